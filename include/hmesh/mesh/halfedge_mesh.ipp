// hmesh - the longer member functions of HalfedgeMesh. Included by halfedge_mesh.hpp only.
#ifndef HMESH_MESH_HALFEDGE_MESH_IPP
#define HMESH_MESH_HALFEDGE_MESH_IPP

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "hmesh/core/array.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

// --- building and checking -----------------------------------------------------------------------------------------

/// The sides of triangles as half-edges.
struct HalfedgeMesh::Sides {
    Status status;              ///< what is wrong with the triangles, and where
    Array<Halfedge> halfedges;  ///< side k of triangle t, from corner k to the next, is halfedges[3 t + k]
    std::size_t edges = 0;      ///< how many there are
};

/// Finds the half-edges of the sides, the two of an edge beside each other. Refuses a vertex that is none, one that a triangle
/// names twice, and two sides that run from one vertex to another.
HalfedgeMesh::Sides HalfedgeMesh::find_sides(std::size_t vertex_count, const Array<Triangle>& triangles) {
    Sides out;
    const auto fail = [&out](const char* what, std::size_t where) {
        out.status = {Errc::invalid_argument, what, static_cast<std::int64_t>(where), 0};
        return std::move(out);
    };
    // The sides of triangles by their smaller corner, and of one smaller corner sorted by the larger one, so that the two
    // half-edges of an edge follow each other. A side is, from high bits to low ones, the larger corner, whether it runs from
    // there, and 3 * triangle + k for the side from corner k to corner k + 1: sorting numbers takes half the time of structs.
    constexpr std::uint64_t reversed = std::uint64_t{1} << 32;
    Array<std::uint32_t> first(vertex_count + 1, 0);
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t a = triangles[t][k], b = triangles[t][corner_after(k)];
            if (a >= vertex_count || b >= vertex_count) return fail("a triangle names a vertex that does not exist", t);
            if (a == b) return fail("a triangle names a vertex twice", t);
            ++first[std::min(a, b) + 1];
        }
    for (std::size_t v = 0; v < vertex_count; ++v) first[v + 1] += first[v];
    Array<std::uint64_t> sides(3 * triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t a = triangles[t][k], b = triangles[t][corner_after(k)];
            sides[first[std::min(a, b)]++] =
                std::uint64_t{std::max(a, b)} << 33U | (a > b ? reversed : 0) | static_cast<std::uint32_t>(3 * t + k);
        }
    out.halfedges.resize(3 * triangles.size());
    for (std::size_t v = 0, i = 0; v < vertex_count; ++v) {
        std::sort(sides.begin() + static_cast<std::ptrdiff_t>(i), sides.begin() + static_cast<std::ptrdiff_t>(first[v]));
        for (std::uint64_t before = 0; i < first[v]; before = sides[i++]) {
            const std::uint64_t side = sides[i];
            // The larger corner is never 0.
            if ((side ^ before) >> 32U == 0)
                return fail("an edge is used twice in one direction, first by triangle", static_cast<std::uint32_t>(before) / 3);
            out.edges += (side ^ before) >> 33U != 0 ? 1 : 0;
            out.halfedges[static_cast<std::uint32_t>(side)] = Halfedge(2 * out.edges - ((side & reversed) != 0 ? 1 : 2));
        }
    }
    return out;
}

/// Links the boundary half-edges, where all others are. Refuses a vertex of no triangle and one in which two fans meet.
Status HalfedgeMesh::link_boundary() {
    const auto fail = [](const char* what, std::size_t where) -> Status {
        return {Errc::invalid_argument, what, static_cast<std::int64_t>(where), 0};
    };
    for (std::size_t i = 0; i < halfedges_.size(); ++i) {
        const Halfedge h(i);
        if (!is_boundary(h)) continue;
        const Vertex v = from_vertex(h);
        if (vertices_[v.index()].deleted()) return fail("a vertex belongs to no triangle", v.index());
        if (is_boundary(halfedge(v))) return fail("two fans of triangles meet in one vertex", v.index());
        set_halfedge(v, h);
    }
    for (std::size_t i = 0; i < vertices_.size(); ++i)
        if (vertices_[i].deleted()) return fail("a vertex belongs to no triangle", i);
    // The boundary half-edge after h leaves h's end; each end has only one.
    for (std::size_t i = 0; i < halfedges_.size(); ++i)
        if (is_boundary(Halfedge(i))) set_next(Halfedge(i), halfedge(to_vertex(Halfedge(i))));
    return {};
}

