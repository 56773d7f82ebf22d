// hmesh tests - circles through grid points in integers of 1/256 px, exact without a second thought.
#ifndef HMESH_TESTS_EXACT_CIRCLES_HPP
#define HMESH_TESTS_EXACT_CIRCLES_HPP

#include <cmath>
#include <cstdint>

#include "hmesh/mesh/geometry.hpp"
#include "wide.hpp"

namespace hmesh_test {

struct GridPoint {
    std::int64_t x, y;
};

inline GridPoint on_grid(hmesh::kit::Point p) { return {std::llround(p.x * 256), std::llround(p.y * 256)}; }

inline std::int64_t double_area(GridPoint a, GridPoint b, GridPoint c) {
    return (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
}

// Positive where d is inside the circle through the positively oriented a, b, c, 0 on it.
inline Wide circle_test(GridPoint a, GridPoint b, GridPoint c, GridPoint d) {
    const auto lift = [d](GridPoint p) {
        const std::int64_t x = p.x - d.x, y = p.y - d.y;
        return Wide{x * x + y * y};
    };
    return lift(a) * double_area(d, b, c) + lift(b) * double_area(d, c, a) + lift(c) * double_area(d, a, b);
}

}  // namespace hmesh_test

#endif  // HMESH_TESTS_EXACT_CIRCLES_HPP
