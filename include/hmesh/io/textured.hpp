/// \file
/// write_textured_obj(), _ply(), _glb(): a mesh to draw its image on, as models with texture coordinates and the texture's name.
///
/// What is written are positions and faces as write_obj(), write_ply() and write_glb() write them, y up, and in place of colours
/// the coordinates of the image: u = x / width to the right and v = 1 - y / height up, or y / height down in glTF, as each format
/// has it; where samples are points, x + 1/2 and y + 1/2 in place of x and y, since they are in the middle of their texels.
/// The texture stays a file of its own, whose name the files hold: OBJ in a material file beside it, which write_material()
/// writes, PLY as the comment that MeshLab reads, glTF as a URI. For outlines (hmesh/outline.hpp) and any other mesh, of at most
/// 67,108,863 vertices and faces.
///
/// O(n), and nothing that grows with the mesh is allocated.
/// Sources: Wavefront, Object and Material files; Khronos, glTF 2.0, sections 3.6 to 3.9.
#ifndef HMESH_IO_TEXTURED_HPP
#define HMESH_IO_TEXTURED_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "hmesh/core/status.hpp"
#include "hmesh/core/version.hpp"
#include "hmesh/io/detail/export_mesh.hpp"
#include "hmesh/io/detail/glb_file.hpp"
#include "hmesh/io/detail/model_parts.hpp"
#include "hmesh/io/gltf.hpp"
#include "hmesh/io/sink.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/mesh/samples.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

namespace detail {

/// Refuses what files of textured models cannot hold. O(n).
[[nodiscard]] inline Status check_for_texture(const MeshView& mesh, const char* name) noexcept {
    constexpr std::uint64_t most = std::numeric_limits<std::int32_t>::max() / 32;  // so that all of a .glb is below 4 GiB
    if (const Status status = check_counts(mesh, most, most, "the mesh has more vertices or faces than a textured model holds");
        !status)
        return status;
    if (const Status status = check_file_name(name); !status) return status;
    return check_for_export(mesh);
}

/// The coordinates of the image at a vertex, v down: samples are in the middle of their texels, also those that are points.
[[nodiscard]] inline std::array<double, 2> texture_place(const MeshView& mesh, std::size_t vertex) noexcept {
    const double shift = kit::inset(mesh.samples);
    return {(static_cast<double>(mesh.positions[2 * vertex]) + shift) / mesh.width,
            (static_cast<double>(mesh.positions[2 * vertex + 1]) + shift) / mesh.height};
}

}  // namespace detail

/// Writes a mesh as an OBJ file: lines `v x y 0`, `vt u v` and `f a/a b/b c/c`. `material_file`, if it is not nullptr, names the
/// file of write_material(), whose material the faces have. A mesh that write_obj() refuses and a name that is empty or has
/// control characters give a Status that says so, and no byte is written; a sink that refuses bytes gives Errc::write_failed.
inline Status write_textured_obj(const MeshView& mesh, const char* material_file, Sink sink) {
    if (const Status status = detail::check_for_texture(mesh, material_file != nullptr ? material_file : "none"); !status)
        return status;
    detail::Writer writer(sink);
    detail::write_obj_head(writer, material_file);
    for (std::size_t v = 0; v < mesh.vertex_count; ++v) {
        const std::array<double, 2> at = detail::upright(mesh, v);
        detail::write_obj_line(writer, "v", {at[0], at[1], 0});
    }
    for (std::size_t v = 0; v < mesh.vertex_count; ++v) {
        const std::array<double, 2> at = detail::texture_place(mesh, v);
        detail::write_obj_line(writer, "vt", {at[0], 1 - at[1]});
    }
    detail::write_obj_faces(writer, mesh, {"/"});
    return writer.finish();
}

/// Writes the material file (.mtl) of write_textured_obj(): one material, `image`, that shows the texture of this name as it is.
inline Status write_material(const char* texture, Sink sink) {
    if (const Status status = detail::check_file_name(texture); !status) return status;
    detail::Writer writer(sink);
    writer.text("# made by hmesh " HMESH_VERSION_STRING "\nnewmtl image\nKd 1 1 1\nillum 0\nmap_Kd -clamp on ");
    writer.text(texture);
    writer.text("\nmap_d -clamp on -imfchan m ");
    writer.text(texture);
    writer.text("\n");
    return writer.finish();
}

/// Writes a mesh as a binary PLY file: vertices `float x y z s t`, and the texture's name as `comment TextureFile`. A mesh that
/// write_ply() refuses and a name that is none or has control characters give a Status that says so, and no byte is written; a
/// sink that refuses bytes gives Errc::write_failed.
inline Status write_textured_ply(const MeshView& mesh, const char* texture, Sink sink) {
    if (const Status status = detail::check_for_texture(mesh, texture); !status) return status;
    detail::Writer writer(sink);
    detail::begin_ply(writer, mesh, texture);
    detail::write_ply_floats(writer, {"x", "y", "z", "s", "t"});
    detail::end_ply_head(writer, mesh);
    for (std::size_t v = 0; v < mesh.vertex_count; ++v) {
        const std::array<double, 2> at = detail::texture_place(mesh, v);
        writer.f32(mesh.positions[2 * v]);
        writer.f32(static_cast<float>(detail::y_up(mesh, v)));
        writer.f32(0);
        writer.f32(static_cast<float>(at[0]));
        writer.f32(static_cast<float>(1 - at[1]));
    }
    detail::write_ply_faces(writer, mesh);
    return writer.finish();
}

/// Writes a mesh as a .glb file of one unlit, blended material that shows the texture of this name, a path as seen from the file.
/// `longer_side` is as in GltfOptions. A mesh without vertices is a scene of nothing. A mesh that write_glb() refuses, a name
/// that is none or has control characters and a length that is none give a Status that says so, and no byte is written; a sink
/// that refuses bytes gives Errc::write_failed.
inline Status write_textured_glb(const MeshView& mesh, const char* texture, Sink sink, double longer_side = 1) {
    if (const Status status = detail::check_for_texture(mesh, texture); !status) return status;
    if (const Status status = detail::check_longer_side(longer_side); !status) return status;
    if (mesh.vertex_count == 0) return detail::write_empty_glb(sink);
    detail::GlbMesh out;
    detail::GlbFile& file = out.file;
    detail::GlbPrimitive primitive;
    const std::uint32_t positions = out.add({}, detail::GlbNumber::f32, 3, mesh.vertex_count);
    const std::uint32_t coordinates = out.add({}, detail::GlbNumber::f32, 2, mesh.vertex_count);
    primitive.attributes = {{"POSITION", positions}, {"TEXCOORD", coordinates, 0}};
    primitive.indices = detail::add_indices(out, mesh);
    detail::bound_positions(mesh, out.grid, file.arrays[positions]);
    file.nodes.push_back(detail::node_of(mesh, out.grid, longer_side));
    file.meshes.push_back({primitive});
    detail::GlbMaterial material;
    material.blends = true;
    material.texture = texture;
    file.materials.push_back(material);
    if (const Status status = detail::count_glb_json(file); !status) return status;
    return detail::write_glb_file(file, sink, [&](detail::Writer& writer, std::size_t i) {
        if (i == positions) return detail::write_glb_positions(writer, mesh, out.grid);
        if (i != coordinates) return detail::write_glb_indices(writer, mesh, file.arrays[i].number);
        for (std::size_t v = 0; v < mesh.vertex_count; ++v)
            for (const double at : detail::texture_place(mesh, v)) writer.f32(static_cast<float>(at));
    });
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_TEXTURED_HPP
