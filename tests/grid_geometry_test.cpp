#include "hmesh/outline/grid_geometry.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "hmesh/core/random.hpp"
#include "test_outlines.hpp"

using hmesh::kit::GridBox;
using hmesh::kit::GridPoint;
using hmesh::kit::Loop;

namespace {

GridPoint some_point(hmesh::kit::Random& random, std::uint32_t size) {
    return {static_cast<std::int32_t>(random.below(size)), static_cast<std::int32_t>(random.below(size))};
}
hmesh_test::UnitPoint wide(GridPoint p) { return {p.x, p.y}; }

}  // namespace

TEST_CASE("segments meet and points are in triangles as whole numbers say, ends and borders included") {
    hmesh::kit::Random random(9);
    for (int round = 0; round < 20000; ++round) {
        const std::uint32_t size = round % 2 == 0 ? 5 : 1U << 24U;
        const GridPoint a = some_point(random, size), b = some_point(random, size), c = some_point(random, size),
                        d = some_point(random, size);
        if (hmesh::kit::do_segments_meet(a, b, c, d) != hmesh_test::touch(wide(a), wide(b), wide(c), wide(d))) FAIL("segments");
        const auto turn = [](GridPoint p, GridPoint q, GridPoint r) { return hmesh_test::turn_of(wide(p), wide(q), wide(r)); };
        const bool apart = (turn(a, b, c) > 0) != (turn(a, b, d) > 0) && (turn(c, d, a) > 0) != (turn(c, d, b) > 0);
        const bool at_end = turn(a, b, c) == 0 || turn(a, b, d) == 0 || turn(c, d, a) == 0 || turn(c, d, b) == 0;
        if (hmesh::kit::do_segments_cross(a, b, c, d) != (apart && !at_end)) FAIL("crossing");
        if (hmesh::kit::orient2d(a, b, c) == 0) continue;
        const auto side = [&](GridPoint p, GridPoint q) { return hmesh_test::turn_of(wide(p), wide(q), wide(d)); };
        const std::int64_t low = std::min({side(a, b), side(b, c), side(c, a)}),
                           high = std::max({side(a, b), side(b, c), side(c, a)});
        if (hmesh::kit::is_in_triangle(a, b, c, d) != (low >= 0 || high <= 0)) FAIL("triangle");
    }
    CHECK(hmesh::kit::is_in_triangle({0, 0}, {4, 4}, {2, 2}, {3, 3}));
    CHECK_FALSE(hmesh::kit::is_in_triangle({0, 0}, {4, 4}, {2, 2}, {5, 5}));
}

TEST_CASE("the box of polygons is the least that has all their corners, its own clockwise on the screen") {
    const GridBox box = hmesh::kit::box_of({{{3, 4}, {9, 5}, {4, 6}}, {{5, -2}, {6, 8}, {-1, 5}}});
    CHECK(box.corners() == Loop{{-1, -2}, {9, -2}, {9, 8}, {-1, 8}});
}

TEST_CASE("the hull of points is convex, clockwise on the screen, and has them all inside") {
    hmesh::kit::Random random(1);
    for (int round = 0; round < 50; ++round) {
        Loop points;
        const std::uint32_t size = round % 2 == 0 ? 6 : 10000;
        for (int i = 0; i < 3 + round; ++i)
            points.push_back({static_cast<std::int32_t>(random.below(size)), static_cast<std::int32_t>(random.below(size))});
        const Loop hull = hmesh::kit::convex_hull(points);
        if (hull.size() < 3) continue;
        for (std::size_t i = 0; i < hull.size(); ++i) {
            const GridPoint a = hull[i], b = hull[(i + 1) % hull.size()], c = hull[(i + 2) % hull.size()];
            CHECK(hmesh::kit::orient2d(a, b, c) > 0);
            for (const GridPoint p : points) CHECK(hmesh::kit::orient2d(a, b, p) >= 0);
        }
    }
    CHECK(hmesh::kit::convex_hull({{1, 1}, {1, 1}}).size() == 1);
}

TEST_CASE("the nearest point of the grid is within the box and good, and far outside there is none") {
    const GridBox box = GridBox({0, 0}).add({100, 50});
    const auto nearest = [&](double x, double y, std::int32_t most) {
        return hmesh::kit::nearest_point(
            {x, y}, box, [&](GridPoint p) { return p.x <= most; },
            [&](GridPoint p) { return (p.x - x) * (p.x - x) + (p.y - y) * (p.y - y); });
    };
    CHECK(nearest(10.4, 20.6, 100) == GridPoint{10, 21});
    CHECK(nearest(10.4, 20.6, 9) == GridPoint{9, 21});
    CHECK_FALSE(nearest(10.4, 20.6, 8));
    CHECK(nearest(10.5, 20.5, 100) == GridPoint{10, 20});  // of four as near the first
    CHECK(nearest(-1.9, 51.9, 100) == GridPoint{0, 50});
    CHECK(nearest(101.9, -1.9, 100) == GridPoint{100, 0});
    for (const double out : {-2.0, 102.0, 1e300, -1e300, std::numeric_limits<double>::quiet_NaN()}) {
        CHECK_FALSE(nearest(out, 20, 100));
        CHECK_FALSE(nearest(20, out, 100));
    }
}
