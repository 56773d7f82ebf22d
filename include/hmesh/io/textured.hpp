/// \file
/// write_textured_obj(), _ply(), _glb(): a mesh to draw its image on, as models with texture coordinates and the texture's name.
///
/// What is written are positions and faces as write_obj(), write_ply() and write_glb() write them, y up, and in place of colours
/// the coordinates of the image: u = x / width to the right and v = 1 - y / height up, or down in glTF, as each format has it.
/// The texture stays a file of its own, whose name the files hold: OBJ in a material file beside it, which write_material()
/// writes, PLY as the comment that MeshLab reads, glTF as a URI. For outlines (hmesh/outline.hpp) and any other mesh.
///
/// O(n), and nothing is allocated. Sources: Wavefront, Object and Material files; Khronos, glTF 2.0, sections 3.6 to 3.9.
#ifndef HMESH_IO_TEXTURED_HPP
#define HMESH_IO_TEXTURED_HPP

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "hmesh/core/finite.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/core/version.hpp"
#include "hmesh/io/detail/export_mesh.hpp"
#include "hmesh/io/sink.hpp"
#include "hmesh/mesh/mesh.hpp"

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

/// The coordinates of the image at a vertex, v down.
[[nodiscard]] inline std::array<double, 2> texture_place(const MeshView& mesh, std::size_t vertex) noexcept {
    return {static_cast<double>(mesh.positions[2 * vertex]) / mesh.width,
            static_cast<double>(mesh.positions[2 * vertex + 1]) / mesh.height};
}

/// Writes a name as a URI, which is also what JSON takes: other bytes than letters, digits and -._~/ as % and two digits.
inline void write_uri(Writer& writer, const char* name) {
    for (; *name != 0; ++name) {
        const char c = *name;
        const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
                              c == '.' || c == '_' || c == '~' || c == '/';
        const auto byte = static_cast<unsigned char>(c);
        const std::array<char, 3> digits = {'%', "0123456789ABCDEF"[byte >> 4U], "0123456789ABCDEF"[byte & 15U]};
        writer.bytes(is_plain ? &c : digits.data(), is_plain ? 1 : 3);
    }
}

