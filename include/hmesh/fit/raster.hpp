/// \file
/// Rasterization: which pixels a face owns, row by row.
///
/// A pixel belongs to the face that holds its centre; a centre on an edge belongs to the face to the right of the edge or, if
/// the edge is level, below it: the top-left rule of Direct3D, Vulkan and most OpenGL drivers. Only first_row() and EdgeWalker
/// decide this, for the moments that fit a mesh as for the pictures drawn of it, so that the spans of a mesh's faces cover each
/// pixel once. Samples that are points lie on the mesh's border too, where the rule has an exception: FarSides.
#ifndef HMESH_FIT_RASTER_HPP
#define HMESH_FIT_RASTER_HPP

#include <algorithm>
#include <limits>
#include <utility>

#include "hmesh/core/compiler.hpp"
#include "hmesh/core/lanes.hpp"
#include "hmesh/mesh/geometry.hpp"
#include "hmesh/mesh/samples.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// Centres that are so much left of an edge, or above its upper end, are taken to be on it, px.
inline constexpr double center_slack = 1.0 / 8589934592.0;  // 2^-33

/// The first row whose centre is not above y, y >= 0. An edge from a down to b crosses the rows [first_row(a.y),
/// first_row(b.y)). The slack makes ceil(y - 1/2) one truncation; on the 1/256 px grid it moves no centre.
[[nodiscard]] HMESH_ALWAYS_INLINE int first_row(double y) noexcept { return truncated(y + (0.5 - center_slack)); }

/// An edge from a down to b, a.y < b.y, as one column a row: column(j) is the first pixel of row j whose centre is not left of
/// the edge.
///
/// The slack keeps centres that lie on the edge to its right in spite of rounding (errors stay below 2^-35 px for coordinates
/// below 2^16) and moves no other centre: on the 1/256 px grid the distance along a row from a centre to an edge of d rows is a
/// multiple of 2^-8 / (2^8 d) px, at least 2^-32 px for the longest edge.
class EdgeWalker {
  public:
    /// The edge from a down to b, a.y < b.y.
    HMESH_ALWAYS_INLINE EdgeWalker(Point a, Point b) noexcept
        : slope_((b.x - a.x) / (b.y - a.y)), start_y_(a.y - 0.5), start_x_(a.x + (0.5 - center_slack)) {}
    /// The first pixel of row j whose centre is not left of the edge, first_row(a.y) <= j < first_row(b.y).
    [[nodiscard]] HMESH_ALWAYS_INLINE int column(int j) const noexcept { return column(static_cast<double>(j)); }
    /// The same with j as a double.
    [[nodiscard]] HMESH_ALWAYS_INLINE int column(double j) const noexcept { return column_below(j - start_y_); }
    /// How far the centres of row j are below a, in px; exact on the 1/256 px grid.
    [[nodiscard]] HMESH_ALWAYS_INLINE double below(int j) const noexcept { return j - start_y_; }
    /// column() of the row whose centres are so far below a.
    [[nodiscard]] HMESH_ALWAYS_INLINE int column_below(double px) const noexcept { return truncated(start_x_ + px * slope_); }

  private:
    double slope_, start_y_, start_x_;
};

/// The right and the lower side of a mesh whose outermost samples have their centres on its sides, as those of Samples::points
/// do. The top-left rule gives these centres to faces beyond the mesh, where there are none. On these two lines alone they
/// belong to the face that ends there: the row on the lower side to edges that end on it, and the column on the right side is
/// left of edges along it. Beyond all points, as by default: no centre lies on a side, and the rule has no exception.
struct FarSides {
    double right = std::numeric_limits<double>::max(),  ///< x of the right side, px: that of the last column's centres
        bottom = std::numeric_limits<double>::max();    ///< y of the lower side, px: that of the last row's centres

