#include "hmesh/mesh/geometry.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "hmesh/core/random.hpp"
#include "wide.hpp"

using hmesh::kit::Point;
using hmesh::kit::Random;
using hmesh_test::Wide;

namespace {

// A point in units of 1/256 px. Coordinates stay below 2^24 + 1, so the sums of products below fit 64 bits with room.
struct GridPoint {
    std::int64_t x, y;
    [[nodiscard]] Point point() const { return {static_cast<double>(x) / 256, static_cast<double>(y) / 256}; }
};

int sign(Wide x) { return x > 0 ? 1 : x < 0 ? -1 : 0; }

// The determinant as it is written in books: rows x, y, x^2 + y^2 of the differences to d.
int exact_in_circle(GridPoint a, GridPoint b, GridPoint c, GridPoint d) {
    Wide m[3][3];
    const GridPoint from[3] = {a, b, c};
    for (int k = 0; k < 3; ++k) {
        m[k][0] = from[k].x - d.x;
        m[k][1] = from[k].y - d.y;
        m[k][2] = m[k][0] * m[k][0] + m[k][1] * m[k][1];
    }
    return sign(m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]));
}

bool circle_differs(GridPoint a, GridPoint b, GridPoint c, GridPoint d) {
    return hmesh::kit::in_circle(a.point(), b.point(), c.point(), d.point()) != exact_in_circle(a, b, c, d);
}

std::int64_t below(Random& random, std::int64_t n) {
    return static_cast<std::int64_t>(random.below(static_cast<std::size_t>(n)));
}

}  // namespace

TEST_CASE("truncated drops the fraction, at whole numbers and one step beside them too") {
    Random random(5);
    for (int round = 0; round < 10000; ++round) {
        const auto whole = static_cast<double>(random.below(round % 2 == 0 ? 100 : 2147483648U));
        CHECK(hmesh::kit::truncated(whole) == static_cast<std::int64_t>(whole));
        if (whole < 2147483647) CHECK(hmesh::kit::truncated(std::nextafter(whole + 1, 0.0)) == static_cast<std::int64_t>(whole));
        CHECK(hmesh::kit::truncated(whole + 0.5) == static_cast<std::int64_t>(whole));
    }
}

TEST_CASE("snap goes to the nearest multiple of 1/256 px and keeps those that are") {
    Random random(5);
    for (int i = 0; i < 10000; ++i) {
        const double x = random.uniform() * 65536, snapped = hmesh::kit::snap(x);
        CHECK(std::abs(snapped - x) <= 1.0 / 512);
        CHECK(snapped * 256 == std::floor(snapped * 256));
        CHECK(hmesh::kit::snap(snapped) == snapped);
        CHECK(static_cast<double>(static_cast<float>(snapped)) == snapped);
    }
    CHECK(hmesh::kit::snap(Point{0.001, 65536}) == Point{0, 65536});
    CHECK(hmesh::kit::midpoint({1, 2}, {2, 5}) == Point{1.5, 3.5});
    CHECK(hmesh::kit::centroid({1, 2}, {2, 5}, {6, 8}) == Point{3, 5});
    CHECK(Point{1, 2} != Point{2, 1});
}

TEST_CASE("orient2d is exact on the 1/256 px grid, turns sign with the orientation, and is positive clockwise on the screen") {
    CHECK(hmesh::kit::orient2d(Point{0, 0}, {1, 0}, {0, 1}) == 1);
    Random random(6);
    const std::int64_t side = 1 << 24;
    int wrong = 0;
    for (int i = 0; i < 100000; ++i) {
        const auto draw = [&] { return GridPoint{below(random, side), below(random, side)}; };
        const GridPoint a = draw(), b = draw(), c = draw();
        // Twice in three trials d is near the line from a to b.
        const GridPoint d =
            i % 3 == 0 ? c : GridPoint{(a.x + b.x) / 2 + below(random, 3) - 1, (a.y + b.y) / 2 + below(random, 3) - 1};
        const std::int64_t exact = (b.x - a.x) * (d.y - a.y) - (d.x - a.x) * (b.y - a.y);
        wrong += hmesh::kit::orient2d(a.point(), b.point(), d.point()) != static_cast<double>(exact) / 65536;
        wrong += hmesh::kit::orient2d(b.point(), a.point(), d.point()) != -static_cast<double>(exact) / 65536;
    }
    CHECK(wrong == 0);
}

