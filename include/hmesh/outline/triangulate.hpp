/// \file
/// triangulate(): polygons with holes as triangles between their corners.
///
/// Holes are joined to what is around them by a side there and back, to the nearest corner that is seen from their leftmost one
/// (Eberly, "Triangulation by ear clipping", 2002), and ears are cut off, those with a short third side first. Exact, whatever
/// the corners are. A polygon of n corners has n - 2 triangles, and 2 more for each hole. Cost: about 1 us a corner, and more
/// where there are many holes, O(holes * corners) at worst.
#ifndef HMESH_OUTLINE_TRIANGULATE_HPP
#define HMESH_OUTLINE_TRIANGULATE_HPP

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "hmesh/mesh/mesh.hpp"
#include "hmesh/outline/buckets.hpp"
#include "hmesh/outline/contour.hpp"
#include "hmesh/outline/grid_geometry.hpp"
#include "hmesh/outline/offers.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

namespace detail {

/// One polygon with its holes as a single ring of nodes.
class EarRing {
  public:
    /// Of corners of all polygons, by their places.
    explicit EarRing(const std::vector<GridPoint>& at) : at_(at) {}

    /// Adds the corners [first, end) of the outer border.
    void add_border(std::uint32_t first, std::uint32_t end) { add_nodes(first, end); }
    /// Adds those of a hole, holes in the order of their leftmost corners; `others` are those still to come, as such ranges.
    void add_hole(std::uint32_t first, std::uint32_t end, const std::vector<std::array<std::uint32_t, 2>>& others) {
        const auto old = static_cast<std::uint32_t>(nodes_.size());
        std::uint32_t from = add_nodes(first, end);
        for (std::uint32_t n = from, i = first; i < end; ++i, n = nodes_[n].next)
            if (is_left_of(place(n), place(from))) from = n;
        // As a rule the nearest is seen: a heap, since sorting all for each hole was most of the time.
        std::vector<Neighbor> neighbors;
        neighbors.reserve(old);
        for (std::uint32_t n = 0; n < old; ++n) {
            const std::int64_t x = std::int64_t{place(n).x} - place(from).x, y = std::int64_t{place(n).y} - place(from).y;
            neighbors.push_back({x * x + y * y, n});
        }
        std::make_heap(neighbors.begin(), neighbors.end());
        for (auto last = neighbors.end(); last != neighbors.begin();) {
            std::pop_heap(neighbors.begin(), last--);
            const std::uint32_t n = last->node;
            if (is_open(n, place(from)) && is_open(from, place(n)) && is_seen(n, from, others)) return join(n, from);
        }
    }

    /// A corner of the ring.
    struct Node {
        std::uint32_t corner,  ///< its number
            previous,          ///< the node before it
            next;              ///< the node behind it
    };
    [[nodiscard]] const std::vector<Node>& nodes() const noexcept { return nodes_; }  ///< of the ring, by their numbers

  private:
    // A node that a hole may be joined to; the nearest is the largest.
    struct Neighbor {
        std::int64_t distance;  // squared
        std::uint32_t node;
        bool operator<(const Neighbor& other) const noexcept {
            return distance != other.distance ? distance > other.distance : node > other.node;
        }
    };

    [[nodiscard]] GridPoint place(std::uint32_t n) const noexcept { return at_[nodes_[n].corner]; }
    static bool is_left_of(GridPoint a, GridPoint b) noexcept { return a.x != b.x ? a.x < b.x : a.y < b.y; }
    void link(std::uint32_t a, std::uint32_t b) { nodes_[a].next = b, nodes_[b].previous = a; }
    std::uint32_t add_nodes(std::uint32_t first, std::uint32_t end) {
        const auto from = static_cast<std::uint32_t>(nodes_.size()), size = end - first;
        for (std::uint32_t i = 0; i < size; ++i)
            nodes_.push_back({first + i, from + (i + size - 1) % size, from + (i + 1) % size});
        return from;
    }
    // Whether the way from a node to p begins inside.
    [[nodiscard]] bool is_open(std::uint32_t n, GridPoint p) const noexcept {
        const GridPoint a = place(nodes_[n].previous), b = place(n), c = place(nodes_[n].next);
        const bool after_first = orient2d(a, b, p) > 0, before_second = orient2d(b, c, p) > 0;
        return orient2d(a, b, c) > 0 ? after_first && before_second : after_first || before_second;
    }
    // Whether no side is between two nodes.
    [[nodiscard]] bool is_seen(std::uint32_t n, std::uint32_t from,
                               const std::vector<std::array<std::uint32_t, 2>>& others) const {
        const GridPoint p = place(n), q = place(from);
        const auto blocks = [&](GridPoint a, GridPoint b) {
            return a != p && a != q && b != p && b != q && do_segments_meet(p, q, a, b);
        };
        for (std::uint32_t m = 0; m < nodes_.size(); ++m)
            if (blocks(place(m), place(nodes_[m].next))) return false;
        for (const auto& [first, end] : others)
            for (std::uint32_t i = first; i < end; ++i)
                if (blocks(at_[i], at_[i + 1 < end ? i + 1 : first])) return false;
        return true;
    }
    // Joins two rings by a side there and one back.
    void join(std::uint32_t n, std::uint32_t m) {
        const auto n2 = static_cast<std::uint32_t>(nodes_.size()), m2 = n2 + 1;
        nodes_.push_back({nodes_[n].corner, 0, 0});
        nodes_.push_back({nodes_[m].corner, 0, 0});
        const std::uint32_t after = nodes_[n].next, before = nodes_[m].previous;
        link(n, m);
        link(before, m2);
        link(m2, n2);
        link(n2, after);
    }

