#include "hmesh/tiles/tiling.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "hmesh/core/random.hpp"
#include "hmesh/mesh/periodic.hpp"

using hmesh::kit::Point;
using hmesh::kit::Rect;
using hmesh::kit::TileGrid;
using hmesh::kit::Tiling;
using hmesh::kit::Tilings;

namespace {

// The lines of one axis, from the rectangles of the first row or column.
std::vector<int> lines_x(const Tiling& tiling) {
    std::vector<int> lines;
    for (std::size_t i = 0; i < tiling.columns(); ++i) lines.push_back(tiling.rect(i).x);
    lines.push_back(lines.back() + tiling.rect(tiling.columns() - 1).width);
    return lines;
}
std::vector<int> lines_y(const Tiling& tiling) {
    std::vector<int> lines;
    for (std::size_t j = 0; j < tiling.rows(); ++j) lines.push_back(tiling.rect(j * tiling.columns()).y);
    lines.push_back(lines.back() + tiling.rect(tiling.size() - 1).height);
    return lines;
}

// Points of an image, at even random numbers to the power of `strength`: above 1 the closer, the nearer they are to a corner.
hmesh::kit::Array<Point> crowded_points(int width, int height, std::size_t count, double strength) {
    hmesh::kit::Random random(5);
    hmesh::kit::Array<Point> points(count);
    for (Point& p : points) p = {width * std::pow(random.uniform(), strength), height * std::pow(random.uniform(), strength)};
    return points;
}

}  // namespace

TEST_CASE("the lines of a tiling cover the image, and its tiles are as equal as can be and as large as asked") {
    for (int size = 1; size <= 70; ++size)
        for (const double tile : {1.0, 1.2, 1.5, 2.0, 3.0, 7.3, 10.0, 64.0, 1000.0}) {
            const Tiling tiling(size, 71 - size, tile);
            const std::vector<int> x = lines_x(tiling), y = lines_y(tiling);
            REQUIRE((x.front() == 0 && x.back() == size && y.front() == 0 && y.back() == 71 - size));
            REQUIRE(tiling.size() == tiling.columns() * tiling.rows());
            // Tiles are numbered row after row, and lie between the lines.
            for (std::size_t k = 0; k < tiling.size(); ++k) {
                const Rect r = tiling.rect(k);
                const std::size_t i = k % tiling.columns(), j = k / tiling.columns();
                REQUIRE((r.x == x[i] && r.x + r.width == x[i + 1] && r.y == y[j] && r.y + r.height == y[j + 1]));
            }
            int least = size, most = 0;
            for (std::size_t i = 0; i < tiling.columns(); ++i) {
                least = std::min(least, x[i + 1] - x[i]);
                most = std::max(most, x[i + 1] - x[i]);
            }
            REQUIRE(least >= 1);
            REQUIRE(most - least <= 1);
            // No other count of tiles comes nearer to size / tile.
            const double wanted = std::max(1.0, size / tile);
            REQUIRE(std::abs(static_cast<double>(tiling.columns()) - wanted) <= 0.5);
        }
}

TEST_CASE("a shifted tiling has its lines midway between those of the other, and no tile is empty") {
    for (int size = 1; size <= 70; ++size)
        for (const double tile : {1.0, 1.2, 1.5, 2.0, 3.0, 7.3, 10.0, 64.0, 1000.0}) {
            const Tiling plain(size, size, tile), shifted(size, size, tile, true, false);
            REQUIRE(lines_y(shifted) == lines_y(plain));
            const Tiling down(size, size, tile, false, true);
            REQUIRE((lines_x(down) == lines_x(plain) && lines_y(down) == lines_x(shifted)));
            const std::vector<int> x = lines_x(plain), between = lines_x(shifted);
            REQUIRE((between.front() == 0 && between.back() == size));
            for (std::size_t i = 0; i + 1 < between.size(); ++i) REQUIRE(between[i] < between[i + 1]);
            if (plain.columns() == 1) {
                REQUIRE(shifted.columns() == 1);
                continue;
            }
            const double spacing = static_cast<double>(size) / static_cast<double>(plain.columns());
            if (spacing > 1) REQUIRE(shifted.columns() == plain.columns() + 1);
            for (std::size_t i = 1; i + 1 < between.size(); ++i)
                REQUIRE(std::abs(between[i] - spacing * (static_cast<double>(i) - 0.5)) <= 0.5 + 1e-9);
        }
}

