// hmesh - vertices: move one vertex, or all in turn, to where the picture fits best.
//
// One visit: the vertex's colour goes to its optimum, and one Gauss-Newton step with the colour eliminated is tried; it
// stays if the exact energy of the ring falls. Gauss-Seidel over such visits beats a joint Levenberg-Marquardt step by
// far (the normal equations are mass-like, so there is no long-range coupling to profit from). A visit walks each spoke
// once and evaluates the ring twice, some 0.6 us.
#ifndef HMESH_FIT_VERTICES_HPP
#define HMESH_FIT_VERTICES_HPP

#include <algorithm>
#include <cmath>
#include <vector>

#include "hmesh/fit/image_mesh.hpp"
#include "hmesh/fit/order.hpp"

namespace hmesh {

// The state of a ring's centre, and what the ring costs with it.
template <int C>
struct Centre {
    Point position;
    Color<C> color;
    double energy = 0;
};

namespace detail {

// The longest step that is tried: 0.6 of the root mean square length of a ring's spokes.
template <int C>
[[nodiscard]] inline double step_cap(const Ring<C>& ring, Point v) noexcept {
    double sum = 0;
    for (int i = 0; i < ring.size; ++i) {
        const double dx = ring.neighbour[i]->position.x - v.x, dy = ring.neighbour[i]->position.y - v.y;
        sum += dx * dx + dy * dy;
    }
    return 0.6 * std::sqrt(sum / ring.size);
}

}  // namespace detail

// Workspace of one ring optimisation, too large to clear on every call.
template <int C>
struct RingWork {
    Ring<C> ring;
    Spokes<C> spokes, trial_spokes;
    FaceFit<C> faces[ring_capacity], trial_faces[ring_capacity];
};

// What optimise_centre() did.
enum class RingOutcome { degenerate, recolored, moved };

// Optimises the centre of work.ring: `centre` holds position and colour on entry and the best found on return, with its
// energy; work.spokes and work.faces belong to it. `least` is the predicted decrease below which no step is tried.
// degenerate: a face is smaller than limits allow, nothing done.
template <int C>
RingOutcome optimise_centre(const ImageMesh<C>& mesh, RingWork<C>& work, Mobility mobility, double least, bool may_move,
                            Centre<C>& centre) {
    const MeshLimits& limits = mesh.limits();
    RingFit<C> fit;
    if (!fit_ring(work.ring, work.spokes, centre.position, limits.min_cross, work.faces, fit)) return RingOutcome::degenerate;
    // A ring without weight wants nothing: it is not to chase the rounding of its sums.
    if (mesh.table().is_weighted() && !(ring_weight(work.ring, work.spokes) > least_weight)) {
        centre.energy = fit.energy(centre.color);
        return RingOutcome::recolored;
    }
    centre.color = best_color(fit, centre.color, limits.ridge, mesh.color_low(), mesh.color_high());
    centre.energy = fit.energy(centre.color);
    if (!may_move || mobility == Mobility::fixed) return RingOutcome::recolored;

    const RingStep step = gauss_newton_step(work.ring, work.faces, fit, centre.color, mobility);
    if (!(step.predicted > least)) return RingOutcome::recolored;
    double dx = step.dx, dy = step.dy;
    const double length = std::sqrt(dx * dx + dy * dy), cap = detail::step_cap(work.ring, centre.position);
    if (length > cap) {
        dx *= cap / length;
        dy *= cap / length;
    }
    // Halve the step while a face would get too small; the last of 6 tries is 1/32 of it.
    for (int halvings = 0; halvings < 6; ++halvings, dx *= 0.5, dy *= 0.5) {
        const Point trial = mesh.clamp({centre.position.x + dx, centre.position.y + dy}, mobility);
        if (trial == centre.position) break;
        if (!work.ring.accepts(trial, limits.min_cross)) continue;
        walk_spokes(mesh.table(), work.ring, trial, work.trial_spokes);
        RingFit<C> trial_fit;
        if (!fit_ring(work.ring, work.trial_spokes, trial, limits.min_cross, work.trial_faces, trial_fit)) continue;
        const Color<C> color = best_color(trial_fit, centre.color, limits.ridge, mesh.color_low(), mesh.color_high());
        const double energy = trial_fit.energy(color);
        if (!(energy < centre.energy)) break;
        centre = {trial, color, energy};
        std::copy_n(work.trial_spokes.spoke, work.ring.size, work.spokes.spoke);
        std::copy_n(work.trial_faces, work.ring.size, work.faces);
        return RingOutcome::moved;
    }
    return RingOutcome::recolored;
}

// One visit of v; returns by how much the energy fell, >= 0. Steps that promise less than `least` are not tried.
template <int C>
double improve_vertex(ImageMesh<C>& mesh, Vertex v, double least) {
    if (mesh.vertex(v).mobility == Mobility::frozen) return 0;
    RingWork<C> work;
    mesh.gather(v, work.ring, work.spokes);
    const double before = mesh.energy(work.ring);
    const VertexState<C>& state = mesh.vertex(v);
    Centre<C> centre{state.position, state.color, 0};
    const RingOutcome outcome = optimise_centre(mesh, work, state.mobility, least, true, centre);
    if (outcome == RingOutcome::degenerate || !(centre.energy < before)) return 0;
    mesh.settle(v, work.ring, centre.position, centre.color, work.faces, outcome == RingOutcome::moved ? &work.spokes : nullptr);
    return before - centre.energy;
}

// Tolerances of a stage, in units of the mean energy of a vertex.
struct Tolerance {
    double spread = 1e-3;  // a visit or flip that gained more makes its neighbours due
    double least = 0;      // predicted gains below this are not tried
};

// Visits all vertices that are due, in spatial order; returns by how much the energy fell.
template <int C>
double sweep(ImageMesh<C>& mesh, const Tolerance& tolerance = {}) {
    const double start = mesh.energy();
    const double spread = tolerance.spread * mesh.mean_energy(), least = tolerance.least * mesh.mean_energy();
    for (const Vertex v : spatial_vertices(mesh)) {
        if (!mesh.is_due(v) || mesh.vertex(v).mobility == Mobility::frozen) continue;  // due for another patch
        if (!mesh.beat()) break;
        mesh.set_due(v, false);
        if (improve_vertex(mesh, v, least) > spread) mesh.set_ring_due(v);
    }
    return start - mesh.energy();
}

}  // namespace hmesh

#endif  // HMESH_FIT_VERTICES_HPP
