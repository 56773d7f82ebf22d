#include "hmesh/fit/raster.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "hmesh/core/random.hpp"

using hmesh::kit::Barycentric;
using hmesh::kit::ClipRect;
using hmesh::kit::EdgeWalker;
using hmesh::kit::first_row;
using hmesh::kit::Point;
using hmesh::kit::Random;

namespace {

// A point in units of 1/256 px. Coordinates stay below 2^24 + 1, so the sums of products below fit 64 bits with room.
struct GridPoint {
    std::int64_t x, y;
    [[nodiscard]] Point point() const { return {static_cast<double>(x) / 256, static_cast<double>(y) / 256}; }
};

std::int64_t orient2d(const GridPoint& a, const GridPoint& b, const GridPoint& p) {
    return (b.x - a.x) * (p.y - a.y) - (p.x - a.x) * (b.y - a.y);
}

// The top-left rule by the signs of the centre's distances to the edges.
bool owns(GridPoint a, GridPoint b, GridPoint c, int i, int j) {
    if (orient2d(a, b, c) < 0) std::swap(b, c);
    if (orient2d(a, b, c) == 0) return false;
    const GridPoint center{256 * std::int64_t{i} + 128, 256 * std::int64_t{j} + 128};
    const auto inside = [&](const GridPoint& from, const GridPoint& to) {
        const std::int64_t side = orient2d(from, to, center);
        const bool is_top = from.y == to.y && to.x > from.x, is_left = to.y < from.y;
        return side > 0 || (side == 0 && (is_top || is_left));
    };
    return inside(a, b) && inside(b, c) && inside(c, a);
}

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
    const EdgeWalker edge(a.point(), b.point());
    return edge.column(static_cast<int>(j)) == exact_column(a, b, j);
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
        wrong += first_row(static_cast<double>(y) / 256) != exact_row(y);
        const std::int64_t far = (std::int64_t{1} << 24) - y;
        wrong += first_row(static_cast<double>(far) / 256) != exact_row(far);
    }
    Random random(1);
    for (int i = 0; i < 100000; ++i) {
        const std::int64_t y = below(random, (1 << 24) + 1);
        wrong += first_row(static_cast<double>(y) / 256) != exact_row(y);
    }
    CHECK(wrong == 0);
    CHECK(first_row(0) == 0);
    CHECK(first_row(0.5) == 0);
    CHECK(first_row(0.50390625) == 1);
    CHECK(first_row(65536) == 65536);
}

TEST_CASE("first_row never falls as y grows, off the grid too, and takes centres for on y that are 2^-33 px above it at most") {
    int falls = 0;
    for (const double center : {0.5, 1.5, 100.5, 4095.5, 65535.5}) {
        double y = center;
        for (int i = 0; i < 20; ++i) y = std::nextafter(y, 0.0);
        int last = first_row(y);
        CHECK(last == static_cast<int>(center));
        for (int i = 0; i < 40; ++i) {
            y = std::nextafter(y, 1e9);
            falls += first_row(y) < last;
            last = first_row(y);
        }
        const double slack = std::ldexp(1.0, -33);
        last = first_row(center);
        for (const double above : {0.5, 0.75, 1.25, 2.0}) {
            falls += first_row(center + above * slack) < last;
            last = first_row(center + above * slack);
            CHECK(last == static_cast<int>(center) + (above > 1 ? 1 : 0));
        }
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
        const EdgeWalker edge(a.point(), b.point());
        for (std::int64_t k = 0; k < n; ++k) wrong += edge.column(static_cast<int>(a.y / 256 + k * dy)) != a.x / 256 + k * dx;
        for (std::int64_t j = exact_row(a.y); j < exact_row(b.y); ++j) wrong += !columns_agree(a, b, j);
    }
    CHECK(wrong == 0);
}

