#include "fuzz_meshing.hpp"

HMESH_FUZZ_MESHING(, float, 1)
