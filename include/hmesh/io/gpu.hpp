/// \file
/// pack_for_gpu(): a mesh as the two buffers that a program hands to OpenGL, Vulkan, Direct3D 12, Metal or WebGPU.
///
/// A vertex is position and colour, interleaved, and GpuLayout says where and in which format: 8 bytes by default, 20 with the
/// indices of a list, 14.4 with those of strips, where a .glb takes 32. Faces come in an order that is good for the vertex cache,
/// vertices in the order in which they are read. Indices of 16 bits reach every vertex from their chunk's base vertex; chunks
/// share one vertex buffer and one rounding, so that no crack is between them. Nothing is decoded: colours are the stored values,
/// so that a GPU that takes them for plain numbers draws what render() draws.
///
/// docs/textures.md shows how each API is told of the layout. Cost: O(n), 0.2 to 0.3 us and 90 to 110 bytes a face.
#ifndef HMESH_IO_GPU_HPP
#define HMESH_IO_GPU_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "hmesh/core/srgb.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/io/detail/export_mesh.hpp"
#include "hmesh/io/gpu/cached_strips.hpp"
#include "hmesh/io/gpu/chunks.hpp"
#include "hmesh/io/gpu/vertex_cache.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/mesh/periodic.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// The format of a vertex attribute, by the names of WebGPU. A unorm of n bits is an integer that stands for its share of
/// 2^n - 1, in [0, 1]; all are little-endian.
enum class GpuFormat : std::uint8_t {
    float32x2,  ///< 8 bytes: VK_FORMAT_R32G32_SFLOAT, DXGI_FORMAT_R32G32_FLOAT
    unorm16x2,  ///< 4 bytes: VK_FORMAT_R16G16_UNORM, DXGI_FORMAT_R16G16_UNORM
    unorm16x4,  ///< 8 bytes: VK_FORMAT_R16G16B16A16_UNORM, DXGI_FORMAT_R16G16B16A16_UNORM
    unorm8x2,   ///< 2 bytes: VK_FORMAT_R8G8_UNORM, DXGI_FORMAT_R8G8_UNORM
    unorm8x4,   ///< 4 bytes: VK_FORMAT_R8G8B8A8_UNORM, DXGI_FORMAT_R8G8B8A8_UNORM
};

/// The format of an index.
enum class GpuIndexFormat : std::uint8_t {
    uint16,  ///< 2 bytes: VK_INDEX_TYPE_UINT16, DXGI_FORMAT_R16_UINT
    uint32,  ///< 4 bytes: VK_INDEX_TYPE_UINT32, DXGI_FORMAT_R32_UINT
};

/// How indices make faces.
enum class GpuTopology : std::uint8_t {
    triangle_list,   ///< three a face
    triangle_strip,  ///< one a face where it goes on, with restarts; every other face is turned, as all APIs have it
};

/// What becomes of colours that have alpha.
enum class GpuAlpha : std::uint8_t {
    as_stored,      ///< they are as in the mesh, and GpuLayout::premultiplied says how that is
    straight,       ///< those of premultiplied meshes are divided by alpha, as for the file formats
    premultiplied,  ///< straight ones are multiplied by alpha, at the vertices: between them the picture is another one
};

/// Options of pack_for_gpu().
struct GpuOptions {
    /// float32x2: px as in the mesh. unorm16x2: shares of the box of GpuLayout, half of the bytes; off by at most 1/131070 of its
    /// sides, 0.004 px of 512. Faces much thinner than that may turn over.
    GpuFormat position = GpuFormat::unorm16x2;
    /// unorm8x4 or unorm16x4: red, green, blue and alpha; grey is three times the same, and alpha 1 where there is none. unorm8x2
    /// or unorm16x2: grey and alpha, of meshes of 1 or 2 channels only. Colours are held to [0, peak].
    GpuFormat color = GpuFormat::unorm8x4;
    /// What becomes of colours that have alpha.
    GpuAlpha alpha = GpuAlpha::as_stored;
    /// Strips take half of the bytes of a list, and a little longer in the vertex cache.
    GpuTopology topology = GpuTopology::triangle_list;
    /// uint32 needs no chunks, and takes 12 bytes a vertex more as a list.
    GpuIndexFormat index = GpuIndexFormat::uint16;
    /// The most vertices that a chunk draws: 3 to 65,535, or to 2^31 with uint32. 0: as many.
    std::uint32_t chunk_vertices = 0;
};