TEST_CASE("a point is in the tile whose rectangle holds it, also on lines and on the border") {
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 9}, {12, 1}, {23, 17}, {40, 31}})
        for (const double tile : {1.0, 2.0, 5.0, 8.0, 30.0})
            for (int shift = 0; shift < 4; ++shift) {
                const Tiling tiling(width, height, tile, (shift & 1) != 0, (shift & 2) != 0);
                // The tile of each pixel, from the rectangles.
                std::vector<std::size_t> owner(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), tiling.size());
                const auto at = [&, w = width](int x, int y) -> std::size_t& {
                    return owner[static_cast<std::size_t>(y * w + x)];
                };
                for (std::size_t k = 0; k < tiling.size(); ++k) {
                    const Rect r = tiling.rect(k);
                    for (int y = r.y; y < r.y + r.height; ++y)
                        for (int x = r.x; x < r.x + r.width; ++x) {
                            REQUIRE(at(x, y) == tiling.size());
                            at(x, y) = k;
                        }
                }
                for (int y = 0; y <= height; ++y)
                    for (int x = 0; x <= width; ++x)
                        for (const Point step : {Point{0, 0}, {0.5, 0.5}, {255.0 / 256, 1.0 / 256}}) {
                            const Point p{std::min<double>(width, x + step.x), std::min<double>(height, y + step.y)};
                            REQUIRE(tiling.tile_at(p) == at(std::min(x, width - 1), std::min(y, height - 1)));
                        }
            }
}

TEST_CASE("tiles of an image that repeats have one size, go around it, and no line of one phase is near one of the other") {
    using hmesh::Periodic;
    for (int size = 1; size <= 60; ++size)
        for (const double tile : {1.0, 5.0, 7.3, 20.0, 1000.0}) {
            std::vector<int> lines[2];
            for (const bool shift : {false, true}) {
                const Tiling tiling(size, 9, tile, shift, shift, Periodic::x);
                const std::vector<int> x = lines_x(tiling), y = lines_y(tiling);
                REQUIRE(x.back() - x.front() == size);
                REQUIRE((tiling.left() == x.front() && x.front() >= 0 && x.front() <= size));
                REQUIRE((y.front() == 0 && y.back() == 9 && tiling.top() == 0));  // as without Periodic
                REQUIRE(y == lines_y(Tiling(size, 9, tile, shift, shift)));
                const double wanted = size / std::max(1.0, std::floor(size / tile + 0.5));
                for (std::size_t i = 0; i + 1 < x.size(); ++i) {
                    REQUIRE(x[i] < x[i + 1]);
                    REQUIRE(x[i + 1] - x[i] <= wanted + 1);
                    REQUIRE(tiling.tile_at({x[i] + 0.5, 4}) % tiling.columns() == i);
                }
                lines[shift] = x;
            }
            const double apart = size / std::max(1.0, std::floor(size / tile + 0.5)) / 2;
            for (const int a : lines[0])
                for (const int b : lines[1]) {
                    const int distance = std::abs(a - b) % size;
                    REQUIRE(std::min(distance, size - distance) >= std::floor(apart) - 1);
                }
        }
}

TEST_CASE("rows of a balanced tiling hold as many points each as asked, and so do the tiles of a row") {
    for (const double strength : {1.0, 1.3}) {
        const hmesh::kit::Array<Point> points = crowded_points(600, 400, 20000, strength);
        const Tiling tiling(TileGrid(600, 400, 130, points)), equal(600, 400, 130);
        REQUIRE((tiling.rows() == equal.rows() && tiling.size() == equal.size()));
        std::vector<double> held(tiling.size(), 0.0);
        for (const Point p : points) ++held[tiling.tile_at(p)];
        const double row_mean = 20000.0 / static_cast<double>(tiling.rows());
        for (std::size_t j = 0; j < tiling.rows(); ++j) {
            const std::size_t columns = tiling.columns(j);
            double row = 0, most = 0;
            for (std::size_t i = 0; i < columns; ++i) {
                row += held[j * columns + i];
                most = std::max(most, held[j * columns + i]);
            }
            CHECK(row <= 1.25 * row_mean + 400);  // lines are at whole pixels, the closest of which have some hundred points
            CHECK(most <= 1.25 * row / static_cast<double>(columns) + 100);
        }
        if (strength > 1) {  // equal tiles do not
            std::vector<double> unequal(equal.size(), 0.0);
            for (const Point p : points) ++unequal[equal.tile_at(p)];
            CHECK(*std::max_element(unequal.begin(), unequal.end()) > 1.4 * *std::max_element(held.begin(), held.end()));
        }
    }
}

