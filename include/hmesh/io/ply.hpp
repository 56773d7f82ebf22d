// hmesh - write_ply(): a mesh as a binary little-endian PLY file, which MeshLab, CloudCompare, Blender and others open.
//
// Vertices are `float x y z` in pixels with y up (y = height - y of the mesh) and z = 0, so that the picture stands
// upright; faces are counter-clockwise, so that it is seen from the front. Colours are `uchar red green blue [alpha]`
// for 3 or 4 channels, one `uchar intensity` for 1; 255 is the mesh's peak. PLY has no names for other numbers of
// channels.
#ifndef HMESH_IO_PLY_HPP
#define HMESH_IO_PLY_HPP

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "hmesh/core/status.hpp"
#include "hmesh/core/version.hpp"
#include "hmesh/io/sink.hpp"
#include "hmesh/mesh/mesh_view.hpp"

namespace hmesh {
namespace detail {

[[nodiscard]] inline Status check_for_ply(const MeshView& mesh) noexcept {
    constexpr std::int64_t most = std::numeric_limits<std::int32_t>::max();
    for (const std::size_t count : {mesh.vertex_count, mesh.face_count})
        if (count > static_cast<std::size_t>(most))
            return {Errc::invalid_argument, "the mesh has more vertices or faces than a PLY file numbers",
                    static_cast<std::int64_t>(count), most};
    if (mesh.channels == 2) return {Errc::invalid_argument, "a PLY file holds 1, 3 or 4 channels", 2, 0};
    if (mesh.height < 1) return {Errc::invalid_argument, "the mesh's height must be at least 1", mesh.height, 1};
    return check(mesh, 4);
}

}  // namespace detail

// Writes the mesh to the sink (see sink.hpp). A mesh that cannot be written gives a Status and no byte.
template <class Sink>
Status write_ply(const MeshView& mesh, Sink&& sink) {
    if (const Status status = detail::check_for_ply(mesh); !status) return status;
    detail::Writer writer(sink);
    writer.text("ply\nformat binary_little_endian 1.0\ncomment made by hmesh " HMESH_VERSION_STRING
                "\nelement vertex ");
    writer.decimal(static_cast<std::int64_t>(mesh.vertex_count));
    writer.text("\nproperty float x\nproperty float y\nproperty float z\n");
    if (mesh.channels == 1) writer.text("property uchar intensity\n");
    else writer.text("property uchar red\nproperty uchar green\nproperty uchar blue\n");
    if (mesh.channels == 4) writer.text("property uchar alpha\n");
    writer.text("element face ");
    writer.decimal(static_cast<std::int64_t>(mesh.face_count));
    writer.text("\nproperty list uchar int vertex_indices\nend_header\n");

    const auto channels = static_cast<std::size_t>(mesh.channels);
    for (std::size_t v = 0; v < mesh.vertex_count; ++v) {
        writer.f32(mesh.positions[2 * v]);
        writer.f32(static_cast<float>(mesh.height - static_cast<double>(mesh.positions[2 * v + 1])));
        writer.f32(0);
        for (std::size_t k = 0; k < channels; ++k) {
            const double share = static_cast<double>(mesh.colors[channels * v + k]) / mesh.peak;
            writer.u8(static_cast<std::uint8_t>(std::max(0.0, std::min(1.0, share)) * 255 + 0.5));
        }
    }
    for (std::size_t f = 0; f < mesh.face_count; ++f) {
        // Clockwise on the screen with y down stays clockwise there with y up: two corners change places.
        const std::array<std::uint32_t, 3>& face = mesh.faces[f];
        writer.u8(3);
        writer.u32(face[0]);
        writer.u32(face[2]);
        writer.u32(face[1]);
    }
    return writer.finish();
}

}  // namespace hmesh

#endif  // HMESH_IO_PLY_HPP
