#include "hmesh/methods/annealed/first_grid.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "hmesh/core/random.hpp"
#include "test_executors.hpp"
#include "test_images.hpp"
#include "test_tiled_meshes.hpp"

namespace kit = hmesh::kit;
using hmesh::Image;
using hmesh::kit::ImageSource;
using hmesh::kit::IndexedMesh;
using hmesh::kit::Point;
using hmesh::kit::Tiling;

namespace {

constexpr auto go_on = [] { return true; };

template <int C>
double least_twice_area(const IndexedMesh<C>& mesh) {
    double least = std::numeric_limits<double>::infinity();
    for (const hmesh::Triangle& t : mesh.faces)
        least = std::min(least, kit::orient2d(mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]));
    return least;
}

// A valid mesh whose vertices inside tiles have the colours of the pixels under them.
template <int C>
void check_grid(const IndexedMesh<C>& mesh, const ImageSource<C>& source) {
    const hmesh::Status status = check(mesh);
    REQUIRE_MESSAGE(status, status.what << " at " << status.value);
    CHECK(mesh.width == source.width());
    CHECK(mesh.height == source.height());
    CHECK(hmesh_test::most_neighbors(mesh) <= kit::max_valence);
    CHECK(least_twice_area(mesh) > 0.25);
    const double w = mesh.width, h = mesh.height;
    for (const Point corner : {Point{0, 0}, Point{w, 0}, Point{w, h}, Point{0, h}})
        CHECK(std::count(mesh.positions.begin(), mesh.positions.end(), corner) == 1);
    bool all_due = true;
    for (const unsigned char due : mesh.dirty) all_due = all_due && due != 0;
    CHECK(all_due);
}

double nodes_for(const Tiling& tiling, int width, int height, double n) {  // as many as squares would have
    const double length = static_cast<double>(tiling.columns() - 1) * height + static_cast<double>(tiling.rows() - 1) * width;
    return length * std::sqrt(n / (static_cast<double>(width) * height));
}

}  // namespace

TEST_CASE("a regular grid is a mesh of the image, has no more vertices than asked for, and not far fewer") {
    const std::pair<int, int> sizes[] = {{1, 1},   {1, 7},   {9, 1},   {2, 2},    {5, 4},
                                         {60, 40}, {3, 500}, {700, 2}, {333, 77}, {3, 5000}};
    for (const auto& [width, height] : sizes) {
        const auto image = hmesh_test::noise<std::uint8_t, 1>(width, height, 1);
        const ImageSource<1> source(image.view());
        for (const double count : {4.0, 4.9, 5.0, 6.0, 9.0, 25.5, 100.0, 1234.0, 40000.0}) {
            CAPTURE(image.width());
            CAPTURE(image.height());
            CAPTURE(count);
            const IndexedMesh<1> grid = kit::regular_grid(source, count);
            check_grid(grid, source);
            CHECK(static_cast<double>(grid.vertex_count()) <= count);
            CHECK(grid.vertex_count() >= 4);
            CHECK(static_cast<double>(grid.vertex_count()) >= 0.3 * std::min(count, (width + 1.0) * (height + 1.0)));
            CHECK(least_twice_area(grid) > 0.9);  // cells of at least a pixel
            CHECK(hmesh_test::most_neighbors(grid) <= 8);
            for (std::size_t v = 0; v < grid.vertex_count(); ++v) {
                const Point p = grid.positions[v];
                REQUIRE(grid.colors[v][0] ==
                        *image.pixel(std::min(width - 1, static_cast<int>(p.x)), std::min(height - 1, static_cast<int>(p.y))));
            }
        }
    }
}

TEST_CASE("a regular grid's cells are nearly square") {
    const auto image = hmesh_test::noise<std::uint8_t, 1>(400, 100, 1);
    const IndexedMesh<1> grid = kit::regular_grid(ImageSource<1>(image.view()), 500);
    std::size_t columns = 0;
    for (const Point p : grid.positions) columns += p.y == 0 ? 1 : 0;
    const double cell_width = 400.0 / static_cast<double>(columns - 1);
    const std::size_t rows = grid.vertex_count() / columns;
    const double cell_height = 100.0 / static_cast<double>(rows - 1);
    CHECK(cell_width / cell_height > 0.75);
    CHECK(cell_width / cell_height < 1.33);
}

