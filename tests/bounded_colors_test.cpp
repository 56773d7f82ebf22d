#include "hmesh/solve/bounded_colors.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "jittered_mesh.hpp"

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using test::Sample;

constexpr hmesh::kit::MeshLimits no_ridge(double ridge = 1e-9) {
    hmesh::kit::MeshLimits limits;
    limits.ridge = ridge;
    return limits;
}

template <int C>
std::vector<hmesh::kit::Color<C>> colors_of(const hmesh::kit::ImageMesh<C>& mesh) {
    std::vector<hmesh::kit::Color<C>> colors(mesh.topology().vertex_slots(), hmesh::kit::Color<C>::zero());
    for (const hmesh::kit::Vertex v : mesh.topology().vertices()) colors[v.index()] = mesh.color(v);
    return colors;
}

// The energy of the mesh if channel k of v changed by d.
template <int C>
double energy_with(hmesh::kit::ImageMesh<C>& mesh, hmesh::kit::Vertex v, int k, double d) {
    const auto mark = mesh.begin();
    hmesh::kit::Color<C> c = mesh.color(v);
    c.set(k, c[k] + d);
    mesh.place(v, mesh.position(v), c);
    const double energy = mesh.energy();
    mesh.rollback(mark);
    return energy;
}

template <int C>
bool all_allowed(const hmesh::kit::ImageMesh<C>& mesh, double low, double high, double grid) {
    for (const hmesh::kit::Vertex v : mesh.topology().vertices()) {
        for (int k = 0; k < C; ++k) {
            const double c = mesh.color(v)[k];
            if (!(c >= low && c <= high)) return false;
            if (grid > 0 && std::round(c / grid) * grid != c) return false;
        }
        for (int k = C; k < hmesh::kit::lanes_for(C + 1); ++k)
            if (mesh.color(v)[k] != 0) return false;
    }
    return true;
}

// Five lines each way of which three are so close that the vertex in their middle, the 13th, sees no pixel.
template <class T, int C>
void make_blind_vertex(Sample<T, C>& s) {
    const double w = s.mesh.width(), h = s.mesh.height();
    std::vector<hmesh::kit::Point> points;
    for (const double y : {0.0, 3.75, 4.0, 4.25, h})
        for (const double x : {0.0, 2.75, 3.0, 3.25, w}) points.push_back({x, y});
    REQUIRE(s.mesh.assign(points, test::grid_triangles(4, 4)));
}
constexpr std::size_t blind_vertex = 12;

}  // namespace

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
    make_blind_vertex(s);
    const hmesh::kit::Vertex blind(blind_vertex);
    REQUIRE(gram_matrix(s.mesh).coeff(blind_vertex, blind_vertex) == 0);
    auto colors = colors_of(s.mesh);
    const double kept[3] = {17, 200, 93};
    for (int k = 0; k < 3; ++k) colors[blind_vertex].set(k, kept[k]);
    s.mesh.set_colors(colors);
    CHECK(optimal_colors(s.mesh).converged);
    for (int k = 0; k < 3; ++k) CHECK(s.mesh.color(blind)[k] == kept[k]);
    bounded_colors(s.mesh, 0, 255, 1);
    for (int k = 0; k < 3; ++k) CHECK(s.mesh.color(blind)[k] == kept[k]);
    CHECK(s.mesh.energy() > 0);

    // Out of range or off the grid, it goes to the nearest that is allowed; without any ridge, too.
    Sample<std::uint8_t, 3> t(test::noise<std::uint8_t, 3>(9, 8, 4), no_ridge(0));
    make_blind_vertex(t);
    const double odd[3] = {-40, 99.6, 300}, allowed[3] = {0, 100, 255};
    for (int k = 0; k < 3; ++k) colors[blind_vertex].set(k, odd[k]);
    t.mesh.set_colors(colors);
    bounded_colors(t.mesh, 0, 255, 1);
    for (int k = 0; k < 3; ++k) CHECK(t.mesh.color(blind)[k] == allowed[k]);
}

