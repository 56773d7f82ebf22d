#include "hmesh/methods/final_colors.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/tiles/indexed_mesh.hpp"
#include "test_colors.hpp"
#include "test_executors.hpp"
#include "test_images.hpp"
#include "test_indexed_meshes.hpp"
#include "test_tiled_meshes.hpp"

using hmesh::Image;
using hmesh::kit::bounded_colors;
using hmesh::kit::ColorRange;
using hmesh::kit::IndexedMesh;
using hmesh::kit::Point;
using hmesh::kit::sample_colors;

namespace {

// For a mesh of one tile and of several, with colours as they are and in steps of `grid`.
template <class T, int C>
void check_sampled(const Image<T, C>& image, hmesh_test::Shape shape, double grid) {
    const IndexedMesh<C> start = hmesh_test::make_indexed(image, shape, 120, 1);
    for (const double tile : {1000.0, 25.0, 9.0}) {
        hmesh_test::Work<T, C> work(image);
        const hmesh_test::ThreadFor two{2};
        hmesh_test::Work<T, C> threads(image, {}, {}, two);
        work.tiled.indexed() = threads.tiled.indexed() = start;
        sample_colors(work.tiled, tile, grid);
        hmesh_test::prove(work);  // its energy among others
        const IndexedMesh<C>& mesh = work.indexed();
        CHECK(mesh.positions == start.positions);
        CHECK(mesh.faces == start.faces);
        for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
            for (int c = 0; c < C; ++c) {
                const double color = mesh.colors[v][c], exact = test::naive_sample(image, mesh.positions[v], c);
                if (grid > 0) REQUIRE(color == grid * std::round(color / grid));
                REQUIRE(std::abs(color - exact) <= 0.5 * grid + 1e-13 * hmesh::PixelTraits<T>::peak);
            }
        sample_colors(threads.tiled, tile, grid);
        CHECK(hmesh_test::same_bits(threads.indexed(), mesh));
    }
}

template <int C>
void check_allowed(const IndexedMesh<C>& mesh, ColorRange range) {
    for (const hmesh::kit::Color<C>& color : mesh.colors)
        for (int c = 0; c < C; ++c) {
            REQUIRE((color[c] >= range.low && color[c] <= range.high));
            if (range.grid > 0) REQUIRE(color[c] == range.grid * std::round(color[c] / range.grid));
        }
}

// The vertex of a mesh that stands at p.
template <int C>
std::size_t vertex_at(const IndexedMesh<C>& mesh, Point p) {
    std::size_t v = 0;
    while (!(mesh.positions[v] == p)) REQUIRE(++v < mesh.vertex_count());
    return v;
}

std::vector<Point> in_order(std::vector<Point> points) {
    std::sort(points.begin(), points.end(), [](Point a, Point b) { return a.y < b.y || (a.y == b.y && a.x < b.x); });
    return points;
}

// The faces of a mesh as their corners stand, whatever these are numbered: from the first of them in reading order.
template <int C>
std::vector<std::vector<Point>> shape_of(const IndexedMesh<C>& mesh) {
    const auto comes_first = [](Point a, Point b) { return a.y < b.y || (a.y == b.y && a.x < b.x); };
    std::vector<std::vector<Point>> faces;
    for (const hmesh::Triangle& t : mesh.faces) {
        faces.push_back({mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]});
        std::vector<Point>& face = faces.back();
        std::rotate(face.begin(), std::min_element(face.begin(), face.end(), comes_first), face.end());
    }
    std::sort(faces.begin(), faces.end(), [&](const auto& a, const auto& b) {
        return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end(), comes_first);
    });
    return faces;
}

// The same by the best colours of a range: they are as good whatever the tiles, and any executor finds them.
template <class T, int C>
void check_bounded(const Image<T, C>& image, hmesh_test::Shape shape, ColorRange range) {
    const IndexedMesh<C> start = hmesh_test::make_indexed(image, shape, 120, 1);
    double best = 0;
    for (const double tile : {1000.0, 25.0, 9.0}) {
        const hmesh_test::ThreadFor two{2};
        hmesh_test::Work<T, C> work(image), threads(image, {}, {}, two);
        work.tiled.indexed() = threads.tiled.indexed() = start;
        bounded_colors(work.tiled, tile, range);
        hmesh_test::prove(work);  // its energy among others
        const IndexedMesh<C>& mesh = work.indexed();
        CHECK(in_order(mesh.positions) == in_order(start.positions));  // work in tiles numbers them anew
        CHECK(shape_of(mesh) == shape_of(start));
        check_allowed(mesh, range);
        CHECK(mesh.energy < hmesh_test::brute_energy(image, start));
        if (tile == 1000) best = mesh.energy;
        CHECK(mesh.energy == doctest::Approx(best).epsilon(1e-3));
        bounded_colors(threads.tiled, tile, range);
        CHECK(hmesh_test::same_bits(threads.indexed(), mesh));
    }
}

