/// \file
/// write_glb(): a mesh as a binary glTF 2.0 file (.glb), for engines, editors and web viewers.
///
/// One node, one mesh, one unlit material (KHR_materials_unlit; a rough, non-metallic one where that is not known). y is up and
/// faces are counter-clockwise seen from +z; the picture's lower left corner is the origin. The buffer holds POSITION, COLOR_0
/// and the indices, all little-endian. Positions are pixels, sized by the node: float VEC3, exact; or unsigned shorts. Colours
/// are unsigned shorts, RGBA, alpha straight: grey is r = g = b, and what has alpha is drawn with alphaMode BLEND. glTF
/// colours are linear light, so stored values are decoded from sRGB: 16 bits keep them to 0.03 of a 255th, in 8 bits only 183
/// of 256 values stay apart. Viewers interpolate linear light: pictures look a little different inside faces, unless the
/// mesh was fitted for that.
///
/// Groups of channels (io/channel_groups.hpp) become COLOR_0, COLOR_1 and so on, NORMAL with TANGENT (1, 0, 0, 1), and _NAME of
/// data. With a normal the material is lit.
///
/// Smallest is a mesh in the order of order_for_gpu(), with positions of 16 bits, colours of 8, and compressed: 8 to 9 bytes a
/// vertex with all, of which 2.3 are indices. Attributes are interleaved then.
///
/// 20 bytes a vertex (16 quantised) and 6 a face, or 12 from 65,536 vertices on. O(n); of what grows with the mesh, nothing is
/// allocated unless there is alpha or a compressor.
/// Sources: Khronos, glTF 2.0 specification, sections 3.6 and 3.7, KHR_mesh_quantization, KHR_materials_unlit,
/// EXT_meshopt_compression.
#ifndef HMESH_IO_GLTF_HPP
#define HMESH_IO_GLTF_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "hmesh/core/array.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/finite.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/srgb.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/io/channel_groups.hpp"
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
    /// Blender do, assimp 5.2 and Godot 4 do not. Positions count steps of a power of two, from 1/256 px to 1 px, the largest
    /// on which all of them lie: exact if the mesh spans at most 65,535 of them, as it does up to 255 px, or up to 1,023 px if
    /// it was made with MeshLimits::position_step = 1.0 / 64. Else they are rounded to a 65535th of the larger extent, off by
    /// 0.004 px at 512 and 0.03 px at 4096, and faces much thinner than that may turn over. Normals and tangents are shorts
    /// too, or bytes.
    bool quantized_positions = false;
    /// The stored values are linear light already, as in many float images, and are written as they are.
    bool colors_are_linear = false;
    /// Bits of a colour and of data, 16 or 8; with quantised positions, of a normal too. 8 take 4 bytes a vertex less, 3 when
    /// compressed, and leave 183 of 256 sRGB values apart: 0.05 dB of a photograph at 35 dB, but 7 of a drawing at 57 dB.
    int color_bits = 16;
    /// What the channels mean. None: they are one colour.
    ChannelGroups groups{};
    /// Compresses the arrays: readers must know EXT_meshopt_compression, as three.js and Babylon.js do with a decoder beside
    /// them; there is no uncompressed copy. What it refers to must live until write_glb() returns. None: they are written as
    /// they are.
    GltfCompress compress{};
};

namespace detail {

/// The plane of the stored positions: a number stands for `origin` + `step` times it, in px with y up.
struct GlbGrid {
    bool is_quantized = false;           ///< numbers are unsigned shorts, else floats
    std::array<double, 2> origin{0, 0};  ///< px
    double step = 1;                     ///< px

    /// The number stored for a coordinate in px, y up; an integer if quantised. `axis`: 0 for x, 1 for y.
    [[nodiscard]] double stored(double value, std::size_t axis) const noexcept {
        if (!is_quantized) return kit::as_float(value);
        return std::min(65535.0, std::floor((value - origin[axis]) / step + 0.5));
    }
};

/// x and y of a vertex in px, y up.
[[nodiscard]] inline std::array<double, 2> upright(const MeshView& mesh, std::size_t vertex) noexcept {
    return {static_cast<double>(mesh.positions[2 * vertex]), y_up(mesh, vertex)};
}

/// The smallest and the largest coordinates of a mesh, in px, y up.
struct GlbBounds {
    std::array<double, 2> low{std::numeric_limits<double>::max(), std::numeric_limits<double>::max()};  ///< of x and y
    std::array<double, 2> high{-low[0], -low[1]};                                                       ///< of x and y

