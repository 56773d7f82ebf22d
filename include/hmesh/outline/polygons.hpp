/// \file
/// Polygons that lose corners, side by side with the contours that they cover: linked corners, and what keeps track of them.
///
/// It is known of each side which part of the contour it runs along, and of each place which sides of polygons and of contours
/// are there. Whether a change leaves contours inside and sides apart is for those to ask who make it, with what is told here.
/// Cost: some 100 bytes for each corner of the contours; a change takes as long as its sides are in squares of the buckets.
#ifndef HMESH_OUTLINE_POLYGONS_HPP
#define HMESH_OUTLINE_POLYGONS_HPP

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "hmesh/outline/buckets.hpp"
#include "hmesh/outline/contour.hpp"
#include "hmesh/outline/grid_geometry.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// A side, from b to c, and its neighbours: four corners in a row. In a triangle the last is the first.
struct ThreeSides {
    std::uint32_t before,  ///< the corner at a
        from,              ///< that at b
        to,                ///< that at c
        last;              ///< that at d
    GridPoint a,           ///< where the side before begins
        b,                 ///< where this one does
        c,                 ///< where it ends
        d;                 ///< where the side behind does
};

/// Polygons that begin as contours, each a ring of corners. A side has the number of the corner at which it begins.
///
/// What is always so: next() and previous() of the corners that are left are each other's inverse and stay within a loop; sides
/// along a loop run along all of its contour, one part after another, each from its first to its last corner; the buckets hold
/// just the sides that there are; corners and areas are the sums of those of the loops.
class Polygons {
  public:
    /// Stands for no corner.
    static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

    /// The end of a side that there may be.
    struct End {
        std::uint32_t corner;  ///< its number
        GridPoint at;          ///< where it would be
    };

    /// Of contours_of() an image of this size in px, or polygons like them.
    Polygons(const std::vector<Loop>& contours, int width, int height)
        : image_(GridBox({0, 0}).add({width * units_per_px, height * units_per_px})),
          sides_(box_of(contours), count(contours) / 2), touched_(box_of(contours), count(contours) / 2) {
        for (const Loop& contour : contours) {
            const auto first = static_cast<std::uint32_t>(at_.size()), size = static_cast<std::uint32_t>(contour.size());
            for (std::uint32_t i = 0; i < size; ++i) {
                at_.push_back(contour[i]), contour_.push_back(contour[i]);
                next_.push_back(first + (i + 1) % size);
                previous_.push_back(first + (i + size - 1) % size);
                loop_of_.push_back(static_cast<std::uint32_t>(parts_.size()));
                from_.push_back(first + i), to_.push_back(first + (i + 1) % size);
            }
            parts_.push_back({first, size, first, size, kit::double_area(contour)});
            double_area_ += parts_.back().double_area;
            corners_ += size;
        }
        for (std::uint32_t v = 0; v < at_.size(); ++v) {
            sides_.add(v, at_[v], at_[next_[v]]);
            touched_.add(v, at_[v], at_[next_[v]]);
        }
    }

    /// The image, in which all corners are to stay.
    [[nodiscard]] const GridBox& image() const noexcept { return image_; }
    /// How many corners are left of all polygons.
    [[nodiscard]] std::size_t corners() const noexcept { return corners_; }
    /// Twice the area of all, in square units.
    [[nodiscard]] std::int64_t double_area() const noexcept { return double_area_; }
    /// The polygons that are left: outer borders and holes.
    [[nodiscard]] std::vector<Loop> loops() const {
        std::vector<Loop> out;
        for (std::uint32_t loop = 0; loop < parts_.size(); ++loop)
            if (size_of(loop) != 0) out.push_back(corners_of(loop));
        return out;
    }

