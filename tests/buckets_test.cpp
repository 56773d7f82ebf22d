#include "hmesh/outline/buckets.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/core/random.hpp"
#include "test_outlines.hpp"

using hmesh::kit::Buckets;
using hmesh::kit::GridBox;
using hmesh::kit::GridPoint;

namespace {

GridPoint some_point(hmesh::kit::Random& random, std::uint32_t size) {
    return {static_cast<std::int32_t>(random.below(size)), static_cast<std::int32_t>(random.below(size))};
}
hmesh_test::UnitPoint wide(GridPoint p) { return {p.x, p.y}; }

}  // namespace

TEST_CASE("every side that touches a box is found there, as long as it is in the buckets") {
    hmesh::kit::Random random(2);
    for (const std::uint32_t size : {3U, 40U, 5000U, 1U << 24U}) {
        const auto last = static_cast<std::int32_t>(size);
        for (const std::size_t expected : {1U, 20U, 5000U}) {
            Buckets buckets(GridBox({0, 0}).add({last, last}), expected);
            struct Side {
                GridPoint a, b;
                bool is_in;
            };
            std::vector<Side> sides;
            for (std::uint32_t i = 0; i < 60; ++i) {
                sides.push_back({some_point(random, size), some_point(random, size), true});
                if (i % 5 == 0) sides.back().b = sides.back().a;
                buckets.add(i, sides.back().a, sides.back().b);
            }
            for (std::uint32_t i = 0; i < 60; i += 3) {
                buckets.remove(i, sides[i].a, sides[i].b);
                sides[i].is_in = false;
            }
            for (int round = 0; round < 30; ++round) {
                const GridBox box = GridBox(some_point(random, size)).add(some_point(random, size));
                std::vector<int> found(sides.size(), 0);
                CHECK(buckets.visit(box, [&](std::uint32_t i) { return ++found[i] > 0; }));
                for (std::size_t i = 0; i < sides.size(); ++i) {
                    const hmesh_test::UnitPoint low{box.left, box.top}, high{box.right, box.bottom};
                    const auto in_box = [&](GridPoint p) {
                        return p.x >= box.left && p.x <= box.right && p.y >= box.top && p.y <= box.bottom;
                    };
                    const auto a = wide(sides[i].a), b = wide(sides[i].b);
                    const bool touches = in_box(sides[i].a) || in_box(sides[i].b) || hmesh_test::cuts(a, b, low, high) ||
                                         hmesh_test::touch(a, b, low, {high.x, low.y}) ||
                                         hmesh_test::touch(a, b, low, {low.x, high.y});
                    if (!sides[i].is_in && found[i] != 0) FAIL("side ", i, " is not there any more");
                    if (sides[i].is_in && touches && found[i] == 0) FAIL("side ", i, " is not found");
                }
            }
        }
    }
}

TEST_CASE("a visit ends where its body says so") {
    Buckets buckets(GridBox({0, 0}).add({9, 9}), 4);
    for (std::uint32_t i = 0; i < 4; ++i) buckets.add(i, {5, 5}, {5, 5});
    int calls = 0;
    CHECK_FALSE(buckets.visit(GridBox({5, 5}), [&](std::uint32_t) { return ++calls < 2; }));
    CHECK(calls == 2);
}
