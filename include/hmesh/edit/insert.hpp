/// \file
/// Insertion: add vertices where one more lowers the energy most.
///
/// A candidate splits an edge at its midpoint or a face at its centroid. Its gain is the exact decrease of the energy, the new
/// vertex having the best colour there (and, on request, one Gauss-Newton step), all other vertices held. Inserting a batch of
/// the best candidates that have no face in common, and optimising between batches, is nearly as good as inserting one at a
/// time, and far faster.
///
/// Cost: 3 or 4 short edge walks a candidate, about 0.2 us.
#ifndef HMESH_EDIT_INSERT_HPP
#define HMESH_EDIT_INSERT_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "hmesh/core/array.hpp"
#include "hmesh/core/coded_order.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/edit/flip.hpp"
#include "hmesh/edit/move.hpp"
#include "hmesh/fit/image_mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// A vertex that could be inserted, and what it would gain; valid until the mesh changes.
template <int C>
struct InsertionCandidate {
    Edge edge;             ///< the edge to split; invalid: split `face`
    Face face;             ///< the face to split where `edge` is invalid
    RingCenter<C> center;  ///< the new vertex, and the energy of the faces around it
    double gain = 0;       ///< decrease of the mesh's energy
    bool fits = false;     ///< whether all new faces have at least limits().min_double_area; else there is no gain
};

/// Options of insert_batch() and best_sites(): which candidates are considered, and how closely.
struct InsertionOptions {
    bool faces = false;     ///< candidates are centroids of faces too, not only midpoints of edges
    bool may_move = false;  ///< candidates take one Gauss-Newton step before their gain is read
};

namespace detail {

/// Completes a candidate: position, colour, gain. `scratch` holds the ring and the spokes of candidate.center, `before` is the
/// energy of the faces that would be split.
template <int C>
void judge_candidate(const ImageMesh<C>& mesh, RingScratch<C>& scratch, Mobility mobility, bool may_move, double wanted,
                     double before, InsertionCandidate<C>& candidate) {
    if (optimize_center(mesh, scratch, mobility, 0, may_move, candidate.center, before - wanted) == RingOutcome::degenerate)
        return;
    candidate.gain = before - candidate.center.energy;
    candidate.fits = true;
}

}  // namespace detail

/// A gain that every candidate reaches.
inline constexpr double any_gain = std::numeric_limits<double>::lowest();

/// The candidate at the midpoint of e, with its best colour and, where `may_move`, one Gauss-Newton step further, unless that is
/// not expected to bring the gain above `wanted`, an energy. Does not fit where e is on the rim of a patch. `scratch` is
/// overwritten. About 0.2 us.
template <int C>
[[nodiscard]] InsertionCandidate<C> edge_candidate(const ImageMesh<C>& mesh, RingScratch<C>& scratch, Edge e, bool may_move,
                                                   double wanted = any_gain) {
    const HalfedgeMesh& topology = mesh.topology();
    InsertionCandidate<C> candidate;
    candidate.edge = e;
    Halfedge a = HalfedgeMesh::halfedge(e);
    if (topology.is_boundary(a)) a = HalfedgeMesh::opposite(a);
    const Halfedge b = HalfedgeMesh::opposite(a), a1 = topology.next(a), a2 = topology.next(a1);
    const VertexState<C>&v0 = mesh.vertex(topology.to_vertex(b)), &v1 = mesh.vertex(topology.to_vertex(a));
    Ring<C>& ring = scratch.ring;
    double before = mesh.energy(topology.face(a));
    // Neighbours around the midpoint, against the orientation of faces: v0, v2, v1, v3.
    ring.open = topology.is_boundary(b);
    ring.size = ring.open ? 3 : 4;
    ring.neighbor[0] = &v0;
    ring.neighbor[1] = &mesh.vertex(topology.to_vertex(a1));
    ring.neighbor[2] = &v1;
    mesh.moments(a2, ring.link[1]);
    mesh.moments(a1, ring.link[2]);
    if (!ring.open) {
        const Halfedge b1 = topology.next(b), b2 = topology.next(b1);
        ring.neighbor[3] = &mesh.vertex(topology.to_vertex(b1));
        mesh.moments(b2, ring.link[3]);
        mesh.moments(b1, ring.link[0]);
        before += mesh.energy(topology.face(b));
    }
    const Mobility mobility = mesh.edge_mobility(e);
    if (mobility == Mobility::locked) return candidate;
    candidate.center.position = mesh.clamp(midpoint(v0.position, v1.position), mobility);
    candidate.center.color = 0.5 * (v0.color + v1.color);
    const Point center = candidate.center.position;
    if (!ring.accepts(center, mesh.limits().min_double_area)) return candidate;
    // The moments of the edge's halves add up to those of the edge: only one half is walked.
    for (int i = 0; i < ring.size; ++i)
        if (i != 2) edge_moments(mesh.table(), center, ring.neighbor[i]->position, scratch.spokes.spoke[i]);
    mesh.moments(a, scratch.spokes.spoke[2]);
    scratch.spokes.spoke[2] += scratch.spokes.spoke[0];
    detail::judge_candidate(mesh, scratch, mobility, may_move, wanted, before, candidate);
    return candidate;
}

