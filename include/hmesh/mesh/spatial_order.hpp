/// \file
/// Spatial order: elements sorted along a space-filling curve.
///
/// A loop that visits neighbours in the plane one after another finds them in the cache: 1.5 times as fast as in order of index
/// or of gain. The curve is Morton's (interleaved bits of x and y); ties go by index. O(n).
#ifndef HMESH_MESH_SPATIAL_ORDER_HPP
#define HMESH_MESH_SPATIAL_ORDER_HPP

#include <cstddef>
#include <cstdint>

#include "hmesh/core/array.hpp"
#include "hmesh/core/coded_order.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/lanes.hpp"
#include "hmesh/mesh/geometry.hpp"
#include "hmesh/mesh/halfedge_mesh.hpp"
#include "hmesh/mesh/handles.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {
namespace detail {

/// The low 16 bits of x, spread to the even bits.
[[nodiscard]] constexpr std::uint32_t spread_bits(std::uint32_t x) noexcept {
    x &= 0xffffU;
    x = (x | (x << 8U)) & 0x00ff00ffU;
    x = (x | (x << 4U)) & 0x0f0f0f0fU;
    x = (x | (x << 2U)) & 0x33333333U;
    return (x | (x << 1U)) & 0x55555555U;
}

}  // namespace detail

/// The position of p's pixel on the Morton curve, for sides up to 2^16. The border x = 2^16 wraps around, which only costs
/// speed.
[[nodiscard]] constexpr std::uint32_t morton_code(Point p) noexcept {
    return detail::spread_bits(static_cast<std::uint32_t>(p.x)) | (detail::spread_bits(static_cast<std::uint32_t>(p.y)) << 1U);
}

namespace detail {

[[nodiscard]] constexpr std::size_t number_of(std::size_t number) noexcept { return number; }
template <class Kind>
[[nodiscard]] constexpr std::size_t number_of(Handle<Kind> handle) noexcept {
    return handle.index();
}

}  // namespace detail

/// The `count` elements of a range, handles or numbers below 2^32, sorted by the Morton code of position(element), the position
/// of an element in px.
template <class Element, class Range>
[[nodiscard]] Array<Element> in_spatial_order(const Range& range, std::size_t count, FunctionRef<Point(Element)> position) {
    Array<Coded> items;
    items.reserve(count);
    for (const Element e : range) items.push_back({morton_code(position(e)), static_cast<std::uint32_t>(detail::number_of(e))});
    sort_by_code(items);
    Array<Element> sorted;
    sorted.reserve(count);
    for (const Coded& item : items) sorted.push_back(Element(item.number));
    return sorted;
}

/// Calls body(e) for the edges that belong to face f: an edge belongs to the face of its even half-edge, or to its only face. A
/// loop over all faces meets each edge once.
template <class Body>
HMESH_ALWAYS_INLINE void for_each_edge(const HalfedgeMesh& topology, Face f, Body&& body) {
    Halfedge h = topology.halfedge(f);
    for (int i = 0; i < 3; ++i, h = topology.next(h))
        if ((h.index() & 1U) == 0 || topology.is_boundary(HalfedgeMesh::opposite(h))) body(HalfedgeMesh::edge(h));
}

/// The vertices of a mesh in spatial order, `position` giving their positions: neighbours in the list are mostly neighbours in
/// the plane. O(n).
[[nodiscard]] inline Array<Vertex> spatial_vertices(const HalfedgeMesh& topology, FunctionRef<Point(Vertex)> position) {
    return in_spatial_order<Vertex>(topology.vertices(), topology.vertex_count(), position);
}
/// The faces of a mesh in spatial order of their centroids, `position` giving the positions of vertices. O(n).
[[nodiscard]] inline Array<Face> spatial_faces(const HalfedgeMesh& topology, FunctionRef<Point(Vertex)> position) {
    return in_spatial_order<Face>(topology.faces(), topology.face_count(), [&](Face f) {
        const auto v = topology.vertices(f);
        return centroid(position(v[0]), position(v[1]), position(v[2]));
    });
}
/// The edges of a mesh, each once, in the order of spatial_faces(), `position` giving the positions of vertices. O(n).
[[nodiscard]] inline Array<Edge> spatial_edges(const HalfedgeMesh& topology, FunctionRef<Point(Vertex)> position) {
    Array<Edge> edges;
    edges.reserve(topology.edge_count());
    for (const Face f : spatial_faces(topology, position)) for_each_edge(topology, f, [&](Edge e) { edges.push_back(e); });
    return edges;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_MESH_SPATIAL_ORDER_HPP
