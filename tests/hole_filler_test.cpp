#include "hmesh/mesh/hole_filler.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "exact_circles.hpp"
#include "hmesh/core/random.hpp"

using hmesh::kit::Ear;
using hmesh::kit::HoleFiller;
using hmesh::kit::Point;
using hmesh::kit::Random;
using hmesh_test::circle_test;
using hmesh_test::double_area;
using hmesh_test::GridPoint;
using hmesh_test::on_grid;

namespace {

using Ring = std::vector<Point>;

const hmesh::kit::Array<Ear>& fill(HoleFiller& filler, const Ring& ring, bool open) {
    return filler.fill(
        static_cast<int>(ring.size()), [&](int k) { return ring[static_cast<std::size_t>(k)]; }, open);
}

// --- geometry in integers of 1/256 px ---

// The triangles are ears of what is left at their turn, none is folded and no corner lies within another's triangle, so
// that they fill the polygon. Returns how many circles hold a corner.
int prove(const hmesh::kit::Array<Ear>& ears, const Ring& ring, bool open) {
    const int count = static_cast<int>(ring.size());
    REQUIRE(static_cast<int>(ears.size()) == count - 2);
    const auto at = [&](int k) { return on_grid(ring[static_cast<std::size_t>(k)]); };
    std::vector<int> left;
    for (int k = 0; k < count; ++k) left.push_back(k);
    std::int64_t area = 0, whole = 0;
    int folded = 0, covered = 0, occupied = 0;
    for (const Ear ear : ears) {
        const auto tip = std::find(left.begin(), left.end(), ear.tip);
        REQUIRE(tip != left.end());
        REQUIRE((tip == left.begin() ? left.back() : tip[-1]) == ear.before);
        REQUIRE((tip + 1 == left.end() ? left.front() : tip[1]) == ear.after);
        if (open) REQUIRE((ear.tip != 0 && ear.tip != count - 1));
        left.erase(tip);
        const GridPoint a = at(ear.after), b = at(ear.tip), c = at(ear.before);
        area += double_area(a, b, c);
        folded += double_area(a, b, c) <= 0;
        bool empty = true;
        for (int k = 0; k < count; ++k) {
            if (k == ear.before || k == ear.tip || k == ear.after) continue;
            const GridPoint d = at(k);
            covered += double_area(a, b, d) >= 0 && double_area(b, c, d) >= 0 && double_area(c, a, d) >= 0;
            empty = empty && circle_test(a, b, c, d) <= 0;
        }
        occupied += !empty;
    }
    for (int k = 0; k < count; ++k) whole += double_area(at(0), at((k + 1) % count), at(k));
    REQUIRE(area == whole);
    REQUIRE(folded == 0);
    REQUIRE(covered == 0);
    return occupied;
}

// Sorted around `centre` by falling angle, as in a one-ring.
Ring around(Ring ring, Point center) {
    std::sort(ring.begin(), ring.end(), [center](Point a, Point b) {
        return std::atan2(a.y - center.y, a.x - center.x) > std::atan2(b.y - center.y, b.x - center.x);
    });
    return ring;
}

Ring circle_points(int radius, Point center, double scale) {
    Ring ring;
    for (int y = -radius; y <= radius; ++y)
        for (int x = -radius; x <= radius; ++x)
            if (x * x + y * y == radius * radius) ring.push_back({center.x + scale * x, center.y + scale * y});
    return around(ring, center);
}

// The border of a rectangle of columns x rows squares.
Ring border_points(int columns, int rows, Point first, double step) {
    Ring ring;
    for (int j = 0; j <= rows; ++j)
        for (int i = 0; i <= columns; ++i)
            if (i == 0 || j == 0 || i == columns || j == rows) ring.push_back({first.x + step * i, first.y + step * j});
    return around(ring, {first.x + 0.5 * step * columns, first.y + 0.5 * step * rows});
}

// `count` corners at random angles and distances from a centre that sees them all; with `half`, from a centre on the line
// through the first and the last. Positions are multiples of `step` px: where it is coarse, many corners are in line.
Ring star(int count, double radius, double spread, double step, bool half, Random& random) {
    const Point center{2048, 2048};
    const auto round = [step](double x) { return step * std::floor(x / step + 0.5); };
    for (;;) {
        Ring ring;
        for (int k = 0; k < count; ++k) {
            const double turn = half ? 3.141592653589793 : 6.283185307179586;
            const double angle = turn * (half ? 1.0 * k / (count - 1) : (k + 0.8 * random.uniform()) / count);
            const double distance = radius * (1 - spread * random.uniform());
            const bool level = half && (k == 0 || k + 1 == count);
            ring.push_back(
                {round(center.x + distance * std::cos(angle)), level ? center.y : round(center.y + distance * std::sin(angle))});
        }
        std::reverse(ring.begin(), ring.end());
        bool good = true;
        for (int k = half ? 1 : 0; k < count; ++k) {
            const Point a = ring[static_cast<std::size_t>(k)], b = ring[static_cast<std::size_t>((k + count - 1) % count)];
            good = good && orient2d(center, a, b) > 0;
        }
        if (good) return ring;
    }
}

}  // namespace