TEST_CASE("optimal colours stay within the mesh's bounds") {
    // One white pixel, black ones around: the corner, whose weight is 0.2 there, would have to be about 1275.
    hmesh::Image<std::uint8_t, 1> image(16, 16);
    image.pixel(0, 0)[0] = 255;
    Sample<std::uint8_t, 1> s(std::move(image));
    REQUIRE(
        s.mesh.assign({{0, 0}, {1.25, 0}, {16, 0}, {16, 16}, {0, 16}, {0, 1.25}}, {{0, 1, 5}, {1, 2, 3}, {1, 3, 5}, {5, 3, 4}}));
    optimal_colors(s.mesh);
    double highest = 0;
    for (const hmesh::kit::Vertex v : s.mesh.topology().vertices()) {
        CHECK(s.mesh.color(v)[0] >= s.mesh.color_low());
        highest = std::max(highest, s.mesh.color(v)[0]);
    }
    CHECK(highest == s.mesh.color_high());
    CHECK(s.mesh.check());
    bounded_colors(s.mesh, 0, 255, 1);
    CHECK(all_allowed(s.mesh, 0, 255, 1));
}

TEST_CASE("no single step of one channel lowers the energy of bounded colours") {
    int at_bounds = 0;
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        Sample<std::uint8_t, 3> s(test::noise<std::uint8_t, 3>(30, 26, seed), no_ridge());
        test::jitter(s.mesh, 6, 5, 60, seed);
        optimal_colors(s.mesh);
        const double grid = seed % 2 == 0 ? 1 : 4, low = 40, high = 200;
        const hmesh::kit::BoundedReport report = bounded_colors(s.mesh, low, high, grid);
        REQUIRE(report.settled);
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

TEST_CASE("bounded colours without a grid are the minimum over the box: the gradient points out of it or is zero") {
    Sample<float, 3> s(test::noise<float, 3>(60, 50, 7), no_ridge());
    test::jitter(s.mesh, 9, 7, 0, 7);
    optimal_colors(s.mesh);
    CHECK(bounded_colors(s.mesh, 0, 1, 0).sweeps > 2);
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
    bounded_colors(s.mesh, 0, 255, 1);
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
        bounded_colors(s.mesh, -bound, bound, 0);
        CHECK(s.mesh.energy() <= best * (1 + 1e-9));
        bounded_colors(s.mesh, -bound, bound, 0.125);
        CHECK(all_allowed(s.mesh, -bound, bound, 0.125));
        CHECK(s.mesh.energy() < 1.05 * best);
    }
    bounded_colors(s.mesh, 0.3, 1.1, 0.25);
    CHECK(all_allowed(s.mesh, 0.5, 1, 0.25));
    // In doubles 41 * 0.01 is above 0.41 and 48 * 0.01 below the number after 0.48, but divisions say otherwise.
    bounded_colors(s.mesh, 0, 0.41, 0.01);
    CHECK(all_allowed(s.mesh, 0, 0.41, 0));
    const double above = std::nextafter(0.48, 1);
    bounded_colors(s.mesh, above, 1, 0.01);
    CHECK(all_allowed(s.mesh, above, 1, 0));
    bounded_colors(s.mesh, 0.375, 0.375, 0);
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
    bounded_colors(s.mesh, 10, 255, 1);
    bounded_colors(t.mesh, 10, 255, 1, test::BackwardFor());
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
    bounded_colors(alone.mesh, 0, 255, 1);
    bounded_colors(all.mesh, 0, 255, 1);
    std::size_t different = 0;
    for (const hmesh::kit::Vertex v : all.mesh.topology().vertices()) different += all.mesh.color(v)[2] != alone.mesh.color(v)[0];
    CHECK(different <= all.mesh.vertex_count() / 50);  // sweeps stop by the largest change in any channel
}