    /// Stretches them around the vertices of a mesh. O(n).
    void add(const MeshView& mesh) noexcept {
        for (std::size_t v = 0; v < mesh.vertex_count; ++v) {
            const std::array<double, 2> at = upright(mesh, v);
            for (std::size_t k = 0; k < 2; ++k) low[k] = std::min(low[k], at[k]), high[k] = std::max(high[k], at[k]);
        }
    }
};

/// The largest step from 1/256 px to 1 px of which all coordinates, from `low` on, are multiples; 1/256 px if there is none.
[[nodiscard]] inline double position_step(const MeshView& mesh, const std::array<double, 2>& low) noexcept {
    std::uint64_t places = 256;  // each bit that one of the positions has, counted in 1/256 px, and that of 1 px
    for (std::size_t v = 0; v < mesh.vertex_count && places % 2 == 0; ++v) {
        const std::array<double, 2> at = upright(mesh, v);
        for (std::size_t k = 0; k < 2; ++k) {
            const double place = std::min((at[k] - low[k]) * 256, 1e18);
            places |= place == std::floor(place) ? static_cast<std::uint64_t>(place) : 1;
        }
    }
    double step = 1.0 / 256;
    for (; places % 2 == 0; places /= 2) step *= 2;
    return step;
}

/// The grid of quantised positions of some meshes, one for all. O(n).
[[nodiscard]] inline GlbGrid quantized_grid(const MeshView* meshes, std::size_t count) noexcept {
    GlbBounds bounds;
    for (std::size_t i = 0; i < count; ++i) bounds.add(meshes[i]);
    GlbGrid grid{true, bounds.low, 1};
    for (std::size_t i = 0; i < count; ++i) grid.step = std::min(grid.step, position_step(meshes[i], bounds.low));
    const double extent = std::max(bounds.high[0] - bounds.low[0], bounds.high[1] - bounds.low[1]);
    grid.step = std::max(grid.step, extent / 65535);
    return grid;
}

/// Finds the bounds of the positions stored. O(n).
inline void bound_positions(const MeshView& mesh, const GlbGrid& grid, GlbArray& array) noexcept {
    GlbBounds bounds;
    bounds.add(mesh);
    // Rounding keeps the order of numbers, hence their extremes.
    array.has_bounds = true;
    for (std::size_t k = 0; k < 2; ++k)
        array.low[k] = grid.stored(bounds.low[k], k), array.high[k] = grid.stored(bounds.high[k], k);
}

/// Refuses a longer side that is no length.
[[nodiscard]] inline Status check_longer_side(double length) noexcept {
    if (kit::is_within(length, 0, static_cast<double>(std::numeric_limits<float>::max()))) return {};
    return {Errc::invalid_argument, "the longer side must be a length that a float holds, or 0"};
}

/// Where the first mesh of the file is, and how large.
[[nodiscard]] inline GlbNode node_of(const MeshView& mesh, const GlbGrid& grid, double longer_side) noexcept {
    const double unit = longer_side > 0 ? longer_side / std::max(mesh.right(), mesh.bottom()) : 1;
    return {{grid.origin[0] * unit, grid.origin[1] * unit}, grid.step * unit, 0};
}

/// What an array of the file is filled with: positions, colours and so on of all vertices, or the indices of all faces.
struct GlbContent {
    enum class Kind : std::uint8_t { positions, colors, normals, tangents, data, indices } kind = Kind::positions;
    std::size_t first = 0;  ///< channel of the mesh
    int channels = 0;       ///< from that one on
};

/// All that write_glb() writes of a mesh.
struct GlbMesh {
    GlbFile file;
    kit::Array<GlbContent> contents;  ///< of each array
    GlbGrid grid;

