#include "hmesh/io/compact/triangulation.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "hmesh/core/random.hpp"
#include "hmesh/io/compact/faces.hpp"
#include "hmesh/io/compact/flips.hpp"
#include "hmesh/io/compact/plane.hpp"

using hmesh::detail::GridPoint;
using hmesh::detail::Triangulation;

namespace {

// Twice the determinant of the circle test by 128 bits, or in doubles where there are none: of small coordinates exact.
int in_circle_by_rows(GridPoint a, GridPoint b, GridPoint c, GridPoint d) {
    const auto row = [&](GridPoint p) {
        const long double x = p.x - d.x, y = p.y - d.y;
        return std::array<long double, 3>{x, y, x * x + y * y};
    };
    const auto r = row(a), s = row(b), t = row(c);
    const long double det =
        r[0] * (s[1] * t[2] - s[2] * t[1]) - r[1] * (s[0] * t[2] - s[2] * t[0]) + r[2] * (s[0] * t[1] - s[1] * t[0]);
    return det > 0 ? 1 : det < 0 ? -1 : 0;
}

std::vector<GridPoint> random_points(std::int32_t width, std::int32_t height, std::size_t count, std::uint64_t seed) {
    hmesh::kit::Random random(seed);
    std::set<std::pair<std::int32_t, std::int32_t>> seen{{0, 0}, {width, 0}, {width, height}, {0, height}};
    std::vector<GridPoint> points{{0, 0}, {width, 0}, {width, height}, {0, height}};
    for (std::size_t k = 0; k < count; ++k) {
        const auto x = static_cast<std::int32_t>(random.below(static_cast<std::size_t>(width) + 1));
        const auto y = static_cast<std::int32_t>(random.below(static_cast<std::size_t>(height) + 1));
        if (seen.insert({x, y}).second) points.push_back({x, y});
    }
    return points;
}

}  // namespace

TEST_CASE("no point lies in a circle, and of those on one the first is joined to all") {
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        // Few places: many circles of four points and more.
        const std::int32_t width = seed % 3 == 0 ? 6 : 40, height = seed % 4 == 0 ? 5 : 30;
        const std::vector<GridPoint> points = random_points(width, height, seed % 2 == 0 ? 60 : 25, seed);
        const Triangulation mesh(points);
        std::int64_t area = 0;
        for (const hmesh::Triangle& face : all_faces(mesh)) {
            const GridPoint a = points[face[0]], b = points[face[1]], c = points[face[2]];
            CHECK(orient2d(a, b, c) > 0);
            area += orient2d(a, b, c);
            for (std::uint32_t v = 0; v < points.size(); ++v) {
                if (v == face[0] || v == face[1] || v == face[2]) continue;
                const int place = in_circle_by_rows(a, b, c, points[v]);
                CHECK(place <= 0);
                // Each face of a circle has its first point as a corner.
                if (place == 0) CHECK(v > face[0]);
            }
        }
        CHECK(area == std::int64_t{2} * width * height);
    }
}

TEST_CASE("circles are told exactly at any size") {
    const std::int32_t far = 1 << 24;
    CHECK(hmesh::detail::in_circle_sign({0, 0}, {far, 0}, {far, far}, {0, far}) == 0);
    CHECK(hmesh::detail::in_circle_sign({0, 0}, {far, 0}, {far, far}, {1, far}) == 1);
    CHECK(hmesh::detail::in_circle_sign({0, 0}, {far, 0}, {far, far}, {-1, far}) == -1);
    CHECK(hmesh::detail::in_circle_sign({0, 0}, {far, 0}, {far - 1, far}, {0, far}) == -1);
    hmesh::kit::Random random(6);
    for (int k = 0; k < 2000; ++k) {
        std::array<GridPoint, 4> p{};
        for (GridPoint& q : p) q = {static_cast<std::int32_t>(random.below(99)), static_cast<std::int32_t>(random.below(99))};
        if (orient2d(p[0], p[1], p[2]) <= 0) continue;
        CHECK(hmesh::detail::in_circle_sign(p[0], p[1], p[2], p[3]) == in_circle_by_rows(p[0], p[1], p[2], p[3]));
    }
}

TEST_CASE("angles are 64ths of a half turn") {
    using hmesh::detail::angle64;
    CHECK(angle64({0, 0}, {10, 0}, {0, 10}) == 31);
    CHECK(angle64({0, 0}, {10, 0}, {10, 10}) == 15);
    CHECK(angle64({0, 0}, {10, 0}, {-10, 10}) == 48);
    CHECK(angle64({0, 0}, {10, 0}, {-10, 9}) == 49);
    CHECK(angle64({0, 0}, {1 << 24, 0}, {1 << 24, 1}) == 0);
    CHECK(angle64({0, 0}, {1 << 24, 0}, {-(1 << 24), 1}) == 63);
}