TEST_CASE("in_circle is 1 inside, 0 on the circle, -1 outside") {
    CHECK(hmesh::kit::in_circle({0, 0}, {2, 0}, {2, 2}, {1, 1}) == 1);
    CHECK(hmesh::kit::in_circle({0, 0}, {2, 0}, {2, 2}, {0, 2}) == 0);
    CHECK(hmesh::kit::in_circle({0, 0}, {2, 0}, {2, 2}, {0, 3}) == -1);
    CHECK(hmesh::kit::in_circle({0, 0}, {65536, 0}, {65536, 65536}, {0, 65536}) == 0);
    CHECK(hmesh::kit::in_circle({0, 0}, {65536, 0}, {65536, 65536}, {1.0 / 256, 65536}) == 1);
    CHECK(hmesh::kit::in_circle({0, 0}, {65536, 0}, {65536, 65536}, {0, 65536 - 1.0 / 256}) == 1);
    CHECK(hmesh::kit::in_circle({0, 0}, {65536, 0}, {65536, 65536 - 1.0 / 256}, {0, 65536}) == -1);
}

TEST_CASE("in_circle is exact for random points of the 1/256 px grid, up to 65536 px apart") {
    Random random(7);
    int wrong = 0, found[3] = {};
    for (int i = 0; i < 200000; ++i) {
        const std::int64_t side = (std::int64_t{1} << random.below(25)) + 1, room = (1 << 24) + 2 - side;
        const std::int64_t left = below(random, room), top = below(random, room);
        const std::int64_t step = i % 2 == 0 ? 1 : std::max<std::int64_t>(1, side / 8);  // coarse: many on a circle
        GridPoint p[4];
        for (GridPoint& q : p) q = {left + below(random, side) / step * step, top + below(random, side) / step * step};
        const int exact = exact_in_circle(p[0], p[1], p[2], p[3]);
        ++found[exact + 1];
        wrong += circle_differs(p[0], p[1], p[2], p[3]);
    }
    CHECK(wrong == 0);
    for (const int count : found) CHECK(count > 20000);
}

TEST_CASE("in_circle is exact for points on a circle of the 1/256 px grid, and for points one step away from it") {
    Random random(8);
    int wrong = 0, found[3] = {};
    for (int i = 0; i < 100000; ++i) {
        // (u^2 - v^2, 2 u v) has the radius u^2 + v^2; so have its mirror images, and those of other (u, v) once each
        // is scaled by the other's radius.
        const std::int64_t largest = std::int64_t{1} << random.below(6);
        std::int64_t x[2], y[2], radius[2];
        for (int k = 0; k < 2; ++k) {
            const std::int64_t u = 1 + below(random, largest), v = below(random, u + 1);
            x[k] = u * u - v * v, y[k] = 2 * u * v, radius[k] = u * u + v * v;
        }
        const std::int64_t full = radius[0] * radius[1];
        std::int64_t scale = std::max<std::int64_t>(1, (std::int64_t{1} << (3 + random.below(21))) / full);
        if (full * scale > (1 << 23)) continue;
        GridPoint p[4];
        const std::int64_t room = (1 << 24) + 1 - 2 * full * scale;
        const std::int64_t cx = full * scale + below(random, room), cy = full * scale + below(random, room);
        for (GridPoint& q : p) {
            const std::size_t k = random.below(2);
            q = {x[k] * radius[1 - k] * scale, y[k] * radius[1 - k] * scale};
            if (random.below(2) == 0) std::swap(q.x, q.y);
            if (random.below(2) == 0) q.x = -q.x;
            if (random.below(2) == 0) q.y = -q.y;
            q.x += cx, q.y += cy;
        }
        REQUIRE(exact_in_circle(p[0], p[1], p[2], p[3]) == 0);
        wrong += circle_differs(p[0], p[1], p[2], p[3]);
        const std::int64_t most = 1 << 24;
        GridPoint& moved = p[random.below(4)];
        moved.x = std::min(most, std::max<std::int64_t>(0, moved.x + below(random, 3) - 1));
        moved.y = std::min(most, std::max<std::int64_t>(0, moved.y + below(random, 3) - 1));
        ++found[exact_in_circle(p[0], p[1], p[2], p[3]) + 1];
        wrong += circle_differs(p[0], p[1], p[2], p[3]);
    }
    CHECK(wrong == 0);
    for (const int count : found) CHECK(count > 10000);
}

