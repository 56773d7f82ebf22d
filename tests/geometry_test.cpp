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

std::int64_t ceil_of(std::int64_t numerator, std::int64_t denominator) {
    return numerator / denominator + (numerator % denominator > 0);
}

// The first row whose centre 256 j + 128 is not above y.
std::int64_t exact_row(std::int64_t y) { return ceil_of(y - 128, 256); }

// By how much the edge from a down to b is right of the left margin's centres in row j, times 256 (b.y - a.y).
std::int64_t crossing(GridPoint a, GridPoint b, std::int64_t j) {
    return (a.x - 128) * (b.y - a.y) + (256 * j + 128 - a.y) * (b.x - a.x);
}

// The first pixel whose centre 256 i + 128 is not left of the edge from a down to b, in row j.
std::int64_t exact_column(GridPoint a, GridPoint b, std::int64_t j) { return ceil_of(crossing(a, b, j), 256 * (b.y - a.y)); }

bool columns_agree(GridPoint a, GridPoint b, std::int64_t j) {
    const hmesh::kit::EdgeWalker edge(a.point(), b.point());
    return edge.column(static_cast<int>(j)) == exact_column(a, b, j);
}

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

// The number t in [0, modulus) with a t = 1 modulo `modulus`, or 0 if there is none.
std::int64_t inverse(std::int64_t a, std::int64_t modulus) {
    std::int64_t r0 = modulus, r1 = ((a % modulus) + modulus) % modulus, t0 = 0, t1 = 1;
    while (r1 != 0) {
        const std::int64_t q = r0 / r1;
        r0 = std::exchange(r1, r0 - q * r1);
        t0 = std::exchange(t1, t0 - q * t1);
    }
    return r0 == 1 ? ((t0 % modulus) + modulus) % modulus : 0;
}

}  // namespace

TEST_CASE("first_row is exact on the 1/256 px grid up to 65536 px") {
    int wrong = 0;
    for (std::int64_t y = 0; y <= 3000; ++y) {
        wrong += hmesh::kit::first_row(static_cast<double>(y) / 256) != exact_row(y);
        const std::int64_t far = (std::int64_t{1} << 24) - y;
        wrong += hmesh::kit::first_row(static_cast<double>(far) / 256) != exact_row(far);
    }
    Random random(1);
    for (int i = 0; i < 100000; ++i) {
        const std::int64_t y = below(random, (1 << 24) + 1);
        wrong += hmesh::kit::first_row(static_cast<double>(y) / 256) != exact_row(y);
    }
    CHECK(wrong == 0);
    CHECK(hmesh::kit::first_row(0) == 0);
    CHECK(hmesh::kit::first_row(0.5) == 0);
    CHECK(hmesh::kit::first_row(0.50390625) == 1);
    CHECK(hmesh::kit::first_row(65536) == 65536);
}

TEST_CASE("first_row never falls as y grows, off the grid too") {
    int falls = 0;
    for (const double center : {0.5, 1.5, 100.5, 4095.5, 65535.5}) {
        double y = center;
        for (int i = 0; i < 20; ++i) y = std::nextafter(y, 0.0);
        int last = hmesh::kit::first_row(y);
        CHECK(last == static_cast<int>(center));
        for (int i = 0; i < 40; ++i) {
            y = std::nextafter(y, 1e9);
            falls += hmesh::kit::first_row(y) < last;
            last = hmesh::kit::first_row(y);
        }
        CHECK(last == static_cast<int>(center) + 1);
    }
    CHECK(falls == 0);
}

