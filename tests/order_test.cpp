
#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "test_images.hpp"
#include "test_meshes.hpp"

using hmesh::kit::Face;
using hmesh::kit::Point;
using hmesh::kit::Vertex;
using hmesh_test::Subject;

namespace {

// Bits of x and y in turn, one by one.
std::uint32_t interleaved(Point p) {
    const auto x = static_cast<std::uint32_t>(p.x), y = static_cast<std::uint32_t>(p.y);
    std::uint32_t code = 0;
    for (unsigned bit = 0; bit < 16; ++bit) code |= ((x >> bit & 1U) << (2 * bit)) | ((y >> bit & 1U) << (2 * bit + 1));
    return code;
}

template <class Element>
void check_sorted(const std::vector<Element>& elements, std::vector<std::pair<std::uint32_t, std::size_t>> expected) {
    std::sort(expected.begin(), expected.end());
    REQUIRE(elements.size() == expected.size());
    for (std::size_t k = 0; k < elements.size(); ++k) REQUIRE(elements[k].index() == expected[k].second);
}

template <int C>
void check_orders(const hmesh::kit::ImageMesh<C>& mesh) {
    std::vector<std::pair<std::uint32_t, std::size_t>> vertices, faces;
    for (const Vertex v : mesh.topology().vertices()) vertices.emplace_back(interleaved(mesh.position(v)), v.index());
    for (const Face f : mesh.topology().faces()) {
        const auto v = mesh.topology().vertices(f);
        const Point a = mesh.position(v[0]), b = mesh.position(v[1]), c = mesh.position(v[2]);
        faces.emplace_back(interleaved({(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3}), f.index());
    }
    check_sorted(hmesh::kit::spatial_vertices(mesh), vertices);
    check_sorted(hmesh::kit::spatial_faces(mesh), faces);
}

}  // namespace

TEST_CASE("live vertices and faces come once each in Morton's order, ties by index") {
    Subject<std::uint8_t, 1> subject(hmesh_test::noise<std::uint8_t, 1>(90, 50, 1), hmesh_test::jittered_grid(90, 50, 20, 12, 1));
    check_orders(subject.mesh);
    hmesh_test::wear(subject.mesh, 1500, 255, 1);
    check_orders(subject.mesh);
    CHECK(subject.mesh.vertex_count() < subject.mesh.topology().vertex_slots());

    Subject<std::uint8_t, 1> crowded(hmesh_test::noise<std::uint8_t, 1>(3, 3, 1), hmesh_test::jittered_grid(3, 3, 12, 12, 1));
    check_orders(crowded.mesh);  // many ties
}
