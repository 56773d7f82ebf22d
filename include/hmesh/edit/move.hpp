/// \file
/// Vertices: move one vertex, or all in turn, to where the picture fits best.
///
/// One visit: the vertex's colour goes to its optimum, and one Gauss-Newton step with the colour eliminated is tried; it
/// stays if the exact energy of the ring falls. Gauss-Seidel over such visits beats a joint Levenberg-Marquardt step by
/// far (the normal equations are mass-like, so there is no long-range coupling to profit from). A visit walks each spoke
/// once and evaluates the ring twice, some 0.6 us.
#ifndef HMESH_EDIT_MOVE_HPP
#define HMESH_EDIT_MOVE_HPP

#include <algorithm>
#include <cmath>
#include <vector>

#include "hmesh/edit/tolerance.hpp"
#include "hmesh/fit/image_mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// The state of a ring's centre, and what the ring costs with it.
template <int C>
struct RingCenter {
    Point position;
    Color<C> color;
    double energy = 0;
};

namespace detail {

/// The longest step that is tried: 0.6 of the root mean square length of a ring's spokes.
template <int C>
[[nodiscard]] inline double step_cap(const Ring<C>& ring, Point v) noexcept {
    double sum = 0;
    for (int i = 0; i < ring.size; ++i) {
        const double dx = ring.neighbor[i]->position.x - v.x, dy = ring.neighbor[i]->position.y - v.y;
        sum += dx * dx + dy * dy;
    }
    return 0.6 * std::sqrt(sum / ring.size);
}

}  // namespace detail

/// Workspace of one ring optimisation, too large to clear on every call.
template <int C>
struct RingScratch {
    Ring<C> ring;
    Spokes<C> spokes, trial_spokes;
    FaceFit<C> faces[ring_capacity], trial_faces[ring_capacity];
};

/// What optimise_centre() did.
enum class RingOutcome { degenerate, recolored, moved };

/// Optimises the centre of scratch.ring: `centre` holds position and colour on entry and the best found on return, with its
/// energy; scratch.spokes and scratch.faces belong to it. `least` is the predicted decrease below which no step is tried.
/// degenerate: a face is smaller than limits allow, nothing done.
template <int C>
RingOutcome optimize_center(const ImageMesh<C>& mesh, RingScratch<C>& scratch, Mobility mobility, double least, bool may_move,
                            RingCenter<C>& center) {
    const MeshLimits& limits = mesh.limits();
    RingFit<C> fit;
    if (!fit_ring(scratch.ring, scratch.spokes, center.position, limits.min_double_area, scratch.faces, fit))
        return RingOutcome::degenerate;
    // A ring without weight wants nothing: it is not to chase the rounding of its sums.
    if (mesh.table().is_weighted() && !(ring_weight(scratch.ring, scratch.spokes) > least_weight)) {
        center.energy = fit.energy(center.color);
        return RingOutcome::recolored;
    }
    center.color = best_color(fit, center.color, limits.ridge, mesh.color_low(), mesh.color_high());
    center.energy = fit.energy(center.color);
    if (!may_move || mobility == Mobility::corner) return RingOutcome::recolored;

    const RingStep step = gauss_newton_step(scratch.ring, scratch.faces, fit, center.color, mobility);
    if (!(step.predicted > least)) return RingOutcome::recolored;
    double dx = step.dx, dy = step.dy;
    const double length = std::sqrt(dx * dx + dy * dy), cap = detail::step_cap(scratch.ring, center.position);
    if (length > cap) {
        dx *= cap / length;
        dy *= cap / length;
    }
    // Halve the step while a face would get too small; the last of 6 tries is 1/32 of it.
    for (int halvings = 0; halvings < 6; ++halvings, dx *= 0.5, dy *= 0.5) {
        const Point trial = mesh.clamp({center.position.x + dx, center.position.y + dy}, mobility);
        if (trial == center.position) break;
        if (!scratch.ring.accepts(trial, limits.min_double_area)) continue;
        walk_spokes(mesh.table(), scratch.ring, trial, scratch.trial_spokes);
        RingFit<C> trial_fit;
        if (!fit_ring(scratch.ring, scratch.trial_spokes, trial, limits.min_double_area, scratch.trial_faces, trial_fit))
            continue;
        const Color<C> color = best_color(trial_fit, center.color, limits.ridge, mesh.color_low(), mesh.color_high());
        const double energy = trial_fit.energy(color);
        if (!(energy < center.energy)) break;
        center = {trial, color, energy};
        std::copy_n(scratch.trial_spokes.spoke, scratch.ring.size, scratch.spokes.spoke);
        std::copy_n(scratch.trial_faces, scratch.ring.size, scratch.faces);
        return RingOutcome::moved;
    }
    return RingOutcome::recolored;
}

/// One visit of v; returns by how much the energy fell, >= 0. Steps that promise less than `least` are not tried.
template <int C>
double improve_vertex(ImageMesh<C>& mesh, Vertex v, double least) {
    if (mesh.vertex(v).mobility == Mobility::locked) return 0;
    RingScratch<C> scratch;
    mesh.gather(v, scratch.ring, scratch.spokes);
    const double before = mesh.energy(scratch.ring);
    const VertexState<C>& state = mesh.vertex(v);
    RingCenter<C> center{state.position, state.color, 0};
    const RingOutcome outcome = optimize_center(mesh, scratch, state.mobility, least, true, center);
    if (outcome == RingOutcome::degenerate || !(center.energy < before)) return 0;
    mesh.apply_fit(v, scratch.ring, center.position, center.color, scratch.faces,
                   outcome == RingOutcome::moved ? &scratch.spokes : nullptr);
    return before - center.energy;
}

/// Visits all vertices that are due, in spatial order; returns by how much the energy fell.
template <int C>
double sweep(ImageMesh<C>& mesh, const Tolerance& tolerance = {}) {
    const double start = mesh.energy();
    const double spread = tolerance.propagate_above * mesh.mean_energy(), least = tolerance.min_gain * mesh.mean_energy();
    for (const Vertex v : spatial_vertices(mesh)) {
        if (!mesh.is_dirty(v) || mesh.vertex(v).mobility == Mobility::locked) continue;  // due for another patch
        if (!mesh.keep_going()) break;
        mesh.set_dirty(v, false);
        if (improve_vertex(mesh, v, least) > spread) mesh.set_ring_dirty(v);
    }
    return start - mesh.energy();
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_EDIT_MOVE_HPP