TEST_CASE("the sign of a sum of three products is exact up to 2^51, where the sum is 0 or 1 as well") {
    Random random(9);
    const auto draw = [&](int bits) {
        const std::uint64_t word = (std::uint64_t{random.next()} << 32U) | random.next();
        const auto magnitude = static_cast<std::int64_t>(word >> static_cast<unsigned>(64 - bits));
        return random.below(2) == 0 ? magnitude : -magnitude;
    };
    int wrong = 0;
    for (int i = 0; i < 200000; ++i) {
        const int bits = 1 + static_cast<int>(random.below(51));
        std::int64_t a[3] = {draw(bits), draw(bits), draw(bits)}, b[3] = {draw(bits), draw(bits), draw(bits)};
        if (i % 3 == 1) a[1] = -b[0], b[1] = a[0], a[2] = random.below(3) == 0 ? 0 : 1, b[2] = draw(1);
        if (i % 3 == 2) a[2] = a[1] = a[0], b[2] = -(b[0] / 2), b[0] /= 2, b[1] = below(random, 3) - 1;
        Wide sum = 0;
        for (int k = 0; k < 3; ++k) sum += Wide{a[k]} * Wide{b[k]};
        wrong += hmesh::kit::detail::sign_of_products(a, b) != sign(sum);
    }
    CHECK(wrong == 0);
}

TEST_CASE("barycentric coordinates sum to 1, make their point, and are 1, 0, 0 in a corner") {
    Random random(10);
    for (int i = 0; i < 2000; ++i) {
        const auto draw = [&] { return Point{random.uniform() * 100, random.uniform() * 100}; };
        const Point a = draw(), b = draw(), c = draw(), p = draw();
        const double area = hmesh::kit::orient2d(a, b, c);
        if (std::abs(area) < 1) continue;
        const hmesh::kit::Barycentric w = hmesh::kit::barycentric(a, b, c, p);
        CHECK(w.a + w.b + w.c == doctest::Approx(1));
        CHECK(std::abs(w.a * a.x + w.b * b.x + w.c * c.x - p.x) < 1e-8);
        CHECK(std::abs(w.a * a.y + w.b * b.y + w.c * c.y - p.y) < 1e-8);
        const bool inside = hmesh::kit::orient2d(a, b, p) / area > 0 && hmesh::kit::orient2d(b, c, p) / area > 0 &&
                            hmesh::kit::orient2d(c, a, p) / area > 0;
        CHECK(inside == (w.a > 0 && w.b > 0 && w.c > 0));
        // On the grid, where no product rounds, hence none that is contracted with a sum either.
        const Point corner_a = hmesh::kit::snap(a), corner_b = hmesh::kit::snap(b), corner_c = hmesh::kit::snap(c);
        const hmesh::kit::Barycentric at_b = hmesh::kit::barycentric(corner_a, corner_b, corner_c, corner_b);
        CHECK((at_b.a == 0 && at_b.b == 1 && at_b.c == 0));
    }
}
