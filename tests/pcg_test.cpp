#include "hmesh/solve/pcg.hpp"

#include <doctest/doctest.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "hmesh/core/random.hpp"
#include "hmesh/solve/eigen.hpp"
#include "hmesh/solve/normal_equations.hpp"
#include "jittered_mesh.hpp"

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using hmesh::kit::HeldEntry;
using hmesh::kit::PcgReport;
using hmesh::kit::Random;
using hmesh::kit::solve_pcg;
using Sparse = Eigen::SparseMatrix<double>;

MatrixXd random_matrix(Index rows, Index columns, Random& random) {
    MatrixXd m(rows, columns);
    for (Index j = 0; j < columns; ++j)
        for (Index i = 0; i < rows; ++i) m(i, j) = 2 * random.uniform() - 1;
    return m;
}

// Positive definite, badly scaled (diagonal over 4 decades) but not ill-conditioned otherwise.
MatrixXd random_spd(Index n, Random& random) {
    const MatrixXd r = random_matrix(n, n, random);
    MatrixXd m = r * r.transpose() / static_cast<double>(n) + 0.2 * MatrixXd::Identity(n, n);
    for (Index i = 0; i < n; ++i) {
        const double scale = std::pow(10, 2 * random.uniform() - 1);
        m.row(i) *= scale;
        m.col(i) *= scale;
    }
    return m;
}

double worst_residual(const Sparse& a, const MatrixXd& b, const MatrixXd& x) {
    double worst = 0;
    for (Index k = 0; k < b.cols(); ++k)
        if (b.col(k).norm() > 0) worst = std::max(worst, (b.col(k) - a * x.col(k)).norm() / b.col(k).norm());
    return worst;
}

template <class Matrix>
decltype(auto) at(Matrix& matrix, const HeldEntry& entry) {
    return matrix(static_cast<Index>(entry.row), static_cast<Index>(entry.column));
}

// What is left of each column when its held entries are taken out of the system as known: by rows, with right-hand side.
struct Reduced {
    std::vector<Index> rows;
    MatrixXd matrix, rhs;
};

Reduced reduce(const MatrixXd& a, const MatrixXd& b, const MatrixXd& x, const std::vector<HeldEntry>& held, Index column) {
    Reduced reduced;
    MatrixXd given = MatrixXd::Zero(a.rows(), 1);
    for (Index i = 0; i < a.rows(); ++i) {
        const bool is_held = std::any_of(held.begin(), held.end(), [&](const HeldEntry& e) {
            return e.row == static_cast<std::size_t>(i) && e.column == static_cast<std::size_t>(column);
        });
        if (is_held) given(i, 0) = x(i, column);
        else reduced.rows.push_back(i);
    }
    const MatrixXd rhs = b.col(column) - a * given;
    const auto n = static_cast<Index>(reduced.rows.size());
    reduced.matrix.resize(n, n);
    reduced.rhs.resize(n, 1);
    for (Index i = 0; i < n; ++i) {
        const Index row = reduced.rows[static_cast<std::size_t>(i)];
        reduced.rhs(i, 0) = rhs(row, 0);
        for (Index j = 0; j < n; ++j) reduced.matrix(i, j) = a(row, reduced.rows[static_cast<std::size_t>(j)]);
    }
    return reduced;
}

}  // namespace

TEST_CASE("solve_pcg finds what a dense factorisation finds, for random positive definite matrices") {
    Random random(1);
    for (const Index n : {1, 2, 7, 40, 120}) {
        const MatrixXd dense = random_spd(n, random), b = random_matrix(n, 4, random);
        const Sparse a = dense.sparseView();
        MatrixXd x = random_matrix(n, 4, random);
        const PcgReport report = solve_pcg(a, b, x, {2000, 1e-13});
        const MatrixXd expected = dense.ldlt().solve(b);
        CAPTURE(n);
        CHECK(report.converged);
        CHECK((x - expected).norm() <= 1e-8 * expected.norm());
    }
}

