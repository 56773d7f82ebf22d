#include <cstdint>

#include "instantiate.hpp"

HMESH_TEST_INSTANTIATE(3)
HMESH_TEST_INSTANTIATE(4)
HMESH_INSTANTIATE(std::uint8_t, 5)
HMESH_INSTANTIATE(float, 16)
HMESH_INSTANTIATE_LODS(float, 16)
// As the command meshes several maps of a material.
HMESH_INSTANTIATE(std::uint16_t, 8)
HMESH_INSTANTIATE(std::uint16_t, 16)
HMESH_INSTANTIATE_LODS(std::uint16_t, 8)
HMESH_INSTANTIATE_LODS(std::uint16_t, 16)
