/// \file
/// Flips: replace an edge by the other diagonal of its two faces where that fits the picture better.
///
/// A flip is judged with positions and colours held: one edge walk and two face energies. It is kept if the energy falls by more
/// than a tolerance, so the energy decreases strictly and the stack of edges runs empty. 26-44 % of the edges of a fitted mesh
/// are diagonals of quadrilaterals that are not convex and cannot flip; the test for minimum area covers these.
#ifndef HMESH_EDIT_FLIP_HPP
#define HMESH_EDIT_FLIP_HPP

#include <algorithm>
#include <cstddef>

#include "hmesh/core/array.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/edit/move.hpp"
#include "hmesh/fit/image_mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// What the flip of an edge e would lead to; valid until the mesh changes.
template <int C>
struct FlipTrial {
    Moments<C> moments;   ///< of the new edge, along halfedge(e) after the flip
    double own = 0;       ///< energy of face(halfedge(e)) after the flip
    double opposite = 0;  ///< energy of face(opposite(halfedge(e))) after the flip
    double decrease = 0;  ///< of the mesh's energy; negative where the flip would raise it
};

/// Whether the geometry lets e flip: e is an interior edge, and both new faces have at least limits().min_double_area, which
/// implies that the quadrilateral around e is convex. In a triangulation of the plane the two far corners of a convex
/// quadrilateral have no other edge in common. Edges on the seam of a periodic image stay. can_flip() looks at valences too.
template <int C>
[[nodiscard]] HMESH_ALWAYS_INLINE bool is_flippable(const ImageMesh<C>& mesh, Edge e) {
    const HalfedgeMesh& topology = mesh.topology();
    const Halfedge a = HalfedgeMesh::halfedge(e), b = HalfedgeMesh::opposite(a);
    if (topology.is_boundary(a) || topology.is_boundary(b)) return false;
    const Vertex v2 = topology.to_vertex(topology.next(a)), v3 = topology.to_vertex(topology.next(b));
    const Point p0 = mesh.position(topology.to_vertex(b)), p1 = mesh.position(topology.to_vertex(a));
    const Point p2 = mesh.position(v2), p3 = mesh.position(v3);
    const double min_area = mesh.limits().min_double_area;
    return orient2d(p0, p3, p2) >= min_area && orient2d(p3, p1, p2) >= min_area && !mesh.is_on_seam(e);
}

/// Whether e can flip: is_flippable(), and both far corners may have one more edge.
template <int C>
[[nodiscard]] bool can_flip(const ImageMesh<C>& mesh, Edge e) {
    if (!is_flippable(mesh, e)) return false;
    const HalfedgeMesh& topology = mesh.topology();
    const Halfedge a = HalfedgeMesh::halfedge(e);
    return mesh.can_gain_edge(topology.to_vertex(topology.next(a))) &&
           mesh.can_gain_edge(topology.to_vertex(topology.next(HalfedgeMesh::opposite(a))));
}

/// Evaluates the flip of e, for which is_flippable() must hold, into `trial`; the mesh stays as it is. One edge walk and two face
/// energies.
template <int C>
void evaluate_flip(const ImageMesh<C>& mesh, Edge e, FlipTrial<C>& trial) {
    const HalfedgeMesh& topology = mesh.topology();
    const Halfedge a = HalfedgeMesh::halfedge(e), b = HalfedgeMesh::opposite(a);
    const Halfedge a1 = topology.next(a), a2 = topology.next(a1), b1 = topology.next(b), b2 = topology.next(b1);
    const VertexState<C>&v0 = mesh.vertex(topology.to_vertex(b)), &v1 = mesh.vertex(topology.to_vertex(a));
    const VertexState<C>&v2 = mesh.vertex(topology.to_vertex(a1)), &v3 = mesh.vertex(topology.to_vertex(b1));
    edge_moments(mesh.table(), v3.position, v2.position, trial.moments);
    Moments<C> own = trial.moments, opposite;
    mesh.add_moments(a2, own);
    mesh.add_moments(b1, own);
    mesh.moments(b2, opposite);
    mesh.add_moments(a1, opposite);
    opposite -= trial.moments;
    trial.own = face_energy(own, v3, v2, v0);
    trial.opposite = face_energy(opposite, v2, v3, v1);
    trial.decrease = mesh.energy(topology.face(a)) + mesh.energy(topology.face(b)) - trial.own - trial.opposite;
}

/// Flips e if that lowers the energy by more than `min_gain` >= 0, an energy, and by more than rounding (1e-9 of the energy of
/// its two faces). Returns the decrease of the energy, 0 if e stays.
template <int C>
double improve_edge(ImageMesh<C>& mesh, Edge e, double min_gain) {
    const HalfedgeMesh& topology = mesh.topology();
    const Halfedge a = HalfedgeMesh::halfedge(e), b = HalfedgeMesh::opposite(a);
    if (topology.is_boundary(a) || topology.is_boundary(b)) return 0;
    const double before = mesh.energy(topology.face(a)) + mesh.energy(topology.face(b));
    if (!(before > min_gain) || !is_flippable(mesh, e)) return 0;
    FlipTrial<C> trial;
    evaluate_flip(mesh, e, trial);
    if (!(trial.decrease > min_gain + 1e-9 * before) || !can_flip(mesh, e)) return 0;
    mesh.flip(e, trial.moments, trial.own, trial.opposite);
    return trial.decrease;
}

/// Flips edges until no flip gains more than `min_gain` >= 0, in units of the mean energy of a vertex. Edges wait on a stack, at
/// first those given, the first on top; after a flip the four sides of its quadrilateral are pushed again. The four vertices
/// around a flipped edge become dirty. Ends early where mesh.keep_going() says stop. Returns the number of flips.
template <int C>
std::size_t flip_edges(ImageMesh<C>& mesh, Array<Edge> stack, double min_gain) {
    const HalfedgeMesh& topology = mesh.topology();
    min_gain *= mesh.mean_energy();
    std::reverse(stack.begin(), stack.end());
    std::size_t flips = 0;
    // The energy falls with every flip; the budget only guards against a million tiny gains where min_gain is 0.
    for (std::size_t budget = 20 * stack.size(); !stack.empty() && budget > 0 && mesh.keep_going(); --budget) {
        const Edge e = stack.back();
        stack.pop_back();
        if (!(improve_edge(mesh, e, min_gain) > 0)) continue;
        ++flips;
        for (const Halfedge h : {HalfedgeMesh::halfedge(e), HalfedgeMesh::opposite(HalfedgeMesh::halfedge(e))}) {
            const Halfedge n = topology.next(h), p = topology.next(n);
            stack.push_back(HalfedgeMesh::edge(n));
            stack.push_back(HalfedgeMesh::edge(p));
            mesh.set_dirty(topology.to_vertex(h), true);
            mesh.set_dirty(topology.to_vertex(n), true);
        }
    }
    return flips;
}
/// The same for all edges of the mesh, in spatial order.
template <int C>
std::size_t flip_edges(ImageMesh<C>& mesh, double min_gain = 1e-4) {
    return flip_edges(mesh, spatial_edges(mesh), min_gain);
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_EDIT_FLIP_HPP
