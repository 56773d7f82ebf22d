#include "hmesh/edit/blocks.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "hmesh/core/progress.hpp"
#include "test_images.hpp"
#include "test_meshes.hpp"

namespace kit = hmesh::kit;
using hmesh::kit::Edge;
using hmesh::kit::Face;
using hmesh::kit::for_each_block;
using hmesh::kit::Vertex;
using hmesh_test::Subject;

namespace {

using Blocks = std::vector<std::vector<Vertex>>;

template <int C>
Blocks blocks_of(kit::ImageMesh<C>& mesh, std::size_t first = 0) {
    Blocks blocks;
    for_each_block(mesh, kit::spatial_vertices(mesh), first, [&](kit::Array<Vertex>& vertices) { blocks.push_back(vertices); });
    return blocks;
}

Subject<std::uint8_t, 1> subject_of(int width, int height, int columns, int rows) {
    return {hmesh_test::noise<std::uint8_t, 1>(width, height, 1), hmesh_test::jittered_grid(width, height, columns, rows, 1)};
}

}  // namespace

TEST_CASE("every vertex is in exactly one block, in spatial order, and a block spans at most 128 x 64 px") {
    for (const auto& [width, height] : {std::pair{300, 200}, {128, 64}, {1, 700}, {700, 1}, {40, 30}}) {
        auto subject = subject_of(width, height, std::max(1, width / 9), std::max(1, height / 9));
        const Blocks blocks = blocks_of(subject.mesh);
        std::vector<Vertex> all;
        for (const auto& block : blocks) {
            REQUIRE(!block.empty());
            double left = 1e9, top = 1e9, right = 0, bottom = 0;
            for (const Vertex v : block) {
                const kit::Point p = subject.mesh.position(v);
                left = std::min(left, std::floor(p.x)), right = std::max(right, std::floor(p.x) + 1);
                top = std::min(top, std::floor(p.y)), bottom = std::max(bottom, std::floor(p.y) + 1);
            }
            CHECK(right - left <= 128);
            CHECK(bottom - top <= 64);
            all.insert(all.end(), block.begin(), block.end());
        }
        CHECK(all == kit::spatial_vertices(subject.mesh));
        // Vertices on the far border stand in blocks of their own where the image ends with a block.
        CHECK(blocks.size() == static_cast<std::size_t>((width / 128 + 1) * (height / 64 + 1)));
    }
}

TEST_CASE("blocks begin with the one asked for, modulo their number, and go round") {
    auto subject = subject_of(300, 200, 30, 20);
    const Blocks blocks = blocks_of(subject.mesh);
    REQUIRE(blocks.size() == 12);
    for (const std::size_t first :
         {std::size_t{0}, std::size_t{1}, std::size_t{5}, std::size_t{11}, std::size_t{12 * 1000 + 7}}) {
        Blocks turned = blocks;
        std::rotate(turned.begin(), turned.begin() + static_cast<std::ptrdiff_t>(first % 12), turned.end());
        CHECK(blocks_of(subject.mesh, first) == turned);
    }
}

TEST_CASE("every edge and every face belongs to one vertex of its own") {
    auto subject = subject_of(150, 140, 20, 20);
    for (int round = 0; round < 2; ++round) {
        const kit::HalfedgeMesh& topology = subject.mesh.topology();
        std::vector<int> edges(topology.edge_slots(), 0), faces(topology.face_slots(), 0), listed(topology.edge_slots(), 0);
        for (const std::vector<Vertex>& block : blocks_of(subject.mesh)) {
            const std::set<std::size_t> own = [&] {
                std::set<std::size_t> indices;
                for (const Vertex v : block) indices.insert(v.index());
                return indices;
            }();
            for (const Edge e : own_edges(subject.mesh, block)) ++listed[e.index()];
            for (const kit::InsertionSite site : own_sites(subject.mesh, block)) {
                if (site.is_edge()) {
                    ++edges[site.edge().index()];
                    CHECK(own.count(topology.from_vertex(kit::HalfedgeMesh::halfedge(site.edge())).index()) == 1);
                } else {
                    ++faces[site.face().index()];
                    CHECK(own.count(topology.from_vertex(topology.halfedge(site.face())).index()) == 1);
                }
            }
        }
        for (std::size_t k = 0; k < edges.size(); ++k) {
            const int wanted = topology.is_deleted(Edge(k)) ? 0 : 1;
            REQUIRE(edges[k] == wanted);
            REQUIRE(listed[k] == wanted);
        }
        for (std::size_t k = 0; k < faces.size(); ++k) REQUIRE(faces[k] == (topology.is_deleted(Face(k)) ? 0 : 1));
        // The same of a mesh with deleted slots and turned edges.
        kit::remove_batch(subject.mesh, 60, {});
        kit::flip_edges(subject.mesh, 0);
    }
}

TEST_CASE("a body may insert and remove vertices of its block; those that come are in no block") {
    auto subject = subject_of(300, 200, 30, 20);
    kit::RingScratch<1> scratch;
    const std::size_t before = subject.mesh.vertex_count();
    std::size_t seen = 0, removed = 0, inserted = 0;
    for_each_block(subject.mesh, kit::spatial_vertices(subject.mesh), 3, [&](kit::Array<Vertex>& vertices) {
        seen += vertices.size();
        const auto candidate = kit::cheapest_collapse(subject.mesh, scratch, vertices[vertices.size() / 2]);
        if (candidate.halfedge.is_valid()) subject.mesh.collapse(candidate.halfedge), ++removed;
        vertices.clear();
        inserted += kit::insert_batch(subject.mesh, 2, {true, false});
    });
    CHECK(seen == before);
    CHECK(removed > 5);
    CHECK(subject.mesh.vertex_count() == before - removed + inserted);
    hmesh_test::prove(subject);
}

TEST_CASE("told to stop, no further block comes, and the task is told of the blocks that are done") {
    auto subject = subject_of(300, 200, 30, 20);
    std::vector<double> fractions;
    bool go_on = true;
    const auto callback = [&](const hmesh::ProgressInfo& info) {
        fractions.push_back(info.fraction);
        return go_on;
    };
    kit::ProgressReporter reporter(callback, 60000, 255);
    reporter.set_range(0, 1);
    kit::TaskProgress task(reporter, 1);
    subject.mesh.set_task(&task);
    int blocks = 0;
    for_each_block(subject.mesh, kit::spatial_vertices(subject.mesh), 0, [&](kit::Array<Vertex>&) {
        ++blocks;
        (void)reporter.poll();
        CHECK(fractions.back() == doctest::Approx((blocks - 1) / 12.0));
        if (blocks == 5) {
            go_on = false;
            (void)reporter.poll();
        }
    });
    CHECK(blocks == 5);
    subject.mesh.set_task(nullptr);
}
