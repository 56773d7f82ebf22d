// tools - the vertices of a tile's sides, by which neighbours meet.
#ifndef HMESH_TOOLS_TILES_SIDES_HPP
#define HMESH_TOOLS_TILES_SIDES_HPP

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "hmesh/io/sink.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "job/sha256.hpp"

namespace tool {

enum class TileSide : std::uint8_t { west, east, north, south };
inline constexpr std::array<TileSide, 4> all_sides = {TileSide::west, TileSide::east, TileSide::north, TileSide::south};

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

// What stands for the vertices of a side: the same for two sides only if all vertices are.
struct SideDigest {
    std::size_t vertices = 0;
    std::string sha256;  // of the bits of their places and colours

    [[nodiscard]] bool is_same(const SideDigest& other) const { return vertices == other.vertices && sha256 == other.sha256; }
};

[[nodiscard]] inline SideDigest digest_of(const std::vector<SideVertex>& side) {
    job::Sha256 sum;
    const auto add = [&](const void* bytes, std::size_t size) {
        sum.add(bytes, size);
        return true;
    };
    hmesh::detail::Writer writer(add);
    for (const SideVertex& v : side) {
        writer.f32(v.along);
        for (const float c : v.color) writer.f32(c);
    }
    (void)writer.finish();
    return {side.size(), sum.hex()};
}

}  // namespace tool

#endif  // HMESH_TOOLS_TILES_SIDES_HPP
