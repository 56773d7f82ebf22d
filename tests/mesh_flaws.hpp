// hmesh tests - flaw_of(): whether a mesh tiles its image, told without the library's geometry.
//
// It works in whole numbers of 1/256 px, so that areas and the top-left rule are exact.
#ifndef HMESH_TESTS_MESH_FLAWS_HPP
#define HMESH_TESTS_MESH_FLAWS_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "grid_point.hpp"
#include "hmesh/mesh/mesh.hpp"

namespace hmesh_test {

namespace detail {

// Whether the side from a to b has its face where a point on it gets to that is moved a little by `first`, and much less by
// `second`.
inline bool owns_border(GridPoint a, GridPoint b, GridPoint first, GridPoint second) {
    const auto gain = [&](GridPoint by) { return (b.x - a.x) * by.y - (b.y - a.y) * by.x; };
    return gain(first) > 0 || (gain(first) == 0 && gain(second) > 0);
}

}  // namespace detail

// Empty for a mesh that tiles the rectangle of an image of this size, [0, width] x [0, height] or for samples that are points
// [0, width - 1] x [0, height - 1]; else what is wrong with it. A centre on an edge belongs to the face to its right or else
// below, but to the one to its left in the last column of points, and to the one above in the last row.
inline std::string flaw_of(const hmesh::MeshView& mesh, int width, int height) {
    if (mesh.width != width || mesh.height != height) return "the mesh has another size than the image";
    const bool of_points = mesh.samples == hmesh::Samples::points;
    const std::int64_t right = 256 * std::int64_t{of_points ? width - 1 : width};
    const std::int64_t bottom = 256 * std::int64_t{of_points ? height - 1 : height};
    const std::int64_t half = of_points ? 0 : 128;
    std::vector<GridPoint> at(mesh.vertex_count);
    std::size_t corners = 0;
    for (std::size_t v = 0; v < at.size(); ++v) {
        const double x = 256 * static_cast<double>(mesh.positions[2 * v]),
                     y = 256 * static_cast<double>(mesh.positions[2 * v + 1]);
        if (!(x >= 0 && x <= static_cast<double>(right) && y >= 0 && y <= static_cast<double>(bottom)))
            return "a vertex lies outside";
        if (std::floor(x) != x || std::floor(y) != y) return "a vertex is off the grid of 1/256 px";
        at[v] = {static_cast<std::int64_t>(x), static_cast<std::int64_t>(y)};
        corners += (at[v].x == 0 || at[v].x == right) && (at[v].y == 0 || at[v].y == bottom) ? 1 : 0;
    }
    if (corners != 4) return "the mesh has not the four corners of the image";

    std::vector<std::pair<std::uint32_t, std::uint32_t>> sides;
    std::vector<unsigned char> used(at.size(), 0);
    std::vector<int> owners(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0);
    std::int64_t twice_area = 0;
    for (std::size_t f = 0; f < mesh.face_count; ++f) {
        const std::array<std::uint32_t, 3>& face = mesh.faces[f];
        for (const std::uint32_t v : face) {
            if (v >= at.size()) return "a face names no vertex";
            used[v] = 1;
        }
        const GridPoint p[4] = {at[face[0]], at[face[1]], at[face[2]], at[face[0]]};
        const std::int64_t twice = double_area(p[0], p[1], p[2]);
        if (twice <= 0) return "a face is flipped or has no area";
        twice_area += twice;
        for (std::size_t k = 0; k < 3; ++k) sides.emplace_back(face[k], face[(k + 1) % 3]);
        const auto [left, far_right] = std::minmax({p[0].x, p[1].x, p[2].x});
        const auto [top, low] = std::minmax({p[0].y, p[1].y, p[2].y});
        for (std::int64_t j = top / 256; j < std::min<std::int64_t>(height, low / 256 + 1); ++j)
            for (std::int64_t i = left / 256; i < std::min<std::int64_t>(width, far_right / 256 + 1); ++i) {
                const bool is_last_column = of_points && i + 1 == width, is_last_row = of_points && j + 1 == height;
                const GridPoint across{is_last_column ? -1 : 1, 0}, down{0, is_last_row ? -1 : 1};
                const GridPoint first = is_last_column ? down : across, second = is_last_column ? across : down;
                bool is_owner = true;
                for (int k = 0; k < 3; ++k) {
                    const std::int64_t side = double_area(p[k], p[k + 1], {256 * i + half, 256 * j + half});
                    is_owner = is_owner && (side > 0 || (side == 0 && detail::owns_border(p[k], p[k + 1], first, second)));
                }
                if (is_owner) ++owners[static_cast<std::size_t>(j * width + i)];
            }
    }
    if (twice_area != 2 * right * bottom) return "the faces' areas do not add up to the image's";
    if (std::count(owners.begin(), owners.end(), 1) != static_cast<std::ptrdiff_t>(owners.size()))
        return "a pixel is not in exactly one face";
    if (std::count(used.begin(), used.end(), 0) != 0) return "a vertex is in no face";

    // Each side once in its direction; what has no counterpart must run along the image's border.
    std::sort(sides.begin(), sides.end());
    if (std::adjacent_find(sides.begin(), sides.end()) != sides.end()) return "an edge is used twice in one direction";
    std::size_t border = 0;
    for (const auto& [a, b] : sides) {
        if (std::binary_search(sides.begin(), sides.end(), std::pair{b, a})) continue;
        ++border;
        const bool upright = at[a].x == at[b].x && (at[a].x == 0 || at[a].x == right);
        const bool level = at[a].y == at[b].y && (at[a].y == 0 || at[a].y == bottom);
        if (!upright && !level) return "an edge inside the image has one face only";
    }
    const std::size_t edges = (sides.size() + border) / 2;
    if (at.size() + mesh.face_count != edges + 1) return "Euler's formula does not hold";
    return {};
}

}  // namespace hmesh_test

#endif  // HMESH_TESTS_MESH_FLAWS_HPP
