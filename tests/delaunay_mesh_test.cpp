#include "hmesh/tiles/delaunay_mesh.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <set>
#include <utility>
#include <vector>

#include "hmesh/core/array.hpp"
#include "hmesh/core/random.hpp"
#include "hmesh/mesh/periodic.hpp"
#include "hmesh/mesh/samples.hpp"
#include "test_executors.hpp"
#include "test_images.hpp"
#include "test_indexed_meshes.hpp"

namespace kit = hmesh::kit;
using hmesh::kit::Delaunay;
using hmesh::kit::Point;

namespace {

int most_edges(const kit::IndexedMesh<1>& mesh) {
    kit::HalfedgeMesh topology;
    REQUIRE(topology.assign(mesh.vertex_count(), mesh.faces));
    int most = 0;
    for (const kit::Vertex v : topology.vertices()) most = std::max(most, topology.valence(v));
    return most;
}

// The Delaunay mesh of the points, whose valences are too large, with few enough edges; returns how many vertices came.
std::size_t check_bound(int side, const std::vector<Point>& points, int limit) {
    const auto image = hmesh_test::noise<std::uint8_t, 1>(side, side, 1);
    kit::IndexedMesh<1> mesh = kit::delaunay_mesh(kit::ImageSource<1>(image.view()), kit::triangulate(side, side, points));
    const std::size_t before = mesh.vertex_count();
    REQUIRE(most_edges(mesh) > limit);
    CHECK(kit::bound_valence(mesh, limit));
    CHECK(most_edges(mesh) <= limit);
    hmesh_test::prove(mesh);
    for (const hmesh::Triangle& t : mesh.faces)
        CHECK(kit::orient2d(mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]) >= 0.25);
    return mesh.vertex_count() - before;
}

}  // namespace

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

TEST_CASE("a pixel's vertex is at its centre, and on the border for the outermost pixels; all are inserted") {
    CHECK(kit::pixel_vertex(0, 5, 4) == Point{0, 0});
    CHECK(kit::pixel_vertex(6, 5, 4) == Point{1.5, 1.5});
    CHECK(kit::pixel_vertex(19, 5, 4) == Point{5, 4});
    CHECK(kit::pixel_vertex(0, 1, 1) == Point{0.5, 0.5});
    CHECK(kit::pixel_vertex(2, 1, 3) == Point{0.5, 3});
    Delaunay delaunay(5, 4);
    REQUIRE(kit::insert_pixels(delaunay, {0, 6, 7, 19, 13, 10}, [] { return true; }));
    CHECK(delaunay.topology().vertex_count() == 8);  // two are corners
    CHECK(delaunay.check());
    std::vector<std::uint32_t> many(10000);
    for (std::uint32_t k = 0; k < 10000; ++k) many[k] = k;
    Delaunay stopped(100, 100);
    int asked = 0;
    CHECK_FALSE(kit::insert_pixels(stopped, many, [&] { return ++asked < 2; }));
    CHECK(asked == 2);
    CHECK(stopped.topology().vertex_count() < 10000);
}