TEST_CASE("solve_pcg finds what a dense factorisation finds, for the normal equations of a mesh") {
    test::Sample<std::uint8_t, 3> s(test::noise<std::uint8_t, 3>(90, 70, 2));
    test::jitter(s.mesh, 12, 9, 200, 2);
    Sparse a = gram_matrix(s.mesh);
    for (Index i = 0; i < a.rows(); ++i) a.coeffRef(i, i) += 1e-3;
    const MatrixXd b = image_rhs(s.mesh), expected = MatrixXd(a).ldlt().solve(b);
    MatrixXd x = MatrixXd::Zero(b.rows(), 3);
    const PcgReport report = solve_pcg(a, b, x, {400, 1e-12});
    CHECK(report.converged);
    CHECK((x - expected).norm() <= 1e-8 * expected.norm());
}

TEST_CASE("a mesh needs few iterations, whatever its size") {
    for (const int size : {8, 40}) {
        test::Sample<std::uint8_t, 1> s(test::noise<std::uint8_t, 1>(10 * size, 10 * size, 3));
        test::jitter(s.mesh, size, size, 0, 3);
        const MatrixXd b = image_rhs(s.mesh);
        MatrixXd x = MatrixXd::Zero(b.rows(), 1);
        const PcgReport report = solve_pcg(gram_matrix(s.mesh), b, x, {200, 1e-7});
        CHECK(report.converged);
        CHECK(report.iterations <= 30);
        CHECK(report.iterations >= 5);
    }
}

TEST_CASE("the residual and the number of iterations reported are true") {
    Random random(4);
    const MatrixXd dense = random_spd(60, random), b = random_matrix(60, 3, random);
    const Sparse a = dense.sparseView();
    int before = 0;
    for (const double tolerance : {1e-2, 1e-6, 1e-11}) {
        MatrixXd x = MatrixXd::Zero(60, 3);
        const PcgReport report = solve_pcg(a, b, x, {1000, tolerance});
        CHECK(report.converged);
        CHECK(report.residual <= tolerance);
        CHECK(report.residual == doctest::Approx(worst_residual(a, b, x)).epsilon(1e-3));
        CHECK(report.iterations > before);
        before = report.iterations;
        // One iteration less does not do.
        MatrixXd y = MatrixXd::Zero(60, 3);
        const PcgReport shorter = solve_pcg(a, b, y, {report.iterations - 1, tolerance});
        CHECK(!shorter.converged);
        CHECK(shorter.iterations == report.iterations - 1);
        CHECK(shorter.residual > tolerance);
        CHECK(shorter.residual == doctest::Approx(worst_residual(a, b, y)).epsilon(1e-3));
    }
}

// A chain of springs between a point and the next, each held to its place by a weak one: its condition is some 4 / `held`.
Sparse chain(Index n, double held) {
    Sparse a(n, n);
    for (Index i = 0; i < n; ++i) {
        a.insert(i, i) = (i > 0) + (i + 1 < n) + held;
        if (i > 0) a.insert(i, i - 1) = a.insert(i - 1, i) = -1;
    }
    return a;
}

TEST_CASE("where rounding has taken the residual of the iteration from the true one, it goes on until that is small") {
    for (const auto& [held, tolerance] : {std::pair(1e-3, 1e-12), std::pair(1e-5, 1e-10)}) {
        const Sparse a = chain(200, held);
        MatrixXd b(200, 1), x = MatrixXd::Zero(200, 1);
        for (Index i = 0; i < 200; ++i) b(i, 0) = 1 + std::sin(static_cast<double>(i * i));
        const PcgReport report = solve_pcg(a, b, x, {5000, tolerance});
        CHECK(report.converged);
        CHECK(worst_residual(a, b, x) <= tolerance);
    }
}

TEST_CASE("a tolerance below rounding ends by itself, unconverged, at a good solution") {
    Random random(5);
    const MatrixXd dense = random_spd(50, random), b = random_matrix(50, 2, random);
    MatrixXd x = MatrixXd::Zero(50, 2);
    const PcgReport report = solve_pcg(dense.sparseView(), b, x, {100000, 1e-30});
    CHECK(!report.converged);
    CHECK(report.iterations < 2000);
    CHECK(report.residual < 1e-12);
    CHECK((x - dense.ldlt().solve(b)).norm() <= 1e-8 * x.norm());
}

