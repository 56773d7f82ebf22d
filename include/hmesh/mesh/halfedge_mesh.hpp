/// \file
/// HalfedgeMesh: the connectivity of a triangle mesh, compact, editable and undoable.
///
/// Half-edges come in pairs: opposite(h) = h xor 1, edge(h) = h / 2, so edges keep their identity under flips and can carry
/// data. Each half-edge stores its next, the vertex it points to and its face; boundary half-edges have no face and are
/// linked along the boundary, counter to the faces. 24 bytes an edge, 4 a vertex and 4 a face; about 84 bytes a vertex.
///
/// The mesh is an oriented 2-manifold with boundary: every vertex has one fan of faces. A boundary vertex's half-edge is the
/// boundary half-edge that leaves it. flip, split and collapse cost O(1) plus the valence for collapse; deleted slots are
/// used again. begin/commit/rollback make any sequence of edits a transaction.
#ifndef HMESH_MESH_HALFEDGE_MESH_HPP
#define HMESH_MESH_HALFEDGE_MESH_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/core/assert.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/core/undo_array.hpp"
#include "hmesh/mesh/handles.hpp"
#include "hmesh/mesh/mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

class HalfedgeMesh {
  public:
    HalfedgeMesh() = default;

    /// The mesh of `triangles` over the vertices [0, vertex_count), all turning the same way. Replaces what was there.
    /// Refuses (and leaves the mesh empty) an index out of range, an edge used twice in one direction, a vertex that is
    /// isolated or where two fans meet. Cost O(n) for bounded valences.
    [[nodiscard]] HMESH_COLD Status assign(std::size_t vertex_count, const std::vector<Triangle>& triangles);

    // --- counts and elements: live ones, and slots including deleted ones (the size for arrays indexed by handles) ---
    [[nodiscard]] std::size_t vertex_count() const noexcept { return counts_.vertices; }
    [[nodiscard]] std::size_t edge_count() const noexcept { return counts_.edges; }
    [[nodiscard]] std::size_t face_count() const noexcept { return counts_.faces; }
    [[nodiscard]] std::size_t vertex_slots() const noexcept { return vertices_.size(); }
    [[nodiscard]] std::size_t edge_slots() const noexcept { return halfedges_.size() / 2; }
    [[nodiscard]] std::size_t face_slots() const noexcept { return faces_.size(); }
    [[nodiscard]] bool is_deleted(Vertex v) const noexcept { return vertices_[v.index()].deleted(); }
    [[nodiscard]] bool is_deleted(Edge e) const noexcept { return halfedges_[2 * e.index()].deleted(); }
    [[nodiscard]] bool is_deleted(Face f) const noexcept { return faces_[f.index()].deleted(); }

    template <class Element>
    class Range;
    [[nodiscard]] Range<Vertex> vertices() const noexcept;  ///< live ones in the order of their indices, for range-based loops
    [[nodiscard]] Range<Edge> edges() const noexcept;       ///< live edges, likewise
    [[nodiscard]] Range<Face> faces() const noexcept;       ///< live faces, likewise

    // --- navigation ---
    [[nodiscard]] static Halfedge opposite(Halfedge h) noexcept { return Halfedge(h.index() ^ 1U); }
    [[nodiscard]] static Edge edge(Halfedge h) noexcept { return Edge(h.index() >> 1U); }
    [[nodiscard]] static Halfedge halfedge(Edge e) noexcept { return Halfedge(e.index() << 1U); }
    [[nodiscard]] Halfedge next(Halfedge h) const noexcept { return halfedges_[h.index()].next; }
    [[nodiscard]] Vertex to_vertex(Halfedge h) const noexcept { return halfedges_[h.index()].to; }
    [[nodiscard]] Vertex from_vertex(Halfedge h) const noexcept { return to_vertex(opposite(h)); }
    [[nodiscard]] Face face(Halfedge h) const noexcept { return halfedges_[h.index()].face; }
    [[nodiscard]] Halfedge halfedge(Vertex v) const noexcept { return vertices_[v.index()].halfedge; }  ///< leaves v
    [[nodiscard]] Halfedge halfedge(Face f) const noexcept { return faces_[f.index()].halfedge; }
    /// The half-edge before h: within a face two steps, along the boundary one turn around from_vertex(h).
    [[nodiscard]] Halfedge previous(Halfedge h) const noexcept {
        if (face(h).is_valid()) return next(next(h));
        Halfedge into = opposite(h);
        while (next(into) != h) into = opposite(next(into));
        return into;
    }
    [[nodiscard]] bool is_boundary(Halfedge h) const noexcept { return !face(h).is_valid(); }
    [[nodiscard]] bool is_boundary(Vertex v) const noexcept { return is_boundary(halfedge(v)); }
    /// Whether it has one face.
    [[nodiscard]] bool is_boundary(Edge e) const noexcept {
        return is_boundary(halfedge(e)) || is_boundary(opposite(halfedge(e)));
    }
    /// From that on which halfedge(f) begins.
    [[nodiscard]] std::array<Vertex, 3> vertices(Face f) const noexcept {
        const Halfedge h = halfedge(f);
        return {from_vertex(h), to_vertex(h), to_vertex(next(h))};
    }
    // The faces as an index list, in their order, over the vertices numbered in theirs: what assign() takes. O(n).
    [[nodiscard]] HMESH_COLD std::vector<Triangle> triangles() const;
    class OneRing;
    /// The half-edges that leave v, each once, against the orientation of the faces, the boundary one first.
    [[nodiscard]] OneRing outgoing(Vertex v) const noexcept;
    /// The number of its edges.
    [[nodiscard]] int valence(Vertex v) const noexcept {
        int count = 0;
        Halfedge h = halfedge(v);
        do {
            ++count;
            h = next(opposite(h));
        } while (h != halfedge(v));
        return count;
    }
    [[nodiscard]] Halfedge find_halfedge(Vertex from, Vertex to) const noexcept;  ///< invalid when there is none

