/// \file
/// FlipCoder: a triangulation of points that are known, as the flips that lead to it from that of Delaunay.
///
/// Flips come in rounds. In the first each edge is asked, in the order of its points; in each later one the edges around the
/// quadrilaterals that the round before has changed. An edge is passed over where it is on the border, where the other diagonal
/// does not lie inside, and for now where a triangle beside it was changed in this very round. So each flip is told in the first
/// round in which it is possible, and where there is none nothing is said but that: a Delaunay triangulation costs next to
/// nothing. A round without a flip is the last. Whatever the bits, what results is a triangulation of all points.
///
/// What tells a flip are the two angles across the edge, how much they are less than half a turn together, as they are at an edge
/// of Delaunay's, the two angles that would be across the new one, and the flips beside it.
#ifndef HMESH_IO_COMPACT_FLIPS_HPP
#define HMESH_IO_COMPACT_FLIPS_HPP

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "hmesh/core/array.hpp"
#include "hmesh/core/coded_order.hpp"
#include "hmesh/io/compact/arithmetic_coder.hpp"
#include "hmesh/io/compact/mixer.hpp"
#include "hmesh/io/compact/plane.hpp"
#include "hmesh/io/compact/start_table.hpp"
#include "hmesh/io/compact/triangulation.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

/// A flip: of which edge, in which round, counted from 1.
struct Flip {
    Triangulation::Index edge,  ///< the directed edge of even number
        round;                  ///< 1 or above
};

/// Which round has made the triangle to the left of each directed edge: 0 is that of Delaunay.
class Rounds {
  public:
    /// Of a triangulation without a flip.
    explicit Rounds(const Triangulation& mesh) : made_(mesh.edge_slots(), 0) {}
    /// The round of the triangle to the left of e.
    [[nodiscard]] std::uint32_t operator[](Triangulation::Index e) const noexcept { return made_[e]; }
    /// Notes that a round has made the triangle to the left of e.
    void set(const Triangulation& mesh, Triangulation::Index e, std::uint32_t round) noexcept {
        for (int k = 0; k < 3; ++k, e = mesh.previous(Triangulation::opposite(e))) made_[e] = round;
    }

  private:
    std::vector<std::uint32_t> made_;
};

/// Codes flips.
class FlipCoder {
  public:
    using Index = Triangulation::Index;

    /// With the coder that it writes to or reads from, which outlives it, as the tables do.
    FlipCoder(ArithmeticCoder& coder, const Logistic& logistic)
        : coder_(&coder), mixer_(logistic, std::size_t{3} * 16, 26000), angles_(std::size_t{3} * 256),
          shapes_(std::size_t{3} * 16 * 256), near_(std::size_t{3} * 3 * 32 * 32) {}

    /// The most flips of a triangulation of n points: what needs more is not coded, and not read.
    [[nodiscard]] static std::size_t most_flips(std::size_t n) noexcept { return 64 * n; }

    /// Codes the flips that lead from the Delaunay triangulation `mesh` to another, which it becomes. Where it writes, `flips`
    /// are these, sorted by edge, and of one edge by round. False: what is read ended before, or flips more than most_flips().
    bool code(Triangulation& mesh, const std::vector<Flip>& flips) {
        const bool writes = coder_->writes();
        Rounds rounds(mesh);
        std::vector<Index> asked = all_edges(mesh), next;
        std::vector<std::uint32_t> listed(mesh.edge_slots() / 2, 0);
        std::size_t left = most_flips(mesh.point_count());
        for (std::uint32_t round = 1; !asked.empty(); ++round) {
            next.clear();
            for (const Index e : asked) {
                if (rounds[e] == round || rounds[Triangulation::opposite(e)] == round) continue;
                Triangulation::Quadrilateral q = mesh.around(e);
                if (!mesh.is_convex(q)) continue;
                const bool is_truth = writes && is_among(flips, {e & ~Index{1}, round});
                if (!code_flip(mesh, rounds, q, e, round, is_truth)) continue;
                if (left-- == 0 || coder_->is_exhausted()) return false;
                // From the lesser of the edge's ends, so that the order does not depend on how edges are kept.
                if (q.b < q.a) q = {q.b, q.a, q.d, q.c};
                mesh.flip(e);
                rounds.set(mesh, e, round);
                rounds.set(mesh, Triangulation::opposite(e), round);
                for (const Index h : sides_of(mesh, e, q))
                    if (listed[h / 2] != round) {
                        listed[h / 2] = round;
                        next.push_back(h);
                    }
            }
            if (coder_->is_exhausted()) return false;
            asked.swap(next);
        }
        return true;
    }

    /// What it has learnt.
    [[nodiscard]] Learnt learnt() { return {{&angles_, &shapes_, &near_}, &mixer_.weights()}; }

