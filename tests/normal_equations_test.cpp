#include "hmesh/solve/normal_equations.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "hmesh/fit/raster.hpp"
#include "hmesh/solve/eigen.hpp"
#include "jittered_mesh.hpp"

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using test::Sample;

// n_p by C: the image as the definition of the normal equations has it, transposed.
template <class T, int C>
MatrixXd pixels(const hmesh::Image<T, C>& image) {
    MatrixXd m(image.width() * image.height(), C);
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x)
            for (int k = 0; k < C; ++k) m(y * image.width() + x, k) = hmesh::PixelTraits<T>::to_real(image.pixel(x, y)[k]);
    return m;
}

MatrixXd centers(int width, int height) {  // n_p by 2
    MatrixXd m(width * height, 2);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) m.row(y * width + x) << x + 0.5, y + 0.5;
    return m;
}

double largest(const MatrixXd& m) { return m.size() == 0 ? 0 : m.cwiseAbs().maxCoeff(); }

template <class T, int C>
void check_normal_equations(std::uint64_t seed) {
    CAPTURE(C);
    Sample<T, C> s(test::noise<T, C>(47, 34, seed));
    test::jitter(s.mesh, 6, 5, 150, seed);
    REQUIRE(s.mesh.topology().vertex_slots() > s.mesh.vertex_count());
    const Eigen::SparseMatrix<double> k = barycentric_matrix(s.mesh);
    const MatrixXd gram = MatrixXd(k * k.transpose());
    const Eigen::SparseMatrix<double> from_moments = gram_matrix(s.mesh);
    const MatrixXd image = pixels(s.image), expected = k * image, points = k * centers(47, 34);
    CHECK(largest(MatrixXd(from_moments) - gram) <= 1e-9 * largest(gram));
    CHECK(largest(image_rhs(s.mesh) - expected) <= 1e-9 * largest(expected));
    CHECK(largest(position_rhs(s.mesh) - points) <= 1e-9 * largest(points));
    // The energy that the mesh reports is the error of I(V) K.
    const double energy = (k.transpose() * color_matrix(s.mesh) - image).squaredNorm();
    CHECK(std::abs(s.mesh.energy() - energy) <= 1e-9 * energy);
}

}  // namespace

TEST_CASE("every pixel is in exactly one face, the one whose moments count it") {
    Sample<std::uint8_t, 1> s(test::noise<std::uint8_t, 1>(53, 31, 2));
    // Whole and half pixels put many centres on edges and vertices.
    const std::vector<double> x = {0, 7.5, 12, 30.5, 41.25, 53}, y = {0, 4.5, 11.5, 20, 31};
    std::vector<hmesh::kit::Point> points;
    for (const double b : y)
        for (const double a : x) points.push_back({a, b});
    REQUIRE(s.mesh.assign(points, test::grid_triangles(5, 4)));
    std::vector<int> owners(53 * 31, 0);
    for (const hmesh::kit::Face f : s.mesh.topology().faces()) {
        const auto v = s.mesh.topology().vertices(f);
        const hmesh::kit::Point a = s.mesh.position(v[0]), b = s.mesh.position(v[1]), c = s.mesh.position(v[2]);
        double count = 0, sum = 0;
        int row = -1;
        hmesh::kit::for_each_span(a, c, b, {}, [&](int j, int begin, int end) {
            CHECK(j > row);
            CHECK(begin < end);
            row = j;
            for (int i = begin; i < end; ++i) {
                const hmesh::kit::Barycentric w = hmesh::kit::barycentric(a, b, c, {i + 0.5, j + 0.5});
                CHECK(std::min(w.a, std::min(w.b, w.c)) > -1e-12);
                ++owners[static_cast<std::size_t>(j * 53 + i)];
                count += 1;
                sum += s.image.pixel(i, j)[0];
            }
        });
        hmesh::kit::Moments<1> m;
        s.mesh.face_moments(f, m);
        CHECK(m.s[1] == count);
        CHECK(m.s[0] == sum);
    }
    CHECK(std::count(owners.begin(), owners.end(), 1) == 53 * 31);
}

TEST_CASE("K K^T, K I^T and K P^T from moments are those of K itself, for 8-bit images") {
    check_normal_equations<std::uint8_t, 1>(11);
    check_normal_equations<std::uint8_t, 3>(12);
    check_normal_equations<std::uint8_t, 5>(13);
}
TEST_CASE("K K^T, K I^T and K P^T from moments are those of K itself, for 16-bit images") {
    check_normal_equations<std::uint16_t, 1>(14);
    check_normal_equations<std::uint16_t, 3>(15);
    check_normal_equations<std::uint16_t, 5>(16);
}
TEST_CASE("K K^T, K I^T and K P^T from moments are those of K itself, for float images") {
    check_normal_equations<float, 1>(17);
    check_normal_equations<float, 3>(18);
    check_normal_equations<float, 5>(19);
}

