/// \file
/// Removal: vertices leave the mesh, one after another, while it stays within the bound.
///
/// A vertex is merged into a neighbour (a half-edge collapse), which may change its heights to make up for it. Where that
/// misses the bound by little, the vertex leaves nevertheless, for a try: the neighbours are moved, as far as they may, and edges
/// flipped to bring all samples back, and if that fails everything is undone. Vertices leave in passes, those first whose loss
/// makes the smallest worst sample; one waits for the next pass where something around it has changed. A candidate costs some
/// 4 us, a try some 40.
#ifndef HMESH_METHODS_BOUNDED_REMOVAL_HPP
#define HMESH_METHODS_BOUNDED_REMOVAL_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "hmesh/core/array.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/mesh/geometry.hpp"
#include "hmesh/mesh/halfedge_mesh.hpp"
#include "hmesh/mesh/spatial_order.hpp"
#include "hmesh/methods/bounded/bounded_mesh.hpp"
#include "hmesh/methods/bounded/options.hpp"
#include "hmesh/methods/bounded/relax.hpp"
#include "hmesh/methods/bounded/star.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// Removes vertices of a mesh.
class BoundedRemoval {
  public:
    /// Works on this mesh, which must outlive it, with what the relaxation may do.
    BoundedRemoval(BoundedMesh& mesh, BoundedRelaxation& relaxation, const Moves& moves)
        : mesh_(&mesh), relaxation_(&relaxation), moves_(moves), star_(*mesh.field, relaxation.per_unit(), mesh.limit) {}

    /// One pass over the vertices whose surroundings have changed since they were tried. Returns how many left.
    HMESH_COLD std::size_t pass(const Array<Vertex>& vertices) {
        double area = 0;
        for (const Face f : mesh_->topology.faces()) {
            const auto v = mesh_->topology.vertices(f);
            area += 0.5 * orient2d(mesh_->position(v[0]), mesh_->position(v[1]), mesh_->position(v[2]));
        }
        // A try takes as long as the samples around it, and is worth it where they are few for what else a vertex costs.
        const double face = area / static_cast<double>(mesh_->topology.face_count());
        if (moves_.positions) {
            try_up_to_ = face > 100 ? 2.5 : 1.7;
            slowest_ = face > 100 ? 0.95 : 0.85;
        } else try_up_to_ = face < 4 ? 2 : 1.1;
        tried_.resize(mesh_->topology.vertex_slots(), 0);
        queue_.clear();
        const std::uint32_t now = mesh_->clock;
        for (std::size_t k = 0; k < vertices.size() && mesh_->keep_going(); ++k) {
            const Vertex v = vertices[k];
            if (mesh_->topology.is_deleted(v) || tried_[v.index()] >= mesh_->changed[v.index()]) continue;
            const Candidate candidate = best(v);
            if (candidate.halfedge.is_valid() && candidate.most <= try_up_to_) queue_.push_back(candidate);
            else tried_[v.index()] = now;
        }
        std::sort(queue_.begin(), queue_.end(), [](const Candidate& a, const Candidate& b) {
            return a.most != b.most ? a.most < b.most : a.halfedge < b.halfedge;
        });
        std::size_t count = 0;
        for (const Candidate& candidate : queue_) {
            if (!mesh_->keep_going()) break;
            const HalfedgeMesh& topology = mesh_->topology;
            if (topology.is_deleted(candidate.vertex) || mesh_->changed[candidate.vertex.index()] > now) continue;
            const Vertex into = topology.to_vertex(candidate.halfedge);
            if (mesh_->changed[into.index()] > now) continue;
            if (leave(candidate)) ++count;
            else tried_[candidate.vertex.index()] = mesh_->clock;
        }
        return count;
    }

    /// Marks the vertices that need not be tried again, in this piece or in another: those that were since something around them
    /// changed. Not those beside locked ones, which may have been in the way.
    HMESH_COLD void settle() {
        const HalfedgeMesh& topology = mesh_->topology;
        tried_.resize(topology.vertex_slots(), 0);
        for (const Vertex v : topology.vertices()) {
            bool is_done = tried_[v.index()] >= mesh_->changed[v.index()];
            for (const Halfedge h : topology.outgoing(v))
                is_done = is_done && (mesh_->vertices[topology.to_vertex(h).index()].freedom & is_locked) == 0;
            std::uint8_t& freedom = mesh_->vertices.edit(v.index()).freedom;
            is_done = is_done && (freedom & is_locked) == 0;
            freedom = static_cast<std::uint8_t>(is_done ? freedom | is_settled : freedom & ~is_settled);
        }
    }

