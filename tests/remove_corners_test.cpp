#include "hmesh/outline/remove_corners.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

#include "test_outlines.hpp"

using hmesh::kit::Polygons;

TEST_CASE("islands in a bay and holes go where that is cheapest") {
    const auto bay = hmesh_test::silhouette(40, 40, [](int x, int y) {
        const bool in_bay = x >= 10 && x < 30 && y < 30;
        return x >= 2 && x < 38 && y >= 2 && y < 38 && (!in_bay || (std::abs(x - 20) < 2 && std::abs(y - 6) < 2));
    });
    Polygons polygons(hmesh::kit::contours_of(hmesh_test::mask_of(bay), 0, true).loops, 40, 40);
    CHECK(polygons.loops().size() == 2);
    for (std::size_t n = polygons.corners(); n-- > 4;) hmesh::kit::remove_corners(polygons, n);
    CHECK(polygons.corners() == 4);
    CHECK(polygons.loops().size() == 1);
    CHECK(polygons.double_area() == 2 * 36 * 36 * 65536);

    const auto ring = hmesh_test::silhouette(40, 40, [](int x, int y) {
        const double d = std::hypot(x - 19.5, y - 19.5);
        return d < 18 && (d > 3 || d < 1);
    });
    Polygons hole(hmesh::kit::contours_of(hmesh_test::mask_of(ring), 0, true).loops, 40, 40);
    CHECK(hole.loops().size() == 3);
    hmesh::kit::remove_corners(hole, 16);
    CHECK(hole.loops().size() == 1);
}

TEST_CASE("corners that are removed leave all inside and no two sides that meet, and each time there is more area") {
    hmesh::kit::Random random(21);
    for (int round = 0; round < 40; ++round) {
        const int width = 3 + static_cast<int>(random.below(40)), height = 3 + static_cast<int>(random.below(40));
        const auto image = hmesh_test::some_silhouette(round, width, height, random);
        const auto contours = hmesh::kit::contours_of(hmesh_test::mask_of(image), 128, true);
        if (contours.loops.empty()) continue;
        CAPTURE(round);
        Polygons polygons(contours.loops, width, height);
        const auto counts = [&](int x, int y) { return image.pixel(x, y)[1] > 0; };
        for (std::size_t n = polygons.corners(); n > 4; n = n * 3 / 4) {
            const std::int64_t before = polygons.double_area();
            hmesh::kit::remove_corners(polygons, n);
            CHECK(polygons.double_area() >= before);
            const std::string flaw =
                hmesh_test::flaw_of_loops(hmesh_test::unit_loops(polygons.loops()), width, height, 128, counts);
            if (!flaw.empty()) FAIL(flaw, " with ", polygons.corners());
        }
    }
}
