// hmesh tests - circles through points of the grid in whole numbers.
#ifndef HMESH_TESTS_EXACT_CIRCLES_HPP
#define HMESH_TESTS_EXACT_CIRCLES_HPP

#include <cstdint>

#include "grid_point.hpp"
#include "wide.hpp"

namespace hmesh_test {

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
