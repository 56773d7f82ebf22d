/// \file
/// write_html(): a mesh as one web page that draws it, by itself, with WebGL.
///
/// The page needs no network, no library and no server: it works from a file:// address and asks for nothing (its content
/// security policy forbids it to). It draws what a GPU draws of the mesh, Gouraud in the stored (sRGB) values as fitted, at any
/// zoom, colours with alpha premultiplied or straight as the mesh has them. Drag to pan, wheel or pinch to zoom, double click
/// to fit; the keys + - and arrows, 0 to fit, 1 for one pixel to one of the screen, w for the edges, o for the original, p to
/// fold the panels away, as they are at first on a phone, and ? for a list of these. Light or dark as the reader's system is.
/// Opened with `#native` in the address it shows one pixel of the picture to one of the screen, the picture's corner in the
/// window's, and nothing else; with `#original` it shows the original so. Its source is in viewer/.
///
/// The mesh is embedded as base64 of, in this order and little-endian: positions, two floats a vertex in px; faces, three
/// indices each of 16 bits up to 65535 vertices and of 32 bits above; colours, a byte a channel, 255 the mesh's peak. About 31
/// bytes a vertex for RGB, 47 above 65535 vertices, and 22 kB for the page. Cost: about 0.2 us a vertex.
#ifndef HMESH_IO_HTML_HPP
#define HMESH_IO_HTML_HPP

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "hmesh/core/status.hpp"
#include "hmesh/io/detail/base64.hpp"
#include "hmesh/io/detail/export_mesh.hpp"
#include "hmesh/io/detail/html_page.hpp"
#include "hmesh/io/sink.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/mesh/unrolled.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// Options of write_html(). Texts are UTF-8 that ends with a zero, and are shown as they are: their &, <, >, " and ' are escaped.
/// All pointers must be valid until write_html() returns.
struct HtmlOptions {
    const char* title = "Triangle mesh";  ///< the page's title, shown in a corner too
    const char* figures = "";             ///< shown below the title, line by line; folded away on small screens
    const char* notes = "";               ///< shown below the list of keys, line by line: what the figures mean
    /// The original picture to compare with, as the bytes of a file that browsers read; nullptr: the page has no slider.
    const unsigned char* original = nullptr;
    std::size_t original_size = 0;            ///< bytes of `original`
    const char* original_type = "image/png";  ///< its media type: letters, digits and any of / + - .
    /// How the page turns the original to show it: 1, as it is, to 8, as Exif's tag Orientation numbers them. Browsers turn by
    /// that tag themselves, not everywhere alike, so the file should be without it.
    int original_orientation = 1;
};

