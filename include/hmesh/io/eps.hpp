/// \file
/// write_eps(): a mesh as encapsulated PostScript, language level 3.
///
/// The shading that write_pdf() draws, in ASCII: of the image's size, 1 px = 1/72 inch. PostScript has no opacity: where there
/// is alpha, the colours of the vertices, straight or premultiplied, are laid over white paper, and the white is part of the
/// picture. The same mesh gives the same bytes.
///
/// Size of an RGB mesh of 256 px or more: 26 bytes a vertex, deflated 15; without strips 74 and 20. Time and memory as PDF's.
/// Source: Adobe, PostScript Language Reference, third edition, 3.13.3 and 4.9.3.
#ifndef HMESH_IO_EPS_HPP
#define HMESH_IO_EPS_HPP

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/core/array.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/core/version.hpp"
#include "hmesh/io/detail/export_mesh.hpp"
#include "hmesh/io/detail/gouraud_stream.hpp"
#include "hmesh/io/detail/strips.hpp"
#include "hmesh/io/page_options.hpp"
#include "hmesh/io/sink.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/mesh/unrolled.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

namespace detail {

/// Writes bytes as lines of at most 101 characters that ASCII85Decode reads, its end mark included.
inline void write_ascii85(Writer& writer, const std::vector<unsigned char>& bytes) {
    std::array<char, 102> line{};
    std::size_t used = 0;
    const auto end_line = [&] {
        if (used == 0) return;
        line[used++] = '\n';
        writer.bytes(line.data(), used);
        used = 0;
    };
    for (std::size_t i = 0; i < bytes.size(); i += 4) {
        const std::size_t count = std::min<std::size_t>(4, bytes.size() - i);
        std::uint32_t word = 0;
        for (std::size_t k = 0; k < 4; ++k) word = word << 8U | (k < count ? std::uint32_t{bytes[i + k]} : 0U);
        if (used >= 96) end_line();
        std::array<char, 5> digits{};
        for (std::size_t k = 5; k-- > 0; word /= 85) digits[k] = static_cast<char>('!' + word % 85);
        // Four zeros are one letter; fewer than four bytes, one digit more than bytes. A line that began with % could be
        // taken for a comment of the document's structure.
        if (used == 0 && digits[0] == '%') line[used++] = ' ';
        if (count == 4 && digits == std::array<char, 5>{'!', '!', '!', '!', '!'}) line[used++] = 'z';
        else
            for (std::size_t k = 0; k <= count; ++k) line[used++] = digits[k];
    }
    end_line();
    writer.text("~>\n");
}

}  // namespace detail

/// Writes a mesh of 1 to 4 channels as an EPS file; colours are held to [0, peak]. What write_pdf() refuses is refused here: a
/// Status says so, and no byte is written. A sink that refuses bytes gives Errc::write_failed.
inline Status write_eps(const MeshView& source, Sink sink, const PageOptions& options = {}) {
    detail::ShadingLayout layout;
    if (const Status status = detail::plan_shading(source, layout); !status) return status;
    if (source.periodic != Periodic::none) {
        const Mesh whole = kit::unrolled(source);
        return write_eps(whole.view(), sink, options);
    }
    const detail::ExportMesh exported(source, detail::Premultiplied::kept);
    const MeshView& mesh = exported.view();
    const auto channels = static_cast<std::size_t>(mesh.channels);
    const int components = mesh.channels == 1 ? 1 : 3;

    const auto share = [&](std::size_t v, std::size_t k) {
        return detail::share_of_peak(mesh.colors[channels * v + k], mesh.peak);
    };
    const auto on_paper = [&](std::size_t v, std::size_t k) {
        const double color = share(v, k);
        if (channels != 4) return color;
        return mesh.premultiplied ? 1 - share(v, 3) + color : 1 - share(v, 3) * (1 - color);
    };
    kit::Array<double> shares;
    shares.reserve(static_cast<std::size_t>(components) * mesh.vertex_count);
    for (std::size_t v = 0; v < mesh.vertex_count; ++v)
        for (std::size_t k = 0; k < static_cast<std::size_t>(components); ++k) shares.push_back(on_paper(v, k));
    std::vector<unsigned char> bytes;
    const bool is_empty = mesh.face_count == 0;  // nothing is drawn then: a shading has at least one face
    if (!is_empty) bytes = detail::shading_bytes(mesh, detail::strip_vertices(mesh, options.strips), layout, components, shares);
    if (const Status status = is_empty ? Status() : detail::compress(options.deflate, bytes); !status) return status;

    detail::Writer writer(sink);
    const auto size = [&](const char* before, const char* after) {
        writer.text(before);
        writer.decimal(mesh.right());
        writer.text(" ");
        writer.decimal(mesh.bottom());
        writer.text(after);
    };
    size("%!PS-Adobe-3.0 EPSF-3.0\n%%Creator: hmesh " HMESH_VERSION_STRING "\n%%BoundingBox: 0 0 ", "\n");
    size("%%HiResBoundingBox: 0 0 ", "\n%%LanguageLevel: 3\n%%DocumentData: Clean7Bit\n%%Pages: 1\n%%EndComments\n");
    size("%%Page: 1 1\ngsave\n0 0 ", " rectclip\n");
    if (!is_empty) {
        // Read as one procedure, so that what follows the drawing - skipping to the end of the data - is known before them.
        writer.text("{ currentfile /ASCII85Decode filter dup");
        if (options.deflate) writer.text(" /FlateDecode filter");
        writer.text("\n<< /DataSource 3 -1 roll\n");
        detail::write_shading_entries(writer, layout, {components, 1, 0});
        writer.text(" >> shfill flushfile } exec\n");
        detail::write_ascii85(writer, bytes);
    }
    writer.text("grestore\nshowpage\n%%Trailer\n%%EOF\n");
    return writer.finish();
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_EPS_HPP
