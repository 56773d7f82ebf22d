// hmesh tests - what the command meshes several maps of a material with, and no test.
#include <cstdint>

#include "hmesh/lods.hpp"

HMESH_INSTANTIATE(std::uint16_t, 8)
HMESH_INSTANTIATE(std::uint16_t, 16)
HMESH_INSTANTIATE_LODS(std::uint16_t, 8)
HMESH_INSTANTIATE_LODS(std::uint16_t, 16)
HMESH_INSTANTIATE_LODS(float, 16)