TEST_CASE("EdgeWalker::column is exact for random edges of the 1/256 px grid, from the shortest to 65536 px") {
    Random random(2);
    int tried = 0, wrong = 0;
    for (int i = 0; i < 400000; ++i) {
        const std::int64_t side = std::int64_t{1} << (6 + random.below(19));  // 1/4 px to 65536 px
        GridPoint a{below(random, side + 1), below(random, side + 1)}, b{below(random, side + 1), below(random, side + 1)};
        const std::int64_t room = (1 << 24) - side, dx = below(random, room + 1), dy = below(random, room + 1);
        a.x += dx, b.x += dx, a.y += dy, b.y += dy;
        if (b.y < a.y) std::swap(a, b);
        const std::int64_t first = exact_row(a.y), last = exact_row(b.y);
        if (first >= last) continue;
        for (const std::int64_t j : {first, last - 1, first + below(random, last - first)}) {
            ++tried;
            wrong += !columns_agree(a, b, j);
        }
    }
    CHECK(wrong == 0);
    CHECK(tried > 500000);
}

TEST_CASE("EdgeWalker::column is exact where the edge passes a centre as closely as the grid allows, or through it") {
    // Solves crossing = offset modulo 256 (b.y - a.y) for offset -1, 0, 1: the edge passes at 2^-32 px at the least.
    Random random(3);
    int found[3] = {}, wrong = 0;
    for (int i = 0; i < 400000; ++i) {
        const std::int64_t side = std::int64_t{1} << (8 + random.below(17));
        const std::int64_t height = side - below(random, std::min<std::int64_t>(side / 2, 1000));
        std::int64_t slant = side - below(random, std::min<std::int64_t>(side, random.below(2) == 0 ? 1000 : side));
        if (random.below(2) == 0) slant = -slant;
        const std::int64_t offset = below(random, 3) - 1;
        // t = 256 j + 128 - a.y, the depth of the row under a. Without a coprime slant only vertices are centres.
        std::int64_t depth = 0;
        if (offset != 0) {
            depth = inverse(slant, height) * (offset > 0 ? 1 : height - 1) % height;
            if (depth == 0) continue;
        }
        const std::int64_t turns = (depth * slant - offset) / height;  // depth * slant = offset + turns * height
        REQUIRE(turns * height + offset == depth * slant);
        GridPoint a{((128 - turns) % 256 + 256) % 256, ((128 - depth) % 256 + 256) % 256};
        const std::int64_t most = 1 << 24;
        if (slant < 0) a.x += (-slant + 255) / 256 * 256;
        // As far from the origin as there is room, where floating point is coarsest.
        const std::int64_t right = std::max(a.x, a.x + slant), bottom = a.y + height;
        if (right > most || bottom > most) continue;
        if (random.below(2) == 0) {
            a.x += (most - right) / 256 * 256;
            a.y += (most - bottom) / 256 * 256;
        }
        const GridPoint b{a.x + slant, a.y + height};
        const std::int64_t j = (a.y + depth - 128) / 256;
        if (j < exact_row(a.y) || j >= exact_row(b.y)) continue;
        const std::int64_t period = 256 * height;
        REQUIRE((crossing(a, b, j) - offset) % period == 0);
        ++found[offset + 1];
        wrong += !columns_agree(a, b, j);
    }
    CHECK(wrong == 0);
    for (const int count : found) CHECK(count > 20000);
}

TEST_CASE("EdgeWalker::column: a centre on the edge lies to its right, in every row of slanted lines through centres") {
    Random random(4);
    int wrong = 0;
    for (int i = 0; i < 3000; ++i) {
        // From centre to centre by whole pixels (dx, dy), n times: the edge meets a centre every dy rows.
        const std::int64_t dx = below(random, 41) - 20, dy = 1 + below(random, 20), n = 1 + below(random, 12);
        const GridPoint a{256 * (300 + below(random, 65000)) + 128, 256 * below(random, 65000) + 128};
        const GridPoint b{a.x + 256 * dx * n, a.y + 256 * dy * n};
        if (b.x > (1 << 24) || b.y > (1 << 24)) continue;
        const hmesh::kit::EdgeWalker edge(a.point(), b.point());
        for (std::int64_t k = 0; k < n; ++k) wrong += edge.column(static_cast<int>(a.y / 256 + k * dy)) != a.x / 256 + k * dx;
        for (std::int64_t j = exact_row(a.y); j < exact_row(b.y); ++j) wrong += !columns_agree(a, b, j);
    }
    CHECK(wrong == 0);
}

