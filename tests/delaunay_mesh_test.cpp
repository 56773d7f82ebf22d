#include "hmesh/tiles/delaunay_mesh.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/core/random.hpp"
#include "test_images.hpp"
#include "test_indexed_meshes.hpp"

namespace kit = hmesh::kit;
using hmesh::kit::Delaunay;
using hmesh::kit::Point;

TEST_CASE("a Delaunay triangulation is a mesh of its image, whether points were only added or some removed again") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(40, 31, 1);
    const kit::ImageSource<3> source(image.view());
    kit::Random random(1);
    std::vector<Point> points;
    for (int k = 0; k < 120; ++k) points.push_back(kit::snap({40 * random.uniform(), 31 * random.uniform()}));
    Delaunay delaunay = kit::triangulate(40, 31, points);
    for (int round = 0; round < 3; ++round) {
        const kit::IndexedMesh<3> mesh = kit::delaunay_mesh(source, delaunay);
        hmesh_test::prove(mesh);
        REQUIRE(mesh.vertex_count() == delaunay.topology().vertex_count());
        std::size_t row = 0;
        for (const kit::Vertex v : delaunay.topology().vertices()) {
            const Point p = delaunay.position(v);
            CHECK(mesh.positions[row] == p);
            const std::uint8_t* pixel = image.pixel(std::min(39, static_cast<int>(p.x)), std::min(30, static_cast<int>(p.y)));
            for (int c = 0; c < 3; ++c) CHECK(mesh.colors[row][c] == pixel[c]);
            CHECK(mesh.dirty[row] != 0);
            ++row;
        }
        for (std::size_t k = 20; k < 120; k += 9) {  // leaves deleted slots
            const kit::Vertex v = delaunay.insert(points[k - static_cast<std::size_t>(round)]);
            if (!Delaunay::is_corner(v)) delaunay.remove(v);
        }
    }
}
