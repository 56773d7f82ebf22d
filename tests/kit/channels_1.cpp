#include "test_kit.hpp"

namespace hmesh::kit {

HMESH_TEST_KIT(, 1)

}  // namespace hmesh::kit
