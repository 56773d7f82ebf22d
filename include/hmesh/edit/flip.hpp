/// \file
/// Flips: turn edges where the other diagonal fits the picture better.
///
/// A flip is judged with positions and colours held fixed: one edge walk and two face energies. It is kept if the energy
/// falls by more than a tolerance, so the total decreases strictly and the queue ends by itself. 26-44 % of the edges of a
/// fitted mesh are diagonals of non-convex quadrilaterals and cannot turn; minimum area covers that test.
#ifndef HMESH_EDIT_FLIP_HPP
#define HMESH_EDIT_FLIP_HPP

#include <algorithm>
#include <cstddef>
#include <vector>

#include "hmesh/core/compiler.hpp"
#include "hmesh/edit/move.hpp"
#include "hmesh/fit/image_mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// What turning an edge would do: the new edge's moments and its faces' energies, valid until the mesh changes.
template <int C>
struct FlipTrial {
    Moments<C> moments;
    double own = 0, opposite = 0;  ///< energies of face(halfedge(e)) and of the other
    double decrease = 0;
};

/// Whether the shape around e lets it turn: interior, both new faces at least limits.min_double_area. In a triangulation of the
/// plane, far corners with a convex quadrilateral between them have no other edge.
template <int C>
[[nodiscard]] HMESH_ALWAYS_INLINE bool is_flippable(const ImageMesh<C>& mesh, Edge e) {
    const HalfedgeMesh& topology = mesh.topology();
    const Halfedge a = HalfedgeMesh::halfedge(e), b = HalfedgeMesh::opposite(a);
    if (topology.is_boundary(a) || topology.is_boundary(b)) return false;
    const Vertex v2 = topology.to_vertex(topology.next(a)), v3 = topology.to_vertex(topology.next(b));
    const Point p0 = mesh.position(topology.to_vertex(b)), p1 = mesh.position(topology.to_vertex(a));
    const Point p2 = mesh.position(v2), p3 = mesh.position(v3);
    const double least = mesh.limits().min_double_area;
    return orient2d(p0, p3, p2) >= least && orient2d(p3, p1, p2) >= least;
}

/// Whether e can turn: convex, and both far corners have room for one more edge.
template <int C>
[[nodiscard]] bool can_flip(const ImageMesh<C>& mesh, Edge e) {
    if (!is_flippable(mesh, e)) return false;
    const HalfedgeMesh& topology = mesh.topology();
    const Halfedge a = HalfedgeMesh::halfedge(e);
    return mesh.can_gain_edge(topology.to_vertex(topology.next(a))) &&
           mesh.can_gain_edge(topology.to_vertex(topology.next(HalfedgeMesh::opposite(a))));
}

/// Evaluates turning e, which is_flippable.
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

/// Turns e if that lowers the energy by more than `least` (and more than rounding). Returns the decrease, 0 if it stays.
template <int C>
double improve_edge(ImageMesh<C>& mesh, Edge e, double least) {
    const HalfedgeMesh& topology = mesh.topology();
    const Halfedge a = HalfedgeMesh::halfedge(e), b = HalfedgeMesh::opposite(a);
    if (topology.is_boundary(a) || topology.is_boundary(b)) return 0;
    const double before = mesh.energy(topology.face(a)) + mesh.energy(topology.face(b));
    if (!(before > least) || !is_flippable(mesh, e)) return 0;
    FlipTrial<C> trial;
    evaluate_flip(mesh, e, trial);
    if (!(trial.decrease > least + 1e-9 * before) || !can_flip(mesh, e)) return 0;
    mesh.flip(e, trial.moments, trial.own, trial.opposite);
    return trial.decrease;
}

/// Turns edges until none gains more than `least`, in units of the mean energy of a vertex: a stack in spatial order; the four
/// sides of each turned edge come up again. Vertices around turned edges become due. Returns the number of flips.
template <int C>
std::size_t flip_edges(ImageMesh<C>& mesh, double least = 1e-4) {
    const HalfedgeMesh& topology = mesh.topology();
    least *= mesh.mean_energy();
    std::vector<Edge> stack = spatial_edges(mesh);
    std::reverse(stack.begin(), stack.end());
    std::size_t flips = 0;
    // The energy falls with every flip; the bound only guards against a tolerance of 0 and a million tiny gains.
    for (std::size_t budget = 20 * stack.size(); !stack.empty() && budget > 0 && mesh.keep_going(); --budget) {
        const Edge e = stack.back();
        stack.pop_back();
        if (!(improve_edge(mesh, e, least) > 0)) continue;
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

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_EDIT_FLIP_HPP
