#include "fuzz_meshing.hpp"

HMESH_FUZZ_MESHING(, std::uint8_t, 3)
