#include "hmesh/solve/optimal_colors.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "hmesh/solve/eigen.hpp"
#include "jittered_mesh.hpp"
#include "test_colors.hpp"
#include "test_images.hpp"

using Eigen::MatrixXd;
using hmesh::kit::optimal_colors;
using test::blind_vertex;
using test::colors_of;
using test::energy_with;
using test::no_ridge;
using test::Sample;

TEST_CASE("optimal colours leave no gradient") {
    Sample<std::uint8_t, 3> s(test::noise<std::uint8_t, 3>(80, 60, 1), no_ridge());
    test::jitter(s.mesh, 9, 7, 100, 1);
    const double before = s.mesh.energy();
    const hmesh::kit::PcgReport report = optimal_colors(s.mesh, {500, 1e-12});
    CHECK(report.converged);
    CHECK(report.iterations > 5);
    CHECK(s.mesh.energy() < before);
    CHECK(s.mesh.check());
    const MatrixXd b = image_rhs(s.mesh), gradient = gram_matrix(s.mesh) * color_matrix(s.mesh) - b;
    CHECK(gradient.norm() <= 1e-9 * b.norm());
}

TEST_CASE("any change of an optimal colour raises the energy") {
    Sample<std::uint16_t, 3> s(test::noise<std::uint16_t, 3>(60, 50, 2));
    test::jitter(s.mesh, 7, 5, 100, 2);
    optimal_colors(s.mesh);
    const double best = s.mesh.energy();
    // The ridge holds colours back a little; a second solve starts where the first ended and leaves nothing of that.
    optimal_colors(s.mesh);
    CHECK(s.mesh.energy() <= best);
    for (const hmesh::kit::Vertex v : s.mesh.topology().vertices())
        for (int k = 0; k < 3; ++k)
            for (const double d : {-0.5, 0.5}) CHECK(energy_with(s.mesh, v, k, d) > s.mesh.energy());
}

TEST_CASE("an affine image is reproduced to rounding") {
    hmesh::Image<float, 3> image(70, 50);
    double scale = 0;
    for (int y = 0; y < 50; ++y)
        for (int x = 0; x < 70; ++x)
            for (int k = 0; k < 3; ++k) {  // eighths: exact in float
                image.pixel(x, y)[k] = static_cast<float>(0.125 * (k + 1) * x - 0.25 * y + k);
                scale += std::pow(static_cast<double>(image.pixel(x, y)[k]), 2);
            }
    Sample<float, 3> s(std::move(image));
    test::jitter(s.mesh, 8, 6, 150, 3);
    CHECK(s.mesh.energy() > scale);
    CHECK(optimal_colors(s.mesh, {500, 1e-12}).converged);
    CHECK(optimal_colors(s.mesh, {500, 1e-12}).converged);
    CHECK(s.mesh.energy() < 1e-6 * scale);
    for (const hmesh::kit::Vertex v : s.mesh.topology().vertices())
        for (int k = 0; k < 3; ++k) {
            const hmesh::kit::Point p = s.mesh.position(v);
            const double expected = 0.125 * (k + 1) * (p.x - 0.5) - 0.25 * (p.y - 0.5) + k;
            CHECK(std::abs(s.mesh.color(v)[k] - expected) < 0.01);
        }
}

TEST_CASE("vertices without pixels keep their colour") {
    Sample<std::uint8_t, 3> s(test::noise<std::uint8_t, 3>(9, 8, 4));
    test::make_blind_vertex(s);
    const hmesh::kit::Vertex blind(blind_vertex);
    REQUIRE(gram_matrix(s.mesh).coeff(blind_vertex, blind_vertex) == 0);
    auto colors = colors_of(s.mesh);
    const double kept[3] = {17, 200, 93};
    for (int k = 0; k < 3; ++k) colors[blind_vertex].set(k, kept[k]);
    s.mesh.set_colors(colors);
    CHECK(optimal_colors(s.mesh).converged);
    for (int k = 0; k < 3; ++k) CHECK(s.mesh.color(blind)[k] == kept[k]);
    CHECK(s.mesh.energy() > 0);
}

TEST_CASE("optimal colours stay within the mesh's bounds, above and below") {
    // One pixel, white among black ones or black among white ones: the corner, whose weight is 0.2 there, would have to be about
    // 1275 beyond the others.
    for (const bool is_white : {true, false}) {
        CAPTURE(is_white);
        auto image = hmesh_test::constant_image<std::uint8_t, 1>(16, 16, is_white ? 0 : 1);
        image.pixel(0, 0)[0] = is_white ? 255 : 0;
        Sample<std::uint8_t, 1> s(std::move(image));
        REQUIRE(s.mesh.assign({{0, 0}, {1.25, 0}, {16, 0}, {16, 16}, {0, 16}, {0, 1.25}},
                              {{0, 1, 5}, {1, 2, 3}, {1, 3, 5}, {5, 3, 4}}));
        optimal_colors(s.mesh);
        double highest = -1e9, lowest = 1e9;
        for (const hmesh::kit::Vertex v : s.mesh.topology().vertices()) {
            highest = std::max(highest, s.mesh.color(v)[0]);
            lowest = std::min(lowest, s.mesh.color(v)[0]);
        }
        CHECK(highest <= s.mesh.color_high());
        CHECK(lowest >= s.mesh.color_low());
        CHECK((is_white ? highest == s.mesh.color_high() : lowest == s.mesh.color_low()));
        CHECK(s.mesh.check());
    }
}

TEST_CASE("any executor gives the same colours to the bit") {
    Sample<std::uint8_t, 5> s(test::noise<std::uint8_t, 5>(90, 70, 10)), t(test::noise<std::uint8_t, 5>(90, 70, 10));
    test::jitter(s.mesh, 30, 24, 100, 10);
    test::jitter(t.mesh, 30, 24, 100, 10);
    optimal_colors(s.mesh);
    optimal_colors(t.mesh, {}, test::BackwardFor());
    CHECK(s.mesh.energy() == t.mesh.energy());
    bool same = true;
    for (const hmesh::kit::Vertex v : s.mesh.topology().vertices())
        for (int k = 0; k < 8; ++k) same = same && s.mesh.color(v)[k] == t.mesh.color(v)[k];
    CHECK(same);
}
