/// \file
/// Vertex moves: optimise position and colour of one vertex, or of all dirty vertices in turn.
///
/// A visit sets the vertex's colour to its optimum and tries one Gauss-Newton step of the position with the colour eliminated;
/// the step is kept if the exact energy of the ring falls. Gauss-Seidel over such visits beats a joint Levenberg-Marquardt step
/// by far: the normal equations are those of a mass matrix, so there is no long-range coupling to profit from.
///
/// Cost: a visit walks each spoke once and evaluates the ring twice, some 0.6 us.
#ifndef HMESH_EDIT_MOVE_HPP
#define HMESH_EDIT_MOVE_HPP

#include <cmath>
#include <limits>

#include "hmesh/core/array.hpp"
#include "hmesh/edit/tolerance.hpp"
#include "hmesh/fit/image_mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// The state of a ring's centre vertex, and the energy of the ring with it.
template <int C>
struct RingCenter {
    Point position;     ///< px, in the plane of the mesh's table
    Color<C> color;     ///< stored values
    double energy = 0;  ///< of the faces of the ring
};

namespace detail {

/// The longest step to try, in px: 0.6 of the root mean square length of the ring's spokes, with the centre at v.
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

/// The ring with its centre at `position`, in the colour that is best there: `center` becomes that, and spokes and faces those of
/// it. `current`: the colour that the ridge favours. False, and `center` stays: a face is smaller than limits().min_double_area.
template <int C>
[[nodiscard]] bool fit_center(const ImageMesh<C>& mesh, const Ring<C>& ring, Point position, const Color<C>& current,
                              Spokes<C>& spokes, FaceFit<C>* faces, RingCenter<C>& center) {
    const MeshLimits& limits = mesh.limits();
    walk_spokes(mesh.table(), ring, position, spokes);
    RingFit<C> fit;
    if (!fit_ring(ring, spokes, position, limits.min_double_area, faces, fit)) return false;
    center.position = position;
    center.color = best_color(fit, current, limits.ridge, mesh.color_low(), mesh.color_high());
    center.energy = fit.energy(center.color);
    return true;
}

/// Workspace for optimising one ring; tens of kB, so callers that visit many rings keep one.
template <int C>
struct RingScratch {
    Ring<C> ring;                           ///< the neighbours, and the moments of the edges opposite the centre
    Spokes<C> spokes;                       ///< moments of the edges from the centre as it is
    Spokes<C> trial_spokes;                 ///< moments of the edges from a trial position
    FaceFit<C> faces[ring_capacity];        ///< fits of the ring's faces as they are
    FaceFit<C> trial_faces[ring_capacity];  ///< fits of the ring's faces for a trial position
};

/// The outcome of optimize_center().
enum class RingOutcome {
    degenerate,  ///< a face is smaller than limits().min_double_area: nothing was done
    recolored,   ///< the position stayed, the colour is the best for it
    moved,       ///< position and colour are new
};

/// Optimises the centre of scratch.ring. `center` holds position and colour on entry, and on return the best found with the
/// energy of the ring; scratch.spokes must fit the position on entry. On return scratch.trial_spokes and scratch.trial_faces fit
/// it where the centre moved, else scratch.spokes and scratch.faces. No step is tried unless `may_move`, its predicted decrease
/// of the energy is above `min_gain`, and 1.3 times as much would bring the energy below `bound`. The mesh itself stays as it is.
template <int C>
RingOutcome optimize_center(const ImageMesh<C>& mesh, RingScratch<C>& scratch, Mobility mobility, double min_gain, bool may_move,
                            RingCenter<C>& center, double bound = std::numeric_limits<double>::max()) {
    const MeshLimits& limits = mesh.limits();
    RingFit<C> fit;
    if (!fit_ring(scratch.ring, scratch.spokes, center.position, limits.min_double_area, scratch.faces, fit))
        return RingOutcome::degenerate;
    // A ring whose pixels have no weight stays: its sums are rounding, and a step would follow that.
    if (mesh.table().is_weighted() && !(ring_weight(scratch.ring, scratch.spokes) > least_weight)) {
        center.energy = fit.energy(center.color);
        return RingOutcome::recolored;
    }
    center.color = best_color(fit, center.color, limits.ridge, mesh.color_low(), mesh.color_high());
    center.energy = fit.energy(center.color);
    if (!may_move || mobility == Mobility::corner) return RingOutcome::recolored;

    const RingStep step = gauss_newton_step(scratch.ring, scratch.faces, fit, center.color, mobility);
    if (!(step.predicted > min_gain) || !(center.energy - 1.3 * step.predicted < bound)) return RingOutcome::recolored;
    double dx = step.dx, dy = step.dy;
    const double length = std::sqrt(dx * dx + dy * dy), cap = detail::step_cap(scratch.ring, center.position);
    if (length > cap) {
        dx *= cap / length;
        dy *= cap / length;
    }
    // Halve the step while a face would get too small; the last of 6 trials is 1/32 of the step.
    for (int halvings = 0; halvings < 6; ++halvings, dx *= 0.5, dy *= 0.5) {
        const Point trial = mesh.clamp({center.position.x + dx, center.position.y + dy}, mobility);
        if (trial == center.position) break;
        if (!scratch.ring.accepts(trial, limits.min_double_area)) continue;
        RingCenter<C> moved;
        if (!fit_center(mesh, scratch.ring, trial, center.color, scratch.trial_spokes, scratch.trial_faces, moved)) continue;
        if (!(moved.energy < center.energy)) break;
        center.position = moved.position;  // one by one, as a copy of all would wait for these to be stored
        center.color = moved.color;
        center.energy = moved.energy;
        return RingOutcome::moved;
    }
    return RingOutcome::recolored;
}

/// Visits v: optimises its colour, and its position where the step's predicted gain is above `min_gain`, an energy. Returns the
/// decrease of the mesh's energy, >= 0; 0 for locked vertices. About 0.6 us.
template <int C>
double improve_vertex(ImageMesh<C>& mesh, Vertex v, double min_gain) {
    if (mesh.vertex(v).mobility == Mobility::locked) return 0;
    RingScratch<C> scratch;
    mesh.gather(v, scratch.ring, scratch.spokes);
    const double before = mesh.energy(scratch.ring);
    const VertexState<C>& state = mesh.vertex(v);
    RingCenter<C> center{state.position, state.color, 0};
    const RingOutcome outcome = optimize_center(mesh, scratch, state.mobility, min_gain, true, center);
    if (outcome == RingOutcome::degenerate || !(center.energy < before)) return 0;
    const bool moved = outcome == RingOutcome::moved;
    mesh.apply_fit(v, scratch.ring, center.position, center.color, moved ? scratch.trial_faces : scratch.faces,
                   moved ? &scratch.trial_spokes : nullptr);
    return before - center.energy;
}

/// Visits those of `vertices` that are dirty, once and in their order, and clears their marks; where a visit gains more than
/// tolerance.propagate_above, the vertex and its neighbours become dirty again. Ends early where mesh.keep_going() says stop.
/// Returns the decrease of the energy.
template <int C>
double sweep(ImageMesh<C>& mesh, const Array<Vertex>& vertices, const Tolerance& tolerance) {
    const double start = mesh.energy();
    const double propagate_above = tolerance.propagate_above * mesh.mean_energy();
    const double min_gain = tolerance.min_gain * mesh.mean_energy();
    for (const Vertex v : vertices) {
        if (!mesh.is_dirty(v) || mesh.vertex(v).mobility == Mobility::locked) continue;  // locked: dirty for another patch
        if (!mesh.keep_going()) break;
        mesh.set_dirty(v, false);
        if (improve_vertex(mesh, v, min_gain) > propagate_above) mesh.set_ring_dirty(v);
    }
    return start - mesh.energy();
}
/// The same for all vertices of the mesh, in spatial order.
template <int C>
double sweep(ImageMesh<C>& mesh, const Tolerance& tolerance = {}) {
    return sweep(mesh, spatial_vertices(mesh), tolerance);
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_EDIT_MOVE_HPP