// The same in tiles of `tile` px: as good as in one piece to `loss` of what there is to be gained.
template <class T, int C>
void check_by_tiles(const Image<T, C>& image, int vertices, double tile, ColorRange range, double loss) {
    const IndexedMesh<C> start = hmesh_test::make_indexed(image, hmesh_test::Shape::delaunay, vertices, 1);
    const hmesh_test::ThreadFor two{2};
    hmesh_test::Work<T, C> whole(image), work(image), threads(image, {}, {}, two);
    whole.tiled.indexed() = work.tiled.indexed() = threads.tiled.indexed() = start;
    bounded_colors(whole.tiled, 1000, range);
    hmesh::kit::detail::colors_by_tiles(work.tiled, tile, range);
    const IndexedMesh<C>& mesh = work.indexed();
    CHECK(in_order(mesh.positions) == in_order(start.positions));  // work in tiles numbers them anew
    CHECK(shape_of(mesh) == shape_of(start));
    check_allowed(mesh, range);
    const double before = hmesh_test::brute_energy(image, start), best = hmesh_test::brute_energy(image, whole.indexed());
    const double energy = hmesh_test::brute_energy(image, mesh);
    CHECK(energy < before);
    CHECK(energy <= best + loss * (before - best));
    hmesh::kit::detail::colors_by_tiles(threads.tiled, tile, range);
    CHECK(hmesh_test::same_bits(threads.indexed(), mesh));

    hmesh_test::Work<T, C> held(image);
    held.tiled.indexed() = start;
    held.tiled.indexed().has_fixed_border = true;
    hmesh::kit::detail::colors_by_tiles(held.tiled, tile, range);
    for (std::size_t v = 0; v < start.vertex_count(); ++v) {
        if (!start.is_on_border(v)) continue;
        hmesh::kit::Color<C> allowed = start.colors[v];
        hmesh::kit::detail::to_allowed<C>(allowed, range);
        const std::size_t its = vertex_at(held.indexed(), start.positions[v]);
        for (int c = 0; c < C; ++c) REQUIRE(held.indexed().colors[its][c] == allowed[c]);
    }
}

}  // namespace

TEST_CASE("colours that are found tile by tile are allowed, nearly as good as those of the whole mesh, and change nothing else") {
    check_by_tiles(hmesh_test::scene<std::uint8_t, 3>(160, 120, 1), 600, 60, {0, 255, 1}, 0.02);
    check_by_tiles(hmesh_test::noise<std::uint8_t, 1>(160, 120, 2), 600, 60, {60, 190, 1}, 0.02);
    check_by_tiles(hmesh_test::scene<float, 4>(160, 120, 4), 600, 60, {0, 1, 0}, 0.02);
    check_by_tiles(hmesh_test::scene<float, 2>(100, 80, 5), 600, 1000, {0, 1, 0}, 1e-3);
    check_by_tiles(hmesh_test::scene<std::uint8_t, 3>(400, 300, 6), 6000, 100, {0, 255, 1}, 1e-3);  // as many as in a photograph
}

TEST_CASE("a mesh in tiles has sampled colours in steps of the grid, and the energy of its pixels, however it is cut") {
    check_sampled(hmesh_test::scene<std::uint8_t, 3>(60, 45, 1), hmesh_test::Shape::worn, 1);
    check_sampled(hmesh_test::scene<std::uint8_t, 1>(60, 45, 2), hmesh_test::Shape::delaunay, 0);
    check_sampled(hmesh_test::noise<std::uint16_t, 2>(40, 45, 3), hmesh_test::Shape::slivers, 16);
    check_sampled(hmesh_test::scene<float, 4>(50, 30, 4), hmesh_test::Shape::scattered, 0);
    check_sampled(hmesh_test::scene<float, 1>(50, 30, 5), hmesh_test::Shape::grid, 1.0 / 64);
}

TEST_CASE("a mesh in tiles gets colours in their range and on their grid, as good as in one tile, and the energy of its pixels") {
    check_bounded(hmesh_test::scene<std::uint8_t, 3>(60, 45, 1), hmesh_test::Shape::worn, {0, 255, 1});
    check_bounded(hmesh_test::noise<std::uint8_t, 1>(60, 45, 2), hmesh_test::Shape::delaunay, {60, 190, 1});
    check_bounded(hmesh_test::scene<std::uint16_t, 2>(40, 45, 3), hmesh_test::Shape::grid, {0, 65535, 0});
    check_bounded(hmesh_test::scene<float, 4>(50, 30, 4), hmesh_test::Shape::scattered, {0, 1, 0});
}

TEST_CASE("told to stop, colours go to the nearest that are allowed, and the energy is true of them") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(60, 45, 1);
    const IndexedMesh<3> start = hmesh_test::make_indexed(image, hmesh_test::Shape::worn, 120, 1);
    const auto stop = [](const hmesh::ProgressInfo&) { return false; };
    for (const double tile : {1000.0, 25.0}) {
        hmesh_test::Work<std::uint8_t, 3> work(image, {}, stop);
        work.tiled.indexed() = start;
        REQUIRE_FALSE(work.progress.poll());
        bounded_colors(work.tiled, tile, {50, 200, 1});
        hmesh_test::prove(work);
        const IndexedMesh<3>& mesh = work.indexed();
        check_allowed(mesh, {50, 200, 1});
        for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
            for (int c = 0; c < 3; ++c) {
                const double held = std::min(200.0, std::max(50.0, start.colors[v][c]));
                CHECK(std::abs(mesh.colors[vertex_at(mesh, start.positions[v])][c] - held) <= 0.5);
            }
    }
}
