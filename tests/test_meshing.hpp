// hmesh tests - mesh_image() for the types that tests use most, compiled once for all of them, in tests/meshing/: an
// instantiation of it is the whole library and takes seconds.
#ifndef HMESH_TESTS_TEST_MESHING_HPP
#define HMESH_TESTS_TEST_MESHING_HPP

#include <cstdint>

#include "hmesh/mesh_image.hpp"

#define HMESH_TEST_MESHING(PREFIX, T, C) \
    PREFIX template hmesh::Result<C> hmesh::mesh_image(const ImageView<T, C>&, const Options&, const ParallelFor&);
#define HMESH_TEST_MESHING_TYPES(PREFIX, C)      \
    HMESH_TEST_MESHING(PREFIX, std::uint8_t, C)  \
    HMESH_TEST_MESHING(PREFIX, std::uint16_t, C) \
    HMESH_TEST_MESHING(PREFIX, float, C)

HMESH_TEST_MESHING_TYPES(extern, 1)
HMESH_TEST_MESHING_TYPES(extern, 2)
HMESH_TEST_MESHING_TYPES(extern, 3)
HMESH_TEST_MESHING_TYPES(extern, 4)

#endif  // HMESH_TESTS_TEST_MESHING_HPP
