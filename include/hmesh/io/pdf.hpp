/// \file
/// write_pdf(): a mesh as a PDF 1.4 page that is exactly a Gouraud-shaded mesh: vectors, no pixels.
///
/// One page of the image's size, 1 px = 1/72 inch (Acrobat opens pages of up to 14400 px), with a free-form Gouraud shading
/// (ISO 32000-1, 8.7.4.5.5) in DeviceRGB, or DeviceGray for 1 channel. Positions of the 1/256 px grid arrive exactly; colours
/// have 8 bits where the mesh's peak is 255, else 16. Where there is alpha, straight colours are drawn under a soft mask
/// (ISO 32000-1, 11.6.5.3) that is a shading of alpha. No date and no random identifier: the same mesh gives the same bytes.
/// Meshes that take poppler long are several shadings, one after another (io/detail/shading_parts.hpp).
///
/// Size of an RGB mesh of 256 px or more: 21 bytes a vertex, deflated 12; in parts 27 and 1.6 times as much deflated; without
/// strips 59 and 16. Time: some 100 MB/s in strips, of which finding them takes most, and 30 MB/s in parts. Memory: the streams,
/// and 60 bytes a face to find the strips; in parts 25 more.
#ifndef HMESH_IO_PDF_HPP
#define HMESH_IO_PDF_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "hmesh/core/array.hpp"
#include "hmesh/core/assert.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/core/version.hpp"
#include "hmesh/io/detail/export_mesh.hpp"
#include "hmesh/io/detail/gouraud_stream.hpp"
#include "hmesh/io/detail/shading_parts.hpp"
#include "hmesh/io/detail/strips.hpp"
#include "hmesh/io/page_options.hpp"
#include "hmesh/io/sink.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/mesh/unrolled.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

namespace detail {

/// A file of objects one after the other, numbered from 1, and the table of where each begins.
class PdfFile {
  public:
    /// Begins a file in a sink, whose callable outlives this object.
    explicit PdfFile(Sink sink) noexcept : writer_(sink) {
        writer_.text("%PDF-1.4\n%\xe2\xe3\xcf\xd3\n");  // 4 bytes above 127 say that the file is binary
    }
    PdfFile(const PdfFile&) = delete;
    PdfFile& operator=(const PdfFile&) = delete;

    /// Begins an object and its dictionary, whose entries are for the caller to put. At most 32 objects.
    Writer& begin_object() {
        HMESH_ASSERT(objects_ < offsets_.size());
        offsets_[objects_++] = writer_.position();
        writer_.decimal(static_cast<std::int64_t>(objects_));
        writer_.text(" 0 obj\n<< ");
        return writer_;
    }
    /// Ends an object without a stream, its dictionary by `more`.
    void end_object(const char* more = "") {
        writer_.text(more);
        writer_.text(" >>\nendobj\n");
    }
    /// Ends the object's dictionary and puts its stream.
    void end_object(const unsigned char* bytes, std::size_t size) {
        writer_.text("\n/Length ");
        writer_.decimal(static_cast<std::int64_t>(size));
        writer_.text(" >>\nstream\n");
        writer_.bytes(bytes, size);
        writer_.text("\nendstream\nendobj\n");
    }
    /// Ends the file, with the numbers of its catalog and of the object that says who made it.
    [[nodiscard]] Status finish(int root, int info) {
        const std::int64_t table = writer_.position();
        const auto entries = static_cast<std::int64_t>(objects_ + 1);
        writer_.text("xref\n0 ");
        writer_.decimal(entries);
        writer_.text("\n0000000000 65535 f \n");
        for (std::size_t i = 0; i < objects_; ++i) {
            std::int64_t first_digit = 1000000000;  // of 10
            for (; first_digit > 1 && offsets_[i] < first_digit; first_digit /= 10) writer_.text("0");
            writer_.decimal(offsets_[i]);
            writer_.text(" 00000 n \n");
        }
        writer_.text("trailer\n<< /Size ");
        writer_.decimal(entries);
        writer_.text(" /Root ");
        writer_.decimal(root);
        writer_.text(" 0 R /Info ");
        writer_.decimal(info);
        writer_.text(" 0 R >>\nstartxref\n");
        writer_.decimal(table);
        writer_.text("\n%%EOF\n");
        return writer_.finish();
    }

