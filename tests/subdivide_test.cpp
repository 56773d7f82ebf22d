#include "hmesh/edit/subdivide.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "test_images.hpp"
#include "test_meshes.hpp"

using hmesh::kit::Face;
using hmesh::kit::subdivide;
using hmesh::kit::Vertex;
using hmesh_test::Subject;

namespace {

template <int C>
double least_cross(const hmesh::kit::ImageMesh<C>& mesh) {
    double least = std::numeric_limits<double>::infinity();
    for (const Face f : mesh.topology().faces()) {
        const auto v = mesh.topology().vertices(f);
        least = std::min(least, hmesh::kit::orient2d(mesh.position(v[0]), mesh.position(v[1]), mesh.position(v[2])));
    }
    return least;
}

template <int C>
int most_neighbors(const hmesh::kit::ImageMesh<C>& mesh) {
    int most = 0;
    for (const Vertex v : mesh.topology().vertices()) most = std::max(most, mesh.topology().valence(v));
    return most;
}

// From the four corners to `total` vertices.
template <class T, int C>
void check_subdivision(hmesh::Image<T, C> image, std::size_t total, const hmesh::MeshLimits& limits = {}) {
    const int width = image.width(), height = image.height();
    Subject<T, C> subject(std::move(image), hmesh_test::jittered_grid(width, height, 1, 1, 1), limits);
    CHECK(subdivide(subject.mesh, total - 4) == total - 4);
    CHECK(subject.mesh.vertex_count() == total);
    CHECK(least_cross(subject.mesh) >= limits.min_double_area);
    CHECK(most_neighbors(subject.mesh) <= hmesh::kit::max_valence);
    hmesh_test::prove(subject);
}

}  // namespace

TEST_CASE("four corners become one vertex a pixel, whatever the size and the least area allowed") {
    for (const double min_double_area : {1e-4, 0.02, 0.25}) {
        hmesh::MeshLimits limits;
        limits.min_double_area = min_double_area;
        for (int height = 1; height <= 8; ++height)
            for (int width = 1; width <= 8; ++width) {
                CAPTURE(width);
                CAPTURE(height);
                CAPTURE(min_double_area);
                const auto most = static_cast<std::size_t>(std::max(4, width * height));
                check_subdivision(hmesh_test::constant_image<std::uint8_t, 1>(width, height, 0.5), most, limits);
            }
        check_subdivision(hmesh_test::affine_image<float, 3>(40, 31), 40 * 31, limits);
        check_subdivision(hmesh_test::noise<std::uint8_t, 1>(1, 200, 1), 200, limits);
        check_subdivision(hmesh_test::noise<std::uint16_t, 2>(150, 2, 2), 300, limits);
    }
}

TEST_CASE("wide gaps to the border leave room for one vertex a pixel") {
    hmesh::MeshLimits limits;
    limits.border_gap = 0.25;
    limits.min_double_area = 0.25;
    for (int height = 1; height <= 6; ++height)
        for (int width = 1; width <= 6; ++width)
            check_subdivision(hmesh_test::constant_image<std::uint8_t, 1>(width, height, 0.5),
                              static_cast<std::size_t>(std::max(4, width * height)), limits);
}

TEST_CASE("the count inserted is told, also when no face has room for more") {
    Subject<std::uint8_t, 1> subject(hmesh_test::noise<std::uint8_t, 1>(5, 4, 1), hmesh_test::jittered_grid(5, 4, 2, 2, 1));
    CHECK(subdivide(subject.mesh, 0) == 0);
    CHECK(subject.mesh.vertex_count() == 9);
    CHECK(subdivide(subject.mesh, 3) == 3);
    CHECK(subject.mesh.vertex_count() == 12);
    const std::size_t more = subdivide(subject.mesh, 1000000);
    CHECK(more < 1000000);
    CHECK(more > 20);
    CHECK(subject.mesh.vertex_count() == 12 + more);
    CHECK(least_cross(subject.mesh) >= subject.mesh.limits().min_double_area);
    hmesh_test::prove(subject);
    CHECK(subdivide(subject.mesh, 10) == 0);
}

