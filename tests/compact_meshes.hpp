// hmesh tests - meshes of all kinds for compact files, and whether two meshes are one but for the order of vertices and faces.
#ifndef HMESH_TESTS_COMPACT_MESHES_HPP
#define HMESH_TESTS_COMPACT_MESHES_HPP

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "hmesh/core/random.hpp"
#include "hmesh/mesh/delaunay.hpp"
#include "hmesh/mesh/geometry.hpp"
#include "hmesh/mesh/halfedge_mesh.hpp"
#include "hmesh/mesh/mesh.hpp"

namespace hmesh_test {

// What a random mesh is made of.
struct MeshKind {
    int width = 16, height = 16;  // px
    int step = 1;                 // of positions, in 1/256 px
    std::size_t points = 30;      // besides the corners, at most
    std::size_t rows = 0;         // on which they lie, none: anywhere
    std::size_t flips = 40;       // tried
    int channels = 3;
    double hidden = 0;  // share of the faces that are left out
};

// A triangulation of random points, flipped here and there, with vertices, faces and their corners in disorder. By the library's
// other triangulation and half-edges, of which compact files know nothing.
[[nodiscard]] inline hmesh::Mesh random_mesh(const MeshKind& kind, std::uint64_t seed) {
    hmesh::kit::Random random(seed);
    const auto place = [&](int size, std::size_t choices) {
        const auto sites = static_cast<std::size_t>(256 * size / kind.step);
        const std::size_t site = choices == 0 ? random.below(sites + 1) : random.below(choices + 1) * sites / choices;
        return static_cast<double>(site) * kind.step / 256;
    };
    std::vector<hmesh::kit::Point> points;
    for (std::size_t k = 0; k < kind.points; ++k) {
        const double x = place(kind.width, 0);
        points.push_back({x, place(kind.height, kind.rows)});
    }
    const hmesh::kit::Delaunay delaunay = hmesh::kit::triangulate(kind.width, kind.height, points);
    hmesh::kit::HalfedgeMesh topology = delaunay.topology();
    const std::vector<hmesh::kit::Point>& at = delaunay.positions();
    using hmesh::kit::HalfedgeMesh;
    for (std::size_t k = 0; k < kind.flips; ++k) {
        const hmesh::kit::Edge e(random.below(topology.edge_count()));
        if (topology.is_boundary(e)) continue;
        const hmesh::kit::Halfedge h = HalfedgeMesh::halfedge(e), o = HalfedgeMesh::opposite(h);
        const auto a = at[topology.from_vertex(h).index()], b = at[topology.to_vertex(h).index()];
        const auto c = at[topology.to_vertex(topology.next(h)).index()], d = at[topology.to_vertex(topology.next(o)).index()];
        if (hmesh::kit::orient2d(a, d, c) > 0 && hmesh::kit::orient2d(d, b, c) > 0 && topology.is_flip_ok(e)) topology.flip(e);
    }
    hmesh::Mesh mesh;
    mesh.width = kind.width;
    mesh.height = kind.height;
    mesh.channels = kind.channels;
    mesh.peak = 255;
    std::vector<std::uint32_t> number(at.size(), 0);
    std::vector<bool> is_used(at.size(), false);
    for (hmesh::Triangle face : topology.triangles()) {
        if (random.uniform() < kind.hidden) continue;
        std::rotate(face.begin(), face.begin() + static_cast<std::ptrdiff_t>(random.below(3)), face.end());
        mesh.faces.push_back(face);
        std::swap(mesh.faces[random.below(mesh.faces.size())], mesh.faces.back());
        for (const std::uint32_t v : face) is_used[v] = true;
    }
    std::vector<std::uint32_t> order;
    for (std::uint32_t v = 0; v < at.size(); ++v) {
        if (!is_used[v]) continue;
        order.push_back(v);
        std::swap(order[random.below(order.size())], order.back());
    }
    for (std::uint32_t v = 0; v < order.size(); ++v) {
        number[order[v]] = v;
        mesh.positions.push_back(static_cast<float>(at[order[v]].x));
        mesh.positions.push_back(static_cast<float>(at[order[v]].y));
        for (int c = 0; c < kind.channels; ++c)
            mesh.colors.push_back(static_cast<float>((random.below(4) == 0 ? random.below(256) : 100 + random.below(9))));
    }
    for (hmesh::Triangle& face : mesh.faces)
        for (std::uint32_t& v : face) v = number[v];
    return mesh;
}

// Where they differ; "": nowhere but in the order of vertices, of faces and of their corners.
[[nodiscard]] inline std::string difference(const hmesh::Mesh& a, const hmesh::Mesh& b) {
    const auto facts = [](const hmesh::Mesh& mesh) {
        return std::tuple{mesh.channels, mesh.width, mesh.height, mesh.peak, mesh.premultiplied, mesh.periodic, mesh.samples};
    };
    if (facts(a) != facts(b)) return "what is said of the images differs";
    if (a.vertex_count() != b.vertex_count()) return "there are more or fewer vertices";
    if (a.colors.size() != b.colors.size()) return "there are more or fewer colours";
    const auto canonical = [](const hmesh::Mesh& mesh) {
        std::vector<std::pair<std::vector<float>, std::uint32_t>> vertices(mesh.vertex_count());
        for (std::uint32_t v = 0; v < vertices.size(); ++v) {
            vertices[v].second = v;
            for (std::size_t k = 0; k < 2; ++k) vertices[v].first.push_back(mesh.positions[2 * v + k]);
            for (int c = 0; c < mesh.channels; ++c)
                vertices[v].first.push_back(
                    mesh.colors[static_cast<std::size_t>(mesh.channels) * v + static_cast<std::size_t>(c)]);
        }
        std::sort(vertices.begin(), vertices.end());
        std::vector<std::uint32_t> number(vertices.size());
        for (std::uint32_t v = 0; v < vertices.size(); ++v) number[vertices[v].second] = v;
        std::vector<hmesh::Triangle> faces = mesh.faces;
        for (hmesh::Triangle& face : faces) {
            for (std::uint32_t& v : face) v = number[v];
            std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
        }
        std::sort(faces.begin(), faces.end());
        std::vector<std::vector<float>> numbers;
        for (auto& vertex : vertices) numbers.push_back(std::move(vertex.first));
        return std::pair{std::move(numbers), std::move(faces)};
    };
    const auto of_a = canonical(a), of_b = canonical(b);
    if (of_a.first != of_b.first) return "a vertex differs";
    return of_a.second == of_b.second ? "" : "a face differs";
}

}  // namespace hmesh_test

#endif  // HMESH_TESTS_COMPACT_MESHES_HPP
