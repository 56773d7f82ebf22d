#include "hmesh/tiles/recut.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "hmesh/mesh/halfedge_mesh.hpp"
#include "periodic_sheets.hpp"
#include "test_images.hpp"
#include "test_indexed_meshes.hpp"

using hmesh::Periodic;
using hmesh::kit::IndexedMesh;
using hmesh::kit::Point;
using hmesh_test::random_periodic;

namespace {

// What a mesh is on the torus: its faces by the places of their corners, each face from its least corner on.
std::multiset<std::array<double, 9>> faces_of(const IndexedMesh<1>& mesh) {
    std::multiset<std::array<double, 9>> out;
    for (const hmesh::Triangle& face : mesh.faces) {
        std::array<std::array<double, 3>, 3> corners{};
        for (std::size_t k = 0; k < 3; ++k) {
            const Point p = mesh.positions[face[k]];
            const Point q = hmesh::kit::turned(p, hmesh::kit::turns_into(p, 0, 0, mesh.torus()), mesh.torus());
            corners[k] = {q.x, q.y, mesh.colors[face[k]][0]};
        }
        std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
        std::array<double, 9> all{};
        for (std::size_t k = 0; k < 9; ++k) all[k] = corners[k / 3][k % 3];
        out.insert(all);
    }
    return out;
}

constexpr Periodic axes[] = {Periodic::x, Periodic::y, Periodic::xy};

}  // namespace

TEST_CASE("a mesh that is cut elsewhere is the same on the torus, and its faces are where the cut says") {
    for (const Periodic periodic : axes)
        for (std::uint64_t seed = 0; seed < 6; ++seed) {
            const int width = 12 + static_cast<int>(seed), height = 9;
            IndexedMesh<1> mesh = random_periodic(width, height, 40, periodic, seed);
            REQUIRE(hmesh::kit::check(mesh));
            const auto before = faces_of(mesh);
            const std::size_t distinct = mesh.distinct_count();
            for (const auto& [x, y] : {std::pair(5, 4), std::pair(1, 8), std::pair(11, 1), std::pair(0, 0)}) {
                const int left = hmesh::kit::wraps_x(periodic) ? x : 0, top = hmesh::kit::wraps_y(periodic) ? y : 0;
                hmesh::kit::recut(mesh, left, top);
                CHECK(hmesh::kit::check(mesh));
                CHECK(faces_of(mesh) == before);
                CHECK(mesh.distinct_count() == distinct);
                for (const hmesh::Triangle& face : mesh.faces) {
                    Point sum;
                    for (const std::uint32_t v : face) sum = {sum.x + mesh.positions[v].x / 3, sum.y + mesh.positions[v].y / 3};
                    REQUIRE((sum.x > left - 1e-9 && sum.x < left + width + 1e-9));
                    REQUIRE((sum.y > top - 1e-9 && sum.y < top + height + 1e-9));
                }
            }
        }
}

TEST_CASE("vertices that were locked stay in front, and marks of copies come together") {
    IndexedMesh<1> mesh = random_periodic(16, 16, 50, Periodic::xy, 3);
    std::fill(mesh.dirty.begin(), mesh.dirty.end(), static_cast<unsigned char>(0));
    const auto copy = static_cast<std::size_t>(
        std::find_if(mesh.roots.begin(), mesh.roots.end(),
                     [&](std::uint32_t& root) { return root != static_cast<std::uint32_t>(&root - mesh.roots.data()); }) -
        mesh.roots.begin());
    REQUIRE(copy < mesh.vertex_count());
    mesh.dirty[copy] = 1;
    mesh.locked_count = 9;
    const double last = mesh.positions[8].x, color = mesh.colors[8][0];
    const std::set<std::uint32_t> locked(mesh.roots.begin(), mesh.roots.begin() + 9);
    hmesh::kit::recut(mesh, 7, 5);
    CHECK(std::count(mesh.dirty.begin(), mesh.dirty.end(), 1) >= 1);
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) CHECK(mesh.dirty[v] == mesh.dirty[mesh.roots[v]]);
    std::set<std::uint32_t> now;
    for (std::size_t v = 0; v < mesh.locked_count; ++v) now.insert(mesh.roots[v]);
    CHECK(now.size() == locked.size());
    const bool is_there = std::any_of(now.begin(), now.end(), [&](std::uint32_t v) {
        return std::fmod(mesh.positions[v].x + 16, 16) == std::fmod(last, 16) && mesh.colors[v][0] == color;
    });
    CHECK(is_there);
    mesh.locked_count = mesh.vertex_count();
    hmesh::kit::recut(mesh, 3, 2);
    CHECK(mesh.locked_count == mesh.vertex_count());
}