/// An attribute of a vertex.
struct GpuAttribute {
    GpuFormat format = GpuFormat::float32x2;  ///< how it is stored
    std::uint32_t offset = 0;                 ///< bytes from the beginning of the vertex, a multiple of the size of its numbers
};

/// What an API has to know of the buffers. A position in px is `offset` + `scale` times the attribute, in the plane of the mesh:
/// x from 0 to `width`, y down from 0 to `height`. Faces are clockwise on the screen.
struct GpuLayout {
    std::uint32_t stride = 0;                           ///< bytes from one vertex to the next, a multiple of 4
    GpuAttribute position;                              ///< float32x2 or unorm16x2
    GpuAttribute color;                                 ///< a unorm of 2 or 4
    GpuIndexFormat index = GpuIndexFormat::uint16;      ///< of all indices
    GpuTopology topology = GpuTopology::triangle_list;  ///< of all chunks
    std::uint32_t restart = 0xffff;                     ///< ends a strip: 0xffff or 0xffffffff; in no list
    /// px: sides of the box of unorm16x2, which is the image's unless vertices lie beyond it; 1 for float32x2. Along the axes of
    /// a periodic mesh the image's side is a whole number of steps of 1 / 65535 of it, so that copies of the buffers join.
    std::array<float, 2> scale{1, 1};
    std::array<float, 2> offset{0, 0};  ///< px: the corner of the box; 0 for float32x2
    int width = 0,                      ///< px of the image's rectangle: MeshView::right()
        height = 0;                     ///< px of the image's rectangle: MeshView::bottom()
    bool has_alpha = false;             ///< whether some of the colours may be transparent
    bool premultiplied = false;         ///< whether colours are multiplied by alpha
};

/// A draw call: `index_count` indices from `first_index` on, to which the API adds `first_vertex` (base vertex, vertex offset).
struct GpuChunk {
    std::uint32_t first_index = 0,  ///< counted in indices
        index_count = 0,            ///< restarts among them
        first_vertex = 0,           ///< of its window of the vertex buffer
        vertex_count = 0;           ///< of its window: all indices are below, but for restarts
};

/// What pack_for_gpu() returns, or why there is nothing.
struct [[nodiscard]] GpuBuffers {
    std::vector<std::uint8_t> vertices;  ///< vertex buffer: a multiple of the stride
    std::vector<std::uint8_t> indices;   ///< index buffer: filled up to a multiple of 4 bytes
    std::vector<GpuChunk> chunks;        ///< draw calls, in any order
    GpuLayout layout;                    ///< what they hold
    Status status;                       ///< ok, or why there are no buffers

    /// The number of vertices in the buffer.
    [[nodiscard]] std::size_t vertex_count() const noexcept { return layout.stride == 0 ? 0 : vertices.size() / layout.stride; }
};

/// The bytes of an attribute.
[[nodiscard]] constexpr std::uint32_t size_of(GpuFormat format) noexcept {
    switch (format) {
        case GpuFormat::unorm8x2: return 2;
        case GpuFormat::unorm8x4:
        case GpuFormat::unorm16x2: return 4;
        case GpuFormat::unorm16x4:
        case GpuFormat::float32x2: break;
    }
    return 8;
}
/// The numbers of an attribute, 2 or 4.
[[nodiscard]] constexpr std::uint32_t components_of(GpuFormat format) noexcept {
    return format == GpuFormat::unorm8x4 || format == GpuFormat::unorm16x4 ? 4 : 2;
}
/// The bytes of an index.
[[nodiscard]] constexpr std::uint32_t size_of(GpuIndexFormat format) noexcept { return format == GpuIndexFormat::uint16 ? 2 : 4; }

