#include <cstdint>

#include "hmesh/lods.hpp"

HMESH_INSTANTIATE(std::uint8_t, 5)
HMESH_INSTANTIATE(float, 16)
#ifdef HMESH_TEST_MAPS  // several maps of a material, which the command meshes and no other test
HMESH_INSTANTIATE(std::uint16_t, 8)
HMESH_INSTANTIATE(std::uint16_t, 16)
HMESH_INSTANTIATE_LODS(std::uint16_t, 8)
HMESH_INSTANTIATE_LODS(std::uint16_t, 16)
HMESH_INSTANTIATE_LODS(float, 16)
#endif
