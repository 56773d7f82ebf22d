// hmesh - colors: the colours of all vertices at once, for geometry that stays.
//
// The squared error is quadratic in the colours: c' K K^T c - 2 c' K I^T + |I|^2 for each channel. optimal_colors
// solves for its minimum; bounded_colors finds final colours that a pixel type can hold, in its range and on its grid,
// which loses less than clamping and rounding the optimum: each vertex makes up for what its neighbours could not do.
// Both add ridge (c - c_now)^2 for each vertex, so that vertices without pixels keep their colour. Both need the mesh
// to be outside a transaction. Cost at 3 channels: 1 to 1.5 us a vertex for optimal, 0.6 us for bounded.
#ifndef HMESH_SOLVE_BOUNDED_COLORS_HPP
#define HMESH_SOLVE_BOUNDED_COLORS_HPP

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/core/assert.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/solve/normal_equations.hpp"
#include "hmesh/fit/image_mesh.hpp"
#include "hmesh/tiles/tiled_mesh.hpp"
#include "hmesh/solve/pcg.hpp"

namespace hmesh::kit {
namespace detail {

// Writes colours[r] to vertex r of topology().vertices().
template <int C>
void write_colors(ImageMesh<C>& mesh, const std::vector<Color<C>>& colors, const ParallelFor& parallel_for) {
    std::vector<Color<C>> by_slot(mesh.topology().vertex_slots(), Color<C>::zero());
    std::size_t row = 0;
    for (const Vertex v : mesh.topology().vertices()) by_slot[v.index()] = colors[row++];
    mesh.set_colors(by_slot, parallel_for);
}

}  // namespace detail

// Gives all vertices the colours with the least squared error, held to the mesh's [color_low, color_high].
template <int C>
PcgReport optimal_colors(ImageMesh<C>& mesh, const PcgOptions& options = {}, const ParallelFor& parallel_for = {}) {
    const double ridge = mesh.limits().ridge;
    const std::vector<CornerSums<C>> corners = corner_sums(mesh, parallel_for);
    Eigen::SparseMatrix<double> matrix = gram_matrix(mesh.topology(), corners, parallel_for);
    for (Eigen::Index i = 0; i < matrix.rows(); ++i) matrix.coeffRef(i, i) += ridge;
    Eigen::MatrixXd solution = color_matrix(mesh);
    const Eigen::MatrixXd rhs = image_rhs(mesh.topology(), corners, parallel_for) + ridge * solution;
    const PcgReport report = solve_pcg(matrix, rhs, solution, options);

    std::vector<Color<C>> colors(mesh.vertex_count(), Color<C>::zero());
    for (std::size_t i = 0; i < colors.size(); ++i) {
        for (int k = 0; k < C; ++k) colors[i].set(k, solution(static_cast<Eigen::Index>(i), k));
        detail::clamp_channels<C>(colors[i], mesh.color_low(), mesh.color_high());
    }
    detail::write_colors(mesh, colors, parallel_for);
    return report;
}

// Settled: without a grid, the last sweep changed nothing that matters; with one, no channel of any vertex can be
// changed by itself, to whatever value is allowed, and lower the error (ridge included).
struct BoundedReport {
    int sweeps = 0, rounding_sweeps = 0;
    bool settled = false;
};

namespace detail {

// The energy with ridge as a function of single colours.
template <int C>
struct ColorSystem {
    Eigen::SparseMatrix<double> gram;
    std::vector<Color<C>> rhs, anchor;  // K I^T, and the colours that ridge pulls to
    std::vector<double> inverse;        // 1 / (diagonal + ridge)
    double ridge = 0;