Status HalfedgeMesh::assign(std::size_t vertex_count, const Array<Triangle>& triangles) {
    clear();
    if (vertex_count >= free_end / 6)
        return {Errc::image_too_large, "a mesh has too many vertices", static_cast<std::int64_t>(vertex_count), free_end / 6};
    const Sides sides = find_sides(vertex_count, triangles);
    if (!sides.status) return sides.status;

    vertices_.resize(vertex_count);
    halfedges_.resize(2 * sides.edges);
    faces_.resize(triangles.size());
    counts_.vertices = vertex_count;
    counts_.edges = sides.edges;
    counts_.faces = triangles.size();
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        const Halfedge* const h = sides.halfedges.data() + 3 * t;
        const Triangle& v = triangles[t];
        set_triangle(Face(t), h[0], h[1], h[2]);
        for (std::size_t k = 0; k < 3; ++k) {
            set_to(h[k], Vertex(v[corner_after(k)]));
            set_to(opposite(h[k]), Vertex(v[k]));
            set_halfedge(Vertex(v[k]), h[k]);
        }
    }
    Status status = link_boundary();
    if (status && !do_turns_meet_all()) status = check();
    if (!status) clear();
    HMESH_ASSERT(!status || check());
    return status;
}

/// Whether a turn around each vertex meets all half-edges that leave it: the one thing that assign() does not know of a mesh whose
/// boundary is linked. They are as many as there are half-edges in all, and a turn meets none twice. A turn over two faces back to
/// back counts for nothing.
bool HalfedgeMesh::do_turns_meet_all() const {
    std::size_t met = 0;
    for (const Vertex v : vertices())
        if (const int turn = valence(v); turn > 2 || is_boundary(v)) met += static_cast<std::size_t>(turn);
    return met == halfedges_.size();
}

inline Array<Triangle> HalfedgeMesh::triangles(const ParallelFor& parallel_for) const {
    Array<std::uint32_t> numbers;  // none: they are indices
    if (vertex_count() < vertex_slots()) {
        numbers.resize(vertex_slots());
        std::uint32_t count = 0;
        for (const Vertex v : vertices()) numbers[v.index()] = count++;
    }
    Array<Triangle> out(face_slots(), raw);
    for_each_chunk(parallel_for, out.size(), 16384, [&](std::size_t begin, std::size_t end) {
        for (std::size_t f = begin; f < end; ++f) {
            if (is_deleted(Face(f))) continue;
            const std::array<Vertex, 3> corners = vertices(Face(f));
            for (std::size_t k = 0; k < 3; ++k) {
                const std::size_t v = corners[k].index();
                out[f][k] = numbers.empty() ? static_cast<std::uint32_t>(v) : numbers[v];
            }
        }
    });
    if (face_count() == face_slots()) return out;
    std::size_t kept = 0;
    for (const Face f : faces()) out[kept++] = out[f.index()];
    out.resize(kept);
    return out;
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
    Array<std::uint32_t> leaving(vertex_slots(), 0);
    Array<unsigned char> boundary(vertex_slots(), 0);
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
    return check_fans(leaving, boundary);
}
inline Status HalfedgeMesh::check_fans(const Array<std::uint32_t>& leaving, const Array<unsigned char>& boundary) const {
    const auto fail = [](const char* what, Vertex v) -> Status {
        return {Errc::invalid_argument, what, static_cast<std::int64_t>(v.index()), 0};
    };
    Array<std::size_t> neighbors, met_by(vertex_slots(), vertex_slots());
    for (const Vertex v : vertices()) {
        neighbors.clear();
        for (const Halfedge h : outgoing(v)) {
            neighbors.push_back(to_vertex(h).index());
            if (neighbors.size() > leaving[v.index()]) return fail("a turn around a vertex does not close", v);
        }
        if (neighbors.size() != leaving[v.index()]) return fail("two fans meet in a vertex", v);
        if (neighbors.size() < 3 && boundary[v.index()] == 0) return fail("two faces have the same corners, at vertex", v);
        for (const std::size_t u : neighbors)
            if (std::exchange(met_by[u], v.index()) == v.index()) return fail("two edges join the same vertices", v);
    }
    return {};
}

