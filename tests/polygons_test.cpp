#include "hmesh/outline/polygons.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "test_outlines.hpp"

using hmesh::kit::GridPoint;
using hmesh::kit::Loop;
using hmesh::kit::Polygons;

namespace {

GridPoint some_point(hmesh::kit::Random& random, int width, int height) {
    return {static_cast<std::int32_t>(random.below(static_cast<std::uint32_t>(256 * width))),
            static_cast<std::int32_t>(random.below(static_cast<std::uint32_t>(256 * height)))};
}

// Any change at v that its loop is large enough for, whatever becomes of the picture.
void change(Polygons& polygons, std::uint32_t v, int width, int height, hmesh::kit::Random& random) {
    const bool is_large = polygons.size_of(polygons.loop_of(v)) > 3;
    const std::size_t kind = random.below(16);
    if (kind == 0) polygons.remove_loop(polygons.loop_of(v));
    else if (kind < 6 && is_large) polygons.remove_corner(v);
    else if (kind < 11 && is_large) polygons.remove_side(v, some_point(random, width, height));
    else polygons.move_side(v, some_point(random, width, height), some_point(random, width, height));
}

// Empty, or which of what the class says is always so is not.
std::string flaw_of(const Polygons& polygons, const std::vector<Loop>& contours) {
    std::size_t corners = 0;
    std::int64_t area = 0;
    std::vector<int> expected(polygons.numbers(), 0), found(polygons.numbers(), 0);
    std::vector<std::uint8_t> is_seen(contours.size(), 0);
    for (std::uint32_t first = 0; first < polygons.numbers(); ++first) {
        const std::uint32_t loop = polygons.loop_of(first);
        if (!polygons.has(first) || is_seen[loop] != 0) continue;
        is_seen[loop] = 1;
        std::size_t size = 0, steps = 0;
        std::uint32_t v = first;
        do {
            if (polygons.previous(polygons.next(v)) != v || polygons.loop_of(v) != loop || !polygons.has(v)) return "links";
            Loop part, next_part;
            polygons.along_contour(v, [&](GridPoint p) { part.push_back(p); });
            polygons.along_contour(polygons.next(v), [&](GridPoint p) { next_part.push_back(p); });
            if (part.back() != next_part.front()) return "parts of the contour";
            steps += part.size() - 1;
            expected[v] = 1;
            v = polygons.next(v);
        } while (++size <= polygons.numbers() && v != first);
        if (size != polygons.size_of(loop) || size != polygons.corners_of(loop).size()) return "the size of a loop";
        if (steps != contours[loop].size()) return "all of the contour";
        if (double_area(polygons.corners_of(loop)) != polygons.double_area_of(loop)) return "the area of a loop";
        corners += size, area += polygons.double_area_of(loop);
    }
    for (std::size_t loop = 0; loop < contours.size(); ++loop)
        if (is_seen[loop] == 0 && polygons.size_of(static_cast<std::uint32_t>(loop)) != 0) return "a loop that is gone";
    if (corners != polygons.corners() || area != polygons.double_area()) return "sums";
    polygons.visit_sides(polygons.image(), [&](std::uint32_t s) { return found[s] = 1, true; });
    return found == expected ? "" : "the sides that there are";
}

}  // namespace

TEST_CASE("whatever is changed, rings are whole, contours are shared out, and sides are found and counted") {
    hmesh::kit::Random random(5);
    for (int round = 0; round < 24; ++round) {
        const int width = 3 + static_cast<int>(random.below(20)), height = 3 + static_cast<int>(random.below(20));
        const auto image = hmesh_test::some_silhouette(round, width, height, random);
        const auto contours = hmesh::kit::contours_of(hmesh_test::mask_of(image), 128, true);
        if (contours.loops.empty()) continue;
        CAPTURE(round);
        Polygons polygons(contours.loops, width, height);
        CHECK(polygons.loops() == contours.loops);
        CHECK(flaw_of(polygons, contours.loops) == "");
        for (int i = 0; i < 60; ++i) {
            const auto v = static_cast<std::uint32_t>(random.below(polygons.numbers()));
            if (!polygons.has(v)) continue;
            change(polygons, v, width, height, random);
            const std::string flaw = flaw_of(polygons, contours.loops);
            if (!flaw.empty()) FAIL(flaw, " after change ", i);
        }
    }
}