namespace detail {

/// Refuses what buffers cannot hold, and options that are none. O(n).
[[nodiscard]] inline Status check_for_gpu(const MeshView& mesh, const GpuOptions& options) noexcept {
    constexpr std::uint64_t most_vertices = std::uint64_t{1} << 31U, most_faces = std::uint64_t{1} << 30U;
    if (const Status status =
            check_counts(mesh, most_vertices, most_faces, "the mesh has more vertices or faces than buffers number");
        !status)
        return status;
    if (const Status status = check_for_export(mesh); !status) return status;
    const auto bad = [](const char* what, auto value, auto limit) {
        return Status(Errc::invalid_argument, what, static_cast<double>(value), static_cast<double>(limit));
    };
    if (options.position != GpuFormat::float32x2 && options.position != GpuFormat::unorm16x2)
        return bad("the positions' format must be float32x2 or unorm16x2", options.position, 1);
    if (options.color <= GpuFormat::float32x2 || options.color > GpuFormat::unorm8x4)
        return bad("the colours' format must be a unorm of 8 or 16 bits", options.color, 4);
    if (components_of(options.color) == 2 && mesh.channels > 2)
        return bad("a format of two numbers holds grey and alpha, and the mesh has more channels", mesh.channels, 2);
    if (options.alpha > GpuAlpha::premultiplied) return bad("the kind of alpha is none of those known", options.alpha, 2);
    if (options.topology > GpuTopology::triangle_strip) return bad("the topology is none of those known", options.topology, 1);
    if (options.index > GpuIndexFormat::uint32) return bad("the indices' format is none of those known", options.index, 1);
    const std::uint64_t most = options.index == GpuIndexFormat::uint16 ? 65535 : most_vertices;
    if (options.chunk_vertices != 0 && options.chunk_vertices < 3)
        return bad("a chunk must have at least 3 vertices", options.chunk_vertices, 3);
    if (options.chunk_vertices > most)
        return bad("a chunk must not have more vertices than its indices number", options.chunk_vertices, most);
    return {};
}

/// The least and the largest coordinate of a mesh along an axis, or the side of its image where that is beyond. O(n).
[[nodiscard]] inline std::array<double, 2> ends_for_gpu(const MeshView& mesh, std::size_t axis) noexcept {
    std::array<double, 2> ends{0, static_cast<double>(axis == 0 ? mesh.right() : mesh.bottom())};
    for (std::size_t v = 0; v < mesh.vertex_count; ++v) {
        const auto at = static_cast<double>(mesh.positions[2 * v + axis]);
        ends[0] = std::min(ends[0], at), ends[1] = std::max(ends[1], at);
    }
    return ends;
}

/// How many steps of 1 / 65535 of the box are a period, where a periodic mesh stands out of its image along an axis in which it
/// repeats, with these ends there. 0: it does not, or is so long that a period would be less than a step.
[[nodiscard]] inline double steps_of_period(const MeshView& mesh, std::size_t axis, const std::array<double, 2>& ends) noexcept {
    const double size = axis == 0 ? mesh.width : mesh.height;
    const bool wraps = axis == 0 ? kit::wraps_x(mesh.periodic) : kit::wraps_y(mesh.periodic);
    return wraps && (ends[0] < 0 || ends[1] > size) ? std::floor(65534 * size / (ends[1] - ends[0])) : 0;
}

/// Where all lies in a vertex, and the box of the positions. O(n).
[[nodiscard]] inline GpuLayout lay_out_for_gpu(const MeshView& mesh, const GpuOptions& options) noexcept {
    GpuLayout layout;
    layout.position = {options.position, 0};
    layout.color = {options.color, size_of(options.position)};
    layout.stride = (layout.color.offset + size_of(options.color) + 3) / 4 * 4;
    layout.index = options.index;
    layout.topology = options.topology;
    layout.restart = options.index == GpuIndexFormat::uint16 ? 0xffffU : 0xffffffffU;
    layout.width = mesh.right(), layout.height = mesh.bottom();
    layout.has_alpha = kit::has_alpha(mesh.channels);
    layout.premultiplied = layout.has_alpha &&
                           (options.alpha == GpuAlpha::as_stored ? mesh.premultiplied : options.alpha == GpuAlpha::premultiplied);
    if (options.position == GpuFormat::float32x2) return layout;
    for (std::size_t axis = 0; axis < 2; ++axis) {
        auto [low, high] = ends_for_gpu(mesh, axis);
        if (const double steps = steps_of_period(mesh, axis, {low, high}); steps > 0) {
            // The period is a whole number of steps, so that copies of a vertex are rounded alike.
            const double step = (axis == 0 ? mesh.width : mesh.height) / steps;
            low = -std::ceil(-low / step) * step;
            high = low + 65535 * step;
        }
        // As the floats that the shader has, so that it finds the same places.
        constexpr auto largest = static_cast<double>(std::numeric_limits<float>::max());
        layout.offset[axis] = static_cast<float>(low);
        layout.scale[axis] = static_cast<float>(std::min(largest, high - static_cast<double>(layout.offset[axis])));
    }
    return layout;
}

/// Puts little-endian numbers into a buffer.
class GpuWriter {
  public:
    /// From this byte on.
    explicit GpuWriter(std::uint8_t* at) noexcept : at_(at) {}
    /// Puts the lower `size` bytes of a number.
    void integer(std::uint32_t value, std::uint32_t size) noexcept {
        for (std::uint32_t i = 0; i < size; ++i) *at_++ = static_cast<std::uint8_t>((value >> (8 * i)) & 0xffU);
    }
    /// Puts a number as IEEE 754 binary32.
    void f32(float value) noexcept {
        std::uint32_t bits = 0;
        std::memcpy(&bits, &value, 4);
        integer(bits, 4);
    }