  private:
    Writer writer_;
    std::array<std::int64_t, 32> offsets_{};
    std::size_t objects_ = 0;
};

/// A shading of a file, as it is stored.
struct PdfShading {
    ShadingColors colors;              ///< the function's number is set when objects are numbered
    std::vector<unsigned char> bytes;  ///< of the stream, compressed if it is to be
};

/// Makes the shadings that draw the mesh one after another. Component k of vertex v is shares[components * v + k].
/// Errc::write_failed where the compressor fails.
[[nodiscard]] inline Status make_shadings(const MeshView& mesh, const ShadingLayout& layout, int components,
                                          const kit::Array<double>& shares, const PageOptions& options,
                                          std::vector<PdfShading>& shadings) {
    std::vector<ShadingPart> parts;
    if (options.strips && options.parts) parts = ShadingDivision(mesh, components, shares).run();
    else parts.push_back({1, strip_vertices(mesh, options.strips)});
    for (const ShadingPart& part : parts) {
        shadings.push_back({{components, part.factor, 0}, shading_bytes(mesh, part.vertices, layout, components, shares)});
        if (const Status status = compress(options.deflate, shadings.back().bytes); !status) return status;
    }
    return {};
}

/// Puts the function that multiplies stored colours by their factor, in PostScript (ISO 32000-1, 7.10.5).
inline void put_multiplier(PdfFile& file, const ShadingColors& colors) {
    const bool is_gray = colors.components == 1;
    std::array<char, 64> code{};  // 52 at most
    std::size_t used = 0;
    const auto add = [&](const char* text) {
        for (; *text != 0; ++text) code[used++] = *text;
    };
    add("{");
    for (int k = 0; k < colors.components; ++k) {
        add(k == 0 ? "" : " ");
        add(colors.factor == 16 ? "16" : colors.factor == 8 ? "8" : colors.factor == 4 ? "4" : "2");
        add(is_gray ? " mul" : " mul 3 1 roll");
    }
    add("}");
    file.begin_object().text(is_gray ? "/FunctionType 4 /Domain [0 1] /Range [0 1]"
                                     : "/FunctionType 4 /Domain [0 1 0 1 0 1] /Range [0 1 0 1 0 1]");
    file.end_object(reinterpret_cast<const unsigned char*>(code.data()), used);
}

}  // namespace detail