    /// The first row whose centre is not above y, or the one after the last for the lower side.
    [[nodiscard]] HMESH_ALWAYS_INLINE int first_row(double y) const noexcept { return kit::first_row(y) + (y == bottom ? 1 : 0); }
    /// How far to the right the edge from a to b is taken to be, so that the centres on it are left of it: 1/2 px along the right
    /// side, else 0.
    [[nodiscard]] HMESH_ALWAYS_INLINE double beyond(Point a, Point b) const noexcept {
        return a.x == right && b.x == right ? 0.5 : 0;
    }
    /// The edge from a down to b, a.y < b.y.
    [[nodiscard]] HMESH_ALWAYS_INLINE EdgeWalker walker(Point a, Point b) const noexcept {
        const double x = beyond(a, b);
        return {{a.x + x, a.y}, {b.x + x, b.y}};
    }
};

/// The far sides of meshes of width * height px while they are fitted (mesh/samples.hpp).
[[nodiscard]] inline FarSides far_sides(int width, int height, Samples samples) noexcept {
    if (samples == Samples::squares) return {};
    return {width - 0.5, height - 0.5};
}

/// barycentric() at the centres of the pixels that a face owns. The weights of b and c are clamped to [0, 1]: rounding of an
/// edge can leave a centre outside, which is much for a face of no width. They are divided by the area last: on the 1/256 px
/// grid everything before that is exact, however thin the face.
class PixelBarycentric {
  public:
    /// The face (a, b, c), of either orientation. Where it has no area, a has all the weight.
    HMESH_ALWAYS_INLINE PixelBarycentric(Point a, Point b, Point c) noexcept
        : a_(a), ab_{b.x - a.x, b.y - a.y}, ac_{c.x - a.x, c.y - a.y} {
        const double area = orient2d(a, b, c);
        per_area_ = area != 0 ? 1 / area : 0;
    }
    /// The barycentric coordinates of the centre of pixel (i, j).
    [[nodiscard]] HMESH_ALWAYS_INLINE Barycentric operator()(int i, int j) const noexcept {
        const double x = i + 0.5 - a_.x, y = j + 0.5 - a_.y;
        const double b = std::max(0.0, std::min(1.0, (x * ac_.y - ac_.x * y) * per_area_));
        const double c = std::max(0.0, std::min(1.0 - b, (ab_.x * y - x * ab_.y) * per_area_));
        return {1 - b - c, b, c};
    }

  private:
    Point a_, ab_, ac_;
    double per_area_;
};

/// The part of a picture that is drawn: rows [first, last), columns [0, width). By default everything.
struct ClipRect {
    int width = std::numeric_limits<int>::max();  ///< number of columns
    int first = 0,                                ///< first row
        last = std::numeric_limits<int>::max();   ///< end of the rows
    FarSides sides{};                             ///< of the mesh, in the picture

    /// The first row whose centre is not above y, clamped to [first, last].
    [[nodiscard]] int row(double y) const noexcept {
        return sides.first_row(std::max(static_cast<double>(first), std::min(static_cast<double>(last), y)));
    }
};

/// Calls body(j, begin, end) for each row j, top to bottom, in which the face (a, b, c), of either orientation, owns pixels:
/// [begin, end), begin < end, clipped. Columns of corners must fit an int.
template <class Body>
void for_each_span(Point a, Point b, Point c, const ClipRect& clip, Body&& body) {
    if (b.y < a.y) std::swap(a, b);
    if (c.y < b.y) std::swap(b, c);
    if (b.y < a.y) std::swap(a, b);
    const auto between = [&](Point upper, Point lower) {
        const int first = clip.row(upper.y), last = clip.row(lower.y);
        if (first >= last) return;
        const EdgeWalker side = clip.sides.walker(upper, lower), opposite = clip.sides.walker(a, c);
        for (int j = first; j < last; ++j) {
            const int one = side.column(j), other = opposite.column(j);
            const int begin = std::max(0, std::min(one, other)), end = std::min(clip.width, std::max(one, other));
            if (begin < end) body(j, begin, end);
        }
    };
    between(a, b);
    between(b, c);
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_FIT_RASTER_HPP
