/// \file
/// Skirt: walls that hang from the sides of a mesh of heights over cracks between levels of detail.
#ifndef HMESH_IO_HEIGHTS_DETAIL_SKIRT_HPP
#define HMESH_IO_HEIGHTS_DETAIL_SKIRT_HPP

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/io/detail/export_mesh.hpp"
#include "hmesh/io/heights/detail/relief.hpp"
#include "hmesh/mesh/mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

/// The walls that hang from the sides of a mesh: two vertices for each of its vertices there, the one that it is and one below,
/// with its normal and its place in the image, so that they are shaded as the surface they hang from.
class Skirt {
  public:
    /// Of nothing.
    Skirt() = default;
    /// Finds the vertices and the edges in the sides. O(n).
    explicit Skirt(const MeshView& mesh) {
        const std::array<double, 2> size = plane_size(mesh);
        for (std::size_t v = 0; v < mesh.vertex_count; ++v)
            if (sides_of(mesh, size, v) != 0) vertices_.push_back(static_cast<std::uint32_t>(v));
        for (std::size_t f = 0; f < mesh.face_count; ++f) {
            const Triangle face = turned(mesh.faces[f]);
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t from = face[k], to = face[(k + 1) % 3];
                if ((sides_of(mesh, size, from) & sides_of(mesh, size, to)) != 0)
                    edges_.push_back({number_of(from), number_of(to)});
            }
        }
    }

    /// Vertices, twice as many as the mesh has in its sides.
    [[nodiscard]] std::size_t vertex_count() const noexcept { return 2 * vertices_.size(); }
    /// Faces.
    [[nodiscard]] std::size_t face_count() const noexcept { return 2 * edges_.size(); }
    /// Which of the mesh's vertices one is, or is below: those with odd numbers are.
    [[nodiscard]] std::size_t above(std::size_t vertex) const noexcept { return vertices_[vertex / 2]; }
    /// Calls put(v) for the corners of all faces, counter-clockwise seen from outside.
    template <class Put>
    void for_corners(Put&& put) const {
        for (const auto& [from, to] : edges_)
            for (const std::uint32_t v : {2 * to, 2 * from, 2 * from + 1, 2 * to, 2 * from + 1, 2 * to + 1}) put(v);
    }

  private:
    // A bit for each side of the plane.
    [[nodiscard]] static unsigned sides_of(const MeshView& mesh, const std::array<double, 2>& size, std::size_t vertex) noexcept {
        unsigned sides = 0;
        for (std::size_t k = 0; k < 2; ++k) {
            const auto at = static_cast<double>(mesh.positions[2 * vertex + k]);
            sides |= (at <= 0 ? 1U : 0U) << 2 * k | (at >= size[k] ? 2U : 0U) << 2 * k;
        }
        return sides;
    }
    [[nodiscard]] std::uint32_t number_of(std::uint32_t vertex) const noexcept {
        return static_cast<std::uint32_t>(std::lower_bound(vertices_.begin(), vertices_.end(), vertex) - vertices_.begin());
    }

    std::vector<std::uint32_t> vertices_;              // of the mesh, ascending
    std::vector<std::array<std::uint32_t, 2>> edges_;  // as their faces go along them, by numbers in vertices_
};

}  // namespace hmesh::detail

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_HEIGHTS_DETAIL_SKIRT_HPP
