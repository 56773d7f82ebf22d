/// \file
/// recut(): a mesh of a torus or cylinder, cut open along other lines.
///
/// Between phases of work a periodic mesh is a sheet (mesh/torus.hpp): an IndexedMesh with copies of the vertices on the cut,
/// which are locked in all patches. recut() moves faces by whole periods until their centroids are in the rectangle that begins
/// where the next tiling does: what was the border is then within tiles, like everything else. Cost: 0.1 us a vertex.
#ifndef HMESH_TILES_RECUT_HPP
#define HMESH_TILES_RECUT_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "hmesh/core/array.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/mesh/geometry.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/mesh/torus.hpp"
#include "hmesh/tiles/fans.hpp"
#include "hmesh/tiles/indexed_mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {
namespace detail {

/// A sheet made of another one.
struct Recut {
    Array<Point> positions;        ///< of its vertices
    Array<Triangle> faces;         ///< in the order of the other sheet's
    Array<std::uint32_t> roots;    ///< as IndexedMesh::roots
    Array<std::uint32_t> from;     ///< of each vertex, the other sheet's vertex that is the same on the torus
    std::size_t locked_count = 0;  ///< the first so many vertices were among as many of the other sheet
};

/// The sheet whose face f is that of another one, with `roots`, after turns[f]. The executor is given a turn every few ms.
[[nodiscard]] HMESH_COLD inline Recut moved_faces(const Array<Point>& positions, Array<Triangle> faces,
                                                  const Array<std::uint32_t>& roots, const Array<Turns>& turns,
                                                  std::size_t locked_count, const Torus& torus,
                                                  const ParallelFor& parallel_for = {}) {
    const std::size_t n = positions.size();
    // As a rule a vertex has one copy, the first; the others are numbered.
    Array<Turns> first(n, raw);
    Array<unsigned char> is_known(n, 0);
    Array<VertexCopy> others;
    Array<std::uint32_t> corners;  // of these, 3 * face + number
    for_each_in_turn(parallel_for, 3 * faces.size(), 1U << 18, [&](std::size_t begin, std::size_t end) {
        for (std::size_t corner = begin; corner < end; ++corner) {
            const std::uint32_t v = faces[corner / 3][corner % 3], root = roots[v];
            const Turns own = v == root ? Turns() : turns_between(positions[root], positions[v], torus);
            const Turns at = own + turns[corner / 3];
            if (std::exchange(is_known[root], 1) == 0) first[root] = at;
            if (first[root] == at) continue;
            others.push_back({root, at});
            corners.push_back(static_cast<std::uint32_t>(corner));
        }
    });
    const NumberedCopies copies = numbered(others);

    Recut out;
    Array<std::uint32_t> number(n, raw), of_copy(copies.different.size());
    out.positions.reserve(n + of_copy.size());
    out.from.reserve(n + of_copy.size());
    out.roots.reserve(n + of_copy.size());
    const auto add = [&](std::uint32_t root, Turns by) {
        out.positions.push_back(turned(positions[root], by, torus));
        out.from.push_back(root);
        return static_cast<std::uint32_t>(out.positions.size() - 1);
    };
    std::size_t k = 0;
    for (std::uint32_t v = 0; v < n; ++v) {
        if (v == locked_count) out.locked_count = out.positions.size();
        if (is_known[v] == 0) continue;
        number[v] = add(v, first[v]);
        out.roots.push_back(number[v]);
        for (; k < of_copy.size() && copies.different[k].vertex == v; ++k) {
            of_copy[k] = add(v, copies.different[k].turns);
            out.roots.push_back(number[v]);
        }
    }
    if (locked_count >= n) out.locked_count = out.positions.size();
    out.faces = std::move(faces);
    for (Triangle& face : out.faces)
        for (std::uint32_t& v : face) v = number[roots[v]];
    for (std::size_t i = 0; i < corners.size(); ++i) out.faces[corners[i] / 3][corners[i] % 3] = of_copy[copies.number[i]];
    return out;
}

/// The turns of the faces of a sheet that bring their centroids into the rectangle of the image's size that begins at (x, y).
[[nodiscard]] HMESH_COLD inline Array<Turns> turns_of_faces(const Array<Point>& positions, const Array<Triangle>& faces, int x,
                                                            int y, const Torus& torus, const ParallelFor& parallel_for = {}) {
    Array<Turns> turns(faces.size(), raw);
    for_each_chunk(parallel_for, faces.size(), 16384, [&](std::size_t begin, std::size_t end) {
        for (std::size_t f = begin; f < end; ++f) {
            const Triangle& face = faces[f];
            turns[f] = turns_into(centroid(positions[face[0]], positions[face[1]], positions[face[2]]), x, y, torus);
        }
    });
    return turns;
}

/// The turns of the faces of a sheet that shorten its border: a face goes to the side where two of its neighbours are as long as
/// there is one. In turns of the executor.
[[nodiscard]] HMESH_COLD inline Array<Turns> shortening_turns(const Array<Point>& positions, const Array<Triangle>& faces,
                                                              const Array<std::uint32_t>& roots, const Torus& torus,
                                                              const ParallelFor& parallel_for = {}) {
    Array<TorusSide> sides;
    parallel_for(1, [&](std::size_t) { sides = torus_sides(positions, faces, roots, torus); });
    struct Neighbor {
        std::uint32_t face = 0;
        Turns away;  // how far it is from where the face would meet it
        bool exists = false;
    };
    Array<Neighbor> neighbors(3 * faces.size());
    for (std::size_t k = 0; k + 1 < sides.size(); ++k) {
        const TorusSide &one = sides[k], &other = sides[k + 1];
        if (!one.is_beside(other)) continue;
        neighbors[one.corner] = {other.corner / 3, other.at - one.at, true};
        neighbors[other.corner] = {one.corner / 3, one.at - other.at, true};
        ++k;
    }
    Array<Turns> turns(faces.size());
    const auto shorten = [&] {
        bool changed = false;
        for (std::size_t f = 0; f < faces.size(); ++f) {
            const auto count_at = [&](Turns place) {
                int count = 0;
                for (std::size_t c = 0; c < 3; ++c) {
                    const Neighbor& neighbor = neighbors[3 * f + c];
                    count += neighbor.exists && neighbor.away + turns[neighbor.face] == place ? 1 : 0;
                }
                return count;
            };
            const int here = count_at(turns[f]);
            for (std::size_t c = 0; here < 2 && c < 2; ++c) {  // of two neighbours in one place one is the first or the second
                const Neighbor& neighbor = neighbors[3 * f + c];
                if (!neighbor.exists) continue;
                const Turns place = neighbor.away + turns[neighbor.face];
                if (place == turns[f] || count_at(place) < 2) continue;
                turns[f] = place;
                changed = true;
                break;
            }
        }
        return changed;
    };
    // Each move takes an edge off the border, so there is an end.
    for (bool changed = true; changed;) parallel_for(1, [&](std::size_t) { changed = shorten(); });
    return turns;
}

/// Renames corners of faces where several fans of faces meet in one vertex of a sheet: each fan but the first gets a vertex of
/// its own, numbered from positions.size() on. Returns the vertices that these are copies of. `roots`: as IndexedMesh::roots.
[[nodiscard]] HMESH_COLD inline Array<std::uint32_t> split_fans(const Array<std::uint32_t>& roots, Array<Triangle>& faces) {
    Array<unsigned char> is_tied(roots.size(), 0);
    for (std::size_t v = 0; v < roots.size(); ++v)
        if (roots[v] != v) is_tied[v] = is_tied[roots[v]] = 1;
    Array<FanCorner> corners;
    for (std::uint32_t f = 0; f < faces.size(); ++f)
        for (std::uint32_t c = 0; c < 3; ++c)
            if (const Triangle& t = faces[f]; is_tied[t[c]] != 0)
                corners.push_back({t[c], f, c, t[(c + 1) % 3], t[(c + 2) % 3], 0});
    Array<std::uint32_t> added;
    find_fans(corners, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin + 1; i < end; ++i) {  // the first fan keeps the vertex
            if (corners[i].fan != i) continue;
            const auto v = static_cast<std::uint32_t>(roots.size() + added.size());
            added.push_back(corners[i].vertex);
            for (std::size_t k = i; k < end; ++k)
                if (corners[k].fan == i) faces[corners[k].face][corners[k].corner] = v;
        }
    });
    return added;
}

