/// \file
/// Periodic meshes: what a mesh of a torus or of a cylinder is once it is cut open into a sheet, and how it is checked.
///
/// A sheet has the same faces as the torus, each once. Vertices on the cut have a copy for each side of it (at most a few), whole
/// periods apart and of the same colour, so that copies of the sheet interlock. Which vertices are copies of one another follows
/// from their positions alone, since positions lie on a grid and no two vertices of a torus stand in one place. A turn is a whole
/// number of periods along each axis.
#ifndef HMESH_MESH_TORUS_HPP
#define HMESH_MESH_TORUS_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "hmesh/core/array.hpp"
#include "hmesh/core/coded_order.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/finite.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/mesh/geometry.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/mesh/periodic.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// The periods of the plane in which an image repeats.
struct Torus {
    int width = 0,                       ///< px of the image
        height = 0;                      ///< px of the image
    Periodic periodic = Periodic::none;  ///< along which axes it repeats
};

/// Whole periods along each axis.
struct Turns {
    int x = 0,                                                                                        ///< times the width
        y = 0;                                                                                        ///< times the height
    friend constexpr bool operator==(Turns a, Turns b) noexcept { return a.x == b.x && a.y == b.y; }  ///< the same turns
    friend constexpr bool operator!=(Turns a, Turns b) noexcept { return !(a == b); }                 ///< other turns
    friend constexpr Turns operator+(Turns a, Turns b) noexcept { return {a.x + b.x, a.y + b.y}; }    ///< one after the other
    friend constexpr Turns operator-(Turns a, Turns b) noexcept { return {a.x - b.x, a.y - b.y}; }    ///< from b to a
};

/// A code for turns: those along x count, of equal ones those along y.
[[nodiscard]] constexpr std::uint64_t code_of(Turns turns) noexcept {
    constexpr std::uint32_t sign = 0x80000000U;
    return code_of(static_cast<std::uint32_t>(turns.x) ^ sign, static_cast<std::uint32_t>(turns.y) ^ sign);
}

/// The turns from `from` to `to`, two places of one vertex.
[[nodiscard]] inline Turns turns_between(Point from, Point to, const Torus& torus) noexcept {
    const auto along = [](double distance, int period, bool wraps) {
        return wraps ? static_cast<int>(std::floor(distance / period + 0.5)) : 0;
    };
    return {along(to.x - from.x, torus.width, wraps_x(torus.periodic)),
            along(to.y - from.y, torus.height, wraps_y(torus.periodic))};
}
/// The point `turns` away from p.
[[nodiscard]] inline Point turned(Point p, Turns turns, const Torus& torus) noexcept {
    return {p.x + static_cast<double>(turns.x) * torus.width, p.y + static_cast<double>(turns.y) * torus.height};
}
/// The turns that bring p into [x, x + width) x [y, y + height), along the axes that repeat.
[[nodiscard]] inline Turns turns_into(Point p, double x, double y, const Torus& torus) noexcept {
    return {wraps_x(torus.periodic) ? -static_cast<int>(std::floor((p.x - x) / torus.width)) : 0,
            wraps_y(torus.periodic) ? -static_cast<int>(std::floor((p.y - y) / torus.height)) : 0};
}
/// The same point of the torus in [0, width) x [0, height), along the axes that repeat.
[[nodiscard]] HMESH_NEVER_INLINE HMESH_COLD inline Point inside(Point p, const Torus& torus) noexcept {
    return turned(p, turns_into(p, 0, 0, torus), torus);
}

/// Whether p is where a vertex of a sheet may be: no more than 64 sizes of the image from its origin. False for NaN.
[[nodiscard]] inline bool is_near(const Point& p, const Torus& torus) noexcept {
    const auto is_along = [](double x, int size) { return is_within(x, -64.0 * size, 64.0 * size) && size > 0; };
    return is_along(p.x, torus.width) && is_along(p.y, torus.height);
}

/// For each vertex of a sheet the first one that is in the same place of the torus, itself where there is none before. Vertices
/// that are not near are at no place but their own. O(n log n).
[[nodiscard]] HMESH_COLD inline Array<std::uint32_t> tied_vertices(const Array<Point>& positions, const Torus& torus) {
    Array<Point> places;
    places.reserve(positions.size());
    for (const Point p : positions) places.push_back(is_near(p, torus) ? inside(p, torus) : p);
    Array<std::uint32_t> roots(positions.size());
    std::uint32_t root = 0xffffffffU;
    for (const Coded& at : sorted_numbers(
             places.size(), [&](std::uint32_t v) { return code_of(places[v].x); },
             [&](std::uint32_t v) { return code_of(places[v].y); })) {
        if (root == 0xffffffffU || places[at.number] != places[root]) root = at.number;
        roots[at.number] = root;
    }
    return roots;
}

