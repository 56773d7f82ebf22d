/// \file
/// Optimal colors: the vertex colours of least squared error for given positions and faces.
///
/// The squared error is quadratic in the colours: c' K K^T c - 2 c' K I^T + |I|^2 for each channel. optimal_colors() solves for
/// its minimum by conjugate gradients; ridge (c - c_now)^2 is added for each vertex, so that vertices without pixels keep their
/// colour. solve/bounded_colors.hpp finds the best colours that a pixel type can hold.
///
/// Cost: 1 to 1.5 us a vertex at 3 channels.
#ifndef HMESH_SOLVE_OPTIMAL_COLORS_HPP
#define HMESH_SOLVE_OPTIMAL_COLORS_HPP

#include <cstddef>

#include "hmesh/core/array.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/fit/image_mesh.hpp"
#include "hmesh/solve/normal_equations.hpp"
#include "hmesh/solve/pcg.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// Gives all vertices the colours of least squared error, then clamps these to the mesh's [color_low(), color_high()], which may
/// raise the error again. Must not be called within a transaction. Returns the solver's report.
template <int C>
PcgReport optimal_colors(ImageMesh<C>& mesh, const PcgOptions& options = {}, const ParallelFor& parallel_for = {}) {
    const double ridge = mesh.limits().ridge;
    const Array<CornerSums<C>> corners = corner_sums(mesh, parallel_for);
    SymmetricMatrix matrix = normal_matrix(mesh.topology(), corners, parallel_for);
    DenseMatrix solution(mesh.vertex_count(), C), rhs = image_sums(mesh.topology(), corners, parallel_for);
    std::size_t row = 0;
    for (const Vertex v : mesh.topology().vertices()) {
        matrix.add_to_diagonal(row, ridge);
        for (int k = 0; k < C; ++k) solution(row, static_cast<std::size_t>(k)) = mesh.color(v)[k];
        ++row;
    }
    for (std::size_t i = 0; i < rhs.values.size(); ++i) rhs.values[i] += ridge * solution.values[i];
    const PcgReport report = solve_pcg(matrix, rhs, solution, options);

    Array<Color<C>> colors(mesh.vertex_count(), Color<C>::zero());
    for (std::size_t i = 0; i < colors.size(); ++i) {
        for (int k = 0; k < C; ++k) colors[i].set(k, solution(i, static_cast<std::size_t>(k)));
        detail::clamp_channels<C>(colors[i], mesh.color_low(), mesh.color_high());
    }
    detail::write_colors(mesh, colors, parallel_for);
    return report;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_SOLVE_OPTIMAL_COLORS_HPP
