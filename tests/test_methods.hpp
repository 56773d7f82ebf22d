// hmesh tests - what the methods that annealed is compared with have in common: pictures that are hard for them, and proofs.
#ifndef HMESH_TESTS_TEST_METHODS_HPP
#define HMESH_TESTS_TEST_METHODS_HPP

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "hmesh/core/progress.hpp"
#include "hmesh/core/random.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/mesh/geometry.hpp"
#include "hmesh/mesh/halfedge_mesh.hpp"
#include "hmesh/tiles/indexed_mesh.hpp"
#include "test_images.hpp"
#include "test_tiled_meshes.hpp"

namespace hmesh_test {

namespace kit = hmesh::kit;

// Pictures with many ties, with parts that nothing bends in, and with lines that gather points.
template <class T, int C>
[[nodiscard]] std::vector<hmesh::Image<T, C>> hard_pictures(int width, int height) {
    std::vector<hmesh::Image<T, C>> out;
    out.push_back(constant_image<T, C>(width, height, 0.4));
    out.push_back(affine_image<T, C>(width, height));
    out.push_back(checkerboard<T, C>(width, height, 1));
    out.push_back(checkerboard<T, C>(width, height, 3));
    out.push_back(noise<T, C>(width, height, 5));
    const auto lit = [&](auto&& is_lit) {
        out.push_back(draw<T, C>(width, height, [&](int x, int y, int) { return is_lit(x, y) ? 1.0 : 0.0; }));
    };
    lit([&](int, int y) { return y == height / 3; });
    lit([&](int x, int) { return x == width / 2; });
    lit([](int x, int y) { return x == y; });
    lit([&](int x, int y) { return x == width - 1 && y == height - 1; });
    lit([&](int x, int y) {  // a circle and its middle
        const double distance = std::hypot(x - width / 2, y - height / 2);
        return distance < 0.5 || std::abs(distance - 0.4 * height) < 0.6;
    });
    kit::Random random(3);
    out.push_back(draw<T, C>(width, height, [&](int x, int, int) { return 2 * x < width ? 0.3 : random.uniform(); }));
    return out;
}

// The mesh is one of the mesh image, and its energy that of its pixels. Vertices may have any number of neighbours.
template <class T, int C>
void prove_mesh(const Work<T, C>& work, std::size_t vertices) {
    CHECK(work.count() == vertices);
    const hmesh::Status status = check(work.indexed());
    REQUIRE_MESSAGE(status, status.what << " at " << status.value);
    const double energy = brute_energy(work.image, work.indexed());
    CHECK(std::abs(work.indexed().energy - energy) <= 1e-9 * energy + 1e-12 * squares(work.image));
}

// Whether no vertex lies in the circle of a face: by the edges, each with the two corners across.
template <int C>
[[nodiscard]] bool is_delaunay(const kit::IndexedMesh<C>& mesh) {
    kit::HalfedgeMesh topology;
    REQUIRE(topology.assign(mesh.vertex_count(), mesh.faces));
    const auto at = [&](kit::Vertex v) { return mesh.positions[v.index()]; };
    for (const kit::Edge e : topology.edges()) {
        if (topology.is_boundary(e)) continue;
        const kit::Halfedge h = kit::HalfedgeMesh::halfedge(e), o = kit::HalfedgeMesh::opposite(h);
        const auto apex = [&](kit::Halfedge side) { return at(topology.to_vertex(topology.next(side))); };
        if (kit::in_circle(at(topology.to_vertex(o)), at(topology.to_vertex(h)), apex(h), apex(o)) > 0) return false;
    }
    return true;
}

// Whether the colour of every vertex is that of the image under it, found anew: the mean of the four pixels around, each
// counting by its share of a unit square around the place.
template <class T, int C>
[[nodiscard]] bool is_sampled(const hmesh::Image<T, C>& image, const kit::IndexedMesh<C>& mesh) {
    double worst = 0;
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
        const double x = std::min(image.width() - 0.5, std::max(0.5, mesh.positions[v].x));
        const double y = std::min(image.height() - 0.5, std::max(0.5, mesh.positions[v].y));
        for (int c = 0; c < C; ++c) {
            double color = 0;
            for (int j = 0; j < image.height(); ++j)
                for (int i = 0; i < image.width(); ++i) {
                    const double share = std::max(0.0, 1 - std::abs(x - i - 0.5)) * std::max(0.0, 1 - std::abs(y - j - 0.5));
                    color += share * static_cast<double>(image.pixel(i, j)[c]);
                }
            worst = std::max(worst, std::abs(color - mesh.colors[v][c]));
        }
    }
    return worst <= 1e-9;  // rounding, of samples up to 65535
}

[[nodiscard]] inline std::string names_of(const kit::ProgressReporter& progress) {
    std::string names;
    for (const hmesh::StageReport& stage : progress.stages()) names += std::string(names.empty() ? "" : " ") + stage.name;
    return names;
}

// Whether a recipe spoilt in one place is refused by a sentence that begins with the name of that place, and that tells the
// value and the bound that it missed.
template <class Recipe, class Spoil>
[[nodiscard]] bool is_refused(const std::string& name, Spoil&& spoil) {
    Recipe recipe;
    REQUIRE(recipe.check(1, 1));
    spoil(recipe);
    const hmesh::Status status = recipe.check(1, 1);
    const bool is_named = std::string(status.what).rfind(name + " must be ", 0) == 0;
    return status.code == hmesh::Errc::invalid_argument && is_named && status.value != status.limit;
}

inline constexpr double infinity = std::numeric_limits<double>::infinity();
inline constexpr double bad_numbers[] = {-1, 1e300, infinity, -infinity, std::numeric_limits<double>::quiet_NaN()};
inline constexpr int bad_integers[] = {-1, std::numeric_limits<int>::min(), std::numeric_limits<int>::max()};

}  // namespace hmesh_test

#endif  // HMESH_TESTS_TEST_METHODS_HPP
