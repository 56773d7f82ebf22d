/// \file
/// Covering: polygons with few corners around contours, of nearly the least area.
///
/// Corners are removed one by one, the cheapest first by the area that it adds, and each removal only ever adds area:
///
/// - a corner that is not convex: the side between its neighbours takes its place;
/// - a side between two convex corners: its neighbours are made longer until they meet (the two-dimensional case of the
///   progressive hulls of Sander et al., "Silhouette clipping", 2000);
/// - a hole with all that is in it.
///
/// Whatever lies wholly in the area added, such as an island in a bay, goes with it. Then sides are turned around what they touch
/// as long as that leaves less area: of least area, a side touches in its middle or in two points. All tests are made in whole
/// numbers, so that contours stay inside and sides never meet, however positions were rounded. Cost: removals some 2 us for each
/// corner of the contours, and turning as much again for each time that all sides are looked at.
#ifndef HMESH_OUTLINE_COVERING_HPP
#define HMESH_OUTLINE_COVERING_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <queue>
#include <utility>
#include <vector>

#include "hmesh/outline/buckets.hpp"
#include "hmesh/outline/contour.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// The convex hull of points, clockwise on the screen, without corners of 180 degrees (Andrew's monotone chain). O(n log n).
[[nodiscard]] inline Loop convex_hull(Loop points) {
    std::sort(points.begin(), points.end(), [](GridPoint a, GridPoint b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
    points.erase(std::unique(points.begin(), points.end()), points.end());
    if (points.size() < 3) return points;
    Loop hull;
    for (int pass = 0; pass < 2; ++pass) {
        const std::size_t start = hull.size();
        for (const GridPoint p : points) {
            while (hull.size() >= start + 2 && orient(hull[hull.size() - 2], hull.back(), p) <= 0) hull.pop_back();
            hull.push_back(p);
        }
        hull.pop_back();
        std::reverse(points.begin(), points.end());
    }
    return hull;
}

/// Polygons that begin as contours and lose corners.
class Covering {
  public:
    /// Of contours_of() an image of this size in px, or polygons like them.
    Covering(const std::vector<Loop>& contours, int width, int height)
        : right_(width * units_per_px), bottom_(height * units_per_px), sides_(box_of(contours), count(contours) / 2),
          touched_(box_of(contours), count(contours) / 2) {
        for (const Loop& contour : contours) {
            const auto first = static_cast<std::uint32_t>(at_.size()), size = static_cast<std::uint32_t>(contour.size());
            for (std::uint32_t i = 0; i < size; ++i) {
                at_.push_back(contour[i]), contour_.push_back(contour[i]);
                next_.push_back(first + (i + 1) % size);
                previous_.push_back(first + (i + size - 1) % size);
                loop_of_.push_back(static_cast<std::uint32_t>(loops_.size()));
                from_.push_back(first + i), to_.push_back(first + (i + 1) % size);
            }
            loops_.push_back({first, size, first, size, kit::double_area(contour)});
            double_area_ += loops_.back().double_area;
            corners_ += size;
        }
        stamp_.assign(at_.size(), 0);
        for (std::uint32_t v = 0; v < at_.size(); ++v) {
            sides_.add(v, at_[v], at_[next_[v]]);
            touched_.add(v, at_[v], at_[next_[v]]);
        }
    }

    [[nodiscard]] std::size_t corners() const noexcept { return corners_; }  ///< of all polygons that are left
    /// The area of the polygons, px^2.
    [[nodiscard]] double area() const noexcept { return static_cast<double>(double_area_) * px2; }

    /// Removes corners until at most `count` are left, the cheapest first, then turns sides. Whether any could be removed: there
    /// may be more left where none can go.
    bool remove_to(std::size_t count) {
        const std::size_t before = corners_;
        offers_ = {};
        for (std::uint32_t v = 0; v < at_.size(); ++v)
            if (next_[v] != none) offer(v);
        remove_cheapest(count);
        turn_sides();
        return corners_ != before;
    }

    /// The polygons that are left: outer borders and holes.
    [[nodiscard]] std::vector<Loop> loops() const {
        std::vector<Loop> out;
        for (const Part& part : loops_)
            if (part.size != 0) out.push_back(corners_of(part));
        return out;
    }

  private:
    static constexpr double px2 = 0.5 / (units_per_px * units_per_px);  // of twice the area in square units
    static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

    struct Part {
        std::uint32_t first, contour_size;  // its contour: corners of contour_
        std::uint32_t some, size;           // a corner of its polygon, and how many there are; size 0: it is gone
        std::int64_t double_area;
    };
    // What can be done at a corner: it goes, or the side after it. The price is the double area added for each corner less.
    struct Offer {
        double price;
        std::uint32_t corner, stamp;
        bool operator<(const Offer& other) const noexcept {  // the best one is the last
            return price != other.price ? price > other.price : corner > other.corner;
        }
    };
    struct Removal {
        bool is_possible = false;
        bool is_side = false;                    // the side from the corner on; else the corner
        bool is_hole = false;                    // all of the corner's loop, a hole
        GridPoint meeting;                       // where its neighbours meet
        std::int64_t added = 0;                  // double area
        std::uint32_t corners = 1;               // that go
        std::vector<std::uint32_t> swallowed{};  // loops
    };

    [[nodiscard]] Loop corners_of(const Part& part) const {
        Loop corners;
        for (std::uint32_t v = part.some; corners.size() < part.size; v = next_[v]) corners.push_back(at_[v]);
        return corners;
    }
    static std::size_t count(const std::vector<Loop>& contours) {
        std::size_t sum = 0;
        for (const Loop& contour : contours) sum += contour.size();
        return sum;
    }
    static GridBox box_of(const std::vector<Loop>& contours) {
        GridBox box(contours.front().front());
        for (const Loop& contour : contours)
            for (const GridPoint p : contour) box.add(p);
        return box;
    }

    // --- removals ---
    void offer(std::uint32_t v) {
        ++stamp_[v];
        if (const Removal removal = removal_at(v); removal.is_possible) offers_.push({price(removal), v, stamp_[v]});
    }
    void offer_around(std::uint32_t v) {
        for (std::uint32_t u : {v, previous_[v], previous_[previous_[v]], next_[v]}) offer(u);
    }
    static double price(const Removal& removal) {
        return static_cast<double>(removal.added) / static_cast<double>(removal.corners);
    }

    // What it would be to remove at v, whatever is in the way: all of a hole where that is the cheaper.
    [[nodiscard]] Removal removal_at(std::uint32_t v) const {
        const Part& part = loops_[loop_of_[v]];
        Removal out;
        if (part.size > 3) out = removal_of(v);
        if (part.double_area > 0) return out;
        Removal hole;
        hole.is_possible = hole.is_hole = true;
        hole.added = -part.double_area;
        hole.corners = part.size;
        return out.is_possible && price(out) <= price(hole) ? out : hole;
    }
    // That of a corner or side of a loop of more than three.
    [[nodiscard]] Removal removal_of(std::uint32_t v) const {
        Removal out;
        const std::uint32_t before = previous_[v], after = next_[v], last = next_[after];
        if (const std::int64_t turn = orient(at_[before], at_[v], at_[after]); turn <= 0) {
            out.is_possible = true;
            out.added = -turn;
            return out;
        }
        if (orient(at_[v], at_[after], at_[last]) <= 0) return out;
        out.is_side = true;
        out.is_possible = find_meeting(at_[before], at_[v], at_[after], at_[last], out.meeting);
        if (out.is_possible)
            out.added = orient(at_[before], out.meeting, at_[last]) - orient(at_[before], at_[v], at_[after]) -
                        orient(at_[before], at_[after], at_[last]);
        return out;
    }

    // The point of the grid nearest to where the lines from a over b and from d over c meet that has both beside it or on it.
    [[nodiscard]] bool find_meeting(GridPoint a, GridPoint b, GridPoint c, GridPoint d, GridPoint& meeting) const {
        const double ux = static_cast<double>(b.x) - a.x, uy = static_cast<double>(b.y) - a.y;
        const double vx = static_cast<double>(d.x) - c.x, vy = static_cast<double>(d.y) - c.y;
        const double across = ux * vy - uy * vx;
        if (!(across > 0)) return false;
        const double share = ((static_cast<double>(c.x) - b.x) * vy - (static_cast<double>(c.y) - b.y) * vx) / across;
        const double x = b.x + share * ux, y = b.y + share * uy;
        if (!(x > -2 && x < right_ + 2.0 && y > -2 && y < bottom_ + 2.0)) return false;
        return nearest_point(
            x, y, [&](GridPoint p) { return orient(a, p, b) >= 0 && orient(p, d, c) >= 0; },
            [&](GridPoint p) { return static_cast<double>(orient(a, p, d)); }, meeting);
    }
    // The point of the grid near (x, y), within the image, that is good and of the least cost.
    template <class IsGood, class Cost>
    [[nodiscard]] bool nearest_point(double x, double y, IsGood&& is_good, Cost&& cost, GridPoint& out) const {
        const auto x0 = static_cast<std::int32_t>(std::floor(x)), y0 = static_cast<std::int32_t>(std::floor(y));
        double least = std::numeric_limits<double>::infinity();
        for (std::int32_t j = y0 - 1; j <= y0 + 2; ++j)
            for (std::int32_t i = x0 - 1; i <= x0 + 2; ++i) {
                const GridPoint p{i, j};
                if (i < 0 || j < 0 || i > right_ || j > bottom_ || !is_good(p)) continue;
                if (const double of_p = cost(p); of_p < least) least = of_p, out = p;
            }
        return least < std::numeric_limits<double>::infinity();
    }

    // Whether nothing is in the way; finds what is swallowed.
    [[nodiscard]] bool is_free(std::uint32_t v, Removal& removal) {
        const std::uint32_t before = previous_[v], after = next_[v], last = next_[after];
        if (removal.is_hole) return swallow_inside(loop_of_[v], removal);
        if (!removal.is_side) {
            return is_side_free(before, at_[before], after, at_[after], {before, v, none}) &&
                   swallow({at_[before], at_[v], at_[after]}, {before, v, after}, removal);
        }
        const GridPoint p = removal.meeting;
        return is_side_free(before, at_[before], v, p, {before, v, after}) &&
               is_side_free(v, p, last, at_[last], {before, v, after}) &&
               swallow({at_[before], p, at_[v]}, {before, v, after, last}, removal) &&
               swallow({at_[v], p, at_[after]}, {before, v, after, last}, removal) &&
               swallow({at_[after], p, at_[last]}, {before, v, after, last}, removal);
    }
    // Whether a side from p, corner a, to q, corner b, would meet no other than at its ends. Sides `gone`, by the corners at
    // which they begin, do not count.
    [[nodiscard]] bool is_side_free(std::uint32_t a, GridPoint p, std::uint32_t b, GridPoint q,
                                    const std::array<std::uint32_t, 3>& gone) const {
        if (p == q) return false;
        return sides_.visit(GridBox(p).add(q), [&](std::uint32_t s) {
            if (std::find(gone.begin(), gone.end(), s) != gone.end()) return true;
            const std::uint32_t t = next_[s];
            const bool begins = s == a || s == b, ends = t == a || t == b;
            if (begins && ends) return false;
            if (!begins && !ends) return !do_segments_meet(p, q, at_[s], at_[t]);
            // They share an end, and must not run along each other.
            const GridPoint shared = (begins ? s : t) == a ? p : q, own = shared == p ? q : p, other = at_[begins ? t : s];
            return orient(shared, own, other) != 0 || along(shared, shared, own, other) < 0;
        });
    }
    // Finds the loops in a hole.
    [[nodiscard]] bool swallow_inside(std::uint32_t hole, Removal& removal) {
        const Loop border = corners_of(loops_[hole]);
        GridBox box(at_[loops_[hole].some]);
        for (const GridPoint p : border) box.add(p);
        std::vector<std::uint32_t> seen = {hole};
        return sides_.visit(box, [&](std::uint32_t s) {
            const std::uint32_t loop = loop_of_[s];
            if (std::find(seen.begin(), seen.end(), loop) != seen.end()) return true;
            seen.push_back(loop);
            if (is_inside(border, at_[s])) take_along(loop, removal);
            return true;
        });
    }
    void take_along(std::uint32_t loop, Removal& removal) const {
        removal.swallowed.push_back(loop);
        removal.corners += loops_[loop].size;
        removal.added -= loops_[loop].double_area;
    }
    // Finds the loops of which a corner is in the triangle; false where that is the loop of `own` itself.
    [[nodiscard]] bool swallow(const std::array<GridPoint, 3>& triangle, const std::vector<std::uint32_t>& own,
                               Removal& removal) {
        const std::uint32_t home = loop_of_[own[0]];
        return sides_.visit(GridBox(triangle[0]).add(triangle[1]).add(triangle[2]), [&](std::uint32_t s) {
            if (loop_of_[s] == home && std::find(own.begin(), own.end(), s) != own.end()) return true;
            if (!is_in_triangle(triangle[0], triangle[1], triangle[2], at_[s])) return true;
            if (loop_of_[s] == home) return false;
            if (std::find(removal.swallowed.begin(), removal.swallowed.end(), loop_of_[s]) != removal.swallowed.end())
                return true;
            take_along(loop_of_[s], removal);
            return true;
        });
    }

    void remove_cheapest(std::size_t count) {
        std::vector<std::uint32_t> blocked;
        for (bool is_new = true; is_new;) {  // whether something has gone since they were blocked
            is_new = false;
            while (!offers_.empty() && corners_ > count) {
                const Offer best = offers_.top();
                offers_.pop();
                const std::uint32_t v = best.corner;
                if (next_[v] == none || best.stamp != stamp_[v]) continue;
                Removal removal = removal_at(v);
                if (!is_free(v, removal)) {
                    blocked.push_back(v);
                    continue;
                }
                // What is swallowed changes the price: its turn may come later.
                if (const double now = price(removal); now > best.price && !offers_.empty() && now > offers_.top().price) {
                    offers_.push({now, v, ++stamp_[v]});
                    continue;
                }
                remove(v, removal);
                is_new = true;
            }
            if (corners_ <= count) return;
            for (const std::uint32_t v : blocked)
                if (next_[v] != none) offer(v);
            blocked.clear();
        }
    }
    void take_out(std::uint32_t v) {
        sides_.remove(v, at_[v], at_[next_[v]]);
        --corners_;
    }
    void remove_loop(std::uint32_t loop) {
        Part& part = loops_[loop];
        std::uint32_t v = part.some;
        for (std::uint32_t i = 0; i < part.size; ++i) {
            take_out(v);
            v = std::exchange(next_[v], none);
        }
        double_area_ -= part.double_area;
        part.size = 0;
    }
    void remove(std::uint32_t v, const Removal& removal) {
        for (const std::uint32_t loop : removal.swallowed) remove_loop(loop);
        if (removal.is_hole) return remove_loop(loop_of_[v]);
        const std::uint32_t before = previous_[v], after = next_[v], last = next_[after];
        Part& part = loops_[loop_of_[v]];
        const std::int64_t area_before = part.double_area;
        sides_.remove(before, at_[before], at_[v]);
        take_out(v);
        --part.size;
        if (!removal.is_side) {
            part.double_area -= orient(at_[before], at_[v], at_[after]);
            link(before, after);
            to_[before] = to_[v];
            next_[v] = none;
            part.some = before;
            sides_.add(before, at_[before], at_[after]);
            double_area_ += part.double_area - area_before;
            offer_around(before);
            offer_around(after);
            return;
        }
        part.double_area += orient(at_[before], removal.meeting, at_[last]) - orient(at_[before], at_[v], at_[after]) -
                            orient(at_[before], at_[after], at_[last]);
        double_area_ += part.double_area - area_before;
        sides_.remove(after, at_[after], at_[last]);
        // The contour between the side's ends is shared out where it is farthest out.
        const std::uint32_t split = farthest(v, at_[before], at_[last]);
        to_[before] = split, from_[v] = split, to_[v] = to_[after];
        at_[v] = removal.meeting;
        link(v, last);
        next_[after] = none;
        part.some = v;
        sides_.add(before, at_[before], at_[v]);
        sides_.add(v, at_[v], at_[last]);
        offer_around(before);
        offer_around(v);
        offer_around(last);
    }
    void link(std::uint32_t a, std::uint32_t b) { next_[a] = b, previous_[b] = a; }

    // --- the contour along a side ---
    [[nodiscard]] std::uint32_t contour_next(std::uint32_t i) const {
        const Part& part = loops_[loop_of_[i]];
        return i + 1 == part.first + part.contour_size ? part.first : i + 1;
    }
    // Calls body(i) for the corners of the contour from one to another.
    template <class Body>
    void along_contour(std::uint32_t from, std::uint32_t to, Body&& body) const {
        for (std::uint32_t i = from;; i = contour_next(i)) {
            body(i);
            if (i == to) return;
        }
    }
    // The corner of the contour along the side from v on that is farthest outside of the line from a to b.
    [[nodiscard]] std::uint32_t farthest(std::uint32_t v, GridPoint a, GridPoint b) const {
        std::uint32_t best = from_[v];
        along_contour(from_[v], to_[v], [&](std::uint32_t i) {
            if (orient(a, b, contour_[i]) < orient(a, b, contour_[best])) best = i;
        });
        return best;
    }

    // --- turning sides ---
    struct RealPoint {
        double x = 0, y = 0;
    };
    // Where the line from p in the direction (dx, dy) meets that from a over b; false: nowhere, or on the other side of a.
    static bool meet(RealPoint p, double dx, double dy, GridPoint a, GridPoint b, RealPoint& out) {
        const double ux = static_cast<double>(b.x) - a.x, uy = static_cast<double>(b.y) - a.y;
        const double across = ux * dy - uy * dx;
        if (across == 0) return false;
        const double share = ((p.x - a.x) * dy - (p.y - a.y) * dx) / across;
        out = {a.x + share * ux, a.y + share * uy};
        return share > 0;
    }
    // Turns sides as long as that makes the area smaller, some passes over all.
    void turn_sides() {
        constexpr int passes = 12;
        for (int pass = 0; pass < passes; ++pass) {
            bool is_last = true;
            for (std::uint32_t v = 0; v < at_.size(); ++v)
                if (next_[v] != none && turn(v)) is_last = false;
            if (is_last) return;
        }
    }
    // Turns the side from v on to the best place that there is between the lines of its neighbours.
    bool turn(std::uint32_t v) {
        const std::uint32_t before = previous_[v], after = next_[v], last = next_[after];
        const GridPoint a = at_[before], b = at_[v], c = at_[after], d = at_[last];
        Loop points;
        const auto gather = [&](std::uint32_t side) {
            along_contour(from_[side], to_[side], [&](std::uint32_t i) { points.push_back(contour_[i]); });
        };
        gather(v);
        if (orient(a, b, c) > 0) gather(before);
        if (orient(b, c, d) > 0) gather(after);
        const Loop hull = convex_hull(std::move(points));
        if (hull.size() < 3) return false;

        // Twice the area of (a, b, c, d), which is to become smaller by 1/100 px^2 at least.
        constexpr double enough = 0.01 / px2;
        const auto area_of = [&](RealPoint p, RealPoint q) {
            return (p.x - a.x) * (q.y - a.y) - (q.x - a.x) * (p.y - a.y) + (q.x - a.x) * (static_cast<double>(d.y) - a.y) -
                   (static_cast<double>(d.x) - a.x) * (q.y - a.y);
        };
        double least =
            area_of({static_cast<double>(b.x), static_cast<double>(b.y)}, {static_cast<double>(c.x), static_cast<double>(c.y)}) -
            enough;
        RealPoint best_b, best_c;
        bool is_found = false;
        const auto try_line = [&](RealPoint p, double dx, double dy) {
            RealPoint p_b, p_c;
            if (!meet(p, dx, dy, a, b, p_b) || !meet(p, dx, dy, d, c, p_c)) return;
            if ((p_c.x - p_b.x) * dx + (p_c.y - p_b.y) * dy <= 0) return;
            // Of lines far beyond the next corners the price is another one.
            if (const double area = area_of(p_b, p_c); area < least) least = area, best_b = p_b, best_c = p_c, is_found = true;
        };
        for (std::size_t i = 0; i < hull.size(); ++i) {
            const GridPoint p = hull[i], q = hull[(i + 1) % hull.size()], o = hull[(i + hull.size() - 1) % hull.size()];
            const RealPoint at{static_cast<double>(p.x), static_cast<double>(p.y)};
            const double dx = static_cast<double>(q.x) - p.x, dy = static_cast<double>(q.y) - p.y;
            try_line(at, dx, dy);
            // The line on which p is in the middle: through where the mirror image of the line d c meets that of a b.
            RealPoint in_b;
            if (!meet({2 * at.x - c.x, 2 * at.y - c.y}, static_cast<double>(d.x) - c.x, static_cast<double>(d.y) - c.y, a, b,
                      in_b))
                continue;
            const double mx = at.x - in_b.x, my = at.y - in_b.y;
            const double from_x = at.x - o.x, from_y = at.y - o.y;
            if (from_x * my - from_y * mx >= 0 && mx * dy - my * dx >= 0) try_line(at, mx, my);
        }
        return is_found && put_side(v, best_b, best_c);
    }
    // Puts the ends of the side from v on to points near p and q, if all stays as it must be.
    bool put_side(std::uint32_t v, RealPoint p, RealPoint q) {
        const std::uint32_t before = previous_[v], after = next_[v], last = next_[after];
        const GridPoint a = at_[before], b = at_[v], c = at_[after], d = at_[last];
        const auto outside = [&](GridPoint g) {
            return (q.x - p.x) * (g.y - p.y) - (g.x - p.x) * (q.y - p.y);  // < 0 outside of the line
        };
        if (!(p.x > -2 && p.x < right_ + 2.0 && p.y > -2 && p.y < bottom_ + 2.0) ||
            !(q.x > -2 && q.x < right_ + 2.0 && q.y > -2 && q.y < bottom_ + 2.0))
            return false;
        const double slack = 1e-6 * (std::abs(q.x - p.x) + std::abs(q.y - p.y));
        GridPoint new_b, new_c;
        const auto squared = [](GridPoint g, RealPoint r) { return (g.x - r.x) * (g.x - r.x) + (g.y - r.y) * (g.y - r.y); };
        if (!nearest_point(
                p.x, p.y, [&](GridPoint g) { return orient(a, b, g) <= 0 && outside(g) <= slack; },
                [&](GridPoint g) { return squared(g, p); }, new_b) ||
            !nearest_point(
                q.x, q.y, [&](GridPoint g) { return orient(c, d, g) <= 0 && outside(g) <= slack; },
                [&](GridPoint g) { return squared(g, q); }, new_c))
            return false;
        const std::int64_t change = orient(a, new_b, new_c) + orient(a, new_c, d) - orient(a, b, c) - orient(a, c, d);
        if (change >= 0 || new_b == new_c || new_b == a || new_c == d) return false;
        // Lines turned past the next corner fold over.
        if (along(a, a, b, new_b) <= 0 || along(d, d, c, new_c) <= 0) return false;
        const bool is_triangle = before == last;
        const std::int64_t turn_of_all = orient(a, new_b, new_c);  // of a triangle, which stays border or hole
        if (is_triangle ? turn_of_all == 0 || (turn_of_all > 0) != (loops_[loop_of_[v]].double_area > 0)
                        : do_segments_meet(a, new_b, new_c, d))
            return false;
        const auto folds = [](GridPoint u, GridPoint at, GridPoint w) {
            return orient(u, at, w) == 0 && along(at, at, u, w) > 0;
        };
        if (folds(a, new_b, new_c) || folds(new_b, new_c, d)) return false;

        const std::array<std::uint32_t, 3> gone = {before, v, after};
        if (!is_side_free(before, a, v, new_b, gone) || !is_side_free(v, new_b, after, new_c, gone) ||
            !is_side_free(after, new_c, last, d, gone))
            return false;
        // Nothing that was inside may come to lie outside: of the new side and, where a corner that is not convex moves on along
        // its other side, of that; but for what is beside that which is left of the others.
        const bool cuts_first = orient(a, b, c) < 0 && along(b, a, b, new_b) > 0;
        const bool cuts_last = orient(b, c, d) < 0 && along(c, d, c, new_c) > 0;
        const auto stays = [&](GridPoint s) {
            return orient(new_b, new_c, s) >= 0 && (!cuts_first || orient(a, new_b, s) >= 0) &&
                   (!cuts_last || orient(new_c, d, s) >= 0);
        };
        // What moves on so is a tip, into which a side of the contour may run without a corner of its own there.
        if (cuts_first || cuts_last) {
            const auto is_crossed = [&](GridPoint p0, GridPoint p1) {
                return !touched_.visit(GridBox(p0).add(p1), [&](std::uint32_t i) {
                    return !do_segments_cross(p0, p1, contour_[i], contour_[contour_next(i)]);
                });
            };
            if (is_crossed(b, new_b) || is_crossed(new_b, new_c) || is_crossed(new_c, c)) return false;
        }
        const std::array<std::array<GridPoint, 3>, 4> swept = {{{a, b, new_b}, {b, c, new_c}, {b, new_c, new_b}, {c, d, new_c}}};
        const std::array<std::uint32_t, 4> own = {before, v, after, last};
        for (std::size_t k = 0; k < swept.size(); ++k) {
            const auto& [t, u, w] = swept[k];
            const GridBox box = GridBox(t).add(u).add(w);
            const bool is_clear = sides_.visit(box, [&, t = t, u = u, w = w](std::uint32_t s) {
                return std::find(own.begin(), own.end(), s) != own.end() || !is_in_triangle(t, u, w, at_[s]);
            });
            if (!is_clear || !touched_.visit(box, [&, t = t, u = u, w = w](std::uint32_t i) {
                    const GridPoint s = contour_[i];
                    return !is_in_triangle(t, u, w, s) || stays(s) || (k == 0 && along(new_b, a, b, s) <= 0) ||
                           (k == 3 && along(new_c, d, c, s) <= 0);
                }))
                return false;
        }
        sides_.remove(before, a, b), sides_.remove(v, b, c), sides_.remove(after, c, d);
        at_[v] = new_b, at_[after] = new_c;
        sides_.add(before, a, new_b), sides_.add(v, new_b, new_c), sides_.add(after, new_c, d);
        loops_[loop_of_[v]].double_area += change;
        double_area_ += change;
        return true;
    }
    // How far p is from o on in the direction from a to b, times the length of that. Exact.
    static std::int64_t along(GridPoint o, GridPoint a, GridPoint b, GridPoint p) noexcept {
        return (std::int64_t{b.x} - a.x) * (std::int64_t{p.x} - o.x) + (std::int64_t{b.y} - a.y) * (std::int64_t{p.y} - o.y);
    }

    std::int32_t right_, bottom_;
    std::vector<GridPoint> at_, contour_;
    std::vector<std::uint32_t> next_, previous_, loop_of_;  // next_ is none where a corner is gone
    std::vector<std::uint32_t> from_, to_;                  // the contour along the side after a corner
    std::vector<std::uint32_t> stamp_;                      // of a corner's last offer
    std::vector<Part> loops_;
    Buckets sides_;    // by the corners at which they begin
    Buckets touched_;  // sides of the contours, so too
    std::priority_queue<Offer> offers_;
    std::size_t corners_ = 0;
    std::int64_t double_area_ = 0;
};

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_OUTLINE_COVERING_HPP
