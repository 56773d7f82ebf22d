// The one file of the module that compiles mesh_image(), for speed; all else is compiled for size.
#define HMESH_IMPLEMENTATION
#include "hmesh/mesh_image.hpp"

#include <cstdint>

HMESH_INSTANTIATE(std::uint8_t, 3)
HMESH_INSTANTIATE(std::uint8_t, 4)
