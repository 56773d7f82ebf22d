/// \file
/// Relaxation: re-optimise a handful of vertices and their edges after a local change.
///
/// Relaxation makes the trial of a removal, an insertion or a flip a fair one: the change is judged by the energy after the
/// vertices around it have moved to their new optimum. A round visits each of the given vertices, then tries to flip each of
/// their edges.
///
/// Cost: for each round a visit (0.6 us) a vertex, and an edge walk and two face energies an edge.
#ifndef HMESH_EDIT_RELAX_HPP
#define HMESH_EDIT_RELAX_HPP

#include <algorithm>
#include <cstddef>

#include "hmesh/core/array.hpp"
#include "hmesh/edit/flip.hpp"
#include "hmesh/edit/move.hpp"
#include "hmesh/edit/tolerance.hpp"
#include "hmesh/fit/image_mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// Optimises `vertices` and flips their edges in at most `rounds` rounds; a round that gains less than 1e-3 mean energies of a
/// vertex is the last. Gauss-Newton steps with a predicted gain up to `min_gain`, an energy, and flips that gain no more are not
/// made.
template <int C>
void relax(ImageMesh<C>& mesh, const Array<Vertex>& vertices, int rounds, double min_gain) {
    const HalfedgeMesh& topology = mesh.topology();
    const double min_round_gain = 1e-3 * mesh.mean_energy();
    for (int round = 0; round < rounds; ++round) {
        const double start = mesh.energy();
        for (const Vertex v : vertices) improve_vertex(mesh, v, min_gain);
        for (const Vertex v : vertices) {
            Edge edges[ring_capacity];
            int count = 0;
            for (const Halfedge h : topology.outgoing(v)) {
                const Vertex u = topology.to_vertex(h);  // an edge between two of the vertices is tried once
                if (u < v && std::find(vertices.begin(), vertices.end(), u) != vertices.end()) continue;
                edges[count++] = HalfedgeMesh::edge(h);
            }
            for (int i = 0; i < count; ++i) improve_edge(mesh, edges[i], min_gain);
        }
        if (start - mesh.energy() < min_round_gain) break;
    }
}
/// Optimises `vertices` and flips their edges, with rounds and threshold from `relaxation` (edit/tolerance.hpp).
template <int C>
void relax(ImageMesh<C>& mesh, const Array<Vertex>& vertices, const Relaxation& relaxation) {
    relax(mesh, vertices, relaxation.rounds, relaxation.min_gain * mesh.mean_energy());
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_EDIT_RELAX_HPP