TEST_CASE("edges that are inserted are there, and the flips told lead to them") {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const std::vector<GridPoint> points = random_points(50, 40, 40, seed);
        // The edges of another triangulation: of the same points seen from aside.
        std::vector<GridPoint> sheared;
        for (const GridPoint p : points) sheared.push_back({5 * p.x, p.y});
        const Triangulation other(sheared);
        const std::vector<hmesh::Triangle> wanted = all_faces(other);
        std::vector<std::array<std::uint32_t, 2>> edges;
        for (const hmesh::Triangle& face : wanted)
            for (std::size_t k = 0; k < 3; ++k) edges.push_back({face[k], face[(k + 1) % 3]});
        Triangulation mesh(points);
        hmesh::detail::FlipFinder finder(mesh);
        REQUIRE(finder.insert(edges));
        CHECK(all_faces(mesh) == wanted);

        const hmesh::detail::Logistic logistic;
        std::vector<std::uint8_t> bytes;
        hmesh::detail::ArithmeticCoder to(bytes);
        Triangulation again(points);
        REQUIRE(hmesh::detail::FlipCoder(to, logistic).code(again, finder.flips()));
        to.finish();
        CHECK(all_faces(again) == wanted);
        hmesh::detail::ArithmeticCoder from(bytes.data(), bytes.size());
        Triangulation read(points);
        REQUIRE(hmesh::detail::FlipCoder(from, logistic).code(read, {}));
        CHECK(all_faces(read) == wanted);
    }
}

TEST_CASE("edges that take the place of others undo flips, and those left lead to what there is") {
    const hmesh::detail::Logistic logistic;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const std::vector<GridPoint> points = random_points(50, 40, 8, seed);
        hmesh::kit::Random random(seed);
        Triangulation mesh(points), again(points);
        hmesh::detail::FlipFinder finder(mesh);
        for (int k = 0; k < 40; ++k) {
            const auto a = static_cast<std::uint32_t>(random.below(points.size()));
            const auto b = static_cast<std::uint32_t>(random.below(points.size()));
            if (a != b) (void)finder.insert(std::vector<std::array<std::uint32_t, 2>>(1, {a, b}));
        }
        std::vector<std::uint8_t> bytes;
        hmesh::detail::ArithmeticCoder to(bytes);
        REQUIRE(hmesh::detail::FlipCoder(to, logistic).code(again, finder.flips()));
        CHECK(all_faces(again) == all_faces(mesh));
    }
}

TEST_CASE("edges that lead over a point are refused") {
    const std::vector<GridPoint> points{{0, 0}, {8, 0}, {8, 8}, {0, 8}, {4, 4}};
    for (const std::array<std::uint32_t, 2> over : {std::array<std::uint32_t, 2>{0, 2}, {1, 3}}) {
        Triangulation mesh(points);
        CHECK(!hmesh::detail::FlipFinder(mesh).insert(std::vector<std::array<std::uint32_t, 2>>(1, over)));
    }
}

TEST_CASE("more flips than most_flips() are neither found nor coded") {
    const hmesh::detail::Logistic logistic;
    // Two chains that bend towards each other, and fans of one point of each between them: see compact_test.
    constexpr std::int32_t n = 400;
    std::vector<GridPoint> points{{0, 0}, {n + 1, 0}, {n + 1, 2 * n * n}, {0, 2 * n * n}};
    for (const std::int32_t side : {-1, 1})
        for (std::int32_t k = -n / 2; k < n / 2; ++k) points.push_back({1 + k + n / 2, n * n + side * (n * n / 2 + k * k)});
    std::vector<std::array<std::uint32_t, 2>> edges;
    for (std::uint32_t k = 0; k < n; ++k) {
        edges.push_back({4 + k, 4 + n});
        edges.push_back({3 + n, 4 + n + k});
    }
    Triangulation mesh(points), again(points);
    hmesh::detail::FlipFinder finder(mesh);
    CHECK(!finder.insert(edges));
    CHECK(finder.flips().size() > hmesh::detail::FlipCoder::most_flips(points.size()));
    std::vector<std::uint8_t> bytes;
    hmesh::detail::ArithmeticCoder to(bytes);
    CHECK(!hmesh::detail::FlipCoder(to, logistic).code(again, finder.flips()));
}
