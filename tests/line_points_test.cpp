#include "hmesh/methods/annealed/line_points.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <utility>

#include "test_images.hpp"

using hmesh::Image;
using hmesh::Periodic;
using hmesh::kit::ImageSource;
using hmesh::kit::Point;
using hmesh::kit::seam_points;
using hmesh::kit::side_points;

TEST_CASE(
    "seams have as many points as lines through points of that density, more where that is higher, and half of all at most") {
    Image<float, 1> density(200, 100);
    for (std::size_t k = 0; k < density.size(); ++k) density.data()[k] = 1;
    for (const Periodic periodic : {Periodic::x, Periodic::y, Periodic::xy}) {
        int on_x = 0, on_y = 0;
        for (const Point p : seam_points(density, 200, periodic)) {  // a point each 10 px
            REQUIRE((p.x == 0) != (p.y == 0));
            on_x += p.x == 0 && p.y < 100 ? 1 : 0;
            on_y += p.y == 0 && p.x < 200 ? 1 : 0;
        }
        CHECK(std::abs(on_x - (periodic == Periodic::y ? 0 : 10)) <= 1);
        CHECK(std::abs(on_y - (periodic == Periodic::x ? 0 : 20)) <= 1);
    }
    for (const int count : {0, 3, 9, 20})
        CHECK(2 * seam_points(density, count, Periodic::xy).size() <= static_cast<std::size_t>(count));
    for (int y = 0; y < 100; ++y) *density.pixel(0, y) = *density.pixel(199, y) = y < 50 ? 1.0F : 16.0F;
    int above = 0, below = 0;
    for (const Point p : seam_points(density, 200, Periodic::x)) ++(p.y < 50 ? above : below);
    CHECK(above > 0);
    CHECK(std::abs(below - 4 * above) <= 4);
}

TEST_CASE("points on the sides stand on outermost samples, and are half of all at most") {
    for (const auto& [columns, rows] : {std::pair{2, 2}, {2, 9}, {9, 2}, {3, 3}, {40, 27}}) {
        const int width = columns, height = rows;
        const auto noise = hmesh_test::noise<std::uint8_t, 3>(width, height, 2);
        const ImageSource<3> source(noise.view());
        for (const int count : {0, 1, 4, width * height / 2, width * height}) {
            const auto points = side_points(source, count);
            for (const Point p : points) {
                CHECK(((p.x == 0.5 || p.x == width - 0.5) || (p.y == 0.5 || p.y == height - 0.5)));
                CHECK((p.x - 0.5 == std::floor(p.x) && p.x > 0 && p.x < width && p.y - 0.5 == std::floor(p.y) && p.y > 0 &&
                       p.y < height));
            }
            CHECK(2 * points.size() <= static_cast<std::size_t>(count) + 1);
        }
    }
}

TEST_CASE("sides have as many points as lines through points of that density, more where the side bends") {
    const auto flat = hmesh_test::draw<std::uint8_t, 1>(200, 100, [](int, int, int) { return 0.5; });
    const auto even = side_points(ImageSource<1>(flat.view()), 200);
    CHECK(std::abs(static_cast<int>(even.size()) - 60) <= 1);  // 600 px, a point each 10 px
    const auto half =
        hmesh_test::draw<std::uint8_t, 1>(200, 100, [](int x, int, int) { return x < 100 ? 0.5 : (x / 2) % 4 / 4.0; });
    int left = 0, right = 0;
    for (const Point p : side_points(ImageSource<1>(half.view()), 200))
        if (p.y == 0.5) ++(p.x < 100 ? left : right);
    CHECK(left > 0);
    CHECK(right > 4 * left);
}

TEST_CASE("points of a row or a column are beside their pixels, on one long side and the other by turns") {
    const hmesh::kit::Array<std::uint32_t> pixels{1, 4, 5};
    const auto row = hmesh::kit::points_by_turns(pixels, true), column = hmesh::kit::points_by_turns(pixels, false);
    REQUIRE(row.size() == 3);
    for (std::size_t k = 0; k < 3; ++k) {
        CHECK(row[k] == Point{pixels[k] + 0.5, k == 1 ? 1.0 : 0.0});
        CHECK(column[k] == Point{row[k].y, row[k].x});
    }
    CHECK(hmesh::kit::points_by_turns({}, true).empty());
}
