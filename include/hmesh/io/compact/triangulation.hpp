/// \file
/// Triangulation: triangles between all of a set of points, begun as those of Delaunay and changed by flips.
///
/// The Delaunay triangulation is made by halves (L. Guibas and J. Stolfi, "Primitives for the manipulation of general
/// subdivisions and the computation of Voronoi diagrams", 1985), of strips and, in these, of cells (after R. Dwyer, "A faster
/// divide-and-conquer algorithm for constructing Delaunay triangulations", 1987), in O(n log n) whatever the points. Where four
/// points or more lie on a circle that holds no other, the first of them, by its number, is joined to all others: this is what a
/// point that was moved toward the inside of all circles by a trifle would do, the first by far the most, so that the
/// triangulation is one and the same for every way to find it. Flips of edges between convex quadrilaterals keep it one. All
/// decisions are exact.
///
/// Cost: some 500 ns and 80 bytes a point.
#ifndef HMESH_IO_COMPACT_TRIANGULATION_HPP
#define HMESH_IO_COMPACT_TRIANGULATION_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "hmesh/core/array.hpp"
#include "hmesh/core/coded_order.hpp"
#include "hmesh/io/compact/plane.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

/// A triangulation of points by directed edges, each beside its opposite, which around each point know the next and the one
/// before.
class Triangulation {
  public:
    using Index = std::uint32_t;                                      ///< of a point, or of a directed edge
    static constexpr Index none = std::numeric_limits<Index>::max();  ///< no point, no edge

    /// The Delaunay triangulation of at least 3 different points that do not lie on one line, which outlive this.
    explicit Triangulation(const std::vector<GridPoint>& points) : points_(&points) {
        const auto n = static_cast<Index>(points.size());
        std::vector<Index> order(n);
        for (Index v = 0; v < n; ++v) order[v] = v;
        edges_.reserve(6 * std::size_t{n});
        sort(order.data(), n, false);
        Index strip = 32;
        while (std::uint64_t{strip} * strip < 32 * std::uint64_t{n}) strip *= 2;
        (void)delaunay_by_halves(order.data(), n, strip, false);
        first_.assign(n, none);
        degree_.assign(n, 0);
        for (Index e = 0; e < edges_.size(); ++e)
            if (edges_[e].from != none) {
                first_[edges_[e].from] = e;
                ++degree_[edges_[e].from];
            }
    }

    [[nodiscard]] static Index opposite(Index e) noexcept { return e ^ 1U; }               ///< the other direction
    [[nodiscard]] std::size_t edge_slots() const noexcept { return edges_.size(); }        ///< one above the last directed edge
    [[nodiscard]] std::size_t point_count() const noexcept { return first_.size(); }       ///< number of points
    [[nodiscard]] bool is_edge(Index e) const noexcept { return edges_[e].from != none; }  ///< false: a slot that is not in use
    [[nodiscard]] Index from(Index e) const noexcept { return edges_[e].from; }            ///< where it begins
    [[nodiscard]] Index to(Index e) const noexcept { return edges_[opposite(e)].from; }    ///< where it ends
    [[nodiscard]] Index next(Index e) const noexcept { return edges_[e].next; }            ///< around from(e), in positive sense
    [[nodiscard]] Index previous(Index e) const noexcept { return edges_[e].previous; }    ///< around from(e)
    [[nodiscard]] Index first(Index v) const noexcept { return first_[v]; }                ///< an edge that leaves v
    [[nodiscard]] Index degree(Index v) const noexcept { return degree_[v]; }              ///< number of edges that leave v
    [[nodiscard]] GridPoint point(Index v) const noexcept { return (*points_)[v]; }        ///< where v is

    /// The third corner of the triangle to the left of an edge, or none beside the border.
    [[nodiscard]] Index apex(Index e) const noexcept {
        const Index c = to(next(e));
        return orient2d(point(from(e)), point(to(e)), point(c)) > 0 ? c : none;
    }
    /// The edge from a to b, or none. O(the smaller of their degrees).
    [[nodiscard]] Index find(Index a, Index b) const noexcept {
        if (degree_[b] < degree_[a]) {
            const Index e = find_around(b, a);
            return e == none ? none : opposite(e);
        }
        return find_around(a, b);
    }