// --- edits ---------------------------------------------------------------------------------------------------------

Vertex HalfedgeMesh::new_vertex() {
    ++counts_.vertices;
    if (counts_.free_vertex == free_end) {
        vertices_.push_back({});
        return Vertex(vertices_.size() - 1);
    }
    const Vertex v(counts_.free_vertex);
    counts_.free_vertex = link_of(halfedge(v));
    return v;
}

Halfedge HalfedgeMesh::new_edge() {
    ++counts_.edges;
    if (counts_.free_edge == free_end) {
        halfedges_.push_back({});
        halfedges_.push_back({});
        return Halfedge(halfedges_.size() - 2);
    }
    const Halfedge h = halfedge(Edge(counts_.free_edge));
    counts_.free_edge = link_of(next(h));
    return h;
}

Face HalfedgeMesh::new_face() {
    ++counts_.faces;
    if (counts_.free_face == free_end) {
        faces_.push_back({});
        return Face(faces_.size() - 1);
    }
    const Face f(counts_.free_face);
    counts_.free_face = link_of(halfedge(f));
    return f;
}

inline void HalfedgeMesh::delete_vertex(Vertex v) {
    set_halfedge(v, free_link(counts_.free_vertex));
    counts_.free_vertex = static_cast<std::uint32_t>(v.index());
    --counts_.vertices;
}

void HalfedgeMesh::delete_edge(Edge e) {
    set_next(halfedge(e), free_link(counts_.free_edge));
    counts_.free_edge = static_cast<std::uint32_t>(e.index());
    --counts_.edges;
}

void HalfedgeMesh::delete_face(Face f) {
    set_halfedge(f, free_link(counts_.free_face));
    counts_.free_face = static_cast<std::uint32_t>(f.index());
    --counts_.faces;
}

void HalfedgeMesh::set_triangle(Face f, Halfedge a, Halfedge b, Halfedge c) {
    HalfedgeSlot& sa = halfedges_.edit(a.index());
    sa.next = b, sa.face = f;
    HalfedgeSlot& sb = halfedges_.edit(b.index());
    sb.next = c, sb.face = f;
    HalfedgeSlot& sc = halfedges_.edit(c.index());
    sc.next = a, sc.face = f;
    set_halfedge(f, a);
}

inline void HalfedgeMesh::flip(Edge e) {
    HMESH_ASSERT(is_flip_ok(e));
    const Halfedge a = halfedge(e), b = opposite(a);
    const Halfedge a1 = next(a), a2 = next(a1), b1 = next(b), b2 = next(b1);
    const Vertex v0 = to_vertex(b), v1 = to_vertex(a), v2 = to_vertex(a1), v3 = to_vertex(b1);
    const Face fa = face(a), fb = face(b);
    set_to(a, v2);
    set_to(b, v3);
    set_triangle(fa, a, a2, b1);  // v3 -> v2 -> v0
    set_triangle(fb, b, b2, a1);  // v2 -> v3 -> v1
    if (halfedge(v0) == a) set_halfedge(v0, b1);
    if (halfedge(v1) == b) set_halfedge(v1, a1);
}

