/// \file
/// Geometry of the grid of 1/256 px: what is asked of its points, segments and triangles, with exact answers, hulls, and which of
/// its points is the nearest to one between them.
#ifndef HMESH_OUTLINE_GRID_GEOMETRY_HPP
#define HMESH_OUTLINE_GRID_GEOMETRY_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "hmesh/outline/contour.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// A rectangle of the plane in units, its border included.
struct GridBox {
    std::int32_t left = 0,  ///< least x
        top = 0,            ///< least y
        right = 0,          ///< largest x
        bottom = 0;         ///< largest y

    /// The least box around a point.
    explicit GridBox(GridPoint p) noexcept : left(p.x), top(p.y), right(p.x), bottom(p.y) {}
    /// Grows it to hold another one.
    GridBox& add(GridPoint p) noexcept {
        left = std::min(left, p.x), right = std::max(right, p.x);
        top = std::min(top, p.y), bottom = std::max(bottom, p.y);
        return *this;
    }
    /// Whether a point is in it.
    [[nodiscard]] bool has(GridPoint p) const noexcept { return p.x >= left && p.x <= right && p.y >= top && p.y <= bottom; }
    /// Clockwise on the screen.
    [[nodiscard]] Loop corners() const { return {{left, top}, {right, top}, {right, bottom}, {left, bottom}}; }
};

/// The least box around polygons, of which there is one at least.
[[nodiscard]] inline GridBox box_of(const std::vector<Loop>& loops) noexcept {
    GridBox box(loops.front().front());
    for (const Loop& loop : loops)
        for (const GridPoint p : loop) box.add(p);
    return box;
}

/// Twice the signed area of the quadrilateral (a, b, c, d) in square units, exact.
[[nodiscard]] constexpr std::int64_t double_area(GridPoint a, GridPoint b, GridPoint c, GridPoint d) noexcept {
    return orient2d(a, b, c) + orient2d(a, c, d);
}

/// Whether the segments from a to b and from c to d have a point in common, their ends included. Exact.
[[nodiscard]] inline bool do_segments_meet(GridPoint a, GridPoint b, GridPoint c, GridPoint d) noexcept {
    if (std::max(a.x, b.x) < std::min(c.x, d.x) || std::max(c.x, d.x) < std::min(a.x, b.x) ||
        std::max(a.y, b.y) < std::min(c.y, d.y) || std::max(c.y, d.y) < std::min(a.y, b.y))
        return false;
    const auto sign = [](std::int64_t x) { return x > 0 ? 1 : x < 0 ? -1 : 0; };
    return sign(orient2d(a, b, c)) * sign(orient2d(a, b, d)) <= 0 && sign(orient2d(c, d, a)) * sign(orient2d(c, d, b)) <= 0;
}

/// Whether the segments from a to b and from c to d cross each other at a point that is no end of either. Exact.
[[nodiscard]] inline bool do_segments_cross(GridPoint a, GridPoint b, GridPoint c, GridPoint d) noexcept {
    const auto differ = [](std::int64_t x, std::int64_t y) { return (x > 0 && y < 0) || (x < 0 && y > 0); };
    return differ(orient2d(a, b, c), orient2d(a, b, d)) && differ(orient2d(c, d, a), orient2d(c, d, b));
}

/// Whether p is in the triangle (a, b, c), of either orientation, or on its border. Exact; a triangle of no area holds nothing
/// but its longest side.
[[nodiscard]] inline bool is_in_triangle(GridPoint a, GridPoint b, GridPoint c, GridPoint p) noexcept {
    const std::int64_t ab = orient2d(a, b, p), bc = orient2d(b, c, p), ca = orient2d(c, a, p);
    if (ab == 0 && bc == 0 && ca == 0) return GridBox(a).add(b).add(c).has(p);
    return (ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0);
}

/// The convex hull of points, clockwise on the screen, without corners of 180 degrees (Andrew's monotone chain). O(n log n).
[[nodiscard]] inline Loop convex_hull(Loop points) {
    std::sort(points.begin(), points.end(), [](GridPoint a, GridPoint b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
    points.erase(std::unique(points.begin(), points.end()), points.end());
    if (points.size() < 3) return points;
    Loop hull;
    hull.reserve(points.size() + 1);
    for (int pass = 0; pass < 2; ++pass) {
        const std::size_t start = hull.size();
        for (const GridPoint p : points) {
            while (hull.size() >= start + 2 && orient2d(hull[hull.size() - 2], hull.back(), p) <= 0) hull.pop_back();
            hull.push_back(p);
        }
        hull.pop_back();
        std::reverse(points.begin(), points.end());
    }
    return hull;
}

/// A point between those of the grid, in the same units.
struct RealPoint {
    double x = 0,  ///< from the left
        y = 0;     ///< from the top
};

/// Of the 16 points of the grid around p that are within a box, the one of the least cost that is good, if any is. Of several the
/// first, row after row.
template <class IsGood, class Cost>
[[nodiscard]] std::optional<GridPoint> nearest_point(RealPoint p, const GridBox& within, IsGood&& is_good, Cost&& cost) {
    // What is farther out has no such point, and may have no place among whole numbers.
    if (!(p.x > within.left - 2.0 && p.x < within.right + 2.0 && p.y > within.top - 2.0 && p.y < within.bottom + 2.0)) return {};
    const auto x = static_cast<std::int32_t>(std::floor(p.x)), y = static_cast<std::int32_t>(std::floor(p.y));
    std::optional<GridPoint> best;
    double least = std::numeric_limits<double>::max();
    for (std::int32_t j = y - 1; j <= y + 2; ++j)
        for (std::int32_t i = x - 1; i <= x + 2; ++i) {
            const GridPoint candidate{i, j};
            if (!within.has(candidate) || !is_good(candidate)) continue;
            if (const double its_cost = cost(candidate); its_cost < least) least = its_cost, best = candidate;
        }
    return best;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_OUTLINE_GRID_GEOMETRY_HPP