    const std::vector<GridPoint>& at_;
    std::vector<Node> nodes_;
};

/// Cuts the ears of a ring, those with a short third side first.
class EarCutter {
  public:
    /// Of a ring of corners, by their places.
    EarCutter(const std::vector<GridPoint>& at, const EarRing& ring)
        : at_(at), nodes_(ring.nodes()), buckets_(box(), nodes_.size()), offers_(size()), left_(size()) {
        for (std::uint32_t n = 0; n < size(); ++n) {
            buckets_.add(n, place(n), place(n));
            offer(n);
        }
    }

    /// Appends the triangles.
    void cut(std::vector<Triangle>& faces) {
        std::vector<std::uint32_t> blocked;
        for (bool is_new = true; is_new && left_ > 2;) {
            is_new = false;
            while (left_ > 2) {
                const std::optional<Offers::Offer> best = offers_.take_out();
                if (!best) break;
                if (!is_ear(best->corner)) {
                    blocked.push_back(best->corner);
                    continue;
                }
                faces.push_back(cut_off(best->corner));
                is_new = true;
            }
            for (const std::uint32_t n : blocked)
                if (nodes_[n].next != none) offer(n);
            blocked.clear();
        }
    }

  private:
    static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

    [[nodiscard]] std::uint32_t size() const noexcept { return static_cast<std::uint32_t>(nodes_.size()); }
    [[nodiscard]] GridPoint place(std::uint32_t n) const noexcept { return at_[nodes_[n].corner]; }
    [[nodiscard]] GridBox box() const noexcept {
        GridBox out(place(0));
        for (std::uint32_t n = 0; n < size(); ++n) out.add(place(n));
        return out;
    }
    void offer(std::uint32_t n) {
        const GridPoint a = place(nodes_[n].previous), b = place(n), c = place(nodes_[n].next);
        const std::int64_t x = std::int64_t{c.x} - a.x, y = std::int64_t{c.y} - a.y;
        if (orient2d(a, b, c) > 0) offers_.add(n, static_cast<double>(x * x + y * y));  // exact: below 2^50
        else offers_.take_back(n);
    }
    // Whether no other node is in the triangle of one and its neighbours.
    [[nodiscard]] bool is_ear(std::uint32_t n) const {
        const GridPoint a = place(nodes_[n].previous), b = place(n), c = place(nodes_[n].next);
        return buckets_.visit(GridBox(a).add(b).add(c), [&](std::uint32_t m) {
            const GridPoint p = place(m);
            return p == a || p == b || p == c || !is_in_triangle(a, b, c, p);
        });
    }
    // Takes a node out of the ring. Returns the triangle.
    Triangle cut_off(std::uint32_t n) {
        const std::uint32_t before = nodes_[n].previous, after = nodes_[n].next;
        buckets_.remove(n, place(n), place(n));
        nodes_[before].next = after, nodes_[after].previous = before;
        nodes_[n].next = none;
        --left_;
        offer(before);
        offer(after);
        return {nodes_[before].corner, nodes_[n].corner, nodes_[after].corner};
    }

    const std::vector<GridPoint>& at_;
    std::vector<EarRing::Node> nodes_;  // next is none where one is cut off
    Buckets buckets_;
    Offers offers_;
    std::size_t left_;
};

}  // namespace detail

/// The triangles of polygons, which do not meet: outer borders with holes in them, and others in these. Corners are numbered in
/// the order of the loops; triangles are clockwise on the screen, and cover each point inside once.
[[nodiscard]] inline std::vector<Triangle> triangulate(const std::vector<Loop>& loops) {
    std::vector<GridPoint> at;
    std::vector<std::array<std::uint32_t, 2>> range;
    std::vector<double> area;
    for (const Loop& loop : loops) {
        const auto first = static_cast<std::uint32_t>(at.size());
        at.insert(at.end(), loop.begin(), loop.end());
        range.push_back({first, static_cast<std::uint32_t>(at.size())});
        area.push_back(static_cast<double>(double_area(loop)));
    }
    // A hole belongs to the least border around it.
    std::vector<std::vector<std::size_t>> holes(loops.size());
    for (std::size_t h = 0; h < loops.size(); ++h) {
        if (area[h] > 0) continue;
        std::size_t best = loops.size();
        for (std::size_t i = 0; i < loops.size(); ++i)
            if (area[i] > -area[h] && (best == loops.size() || area[i] < area[best]) && is_inside(loops[i], loops[h].front()))
                best = i;
        if (best < loops.size()) holes[best].push_back(h);
    }
    std::vector<Triangle> faces;
    for (std::size_t i = 0; i < loops.size(); ++i) {
        if (!(area[i] > 0)) continue;
        const auto leftmost = [&](std::size_t h) {
            std::int32_t x = std::numeric_limits<std::int32_t>::max();
            for (const GridPoint p : loops[h]) x = std::min(x, p.x);
            return x;
        };
        std::sort(holes[i].begin(), holes[i].end(), [&](std::size_t a, std::size_t b) {
            const std::int32_t x = leftmost(a), y = leftmost(b);
            return x != y ? x < y : a < b;
        });
        detail::EarRing ring(at);
        ring.add_border(range[i][0], range[i][1]);
        std::vector<std::array<std::uint32_t, 2>> others;
        for (std::size_t k = holes[i].size(); k-- > 0;) others.push_back(range[holes[i][k]]);
        while (!others.empty()) {
            const auto hole = others.back();
            others.pop_back();
            ring.add_hole(hole[0], hole[1], others);
        }
        detail::EarCutter(at, ring).cut(faces);
    }
    return faces;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_OUTLINE_TRIANGULATE_HPP
