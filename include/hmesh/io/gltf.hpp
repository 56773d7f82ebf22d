/// \file
/// write_glb(): a mesh as a binary glTF 2.0 file (.glb), for engines, editors and web viewers.
///
/// One node, one mesh, one unlit material (KHR_materials_unlit; a rough, non-metallic one where that is not known). y is up and
/// faces are counter-clockwise seen from +z; the picture's lower left corner is the origin. The buffer holds POSITION, COLOR_0
/// and the indices, all little-endian. Positions are pixels, sized by the node: float VEC3, exact; or unsigned shorts. Colours
/// are unsigned shorts, RGBA, alpha straight: grey is r = g = b, and what has alpha is drawn with alphaMode BLEND. glTF
/// colours are linear light, so stored values are decoded from sRGB: 16 bits keep them to 0.02 of a 255th, in 8 bits only 183
/// of 256 values would stay apart. Viewers interpolate linear light: pictures look a little different inside faces, unless the
/// mesh was fitted for that.
///
/// 20 bytes a vertex (16 quantised) and 6 a face, or 12 from 65,536 vertices on. O(n), and nothing is allocated unless there is
/// alpha: the sizes in the head of the file follow from the counts, and the JSON is written twice, the first time to be counted.
/// Sources: Khronos, glTF 2.0 specification, sections 3.6, 3.7 and 4.4, KHR_mesh_quantization, KHR_materials_unlit.
#ifndef HMESH_IO_GLTF_HPP
#define HMESH_IO_GLTF_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "hmesh/core/finite.hpp"
#include "hmesh/core/srgb.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/core/version.hpp"
#include "hmesh/io/detail/export_mesh.hpp"
#include "hmesh/io/sink.hpp"
#include "hmesh/mesh/mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// Options of write_glb().
struct GltfOptions {
    /// The length of the image's longer side in units, which glTF takes for metres; 0: a pixel is a unit. A metre is about what
    /// editors make of a picture; with a pixel a unit a photo is kilometres wide, beyond what their cameras see at first. It is
    /// the scale of the node alone: the positions in the buffer stay pixels.
    double longer_side = 1;
    /// Positions are unsigned shorts, 4 bytes a vertex less. Readers must know KHR_mesh_quantization: three.js, Babylon.js and
    /// Blender do, assimp 5.2 does not. Positions are rounded to a step of 1/256 px or, if the mesh spans more than 65535 / 256
    /// px, to a 65535th of its larger extent: exact up to a side of 255 px, off by 0.004 px at 512 and 0.03 px at 4096. Faces
    /// much thinner than a step may turn over.
    bool quantized_positions = false;
    /// The stored values are linear light already, as in many float images, and are written as they are.
    bool colors_are_linear = false;
};

namespace detail {

/// How the positions are stored, and where everything lies in the file. Sizes are in bytes.
struct GlbLayout {
    bool quantized = false;                                              ///< positions are unsigned shorts
    bool wide_indices = false;                                           ///< indices have 32 bits
    bool blends = false;                                                 ///< there is alpha
    double origin_x = 0, origin_y = 0, step = 1;                         ///< px, y up: position = origin + step * stored number
    double min_x = 0, min_y = 0, max_x = 0, max_y = 0;                   ///< the bounds of the stored numbers
    double unit = 1;                                                     ///< units a px
    std::uint64_t vertices = 0, corners = 0;                             ///< counts; three corners a face
    std::uint64_t position_bytes = 0, color_bytes = 0, index_bytes = 0;  ///< the three arrays of the buffer, in this order
    std::uint64_t json_bytes = 0;                                        ///< without padding

    /// From one position to the next.
    [[nodiscard]] std::uint64_t position_stride() const noexcept { return quantized ? 8 : 12; }
    /// The buffer without padding.
    [[nodiscard]] std::uint64_t binary_bytes() const noexcept { return position_bytes + color_bytes + index_bytes; }
    /// All of the file.
    [[nodiscard]] std::uint64_t file_bytes() const noexcept { return 28 + padded(json_bytes) + padded(binary_bytes()); }
    /// A size with the padding that makes it a multiple of 4.
    [[nodiscard]] static std::uint64_t padded(std::uint64_t size) noexcept { return (size + 3) / 4 * 4; }

