#include "hmesh/methods/baselines/error_diffusion.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "hmesh/core/random.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/mesh/geometry.hpp"
#include "hmesh/tiles/delaunay_mesh.hpp"
#include "test_images.hpp"

using hmesh::Image;
using hmesh::kit::diffused_points;

namespace {

const auto always = [] { return true; };

template <class Value>
Image<float, 1> map_of(int width, int height, Value&& value) {
    Image<float, 1> map(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) *map.pixel(x, y) = static_cast<float>(value(x, y));
    return map;
}
Image<float, 1> even(int width, int height) {
    return map_of(width, height, [](int, int) { return 1; });
}

// Points in turn, by errors that are kept for the whole image and handed on one by one.
std::vector<std::uint32_t> naive_points(const Image<float, 1>& map, double factor, double floor) {
    const bool flat = map.width() > 8 * map.height();
    const int width = flat ? map.height() : map.width(), height = flat ? map.width() : map.height();
    const std::vector<double> none(static_cast<std::size_t>(width), 0.0);
    std::vector<std::vector<double>> errors(static_cast<std::size_t>(height), none);
    std::vector<std::uint32_t> points;
    for (int y = 0; y < height; ++y) {
        const bool right = y % 2 == 0;
        for (int k = 0; k < width; ++k) {
            const int x = right ? k : width - 1 - k, ahead = right ? x + 1 : x - 1, behind = right ? x - 1 : x + 1;
            const auto at = [&](int i, int j) {
                return static_cast<std::size_t>(flat ? i * map.width() + j : j * map.width() + i);
            };
            const double density = std::min(1.0, factor * (static_cast<double>(map.data()[at(x, y)]) + floor));
            double error = density + errors[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)];
            if (error >= 0.5) {
                points.push_back(static_cast<std::uint32_t>(at(x, y)));
                error -= 1;
            }
            const auto hand = [&](int to_x, int to_y, double share) {
                if (to_x < 0 || to_x >= width) to_x = x, to_y = y + 1;
                if (to_y < height) errors[static_cast<std::size_t>(to_y)][static_cast<std::size_t>(to_x)] += share / 16 * error;
            };
            hand(ahead, y, 7);
            hand(behind, y + 1, 3);
            hand(x, y + 1, 5);
            hand(ahead, y + 1, 1);
        }
    }
    return points;
}

// Points that are pixels, each once, row after row there and back (or so by columns).
void check_points(const Image<float, 1>& map, const std::vector<std::uint32_t>& points) {
    const bool flat = map.width() > 8 * map.height();
    const auto width = static_cast<std::uint32_t>(map.width()), height = static_cast<std::uint32_t>(map.height());
    std::uint32_t last = 0;
    bool ordered = true;
    for (std::size_t k = 0; k < points.size(); ++k) {
        const std::uint32_t x = flat ? points[k] / width : points[k] % width, y = flat ? points[k] % width : points[k] / width;
        const std::uint32_t row = flat ? height : width, place = y * row + (y % 2 == 0 ? x : row - 1 - x);
        ordered = ordered && points[k] < width * height && (k == 0 || place > last);
        last = place;
    }
    CHECK(ordered);
}

std::vector<std::uint32_t> points_of(const Image<float, 1>& map, std::size_t count) {
    const std::vector<std::uint32_t> points = diffused_points(map.view(), count, always);
    check_points(map, points);
    CHECK(points.size() >= count);
    return points;
}

// The share of the points whose pixel is one of these.
template <class Is>
double share(const Image<float, 1>& map, const std::vector<std::uint32_t>& points, Is&& is) {
    const auto width = static_cast<std::uint32_t>(map.width());
    const auto number = std::count_if(points.begin(), points.end(), [&](std::uint32_t p) {
        return is(static_cast<int>(p % width), static_cast<int>(p / width));
    });
    return static_cast<double>(number) / static_cast<double>(points.size());
}

}  // namespace