TEST_CASE("many pixels are triangulated in bands: all of them, by Delaunay's rule, the same by any executor") {
    hmesh::kit::Random random(3);
    struct Shape {
        int width, height;
        std::size_t pixels;  // 0: all
        std::size_t bands;
    };
    for (const Shape& shape : {Shape{120, 90, 0, 5}, Shape{90, 120, 0, 5}, Shape{700, 20, 0, 1}, Shape{20, 9000, 70000, 34},
                               Shape{1, 9000, 9000, 4}, Shape{2000, 1500, 6200, 3}, Shape{300, 300, 4095, 1}})
        for (const hmesh::Samples samples : {hmesh::Samples::squares, hmesh::Samples::points}) {
            if (samples == hmesh::Samples::points && shape.width == 1) continue;
            CAPTURE(shape.width);
            const auto all = static_cast<std::size_t>(shape.width) * static_cast<std::size_t>(shape.height);
            kit::Array<std::uint32_t> pixels;
            for (std::size_t k = 0; k < (shape.pixels > 0 ? shape.pixels : all); ++k)
                pixels.push_back(static_cast<std::uint32_t>(shape.pixels > 0 ? random.below(all) : k));
            std::sort(pixels.begin(), pixels.end());
            const auto go_on = [] { return true; };
            Delaunay one(shape.width, shape.height, samples), many = one, backwards = one, threads = one;
            REQUIRE(kit::insert_pixels(one, pixels, go_on));
            REQUIRE(kit::triangulate_pixels(many, pixels, {}, go_on));
            CHECK(many.check());
            std::vector<std::pair<double, double>> places[2], more;
            for (const Delaunay* mesh : {&one, &many})
                for (const kit::Vertex v : mesh->topology().vertices())
                    places[mesh == &many ? 1 : 0].emplace_back(mesh->position(v).x, mesh->position(v).y);
            for (auto& list : places) std::sort(list.begin(), list.end());
            std::set_difference(places[1].begin(), places[1].end(), places[0].begin(), places[0].end(), std::back_inserter(more));
            CHECK(places[1].size() == places[0].size() + 2 * (shape.bands - 1));
            REQUIRE(more.size() == 2 * (shape.bands - 1));  // two where bands meet, left and right
            const double low = kit::inset(samples);
            for (std::size_t k = 0; k < more.size(); ++k) CHECK(more[k].first == (2 * k < more.size() ? low : shape.width - low));
            REQUIRE(kit::triangulate_pixels(backwards, pixels, hmesh_test::ReverseFor(), go_on));
            REQUIRE(kit::triangulate_pixels(threads, pixels, hmesh_test::ThreadFor{3}, go_on));
            for (const Delaunay* other : {&backwards, &threads}) {
                CHECK(other->topology().triangles(hmesh_test::ReverseFor()) == many.topology().triangles());
                for (const kit::Vertex v : many.topology().vertices()) REQUIRE(other->position(v) == many.position(v));
            }
        }
}

TEST_CASE("pixels that are all in few rows are triangulated too") {
    kit::Array<std::uint32_t> pixels;
    for (std::uint32_t k = 0; k < 60 * 3000; ++k)
        if (k / 60 < 4 || k / 60 > 2920) pixels.push_back(k);
    Delaunay delaunay(60, 3000);
    REQUIRE(kit::triangulate_pixels(delaunay, pixels, {}, [] { return true; }));
    CHECK(delaunay.check());
    CHECK(delaunay.topology().vertex_count() >= pixels.size());
}

TEST_CASE("who has seen enough stops a triangulation in bands, before they are joined or after") {
    kit::Array<std::uint32_t> pixels;
    for (std::uint32_t k = 0; k < 120 * 90; ++k) pixels.push_back(k);
    for (int calls = 1; calls <= 2; ++calls) {
        Delaunay delaunay(120, 90);
        int asked = 0;
        CHECK_FALSE(kit::triangulate_pixels(delaunay, pixels, {}, [&] { return ++asked < calls; }));
        CHECK(asked == calls);
    }
}

TEST_CASE("a vertex in the middle of a circle of points has as few edges as asked for afterwards") {
    for (const int limit : {16, 32}) {
        std::vector<Point> points = {{128, 128}};
        for (int k = 0; k < 200; ++k) {
            const double angle = 6.283185307179586 * k / 200;
            points.push_back(kit::snap({128 + 100 * std::cos(angle), 128 + 100 * std::sin(angle)}));
        }
        (void)check_bound(256, points, limit);
        points.resize(1);  // the circle's pixels
        for (int y = 0; y < 256; ++y)
            for (int x = 0; x < 256; ++x)
                if (std::abs(std::hypot(x - 127.5, y - 127.5) - 100) < 0.5) points.push_back({x + 0.5, y + 0.5});
        (void)check_bound(256, points, limit);
    }
}