/// Writes a mesh of 1 to 4 channels as a PDF file; colours are held to [0, peak]. A mesh without vertices is a page on which
/// nothing is drawn. A mesh that has no size or one above 4,194,304 px, numbers that are not finite, positions further than that
/// from the corner, faces without their vertices or more than 47,721,858 of them gives a Status that says so, and a compressor
/// that fails gives Errc::write_failed: no byte is written. A sink that refuses bytes gives Errc::write_failed.
inline Status write_pdf(const MeshView& source, Sink sink, const PageOptions& options = {}) {
    detail::ShadingLayout layout;
    if (const Status status = detail::plan_shading(source, layout); !status) return status;
    if (source.periodic != Periodic::none) {
        const Mesh whole = kit::unrolled(source);
        return write_pdf(whole.view(), sink, options);
    }
    const detail::ExportMesh exported(source, detail::Premultiplied::divided);
    const MeshView& mesh = exported.view();
    const auto channels = static_cast<std::size_t>(mesh.channels);
    const int components = mesh.channels == 1 ? 1 : 3;
    const bool is_masked = mesh.channels == 4 && mesh.face_count != 0;

    std::vector<detail::PdfShading> colors, alpha;
    const auto shade = [&](int count, std::size_t first_channel, std::vector<detail::PdfShading>& shadings) {
        kit::Array<double> shares;
        shares.reserve(static_cast<std::size_t>(count) * mesh.vertex_count);
        for (std::size_t v = 0; v < mesh.vertex_count; ++v)
            for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k)
                shares.push_back(static_cast<double>(mesh.colors[channels * v + first_channel + k]) / mesh.peak);
        if (mesh.face_count == 0) return Status();  // a shading has at least one
        return detail::make_shadings(mesh, layout, count, shares, options, shadings);
    };
    if (const Status status = shade(components, 0, colors); !status) return status;
    if (is_masked)
        if (const Status status = shade(1, 3, alpha); !status) return status;

    // Numbers of objects. The functions that multiply stored colours come last.
    constexpr int first_color = 6;
    const int group_at = first_color + static_cast<int>(colors.size()), first_alpha = group_at + 3;
    int next_function = is_masked ? first_alpha + static_cast<int>(alpha.size()) : group_at;
    for (std::vector<detail::PdfShading>* shadings : {&colors, &alpha})
        for (detail::PdfShading& shading : *shadings)
            if (shading.colors.factor != 1) shading.colors.function = next_function++;

    detail::PdfFile file(sink);
    const auto box = [&](detail::Writer& writer, const char* name) {
        writer.text(name);
        writer.text(" [0 0 ");
        writer.decimal(mesh.right());
        writer.text(" ");
        writer.decimal(mesh.bottom());
        writer.text("]");
    };
    const auto end_text_stream = [&](const char* text) {
        file.end_object(reinterpret_cast<const unsigned char*>(text), std::strlen(text));
    };
    const auto reference = [](detail::Writer& writer, const char* before, int number) {
        writer.text(before);
        writer.decimal(number);
        writer.text(" 0 R");
    };
    const auto resources = [&](detail::Writer& writer, int first, std::size_t count) {
        writer.text("/Shading <<");
        for (std::size_t i = 0; i < count; ++i) {
            writer.text(" /S");
            writer.decimal(static_cast<std::int64_t>(i));
            reference(writer, " ", first + static_cast<int>(i));
        }
        writer.text(" >> >>");
    };
    const auto draw = [&](std::size_t count) {  // ends a stream that draws so many shadings
        static constexpr char all[] = "/S0 sh /S1 sh /S2 sh /S3 sh /S4 sh";
        const std::size_t size = count == 0 ? 0 : 7 * count - 1;
        HMESH_ASSERT(size < sizeof all);
        file.end_object(reinterpret_cast<const unsigned char*>(all), size);
    };
    const auto put = [&](const std::vector<detail::PdfShading>& shadings) {
        for (const detail::PdfShading& shading : shadings) {
            detail::Writer& writer = file.begin_object();
            detail::write_shading_entries(writer, layout, shading.colors);
            if (options.deflate) writer.text("\n/Filter /FlateDecode");
            file.end_object(shading.bytes.data(), shading.bytes.size());
        }
    };
    const auto put_functions = [&](const std::vector<detail::PdfShading>& shadings) {
        for (const detail::PdfShading& shading : shadings)
            if (shading.colors.factor != 1) detail::put_multiplier(file, shading.colors);
    };
    const auto group = [&](const char* space, int first, std::size_t count) {
        detail::Writer& writer = file.begin_object();
        writer.text("/Type /XObject /Subtype /Form ");
        box(writer, "/BBox");
        writer.text("\n/Group << /S /Transparency /CS /Device");
        writer.text(space);
        writer.text(" /I true >>\n/Resources << ");
        resources(writer, first, count);
        draw(count);
    };
    file.begin_object().text("/Producer (hmesh " HMESH_VERSION_STRING ")");  // 1
    file.end_object();
    file.begin_object().text("/Type /Catalog /Pages 3 0 R");  // 2
    file.end_object();
    file.begin_object().text("/Type /Pages /Kids [4 0 R] /Count 1");  // 3
    file.end_object();
    detail::Writer& page = file.begin_object();  // 4
    page.text("/Type /Page /Parent 3 0 R ");
    box(page, "/MediaBox");
    page.text(" /Contents 5 0 R\n/Resources << ");
    if (is_masked) {
        reference(page, "/XObject << /X0 ", group_at);
        reference(page, " >> /ExtGState << /G0 ", group_at + 1);
        page.text(" >> >>\n/Group << /S /Transparency /CS /DeviceRGB >>");
    } else {
        resources(page, first_color, colors.size());
    }
    file.end_object();
    file.begin_object();  // 5
    if (is_masked) end_text_stream("/G0 gs /X0 Do");
    else draw(colors.size());
    put(colors);
    if (is_masked) {
        // The colours are a group and masked as a whole: poppler draws parts of a face over each other.
        group("RGB", first_color, colors.size());
        reference(file.begin_object(), "/Type /ExtGState /SMask << /S /Luminosity /G ", group_at + 2);
        file.end_object(" >>");
        group("Gray", first_alpha, alpha.size());
        put(alpha);
    }
    put_functions(colors);
    put_functions(alpha);
    return file.finish(2, 1);
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_PDF_HPP