  private:
    std::uint8_t* at_;
};

/// The vertex buffer: of the vertices `sources` of a mesh that ExportMesh has made ready.
[[nodiscard]] inline std::vector<std::uint8_t> gpu_vertices(const MeshView& mesh, const std::vector<std::uint32_t>& sources,
                                                            const GpuLayout& layout) {
    std::vector<std::uint8_t> bytes(sources.size() * layout.stride, 0);
    const bool multiplies = layout.premultiplied && !mesh.premultiplied;
    const bool is_wide = layout.color.format == GpuFormat::unorm16x2 || layout.color.format == GpuFormat::unorm16x4;
    std::array<double, 2> steps{};
    for (std::size_t axis = 0; axis < 2 && layout.position.format == GpuFormat::unorm16x2; ++axis)
        steps[axis] = steps_of_period(mesh, axis, ends_for_gpu(mesh, axis));
    for (std::size_t i = 0; i < sources.size(); ++i) {
        const std::uint32_t v = sources[i];
        GpuWriter writer(bytes.data() + i * layout.stride);
        for (std::size_t axis = 0; axis < 2; ++axis) {
            const float at = mesh.positions[2 * std::size_t{v} + axis];
            if (layout.position.format == GpuFormat::float32x2) writer.f32(at);
            else {
                const auto low = static_cast<double>(layout.offset[axis]);
                double from = static_cast<double>(at) - low;
                if (steps[axis] > 0) {
                    // Rounded within the first period, then turned in whole steps.
                    const double size = axis == 0 ? layout.width : layout.height, step = size / steps[axis];
                    const double turns = std::floor(static_cast<double>(at) / size);
                    const auto rounded = [&](double x) { return std::floor(x / step + 0.5); };
                    from = (rounded(-low) + turns * steps[axis] + rounded(static_cast<double>(at) - turns * size)) / 65535 *
                           static_cast<double>(layout.scale[axis]);
                }
                writer.integer(to_u16(std::max(0.0, std::min(1.0, from / static_cast<double>(layout.scale[axis])))), 2);
            }
        }
        std::array<double, 4> rgba = rgba_shares(mesh, v);
        for (std::size_t k = 0; k < 3 && multiplies; ++k) rgba[k] *= rgba[3];
        if (components_of(layout.color.format) == 2) rgba[1] = rgba[3];
        for (std::size_t k = 0; k < components_of(layout.color.format); ++k)
            writer.integer(is_wide ? to_u16(rgba[k]) : to_u8(rgba[k]), is_wide ? 2 : 1);
    }
    return bytes;
}

/// The faces whose corners are three.
[[nodiscard]] inline std::vector<Triangle> faces_of_three_corners(const MeshView& mesh) {
    std::vector<Triangle> faces;
    faces.reserve(mesh.face_count);
    for (std::size_t f = 0; f < mesh.face_count; ++f)
        if (const Triangle& face = mesh.faces[f]; face[0] != face[1] && face[1] != face[2] && face[2] != face[0])
            faces.push_back(face);
    return faces;
}

/// The vertices of the mesh that a slab draws, in this order, with kit::no_index for restarts.
[[nodiscard]] inline std::vector<std::uint32_t> gpu_indices(const kit::Slab& slab, GpuTopology topology) {
    std::vector<std::uint32_t> indices;
    if (topology == GpuTopology::triangle_strip) {
        indices = kit::vertex_cache_strips(slab.faces, slab.vertices.size());
    } else {
        indices.reserve(3 * slab.faces.size());
        for (const std::uint32_t f : kit::vertex_cache_order(slab.faces, slab.vertices.size()))
            indices.insert(indices.end(), slab.faces[f].begin(), slab.faces[f].end());
    }
    for (std::uint32_t& v : indices)
        if (v != kit::no_index) v = slab.vertices[v];
    return indices;
}

}  // namespace detail

