/// \file
/// remove_corners(): corners of polygons and holes go one by one, the cheapest first by the area that this adds.
///
/// A removal only ever adds area:
///
/// - a corner that is not convex: the side between its neighbours takes its place;
/// - a side between two convex corners: its neighbours are made longer until they meet (the two-dimensional case of the
///   progressive hulls of Sander et al., "Silhouette clipping", 2000);
/// - a hole with all that is in it.
///
/// Whatever lies wholly in the area added, such as an island in a bay, goes with it. What would make sides meet waits until that
/// which is in the way has gone. Cost: some 2 us for each corner of the contours.
#ifndef HMESH_OUTLINE_REMOVE_CORNERS_HPP
#define HMESH_OUTLINE_REMOVE_CORNERS_HPP

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "hmesh/outline/contour.hpp"
#include "hmesh/outline/grid_geometry.hpp"
#include "hmesh/outline/offers.hpp"
#include "hmesh/outline/polygons.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

namespace detail {

/// What can be done at a corner.
struct CornerRemoval {
    /// What goes: the corner, the side from it on, or all of its loop, which is a hole.
    enum class Kind : std::uint8_t { none, corner, side, hole };

    Kind kind = Kind::none;                ///< none: there is nothing to remove
    GridPoint meeting;                     ///< of a side: where its neighbours meet
    std::int64_t added = 0;                ///< double area
    std::uint32_t corners = 1;             ///< that go
    std::vector<std::uint32_t> swallowed;  ///< loops, which is_free() finds

