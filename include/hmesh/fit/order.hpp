// hmesh - order: the order in which operators visit a mesh, along a space-filling curve (mesh/spatial_order.hpp).
#ifndef HMESH_FIT_ORDER_HPP
#define HMESH_FIT_ORDER_HPP

#include <vector>

#include "hmesh/fit/image_mesh.hpp"
#include "hmesh/mesh/spatial_order.hpp"

namespace hmesh {

template <int C>
[[nodiscard]] std::vector<Vertex> spatial_vertices(const ImageMesh<C>& mesh) {
    return in_spatial_order<Vertex>(mesh.topology().vertices(), mesh.vertex_count(), [&](Vertex v) { return mesh.position(v); });
}

template <int C>
[[nodiscard]] std::vector<Face> spatial_faces(const ImageMesh<C>& mesh) {
    return in_spatial_order<Face>(mesh.topology().faces(), mesh.topology().face_count(), [&](Face f) { return mesh.centroid(f); });
}

}  // namespace hmesh

#endif  // HMESH_FIT_ORDER_HPP