TEST_CASE("errors are diffused as Floyd and Steinberg say, in rows there and back, and none falls over a side") {
    hmesh::kit::Random random(1);
    for (const auto& [width, height] : {std::pair{31, 26}, {1, 1}, {1, 40}, {40, 1}, {2, 33}, {50, 3}, {17, 2}, {3, 3}}) {
        const auto map = map_of(width, height, [&](int, int) { return random.uniform() * random.uniform(); });
        for (const double factor : {0.05, 0.3, 1.0, 5.0}) {
            std::vector<std::uint32_t> points;
            hmesh::kit::detail::diffuse(map.view(), factor, 0.01, [&, w = width](int x, int y) {
                points.push_back(static_cast<std::uint32_t>(y * w + x));
            });
            CHECK(points == naive_points(map, factor, 0.01));
        }
    }
}

TEST_CASE("there are as many points as asked for, or hardly more, each a pixel of its own, row after row") {
    hmesh::kit::Random random(2);
    const int width = 61, height = 50;
    const Image<float, 1> maps[] = {
        even(width, height),
        map_of(width, height, [&](int, int) { return random.uniform(); }),
        map_of(width, height, [](int x, int y) { return x * x + 3 * y; }),
        map_of(width, height, [&](int, int) { return std::pow(random.uniform(), 8); }),  // a few large values
        map_of(width, height, [](int x, int y) { return 1e-30 * std::exp(0.2 * x + 0.1 * y); }),
    };
    for (const Image<float, 1>& map : maps)
        for (const std::size_t count : {1U, 2U, 7U, 100U, 500U, 1300U, 3000U, 3049U}) {
            const std::size_t got = points_of(map, count).size();
            CHECK(got <= count + count / 30 + 1);
        }
}

TEST_CASE("as many points as pixels are all pixels, and no points are none") {
    hmesh::kit::Random random(3);
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 13}, {13, 1}, {2, 2}, {20, 11}, {90, 3}}) {
        const auto pixels = static_cast<std::size_t>(width * height);
        for (const auto& map : {even(width, height), map_of(width, height, [](int, int) { return 0; }),
                                map_of(width, height, [&](int, int) { return random.uniform(); }),
                                map_of(width, height, [](int x, int y) { return x + y == 0 ? 1e30 : 0.0; }),
                                map_of(width, height, [](int x, int y) { return x + y == 0 ? 3e-45 : 0.0; })}) {
            CHECK(points_of(map, pixels).size() == pixels);
            CHECK(points_of(map, 0).empty());
            CHECK(points_of(map, 1).size() == 1);
        }
    }
}

TEST_CASE("points are as dense as the map is large") {
    const auto halves = map_of(80, 60, [](int x, int) { return x < 40 ? 3 : 1; });
    for (const std::size_t count : {400U, 800U, 1600U}) {
        const auto points = points_of(halves, count);
        CHECK(share(halves, points, [](int x, int) { return x < 40; }) == doctest::Approx(0.75).epsilon(0.05));
    }
    // Of density x: quarters from the left have 1, 3, 5 and 7 sixteenths.
    const auto ramp = map_of(80, 60, [](int x, int) { return x + 0.5; });
    const auto points = points_of(ramp, 1200);
    for (int k = 0; k < 4; ++k)
        CHECK(std::abs(share(ramp, points, [k](int x, int) { return x / 20 == k; }) - (2 * k + 1) / 16.0) < 0.02);
    // Nothing but the ratios counts.
    const auto small = map_of(80, 60, [](int x, int) { return std::ldexp(x + 0.5, -100); });
    const auto large = map_of(80, 60, [](int x, int) { return std::ldexp(x + 0.5, 100); });
    CHECK(points_of(small, 1200) == points);
    CHECK(points_of(large, 1200) == points);
}

TEST_CASE("images of a few rows or columns have points as dense as the map is large too, also with few points") {
    for (const int breadth : {1, 2, 3, 5})
        for (const bool upright : {false, true}) {
            const int width = upright ? breadth : 1000, height = upright ? 1000 : breadth;
            const auto along = [&](int x, int y) { return upright ? y : x; };
            for (const std::size_t count : {40U, 100U, 400U}) {
                const auto halves = map_of(width, height, [&](int x, int y) { return along(x, y) < 500 ? 3 : 1; });
                const auto points = points_of(halves, count);
                CHECK(points.size() <= count + count / 100 + 1);
                CHECK(std::abs(share(halves, points, [&](int x, int y) { return along(x, y) < 500; }) - 0.75) < 0.04);
            }
        }
    // Alone in its row, a point comes every 1 / density pixels.
    const auto points = points_of(even(1000, 1), 10);
    REQUIRE(points.size() == 10);
    for (std::size_t k = 1; k < points.size(); ++k) CHECK(std::abs(static_cast<int>(points[k] - points[k - 1]) - 100) <= 1);
}

