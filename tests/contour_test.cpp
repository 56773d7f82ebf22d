#include "hmesh/outline/contour.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "test_outlines.hpp"

using hmesh::kit::Contours;
using hmesh::kit::GridPoint;
using hmesh::kit::Loop;
using hmesh::kit::Mask;

namespace {

Mask mask_of(const std::vector<std::string>& rows) {
    Mask mask{static_cast<int>(rows.front().size()), static_cast<int>(rows.size()), {}};
    for (const std::string& row : rows)
        for (const char c : row) mask.pixels.push_back(c == '#' ? 1 : 0);
    return mask;
}

}  // namespace

TEST_CASE("a border runs clockwise on the screen from its upper left corner, and that of a hole the other way") {
    const Contours one = contours_of(mask_of({"....", ".##.", ".#.."}), 0, true);
    REQUIRE(one.loops.size() == 1);
    CHECK(one.loops[0] == Loop{{256, 256}, {768, 256}, {768, 512}, {512, 512}, {512, 768}, {256, 768}});
    CHECK(one.area == 3);
    CHECK(one.length == doctest::Approx(8 * std::acos(-1.0) / 4));
    CHECK(hmesh::kit::double_area(one.loops[0]) == 6 * 65536);
    const Contours ring = contours_of(mask_of({"###", "#.#", "###"}), 0, true);
    REQUIRE(ring.loops.size() == 2);
    CHECK(ring.area == 8);
    CHECK(hmesh::kit::double_area(ring.loops[0]) == 18 * 65536);
    CHECK(hmesh::kit::double_area(ring.loops[1]) == -2 * 65536);
    CHECK(contours_of(mask_of({"###", "#.#", "###"}), 0, false).loops.size() == 1);
    CHECK(contours_of(mask_of({"###", "#.#", "###"}), 0, false).area == 9);
    CHECK(contours_of(mask_of({"...", "..."}), 77, true).loops.empty());
}

TEST_CASE("pixels that touch at a corner are joined there, also where that makes others touch") {
    CHECK(contours_of(mask_of({"#.", ".#"}), 0, true).area == 3);
    CHECK(contours_of(mask_of({".#", "#."}), 0, true).area == 3);
    // What is filled touches another, in squares that were looked at before: to its upper left and to its upper right.
    const Contours left = contours_of(mask_of({"#..", "..#", ".#."}), 0, true);
    CHECK(left.area == 5);
    CHECK(left.loops.size() == 1);
    const Contours right = contours_of(mask_of({"..#", "#..", ".#."}), 0, true);
    CHECK(right.area == 5);
    CHECK(right.loops.size() == 1);
    CHECK(contours_of(mask_of({"#.#.", ".#.#", "#.#.", ".#.#"}), 0, true).loops.size() >= 1);
    CHECK(contours_of(mask_of({"#.#.", ".#.#", "#.#.", ".#.#"}), 0, false).loops.size() == 1);
}

TEST_CASE("what grown pixels cover is what is inside, whatever mask and margin; borders have right angles and do not meet") {
    hmesh::kit::Random random(4);
    for (int round = 0; round < 80; ++round) {
        const int width = 1 + static_cast<int>(random.below(16)), height = 1 + static_cast<int>(random.below(16));
        const auto image = hmesh_test::some_silhouette(round, width, height, random);
        Mask mask{width, height, {}};
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) mask.pixels.push_back(image.pixel(x, y)[1] > 0 ? 1 : 0);
        constexpr int margins[] = {0, 1, 77, 128, 200, 256, 384, 5000};
        const int margin = margins[random.below(8)];
        CAPTURE(round);
        CAPTURE(margin);
        const Contours contours = contours_of(mask, margin, true);
        const auto loops = hmesh_test::unit_loops(contours.loops);
        const auto counts = [&](int x, int y) { return image.pixel(x, y)[1] > 0; };
        CHECK(hmesh_test::flaw_of_loops(loops, width, height, margin, counts) == "");
        double area = 0;
        for (const Loop& loop : contours.loops) {
            area += static_cast<double>(hmesh::kit::double_area(loop)) / (2 * 65536);
            for (std::size_t i = 0; i < loop.size(); ++i) {
                const GridPoint a = loop[i], b = loop[(i + 1) % loop.size()], c = loop[(i + 2) % loop.size()];
                if ((a.x == b.x) == (b.x == c.x) || (a.y == b.y) == (b.y == c.y)) FAIL("no right angle");
            }
        }
        CHECK(contours.area == doctest::Approx(area).epsilon(1e-12));
        // Points of a fine grid are inside where a grown pixel is, but for corners that are filled.
        int wrong = 0, filled = 0;
        for (std::int64_t y = 16; y < 256 * height; y += 32)
            for (std::int64_t x = 16; x < 256 * width; x += 32) {
                bool is_covered = false;
                for (int j = 0; j < height; ++j)
                    for (int i = 0; i < width; ++i)
                        is_covered = is_covered || (counts(i, j) && x > 256 * i - margin && x < 256 * (i + 1) + margin &&
                                                    y > 256 * j - margin && y < 256 * (j + 1) + margin);
                const bool is_in = hmesh_test::is_within(loops, {x, y});
                wrong += is_covered && !is_in ? 1 : 0;
                filled += is_in && !is_covered ? 1 : 0;
            }
        CHECK(wrong == 0);
        if (round % 8 == 1 || round % 8 == 3) CHECK(filled <= 8 * 64);
    }
}

