#include "test_kit.hpp"

namespace hmesh::kit {

HMESH_TEST_KIT(, 4)

}  // namespace hmesh::kit