TEST_CASE("a side is free if it meets no other but at its ends, and does not run along those") {
    hmesh::kit::Random random(6);
    int free = 0;
    for (int round = 0; round < 16; ++round) {
        const int width = 3 + static_cast<int>(random.below(20)), height = 3 + static_cast<int>(random.below(20));
        const auto image = hmesh_test::some_silhouette(round, width, height, random);
        const auto contours = hmesh::kit::contours_of(hmesh_test::mask_of(image), 64, true);
        if (contours.loops.empty()) continue;
        const Polygons polygons(contours.loops, width, height);
        const auto wide = [](GridPoint p) { return hmesh_test::UnitPoint{p.x, p.y}; };
        for (int i = 0; i < 200; ++i) {
            const auto a = static_cast<std::uint32_t>(random.below(polygons.numbers())),
                       b = static_cast<std::uint32_t>(random.below(polygons.numbers())),
                       gone = static_cast<std::uint32_t>(random.below(polygons.numbers()));
            const GridPoint p = polygons.at(a), q = polygons.at(b);
            bool expected = a != b;
            for (std::uint32_t s = 0; s < polygons.numbers(); ++s) {
                if (s == gone) continue;
                const std::uint32_t t = polygons.next(s);
                const bool begins = s == a || s == b, ends = t == a || t == b;
                if (!begins && !ends) {
                    expected = expected && !hmesh_test::touch(wide(p), wide(q), wide(polygons.at(s)), wide(polygons.at(t)));
                } else {  // The farther end of one must not be on the other.
                    const std::uint32_t shared = begins ? s : t, other = begins ? t : s, own = shared == a ? b : a;
                    const auto turn = hmesh::kit::orient2d(polygons.at(shared), polygons.at(own), polygons.at(other));
                    const std::int64_t x = std::int64_t{polygons.at(own).x - polygons.at(shared).x} *
                                           (polygons.at(other).x - polygons.at(shared).x),
                                       y = std::int64_t{polygons.at(own).y - polygons.at(shared).y} *
                                           (polygons.at(other).y - polygons.at(shared).y);
                    expected = expected && (turn != 0 || x + y < 0);
                }
            }
            const bool is_free = polygons.is_side_free({a, p}, {b, q}, {gone, Polygons::none, Polygons::none});
            free += is_free ? 1 : 0;
            if (is_free != expected) FAIL(a, " to ", b, " in round ", round);
        }
    }
    CHECK(free > 100);
}

TEST_CASE("what a side was along is shared out, where it is farthest out, by the neighbours that meet beyond it") {
    constexpr std::int32_t px = hmesh::kit::units_per_px;
    // Of the ends of the second side the one that is farther from the line between the ends of its neighbours.
    const Loop second = {{0, 20 * px}, {0, 8 * px}, {4 * px, 2 * px}, {20 * px, 0}, {20 * px, 20 * px}};
    const Loop first = {{0, 20 * px}, {2 * px, 4 * px}, {8 * px, 0}, {20 * px, 0}, {20 * px, 20 * px}};
    for (const bool is_second : {true, false}) {
        const Loop& contour = is_second ? second : first;
        Polygons polygons({contour}, 20, 20);
        polygons.remove_side(1, is_second ? GridPoint{0, 640} : GridPoint{640, 0});
        Loop before, behind;
        polygons.along_contour(0, [&](GridPoint p) { before.push_back(p); });
        polygons.along_contour(1, [&](GridPoint p) { behind.push_back(p); });
        CHECK(before.size() == (is_second ? 3 : 2));
        CHECK(before.back() == contour[is_second ? 2 : 1]);
        CHECK(behind.size() == (is_second ? 2 : 3));
        CHECK(behind.back() == contour[3]);
    }
}
