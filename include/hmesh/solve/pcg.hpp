/// \file
/// Preconditioned conjugate gradients (PCG) with the Jacobi preconditioner, for several right-hand sides at once.
///
/// For symmetric positive semidefinite matrices like K K^T, which is a mass matrix: divided by its diagonal it is well
/// conditioned, so that 15 to 25 iterations reach a relative residual of 1e-7 whatever the size of the mesh, and no
/// factorisation is needed. Each right-hand side has step sizes and a stop of its own; the passes over the matrix are shared.
///
/// Cost: an iteration takes about 2 ns for each entry of the matrix and right-hand side.
#ifndef HMESH_SOLVE_PCG_HPP
#define HMESH_SOLVE_PCG_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "hmesh/core/array.hpp"
#include "hmesh/core/assert.hpp"
#include "hmesh/solve/normal_equations.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// When solve_pcg() stops.
struct PcgOptions {
    int max_iterations = 200;  ///< over all restarts, >= 1
    double tolerance = 1e-10;  ///< on the 2-norm of the residual, relative to that of the right-hand side
};

/// The report of solve_pcg().
struct PcgReport {
    int iterations = 0;  ///< each advances all columns that have not stopped
    /// The largest |b - A x| / |b| of a column in 2-norms, computed from the X returned. Held rows are left out of both norms,
    /// and b is less what the held entries contribute.
    double residual = 0;
    bool converged = false;  ///< whether every column's residual is within the tolerance
};

/// An entry of X that is given, not solved for.
struct HeldEntry {
    std::size_t row = 0;     ///< of X, that is the vertex
    std::size_t column = 0;  ///< of X, that is the right-hand side
};

namespace detail {

/// out = A x; row i of `out` gathers along row i of A.
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

/// out[k] = the dot product of column k of a and column k of b.
inline void column_dots(const DenseMatrix& a, const DenseMatrix& b, Array<double>& out) {
    std::fill(out.begin(), out.end(), 0.0);
    for (std::size_t i = 0; i < a.rows; ++i)
        for (std::size_t k = 0; k < out.size(); ++k) out[k] += a(i, k) * b(i, k);
}

}  // namespace detail

/// Solves A X = B. A: n by n, symmetric, positive semidefinite, both triangles stored. B: n by k. X: n by k, the start on entry,
/// the solution on return.
///
/// Where the diagonal of A is not positive (a vertex without pixels), the row of X stays as it was. In all others a column of B
/// that is 0 has the solution 0. The entries of X that `held` names by row and column stay too; the other entries are solved for
/// with these given, and B may hold anything there. Each iteration costs about 2 ns for each entry of A and column of B.
inline PcgReport solve_pcg(const SymmetricMatrix& a, const DenseMatrix& b, DenseMatrix& x, const PcgOptions& options = {},
                           const std::vector<HeldEntry>& held = {}) {
    HMESH_ASSERT(b.rows == a.size() && x.rows == b.rows && x.columns == b.columns);
    const std::size_t n = b.rows, width = b.columns;
    PcgReport report;
    report.converged = true;
    if (n == 0 || width == 0) return report;

    Array<double> inverse(n, 0.0);  // the preconditioner
    for (std::size_t i = 0; i < n; ++i)
        if (const double diagonal = a.diagonal(i); diagonal > 0) inverse[i] = 1 / diagonal;
    DenseMatrix& solution = x;
    DenseMatrix residual(n, width), direction(n, width), product(n, width);
    Array<double> norm(width), rr(width), rz(width), rz_before(width), steps(width), reference(width);
    Array<unsigned char> runs(width, 1);
    const auto release = [&](DenseMatrix& rows) {  // held entries have no residual
        for (const HeldEntry& entry : held) rows(entry.row, entry.column) = 0;
    };
    // At first `direction` has only the held entries of the solution, whose product is part of B's side.
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
        for (std::size_t i = 0; i < n && norm[k] == 0; ++i)
            if (inverse[i] > 0) solution(i, k) = direction(i, k);
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

    // The residual that the iteration updates drifts from the true one by rounding; a column has converged when the true one is
    // small. Otherwise the column starts again from there, unless the last start lowered its residual by less than a factor of 2.
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