    // --- corners ---
    /// All corners have numbers below this.
    [[nodiscard]] std::uint32_t numbers() const noexcept { return static_cast<std::uint32_t>(at_.size()); }
    /// Whether a corner is left.
    [[nodiscard]] bool has(std::uint32_t v) const noexcept { return next_[v] != none; }
    /// Where it is.
    [[nodiscard]] GridPoint at(std::uint32_t v) const noexcept { return at_[v]; }
    /// The corner behind it.
    [[nodiscard]] std::uint32_t next(std::uint32_t v) const noexcept { return next_[v]; }
    /// The corner before it.
    [[nodiscard]] std::uint32_t previous(std::uint32_t v) const noexcept { return previous_[v]; }
    /// The loop that it belongs to, if it is gone, too.
    [[nodiscard]] std::uint32_t loop_of(std::uint32_t v) const noexcept { return loop_of_[v]; }
    /// The side from a corner on and its neighbours.
    [[nodiscard]] ThreeSides three_sides(std::uint32_t v) const noexcept {
        const std::uint32_t before = previous_[v], after = next_[v], last = next_[after];
        return {before, v, after, last, at_[before], at_[v], at_[after], at_[last]};
    }

    // --- loops ---
    /// The number of a loop's corners; 0: it is gone.
    [[nodiscard]] std::uint32_t size_of(std::uint32_t loop) const noexcept { return parts_[loop].size; }
    /// Twice the area of a loop, in square units.
    [[nodiscard]] std::int64_t double_area_of(std::uint32_t loop) const noexcept { return parts_[loop].double_area; }
    /// Whether it is a hole.
    [[nodiscard]] bool is_hole(std::uint32_t loop) const noexcept { return parts_[loop].double_area <= 0; }
    /// Where its corners are, in order.
    [[nodiscard]] Loop corners_of(std::uint32_t loop) const {
        Loop out;
        for (std::uint32_t v = parts_[loop].some; out.size() < parts_[loop].size; v = next_[v]) out.push_back(at_[v]);
        return out;
    }

    // --- what is where ---
    /// Calls body(side) for all sides that may touch the box, some of them more than once, until it returns false. Whether it
    /// never did.
    template <class Body>
    bool visit_sides(const GridBox& box, Body&& body) const {
        return sides_.visit(box, body);
    }
    /// Likewise body(p, q) for the sides of the contours, from p to q.
    template <class Body>
    bool visit_contours(const GridBox& box, Body&& body) const {
        return touched_.visit(box, [&](std::uint32_t i) { return body(contour_[i], contour_[contour_next(i)]); });
    }
    /// Calls body(p) for the corners of the contour along a side, its ends included.
    template <class Body>
    void along_contour(std::uint32_t side, Body&& body) const {
        walk_contour(side, [&](std::uint32_t i) { body(contour_[i]); });
    }
    /// Whether a side from a to b would meet no other than at its ends. Sides `gone`, or none, do not count.
    [[nodiscard]] bool is_side_free(End a, End b, const std::array<std::uint32_t, 3>& gone) const {
        const GridPoint p = a.at, q = b.at;
        if (p == q) return false;
        return sides_.visit(GridBox(p).add(q), [&](std::uint32_t s) {
            if (std::find(gone.begin(), gone.end(), s) != gone.end()) return true;
            const std::uint32_t t = next_[s];
            const bool begins = s == a.corner || s == b.corner, ends = t == a.corner || t == b.corner;
            if (begins && ends) return false;
            if (!begins && !ends) return !do_segments_meet(p, q, at_[s], at_[t]);
            // They share an end, and must not run along each other.
            const GridPoint shared = (begins ? s : t) == a.corner ? p : q, own = shared == p ? q : p, other = at_[begins ? t : s];
            return orient2d(shared, own, other) != 0 || along(shared, shared, own, other) < 0;
        });
    }