/// Gives a mesh the vertices and faces of a sheet made of it.
template <int C>
HMESH_COLD void take(IndexedMesh<C>& mesh, Recut&& sheet) {
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
        if (mesh.dirty[v] != 0) mesh.dirty[mesh.roots[v]] = 1;
    Array<Color<C>> colors;
    Array<unsigned char> dirty;
    colors.reserve(sheet.from.size());
    dirty.reserve(sheet.from.size());
    for (const std::uint32_t v : sheet.from) {
        colors.push_back(mesh.colors[v]);
        dirty.push_back(mesh.dirty[v]);
    }
    mesh.positions = std::move(sheet.positions);
    mesh.colors = std::move(colors);
    mesh.dirty = std::move(dirty);
    mesh.faces = std::move(sheet.faces);
    mesh.roots = std::move(sheet.roots);
    mesh.locked_count = sheet.locked_count;
    mesh.count_copies();
}

}  // namespace detail

/// Makes a mesh periodic: vertices that are in one place of the torus are tied, and take the colour of the first. Its border must
/// pair, which check() says.
template <int C>
HMESH_COLD void tie(IndexedMesh<C>& mesh, Periodic periodic) {
    mesh.periodic = periodic;
    mesh.roots.clear();
    if (periodic != Periodic::none) mesh.roots = tied_vertices(mesh.positions, mesh.torus());
    for (std::size_t v = 0; v < mesh.roots.size(); ++v) mesh.colors[v] = mesh.colors[mesh.roots[v]];
    mesh.count_copies();
}

