#include "hmesh/solve/eigen.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "hmesh/fit/image_source.hpp"
#include "hmesh/mesh/delaunay.hpp"
#include "jittered_mesh.hpp"

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using hmesh::kit::DenseMatrix;
using hmesh::kit::SymmetricMatrix;
using test::Sample;

MatrixXd centers(int width, int height) {  // n_p by 2
    MatrixXd m(width * height, 2);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) m.row(y * width + x) << x + 0.5, y + 0.5;
    return m;
}

double largest(const MatrixXd& m) { return m.size() == 0 ? 0 : m.cwiseAbs().maxCoeff(); }

}  // namespace

TEST_CASE("the columns of K are barycentric coordinates: at most 3 entries, none negative, sum 1") {
    Sample<std::uint8_t, 3> s(test::noise<std::uint8_t, 3>(40, 30, 1));
    test::jitter(s.mesh, 7, 5, 200, 1);
    const Eigen::SparseMatrix<double> k = barycentric_matrix(s.mesh);
    REQUIRE(k.rows() == static_cast<Index>(s.mesh.vertex_count()));
    REQUIRE(k.cols() == 40 * 30);
    for (Index p = 0; p < k.cols(); ++p) {
        int count = 0;
        double sum = 0, least = 1;
        Index before = -1;
        for (Eigen::SparseMatrix<double>::InnerIterator it(k, p); it; ++it, ++count) {
            CHECK(it.index() > before);
            before = it.index();
            sum += it.value();
            least = std::min(least, it.value());
        }
        CHECK(count <= 3);
        CHECK(std::abs(sum - 1) < 1e-14);
        CHECK(least > -1e-12);
    }
}

TEST_CASE("V K is the positions of the pixels") {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        Sample<std::uint8_t, 1> s(test::noise<std::uint8_t, 1>(64, 45, seed));
        test::jitter(s.mesh, 9, 7, 300, seed);
        const Eigen::SparseMatrix<double> k = barycentric_matrix(s.mesh);
        CHECK(largest(k.transpose() * position_matrix(s.mesh) - centers(64, 45)) < 1e-9);
        // Hence K K^T V^T = K P^T: the paper's 2-D solve for positions has no reason to move.
        const MatrixXd residual = gram_matrix(s.mesh) * position_matrix(s.mesh) - position_rhs(s.mesh);
        CHECK(largest(residual) <= 1e-9 * largest(position_rhs(s.mesh)));
    }
}

TEST_CASE("samples that are points have their columns of K too, those on the far sides of the mesh among them") {
    const auto image = test::noise<std::uint8_t, 1>(12, 9, 3);
    const auto source = hmesh::kit::ImageSource<1>(image.view()).with_samples(hmesh::Samples::points);
    const hmesh::kit::MomentTable<1> table = source.table({0, 0, 12, 9});
    hmesh::kit::Delaunay delaunay(12, 9, hmesh::Samples::points);
    for (const auto& [x, y] : {std::pair(3.5, 2.25), std::pair(11.5, 4.0), std::pair(7.0, 8.5), std::pair(6.5, 4.5)})
        delaunay.insert({x, y});
    hmesh::kit::ImageMesh<1> mesh(table, 0, 255);
    REQUIRE(mesh.assign(delaunay.positions(), delaunay.topology().triangles()));
    CHECK(largest(barycentric_matrix(mesh).transpose() * position_matrix(mesh) - centers(12, 9)) < 1e-9);
}

TEST_CASE("I(V) has the colours of the vertices, row by row, and V their places") {
    Sample<std::uint16_t, 3> s(test::noise<std::uint16_t, 3>(40, 30, 6));
    test::jitter(s.mesh, 7, 5, 200, 6);
    const MatrixXd colors = color_matrix(s.mesh), positions = position_matrix(s.mesh);
    REQUIRE(colors.rows() == static_cast<Index>(s.mesh.vertex_count()));
    REQUIRE(colors.cols() == 3);
    REQUIRE(positions.rows() == colors.rows());
    Index row = 0;
    for (const hmesh::kit::Vertex v : s.mesh.topology().vertices()) {
        for (int k = 0; k < 3; ++k) CHECK(colors(row, k) == s.mesh.color(v)[k]);
        CHECK(positions(row, 0) == s.mesh.position(v).x);
        CHECK(positions(row, 1) == s.mesh.position(v).y);
        ++row;
    }
}

