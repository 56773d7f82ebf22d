/// \file
/// WallPlan: where the walls of a solid stand, so that each of its edges has two faces.
///
/// A wall stands on each edge that one face has alone: along the outer border and around holes. Where borders touch in a
/// vertex (one of the mesh, or one for each) the faces around it are several fans, and one vertical edge would have four
/// walls. There each fan gets a corner of its own, moved into the fan by a 64th of a sample at most, and by less than would
/// turn one of its faces over.
///
/// O(n log n); 24 bytes a face while it is made, 8 for each edge of the border afterwards.
#ifndef HMESH_IO_HEIGHTS_DETAIL_WALLS_HPP
#define HMESH_IO_HEIGHTS_DETAIL_WALLS_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/core/status.hpp"
#include "hmesh/io/detail/export_mesh.hpp"
#include "hmesh/mesh/mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

/// The walls of a mesh, whose faces are taken as turned() has them, with y up. The mesh must outlive it.
class WallPlan {
  public:
    /// Of a mesh of fewer than 2^31 vertices that check() accepts. Call plan() before all else.
    explicit WallPlan(const MeshView& mesh) noexcept : mesh_(mesh) {}

    /// Finds the walls. Refuses a mesh in which an edge has more than two faces, or two that do not go along it in opposite ways.
    [[nodiscard]] Status plan() {
        if (const Status status = find_borders(); !status) return status;
        part_fans();
        return {};
    }

    /// The number of walls.
    [[nodiscard]] std::size_t size() const noexcept { return borders_.size(); }
    /// Whether a wall stands on the edge along which a face goes from one vertex to another.
    [[nodiscard]] bool has_wall(std::uint32_t from, std::uint32_t to) const noexcept {
        return std::binary_search(borders_.begin(), borders_.end(), key(from, to));
    }
    /// By how much the corner of a face is moved, in px of the mesh's plane.
    [[nodiscard]] std::array<double, 2> shift(std::size_t face, std::uint32_t vertex) const noexcept {
        if (corners_.empty()) return {};
        const Corner sought{vertex, static_cast<std::uint32_t>(face), 0, 0, {}};
        const auto found = std::lower_bound(corners_.begin(), corners_.end(), sought, by_face);
        return found != corners_.end() && found->vertex == vertex && found->face == sought.face ? found->shift
                                                                                                : std::array<double, 2>{};
    }

  private:
    // The corner of a face at a vertex where borders touch, and the corners that follow it, counter-clockwise.
    struct Corner {
        std::uint32_t vertex, face, right, left;
        std::array<double, 2> shift;  // px
    };
    static bool by_face(const Corner& a, const Corner& b) noexcept {
        return a.vertex != b.vertex ? a.vertex < b.vertex : a.face < b.face;
    }

    static bool by_right(const Corner& a, const Corner& b) noexcept {
        return a.vertex != b.vertex ? a.vertex < b.vertex : a.right < b.right;
    }
    [[nodiscard]] static std::uint64_t key(std::uint32_t from, std::uint32_t to) noexcept {
        return std::uint64_t{from} << 32U | to;
    }