  private:
    // All edges, each once, by the lesser of its points and then by the other.
    [[nodiscard]] static std::vector<Index> all_edges(const Triangulation& mesh) {
        std::vector<Index> edges;
        edges.reserve(mesh.edge_slots() / 2);
        for (Index v = 0; v < mesh.point_count(); ++v) {
            const std::size_t begin = edges.size();
            Index e = mesh.first(v);
            for (Index k = 0; k < mesh.degree(v); ++k, e = mesh.next(e))
                if (mesh.to(e) > v) edges.push_back(e);
            std::sort(edges.begin() + static_cast<std::ptrdiff_t>(begin), edges.end(),
                      [&](Index a, Index b) { return mesh.to(a) < mesh.to(b); });
        }
        return edges;
    }
    // The sides of the quadrilateral of a flipped edge: those from a to c, c to b, b to d, d to a.
    [[nodiscard]] static std::array<Index, 4> sides_of(const Triangulation& mesh, Index e,
                                                       const Triangulation::Quadrilateral& q) noexcept {
        // The edge is now between c and d; seen from d, a is to its left.
        if (mesh.from(e) != q.d) e = Triangulation::opposite(e);
        const Index o = Triangulation::opposite(e);
        return {mesh.previous(o), mesh.next(o), mesh.previous(e), mesh.next(e)};
    }
    [[nodiscard]] static bool is_among(const std::vector<Flip>& flips, Flip flip) noexcept {
        return std::binary_search(flips.begin(), flips.end(), flip, [](const Flip& a, const Flip& b) {
            return a.edge != b.edge ? a.edge < b.edge : a.round < b.round;
        });
    }

    bool code_flip(const Triangulation& mesh, const Rounds& rounds, const Triangulation::Quadrilateral& q, Index e,
                   std::uint32_t round, bool value) {
        const GridPoint a = mesh.point(q.a), b = mesh.point(q.b), c = mesh.point(q.c), d = mesh.point(q.d);
        const int at_c = angle64(c, a, b), at_d = angle64(d, b, a);
        const auto slack = static_cast<std::size_t>(std::max(0, std::min(63, 79 - at_c - at_d)));  // 16 or so: a circle
        const std::size_t phase = std::min<std::uint32_t>(round, 3) - 1;
        const Index o = Triangulation::opposite(e);
        const std::size_t fresh = (rounds[e] + 1 == round ? 1U : 0U) + (rounds[o] + 1 == round ? 1U : 0U);
        // Triangles beyond the four sides that a flip has made; of this round's, each is six.
        std::size_t flipped = 0;
        for (const Index side :
             {mesh.next(e), mesh.next(o), Triangulation::opposite(mesh.previous(e)), Triangulation::opposite(mesh.previous(o))})
            flipped += rounds[side] == 0 ? 0U : rounds[side] == round ? 6U : 1U;
        const int at_a = angle64(a, d, c), at_b = angle64(b, c, d);
        const auto place = [](int low, int high) {
            return static_cast<std::size_t>(std::min(low, high) / 4 * 16 + std::max(low, high) / 4);
        };
        return mixer_.code(
            *coder_, value,
            {&angles_[phase * 256 + place(at_c, at_d)], &shapes_[(phase * 16 + slack / 4) * 256 + place(at_a, at_b)],
             &near_[((phase * 3 + fresh) * 32 + slack / 2) * 32 + flipped]},
            phase * 16 + slack / 4);
    }

    ArithmeticCoder* coder_;
    Mixer<3> mixer_;
    std::vector<AdaptiveBit> angles_, shapes_, near_;
};

/// The flips that lead from the Delaunay triangulation of points to one that has these edges, found by inserting one after the
/// other; `mesh` is the former and becomes the latter. Sorted as FlipCoder wants them. False: an edge cannot be there, as it
/// leads over a point, or there are more flips than most_flips(). Of edges that cross the last stays: who calls has to look.
/// After S. Sloan, "A fast algorithm for generating constrained Delaunay triangulations", 1993.
class FlipFinder {
  public:
    using Index = Triangulation::Index;

    /// Of a Delaunay triangulation that is without a flip yet, and outlives this.
    explicit FlipFinder(Triangulation& mesh) : mesh_(&mesh), rounds_(mesh), last_(mesh.edge_slots() / 2, no_flip) {}

    /// Inserts edges, in their order.
    bool insert(const std::vector<std::array<Index, 2>>& edges) {
        std::vector<std::array<Index, 2>> missing, still;
        for (const auto& edge : edges)
            if (mesh_->find(edge[0], edge[1]) == Triangulation::none) missing.push_back(edge);
        // Those first that one flip makes, as each may bring others near.
        for (std::size_t before = 0; before != missing.size();) {
            before = missing.size();
            still.clear();
            for (const auto& edge : missing) {
                if (!find_crossed(edge, 1)) return false;
                if (crossed_.size() == 1) flip(crossed_[0]);
                else still.push_back(edge);
            }
            missing.swap(still);
            if (count_ > most()) return false;
        }
        for (const auto& edge : missing)
            if (!insert(edge)) return false;
        return true;
    }

    /// The flips made, sorted.
    [[nodiscard]] std::vector<Flip> flips() const {
        kit::Array<kit::Coded> order;
        for (std::uint32_t k = 0; k < made_.size(); ++k)
            if (!made_[k].is_undone) order.push_back({kit::code_of(made_[k].flip.edge, made_[k].flip.round), k});
        kit::sort_by_code(order);
        std::vector<Flip> sorted;
        for (const kit::Coded& at : order) sorted.push_back(made_[at.number].flip);
        return sorted;
    }

