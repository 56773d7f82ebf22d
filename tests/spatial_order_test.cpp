#include "hmesh/mesh/spatial_order.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/core/random.hpp"

using hmesh::kit::in_spatial_order;
using hmesh::kit::morton_code;
using hmesh::kit::Point;
using hmesh::kit::Random;

namespace {

// Bit by bit.
std::uint32_t interleaved(std::uint32_t x, std::uint32_t y) {
    std::uint32_t code = 0;
    for (unsigned bit = 0; bit < 16; ++bit) code |= ((x >> bit & 1U) << (2 * bit)) | ((y >> bit & 1U) << (2 * bit + 1));
    return code;
}

std::vector<std::size_t> indices(std::size_t count) {
    std::vector<std::size_t> list(count);
    for (std::size_t k = 0; k < count; ++k) list[k] = k;
    return list;
}

void check_order(const std::vector<Point>& points) {
    const auto range = indices(points.size());
    const auto order = in_spatial_order<std::size_t>(range, range.size(), [&](std::size_t k) { return points[k]; });
    auto expected = range;
    std::stable_sort(expected.begin(), expected.end(),
                     [&](std::size_t a, std::size_t b) { return morton_code(points[a]) < morton_code(points[b]); });
    CHECK(order == expected);
}

std::vector<Point> random_points(std::size_t count, double width, double height, std::uint64_t seed) {
    Random random(seed);
    std::vector<Point> points(count);
    for (Point& p : points) p = {width * random.uniform(), height * random.uniform()};
    return points;
}

}  // namespace

TEST_CASE("the code has the bits of the pixel's x and y in turn, x first") {
    CHECK(morton_code({0, 0}) == 0);
    CHECK(morton_code({1, 0}) == 1);
    CHECK(morton_code({0, 1}) == 2);
    CHECK(morton_code({1.99, 1.5}) == 3);
    CHECK(morton_code({65535.9, 65535.9}) == 0xffffffffU);
    CHECK(morton_code({65535, 0}) == 0x55555555U);
    CHECK(morton_code({65536, 0}) == 0);  // the border wraps around
    Random random(1);
    for (int k = 0; k < 10000; ++k) {
        const std::uint32_t x = random.next() >> 16U, y = random.next() >> 16U;
        const Point p{x + random.uniform(), y + random.uniform()};
        REQUIRE(morton_code(p) == interleaved(x, y));
    }
    static_assert(morton_code({5, 3}) == 0x1bU, "usable at compile time");
}

TEST_CASE("elements come by rising code, and in their own order where codes are equal") {
    for (const double size : {1.0, 2.0, 40.0, 3000.0, 65536.0})
        for (const std::size_t count : {1U, 2U, 77U, 5000U}) {
            check_order(random_points(count, size, size, count));
            check_order(random_points(count, size, 1, count));
            check_order(random_points(count, 1, size, count));
        }
}

TEST_CASE("no element gives no order, and one pixel keeps all as they were") {
    check_order({});
    check_order(std::vector<Point>(500, Point{0, 0}));
    check_order(std::vector<Point>(500, Point{65535, 65535}));
}

TEST_CASE("neighbors in the order are neighbors in the plane") {
    const auto points = random_points(4000, 256, 256, 1);
    const auto range = indices(points.size());
    const auto order = in_spatial_order<std::size_t>(range, range.size(), [&](std::size_t k) { return points[k]; });
    const auto length = [&](const std::vector<std::size_t>& list) {
        double sum = 0;
        for (std::size_t k = 1; k < list.size(); ++k)
            sum += std::hypot(points[list[k]].x - points[list[k - 1]].x, points[list[k]].y - points[list[k - 1]].y);
        return sum;
    };
    CHECK(length(order) < 0.1 * length(range));
}
