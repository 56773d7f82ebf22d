#include "fuzz_meshing.hpp"
#include "meshing/instantiate_type.hpp"

HMESH_TEST_INSTANTIATE_TYPE(std::uint16_t, 4)
