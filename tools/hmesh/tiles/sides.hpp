// tools - the vertices of a tile's sides, by which neighbours meet.
#ifndef HMESH_TOOLS_TILES_SIDES_HPP
#define HMESH_TOOLS_TILES_SIDES_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/mesh/mesh.hpp"

namespace tool {

enum class TileSide : std::uint8_t { west, east, north, south };

// A vertex as both tiles of a seam have it: its place along the seam, which tiles count from the same sample, and its colour.
struct SideVertex {
    float along = 0;
    std::vector<float> color;
    std::uint32_t vertex = 0;  // of the tile's mesh

    [[nodiscard]] bool is_same(const SideVertex& other) const {
        return !(along < other.along) && !(other.along < along) && color == other.color;
    }
};

// Those of one side, by their places.
[[nodiscard]] inline std::vector<SideVertex> side_vertices(const hmesh::Mesh& mesh, TileSide side) {
    const hmesh::MeshView view = mesh.view();
    const bool is_column = side == TileSide::west || side == TileSide::east;
    const auto place = static_cast<float>(side == TileSide::east ? view.right() : side == TileSide::south ? view.bottom() : 0);
    const auto channels = static_cast<std::size_t>(view.channels);
    std::vector<SideVertex> found;
    for (std::size_t v = 0; v < view.vertex_count; ++v) {
        const float across = view.positions[2 * v + (is_column ? 0 : 1)];
        if (across < place || place < across) continue;
        const float* const color = view.colors + channels * v;
        found.push_back({view.positions[2 * v + (is_column ? 1 : 0)], {color, color + channels}, static_cast<std::uint32_t>(v)});
    }
    std::sort(found.begin(), found.end(), [](const SideVertex& a, const SideVertex& b) { return a.along < b.along; });
    return found;
}

}  // namespace tool

#endif  // HMESH_TOOLS_TILES_SIDES_HPP