namespace detail {

/// Whether a text can be the media type of the original.
[[nodiscard]] inline bool is_media_type(const char* text) noexcept {
    if (text == nullptr || *text == 0) return false;
    for (; *text != 0; ++text) {
        const char c = *text;
        const bool is_good = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '/' || c == '+' ||
                             c == '-' || c == '.';
        if (!is_good) return false;
    }
    return true;
}

/// Refuses what a page cannot hold. O(n).
[[nodiscard]] inline Status check_for_html(const MeshView& mesh, const HtmlOptions& options) noexcept {
    constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();
    if (const Status status = check_counts(mesh, most, most, "the mesh has more vertices or faces than a page numbers"); !status)
        return status;
    if (options.title == nullptr || options.figures == nullptr || options.notes == nullptr)
        return {Errc::invalid_argument, "the title, the figures and the notes must be texts"};
    if (options.original != nullptr && !is_media_type(options.original_type))
        return {Errc::invalid_argument, "the original's media type must be such as image/png"};
    if (options.original_orientation < 1 || options.original_orientation > 8)
        return {Errc::invalid_argument, "the original's orientation must be from 1 to 8",
                static_cast<double>(options.original_orientation), options.original_orientation < 1 ? 1.0 : 8.0};
    return check_for_export(mesh);
}

/// Writes a text to stand between tags or in a quoted attribute.
inline void write_escaped(Writer& writer, const char* text) {
    for (; *text != 0; ++text) switch (*text) {
            case '&': writer.text("&amp;"); break;
            case '<': writer.text("&lt;"); break;
            case '>': writer.text("&gt;"); break;
            case '"': writer.text("&quot;"); break;
            case '\'': writer.text("&#39;"); break;
            default: writer.bytes(text, 1);
        }
}

/// Puts positions, faces and colours as they are embedded.
inline void write_mesh_bytes(Writer& out, const MeshView& mesh) {
    for (std::size_t i = 0; i < 2 * mesh.vertex_count; ++i) out.f32(mesh.positions[i]);
    const bool is_short = mesh.vertex_count <= 65535;
    for (std::size_t f = 0; f < mesh.face_count; ++f)
        for (const std::uint32_t v : mesh.faces[f]) {
            if (is_short) out.u16(static_cast<std::uint16_t>(v));
            else out.u32(v);
        }
    const std::size_t samples = static_cast<std::size_t>(mesh.channels) * mesh.vertex_count;
    for (std::size_t i = 0; i < samples; ++i) out.u8(to_u8(share_of_peak(mesh.colors[i], mesh.peak)));
}

/// Writes the mesh as the JSON that viewer/drawing.js reads.
inline void write_html_mesh(Writer& writer, const MeshView& mesh) {
    const std::array<std::int64_t, 5> numbers = {mesh.right(), mesh.bottom(), mesh.channels,
                                                 static_cast<std::int64_t>(mesh.vertex_count),
                                                 static_cast<std::int64_t>(mesh.face_count)};
    static constexpr std::array<const char*, 5> names = {
        "{\"width\":", ",\"height\":", ",\"channels\":", ",\"vertices\":", ",\"faces\":"};
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        writer.text(names[i]);
        writer.decimal(numbers[i]);
    }
    writer.text(mesh.samples == Samples::points ? ",\"points\":true" : ",\"points\":false");
    writer.text(mesh.premultiplied && mesh.channels == 4 ? ",\"premultiplied\":true" : ",\"premultiplied\":false");
    writer.text(",\"data\":\"");
    Base64Sink base64(writer);
    Writer bytes(base64);
    write_mesh_bytes(bytes, mesh);
    static_cast<void>(bytes.finish());  // the sink takes all
    base64.finish();
    writer.text("\"}");
}

/// Writes the picture to compare with, if there is one.
inline void write_html_original(Writer& writer, const HtmlOptions& options) {
    if (options.original == nullptr || options.original_size == 0) return;
    writer.text("<img id=\"original\" alt=\"\" hidden data-turn=\"");
    writer.decimal(options.original_orientation);
    writer.text("\" src=\"data:");
    writer.text(options.original_type);
    writer.text(";base64,");
    Base64Sink base64(writer);
    base64(options.original, options.original_size);
    base64.finish();
    writer.text("\">");
}

}  // namespace detail

/// Writes a mesh of 1 to 4 channels as a web page; colours are held to [0, peak]. A mesh that has no size, numbers that are not
/// finite, faces without their vertices or 2^32 vertices or faces, and options without texts or a media type give a Status that
/// says so, and no byte is written; a sink that refuses bytes gives Errc::write_failed.
inline Status write_html(const MeshView& source, Sink sink, const HtmlOptions& options = {}) {
    if (const Status status = detail::check_for_html(source, options); !status) return status;
    if (source.periodic != Periodic::none) {
        const Mesh whole = kit::unrolled(source);
        return write_html(whole.view(), sink, options);
    }
    const detail::ExportMesh exported(source, detail::Premultiplied::kept);
    detail::Writer writer(sink);
    for (const detail::HtmlPiece& piece : detail::html_page) {
        writer.text(piece.text);
        switch (piece.next) {
            case detail::HtmlField::title: detail::write_escaped(writer, options.title); break;
            case detail::HtmlField::figures: detail::write_escaped(writer, options.figures); break;
            case detail::HtmlField::notes: detail::write_escaped(writer, options.notes); break;
            case detail::HtmlField::original: detail::write_html_original(writer, options); break;
            case detail::HtmlField::mesh: detail::write_html_mesh(writer, exported.view()); break;
            case detail::HtmlField::nothing: break;
        }
    }
    return writer.finish();
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_HTML_HPP