TEST_CASE("a tiled grid is a mesh of the image without T-junctions, for any size, tile and density") {
    const std::pair<int, int> sizes[] = {{1, 1},   {1, 300},  {300, 1},   {2, 2},    {9, 14},
                                         {150, 2}, {3, 5000}, {200, 130}, {640, 480}};
    for (const auto& [width, height] : sizes) {
        const auto image = hmesh_test::scene<std::uint8_t, 1>(width, height, 1);
        const ImageSource<1> source(image.view());
        const double pixels = static_cast<double>(width) * height;
        for (const double tile : {4.0, 40.0, 64.0, 100.0, 256.0})
            for (const double density : {0.003, 0.03, 0.3, 1.0}) {
                const Tiling tiling(width, height, tile);
                if (density * tile * tile < 25 || density * pixels > 10000 || tiling.size() > 100) continue;
                CAPTURE(image.width());
                CAPTURE(image.height());
                CAPTURE(tile);
                CAPTURE(density);
                const double count = density * pixels;
                const IndexedMesh<1> grid =
                    kit::tiled_grid(source, tiling, count, nodes_for(tiling, width, height, count), go_on);
                check_grid(grid, source);
                if (count > 400 && std::min(width, height) > 60) {
                    CHECK(static_cast<double>(grid.vertex_count()) > 0.6 * count);
                    CHECK(static_cast<double>(grid.vertex_count()) < 1.6 * count);
                }
            }
    }
}

TEST_CASE("no edge crosses a seam, and the nodes on it are those of both tiles") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(150, 110, 2);
    const ImageSource<3> source(image.view());
    const Tiling tiling(150, 110, 50);
    REQUIRE(tiling.columns() == 3);
    const IndexedMesh<3> grid = kit::tiled_grid(source, tiling, 600, nodes_for(tiling, 150, 110, 600), go_on);
    check_grid(grid, source);
    std::size_t on_seams = 0;
    for (const Point p : grid.positions)
        on_seams += (p.x == 50 || p.x == 100 || p.y == tiling.rect(3).y) && p.x > 0 && p.x < 150 && p.y > 0 && p.y < 110 ? 1 : 0;
    CHECK(on_seams > 30);
    for (const hmesh::Triangle& t : grid.faces) {
        bool within = false;
        for (std::size_t k = 0; k < tiling.size(); ++k) {
            const kit::Rect r = tiling.rect(k);
            bool all = true;
            for (const std::uint32_t v : t) {
                const Point p = grid.positions[v];
                all = all && p.x >= r.x && p.x <= r.x + r.width && p.y >= r.y && p.y <= r.y + r.height;
            }
            within = within || all;
        }
        REQUIRE(within);
    }
}

TEST_CASE("seams as dense or as empty as can be beside any grid give no vertex too many neighbors") {
    kit::Random random(5);
    const Image<std::uint8_t, 1> pictures[] = {
        hmesh_test::constant_image<std::uint8_t, 1>(300, 200, 0.4), hmesh_test::noise<std::uint8_t, 1>(300, 200, 1),
        hmesh_test::affine_image<std::uint8_t, 1>(300, 200),
        hmesh_test::draw<std::uint8_t, 1>(300, 200, [&](int x, int y, int) {  // all there is to see is around a corner
            const double level = random.uniform();
            return x >= 70 && x < 130 && y >= 70 && y < 130 ? level : 0.3;
        })};
    for (const Image<std::uint8_t, 1>& image : pictures) {
        const ImageSource<1> source(image.view());
        const Tiling tiling(300, 200, 100);
        for (const double n : {1600.0, 3000.0, 9000.0})
            for (const double share : {0.0, 0.1, 0.3, 1.0, 4.0}) {
                CAPTURE(n);
                CAPTURE(share);
                const double count = std::max(4.0, std::min(10000.0, share * n));
                check_grid(kit::tiled_grid(source, tiling, count, 0.7 * nodes_for(tiling, 300, 200, n), go_on), source);
            }
    }
}

TEST_CASE("a tiled grid is the same whatever the executor's order, and a mesh when told to stop") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(150, 110, 2);
    const ImageSource<3> source(image.view());
    const Tiling tiling(150, 110, 50);
    const IndexedMesh<3> serial = kit::tiled_grid(source, tiling, 600, 120, go_on);
    CHECK(hmesh_test::same_bits(serial, kit::tiled_grid(source, tiling, 600, 120, go_on, hmesh_test::ReverseFor{})));
    CHECK(hmesh_test::same_bits(serial, kit::tiled_grid(source, tiling, 600, 120, go_on, hmesh_test::ShuffledFor{3})));
    CHECK(check(kit::tiled_grid(source, tiling, 600, 120, [] { return false; })));
}
