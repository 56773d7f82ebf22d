#include "hmesh/io/detail/shading_parts.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "test_shadings.hpp"

using hmesh::detail::shading_pieces;
using hmesh::detail::ShadingPart;

namespace {

// The faces of strips, their corners in rising order.
std::vector<hmesh::Triangle> faces_of(const ShadingPart& part) {
    std::vector<hmesh::Triangle> faces;
    for (std::size_t i = 0; i < part.vertices.size(); ++i) {
        const auto& next = part.vertices[i];
        if (next.flag == 0) {
            REQUIRE(i + 2 < part.vertices.size());
            faces.push_back({next.vertex, part.vertices[i + 1].vertex, part.vertices[i + 2].vertex});
            i += 2;
        } else {
            REQUIRE(!faces.empty());
            const hmesh::Triangle last = faces.back();
            faces.push_back({last[next.flag == 1 ? 1 : 0], last[2], next.vertex});
        }
    }
    for (hmesh::Triangle& face : faces) std::sort(face.begin(), face.end());
    return faces;
}

std::vector<double> shares_of(const hmesh::Mesh& mesh) {
    std::vector<double> shares;
    for (const float color : mesh.colors) shares.push_back(static_cast<double>(color) / mesh.peak);
    return shares;
}

std::vector<ShadingPart> parts_of(const hmesh::Mesh& mesh) {
    const std::vector<double> shares = shares_of(mesh);
    const hmesh::MeshView view = mesh.view();
    return hmesh::detail::ShadingDivision(view, mesh.channels, shares).run();
}

double area(const hmesh::Mesh& mesh, const hmesh::Triangle& face) {
    const auto x = [&](std::size_t k) { return static_cast<double>(mesh.positions[2 * std::size_t{face[k]}]); };
    const auto y = [&](std::size_t k) { return static_cast<double>(mesh.positions[2 * std::size_t{face[k]} + 1]); };
    return std::abs((x(1) - x(0)) * (y(2) - y(0)) - (y(1) - y(0)) * (x(2) - x(0))) / 2;
}

double range(const hmesh::Mesh& mesh, const hmesh::Triangle& face) {
    const auto share = [&](std::size_t k) { return static_cast<double>(mesh.colors[face[k]]) / mesh.peak; };
    return std::max({share(0), share(1), share(2)}) - std::min({share(0), share(1), share(2)});
}

}  // namespace

TEST_CASE("a face is halved until its corners differ by 3/256 at most, six times at most") {
    CHECK(shading_pieces(0, 1) == 1);
    CHECK(shading_pieces(3.0 / 256, 1) == 1);
    CHECK(shading_pieces(3.1 / 256, 1) == 4);
    CHECK(shading_pieces(48.0 / 256, 1) == 256);
    CHECK(shading_pieces(48.0 / 256, 4) == 16);
    CHECK(shading_pieces(48.0 / 256, 16) == 1);
    CHECK(shading_pieces(1, 1) == 4096);
}

TEST_CASE("parts hold each face once, and none is stored so small that it would have too few pieces") {
    const hmesh::Mesh mesh = hmesh_test::random_grid(1, 150, 120, 60, 60, 255, 1);
    const std::vector<ShadingPart> parts = parts_of(mesh);
    CHECK(parts.size() > 1);
    std::vector<hmesh::Triangle> all, expected = mesh.faces;
    for (const ShadingPart& part : parts) {
        if (&part != &parts.front()) CHECK(part.factor < (&part - 1)->factor);
        for (const hmesh::Triangle& face : faces_of(part)) {
            all.push_back(face);
            if (part.factor != 1) CHECK(shading_pieces(range(mesh, face), part.factor) >= 8 * area(mesh, face));
        }
    }
    for (hmesh::Triangle& face : expected) std::sort(face.begin(), face.end());
    std::sort(expected.begin(), expected.end());
    std::sort(all.begin(), all.end());
    CHECK(all == expected);
}

