/// \file
/// Images that are not in memory, beside hmesh/hmesh.hpp: mesh_image() of an ImageReader, which reads rectangles where they are
/// needed. docs/scale.md says what it costs.
///
/// This header defines nothing itself.
#ifndef HMESH_LARGE_HPP
#define HMESH_LARGE_HPP

#include "hmesh/image/image_reader.hpp"
#include "hmesh/large/mesh_reader.hpp"

#endif  // HMESH_LARGE_HPP