    /// The double area added for each corner less.
    [[nodiscard]] double price() const noexcept { return static_cast<double>(added) / static_cast<double>(corners); }
};

/// The point of the grid nearest to where the lines from a over b and from d over c meet that has both beside it or on it.
[[nodiscard]] inline std::optional<GridPoint> find_meeting(const ThreeSides& s, const GridBox& image) {
    const double ux = static_cast<double>(s.b.x) - s.a.x, uy = static_cast<double>(s.b.y) - s.a.y;
    const double vx = static_cast<double>(s.d.x) - s.c.x, vy = static_cast<double>(s.d.y) - s.c.y;
    const double across = ux * vy - uy * vx;
    if (!(across > 0)) return {};
    const double share = ((static_cast<double>(s.c.x) - s.b.x) * vy - (static_cast<double>(s.c.y) - s.b.y) * vx) / across;
    return nearest_point(
        {s.b.x + share * ux, s.b.y + share * uy}, image,
        [&](GridPoint p) { return orient2d(s.a, p, s.b) >= 0 && orient2d(p, s.d, s.c) >= 0; },
        [&](GridPoint p) { return static_cast<double>(orient2d(s.a, p, s.d)); });
}

/// What it would be to remove the corner v or the side from it on, of a loop of more than three, whatever is in the way.
[[nodiscard]] inline CornerRemoval removal_of(const Polygons& polygons, std::uint32_t v) {
    const ThreeSides s = polygons.three_sides(v);
    CornerRemoval out;
    if (const std::int64_t turn = orient2d(s.a, s.b, s.c); turn <= 0) {
        out.kind = CornerRemoval::Kind::corner;
        out.added = -turn;
    } else if (orient2d(s.b, s.c, s.d) > 0) {
        const std::optional<GridPoint> meeting = find_meeting(s, polygons.image());
        if (!meeting) return out;
        out.kind = CornerRemoval::Kind::side;
        out.meeting = *meeting;
        out.added = orient2d(s.a, *meeting, s.d) - double_area(s.a, s.b, s.c, s.d);
    }
    return out;
}

/// What it would be to remove at v, whatever is in the way: all of a hole where that is the cheaper.
[[nodiscard]] inline CornerRemoval removal_at(const Polygons& polygons, std::uint32_t v) {
    const std::uint32_t loop = polygons.loop_of(v);
    CornerRemoval out;
    if (polygons.size_of(loop) > 3) out = removal_of(polygons, v);
    if (!polygons.is_hole(loop)) return out;
    CornerRemoval hole;
    hole.kind = CornerRemoval::Kind::hole;
    hole.added = -polygons.double_area_of(loop);
    hole.corners = polygons.size_of(loop);
    return out.kind != CornerRemoval::Kind::none && out.price() <= hole.price() ? out : hole;
}

// --- what is in the way, and what goes along ---

/// Has a loop go with a removal.
inline void take_along(const Polygons& polygons, std::uint32_t loop, CornerRemoval& removal) {
    removal.swallowed.push_back(loop);
    removal.corners += polygons.size_of(loop);
    removal.added -= polygons.double_area_of(loop);
}

/// Finds the loops in the hole of which v is a corner.
inline void swallow_inside(const Polygons& polygons, std::uint32_t v, CornerRemoval& removal) {
    const std::uint32_t hole = polygons.loop_of(v);
    const Loop border = polygons.corners_of(hole);
    GridBox box(polygons.at(v));
    for (const GridPoint p : border) box.add(p);
    std::vector<std::uint32_t> seen = {hole};
    polygons.visit_sides(box, [&](std::uint32_t s) {
        const std::uint32_t loop = polygons.loop_of(s);
        if (std::find(seen.begin(), seen.end(), loop) != seen.end()) return true;
        seen.push_back(loop);
        if (is_inside(border, polygons.at(s))) take_along(polygons, loop, removal);
        return true;
    });
}

/// Finds the loops of which a corner is in the triangle; false where that is the loop of `own` itself, but for these corners.
[[nodiscard]] inline bool swallow(const Polygons& polygons, const std::array<GridPoint, 3>& triangle,
                                  const std::array<std::uint32_t, 4>& own, CornerRemoval& removal) {
    const GridPoint a = triangle[0], b = triangle[1], c = triangle[2];
    const std::uint32_t home = polygons.loop_of(own[0]);
    return polygons.visit_sides(GridBox(a).add(b).add(c), [&](std::uint32_t s) {
        if (std::find(own.begin(), own.end(), s) != own.end() || !is_in_triangle(a, b, c, polygons.at(s))) return true;
        const std::uint32_t loop = polygons.loop_of(s);
        if (loop == home) return false;
        if (std::find(removal.swallowed.begin(), removal.swallowed.end(), loop) == removal.swallowed.end())
            take_along(polygons, loop, removal);
        return true;
    });
}

/// Whether nothing is in the way of a removal at v; finds what is swallowed.
[[nodiscard]] inline bool is_free(const Polygons& polygons, std::uint32_t v, CornerRemoval& removal) {
    if (removal.kind == CornerRemoval::Kind::hole) {
        swallow_inside(polygons, v, removal);
        return true;
    }
    const ThreeSides s = polygons.three_sides(v);
    if (removal.kind == CornerRemoval::Kind::corner)
        return polygons.is_side_free({s.before, s.a}, {s.to, s.c}, {s.before, v, Polygons::none}) &&
               swallow(polygons, {s.a, s.b, s.c}, {s.before, v, s.to, Polygons::none}, removal);
    const GridPoint p = removal.meeting;
    const std::array<std::uint32_t, 3> gone = {s.before, v, s.to};
    const std::array<std::uint32_t, 4> own = {s.before, v, s.to, s.last};
    return polygons.is_side_free({s.before, s.a}, {v, p}, gone) && polygons.is_side_free({v, p}, {s.last, s.d}, gone) &&
           swallow(polygons, {s.a, p, s.b}, own, removal) && swallow(polygons, {s.b, p, s.c}, own, removal) &&
           swallow(polygons, {s.c, p, s.d}, own, removal);
}

// --- the cheapest first ---

/// Offers what there is at a corner, in place of what was offered there.
inline void offer(const Polygons& polygons, std::uint32_t v, Offers& offers) {
    if (const CornerRemoval removal = removal_at(polygons, v); removal.kind != CornerRemoval::Kind::none)
        offers.add(v, removal.price());
    else offers.take_back(v);
}
/// Offers anew all that a change at v may have changed.
inline void offer_around(const Polygons& polygons, std::uint32_t v, Offers& offers) {
    const std::uint32_t before = polygons.previous(v);
    for (const std::uint32_t u : {v, before, polygons.previous(before), polygons.next(v)}) offer(polygons, u, offers);
}

/// Does it, and offers what there is then.
inline void remove(Polygons& polygons, std::uint32_t v, const CornerRemoval& removal, Offers& offers) {
    for (const std::uint32_t loop : removal.swallowed) polygons.remove_loop(loop);
    if (removal.kind == CornerRemoval::Kind::hole) return polygons.remove_loop(polygons.loop_of(v));
    const ThreeSides s = polygons.three_sides(v);
    if (removal.kind == CornerRemoval::Kind::corner) {
        polygons.remove_corner(v);
        offer_around(polygons, s.before, offers);
        offer_around(polygons, s.to, offers);
    } else {
        polygons.remove_side(v, removal.meeting);
        offer_around(polygons, s.before, offers);
        offer_around(polygons, v, offers);
        offer_around(polygons, s.last, offers);
    }
}

/// Removes what is offered, until `count` corners are left or no more offers. Adds the corners at which something was in the way.
/// Whether anything has gone.
inline bool remove_offered(Polygons& polygons, std::size_t count, Offers& offers, std::vector<std::uint32_t>& blocked) {
    bool is_any = false;
    while (polygons.corners() > count) {
        const std::optional<Offers::Offer> best = offers.take_out();
        if (!best) break;
        const std::uint32_t v = best->corner;
        if (!polygons.has(v)) continue;
        CornerRemoval removal = removal_at(polygons, v);
        if (!is_free(polygons, v, removal)) {
            blocked.push_back(v);
            continue;
        }
        // A hole that has lost corners costs more for each of those left: its turn may come later. What is swallowed makes a
        // removal cheaper than it was offered, and its turn comes late.
        if (const double now = removal.price(); now > best->price && now > offers.least_price()) {
            offers.add(v, now);
            continue;
        }
        remove(polygons, v, removal, offers);
        is_any = true;
    }
    return is_any;
}

}  // namespace detail

/// Removes corners until at most `count` are left, the cheapest first: there may be more left where none can go.
inline void remove_corners(Polygons& polygons, std::size_t count) {
    detail::Offers offers(polygons.numbers());
    for (std::uint32_t v = 0; v < polygons.numbers(); ++v)
        if (polygons.has(v)) detail::offer(polygons, v, offers);
    // What is blocked may be free once something has gone.
    std::vector<std::uint32_t> blocked;
    while (detail::remove_offered(polygons, count, offers, blocked) && polygons.corners() > count) {
        for (const std::uint32_t v : blocked)
            if (polygons.has(v)) detail::offer(polygons, v, offers);
        blocked.clear();
    }
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_OUTLINE_REMOVE_CORNERS_HPP
