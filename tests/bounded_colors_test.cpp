#include "hmesh/solve/bounded_colors.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include "hmesh/solve/eigen.hpp"
#include "hmesh/solve/optimal_colors.hpp"
#include "jittered_mesh.hpp"
#include "test_colors.hpp"

using Eigen::Index;
using Eigen::MatrixXd;
using hmesh::kit::bounded_colors;
using hmesh::kit::optimal_colors;
using test::all_allowed;
using test::blind_vertex;
using test::colors_of;
using test::energy_with;
using test::no_ridge;
using test::Sample;

TEST_CASE("vertices without pixels keep their colour") {
    Sample<std::uint8_t, 3> s(test::noise<std::uint8_t, 3>(9, 8, 4));
    test::make_blind_vertex(s);
    const hmesh::kit::Vertex blind(blind_vertex);
    REQUIRE(gram_matrix(s.mesh).coeff(blind_vertex, blind_vertex) == 0);
    auto colors = colors_of(s.mesh);
    const double kept[3] = {17, 200, 93};
    for (int k = 0; k < 3; ++k) colors[blind_vertex].set(k, kept[k]);
    s.mesh.set_colors(colors);
    bounded_colors(s.mesh, {0, 255, 1});
    for (int k = 0; k < 3; ++k) CHECK(s.mesh.color(blind)[k] == kept[k]);
    CHECK(s.mesh.energy() > 0);

    // Out of range or off the grid, it goes to the nearest that is allowed; without any ridge, too.
    Sample<std::uint8_t, 3> t(test::noise<std::uint8_t, 3>(9, 8, 4), no_ridge(0));
    test::make_blind_vertex(t);
    const double odd[3] = {-40, 99.6, 300}, allowed[3] = {0, 100, 255};
    for (int k = 0; k < 3; ++k) colors[blind_vertex].set(k, odd[k]);
    t.mesh.set_colors(colors);
    bounded_colors(t.mesh, {0, 255, 1});
    for (int k = 0; k < 3; ++k) CHECK(t.mesh.color(blind)[k] == allowed[k]);
}

TEST_CASE("where the best colour lies far out of range, bounded colours stay in it") {
    // One white pixel, black ones around: the corner, whose weight is 0.2 there, would have to be about 1275.
    hmesh::Image<std::uint8_t, 1> image(16, 16);
    image.pixel(0, 0)[0] = 255;
    Sample<std::uint8_t, 1> s(std::move(image));
    REQUIRE(
        s.mesh.assign({{0, 0}, {1.25, 0}, {16, 0}, {16, 16}, {0, 16}, {0, 1.25}}, {{0, 1, 5}, {1, 2, 3}, {1, 3, 5}, {5, 3, 4}}));
    optimal_colors(s.mesh);
    REQUIRE_FALSE(all_allowed(s.mesh, 0, 255, 0));
    bounded_colors(s.mesh, {0, 255, 1});
    CHECK(all_allowed(s.mesh, 0, 255, 1));
}

TEST_CASE("no single step of one channel lowers the energy of bounded colours") {
    int at_bounds = 0;
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        Sample<std::uint8_t, 3> s(test::noise<std::uint8_t, 3>(30, 26, seed), no_ridge());
        test::jitter(s.mesh, 6, 5, 60, seed);
        optimal_colors(s.mesh);
        const double grid = seed % 2 == 0 ? 1 : 4, low = 40, high = 200;
        const hmesh::kit::BoundedReport report = bounded_colors(s.mesh, {low, high, grid});
        REQUIRE(report.converged);
        CHECK(report.rounding_sweeps >= 1);
        CHECK(report.rounding_sweeps <= 10);
        CHECK(s.mesh.check());
        CHECK(all_allowed(s.mesh, low, high, grid));
        const double energy = s.mesh.energy();
        for (const hmesh::kit::Vertex v : s.mesh.topology().vertices())
            for (int k = 0; k < 3; ++k)
                for (const double d : {-grid, grid}) {
                    const double moved = s.mesh.color(v)[k] + d;
                    if (moved < low || moved > high) ++at_bounds;
                    else CHECK(energy_with(s.mesh, v, k, d) >= energy * (1 - 1e-9));
                }
    }
    CHECK(at_bounds > 20);
}