/// A copy of a vertex, some turns away from it.
struct VertexCopy {
    std::uint32_t vertex = 0;  ///< of which
    Turns turns;               ///< how far away
};

/// Copies that may repeat, as numbers of different ones.
struct NumberedCopies {
    Array<VertexCopy> different;  ///< sorted by vertex, then turns
    Array<std::uint32_t> number;  ///< of each copy: its place among these
};

/// Numbers copies. O(n log n).
[[nodiscard]] HMESH_COLD inline NumberedCopies numbered(const Array<VertexCopy>& copies) {
    NumberedCopies out;
    out.number.resize(copies.size());
    for (const Coded& at : sorted_numbers(
             copies.size(), [&](std::uint32_t k) { return std::uint64_t{copies[k].vertex}; },
             [&](std::uint32_t k) { return code_of(copies[k].turns); })) {
        const VertexCopy& copy = copies[at.number];
        if (out.different.empty() || out.different.back().vertex != copy.vertex || out.different.back().turns != copy.turns)
            out.different.push_back(copy);
        out.number[at.number] = static_cast<std::uint32_t>(out.different.size() - 1);
    }
    return out;
}

/// A side of a face of a sheet as an edge of the torus, from the one of its ends that comes first there.
struct TorusSide {
    std::uint32_t from = 0,    ///< root of that end
        to = 0;                ///< root of the other end
    Turns along;               ///< from one to the other
    Turns at;                  ///< of the end from its root
    std::uint32_t corner = 0;  ///< 3 * face + number of the side
    bool is_reversed = false;  ///< whether the face runs from the other end
    /// Whether both are sides of one edge.
    [[nodiscard]] bool is_beside(const TorusSide& o) const noexcept { return from == o.from && to == o.to && along == o.along; }
};

/// The sides of all faces of a sheet, those of an edge next to each other. O(n log n).
[[nodiscard]] HMESH_COLD inline Array<TorusSide> torus_sides(const Array<Point>& positions, const Array<Triangle>& faces,
                                                             const Array<std::uint32_t>& roots, const Torus& torus) {
    Array<TorusSide> sides;
    sides.reserve(3 * faces.size());
    for (std::uint32_t corner = 0; corner < 3 * faces.size(); ++corner) {
        const Triangle& face = faces[corner / 3];
        const std::uint32_t a = face[corner % 3], b = face[corner % 3 == 2 ? 0 : corner % 3 + 1];
        const Turns at_a = turns_between(positions[roots[a]], positions[a], torus);
        const Turns at_b = turns_between(positions[roots[b]], positions[b], torus);
        const Turns along = at_b - at_a;
        const bool is_loop = roots[a] == roots[b];
        const bool is_reversed = is_loop ? along.x != 0 ? along.x < 0 : along.y < 0 : roots[a] > roots[b];
        if (is_reversed) sides.push_back({roots[b], roots[a], at_a - at_b, at_b, corner, true});
        else sides.push_back({roots[a], roots[b], along, at_a, corner, false});
    }
    return in_order(sides, sorted_numbers(
                               sides.size(), [&](std::uint32_t k) { return code_of(sides[k].from, sides[k].to); },
                               [&](std::uint32_t k) { return code_of(sides[k].along); }));
}

namespace detail {

/// Whether both points are on one side of the image along which it does not repeat.
[[nodiscard]] inline bool on_one_side(Point a, Point b, const Torus& torus) noexcept {
    return (!wraps_x(torus.periodic) && a.x == b.x && (a.x == 0 || a.x == torus.width)) ||
           (!wraps_y(torus.periodic) && a.y == b.y && (a.y == 0 || a.y == torus.height));
}

}  // namespace detail

