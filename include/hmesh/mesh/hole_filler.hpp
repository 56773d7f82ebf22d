/// \file
/// HoleFiller: which triangles fill the hole that a removed vertex leaves.
///
/// The hole is the polygon of the removed vertex's neighbours. It is filled by ears: a corner of the polygon, the tip, is cut
/// off with its two neighbours if the three make a triangle of positive area whose circumcircle holds no other remaining corner
/// (O. Devillers, "On deletion in Delaunay triangulations", 1999, who finds the next ear with a heap; for the usual 6 corners a
/// search is faster). Every decision is exact on the 1/256 px grid. Corners are known by number only, so that a stage may try a
/// removal before it edits any mesh. Cost: about 70 ns for 6 corners, 300 ns for 12, O(k^2) for k.
///
/// Why it always ends with a triangulation:
///
/// 1. Invariant: what remains is a simple polygon. A corner in the closed triangle of a cut ear, or on its diagonal, would be
///    strictly inside the ear's circumcircle, so a cut ear is a true ear. A simple polygon of 3 corners has a positive area.
/// 2. Existence: if all sides of the polygon are edges of some Delaunay triangulation of its corners, as after a removal from
///    one, that triangulation fills the polygon. None of its ears (at least two that are not adjacent) is refused, since the
///    circumcircles of Delaunay triangles are empty inside, and the diagonals of these ears are such edges again. Where more
///    than 3 corners are cocircular there are several such triangulations, and any ear of any of them will do.
/// 3. Refused ears stay refused until a neighbour of their tip is cut: otherwise, put back together with that cut, the ear
///    would be an ear of the fuller polygon. So one turn and a look back at each cut suffice.
/// 4. Fallback: in a mesh that is not Delaunay every ear of a polygon may be refused. Then the first true ear is cut (each
///    simple polygon has two that are not adjacent: G. Meisters, "Polygons have ears", 1975), and the result is still a
///    triangulation.
#ifndef HMESH_MESH_HOLE_FILLER_HPP
#define HMESH_MESH_HOLE_FILLER_HPP

#include <cmath>
#include <cstddef>

#include "hmesh/core/array.hpp"
#include "hmesh/core/assert.hpp"
#include "hmesh/mesh/geometry.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// A triangle of the filling: three corners of the hole, by their numbers in the ring given to HoleFiller::fill(). The ring
/// runs against the orientation of faces, so the face of an ear is (after, tip, before).
struct Ear {
    int before,  ///< the corner before the tip
        tip,     ///< the corner that is cut off
        after;   ///< the corner after the tip
};

namespace detail {

/// The circle through the positively oriented a, b, c, for tests of many points against it: in_circle(), expanded around b.
class Circle {
  public:
    Circle(Point a, Point b, Point c) noexcept : a_(a), b_(b), c_(c) {
        const double ax = a.x - b.x, ay = a.y - b.y, cx = c.x - b.x, cy = c.y - b.y;
        const double aa = ax * ax + ay * ay, cc = cx * cx + cy * cy;
        area_ = cx * ay - cy * ax;
        x_ = cy * aa - ay * cc, y_ = ax * cc - cx * aa;
        size_x_ = std::abs(cy) * aa + std::abs(ay) * cc, size_y_ = std::abs(ax) * cc + std::abs(cx) * aa;
    }
    [[nodiscard]] bool is_positive() const noexcept { return area_ > 0; }
    /// Whether p is strictly inside. Exact on the 1/256 px grid.
    [[nodiscard]] bool holds(Point p) const noexcept {
        const double x = p.x - b_.x, y = p.y - b_.y, square = x * x + y * y;
        const double outside = area_ * square + x_ * x + y_ * y;
        // Differences, areas and squares are exact; a term passes at most five roundings of 2^-53, the rest is for those
        // of the bound itself.
        const double bound = (area_ * square + size_x_ * std::abs(x) + size_y_ * std::abs(y)) * (8.0 / 9007199254740992.0);
        if (std::abs(outside) > bound) return outside < 0;
        return in_circle(a_, b_, c_, p) > 0;
    }

