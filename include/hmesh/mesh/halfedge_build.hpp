// hmesh - how a HalfedgeMesh is built from triangles, and proved right. Include halfedge_mesh.hpp.
#ifndef HMESH_MESH_HALFEDGE_BUILD_HPP
#define HMESH_MESH_HALFEDGE_BUILD_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/mesh/halfedge_mesh.hpp"

namespace hmesh::kit {

inline Status HalfedgeMesh::assign(std::size_t vertex_count, const std::vector<Triangle>& triangles) {
    clear();
    const auto fail = [this](const char* what, std::size_t where) -> Status {
        clear();
        return {Errc::invalid_argument, what, static_cast<std::int64_t>(where), 0};
    };
    if (vertex_count >= free_end / 6)
        return {Errc::image_too_large, "a mesh has too many vertices", static_cast<std::int64_t>(vertex_count), free_end / 6};

    // Each side of a triangle as (smaller corner, larger corner, direction): the two half-edges of an edge sort together.
    // First by counting, then the few that share their smaller corner.
    struct Side {
        std::uint32_t low, high, corner;  // corner = 3 * triangle + k; the side runs from corner k to corner k + 1
        bool reversed;
    };
    std::vector<std::size_t> first(vertex_count + 1, 0);
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t a = triangles[t][k], b = triangles[t][(k + 1) % 3];
            if (a >= vertex_count || b >= vertex_count) return fail("a triangle names a vertex that does not exist", t);
            if (a == b) return fail("a triangle names a vertex twice", t);
            ++first[std::min(a, b) + 1];
        }
    for (std::size_t v = 0; v < vertex_count; ++v) first[v + 1] += first[v];
    std::vector<Side> sides(3 * triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t a = triangles[t][k], b = triangles[t][(k + 1) % 3];
            sides[first[std::min(a, b)]++] = {std::min(a, b), std::max(a, b), static_cast<std::uint32_t>(3 * t + k), a > b};
        }
    for (std::size_t v = 0, begin = 0; v < vertex_count; begin = first[v++])
        std::sort(sides.begin() + static_cast<std::ptrdiff_t>(begin), sides.begin() + static_cast<std::ptrdiff_t>(first[v]),
                  [](const Side& a, const Side& b) { return a.high != b.high ? a.high < b.high : a.reversed < b.reversed; });

    std::vector<Halfedge> side_halfedge(3 * triangles.size());
    vertices_.resize(vertex_count);
    counts_.vertices = vertex_count;
    for (std::size_t i = 0; i < sides.size();) {
        const Side& side = sides[i];
        std::size_t same = i + 1;
        while (same < sides.size() && sides[same].low == side.low && sides[same].high == side.high) ++same;
        if (same - i > 2 || (same - i == 2 && sides[i + 1].reversed == side.reversed))
            return fail("an edge is used twice in one direction, first by triangle", side.corner / 3);
        const Halfedge h = new_edge();
        set_to(h, Vertex(side.high));
        set_to(opposite(h), Vertex(side.low));
        for (; i < same; ++i) side_halfedge[sides[i].corner] = sides[i].reversed ? opposite(h) : h;
    }
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        set_triangle(new_face(), side_halfedge[3 * t], side_halfedge[3 * t + 1], side_halfedge[3 * t + 2]);
        for (std::size_t k = 0; k < 3; ++k) set_halfedge(Vertex(triangles[t][k]), side_halfedge[3 * t + k]);
    }
    for (std::size_t i = 0; i < halfedges_.size(); ++i) {
        const Halfedge h(i);
        if (!is_boundary(h)) continue;
        const Vertex v = from_vertex(h);
        if (vertices_[v.index()].deleted()) return fail("a vertex belongs to no triangle", v.index());
        if (is_boundary(halfedge(v))) return fail("two fans of triangles meet in one vertex", v.index());
        set_halfedge(v, h);
    }
    for (std::size_t i = 0; i < vertex_count; ++i)
        if (vertices_[i].deleted()) return fail("a vertex belongs to no triangle", i);
    // The boundary half-edge after h leaves h's end; each end has only one.
    for (std::size_t i = 0; i < halfedges_.size(); ++i)
        if (is_boundary(Halfedge(i))) set_next(Halfedge(i), halfedge(to_vertex(Halfedge(i))));
    const Status status = check();
    if (!status) clear();
    return status;
}