TEST_CASE("a map of 0 counts as even") {
    for (const std::size_t count : {50U, 300U, 2000U})
        CHECK(points_of(map_of(61, 50, [](int, int) { return 0; }), count) == points_of(even(61, 50), count));
    const auto points = points_of(even(60, 60), 900);
    for (int j = 0; j < 3; ++j)
        for (int i = 0; i < 3; ++i)
            CHECK(std::abs(share(even(60, 60), points, [&](int x, int y) { return x / 20 == i && y / 20 == j; }) - 1 / 9.0) <
                  0.02);
}

TEST_CASE("flat parts have points only when all others have, and then evenly") {
    // One pixel that is not 0, or a block of 9.
    for (const int side : {1, 3}) {
        const auto is_bright = [side](int x, int y) { return x >= 20 && x < 20 + side && y >= 30 && y < 30 + side; };
        const auto map = map_of(60, 60, [&](int x, int y) { return is_bright(x, y) ? 0.001 : 0.0; });
        const auto few = points_of(map, static_cast<std::size_t>(side));
        CHECK(few.size() <= static_cast<std::size_t>(side * side));
        CHECK(share(map, few, is_bright) == 1);
        const auto many = points_of(map, 900);
        CHECK(many.size() <= 930);
        CHECK(share(map, many, is_bright) * static_cast<double>(many.size()) >= side * side - 0.5);
        for (int k = 0; k < 3; ++k) CHECK(std::abs(share(map, many, [k](int x, int) { return x / 20 == k; }) - 1 / 3.0) < 0.03);
    }
}

TEST_CASE("maps of the largest and of the smallest floats are as good as any") {
    for (const float size : {std::numeric_limits<float>::max(), std::numeric_limits<float>::denorm_min()}) {
        const auto map = map_of(40, 30, [&](int, int) { return size; });
        for (const std::size_t count : {1U, 60U, 1000U, 1200U}) CHECK(points_of(map, count) == points_of(even(40, 30), count));
    }
}

TEST_CASE("told to stop between two passes there are no points, and otherwise the same as ever") {
    hmesh::kit::Random random(4);
    const auto map = map_of(40, 30, [&](int, int) { return std::pow(random.uniform(), 6); });
    std::size_t asked = 0;
    const auto points = diffused_points(map.view(), 300, [&] { return ++asked > 0; });
    CHECK(points == points_of(map, 300));
    REQUIRE(asked > 2);
    for (std::size_t stop = 1; stop <= asked; ++stop) {
        std::size_t calls = 0;
        CHECK(diffused_points(map.view(), 300, [&] { return ++calls < stop; }).empty());
        CHECK(calls == stop);
    }
    CHECK(diffused_points(map.view(), 300) == points);  // never told to stop
}

TEST_CASE("vertices of pixels are on their centers, and on the border for the outermost, whatever the size") {
    using hmesh::kit::pixel_vertex;
    using hmesh::kit::Point;
    CHECK(pixel_vertex(0, 5, 4) == Point{0, 0});
    CHECK(pixel_vertex(3, 5, 4) == Point{3.5, 0});
    CHECK(pixel_vertex(4, 5, 4) == Point{5, 0});
    CHECK(pixel_vertex(5 + 2, 5, 4) == Point{2.5, 1.5});
    CHECK(pixel_vertex(19, 5, 4) == Point{5, 4});
    CHECK(pixel_vertex(0, 1, 1) == Point{0.5, 0.5});
    CHECK(pixel_vertex(2, 1, 3) == Point{0.5, 3});
    CHECK(pixel_vertex(4294967295U, 65536, 65536) == Point{65536, 65536});
}
