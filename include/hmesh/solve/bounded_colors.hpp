/// \file
/// Bounded colors: the vertex colours of least squared error among those that a pixel type can hold, in its range and on its
/// grid.
///
/// The squared error is quadratic in the colours (solve/optimal_colors.hpp). Clamping and rounding its unconstrained minimum
/// would lose more than the coordinate descent here, in which each vertex makes up for what the bounds and the grid cost its
/// neighbours. ridge (c - c_now)^2 is added for each vertex, so that vertices without pixels keep their colour.
///
/// Cost: 0.6 us a vertex at 3 channels.
#ifndef HMESH_SOLVE_BOUNDED_COLORS_HPP
#define HMESH_SOLVE_BOUNDED_COLORS_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "hmesh/core/array.hpp"
#include "hmesh/core/assert.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/fit/image_mesh.hpp"
#include "hmesh/solve/normal_equations.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// The values that the channels of a vertex's colour may have.
struct ColorRange {
    double low = 0,  ///< smallest stored value, or -infinity
        high = 0,    ///< largest stored value, or infinity
        grid = 0;    ///< where above 0, values are multiples of it, of which one must lie in [low, high]
};

/// The report of bounded_colors().
struct BoundedReport {
    int sweeps = 0;           ///< over all vertices, without the grid; at most 20
    int rounding_sweeps = 0;  ///< over the grid; at most 10
    /// Without a grid: the last sweep changed no channel by more than 1e-7 of its largest value. With a grid: no channel of any
    /// vertex can be changed by itself, to whatever allowed value, and lower the error (ridge included).
    bool converged = false;
};

namespace detail {

/// The energy with ridge as a function of the colours; rows are the mesh's vertices in the order of topology().vertices().
template <int C>
struct ColorSystem {
    SymmetricMatrix gram;    ///< K K^T
    Array<Color<C>> rhs;     ///< K I^T
    Array<Color<C>> anchor;  ///< the colours that ridge favours: those at the start
    Array<double> inverse;   ///< 1 / (diagonal + ridge); 0 where that is not positive
    double ridge = 0;        ///< in pixels, see MeshLimits

