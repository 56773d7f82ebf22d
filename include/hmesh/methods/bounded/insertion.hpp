/// \file
/// Greedy insertion: the sample that the mesh is farthest off becomes a vertex, until none is off by more than the limit.
///
/// M. Garland and P. Heckbert, "Fast polygonal approximation of terrains and height fields", 1995: the mesh stays Delaunay within
/// its border, heights are samples, and each face keeps its worst sample. Edges of the border are never split: they are within
/// the limit from the start (methods/bounded/side.hpp). Ends for every limit >= 0, since a sample that is a vertex is not off.
/// Cost: some 1.5 us an insertion, and 0.3 ns for each sample of a changed face: O(n log n) in all.
#ifndef HMESH_METHODS_BOUNDED_INSERTION_HPP
#define HMESH_METHODS_BOUNDED_INSERTION_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "hmesh/core/array.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/mesh/geometry.hpp"
#include "hmesh/mesh/halfedge_mesh.hpp"
#include "hmesh/methods/bounded/bounded_mesh.hpp"
#include "hmesh/methods/bounded/face_error.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// Inserts samples into a mesh until all its faces are within mesh.limit. Returns whether it came so far: false where
/// mesh.keep_going() said stop.
class GreedyInsertion {
  public:
    /// Works on this mesh, which must outlive the insertion.
    explicit GreedyInsertion(BoundedMesh& mesh) : mesh_(&mesh) {}

    /// Inserts until all faces are within the limit. False: stopped before.
    HMESH_COLD bool run() {
        for (const Face f : mesh_->topology.faces()) scan(f);
        while (!heap_.empty()) {
            std::pop_heap(heap_.begin(), heap_.end());
            const Entry entry = heap_.back();
            heap_.pop_back();
            if (entry.error != worst_[entry.face].error) continue;  // scanned anew since
            if (!mesh_->keep_going()) return false;
            insert(Face(entry.face));
        }
        return true;
    }

  private:
    struct Entry {
        double error;
        std::uint32_t face;
        friend bool operator<(const Entry& a, const Entry& b) noexcept {
            return a.error != b.error ? a.error < b.error : a.face > b.face;
        }
    };

    void scan(Face f) {
        const auto v = mesh_->topology.vertices(f);
        if (f.index() >= worst_.size()) worst_.resize(std::max(f.index() + 1, 2 * worst_.size()));
        WorstSample& worst = worst_[f.index()];
        worst = worst_sample(*mesh_->field, mesh_->corner(v[0]), mesh_->corner(v[1]), mesh_->corner(v[2]));
        if (!(worst.error > mesh_->limit)) return;
        heap_.push_back({worst.error, static_cast<std::uint32_t>(f.index())});
        std::push_heap(heap_.begin(), heap_.end());
    }

    void insert(Face f) {
        HalfedgeMesh& topology = mesh_->topology;
        const HeightField& field = *mesh_->field;
        const WorstSample worst = worst_[f.index()];
        worst_[f.index()].error = 0;
        BoundedVertex added;
        added.freedom = can_lift | can_leave | can_slide_x | can_slide_y;
        added.corner.position = {worst.i + field.offset(), worst.j + field.offset()};
        for (int c = 0; c < field.channels; ++c) added.corner.heights[c] = field.row(c, worst.j)[worst.i];
        const Point p = added.corner.position;
        Halfedge on = topology.halfedge(f);
        Halfedge edge;
        for (int k = 0; k < 3; ++k, on = topology.next(on)) {
            const Vertex from = topology.from_vertex(on);
            if (mesh_->position(from) == p) {  // a vertex that is no sample's height, as on a side of squares: let it be one
                mesh_->vertices.edit(from.index()).corner = added.corner;
                rescan(from);
                return;
            }
            if (orient2d(mesh_->position(from), mesh_->position(topology.to_vertex(on)), p) == 0) edge = on;
        }
        const bool on_border = edge.is_valid() && topology.is_boundary(HalfedgeMesh::opposite(edge));
        if (on_border) added.freedom = static_cast<std::uint8_t>(mesh_->vertices[topology.from_vertex(edge).index()].freedom);
        const Vertex v = edge.is_valid() ? topology.split(HalfedgeMesh::edge(edge)) : topology.split(f);
        mesh_->vertices.push_back(added);
        mesh_->changed.push_back(mesh_->clock);
        legalize(v);
        rescan(v);
    }

    void rescan(Vertex v) {
        for (const Halfedge h : mesh_->topology.outgoing(v))
            if (!mesh_->topology.is_boundary(h)) scan(mesh_->topology.face(h));
    }

    /// Flips edges around a new vertex until the circumcircles of its faces are empty.
    void legalize(Vertex v) {
        HalfedgeMesh& topology = mesh_->topology;
        const Point p = mesh_->position(v);
        stack_.clear();
        for (const Halfedge h : topology.outgoing(v))
            if (!topology.is_boundary(h)) stack_.push_back(topology.next(h));
        while (!stack_.empty()) {
            const Halfedge h = stack_.back(), o = HalfedgeMesh::opposite(h);
            stack_.pop_back();
            if (topology.is_boundary(o)) continue;
            const Halfedge left = topology.next(o), right = topology.next(left);
            const Point a = mesh_->position(topology.to_vertex(o)), b = mesh_->position(topology.to_vertex(h));
            if (in_circle(a, b, p, mesh_->position(topology.to_vertex(left))) <= 0) continue;
            topology.flip(HalfedgeMesh::edge(h));
            stack_.push_back(left);
            stack_.push_back(right);
        }
    }

    BoundedMesh* mesh_;
    Array<WorstSample> worst_;  ///< by face slot
    Array<Entry> heap_;
    Array<Halfedge> stack_;
};

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_BOUNDED_INSERTION_HPP
