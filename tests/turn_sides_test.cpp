#include "hmesh/outline/turn_sides.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <string>

#include "hmesh/outline/remove_corners.hpp"
#include "test_outlines.hpp"

using hmesh::kit::Loop;
using hmesh::kit::Polygons;

TEST_CASE("turning leaves as many corners, all inside, no two sides that meet, and less area where it does anything") {
    hmesh::kit::Random random(31);
    int turned = 0;
    for (int round = 0; round < 64; ++round) {
        const int width = 3 + static_cast<int>(random.below(40)), height = 3 + static_cast<int>(random.below(40));
        const auto image = hmesh_test::some_silhouette(round, width, height, random);
        const auto contours = hmesh::kit::contours_of(hmesh_test::mask_of(image), 128, true);
        if (contours.loops.empty()) continue;
        CAPTURE(round);
        Polygons polygons(contours.loops, width, height);
        hmesh::kit::remove_corners(polygons, polygons.corners() / (2 + random.below(4)));
        const std::size_t corners = polygons.corners();
        const std::int64_t area = polygons.double_area();
        const auto before = polygons.loops();
        hmesh::kit::turn_sides(polygons);
        CHECK(polygons.corners() == corners);
        if (polygons.loops() != before) {
            CHECK(polygons.double_area() < area);
            ++turned;
        }
        const auto counts = [&](int x, int y) { return image.pixel(x, y)[1] > 0; };
        const std::string flaw = hmesh_test::flaw_of_loops(hmesh_test::unit_loops(polygons.loops()), width, height, 128, counts);
        if (!flaw.empty()) FAIL(flaw, " with ", corners);
    }
    CHECK(turned > 20);
}

TEST_CASE("a side that stands away from the contour is turned back to it") {
    constexpr std::int32_t px = hmesh::kit::units_per_px;
    const Loop square = {{10 * px, 10 * px}, {20 * px, 10 * px}, {20 * px, 20 * px}, {10 * px, 20 * px}};
    Polygons polygons({square}, 40, 40);
    polygons.move_side(0, {10 * px, 4 * px}, {20 * px, 7 * px});
    hmesh::kit::turn_sides(polygons);
    CHECK(polygons.loops().front() == square);
}
