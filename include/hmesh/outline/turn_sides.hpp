/// \file
/// turn_sides(): sides of polygons are turned around what they touch, as long as that leaves less area.
///
/// Of least area, a side touches in its middle or in two points. Where that is between the lines of its neighbours is found in
/// real numbers. Whether it may stand there, once its ends are on the grid, is asked in whole ones, so that contours stay inside
/// and sides never meet, however positions were rounded. Cost: some 2 us for each corner of the contours and each time that all
/// sides are looked at.
#ifndef HMESH_OUTLINE_TURN_SIDES_HPP
#define HMESH_OUTLINE_TURN_SIDES_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "hmesh/outline/contour.hpp"
#include "hmesh/outline/grid_geometry.hpp"
#include "hmesh/outline/polygons.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

namespace detail {

/// A line through a point, with its direction.
struct DirectedLine {
    RealPoint at;   ///< a point of it
    double dx = 0,  ///< to the right
        dy = 0;     ///< down
};

/// The ends of a side, before they are on the grid.
struct RealSide {
    RealPoint b,  ///< where it begins
        c;        ///< where it ends
};

/// The ends of a side.
struct GridSide {
    GridPoint b,  ///< where it begins
        c;        ///< where it ends
};

/// The same point.
[[nodiscard]] inline RealPoint real_point(GridPoint p) noexcept { return {static_cast<double>(p.x), static_cast<double>(p.y)}; }

// --- where a side would stand best ---

/// Where a line meets that from a over b; nothing: nowhere, or on the other side of a.
[[nodiscard]] inline std::optional<RealPoint> meet(const DirectedLine& line, GridPoint a, GridPoint b) noexcept {
    const double ux = static_cast<double>(b.x) - a.x, uy = static_cast<double>(b.y) - a.y;
    const double across = ux * line.dy - uy * line.dx;
    if (across == 0) return {};
    const double share = ((line.at.x - a.x) * line.dy - (line.at.y - a.y) * line.dx) / across;
    if (!(share > 0)) return {};
    return RealPoint{a.x + share * ux, a.y + share * uy};
}

/// The hull of what the side touches or may touch once turned: of the contour along it and, where its ends are convex, along
/// its neighbours.
[[nodiscard]] inline Loop touchable_hull(const Polygons& polygons, const ThreeSides& s) {
    Loop points;
    const auto gather = [&](std::uint32_t side) { polygons.along_contour(side, [&](GridPoint p) { points.push_back(p); }); };
    gather(s.from);
    if (orient2d(s.a, s.b, s.c) > 0) gather(s.before);
    if (orient2d(s.b, s.c, s.d) > 0) gather(s.to);
    return convex_hull(std::move(points));
}

/// Of lines along which the middle one of three sides might run, the best.
class BestLine {
  public:
    /// Of these sides, as they are.
    explicit BestLine(const ThreeSides& sides) : s_(sides), least_(area_of({real_point(s_.b), real_point(s_.c)}) - enough) {}

    /// Tries one, with what has to be inside to its right.
    void try_line(const DirectedLine& line) {
        const std::optional<RealPoint> b = meet(line, s_.a, s_.b);
        if (!b) return;
        const std::optional<RealPoint> c = meet(line, s_.d, s_.c);
        if (!c || (c->x - b->x) * line.dx + (c->y - b->y) * line.dy <= 0) return;
        // Of lines far beyond the next corners the price is another one.
        if (const double area = area_of({*b, *c}); area < least_) least_ = area, best_ = {*b, *c};
    }
    /// The ends of the side along the best; nothing: it is best as it is.
    [[nodiscard]] const std::optional<RealSide>& best() const noexcept { return best_; }

  private:
    // What twice the area is to become smaller by at least: 1/100 px^2.
    static constexpr double enough = 0.02 * units_per_px * units_per_px;

    // Twice the area of (a, b, c, d).
    [[nodiscard]] double area_of(const RealSide& side) const noexcept {
        const GridPoint a = s_.a, d = s_.d;
        const RealPoint p = side.b, q = side.c;
        return (p.x - a.x) * (q.y - a.y) - (q.x - a.x) * (p.y - a.y) + (q.x - a.x) * (static_cast<double>(d.y) - a.y) -
               (static_cast<double>(d.x) - a.x) * (q.y - a.y);
    }