inline Vertex HalfedgeMesh::split(Edge e) {
    const Halfedge a = halfedge(e), b = opposite(a);
    const Vertex v1 = to_vertex(a), m = new_vertex();
    const Halfedge c = new_edge(), d = opposite(c);  // m -> v1 and back
    const Halfedge before_b = previous(b);           // read before anything changes
    const Halfedge a1 = next(a), b1 = next(b);
    const Face fa = face(a), fb = face(b);
    set_to(a, m);
    set_to(c, v1);
    set_to(d, m);
    if (fa.is_valid()) {
        const Halfedge a2 = next(a1), s = new_edge(), t = opposite(s);  // m -> v2 and back
        set_to(s, to_vertex(a1));
        set_to(t, m);
        set_triangle(fa, a, s, a2);
        set_triangle(new_face(), c, a1, t);
    } else {
        set_next(a, c);
        set_next(c, a1);
        set_face(c, Face());
    }
    if (fb.is_valid()) {
        const Halfedge b2 = next(b1), s = new_edge(), t = opposite(s);  // m -> v3 and back
        set_to(s, to_vertex(b1));
        set_to(t, m);
        set_triangle(fb, b, b1, t);
        set_triangle(new_face(), d, s, b2);
    } else {
        set_next(before_b, d);
        set_next(d, b);
        set_face(d, Face());
    }
    set_halfedge(m, fa.is_valid() ? b : c);  // b when it is the boundary, or either when neither is
    if (halfedge(v1) == b) set_halfedge(v1, d);
    return m;
}

inline Vertex HalfedgeMesh::split(Face f) {
    const Halfedge a = halfedge(f), b = next(a), c = next(b);
    const Vertex m = new_vertex();
    Halfedge spoke[3];  // from m to the origin of a, b, c
    const Halfedge side[3] = {a, b, c};
    for (int i = 0; i < 3; ++i) {
        spoke[i] = new_edge();
        set_to(spoke[i], from_vertex(side[i]));
        set_to(opposite(spoke[i]), m);
    }
    set_triangle(f, a, opposite(spoke[1]), spoke[0]);
    set_triangle(new_face(), b, opposite(spoke[2]), spoke[1]);
    set_triangle(new_face(), c, opposite(spoke[0]), spoke[2]);
    set_halfedge(m, spoke[0]);
    return m;
}

inline bool HalfedgeMesh::is_collapse_ok(Halfedge h) const noexcept {
    const Halfedge o = opposite(h);
    const Vertex v = to_vertex(o), u = to_vertex(h);
    if (is_boundary(v) && !is_boundary(h) && !is_boundary(o)) return false;
    const Vertex left = is_boundary(h) ? Vertex() : to_vertex(next(h));
    const Vertex right = is_boundary(o) ? Vertex() : to_vertex(next(o));
    for (const Halfedge s : outgoing(v)) {
        const Vertex a = to_vertex(s);
        if (a == u || a == left || a == right) continue;
        if (find_halfedge(a, u).is_valid()) return false;
    }
    // A tetrahedron, the smallest closed mesh, would end as two faces back to back.
    if (!is_boundary(v) && !is_boundary(u) && valence(v) == 3 && valence(u) == 3) return false;
    // A far corner must keep a face, and the last triangle of a component is nobody's to remove.
    if (left.is_valid() && is_boundary(opposite(next(h))) && is_boundary(opposite(next(next(h))))) return false;
    if (right.is_valid() && is_boundary(opposite(next(o))) && is_boundary(opposite(next(next(o))))) return false;
    return true;
}

void HalfedgeMesh::replace(Halfedge goes, Halfedge stays) {
    const Halfedge before = previous(goes), after = next(goes);
    const Face f = face(goes);
    set_next(before, stays);
    HalfedgeSlot& slot = halfedges_.edit(stays.index());
    slot.next = after, slot.face = f;
    if (f.is_valid() && halfedge(f) == goes) set_halfedge(f, stays);
}

