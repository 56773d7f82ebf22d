#include "hmesh/outline/covering.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <string>

#include "test_outlines.hpp"

using hmesh::kit::Covering;
using hmesh::kit::Loop;

namespace {

double area_of(const Covering& covering) {
    double sum = 0;
    for (const Loop& loop : covering.loops()) sum += static_cast<double>(hmesh::kit::double_area(loop)) / (2 * 65536);
    return sum;
}

}  // namespace

TEST_CASE("step by step corners go, the contour stays inside, and the area is what is counted") {
    hmesh::kit::Random random(8);
    for (int round = 0; round < 40; ++round) {
        const int width = 3 + static_cast<int>(random.below(40)), height = 3 + static_cast<int>(random.below(40));
        const auto image = hmesh_test::some_silhouette(round, width, height, random);
        const auto contours = hmesh::kit::contours_of(hmesh_test::mask_of(image), 128, true);
        if (contours.loops.empty()) continue;
        CAPTURE(round);
        Covering covering(contours.loops, width, height);
        CHECK(covering.area() == doctest::Approx(contours.area).epsilon(1e-12));
        for (std::size_t before = covering.corners(); before > 4; before = covering.corners()) {
            const std::size_t wanted = round % 2 == 0 ? before - 1 : before / 2;
            if (!covering.remove_to(wanted)) break;
            CHECK(covering.corners() < before);
            CHECK(covering.area() == doctest::Approx(area_of(covering)).epsilon(1e-12));
            const auto counts = [&](int x, int y) { return image.pixel(x, y)[1] > 0; };
            const std::string flaw =
                hmesh_test::flaw_of_loops(hmesh_test::unit_loops(covering.loops()), width, height, 128, counts);
            if (!flaw.empty()) FAIL(flaw, " with ", covering.corners());
        }
    }
}

TEST_CASE("a step between two levels costs half of its rectangle, and a square without a corner its square") {
    // Two squares of 4 px, side by side and 1 px apart in height.
    const auto steps = hmesh_test::silhouette(
        20, 20, [](int x, int y) { return (x >= 4 && x < 8 && y >= 5 && y < 9) || (x >= 8 && x < 12 && y >= 6 && y < 9); });
    Covering covering(hmesh::kit::contours_of(hmesh_test::mask_of(steps), 0, true).loops, 20, 20);
    CHECK(covering.corners() == 6);
    CHECK(covering.remove_to(5));
    CHECK(covering.corners() == 5);
    CHECK(covering.area() == 16 + 12 + 2);
    CHECK(covering.remove_to(4));
    CHECK(covering.area() <= 32);
    CHECK(covering.area() > 30);
}
