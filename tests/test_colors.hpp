// hmesh tests - what tests of colours have in common: meshes whose vertices lack pixels, and colours held against bounds.
#ifndef HMESH_TESTS_TEST_COLORS_HPP
#define HMESH_TESTS_TEST_COLORS_HPP

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "hmesh/fit/image_mesh.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/mesh/limits.hpp"
#include "jittered_mesh.hpp"

namespace test {

constexpr hmesh::MeshLimits no_ridge(double ridge = 1e-9) {
    hmesh::MeshLimits limits;
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
    REQUIRE(s.mesh.assign(points, grid_triangles(4, 4)));
}
inline constexpr std::size_t blind_vertex = 12;

// The bilinear colour as a sum over all pixels of the image, each with the product of two hat functions around its centre;
// beyond the outermost centres that of the nearest place among them.
template <class T, int C>
double naive_sample(const hmesh::Image<T, C>& image, hmesh::kit::Point p, int c) {
    const double x = std::clamp(p.x, 0.5, image.width() - 0.5), y = std::clamp(p.y, 0.5, image.height() - 0.5);
    double sum = 0;
    for (int j = 0; j < image.height(); ++j)
        for (int i = 0; i < image.width(); ++i)
            sum += std::max(0.0, 1 - std::abs(x - i - 0.5)) * std::max(0.0, 1 - std::abs(y - j - 0.5)) *
                   static_cast<double>(image.pixel(i, j)[c]);
    return sum;
}

}  // namespace test

#endif  // HMESH_TESTS_TEST_COLORS_HPP
