// hmesh - HoleFiller: which triangles fill the hole that a removed vertex leaves.
//
// The hole is the polygon of the vertex's neighbours. It is filled by ears: a corner, the tip, is cut off with its two
// neighbours when they make a triangle of positive area whose circumcircle holds no other corner that is left (O.
// Devillers, "On deletion in Delaunay triangulations", 1999, who finds the next ear with a heap; for the usual 6 corners
// a search is faster). Every decision is exact on the 1/256 px grid. Knows corners by their number only, so that a stage
// may try a removal before it edits any mesh. Cost: about 20 ns a corner at 6 corners, O(k^2) at k.
//
// Why it never gets stuck. A cut ear is a true one: a corner in its closed triangle, on its diagonal too, would be
// strictly inside its circle. So what is left stays a simple polygon, and a simple polygon of 3 corners has an area. If
// all sides of the polygon are edges of some Delaunay triangulation of its corners, as after a removal from one, that
// triangulation fills the polygon, and of its ears (two at least, not next to each other) none is refused, since the
// circles of Delaunay triangles are empty inside; its diagonals are such edges again. Where more than 3 corners lie on a
// circle there are several such triangulations and any ear of any of them will do. An ear that was refused stays so until
// a neighbour of its tip is cut: it would otherwise, put back together with that cut, be an ear of the fuller polygon. So
// one turn and a look back at each cut suffice. In a mesh that is not Delaunay there may be polygons where every ear is
// refused: then the first true ear is cut, and the result is a triangulation all the same.
#ifndef HMESH_MESH_HOLE_FILLER_HPP
#define HMESH_MESH_HOLE_FILLER_HPP

#include <cmath>
#include <cstddef>
#include <vector>

#include "hmesh/core/assert.hpp"
#include "hmesh/mesh/geometry.hpp"

namespace hmesh {

// Three corners of the hole, by their numbers in the ring that was given. The ring runs against the orientation of faces:
// the face of an ear is (after, tip, before).
struct Ear {
    int before, tip, after;
};

class HoleFiller {
  public:
    // The `count` - 2 triangles, in the order of cutting, of the polygon position_at(0), ..., position_at(count - 1),
    // count >= 3. Turning an edge from the removed vertex to each tip but the last makes all of them in turn; the last
    // is what is left. The corners follow each other against the orientation of the faces, as in a one-ring; the polygon
    // is simple and has no corner twice. In an `open` ring, around a vertex on the border, the side from the last corner
    // to the first is the border's, and neither is a tip (the last triangle has them as `after` and `before`).
    // The result holds until the next call; nothing is allocated unless `count` is a new record.
    template <class PositionAt>
    const std::vector<Ear>& fill(int count, PositionAt&& position_at, bool open) {
        HMESH_ASSERT(count >= 3);
        ears_.clear();
        corners_.clear();
        for (int k = 0; k < count; ++k) corners_.push_back({position_at(k), k});
        cut(open ? 1 : 0);
        return ears_;
    }

  private:
    struct Corner {
        Point position;
        int number;
    };

    // `margin` corners at the beginning and as many at the end are no tips.
    void cut(int margin) {
        int size = static_cast<int>(corners_.size()), tip = margin, refused = 0;
        bool any = false;  // whether any true ear will do
        while (size > 3) {
            const int before = tip == 0 ? size - 1 : tip - 1, after = tip + 1 == size ? 0 : tip + 1;
            if (any ? is_true_ear(before, tip, after) : is_delaunay_ear(before, tip, after)) {
                emit(before, tip, after);
                corners_.erase(corners_.begin() + tip);
                --size;
                if (tip > margin) --tip;
                else if (margin == 0) tip = size - 1;
                refused = 0;
                any = false;
                continue;
            }
            if (++tip >= size - margin) tip = margin;
            if (++refused <= size) continue;
            HMESH_ASSERT(!any);  // a simple polygon has a true ear
            refused = 0;
            any = true;
        }
        emit(0, 1, 2);
    }

    void emit(int before, int tip, int after) { ears_.push_back({number(before), number(tip), number(after)}); }
    [[nodiscard]] int number(int i) const noexcept { return corners_[static_cast<std::size_t>(i)].number; }
    [[nodiscard]] Point position(int i) const noexcept { return corners_[static_cast<std::size_t>(i)].position; }

    [[nodiscard]] bool is_delaunay_ear(int before, int tip, int after) const noexcept {
        const Point a = position(after), b = position(tip), c = position(before);
        if (!(cross(a, b, c) > 0)) return false;
        const int size = static_cast<int>(corners_.size());
        for (int i = 0; i < size; ++i)
            if (i != before && i != tip && i != after && in_circle(a, b, c, position(i)) > 0) return false;
        return true;
    }

    [[nodiscard]] bool is_true_ear(int before, int tip, int after) const noexcept {
        const Point a = position(after), b = position(tip), c = position(before);
        if (!(cross(a, b, c) > 0)) return false;
        const int size = static_cast<int>(corners_.size());
        for (int i = 0; i < size; ++i) {
            const Point p = position(i);
            if (i != before && i != tip && i != after && cross(a, b, p) >= 0 && cross(b, c, p) >= 0 && cross(c, a, p) >= 0)
                return false;
        }
        return true;
    }

    std::vector<Ear> ears_;
    std::vector<Corner> corners_;
};

}  // namespace hmesh

#endif  // HMESH_MESH_HOLE_FILLER_HPP