TEST_CASE("a vertex beside a straight line of points, none of whose edges can turn, loses them to new vertices") {
    for (const int limit : {16, 32})
        for (const double distance : {1.0, 2.0, 40.0}) {
            std::vector<Point> points = {{128.5, 100.5 - distance}};
            for (int x = 30; x < 230; ++x) points.push_back({x + 0.5, 100.5});
            CHECK(check_bound(256, points, limit) > 0);
            std::vector<Point> upright;
            for (const Point p : points) upright.push_back({p.y, p.x});
            CHECK(check_bound(256, upright, limit) > 0);
        }
    // As many as no single layer of new vertices takes.
    std::vector<Point> many = {{1500.5, 1000.5}};
    for (int x = 10; x < 2990; ++x) many.push_back({x + 0.5, 2000.5});
    CHECK(check_bound(3000, many, 32) > 100);
    // A line along the border, and the border's own vertices.
    std::vector<Point> border = {{128.5, 60.5}};
    for (int x = 1; x < 255; ++x) border.push_back({x + 0.5, 0});
    CHECK(check_bound(256, border, 16) > 0);
}

TEST_CASE("a mesh whose vertices have few edges stays as it is") {
    const auto image = hmesh_test::scene<std::uint8_t, 1>(64, 64, 1);
    kit::Random random(1);
    std::vector<Point> points;
    for (int k = 0; k < 300; ++k) points.push_back(kit::snap({64 * random.uniform(), 64 * random.uniform()}));
    kit::IndexedMesh<1> mesh = kit::delaunay_mesh(kit::ImageSource<1>(image.view()), kit::triangulate(64, 64, points));
    const kit::IndexedMesh<1> before = mesh;
    REQUIRE(most_edges(mesh) <= 20);
    CHECK(kit::bound_valence(mesh, 20));
    CHECK(mesh.positions == before.positions);
    CHECK(mesh.faces == before.faces);
}

TEST_CASE("where faces are small, those that are new are not, no vertex gets more edges, and what is said of them is true") {
    const auto image = hmesh_test::noise<std::uint8_t, 1>(64, 64, 1);
    int bounded = 0, failed = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        kit::Random random(seed);
        // Two hubs that see as many points around them; one may have them near, where faces cannot turn.
        std::vector<Point> points;
        for (const double x : {14.0, 46.0}) {
            const double radius = x > 32 ? 13 : 1 + 8 * random.uniform(), width = seed % 3 == 0 ? 0 : random.uniform();
            points.push_back({x, 30});
            for (int k = 0; k < 30; ++k) {
                const double angle = 6.283185307179586 * random.uniform(), far = radius + width * random.uniform();
                points.push_back(kit::snap({x + far * std::cos(angle), 30 + far * std::sin(angle)}));
            }
        }
        kit::IndexedMesh<1> mesh = kit::delaunay_mesh(kit::ImageSource<1>(image.view()), kit::triangulate(64, 64, points));
        const std::set<hmesh::Triangle> before(mesh.faces.begin(), mesh.faces.end());
        const int most = most_edges(mesh);
        const bool is_bounded = kit::bound_valence(mesh, 16);
        ++(is_bounded ? bounded : failed);
        CHECK(is_bounded == (most_edges(mesh) <= 16));
        CHECK(most_edges(mesh) <= std::max(16, most));
        hmesh_test::prove(mesh);
        for (hmesh::Triangle t : mesh.faces) {
            bool is_old = false;
            for (int turn = 0; turn < 3; ++turn) {
                std::rotate(t.begin(), t.begin() + 1, t.end());
                is_old = is_old || before.count(t) > 0;
            }
            if (!is_old) CHECK(kit::orient2d(mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]) >= 0.25);
        }
    }
    CHECK(bounded > 0);
    CHECK(failed > 0);
}