TEST_CASE("right-hand sides do not disturb each other: together or alone, the same bits") {
    Random random(6);
    const MatrixXd dense = random_spd(80, random);
    const Sparse a = dense.sparseView();
    MatrixXd b = random_matrix(80, 4, random), start = random_matrix(80, 4, random);
    start.col(1) = dense.ldlt().solve(b.col(1));  // done before it starts
    b.col(2) *= 1e100;
    b.col(3).setZero();
    MatrixXd x = start;
    CHECK(solve_pcg(a, b, x, {1000, 1e-9}).converged);
    for (Index k = 0; k < 4; ++k) {
        MatrixXd alone = start.col(k);
        CHECK(solve_pcg(a, b.col(k), alone, {1000, 1e-9}).converged);
        CHECK(alone == x.col(k));
    }
    CHECK(x.col(1) == start.col(1));
    CHECK(x.col(3).isZero(0));
}

TEST_CASE("a right-hand side of zero has the solution zero, at once") {
    Random random(7);
    const Sparse a = random_spd(10, random).sparseView();
    MatrixXd x = random_matrix(10, 2, random);
    const PcgReport report = solve_pcg(a, MatrixXd::Zero(10, 2), x);
    CHECK(report.converged);
    CHECK(report.iterations == 0);
    CHECK(report.residual == 0);
    CHECK(x.isZero(0));
}

TEST_CASE("rows of zeros keep their values and disturb no other row") {
    Random random(8);
    MatrixXd dense = random_spd(30, random);
    dense.row(4).setZero(), dense.col(4).setZero();
    dense.row(17).setZero(), dense.col(17).setZero();
    MatrixXd b = random_matrix(30, 2, random);
    b.row(4).setZero(), b.row(17).setZero();
    const MatrixXd start = random_matrix(30, 2, random);
    MatrixXd x = start;
    const PcgReport report = solve_pcg(dense.sparseView(), b, x, {1000, 1e-12});
    CHECK(report.converged);
    CHECK(x.row(4) == start.row(4));
    CHECK(x.row(17) == start.row(17));
    CHECK(worst_residual(dense.sparseView(), b, x) <= 1e-12);

    // Nor does a right-hand side that is zero, whose solution is zero in all other rows.
    MatrixXd z = start;
    CHECK(solve_pcg(dense.sparseView(), MatrixXd::Zero(30, 2), z).converged);
    CHECK(z.row(4) == start.row(4));
    CHECK(z.row(17) == start.row(17));
    z.row(4).setZero(), z.row(17).setZero();
    CHECK(z.isZero(0));

    // Where such a row asks for the impossible, the others are solved all the same, and the report says no.
    b(4, 1) = 1;
    MatrixXd y = start;
    const PcgReport impossible = solve_pcg(dense.sparseView(), b, y, {1000, 1e-12});
    CHECK(!impossible.converged);
    CHECK(impossible.iterations < 1000);
    CHECK(y.allFinite());
    CHECK((y - x).norm() <= 1e-8 * x.norm());
    CHECK(impossible.residual == doctest::Approx(1 / b.col(1).norm()));
}

TEST_CASE("singular, indefinite and empty systems give no NaN") {
    Sparse zero(3, 3);
    MatrixXd x = MatrixXd::Ones(3, 1);
    PcgReport report = solve_pcg(zero, MatrixXd::Ones(3, 1), x);
    CHECK(!report.converged);
    CHECK(x == MatrixXd::Ones(3, 1));
    CHECK(report.residual == doctest::Approx(1));

    MatrixXd ones = MatrixXd::Ones(3, 3);  // singular, with a solution
    x.setZero();
    report = solve_pcg(ones.sparseView(), MatrixXd::Ones(3, 1), x);
    CHECK(report.converged);
    CHECK(x.sum() == doctest::Approx(1));

    MatrixXd difference(2, 2);  // singular, without a solution: along the right-hand side there is no energy
    difference << 1, -1, -1, 1;
    x = MatrixXd::Zero(2, 1);
    report = solve_pcg(difference.sparseView(), MatrixXd::Ones(2, 1), x);
    CHECK(!report.converged);
    CHECK(x == MatrixXd::Zero(2, 1));

    MatrixXd indefinite(2, 2);
    indefinite << 1, 3, 3, 1;
    x = MatrixXd::Zero(2, 1);
    MatrixXd b(2, 1);
    b << 1, -1;
    report = solve_pcg(indefinite.sparseView(), b, x);
    CHECK(!report.converged);
    CHECK(x.allFinite());
    CHECK(std::isfinite(report.residual));

    MatrixXd none(0, 3);
    CHECK(solve_pcg(Sparse(0, 0), MatrixXd(0, 3), none).converged);
    MatrixXd no_columns(3, 0);
    CHECK(solve_pcg(zero, MatrixXd(3, 0), no_columns).converged);
}

