/// \file
/// IndexedMesh: a mesh of any size between two phases of work, as arrays of vertices and an index list of faces.
///
/// Work happens in patches (tiles/patch.hpp), which have half-edges, moments and energies of their own. Between phases only the
/// IndexedMesh exists: about 100 bytes a vertex, and nothing for each pixel.
#ifndef HMESH_TILES_INDEXED_MESH_HPP
#define HMESH_TILES_INDEXED_MESH_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "hmesh/core/array.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/fit/image_source.hpp"
#include "hmesh/fit/squared_error.hpp"
#include "hmesh/mesh/halfedge_mesh.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/mesh/periodic.hpp"
#include "hmesh/mesh/samples.hpp"
#include "hmesh/mesh/torus.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// A mesh of an image of C channels; positions, colors and dirty have one entry for each vertex. That of a periodic image is cut
/// open (mesh/torus.hpp), and vertices on the cut have copies.
template <int C>
struct IndexedMesh {
    int width = 0;                       ///< px of the image; the faces tile [0, width] x [0, height], or the torus
    int height = 0;                      ///< px of the image
    Array<Point> positions;              ///< px, y down, on the 1/256 px grid
    Array<Color<C>> colors;              ///< stored values
    Array<unsigned char> dirty;          ///< not 0: surroundings changed since the vertex was last optimised
    Array<Triangle> faces;               ///< indices of vertices, each face turning like (0, 0), (1, 0), (0, 1)
    double energy = 0;                   ///< squared error over pixels and channels, as of the last phase of work
    std::size_t locked_count = 0;        ///< the first so many vertices were locked in the last phase of work
    Periodic periodic = Periodic::none;  ///< along which axes the mesh repeats
    Array<std::uint32_t> roots{};        ///< of each vertex of a periodic mesh: itself, or the one that it is a copy of
    std::size_t copy_count = 0;          ///< vertices that are copies of others
    bool has_fixed_border = false;       ///< whether vertices and edges on the border stay as they are
    Samples samples = Samples::squares;  ///< of the image; for points the faces tile what is 1/2 px inside (mesh/samples.hpp)

    /// The number of vertices, copies included.
    [[nodiscard]] std::size_t vertex_count() const noexcept { return positions.size(); }
    /// The number of vertices but for copies.
    [[nodiscard]] std::size_t distinct_count() const noexcept { return positions.size() - copy_count; }
    /// The energy per vertex, the unit of all tolerances.
    [[nodiscard]] double mean_energy() const noexcept { return energy / static_cast<double>(distinct_count()); }
    /// The periods of the plane.
    [[nodiscard]] Torus torus() const noexcept { return {width, height, periodic}; }
    /// Sets copy_count from the roots.
    void count_copies() noexcept {
        copy_count = 0;
        for (std::size_t v = 0; v < roots.size(); ++v) copy_count += roots[v] != v ? 1U : 0U;
    }
    /// Whether vertex v is on the border of the rectangle, of a mesh that is not periodic.
    [[nodiscard]] bool is_on_border(std::size_t v) const noexcept {
        const Point p = positions[v];
        const double low = inset(samples);
        return p.x == low || p.y == low || p.x == width - low || p.y == height - low;
    }
    /// Appends a vertex and marks it dirty.
    void add(Point position, const Color<C>& color) {
        positions.push_back(position);
        colors.push_back(color);
        dirty.push_back(1);
    }
};

namespace detail {

/// What check() says of a periodic mesh besides its arrays' lengths.
[[nodiscard]] HMESH_COLD inline Status check_sheet(const Array<Point>& positions, const Array<Triangle>& faces,
                                                   const Array<std::uint32_t>& roots, const Torus& torus) {
    for (std::size_t v = 0; v < positions.size(); ++v) {
        const Point p = positions[v];
        if (!is_near(p, torus)) return {Errc::invalid_argument, "a vertex is far outside the image", v};
        if (std::floor(p.x * grid_steps) != p.x * grid_steps || std::floor(p.y * grid_steps) != p.y * grid_steps)
            return {Errc::invalid_argument, "a vertex is off the grid", v};
    }
    // Roots need not be the first of their vertices.
    const Array<std::uint32_t> fresh = tied_vertices(positions, torus);
    for (std::size_t v = 0; v < roots.size(); ++v)
        if (roots[v] >= roots.size() || fresh[v] != fresh[roots[v]] || roots[roots[v]] != roots[v] ||
            (fresh[v] != v && roots[v] != roots[fresh[v]]))
            return {Errc::invalid_argument, "a vertex is tied to one in another place, or not to one in its own", v};
    return check_torus(positions, faces, roots, torus);
}

}  // namespace detail

