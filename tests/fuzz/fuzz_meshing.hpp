// hmesh tests - mesh_image() for the types that are fuzzed, each compiled by itself in tests/fuzz/meshing/: with sanitizers it
// takes a minute.
#ifndef HMESH_TESTS_FUZZ_FUZZ_MESHING_HPP
#define HMESH_TESTS_FUZZ_FUZZ_MESHING_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "hmesh/mesh_image.hpp"

namespace hmesh_test {

// A sample type of the user's own: whole numbers of both signs.
struct Height {
    std::int16_t steps;
};

}  // namespace hmesh_test

template <>
struct hmesh::PixelTraits<hmesh_test::Height> {
    static constexpr double peak = 1000, lowest = -1000, highest = 1000;
    static constexpr bool is_integer = true;
    static double to_real(hmesh_test::Height sample) noexcept { return sample.steps % 1001; }
    static hmesh_test::Height from_real(double value) noexcept {
        return {static_cast<std::int16_t>(std::floor(std::max(lowest, std::min(highest, value)) + 0.5))};
    }
};

#define HMESH_FUZZ_MESHING(PREFIX, T, C) \
    PREFIX template hmesh::Result<C> hmesh::mesh_image(const ImageView<T, C>&, const Options&, const ParallelFor&);

HMESH_FUZZ_MESHING(extern, std::uint8_t, 3)
HMESH_FUZZ_MESHING(extern, std::uint16_t, 4)
HMESH_FUZZ_MESHING(extern, float, 1)
HMESH_FUZZ_MESHING(extern, float, 2)
HMESH_FUZZ_MESHING(extern, hmesh_test::Height, 1)

#endif  // HMESH_TESTS_FUZZ_FUZZ_MESHING_HPP
