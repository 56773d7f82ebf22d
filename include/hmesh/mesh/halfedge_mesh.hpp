/// \file
/// HalfedgeMesh: the connectivity of a triangle mesh, compact, editable and undoable.
///
/// Half-edges come in pairs: opposite(h) = h xor 1, edge(h) = h / 2, so edges keep their identity under flips and can carry
/// data. Each half-edge stores its next half-edge, the vertex it points to and its face; boundary half-edges have no face and
/// are linked along the boundary, against the orientation of the faces. 24 bytes an edge, 4 a vertex and 4 a face; about 84
/// bytes a vertex.
///
/// The mesh is an oriented 2-manifold with boundary: every vertex has one fan of faces. The half-edge stored for a boundary
/// vertex is the boundary half-edge that leaves it. flip and split cost O(1), collapse O(valence); slots of deleted elements
/// are reused. begin/commit/rollback make any sequence of edits a transaction.
#ifndef HMESH_MESH_HALFEDGE_MESH_HPP
#define HMESH_MESH_HALFEDGE_MESH_HPP

#include <array>
#include <cstddef>
#include <cstdint>

#include "hmesh/core/array.hpp"
#include "hmesh/core/assert.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/mesh/handles.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/mesh/undo_array.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// The connectivity of an oriented triangle mesh with boundary, as half-edges. Knows no positions.
class HalfedgeMesh {
  public:
    /// The empty mesh.
    HalfedgeMesh() = default;

    /// Replaces the mesh by that of `triangles` over the vertices [0, vertex_count), all of one orientation. Refuses
    /// (invalid_argument with the index where, or image_too_large, and leaves the mesh empty): an index out of range, an edge
    /// used twice in one direction, an isolated vertex, a vertex where two fans meet, two faces back to back. O(n) for bounded
    /// valences.
    [[nodiscard]] HMESH_PATCHWISE inline Status assign(std::size_t vertex_count, const Array<Triangle>& triangles);

    // --- counts and elements: live ones, and slots including deleted ones (the size for arrays indexed by handles) ---
    [[nodiscard]] std::size_t vertex_count() const noexcept { return counts_.vertices; }     ///< number of live vertices
    [[nodiscard]] std::size_t edge_count() const noexcept { return counts_.edges; }          ///< number of live edges
    [[nodiscard]] std::size_t face_count() const noexcept { return counts_.faces; }          ///< number of live faces
    [[nodiscard]] std::size_t vertex_slots() const noexcept { return vertices_.size(); }     ///< size of an array by vertices
    [[nodiscard]] std::size_t edge_slots() const noexcept { return halfedges_.size() / 2; }  ///< size of an array by edges
    [[nodiscard]] std::size_t face_slots() const noexcept { return faces_.size(); }          ///< size of an array by faces
    /// Whether the vertex is deleted.
    [[nodiscard]] bool is_deleted(Vertex v) const noexcept { return vertices_[v.index()].deleted(); }
    /// Whether the edge is deleted.
    [[nodiscard]] bool is_deleted(Edge e) const noexcept { return halfedges_[2 * e.index()].deleted(); }
    /// Whether the face is deleted.
    [[nodiscard]] bool is_deleted(Face f) const noexcept { return faces_[f.index()].deleted(); }

    /// The live elements of one kind, see vertices(), edges() and faces().
    template <class Element>
    class Range;
    [[nodiscard]] Range<Vertex> vertices() const noexcept;  ///< live vertices in the order of their indices
    [[nodiscard]] Range<Edge> edges() const noexcept;       ///< live edges in the order of their indices
    [[nodiscard]] Range<Face> faces() const noexcept;       ///< live faces in the order of their indices

