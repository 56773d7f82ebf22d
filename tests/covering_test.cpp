#include "hmesh/outline/covering.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "test_outlines.hpp"

using hmesh::kit::Covering;
using hmesh::kit::GridPoint;
using hmesh::kit::Loop;

namespace {

hmesh::kit::Mask mask_of(const hmesh_test::AlphaImage& image) {
    hmesh::kit::Mask mask{image.width(), image.height(), {}};
    for (std::size_t k = 1; k < image.size(); k += 2) mask.pixels.push_back(image.data()[k]);
    return mask;
}

hmesh_test::UnitLoops loops_of(const Covering& covering) {
    hmesh_test::UnitLoops loops;
    for (const Loop& loop : covering.loops()) {
        loops.emplace_back();
        for (const GridPoint p : loop) loops.back().push_back({p.x, p.y});
    }
    return loops;
}

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
        const auto contours = hmesh::kit::contours_of(mask_of(image), 128, true);
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
            const std::string flaw = hmesh_test::flaw_of_loops(loops_of(covering), width, height, 128, counts);
            if (!flaw.empty()) FAIL(flaw, " with ", covering.corners());
        }
    }
}

TEST_CASE("a step between two levels costs half of its rectangle, and a square without a corner its square") {
    // Two squares of 4 px, side by side and 1 px apart in height.
    const auto steps = hmesh_test::silhouette(
        20, 20, [](int x, int y) { return (x >= 4 && x < 8 && y >= 5 && y < 9) || (x >= 8 && x < 12 && y >= 6 && y < 9); });
    Covering covering(hmesh::kit::contours_of(mask_of(steps), 0, true).loops, 20, 20);
    CHECK(covering.corners() == 6);
    CHECK(covering.remove_to(5));
    CHECK(covering.corners() == 5);
    CHECK(covering.area() == 16 + 12 + 2);
    CHECK(covering.remove_to(4));
    CHECK(covering.area() <= 32);
    CHECK(covering.area() > 30);
}

TEST_CASE("islands in a bay and holes go where that is cheapest") {
    const auto bay = hmesh_test::silhouette(40, 40, [](int x, int y) {
        const bool in_bay = x >= 10 && x < 30 && y < 30;
        return x >= 2 && x < 38 && y >= 2 && y < 38 && (!in_bay || (std::abs(x - 20) < 2 && std::abs(y - 6) < 2));
    });
    Covering covering(hmesh::kit::contours_of(mask_of(bay), 0, true).loops, 40, 40);
    CHECK(covering.loops().size() == 2);
    while (covering.corners() > 4 && covering.remove_to(covering.corners() - 1)) continue;
    CHECK(covering.corners() == 4);
    CHECK(covering.loops().size() == 1);
    CHECK(covering.area() == 36 * 36);

    const auto ring = hmesh_test::silhouette(40, 40, [](int x, int y) {
        const double far = std::hypot(x - 19.5, y - 19.5);
        return far < 18 && (far > 3 || far < 1);
    });
    Covering hole(hmesh::kit::contours_of(mask_of(ring), 0, true).loops, 40, 40);
    CHECK(hole.loops().size() == 3);
    CHECK(hole.remove_to(16));
    CHECK(hole.loops().size() == 1);
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
            CHECK(hmesh::kit::orient(a, b, c) > 0);
            for (const GridPoint p : points) CHECK(hmesh::kit::orient(a, b, p) >= 0);
        }
    }
    CHECK(hmesh::kit::convex_hull({{1, 1}, {1, 1}}).size() == 1);
}
