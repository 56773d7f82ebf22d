// hmesh tests - mesh_image() as programs of many files use it: declared here, compiled once for all tests in tests/meshing/, by
// every recipe for images of 1 to 4 channels of 8-bit, 16-bit and float samples. An instantiation is the whole library and takes
// seconds. CMake defines HMESH_COMPILED for tests that include this; elsewhere each of them compiles what it needs.
#ifndef HMESH_TESTS_TEST_MESHING_HPP
#define HMESH_TESTS_TEST_MESHING_HPP

#include "hmesh/mesh_image.hpp"

#endif  // HMESH_TESTS_TEST_MESHING_HPP