  private:
    /// How far from the bound, in bounds, a removal is tried nevertheless.
    /// Of those above 1.7 one in a hundred succeeds: worth it where faces are so large that tries are few for the samples.
    double try_up_to_ = 1;
    /// What a round must leave of the excess at most for another to be worth it.
    double slowest_ = 0.9;
    static constexpr int try_rounds = 12;

    struct Candidate {
        Halfedge halfedge;  // of the vertex that leaves, to the one that it is merged into; invalid: none
        Vertex vertex;      // the one that leaves
        double most = 0;    // largest fit after, in bounds
        double energy = 0;
        float heights[max_bounded_channels] = {};  // of the other
    };

    /// The best of the collapses of v.
    [[nodiscard]] Candidate best(Vertex v) {
        Candidate found;
        found.vertex = v;
        if (!mesh_->vertices[v.index()].can(can_leave)) return found;
        for (const Halfedge h : mesh_->topology.outgoing(v)) {
            Candidate next;
            next.vertex = v;
            next.halfedge = h;
            if (!(moves_.heights ? evaluate_lifted(next) : evaluate(next, found))) continue;
            if (!found.halfedge.is_valid() || is_better(next, found)) found = next;
        }
        return found;
    }
    [[nodiscard]] static bool is_better(const Candidate& a, const Candidate& b) noexcept {
        if ((a.most <= 1) != (b.most <= 1)) return a.most <= 1;
        return a.most <= 1 ? a.energy < b.energy : a.most < b.most;
    }

    /// Calls body(a, b) for the far corners of the faces of v that stay when v is merged into `into`, until it returns false.
    template <class Body>
    bool for_each_kept(Vertex v, Vertex into, Body&& body) const {
        const HalfedgeMesh& topology = mesh_->topology;
        for (const Halfedge h : topology.outgoing(v)) {
            if (topology.is_boundary(h)) continue;
            const Vertex a = topology.to_vertex(h), b = topology.to_vertex(topology.next(h));
            if (a == into || b == into) continue;
            if (!body(mesh_->corner(a), mesh_->corner(b))) return false;
        }
        return true;
    }
    /// Whether v can be merged into the end of h and leave well shaped faces that cover what they must.
    [[nodiscard]] bool is_possible(Vertex v, Halfedge h) const {
        const HalfedgeMesh& topology = mesh_->topology;
        const Vertex into = topology.to_vertex(h);
        const Point place = mesh_->position(into);
        if (!for_each_kept(v, into,
                           [&](const Corner& a, const Corner& b) { return is_well_shaped(place, a.position, b.position); }))
            return false;
        if (!topology.is_collapse_ok(h)) return false;
        return !topology.is_boundary(v) || keeps_cover(v, h);
    }
    [[nodiscard]] bool keeps_cover(Vertex v, Halfedge h) const;

    /// Heights as they are: the largest error of the faces that change, exactly.
    [[nodiscard]] bool evaluate(Candidate& candidate, const Candidate& rival) const {
        const Vertex into = mesh_->topology.to_vertex(candidate.halfedge);
        if (!is_possible(candidate.vertex, candidate.halfedge)) return false;
        const Corner& apex = mesh_->corner(into);
        const double reach = try_up_to_ * mesh_->limit;
        const double enough = rival.halfedge.is_valid() ? std::min(reach, rival.energy) : reach;
        double worst = 0;
        const bool holds = for_each_kept(candidate.vertex, into, [&](const Corner& a, const Corner& b) {
            worst = std::max(worst, face_error(*mesh_->field, apex, a, b, enough));
            return worst <= enough;
        });
        for (int c = 0; c < mesh_->field->channels; ++c) candidate.heights[c] = apex.heights[c];
        candidate.energy = worst;
        candidate.most = mesh_->limit > 0 ? worst / mesh_->limit : 0;
        return holds;
    }
    /// With the heights that suit the samples best.
    [[nodiscard]] bool evaluate_lifted(Candidate& candidate) {
        const HalfedgeMesh& topology = mesh_->topology;
        const Vertex v = candidate.vertex, into = topology.to_vertex(candidate.halfedge);
        if (!is_possible(v, candidate.halfedge)) return false;
        const Corner& apex = mesh_->corner(into);
        star_.begin(apex, apex.position);
        if (!for_each_kept(v, into, [&](const Corner& a, const Corner& b) { return star_.add(a, b); })) return false;
        double heights[max_bounded_channels] = {};
        const bool can_change = mesh_->vertices[into.index()].can(can_lift);
        if (star_.fit(heights).most > (can_change ? hopeless : try_up_to_)) return false;
        if (!for_each_kept(into, v, [&](const Corner& a, const Corner& b) { return star_.add(a, b); })) return false;
        const Fit fit = can_change ? star_.lift(heights, 3) : star_.fit(heights);
        const Corner lifted = star_.apex(heights);
        for (int c = 0; c < mesh_->field->channels; ++c) candidate.heights[c] = lifted.heights[c];
        candidate.most = fit.most;
        candidate.energy = fit.energy;
        return true;
    }
    /// What no change of a height makes up for, in bounds.
    static constexpr double hopeless = 12;

