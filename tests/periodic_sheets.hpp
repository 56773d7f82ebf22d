// hmesh tests - what a periodic mesh must be, told without the library's geometry: each place of the plane is in one face of the
// mesh and its copies, and each edge on the border has its partner on the other side.
#ifndef HMESH_TESTS_PERIODIC_SHEETS_HPP
#define HMESH_TESTS_PERIODIC_SHEETS_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "grid_point.hpp"
#include "hmesh/core/random.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/mesh/periodic.hpp"

namespace hmesh_test {

[[nodiscard]] inline GridPoint place_of(const hmesh::Mesh& mesh, std::uint32_t v) {
    return {static_cast<std::int64_t>(static_cast<double>(mesh.positions[2 * std::size_t{v}]) * 256),
            static_cast<std::int64_t>(static_cast<double>(mesh.positions[2 * std::size_t{v} + 1]) * 256)};
}
// Faces of the mesh and of its copies up to `reach` periods away that hold a place off all edges; -1: it is on one.
[[nodiscard]] inline int faces_over(const hmesh::Mesh& mesh, GridPoint p, int reach = 3) {
    const int across = hmesh::kit::wraps_x(mesh.periodic) ? reach : 0, down = hmesh::kit::wraps_y(mesh.periodic) ? reach : 0;
    int count = 0;
    for (const hmesh::Triangle& face : mesh.faces)
        for (int j = -down; j <= down; ++j)
            for (int i = -across; i <= across; ++i) {
                const GridPoint q{p.x - std::int64_t{256} * i * mesh.width, p.y - std::int64_t{256} * j * mesh.height};
                const GridPoint a = place_of(mesh, face[0]), b = place_of(mesh, face[1]), c = place_of(mesh, face[2]);
                const std::int64_t one = double_area(a, b, q), two = double_area(b, c, q), three = double_area(c, a, q);
                if (one < 0 || two < 0 || three < 0) continue;
                if (one == 0 || two == 0 || three == 0) return -1;
                ++count;
            }
    return count;
}

// Why the mesh is none of a torus or cylinder, cut open; "": it is one. `places` random places are looked at.
[[nodiscard]] inline std::string sheet_flaw(const hmesh::Mesh& mesh, int places = 40) {
    hmesh::kit::Random random(7);
    for (int k = 0; k < places; ++k) {
        const GridPoint p{static_cast<std::int64_t>(random.below(static_cast<std::size_t>(256 * mesh.width))),
                          static_cast<std::int64_t>(random.below(static_cast<std::size_t>(256 * mesh.height)))};
        const int count = faces_over(mesh, p);
        if (count != 1 && count != -1) return "a place is in " + std::to_string(count) + " faces";
    }
    // Edges with a face on one side only, by their ends within the first period.
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
    for (const hmesh::Triangle& f : mesh.faces)
        for (std::size_t k = 0; k < 3; ++k)
            if (++sides[{f[k], f[(k + 1) % 3]}] > 1) return "a side is used twice";
    const bool x = hmesh::kit::wraps_x(mesh.periodic), y = hmesh::kit::wraps_y(mesh.periodic);
    const std::int64_t width = std::int64_t{256} * mesh.width, height = std::int64_t{256} * mesh.height;
    const auto modulo = [](std::int64_t a, std::int64_t n) { return (a % n + n) % n; };
    using Edge = std::array<std::int64_t, 4>;  // where it begins, within the first period, and what it spans
    std::map<Edge, std::pair<std::uint32_t, std::uint32_t>> border;
    const auto edge_of = [&](std::uint32_t from, std::uint32_t to) {
        const GridPoint a = place_of(mesh, from), b = place_of(mesh, to);
        return Edge{x ? modulo(a.x, width) : a.x, y ? modulo(a.y, height) : a.y, b.x - a.x, b.y - a.y};
    };
    for (const auto& [side, count] : sides)
        if (sides.count({side.second, side.first}) == 0 && !border.emplace(edge_of(side.first, side.second), side).second)
            return "two edges of the border are one";
    const auto same_color = [&](std::uint32_t a, std::uint32_t b) {
        for (int c = 0; c < mesh.channels; ++c) {
            const auto at = [&](std::uint32_t v) {
                return mesh.colors[static_cast<std::size_t>(mesh.channels) * v + static_cast<std::size_t>(c)];
            };
            if (at(a) != at(b)) return false;
        }
        return true;
    };
    for (const auto& [edge, side] : border) {
        const GridPoint a = place_of(mesh, side.first), b = place_of(mesh, side.second);
        if ((!x && a.x == b.x && (a.x == 0 || a.x == width)) || (!y && a.y == b.y && (a.y == 0 || a.y == height))) continue;
        const auto partner = border.find(edge_of(side.second, side.first));
        if (partner == border.end()) return "an edge of the border has no partner";
        if (!same_color(side.first, partner->second.second) || !same_color(side.second, partner->second.first))
            return "the colour jumps over the border";
    }
    return {};
}

}  // namespace hmesh_test

#endif  // HMESH_TESTS_PERIODIC_SHEETS_HPP