    // Calls update(c, step) for each vertex in turn: c is its colour, c + step the best one while the others stay.
    template <class Update>
    void sweep(std::vector<Color<C>>& colors, Update&& update) const {
        const int* const starts = gram.outerIndexPtr();
        const int* const rows = gram.innerIndexPtr();
        const double* const values = gram.valuePtr();
        for (std::size_t v = 0; v < colors.size(); ++v) {
            Color<C>& c = colors[v];
            Color<C> step = rhs[v] + ridge * (anchor[v] - c);
            for (int e = starts[v]; e < starts[v + 1]; ++e) step -= values[e] * colors[static_cast<std::size_t>(rows[e])];
            step *= inverse[v];
            update(c, step);
        }
    }
};

// The multiples of `grid` in [low, high] as the range of their factors.
struct GridRange {
    double grid, first, last;
    GridRange(double low, double high, double step) noexcept
        : grid(step), first(std::ceil(low / step)), last(std::floor(high / step)) {
        if (first * grid < low) first += 1;  // the division may have rounded the wrong way
        if (last * grid > high) last -= 1;
    }
    [[nodiscard]] double nearest(double value) const noexcept {
        return std::max(first, std::min(last, std::floor(value / grid + 0.5))) * grid;
    }
};

// The system of a mesh with this topology and these corners (solve/normal_equations.hpp); colours go by row.
template <int C>
[[nodiscard]] ColorSystem<C> color_system(const HalfedgeMesh& topology, const std::vector<CornerSums<C>>& corners,
                                          const std::vector<Color<C>>& colors, double ridge, const ParallelFor& parallel_for) {
    ColorSystem<C> system;
    system.ridge = ridge;
    system.gram = gram_matrix(topology, corners, parallel_for);
    system.rhs.assign(colors.size(), Color<C>::zero());
    system.inverse.assign(colors.size(), 0.0);
    std::size_t row = 0;
    for (const Vertex v : topology.vertices()) {
        for (const Halfedge h : topology.outgoing(v)) system.rhs[row] += corners[h.index()].image;
        system.rhs[row].set(C, 0);
        double diagonal = ridge;
        for (const Halfedge h : topology.outgoing(v)) diagonal += corners[h.index()].square;
        if (diagonal > 0) system.inverse[row] = 1 / diagonal;
        ++row;
    }
    system.anchor = colors;
    return system;
}

// Takes colours that lie in [low, high] to the best there, see bounded_colors; before each sweep but the one that puts them
// on the grid, go_on() is asked.
template <int C, class GoOn>
BoundedReport descend(const ColorSystem<C>& system, double low, double high, double grid, std::vector<Color<C>>& colors,
                      GoOn&& go_on) {
    HMESH_ASSERT(low <= high && grid >= 0);
    constexpr int most_sweeps = 20, most_rounding_sweeps = 10;
    double scale = 0;
    for (const Color<C>& c : colors)
        for (int k = 0; k < C; ++k) scale = std::max(scale, std::abs(c[k]));

    BoundedReport report;
    const double least = grid > 0 ? grid / 16 : 1e-7 * scale;
    while (report.sweeps < most_sweeps && !report.settled && go_on()) {
        double largest = 0;
        system.sweep(colors, [&](Color<C>& c, const Color<C>& step) {
            Color<C> next = c + step;
            detail::clamp_channels<C>(next, low, high);
            for (int k = 0; k < C; ++k) largest = std::max(largest, std::abs(next[k] - c[k]));
            c = next;
        });
        ++report.sweeps;
        report.settled = largest <= least;
    }

    if (grid > 0) {
        const detail::GridRange range(low, high, grid);
        HMESH_ASSERT(range.first <= range.last);
        system.sweep(colors, [&](Color<C>& c, const Color<C>& step) {
            for (int k = 0; k < C; ++k) c.set(k, range.nearest(c[k] + step[k]));
        });
        // The nearest multiple is the best one, since the error along one colour is a parabola. Steps of half the grid
        // are ties: left alone, or rounding could trade two colours to and fro.
        const double half = grid * (0.5 + 1e-9);
        report.settled = false;
        while (report.rounding_sweeps < most_rounding_sweeps && !report.settled && go_on()) {
            bool changed = false;
            system.sweep(colors, [&](Color<C>& c, const Color<C>& step) {
                for (int k = 0; k < C; ++k) {
                    if (!(std::abs(step[k]) > half)) continue;
                    const double next = range.nearest(c[k] + step[k]);
                    changed = changed || next != c[k];
                    c.set(k, next);
                }
            });
            ++report.rounding_sweeps;
            report.settled = !changed;
        }
    }
    return report;
}

}  // namespace detail

// Gives all vertices colours in [low, high], which may be infinite, that are multiples of grid if grid > 0 (one must be
// in the range). By coordinate descent (projected Gauss-Seidel) from the current colours: first without the grid, then
// onto it, vertex by vertex, then over the grid while that lowers the error.
template <int C>
BoundedReport bounded_colors(ImageMesh<C>& mesh, double low, double high, double grid, const ParallelFor& parallel_for = {}) {
    std::vector<Color<C>> colors;
    colors.reserve(mesh.vertex_count());
    for (const Vertex v : mesh.topology().vertices()) {
        colors.push_back(mesh.color(v));
        detail::clamp_channels<C>(colors.back(), low, high);
    }
    const auto system =
        detail::color_system(mesh.topology(), corner_sums(mesh, parallel_for), colors, mesh.limits().ridge, parallel_for);
    const BoundedReport report = detail::descend(system, low, high, grid, colors, [] { return true; });
    detail::write_colors(mesh, colors, parallel_for);
    return report;
}

// The same for a mesh in patches, whose energy is then that of the final colours. After a cancellation colours go to the
// nearest that are allowed, no more, and what is reported is still true of the mesh.
template <int C>
BoundedReport bounded_colors(TiledMesh<C>& work, const Tiling& tiling, double low, double high, double grid) {
    BoundedReport report;
    if (tiling.size() == 1 &&
        work.for_each(tiling, [&](Patch<C>& patch, std::size_t) { report = bounded_colors(patch.mesh(), low, high, grid); }))
        return report;
    IndexedMesh<C>& whole = work.indexed();
    for (Color<C>& c : whole.colors) detail::clamp_channels<C>(c, low, high);
    HalfedgeMesh topology;
    const Status status = topology.assign(whole.vertex_count(), whole.triangles);
    HMESH_ASSERT(status);
    (void)status;
    std::vector<CornerSums<C>> corners(2 * topology.edge_slots());
    work.visit(tiling, [&](Patch<C>& patch, std::size_t, const std::uint32_t* triangles) {
        for (const Face f : patch.mesh().topology().faces()) {
            const Halfedge h0 = topology.halfedge(Face(triangles[f.index()])), h1 = topology.next(h0), h2 = topology.next(h1);
            detail::sum_face(patch.mesh(), f, corners[h0.index()], corners[h1.index()], corners[h2.index()]);
        }
    });
    if (work.monitor().stopped()) std::fill(corners.begin(), corners.end(), CornerSums<C>());  // only ridges pull
    const auto system = detail::color_system(topology, corners, whole.colors, work.limits().ridge, work.parallel_for());
    report = detail::descend(system, low, high, grid, whole.colors, [&] { return work.monitor().poll(); });
    work.measure(tiling);
    return report;
}

}  // namespace hmesh::kit

#endif  // HMESH_SOLVE_BOUNDED_COLORS_HPP
