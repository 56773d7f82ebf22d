#include "hmesh/methods/annealed/first_price.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/edit/insert.hpp"
#include "test_images.hpp"
#include "test_meshes.hpp"

namespace kit = hmesh::kit;
using hmesh::kit::Edge;
using hmesh::kit::Face;
using hmesh::kit::first_price;
using hmesh::kit::sample_worths;
using hmesh::kit::Vertex;
using hmesh::kit::VertexWorths;
using hmesh_test::Subject;

TEST_CASE("each edge and face counts for one vertex, with the gain that its candidate has") {
    const Subject<std::uint8_t, 1> subject(hmesh_test::noise<std::uint8_t, 1>(60, 50, 1),
                                           hmesh_test::jittered_grid(60, 50, 7, 6, 1));
    const kit::ImageMesh<1>& mesh = subject.mesh;
    VertexWorths worths;
    sample_worths(mesh, kit::spatial_vertices(mesh), 1, worths);
    REQUIRE(worths.gains.size() == mesh.vertex_count());
    // The largest gain of all sites, found without any ownership, is the largest of all vertices.
    kit::RingScratch<1> scratch;
    double most = 0, sum = 0;
    for (const Edge e : mesh.topology().edges()) most = std::max(most, kit::edge_candidate(mesh, scratch, e, true).gain);
    for (const Face f : mesh.topology().faces()) most = std::max(most, kit::face_candidate(mesh, scratch, f, true).gain);
    CHECK(most > 0);
    CHECK(*std::max_element(worths.gains.begin(), worths.gains.end()) == most);
    for (const double gain : worths.gains) {
        CHECK(gain >= 0);
        sum += gain;
    }
    CHECK(sum > 0);
    // Corners have no collapse.
    CHECK(worths.costs.size() == mesh.vertex_count() - 4);
    std::vector<double> costs;
    for (const kit::Vertex v : mesh.topology().vertices())
        if (const kit::CollapseCandidate c = kit::cheapest_collapse(mesh, scratch, v); c.halfedge.is_valid())
            costs.push_back(c.cost);
    std::sort(costs.begin(), costs.end());
    std::sort(worths.costs.begin(), worths.costs.end());
    CHECK(costs == worths.costs);
}

TEST_CASE("every step-th vertex is looked at, and several patches add up") {
    const Subject<std::uint8_t, 1> subject(hmesh_test::noise<std::uint8_t, 1>(60, 50, 1),
                                           hmesh_test::jittered_grid(60, 50, 7, 6, 1));
    VertexWorths worths;
    sample_worths(subject.mesh, kit::spatial_vertices(subject.mesh), 5, worths);
    CHECK(worths.gains.size() == (subject.mesh.vertex_count() + 4) / 5);
    sample_worths(subject.mesh, kit::spatial_vertices(subject.mesh), 1000, worths);
    CHECK(worths.gains.size() == (subject.mesh.vertex_count() + 4) / 5 + 1);
}

TEST_CASE("the price is 2.35 times the median gain, at least 0.3 times what the cheapest quarter costs") {
    VertexWorths none;
    CHECK(first_price(none) == 0);
    VertexWorths gains{{5, 1, 3, 2, 4}, {}};
    CHECK(first_price(gains) == doctest::Approx(2.35 * 3));
    VertexWorths both{{5, 1, 3, 2, 4}, {100, 60, 20, 80, 40, -10, 90, 70}};
    CHECK(first_price(both) == doctest::Approx(2.35 * 3));
    VertexWorths costly{{0, 0, 3}, {100, 60, 20, 80, 40, -10, 90, 70}};  // the quarter is -10, which counts as 0, and 20
    CHECK(first_price(costly) == doctest::Approx(0.3 * 10));
}