TEST_CASE("no tile of a balanced tiling is narrower than half of what equal ones are, wherever the points are") {
    for (const double x : {0.0, 0.5, 31.7, 299.5, 599.0, 600.0})
        for (const double y : {0.0, 200.0, 399.5, 400.0}) {
            const hmesh::kit::Array<Point> points(1000, {x, y});
            const TileGrid grid(600, 400, 100, points);
            for (const bool shift_x : {false, true})
                for (const bool shift_y : {false, true}) {
                    const Tiling tiling(grid, shift_x, shift_y), equal(600, 400, 100, shift_x, shift_y);
                    REQUIRE(tiling.size() == equal.size());
                    for (std::size_t k = 0; k < tiling.size(); ++k) {
                        CHECK(tiling.rect(k).width >= equal.rect(k).width / 2 - 1);  // rounded
                        CHECK(tiling.rect(k).height >= equal.rect(k).height / 2 - 1);
                    }
                }
        }
}

TEST_CASE("balanced tilings have every pixel in one tile, and each place off all lines in one of four phases") {
    for (const double tile : {1.0, 2.0, 7.0, 16.0, 100.0}) {
        const TileGrid grid(40, 31, tile, crowded_points(40, 31, 300, 3));
        std::vector<int> inside(40 * 31, 0);  // in how many phases a pixel's tile holds the pixels beside it
        for (const bool shift_x : {false, true})
            for (const bool shift_y : {false, true}) {
                const Tiling tiling(grid, shift_x, shift_y);
                std::vector<int> covers(40 * 31, 0);
                for (std::size_t k = 0; k < tiling.size(); ++k) {
                    const Rect r = tiling.rect(k);
                    for (int y = r.y; y < r.y + r.height; ++y)
                        for (int x = r.x; x < r.x + r.width; ++x) {
                            const auto at = static_cast<std::size_t>(40 * y + x);
                            ++covers[at];
                            REQUIRE(tiling.tile_at({x + 0.5, y + 0.5}) == k);
                            const bool is_off_x = (x > r.x || x == 0) && (x + 1 < r.x + r.width || x == 39);
                            const bool is_off_y = (y > r.y || y == 0) && (y + 1 < r.y + r.height || y == 30);
                            inside[at] += is_off_x && is_off_y ? 1 : 0;
                        }
                }
                CHECK(std::count(covers.begin(), covers.end(), 1) == 40 * 31);
            }
        if (tile >= 16) CHECK(std::count(inside.begin(), inside.end(), 0) == 0);
    }
    CHECK(Tiling(TileGrid(40, 31, 7, {})) == Tiling(40, 31, 7));  // no points: equal tiles
}

TEST_CASE("one tile alone is not shifted, and no tile is empty where tiles of less than a pixel are asked for") {
    CHECK(Tiling(30, 20, 100, true, true) == Tiling(30, 20, 100));
    CHECK(Tiling(30, 20, 14, true, true) == Tiling(30, 20, 14, true));
    for (int size = 1; size <= 20; ++size)
        for (const double tile : {0.3, 0.6, 0.9, 1.0})
            for (const bool shift : {false, true})
                for (const hmesh::Periodic periodic : {hmesh::Periodic::none, hmesh::Periodic::xy}) {
                    const Tiling tiling(size, 21 - size, tile, shift, shift, periodic);
                    int pixels = 0;
                    for (std::size_t k = 0; k < tiling.size(); ++k) {
                        const Rect r = tiling.rect(k);
                        REQUIRE((r.width > 0 && r.height > 0));
                        pixels += r.width * r.height;
                    }
                    REQUIRE(pixels == size * (21 - size));
                }
}

TEST_CASE("of four phases one leaves each place off its lines, and of two those where lines of both do not cross") {
    const Tilings tilings(40, 31, 10);
    // Which lines of a phase a place is on: 1 for one from top to bottom, 2 for one from left to right.
    const auto lines_at = [&](int phase, int x, int y) {
        const std::vector<int> columns = lines_x(tilings[phase]), rows = lines_y(tilings[phase]);
        return (std::count(columns.begin() + 1, columns.end() - 1, x) > 0 ? 1 : 0) |
               (std::count(rows.begin() + 1, rows.end() - 1, y) > 0 ? 2 : 0);
    };
    int crossings = 0;
    for (int y = 0; y <= 31; ++y)
        for (int x = 0; x <= 40; ++x) {
            int off = 0;
            for (int phase = 4; phase < 8; ++phase) off += lines_at(phase, x, y) == 0 ? 1 : 0;
            REQUIRE(off > 0);
            const int first = lines_at(0, x, y), second = lines_at(1, x, y);
            if (first == 0 || second == 0) continue;
            REQUIRE((first | second) == 3);
            ++crossings;
        }
    CHECK(crossings > 0);
}
