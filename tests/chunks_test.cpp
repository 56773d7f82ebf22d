#include "hmesh/io/gpu/chunks.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <set>
#include <vector>

#include "hmesh/core/random.hpp"
#include "test_exports.hpp"

namespace {

using Faces = std::vector<hmesh::Triangle>;

// The faces of the mesh that slabs hold, in their order; checks what a slab promises.
Faces faces_of(const std::vector<hmesh::kit::Slab>& slabs, std::size_t most) {
    Faces faces;
    for (const auto& slab : slabs) {
        CHECK(!slab.faces.empty());
        CHECK(slab.vertices.size() <= most);
        CHECK(std::set<std::uint32_t>(slab.vertices.begin(), slab.vertices.end()).size() == slab.vertices.size());
        std::vector<int> uses(slab.vertices.size(), 0);
        for (const auto& face : slab.faces) {
            for (const std::uint32_t v : face) ++uses.at(v);
            faces.push_back({slab.vertices[face[0]], slab.vertices[face[1]], slab.vertices[face[2]]});
        }
        CHECK(std::count(uses.begin(), uses.end(), 0) == 0);
    }
    return faces;
}

// Puts slabs into windows, each vertex drawn as often as it is; returns the number of vertices in the buffer.
std::size_t check_windows(const std::vector<hmesh::kit::Slab>& slabs, std::size_t vertices) {
    hmesh::kit::ChunkWindows windows(vertices);
    std::size_t last = 0;
    for (std::size_t i = 0; i < slabs.size(); ++i) {
        std::vector<std::uint32_t> drawn;
        for (const auto& face : slabs[i].faces) {
            for (const std::uint32_t v : face) drawn.push_back(slabs[i].vertices[v]);
            drawn.push_back(hmesh::kit::no_index);
        }
        std::vector<std::uint32_t> indices = drawn;
        windows.add(indices, i + 1 < slabs.size() ? slabs[i + 1].vertices : std::vector<std::uint32_t>{});
        CHECK(windows.first() >= last);
        last = windows.first();
        CHECK(windows.sources().size() - windows.first() == slabs[i].vertices.size());
        REQUIRE(indices.size() == drawn.size());
        for (std::size_t k = 0; k < drawn.size(); ++k)
            if (drawn[k] == hmesh::kit::no_index) REQUIRE(indices[k] == hmesh::kit::no_index);
            else REQUIRE(windows.sources().at(windows.first() + indices[k]) == drawn[k]);
    }
    return windows.sources().size();
}

}  // namespace

TEST_CASE("faces of few vertices are one slab, in their order") {
    const hmesh::Mesh mesh = hmesh_test::square_grid(9, 7);
    const auto slabs = hmesh::kit::cut_into_slabs(mesh.view(), mesh.faces, 80);
    CHECK(slabs.size() == 1);
    CHECK(faces_of(slabs, 80) == mesh.faces);
    CHECK(check_windows(slabs, 80) == 80);
}

TEST_CASE("slabs hold each face once, and their windows each vertex once") {
    for (const bool is_high : {false, true}) {
        const hmesh::Mesh mesh = is_high ? hmesh_test::square_grid(10, 50) : hmesh_test::square_grid(50, 10);
        for (const std::size_t most : {40U, 64U, 100U, 560U}) {
            const auto slabs = hmesh::kit::cut_into_slabs(mesh.view(), mesh.faces, most);
            CHECK(slabs.size() > 1);
            CHECK(slabs.size() <= 561 / (most - 24) + 1);  // less what two slabs share
            Faces faces = faces_of(slabs, most), all = mesh.faces;
            std::size_t at = 0;
            for (const auto& slab : slabs) {
                auto next = mesh.faces.begin();  // each is found behind the one before: in the order that they have in the mesh
                for (std::size_t f = 0; f < slab.faces.size() && next != mesh.faces.end(); ++f)
                    next = std::find(next, mesh.faces.end(), faces[at++]);
                CHECK(next != mesh.faces.end());
            }
            std::sort(faces.begin(), faces.end());
            std::sort(all.begin(), all.end());
            CHECK(faces == all);
            CHECK(check_windows(slabs, mesh.vertex_count()) == 561);
        }
    }
}

TEST_CASE("any list of faces is cut, into slabs of three vertices too, at any place") {
    hmesh::kit::Random random(1);
    for (int i = 0; i < 300; ++i) {
        const std::size_t vertices = 4 + random.below(30);
        hmesh::Mesh mesh;
        for (std::size_t v = 0; v < 2 * vertices; ++v)
            mesh.positions.push_back(i % 3 == 0 ? 5.0F : static_cast<float>(random.uniform() * (i % 3 == 1 ? 3e38 : 9)));
        mesh.faces.resize(1 + random.below(60));
        for (auto& face : mesh.faces) do
                for (std::uint32_t& v : face) v = static_cast<std::uint32_t>(random.below(vertices));
            while (face[0] == face[1] || face[1] == face[2] || face[2] == face[0]);
        const std::size_t most = 3 + random.below(12);
        const auto slabs = hmesh::kit::cut_into_slabs(mesh.view(), mesh.faces, most);
        Faces faces = faces_of(slabs, most);
        std::sort(faces.begin(), faces.end());
        std::sort(mesh.faces.begin(), mesh.faces.end());
        CHECK(faces == mesh.faces);
        (void)check_windows(slabs, vertices);
    }
}
