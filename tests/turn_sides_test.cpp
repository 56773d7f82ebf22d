#include "hmesh/outline/turn_sides.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

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

TEST_CASE("a side is not turned so that it leaves an island outside that the polygon had swallowed") {
    constexpr std::int32_t px = hmesh::kit::units_per_px;
    const Loop contour = {{30 * px, 30 * px}, {45 * px, 30 * px}, {70 * px, 55 * px}, {70 * px, 70 * px}, {30 * px, 70 * px}};
    // In each place beyond the long slope: the corner that it becomes, and between this and both sides.
    for (const std::array<std::int32_t, 2>& at : {std::array<std::int32_t, 2>{67, 31}, {60, 31}, {67, 38}, {64, 34}, {0, 0}}) {
        CAPTURE(at[0]);
        std::vector<Loop> loops = {contour};
        const std::int32_t left = at[0] * px, top = at[1] * px;
        const bool has_island = left > 0;
        if (has_island) loops.push_back({{left, top}, {left + 2 * px, top}, {left + 2 * px, top + 2 * px}, {left, top + 2 * px}});
        Polygons polygons(loops, 100, 100);
        if (has_island) polygons.remove_loop(1);
        polygons.remove_side(1, {70 * px, 30 * px});
        REQUIRE(polygons.loops().size() == 1);
        CHECK(polygons.double_area() == std::int64_t{2} * 40 * 40 * px * px);
        hmesh::kit::turn_sides(polygons);
        // Without an island both sides of the corner are turned, and a tenth of the area and more is gone.
        if (!has_island) CHECK(polygons.double_area() < std::int64_t{2} * 36 * 40 * px * px);
        const std::vector<Loop> after = polygons.loops();
        REQUIRE(after.size() == 1);
        REQUIRE(after[0].size() == 4);
        for (std::size_t i = 0; i < 4; ++i)
            for (const Loop& loop : loops)
                for (const hmesh::kit::GridPoint p : loop)
                    CHECK(hmesh::kit::orient2d(after[0][i], after[0][(i + 1) % 4], p) >= 0);
    }
}

TEST_CASE("a side is not turned where it, or a neighbour that this makes longer, would meet another polygon") {
    constexpr std::int32_t px = hmesh::kit::units_per_px;
    const Loop contour = {{30 * px, 30 * px}, {45 * px, 30 * px}, {70 * px, 55 * px}, {70 * px, 70 * px}, {30 * px, 70 * px}};
    int turned = 0;
    // As it is and mirrored, so that each of both neighbours becomes longer. What is in the way: nothing; a square where the
    // neighbour would end; one where the side would run; and a bar across both, which has no corner between old and new sides.
    for (const bool is_mirrored : {false, true})
        for (const std::array<std::int32_t, 3>& at :
             {std::array<std::int32_t, 3>{5, 5, 2}, {29, 19, 2}, {34, 19, 2}, {10, 18, 50}}) {
            CAPTURE(is_mirrored);
            CAPTURE(at[0]);
            std::vector<Loop> loops = {contour};
            const std::int32_t left = at[0] * px, top = at[1] * px, right = left + at[2] * px;
            loops.push_back({{left, top}, {right, top}, {right, top + 2 * px}, {left, top + 2 * px}});
            if (is_mirrored)
                for (Loop& loop : loops) {
                    for (hmesh::kit::GridPoint& p : loop) p = {p.y, p.x};
                    std::reverse(loop.begin(), loop.end());
                }
            Polygons polygons(loops, 100, 100);
            polygons.remove_side(is_mirrored ? 2 : 1, {(is_mirrored ? 30 : 70) * px, (is_mirrored ? 70 : 30) * px});
            REQUIRE(polygons.corners() == 8);
            const std::int64_t before = polygons.double_area();
            hmesh::kit::turn_sides(polygons);
            if (polygons.double_area() < before) ++turned;
            const std::vector<Loop> after = polygons.loops();
            REQUIRE(after.size() == 2);
            for (std::size_t i = 0; i < 4; ++i)
                for (std::size_t j = 0; j < 4; ++j)
                    CHECK(!hmesh::kit::do_segments_meet(after[0][i], after[0][(i + 1) % 4], after[1][j], after[1][(j + 1) % 4]));
        }
    CHECK(turned >= 2);
}