    [[nodiscard]] Status find_borders() {
        // Both ends, the lower first, and at last whether the face goes from the higher one: 63 bits.
        std::vector<std::uint64_t> edges;
        edges.reserve(3 * mesh_.face_count);
        for (std::size_t f = 0; f < mesh_.face_count; ++f) {
            const Triangle face = turned(mesh_.faces[f]);
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t from = face[k], to = face[(k + 1) % 3];
                if (from == to)
                    return {Errc::invalid_argument, "a solid needs faces of three vertices, and one has a vertex twice, number",
                            static_cast<std::int64_t>(f), static_cast<std::int64_t>(f)};
                const std::uint64_t low = std::min(from, to), high = std::max(from, to);
                edges.push_back(low << 32U | high << 1U | (from > to ? 1U : 0U));
            }
        }
        std::sort(edges.begin(), edges.end());
        for (std::size_t i = 0; i < edges.size();) {
            const std::uint64_t edge = edges[i] / 2;
            std::size_t next = i + 1;
            while (next < edges.size() && edges[next] / 2 == edge) ++next;
            const bool is_inner = next - i == 2 && edges[i] != edges[i + 1];
            if (next - i > 1 && !is_inner)
                return {
                    Errc::invalid_argument,
                    "a solid needs edges of two faces, one to its left and one to its right; one has more on a side, at vertex",
                    static_cast<std::int64_t>(edge >> 31U), 0};
            const auto low = static_cast<std::uint32_t>(edge >> 31U), high = static_cast<std::uint32_t>(edge & 0x7FFFFFFFU);
            if (!is_inner) borders_.push_back(edges[i] % 2 == 0 ? key(low, high) : key(high, low));
            i = next;
        }
        std::sort(borders_.begin(), borders_.end());
        return {};
    }

    // The vertices in whose places more than one edge of the border begins, sorted: meshes of mesh_image() have one for each fan.
    [[nodiscard]] std::vector<std::uint32_t> find_touched() const {
        std::vector<std::uint32_t> begins, touched;
        begins.reserve(borders_.size());
        for (const std::uint64_t border : borders_) begins.push_back(static_cast<std::uint32_t>(border >> 32U));
        const float* const at = mesh_.positions;
        const auto is_before = [&](std::size_t a, std::size_t b) {
            return at[2 * a] < at[2 * b] || (!(at[2 * b] < at[2 * a]) && at[2 * a + 1] < at[2 * b + 1]);
        };
        std::sort(begins.begin(), begins.end(), is_before);
        for (std::size_t i = 1; i < begins.size(); ++i)
            if (!is_before(begins[i - 1], begins[i])) touched.insert(touched.end(), {begins[i - 1], begins[i]});
        std::sort(touched.begin(), touched.end());
        touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
        return touched;
    }

    void part_fans() {
        const std::vector<std::uint32_t> touched = find_touched();
        if (touched.empty()) return;
        for (std::size_t f = 0; f < mesh_.face_count; ++f) {
            const Triangle face = turned(mesh_.faces[f]);
            for (std::size_t k = 0; k < 3; ++k)
                if (std::binary_search(touched.begin(), touched.end(), face[k]))
                    corners_.push_back({face[k], static_cast<std::uint32_t>(f), face[(k + 1) % 3], face[(k + 2) % 3], {}});
        }
        std::sort(corners_.begin(), corners_.end(), by_right);
        for (std::size_t i = 0; i < corners_.size(); ++i)
            if (has_wall(corners_[i].vertex, corners_[i].right)) move_fan(i);
        std::sort(corners_.begin(), corners_.end(), by_face);
    }

    // Moves the corners of the fan that begins with this one. They are sorted by_right.
    void move_fan(std::size_t first) {
        std::vector<std::size_t> fan = {first};
        for (;;) {  // ends: no two faces have an edge on the same side, and the first one has a wall there
            const Corner sought{corners_[first].vertex, 0, corners_[fan.back()].left, 0, {}};
            const auto next = std::lower_bound(corners_.begin(), corners_.end(), sought, by_right);
            if (next == corners_.end() || next->vertex != sought.vertex || next->right != sought.right) break;
            fan.push_back(static_cast<std::size_t>(next - corners_.begin()));
        }
        double angle = 0, farthest = 1.0 / 64;  // px
        for (const std::size_t i : fan) {
            const std::array<double, 2> right = towards(corners_[i].vertex, corners_[i].right),
                                        left = towards(corners_[i].vertex, corners_[i].left);
            const double twice_area = right[0] * left[1] - right[1] * left[0];
            angle += std::atan2(twice_area, right[0] * left[0] + right[1] * left[1]);
            const double opposite = std::hypot(left[0] - right[0], left[1] - right[1]);
            // A quarter of the way to the opposite edge.
            if (twice_area > 0 && opposite > 0) farthest = std::min(farthest, 0.25 * twice_area / opposite);
        }
        const std::array<double, 2> begins = towards(corners_[first].vertex, corners_[first].right);
        const double size = std::hypot(begins[0], begins[1]);
        if (!(size > 0)) return;
        const double c = std::cos(angle / 2) * farthest / size, s = std::sin(angle / 2) * farthest / size;
        for (const std::size_t i : fan)  // y goes down in the mesh's plane
            corners_[i].shift = {c * begins[0] - s * begins[1], -(s * begins[0] + c * begins[1])};
    }
    // From one vertex to another, px, y up.
    [[nodiscard]] std::array<double, 2> towards(std::size_t from, std::size_t to) const noexcept {
        const auto at = [&](std::size_t i) { return static_cast<double>(mesh_.positions[i]); };
        return {at(2 * to) - at(2 * from), at(2 * from + 1) - at(2 * to + 1)};
    }

    MeshView mesh_;
    std::vector<std::uint64_t> borders_;  // keys of edges, sorted
    std::vector<Corner> corners_;         // sorted by_face
};

}  // namespace hmesh::detail

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_HEIGHTS_DETAIL_WALLS_HPP
