// hmesh - IndexedMesh: a mesh of any size between two phases of work, as arrays of vertices and an index list.
//
// Work happens in patches (tiles/patch.hpp), which have half-edges, moments and energies of their own; what remains in
// between is this: about 100 bytes a vertex, and nothing a pixel.
#ifndef HMESH_TILES_INDEXED_MESH_HPP
#define HMESH_TILES_INDEXED_MESH_HPP

#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/core/status.hpp"
#include "hmesh/fit/ring.hpp"
#include "hmesh/mesh/halfedge_mesh.hpp"

namespace hmesh::kit {

template <int C>
struct IndexedMesh {
    int width = 0, height = 0;     // px of the image; the triangles tile [0, width] x [0, height]
    std::vector<Point> positions;  // on the 1/256 px grid
    std::vector<Color<C>> colors;
    std::vector<unsigned char> dirty;  // not 0: surroundings changed since the vertex was last optimised
    std::vector<Triangle> triangles;
    double energy = 0;  // as of the last phase of work

    [[nodiscard]] std::size_t vertex_count() const noexcept { return positions.size(); }
    [[nodiscard]] double mean_energy() const noexcept { return energy / static_cast<double>(vertex_count()); }
    // A vertex that is due.
    void add(Point position, const Color<C>& color) {
        positions.push_back(position);
        colors.push_back(color);
        dirty.push_back(1);
    }
};

// Proves that the mesh is one: arrays of one length, vertices on the grid, triangles that turn the right way, meet edge to
// edge without T-junctions, and tile the image. O(n log n).
template <int C>
[[nodiscard]] Status check(const IndexedMesh<C>& mesh) {
    const auto fail = [](const char* what, std::size_t where) -> Status {
        return {Errc::invalid_argument, what, static_cast<std::int64_t>(where), 0};
    };
    const std::size_t n = mesh.positions.size();
    if (mesh.colors.size() != n || mesh.dirty.size() != n) return fail("the arrays of vertices differ in length", n);
    HalfedgeMesh topology;
    if (const Status status = topology.assign(n, mesh.triangles); !status) return status;
    for (std::size_t i = 0; i < n; ++i)
        if (snap(mesh.positions[i]) != mesh.positions[i]) return fail("a vertex is off the grid", i);
    double area = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Triangle& triangle = mesh.triangles[t];
        const double twice = orient2d(mesh.positions[triangle[0]], mesh.positions[triangle[1]], mesh.positions[triangle[2]]);
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

}  // namespace hmesh::kit

#endif  // HMESH_TILES_INDEXED_MESH_HPP
