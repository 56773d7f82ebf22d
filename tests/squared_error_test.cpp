#include "hmesh/fit/squared_error.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "hmesh/fit/edge_moments.hpp"
#include "test_images.hpp"
#include "test_meshes.hpp"

using hmesh::PixelTraits;
using hmesh::kit::Color;
using hmesh::kit::CornerSums;
using hmesh::kit::Face;
using hmesh::kit::Mobility;
using hmesh::kit::Moments;
using hmesh::kit::Point;
using hmesh::kit::VertexState;
using hmesh_test::Subject;

namespace {

template <class T, int C>
void check_faces(std::uint64_t seed) {
    Subject<T, C> subject(hmesh_test::scene<T, C>(29, 34, seed), hmesh_test::jittered_grid(29, 34, 4, 5, seed));
    hmesh_test::wear(subject.mesh, 100, PixelTraits<T>::peak, seed);
    const double slack = 1e-11 * hmesh_test::squares(subject.image);
    for (const Face f : subject.mesh.topology().faces()) {
        const auto v = subject.mesh.topology().vertices(f);
        Moments<C> m;
        subject.mesh.face_moments(f, m);
        const double truth = hmesh_test::brute_energy(subject, f);
        for (std::size_t k = 0; k < 3; ++k) {
            const VertexState<C>&a = subject.mesh.vertex(v[k]), &b = subject.mesh.vertex(v[(k + 1) % 3]);
            const VertexState<C>& c = subject.mesh.vertex(v[(k + 2) % 3]);
            REQUIRE(std::abs(hmesh::kit::face_energy(m, a, b, c) - truth) <= 1e-8 * truth + slack);
            hmesh::kit::FaceFit<C> fit{};
            REQUIRE(hmesh::kit::fit_face(m, a.position, b, c, 0.02, fit));
            REQUIRE(std::abs(fit.energy(a.color) - truth) <= 1e-8 * truth + slack);
        }
    }
}

// Pixel by pixel, with the barycentric weights of each.
template <class T, int C>
void check_corners(std::uint64_t seed) {
    Subject<T, C> subject(hmesh_test::scene<T, C>(29, 34, seed), hmesh_test::jittered_grid(29, 34, 4, 5, seed));
    hmesh_test::wear(subject.mesh, 100, PixelTraits<T>::peak, seed);
    for (const Face f : subject.mesh.topology().faces()) {
        const auto v = subject.mesh.topology().vertices(f);
        const Point p[3] = {subject.mesh.position(v[0]), subject.mesh.position(v[1]), subject.mesh.position(v[2])};
        CornerSums<C> expected[3], sums[3];
        double squares = 0;
        hmesh_test::for_each_pixel(29, 34, p[0], p[1], p[2], [&](int i, int j) {
            const Point at{i + 0.5, j + 0.5};
            const hmesh::kit::Barycentric w = hmesh::kit::barycentric(p[0], p[1], p[2], at);
            const double lambda[3] = {w.a, w.b, w.c};
            for (int k = 0; k < 3; ++k) {
                expected[k].square += lambda[k] * lambda[k];
                expected[k].coupling += lambda[k] * lambda[(k + 1) % 3];
                expected[k].x += lambda[k] * at.x;
                expected[k].y += lambda[k] * at.y;
                for (int c = 0; c < C; ++c) {
                    const double sample = PixelTraits<T>::to_real(subject.image.pixel(i, j)[c]);
                    expected[k].image.set(c, expected[k].image[c] + lambda[k] * sample);
                    squares += sample;
                }
                expected[k].image.set(C, expected[k].image[C] + lambda[k]);
            }
        });
        Moments<C> m;
        subject.mesh.face_moments(f, m);
        hmesh::kit::sum_corners(m, p[0], p[1], p[2], sums[0], sums[1], sums[2]);
        for (int k = 0; k < 3; ++k) {
            REQUIRE(std::abs(sums[k].square - expected[k].square) <= 1e-8 * (1 + expected[k].square));
            REQUIRE(std::abs(sums[k].coupling - expected[k].coupling) <= 1e-8 * (1 + std::abs(expected[k].coupling)));
            REQUIRE(std::abs(sums[k].x - expected[k].x) <= 1e-8 * (1 + expected[k].x));
            REQUIRE(std::abs(sums[k].y - expected[k].y) <= 1e-8 * (1 + expected[k].y));
            for (int c = 0; c <= C; ++c) REQUIRE(std::abs(sums[k].image[c] - expected[k].image[c]) <= 1e-8 * (1 + squares));
        }
    }
}

}  // namespace

TEST_CASE("the energy of a face is that of its pixels, from whichever corner it is computed") {
    check_faces<std::uint8_t, 3>(11);
    check_faces<std::uint16_t, 1>(12);
    check_faces<float, 2>(13);
    check_faces<std::uint8_t, 7>(14);
    check_faces<float, 4>(15);
}

TEST_CASE("a face that is flipped, degenerate or smaller than the bound is refused, one of just that area is not") {
    Subject<std::uint8_t, 1> subject(hmesh_test::scene<std::uint8_t, 1>(16, 16, 1));
    VertexState<1> a{Color<1>::zero(), {4, 4}, Mobility::free}, b{Color<1>::zero(), {8, 4}, Mobility::free};
    const auto fits = [&](Point v, double min_double_area) {
        Moments<1> m, side;
        hmesh::kit::edge_moments(subject.table, v, a.position, m);
        hmesh::kit::edge_moments(subject.table, a.position, b.position, side);
        m += side;
        hmesh::kit::edge_moments(subject.table, b.position, v, side);
        m += side;
        hmesh::kit::FaceFit<1> fit{};
        return hmesh::kit::fit_face(m, v, a, b, min_double_area, fit);
    };
    CHECK(fits({6, 8}, 0.02));
    CHECK(fits({6, 8}, 16));  // 4 * 4
    CHECK_FALSE(fits({6, 8}, 16.001));
    CHECK_FALSE(fits({6, 0}, 0.02));              // flipped
    CHECK_FALSE(fits({6, 4}, 0.02));              // level with its far side
    CHECK_FALSE(fits({4, 4}, 0.02));              // in a corner
    CHECK_FALSE(fits({6, 4 + 1.0 / 256}, 0.02));  // 4 / 256 < 0.02
    CHECK(fits({6, 4 + 2.0 / 256}, 0.02));
}

TEST_CASE("what the corners of a face add to the normal equations is what its pixels add, weight by weight") {
    check_corners<std::uint8_t, 3>(1);
    check_corners<std::uint16_t, 1>(2);
    check_corners<float, 4>(3);
}

TEST_CASE("a face without pixels adds nothing to the normal equations") {
    CornerSums<2> sums[3];
    hmesh::kit::sum_corners(Moments<2>::zero(), {4, 4}, {4.25, 4}, {4, 4.25}, sums[0], sums[1], sums[2]);
    for (const CornerSums<2>& corner : sums) {
        CHECK((corner.square == 0 && corner.coupling == 0 && corner.x == 0 && corner.y == 0));
        CHECK(corner.image.sum() == 0);
    }
}
