/// \file
/// What programs that keep meshes in compact files add to hmesh/hmesh.hpp: write_compact() and read_compact().
///
/// This header defines nothing itself. It stands beside hmesh/hmesh.hpp, since most programs only write files for others.
#ifndef HMESH_COMPACT_HPP
#define HMESH_COMPACT_HPP

#include "hmesh/io/compact.hpp"

#endif  // HMESH_COMPACT_HPP
