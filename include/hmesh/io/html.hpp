// hmesh - write_html(): a mesh as one web page that draws it, by itself, with WebGL.
//
// The page needs no network, no library and no server: it works from a file:// address and asks for nothing (its content
// security policy forbids it to). It draws what a GPU draws of the mesh, Gouraud in the stored (sRGB) values as fitted, at
// any zoom, colours with alpha premultiplied or straight as the mesh has them; html_handling.hpp says how it is handled.
// Opened with `#native` in the address it shows one pixel of the picture to one of the screen, the picture's corner in the
// window's, and nothing else.
//
// The mesh is embedded as base64 of, in this order and little-endian: positions, two floats a vertex in px; faces, three
// indices each of 16 bits up to 65535 vertices and of 32 bits above; colours, a byte a channel, 255 the mesh's peak. About
// 31 bytes a vertex for RGB, 47 above 65535 vertices, and 20 kB for the page. Cost: about 0.2 us a vertex.
#ifndef HMESH_IO_HTML_HPP
#define HMESH_IO_HTML_HPP

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "hmesh/core/status.hpp"
#include "hmesh/io/detail/base64.hpp"
#include "hmesh/io/detail/color_shares.hpp"
#include "hmesh/io/detail/html_drawing.hpp"
#include "hmesh/io/detail/html_handling.hpp"
#include "hmesh/io/detail/html_page.hpp"
#include "hmesh/io/sink.hpp"
#include "hmesh/mesh/mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

// Texts are UTF-8 and are shown as they are: their &, <, >, " and ' are escaped.
struct HtmlOptions {
    const char* title = "Triangle mesh";
    const char* figures = "";  // shown in a corner, line by line
    // The original picture, as the bytes of a file that browsers read, to compare with; none: no slider.
    const unsigned char* original = nullptr;
    std::size_t original_size = 0;
    const char* original_type = "image/png";  // its media type: letters, digits and any of / + - .
};

namespace detail {

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

[[nodiscard]] inline Status check_for_html(const MeshView& mesh, const HtmlOptions& options) noexcept {
    constexpr std::int64_t most = 0xffffffff;
    for (const std::size_t count : {mesh.vertex_count, mesh.face_count})
        if (count > static_cast<std::size_t>(most))
            return {Errc::invalid_argument, "the mesh has more vertices or faces than a page numbers",
                    static_cast<std::int64_t>(count), most};
    if (options.title == nullptr || options.figures == nullptr)
        return {Errc::invalid_argument, "the title and the figures must be texts", 0, 0};
    if (options.original != nullptr && !is_media_type(options.original_type))
        return {Errc::invalid_argument, "the original's media type must be such as image/png", 0, 0};
    return check_for_export(mesh);
}

// Text between tags or in a quoted attribute.
template <class Sink>
void write_escaped(Writer<Sink>& writer, const char* text) {
    for (; *text != 0; ++text) switch (*text) {
            case '&': writer.text("&amp;"); break;
            case '<': writer.text("&lt;"); break;
            case '>': writer.text("&gt;"); break;
            case '"': writer.text("&quot;"); break;
            case '\'': writer.text("&#39;"); break;
            default: writer.bytes(text, 1);
        }
}

template <class Sink>
void write_mesh_base64(Writer<Sink>& writer, const MeshView& mesh) {
    Base64Writer<Sink> out(writer);
    for (std::size_t i = 0; i < 2 * mesh.vertex_count; ++i) out.f32(mesh.positions[i]);
    const bool is_short = mesh.vertex_count <= 65535;
    for (std::size_t f = 0; f < mesh.face_count; ++f)
        for (const std::uint32_t v : mesh.faces[f]) {
            if (is_short) out.u16(static_cast<std::uint16_t>(v));
            else out.u32(v);
        }
    const std::size_t samples = static_cast<std::size_t>(mesh.channels) * mesh.vertex_count;
    for (std::size_t i = 0; i < samples; ++i) out.u8(to_u8(share_of_peak(mesh.colors[i], mesh.peak)));
    out.finish();
}

}  // namespace detail

// Writes the page to the sink (see sink.hpp). A mesh or options that cannot be written give a Status and no byte.
template <class Sink>
Status write_html(const MeshView& mesh, Sink&& sink, const HtmlOptions& options = {}) {
    if (const Status status = detail::check_for_html(mesh, options); !status) return status;
    detail::Writer writer(sink);
    writer.text(detail::html_head);
    detail::write_escaped(writer, options.title);
    writer.text(detail::html_style);
    detail::write_escaped(writer, options.title);
    writer.text(detail::html_figures);
    detail::write_escaped(writer, options.figures);
    writer.text(detail::html_controls);
    if (options.original != nullptr && options.original_size > 0) {
        writer.text("<img id=\"original\" alt=\"\" hidden src=\"data:");
        writer.text(options.original_type);
        writer.text(";base64,");
        detail::Base64Writer out(writer);
        for (std::size_t i = 0; i < options.original_size; ++i) out.u8(options.original[i]);
        out.finish();
        writer.text("\">\n");
    }
    writer.text("<script>\n'use strict';\nconst mesh = {");
    const std::array<std::int64_t, 5> numbers = {mesh.width, mesh.height, mesh.channels,
                                                 static_cast<std::int64_t>(mesh.vertex_count),
                                                 static_cast<std::int64_t>(mesh.face_count)};
    static constexpr std::array<const char*, 5> names = {"width: ", ", height: ", ", channels: ", ", vertices: ", ", faces: "};
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        writer.text(names[i]);
        writer.decimal(numbers[i]);
    }
    writer.text(mesh.premultiplied && mesh.channels == 4 ? ", premultiplied: true" : ", premultiplied: false");
    writer.text(", data: '");
    detail::write_mesh_base64(writer, mesh);
    writer.text("'};\n");
    writer.text(detail::html_drawing);
    writer.text(detail::html_handling);
    return writer.finish();
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_HTML_HPP
