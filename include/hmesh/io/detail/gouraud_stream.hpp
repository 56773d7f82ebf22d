/// \file
/// A mesh as a free-form Gouraud shading (type 4), the stream of bytes that PDF and PostScript level 3 share.
///
/// ISO 32000-1, 8.7.4.5.5: for each vertex an edge flag (see strips.hpp), x, y and the colour components, most significant byte
/// first. Colours are interpolated in the shading's colour space: in DeviceRGB that is what hmesh fits.
///
/// Coordinates count 1/256 px, the grid of hmesh's meshes: the range that /Decode maps to is whole pixels plus
/// (2^bits - 1) / 256, so that every position of the grid arrives exactly; in 24 bits up to 65535 px, in 16 below 256 px and in
/// 32 beyond. 16 bits for all would save a tenth of the deflated size, but move the vertices of a 512 px image by up to
/// 1/128 px, which turns over thin faces. Components have 8 bits where the mesh's peak is 255, else 16.
#ifndef HMESH_IO_DETAIL_GOURAUD_STREAM_HPP
#define HMESH_IO_DETAIL_GOURAUD_STREAM_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "hmesh/core/array.hpp"
#include "hmesh/core/finite.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/io/detail/export_mesh.hpp"
#include "hmesh/io/detail/strips.hpp"
#include "hmesh/io/page_options.hpp"
#include "hmesh/io/sink.hpp"
#include "hmesh/mesh/mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

/// How a vertex is stored, y up.
struct ShadingLayout {
    int coordinate_bytes = 0;        ///< of x and of y: 2, 3 or 4
    int component_bytes = 0;         ///< of a colour component: 1 or 2
    std::int64_t left = 0, low = 0;  ///< px: the whole numbers for which 0 stands, of x and of y

    /// Bytes from a vertex to the next, with so many colour components.
    [[nodiscard]] std::size_t vertex_bytes(int components) const noexcept {
        return static_cast<std::size_t>(1 + 2 * coordinate_bytes + components * component_bytes);
    }
    /// Px from the number 0 to the largest; exact.
    [[nodiscard]] double extent() const noexcept {
        return static_cast<double>((std::uint64_t{1} << (8 * coordinate_bytes)) - 1) / 256;
    }
};

/// Refuses what a shading cannot hold, and fills the layout of what it can. O(n).
[[nodiscard]] inline Status plan_shading(const MeshView& mesh, ShadingLayout& layout) noexcept {
    // The longest stream, 3 vertices a face of 1 + 8 + 6 bytes, keeps its length below 2^31 (ISO 32000-1, annex C).
    constexpr std::uint64_t most = ((std::uint64_t{1} << 31U) - 1) / 45, any = std::numeric_limits<std::uint64_t>::max();
    if (const Status status = check_counts(mesh, any, most, "the mesh has more faces than a shading holds"); !status)
        return status;
    constexpr int farthest = 4194304;  // px: numbers of 32 bits count 1/256 px up to 2^24 px
    for (const int side : {mesh.width, mesh.height})
        if (side > farthest)
            return {Errc::invalid_argument, "the mesh's width or height is more than a shading holds", side, farthest};
    if (const Status status = check_for_export(mesh); !status) return status;

    double left = 0, low = 0, right = mesh.right(), high = mesh.bottom();
    for (std::size_t v = 0; v < mesh.vertex_count; ++v) {
        const double x = static_cast<double>(mesh.positions[2 * v]), y = y_up(mesh, v);
        if (!kit::is_within(x, -farthest, farthest) || !kit::is_within(y, -farthest, farthest))
            return {Errc::invalid_argument, "the mesh has a position far outside its image, at vertex",
                    static_cast<std::int64_t>(v), 0};
        left = std::min(left, x), right = std::max(right, x);
        low = std::min(low, y), high = std::max(high, y);
    }
    layout.left = static_cast<std::int64_t>(std::floor(left));
    layout.low = static_cast<std::int64_t>(std::floor(low));
    const double side = std::max(right - static_cast<double>(layout.left), high - static_cast<double>(layout.low));
    layout.coordinate_bytes = 2;
    while (layout.extent() < side) ++layout.coordinate_bytes;
    layout.component_bytes = mesh.peak == 255 ? 1 : 2;
    return {};
}

