/// \file
/// Point removal: removes from a Delaunay triangulation, again and again, the vertex whose removal costs least.
///
/// This is the adaptive thinning of Demaret and Iske ("Advances in digital image compression by adaptive thinning", 2004), and
/// the second half of Adams' method (2011). The hole that a vertex leaves is filled by Delaunay ears (mesh/hole_filler.hpp), and
/// colours stay. The cost is the exact rise of the energy, which follows from the moments of the hole's sides and of the new
/// edges. A heap has the costs of all vertices; those around a removed vertex are computed again.
///
/// Cost: about 1 us for each cost, 6 to 8 us for a removal. The recipe Annealed uses edit/collapse.hpp instead, which merges a
/// vertex into its best neighbour and re-optimises the surroundings: that fits better, and does not keep the mesh Delaunay.
#ifndef HMESH_METHODS_BASELINES_POINT_REMOVAL_HPP
#define HMESH_METHODS_BASELINES_POINT_REMOVAL_HPP

#include <cstddef>
#include <cstdint>

#include "hmesh/core/array.hpp"
#include "hmesh/edit/indexed_heap.hpp"
#include "hmesh/fit/image_mesh.hpp"
#include "hmesh/mesh/hole_filler.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// A mesh together with the cost of removing each of its vertices.
template <int C>
class PointRemoval {
  public:
    /// Computes the costs of all vertices, 1 us each. The mesh must outlive the object; its inner edges must be Delaunay edges,
    /// and its corners must have Mobility::corner or locked.
    explicit PointRemoval(ImageMesh<C>& mesh) : mesh_(&mesh) {
        for (const Vertex v : mesh.topology().vertices()) {
            if (!mesh.keep_going()) break;  // remove_down_to() then stops too
            rate(v);
        }
    }

    /// Removes the cheapest vertices until `count` >= 4 are left. Vertices with more than ring_capacity neighbours stay. Returns
    /// the number of vertices removed: fewer where no other vertex can be removed, or where mesh.keep_going() says stop.
    std::size_t remove_down_to(std::size_t count) {
        const std::size_t first = mesh_->vertex_count();
        while (mesh_->vertex_count() > count && !costs_.empty() && mesh_->keep_going()) {
            remove(Vertex(costs_.pop().id));
            if (mesh_->task() != nullptr)
                mesh_->task()->set_fraction(static_cast<double>(first - mesh_->vertex_count()) /
                                            static_cast<double>(first - count));
        }
        return first - mesh_->vertex_count();
    }

    /// The rise of the energy if v were removed; can_go(v) must hold.
    [[nodiscard]] double cost(Vertex v) const noexcept { return costs_.key(static_cast<std::uint32_t>(v.index())); }
    /// Whether v may be removed: not a corner, not locked, at most ring_capacity neighbours.
    [[nodiscard]] bool can_go(Vertex v) const noexcept { return costs_.contains(static_cast<std::uint32_t>(v.index())); }

  private:
    /// Enters the cost of v into the heap or, where v must stay, takes v out of the heap.
    void rate(Vertex v) {
        const auto id = static_cast<std::uint32_t>(v.index());
        const Mobility mobility = mesh_->vertex(v).mobility;
        const bool can_go =
            mobility != Mobility::corner && mobility != Mobility::locked && mesh_->topology().valence(v) <= ring_capacity;
        if (can_go) costs_.push(id, fill(v));
        else if (costs_.contains(id)) costs_.erase(id);
    }

    /// Finds the ears that would fill the hole of v, the moments of their diagonals, and their energies; the mesh stays as it
    /// is. Returns the cost of removing v.
    double fill(Vertex v) {
        mesh_->gather(v, ring_, spokes_);
        ears_ = &filler_.fill(
            ring_.size, [&](int i) { return ring_.neighbor[i]->position; }, ring_.open);
        double energy = -mesh_->energy(ring_);
        for (int i = ring_.first_face(); i < ring_.size; ++i) sides_[i] = ring_.link[i];
        if (ring_.open) {  // v lies on a straight line between its first and last neighbours
            sides_[0] = spokes_.spoke[ring_.size - 1];
            sides_[0] -= spokes_.spoke[0];
        }
        // sides_[i] runs from neighbour i to the one before it among those not yet cut off by an ear.
        const std::size_t count = ears_->size();
        for (std::size_t k = 0; k < count; ++k) {
            const Ear& ear = (*ears_)[k];
            Moments<C> m = sides_[ear.after];
            m += sides_[ear.tip];
            if (k + 1 < count) {
                edge_moments(mesh_->table(), ring_.neighbor[ear.after]->position, ring_.neighbor[ear.before]->position,
                             diagonals_[k]);
                m -= diagonals_[k];
                sides_[ear.after] = diagonals_[k];
            } else {
                m += sides_[ear.before];
            }
            energies_[k] = face_energy(m, *ring_.neighbor[ear.after], *ring_.neighbor[ear.tip], *ring_.neighbor[ear.before]);
            energy += energies_[k];
        }
        return energy;
    }

    /// Removes v, and computes the costs around it again.
    void remove(Vertex v) {
        const HalfedgeMesh& topology = mesh_->topology();
        (void)fill(v);
        around_.clear();
        for (int i = 0; i < ring_.size; ++i) around_.push_back(topology.to_vertex(ring_.halfedge[i]));
        // The spoke to an ear's tip flips into the ear's diagonal. In between, faces at v may have no area: they are given no
        // energy, and the last of them gets its true one from the collapse.
        bool is_left[ring_capacity];
        for (int i = 0; i < ring_.size; ++i) is_left[i] = true;
        for (std::size_t k = 0; k + 1 < ears_->size(); ++k) {
            const int tip = (*ears_)[k].tip;
            const Halfedge spoke = ring_.halfedge[tip];
            is_left[tip] = false;
            const bool is_even = (spoke.index() & 1U) == 0;
            if (!is_even) diagonals_[k] *= -1.0;
            mesh_->flip(HalfedgeMesh::edge(spoke), diagonals_[k], is_even ? 0 : energies_[k], is_even ? energies_[k] : 0);
        }
        int into = 0;  // a border vertex collapses along the border
        while (!is_left[into]) ++into;
        mesh_->collapse(ring_.halfedge[into]);
        for (const Vertex u : around_) rate(u);
    }

    ImageMesh<C>* mesh_;
    IndexedHeap costs_;
    HoleFiller filler_;
    const Array<Ear>* ears_ = nullptr;  ///< those of the last fill()
    Ring<C> ring_;
    Spokes<C> spokes_;
    Moments<C> sides_[ring_capacity], diagonals_[ring_capacity];
    double energies_[ring_capacity] = {};
    Array<Vertex> around_;
};

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_BASELINES_POINT_REMOVAL_HPP
