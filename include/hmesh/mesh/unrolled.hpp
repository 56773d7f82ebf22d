/// \file
/// unrolled(): a periodic mesh with as many copies of its faces as cover the picture.
///
/// The border of a periodic mesh may be jagged: parts of faces stand out of the image on one side, and what they leave free on
/// the other side belongs to copies of them. Vertices of copies that meet do so in equal numbers, so that the seam has no gap at
/// any size. Cost: 10 ns a face.
#ifndef HMESH_MESH_UNROLLED_HPP
#define HMESH_MESH_UNROLLED_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "hmesh/core/array.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/mesh/periodic.hpp"
#include "hmesh/mesh/torus.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// A periodic mesh with copies of its faces, whole periods away, wherever these touch the image's rectangle: it covers all of
/// [0, width] x [0, height] and stands out of it. Its own vertices and faces come first. Not periodic any more; a mesh that is
/// not periodic comes back as it is. check() must accept the mesh. O(n log n).
[[nodiscard]] HMESH_COLD inline Mesh unrolled(const MeshView& mesh) {
    constexpr double most = 16;  // turns: faces of meshes made by hand may be anywhere
    Mesh out;
    out.channels = mesh.channels;
    out.width = mesh.width, out.height = mesh.height;
    out.peak = mesh.peak;
    out.premultiplied = mesh.premultiplied;
    out.samples = mesh.samples;
    const auto channels = static_cast<std::size_t>(mesh.channels);
    out.positions.assign(mesh.positions, mesh.positions + 2 * mesh.vertex_count);
    out.colors.assign(mesh.colors, mesh.colors + channels * mesh.vertex_count);
    out.faces.assign(mesh.faces, mesh.faces + mesh.face_count);
    Array<VertexCopy> corners;  // of the faces' copies
    for (std::size_t f = 0; f < mesh.face_count; ++f) {
        // The turns after which a part of the face is inside, along one axis.
        const auto range = [&](std::size_t axis, int size, bool wraps) {
            const auto at = [&](std::size_t k) {
                return static_cast<double>(mesh.positions[2 * std::size_t{mesh.faces[f][k]} + axis]) / size;
            };
            const double low = std::min({at(0), at(1), at(2)}), high = std::max({at(0), at(1), at(2)});
            if (!wraps || std::abs(low) > most || std::abs(high) > most) return std::array<int, 2>{0, 0};
            return std::array<int, 2>{static_cast<int>(std::floor(-high)) + 1, static_cast<int>(std::ceil(1 - low)) - 1};
        };
        const auto x = range(0, mesh.width, wraps_x(mesh.periodic)), y = range(1, mesh.height, wraps_y(mesh.periodic));
        for (int j = y[0]; j <= y[1]; ++j)
            for (int i = x[0]; i <= x[1]; ++i)
                if (i != 0 || j != 0)
                    for (const std::uint32_t v : mesh.faces[f]) corners.push_back({v, {i, j}});
    }
    const NumberedCopies copies = numbered(corners);
    for (const VertexCopy& copy : copies.different) {
        const std::size_t v = copy.vertex;
        out.positions.push_back(mesh.positions[2 * v] + static_cast<float>(copy.turns.x) * static_cast<float>(mesh.width));
        out.positions.push_back(mesh.positions[2 * v + 1] + static_cast<float>(copy.turns.y) * static_cast<float>(mesh.height));
        out.colors.insert(out.colors.end(), mesh.colors + channels * v, mesh.colors + channels * (v + 1));
    }
    for (std::size_t k = 0; k < corners.size(); k += 3) {
        Triangle face{};
        for (std::size_t c = 0; c < 3; ++c) face[c] = static_cast<std::uint32_t>(mesh.vertex_count) + copies.number[k + c];
        out.faces.push_back(face);
    }
    return out;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_MESH_UNROLLED_HPP