TEST_CASE("without holes what is left is the outer borders that no other is around, and what is inside of these is all covered") {
    hmesh::kit::Random random(5);
    int nested = 0, left = 0;
    for (int round = 0; round < 120; ++round) {
        const int width = 1 + static_cast<int>(random.below(14)), height = 1 + static_cast<int>(random.below(14));
        const auto image = hmesh_test::some_silhouette(round, width, height, random);
        Mask mask{width, height, {}};
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {  // or rings around rings, with gaps or without
                const bool is_ring = std::max(std::abs(2 * x - width), std::abs(2 * y - height)) / 2 % 2 == 0;
                const bool is_gap = round % 3 == 1 && random.below(30) == 0;
                mask.pixels.push_back((round % 3 == 2 ? image.pixel(x, y)[1] > 0 : is_ring != is_gap) ? 1 : 0);
            }
        const int margin = static_cast<int>(random.below(2)) * 77;
        CAPTURE(round);
        const Contours all = contours_of(mask, margin, true), filled = contours_of(mask, margin, false);
        // Twice as large, so that the middle of a unit is a whole number: that below and to the right of the first corner is
        // inside of an outer border.
        std::vector<Loop> expected;
        std::vector<hmesh_test::UnitLoops> doubled;
        for (const Loop& loop : all.loops) {
            doubled.emplace_back(1);
            for (const GridPoint p : loop) doubled.back()[0].push_back({2 * p.x, 2 * p.y});
        }
        double area = 0, length = 0;
        for (std::size_t i = 0; i < all.loops.size(); ++i) {
            if (hmesh::kit::double_area(all.loops[i]) < 0) continue;
            bool is_nested = false;
            for (std::size_t j = 0; j < all.loops.size(); ++j)
                is_nested =
                    is_nested || (j != i && hmesh::kit::double_area(all.loops[j]) > 0 &&
                                  hmesh_test::is_within(doubled[j], {2 * all.loops[i][0].x + 1, 2 * all.loops[i][0].y + 1}));
            nested += is_nested ? 1 : 0;
            if (is_nested) continue;
            const Loop& loop = all.loops[i];
            expected.push_back(loop);
            area += static_cast<double>(hmesh::kit::double_area(loop)) / (2 * 65536);
            for (std::size_t k = 0; k < loop.size(); ++k) {
                const GridPoint a = loop[k], b = loop[k + 1 < loop.size() ? k + 1 : 0];
                length += (std::abs(b.x - a.x) + std::abs(b.y - a.y)) / 256.0;
            }
        }
        CHECK(filled.loops == expected);
        CHECK(filled.area == doctest::Approx(area));
        CHECK(filled.length == doctest::Approx(length * std::acos(-1.0) / 4));
        left += static_cast<int>(all.loops.size() - expected.size());
    }
    CHECK(nested > 5);
    CHECK(left > 50);
}

TEST_CASE("a point is inside of a polygon as counting sides to its right says") {
    hmesh::kit::Random random(3);
    const Loop star = {{0, 0}, {50, 20}, {100, 0}, {80, 50}, {100, 100}, {50, 80}, {0, 100}, {20, 50}};
    hmesh_test::UnitLoops units(1);
    for (const GridPoint p : star) units[0].push_back({2 * p.x, 2 * p.y});
    for (int round = 0; round < 500; ++round) {
        const GridPoint p{static_cast<std::int32_t>(random.below(100)), static_cast<std::int32_t>(random.below(100))};
        Loop twice;
        for (const GridPoint q : star) twice.push_back({2 * q.x, 2 * q.y});
        const GridPoint odd{2 * p.x + 1, 2 * p.y + 1};
        CHECK(hmesh::kit::is_inside(twice, odd) == hmesh_test::is_within(units, {odd.x, odd.y}));
    }
}