TEST_CASE("EdgeWalker::column stays within the image for edges on its sides") {
    for (const double width : {1.0, 255.0, 65536.0}) {
        CHECK(hmesh::kit::EdgeWalker({0, 0}, {0, 1000}).column(500) == 0);
        CHECK(hmesh::kit::EdgeWalker({width, 0}, {width, 1000}).column(500) == static_cast<int>(width));
        CHECK(hmesh::kit::EdgeWalker({0, 0}, {width, 65536}).column(0) ==
              exact_column({0, 0}, {static_cast<int>(width) * 256, 1 << 24}, 0));
        CHECK(hmesh::kit::EdgeWalker({width, 0}, {0, 65536}).column(65535) <= static_cast<int>(width));
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
    CHECK(Point{1, 2} != Point{2, 1});
}

TEST_CASE("cross is exact on the 1/256 px grid, turns sign with the orientation, and is positive clockwise on the screen") {
    CHECK(hmesh::kit::orient2d({0, 0}, {1, 0}, {0, 1}) == 1);
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

TEST_CASE("the sign of a sum of three products is exact up to 2^50, where the sum is 0 or 1 as well") {
    Random random(9);
    const auto draw = [&](int bits) {
        const std::uint64_t word = (std::uint64_t{random.next()} << 32U) | random.next();
        const auto magnitude = static_cast<std::int64_t>(word >> static_cast<unsigned>(64 - bits));
        return random.below(2) == 0 ? magnitude : -magnitude;
    };
    int wrong = 0;
    for (int i = 0; i < 200000; ++i) {
        const int bits = 1 + static_cast<int>(random.below(50));
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
        const bool inside =
            hmesh::kit::orient2d(a, b, p) / area > 0 && hmesh::kit::orient2d(b, c, p) / area > 0 && hmesh::kit::orient2d(c, a, p) / area > 0;
        CHECK(inside == (w.a > 0 && w.b > 0 && w.c > 0));
        // On the grid, where no product rounds, hence none that is contracted with a sum either.
        const Point corner_a = hmesh::kit::snap(a), corner_b = hmesh::kit::snap(b), corner_c = hmesh::kit::snap(c);
        const hmesh::kit::Barycentric at_b = hmesh::kit::barycentric(corner_a, corner_b, corner_c, corner_b);
        CHECK((at_b.a == 0 && at_b.b == 1 && at_b.c == 0));
    }
}

TEST_CASE("PixelBarycentric are the barycentric coordinates of pixel centres, held to [0, 1], for faces of either orientation") {
    const hmesh::kit::Point a{2.25, 1.5}, b{17.0, 4.75}, c{6.5, 19.0};
    for (const bool turned : {false, true}) {
        const hmesh::kit::Point second = turned ? c : b, third = turned ? b : c;
        const hmesh::kit::PixelBarycentric weights(a, second, third);
        int inside = 0;
        for (int j = 0; j < 20; ++j)
            for (int i = 0; i < 20; ++i) {
                const hmesh::kit::Barycentric w = weights(i, j), exact = hmesh::kit::barycentric(a, second, third, {i + 0.5, j + 0.5});
                CHECK(w.a + w.b + w.c == doctest::Approx(1));
                CHECK((w.a >= 0 && w.b >= 0 && w.c >= 0 && w.b <= 1 && w.c <= 1));
                if (exact.a < 0 || exact.b < 0 || exact.c < 0) continue;
                ++inside;
                CHECK(w.b == doctest::Approx(exact.b));
                CHECK(w.c == doctest::Approx(exact.c));
            }
        CHECK(inside > 80);
    }
    const hmesh::kit::Barycentric nowhere = hmesh::kit::PixelBarycentric(a, b, b)(9, 9);
    CHECK((nowhere.a == 1 && nowhere.b == 0 && nowhere.c == 0));
}