/// The candidate at the centroid of f; otherwise as edge_candidate().
template <int C>
[[nodiscard]] InsertionCandidate<C> face_candidate(const ImageMesh<C>& mesh, RingScratch<C>& scratch, Face f, bool may_move,
                                                   double wanted = any_gain) {
    const HalfedgeMesh& topology = mesh.topology();
    InsertionCandidate<C> candidate;
    candidate.face = f;
    Ring<C>& ring = scratch.ring;
    ring.open = false;
    ring.size = 3;
    // Neighbours around the centroid, against the orientation: neighbour i - 1 follows neighbour i along the face's sides.
    Halfedge h = topology.halfedge(f);
    for (int i = 2; i >= 0; --i, h = topology.next(h)) {
        ring.neighbor[i] = &mesh.vertex(topology.from_vertex(h));
        mesh.moments(h, ring.link[i]);
    }
    const VertexState<C>&v0 = *ring.neighbor[0], &v1 = *ring.neighbor[1], &v2 = *ring.neighbor[2];
    candidate.center.position = mesh.clamp(centroid(v0.position, v1.position, v2.position), Mobility::free);
    candidate.center.color = (1.0 / 3) * (v0.color + v1.color + v2.color);
    if (!ring.accepts(candidate.center.position, mesh.limits().min_double_area)) return candidate;
    walk_spokes(mesh.table(), ring, candidate.center.position, scratch.spokes);
    detail::judge_candidate(mesh, scratch, Mobility::free, may_move, wanted, mesh.energy(f), candidate);
    return candidate;
}

/// Inserts a candidate that fits and was evaluated for the mesh as it is, by splitting its edge or face. Returns the new vertex.
template <int C>
Vertex insert(ImageMesh<C>& mesh, const InsertionCandidate<C>& candidate) {
    return candidate.edge.is_valid() ? mesh.split(candidate.edge, candidate.center.position, candidate.center.color)
                                     : mesh.split(candidate.face, candidate.center.position, candidate.center.color);
}

/// Whether the corners whose valence the candidate would raise may all have one more edge.
template <int C>
[[nodiscard]] bool can_gain_edge(const ImageMesh<C>& mesh, const InsertionCandidate<C>& candidate) {
    const HalfedgeMesh& topology = mesh.topology();
    const auto full = [&](Vertex v) { return !mesh.can_gain_edge(v); };
    if (!candidate.edge.is_valid()) {
        for (const Vertex v : topology.vertices(candidate.face))
            if (full(v)) return false;
        return true;
    }
    for (const Halfedge h :
         {HalfedgeMesh::halfedge(candidate.edge), HalfedgeMesh::opposite(HalfedgeMesh::halfedge(candidate.edge))})
        if (!topology.is_boundary(h) && full(topology.to_vertex(topology.next(h)))) return false;
    return true;
}