TEST_CASE("EdgeWalker::column stays within the image for edges on its sides") {
    for (const double width : {1.0, 255.0, 65536.0}) {
        CHECK(EdgeWalker({0, 0}, {0, 1000}).column(500) == 0);
        CHECK(EdgeWalker({width, 0}, {width, 1000}).column(500) == static_cast<int>(width));
        CHECK(EdgeWalker({0, 0}, {width, 65536}).column(0) == exact_column({0, 0}, {static_cast<int>(width) * 256, 1 << 24}, 0));
        CHECK(EdgeWalker({width, 0}, {0, 65536}).column(65535) <= static_cast<int>(width));
    }
}

TEST_CASE("the spans of a face are the pixels that it owns by the top-left rule, clipped or not") {
    Random random(5);
    constexpr int width = 24, height = 20;
    int wrong = 0, owned = 0;
    for (int round = 0; round < 3000; ++round) {
        // Multiples of half a pixel put many centres on edges. Some corners lie outside of what is seen.
        const int step = round % 3 == 0 ? 128 : 1, beyond = round % 2 == 0 ? 0 : 10;
        const auto draw = [&](int size) {
            const auto places = static_cast<std::size_t>((size + 2 * beyond) * 256 / step + 1);
            return static_cast<std::int64_t>(random.below(places)) * step - 256 * beyond;
        };
        GridPoint corners[3];
        for (GridPoint& corner : corners) corner = {draw(width), draw(height)};
        const ClipRect clips[] = {{width, 0, height}, {width / 2, 3, 11}, {}};
        for (const ClipRect& clip : clips) {
            if (beyond != 0 && clip.width > width) continue;
            const int last = clip.last < height ? clip.last : height, columns = clip.width < width ? clip.width : width;
            std::vector<int> visits(width * height, 0);
            int row = -1;
            hmesh::kit::for_each_span(
                corners[0].point(), corners[1].point(), corners[2].point(), clip, [&](int j, int begin, int end) {
                    wrong += j <= row || begin >= end || begin < 0 || end > columns || j < clip.first || j >= last;
                    row = j;
                    for (int i = begin; i < end && i < width && j < height; ++i)
                        ++visits[static_cast<std::size_t>(j * width + i)];
                });
            for (int j = clip.first; j < last; ++j)
                for (int i = 0; i < columns; ++i) {
                    const int expected = owns(corners[0], corners[1], corners[2], i, j) ? 1 : 0;
                    wrong += visits[static_cast<std::size_t>(j * width + i)] != expected;
                    owned += expected;
                }
        }
    }
    CHECK(wrong == 0);
    CHECK(owned > 100000);
}

TEST_CASE("PixelBarycentric are the barycentric coordinates of pixel centres, held to [0, 1], for faces of either orientation") {
    const Point a{2.25, 1.5}, b{17.0, 4.75}, c{6.5, 19.0};
    for (const bool turned : {false, true}) {
        const Point second = turned ? c : b, third = turned ? b : c;
        const hmesh::kit::PixelBarycentric weights(a, second, third);
        int inside = 0;
        for (int j = 0; j < 20; ++j)
            for (int i = 0; i < 20; ++i) {
                const Barycentric w = weights(i, j), exact = hmesh::kit::barycentric(a, second, third, {i + 0.5, j + 0.5});
                CHECK(w.a + w.b + w.c == doctest::Approx(1));
                CHECK((w.a >= 0 && w.b >= 0 && w.c >= 0 && w.b <= 1 && w.c <= 1));
                if (exact.a < 0 || exact.b < 0 || exact.c < 0) continue;
                ++inside;
                CHECK(w.b == doctest::Approx(exact.b));
                CHECK(w.c == doctest::Approx(exact.c));
            }
        CHECK(inside > 80);
    }
    const Barycentric nowhere = hmesh::kit::PixelBarycentric(a, b, b)(9, 9);
    CHECK((nowhere.a == 1 && nowhere.b == 0 && nowhere.c == 0));
}