    /// Leaves a vertex its colour.
    void hold(std::size_t row) noexcept { inverse[row] = 0; }
    /// Calls update(c, step) for each vertex in turn: c is the vertex's colour, c + step the best one for it while the others
    /// stay.
    template <class Update>
    void sweep(Array<Color<C>>& colors, Update&& update) const {
        const int* const starts = gram.starts.data();
        const int* const rows = gram.columns.data();
        const double* const values = gram.values.data();
        for (std::size_t v = 0; v < colors.size(); ++v) {
            Color<C>& c = colors[v];
            Color<C> step = rhs[v] + ridge * (anchor[v] - c);
            for (int e = starts[v]; e < starts[v + 1]; ++e) step -= values[e] * colors[static_cast<std::size_t>(rows[e])];
            step *= inverse[v];
            update(c, step);
        }
    }
};

/// The multiples of a range's grid in it, as the range [first, last] of their integer factors.
struct GridRange {
    double grid, first, last;
    /// Of a range with a grid > 0; first > last: there are none.
    explicit GridRange(ColorRange range) noexcept
        : grid(range.grid), first(std::ceil(range.low / grid)), last(std::floor(range.high / grid)) {
        if (first * grid < range.low) first += 1;  // the division may have rounded the wrong way
        if (last * grid > range.high) last -= 1;
    }
    /// The multiple nearest to `value`, held to the range.
    [[nodiscard]] double nearest(double value) const noexcept {
        return std::max(first, std::min(last, std::floor(value / grid + 0.5))) * grid;
    }
};

/// Moves a colour to the nearest that a range allows.
template <int C>
void to_allowed(Color<C>& color, ColorRange range) noexcept {
    clamp_channels<C>(color, range.low, range.high);
    if (!(range.grid > 0)) return;
    const GridRange steps(range);
    for (int c = 0; c < C; ++c) color.set(c, steps.nearest(color[c]));
}

/// The system of a mesh with this topology and these corner sums (fit/squared_error.hpp); `colors`, one a row, become the anchor.
template <int C>
[[nodiscard]] HMESH_COLD ColorSystem<C> color_system(const HalfedgeMesh& topology, const Array<CornerSums<C>>& corners,
                                                     const Array<Color<C>>& colors, double ridge,
                                                     const ParallelFor& parallel_for) {
    ColorSystem<C> system;
    system.ridge = ridge;
    system.gram = normal_matrix(topology, corners, parallel_for);
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

/// The descent of bounded_colors(): improves `colors`, which lie in [range.low, range.high], one a row. Asks go_on(), where set,
/// before each sweep but the one that puts the colours on the grid.
template <int C>
BoundedReport descend(const ColorSystem<C>& system, ColorRange range, Array<Color<C>>& colors, FunctionRef<bool()> go_on = {}) {
    HMESH_ASSERT(range.low <= range.high && range.grid >= 0);
    constexpr int max_sweeps = 20, max_rounding_sweeps = 10;
    Color<C> scale = Color<C>::zero();
    for (const Color<C>& c : colors)
        for (int k = 0; k < C; ++k) scale.set(k, std::max(scale[k], std::abs(c[k])));

    BoundedReport report;
    while (report.sweeps < max_sweeps && !report.converged && (!go_on || go_on())) {
        report.converged = true;
        system.sweep(colors, [&](Color<C>& c, const Color<C>& step) {
            Color<C> next = c + step;
            detail::clamp_channels<C>(next, range.low, range.high);
            for (int k = 0; k < C; ++k)
                if (std::abs(next[k] - c[k]) > (range.grid > 0 ? range.grid / 16 : 1e-7 * scale[k])) report.converged = false;
            c = next;
        });
        ++report.sweeps;
    }

    if (range.grid > 0) {
        const detail::GridRange steps(range);
        HMESH_ASSERT(steps.first <= steps.last);
        system.sweep(colors, [&](Color<C>& c, const Color<C>& step) {
            for (int k = 0; k < C; ++k) c.set(k, steps.nearest(c[k] + step[k]));
        });
        // The nearest multiple is the best one, since the error along one channel is a parabola. Steps of half the grid
        // are ties and not taken, or rounding could move two colours back and forth.
        const double half = range.grid * (0.5 + 1e-9);
        report.converged = false;
        while (report.rounding_sweeps < max_rounding_sweeps && !report.converged && (!go_on || go_on())) {
            bool changed = false;
            system.sweep(colors, [&](Color<C>& c, const Color<C>& step) {
                for (int k = 0; k < C; ++k) {
                    if (!(std::abs(step[k]) > half)) continue;
                    const double next = steps.nearest(c[k] + step[k]);
                    changed = changed || next != c[k];
                    c.set(k, next);
                }
            });
            ++report.rounding_sweeps;
            report.converged = !changed;
        }
    }
    return report;
}

}  // namespace detail

/// Gives all vertices colours that a range allows. Coordinate descent (projected Gauss-Seidel) from the current colours: first
/// without the grid; then onto the grid, vertex by vertex; then over the grid as long as that lowers the error. 0.6 us a vertex
/// at 3 channels. Locked vertices keep colours that the range allows, unless they are `unlocked` here: then they get those that
/// are best for the faces of this mesh. go_on(), where set, is asked before each sweep but the one that puts the colours on the
/// grid, which is the last one once it says false.
template <int C>
HMESH_COLD BoundedReport bounded_colors(ImageMesh<C>& mesh, ColorRange range, const ParallelFor& parallel_for = {},
                                        FunctionRef<bool()> go_on = {}, bool unlocked = false) {
    Array<Color<C>> colors;
    colors.reserve(mesh.vertex_count());
    for (const Vertex v : mesh.topology().vertices()) {
        colors.push_back(mesh.color(v));
        detail::clamp_channels<C>(colors.back(), range.low, range.high);
    }
    auto system =
        detail::color_system(mesh.topology(), corner_sums(mesh, parallel_for), colors, mesh.limits().ridge, parallel_for);
    std::size_t row = 0;
    for (const Vertex v : mesh.topology().vertices()) {
        if (!unlocked && mesh.vertex(v).mobility == Mobility::locked) system.hold(row);
        ++row;
    }
    const BoundedReport report = detail::descend(system, range, colors, go_on);
    detail::write_colors(mesh, colors, parallel_for);
    return report;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_SOLVE_BOUNDED_COLORS_HPP
