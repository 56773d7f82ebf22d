// hmesh - spans: the pixels of a face, row by row.
//
// A pixel belongs to a face by the top-left rule (mesh/geometry.hpp), so the spans of a mesh's faces cover each pixel once.
#ifndef HMESH_MESH_RASTER_HPP
#define HMESH_MESH_RASTER_HPP

#include <algorithm>
#include <limits>
#include <utility>

#include "hmesh/mesh/geometry.hpp"

namespace hmesh::kit {

// What is seen of a picture: rows [first, last), columns [0, width). By default all that there may be.
struct ClipRect {
    int width = std::numeric_limits<int>::max();
    int first = 0, last = std::numeric_limits<int>::max();

    // first_row(y) of y held to the rows seen.
    [[nodiscard]] int row(double y) const noexcept {
        return first_row(std::max(static_cast<double>(first), std::min(static_cast<double>(last), y)));
    }
};

// Calls body(j, begin, end) for the pixels [begin, end), begin < end, of each row j that the face a, b, c owns, down the rows.
// Either orientation will do; columns of corners fit an int.
template <class Body>
void for_each_span(Point a, Point b, Point c, const ClipRect& clip, Body&& body) {
    if (b.y < a.y) std::swap(a, b);
    if (c.y < b.y) std::swap(b, c);
    if (b.y < a.y) std::swap(a, b);
    const auto between = [&](Point upper, Point lower) {
        const int first = clip.row(upper.y), last = clip.row(lower.y);
        if (first >= last) return;
        const EdgeWalker side(upper, lower), opposite(a, c);
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

#endif  // HMESH_MESH_RASTER_HPP