    /// The corners of the two triangles beside an edge from a to b: c to the left and d to the right.
    struct Quadrilateral {
        Index a = none, b = none, c = none, d = none;
    };
    /// Those beside an edge; c or d is none at the border.
    [[nodiscard]] Quadrilateral around(Index e) const noexcept { return {from(e), to(e), apex(e), apex(opposite(e))}; }
    /// Whether the other diagonal lies inside, so that the edge can be flipped.
    [[nodiscard]] bool is_convex(const Quadrilateral& q) const noexcept {
        return q.c != none && q.d != none && orient2d(point(q.a), point(q.d), point(q.c)) > 0 &&
               orient2d(point(q.d), point(q.b), point(q.c)) > 0;
    }
    /// Makes the edge from a to b, of a convex quadrilateral, the one from d to c.
    void flip(Index e) noexcept {
        const Index o = opposite(e), at_c = opposite(next(e)), at_d = opposite(next(o));
        // Around c the edge to a is followed by that to b, and around d the one to b by that to a.
        for (const Index h : {e, o}) {
            if (first_[edges_[h].from] == h) first_[edges_[h].from] = edges_[h].next;
            --degree_[edges_[h].from];
            take_out(h);
        }
        put_after(e, at_d, edges_[at_d].from);
        put_after(o, at_c, edges_[at_c].from);
        ++degree_[edges_[e].from];
        ++degree_[edges_[o].from];
    }

  private:
    struct Edge {
        Index from = none, next = none, previous = none;
    };
    using Ends = std::pair<Index, Index>;  // of a hull: the edge from its first point around it, that from its last the other way

    [[nodiscard]] Index find_around(Index a, Index b) const noexcept {
        Index e = first_[a];
        for (Index k = 0; k < degree_[a]; ++k, e = next(e))
            if (to(e) == b) return e;
        return none;
    }

    // --- edges ---

    Index make(Index a, Index b) {
        auto e = static_cast<Index>(edges_.size());
        if (free_ != none) {
            e = free_;
            free_ = edges_[e].next;
        } else {
            edges_.resize(edges_.size() + 2);
        }
        edges_[e] = {a, e, e};
        edges_[opposite(e)] = {b, opposite(e), opposite(e)};
        return e;
    }
    void take_out(Index e) noexcept {
        edges_[edges_[e].next].previous = edges_[e].previous;
        edges_[edges_[e].previous].next = edges_[e].next;
    }
    // Puts an edge, of which `at` is the new begin, behind another of that point.
    void put_after(Index e, Index other, Index at) noexcept {
        edges_[e] = {at, edges_[other].next, other};
        edges_[edges_[e].next].previous = e;
        edges_[other].next = e;
    }
    void remove(Index e) noexcept {
        take_out(e);
        take_out(opposite(e));
        edges_[e].from = edges_[opposite(e)].from = none;
        e &= ~Index{1};
        edges_[e].next = free_;
        free_ = e;
    }
    // An edge from the end of a to the begin of b, in the face to the left of both.
    Index connect(Index a, Index b) {
        const Index e = make(to(a), from(b)), o = opposite(e);
        put_after(e, previous(opposite(a)), edges_[e].from);
        put_after(o, b, edges_[o].from);
        return e;
    }

    // --- the Delaunay triangulation ---

    [[nodiscard]] std::int64_t side(Index v, Index e) const noexcept { return orient2d(point(v), point(from(e)), point(to(e))); }
    [[nodiscard]] bool is_inside(Index a, Index b, Index c, Index d) const noexcept {
        if (d == a || d == b || d == c) return false;
        const int sign = in_circle_sign(point(a), point(b), point(c), point(d));
        if (sign != 0) return sign > 0;
        // The first of the four is a trifle lower than it was, in the paraboloid over the plane.
        const Index first = std::min(std::min(a, b), std::min(c, d));
        if (first == d) return true;
        if (first == a) return orient2d(point(d), point(b), point(c)) < 0;
        if (first == b) return orient2d(point(a), point(d), point(c)) < 0;
        return orient2d(point(a), point(b), point(d)) < 0;
    }

