// hmesh tests - what test_meshing.hpp and test_kit.hpp promise, for images of so many channels. mesh_image() is made of those
// building blocks, so that in one file they cost nothing.
#ifndef HMESH_TESTS_MESHING_INSTANTIATE_HPP
#define HMESH_TESTS_MESHING_INSTANTIATE_HPP

#include <cstdint>

#include "hmesh/rate/compact_image.hpp"
#include "instantiate_type.hpp"
#include "test_kit.hpp"

#define HMESH_TEST_INSTANTIATE(C)                 \
    HMESH_TEST_INSTANTIATE_TYPE(std::uint8_t, C)  \
    HMESH_TEST_INSTANTIATE_TYPE(std::uint16_t, C) \
    HMESH_TEST_INSTANTIATE_TYPE(float, C)         \
    HMESH_INSTANTIATE_COMPACT(std::uint8_t, C)    \
    namespace hmesh::kit {                        \
    HMESH_TEST_KIT(, C)                           \
    }

#endif  // HMESH_TESTS_MESHING_INSTANTIATE_HPP