  private:
    Point a_, b_, c_;
    double area_, x_, y_, size_x_, size_y_;
};

}  // namespace detail

/// Finds the triangles that fill the hole of a removed vertex. Keep one object: it keeps its memory.
class HoleFiller {
  public:
    /// The `count` - 2 triangles that fill the polygon position_at(0), ..., position_at(count - 1), count >= 3, in the order in
    /// which they are cut. Flipping the edge from the removed vertex to the tip of each ear but the last makes the triangles in
    /// turn; the last one is what remains.
    ///
    /// The corners follow each other against the orientation of the faces, as in a one-ring. The polygon must be simple: no
    /// side meets another and no corner occurs twice (otherwise some faces have no area). In an `open` ring, around a boundary
    /// vertex, the side from the last corner to the first is on the boundary, and neither of the two is a tip (the last
    /// triangle has them as `after` and `before`).
    ///
    /// The result is valid until the next call. Nothing is allocated unless `count` is larger than ever before.
    template <class PositionAt>
    const Array<Ear>& fill(int count, PositionAt&& position_at, bool open) {
        HMESH_ASSERT(count >= 3);
        const auto size = static_cast<std::size_t>(count);
        if (corners_.size() < size) corners_.resize(size);
        ears_.resize(size - 2);
        for (int k = 0; k < count; ++k) corners_[static_cast<std::size_t>(k)] = {position_at(k), k};
        cut(count, open ? 1 : 0);
        return ears_;
    }

  private:
    struct Corner {
        Point position;
        int number;
    };

    /// Cuts ears of `size` corners. The first `margin` corners and the last `margin` ones are no tips.
    void cut(int size, int margin) {
        Corner* const corners = corners_.data();
        Ear* ear = ears_.data();
        // What is asked of a tip: an empty circle; after a turn in vain a true ear; of a polygon that is not simple, nothing.
        enum { empty_circle, true_ear, nothing } demand = empty_circle;
        int tip = margin, refused = 0;
        while (size > 3) {
            const int before = tip == 0 ? size - 1 : tip - 1, after = tip + 1 == size ? 0 : tip + 1;
            const bool ok = demand == empty_circle ? is_delaunay_ear(size, before, tip, after)
                                                   : demand == nothing || is_true_ear(size, before, tip, after);
            if (ok) {
                *ear++ = {corners[before].number, corners[tip].number, corners[after].number};
                --size;
                for (int i = tip; i < size; ++i) corners[i] = corners[i + 1];
                if (tip > margin) --tip;
                else if (margin == 0) tip = size - 1;
                refused = 0;
                demand = empty_circle;
                continue;
            }
            if (++tip >= size - margin) tip = margin;
            if (++refused <= size) continue;
            refused = 0;
            demand = demand == empty_circle ? true_ear : nothing;
        }
        *ear = {corners[0].number, corners[1].number, corners[2].number};
    }

    [[nodiscard]] bool is_delaunay_ear(int size, int before, int tip, int after) const noexcept {
        const Corner* const corners = corners_.data();
        const detail::Circle circle(corners[after].position, corners[tip].position, corners[before].position);
        if (!circle.is_positive()) return false;
        for (int i = 0; i < size; ++i)
            if (i != before && i != tip && i != after && circle.holds(corners[i].position)) return false;
        return true;
    }

    [[nodiscard]] bool is_true_ear(int size, int before, int tip, int after) const noexcept {
        const Corner* const corners = corners_.data();
        const Point a = corners[after].position, b = corners[tip].position, c = corners[before].position;
        if (!(orient2d(a, b, c) > 0)) return false;
        for (int i = 0; i < size; ++i) {
            const Point p = corners[i].position;
            if (i != before && i != tip && i != after && orient2d(a, b, p) >= 0 && orient2d(b, c, p) >= 0 &&
                orient2d(c, a, p) >= 0)
                return false;
        }
        return true;
    }

    Array<Ear> ears_;
    Array<Corner> corners_;
};

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_MESH_HOLE_FILLER_HPP