  private:
    [[nodiscard]] std::size_t most() const noexcept { return FlipCoder::most_flips(mesh_->point_count()); }

    // A flip that was made, and what it changed.
    struct Made {
        Flip flip;
        std::uint32_t left, right;  // rounds of the triangles before, beside its edge of even number
        Index from;                 // where that began
        std::size_t before;         // the flip of this edge before it, or no_flip
        bool is_undone;
    };
    static constexpr std::size_t no_flip = static_cast<std::size_t>(-1);

    void flip(Index e) {
        const Index o = Triangulation::opposite(e);
        std::size_t& last = last_[e / 2];
        if (last != no_flip && rounds_[e] == made_[last].flip.round && rounds_[o] == made_[last].flip.round) {
            // Both triangles are what its last flip has made: this one undoes it, which cannot be told and need not be.
            const Made made = made_[last];
            mesh_->flip(e);
            const Index even = e & ~Index{1};
            const bool is_turned = mesh_->from(even) != made.from;  // as two flips turn an edge round, and four do not
            rounds_.set(*mesh_, even, is_turned ? made.right : made.left);
            rounds_.set(*mesh_, even | 1U, is_turned ? made.left : made.right);
            made_[last].is_undone = true;
            last = made.before;
            --count_;
            return;
        }
        const std::uint32_t round = 1 + std::max(rounds_[e], rounds_[o]);
        made_.push_back(
            {{e & ~Index{1}, round}, rounds_[e & ~Index{1}], rounds_[e | 1U], mesh_->from(e & ~Index{1}), last, false});
        last = made_.size() - 1;
        ++count_;
        mesh_->flip(e);
        rounds_.set(*mesh_, e, round);
        rounds_.set(*mesh_, o, round);
    }
    [[nodiscard]] std::int64_t side(std::array<Index, 2> edge, Index v) const noexcept {
        return orient2d(mesh_->point(edge[0]), mesh_->point(edge[1]), mesh_->point(v));
    }
    [[nodiscard]] bool does_cross(std::array<Index, 2> edge, Index e) const noexcept {
        const Index a = mesh_->from(e), b = mesh_->to(e);
        if (a == edge[0] || a == edge[1] || b == edge[0] || b == edge[1]) return false;
        const std::int64_t at_a = side(edge, a), at_b = side(edge, b);
        return (at_a > 0 && at_b < 0) || (at_a < 0 && at_b > 0);
    }
    // The edges that one which is not there would cross, from its first point on: none where it is there, and `most` + 1 at most.
    bool find_crossed(std::array<Index, 2> edge, std::size_t most) {
        crossed_.clear();
        if (mesh_->find(edge[0], edge[1]) != Triangulation::none) return true;
        if (mesh_->degree(edge[1]) < mesh_->degree(edge[0])) std::swap(edge[0], edge[1]);
        Index e = mesh_->first(edge[0]), at = Triangulation::none;
        for (Index k = 0; k < mesh_->degree(edge[0]) && at == Triangulation::none; ++k, e = mesh_->next(e))
            if (mesh_->apex(e) != Triangulation::none && side(edge, mesh_->to(e)) < 0 && side(edge, mesh_->apex(e)) > 0)
                at = mesh_->previous(Triangulation::opposite(e));  // the side across from the first point, from right to left
        if (at == Triangulation::none) return false;
        for (;;) {
            crossed_.push_back(at);
            if (crossed_.size() > most) return true;
            at = Triangulation::opposite(at);
            const Index v = mesh_->apex(at);
            if (v == Triangulation::none) return false;
            if (v == edge[1]) return true;
            const std::int64_t turn = side(edge, v);
            if (turn == 0) return false;
            // `at` now leads from left to right; the next side crossed leads from its end to v, or from v to its begin.
            at = turn > 0 ? mesh_->previous(Triangulation::opposite(at)) : Triangulation::opposite(mesh_->next(at));
        }
    }
    bool insert(std::array<Index, 2> edge) {
        if (!find_crossed(edge, mesh_->edge_slots())) return false;
        // Where an edge cannot be flipped for now another comes first: one that can there is always.
        const std::size_t most_tries = 64 * crossed_.size() * crossed_.size() + 64;
        for (std::size_t k = 0; k < crossed_.size(); ++k) {
            const Index e = crossed_[k];
            if (count_ > most() || k > most_tries) return false;
            if (mesh_->is_convex(mesh_->around(e))) flip(e);
            if (does_cross(edge, e)) crossed_.push_back(e);
        }
        return mesh_->find(edge[0], edge[1]) != Triangulation::none;
    }

    Triangulation* mesh_;
    Rounds rounds_;
    std::vector<Made> made_;
    std::vector<std::size_t> last_;  // the last flip of each edge in made_, or no_flip
    std::size_t count_ = 0;          // flips that were not undone
    std::vector<Index> crossed_;
};

}  // namespace hmesh::detail

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_COMPACT_FLIPS_HPP
