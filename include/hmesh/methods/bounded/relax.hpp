/// \file
/// Relaxation: vertices move and edges flip so that the mesh is nearer to its worst samples, which makes room for removals.
///
/// Both lower the energy of the faces they change (methods/bounded/star.hpp), and neither takes a face beyond the bound that is
/// within it. A move costs some 1.5 us, a flip that is refused 0.2.
#ifndef HMESH_METHODS_BOUNDED_RELAX_HPP
#define HMESH_METHODS_BOUNDED_RELAX_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "hmesh/core/compiler.hpp"
#include "hmesh/mesh/geometry.hpp"
#include "hmesh/mesh/halfedge_mesh.hpp"
#include "hmesh/methods/bounded/bounded_mesh.hpp"
#include "hmesh/methods/bounded/star.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// What relaxation and removal may do.
struct Moves {
    bool heights;    ///< change heights
    bool positions;  ///< and positions
};

/// Moves vertices and flips edges of a mesh.
class BoundedRelaxation {
  public:
    /// Works on this mesh, which must outlive it.
    BoundedRelaxation(BoundedMesh& mesh, const Moves& moves)
        : mesh_(&mesh), moves_(moves), per_unit_(1 / unit(mesh)), now_(*mesh.field, per_unit_, mesh.limit),
          then_(*mesh.field, per_unit_, mesh.limit) {}

    /// What is 1 to fits: a little less than the limit, by what floats may be wrong; for limits that floats cannot tell from 0
    /// what they can.
    [[nodiscard]] static double unit(const BoundedMesh& mesh) noexcept {
        return std::max(mesh.limit * (1 - 1e-4), std::max(1e-30, 1e-6 * mesh.field->rounding.largest));
    }
    /// The share of its energy that a move must gain, but in trials: each makes all around it be tried anew.
    double least_gain = 0.02;

    [[nodiscard]] double per_unit() const noexcept { return per_unit_; }  ///< 1 / unit()

    /// Moves v if that lowers the energy of its star. `is_trial`: faces may be beyond the bound, and whether they still are is
    /// not asked; else all were within it and are. Returns whether it moved.
    bool move(Vertex v, bool is_trial) {
        const BoundedVertex& state = mesh_->vertices[v.index()];
        if (!moves_.heights || !state.can(can_lift)) return false;
        const bool slide_x = moves_.positions && state.can(can_slide_x), slide_y = moves_.positions && state.can(can_slide_y);
        const Point old = state.corner.position;
        if (!gather(now_, v, old)) return false;
        double heights[max_bounded_channels] = {}, step[2 + max_bounded_channels] = {};
        const Fit before = now_.fit(heights);
        if (!(before.most > 1e-3) || !now_.direction(heights, before, slide_x, slide_y, step)) return false;
        const double ceiling = std::max(1.0, before.most);
        for (const double share : {0.5, 0.15, 0.04}) {
            double trial[max_bounded_channels];
            for (int c = 0; c < mesh_->field->channels; ++c) trial[c] = share * step[2 + c];
            const Point place = target(state, old, share * step[0], share * step[1]);
            const bool stays = place == old;
            if (!stays && !gather(then_, v, place)) continue;
            const Star& star = stays ? now_ : then_;
            const Fit after = star.fit(trial);
            if (!(after.energy < before.energy * (1 - (is_trial ? 1e-4 : least_gain))) || after.most > ceiling) continue;
            const Corner corner = state.corner, moved = star.apex(trial);
            mesh_->vertices.edit(v.index()).corner = moved;
            if (is_trial || mesh_->holds_around(v)) {
                if (!is_trial) mesh_->touch(v);
                return true;
            }
            mesh_->vertices.edit(v.index()).corner = corner;
            return false;
        }
        return false;
    }

    /// Flips e if that lowers the energy of its faces; see move().
    bool flip(Edge e, bool is_trial) {
        HalfedgeMesh& topology = mesh_->topology;
        const Halfedge a = HalfedgeMesh::halfedge(e), b = HalfedgeMesh::opposite(a);
        if (topology.is_boundary(a) || topology.is_boundary(b)) return false;
        const Vertex v0 = topology.to_vertex(b), v1 = topology.to_vertex(a);
        const Vertex v2 = topology.to_vertex(topology.next(a)), v3 = topology.to_vertex(topology.next(b));
        const Corner &c0 = mesh_->corner(v0), &c1 = mesh_->corner(v1), &c2 = mesh_->corner(v2), &c3 = mesh_->corner(v3);
        if (!is_well_shaped(c0.position, c3.position, c2.position) || !is_well_shaped(c3.position, c1.position, c2.position))
            return false;
        const HeightField& field = *mesh_->field;
        const auto fit = [&](const Corner& p, const Corner& q, const Corner& r) {
            return face_fit(field, p, q, r, static_cast<float>(per_unit_));
        };
        const Fit old_a = fit(c0, c1, c2), old_b = fit(c1, c0, c3);
        const double old_energy = old_a.energy + old_b.energy, ceiling = std::max({1.0, old_a.most, old_b.most});
        if (!(old_energy > 1e-20)) return false;
        const Fit new_a = fit(c0, c3, c2);
        if (!(new_a.energy < old_energy * (1 - 1e-4)) || new_a.most > ceiling) return false;
        const Fit new_b = fit(c3, c1, c2);
        if (!(new_a.energy + new_b.energy < old_energy * (1 - 1e-4)) || new_b.most > ceiling) return false;
        // Two locked vertices may be joined by an edge beyond the patch.
        if (!topology.is_flip_ok(e)) return false;
        if (!is_trial && (face_error(field, c0, c3, c2, mesh_->limit) > mesh_->limit ||
                          face_error(field, c3, c1, c2, mesh_->limit) > mesh_->limit))
            return false;
        topology.flip(e);
        if (!is_trial) {
            ++mesh_->clock;
            for (const Vertex v : {v0, v1, v2, v3}) mesh_->changed[v.index()] = mesh_->clock;
        }
        return true;
    }

  private:
    /// The star of v with v at `place`. False where that is not well shaped.
    [[nodiscard]] bool gather(Star& star, Vertex v, Point place) const {
        star.begin(mesh_->corner(v), place);
        const HalfedgeMesh& topology = mesh_->topology;
        for (const Halfedge h : topology.outgoing(v)) {
            if (topology.is_boundary(h)) continue;
            if (!star.add(mesh_->corner(topology.to_vertex(h)), mesh_->corner(topology.to_vertex(topology.next(h)))))
                return false;
        }
        return true;
    }
    /// Where a step leads: on the 1/256 px grid, not farther than half way out of the rectangle's inside.
    [[nodiscard]] Point target(const BoundedVertex& state, Point from, double dx, double dy) const noexcept {
        constexpr double gap = 1.0 / 16;
        const double right = mesh_->field->right(), bottom = mesh_->field->bottom();
        Point to = from;
        const double reach = std::max(std::abs(dx), std::abs(dy)), scale = reach > 8 ? 8 / reach : 1;
        if (state.can(can_slide_x)) to.x = snap(std::max(gap, std::min(right - gap, from.x + dx * scale)));
        if (state.can(can_slide_y)) to.y = snap(std::max(gap, std::min(bottom - gap, from.y + dy * scale)));
        return to;
    }

    BoundedMesh* mesh_;
    Moves moves_;
    double per_unit_;
    Star now_, then_;
};

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_BOUNDED_RELAX_HPP
