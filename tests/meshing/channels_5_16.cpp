#include <cstdint>

#include "hmesh/mesh_image.hpp"

HMESH_INSTANTIATE(std::uint8_t, 5)
HMESH_INSTANTIATE(float, 16)