TEST_CASE("faces have the largest factors that they may, or smaller ones that spare cuts between neighbours") {
    const hmesh::Mesh mesh = hmesh_test::random_grid(1, 75, 60, 30, 30, 255, 1);
    std::map<hmesh::Triangle, int> alone, chosen;  // factors: as if there were no neighbours, and what they are
    std::map<std::array<std::uint32_t, 2>, std::vector<hmesh::Triangle>> sides;
    for (hmesh::Triangle face : mesh.faces) {
        std::sort(face.begin(), face.end());
        int& factor = alone[face];
        for (factor = 16; factor > 1 && shading_pieces(range(mesh, face), factor) < 8 * area(mesh, face);) factor /= 2;
        for (const auto& side : {std::array<std::uint32_t, 2>{face[0], face[1]}, {face[0], face[2]}, {face[1], face[2]}})
            sides[side].push_back(face);
    }
    for (const ShadingPart& part : parts_of(mesh))
        for (const hmesh::Triangle& face : faces_of(part)) chosen[face] = part.factor;
    REQUIRE(chosen.size() == alone.size());
    int smaller = 0, larger = 0;
    for (const auto& [face, factor] : chosen) {
        larger += factor > alone.at(face) ? 1 : 0;
        smaller += factor < alone.at(face) ? 1 : 0;
    }
    // In pieces, of which a cut costs 800.
    const auto pieces = [&](const std::map<hmesh::Triangle, int>& factors) {
        double sum = 0;
        for (const auto& [face, factor] : factors) sum += shading_pieces(range(mesh, face), factor);
        return sum;
    };
    const auto cuts = [&](const std::map<hmesh::Triangle, int>& factors) {
        int sum = 0;
        for (const auto& [side, both] : sides) sum += both.size() == 2 && factors.at(both[0]) != factors.at(both[1]) ? 1 : 0;
        return sum;
    };
    INFO(pieces(chosen), " pieces for ", pieces(alone), ", ", cuts(chosen), " cuts for ", cuts(alone), ", ", smaller, " smaller");
    CHECK(smaller > 0);
    CHECK(larger == 0);
    CHECK(cuts(chosen) < 0.7 * cuts(alone));
    CHECK(pieces(chosen) + 800 * cuts(chosen) < pieces(alone) + 800 * cuts(alone));
    // Nor does any face but a few gain by another choice: all have chosen some times over.
    int unhappy = 0;
    for (const auto& [triangle, factor] : chosen) {
        const hmesh::Triangle face = triangle;
        const auto cost = [&](int of) {
            double sum = shading_pieces(range(mesh, face), of);
            for (const auto& side : {std::array<std::uint32_t, 2>{face[0], face[1]}, {face[0], face[2]}, {face[1], face[2]}})
                for (const hmesh::Triangle& other : sides.at(side)) sum += other != face && chosen.at(other) != of ? 800 : 0;
            return sum;
        };
        for (int other = 1; other <= alone.at(face); other *= 2)
            if (cost(other) < cost(factor)) {
                ++unhappy;
                break;
            }
    }
    CHECK(unhappy <= 18);  // 1 %
}

TEST_CASE("faces are as steep as the component that differs most") {
    hmesh::Mesh mesh = hmesh_test::random_grid(3, 60, 60, 30, 30, 255, 2);
    for (std::size_t steep = 0; steep < 3; ++steep) {
        for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
            for (std::size_t k = 0; k < 3; ++k) mesh.colors[3 * v + k] = k == steep && v / 31 % 2 == 0 ? 255 : 40;
        CHECK(parts_of(mesh).front().factor > 1);
    }
    for (float& color : mesh.colors) color = 40;
    CHECK(parts_of(mesh).front().factor == 1);
}

TEST_CASE("two million pieces are one part, more are several") {
    // 4,096 pieces a face that has both black and white, which all have.
    const auto steep = [](int rows) {
        hmesh::Mesh mesh = hmesh_test::random_grid(1, 60, 60, 8, rows, 255, 2);
        for (std::size_t v = 0; v < mesh.vertex_count(); ++v) mesh.colors[v] = v / 9 % 2 == 0 ? 0 : 255;
        return mesh;
    };
    CHECK(parts_of(steep(30)).size() == 1);  // 480 faces, 1,966,080 pieces
    CHECK(parts_of(steep(30)).front().factor == 1);
    CHECK(parts_of(steep(31)).front().factor > 1);  // 496 faces, 2,031,616 pieces
}

TEST_CASE("colours beyond full intensity count as what is drawn") {
    hmesh::Mesh mesh = hmesh_test::random_grid(1, 60, 60, 30, 30, 255, 3);
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) mesh.colors[v] = v % 2 == 0 ? 300 : 60000;
    REQUIRE(parts_of(mesh).size() == 1);
    CHECK(parts_of(mesh).front().factor == 1);
}