/// A place for a new vertex, an edge or a face, in 4 bytes.
class InsertionSite {
  public:
    InsertionSite() noexcept = default;
    /// The midpoint of an edge.
    explicit InsertionSite(Edge e) noexcept : code_(static_cast<std::uint32_t>(2 * e.index())) {}
    /// The centroid of a face.
    explicit InsertionSite(Face f) noexcept : code_(static_cast<std::uint32_t>(2 * f.index() + 1)) {}
    /// Whether the site is an edge; else it is a face.
    [[nodiscard]] bool is_edge() const noexcept { return (code_ & 1U) == 0; }
    /// The edge, where is_edge().
    [[nodiscard]] Edge edge() const noexcept { return Edge(code_ >> 1U); }
    /// The face, where not is_edge().
    [[nodiscard]] Face face() const noexcept { return Face(code_ >> 1U); }

  private:
    std::uint32_t code_ = 0;  ///< 2 * index of an edge, or 2 * index of a face + 1
};

/// The candidate at a site: edge_candidate() or face_candidate(). `scratch` is overwritten.
template <int C>
[[nodiscard]] InsertionCandidate<C> candidate_at(const ImageMesh<C>& mesh, RingScratch<C>& scratch, InsertionSite site,
                                                 bool may_move, double wanted = any_gain) {
    return site.is_edge() ? edge_candidate(mesh, scratch, site.edge(), may_move, wanted)
                          : face_candidate(mesh, scratch, site.face(), may_move, wanted);
}

/// An upper bound on the gain of a vertex at the site: the energy of the one or two faces that it splits.
template <int C>
[[nodiscard]] double max_gain(const ImageMesh<C>& mesh, InsertionSite site) {
    if (!site.is_edge()) return mesh.energy(site.face());
    double sum = 0;
    const Halfedge h = HalfedgeMesh::halfedge(site.edge());
    for (const Halfedge s : {h, HalfedgeMesh::opposite(h)})
        if (!mesh.topology().is_boundary(s)) sum += mesh.energy(mesh.topology().face(s));
    return sum;
}

/// The sites of a mesh in spatial order: each edge once and, where `faces`, each face.
template <int C>
[[nodiscard]] Array<InsertionSite> insertion_sites(const ImageMesh<C>& mesh, bool faces) {
    const HalfedgeMesh& topology = mesh.topology();
    Array<InsertionSite> sites;
    sites.reserve(topology.edge_count() + (faces ? topology.face_count() : 0));
    for (const Face f : spatial_faces(mesh)) {
        for_each_edge(topology, f, [&](Edge e) {
            const InsertionSite site(e);
            sites.push_back(site);
        });
        const InsertionSite center(f);
        if (faces) sites.push_back(center);
    }
    return sites;
}

namespace detail {

/// The numbers of the largest of n gains > 0, by falling gain, ties by number: at most 4 * count, since about half of a list of
/// sites touch a better one. A gain below 0 never counts. Those with the largest bounds are evaluated first; their gains then
/// tell up to which bound the others cannot get into the list, and these are not evaluated. 36 bytes for each of the n.
[[nodiscard]] HMESH_COLD inline Array<std::uint32_t> largest_gains(std::size_t n, std::size_t count,
                                                                   FunctionRef<float(std::size_t)> bound,
                                                                   FunctionRef<float(std::size_t)> gain) {
    const std::size_t wanted = 2 * count;
    Array<float> gains(n, 0.0F);
    const auto falling = [n](FunctionRef<float(std::size_t)> value) {
        return sorted_numbers(n, [&](std::uint32_t k) { return code_of(-static_cast<double>(std::max(value(k), 0.0F))); });
    };
    const auto gain_of = [&](std::size_t k) { return gains[k]; };
    const auto evaluate = [&](float above, float up_to) {
        for (std::size_t k = 0; k < n; ++k) {
            const float b = bound(k);
            if (b > above && b <= up_to) gains[k] = gain(k);
        }
    };
    const float first_cut = wanted < n ? std::max(bound(falling(bound)[wanted].number), 0.0F) : 0.0F;
    evaluate(first_cut, std::numeric_limits<float>::max());
    evaluate(wanted < n ? std::max(gains[falling(gain_of)[wanted].number], 0.0F) : 0.0F, first_cut);
    Array<std::uint32_t> best;
    for (const Coded& at : falling(gain_of))
        if (gains[at.number] > 0 && best.size() < 2 * wanted) best.push_back(at.number);
    return best;
}

}  // namespace detail

