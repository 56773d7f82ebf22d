// hmesh tests - points of the 1/256 px grid in whole numbers, exact without a second thought.
#ifndef HMESH_TESTS_GRID_POINT_HPP
#define HMESH_TESTS_GRID_POINT_HPP

#include <cmath>
#include <cstdint>

#include "hmesh/mesh/geometry.hpp"

namespace hmesh_test {

struct GridPoint {
    std::int64_t x = 0, y = 0;
};

inline GridPoint on_grid(hmesh::kit::Point p) { return {std::llround(p.x * 256), std::llround(p.y * 256)}; }

// Positive where a, b, c turn as faces do.
inline std::int64_t double_area(GridPoint a, GridPoint b, GridPoint c) {
    return (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
}

}  // namespace hmesh_test

#endif  // HMESH_TESTS_GRID_POINT_HPP