    // --- edits; each needs its predicate to hold ---
    /// Two faces, and their far corners are not neighbours yet.
    [[nodiscard]] bool is_flip_ok(Edge e) const noexcept {
        const Halfedge a = halfedge(e), b = opposite(a);
        return !is_boundary(a) && !is_boundary(b) && !find_halfedge(to_vertex(next(a)), to_vertex(next(b))).is_valid();
    }
    /// Turns the edge against the faces' orientation: halfedge(e) then runs from the far corner of its opposite's face to
    /// that of its own. Twice gives the same mesh with the edge reversed.
    void flip(Edge e);

    /// Puts a new vertex on edge e, joined to the far corners. halfedge(e) keeps its origin and now ends at the new vertex.
    Vertex split(Edge e);
    /// Puts a new vertex inside face f, joined to its corners.
    Vertex split(Face f);

    /// Whether from_vertex(h) can be merged into to_vertex(h) and leave a manifold whose boundary keeps its vertices'
    /// order: the two share no neighbour but the far corners, and a boundary vertex goes along the boundary only.
    [[nodiscard]] bool is_collapse_ok(Halfedge h) const noexcept;
    /// Merges from_vertex(h), which is deleted with h's faces, into to_vertex(h). Edges of the removed fan that keep their
    /// identity: all but edge(h) and the two of from_vertex(h) to the far corners.
    void collapse(Halfedge h);

    // --- transactions; they nest, the inner ends first ---
    struct Mark;
    [[nodiscard]] Mark begin();              ///< from here on changes can be undone
    void commit(const Mark& mark) noexcept;  ///< keeps what was done since
    void rollback(const Mark& mark);         ///< brings all back to what it was at that mark, handles included

    /// Memory for so many vertices.
    void reserve(std::size_t vertices) {
        vertices_.reserve(vertices);
        halfedges_.reserve(6 * vertices);
        faces_.reserve(2 * vertices);
    }

    /// Outside a transaction. Memory that was reserved stays.
    void clear() {
        HMESH_ASSERT(depth_ == 0);
        halfedges_.resize(0);
        vertices_.resize(0);
        faces_.resize(0);
        counts_ = Counts();
    }

    /// Proves every invariant above; the sentence names what is broken and `got` the first index where. O(n).
    [[nodiscard]] HMESH_COLD Status check() const;

  private:
    /// A deleted slot holds, behind a flag in the top bit, the slot deleted before it (free_end: none).
    static constexpr std::uint32_t deleted_flag = 0x80000000U;
    static constexpr std::uint32_t free_end = 0x7fffffffU;
    struct Slot {
        Halfedge halfedge;
        /// An unset handle has the top bit too, but is no slot: a live element always has a half-edge.
        [[nodiscard]] bool deleted() const noexcept { return (halfedge.index() & deleted_flag) != 0; }
    };
    struct HalfedgeSlot {
        Halfedge next;
        Vertex to;
        Face face;
        [[nodiscard]] bool deleted() const noexcept { return (next.index() & deleted_flag) != 0; }
    };
    struct Counts {
        std::size_t vertices = 0, edges = 0, faces = 0;
        std::uint32_t free_vertex = free_end, free_edge = free_end, free_face = free_end;
    };

    [[nodiscard]] static Halfedge free_link(std::uint32_t link) noexcept {
        return Halfedge(static_cast<std::size_t>(link | deleted_flag));
    }
    [[nodiscard]] static std::uint32_t link_of(Halfedge h) noexcept {
        return static_cast<std::uint32_t>(h.index()) & ~deleted_flag;
    }

    void set_next(Halfedge h, Halfedge n) { halfedges_.edit(h.index()).next = n; }
    void set_face(Halfedge h, Face f) { halfedges_.edit(h.index()).face = f; }
    void set_to(Halfedge h, Vertex v) { halfedges_.edit(h.index()).to = v; }
    void set_halfedge(Vertex v, Halfedge h) { vertices_.edit(v.index()).halfedge = h; }
    void set_halfedge(Face f, Halfedge h) { faces_.edit(f.index()).halfedge = h; }
    void set_triangle(Face f, Halfedge a, Halfedge b, Halfedge c);

