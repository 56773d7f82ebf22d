/// \file
/// Blocks: a mesh in pieces whose pixels and vertices fit the second cache of a core.
///
/// A pass over a large mesh waits for memory: a moment table takes 16 bytes a pixel, a mesh 560 bytes a vertex. All passes over
/// one block before the first over the next take 0.7 of the time. A block is the vertices that stand in a rectangle of 128 x 64
/// px, 128 KiB of the table, which are neighbours on the Morton curve; edges and faces belong to one of their vertices.
#ifndef HMESH_EDIT_BLOCKS_HPP
#define HMESH_EDIT_BLOCKS_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "hmesh/core/array.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/edit/flip.hpp"
#include "hmesh/edit/insert.hpp"
#include "hmesh/edit/move.hpp"
#include "hmesh/fit/image_mesh.hpp"
#include "hmesh/mesh/spatial_order.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// The edges that belong to a vertex: each edge of a mesh belongs to the one that its even half-edge leaves.
template <class Body>
HMESH_ALWAYS_INLINE void for_each_own_edge(const HalfedgeMesh& topology, Vertex v, Body&& body) {
    for (const Halfedge h : topology.outgoing(v))
        if ((h.index() & 1U) == 0) body(HalfedgeMesh::edge(h));
}
/// The faces that belong to a vertex: each face of a mesh belongs to the one that its half-edge leaves.
template <class Body>
HMESH_ALWAYS_INLINE void for_each_own_face(const HalfedgeMesh& topology, Vertex v, Body&& body) {
    for (const Halfedge h : topology.outgoing(v))
        if (!topology.is_boundary(h) && topology.halfedge(topology.face(h)) == h) body(topology.face(h));
}

/// Calls body(vertices) for those of `all`, vertices in spatial order, in each block, from block `first` modulo their number on.
/// Vertices that the body inserts are in no block, those that it removes must have been in this one. Tells the mesh's task of the
/// share of the blocks that is done. Ends early where mesh.keep_going() says stop.
template <int C>
HMESH_COLD void for_each_block(ImageMesh<C>& mesh, const Array<Vertex>& all, std::size_t first,
                               FunctionRef<void(Array<Vertex>& vertices)> body) {
    Array<std::size_t> begins;
    std::uint32_t last = 0;
    for (std::size_t k = 0; k < all.size(); ++k) {
        const std::uint32_t block = morton_code(mesh.position(all[k])) >> 13U;
        if (k == 0 || block != last) begins.push_back(k);
        last = block;
    }
    const std::size_t count = begins.size();
    begins.push_back(all.size());
    Array<Vertex> vertices;
    for (std::size_t i = 0; i < count && mesh.keep_going(); ++i) {
        const std::size_t k = (first + i) % count;
        vertices.assign(all.begin() + static_cast<std::ptrdiff_t>(begins[k]),
                        all.begin() + static_cast<std::ptrdiff_t>(begins[k + 1]));
        body(vertices);
        if (mesh.task() != nullptr) mesh.task()->set_fraction(static_cast<double>(i + 1) / static_cast<double>(count));
    }
}

/// The edges that belong to these vertices.
template <int C>
[[nodiscard]] Array<Edge> own_edges(const ImageMesh<C>& mesh, const Array<Vertex>& vertices) {
    Array<Edge> edges;
    edges.reserve(3 * vertices.size());
    for (const Vertex v : vertices) for_each_own_edge(mesh.topology(), v, [&](Edge e) { edges.push_back(e); });
    return edges;
}

/// The insertion sites that belong to these vertices: edges and faces.
template <int C>
[[nodiscard]] Array<InsertionSite> own_sites(const ImageMesh<C>& mesh, const Array<Vertex>& vertices) {
    Array<InsertionSite> sites;
    sites.reserve(5 * vertices.size());
    for (const Vertex v : vertices) {
        for_each_own_edge(mesh.topology(), v, [&](Edge e) { sites.emplace_back(e); });
        for_each_own_face(mesh.topology(), v, [&](Face f) { sites.emplace_back(f); });
    }
    return sites;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_EDIT_BLOCKS_HPP
