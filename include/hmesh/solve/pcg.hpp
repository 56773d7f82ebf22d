/// \file
/// Pcg: conjugate gradients with Jacobi preconditioner, for several right-hand sides at once.
///
/// For self-adjoint positive semidefinite matrices like K K^T, which is a mass matrix: divided by its diagonal it is
/// well conditioned, so 15 to 25 iterations reach 1e-7 whatever the size of the mesh, and no factorisation is needed.
/// Each right-hand side has its own step sizes and stops by itself; they share the passes over the matrix. An iteration
/// costs about 2 ns an entry and right-hand side.
#ifndef HMESH_SOLVE_PCG_HPP
#define HMESH_SOLVE_PCG_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "hmesh/core/assert.hpp"
#include "hmesh/solve/normal_equations.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// When solve_pcg() stops.
struct PcgOptions {
    int max_iterations = 200;
    double tolerance = 1e-10;  ///< of the residual, relative to the right-hand side
};

/// How far solve_pcg() came.
struct PcgReport {
    int iterations = 0;
    /// max over columns of |b - A x| / |b|, computed from the x returned; both without the rows that are held, and b less what
    /// these contribute
    double residual = 0;
    bool converged = false;
};

/// An entry of X that is given.
struct HeldEntry {
    std::size_t row = 0, column = 0;
};

namespace detail {

/// out = A x: row i gathers along row i of A, which is symmetric.
inline void multiply(const SymmetricMatrix& a, const DenseMatrix& x, DenseMatrix& out) {
    const std::size_t columns = x.columns;
    for (std::size_t i = 0; i < a.size(); ++i) {
        double* const to = out.values.data() + i * columns;
        std::fill(to, to + columns, 0.0);
        for (auto e = static_cast<std::size_t>(a.starts[i]); e < static_cast<std::size_t>(a.starts[i + 1]); ++e) {
            const double value = a.values[e];
            const double* const from = x.values.data() + static_cast<std::size_t>(a.columns[e]) * columns;
            for (std::size_t k = 0; k < columns; ++k) to[k] += value * from[k];
        }
    }
}

/// Dot products of the columns of a and b.
inline void column_dots(const DenseMatrix& a, const DenseMatrix& b, std::vector<double>& out) {
    std::fill(out.begin(), out.end(), 0.0);
    for (std::size_t i = 0; i < a.rows; ++i)
        for (std::size_t k = 0; k < out.size(); ++k) out[k] += a(i, k) * b(i, k);
}

}  // namespace detail

/// Solves A X = B. A: n by n, self-adjoint, positive semidefinite, both triangles stored. B: n by k. X: n by k, on entry
/// where to start, on return the solution. A column of B that is 0 has the solution 0. A row whose diagonal is not
/// positive (a vertex without pixels) leaves its row of X as it was. So do entries that `held` names, by row and column:
/// the others are then solved for with these given, all columns with the one matrix; B may be anything in such entries.
inline PcgReport solve_pcg(const SymmetricMatrix& a, const DenseMatrix& b, DenseMatrix& x, const PcgOptions& options = {},
                           const std::vector<HeldEntry>& held = {}) {
    HMESH_ASSERT(b.rows == a.size() && x.rows == b.rows && x.columns == b.columns);
    const std::size_t n = b.rows, width = b.columns;
    PcgReport report;
    report.converged = true;
    if (n == 0 || width == 0) return report;

    std::vector<double> inverse(n, 0.0);  // the preconditioner
    for (std::size_t i = 0; i < n; ++i)
        if (const double diagonal = a.diagonal(i); diagonal > 0) inverse[i] = 1 / diagonal;
    DenseMatrix& solution = x;
    DenseMatrix residual(n, width), direction(n, width), product(n, width);
    std::vector<double> norm(width), rr(width), rz(width), rz_before(width), steps(width), reference(width);
    std::vector<unsigned char> runs(width, 1);
    const auto release = [&](DenseMatrix& rows) {  // what is held has no residual
        for (const HeldEntry& entry : held) rows(entry.row, entry.column) = 0;
    };
    // For now the solution's held entries.
    for (const HeldEntry& entry : held) direction(entry.row, entry.column) = solution(entry.row, entry.column);
    const auto subtract_product = [&] {  // residual = b - product
        for (std::size_t i = 0; i < residual.values.size(); ++i) residual.values[i] = b.values[i] - product.values[i];
        release(residual);
    };
    if (!held.empty()) detail::multiply(a, direction, product);
    subtract_product();
    detail::column_dots(residual, residual, norm);
    for (std::size_t k = 0; k < width; ++k) {
        norm[k] = std::sqrt(norm[k]);
        for (std::size_t i = 0; i < n && norm[k] == 0; ++i) solution(i, k) = direction(i, k);
    }
    const auto is_small = [&](std::size_t k) { return std::sqrt(rr[k]) <= options.tolerance * norm[k]; };
    const auto measure = [&] {  // r r, and r z with z = r / diagonal
        std::fill(rr.begin(), rr.end(), 0.0);
        std::fill(rz.begin(), rz.end(), 0.0);
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t k = 0; k < width; ++k) {
                const double r = residual(i, k);
                rr[k] += r * r;
                rz[k] += r * r * inverse[i];
            }
    };

    // The residual that the iteration carries along drifts from the true one by rounding; a column has converged when
    // the true one is small. Otherwise it starts again from there, unless the last start gained less than a factor 2.
    for (bool first = true;; first = false) {
        detail::multiply(a, solution, product);
        subtract_product();
        measure();
        bool any = false;
        for (std::size_t k = 0; k < width; ++k) {
            runs[k] = !is_small(k) && rz[k] > 0 && (first || rr[k] <= 0.25 * reference[k]);
            reference[k] = rr[k];
            any = any || runs[k] != 0;
        }
        if (!any || report.iterations >= options.max_iterations) break;

        std::fill(direction.values.begin(), direction.values.end(), 0.0);
        rz_before = rz;  // the first direction is z itself: its factor below multiplies 0
        while (any && report.iterations < options.max_iterations) {
            for (std::size_t i = 0; i < n; ++i)
                for (std::size_t k = 0; k < width; ++k)
                    if (runs[k] != 0) direction(i, k) = residual(i, k) * inverse[i] + rz[k] / rz_before[k] * direction(i, k);
            detail::multiply(a, direction, product);
            release(product);
            detail::column_dots(direction, product, steps);
            for (std::size_t k = 0; k < width; ++k) {
                if (!(steps[k] > 0)) runs[k] = 0;  // the direction has no energy: a singular matrix, or rounding
                steps[k] = runs[k] != 0 ? rz[k] / steps[k] : 0.0;
            }
            for (std::size_t i = 0; i < n; ++i)
                for (std::size_t k = 0; k < width; ++k) {
                    solution(i, k) += steps[k] * direction(i, k);
                    residual(i, k) -= steps[k] * product(i, k);
                }
            rz_before = rz;
            measure();
            ++report.iterations;
            any = false;
            for (std::size_t k = 0; k < width; ++k) {
                if (is_small(k) || !(rz[k] > 0)) runs[k] = 0;
                any = any || runs[k] != 0;
            }
        }
    }
    for (std::size_t k = 0; k < width; ++k) {
        if (norm[k] > 0) report.residual = std::max(report.residual, std::sqrt(rr[k]) / norm[k]);
        report.converged = report.converged && is_small(k);
    }
    return report;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_SOLVE_PCG_HPP
