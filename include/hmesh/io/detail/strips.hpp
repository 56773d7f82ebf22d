/// \file
/// Triangle strips: the faces of a mesh as the vertices and edge flags of a free-form Gouraud shading.
///
/// A triangle that shares a side with the one before it needs one vertex instead of three (ISO 32000-1, 8.7.4.5.5): flag 0
/// begins anew with three vertices a, b, c; flag 1 adds d to make b, c, d; flag 2 adds d to make a, c, d. The newest vertex is
/// in both sides that can be shared, so any way from face to face that enters each by one side and leaves it by another can be
/// written. The walk goes to the neighbour that has the fewest ways on left (Akeley's rule, as in SGI's tomesh). Meshes of
/// images get strips of 30 to 40 faces on average, 1.06 vertices a face. Cost: about 0.1 us and 96 bytes a face, O(n log n) at
/// worst.
#ifndef HMESH_IO_DETAIL_STRIPS_HPP
#define HMESH_IO_DETAIL_STRIPS_HPP

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "hmesh/core/array.hpp"
#include "hmesh/core/coded_order.hpp"
#include "hmesh/mesh/mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

/// A vertex as a reader of edge flags takes it.
struct StripVertex {
    std::uint32_t vertex;  ///< its index in the mesh
    std::uint8_t flag;     ///< 0, 1 or 2; 0 for the second and third vertex of a first triangle, where it means nothing
};

/// The index that stands for no face.
inline constexpr std::uint32_t no_face = std::numeric_limits<std::uint32_t>::max();

/// The face across each side of each face, or no_face; side k runs from corner k to corner k + 1. A side used by more than two
/// faces joins them two by two, so that each side leads to at most one face. At most 2^32 / 3 faces.
[[nodiscard]] inline kit::Array<Triangle> face_neighbors(const MeshView& mesh) {
    kit::Array<kit::Coded> sides;  // by their ends, the smaller one first; number 3 * face + k
    sides.reserve(3 * mesh.face_count);
    for (std::size_t f = 0; f < mesh.face_count; ++f)
        for (std::size_t k = 0; k < 3; ++k) {
            const auto [low, high] = std::minmax({mesh.faces[f][k], mesh.faces[f][(k + 1) % 3]});
            sides.push_back({kit::code_of(low, high), static_cast<std::uint32_t>(3 * f + k)});
        }
    kit::sort_by_code(sides);
    kit::Array<Triangle> across(mesh.face_count, {no_face, no_face, no_face});
    for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
        const std::uint32_t one = sides[i].number, other = sides[i + 1].number;
        if (sides[i].code != sides[i + 1].code || one / 3 == other / 3) continue;  // a face may have a corner twice
        across[one / 3][one % 3] = other / 3;
        across[other / 3][other % 3] = one / 3;
        ++i;
    }
    return across;
}

/// A walk over the faces of a mesh that goes on to a face beside the last one for as long as it can.
class StripWalk {
  public:
    /// Over a mesh that check() accepts and whose arrays outlive the walk.
    explicit StripWalk(const MeshView& mesh) : mesh_(mesh), across_(face_neighbors(mesh)), left_(mesh.face_count, 0) {
        for (std::size_t f = 0; f < mesh.face_count; ++f)
            for (const std::uint32_t g : across_[f]) left_[f] = static_cast<std::uint8_t>(left_[f] + (g != no_face ? 1 : 0));
        for (std::size_t f = mesh.face_count; f-- > 0;) starts_[left_[f]].push_back(static_cast<std::uint32_t>(f));
    }

    /// Every face once, in strips. To be called once.
    [[nodiscard]] kit::Array<StripVertex> run() {
        kit::Array<StripVertex> out;
        out.reserve(mesh_.face_count + mesh_.face_count / 8 + 3);
        kit::Array<std::uint32_t> path;
        for (std::uint32_t start = next_start(); start != no_face; start = next_start()) {
            path.clear();
            walk_from(start, path);
            if (const std::uint32_t more = way_on(start); more != no_face) {  // the strip grows at both ends
                std::reverse(path.begin(), path.end());
                walk_from(more, path);
            }
            append(path, out);
        }
        return out;
    }

  private:
    static constexpr std::uint8_t taken = 4;

    // The face that is not taken and has the fewest neighbours that are not, the last one to have become so.
    [[nodiscard]] std::uint32_t next_start() {
        for (std::size_t n = 0; n < starts_.size(); ++n)
            while (!starts_[n].empty()) {
                const std::uint32_t f = starts_[n].back();
                starts_[n].pop_back();
                if (left_[f] == n) return f;
            }
        return no_face;
    }
    void take(std::uint32_t f) {
        left_[f] = taken;
        for (const std::uint32_t g : across_[f])
            if (g != no_face && left_[g] != taken) starts_[--left_[g]].push_back(g);
    }
    [[nodiscard]] std::uint32_t way_on(std::uint32_t f) const {
        std::uint32_t best = no_face;
        for (const std::uint32_t g : across_[f])
            if (g != no_face && left_[g] != taken && (best == no_face || left_[g] < left_[best])) best = g;
        return best;
    }
    void walk_from(std::uint32_t f, kit::Array<std::uint32_t>& path) {
        for (; f != no_face; f = way_on(f)) {
            take(f);
            path.push_back(f);
        }
    }

    // The corners of f, those of the side toward g first.
    [[nodiscard]] Triangle corners(std::uint32_t f, std::uint32_t g) const {
        const Triangle& face = mesh_.faces[f];
        for (std::size_t k = 0; k < 3; ++k)
            if (across_[f][k] == g) return {face[k], face[(k + 1) % 3], face[(k + 2) % 3]};
        return face;
    }
    void append(const kit::Array<std::uint32_t>& path, kit::Array<StripVertex>& out) const {
        std::uint32_t a = 0, b = 0, c = 0;
        const auto same = [](std::uint32_t u, std::uint32_t v, const Triangle& side) {
            return (u == side[0] && v == side[1]) || (u == side[1] && v == side[0]);
        };
        for (std::size_t i = 0; i < path.size(); ++i) {
            if (i > 0) {
                const Triangle next = corners(path[i], path[i - 1]);
                if (same(b, c, next)) {
                    out.push_back({next[2], 1});
                    a = b, b = c, c = next[2];
                    continue;
                }
                if (same(a, c, next)) {
                    out.push_back({next[2], 2});
                    b = c, c = next[2];
                    continue;
                }
                // Faces that have a corner twice or lie on each other come here.
            }
            const Triangle face = corners(path[i], i + 1 < path.size() ? path[i + 1] : no_face);
            a = face[2], b = face[0], c = face[1];
            for (const std::uint32_t v : {a, b, c}) out.push_back({v, 0});
        }
    }

    const MeshView mesh_;
    const kit::Array<Triangle> across_;
    kit::Array<std::uint8_t> left_;                    // a face's neighbours that are not taken, or `taken`
    std::array<kit::Array<std::uint32_t>, 4> starts_;  // faces that had so many; those that have still are in the right one
};

/// Every face of a mesh that check() accepts once: in strips or, without, each by itself in the mesh's order.
[[nodiscard]] inline kit::Array<StripVertex> strip_vertices(const MeshView& mesh, bool strips) {
    if (strips) return StripWalk(mesh).run();
    kit::Array<StripVertex> out;
    out.reserve(3 * mesh.face_count);
    for (std::size_t f = 0; f < mesh.face_count; ++f)
        for (const std::uint32_t v : mesh.faces[f]) out.push_back({v, 0});
    return out;
}

}  // namespace hmesh::detail

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_DETAIL_STRIPS_HPP
