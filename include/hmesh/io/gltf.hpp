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
/// 20 bytes a vertex (16 quantised) and 6 a face, or 12 from 65,536 vertices on. O(n); of what grows with the mesh, nothing is
/// allocated unless there is alpha.
/// Sources: Khronos, glTF 2.0 specification, sections 3.6 and 3.7, KHR_mesh_quantization, KHR_materials_unlit.
#ifndef HMESH_IO_GLTF_HPP
#define HMESH_IO_GLTF_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "hmesh/core/finite.hpp"
#include "hmesh/core/srgb.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/io/detail/export_mesh.hpp"
#include "hmesh/io/detail/glb_file.hpp"
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

/// The plane of the stored positions: a number stands for `origin` + `step` times it, in px with y up.
struct GlbGrid {
    bool is_quantized = false;           ///< numbers are unsigned shorts, else floats
    std::array<double, 2> origin{0, 0};  ///< px
    double step = 1;                     ///< px

    /// The number stored for a coordinate in px, y up; an integer if quantised. `axis`: 0 for x, 1 for y.
    [[nodiscard]] double stored(double value, std::size_t axis) const noexcept {
        if (!is_quantized) return static_cast<double>(static_cast<float>(value));
        return std::min(65535.0, std::floor((value - origin[axis]) / step + 0.5));
    }
};

/// x and y of a vertex in px, y up.
[[nodiscard]] inline std::array<double, 2> upright(const MeshView& mesh, std::size_t vertex) noexcept {
    return {static_cast<double>(mesh.positions[2 * vertex]), y_up(mesh, vertex)};
}

/// Finds the grid of the positions, and the bounds of the numbers stored. O(n).
inline void lay_out_positions(const MeshView& mesh, bool is_quantized, GlbGrid& grid, GlbArray& array) noexcept {
    std::array<double, 2> low = upright(mesh, 0), high = low;
    for (std::size_t v = 1; v < mesh.vertex_count; ++v) {
        const std::array<double, 2> at = upright(mesh, v);
        for (std::size_t k = 0; k < 2; ++k) low[k] = std::min(low[k], at[k]), high[k] = std::max(high[k], at[k]);
    }
    grid.is_quantized = is_quantized;
    if (is_quantized) {
        grid.origin = low;
        // 1/256 px is the grid that positions lie on, and divides exactly.
        grid.step = std::max(1.0 / 256, std::max(high[0] - low[0], high[1] - low[1]) / 65535);
    }
    // Rounding keeps the order of numbers, hence their extremes.
    array.has_bounds = true;
    for (std::size_t k = 0; k < 2; ++k) array.low[k] = grid.stored(low[k], k), array.high[k] = grid.stored(high[k], k);
}

/// What an array of the file is filled with.
enum class GlbContent : std::uint8_t { positions, colors, indices };

/// All that write_glb() writes of a mesh.
struct GlbMesh {
    GlbFile file;
    std::vector<GlbContent> contents;  ///< of each array
    GlbGrid grid;
};

/// Refuses what a .glb file cannot hold, and lays out what it can. O(n).
[[nodiscard]] inline Status lay_out_glb(const MeshView& mesh, const GltfOptions& options, GlbMesh& out) {
    constexpr std::uint64_t most = std::numeric_limits<std::int32_t>::max();  // products with strides stay below 2^63
    if (const Status status = check_counts(mesh, most, most, "the mesh has more vertices or faces than a .glb file holds");
        !status)
        return status;
    GlbFile& file = out.file;
    GlbPrimitive primitive;
    const auto add = [&](GlbContent content, GlbNumber number, std::uint32_t components, std::uint64_t count) {
        GlbArray array;
        array.number = number;
        array.components = components;
        array.is_normalized = content == GlbContent::colors;
        array.is_indices = content == GlbContent::indices;
        array.count = count;
        file.arrays.push_back(array);
        out.contents.push_back(content);
        return static_cast<std::uint32_t>(file.arrays.size() - 1);
    };
    const auto positions = options.quantized_positions ? GlbNumber::u16 : GlbNumber::f32;
    primitive.attributes.push_back({"POSITION", add(GlbContent::positions, positions, 3, mesh.vertex_count)});
    primitive.attributes.push_back({"COLOR", add(GlbContent::colors, GlbNumber::u16, 4, mesh.vertex_count), 0});
    // 65535 and 2^32 - 1 must not be used as indices: they mean a restart to GPUs.
    primitive.indices = add(GlbContent::indices, mesh.vertex_count > 65535 ? GlbNumber::u32 : GlbNumber::u16, 1,
                            3 * static_cast<std::uint64_t>(mesh.face_count));
    if (const Status status = check_glb_size(file); !status) return status;  // before so many are read
    if (const Status status = check_for_export(mesh); !status) return status;
    if (!kit::is_within(options.longer_side, 0, static_cast<double>(std::numeric_limits<float>::max())))
        return {Errc::invalid_argument, "the longer side must be a length that a float holds, or 0", 0, 0};

    file.is_quantized = options.quantized_positions;
    file.materials.push_back({false, mesh.channels == 2 || mesh.channels == 4});
    lay_out_positions(mesh, options.quantized_positions, out.grid, file.arrays[primitive.attributes[0].array]);
    const double unit = options.longer_side > 0 ? options.longer_side / std::max(mesh.width, mesh.height) : 1;
    file.nodes.push_back({{out.grid.origin[0] * unit, out.grid.origin[1] * unit}, out.grid.step * unit, 0});
    file.meshes.push_back({primitive});
    return count_glb_json(file);
}

/// Writes the positions, z = 0.
inline void write_glb_positions(Writer& writer, const MeshView& mesh, const GlbGrid& grid) {
    for (std::size_t v = 0; v < mesh.vertex_count; ++v) {
        const std::array<double, 2> at = upright(mesh, v);
        for (std::size_t k = 0; k < 2; ++k) {
            if (grid.is_quantized) writer.u16(static_cast<std::uint16_t>(grid.stored(at[k], k)));
            else writer.f32(static_cast<float>(at[k]));
        }
        writer.u32(0);  // z, and of shorts padding: vertex attributes begin at multiples of 4
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
inline void write_glb_indices(Writer& writer, const MeshView& mesh, GlbNumber number) {
    for (std::size_t f = 0; f < mesh.face_count; ++f) {
        for (const std::uint32_t v : turned(mesh.faces[f])) {
            if (number == GlbNumber::u32) writer.u32(v);
            else writer.u16(static_cast<std::uint16_t>(v));
        }
    }
}

}  // namespace detail

/// Writes a mesh of 1 to 4 channels as a .glb file. A mesh that is empty, has no size, numbers that are not finite, faces
/// without their vertices, or needs 4 GiB, and a longer side that is negative or no float, give a Status that says so, and no
/// byte is written; a sink that refuses bytes gives Errc::write_failed.
inline Status write_glb(const MeshView& source, Sink sink, const GltfOptions& options = {}) {
    detail::GlbMesh out;
    if (const Status status = detail::lay_out_glb(source, options, out); !status) return status;
    const detail::ExportMesh exported(source, detail::Premultiplied::divided);
    const MeshView& mesh = exported.view();
    return detail::write_glb_file(out.file, sink, [&](detail::Writer& writer, std::size_t array) {
        switch (out.contents[array]) {
            case detail::GlbContent::positions: return write_glb_positions(writer, mesh, out.grid);
            case detail::GlbContent::colors: return write_glb_colors(writer, mesh, options.colors_are_linear);
            case detail::GlbContent::indices: return write_glb_indices(writer, mesh, out.file.arrays[array].number);
        }
    });
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_GLTF_HPP