TEST_CASE("three corners are one triangle, four are cut by the diagonal that leaves no corner in a circle") {
    HoleFiller filler;
    CHECK(prove(fill(filler, {{0, 0}, {0, 1}, {1, 0}}, false), {{0, 0}, {0, 1}, {1, 0}}, false) == 0);
    const Ring flat = {{0, 0}, {4, 1}, {8, 0}, {4, -1}};
    CHECK(prove(fill(filler, flat, false), flat, false) == 0);
    const hmesh::kit::Array<Ear>& ears = fill(filler, flat, false);
    CHECK((ears[0].tip == 0 && ears[0].before == 3 && ears[0].after == 1));
    CHECK((ears[1].before == 1 && ears[1].tip == 2 && ears[1].after == 3));
}

TEST_CASE("a convex polygon gets its Delaunay triangulation, whatever lies on a circle or in line") {
    HoleFiller filler;
    std::vector<Ring> rings;
    for (const int radius : {1, 5, 25, 65, 325}) rings.push_back(circle_points(radius, {400, 400}, 1));
    rings.push_back(circle_points(65, {32768, 32768}, 504));
    rings.push_back(circle_points(65, {65000, 65000}, 1.0 / 256));
    for (const int columns : {1, 2, 3, 8, 60})
        for (const int rows : {1, 2, 5}) rings.push_back(border_points(columns, rows, {0.5, 0.5}, 1));
    rings.push_back(border_points(6, 4, {0, 0}, 8192));
    for (const Ring& ring : rings) {
        Ring turned = ring;
        for (std::size_t k = 0; k < std::min<std::size_t>(ring.size(), 12); ++k) {
            CHECK(prove(fill(filler, turned, false), turned, false) == 0);
            std::rotate(turned.begin(), turned.begin() + 1, turned.end());
        }
    }
}

TEST_CASE("an open ring keeps the edge between its ends for the last triangle") {
    HoleFiller filler;
    for (const Ring& ring : {border_points(6, 3, {0, 0}, 1), circle_points(25, {30, 30}, 1)}) {
        // Beginning at each corner, those that follow on one side of the line from the first to the last.
        Ring turned = ring;
        for (std::size_t k = 0; k < ring.size(); ++k) {
            std::rotate(turned.begin(), turned.begin() + 1, turned.end());
            for (std::size_t size = 3; size <= ring.size(); ++size) {
                const Ring part(turned.begin(), turned.begin() + static_cast<std::ptrdiff_t>(size));
                bool off_line = true;
                for (std::size_t i = 1; i + 1 < size; ++i) off_line = off_line && orient2d(part[0], part.back(), part[i]) > 0;
                if (off_line) CHECK(prove(fill(filler, part, true), part, true) == 0);
            }
        }
    }
}

