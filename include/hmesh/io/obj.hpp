// hmesh - write_obj(): a mesh as a Wavefront OBJ file with colours, which MeshLab, Blender, Godot and others open.
//
// Lines `v x y 0 r g b`, then `f a b c`: pixels with y up (y = height - y of the mesh), faces counter-clockwise. Colours
// after the position are no part of the format, but what all programs agree on that know them: sRGB-encoded as stored,
// held to [0, 1], here with six decimals. Grey is written as r = g = b. There is no place for alpha: it is left out, and
// where a mesh is transparent its bare colours show. Positions are exact on the 1/256 px grid, and elsewhere if a reader
// keeps floats. Stock Unity ignores the colours: use .glb there.
#ifndef HMESH_IO_OBJ_HPP
#define HMESH_IO_OBJ_HPP

#include <array>
#include <cstddef>
#include <cstdint>

#include "hmesh/core/status.hpp"
#include "hmesh/core/version.hpp"
#include "hmesh/io/detail/color_shares.hpp"
#include "hmesh/io/detail/straight_colors.hpp"
#include "hmesh/io/sink.hpp"
#include "hmesh/mesh/mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

// Writes the mesh to the sink (see sink.hpp). A mesh that cannot be written gives a Status and no byte.
template <class Sink>
Status write_obj(const MeshView& source, Sink&& sink) {
    if (const Status status = detail::check_for_export(source); !status) return status;
    const detail::StraightMesh straight(source);
    const MeshView& mesh = straight.view();
    detail::Writer writer(sink);
    writer.text("# made by hmesh " HMESH_VERSION_STRING "\n");
    for (std::size_t v = 0; v < mesh.vertex_count; ++v) {
        writer.text("v ");
        writer.real(static_cast<double>(mesh.positions[2 * v]));
        writer.text(" ");
        writer.real(mesh.height - static_cast<double>(mesh.positions[2 * v + 1]));
        writer.text(" 0");
        const std::array<double, 4> rgba = detail::rgba_shares(mesh, v);
        for (std::size_t k = 0; k < 3; ++k) {
            writer.text(" ");
            writer.fixed(rgba[k], 6);
        }
        writer.text("\n");
    }
    for (std::size_t f = 0; f < mesh.face_count; ++f) {
        // Two corners change places, since y does; vertices count from 1.
        const std::array<std::uint32_t, 3>& face = mesh.faces[f];
        writer.text("f");
        for (const std::uint32_t v : {face[0], face[2], face[1]}) {
            writer.text(" ");
            writer.decimal(static_cast<std::int64_t>(v) + 1);
        }
        writer.text("\n");
    }
    return writer.finish();
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_OBJ_HPP