    // --- changes ---
    /// Removes a loop.
    void remove_loop(std::uint32_t loop) {
        std::uint32_t v = parts_[loop].some;
        for (std::uint32_t i = 0; i < parts_[loop].size; ++i) {
            sides_.remove(v, at_[v], at_[next_[v]]);
            v = std::exchange(next_[v], none);
        }
        corners_ -= parts_[loop].size;
        parts_[loop].size = 0;
        grow(loop, -parts_[loop].double_area);
    }
    /// Removes a corner of a loop of more than three: the side between its neighbours takes its place.
    void remove_corner(std::uint32_t v) {
        const std::uint32_t before = previous_[v], after = next_[v];
        sides_.remove(before, at_[before], at_[v]);
        sides_.remove(v, at_[v], at_[after]);
        grow(loop_of_[v], -orient2d(at_[before], at_[v], at_[after]));
        take_out(v, before);
        to_[before] = to_[v];
        sides_.add(before, at_[before], at_[after]);
    }
    /// Removes the side from a corner on, of a loop of more than three: its neighbours meet in this point, at which the corner is
    /// from then on.
    void remove_side(std::uint32_t v, GridPoint meeting) {
        const ThreeSides s = three_sides(v);
        forget_sides(s);
        grow(loop_of_[v], orient2d(s.a, meeting, s.d) - kit::double_area(s.a, s.b, s.c, s.d));
        // The contour between the side's ends is shared out where it is farthest out.
        const std::uint32_t split = farthest(v, s.a, s.d);
        to_[s.before] = split, from_[v] = split, to_[v] = to_[s.to];
        at_[v] = meeting;
        take_out(s.to, v);
        sides_.add(s.before, s.a, meeting);
        sides_.add(v, meeting, s.d);
    }
    /// Moves the side from a corner on, to run from b to c.
    void move_side(std::uint32_t v, GridPoint b, GridPoint c) {
        const ThreeSides s = three_sides(v);
        forget_sides(s);
        grow(loop_of_[v], kit::double_area(s.a, b, c, s.d) - kit::double_area(s.a, s.b, s.c, s.d));
        at_[v] = b, at_[s.to] = c;
        sides_.add(s.before, s.a, b), sides_.add(v, b, c), sides_.add(s.to, c, s.d);
    }

  private:
    struct Part {
        std::uint32_t first, contour_size;  // its contour: corners of contour_
        std::uint32_t some, size;           // a corner of its polygon, and how many there are; size 0: it is gone
        std::int64_t double_area;

        [[nodiscard]] std::uint32_t contour_next(std::uint32_t i) const noexcept {
            return i + 1 == first + contour_size ? first : i + 1;
        }
    };

    static std::size_t count(const std::vector<Loop>& contours) {
        std::size_t sum = 0;
        for (const Loop& contour : contours) sum += contour.size();
        return sum;
    }

    void grow(std::uint32_t loop, std::int64_t change) {
        parts_[loop].double_area += change;
        double_area_ += change;
    }
    void forget_sides(const ThreeSides& s) {
        sides_.remove(s.before, s.a, s.b), sides_.remove(s.from, s.b, s.c), sides_.remove(s.to, s.c, s.d);
    }
    // Takes a corner out of its ring. One before it stays.
    void take_out(std::uint32_t v, std::uint32_t before) {
        const std::uint32_t after = next_[v];
        next_[before] = after, previous_[after] = before;
        next_[v] = none;
        parts_[loop_of_[v]].some = before;
        --parts_[loop_of_[v]].size;
        --corners_;
    }

    [[nodiscard]] std::uint32_t contour_next(std::uint32_t i) const { return parts_[loop_of_[i]].contour_next(i); }
    // Calls body(i) for the corners of the contour along a side.
    template <class Body>
    void walk_contour(std::uint32_t side, Body&& body) const {
        const Part part = parts_[loop_of_[side]];
        const std::uint32_t last = to_[side];
        for (std::uint32_t i = from_[side];; i = part.contour_next(i)) {
            body(i);
            if (i == last) return;
        }
    }
    // The corner of the contour along a side that is farthest outside of the line from a to b.
    [[nodiscard]] std::uint32_t farthest(std::uint32_t side, GridPoint a, GridPoint b) const {
        std::uint32_t best = from_[side];
        walk_contour(side, [&](std::uint32_t i) {
            if (orient2d(a, b, contour_[i]) < orient2d(a, b, contour_[best])) best = i;
        });
        return best;
    }

    GridBox image_;
    std::vector<GridPoint> at_, contour_;
    std::vector<std::uint32_t> next_, previous_, loop_of_;  // next_ is none where a corner is gone
    std::vector<std::uint32_t> from_, to_;                  // the contour along the side after a corner
    std::vector<Part> parts_;
    Buckets sides_;    // by the corners at which they begin
    Buckets touched_;  // sides of the contours, so too
    std::size_t corners_ = 0;
    std::int64_t double_area_ = 0;
};

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_OUTLINE_POLYGONS_HPP