TEST_CASE("a vertex on the border, which has an edge more than faces, is bounded too") {
    for (int count = 12; count < 20; ++count) {
        std::vector<Point> points = {{128, 0}};
        for (int k = 0; k < count; ++k) {
            const double angle = 3.141592653589793 * (k + 0.5) / count;
            points.push_back(kit::snap({128 + 100 * std::cos(angle), 100 * std::sin(angle)}));
        }
        const auto image = hmesh_test::noise<std::uint8_t, 1>(256, 256, 1);
        kit::IndexedMesh<1> mesh = kit::delaunay_mesh(kit::ImageSource<1>(image.view()), kit::triangulate(256, 256, points));
        CHECK(kit::bound_valence(mesh, 16));
        CHECK(most_edges(mesh) <= 16);
        hmesh_test::prove(mesh);
    }
}

TEST_CASE("along the axes on which an image repeats pixels on its sides are left out, unless it has no others") {
    for (const int width : {1, 2, 5})
        for (const int height : {1, 2, 4})
            for (const hmesh::Periodic periodic :
                 {hmesh::Periodic::none, hmesh::Periodic::x, hmesh::Periodic::y, hmesh::Periodic::xy}) {
                kit::Array<std::uint32_t> pixels, expected;
                for (int y = 0; y < height; ++y)
                    for (int x = 0; x < width; ++x) {
                        const auto pixel = static_cast<std::uint32_t>(y * width + x);
                        const Point p = kit::pixel_vertex(pixel, width, height);
                        const bool on_x = p.x == 0 || p.x == width, on_y = p.y == 0 || p.y == height;
                        pixels.push_back(pixel);
                        if (!(on_x && hmesh::kit::wraps_x(periodic)) && !(on_y && hmesh::kit::wraps_y(periodic)))
                            expected.push_back(pixel);
                    }
                kit::leave_out_sides(pixels, width, height, periodic);
                CHECK(pixels == expected);
            }
}

TEST_CASE("of the pixels that crowd around a vertex with as many edges as asked for every second is left out") {
    constexpr int side = 64, limit = 16;
    for (const int count : {limit - 1, limit, 40}) {
        kit::Array<std::uint32_t> pixels = {20 * side + 32, 2 * side + 5, 60 * side + 50};
        for (int k = 0; k < count; ++k) {
            const double angle = 6.283185307179586 * k / count;
            const int x = static_cast<int>(32.5 + 15 * std::cos(angle)), y = static_cast<int>(20.5 + 15 * std::sin(angle));
            pixels.push_back(static_cast<std::uint32_t>(y * side + x));
        }
        Delaunay delaunay(side, side);
        REQUIRE(kit::insert_pixels(delaunay, pixels, [] { return true; }));
        const std::vector<hmesh::Triangle> faces = delaunay.topology().triangles();
        kit::Array<Point> positions;
        for (const kit::Vertex v : delaunay.topology().vertices()) positions.push_back(delaunay.position(v));
        // The vertices of faces of a vertex with so many of them.
        kit::Array<std::uint32_t> expected;
        int crowded = 0;
        for (const std::uint32_t pixel : pixels) {
            bool is_crowded = false;
            for (const hmesh::Triangle& face : faces)
                for (const std::uint32_t center : face) {
                    const auto has_it = [&](const hmesh::Triangle& t) { return std::count(t.begin(), t.end(), center) > 0; };
                    if (std::count_if(faces.begin(), faces.end(), has_it) < limit) continue;
                    for (const std::uint32_t v : face)
                        is_crowded = is_crowded || positions[v] == kit::pixel_vertex(pixel, side, side);
                }
            if (!is_crowded || ++crowded % 2 == 0) expected.push_back(pixel);
        }
        CHECK(kit::leave_out_crowd(pixels, positions, faces, side, side, limit) == (crowded > 0));
        CHECK((crowded > 0) == (count >= limit));
        CHECK(pixels == expected);
    }
}
