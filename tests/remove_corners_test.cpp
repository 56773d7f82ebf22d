#include "hmesh/outline/remove_corners.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

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

TEST_CASE("the cheapest goes first: of notches the shallowest, of cut corners the shortest, of holes the least") {
    using hmesh::kit::Loop;
    constexpr std::int32_t px = 256;
    constexpr std::int64_t px2 = 2 * 65536;  // as areas are told
    // Sides that are cut off a square, of 3, 1, 4 and 2 px along both axes: each goes by lengthening its neighbours.
    const Loop cut = {{13 * px, 10 * px}, {49 * px, 10 * px}, {50 * px, 11 * px}, {50 * px, 46 * px},
                      {46 * px, 50 * px}, {12 * px, 50 * px}, {10 * px, 48 * px}, {10 * px, 13 * px}};
    Polygons square({cut}, 60, 60);
    std::int64_t area = 1600 * px2 - (9 + 1 + 16 + 4) * px2 / 2;
    CHECK(square.double_area() == area);
    for (const std::int64_t side : {1, 2, 3, 4}) {
        hmesh::kit::remove_corners(square, square.corners() - 1);
        area += side * side * px2 / 2;
        CHECK(square.double_area() == area);
    }
    const std::vector<Loop> whole = square.loops();
    REQUIRE(whole.size() == 1);
    CHECK(whole[0].size() == 4);
    for (const hmesh::kit::GridPoint p : whole[0]) {
        CHECK((p.x == 10 * px || p.x == 50 * px));
        CHECK((p.y == 10 * px || p.y == 50 * px));
    }
    // Notches in its upper side, 6 px wide and 2, 3 and 1 px deep. Once one has gone, its ends cost nothing.
    const Loop notched = {{10 * px, 10 * px}, {20 * px, 10 * px}, {23 * px, 12 * px}, {26 * px, 10 * px}, {46 * px, 10 * px},
                          {49 * px, 13 * px}, {52 * px, 10 * px}, {72 * px, 10 * px}, {75 * px, 11 * px}, {78 * px, 10 * px},
                          {90 * px, 10 * px}, {90 * px, 90 * px}, {10 * px, 90 * px}};
    Polygons comb({notched}, 100, 100);
    area = 6400 * px2 - (2 + 3 + 1) * 3 * px2;
    CHECK(comb.double_area() == area);
    for (const std::int64_t depth : {1, 2, 3}) {
        hmesh::kit::remove_corners(comb, comb.corners() - 1);
        area += depth * 3 * px2;
        CHECK(comb.double_area() == area);
        hmesh::kit::remove_corners(comb, comb.corners() - 2);
        CHECK(comb.double_area() == area);
    }
    CHECK(comb.corners() == 4);
    // All at once it is the same: what a removal changes around it is offered anew, such as the ends of a notch that has gone.
    for (const Loop& loop : {cut, notched}) {
        Polygons one_by_one({loop}, 100, 100);
        for (std::size_t n = loop.size(); n-- > 4;) {
            hmesh::kit::remove_corners(one_by_one, n);
            Polygons at_once({loop}, 100, 100);
            hmesh::kit::remove_corners(at_once, n);
            CHECK(at_once.corners() == n);
            CHECK(at_once.double_area() == one_by_one.double_area());
        }
    }
    // Square holes: a fourth of the area for each corner, where a corner alone would cost half of it.
    const auto hole = [](std::int32_t x, std::int32_t y, std::int32_t size) {
        return Loop{{x * px, y * px}, {x * px, (y + size) * px}, {(x + size) * px, (y + size) * px}, {(x + size) * px, y * px}};
    };
    Polygons sieve({{{0, 0}, {60 * px, 0}, {60 * px, 60 * px}, {0, 60 * px}}, hole(10, 10, 4), hole(30, 12, 8), hole(20, 40, 2)},
                   60, 60);
    area = (3600 - 16 - 64 - 4) * px2;
    CHECK(sieve.double_area() == area);
    for (const std::int64_t size : {2, 4, 8}) {
        const std::size_t before = sieve.corners();
        hmesh::kit::remove_corners(sieve, before - 1);
        CHECK(sieve.corners() == before - 4);
        area += size * size * px2;
        CHECK(sieve.double_area() == area);
    }
    // Of a hole with a corner cut off, one end of the cut goes: 9.5 px^2 for a corner, where all of it would be 80 for each.
    Polygons frame({{{0, 0}, {60 * px, 0}, {60 * px, 60 * px}, {0, 60 * px}},
                    {{10 * px, 11 * px}, {10 * px, 30 * px}, {30 * px, 30 * px}, {30 * px, 10 * px}, {11 * px, 10 * px}}},
                   60, 60);
    area = frame.double_area();
    hmesh::kit::remove_corners(frame, 8);
    CHECK(frame.corners() == 8);
    CHECK(frame.double_area() == area + px2 * 19 / 2);
}

TEST_CASE("a hole that has lost a corner costs more for each of those left, wherever it is asked for") {
    constexpr std::int32_t px = 256, cut = 7 * px + px / 8;
    // A cross of arms of 8 x 8 px, off which a corner is cut: an end of that goes for 3.5 px^2. With the hole a corner costs
    // 24.6 px^2 before and 26.3 after that, and by itself 28 at least; the cut off the square costs 25.4.
    hmesh::kit::Loop cross = {{27, 18}, {26, 19}, {26, 26}, {18, 26}, {18, 34}, {26, 34}, {26, 42},
                              {34, 42}, {34, 34}, {42, 34}, {42, 26}, {34, 26}, {34, 18}};
    for (hmesh::kit::GridPoint& p : cross) p = {p.x * px, p.y * px};
    Polygons frame({{{cut, 0}, {60 * px, 0}, {60 * px, 60 * px}, {0, 60 * px}, {0, cut}}, cross}, 60, 60);
    hmesh::kit::remove_corners(frame, 16);
    CHECK(frame.corners() == 16);
    CHECK(frame.double_area() == std::int64_t{2} * px * px * (60 * 60 - 316));
    hmesh::kit::remove_corners(frame, 15);
    CHECK(frame.corners() == 4);
}

TEST_CASE("a corner in line with its neighbours goes for nothing, beside one that is not convex too") {
    constexpr std::int32_t px = 256;
    const hmesh::kit::Loop step = {{0, 10 * px}, {5 * px, 10 * px},  {10 * px, 10 * px}, {10 * px, 0},
                                   {20 * px, 0}, {20 * px, 20 * px}, {0, 20 * px}};
    Polygons polygons({step}, 20, 20);
    const std::int64_t area = polygons.double_area();
    hmesh::kit::remove_corners(polygons, step.size() - 1);
    CHECK(polygons.corners() == step.size() - 1);
    CHECK(polygons.double_area() == area);
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