    // --- navigation ---
    /// The other half-edge of h's edge.
    [[nodiscard]] static Halfedge opposite(Halfedge h) noexcept { return Halfedge(h.index() ^ 1U); }
    /// The edge of a half-edge.
    [[nodiscard]] static Edge edge(Halfedge h) noexcept { return Edge(h.index() >> 1U); }
    /// The even half-edge of an edge; opposite() gives the other.
    [[nodiscard]] static Halfedge halfedge(Edge e) noexcept { return Halfedge(e.index() << 1U); }
    /// The half-edge after h around its face, or along the boundary.
    [[nodiscard]] Halfedge next(Halfedge h) const noexcept { return halfedges_[h.index()].next; }
    /// The vertex at the end of h.
    [[nodiscard]] Vertex to_vertex(Halfedge h) const noexcept { return halfedges_[h.index()].to; }
    /// The vertex at the beginning of h.
    [[nodiscard]] Vertex from_vertex(Halfedge h) const noexcept { return to_vertex(opposite(h)); }
    /// The face of h; invalid on the boundary.
    [[nodiscard]] Face face(Halfedge h) const noexcept { return halfedges_[h.index()].face; }
    /// A half-edge that leaves v: the boundary one if v is on the boundary.
    [[nodiscard]] Halfedge halfedge(Vertex v) const noexcept { return vertices_[v.index()].halfedge; }
    /// A half-edge of face f.
    [[nodiscard]] Halfedge halfedge(Face f) const noexcept { return faces_[f.index()].halfedge; }
    /// The half-edge before h: within a face two steps, along the boundary one turn around from_vertex(h).
    [[nodiscard]] Halfedge previous(Halfedge h) const noexcept {
        if (face(h).is_valid()) return next(next(h));
        Halfedge into = opposite(h);
        while (next(into) != h) into = opposite(next(into));
        return into;
    }
    /// Whether the half-edge has no face.
    [[nodiscard]] bool is_boundary(Halfedge h) const noexcept { return !face(h).is_valid(); }
    /// Whether the vertex is on the boundary.
    [[nodiscard]] bool is_boundary(Vertex v) const noexcept { return is_boundary(halfedge(v)); }
    /// Whether the edge is on the boundary, with one face.
    [[nodiscard]] bool is_boundary(Edge e) const noexcept {
        return is_boundary(halfedge(e)) || is_boundary(opposite(halfedge(e)));
    }
    /// The corners of a face, beginning with from_vertex(halfedge(f)), in its orientation.
    [[nodiscard]] std::array<Vertex, 3> vertices(Face f) const noexcept {
        const Halfedge h = halfedge(f);
        return {from_vertex(h), to_vertex(h), to_vertex(next(h))};
    }
    /// The live faces as triples of indices, in the order of faces(); vertices are numbered in the order of vertices(). This is
    /// what assign() takes. O(n), most of it by parallel_for.
    [[nodiscard]] HMESH_COLD Array<Triangle> triangles(const ParallelFor& parallel_for = {}) const;
    /// The half-edges that leave a vertex, see outgoing().
    class OneRing;
    /// The half-edges that leave v, each once, against the orientation of the faces; on the boundary the boundary half-edge
    /// comes first. For range-based loops.
    [[nodiscard]] OneRing outgoing(Vertex v) const noexcept;
    /// The number of edges at v.
    [[nodiscard]] int valence(Vertex v) const noexcept {
        int count = 0;
        Halfedge h = halfedge(v);
        do {
            ++count;
            h = next(opposite(h));
        } while (h != halfedge(v));
        return count;
    }
    /// The half-edge from one vertex to another; invalid if there is none.
    [[nodiscard]] Halfedge find_halfedge(Vertex from, Vertex to) const noexcept;

    // --- edits; each needs its predicate to hold ---
    /// Whether e can be flipped: it has two faces, whose far corners (not on e) are not neighbours yet.
    [[nodiscard]] bool is_flip_ok(Edge e) const noexcept {
        const Halfedge a = halfedge(e), b = opposite(a);
        return !is_boundary(a) && !is_boundary(b) && !find_halfedge(to_vertex(next(a)), to_vertex(next(b))).is_valid();
    }
    /// Turns e, for which is_flip_ok(e), against the orientation of the faces: halfedge(e) then runs from the far corner of its
    /// opposite's face to that of its own. Two flips give the same mesh with the edge reversed.
    void flip(Edge e);

    /// Puts a new vertex on e, joined to the far corners of its faces. halfedge(e) keeps its origin and then ends at the new
    /// vertex.
    Vertex split(Edge e);
    /// Puts a new vertex inside f, joined to its corners.
    Vertex split(Face f);

    /// Whether from_vertex(h) can be merged into to_vertex(h) and leave a manifold whose boundary keeps the order of its
    /// vertices: the two share no neighbours but the far corners of h's edge, and a boundary vertex moves along the boundary
    /// only.
    [[nodiscard]] bool is_collapse_ok(Halfedge h) const noexcept;
    /// Merges from_vertex(h) into to_vertex(h), for is_collapse_ok(h); from_vertex(h) and the faces of h's edge are deleted.
    /// All other edges of from_vertex(h) keep their identity, except those to the far corners.
    void collapse(Halfedge h);

