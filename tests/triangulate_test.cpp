#include "hmesh/outline/triangulate.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "test_outlines.hpp"

using hmesh::kit::GridPoint;
using hmesh::kit::Loop;

namespace {

std::string flaw_of(const std::vector<Loop>& loops) {
    hmesh_test::UnitLoops units;
    for (const Loop& loop : loops) {
        units.emplace_back();
        for (const GridPoint p : loop) units.back().push_back({p.x, p.y});
    }
    return hmesh_test::flaw_of_faces(units, hmesh::kit::triangulate(loops));
}

Loop box(std::int32_t left, std::int32_t top, std::int32_t right, std::int32_t bottom) {
    return {{left, top}, {right, top}, {right, bottom}, {left, bottom}};
}
Loop turned(Loop loop) {
    std::reverse(loop.begin(), loop.end());
    return loop;
}

}  // namespace

TEST_CASE("a square is two triangles, and a square with a square hole eight") {
    CHECK(hmesh::kit::triangulate({box(0, 0, 4, 4)}).size() == 2);
    const std::vector<Loop> ring = {box(0, 0, 9, 9), turned(box(3, 3, 6, 6))};
    CHECK(hmesh::kit::triangulate(ring).size() == 8);
    CHECK(flaw_of(ring) == "");
    CHECK(hmesh::kit::triangulate({}).empty());
}

TEST_CASE("holes in a row, islands in holes and holes in these are divided, in any order") {
    std::vector<Loop> loops = {box(0, 0, 1000, 1000)};
    for (std::int32_t i = 0; i < 9; ++i)
        for (std::int32_t j = 0; j < 9; ++j) {
            const std::int32_t x = 100 * i + 20, y = 100 * j + 20;
            loops.push_back(turned(box(x, y, x + 80, y + 80)));
            loops.push_back(box(x + 10, y + 10, x + 70, y + 70));
            loops.push_back(turned(box(x + 30, y + 30, x + 40, y + 40)));
        }
    CHECK(flaw_of(loops) == "");
    std::reverse(loops.begin(), loops.end());
    CHECK(flaw_of(loops) == "");
}

TEST_CASE("a hole is not joined to the nearest corner where another hole is between them, in any order") {
    // A notch from above ends beside a triangle, with a bar between them.
    std::vector<Loop> loops = {{{0, 0}, {300, 0}, {310, 500}, {320, 0}, {1000, 0}, {1000, 1000}, {0, 1000}},
                               turned({{200, 500}, {210, 520}, {202, 520}}),
                               turned(box(250, 400, 255, 600))};
    CHECK(flaw_of(loops) == "");
    std::reverse(loops.begin(), loops.end());
    CHECK(flaw_of(loops) == "");
}

TEST_CASE("corners in line, combs and spirals are divided") {
    CHECK(flaw_of({{{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 3}, {1, 3}, {0, 3}, {0, 2}}}) == "");
    Loop comb = {{0, 100}, {0, 0}};
    for (std::int32_t i = 0; i < 50; ++i)
        comb.insert(comb.end(), {{4 * i + 1, 0}, {4 * i + 1, 90}, {4 * i + 4, 90}, {4 * i + 4, 0}});
    comb.push_back({202, 0});
    comb.push_back({202, 100});
    CHECK(flaw_of({comb}) == "");
}

TEST_CASE("the contours of masks of all kinds are divided") {
    hmesh::kit::Random random(6);
    for (int round = 0; round < 80; ++round) {
        const int width = 1 + static_cast<int>(random.below(30)), height = 1 + static_cast<int>(random.below(30));
        const auto image = hmesh_test::some_silhouette(round, width, height, random);
        hmesh::kit::Mask mask{width, height, {}};
        for (std::size_t k = 1; k < image.size(); k += 2) mask.pixels.push_back(image.data()[k]);
        CAPTURE(round);
        CHECK(flaw_of(hmesh::kit::contours_of(mask, 0, true).loops) == "");
    }
}