/// Packs a mesh of 1 to 4 channels into a vertex and an index buffer. Every face of three different corners is drawn once, with
/// its orientation, in an order of its own; other faces and vertices that no face uses are left out. The same mesh gives the same
/// bytes, whatever the byte order of the machine.
///
/// A mesh without vertices gives buffers of no bytes and no chunks. One that has no size, more than 4 channels, numbers that are
/// not finite, faces without their vertices or none of three different corners, over 2^31 vertices or 2^30 faces, and options out
/// of range give a Status that says so and no buffers.
[[nodiscard]] inline GpuBuffers pack_for_gpu(const MeshView& source, const GpuOptions& options = {}) {
    GpuBuffers buffers;
    buffers.status = detail::check_for_gpu(source, options);
    if (!buffers.status) return buffers;
    if (source.face_count == 0) {
        buffers.layout = detail::lay_out_for_gpu(source, options);
        return buffers;
    }
    const std::vector<Triangle> faces = detail::faces_of_three_corners(source);
    if (faces.empty()) {
        buffers.status = {Errc::invalid_argument, "the mesh has no face of three different corners", 0, 1};
        return buffers;
    }
    const auto wanted = options.alpha == GpuAlpha::straight ? detail::Premultiplied::divided : detail::Premultiplied::kept;
    const detail::ExportMesh exported(source, wanted);
    const MeshView& mesh = exported.view();
    GpuLayout& layout = buffers.layout;
    layout = detail::lay_out_for_gpu(source, options);

    const std::size_t most = options.chunk_vertices != 0               ? options.chunk_vertices
                             : options.index == GpuIndexFormat::uint16 ? 65535
                                                                       : mesh.vertex_count;
    const std::vector<kit::Slab> slabs = kit::cut_into_slabs(mesh, faces, std::max<std::size_t>(3, most));
    kit::ChunkWindows windows(mesh.vertex_count);
    const std::uint32_t index_size = size_of(options.index);
    // 3 a face of a list, 1.6 of strips.
    buffers.indices.reserve(index_size * faces.size() * (options.topology == GpuTopology::triangle_list ? 3 : 2) + 4);
    for (std::size_t i = 0; i < slabs.size(); ++i) {
        std::vector<std::uint32_t> indices = detail::gpu_indices(slabs[i], options.topology);
        windows.add(indices, i + 1 < slabs.size() ? slabs[i + 1].vertices : std::vector<std::uint32_t>{});
        GpuChunk chunk;
        chunk.first_index = static_cast<std::uint32_t>(buffers.indices.size() / index_size);
        chunk.index_count = static_cast<std::uint32_t>(indices.size());
        chunk.first_vertex = static_cast<std::uint32_t>(windows.first());
        chunk.vertex_count = static_cast<std::uint32_t>(windows.sources().size() - windows.first());
        buffers.chunks.push_back(chunk);
        const std::size_t used = buffers.indices.size();
        buffers.indices.resize(used + index_size * indices.size());
        detail::GpuWriter writer(buffers.indices.data() + used);
        // Of no_index, all bits set, either size keeps the restart.
        for (const std::uint32_t index : indices) writer.integer(index, index_size);
    }
    buffers.indices.resize((buffers.indices.size() + 3) / 4 * 4);
    buffers.vertices = detail::gpu_vertices(mesh, windows.sources(), layout);
    return buffers;
}

