#include "hmesh/mesh/spatial_order.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "hmesh/core/random.hpp"
#include "test_images.hpp"
#include "test_meshes.hpp"

using hmesh::kit::Edge;
using hmesh::kit::Face;
using hmesh::kit::Halfedge;
using hmesh::kit::HalfedgeMesh;
using hmesh::kit::in_spatial_order;
using hmesh::kit::morton_code;
using hmesh::kit::Point;
using hmesh::kit::Random;
using hmesh::kit::Vertex;
using hmesh_test::Subject;

namespace {

// Bit by bit.
std::uint32_t interleaved(std::uint32_t x, std::uint32_t y) {
    std::uint32_t code = 0;
    for (unsigned bit = 0; bit < 16; ++bit) code |= ((x >> bit & 1U) << (2 * bit)) | ((y >> bit & 1U) << (2 * bit + 1));
    return code;
}

std::vector<std::size_t> indices(std::size_t count) {
    std::vector<std::size_t> list(count);
    for (std::size_t k = 0; k < count; ++k) list[k] = k;
    return list;
}

void check_order(const std::vector<Point>& points) {
    const auto range = indices(points.size());
    const auto order = in_spatial_order<std::size_t>(range, range.size(), [&](std::size_t k) { return points[k]; });
    auto expected = range;
    std::stable_sort(expected.begin(), expected.end(),
                     [&](std::size_t a, std::size_t b) { return morton_code(points[a]) < morton_code(points[b]); });
    CHECK(order == expected);
}

std::vector<Point> random_points(std::size_t count, double width, double height, std::uint64_t seed) {
    Random random(seed);
    std::vector<Point> points(count);
    for (Point& p : points) p = {width * random.uniform(), height * random.uniform()};
    return points;
}

template <class Element>
void check_sorted(const hmesh::kit::Array<Element>& elements, std::vector<std::pair<std::uint32_t, std::size_t>> expected) {
    std::sort(expected.begin(), expected.end());
    REQUIRE(elements.size() == expected.size());
    for (std::size_t k = 0; k < elements.size(); ++k) REQUIRE(elements[k].index() == expected[k].second);
}

template <int C>
void check_orders(const hmesh::kit::ImageMesh<C>& mesh) {
    std::vector<std::pair<std::uint32_t, std::size_t>> vertices, faces;
    for (const Vertex v : mesh.topology().vertices()) vertices.emplace_back(morton_code(mesh.position(v)), v.index());
    for (const Face f : mesh.topology().faces()) {
        const auto v = mesh.topology().vertices(f);
        const Point a = mesh.position(v[0]), b = mesh.position(v[1]), c = mesh.position(v[2]);
        faces.emplace_back(morton_code({(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3}), f.index());
    }
    check_sorted(hmesh::kit::spatial_vertices(mesh), vertices);
    check_sorted(hmesh::kit::spatial_faces(mesh), faces);
    // Edges come with the faces: with that of their even half-edge or, on the border, with the only one.
    std::vector<std::size_t> edges;
    for (const Face f : hmesh::kit::spatial_faces(mesh)) {
        Halfedge h = mesh.topology().halfedge(f);
        for (int i = 0; i < 3; ++i, h = mesh.topology().next(h))
            if (h == HalfedgeMesh::halfedge(HalfedgeMesh::edge(h)) || mesh.topology().is_boundary(HalfedgeMesh::edge(h)))
                edges.push_back(HalfedgeMesh::edge(h).index());
    }
    std::vector<std::size_t> found;
    for (const Edge e : hmesh::kit::spatial_edges(mesh)) found.push_back(e.index());
    REQUIRE(found == edges);
    std::sort(found.begin(), found.end());
    REQUIRE(std::unique(found.begin(), found.end()) == found.end());
    REQUIRE(found.size() == mesh.topology().edge_count());
}

}  // namespace

TEST_CASE("the code has the bits of the pixel's x and y in turn, x first") {
    CHECK(morton_code({0, 0}) == 0);
    CHECK(morton_code({1, 0}) == 1);
    CHECK(morton_code({0, 1}) == 2);
    CHECK(morton_code({1.99, 1.5}) == 3);
    CHECK(morton_code({65535.9, 65535.9}) == 0xffffffffU);
    CHECK(morton_code({65535, 0}) == 0x55555555U);
    CHECK(morton_code({65536, 0}) == 0);  // the border wraps around
    Random random(1);
    for (int k = 0; k < 10000; ++k) {
        const std::uint32_t x = random.next() >> 16U, y = random.next() >> 16U;
        const Point p{x + random.uniform(), y + random.uniform()};
        REQUIRE(morton_code(p) == interleaved(x, y));
    }
    static_assert(morton_code({5, 3}) == 0x1bU, "usable at compile time");
}

TEST_CASE("elements come by rising code, and in their own order where codes are equal") {
    for (const double size : {1.0, 2.0, 40.0, 3000.0, 65536.0})
        for (const std::size_t count : {1U, 2U, 77U, 5000U}) {
            check_order(random_points(count, size, size, count));
            check_order(random_points(count, size, 1, count));
            check_order(random_points(count, 1, size, count));
        }
}

TEST_CASE("no element gives no order, and one pixel keeps all as they were") {
    check_order({});
    check_order(std::vector<Point>(500, Point{0, 0}));
    check_order(std::vector<Point>(500, Point{65535, 65535}));
}

TEST_CASE("neighbors in the order are neighbors in the plane") {
    const auto points = random_points(4000, 256, 256, 1);
    const auto range = indices(points.size());
    const auto order = in_spatial_order<std::size_t>(range, range.size(), [&](std::size_t k) { return points[k]; });
    const auto length = [&](const std::vector<std::size_t>& list) {
        double sum = 0;
        for (std::size_t k = 1; k < list.size(); ++k)
            sum += std::hypot(points[list[k]].x - points[list[k - 1]].x, points[list[k]].y - points[list[k - 1]].y);
        return sum;
    };
    CHECK(length(order) < 0.1 * length(range));
}

TEST_CASE("live vertices and faces come once each in Morton's order, ties by index, and edges once each with their faces") {
    Subject<std::uint8_t, 1> subject(hmesh_test::noise<std::uint8_t, 1>(90, 50, 1), hmesh_test::jittered_grid(90, 50, 20, 12, 1));
    check_orders(subject.mesh);
    hmesh_test::wear(subject.mesh, 1500, 255, 1);
    check_orders(subject.mesh);
    CHECK(subject.mesh.vertex_count() < subject.mesh.topology().vertex_slots());

    Subject<std::uint8_t, 1> crowded(hmesh_test::noise<std::uint8_t, 1>(3, 3, 1), hmesh_test::jittered_grid(3, 3, 12, 12, 1));
    check_orders(crowded.mesh);  // many ties
}
