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

/// A solve under way: all columns at once, each until it has converged.
class PcgRun {
  public:
    /// Of the system of solve_pcg(), whose parameters these are; all must outlive the run.
    PcgRun(const SymmetricMatrix& a, const DenseMatrix& b, DenseMatrix& x, const PcgOptions& options,
           const std::vector<HeldEntry>& held)
        : a_(&a), b_(&b), solution_(&x), options_(options), held_(&held), n_(b.rows), width_(b.columns), inverse_(n_, 0.0),
          residual_(n_, width_), direction_(n_, width_), product_(n_, width_), norm_(width_), rr_(width_), rz_(width_),
          rz_before_(width_), steps_(width_), reference_(width_), runs_(width_, 1) {
        for (std::size_t i = 0; i < n_; ++i)
            if (const double diagonal = a.diagonal(i); diagonal > 0) inverse_[i] = 1 / diagonal;
    }

    PcgReport run() {
        find_norms();
        for (bool is_first = true; start(is_first) && report_.iterations < options_.max_iterations; is_first = false) {
            std::fill(direction_.values.begin(), direction_.values.end(), 0.0);
            rz_before_ = rz_;  // the first direction is z itself: its factor multiplies 0
            while (is_any_running() && report_.iterations < options_.max_iterations) iterate();
        }
        report_.converged = true;
        for (std::size_t k = 0; k < width_; ++k) {
            if (norm_[k] > 0) report_.residual = std::max(report_.residual, std::sqrt(rr_[k]) / norm_[k]);
            report_.converged = report_.converged && is_small(k);
        }
        return report_;
    }

  private:
    /// The norms of B's columns, what held entries give being part of B's side. Sets solutions of columns of 0.
    void find_norms() {
        // At first the direction has only the held entries of the solution.
        for (const HeldEntry& entry : *held_) direction_(entry.row, entry.column) = (*solution_)(entry.row, entry.column);
        if (!held_->empty()) multiply(*a_, direction_, product_);
        subtract_product();
        column_dots(residual_, residual_, norm_);
        for (std::size_t k = 0; k < width_; ++k) {
            norm_[k] = std::sqrt(norm_[k]);
            for (std::size_t i = 0; i < n_ && norm_[k] == 0; ++i)
                if (inverse_[i] > 0) (*solution_)(i, k) = direction_(i, k);
        }
    }
    /// Finds the true residual, from which that of the iteration drifts by rounding, and the columns that go on from there: a
    /// column has converged when the true one is small, and does not start again where the last start lowered its residual by
    /// less than a factor of 2. Returns whether any goes on.
    bool start(bool is_first) {
        multiply(*a_, *solution_, product_);
        subtract_product();
        measure();
        for (std::size_t k = 0; k < width_; ++k) {
            runs_[k] = !is_small(k) && rz_[k] > 0 && (is_first || rr_[k] <= 0.25 * reference_[k]);
            reference_[k] = rr_[k];
        }
        return is_any_running();
    }
    /// One step of all columns that run, along directions that are conjugate to those before.
    void iterate() {
        for (std::size_t i = 0; i < n_; ++i)
            for (std::size_t k = 0; k < width_; ++k)
                if (runs_[k] != 0) direction_(i, k) = residual_(i, k) * inverse_[i] + rz_[k] / rz_before_[k] * direction_(i, k);
        multiply(*a_, direction_, product_);
        release(product_);
        column_dots(direction_, product_, steps_);
        for (std::size_t k = 0; k < width_; ++k) {
            if (!(steps_[k] > 0)) runs_[k] = 0;  // the direction has no energy: a singular matrix, or rounding
            steps_[k] = runs_[k] != 0 ? rz_[k] / steps_[k] : 0.0;
        }
        for (std::size_t i = 0; i < n_; ++i)
            for (std::size_t k = 0; k < width_; ++k) {
                (*solution_)(i, k) += steps_[k] * direction_(i, k);
                residual_(i, k) -= steps_[k] * product_(i, k);
            }
        rz_before_ = rz_;
        measure();
        ++report_.iterations;
        for (std::size_t k = 0; k < width_; ++k)
            if (is_small(k) || !(rz_[k] > 0)) runs_[k] = 0;
    }

    /// The residual is B less the product.
    void subtract_product() {
        for (std::size_t i = 0; i < residual_.values.size(); ++i) residual_.values[i] = b_->values[i] - product_.values[i];
        release(residual_);
    }
    /// Held entries have no residual.
    void release(DenseMatrix& rows) const {
        for (const HeldEntry& entry : *held_) rows(entry.row, entry.column) = 0;
    }
    /// The products r r, and r z with z = r / diagonal.
    void measure() {
        std::fill(rr_.begin(), rr_.end(), 0.0);
        std::fill(rz_.begin(), rz_.end(), 0.0);
        for (std::size_t i = 0; i < n_; ++i)
            for (std::size_t k = 0; k < width_; ++k) {
                const double r = residual_(i, k);
                rr_[k] += r * r;
                rz_[k] += r * r * inverse_[i];
            }
    }
    [[nodiscard]] bool is_small(std::size_t k) const { return std::sqrt(rr_[k]) <= options_.tolerance * norm_[k]; }
    [[nodiscard]] bool is_any_running() const {
        return std::any_of(runs_.begin(), runs_.end(), [](unsigned char runs) { return runs != 0; });
    }

    const SymmetricMatrix* a_;
    const DenseMatrix* b_;
    DenseMatrix* solution_;
    PcgOptions options_;
    const std::vector<HeldEntry>* held_;
    std::size_t n_, width_;
    Array<double> inverse_;  ///< the preconditioner; 0 where the diagonal is not positive
    DenseMatrix residual_, direction_, product_;
    Array<double> norm_, rr_, rz_, rz_before_, steps_, reference_;  ///< of each column
    Array<unsigned char> runs_;                                     ///< whether a column goes on
    PcgReport report_;
};

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
    return detail::PcgRun(a, b, x, options, held).run();
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_SOLVE_PCG_HPP
