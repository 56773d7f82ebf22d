#include "test_meshing.hpp"

HMESH_TEST_MESHING_TYPES(, 2)
