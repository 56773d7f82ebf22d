/// \file
/// Delaunay triangulations of pixels as meshes of an image, the start of many methods. O(n).
#ifndef HMESH_TILES_DELAUNAY_MESH_HPP
#define HMESH_TILES_DELAUNAY_MESH_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/core/assert.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/fit/image_source.hpp"
#include "hmesh/mesh/delaunay.hpp"
#include "hmesh/mesh/geometry.hpp"
#include "hmesh/mesh/halfedge_mesh.hpp"
#include "hmesh/mesh/spatial_order.hpp"
#include "hmesh/tiles/indexed_mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// The position, in px, of the vertex that stands for pixel number y * width + x: the pixel's centre, but on the border for the
/// outermost pixels, so that a mesh of such vertices covers the image.
[[nodiscard]] inline Point pixel_vertex(std::uint32_t pixel, int width, int height) noexcept {
    const auto place = [](std::uint32_t i, int size) {
        return size == 1 ? 0.5 : i == 0 ? 0.0 : i + 1 == static_cast<std::uint32_t>(size) ? static_cast<double>(size) : i + 0.5;
    };
    const auto columns = static_cast<std::uint32_t>(width);
    return {place(pixel % columns, width), place(pixel / columns, height)};
}

/// Inserts the vertices that stand for these pixels, given as y * width + x, in spatial order. False: go_on(), called between
/// some thousands, said so.
[[nodiscard]] HMESH_COLD inline bool insert_pixels(Delaunay& delaunay, const std::vector<std::uint32_t>& pixels,
                                                   FunctionRef<bool()> go_on) {
    const auto place = [&](std::uint32_t pixel) { return pixel_vertex(pixel, delaunay.width(), delaunay.height()); };
    delaunay.reserve(pixels.size() + 4);
    std::size_t done = 0;
    for (const std::uint32_t pixel : in_spatial_order<std::uint32_t>(pixels, pixels.size(), place)) {
        if (++done % 4096 == 0 && !go_on()) return false;
        (void)delaunay.insert(place(pixel));
    }
    return true;
}

/// The mesh of a Delaunay triangulation of the image's rectangle, with the colours of the pixels under the vertices; vertices
/// and faces are in the order of delaunay.topology(). The energy is not computed: ImageMesh::assign() and TiledMesh::measure()
/// do that. O(n).
template <int C>
[[nodiscard]] HMESH_COLD IndexedMesh<C> delaunay_mesh(const ImageSource<C>& source, const Delaunay& delaunay) {
    HMESH_ASSERT(delaunay.width() == source.width() && delaunay.height() == source.height());
    IndexedMesh<C> mesh;
    mesh.width = source.width();
    mesh.height = source.height();
    for (const Vertex v : delaunay.topology().vertices()) {
        const Point p = delaunay.position(v);
        mesh.add(p, source.pixel(static_cast<int>(p.x), static_cast<int>(p.y)));
    }
    mesh.faces = delaunay.topology().triangles();
    return mesh;
}

/// Flips edges until no vertex has more than `limit` >= 8 edges, where a flip is possible that gives no other vertex more: a point
/// in a flat part sees all those at a sharp edge around it. Faces stay positively oriented, which is enough for ImageMesh.
/// O(n) where there is nothing to do.
template <int C>
HMESH_COLD void bound_valence(IndexedMesh<C>& mesh, int limit) {
    std::vector<int> faces(mesh.vertex_count(), 0);
    for (const Triangle& t : mesh.faces)
        for (const std::uint32_t v : t) ++faces[v];
    // A vertex on the border has one edge more than faces.
    if (std::none_of(faces.begin(), faces.end(), [&](int count) { return count + 1 > limit; })) return;
    HalfedgeMesh topology;
    if (!topology.assign(mesh.vertex_count(), mesh.faces)) return;
    const auto at = [&](Vertex v) { return mesh.positions[v.index()]; };
    const auto turns_well = [&](Halfedge a) {
        const Halfedge b = HalfedgeMesh::opposite(a);
        if (topology.is_boundary(a) || topology.is_boundary(b) || !topology.is_flip_ok(HalfedgeMesh::edge(a))) return false;
        const Vertex left = topology.to_vertex(topology.next(a)), right = topology.to_vertex(topology.next(b));
        const Point from = at(topology.from_vertex(a)), to = at(topology.to_vertex(a));
        return topology.valence(left) < limit && topology.valence(right) < limit && orient2d(from, at(right), at(left)) >= 1 &&
               orient2d(at(right), to, at(left)) >= 1;
    };
    for (const Vertex v : topology.vertices())
        for (bool turned = true; turned && topology.valence(v) > limit;) {
            turned = false;
            for (const Halfedge h : topology.outgoing(v))
                if (turns_well(h)) {
                    topology.flip(HalfedgeMesh::edge(h));
                    turned = true;
                    break;
                }
        }
    mesh.faces = topology.triangles();
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_TILES_DELAUNAY_MESH_HPP