TEST_CASE("the largest faces go first") {
    // Cells of 8 x 8 px in one half, one of 32 x 32 px in the other: the latter's faces are split down to the former's.
    hmesh_test::Triangulation grid;
    for (int j = 0; j <= 4; ++j)
        for (int i = 0; i <= 4; ++i) grid.positions.push_back({8.0 * i, 8.0 * j});
    for (std::uint32_t j = 0; j < 4; ++j)
        for (std::uint32_t i = 0; i < 4; ++i) {
            const std::uint32_t a = 5 * j + i;
            grid.triangles.push_back({a, a + 1, a + 6});
            grid.triangles.push_back({a, a + 6, a + 5});
        }
    grid.positions.push_back({64, 0});   // 25
    grid.positions.push_back({64, 32});  // 26
    for (std::uint32_t j = 0; j < 4; ++j) grid.triangles.push_back({5 * j + 4, 25, 5 * j + 9});
    grid.triangles.push_back({24, 25, 26});
    Subject<std::uint8_t, 1> subject(hmesh_test::constant_image<std::uint8_t, 1>(64, 32, 0.5), grid);
    CHECK(subdivide(subject.mesh, 8) == 8);
    std::size_t fine = 0;
    double largest = 0;
    for (const Face f : subject.mesh.topology().faces()) {
        const auto v = subject.mesh.topology().vertices(f);
        const double twice =
            hmesh::kit::orient2d(subject.mesh.position(v[0]), subject.mesh.position(v[1]), subject.mesh.position(v[2]));
        largest = std::max(largest, twice);
        if (twice == 64) ++fine;
    }
    CHECK(fine >= 32);
    CHECK(largest < 1024);
    hmesh_test::prove(subject);
}

TEST_CASE("a large face whose corners have all the neighbors they can take is passed over") {
    // 40 spokes: to the corners of the square and to 36 points of its left side. The three largest faces have their
    // longest edge on the border, opposite the hub.
    hmesh_test::Triangulation fan;
    fan.positions.push_back({32, 32});
    for (const hmesh::kit::Point p : {hmesh::kit::Point{0, 0}, {64, 0}, {64, 64}, {0, 64}}) fan.positions.push_back(p);
    for (int k = 1; k <= hmesh::kit::max_valence - 4; ++k)
        fan.positions.push_back({0, hmesh::kit::snap(64 - 64.0 * k / (hmesh::kit::max_valence - 3))});
    for (std::uint32_t k = 1; k <= hmesh::kit::max_valence; ++k) fan.triangles.push_back({0, k, k % hmesh::kit::max_valence + 1});
    Subject<std::uint8_t, 1> subject(hmesh_test::constant_image<std::uint8_t, 1>(64, 64, 0.5), fan);
    REQUIRE(most_neighbors(subject.mesh) == hmesh::kit::max_valence);
    CHECK(subdivide(subject.mesh, 20) == 20);
    CHECK(most_neighbors(subject.mesh) == hmesh::kit::max_valence);
    hmesh_test::prove(subject);
}

TEST_CASE("an affine picture stays exact, and what is new is due for a visit") {
    Subject<float, 3> subject(hmesh_test::affine_image<float, 3>(30, 20), hmesh_test::jittered_grid(30, 20, 1, 1, 1));
    for (int k = 0; k < 30; ++k)
        for (const Vertex v : subject.mesh.topology().vertices()) hmesh::kit::improve_vertex(subject.mesh, v, 0);
    const double before = subject.mesh.energy();
    for (const Vertex v : subject.mesh.topology().vertices()) subject.mesh.set_dirty(v, false);
    CHECK(subdivide(subject.mesh, 40) == 40);
    CHECK(subject.mesh.energy() <= before + hmesh_test::rounding(subject));
    std::size_t due = 0;
    for (const Vertex v : subject.mesh.topology().vertices()) due += subject.mesh.is_dirty(v) ? 1 : 0;
    CHECK(due >= 40);
    hmesh_test::prove(subject);
}