/// corner_mesh() of a source that may be periodic: its sides are tied then.
template <int C>
[[nodiscard]] HMESH_COLD IndexedMesh<C> tied_corner_mesh(const ImageSource<C>& source) {
    IndexedMesh<C> mesh = corner_mesh(source);
    tie(mesh, source.periodic());
    return mesh;
}

/// Cuts a periodic mesh open so that the centroids of its faces are in the rectangle of the image's size that begins at (x, y),
/// in px. Faces stay in their order, vertices too but for copies, which follow the first of them.
template <int C>
HMESH_COLD void recut(IndexedMesh<C>& mesh, int x, int y, const ParallelFor& parallel_for = {}) {
    if (mesh.periodic == Periodic::none) return;
    const Array<Turns> turns = detail::turns_of_faces(mesh.positions, mesh.faces, x, y, mesh.torus(), parallel_for);
    detail::take(mesh, detail::moved_faces(mesh.positions, std::move(mesh.faces), mesh.roots, turns, mesh.locked_count,
                                           mesh.torus(), parallel_for));
}

/// The last cut of a periodic mesh, for the user: along the sides of the image if these are `straight` seams, else as short as
/// moves of single faces make it; no two fans of faces meet in one vertex. The mesh is no more for phases of work.
template <int C>
HMESH_COLD void finish_cut(IndexedMesh<C>& mesh, bool straight, const ParallelFor& parallel_for = {}) {
    if (mesh.periodic == Periodic::none) return;
    recut(mesh, 0, 0, parallel_for);
    if (!straight) {
        const Array<Turns> turns = detail::shortening_turns(mesh.positions, mesh.faces, mesh.roots, mesh.torus(), parallel_for);
        detail::take(
            mesh, detail::moved_faces(mesh.positions, std::move(mesh.faces), mesh.roots, turns, 0, mesh.torus(), parallel_for));
    }
    for (const std::uint32_t v : detail::split_fans(mesh.roots, mesh.faces)) {
        mesh.add(mesh.positions[v], Color<C>(mesh.colors[v]));
        mesh.roots.push_back(mesh.roots[v]);
        ++mesh.copy_count;
    }
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_TILES_RECUT_HPP
