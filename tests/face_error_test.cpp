#include "hmesh/methods/bounded/face_error.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <limits>

#include "hmesh/core/random.hpp"

namespace {

using hmesh::kit::Corner;
using hmesh::kit::face_error;
using hmesh::kit::HeightField;

constexpr double all = std::numeric_limits<double>::infinity();

// Whole numbers below 1000.
HeightField noise(int width, int height, std::uint64_t seed) {
    hmesh::kit::Random random(seed);
    HeightField field;
    field.width = width;
    field.height = height;
    field.samples = hmesh::Samples::points;
    field.values.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) + 16);
    for (float& value : field.values) value = static_cast<float>(random.below(1000));
    return field;
}

}  // namespace

// The worst sample of a common edge is as far off as seen from either face but for rounding, and may be what is compared with.
TEST_CASE("a face whose first rows come to the bound by rounding alone is looked at to its end") {
    int seen = 0;
    for (std::uint64_t seed = 1; seed <= 20000; ++seed) {
        hmesh::kit::Random random(seed);
        const HeightField field = noise(30, 14, seed);
        HeightField edge = field;  // of which the first row is all there is
        edge.height = 1;
        const auto corner = [&](int x, int y) {
            Corner c{{static_cast<double>(x), static_cast<double>(y)}, {}};
            c.heights[0] = static_cast<float>(random.below(1000));
            return c;
        };
        const Corner a = corner(0, 0), b = corner(20 + static_cast<int>(random.below(9)), 0);
        const Corner one = corner(static_cast<int>(random.below(29)), 3 + static_cast<int>(random.below(10)));
        const Corner other = corner(static_cast<int>(random.below(29)), 3 + static_cast<int>(random.below(10)));
        const double enough = face_error(edge, a, b, other, all), error = face_error(field, a, b, one, all);
        if (!(error > enough)) continue;
        ++seen;
        CHECK(face_error(field, a, b, one, enough) > enough);
    }
    CHECK(seen > 10000);
}
