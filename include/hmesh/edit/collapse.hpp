/// \file
/// Collapse: remove the vertices whose loss raises the energy least.
///
/// A vertex is removed by merging it into the neighbour for which the energy rises least, all other vertices held; this exact
/// rise is the cost of the collapse. remove_batch() removes the cheapest vertices, no two of them adjacent, and re-optimises
/// the ring of each. Inserting too many vertices and then removing the surplus is the best bargain in meshing (+2 dB for 0.1 s
/// on Lena, 1 %).
///
/// Cost: finding the cheapest collapse of a vertex takes up to valence^2 face energies, with early exit about 1 us.
#ifndef HMESH_EDIT_COLLAPSE_HPP
#define HMESH_EDIT_COLLAPSE_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include "hmesh/core/array.hpp"
#include "hmesh/core/coded_order.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/edit/move.hpp"
#include "hmesh/edit/relax.hpp"
#include "hmesh/fit/image_mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// The cheapest collapse of a vertex: along which half-edge, and what it costs.
struct CollapseCandidate {
    Halfedge halfedge;  ///< from the vertex to the neighbour that it is merged into; invalid: the vertex cannot be removed
    double cost = std::numeric_limits<double>::max();  ///< rise of the energy; may be negative
};

namespace detail {

/// The energy of the faces that fill a ring once its centre is merged into neighbour j. The largest double as soon as the energy
/// reaches `bound`, or if a face would be smaller than limits().min_double_area.
template <int C>
[[nodiscard]] double filled_energy(const ImageMesh<C>& mesh, const Ring<C>& ring, int j, double bound) {
    constexpr double never = std::numeric_limits<double>::max();
    const VertexState<C>& u = *ring.neighbor[j];
    const double min_area = mesh.limits().min_double_area;
    // Faces i (neighbours i, i - 1) that do not have j as a corner; an open ring has no face 0.
    for (int i = ring.first_face(); i < ring.size; ++i)
        if (i != j && ring.before(i) != j &&
            !(orient2d(u.position, ring.neighbor[i]->position, ring.neighbor[ring.before(i)]->position) >= min_area))
            return never;
    double energy = 0;
    // Once around the ring from neighbour j + 1, whose edge to j is the link of face j + 1; each edge from u is walked once.
    Moments<C> spoke = Moments<C>::zero();
    bool known = false;  // whether `spoke` holds the moments from u to neighbour i - 1
    for (int step = 1; step < ring.size; ++step) {
        const int i = j + step < ring.size ? j + step : j + step - ring.size, before = ring.before(i);
        if (ring.open && i == 0) continue;
        if (before == j) {  // face (v, i, j) vanishes; its far side from i to j is an edge of u
            spoke = ring.link[i] * -1.0;
            known = true;
            continue;
        }
        if (!known) edge_moments(mesh.table(), u.position, ring.neighbor[before]->position, spoke);
        Moments<C> m = ring.link[i];
        m -= spoke;
        if (ring.before(j) == i && !(ring.open && j == 0)) spoke = ring.link[j];  // the last face: from j to i
        else edge_moments(mesh.table(), u.position, ring.neighbor[i]->position, spoke);
        known = true;
        m += spoke;
        energy += face_energy(m, u, *ring.neighbor[i], *ring.neighbor[before]);
        if (!(energy < bound)) return never;
    }
    return energy;
}

}  // namespace detail

/// The cheapest collapse of v. None (an invalid half-edge) for corners and locked vertices, and where every collapse would break
/// the topology, a valence limit or limits().min_double_area. Vertices on the border or on a seam collapse along it only.
/// `scratch` is overwritten. O(valence^2), about 1 us.
template <int C>
[[nodiscard]] CollapseCandidate cheapest_collapse(const ImageMesh<C>& mesh, RingScratch<C>& scratch, Vertex v) {
    const HalfedgeMesh& topology = mesh.topology();
    CollapseCandidate best;
    const Mobility mobility = mesh.vertex(v).mobility;
    if (mobility == Mobility::corner || mobility == Mobility::locked) return best;
    Ring<C>& ring = scratch.ring;
    mesh.gather(v, ring, scratch.spokes);
    const double before = mesh.energy(ring);
    double lowest = std::numeric_limits<double>::max();
    for (int j = 0; j < ring.size; ++j) {
        if (ring.open && j != 0 && j != ring.size - 1) continue;  // a border vertex collapses along the border
        if (!ring.open && mobility != Mobility::free && !mesh.is_on_seam(HalfedgeMesh::edge(ring.halfedge[j]))) continue;
        const double energy = detail::filled_energy(mesh, ring, j, lowest);
        if (!(energy < lowest)) continue;
        // The merged vertex has the neighbours of both, less the two themselves and the far corners that both had.
        const int shared = ring.open ? 3 : 4;
        if (topology.valence(topology.to_vertex(ring.halfedge[j])) + ring.size - shared > ring.neighbor[j]->valence_limit ||
            !topology.is_collapse_ok(ring.halfedge[j]))
            continue;
        lowest = energy;
        best = {ring.halfedge[j], energy - before};
    }
    return best;
}

