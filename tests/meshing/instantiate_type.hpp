// hmesh tests - mesh_image() by every recipe and levels of detail for one type of sample and number of channels.
#ifndef HMESH_TESTS_MESHING_INSTANTIATE_TYPE_HPP
#define HMESH_TESTS_MESHING_INSTANTIATE_TYPE_HPP

#include "hmesh/large.hpp"
#include "hmesh/lods.hpp"
#include "hmesh/paper.hpp"

#define HMESH_TEST_INSTANTIATE_TYPE(T, C)                 \
    HMESH_INSTANTIATE(T, C)                               \
    HMESH_INSTANTIATE_READER(T, C)                        \
    HMESH_INSTANTIATE_LODS(T, C)                          \
    HMESH_INSTANTIATE_PROGRESSIVE(T, C)                   \
    HMESH_INSTANTIATE_RECIPE(T, C, ::hmesh::Hierarchical) \
    HMESH_INSTANTIATE_RECIPE(T, C, ::hmesh::Xie)          \
    HMESH_INSTANTIATE_RECIPE(T, C, ::hmesh::Adams)        \
    HMESH_INSTANTIATE_RECIPE(T, C, ::hmesh::AdaptiveThinning)

#endif  // HMESH_TESTS_MESHING_INSTANTIATE_TYPE_HPP