    /// The number stored for an x in px; an integer if quantised.
    [[nodiscard]] double stored_x(double x) const noexcept { return stored(x, origin_x); }
    /// The number stored for a y in px, y up; an integer if quantised.
    [[nodiscard]] double stored_y(double y) const noexcept { return stored(y, origin_y); }

  private:
    [[nodiscard]] double stored(double value, double origin) const noexcept {
        if (!quantized) return static_cast<double>(static_cast<float>(value));
        return std::min(65535.0, std::floor((value - origin) / step + 0.5));
    }
};

/// Finds origin, step and bounds of the positions. O(n).
inline void lay_out_positions(const MeshView& mesh, GlbLayout& layout) noexcept {
    double left = static_cast<double>(mesh.positions[0]), right = left, bottom = y_up(mesh, 0), top = bottom;
    for (std::size_t v = 1; v < mesh.vertex_count; ++v) {
        const double x = static_cast<double>(mesh.positions[2 * v]), y = y_up(mesh, v);
        left = std::min(left, x), right = std::max(right, x);
        bottom = std::min(bottom, y), top = std::max(top, y);
    }
    if (layout.quantized) {
        layout.origin_x = left;
        layout.origin_y = bottom;
        // 1/256 px is the grid that positions lie on, and divides exactly.
        layout.step = std::max(1.0 / 256, std::max(right - left, top - bottom) / 65535);
    }
    // Rounding keeps the order of numbers, hence their extremes.
    layout.min_x = layout.stored_x(left), layout.max_x = layout.stored_x(right);
    layout.min_y = layout.stored_y(bottom), layout.max_y = layout.stored_y(top);
}

/// Writes a bracket and two numbers.
inline void write_pair(Writer& writer, double x, double y, const char* rest) {
    writer.text("[");
    writer.real(x);
    writer.text(",");
    writer.real(y);
    writer.text(rest);
}

/// Writes words and an integer.
inline void write_count(Writer& writer, const char* name, std::uint64_t value) {
    writer.text(name);
    writer.decimal(static_cast<std::int64_t>(value));
}

/// Writes the JSON chunk without padding.
inline void write_gltf_json(Writer& writer, const GlbLayout& layout) {
    writer.text("{\"asset\":{\"version\":\"2.0\",\"generator\":\"hmesh " HMESH_VERSION_STRING "\"},");
    writer.text("\"extensionsUsed\":[\"KHR_materials_unlit\"");
    if (layout.quantized) writer.text(",\"KHR_mesh_quantization\"],\"extensionsRequired\":[\"KHR_mesh_quantization\"");
    writer.text("],\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0,\"translation\":");
    write_pair(writer, layout.origin_x * layout.unit, layout.origin_y * layout.unit, ",0],\"scale\":");
    write_pair(writer, layout.step * layout.unit, layout.step * layout.unit, ",");
    writer.real(layout.step * layout.unit);
    writer.text("]}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"COLOR_0\":1},");
    writer.text("\"indices\":2,\"material\":0}]}],");
    writer.text("\"materials\":[{\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"roughnessFactor\":1},");
    if (layout.blends) writer.text("\"alphaMode\":\"BLEND\",");
    writer.text("\"extensions\":{\"KHR_materials_unlit\":{}}}],");

    // 5123 and 5125 are unsigned short and int, 5126 is float.
    write_count(writer, "\"accessors\":[{\"bufferView\":0,\"componentType\":", layout.quantized ? 5123 : 5126);
    write_count(writer, ",\"count\":", layout.vertices);
    writer.text(",\"type\":\"VEC3\",\"min\":");
    write_pair(writer, layout.min_x, layout.min_y, ",0],\"max\":");
    write_pair(writer, layout.max_x, layout.max_y, ",0]},");
    write_count(writer, "{\"bufferView\":1,\"componentType\":5123,\"normalized\":true,\"count\":", layout.vertices);
    write_count(writer, ",\"type\":\"VEC4\"},{\"bufferView\":2,\"componentType\":", layout.wide_indices ? 5125 : 5123);
    write_count(writer, ",\"count\":", layout.corners);

    // 34962 holds vertices and 34963 indices.
    write_count(writer, ",\"type\":\"SCALAR\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":", layout.position_bytes);
    write_count(writer, ",\"byteStride\":", layout.position_stride());
    write_count(writer, ",\"target\":34962},{\"buffer\":0,\"byteOffset\":", layout.position_bytes);
    write_count(writer, ",\"byteLength\":", layout.color_bytes);
    writer.text(",\"byteStride\":8,\"target\":34962},");
    write_count(writer, "{\"buffer\":0,\"byteOffset\":", layout.position_bytes + layout.color_bytes);
    write_count(writer, ",\"byteLength\":", layout.index_bytes);
    write_count(writer, ",\"target\":34963}],\"buffers\":[{\"byteLength\":", layout.binary_bytes());
    writer.text("}]}");
}

/// Refuses a file of 4 GiB or more.
[[nodiscard]] inline Status check_size(const GlbLayout& layout) noexcept {
    constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();
    if (layout.file_bytes() <= most) return {};
    return {Errc::invalid_argument, "the mesh needs more bytes than the head of a .glb file counts",
            static_cast<std::int64_t>(layout.file_bytes()), static_cast<std::int64_t>(most)};
}

/// Refuses what a .glb file cannot hold, and fills the layout of what it can. O(n).
[[nodiscard]] inline Status lay_out_glb(const MeshView& mesh, const GltfOptions& options, GlbLayout& layout) noexcept {
    constexpr std::uint64_t most = std::numeric_limits<std::int32_t>::max();  // products with strides stay below 2^63
    if (const Status status = check_counts(mesh, most, most, "the mesh has more vertices or faces than a .glb file holds");
        !status)
        return status;
    layout.blends = mesh.channels == 2 || mesh.channels == 4;
    layout.quantized = options.quantized_positions;
    layout.vertices = mesh.vertex_count;
    layout.corners = 3 * static_cast<std::uint64_t>(mesh.face_count);
    // 65535 and 2^32 - 1 must not be used as indices: they mean a restart to GPUs.
    layout.wide_indices = layout.vertices > 65535;
    layout.position_bytes = layout.position_stride() * layout.vertices;
    layout.color_bytes = 8 * layout.vertices;
    layout.index_bytes = (layout.wide_indices ? 4 : 2) * layout.corners;
    if (const Status status = check_size(layout); !status) return status;  // before so many are read
    if (const Status status = check_for_export(mesh); !status) return status;
    if (!kit::is_within(options.longer_side, 0, static_cast<double>(std::numeric_limits<float>::max())))
        return {Errc::invalid_argument, "the longer side must be a length that a float holds, or 0", 0, 0};

    if (options.longer_side > 0) layout.unit = options.longer_side / std::max(mesh.width, mesh.height);
    lay_out_positions(mesh, layout);
    const auto nowhere = [](const void*, std::size_t) { return true; };
    Writer counter(nowhere);
    write_gltf_json(counter, layout);
    layout.json_bytes = static_cast<std::uint64_t>(counter.position());
    return check_size(layout);
}

/// Writes the positions, z = 0.
inline void write_glb_positions(Writer& writer, const MeshView& mesh, const GlbLayout& layout) {
    for (std::size_t v = 0; v < mesh.vertex_count; ++v) {
        const double x = layout.stored_x(static_cast<double>(mesh.positions[2 * v])), y = layout.stored_y(y_up(mesh, v));
        if (layout.quantized) {
            writer.u16(static_cast<std::uint16_t>(x));
            writer.u16(static_cast<std::uint16_t>(y));
            writer.u32(0);  // z and padding: vertex attributes begin at multiples of 4
        } else {
            writer.f32(static_cast<float>(x));
            writer.f32(static_cast<float>(y));
            writer.f32(0);
        }
    }
}

/// Writes RGBA of 16 bits each.
inline void write_glb_colors(Writer& writer, const MeshView& mesh, bool are_linear) {
    for (std::size_t v = 0; v < mesh.vertex_count; ++v) {
        const std::array<double, 4> rgba = rgba_shares(mesh, v);
        for (std::size_t k = 0; k < 3; ++k) writer.u16(to_u16(are_linear ? rgba[k] : kit::srgb_to_linear(rgba[k])));
        writer.u16(to_u16(rgba[3]));
    }
}

/// Writes the faces' corners.
inline void write_glb_indices(Writer& writer, const MeshView& mesh, bool wide) {
    for (std::size_t f = 0; f < mesh.face_count; ++f) {
        for (const std::uint32_t v : turned(mesh.faces[f])) {
            if (wide) writer.u32(v);
            else writer.u16(static_cast<std::uint16_t>(v));
        }
    }
}

/// Fills a chunk of this size up to a multiple of 4.
inline void pad(Writer& writer, std::uint64_t size, char with) {
    for (; size % 4 != 0; ++size) writer.u8(static_cast<std::uint8_t>(with));
}

/// Writes the file of a mesh without vertices: an accessor has at least one element, so there is no mesh but an empty scene.
inline Status write_empty_glb(const MeshView& mesh, Sink sink) {
    if (const Status status = check_for_export(mesh); !status) return status;
    static constexpr char json[] =
        "{\"asset\":{\"version\":\"2.0\",\"generator\":\"hmesh " HMESH_VERSION_STRING "\"},\"scene\":0,\"scenes\":[{}]}";
    constexpr std::uint64_t size = sizeof json - 1;
    Writer writer(sink);
    writer.text("glTF");
    writer.u32(2);
    writer.u32(static_cast<std::uint32_t>(20 + GlbLayout::padded(size)));
    writer.u32(static_cast<std::uint32_t>(GlbLayout::padded(size)));
    writer.text("JSON");
    writer.text(json);
    pad(writer, size, ' ');
    return writer.finish();
}

}  // namespace detail

/// Writes a mesh of 1 to 4 channels as a .glb file; one without vertices as a scene of nothing. A mesh that has no size, numbers
/// that are not finite, faces without their vertices, or needs 4 GiB, and a longer side that is negative or no float, give a
/// Status that says so, and no byte is written; a sink that refuses bytes gives Errc::write_failed.
inline Status write_glb(const MeshView& source, Sink sink, const GltfOptions& options = {}) {
    if (source.vertex_count == 0 && source.face_count == 0) return detail::write_empty_glb(source, sink);
    detail::GlbLayout layout;
    if (const Status status = detail::lay_out_glb(source, options, layout); !status) return status;
    const detail::ExportMesh exported(source, detail::Premultiplied::divided);
    const MeshView& mesh = exported.view();
    detail::Writer writer(sink);
    writer.text("glTF");
    writer.u32(2);
    writer.u32(static_cast<std::uint32_t>(layout.file_bytes()));
    writer.u32(static_cast<std::uint32_t>(detail::GlbLayout::padded(layout.json_bytes)));
    writer.text("JSON");
    detail::write_gltf_json(writer, layout);
    detail::pad(writer, layout.json_bytes, ' ');
    writer.u32(static_cast<std::uint32_t>(detail::GlbLayout::padded(layout.binary_bytes())));
    writer.bytes("BIN", 4);  // with its zero
    detail::write_glb_positions(writer, mesh, layout);
    detail::write_glb_colors(writer, mesh, options.colors_are_linear);
    detail::write_glb_indices(writer, mesh, layout.wide_indices);
    detail::pad(writer, layout.binary_bytes(), '\0');
    return writer.finish();
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_GLTF_HPP
