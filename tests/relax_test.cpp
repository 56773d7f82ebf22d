#include "hmesh/edit/relax.hpp"

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

using hmesh::kit::Halfedge;
using hmesh::kit::ImageMesh;
using hmesh::kit::Random;
using hmesh::kit::Vertex;
using hmesh_test::Subject;

namespace {

template <int C>
std::vector<Vertex> ring_of(const ImageMesh<C>& mesh, Vertex v) {
    std::vector<Vertex> ring;
    for (const Halfedge h : mesh.topology().outgoing(v)) ring.push_back(mesh.topology().to_vertex(h));
    return ring;
}

template <class T, int C>
void check_relaxing(hmesh::Image<T, C> image, double range, std::uint64_t seed) {
    const int width = image.width(), height = image.height();
    Subject<T, C> subject(std::move(image), hmesh_test::jittered_grid(width, height, 5, 4, seed));
    ImageMesh<C>& mesh = subject.mesh;
    hmesh_test::wear(mesh, 60, range, seed);
    Random random(seed);
    int gained = 0;
    for (int k = 0; k < 80; ++k) {
        const std::vector<Vertex> ring = ring_of(mesh, hmesh_test::any_vertex(mesh, random));
        std::vector<unsigned char> in_ring(mesh.topology().vertex_slots(), 0);
        for (const Vertex v : ring) in_ring[v.index()] = 1;
        std::vector<hmesh::kit::VertexState<C>> old;
        for (std::size_t i = 0; i < mesh.topology().vertex_slots(); ++i) old.push_back(mesh.vertex(Vertex(i)));
        const double before = mesh.energy();
        hmesh::kit::relax(mesh, ring, {});
        REQUIRE(mesh.energy() <= before + hmesh_test::rounding(subject));
        gained += mesh.energy() < before ? 1 : 0;
        hmesh_test::prove(subject);
        for (const Vertex v : mesh.topology().vertices()) {
            if (in_ring[v.index()] != 0) continue;
            REQUIRE(mesh.position(v) == old[v.index()].position);
            for (int c = 0; c < C; ++c) REQUIRE(mesh.color(v)[c] == old[v.index()].color[c]);
        }
    }
    CHECK(gained > 40);
}

}  // namespace

TEST_CASE("relaxing never raises the energy and moves no other vertex than the given ones") {
    check_relaxing(hmesh_test::scene<std::uint8_t, 3>(31, 26, 1), 255, 1);
    check_relaxing(hmesh_test::noise<std::uint16_t, 1>(29, 25, 2), 65535, 2);
    check_relaxing(hmesh_test::scene<float, 2>(27, 28, 3), 1, 3);
}

TEST_CASE("more rounds gain more, and none changes nothing") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(41, 36, 1);
    const auto grid = hmesh_test::jittered_grid(41, 36, 4, 4, 1);
    double last = 0;
    for (const int rounds : {0, 1, 2, 5, 20}) {
        Subject<std::uint8_t, 3> subject(image, grid);
        const auto before = hmesh_test::snapshot(subject.mesh);
        std::vector<Vertex> all;
        for (const Vertex v : subject.mesh.topology().vertices()) all.push_back(v);
        hmesh::kit::relax(subject.mesh, all, {rounds, 0});
        if (rounds == 0) CHECK(hmesh_test::snapshot(subject.mesh) == before);
        else CHECK(subject.mesh.energy() < last);
        last = subject.mesh.energy();
        hmesh_test::prove(subject);
    }
}

TEST_CASE("relaxing turns the edges at the given vertices and no other") {
    // Flat, then rising from the diagonal on that the mesh does not have.
    hmesh::Image<std::uint8_t, 1> image(16, 16);
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x) *image.pixel(x, y) = static_cast<std::uint8_t>(12 * std::max(0, x + y - 15));
    const std::vector<hmesh::kit::Point> corners = {{0, 0}, {16, 0}, {16, 16}, {0, 16}};
    for (const std::size_t first : {0U, 1U}) {
        Subject<std::uint8_t, 1> subject(image);
        REQUIRE(subject.mesh.assign(corners, {{0, 1, 2}, {0, 2, 3}}));
        const double before = subject.mesh.energy();
        hmesh::kit::relax(subject.mesh, {Vertex(first), Vertex(first + 2)}, {20, 0});
        CHECK(subject.mesh.energy() < before);
        hmesh_test::prove(subject);
        CHECK(subject.mesh.topology().find_halfedge(Vertex(1), Vertex(3)).is_valid() == (first == 0));
    }
}

TEST_CASE("relaxing over a constant picture changes nothing that shows") {
    Subject<std::uint8_t, 1> subject(hmesh_test::constant_image<std::uint8_t, 1>(20, 20, 0.5),
                                     hmesh_test::jittered_grid(20, 20, 3, 3, 1));
    std::vector<Vertex> all;
    for (const Vertex v : subject.mesh.topology().vertices()) all.push_back(v);
    hmesh::kit::relax(subject.mesh, all, {});
    CHECK(std::abs(subject.mesh.energy()) < 1e-6);
    hmesh_test::prove(subject);
}
