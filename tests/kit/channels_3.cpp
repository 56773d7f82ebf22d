#include "test_kit.hpp"

namespace hmesh::kit {

HMESH_TEST_KIT(, 3)

}  // namespace hmesh::kit