TEST_CASE("the last cut is shorter than that by centroids, and a surface with a border") {
    std::size_t before = 0, after = 0;
    for (const Periodic periodic : axes)
        for (std::uint64_t seed = 0; seed < 8; ++seed) {
            IndexedMesh<1> mesh = random_periodic(14, 11, 60, periodic, seed + 20);
            // Points that are not on the sides, so that there is something to shorten.
            for (Point& p : mesh.positions) {
                if (hmesh::kit::wraps_x(periodic)) p.x += 0.5;
                if (hmesh::kit::wraps_y(periodic)) p.y += 0.25;
            }
            hmesh::kit::recut(mesh, 0, 0);
            const auto faces = faces_of(mesh);
            const std::size_t distinct = mesh.distinct_count();
            before += mesh.copy_count;
            hmesh::kit::finish_cut(mesh, false);
            after += mesh.copy_count;
            CHECK(hmesh::kit::check(mesh));
            CHECK(faces_of(mesh) == faces);
            CHECK(mesh.distinct_count() == distinct);
            hmesh::kit::HalfedgeMesh topology;
            CHECK(topology.assign(mesh.vertex_count(), mesh.faces));
            CHECK(hmesh_test::sheet_flaw(to_mesh(mesh, 255)) == "");
            // Along the sides again.
            mesh = random_periodic(14, 11, 60, periodic, seed + 20);
            hmesh::kit::recut(mesh, 3, 3);
            hmesh::kit::finish_cut(mesh, true);
            for (const Point p : mesh.positions) CHECK((p.x >= 0 && p.x <= 14 && p.y >= 0 && p.y <= 11));
        }
    CHECK(after <= before);
}

// Of few points, so that some cuts bring several fans of faces to one vertex.
TEST_CASE("after the last cut no face has two neighbours on another side, no vertex two fans, and copies are counted") {
    int added = 0;
    for (const auto& [width, height, points] : {std::array{8, 3, 8}, {3, 3, 8}, {5, 3, 14}, {8, 3, 30}})
        for (std::uint64_t seed = 0; seed < 32; ++seed) {
            IndexedMesh<1> mesh = random_periodic(width, height, points, Periodic::xy, seed);
            for (Point& p : mesh.positions) p = {p.x + 0.5, p.y + 0.25};
            hmesh::kit::recut(mesh, 0, 0);
            const auto faces = faces_of(mesh);
            hmesh::kit::finish_cut(mesh, false);
            CHECK(hmesh::kit::check(mesh));
            CHECK(faces_of(mesh) == faces);
            hmesh::kit::HalfedgeMesh topology;
            CHECK(topology.assign(mesh.vertex_count(), mesh.faces));
            std::size_t copies = 0;
            for (std::size_t v = 0; v < mesh.vertex_count(); ++v) copies += mesh.roots[v] != v ? 1 : 0;
            CHECK(mesh.copy_count == copies);
            // Sides by the places of their ends, as the faces that have them go.
            std::multiset<std::array<double, 4>> sides;
            for (const hmesh::Triangle& face : mesh.faces)
                for (std::size_t k = 0; k < 3; ++k) {
                    const Point a = mesh.positions[face[k]], b = mesh.positions[face[(k + 1) % 3]];
                    sides.insert({a.x, a.y, b.x, b.y});
                }
            for (const hmesh::Triangle& face : mesh.faces) {
                const auto neighbors_at = [&](int x, int y) {
                    std::size_t count = 0;
                    for (std::size_t k = 0; k < 3; ++k) {
                        const Point a = mesh.positions[face[k]], b = mesh.positions[face[(k + 1) % 3]];
                        count += sides.count({b.x + x, b.y + y, a.x + x, a.y + y});
                    }
                    return count;
                };
                for (const int x : {-width, 0, width})
                    for (const int y : {-height, 0, height})
                        if (x != 0 || y != 0) CHECK(neighbors_at(x, y) < 2);
            }
            std::set<std::pair<double, double>> places;
            for (const Point p : mesh.positions) places.insert({p.x, p.y});
            added += places.size() < mesh.vertex_count() ? 1 : 0;
        }
    CHECK(added > 0);
}

TEST_CASE("the two triangles of an image are a torus of one vertex") {
    const auto image = hmesh_test::noise<std::uint8_t, 1>(5, 4, 1);
    const auto source = hmesh::kit::ImageSource<1>(image.view()).with_periodic(Periodic::xy, false);
    IndexedMesh<1> mesh = hmesh::kit::tied_corner_mesh(source);
    CHECK(mesh.distinct_count() == 1);
    CHECK(hmesh::kit::check(mesh));
    hmesh::kit::recut(mesh, 2, 2);
    CHECK(hmesh::kit::check(mesh));
    mesh.colors[mesh.roots[0] == 0 ? 1 : 0].set(0, 77.5);
    CHECK_FALSE(hmesh::kit::check(mesh));
}

TEST_CASE("a mesh that is not periodic is left as it is") {
    IndexedMesh<1> mesh = random_periodic(9, 9, 12, Periodic::none, 4);
    const auto faces = mesh.faces;
    const auto positions = mesh.positions;
    hmesh::kit::recut(mesh, 4, 4);
    hmesh::kit::finish_cut(mesh, false);
    CHECK(mesh.faces == faces);
    CHECK(mesh.positions == positions);
    CHECK(hmesh::kit::check(mesh));
}