    /// Appends an array and returns its number.
    std::uint32_t add(GlbContent content, GlbNumber number, std::uint32_t components, std::uint64_t count) {
        GlbArray array;
        array.number = number;
        array.components = components;
        array.is_normalized =
            content.kind != GlbContent::Kind::positions && content.kind != GlbContent::Kind::indices && number != GlbNumber::f32;
        array.is_indices = content.kind == GlbContent::Kind::indices;
        array.count = count;
        file.arrays.push_back(array);
        contents.push_back(content);
        return static_cast<std::uint32_t>(file.arrays.size() - 1);
    }
};

/// How the colours of meshes are wanted.
[[nodiscard]] inline Premultiplied wanted_colors(const GltfOptions& options) noexcept {
    return options.groups.is_empty() ? Premultiplied::divided : Premultiplied::grouped;
}

/// Appends the array of the indices of so many vertices and faces, and returns its number.
HMESH_COLD inline std::uint32_t add_indices(GlbMesh& out, std::size_t vertices, std::size_t faces) {
    // 65535 and 2^32 - 1 must not be used as indices: they mean a restart to GPUs.
    return out.add({GlbContent::Kind::indices}, vertices > 65535 ? GlbNumber::u32 : GlbNumber::u16, 1,
                   3 * static_cast<std::uint64_t>(faces));
}
/// The same of a mesh.
HMESH_COLD inline std::uint32_t add_indices(GlbMesh& out, const MeshView& mesh) {
    return add_indices(out, mesh.vertex_count, mesh.face_count);
}

/// Appends the arrays of a group of channels, from the channel `first` on, and names them.
HMESH_COLD inline void add_group(GlbMesh& out, GlbPrimitive& primitive, GlbMaterial& material, const ChannelGroup& group,
                                 std::size_t first, std::uint64_t vertices, const GltfOptions& options) {
    using Kind = GlbContent::Kind;
    const bool is_narrow = options.color_bits == 8;
    const auto number = is_narrow ? GlbNumber::u8 : GlbNumber::u16;
    if (group.meaning == ChannelGroup::Meaning::color) {
        int set = 0;
        for (const GlbAttribute& before : primitive.attributes) set += before.set >= 0 ? 1 : 0;
        material.blends = material.blends || (set == 0 && kit::has_alpha(group.channels));
        primitive.attributes.push_back({"COLOR", out.add({Kind::colors, first, group.channels}, number, 4, vertices), set});
    } else if (group.meaning == ChannelGroup::Meaning::normal) {
        const auto vectors = !options.quantized_positions ? GlbNumber::f32 : is_narrow ? GlbNumber::i8 : GlbNumber::i16;
        material.is_lit = true;
        primitive.attributes.push_back({"NORMAL", out.add({Kind::normals, first, 3}, vectors, 3, vertices)});
        primitive.attributes.push_back({"TANGENT", out.add({Kind::tangents, first, 3}, vectors, 4, vertices)});
    } else {
        const auto components = static_cast<std::uint32_t>(group.channels);
        const std::uint32_t array = out.add({Kind::data, first, group.channels}, number, components, vertices);
        primitive.attributes.push_back({group.name, array, -1, true});
    }
}

/// Refuses what a .glb file cannot hold, and lays out what it can. O(n).
[[nodiscard]] HMESH_COLD inline Status lay_out_glb(const MeshView& mesh, const GltfOptions& options, GlbMesh& out) {
    constexpr std::uint64_t most = std::numeric_limits<std::int32_t>::max();  // products with strides stay below 2^63
    if (const Status status = check_counts(mesh, most, most, "the mesh has more vertices or faces than a .glb file holds");
        !status)
        return status;
    if (options.color_bits != 8 && options.color_bits != 16)
        return {Errc::invalid_argument, "the bits of a colour must be 8 or 16", options.color_bits, 16};
    if (const Status status = check(options.groups, mesh); !status) return status;
    GlbFile& file = out.file;
    GlbPrimitive primitive;
    GlbMaterial material;
    const auto positions = options.quantized_positions ? GlbNumber::u16 : GlbNumber::f32;
    primitive.attributes.push_back({"POSITION", out.add({}, positions, 3, mesh.vertex_count)});
    std::size_t channel = 0;
    for (const ChannelGroup& group : options.groups) {
        add_group(out, primitive, material, group, channel, mesh.vertex_count, options);
        channel += static_cast<std::size_t>(group.channels);
    }
    if (options.groups.is_empty())
        add_group(out, primitive, material, {"color", ChannelGroup::Meaning::color, mesh.channels}, 0, mesh.vertex_count,
                  options);
    primitive.indices = add_indices(out, mesh);
    if (const Status status = check_glb_size(file); !status) return status;  // before so many are read
    if (const Status status = check_for_export(mesh, options.groups.is_empty() ? 4 : 16); !status) return status;
    if (const Status status = check_longer_side(options.longer_side); !status) return status;

    file.is_quantized = options.quantized_positions;
    if (options.quantized_positions) out.grid = quantized_grid(&mesh, 1);
    bound_positions(mesh, out.grid, file.arrays[primitive.attributes[0].array]);
    file.nodes.push_back(node_of(mesh, out.grid, options.longer_side));
    file.meshes.push_back({primitive});
    file.materials.push_back(material);
    return {};
}

/// Puts a share in [0, 1], or a component of a unit vector in [-1, 1], as a number of this kind.
inline void put_share(Writer& writer, GlbNumber number, double share) {
    switch (number) {
        case GlbNumber::u8: return writer.u8(to_u8(share));
        case GlbNumber::u16: return writer.u16(to_u16(share));
        case GlbNumber::i8: return writer.u8(static_cast<std::uint8_t>(static_cast<int>(std::floor(share * 127 + 0.5))));
        case GlbNumber::i16: return writer.u16(static_cast<std::uint16_t>(static_cast<int>(std::floor(share * 32767 + 0.5))));
        case GlbNumber::u32:
        case GlbNumber::f32: break;
    }
    writer.f32(static_cast<float>(share));
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

/// What is stored of a vertex in an array of this content, as shares: colours of linear light.
[[nodiscard]] inline std::array<double, 4> glb_shares(const MeshView& mesh, std::size_t vertex, const GlbContent& content,
                                                      bool colors_are_linear) noexcept {
    const float* const color = mesh.colors + static_cast<std::size_t>(mesh.channels) * vertex + content.first;
    std::array<double, 4> shares{};
    switch (content.kind) {
        case GlbContent::Kind::colors:
            shares = rgba_shares(color, content.channels, mesh.peak);
            for (std::size_t k = 0; k < 3 && !colors_are_linear; ++k) shares[k] = kit::srgb_to_linear(shares[k]);
            break;
        case GlbContent::Kind::normals: {
            const std::array<double, 3> normal = unit_normal(color, mesh.peak);
            std::copy(normal.begin(), normal.end(), shares.begin());
            break;
        }
        case GlbContent::Kind::tangents: return {1, 0, 0, 1};
        default:
            for (std::size_t k = 0; k < static_cast<std::size_t>(content.channels); ++k)
                shares[k] = share_of_peak(color[k], mesh.peak);
    }
    return shares;
}

/// Writes colours, normals, tangents or data.
inline void write_glb_shares(Writer& writer, const MeshView& mesh, const GlbContent& content, const GlbArray& array,
                             bool colors_are_linear) {
    for (std::size_t v = 0; v < mesh.vertex_count; ++v) {
        const std::array<double, 4> shares = glb_shares(mesh, v, content, colors_are_linear);
        for (std::size_t k = 0; k < array.components; ++k) put_share(writer, array.number, shares[k]);
        pad(writer, std::uint64_t{size_of(array.number)} * array.components, '\0');
    }
}

/// Writes a corner.
inline void write_glb_index(Writer& writer, std::uint32_t vertex, GlbNumber number) {
    if (number == GlbNumber::u32) writer.u32(vertex);
    else writer.u16(static_cast<std::uint16_t>(vertex));
}

/// Writes the faces' corners.
inline void write_glb_indices(Writer& writer, const MeshView& mesh, GlbNumber number) {
    for (std::size_t f = 0; f < mesh.face_count; ++f)
        for (const std::uint32_t v : turned(mesh.faces[f])) write_glb_index(writer, v, number);
}

/// Writes an array of this content.
inline void write_glb_array(Writer& writer, const MeshView& mesh, GlbContent content, const GlbArray& array, const GlbGrid& grid,
                            const GltfOptions& options) {
    if (content.kind == GlbContent::Kind::positions) return write_glb_positions(writer, mesh, grid);
    if (content.kind == GlbContent::Kind::indices) return write_glb_indices(writer, mesh, array.number);
    if (options.groups.is_empty()) content.channels = mesh.channels;  // grey with alpha is red, green and blue there
    write_glb_shares(writer, mesh, content, array, options.colors_are_linear);
}

}  // namespace detail

/// Writes a mesh of 1 to 4 channels, or with groups of up to 16, as a .glb file; one without vertices as a scene of nothing. A
/// mesh that has no size, numbers that are not finite, faces without their vertices, or needs 4 GiB, groups that check()
/// refuses, a longer side that is negative or no float, and bits other than 8 and 16 give a Status that says so, and no byte is
/// written; a sink that refuses bytes and a compressor that fails give Errc::write_failed.
inline Status write_glb(const MeshView& source, Sink sink, const GltfOptions& options = {}) {
    detail::GlbMesh out;
    if (const Status status = detail::lay_out_glb(source, options, out); !status) return status;
    if (source.vertex_count == 0) return detail::write_empty_glb(sink);
    const detail::ExportMesh exported(source, detail::wanted_colors(options));
    const MeshView& mesh = exported.view();
    const auto fill = [&](detail::Writer& writer, std::size_t i) {
        detail::write_glb_array(writer, mesh, out.contents[i], out.file.arrays[i], out.grid, options);
    };
    if (options.compress)
        if (const Status status = compress_arrays(out.file, fill, options.compress); !status) return status;
    if (const Status status = count_glb_json(out.file); !status) return status;
    return write_glb_file(out.file, sink, fill);
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_GLTF_HPP
