#include "hmesh/io/detail/strips.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/core/random.hpp"
#include "test_shadings.hpp"

using Faces = std::vector<hmesh::Triangle>;

namespace {

hmesh::MeshView view_of(const Faces& faces, std::size_t vertices) {
    hmesh::MeshView view;
    view.faces = faces.data();
    view.face_count = faces.size();
    view.vertex_count = vertices;
    return view;
}

// The triangles that a reader of edge flags draws, and how many times it began anew.
Faces drawn(const std::vector<hmesh::detail::StripVertex>& vertices, std::size_t& strips) {
    Faces faces;
    strips = 0;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        if (vertices[i].flag == 0) {
            REQUIRE(i + 2 < vertices.size());
            faces.push_back({vertices[i].vertex, vertices[i + 1].vertex, vertices[i + 2].vertex});
            i += 2;
            ++strips;
        } else {
            REQUIRE(!faces.empty());
            const auto last = faces.back();
            faces.push_back({last[vertices[i].flag == 1 ? 1 : 0], last[2], vertices[i].vertex});
        }
    }
    return faces;
}

Faces sorted(Faces faces) {
    for (auto& face : faces) std::sort(face.begin(), face.end());
    std::sort(faces.begin(), faces.end());
    return faces;
}

// Checks that each face is drawn once; returns the number of strips.
std::size_t strips_of(const Faces& faces, std::size_t vertices) {
    std::size_t strips = 0;
    const Faces got = drawn(hmesh::detail::strip_vertices(view_of(faces, vertices), true), strips);
    CHECK(sorted(got) == sorted(faces));
    return strips;
}

}  // namespace

TEST_CASE("a band, a fan and a closed ring of faces are one strip each") {
    Faces band, fan, ring;
    for (std::uint32_t i = 0; i < 50; ++i) {
        band.push_back(i % 2 == 0 ? hmesh::Triangle{i, i + 1, i + 2} : hmesh::Triangle{i + 1, i, i + 2});
        fan.push_back({0, i + 1, i + 2});
        ring.push_back({50, i, (i + 1) % 50});
    }
    CHECK(strips_of(band, 52) == 1);
    CHECK(strips_of(fan, 52) == 1);
    CHECK(strips_of(ring, 51) == 1);
    std::rotate(band.begin(), band.begin() + 17, band.end());
    CHECK(strips_of(band, 52) == 1);
}

TEST_CASE("strips of a grid are 35 faces long on average and take 1.06 vertices a face at most, whatever order it comes in") {
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
        const hmesh::Mesh mesh = hmesh_test::random_grid(1, 150, 120, 40, 30, 255, seed);
        CHECK(35 * strips_of(mesh.faces, mesh.vertex_count()) <= mesh.face_count());
        const auto vertices = hmesh::detail::strip_vertices(mesh.view(), true);
        CHECK(static_cast<double>(vertices.size()) <= 1.06 * static_cast<double>(mesh.face_count()));
    }
}

TEST_CASE("faces that touch in vertices alone are strips of their own") {
    CHECK(strips_of({{0, 1, 2}}, 3) == 1);
    CHECK(strips_of({{0, 1, 2}, {2, 3, 4}, {4, 5, 0}}, 6) == 3);
}

TEST_CASE("any list of faces is drawn face by face: with corners twice, sides of many faces, faces on each other") {
    CHECK(strips_of({{0, 0, 0}, {0, 0, 0}, {1, 1, 2}, {1, 2, 2}, {2, 1, 1}}, 3) <= 5);
    CHECK(strips_of({{0, 1, 2}, {0, 1, 2}, {0, 2, 1}, {1, 0, 3}, {0, 1, 4}}, 5) <= 5);
    hmesh::kit::Random random(1);
    for (int i = 0; i < 400; ++i) {
        const auto vertices = static_cast<std::uint32_t>(3 + random.below(8));
        Faces faces(1 + random.below(30));
        for (auto& face : faces)
            for (std::uint32_t& v : face) v = static_cast<std::uint32_t>(random.below(vertices));
        strips_of(faces, vertices);
    }
}

TEST_CASE("without strips the faces come in their order") {
    const Faces faces = {{0, 1, 2}, {0, 2, 3}, {3, 4, 0}};
    std::size_t strips = 0;
    CHECK(drawn(hmesh::detail::strip_vertices(view_of(faces, 5), false), strips) == faces);
    CHECK(strips == 3);
}
