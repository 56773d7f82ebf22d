/// \file
/// delaunay_mesh(): a Delaunay triangulation as a mesh of an image, the start of many methods. O(n).
#ifndef HMESH_TILES_DELAUNAY_MESH_HPP
#define HMESH_TILES_DELAUNAY_MESH_HPP

#include "hmesh/core/assert.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/fit/image_source.hpp"
#include "hmesh/mesh/delaunay.hpp"
#include "hmesh/tiles/indexed_mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

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

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_TILES_DELAUNAY_MESH_HPP