TEST_CASE("held entries keep their bits, and the others solve the system without them, column by column") {
    Random random(11);
    for (const Index n : {1, 2, 9, 60}) {
        const MatrixXd dense = random_spd(n, random), start = random_matrix(n, 4, random);
        MatrixXd b = random_matrix(n, 4, random);
        std::vector<HeldEntry> held;  // none in column 0, all in column 3
        for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i)
            for (std::size_t k = 1; k < 4; ++k)
                if (k == 3 || random.below(3) == 0) held.push_back({i, k});
        for (const HeldEntry& entry : held) at(b, entry) = 1e300;
        MatrixXd x = start;
        const PcgReport report = solve_pcg(dense.sparseView(), b, x, {2000, 1e-12}, held);
        CAPTURE(n);
        CHECK(report.converged);
        for (const HeldEntry& entry : held) CHECK(at(x, entry) == at(start, entry));
        double residual = 0;
        for (Index k = 0; k < 4; ++k) {
            const Reduced reduced = reduce(dense, b, start, held, k);
            if (reduced.rows.empty()) continue;
            const MatrixXd expected = reduced.matrix.ldlt().solve(reduced.rhs);
            MatrixXd actual(expected.rows(), 1);
            for (Index i = 0; i < actual.rows(); ++i) actual(i, 0) = x(reduced.rows[static_cast<std::size_t>(i)], k);
            CHECK((actual - expected).norm() <= 1e-8 * expected.norm());
            residual = std::max(residual, (reduced.rhs - reduced.matrix * actual).norm() / reduced.rhs.norm());
        }
        CHECK(report.residual <= 1e-12);
        CHECK(std::abs(report.residual - residual) <= 1e-13);
    }
}

TEST_CASE("held entries are what the residual is relative to, whatever the right-hand side") {
    Random random(12);
    const MatrixXd dense = random_spd(40, random), start = random_matrix(40, 3, random);
    MatrixXd b = random_matrix(40, 3, random);
    b.col(0).setZero();  // only what is held asks for something
    b.col(1) *= 1e-9;    // far less than what is held
    const std::vector<HeldEntry> held = {{3, 0}, {17, 0}, {5, 1}, {0, 2}};
    for (const double tolerance : {1e-3, 1e-10}) {
        MatrixXd x = start;
        const PcgReport report = solve_pcg(dense.sparseView(), b, x, {2000, tolerance}, held);
        CHECK(report.converged);
        double residual = 0;
        for (Index k = 0; k < 3; ++k) {
            const Reduced reduced = reduce(dense, b, start, held, k);
            MatrixXd actual(static_cast<Index>(reduced.rows.size()), 1);
            for (Index i = 0; i < actual.rows(); ++i) actual(i, 0) = x(reduced.rows[static_cast<std::size_t>(i)], k);
            residual = std::max(residual, (reduced.rhs - reduced.matrix * actual).norm() / reduced.rhs.norm());
        }
        CHECK(residual <= tolerance);
        CHECK(report.residual == doctest::Approx(residual).epsilon(1e-3));
    }
}

TEST_CASE("entries held at zero beside a right-hand side of zero give zero, at once") {
    Random random(13);
    MatrixXd x = random_matrix(20, 1, random);
    x(4, 0) = 0;
    const PcgReport report = solve_pcg(random_spd(20, random).sparseView(), MatrixXd::Zero(20, 1), x, {}, {{4, 0}});
    CHECK(report.converged);
    CHECK(report.iterations == 0);
    CHECK(x.isZero(0));
}
