// hmesh - how a HalfedgeMesh is edited: slots for new elements, flip, split, collapse. Include halfedge_mesh.hpp.
#ifndef HMESH_MESH_HALFEDGE_EDITS_HPP
#define HMESH_MESH_HALFEDGE_EDITS_HPP

#include <cstdint>

#include "hmesh/mesh/halfedge_mesh.hpp"

namespace hmesh::kit {

inline Vertex HalfedgeMesh::new_vertex() {
    ++counts_.vertices;
    if (counts_.free_vertex == free_end) {
        vertices_.push_back({});
        return Vertex(vertices_.size() - 1);
    }
    const Vertex v(counts_.free_vertex);
    counts_.free_vertex = link_of(halfedge(v));
    return v;
}

inline Halfedge HalfedgeMesh::new_edge() {
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

inline Face HalfedgeMesh::new_face() {
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

inline void HalfedgeMesh::delete_edge(Edge e) {
    set_next(halfedge(e), free_link(counts_.free_edge));
    counts_.free_edge = static_cast<std::uint32_t>(e.index());
    --counts_.edges;
}

inline void HalfedgeMesh::delete_face(Face f) {
    set_halfedge(f, free_link(counts_.free_face));
    counts_.free_face = static_cast<std::uint32_t>(f.index());
    --counts_.faces;
}

inline void HalfedgeMesh::set_triangle(Face f, Halfedge a, Halfedge b, Halfedge c) {
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

inline void HalfedgeMesh::replace(Halfedge goes, Halfedge stays) {
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

}  // namespace hmesh::kit

#endif  // HMESH_MESH_HALFEDGE_EDITS_HPP
