// hmesh tests - what test_meshing.hpp promises, for images of so many channels.
#ifndef HMESH_TESTS_MESHING_INSTANTIATE_HPP
#define HMESH_TESTS_MESHING_INSTANTIATE_HPP

#include <cstdint>

#include "hmesh/paper.hpp"

#define HMESH_TEST_INSTANTIATE_TYPE(T, C)                 \
    HMESH_INSTANTIATE(T, C)                               \
    HMESH_INSTANTIATE_RECIPE(T, C, ::hmesh::Hierarchical) \
    HMESH_INSTANTIATE_RECIPE(T, C, ::hmesh::Xie)          \
    HMESH_INSTANTIATE_RECIPE(T, C, ::hmesh::Adams)        \
    HMESH_INSTANTIATE_RECIPE(T, C, ::hmesh::AdaptiveThinning)
#define HMESH_TEST_INSTANTIATE(C)                 \
    HMESH_TEST_INSTANTIATE_TYPE(std::uint8_t, C)  \
    HMESH_TEST_INSTANTIATE_TYPE(std::uint16_t, C) \
    HMESH_TEST_INSTANTIATE_TYPE(float, C)

#endif  // HMESH_TESTS_MESHING_INSTANTIATE_HPP
