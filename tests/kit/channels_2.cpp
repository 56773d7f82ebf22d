#include "test_kit.hpp"

namespace hmesh::kit {

HMESH_TEST_KIT(, 2)

}  // namespace hmesh::kit