    // --- meshes side by side; outside a transaction ---
    /// Where in a mesh the elements of another one are.
    struct Place {
        std::array<Vertex, 4> corners;  ///< the vertices here that its first four are
        std::size_t vertices,           ///< what is added to the index of another one of its vertices,
            halfedges,                  ///< of its half-edges
            faces;                      ///< and of its faces
        /// The vertex here that is v there.
        [[nodiscard]] Vertex number(Vertex v) const noexcept {
            return v.index() < 4 ? corners[v.index()] : Vertex(vertices + v.index());
        }
    };
    /// Makes slots for so many more vertices, edges and faces, which count as live and are to be written by move() and copy().
    HMESH_COLD inline void add_slots(std::size_t vertices, std::size_t edges, std::size_t faces);
    /// Moves a vertex to a slot that add_slots() made; its old one is to be written.
    HMESH_COLD inline void move(Vertex from, Vertex to);
    /// Copies `part`, of which nothing was ever deleted, to slots that add_slots() made, but for its first two vertices, which
    /// another part has too. Threads may copy parts to places of their own.
    HMESH_COLD inline void copy(const HalfedgeMesh& part, const Place& place);
    /// Joins two boundary half-edges between the same vertices, of faces on both sides: the edge of `b` goes, and that of `a`
    /// has both faces.
    HMESH_COLD inline void sew(Halfedge a, Halfedge b);

    // --- transactions; they nest, the inner ends first ---
    /// The beginning of a transaction, see begin().
    struct Mark;
    [[nodiscard]] Mark begin();              ///< begins a transaction: from here on changes can be undone
    void commit(const Mark& mark) noexcept;  ///< ends a transaction and keeps its changes
    void rollback(const Mark& mark);         ///< ends a transaction and undoes its changes, to the last handle

    /// Reserves memory for this number of vertices.
    void reserve(std::size_t vertices) {
        vertices_.reserve(vertices);
        halfedges_.reserve(6 * vertices);
        faces_.reserve(2 * vertices);
    }

    /// Deletes everything. Outside a transaction only; memory is kept.
    void clear() {
        HMESH_ASSERT(depth_ == 0);
        halfedges_.resize(0);
        vertices_.resize(0);
        faces_.resize(0);
        counts_ = Counts();
    }

    /// Verifies every invariant named above; invalid_argument with a sentence about the broken one and the first index where.
    /// O(n).
    [[nodiscard]] HMESH_COLD Status check() const;

  private:
    /// The half-edge of a deleted slot is the index of the slot deleted before it (free_end: none) with this flag.
    static constexpr std::uint32_t deleted_flag = 0x80000000U;
    static constexpr std::uint32_t free_end = 0x7fffffffU;
    struct Slot {
        Halfedge halfedge;
        /// Whether the slot is deleted. An unset handle has the top bit too, but a live element always has a half-edge.
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

    // The large ones are calls: a split has up to fifteen of them, which takes 6 KB of code in place.
    void set_next(Halfedge h, Halfedge n) { halfedges_.edit(h.index()).next = n; }
    void set_face(Halfedge h, Face f) { halfedges_.edit(h.index()).face = f; }
    HMESH_NEVER_INLINE void set_to(Halfedge h, Vertex v) { halfedges_.edit(h.index()).to = v; }
    void set_halfedge(Vertex v, Halfedge h) { vertices_.edit(v.index()).halfedge = h; }
    void set_halfedge(Face f, Halfedge h) { faces_.edit(f.index()).halfedge = h; }
    HMESH_NEVER_INLINE inline void set_triangle(Face f, Halfedge a, Halfedge b, Halfedge c);

    [[nodiscard]] HMESH_NEVER_INLINE inline Vertex new_vertex();
    [[nodiscard]] HMESH_NEVER_INLINE inline Halfedge new_edge();  ///< returns the even half-edge
    [[nodiscard]] HMESH_NEVER_INLINE inline Face new_face();
    void delete_vertex(Vertex v);
    HMESH_NEVER_INLINE inline void delete_edge(Edge e);
    HMESH_NEVER_INLINE inline void delete_face(Face f);
    /// Puts `stays`, an edge of a face to be deleted, in the place of `goes` in the adjacent face (or boundary).
    HMESH_NEVER_INLINE inline void replace(Halfedge goes, Halfedge stays);
    /// The corner of a triangle after corner k. Not (k + 1) % 3, which becomes a division where code is to be small.
    [[nodiscard]] static std::size_t corner_after(std::size_t k) noexcept { return k == 2 ? 0 : k + 1; }