/// Cuts a mesh of 1 to 16 channels into parts of at most `most_vertices`, at least 3, each a mesh of the same image: slabs across
/// its longer side, which repeat the vertices that they share. A mesh that has no more is the one part, as it is; of a larger one
/// faces with a corner twice, and vertices of no face, are left out. A mesh that check() refuses, and one that has to be cut and
/// has no face of three different corners, gives a Status and no parts. O(n).
[[nodiscard]] inline Status cut_for_gpu(const MeshView& mesh, std::vector<Mesh>& parts, std::size_t most_vertices = 65535) {
    parts.clear();
    if (const Status status = check(mesh, 16); !status) return status;
    std::vector<kit::Slab> slabs(1);
    if (mesh.vertex_count > most_vertices) {
        const std::vector<Triangle> faces = detail::faces_of_three_corners(mesh);
        if (faces.empty()) return {Errc::invalid_argument, "the mesh has no face of three different corners", 0, 1};
        slabs = kit::cut_into_slabs(mesh, faces, std::max<std::size_t>(3, most_vertices));
    } else {
        for (std::uint32_t v = 0; v < mesh.vertex_count; ++v) slabs.front().vertices.push_back(v);
        slabs.front().faces.assign(mesh.faces, mesh.faces + mesh.face_count);
    }
    const auto channels = static_cast<std::size_t>(mesh.channels);
    for (kit::Slab& slab : slabs) {
        Mesh& part = parts.emplace_back();
        part.channels = mesh.channels, part.width = mesh.width, part.height = mesh.height;
        part.peak = mesh.peak, part.premultiplied = mesh.premultiplied, part.periodic = mesh.periodic;
        part.samples = mesh.samples;
        for (const std::uint32_t v : slab.vertices) {
            const float *const at = mesh.positions + 2 * std::size_t{v}, *const color = mesh.colors + channels * v;
            part.positions.insert(part.positions.end(), at, at + 2);
            part.colors.insert(part.colors.end(), color, color + channels);
        }
        part.faces.swap(slab.faces);
    }
    return {};
}

/// Puts the faces of a mesh of 1 to 16 channels into an order that is good for the vertex cache, and its vertices into that in
/// which files name them, for formats that keep both orders, as write_glb() does; they compress better so. Faces keep the order
/// of their corners. Those with a corner twice, and vertices of no face, are removed. A mesh that check() refuses, or that has
/// no face of three different corners, or more than 2^30, gives a Status and stays as it is. O(n), some 0.2 us a face.
[[nodiscard]] inline Status order_for_gpu(Mesh& mesh) {
    constexpr std::uint64_t most_vertices = std::uint64_t{1} << 31U, most_faces = std::uint64_t{1} << 30U;
    const MeshView view = mesh.view();
    if (const Status status =
            detail::check_counts(view, most_vertices, most_faces, "the mesh has more vertices or faces than can be ordered");
        !status)
        return status;
    if (const Status status = check(mesh, 16); !status) return status;
    const std::vector<Triangle> faces = detail::faces_of_three_corners(view);
    if (faces.empty()) return {Errc::invalid_argument, "the mesh has no face of three different corners", 0, 1};
    const auto channels = static_cast<std::size_t>(mesh.channels);
    std::vector<std::uint32_t> places(mesh.vertex_count(), kit::no_index);
    std::vector<Triangle> ordered;
    std::vector<float> positions, colors;
    ordered.reserve(faces.size());
    positions.reserve(mesh.positions.size());
    colors.reserve(mesh.colors.size());
    for (const std::uint32_t f : kit::vertex_cache_order(faces, mesh.vertex_count())) {
        Triangle face = faces[f];
        for (const std::size_t corner : {0U, 2U, 1U}) {  // as exporters turn it, for y up
            std::uint32_t& v = face[corner];
            std::uint32_t& place = places[v];
            if (place == kit::no_index) {
                place = static_cast<std::uint32_t>(positions.size() / 2);
                const std::size_t at = v;
                positions.insert(positions.end(), {mesh.positions[2 * at], mesh.positions[2 * at + 1]});
                const float* const color = mesh.colors.data() + channels * at;
                colors.insert(colors.end(), color, color + channels);
            }
            v = place;
        }
        ordered.push_back(face);
    }
    mesh.positions.swap(positions);
    mesh.colors.swap(colors);
    mesh.faces.swap(ordered);
    return {};
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_GPU_HPP
