/// \file
/// Geometry step: the paper's linear least squares in position and colour (sections 4.4 and 4.5.1), with a safeguard.
///
/// K has the barycentric coordinates of the pixels' foot points (methods/hierarchical/footpoints.hpp). Positions and colours of
/// all vertices are the least-squares solution of V K = P and I(V) K = I, with one matrix K K^T for all coordinates, by
/// preconditioned conjugate gradients. The plain solution lowers the distance in 2 + C dimensions but raises the error of the
/// picture: Lena at 1 % ends at 28.4 dB, instead of the 29.7 dB that solving for colours alone reaches. By default the solution
/// is therefore only a direction: each vertex in turn goes the part of its way for which the error of its ring is least, and
/// colours are then solved for under the pixels (solve/optimal_colors.hpp), so that the error never rises but by rounding. Two
/// such steps with flips on two levels take Adams' mesh from 28.2 to 30.3 dB.
///
/// Cost: 30 ns a pixel for the foot points; 0.4 us for a trial on a ring, since edge moments make it independent of the number
/// of pixels.
#ifndef HMESH_METHODS_HIERARCHICAL_GEOMETRY_STEP_HPP
#define HMESH_METHODS_HIERARCHICAL_GEOMETRY_STEP_HPP

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/core/array.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/edit/move.hpp"
#include "hmesh/fit/image_mesh.hpp"
#include "hmesh/methods/hierarchical/footpoints.hpp"
#include "hmesh/solve/bounded_colors.hpp"
#include "hmesh/solve/eigen.hpp"
#include "hmesh/solve/normal_equations.hpp"
#include "hmesh/solve/optimal_colors.hpp"
#include "hmesh/solve/pcg.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// How a geometry step uses its least-squares solution.
enum class StepRule : std::uint8_t {
    safeguarded,  ///< each vertex goes the part of its way for which its ring's error is least; colours are solved for afterwards
    literal,      ///< each vertex goes all of its way, or the first half, quarter .. that folds no face; colours as solved for
};

/// Options of geometry_step().
struct GeometryStep {
    FootSearch search = FootSearch::own_face;  ///< where foot points are searched
    StepRule rule = StepRule::safeguarded;     ///< how the solution is used
    /// Px that 1/255 of the peak is worth in the distance of pixels and mesh, in [0.001, 1000]; 0.3 to 3 differ by up to 0.1 dB.
    double color_scale = 1;
    double ridge = 1e-3;        ///< weight of the current state, in pixels, in [1e-9, 1000]; for faces without pixels
    int halvings = 4;           ///< safeguarded tries 1, 1/2, .. 2^-halvings of the way, in [0, 20]
    PcgOptions pcg{200, 1e-7};  ///< of the solves for positions and for colours
};

/// The linear system of a geometry step, gram * solution = rhs; rows are vertices, the 2 + C columns x, y and the colour
/// channels.
struct GeometrySystem {
    Eigen::SparseMatrix<double> gram;  ///< n_v by n_v: K K^T with the ridge on its diagonal
    Eigen::MatrixXd rhs;               ///< n_v by 2 + C
    Eigen::MatrixXd solution;          ///< n_v by 2 + C; at first the positions in px and colours in stored values of the mesh
    std::vector<HeldEntry> held;       ///< coordinates of border vertices across their side, of corners and of locked vertices
};

/// Makes the system for a mesh. `color_scale`: px that a unit of stored value is worth; `ridge`: in pixels.
template <int C>
[[nodiscard]] GeometrySystem geometry_system(const ImageMesh<C>& mesh, FootSearch search, double color_scale, double ridge,
                                             const ParallelFor& parallel_for = {}) {
    GeometrySystem system;
    const HalfedgeMesh& topology = mesh.topology();
    const Array<CornerSums<C>> corners = foot_sums(mesh, search, color_scale, parallel_for);
    system.gram = gram_matrix(topology, corners, parallel_for);
    for (Eigen::Index i = 0; i < system.gram.rows(); ++i) system.gram.coeffRef(i, i) += ridge;
    system.solution.resize(system.gram.rows(), 2 + C);
    system.rhs.resize(system.gram.rows(), 2 + C);
    system.solution << position_matrix(mesh), color_matrix(mesh);
    system.rhs << position_rhs<C>(topology, corners, parallel_for), image_rhs<C>(topology, corners, parallel_for);
    system.rhs += ridge * system.solution;
    std::size_t row = 0;
    for (const Vertex v : topology.vertices()) {
        const Mobility mobility = mesh.vertex(v).mobility;
        if (mobility != Mobility::free && mobility != Mobility::along_x) system.held.push_back({row, 0});
        if (mobility != Mobility::free && mobility != Mobility::along_y) system.held.push_back({row, 1});
        ++row;
    }
    return system;
}