/// Checks that the mesh is valid: arrays of one length, vertices on the 1/256 px grid, faces that have positive area, meet edge
/// to edge without T-junctions, and tile the image or, of a periodic mesh, the torus, copies of vertices having one colour.
/// Errc::invalid_argument with the index of what is wrong. O(n log n).
template <int C>
[[nodiscard]] HMESH_COLD Status check(const IndexedMesh<C>& mesh) {
    const auto fail = [](const char* what, std::size_t where) -> Status {
        return {Errc::invalid_argument, what, static_cast<std::int64_t>(where), 0};
    };
    const std::size_t n = mesh.positions.size();
    if (mesh.colors.size() != n || mesh.dirty.size() != n) return fail("the arrays of vertices differ in length", n);
    if (mesh.periodic != Periodic::none) {
        if (mesh.roots.size() != n) return fail("the arrays of vertices differ in length", n);
        if (const Status status = detail::check_sheet(mesh.positions, mesh.faces, mesh.roots, mesh.torus()); !status)
            return status;
        for (std::size_t i = 0; i < n; ++i)
            for (int c = 0; c < C; ++c)
                if (mesh.colors[i][c] != mesh.colors[mesh.roots[i]][c])
                    return fail("the copies of a vertex on the cut differ in colour", i);
        return {};
    }
    HalfedgeMesh topology;
    if (const Status status = topology.assign(n, mesh.faces); !status) return status;
    for (std::size_t i = 0; i < n; ++i)
        if (!is_on_grid(mesh.positions[i])) return fail("a vertex is off the grid", i);
    double area = 0;
    for (std::size_t t = 0; t < mesh.faces.size(); ++t) {
        const Triangle& face = mesh.faces[t];
        const double twice = orient2d(mesh.positions[face[0]], mesh.positions[face[1]], mesh.positions[face[2]]);
        if (!(twice > 0)) return fail("a face is flipped or has no area", t);
        area += twice;
    }
    const double low = inset(mesh.samples), right = mesh.width - low, bottom = mesh.height - low;
    if (area != 2.0 * (right - low) * (bottom - low)) return fail("the faces do not tile the image", 0);
    // One boundary, along the sides: with the area above, no hole and no overlap.
    for (const Edge e : topology.edges()) {
        if (!topology.is_boundary(e)) continue;
        const Point a = mesh.positions[topology.from_vertex(HalfedgeMesh::halfedge(e)).index()];
        const Point b = mesh.positions[topology.to_vertex(HalfedgeMesh::halfedge(e)).index()];
        const bool on_side = (a.x == b.x && (a.x == low || a.x == right)) || (a.y == b.y && (a.y == low || a.y == bottom));
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
    mesh.samples = source.samples();
    const double low = inset(mesh.samples);
    for (const int y : {0, source.height()})
        for (const int x : {0, source.width()}) mesh.add({x == 0 ? low : x - low, y == 0 ? low : y - low}, Color<C>::zero());
    const auto corner = [&](std::size_t k) { return Point{k % 2 == 0 ? 0.0 : mesh.width, k < 2 ? 0.0 : mesh.height}; };
    source.visit(4, corner, [&](const SourceWindow<C>& window, std::size_t k) {
        mesh.colors[k] = window.pixel(static_cast<int>(corner(k).x), static_cast<int>(corner(k).y));
    });
    mesh.faces = {{0, 1, 2}, {1, 3, 2}};
    return mesh;
}

/// The mesh as plain float arrays, the result of mesh_image(). `peak`: the stored value of full intensity. Done in order, as the
/// arrays grow; the executor is given a turn every few ms.
template <int C>
[[nodiscard]] HMESH_COLD Mesh to_mesh(const IndexedMesh<C>& from, double peak, const ParallelFor& parallel_for = {}) {
    Mesh to;
    to.channels = C;
    to.width = from.width;
    to.height = from.height;
    to.peak = peak;
    to.samples = from.samples;
    to.positions.reserve(2 * from.vertex_count());
    to.colors.reserve(C * from.vertex_count());
    to.faces.reserve(from.faces.size());
    const double shift = inset(from.samples);
    for_each_in_turn(parallel_for, from.vertex_count(), 1U << 17, [&](std::size_t begin, std::size_t end) {
        to.positions.resize(2 * end);
        to.colors.resize(C * end);
        for (std::size_t v = begin; v < end; ++v) {
            to.positions[2 * v] = static_cast<float>(from.positions[v].x - shift);
            to.positions[2 * v + 1] = static_cast<float>(from.positions[v].y - shift);
            for (std::size_t c = 0; c < C; ++c) to.colors[C * v + c] = static_cast<float>(from.colors[v][static_cast<int>(c)]);
        }
    });
    for_each_in_turn(parallel_for, from.faces.size(), 1U << 18, [&](std::size_t begin, std::size_t end) {
        to.faces.insert(to.faces.end(), from.faces.begin() + begin, from.faces.begin() + end);
    });
    to.periodic = from.periodic;
    return to;
}
/// The mesh as an IndexedMesh, for further work on it; all vertices are dirty, the energy is not computed. Returns an empty mesh
/// where `from` does not have C channels or its arrays differ in their number of vertices; whether it tiles its image is for
/// check() to say.
template <int C>
[[nodiscard]] HMESH_COLD IndexedMesh<C> to_indexed_mesh(const Mesh& from) {
    IndexedMesh<C> to;
    if (from.channels != C || from.colors.size() != C * from.vertex_count()) return to;
    to.width = from.width;
    to.height = from.height;
    to.samples = from.samples;
    const double shift = inset(from.samples);
    for (std::size_t v = 0; v < from.vertex_count(); ++v) {
        Color<C> color = Color<C>::zero();
        for (std::size_t c = 0; c < C; ++c) color.set(static_cast<int>(c), static_cast<double>(from.colors[C * v + c]));
        to.add({static_cast<double>(from.positions[2 * v]) + shift, static_cast<double>(from.positions[2 * v + 1]) + shift},
               color);
    }
    to.faces = from.faces;
    to.periodic = from.periodic;
    if (to.periodic != Periodic::none) to.roots = tied_vertices(to.positions, to.torus());
    to.count_copies();
    return to;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_TILES_INDEXED_MESH_HPP