/// A vertex that may be removed, and the cost of its cheapest collapse.
struct Removal {
    double cost;          ///< an energy; may be negative
    std::uint32_t place;  ///< of the vertex in the list that it was chosen from
    Vertex vertex;        ///< which
};

/// The first `count` of these removals, or all, by their places.
[[nodiscard]] HMESH_COLD inline Array<Removal> in_place_order(const Array<Removal>& removals, std::size_t count) {
    return in_order(removals, sorted_numbers(std::min(count, removals.size()),
                                             [&](std::uint32_t k) { return std::uint64_t{removals[k].place}; }));
}

/// Those of `vertices` that are cheapest to remove, at most `count` and none of them in the ring of another, the cheapest first.
/// Some 1 us for each vertex.
template <int C>
[[nodiscard]] HMESH_COLD Array<Removal> cheapest_removals(const ImageMesh<C>& mesh, const Array<Vertex>& vertices,
                                                          std::size_t count) {
    const HalfedgeMesh& topology = mesh.topology();
    Array<Removal> all, chosen;
    all.reserve(vertices.size());
    RingScratch<C> scratch;
    for (std::size_t k = 0; k < vertices.size() && mesh.keep_going(); ++k) {
        const CollapseCandidate candidate = cheapest_collapse(mesh, scratch, vertices[k]);
        if (candidate.halfedge.is_valid()) all.push_back({candidate.cost, static_cast<std::uint32_t>(k), vertices[k]});
    }
    Array<unsigned char> touched(topology.vertex_slots(), 0);
    for (const Coded& at : sorted_numbers(all.size(), [&](std::uint32_t k) { return code_of(all[k].cost); })) {
        if (chosen.size() >= count) break;
        const Removal& removal = all[at.number];
        if (touched[removal.vertex.index()] != 0) continue;
        for (const Halfedge h : topology.outgoing(removal.vertex)) touched[topology.to_vertex(h).index()] = 1;
        chosen.push_back(removal);
    }
    return chosen;
}

/// Removes the first `count` of the vertices that cheapest_removals() has chosen, with the mesh as it was then, in the order of
/// their places, which takes less time where that is a spatial order, and re-optimises the ring of each with relax(). Vertices of
/// these rings become dirty. Where some cannot be removed any more, because they stand too close to others that were, the next
/// ones of the list are. Returns the number of vertices removed, which is less than `count` where the list ends before, or where
/// mesh.keep_going() says stop.
template <int C>
std::size_t remove_batch(ImageMesh<C>& mesh, const Array<Removal>& removals, std::size_t count, const Relaxation& relaxation) {
    const HalfedgeMesh& topology = mesh.topology();
    RingScratch<C> scratch;
    Array<Vertex> ring;
    std::size_t removed = 0;
    const Array<Removal> some = in_place_order(removals, count);
    for (std::size_t k = 0; removed < count && k < removals.size() && mesh.keep_going(); ++k) {
        const Vertex v = k < some.size() ? some[k].vertex : removals[k].vertex;
        // Flips around earlier removals may have changed the ring: find the cheapest collapse again.
        const CollapseCandidate now = cheapest_collapse(mesh, scratch, v);
        if (!now.halfedge.is_valid()) continue;
        ring.clear();
        for (const Halfedge h : topology.outgoing(v)) ring.push_back(topology.to_vertex(h));
        mesh.collapse(now.halfedge);
        relax(mesh, ring, relaxation);
        for (const Vertex u : ring) mesh.set_dirty(u, true);
        ++removed;
    }
    return removed;
}

/// Removes up to `count` vertices, those that are cheapest to remove, no two of them neighbours: one in the ring of another stays
/// for the next batch. As above.
template <int C>
std::size_t remove_batch(ImageMesh<C>& mesh, std::size_t count, const Relaxation& relaxation) {
    return remove_batch(mesh, cheapest_removals(mesh, spatial_vertices(mesh), count), count, relaxation);
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_EDIT_COLLAPSE_HPP
