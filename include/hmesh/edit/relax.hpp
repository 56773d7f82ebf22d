/// \file
/// Relaxation: re-optimise a handful of vertices and their edges after a local change.
///
/// What turns a change of topology into an honest trial: a removal, insertion or flip is judged by the energy after the
/// vertices around it have moved to their new optimum. A round visits each vertex, then tries each of their edges once.
#ifndef HMESH_EDIT_RELAX_HPP
#define HMESH_EDIT_RELAX_HPP

#include <algorithm>
#include <cstddef>
#include <vector>

#include "hmesh/edit/flip.hpp"
#include "hmesh/edit/move.hpp"
#include "hmesh/edit/tolerance.hpp"
#include "hmesh/fit/image_mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// At most `rounds` rounds; steps that promise less energy than `least` are not tried.
template <int C>
void relax(ImageMesh<C>& mesh, const std::vector<Vertex>& vertices, int rounds, double least) {
    const HalfedgeMesh& topology = mesh.topology();
    const double enough = 1e-3 * mesh.mean_energy();
    for (int round = 0; round < rounds; ++round) {
        const double start = mesh.energy();
        for (const Vertex v : vertices) improve_vertex(mesh, v, least);
        for (const Vertex v : vertices) {
            Edge edges[ring_capacity];
            int count = 0;
            for (const Halfedge h : topology.outgoing(v)) {
                const Vertex u = topology.to_vertex(h);  // an edge between two of the vertices comes up once
                if (u < v && std::find(vertices.begin(), vertices.end(), u) != vertices.end()) continue;
                edges[count++] = HalfedgeMesh::edge(h);
            }
            for (int i = 0; i < count; ++i) improve_edge(mesh, edges[i], least);
        }
        if (start - mesh.energy() < enough) break;
    }
}
template <int C>
void relax(ImageMesh<C>& mesh, const std::vector<Vertex>& vertices, const Relaxation& relaxation) {
    relax(mesh, vertices, relaxation.rounds, relaxation.min_gain * mesh.mean_energy());
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_EDIT_RELAX_HPP
