// hmesh - order: the order in which operators visit a mesh, along a space-filling curve (mesh/spatial_order.hpp).
#ifndef HMESH_FIT_ORDER_HPP
#define HMESH_FIT_ORDER_HPP

#include <vector>

#include "hmesh/fit/image_mesh.hpp"
#include "hmesh/mesh/spatial_order.hpp"

namespace hmesh::kit {

// The vertices, neighbours in the list mostly being neighbours in the plane. O(n).
template <int C>
[[nodiscard]] std::vector<Vertex> spatial_vertices(const ImageMesh<C>& mesh) {
    return in_spatial_order<Vertex>(mesh.topology().vertices(), mesh.vertex_count(), [&](Vertex v) { return mesh.position(v); });
}

// The faces, by their centroids.
template <int C>
[[nodiscard]] std::vector<Face> spatial_faces(const ImageMesh<C>& mesh) {
    return in_spatial_order<Face>(mesh.topology().faces(), mesh.topology().face_count(),
                                  [&](Face f) { return mesh.centroid(f); });
}

// Calls body(e) for the edges that come with face f: of the two faces beside an edge, it comes with that of its even
// half-edge, or the only one. So a loop over all faces meets each edge once.
template <class Body>
HMESH_ALWAYS_INLINE void for_each_edge(const HalfedgeMesh& topology, Face f, Body&& body) {
    Halfedge h = topology.halfedge(f);
    for (int i = 0; i < 3; ++i, h = topology.next(h))
        if ((h.index() & 1U) == 0 || topology.is_boundary(HalfedgeMesh::opposite(h))) body(HalfedgeMesh::edge(h));
}

// Each edge once, face by face.
template <int C>
[[nodiscard]] std::vector<Edge> spatial_edges(const ImageMesh<C>& mesh) {
    std::vector<Edge> edges;
    edges.reserve(mesh.topology().edge_count());
    for (const Face f : spatial_faces(mesh)) for_each_edge(mesh.topology(), f, [&](Edge e) { edges.push_back(e); });
    return edges;
}

}  // namespace hmesh::kit

#endif  // HMESH_FIT_ORDER_HPP
