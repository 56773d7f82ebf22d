/// \file
/// What programs that keep meshes in compact files add to hmesh/hmesh.hpp: write_compact() and read_compact(), and
/// compact_image(), an image in a given number of bytes, and the start table compact_photographs, which both may begin with.
///
/// This header defines nothing itself. It stands beside hmesh/hmesh.hpp, since most programs only write files for others. Those
/// that only read may do with hmesh/io/compact.hpp.
#ifndef HMESH_COMPACT_HPP
#define HMESH_COMPACT_HPP

#include "hmesh/io/compact.hpp"
#include "hmesh/io/compact/photographs.hpp"
#include "hmesh/rate/compact_image.hpp"

#endif  // HMESH_COMPACT_HPP
