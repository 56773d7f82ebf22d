#include "fuzz_meshing.hpp"

HMESH_FUZZ_MESHING(, hmesh_test::Height, 1)
