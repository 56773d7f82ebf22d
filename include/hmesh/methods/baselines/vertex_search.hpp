/// \file
/// Vertex search: move vertices in whole pixels to where the error is least, with sampled colours.
///
/// The geometry step of Xie et al. (2014) as a pattern search: a vertex tries the eight positions at a distance of `first_step`
/// pixels and moves to the best as long as that lowers the error of its ring; then the distance is halved, down to one pixel.
/// The colour is always that of the image at the vertex. Neighbours of a vertex that moved are visited again, each vertex up to
/// `visits` times.
///
/// Cost: a trial walks the ring's spokes in about 0.4 us, less where it is worse early; a visit takes some 6 us.
#ifndef HMESH_METHODS_BASELINES_VERTEX_SEARCH_HPP
#define HMESH_METHODS_BASELINES_VERTEX_SEARCH_HPP

#include <algorithm>
#include <cstddef>
#include <vector>

#include "hmesh/fit/image_mesh.hpp"
#include "hmesh/solve/sampled_colors.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// Options of search_vertices().
struct VertexSearch {
    int first_step = 4;  ///< the first distance, px, in [1, 4096]; halved down to 1
    int visits = 6;      ///< of each vertex at most, in [1, 1000]
};

namespace detail {

/// The energy of the faces of a ring with its centre vertex in this state; once it reaches `bound`, any value not below that.
template <int C>
[[nodiscard]] double centered_energy(const MomentTable<C>& table, const Ring<C>& ring, const VertexState<C>& center,
                                     double bound) {
    Moments<C> first, before, spoke;
    edge_moments(table, center.position, ring.neighbor[0]->position, first);
    before = first;
    double energy = 0;
    for (int i = 1; i <= ring.size && energy < bound; ++i) {
        const int k = i % ring.size;  // face k joins the centre, neighbour k and the one before; face 0 comes last
        if (k == 0 && ring.open) break;
        if (k == 0) spoke = first;
        else edge_moments(table, center.position, ring.neighbor[k]->position, spoke);
        Moments<C> m = spoke;
        m += ring.link[k];
        m -= before;
        energy += face_energy(m, center, *ring.neighbor[k], *ring.neighbor[i - 1]);
        before = spoke;
    }
    return energy;
}

/// Visits v. Returns whether it moved. `ring` and `spokes` are overwritten.
template <int C>
bool search_vertex(ImageMesh<C>& mesh, Vertex v, int first_step, Ring<C>& ring, Spokes<C>& spokes) {
    const VertexState<C> state = mesh.vertex(v);
    if (state.mobility == Mobility::corner || state.mobility == Mobility::locked) return false;
    mesh.gather(v, ring, spokes);
    double lowest = mesh.energy(ring);
    double squares = ring.open ? spokes.spoke[ring.size - 1].q[3] - spokes.spoke[0].q[3] : 0;  // |I|^2 of the ring
    for (int i = ring.first_face(); i < ring.size; ++i) squares += ring.link[i].q[3];
    // A gain that rounding may feign: energies are differences of sums as large as the squares, some of them over whole rows.
    // Rounding may leave either below 0, and with gains below 0 the search would go round in circles.
    const double min_gain = 1e-9 * std::max(0.0, lowest) + 1e-12 * std::max(0.0, squares);
    VertexState<C> best = state;
    // A vertex stays on its side of the image or at least half a pixel off, where the centres of pixels are.
    const auto on_centers = [](double x, int size) { return x >= 0.5 && x <= size - 0.5; };
    for (int step = first_step; step >= 1; step /= 2)
        for (bool moved = true; moved;) {
            moved = false;
            const Point from = best.position;
            for (int direction = 0; direction < 9; ++direction) {
                const int dx = direction % 3 - 1, dy = direction / 3 - 1;
                if ((dx == 0 && dy == 0) || (dx != 0 && state.mobility == Mobility::along_y) ||
                    (dy != 0 && state.mobility == Mobility::along_x))
                    continue;
                VertexState<C> trial = best;
                trial.position = {from.x + dx * step, from.y + dy * step};
                if ((dx != 0 && !on_centers(trial.position.x, mesh.width())) ||
                    (dy != 0 && !on_centers(trial.position.y, mesh.height())) ||
                    !ring.accepts(trial.position, mesh.limits().min_double_area))
                    continue;
                trial.color = sampled_color(mesh.table(), trial.position);
                const double energy = centered_energy(mesh.table(), ring, trial, lowest - min_gain);
                if (!(energy < lowest - min_gain)) continue;
                lowest = energy;
                best = trial;
                moved = true;
            }
        }
    if (best.position == state.position) return false;
    mesh.place(v, best.position, best.color);
    return true;
}

}  // namespace detail

/// Visits vertices in rounds, in spatial order: all in the first round, then those that are dirty because a neighbour moved,
/// until none is or options.visits rounds are done. The mesh should have sampled colours (sample_colors()), since a vertex that
/// stays keeps its colour. Vertices with more than ring_capacity neighbours stay. Returns the number of visits that moved their
/// vertex; ends early where mesh.keep_going() says stop.
template <int C>
std::size_t search_vertices(ImageMesh<C>& mesh, const VertexSearch& options) {
    const HalfedgeMesh& topology = mesh.topology();
    Ring<C> ring;
    Spokes<C> spokes;
    std::size_t moves = 0, moved = 1;
    for (const Vertex v : topology.vertices()) mesh.set_dirty(v, true);
    mesh.expect(1, 0.6 * options.visits * static_cast<double>(mesh.vertex_count()));
    for (int round = 0; round < options.visits && moved > 0; ++round) {
        moved = 0;
        for (const Vertex v : spatial_vertices(mesh)) {
            if (!mesh.is_dirty(v)) continue;
            if (!mesh.keep_going()) return moves + moved;
            mesh.set_dirty(v, false);
            if (topology.valence(v) > ring_capacity) continue;
            if (!detail::search_vertex(mesh, v, options.first_step, ring, spokes)) continue;
            ++moved;
            mesh.set_ring_dirty(v);
        }
        moves += moved;
    }
    return moves;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_BASELINES_VERTEX_SEARCH_HPP