TEST_CASE("slivers and faces without pixels lose nothing: each entry of K K^T is as exact as its pixels") {
    // One vertex 1/256 px off the diagonal of a large square far from the origin.
    Sample<std::uint8_t, 1> s(test::noise<std::uint8_t, 1>(600, 500, 3));
    REQUIRE(s.mesh.assign({{0, 0}, {600, 0}, {600, 500}, {0, 500}, {300.0 + 1.0 / 256, 250}},
                          {{0, 1, 4}, {1, 2, 4}, {2, 0, 4}, {0, 2, 3}}));
    const Eigen::SparseMatrix<double> k = barycentric_matrix(s.mesh);
    const MatrixXd expected = MatrixXd(k * k.transpose()), actual = MatrixXd(gram_matrix(s.mesh));
    for (Index i = 0; i < 5; ++i)
        for (Index j = 0; j < 5; ++j) CHECK(std::abs(actual(i, j) - expected(i, j)) <= 1e-9 * (std::abs(expected(i, j)) + 1e-3));
}

TEST_CASE("K K^T is symmetric to the bit and has an entry for each vertex and for each edge either way") {
    Sample<float, 3> s(test::noise<float, 3>(40, 30, 4));
    test::jitter(s.mesh, 7, 5, 200, 4);
    const Eigen::SparseMatrix<double> gram = gram_matrix(s.mesh);
    CHECK(gram.nonZeros() == static_cast<Index>(s.mesh.vertex_count() + 2 * s.mesh.topology().edge_count()));
    CHECK(gram.isCompressed());
    CHECK(largest(MatrixXd(gram) - MatrixXd(gram).transpose()) == 0);
    double sum = 0;
    for (Index i = 0; i < gram.outerSize(); ++i) {
        Index before = -1;
        for (Eigen::SparseMatrix<double>::InnerIterator it(gram, i); it; ++it) {
            CHECK(it.index() > before);
            before = it.index();
            sum += it.value();
        }
    }
    CHECK(std::abs(sum - 40 * 30) < 1e-9);  // the hat functions sum to 1 at each pixel
}

TEST_CASE("the diagonal of a symmetric matrix is found in rows that store it, and can be added to there") {
    hmesh::kit::SymmetricMatrix matrix;
    CHECK(matrix.size() == 0);
    matrix.starts = {0, 2, 3, 5};
    matrix.columns = {0, 2, 2, 0, 1};
    matrix.values = {4, -1, 9, -1, 9};
    CHECK(matrix.size() == 3);
    CHECK(matrix.diagonal(0) == 4);
    CHECK(matrix.diagonal(1) == 0);
    CHECK(matrix.diagonal(2) == 0);
    matrix.add_to_diagonal(0, 0.5);
    CHECK(matrix.values == std::vector<double>{4.5, -1, 9, -1, 9});
    hmesh::kit::DenseMatrix dense(2, 3);
    dense(1, 2) = 7;
    CHECK(dense.values == std::vector<double>{0, 0, 0, 0, 0, 7});
}

TEST_CASE("the normal equations are those that Eigen's matrices hold, and the corners of unused half-edges are zero") {
    Sample<std::uint8_t, 3> s(test::noise<std::uint8_t, 3>(40, 30, 6));
    test::jitter(s.mesh, 7, 5, 200, 6);
    const auto& topology = s.mesh.topology();
    const auto corners = corner_sums(s.mesh);
    REQUIRE(corners.size() == 2 * topology.edge_slots());
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const hmesh::kit::Halfedge h(i);
        if (!topology.is_deleted(hmesh::kit::HalfedgeMesh::edge(h)) && !topology.is_boundary(h)) continue;
        CHECK((corners[i].square == 0 && corners[i].coupling == 0 && corners[i].image.sum() == 0));
    }
    const hmesh::kit::SymmetricMatrix matrix = normal_matrix(topology, corners);
    const Eigen::SparseMatrix<double> gram = gram_matrix(s.mesh);
    REQUIRE(matrix.size() == s.mesh.vertex_count());
    for (std::size_t i = 0; i < matrix.size(); ++i)
        CHECK(matrix.diagonal(i) == gram.coeff(static_cast<Index>(i), static_cast<Index>(i)));
    CHECK(largest(to_eigen(image_sums(topology, corners)) - image_rhs(s.mesh)) == 0);
    CHECK(largest(to_eigen(position_sums(topology, corners)) - position_rhs(s.mesh)) == 0);
}

TEST_CASE("any executor gives the same bits of the normal equations") {
    Sample<float, 3> s(test::noise<float, 3>(120, 90, 5));
    test::jitter(s.mesh, 40, 30, 300, 5);
    const test::BackwardFor backward;
    CHECK(largest(MatrixXd(gram_matrix(s.mesh, backward) - gram_matrix(s.mesh))) == 0);
    CHECK(largest(image_rhs(s.mesh, backward) - image_rhs(s.mesh)) == 0);
    CHECK(largest(position_rhs(s.mesh, backward) - position_rhs(s.mesh)) == 0);
}
