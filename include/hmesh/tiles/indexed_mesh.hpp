/// \file
/// IndexedMesh: a mesh of any size between two phases of work, as arrays of vertices and an index list of faces.
///
/// Work happens in patches (tiles/patch.hpp), which have half-edges, moments and energies of their own. Between phases only the
/// IndexedMesh exists: about 100 bytes a vertex, and nothing for each pixel.
#ifndef HMESH_TILES_INDEXED_MESH_HPP
#define HMESH_TILES_INDEXED_MESH_HPP

#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/core/compiler.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/fit/image_source.hpp"
#include "hmesh/fit/squared_error.hpp"
#include "hmesh/mesh/halfedge_mesh.hpp"
#include "hmesh/mesh/mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// A mesh of an image of C channels; positions, colors and dirty have one entry for each vertex.
template <int C>
struct IndexedMesh {
    int width = 0;                     ///< px of the image; the faces tile [0, width] x [0, height]
    int height = 0;                    ///< px of the image
    std::vector<Point> positions;      ///< px, y down, on the 1/256 px grid
    std::vector<Color<C>> colors;      ///< stored values
    std::vector<unsigned char> dirty;  ///< not 0: surroundings changed since the vertex was last optimised
    std::vector<Triangle> faces;       ///< indices of vertices, each face turning like (0, 0), (1, 0), (0, 1)
    double energy = 0;                 ///< squared error over pixels and channels, as of the last phase of work
    std::size_t locked_count = 0;      ///< the first so many vertices were locked in the last phase of work

    /// The number of vertices.
    [[nodiscard]] std::size_t vertex_count() const noexcept { return positions.size(); }
    /// The energy per vertex, the unit of all tolerances.
    [[nodiscard]] double mean_energy() const noexcept { return energy / static_cast<double>(vertex_count()); }
    /// Appends a vertex and marks it dirty.
    void add(Point position, const Color<C>& color) {
        positions.push_back(position);
        colors.push_back(color);
        dirty.push_back(1);
    }
};

/// Checks that the mesh is valid: arrays of one length, vertices on the 1/256 px grid, faces that have positive area, meet edge
/// to edge without T-junctions, and tile the image. Errc::invalid_argument with the index of what is wrong. O(n log n).
template <int C>
[[nodiscard]] Status check(const IndexedMesh<C>& mesh) {
    const auto fail = [](const char* what, std::size_t where) -> Status {
        return {Errc::invalid_argument, what, static_cast<std::int64_t>(where), 0};
    };
    const std::size_t n = mesh.positions.size();
    if (mesh.colors.size() != n || mesh.dirty.size() != n) return fail("the arrays of vertices differ in length", n);
    HalfedgeMesh topology;
    if (const Status status = topology.assign(n, mesh.faces); !status) return status;
    for (std::size_t i = 0; i < n; ++i)
        if (snap(mesh.positions[i]) != mesh.positions[i]) return fail("a vertex is off the grid", i);
    double area = 0;
    for (std::size_t t = 0; t < mesh.faces.size(); ++t) {
        const Triangle& face = mesh.faces[t];
        const double twice = orient2d(mesh.positions[face[0]], mesh.positions[face[1]], mesh.positions[face[2]]);
        if (!(twice > 0)) return fail("a face is flipped or has no area", t);
        area += twice;
    }
    if (area != 2.0 * mesh.width * mesh.height) return fail("the faces do not tile the image", 0);
    // One boundary, along the sides: with the area above, no hole and no overlap.
    for (const Edge e : topology.edges()) {
        if (!topology.is_boundary(e)) continue;
        const Point a = mesh.positions[topology.from_vertex(HalfedgeMesh::halfedge(e)).index()];
        const Point b = mesh.positions[topology.to_vertex(HalfedgeMesh::halfedge(e)).index()];
        const bool on_side = (a.x == b.x && (a.x == 0 || a.x == mesh.width)) || (a.y == b.y && (a.y == 0 || a.y == mesh.height));
        if (!on_side) return fail("an edge inside the image has one face only", e.index());
    }
    return {};
}

/// The mesh of two faces over the image's rectangle, with the colours of the corner pixels: the mesh that methods begin with,
/// and that is returned when they are cancelled before they have a better one. Its energy is not computed.
template <int C>
[[nodiscard]] HMESH_COLD IndexedMesh<C> corner_mesh(const ImageSource<C>& source) {
    IndexedMesh<C> mesh;
    mesh.width = source.width();
    mesh.height = source.height();
    for (const int y : {0, source.height()})
        for (const int x : {0, source.width()}) mesh.add({static_cast<double>(x), static_cast<double>(y)}, source.pixel(x, y));
    mesh.faces = {{0, 1, 2}, {1, 3, 2}};
    return mesh;
}

/// The mesh as plain float arrays, the result of mesh_image(). `peak`: the stored value of full intensity.
template <int C>
[[nodiscard]] HMESH_COLD Mesh to_mesh(const IndexedMesh<C>& from, double peak) {
    Mesh to;
    to.channels = C;
    to.width = from.width;
    to.height = from.height;
    to.peak = peak;
    to.positions.reserve(2 * from.vertex_count());
    to.colors.reserve(C * from.vertex_count());
    for (std::size_t v = 0; v < from.vertex_count(); ++v) {
        to.positions.push_back(static_cast<float>(from.positions[v].x));
        to.positions.push_back(static_cast<float>(from.positions[v].y));
        for (int c = 0; c < C; ++c) to.colors.push_back(static_cast<float>(from.colors[v][c]));
    }
    to.faces = from.faces;
    return to;
}
/// The mesh as an IndexedMesh, for further work on it; all vertices are dirty, the energy is not computed. Returns an empty mesh
/// where `from` does not have C channels or its arrays differ in their number of vertices; whether it tiles its image is for
/// check() to say.
template <int C>
[[nodiscard]] IndexedMesh<C> to_indexed_mesh(const Mesh& from) {
    IndexedMesh<C> to;
    if (from.channels != C || from.colors.size() != C * from.vertex_count()) return to;
    to.width = from.width;
    to.height = from.height;
    for (std::size_t v = 0; v < from.vertex_count(); ++v) {
        Color<C> color = Color<C>::zero();
        for (std::size_t c = 0; c < C; ++c) color.set(static_cast<int>(c), static_cast<double>(from.colors[C * v + c]));
        to.add({static_cast<double>(from.positions[2 * v]), static_cast<double>(from.positions[2 * v + 1])}, color);
    }
    to.faces = from.faces;
    return to;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_TILES_INDEXED_MESH_HPP
