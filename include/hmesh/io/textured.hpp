/// \file
/// write_textured_obj(), _ply(), _glb(): a mesh to draw its image on, as models with texture coordinates and the texture's name.
///
/// What is written are positions and faces as write_obj(), write_ply() and write_glb() write them, y up, and in place of colours
/// the coordinates of the image: u = x / width to the right and v = 1 - y / height up, or down in glTF, as each format has it.
/// The texture stays a file of its own, whose name the files hold: OBJ in a material file beside it, which write_material()
/// writes, PLY as the comment that MeshLab reads, glTF as a URI. For outlines (hmesh/outline.hpp) and any other mesh.
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
#include "hmesh/io/gltf.hpp"
#include "hmesh/io/sink.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/mesh/samples.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

namespace detail {

/// Refuses a name that is none, or that would end a line.
[[nodiscard]] inline Status check_file_name(const char* name) noexcept {
    if (name == nullptr || *name == 0) return {Errc::invalid_argument, "the texture needs a name"};
    for (const char* c = name; *c != 0; ++c)
        if (static_cast<unsigned char>(*c) < 32)
            return {Errc::invalid_argument, "the texture's name must not have control characters",
                    static_cast<int>(static_cast<unsigned char>(*c)), 32};
    return {};
}

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
/// file of write_material(), whose material the faces have. A mesh that write_obj() refuses and a name with control characters
/// give a Status that says so, and no byte is written; a sink that refuses bytes gives Errc::write_failed.
inline Status write_textured_obj(const MeshView& mesh, const char* material_file, Sink sink) {
    if (const Status status = detail::check_for_texture(mesh, material_file != nullptr ? material_file : "none"); !status)
        return status;
    detail::Writer writer(sink);
    writer.text("# made by hmesh " HMESH_VERSION_STRING "\n");
    if (material_file != nullptr) {
        writer.text("mtllib ");
        writer.text(material_file);
        writer.text("\nusemtl image\n");
    }
    for (std::size_t v = 0; v < mesh.vertex_count; ++v) {
        writer.text("v ");
        writer.real(static_cast<double>(mesh.positions[2 * v]));
        writer.text(" ");
        writer.real(detail::y_up(mesh, v));
        writer.text(" 0\n");
    }
    for (std::size_t v = 0; v < mesh.vertex_count; ++v) {
        const std::array<double, 2> at = detail::texture_place(mesh, v);
        writer.text("vt ");
        writer.real(at[0]);
        writer.text(" ");
        writer.real(1 - at[1]);
        writer.text("\n");
    }
    for (std::size_t f = 0; f < mesh.face_count; ++f) {
        writer.text("f");
        for (const std::uint32_t v : detail::turned(mesh.faces[f]))
            for (const char* before : {" ", "/"}) {
                writer.text(before);
                writer.decimal(static_cast<std::int64_t>(v) + 1);  // vertices count from 1
            }
        writer.text("\n");
    }
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
    writer.text("ply\nformat binary_little_endian 1.0\ncomment made by hmesh " HMESH_VERSION_STRING "\ncomment TextureFile ");
    writer.text(texture);
    writer.text("\nelement vertex ");
    writer.decimal(static_cast<std::int64_t>(mesh.vertex_count));
    for (const char* name : {"x", "y", "z", "s", "t"}) {
        writer.text("\nproperty float ");
        writer.text(name);
    }
    writer.text("\nelement face ");
    writer.decimal(static_cast<std::int64_t>(mesh.face_count));
    writer.text("\nproperty list uchar int vertex_indices\nend_header\n");
    for (std::size_t v = 0; v < mesh.vertex_count; ++v) {
        const std::array<double, 2> at = detail::texture_place(mesh, v);
        writer.f32(mesh.positions[2 * v]);
        writer.f32(static_cast<float>(detail::y_up(mesh, v)));
        writer.f32(0);
        writer.f32(static_cast<float>(at[0]));
        writer.f32(static_cast<float>(1 - at[1]));
    }
    for (std::size_t f = 0; f < mesh.face_count; ++f) {
        writer.u8(3);
        for (const std::uint32_t v : detail::turned(mesh.faces[f])) writer.u32(v);
    }
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