    struct Sides;
    [[nodiscard]] HMESH_PATCHWISE inline static Sides find_sides(std::size_t vertex_count, const Array<Triangle>& triangles);
    [[nodiscard]] HMESH_PATCHWISE inline Status link_boundary();
    [[nodiscard]] HMESH_PATCHWISE inline bool do_turns_meet_all() const;
    [[nodiscard]] HMESH_COLD Status check_vertex(Vertex v) const;
    /// Whether each vertex has one fan: a turn around it meets all half-edges that leave it, as many as told, and no neighbour
    /// twice. `boundary`: of each vertex how many of them are on the boundary.
    [[nodiscard]] HMESH_COLD Status check_fans(const Array<std::uint32_t>& leaving, const Array<unsigned char>& boundary) const;

    UndoArray<HalfedgeSlot> halfedges_;
    UndoArray<Slot> vertices_, faces_;
    Counts counts_;
    int depth_ = 0;
};

/// The beginning of a transaction.
struct HalfedgeMesh::Mark {
    UndoArray<HalfedgeSlot>::Mark halfedges;  ///< notes on half-edges
    UndoArray<Slot>::Mark vertices,           ///< notes on vertices
        faces;                                ///< notes on faces
    Counts counts;                            ///< numbers of live elements
};

/// The live elements of one kind in the order of their indices: what vertices(), edges() and faces() return.
template <class Element>
class HalfedgeMesh::Range {
  public:
    Range(const HalfedgeMesh& mesh, std::size_t end) noexcept : mesh_(&mesh), end_(end) {}  ///< slots [0, end)
    /// Goes from one live element to the next.
    class Iterator {
      public:
        /// At the first live element from slot `index` on, before slot `end`.
        Iterator(const HalfedgeMesh& mesh, std::size_t index, std::size_t end) noexcept : mesh_(&mesh), index_(index), end_(end) {
            skip();
        }
        [[nodiscard]] Element operator*() const noexcept { return Element(index_); }  ///< the element
        /// To the next live element.
        Iterator& operator++() noexcept {
            ++index_;
            skip();
            return *this;
        }
        /// Whether the iterators differ.
        friend bool operator!=(const Iterator& a, const Iterator& b) noexcept { return a.index_ != b.index_; }

      private:
        void skip() noexcept {
            while (index_ < end_ && mesh_->is_deleted(Element(index_))) ++index_;
        }
        const HalfedgeMesh* mesh_;
        std::size_t index_, end_;
    };
    [[nodiscard]] Iterator begin() const noexcept { return {*mesh_, 0, end_}; }   ///< first live element
    [[nodiscard]] Iterator end() const noexcept { return {*mesh_, end_, end_}; }  ///< end of the slots

  private:
    const HalfedgeMesh* mesh_;
    std::size_t end_;
};

/// The half-edges that leave a vertex, against the orientation of the faces: what outgoing() returns.
class HalfedgeMesh::OneRing {
  public:
    /// All half-edges that leave from_vertex(first), beginning with `first`.
    OneRing(const HalfedgeMesh& mesh, Halfedge first) noexcept : mesh_(&mesh), first_(first) {}
    /// Turns around the vertex.
    class Iterator {
      public:
        /// At `first`, before the turn or after it.
        Iterator(const HalfedgeMesh& mesh, Halfedge first, bool done) noexcept
            : mesh_(&mesh), first_(first), current_(first), done_(done) {}
        [[nodiscard]] Halfedge operator*() const noexcept { return current_; }  ///< the half-edge
        /// To the next half-edge against the orientation of the faces.
        Iterator& operator++() noexcept {
            current_ = mesh_->next(opposite(current_));
            done_ = current_ == first_;
            return *this;
        }
        /// Whether one turn is complete and the other is not.
        friend bool operator!=(const Iterator& a, const Iterator& b) noexcept { return a.done_ != b.done_; }

      private:
        const HalfedgeMesh* mesh_;
        Halfedge first_, current_;
        bool done_;
    };
    [[nodiscard]] Iterator begin() const noexcept { return {*mesh_, first_, false}; }  ///< before the turn
    [[nodiscard]] Iterator end() const noexcept { return {*mesh_, first_, true}; }     ///< after the turn

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