namespace detail {

/// Moves v the part 1, 1/2, .. 2^-halvings of the way to `target` for which the error of its ring, with the best colour for v,
/// is least. Returns whether v moved. `scratch` is overwritten.
template <int C>
bool step_toward(ImageMesh<C>& mesh, Vertex v, Point target, int halvings, RingScratch<C>& scratch) {
    const MeshLimits& limits = mesh.limits();
    const VertexState<C>& state = mesh.vertex(v);
    mesh.gather(v, scratch.ring, scratch.spokes);
    // A ring whose pixels have no weight stays, though pixels next to it may have their foot points there.
    if (mesh.table().is_weighted() && !(ring_weight(scratch.ring, scratch.spokes) > least_weight)) return false;
    const double before = mesh.energy(scratch.ring);
    const Point from = state.position;
    RingCenter<C> best{from, state.color, before * (1 - 1e-9)};  // gains within rounding do not count
    double share = 1;
    for (int k = 0; k <= halvings; ++k, share *= 0.5) {
        const Point part{from.x + share * (target.x - from.x), from.y + share * (target.y - from.y)};
        const Point trial = mesh.clamp(part, state.mobility);
        if (trial == from) break;
        if (!scratch.ring.accepts(trial, limits.min_double_area)) continue;
        walk_spokes(mesh.table(), scratch.ring, trial, scratch.trial_spokes);
        RingFit<C> fit;
        if (!fit_ring(scratch.ring, scratch.trial_spokes, trial, limits.min_double_area, scratch.trial_faces, fit)) continue;
        const Color<C> color = best_color(fit, state.color, limits.ridge, mesh.color_low(), mesh.color_high());
        const double energy = fit.energy(color);
        if (energy < best.energy) best = {trial, color, energy};
    }
    if (best.position == from) return false;
    mesh.place(v, best.position, best.color);
    return true;
}

/// Gives all vertices the least-squares colours under the pixels, within the mesh's range. Clamping the optimum may raise the
/// error, and so may stopping the solver early: then the old colours are restored and improved by bounded_colors(), which never
/// raises it.
template <int C>
void improve_colors(ImageMesh<C>& mesh, const PcgOptions& options, const ParallelFor& parallel_for) {
    const double before = mesh.energy();
    Array<Color<C>> colors;
    colors.reserve(mesh.vertex_count());
    for (const Vertex v : mesh.topology().vertices()) colors.push_back(mesh.color(v));
    optimal_colors(mesh, options, parallel_for);
    if (mesh.energy() <= before) return;
    write_colors(mesh, colors, parallel_for);
    bounded_colors(mesh, {mesh.color_low(), mesh.color_high()}, parallel_for);
}

/// Moves v toward `target`, the first of 1, 1/2, .. 1/32 of the way with which no face around it folds over. Returns whether v
/// arrived.
template <int C>
bool step_unfolded(ImageMesh<C>& mesh, Vertex v, Point target, RingScratch<C>& scratch) {
    mesh.gather(v, scratch.ring, scratch.spokes);
    const VertexState<C>& state = mesh.vertex(v);
    const Point from = state.position;
    double share = 1;
    for (int k = 0; k < 6; ++k, share *= 0.5) {
        const Point part{from.x + share * (target.x - from.x), from.y + share * (target.y - from.y)};
        const Point trial = mesh.clamp(part, state.mobility);
        if (trial == from) return true;
        if (!scratch.ring.accepts(trial, mesh.limits().min_double_area)) continue;
        mesh.place(v, trial, state.color);
        return k == 0;
    }
    return false;
}

}  // namespace detail

/// Makes one geometry step. `peak`: the stored value of full intensity. Vertices with more than ring_capacity neighbours keep
/// their position. Returns the report of the solve for positions; ends early where mesh.keep_going() says stop.
template <int C>
PcgReport geometry_step(ImageMesh<C>& mesh, const GeometryStep& options, double peak, const ParallelFor& parallel_for = {}) {
    GeometrySystem system = geometry_system(mesh, options.search, options.color_scale * 255 / peak, options.ridge, parallel_for);
    if (mesh.task() != nullptr && mesh.task()->stopped()) return {};  // some sums may be missing
    const PcgReport report = solve_pcg(system.gram, system.rhs, system.solution, options.pcg, system.held);
    const HalfedgeMesh& topology = mesh.topology();
    const Array<int> rows = vertex_rows(topology);
    const auto target = [&](Vertex v) {
        const Eigen::Index row = rows[v.index()];
        return Point{system.solution(row, 0), system.solution(row, 1)};
    };
    const Array<Vertex> vertices = spatial_vertices(mesh);
    RingScratch<C> scratch;
    if (options.rule == StepRule::safeguarded) {
        for (const Vertex v : vertices) {
            if (!mesh.keep_going()) break;
            if (topology.valence(v) <= ring_capacity) detail::step_toward(mesh, v, target(v), options.halvings, scratch);
        }
        detail::improve_colors(mesh, options.pcg, parallel_for);
        return report;
    }
    Array<unsigned char> arrived(topology.vertex_slots(), 0);
    for (int round = 0; round < 3; ++round)  // neighbours that have moved meanwhile make room
        for (const Vertex v : vertices) {
            if (!mesh.keep_going()) break;
            if (arrived[v.index()] == 0 && topology.valence(v) <= ring_capacity)
                arrived[v.index()] = detail::step_unfolded(mesh, v, target(v), scratch) ? 1 : 0;
        }
    Array<Color<C>> colors;
    for (Eigen::Index row = 0; row < system.solution.rows(); ++row) {
        colors.push_back(Color<C>::zero());
        for (int c = 0; c < C; ++c) colors.back().set(c, system.solution(row, 2 + c));
        detail::clamp_channels<C>(colors.back(), mesh.color_low(), mesh.color_high());
    }
    detail::write_colors(mesh, colors, parallel_for);
    return report;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_HIERARCHICAL_GEOMETRY_STEP_HPP
