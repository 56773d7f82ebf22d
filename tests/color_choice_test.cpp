#include "hmesh/io/compact/colors/color_choice.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/core/random.hpp"
#include "hmesh/io/compact/plane.hpp"
#include "hmesh/io/compact/triangulation.hpp"

using hmesh::detail::ColorChoice;
using hmesh::detail::GridPoint;
using hmesh::detail::Triangulation;

namespace {

// Points of a square, corners among them.
std::vector<GridPoint> scattered(std::size_t count) {
    hmesh::kit::Random random(5);
    std::vector<GridPoint> points{{0, 0}, {4096, 0}, {4096, 4096}, {0, 4096}};
    while (points.size() < count)
        points.push_back({1 + static_cast<std::int32_t>(random.below(4095)), 1 + static_cast<std::int32_t>(random.below(4095))});
    return points;
}
// 24 times the integral of the square of what is linear in each triangle and `off` at its corners.
double energy(const Triangulation& mesh, const std::vector<double>& off) {
    double sum = 0;
    for (Triangulation::Index e = 0; e < mesh.edge_slots(); ++e) {
        if (!mesh.is_edge(e) || mesh.apex(e) == Triangulation::none) continue;
        const Triangulation::Index a = mesh.from(e), b = mesh.to(e), c = mesh.apex(e);
        if (a > b || a > c) continue;  // each triangle once
        const auto area = static_cast<double>(orient2d(mesh.point(a), mesh.point(b), mesh.point(c)));
        const double all = off[a] + off[b] + off[c];
        sum += area * (all * all + off[a] * off[a] + off[b] * off[b] + off[c] * off[c]);
    }
    return sum;
}

}  // namespace

TEST_CASE("what vertices miss those after them make good") {
    const std::vector<GridPoint> points = scattered(300);
    const Triangulation mesh(points);
    hmesh::kit::Random random(6);
    std::vector<double> wanted(2 * points.size());
    for (double& value : wanted) value = 40 * random.uniform();
    ColorChoice choice(mesh, std::vector<bool>(points.size(), true), wanted, 2);
    std::vector<double> rounded(points.size()), chosen(points.size());
    for (std::size_t v = 0; v < points.size(); ++v) {
        rounded[v] = std::round(wanted[2 * v + 1]) - wanted[2 * v + 1];
        chosen[v] = std::round(choice.wanted(v, 1)) - wanted[2 * v + 1];
        choice.set(v, 0, choice.wanted(v, 0));
        choice.set(v, 1, std::round(choice.wanted(v, 1)));
        choice.close(v);
    }
    CHECK(energy(mesh, chosen) < 0.9 * energy(mesh, rounded));
}

TEST_CASE("an error costs what is left when the neighbours have made it good") {
    const std::vector<GridPoint> points{{0, 0}, {4, 0}, {4, 4}, {0, 4}, {2, 2}};
    const Triangulation mesh(points);
    const std::vector<double> wanted(5, 10.0);
    ColorChoice choice(mesh, std::vector<bool>(5, true), wanted, 1);
    // Four triangles of twice the area 8; corners lie in two of them each, of 16 together.
    const double own = 2 * 4 * 8, corner = 2 * 16, shared = 16;
    CHECK(choice.price(4) == doctest::Approx(own - 4 * shared * shared / corner));
    for (std::size_t v = 0; v < 2; ++v) choice.close(v);
    CHECK(choice.price(4) == doctest::Approx(own - 2 * shared * shared / corner));
    for (std::size_t v = 2; v < 4; ++v) choice.close(v);
    CHECK(choice.price(4) == doctest::Approx(own));
    CHECK(choice.wanted(4, 0) == doctest::Approx(10));
    // What was written of a vertex moves what is best for its neighbours the other way.
    ColorChoice after(mesh, std::vector<bool>(5, true), wanted, 1);
    after.set(0, 0, 12);
    after.close(0);
    CHECK(after.wanted(4, 0) < 10);
    CHECK(after.wanted(0, 0) == doctest::Approx(12));
}

TEST_CASE("vertices that are not used have no part in it") {
    const std::vector<GridPoint> points{{0, 0}, {4, 0}, {4, 4}, {0, 4}, {2, 2}};
    const Triangulation mesh(points);
    ColorChoice choice(mesh, {true, true, true, true, false}, std::vector<double>(5, 1.0), 1);
    choice.set(0, 0, 3);
    choice.close(0);
    CHECK(choice.wanted(4, 0) == doctest::Approx(1));
    CHECK(choice.wanted(1, 0) < 1);
}