TEST_CASE("locked vertices keep their colours, and the others have the best beside them") {
    for (const double grid : {0.0, 1.0}) {
        CAPTURE(grid);
        Sample<std::uint8_t, 3> s(test::noise<std::uint8_t, 3>(30, 26, 3), no_ridge());
        test::jitter(s.mesh, 6, 5, 60, 3);
        auto colors = colors_of(s.mesh);
        const auto is_locked = [](hmesh::kit::Vertex v) { return v.index() % 3 == 0; };
        for (const hmesh::kit::Vertex v : s.mesh.topology().vertices()) {
            if (!is_locked(v)) continue;
            for (int k = 0; k < 3; ++k) colors[v.index()].set(k, 10.0 + 40 * k + static_cast<double>(v.index()));  // any
            s.mesh.lock(v, s.mesh.topology().valence(v));
        }
        s.mesh.set_colors(colors);
        REQUIRE(bounded_colors(s.mesh, {0, 255, grid}).converged);
        CHECK(s.mesh.check());
        const double energy = s.mesh.energy(), step = grid > 0 ? grid : 0.01;
        int locked = 0, would_move = 0;
        for (const hmesh::kit::Vertex v : s.mesh.topology().vertices())
            for (int k = 0; k < 3; ++k) {
                const double now = s.mesh.color(v)[k];
                double lowest = energy;
                for (const double d : {-step, step})
                    if (now + d >= 0 && now + d <= 255) lowest = std::min(lowest, energy_with(s.mesh, v, k, d));
                if (is_locked(v)) {
                    CHECK(now == colors[v.index()][k]);
                    ++locked;
                    would_move += lowest < energy * (1 - 1e-9) ? 1 : 0;
                } else {
                    CHECK(lowest >= energy * (1 - 1e-9));
                }
            }
        CHECK(locked > 30);
        CHECK(2 * would_move > locked);

        // Unlocked for this once, they get the best ones too: those that the mesh gets from there without locks.
        Sample<std::uint8_t, 3> free(test::noise<std::uint8_t, 3>(30, 26, 3), no_ridge());
        test::jitter(free.mesh, 6, 5, 60, 3);
        free.mesh.set_colors(colors_of(s.mesh));
        REQUIRE(bounded_colors(free.mesh, {0, 255, grid}).converged);
        REQUIRE(bounded_colors(s.mesh, {0, 255, grid}, {}, {}, true).converged);
        CHECK(s.mesh.energy() < energy);
        const auto with = colors_of(s.mesh), without = colors_of(free.mesh);
        for (std::size_t v = 0; v < with.size(); ++v)
            for (int k = 0; k < 3; ++k) CHECK(with[v][k] == without[v][k]);
        CHECK(s.mesh.check());
    }
}

TEST_CASE("bounded colours without a grid are the minimum over the box: the gradient points out of it or is zero") {
    Sample<float, 3> s(test::noise<float, 3>(60, 50, 7), no_ridge());
    test::jitter(s.mesh, 9, 7, 0, 7);
    optimal_colors(s.mesh);
    CHECK(bounded_colors(s.mesh, {0, 1, 0}).sweeps > 2);
    CHECK(all_allowed(s.mesh, 0, 1, 0));
    const MatrixXd b = image_rhs(s.mesh), c = color_matrix(s.mesh), gradient = gram_matrix(s.mesh) * c - b;
    int at_bounds = 0;
    for (Index i = 0; i < c.rows(); ++i)
        for (Index k = 0; k < 3; ++k) {
            const double g = gradient(i, k);
            if (c(i, k) == 0 || c(i, k) == 1) ++at_bounds;
            if (c(i, k) < 1) CHECK(g > -1e-4);
            if (c(i, k) > 0) CHECK(g < 1e-4);
        }
    CHECK(at_bounds > 5);
}

TEST_CASE("a channel of large values, which has its colours at once, ends no other's search") {
    const auto colors_beside = [](float large) {
        hmesh::Image<float, 2> image = test::noise<float, 2>(60, 50, 7);
        for (int y = 0; y < 50; ++y)
            for (int x = 0; x < 60; ++x) image.pixel(x, y)[1] = large;
        Sample<float, 2> s(std::move(image), no_ridge());
        test::jitter(s.mesh, 9, 7, 0, 7);
        auto colors = colors_of(s.mesh);
        for (auto& color : colors) color.set(0, 0), color.set(1, static_cast<double>(large));
        s.mesh.set_colors(colors);
        CHECK(bounded_colors(s.mesh, {0, 1e9, 0}).sweeps > 2);
        return colors_of(s.mesh);
    };
    const auto small = colors_beside(1), large = colors_beside(1048576);
    for (std::size_t v = 0; v < small.size(); ++v) CHECK(small[v][0] == large[v][0]);
}

TEST_CASE("a ridge draws colours to those at the start, as strongly as pixels do to theirs") {
    const double ridge = 30;
    Sample<float, 3> s(test::noise<float, 3>(60, 50, 7), no_ridge(ridge));
    test::jitter(s.mesh, 9, 7, 0, 7);
    const MatrixXd start = color_matrix(s.mesh);
    const hmesh::kit::BoundedReport report = bounded_colors(s.mesh, {-1e6, 1e6, 0});
    CHECK(report.converged);
    CHECK(report.sweeps > 2);
    CHECK(report.sweeps < 20);
    const MatrixXd c = color_matrix(s.mesh), gradient = gram_matrix(s.mesh) * c - image_rhs(s.mesh);
    CHECK(gradient.norm() > 1);
    CHECK((gradient + ridge * (c - start)).cwiseAbs().maxCoeff() < 1e-4);
}

