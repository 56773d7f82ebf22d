// hmesh tests - mesh_image() for the types that tests use most, compiled once for all of them, in tests/meshing/: an
// instantiation of it is the whole library and takes seconds.
#ifndef HMESH_TESTS_TEST_MESHING_HPP
#define HMESH_TESTS_TEST_MESHING_HPP

#include <cstdint>

#include "hmesh/mesh_image.hpp"
#include "test_executors.hpp"

#define HMESH_TEST_MESHING(PREFIX, T, C, PARALLEL_FOR) \
    PREFIX template hmesh::Result<C> hmesh::mesh_image(const ImageView<T, C>&, const Options&, const PARALLEL_FOR&);

#define HMESH_TEST_MESHING_1(PREFIX)                                 \
    HMESH_TEST_MESHING(PREFIX, std::uint8_t, 1, SerialFor)           \
    HMESH_TEST_MESHING(PREFIX, std::uint16_t, 1, SerialFor)          \
    HMESH_TEST_MESHING(PREFIX, float, 1, SerialFor)                  \
    HMESH_TEST_MESHING(PREFIX, std::uint8_t, 1, hmesh_test::AnyFor)  \
    HMESH_TEST_MESHING(PREFIX, std::uint16_t, 1, hmesh_test::AnyFor) \
    HMESH_TEST_MESHING(PREFIX, float, 1, hmesh_test::AnyFor)
#define HMESH_TEST_MESHING_2(PREFIX)                        \
    HMESH_TEST_MESHING(PREFIX, std::uint8_t, 2, SerialFor)  \
    HMESH_TEST_MESHING(PREFIX, std::uint16_t, 2, SerialFor) \
    HMESH_TEST_MESHING(PREFIX, float, 2, SerialFor)         \
    HMESH_TEST_MESHING(PREFIX, float, 2, hmesh_test::AnyFor)
#define HMESH_TEST_MESHING_3(PREFIX)                        \
    HMESH_TEST_MESHING(PREFIX, std::uint8_t, 3, SerialFor)  \
    HMESH_TEST_MESHING(PREFIX, std::uint16_t, 3, SerialFor) \
    HMESH_TEST_MESHING(PREFIX, float, 3, SerialFor)         \
    HMESH_TEST_MESHING(PREFIX, std::uint8_t, 3, hmesh_test::AnyFor)
#define HMESH_TEST_MESHING_4(PREFIX)                        \
    HMESH_TEST_MESHING(PREFIX, std::uint8_t, 4, SerialFor)  \
    HMESH_TEST_MESHING(PREFIX, std::uint16_t, 4, SerialFor) \
    HMESH_TEST_MESHING(PREFIX, float, 4, SerialFor)

HMESH_TEST_MESHING_1(extern)
HMESH_TEST_MESHING_2(extern)
HMESH_TEST_MESHING_3(extern)
HMESH_TEST_MESHING_4(extern)

#endif  // HMESH_TESTS_TEST_MESHING_HPP
