/// \file
/// Subdivision: insert vertices by area alone, where none lowers the energy.
///
/// A constant or affine picture gains nothing from another vertex, yet a target of n vertices is met exactly. The face of largest
/// area is split at the midpoint of its longest edge, or at its centroid where that edge cannot be split.
///
/// Cost: O(log faces) a vertex. An image of p pixels has room for p vertices: they make about 2 p faces, of which the largest
/// has at least the mean area, 1/2 px^2, while the default of MeshLimits::min_double_area refuses areas below 0.01 px^2.
#ifndef HMESH_EDIT_SUBDIVIDE_HPP
#define HMESH_EDIT_SUBDIVIDE_HPP

#include <cstddef>
#include <cstdint>

#include "hmesh/core/compiler.hpp"
#include "hmesh/edit/indexed_heap.hpp"
#include "hmesh/edit/insert.hpp"
#include "hmesh/fit/image_mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// Inserts up to `count` vertices by splitting the largest face again and again; rings of new vertices become dirty. Returns the
/// number of vertices inserted: less than `count` where no face can be split any more, or where mesh.keep_going() says stop.
template <int C>
HMESH_COLD std::size_t subdivide(ImageMesh<C>& mesh, std::size_t count) {
    const HalfedgeMesh& topology = mesh.topology();
    IndexedHeap largest;
    const auto push = [&](Face f) HMESH_COLD {
        const auto v = topology.vertices(f);
        largest.push(static_cast<std::uint32_t>(f.index()),
                     -orient2d(mesh.position(v[0]), mesh.position(v[1]), mesh.position(v[2])));
    };
    for (const Face f : topology.faces()) push(f);
    RingScratch<C> scratch;
    std::size_t inserted = 0;
    while (inserted < count && !largest.empty() && mesh.keep_going()) {
        const Face f(largest.top().id);
        Halfedge longest, h = topology.halfedge(f);
        double length = -1;
        for (int i = 0; i < 3; ++i, h = topology.next(h)) {
            const Point a = mesh.position(topology.from_vertex(h)), b = mesh.position(topology.to_vertex(h));
            const double squared = (b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y);
            if (squared > length) length = squared, longest = h;
        }
        InsertionCandidate<C> candidate = edge_candidate(mesh, scratch, HalfedgeMesh::edge(longest), false);
        if (!(candidate.fits && can_gain_edge(mesh, candidate))) candidate = face_candidate(mesh, scratch, f, false);
        if (!(candidate.fits && can_gain_edge(mesh, candidate))) {
            largest.pop();
            continue;
        }
        const Vertex v = insert(mesh, candidate);
        for (const Halfedge s : topology.outgoing(v))
            if (!topology.is_boundary(s)) push(topology.face(s));
        mesh.set_ring_dirty(v);
        ++inserted;
    }
    return inserted;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_EDIT_SUBDIVIDE_HPP
