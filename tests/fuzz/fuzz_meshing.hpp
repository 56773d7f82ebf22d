// hmesh tests - mesh_image() for the types that are fuzzed, by every recipe: declared here, each type compiled by itself in
// tests/fuzz/meshing/. With sanitizers it takes a minute.
#ifndef HMESH_TESTS_FUZZ_FUZZ_MESHING_HPP
#define HMESH_TESTS_FUZZ_FUZZ_MESHING_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "hmesh/paper.hpp"

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

#endif  // HMESH_TESTS_FUZZ_FUZZ_MESHING_HPP
