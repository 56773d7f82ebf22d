/// \file
/// write_obj(): a mesh as a Wavefront OBJ file with colours, which MeshLab, Blender, Godot and others open.
///
/// Lines `v x y 0 r g b`, then `f a b c`: pixels with y up (y = height - y of the mesh), faces counter-clockwise. Colours after
/// the position are no part of the format, but what all programs agree on that know them: sRGB-encoded as stored, held to
/// [0, 1], here with six decimals. Grey is written as r = g = b. There is no place for alpha: it is left out, and where a mesh
/// is transparent its straight colours show. Positions are exact on the 1/256 px grid, and elsewhere if a reader keeps floats.
/// Stock Unity ignores the colours: use .glb there.
///
/// Some 50 bytes a vertex and 20 a face. O(n); nothing is allocated unless there is alpha.
#ifndef HMESH_IO_OBJ_HPP
#define HMESH_IO_OBJ_HPP

#include <array>
#include <cstddef>
#include <cstdint>

#include "hmesh/core/status.hpp"
#include "hmesh/io/detail/export_mesh.hpp"
#include "hmesh/io/detail/model_parts.hpp"
#include "hmesh/io/sink.hpp"
#include "hmesh/mesh/mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// Writes a mesh of 1 to 4 channels as an OBJ file. A mesh that has no size, numbers that are not finite or faces without their
/// vertices gives a Status that says so, and no byte is written; a sink that refuses bytes gives
/// Errc::write_failed.
inline Status write_obj(const MeshView& source, Sink sink) {
    if (const Status status = detail::check_for_export(source); !status) return status;
    const detail::ExportMesh exported(source, detail::Premultiplied::divided);
    const MeshView& mesh = exported.view();
    detail::Writer writer(sink);
    detail::write_obj_head(writer, nullptr);
    for (std::size_t v = 0; v < mesh.vertex_count; ++v) {
        writer.text("v ");
        writer.real(static_cast<double>(mesh.positions[2 * v]));
        writer.text(" ");
        writer.real(detail::y_up(mesh, v));
        writer.text(" 0");
        const std::array<double, 4> rgba = detail::rgba_shares(mesh, v);
        for (std::size_t k = 0; k < 3; ++k) {
            writer.text(" ");
            writer.fixed(rgba[k], 6);
        }
        writer.text("\n");
    }
    detail::write_obj_faces(writer, mesh);
    return writer.finish();
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_OBJ_HPP