/// The best sites for `count` new vertices, by falling gain, ties in spatial order: up to 4 * count. max_gain() spares most sites
/// their evaluation. 40 bytes a site.
template <int C>
[[nodiscard]] HMESH_PATCHWISE Array<InsertionSite> best_sites(const ImageMesh<C>& mesh, std::size_t count,
                                                              const InsertionOptions& options) {
    const Array<InsertionSite> sites = insertion_sites(mesh, options.faces);
    const double scale = mesh.energy() > 0 ? 1 / mesh.mean_energy() : 0;  // keeps floats in range, whatever the unit of samples
    RingScratch<C> scratch;
    const auto bound = [&](std::size_t k) { return static_cast<float>(scale * max_gain(mesh, sites[k])); };
    const auto gain = [&](std::size_t k) {
        if (!mesh.keep_going()) return -1.0F;
        const auto candidate = candidate_at(mesh, scratch, sites[k], options.may_move);
        return candidate.fits ? static_cast<float>(scale * candidate.gain) : -1.0F;
    };
    Array<InsertionSite> best;
    for (const std::uint32_t k : detail::largest_gains(sites.size(), count, bound, gain)) best.push_back(sites[k]);
    return best;
}

/// Inserts up to `count` vertices at the best sites that have no face in common, then around each new vertex tries to flip the
/// outer edges of its faces and visits the vertex. The rings of new vertices become dirty. Returns the number of vertices
/// inserted, which is 0 where no candidate lowers the energy; it may be less than `count` also because
/// mesh.keep_going() says stop.
template <int C>
HMESH_PATCHWISE std::size_t insert_batch(ImageMesh<C>& mesh, std::size_t count, const InsertionOptions& options) {
    const HalfedgeMesh& topology = mesh.topology();
    const Array<InsertionSite> sites = best_sites(mesh, count, options);
    Array<unsigned char> touched(topology.face_slots() + 2 * count, 0);
    Array<Vertex> inserted;
    inserted.reserve(count);
    RingScratch<C> scratch;
    for (const InsertionSite site : sites) {
        if (inserted.size() >= count || !mesh.keep_going()) break;
        bool free = true;
        if (site.is_edge()) {
            const Halfedge h = HalfedgeMesh::halfedge(site.edge());
            for (const Halfedge s : {h, HalfedgeMesh::opposite(h)})
                if (!topology.is_boundary(s) && touched[topology.face(s).index()] != 0) free = false;
        } else {
            free = touched[site.face().index()] == 0;
        }
        if (!free) continue;
        const InsertionCandidate<C> candidate = candidate_at(mesh, scratch, site, options.may_move);
        if (!can_gain_edge(mesh, candidate)) continue;
        const Vertex v = insert(mesh, candidate);
        for (const Halfedge h : topology.outgoing(v))
            if (!topology.is_boundary(h)) touched[topology.face(h).index()] = 1;
        mesh.set_ring_dirty(v);
        inserted.push_back(v);
    }
    for (const Vertex v : inserted) {
        if (!mesh.keep_going()) break;
        Edge outer[ring_capacity];
        int size = 0;
        for (const Halfedge h : topology.outgoing(v))
            if (!topology.is_boundary(h)) outer[size++] = HalfedgeMesh::edge(topology.next(h));
        for (int i = 0; i < size; ++i) improve_edge(mesh, outer[i], 0);
        improve_vertex(mesh, v, 0);
    }
    return inserted.size();
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_EDIT_INSERT_HPP