TEST_CASE("any polygon that its centre sees is triangulated, by empty circles where there are any") {
    HoleFiller filler;
    Random random(1);
    int full = 0, empty = 0;
    for (int k = 0; k < 20000; ++k) {
        const bool half = k % 2 == 0;
        const int count = 4 + static_cast<int>(random.below(14));
        const double radius = k % 3 == 0 ? 0.2 : k % 3 == 1 ? 20 : 2000, spread = k % 5 == 0 ? 0.2 : 0.95;
        const double step = k % 7 < 3 && radius == 20 ? 1 : 1.0 / 256;
        const Ring ring = star(step == 1 ? std::min(count, 9) : count, radius, spread, step, half, random);
        const int occupied = prove(fill(filler, ring, half), ring, half);
        ++(occupied == 0 ? empty : full);
    }
    CHECK(full > 500);
    CHECK(empty > 500);
}

TEST_CASE("a spiral, where no circle of an ear need be empty, is triangulated too") {
    HoleFiller filler;
    Ring outer, inner;
    for (int k = 0; k <= 40; ++k) {
        const double angle = 0.4 * k, radius = 60 + 1.3 * k;
        outer.push_back(snap(Point{400 + (radius + 8) * std::cos(angle), 400 + (radius + 8) * std::sin(angle)}));
        inner.push_back(snap(Point{400 + (radius - 8) * std::cos(angle), 400 + (radius - 8) * std::sin(angle)}));
    }
    Ring ring(outer.rbegin(), outer.rend());
    ring.insert(ring.end(), inner.begin(), inner.end());
    CHECK(prove(fill(filler, ring, false), ring, false) > 0);
}

TEST_CASE("a polygon that is not simple ends all the same") {
    HoleFiller filler;
    CHECK(fill(filler, {{0, 0}, {1, 1}, {2, 2}, {3, 3}, {4, 4}}, false).size() == 3);
    CHECK(fill(filler, {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, false).size() == 2);  // turns with the faces
    CHECK(fill(filler, Ring(9, Point{1, 1}), true).size() == 7);
}

TEST_CASE("no memory is asked for once the largest ring has been seen") {
    HoleFiller filler;
    const Ring large = circle_points(65, {100, 100}, 1), small = circle_points(5, {100, 100}, 1);
    const Ear* const data = fill(filler, large, false).data();
    CHECK(fill(filler, small, false).data() == data);
    CHECK(fill(filler, large, false).data() == data);
}

TEST_CASE("a circle holds what lies strictly inside, exactly, on the whole 1/256 px grid") {
    Random random(2);
    int wrong = 0, found[3] = {};
    for (int k = 0; k < 100000; ++k) {
        const std::size_t side = std::size_t{1} << random.below(25), step = k % 2 == 0 ? 1 : std::max<std::size_t>(1, side / 8);
        GridPoint p[4];
        for (GridPoint& q : p)
            q = {static_cast<std::int64_t>((1U << 24U) - random.below(side + 1) / step * step),
                 static_cast<std::int64_t>((1U << 24U) - random.below(side + 1) / step * step)};
        if (k % 4 == 2) {  // the fourth corner of a rectangle, turned, or next to it
            p[3] = {p[0].x + p[2].y - p[0].y, p[0].y - (p[2].x - p[0].x)};
            p[1] = {p[2].x + p[3].x - p[0].x, p[2].y + p[3].y - p[0].y};
            p[3].x += static_cast<std::int64_t>(random.below(3)) - 1;
            if (std::min({p[1].x, p[1].y, p[3].x, p[3].y}) < 0 || std::max({p[1].x, p[1].y, p[3].x, p[3].y}) > (1 << 24))
                continue;
        }
        if (double_area(p[0], p[1], p[2]) < 0) std::swap(p[0], p[1]);
        const std::int64_t area = double_area(p[0], p[1], p[2]);
        const auto point = [](GridPoint q) { return Point{static_cast<double>(q.x) / 256, static_cast<double>(q.y) / 256}; };
        const hmesh::kit::detail::Circle subject(point(p[0]), point(p[1]), point(p[2]));
        wrong += subject.is_positive() != (area > 0);
        if (area == 0) continue;
        const hmesh_test::Wide exact = circle_test(p[0], p[1], p[2], p[3]);
        ++found[exact < 0 ? 0 : exact == 0 ? 1 : 2];
        wrong += subject.holds(point(p[3])) != (exact > 0);
    }
    CHECK(wrong == 0);
    for (const int count : found) CHECK(count > 5000);
}