    /// Removes the vertex if the mesh can be kept within the bound.
    bool leave(const Candidate& candidate) {
        HalfedgeMesh& topology = mesh_->topology;
        const Vertex into = topology.to_vertex(candidate.halfedge);
        if (candidate.most > 1) return try_to_leave(candidate);
        const HalfedgeMesh::Mark mark = topology.begin();
        const auto vertices = mesh_->vertices.mark();
        merge(candidate);
        // Without lifting the faces were held against the limit already.
        if (!moves_.heights || mesh_->holds_around(into)) {
            topology.commit(mark);
            mesh_->vertices.stop_recording();
            mesh_->touch(into);
            return true;
        }
        topology.rollback(mark);
        mesh_->vertices.rollback(vertices);
        mesh_->vertices.stop_recording();
        return false;
    }
    void merge(const Candidate& candidate) {
        const Vertex into = mesh_->topology.to_vertex(candidate.halfedge);
        mesh_->topology.collapse(candidate.halfedge);
        Corner& corner = mesh_->vertices.edit(into.index()).corner;
        for (int c = 0; c < mesh_->field->channels; ++c) corner.heights[c] = candidate.heights[c];
    }

    bool try_to_leave(const Candidate& candidate) {
        HalfedgeMesh& topology = mesh_->topology;
        const Vertex into = topology.to_vertex(candidate.halfedge);
        const HalfedgeMesh::Mark mark = topology.begin();
        const auto vertices = mesh_->vertices.mark();
        merge(candidate);
        moved_.clear();
        moved_.push_back(into);
        bool holds = false;
        double last = candidate.most;
        for (int round = 0; round < try_rounds && !holds; ++round) {
            relaxation_->move(into, true);
            ring_.clear();
            for (const Halfedge h : topology.outgoing(into)) ring_.push_back(topology.to_vertex(h));
            for (const Vertex v : ring_)
                if (relaxation_->move(v, true)) note(v);
            edges_.clear();
            for (const Halfedge h : topology.outgoing(into)) {
                edges_.push_back(HalfedgeMesh::edge(h));
                if (!topology.is_boundary(h)) edges_.push_back(HalfedgeMesh::edge(topology.next(h)));
            }
            for (const Edge e : edges_)
                if (relaxation_->flip(e, true)) {
                    const Halfedge h = HalfedgeMesh::halfedge(e), o = HalfedgeMesh::opposite(h);
                    for (const Vertex v : {topology.to_vertex(h), topology.to_vertex(o), topology.to_vertex(topology.next(h)),
                                           topology.to_vertex(topology.next(o))})
                        note(v);
                }
            const double most = worst_around();
            holds = most <= 1;
            if (!holds && most - 1 > slowest_ * (last - 1)) break;
            last = most;
        }
        if (holds)
            for (const Vertex v : moved_) holds = holds && mesh_->holds_around(v);
        if (holds) {
            topology.commit(mark);
            mesh_->vertices.stop_recording();
            for (const Vertex v : moved_) mesh_->touch(v);
            return true;
        }
        topology.rollback(mark);
        mesh_->vertices.rollback(vertices);
        mesh_->vertices.stop_recording();
        return false;
    }
    void note(Vertex v) {
        if (std::find(moved_.begin(), moved_.end(), v) == moved_.end()) moved_.push_back(v);
    }
    /// The largest fit of the faces at moved vertices.
    [[nodiscard]] double worst_around() {
        const HalfedgeMesh& topology = mesh_->topology;
        faces_.clear();
        for (const Vertex v : moved_)
            for (const Halfedge h : topology.outgoing(v))
                if (!topology.is_boundary(h)) faces_.push_back(topology.face(h));
        std::sort(faces_.begin(), faces_.end());
        faces_.erase(std::unique(faces_.begin(), faces_.end()), faces_.end());
        double most = 0;
        for (const Face f : faces_) {
            const auto v = topology.vertices(f);
            most = std::max(most, face_fit(*mesh_->field, mesh_->corner(v[0]), mesh_->corner(v[1]), mesh_->corner(v[2]),
                                           static_cast<float>(relaxation_->per_unit()))
                                      .most);
        }
        return most;
    }

