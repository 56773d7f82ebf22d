#include <cstdint>

#include "hmesh/lods/mesh_lods.hpp"
#include "hmesh/mesh_image.hpp"

HMESH_INSTANTIATE(std::uint8_t, 5)
HMESH_INSTANTIATE(float, 16)
HMESH_INSTANTIATE_LODS(float, 16)
// As the command meshes several maps of a material.
HMESH_INSTANTIATE(std::uint16_t, 8)
HMESH_INSTANTIATE(std::uint16_t, 16)
HMESH_INSTANTIATE_LODS(std::uint16_t, 8)
HMESH_INSTANTIATE_LODS(std::uint16_t, 16)
