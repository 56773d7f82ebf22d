/// \file
/// Flip queue: the paper's topology step (section 4.5.2, after Xie et al. 2014).
///
/// The queue holds all interior edges at first; the edge whose two faces have the largest error is next. It flips if that lowers
/// the error, with positions and colours held, and then the four sides of its quadrilateral enter the queue again. An edge
/// leaves the queue a bounded number of times. flip_edges() (edit/flip.hpp) reaches the same kind of minimum without this order,
/// in half the time.
///
/// Cost: about 0.3 us an edge.
#ifndef HMESH_METHODS_BASELINES_FLIP_QUEUE_HPP
#define HMESH_METHODS_BASELINES_FLIP_QUEUE_HPP

#include <cstddef>
#include <cstdint>

#include "hmesh/core/array.hpp"
#include "hmesh/edit/flip.hpp"
#include "hmesh/edit/indexed_heap.hpp"
#include "hmesh/fit/image_mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// Flips edges until the queue is empty; an edge is tried at most `visits` >= 1 times. The energy falls with every flip by more
/// than rounding, so the queue would empty anyway; the bound saves trials for tiny gains. The four vertices around a flipped
/// edge become dirty. Ends early where mesh.keep_going() says stop. Returns the number of flips.
template <int C>
std::size_t run_flip_queue(ImageMesh<C>& mesh, int visits = 8) {
    const HalfedgeMesh& topology = mesh.topology();
    IndexedHeap suspects;
    Array<int> left(topology.edge_slots(), visits);
    const auto suspect = [&](Edge e) {
        if (topology.is_boundary(e) || left[e.index()] == 0) return;
        const Halfedge h = HalfedgeMesh::halfedge(e);
        const double energy = mesh.energy(topology.face(h)) + mesh.energy(topology.face(HalfedgeMesh::opposite(h)));
        suspects.push(static_cast<std::uint32_t>(e.index()), -energy);
    };
    for (const Edge e : topology.edges()) suspect(e);
    std::size_t flips = 0;
    while (!suspects.empty() && mesh.keep_going()) {
        const Edge e(suspects.pop().id);
        --left[e.index()];
        if (!(improve_edge(mesh, e, 0) > 0)) continue;
        ++flips;
        for (const Halfedge h : {HalfedgeMesh::halfedge(e), HalfedgeMesh::opposite(HalfedgeMesh::halfedge(e))}) {
            const Halfedge n = topology.next(h);
            suspect(HalfedgeMesh::edge(n));
            suspect(HalfedgeMesh::edge(topology.next(n)));
            mesh.set_dirty(topology.to_vertex(h), true);
            mesh.set_dirty(topology.to_vertex(n), true);
        }
    }
    return flips;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_BASELINES_FLIP_QUEUE_HPP
