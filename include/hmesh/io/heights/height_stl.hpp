/// \file
/// write_height_stl(), write_solid_stl(): a mesh of heights as a binary STL file: a surface, or a solid to be printed.
///
/// STL knows neither vertices nor units: 50 bytes a face, its normal and its three corners as floats. z is up unless
/// HeightOptions::up says otherwise; normals of vertices, texture coordinates and textures are left out.
///
/// The solid has the surface above, the same faces flat below, and walls of two faces on each edge of the border: twice the
/// faces and more. Who looks for vertices by their coordinates, as slicers do, finds that each edge has two faces; so the mesh
/// must have one vertex where there is one place, but where its borders touch, and floats must keep its vertices apart.
///
/// The surface O(n), nothing allocated. The solid O(n log n), 24 bytes a face.
/// Source: Marshall Burns, Automated Fabrication, section 6.5: the STL format.
#ifndef HMESH_IO_HEIGHTS_HEIGHT_STL_HPP
#define HMESH_IO_HEIGHTS_HEIGHT_STL_HPP

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "hmesh/core/finite.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/core/version.hpp"
#include "hmesh/io/detail/export_mesh.hpp"
#include "hmesh/io/heights/detail/relief.hpp"
#include "hmesh/io/heights/detail/walls.hpp"
#include "hmesh/io/heights/height_options.hpp"
#include "hmesh/io/sink.hpp"
#include "hmesh/mesh/mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {
namespace detail {

/// The corners of a face in space.
using Corners3 = std::array<Vector3, 3>;

/// Writes the 80 bytes that readers skip, which must not begin with "solid", and the number of faces.
inline void write_stl_head(Writer& writer, std::uint64_t faces) {
    static constexpr std::array<char, 80> comment{"made by hmesh " HMESH_VERSION_STRING};
    writer.bytes(comment.data(), comment.size());
    writer.u32(static_cast<std::uint32_t>(faces));
}

/// Writes a face, counter-clockwise seen from outside. A face without an area, as its corners are stored, has the normal 0.
inline void write_stl_face(Writer& writer, const Corners3& corners) {
    Corners3 stored{};
    for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t axis = 0; axis < 3; ++axis) stored[k][axis] = kit::as_float(corners[k][axis]);
    for (const double part : unit(area_normal(stored[0], stored[1], stored[2]), {})) writer.f32(static_cast<float>(part));
    for (const Vector3& corner : stored)
        for (const double coordinate : corner) writer.f32(static_cast<float>(coordinate));
    writer.u16(0);
}

/// Refuses what no STL file of `faces` faces holds. O(n).
[[nodiscard]] inline Status check_for_stl(const MeshView& mesh, const HeightOptions& options, std::uint64_t most_faces) {
    if (const Status status =
            check_counts(mesh, most_numbered, most_faces, "the mesh has more vertices or faces than an STL file holds");
        !status)
        return status;
    return check_relief(mesh, {}, options);
}

/// Refuses a solid whose vertices for the sides of borders that touch are one as floats, far from the origin. O(n log n).
[[nodiscard]] inline Status check_parted(const MeshView& mesh, const HeightOptions& options, const WallPlan& walls) {
    const Relief on_map(mesh, {}, options, false);
    std::vector<std::array<double, 4>> moved;  // x and y as they are stored, and by how much: of each fan alike, of others not
    for (std::size_t f = 0; f < mesh.face_count; ++f)
        for (const std::uint32_t v : mesh.faces[f]) {
            const std::array<double, 2> shift = walls.shift(f, v);
            if (shift == std::array<double, 2>{}) continue;
            const Vector3 at = on_map.position(v, shift);
            moved.push_back({kit::as_float(at[0]), kit::as_float(at[1]), shift[0], shift[1]});
        }
    std::sort(moved.begin(), moved.end());
    for (std::size_t i = 1; i < moved.size(); ++i)
        if (moved[i - 1] != moved[i] && moved[i - 1][0] == moved[i][0] && moved[i - 1][1] == moved[i][1])
            return {Errc::invalid_argument,
                    "the origin is too far for floats to keep the vertices of a solid apart where borders touch, at x",
                    moved[i][0]};
    return {};
}

}  // namespace detail

/// Writes a mesh as a binary STL file, an open surface that faces up. A mesh that write_height_ply() refuses gives a Status that
/// says so, and no byte is written; a sink that refuses bytes gives Errc::write_failed.
inline Status write_height_stl(const MeshView& mesh, Sink sink, const HeightOptions& options = {}) {
    constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();
    if (const Status status = detail::check_for_stl(mesh, options, most); !status) return status;
    const detail::Relief relief(mesh, {}, options, detail::is_y_up(options, false));
    detail::Writer writer(sink);
    detail::write_stl_head(writer, mesh.face_count);
    for (std::size_t f = 0; f < mesh.face_count; ++f) {
        const Triangle face = detail::turned(mesh.faces[f]);
        detail::write_stl_face(writer, {relief.position(face[0]), relief.position(face[1]), relief.position(face[2])});
    }
    return writer.finish();
}

/// Writes a mesh as the binary STL file of a solid that stands on a flat base at the height `base`, in the units of
/// HeightOptions::z: watertight, each edge of two faces, with walls around holes too. Where borders touch in a vertex, as holes
/// do at their corners, it becomes a vertex for each side, a 64th of a sample apart at most.
///
/// Refuses what write_height_stl() does, a base that is not below all heights, faces that have a vertex twice, edges that more
/// faces share than one on each side, and borders that touch so far from the origin that floats keep no such vertices apart.
inline Status write_solid_stl(const MeshView& mesh, double base, Sink sink, const HeightOptions& options = {}) {
    constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max() / 8;  // two and six for its walls, at most
    if (const Status status = detail::check_for_stl(mesh, options, most); !status) return status;
    const detail::Relief relief(mesh, {}, options, detail::is_y_up(options, false));
    constexpr auto farthest = static_cast<double>(std::numeric_limits<float>::max());
    if (!kit::is_within(base, -farthest, farthest))
        return {Errc::invalid_argument, "the base of a solid must be a height that a float holds", base, farthest};
    for (std::size_t v = 0; v < mesh.vertex_count; ++v)
        if (!(static_cast<float>(base) < static_cast<float>(relief.height(v))))
            return {Errc::invalid_argument, "the base of a solid must be below all of its heights", base, relief.height(v)};
    detail::WallPlan walls(mesh);
    if (const Status status = walls.plan(); !status) return status;
    if (const Status status = detail::check_parted(mesh, options, walls); !status) return status;

    detail::Writer writer(sink);
    detail::write_stl_head(writer, 2 * std::uint64_t{mesh.face_count} + 2 * std::uint64_t{walls.size()});
    for (std::size_t f = 0; f < mesh.face_count; ++f) {
        const Triangle face = detail::turned(mesh.faces[f]);
        detail::Corners3 above{}, below{};
        for (std::size_t k = 0; k < 3; ++k) {
            const std::array<double, 2> shift = walls.shift(f, face[k]);
            above[k] = relief.position(face[k], shift);
            below[k] = relief.position(face[k], shift, &base);
        }
        detail::write_stl_face(writer, above);
        detail::write_stl_face(writer, {below[0], below[2], below[1]});
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t next = (k + 1) % 3;
            if (!walls.has_wall(face[k], face[next])) continue;
            detail::write_stl_face(writer, {above[next], above[k], below[k]});
            detail::write_stl_face(writer, {above[next], below[k], below[next]});
        }
    }
    return writer.finish();
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_HEIGHTS_HEIGHT_STL_HPP
