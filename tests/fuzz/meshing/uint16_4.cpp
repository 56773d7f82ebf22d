#include "fuzz_meshing.hpp"

HMESH_FUZZ_MESHING(, std::uint16_t, 4)