/// Writes the JSON chunk of a textured .glb without padding: positions, coordinates and indices, in this order.
inline void write_textured_json(Writer& writer, const MeshView& mesh, const char* texture, double unit) {
    const auto count = [&](const char* words, std::uint64_t value) {
        writer.text(words);
        writer.decimal(static_cast<std::int64_t>(value));
    };
    const auto number = [&](const char* words, double value) {
        writer.text(words);
        writer.real(value);
    };
    double left = static_cast<double>(mesh.positions[0]), right = left, low = y_up(mesh, 0), high = low;
    for (std::size_t v = 1; v < mesh.vertex_count; ++v) {
        left = std::min(left, static_cast<double>(mesh.positions[2 * v]));
        right = std::max(right, static_cast<double>(mesh.positions[2 * v]));
        low = std::min(low, y_up(mesh, v));
        high = std::max(high, y_up(mesh, v));
    }
    const bool is_wide = mesh.vertex_count > 65535;
    const std::uint64_t vertices = mesh.vertex_count, corners = 3 * static_cast<std::uint64_t>(mesh.face_count);
    const std::uint64_t index_bytes = (is_wide ? 4 : 2) * corners;
    writer.text("{\"asset\":{\"version\":\"2.0\",\"generator\":\"hmesh " HMESH_VERSION_STRING "\"},");
    writer.text("\"extensionsUsed\":[\"KHR_materials_unlit\"],\"scene\":0,\"scenes\":[{\"nodes\":[0]}],");
    number("\"nodes\":[{\"mesh\":0,\"scale\":[", unit);
    number(",", unit);
    number(",", unit);
    writer.text("]}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":1},");
    writer.text("\"indices\":2,\"material\":0}]}],");
    writer.text("\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0},");
    writer.text("\"metallicFactor\":0,\"roughnessFactor\":1},\"alphaMode\":\"BLEND\",");
    writer.text("\"extensions\":{\"KHR_materials_unlit\":{}}}],");
    // 9729 is linear, without mipmaps; 33071 clamps to the edge.
    writer.text("\"samplers\":[{\"magFilter\":9729,\"minFilter\":9729,\"wrapS\":33071,\"wrapT\":33071}],");
    writer.text("\"textures\":[{\"sampler\":0,\"source\":0}],\"images\":[{\"uri\":\"");
    write_uri(writer, texture);
    // 5123, 5125 and 5126 are unsigned short, unsigned int and float.
    count("\"}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":", vertices);
    number(",\"type\":\"VEC3\",\"min\":[", static_cast<double>(static_cast<float>(left)));
    number(",", static_cast<double>(static_cast<float>(low)));
    number(",0],\"max\":[", static_cast<double>(static_cast<float>(right)));
    number(",", static_cast<double>(static_cast<float>(high)));
    count(",0]},{\"bufferView\":1,\"componentType\":5126,\"count\":", vertices);
    count(",\"type\":\"VEC2\"},{\"bufferView\":2,\"componentType\":", is_wide ? 5125 : 5123);
    count(",\"count\":", corners);
    count(",\"type\":\"SCALAR\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":", 12 * vertices);
    count(",\"byteStride\":12,\"target\":34962},{\"buffer\":0,\"byteOffset\":", 12 * vertices);
    count(",\"byteLength\":", 8 * vertices);
    count(",\"byteStride\":8,\"target\":34962},{\"buffer\":0,\"byteOffset\":", 20 * vertices);
    count(",\"byteLength\":", index_bytes);
    count(",\"target\":34963}],\"buffers\":[{\"byteLength\":", 20 * vertices + index_bytes);
    writer.text("}]}");
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
    if (!kit::is_within(longer_side, 0, static_cast<double>(std::numeric_limits<float>::max())))
        return {Errc::invalid_argument, "the longer side must be a length that a float holds, or 0", 0, 0};
    const double unit = longer_side > 0 ? longer_side / std::max(mesh.width, mesh.height) : 1;
    const bool is_empty = mesh.vertex_count == 0;
    const auto write_json = [&](detail::Writer& writer) {
        if (!is_empty) return detail::write_textured_json(writer, mesh, texture, unit);
        writer.text("{\"asset\":{\"version\":\"2.0\",\"generator\":\"hmesh " HMESH_VERSION_STRING
                    "\"},\"scene\":0,\"scenes\":[{}]}");
    };
    const auto nowhere = [](const void*, std::size_t) { return true; };
    detail::Writer counter(nowhere);
    write_json(counter);
    const auto padded = [](std::uint64_t size) { return static_cast<std::uint32_t>((size + 3) / 4 * 4); };
    const auto json_bytes = static_cast<std::uint64_t>(counter.position());
    const bool is_wide = mesh.vertex_count > 65535;
    const std::uint64_t binary_bytes = 20 * mesh.vertex_count + (is_wide ? 12 : 6) * static_cast<std::uint64_t>(mesh.face_count);

    detail::Writer writer(sink);
    writer.text("glTF");
    writer.u32(2);
    writer.u32(20 + padded(json_bytes) + (is_empty ? 0 : 8 + padded(binary_bytes)));
    writer.u32(padded(json_bytes));
    writer.text("JSON");
    write_json(writer);
    for (std::uint64_t i = json_bytes; i % 4 != 0; ++i) writer.text(" ");
    if (is_empty) return writer.finish();
    writer.u32(padded(binary_bytes));
    writer.bytes("BIN", 4);  // with its zero
    for (std::size_t v = 0; v < mesh.vertex_count; ++v) {
        writer.f32(mesh.positions[2 * v]);
        writer.f32(static_cast<float>(detail::y_up(mesh, v)));
        writer.f32(0);
    }
    for (std::size_t v = 0; v < mesh.vertex_count; ++v)
        for (const double at : detail::texture_place(mesh, v)) writer.f32(static_cast<float>(at));
    for (std::size_t f = 0; f < mesh.face_count; ++f)
        for (const std::uint32_t v : detail::turned(mesh.faces[f])) {
            if (is_wide) writer.u32(v);
            else writer.u16(static_cast<std::uint16_t>(v));
        }
    for (std::uint64_t i = binary_bytes; i % 4 != 0; ++i) writer.u8(0);
    return writer.finish();
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_TEXTURED_HPP