/// Checks that a sheet is a mesh of the torus or cylinder, `roots` being its tied_vertices(): faces of positive area whose sum is
/// the image's, each edge with a face on both sides of it, but for those on sides of a cylinder, and Euler's characteristic 0.
/// Such faces cover each place once. Errc::invalid_argument with the index of what is wrong. O(n log n).
[[nodiscard]] HMESH_COLD inline Status check_torus(const Array<Point>& positions, const Array<Triangle>& faces,
                                                   const Array<std::uint32_t>& roots, const Torus& torus) {
    const auto fail = [](const char* what, std::size_t where) -> Status { return {Errc::invalid_argument, what, where}; };
    double area = 0;
    for (std::size_t f = 0; f < faces.size(); ++f) {
        for (const std::uint32_t v : faces[f])
            if (v >= positions.size()) return fail("the mesh has a face that names no vertex, at face", f);
        const double twice = orient2d(positions[faces[f][0]], positions[faces[f][1]], positions[faces[f][2]]);
        if (!(twice > 0)) return fail("a face is flipped or has no area", f);
        area += twice;
    }
    if (!(std::abs(area - 2.0 * torus.width * torus.height) <= 1e-9 * area))
        return fail("the faces do not tile the image", faces.size());
    const Array<TorusSide> sides = torus_sides(positions, faces, roots, torus);
    std::size_t edges = 0;
    for (std::size_t k = 0; k < sides.size(); ++k, ++edges) {
        const std::size_t f = sides[k].corner / 3, c = sides[k].corner % 3;
        if (k + 1 == sides.size() || !sides[k].is_beside(sides[k + 1])) {
            if (!detail::on_one_side(positions[faces[f][c]], positions[faces[f][c == 2 ? 0 : c + 1]], torus))
                return fail("an edge on the cut has no partner on its other side, of face", f);
            continue;
        }
        if (sides[k].is_reversed == sides[k + 1].is_reversed || (k + 2 < sides.size() && sides[k].is_beside(sides[k + 2])))
            return fail("an edge has two faces on one side, first face", f);
        ++k;
    }
    Array<unsigned char> is_used(positions.size(), 0);
    for (const Triangle& face : faces)
        for (const std::uint32_t v : face) is_used[roots[v]] = 1;
    const auto vertices = static_cast<std::size_t>(std::count(is_used.begin(), is_used.end(), 1));
    if (vertices + faces.size() != edges)
        return {Errc::invalid_argument, "the mesh is no torus or cylinder: its Euler characteristic is not 0",
                static_cast<double>(vertices + faces.size()) - static_cast<double>(edges)};
    return {};
}

/// The positions of a mesh.
[[nodiscard]] HMESH_COLD inline Array<Point> positions_of(const MeshView& mesh) {
    Array<Point> positions(mesh.vertex_count);
    for (std::size_t v = 0; v < mesh.vertex_count; ++v)
        positions[v] = {static_cast<double>(mesh.positions[2 * v]), static_cast<double>(mesh.positions[2 * v + 1])};
    return positions;
}

/// Checks that a mesh is what its `periodic` says: that copies of it, shifted by its size, cover each place of the plane (of a
/// band, where it repeats along one axis) once, and that the vertices of its border have copies of the same colour, to the bit,
/// on the other side. A mesh that repeats along no axis is refused. Errc::invalid_argument or not_finite. O(n log n).
[[nodiscard]] HMESH_COLD inline Status check_periodic(const MeshView& mesh) {
    if (mesh.periodic == Periodic::none) return {Errc::invalid_argument, "the mesh is not periodic"};
    if (const Status status = check(mesh, 16); !status) return status;
    if (mesh.width < 1 || mesh.height < 1) return {Errc::invalid_argument, "the mesh's width and height must be at least 1"};
    const Array<Point> positions = positions_of(mesh);
    const Torus torus{mesh.width, mesh.height, mesh.periodic};
    for (std::size_t v = 0; v < positions.size(); ++v)
        if (!is_near(positions[v], torus))
            return {Errc::invalid_argument, "the mesh has a position far outside its image, at vertex", v};
    const Array<std::uint32_t> roots = tied_vertices(positions, torus);
    const auto channels = static_cast<std::size_t>(mesh.channels);
    for (std::size_t v = 0; v < positions.size(); ++v)
        if (!std::equal(mesh.colors + channels * v, mesh.colors + channels * (v + 1), mesh.colors + channels * roots[v]))
            return {Errc::invalid_argument, "the copies of a vertex on the cut differ in colour, at vertex", v};
    return check_torus(positions, {mesh.faces, mesh.faces + mesh.face_count}, roots, torus);
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_MESH_TORUS_HPP