    // The codes by which points are ordered from left to right or, turned by a quarter, from the top down.
    [[nodiscard]] std::uint64_t place_of(Index v, bool is_down) const noexcept {
        constexpr std::uint32_t sign = 0x80000000U;
        const std::uint32_t x = static_cast<std::uint32_t>(point(v).x) ^ sign, y = static_cast<std::uint32_t>(point(v).y) ^ sign;
        return is_down ? kit::code_of(y, ~x) : kit::code_of(x, y);
    }
    [[nodiscard]] bool is_before(Index a, Index b, bool is_down) const noexcept {
        return place_of(a, is_down) < place_of(b, is_down);
    }
    void sort(Index* order, Index n, bool is_down) const {
        kit::Array<kit::Coded> codes(n);
        for (Index k = 0; k < n; ++k) codes[k] = {place_of(order[k], is_down), order[k]};
        kit::sort_by_code(codes);
        for (Index k = 0; k < n; ++k) order[k] = codes[k].number;
    }
    // Of n >= 2 points from left to right, whose strips of `few` are cut across again, from the top down, into cells: so that
    // halves do not meet along lines much longer than they are wide, along which most edges are removed again.
    Ends delaunay_by_halves(Index* order, Index n, Index few, bool is_down) {
        constexpr Index cell = 24;
        if (n <= few) {
            sort(order, n, !is_down);
            return is_down ? delaunay(order, n) : delaunay_by_halves(order, n, cell, true);
        }
        const Ends first = delaunay_by_halves(order, n / 2, few, is_down);
        const Ends last = delaunay_by_halves(order + n / 2, n - n / 2, few, is_down);
        return merge(ends_in_order(first, is_down), ends_in_order(last, is_down));
    }
    // The ends of a hull in one of the orders, found by going round it.
    [[nodiscard]] Ends ends_in_order(const Ends& known, bool is_down) const noexcept {
        Index into = known.second, out_of = known.second;  // to the first point and from the last, with the outside to the left
        for (Index e = following(known.second); e != known.second; e = following(e)) {
            if (is_before(to(e), to(into), is_down)) into = e;
            if (is_before(from(out_of), from(e), is_down)) out_of = e;
        }
        return {opposite(into), out_of};
    }
    // Of n >= 2 points from left to right. Both edges of the result have the outside to their right and left.
    Ends delaunay(const Index* order, Index n) {
        if (n == 2) {
            const Index e = make(order[0], order[1]);
            return {e, opposite(e)};
        }
        if (n == 3) {
            const Index a = make(order[0], order[1]), b = make(order[1], order[2]);
            put_after(b, opposite(a), order[1]);
            const std::int64_t turn = orient2d(point(order[0]), point(order[1]), point(order[2]));
            if (turn == 0) return {a, opposite(b)};
            const Index c = connect(b, a);
            if (turn > 0) return {a, opposite(b)};
            return {opposite(c), c};
        }
        const Ends left = delaunay(order, n / 2), right = delaunay(order + n / 2, n - n / 2);
        return merge(left, right);
    }

    Ends merge(Ends left, Ends right) {
        Index outer_left = left.first, inner_left = left.second, inner_right = right.first, outer_right = right.second;
        // The common tangent below.
        for (;;) {
            if (side(from(inner_right), inner_left) > 0) inner_left = following(inner_left);
            else if (side(from(inner_left), inner_right) < 0) inner_right = next(opposite(inner_right));
            else break;
        }
        Index base = connect(opposite(inner_right), inner_left);
        if (from(inner_left) == from(outer_left)) outer_left = opposite(base);
        if (from(inner_right) == from(outer_right)) outer_right = base;
        // Up between both, with the edge that a circle through the base meets first.
        for (;;) {
            Index to_left = next(opposite(base));
            if (is_above(to_left, base)) {
                while (is_inside(to(base), from(base), to(to_left), to(next(to_left)))) {
                    const Index gone = to_left;
                    to_left = next(to_left);
                    remove(gone);
                }
            }
            Index to_right = previous(base);
            if (is_above(to_right, base)) {
                while (is_inside(to(base), from(base), to(to_right), to(previous(to_right)))) {
                    const Index gone = to_right;
                    to_right = previous(to_right);
                    remove(gone);
                }
            }
            const bool is_left = is_above(to_left, base), is_right = is_above(to_right, base);
            if (!is_left && !is_right) break;
            if (!is_left || (is_right && is_inside(to(to_left), from(to_left), from(to_right), to(to_right))))
                base = connect(to_right, opposite(base));
            else base = connect(opposite(base), opposite(to_left));
        }
        return {outer_left, outer_right};
    }
    // The next edge around the face to the left.
    [[nodiscard]] Index following(Index e) const noexcept { return previous(opposite(e)); }
    [[nodiscard]] bool is_above(Index e, Index base) const noexcept {
        return orient2d(point(to(e)), point(to(base)), point(from(base))) > 0;
    }

    const std::vector<GridPoint>* points_;
    std::vector<Edge> edges_;
    std::vector<Index> first_, degree_;
    Index free_ = none;
};

/// Twice the area of the triangle that an edge is a side of; beyond the border 0.
[[nodiscard]] inline std::int64_t area_beside(const Triangulation& mesh, Triangulation::Index e) {
    const Triangulation::Index c = mesh.apex(e);
    return c == Triangulation::none ? 0 : orient2d(mesh.point(mesh.from(e)), mesh.point(mesh.to(e)), mesh.point(c));
}
/// Twice the area of the triangles around a point.
[[nodiscard]] inline std::int64_t area_around(const Triangulation& mesh, Triangulation::Index v) {
    std::int64_t area = 0;
    Triangulation::Index e = mesh.first(v);
    for (Triangulation::Index k = 0; k < mesh.degree(v); ++k, e = mesh.next(e)) area += area_beside(mesh, e);
    return area;
}

}  // namespace hmesh::detail

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_COMPACT_TRIANGULATION_HPP