inline void HalfedgeMesh::collapse(Halfedge h) {
    HMESH_ASSERT(is_collapse_ok(h));
    const Halfedge o = opposite(h);
    const Vertex v = to_vertex(o), u = to_vertex(h);
    const Halfedge before_h = previous(h), before_o = previous(o);
    const bool v_on_boundary = is_boundary(v);
    for (Halfedge s = next(o); s != h; s = next(opposite(s))) set_to(opposite(s), u);

    Halfedge last = halfedge(u);
    if (!is_boundary(h)) {
        const Halfedge stays = next(h), goes = next(stays);  // u -> left, left -> v
        const Vertex left = to_vertex(stays);
        const Face f = face(h);
        replace(opposite(goes), stays);
        if (halfedge(left) == goes) set_halfedge(left, opposite(stays));
        delete_edge(edge(goes));
        delete_face(f);
        if (last == o) last = stays;
    } else {
        set_next(before_h, next(h));
        last = next(h);
    }
    if (!is_boundary(o)) {
        const Halfedge goes = next(o), stays = next(goes);  // v -> right, right -> u
        const Vertex right = to_vertex(goes);
        const Face f = face(o);
        replace(opposite(goes), stays);
        if (halfedge(right) == opposite(goes)) set_halfedge(right, stays);
        delete_edge(edge(goes));
        delete_face(f);
        if (last == o) last = opposite(stays);
    } else {
        set_next(before_o, next(o));
        if (last == o) last = next(o);
    }
    // A boundary vertex's half-edge is its boundary half-edge.
    if (v_on_boundary)
        while (!is_boundary(last)) last = next(opposite(last));
    set_halfedge(u, last);
    delete_edge(edge(h));
    delete_vertex(v);
}

// --- meshes side by side --------------------------------------------------------------------------------------------

void HalfedgeMesh::add_slots(std::size_t vertices, std::size_t edges, std::size_t faces) {
    vertices_.resize_raw(vertices_.size() + vertices);
    halfedges_.resize_raw(halfedges_.size() + 2 * edges);
    faces_.resize_raw(faces_.size() + faces);
    counts_.vertices += vertices;
    counts_.edges += edges;
    counts_.faces += faces;
}

void HalfedgeMesh::move(Vertex from, Vertex to) {
    for (const Halfedge h : outgoing(from)) set_to(opposite(h), to);
    set_halfedge(to, halfedge(from));
}

void HalfedgeMesh::copy(const HalfedgeMesh& part, const Place& place) {
    HMESH_ASSERT(part.vertex_count() == part.vertex_slots() && part.edge_count() == part.edge_slots());
    const auto number = [&](Halfedge h) { return Halfedge(place.halfedges + h.index()); };
    for (std::size_t i = 2; i < part.vertex_slots(); ++i)
        vertices_.raw(place.number(Vertex(i)).index()).halfedge = number(part.halfedge(Vertex(i)));
    for (std::size_t i = 0; i < part.face_slots(); ++i) faces_.raw(place.faces + i).halfedge = number(part.halfedge(Face(i)));
    for (std::size_t i = 0; i < part.halfedges_.size(); ++i) {
        const HalfedgeSlot& from = part.halfedges_[i];
        halfedges_.raw(place.halfedges + i) = {number(from.next), place.number(from.to),
                                               from.face.is_valid() ? Face(place.faces + from.face.index()) : Face()};
    }
}

void HalfedgeMesh::sew(Halfedge a, Halfedge b) {
    HMESH_ASSERT(is_boundary(a) && is_boundary(b) && from_vertex(a) == to_vertex(b) && to_vertex(a) == from_vertex(b));
    const Halfedge inner = opposite(b), second = next(inner), third = next(second);
    const Halfedge after_a = next(a), after_b = next(b), before_a = previous(a), before_b = previous(b);
    set_next(before_a, after_b);
    set_next(before_b, after_a);
    set_halfedge(from_vertex(a), after_b);
    set_halfedge(to_vertex(a), after_a);
    set_triangle(face(inner), a, second, third);
    delete_edge(edge(b));
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_MESH_HALFEDGE_MESH_IPP
