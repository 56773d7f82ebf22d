#include "instantiate.hpp"

HMESH_TEST_INSTANTIATE(4)