TEST_CASE("bounding costs energy, but little on a smooth image, and less than rounding and clamping do") {
    Sample<std::uint8_t, 3> s(test::hills<3>(160, 120));
    test::jitter(s.mesh, 18, 14, 200, 8);
    optimal_colors(s.mesh);
    optimal_colors(s.mesh);
    const double best = s.mesh.energy();
    const auto optimum = colors_of(s.mesh);
    auto rounded = optimum;
    for (auto& c : rounded)
        for (int k = 0; k < 3; ++k) c.set(k, std::round(std::max(0.0, std::min(255.0, c[k]))));
    s.mesh.set_colors(rounded);
    const double plain = s.mesh.energy();
    s.mesh.set_colors(optimum);
    bounded_colors(s.mesh, {0, 255, 1});
    CHECK(all_allowed(s.mesh, 0, 255, 1));
    CHECK(s.mesh.energy() >= best * (1 - 1e-12));
    CHECK(s.mesh.energy() < best * 1.01);
    CHECK(s.mesh.energy() < plain);
}

TEST_CASE("bounds may be infinite, as large as floats go, a single value, or off the grid") {
    Sample<float, 1> s(test::noise<float, 1>(40, 30, 9));
    test::jitter(s.mesh, 6, 5, 50, 9);
    optimal_colors(s.mesh);
    const double best = s.mesh.energy();
    const double infinity = std::numeric_limits<double>::infinity(), large = std::numeric_limits<float>::max();
    for (const double bound : {infinity, large}) {
        bounded_colors(s.mesh, {-bound, bound, 0});
        CHECK(s.mesh.energy() <= best * (1 + 1e-9));
        bounded_colors(s.mesh, {-bound, bound, 0.125});
        CHECK(all_allowed(s.mesh, -bound, bound, 0.125));
        CHECK(s.mesh.energy() < 1.05 * best);
    }
    bounded_colors(s.mesh, {0.3, 1.1, 0.25});
    CHECK(all_allowed(s.mesh, 0.5, 1, 0.25));
    // In doubles 41 * 0.01 is above 0.41 and 48 * 0.01 below the number after 0.48, but divisions say otherwise.
    bounded_colors(s.mesh, {0, 0.41, 0.01});
    CHECK(all_allowed(s.mesh, 0, 0.41, 0));
    const double above = std::nextafter(0.48, 1);
    bounded_colors(s.mesh, {above, 1, 0.01});
    CHECK(all_allowed(s.mesh, above, 1, 0));
    bounded_colors(s.mesh, {0.375, 0.375, 0});
    CHECK(all_allowed(s.mesh, 0.375, 0.375, 0));
    CHECK(s.mesh.check());
}

TEST_CASE("any number of channels, and any executor, gives the same colours to the bit") {
    Sample<std::uint8_t, 5> s(test::noise<std::uint8_t, 5>(90, 70, 10)), t(test::noise<std::uint8_t, 5>(90, 70, 10));
    test::jitter(s.mesh, 30, 24, 100, 10);
    test::jitter(t.mesh, 30, 24, 100, 10);
    optimal_colors(s.mesh);
    optimal_colors(t.mesh, {}, test::BackwardFor());
    bool same = s.mesh.energy() == t.mesh.energy();
    bounded_colors(s.mesh, {10, 255, 1});
    bounded_colors(t.mesh, {10, 255, 1}, test::BackwardFor());
    same = same && s.mesh.energy() == t.mesh.energy();
    for (const hmesh::kit::Vertex v : s.mesh.topology().vertices())
        for (int k = 0; k < 8; ++k) same = same && s.mesh.color(v)[k] == t.mesh.color(v)[k];
    CHECK(same);
    CHECK(all_allowed(s.mesh, 10, 255, 1));

    // A channel alone comes out as it does beside others.
    hmesh::Image<std::uint8_t, 1> second(90, 70);
    for (int y = 0; y < 70; ++y)
        for (int x = 0; x < 90; ++x) second.pixel(x, y)[0] = s.image.pixel(x, y)[2];
    Sample<std::uint8_t, 1> alone(std::move(second));
    test::jitter(alone.mesh, 30, 24, 0, 11);
    Sample<std::uint8_t, 5> all(test::noise<std::uint8_t, 5>(90, 70, 10));
    test::jitter(all.mesh, 30, 24, 0, 11);
    auto colors = colors_of(all.mesh);
    const auto own = colors_of(alone.mesh);
    for (std::size_t i = 0; i < colors.size(); ++i) colors[i].set(2, own[i][0]);
    all.mesh.set_colors(colors);
    bounded_colors(alone.mesh, {0, 255, 1});
    bounded_colors(all.mesh, {0, 255, 1});
    std::size_t different = 0;
    for (const hmesh::kit::Vertex v : all.mesh.topology().vertices()) different += all.mesh.color(v)[2] != alone.mesh.color(v)[0];
    CHECK(different <= all.mesh.vertex_count() / 50);  // sweeps stop by the largest change in any channel
}