inline Status HalfedgeMesh::check_vertex(Vertex v) const {
    const auto fail = [v](const char* what) -> Status {
        return {Errc::invalid_argument, what, static_cast<std::int64_t>(v.index()), 0};
    };
    const Halfedge first = halfedge(v);
    if (first.index() >= halfedges_.size() || is_deleted(edge(first)) || from_vertex(first) != v)
        return fail("a vertex's half-edge does not leave it");
    return {};
}

inline Status HalfedgeMesh::check() const {
    const auto fail = [](const char* what, std::size_t index) -> Status {
        return {Errc::invalid_argument, what, static_cast<std::int64_t>(index), 0};
    };
    std::size_t vertex_total = 0, edge_total = 0, face_total = 0;
    for (const Vertex v : vertices()) {
        if (const Status status = check_vertex(v); !status) return status;
        ++vertex_total;
    }
    std::vector<std::uint32_t> leaving(vertex_slots(), 0);
    std::vector<unsigned char> boundary(vertex_slots(), 0);
    for (const Edge e : edges()) {
        ++edge_total;
        for (const Halfedge h : {halfedge(e), opposite(halfedge(e))}) {
            const Halfedge n = next(h);
            if (n.index() >= halfedges_.size() || is_deleted(edge(n))) return fail("a half-edge's next is none", h.index());
            if (to_vertex(h).index() >= vertex_slots() || is_deleted(to_vertex(h)))
                return fail("a half-edge points to no vertex", h.index());
            if (from_vertex(n) != to_vertex(h)) return fail("a half-edge's next does not leave its end", h.index());
            if (face(n) != face(h)) return fail("a half-edge and its next have two faces", h.index());
            if (is_boundary(h)) {
                if (is_boundary(opposite(h))) return fail("an edge has no face", e.index());
                if (boundary[from_vertex(h).index()]++ != 0) return fail("two fans meet in a vertex", from_vertex(h).index());
                if (halfedge(from_vertex(h)) != h)
                    return fail("a boundary vertex's half-edge is not on the boundary", from_vertex(h).index());
            } else {
                if (face(h).index() >= face_slots() || is_deleted(face(h))) return fail("a half-edge's face is none", h.index());
                if (next(next(n)) != h) return fail("a face is no triangle", face(h).index());
                if (to_vertex(n) == from_vertex(h) || to_vertex(h) == from_vertex(h))
                    return fail("a face has a corner twice", face(h).index());
            }
            ++leaving[from_vertex(h).index()];
        }
    }
    for (const Face f : faces()) {
        ++face_total;
        const Halfedge h = halfedge(f);
        if (h.index() >= halfedges_.size() || is_deleted(edge(h)) || face(h) != f)
            return fail("a face's half-edge does not bound it", f.index());
    }
    if (vertex_total != vertex_count() || edge_total != edge_count() || face_total != face_count())
        return fail("a count of live elements is wrong", vertex_total);
    std::size_t bounded = 0;
    for (const Edge e : edges()) bounded += (is_boundary(halfedge(e)) ? 0U : 1U) + (is_boundary(opposite(halfedge(e))) ? 0U : 1U);
    if (bounded != 3 * face_total) return fail("the faces do not use each half-edge once", bounded);
    // One fan a vertex: a turn around it meets all half-edges that leave it, and no neighbour twice.
    std::vector<std::size_t> neighbors;
    for (const Vertex v : vertices()) {
        neighbors.clear();
        for (const Halfedge h : outgoing(v)) {
            neighbors.push_back(to_vertex(h).index());
            if (neighbors.size() > leaving[v.index()]) return fail("a turn around a vertex does not close", v.index());
        }
        if (neighbors.size() != leaving[v.index()]) return fail("two fans meet in a vertex", v.index());
        std::sort(neighbors.begin(), neighbors.end());
        if (std::adjacent_find(neighbors.begin(), neighbors.end()) != neighbors.end())
            return fail("two edges join the same vertices", v.index());
    }
    return {};
}

}  // namespace hmesh::kit

#endif  // HMESH_MESH_HALFEDGE_BUILD_HPP