TEST_CASE("colours that are set are those that are read, and the energy follows") {
    Sample<std::uint8_t, 3> s(test::noise<std::uint8_t, 3>(40, 30, 7));
    test::jitter(s.mesh, 7, 5, 200, 7);
    const MatrixXd before = color_matrix(s.mesh), after = 255 * MatrixXd::Identity(before.rows(), 3);
    const double energy = s.mesh.energy();
    set_colors(s.mesh, after);
    CHECK(color_matrix(s.mesh) == after);
    CHECK(s.mesh.energy() != energy);
    REQUIRE(s.mesh.check());
    set_colors(s.mesh, before);
    CHECK(s.mesh.energy() == doctest::Approx(energy).epsilon(1e-12));
}

TEST_CASE("the plain arrays of the normal equations are Eigen's matrices and back, to the bit") {
    Sample<std::uint8_t, 3> s(test::noise<std::uint8_t, 3>(40, 30, 7));
    test::jitter(s.mesh, 7, 5, 200, 7);
    const auto corners = corner_sums(s.mesh);
    const SymmetricMatrix matrix = normal_matrix(s.mesh.topology(), corners), again = hmesh::kit::from_eigen(to_eigen(matrix));
    CHECK(again.starts == matrix.starts);
    CHECK(again.columns == matrix.columns);
    CHECK(again.values == matrix.values);
    const DenseMatrix sums = image_sums(s.mesh.topology(), corners);
    const MatrixXd dense = to_eigen(sums);
    REQUIRE(dense.rows() == static_cast<Index>(sums.rows));
    REQUIRE(dense.cols() == 3);
    CHECK(dense(4, 2) == sums(4, 2));
    const DenseMatrix back = hmesh::kit::from_eigen(dense);
    CHECK(back.rows == sums.rows);
    CHECK(back.columns == sums.columns);
    CHECK(back.values == sums.values);
    CHECK(largest(to_eigen(position_sums(s.mesh.topology(), corners)) - position_rhs(s.mesh)) == 0);
}

TEST_CASE("solve_pcg gives the same bits over Eigen's matrices as over plain arrays") {
    Sample<std::uint8_t, 3> s(test::noise<std::uint8_t, 3>(40, 30, 8));
    test::jitter(s.mesh, 7, 5, 200, 8);
    const auto corners = corner_sums(s.mesh);
    const SymmetricMatrix matrix = normal_matrix(s.mesh.topology(), corners);
    const DenseMatrix rhs = image_sums(s.mesh.topology(), corners);
    const std::vector<hmesh::kit::HeldEntry> held = {{0, 0}, {3, 2}};
    DenseMatrix plain(rhs.rows, 3);
    plain(3, 2) = 17;
    MatrixXd wrapped = to_eigen(plain);
    const auto expected = hmesh::kit::solve_pcg(matrix, rhs, plain, {200, 1e-9}, held);
    const auto report = hmesh::kit::solve_pcg(to_eigen(matrix), to_eigen(rhs), wrapped, {200, 1e-9}, held);
    CHECK(report.iterations == expected.iterations);
    CHECK(report.residual == expected.residual);
    CHECK(report.converged);
    CHECK(largest(wrapped - to_eigen(plain)) == 0);
    CHECK(wrapped(3, 2) == 17);
}

TEST_CASE("any executor gives the same bits of K") {
    Sample<float, 3> s(test::noise<float, 3>(120, 90, 5));
    test::jitter(s.mesh, 40, 30, 300, 5);
    CHECK(largest(MatrixXd(barycentric_matrix(s.mesh, test::BackwardFor()) - barycentric_matrix(s.mesh))) == 0);
}