    BoundedMesh* mesh_;
    BoundedRelaxation* relaxation_;
    Moves moves_;
    Star star_;
    Array<std::uint32_t> tried_;  ///< by vertex slot: mesh_->clock when its removal failed
    Array<Candidate> queue_;
    Array<Vertex> moved_, ring_;
    Array<Edge> edges_;
    Array<Face> faces_;
};

/// Whether the border may run from the vertex before v straight to the end of h, as seen along the border: along a side of the
/// image where v is on one, and on the rim of what has data so that no sample is lost and none comes in.
inline bool BoundedRemoval::keeps_cover(Vertex v, Halfedge h) const {
    const HalfedgeMesh& topology = mesh_->topology;
    const Halfedge out = topology.halfedge(v), in = topology.previous(out);
    const Vertex after = topology.to_vertex(out), before = topology.from_vertex(in);
    const Vertex into = topology.to_vertex(h);
    if (into != after && into != before) return false;
    const Point a = mesh_->position(before), b = mesh_->position(v), c = mesh_->position(after);
    // The border runs against the faces: positive where they lie in the triangle's angle at v.
    const double area = -orient2d(a, b, c);
    if (area == 0) return true;
    if (!mesh_->vertices[v.index()].can(on_rim)) return false;
    const HeightField& field = *mesh_->field;
    const bool squares = field.samples == Samples::squares;
    if (area > 0 && !squares) return false;  // v itself is a sample
    const auto is_between = [](Point p, Point q, Point r) {
        return orient2d(p, q, r) == 0 && std::min(p.x, q.x) <= r.x && r.x <= std::max(p.x, q.x) && std::min(p.y, q.y) <= r.y &&
               r.y <= std::max(p.y, q.y);
    };
    const double sign = area > 0 ? -1 : 1;
    const auto is_free = [&](double step_offset) {
        for (double y = std::floor(std::min({a.y, b.y, c.y})) + step_offset; y <= std::max({a.y, b.y, c.y}); ++y)
            for (double x = std::floor(std::min({a.x, b.x, c.x})) + step_offset; x <= std::max({a.x, b.x, c.x}); ++x) {
                const Point p{x, y};
                if (sign * orient2d(a, b, p) < 0 || sign * orient2d(b, c, p) < 0 || sign * orient2d(c, a, p) < 0) continue;
                if (area > 0 ? !is_between(c, a, p) : !is_between(a, b, p) && !is_between(b, c, p)) return false;
            }
        return true;
    };
    // What is cut away holds no sample, but for those on the new border; what is added none at all but for those on the old
    // one, and no place where another part of the rim may be.
    return is_free(field.offset()) && (area > 0 || !squares || is_free(0));
}

/// Takes vertices from a mesh within its limit, in at most `passes` passes, until one takes none
/// or mesh.keep_going() says stop; it holds all the time.
HMESH_COLD inline void shrink(BoundedMesh& mesh, Bounded::Effort effort, int passes) {
    if (effort == Bounded::Effort::draft) return;
    const bool can_lift_any = mesh.limit > 0;
    const Moves moves{effort >= Bounded::Effort::normal && can_lift_any, effort == Bounded::Effort::best && can_lift_any};
    BoundedRelaxation relaxation(mesh, moves);
    BoundedRemoval removal(mesh, relaxation, moves);
    const auto position = [&](Vertex v) { return mesh.position(v); };
    Array<std::uint32_t> relaxed(mesh.topology.vertex_slots(), 0);
    std::uint32_t flipped = 0;
    for (int pass = 0; pass < passes && mesh.keep_going(); ++pass) {
        const Array<Vertex> vertices = spatial_vertices(mesh.topology, position);
        if (moves.heights) {
            const std::uint32_t begin = mesh.clock;
            for (const Edge e : spatial_edges(mesh.topology, position)) {
                if (!mesh.keep_going()) break;
                const Halfedge h = HalfedgeMesh::halfedge(e);
                if (mesh.changed[mesh.topology.to_vertex(h).index()] > flipped ||
                    mesh.changed[mesh.topology.from_vertex(h).index()] > flipped)
                    relaxation.flip(e, false);
            }
            flipped = begin;
            for (const Vertex v : vertices) {
                if (!mesh.keep_going()) break;
                if (mesh.changed[v.index()] <= relaxed[v.index()]) continue;
                relaxed[v.index()] = mesh.clock;
                if (relaxation.move(v, false)) relaxed[v.index()] = 0;
            }
        }
        // Where nothing leaves any more, smaller moves may make room.
        if (removal.pass(vertices) > 0) continue;
        if (!moves.positions || relaxation.least_gain < 1e-3) break;
        relaxation.least_gain *= 0.25;
    }
    removal.settle();
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_BOUNDED_REMOVAL_HPP
