// The one file of the module that compiles mesh_image() and compact_image(), for speed; all else is compiled for size.
#define HMESH_IMPLEMENTATION
#include "hmesh/mesh_image.hpp"

#include <cstdint>

#include "hmesh/rate/compact_image.hpp"

HMESH_INSTANTIATE(std::uint8_t, 3)
HMESH_INSTANTIATE(std::uint8_t, 4)
HMESH_INSTANTIATE_COMPACT(std::uint8_t, 3)
HMESH_INSTANTIATE_COMPACT(std::uint8_t, 4)