    ThreeSides s_;
    double least_;
    std::optional<RealSide> best_;
};

/// The best place for the side from b to c that there is between the lines of its neighbours, if it is better than that.
[[nodiscard]] inline std::optional<RealSide> best_place(const Polygons& polygons, const ThreeSides& s) {
    const Loop hull = touchable_hull(polygons, s);
    if (hull.size() < 3) return {};
    BestLine lines(s);
    for (std::size_t i = 0; i < hull.size(); ++i) {
        const RealPoint o = real_point(hull[(i + hull.size() - 1) % hull.size()]), p = real_point(hull[i]),
                        q = real_point(hull[(i + 1) % hull.size()]);
        const DirectedLine along_hull{p, q.x - p.x, q.y - p.y};
        lines.try_line(along_hull);
        // The line on which p is in the middle: through where the mirror image of the line d c meets that of a b.
        const std::optional<RealPoint> in_b =
            meet({{2 * p.x - s.c.x, 2 * p.y - s.c.y}, static_cast<double>(s.d.x) - s.c.x, static_cast<double>(s.d.y) - s.c.y},
                 s.a, s.b);
        if (!in_b) continue;
        const DirectedLine halved{p, p.x - in_b->x, p.y - in_b->y};
        const double from_x = p.x - o.x, from_y = p.y - o.y;
        if (from_x * halved.dy - from_y * halved.dx >= 0 && halved.dx * along_hull.dy - halved.dy * along_hull.dx >= 0)
            lines.try_line(halved);
    }
    return lines.best();
}

// --- whether it may stand there ---

/// The points of the grid nearest to the ends of a side that are within the image, and inside of neither it nor its neighbours.
[[nodiscard]] inline std::optional<GridSide> on_grid(const ThreeSides& s, const RealSide& side, const GridBox& image) {
    const RealPoint p = side.b, q = side.c;
    const double slack = 1e-6 * (std::abs(q.x - p.x) + std::abs(q.y - p.y));
    const auto is_outside = [&](GridPoint g) { return (q.x - p.x) * (g.y - p.y) - (g.x - p.x) * (q.y - p.y) <= slack; };
    const auto squared = [](GridPoint g, RealPoint r) { return (g.x - r.x) * (g.x - r.x) + (g.y - r.y) * (g.y - r.y); };
    const std::optional<GridPoint> b = nearest_point(
        p, image, [&](GridPoint g) { return orient2d(s.a, s.b, g) <= 0 && is_outside(g); },
        [&](GridPoint g) { return squared(g, p); });
    if (!b) return {};
    const std::optional<GridPoint> c = nearest_point(
        q, image, [&](GridPoint g) { return orient2d(s.c, s.d, g) <= 0 && is_outside(g); },
        [&](GridPoint g) { return squared(g, q); });
    if (!c) return {};
    return GridSide{*b, *c};
}

/// Whether the three sides would fold or meet each other, with the middle one at `to`.
[[nodiscard]] inline bool is_folded(const Polygons& polygons, const ThreeSides& s, const GridSide& to) {
    if (to.b == to.c || to.b == s.a || to.c == s.d) return true;
    // Lines turned past the next corner fold over.
    if (along(s.a, s.a, s.b, to.b) <= 0 || along(s.d, s.d, s.c, to.c) <= 0) return true;
    if (s.before == s.last) {  // a triangle, which stays border or hole
        const std::int64_t turn_of_all = orient2d(s.a, to.b, to.c);
        if (turn_of_all == 0 || (turn_of_all > 0) == polygons.is_hole(polygons.loop_of(s.from))) return true;
    } else if (do_segments_meet(s.a, to.b, to.c, s.d)) {
        return true;
    }
    const auto turns_back = [](GridPoint u, GridPoint at, GridPoint w) {
        return orient2d(u, at, w) == 0 && along(at, at, u, w) > 0;
    };
    return turns_back(s.a, to.b, to.c) || turns_back(to.b, to.c, s.d);
}

/// Whether none of the three sides would meet another one, with the middle one at `to`.
[[nodiscard]] inline bool are_sides_free(const Polygons& polygons, const ThreeSides& s, const GridSide& to) {
    const std::array<std::uint32_t, 3> gone = {s.before, s.from, s.to};
    return polygons.is_side_free({s.before, s.a}, {s.from, to.b}, gone) &&
           polygons.is_side_free({s.from, to.b}, {s.to, to.c}, gone) && polygons.is_side_free({s.to, to.c}, {s.last, s.d}, gone);
}

/// Whether in a triangle there is neither another corner nor one of the contours, but for those that may_be(p) there.
template <class MayBe>
[[nodiscard]] bool is_clear(const Polygons& polygons, const ThreeSides& s, const std::array<GridPoint, 3>& triangle,
                            MayBe&& may_be) {
    const GridPoint t = triangle[0], u = triangle[1], w = triangle[2];
    const GridBox box = GridBox(t).add(u).add(w);
    return polygons.visit_sides(box, [&](std::uint32_t v) {
        return v == s.before || v == s.from || v == s.to || v == s.last || !is_in_triangle(t, u, w, polygons.at(v));
    }) && polygons.visit_contours(box, [&](GridPoint p, GridPoint /*next*/) { return !is_in_triangle(t, u, w, p) || may_be(p); });
}

/// Whether a side of the contours crosses the segment from p to q.
[[nodiscard]] inline bool is_contour_crossed(const Polygons& polygons, GridPoint p, GridPoint q) {
    return !polygons.visit_contours(GridBox(p).add(q), [&](GridPoint a, GridPoint b) { return !do_segments_cross(p, q, a, b); });
}

/// Whether nothing that was inside would come to lie outside, with the middle one of the three sides at `to`.
[[nodiscard]] inline bool is_all_inside(const Polygons& polygons, const ThreeSides& s, const GridSide& to) {
    // Outside of the new side and, where a corner that is not convex moves on along its other side, of that; but for what is
    // beside that which is left of the others.
    const bool cuts_first = orient2d(s.a, s.b, s.c) < 0 && along(s.b, s.a, s.b, to.b) > 0;
    const bool cuts_last = orient2d(s.b, s.c, s.d) < 0 && along(s.c, s.d, s.c, to.c) > 0;
    // What moves on so is a tip, into which a side of the contour may run without a corner of its own there.
    if ((cuts_first || cuts_last) && (is_contour_crossed(polygons, s.b, to.b) || is_contour_crossed(polygons, to.b, to.c) ||
                                      is_contour_crossed(polygons, to.c, s.c)))
        return false;
    const auto stays = [&](GridPoint p) {
        return orient2d(to.b, to.c, p) >= 0 && (!cuts_first || orient2d(s.a, to.b, p) >= 0) &&
               (!cuts_last || orient2d(to.c, s.d, p) >= 0);
    };
    const auto is_beside_first = [&](GridPoint p) { return stays(p) || along(to.b, s.a, s.b, p) <= 0; };
    const auto is_beside_last = [&](GridPoint p) { return stays(p) || along(to.c, s.d, s.c, p) <= 0; };
    return is_clear(polygons, s, {s.a, s.b, to.b}, is_beside_first) && is_clear(polygons, s, {s.b, s.c, to.c}, stays) &&
           is_clear(polygons, s, {s.b, to.c, to.b}, stays) && is_clear(polygons, s, {s.c, s.d, to.c}, is_beside_last);
}

/// Turns the side from v on to the best place that there is, if all stays as it must be. Whether it could.
inline bool turn(Polygons& polygons, std::uint32_t v) {
    const ThreeSides s = polygons.three_sides(v);
    const std::optional<RealSide> best = best_place(polygons, s);
    if (!best) return false;
    const std::optional<GridSide> to = on_grid(s, *best, polygons.image());
    if (!to || double_area(s.a, to->b, to->c, s.d) >= double_area(s.a, s.b, s.c, s.d)) return false;
    if (is_folded(polygons, s, *to) || !are_sides_free(polygons, s, *to) || !is_all_inside(polygons, s, *to)) return false;
    polygons.move_side(v, to->b, to->c);
    return true;
}

}  // namespace detail

/// Turns sides as long as that makes the area smaller, some passes over all.
inline void turn_sides(Polygons& polygons) {
    constexpr int passes = 12;
    for (int pass = 0; pass < passes; ++pass) {
        bool is_last = true;
        for (std::uint32_t v = 0; v < polygons.numbers(); ++v)
            if (polygons.has(v) && detail::turn(polygons, v)) is_last = false;
        if (is_last) return;
    }
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_OUTLINE_TURN_SIDES_HPP