/// The colours of a shading as its dictionary gives them.
struct ShadingColors {
    int components = 3;  ///< 1 is grey, 3 are red, green and blue
    int factor = 1;      ///< what the colours are divided by where they are stored: a power of two up to 16
    int function = 0;    ///< unless the factor is 1: the number of the object that multiplies by it, in PDF
};

/// Writes the entries of the shading's dictionary that describe its stream, in the syntax of PDF and, for factor 1, PostScript.
inline void write_shading_entries(Writer& writer, const ShadingLayout& layout, const ShadingColors& colors) {
    const bool is_gray = colors.components == 1;
    const char* const space = is_gray ? "/DeviceGray" : "/DeviceRGB";
    writer.text("/ShadingType 4 /ColorSpace ");
    if (colors.factor == 1) {
        writer.text(space);
    } else {
        writer.text(is_gray ? "[/DeviceN [/Gray] " : "[/DeviceN [/Red /Green /Blue] ");
        writer.text(space);
        writer.text(" ");
        writer.decimal(colors.function);
        writer.text(" 0 R]");
    }
    writer.text("\n/BitsPerCoordinate ");
    writer.decimal(std::int64_t{8} * layout.coordinate_bytes);
    writer.text(" /BitsPerComponent ");
    writer.decimal(std::int64_t{8} * layout.component_bytes);
    writer.text(" /BitsPerFlag 8\n/Decode [");
    for (const std::int64_t from : {layout.left, layout.low}) {
        writer.decimal(from);
        writer.text(" ");
        writer.fixed(static_cast<double>(from) + layout.extent(), 8);
        writer.text(" ");
    }
    for (int k = 0; k < colors.components; ++k) {
        writer.text(k == 0 ? "0 " : " 0 ");
        writer.fixed(1.0 / colors.factor, 4);
    }
    writer.text("]");
}

/// The bytes of the stream. Component k of vertex v as a share of full intensity is shares[components * v + k]; it is held to
/// [0, 1]. View and layout come by value, since a byte that is written might be any other object's: a fifth of the time.
[[nodiscard]] inline std::vector<unsigned char> shading_bytes(MeshView mesh, const kit::Array<StripVertex>& vertices,
                                                              ShadingLayout layout, int components,
                                                              const kit::Array<double>& shares) {
    std::vector<unsigned char> out(vertices.size() * layout.vertex_bytes(components));
    unsigned char* to = out.data();
    const auto put = [&to](double number, int bytes) {
        const auto bits = static_cast<std::uint32_t>(number + 0.5);
        for (int i = bytes; i-- > 0;) *to++ = static_cast<unsigned char>((bits >> (8 * i)) & 0xffU);
    };
    const double full = layout.component_bytes == 1 ? 255 : 65535;
    const auto count = static_cast<std::size_t>(components);
    const double* const from = shares.data();
    for (const StripVertex s : vertices) {
        const std::size_t v = s.vertex;
        *to++ = s.flag;
        put((static_cast<double>(mesh.positions[2 * v]) - static_cast<double>(layout.left)) * 256, layout.coordinate_bytes);
        put((y_up(mesh, v) - static_cast<double>(layout.low)) * 256, layout.coordinate_bytes);
        for (std::size_t k = 0; k < count; ++k)
            put(std::max(0.0, std::min(1.0, from[count * v + k])) * full, layout.component_bytes);
    }
    return out;
}

/// Replaces the bytes by their zlib stream, where there is a compressor. Errc::write_failed where it fails.
[[nodiscard]] inline Status compress(PageOptions::Deflate deflate, std::vector<unsigned char>& bytes) {
    if (!deflate) return {};
    std::vector<unsigned char> out;
    if (!deflate(bytes.data(), bytes.size(), out) || out.empty())
        return {Errc::write_failed, "the compressor failed, before the first byte was written"};
    bytes.swap(out);
    return {};
}

}  // namespace hmesh::detail

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_DETAIL_GOURAUD_STREAM_HPP