    [[nodiscard]] Vertex new_vertex();
    [[nodiscard]] Halfedge new_edge();  ///< the even half-edge
    [[nodiscard]] Face new_face();
    void delete_vertex(Vertex v);
    void delete_edge(Edge e);
    void delete_face(Face f);
    /// `stays`, an edge of a face that goes, takes the place of `goes` in the next face (or boundary) over.
    void replace(Halfedge goes, Halfedge stays);
    [[nodiscard]] Status check_vertex(Vertex v) const;

    UndoArray<HalfedgeSlot> halfedges_;
    UndoArray<Slot> vertices_, faces_;
    Counts counts_;
    int depth_ = 0;
};

/// Where a transaction began.
struct HalfedgeMesh::Mark {
    UndoArray<HalfedgeSlot>::Mark halfedges;
    UndoArray<Slot>::Mark vertices, faces;
    Counts counts;
};

template <class Element>  ///< what vertices(), edges() and faces() give
class HalfedgeMesh::Range {
  public:
    Range(const HalfedgeMesh& mesh, std::size_t end) noexcept : mesh_(&mesh), end_(end) {}
    class Iterator {
      public:
        Iterator(const HalfedgeMesh& mesh, std::size_t index, std::size_t end) noexcept : mesh_(&mesh), index_(index), end_(end) {
            skip();
        }
        [[nodiscard]] Element operator*() const noexcept { return Element(index_); }
        Iterator& operator++() noexcept {
            ++index_;
            skip();
            return *this;
        }
        friend bool operator!=(const Iterator& a, const Iterator& b) noexcept { return a.index_ != b.index_; }

      private:
        void skip() noexcept {
            while (index_ < end_ && mesh_->is_deleted(Element(index_))) ++index_;
        }
        const HalfedgeMesh* mesh_;
        std::size_t index_, end_;
    };
    [[nodiscard]] Iterator begin() const noexcept { return {*mesh_, 0, end_}; }
    [[nodiscard]] Iterator end() const noexcept { return {*mesh_, end_, end_}; }

  private:
    const HalfedgeMesh* mesh_;
    std::size_t end_;
};

/// What outgoing() gives.
class HalfedgeMesh::OneRing {
  public:
    OneRing(const HalfedgeMesh& mesh, Halfedge first) noexcept : mesh_(&mesh), first_(first) {}
    class Iterator {
      public:
        Iterator(const HalfedgeMesh& mesh, Halfedge first, bool done) noexcept
            : mesh_(&mesh), first_(first), current_(first), done_(done) {}
        [[nodiscard]] Halfedge operator*() const noexcept { return current_; }
        Iterator& operator++() noexcept {
            current_ = mesh_->next(opposite(current_));
            done_ = current_ == first_;
            return *this;
        }
        friend bool operator!=(const Iterator& a, const Iterator& b) noexcept { return a.done_ != b.done_; }

      private:
        const HalfedgeMesh* mesh_;
        Halfedge first_, current_;
        bool done_;
    };
    [[nodiscard]] Iterator begin() const noexcept { return {*mesh_, first_, false}; }
    [[nodiscard]] Iterator end() const noexcept { return {*mesh_, first_, true}; }

  private:
    const HalfedgeMesh* mesh_;
    Halfedge first_;
};

inline HalfedgeMesh::Range<Vertex> HalfedgeMesh::vertices() const noexcept { return {*this, vertex_slots()}; }
inline HalfedgeMesh::Range<Edge> HalfedgeMesh::edges() const noexcept { return {*this, edge_slots()}; }
inline HalfedgeMesh::Range<Face> HalfedgeMesh::faces() const noexcept { return {*this, face_slots()}; }
inline HalfedgeMesh::OneRing HalfedgeMesh::outgoing(Vertex v) const noexcept { return {*this, halfedge(v)}; }

inline Halfedge HalfedgeMesh::find_halfedge(Vertex from, Vertex to) const noexcept {
    for (const Halfedge h : outgoing(from))
        if (to_vertex(h) == to) return h;
    return {};
}

// --- transactions ---------------------------------------------------------------------------------------------------

inline HalfedgeMesh::Mark HalfedgeMesh::begin() {
    ++depth_;
    return {halfedges_.mark(), vertices_.mark(), faces_.mark(), counts_};
}

inline void HalfedgeMesh::commit(const Mark&) noexcept {
    if (--depth_ > 0) return;
    halfedges_.stop_recording();
    vertices_.stop_recording();
    faces_.stop_recording();
}

inline void HalfedgeMesh::rollback(const Mark& mark) {
    halfedges_.rollback(mark.halfedges);
    vertices_.rollback(mark.vertices);
    faces_.rollback(mark.faces);
    counts_ = mark.counts;
    commit(mark);
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#include "hmesh/mesh/halfedge_mesh.ipp"

#endif  // HMESH_MESH_HALFEDGE_MESH_HPP
