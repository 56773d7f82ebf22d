/// \file
/// write_pdf(): a mesh as a PDF 1.4 page that is exactly a Gouraud-shaded mesh: vectors, no pixels.
///
/// One page of the image's size, 1 px = 1/72 inch (Acrobat opens pages of up to 14400 px), with a free-form Gouraud shading
/// (ISO 32000-1, 8.7.4.5.5) in DeviceRGB, or DeviceGray for 1 channel. Positions of the 1/256 px grid arrive exactly; colours
/// have 8 bits where the mesh's peak is 255, else 16. Where there is alpha, straight colours are drawn under a soft mask
/// (ISO 32000-1, 11.6.5.3) that is a shading of alpha. No date and no random identifier: the same mesh gives the same bytes.
///
/// Size of an RGB mesh of 256 px or more: 21 bytes a vertex, deflated 12; without strips 59 and 16. Time: some 100 MB/s in
/// strips, of which finding them takes most. Memory: the streams, and 60 bytes a face to find
/// the strips.
#ifndef HMESH_IO_PDF_HPP
#define HMESH_IO_PDF_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "hmesh/core/assert.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/core/version.hpp"
#include "hmesh/io/detail/export_mesh.hpp"
#include "hmesh/io/detail/gouraud_stream.hpp"
#include "hmesh/io/detail/strips.hpp"
#include "hmesh/io/page_options.hpp"
#include "hmesh/io/sink.hpp"
#include "hmesh/mesh/mesh.hpp"

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

    /// Begins an object and its dictionary, whose entries are for the caller to put. At most 10 objects.
    Writer& begin_object() {
        HMESH_ASSERT(objects_ < offsets_.size());
        offsets_[objects_++] = writer_.position();
        writer_.decimal(static_cast<std::int64_t>(objects_));
        writer_.text(" 0 obj\n<< ");
        return writer_;
    }
    /// Ends an object without a stream.
    void end_object() { writer_.text(" >>\nendobj\n"); }
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
    std::array<std::int64_t, 10> offsets_{};
    std::size_t objects_ = 0;
};

}  // namespace detail

/// Writes a mesh of 1 to 4 channels as a PDF file; colours are held to [0, peak]. A mesh that is empty, has no size or one above
/// 4,194,304 px, numbers that are not finite, positions further than that from the corner, faces without their vertices or more
/// than 47,721,858 of them gives a Status that says so, and a compressor that fails gives Errc::write_failed: no byte is written.
/// A sink that refuses bytes gives Errc::write_failed.
inline Status write_pdf(const MeshView& source, Sink sink, const PageOptions& options = {}) {
    detail::ShadingLayout layout;
    if (const Status status = detail::plan_shading(source, layout); !status) return status;
    const detail::ExportMesh exported(source, detail::Premultiplied::divided);
    const MeshView& mesh = exported.view();
    const auto channels = static_cast<std::size_t>(mesh.channels);
    const int components = mesh.channels == 1 ? 1 : 3;
    const bool is_masked = mesh.channels == 4;

    const std::vector<detail::StripVertex> vertices = detail::strip_vertices(mesh, options.strips);
    const auto stream = [&](int count, std::size_t first_channel) {  // of so many channels
        std::vector<double> shares;
        shares.reserve(static_cast<std::size_t>(count) * mesh.vertex_count);
        for (std::size_t v = 0; v < mesh.vertex_count; ++v)
            for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k)
                shares.push_back(static_cast<double>(mesh.colors[channels * v + first_channel + k]) / mesh.peak);
        return detail::shading_bytes(mesh, vertices, layout, count, shares);
    };
    std::vector<unsigned char> colors = stream(components, 0);
    if (const Status status = detail::compress(options.deflate, colors); !status) return status;
    std::vector<unsigned char> alpha;
    if (is_masked) {
        alpha = stream(1, 3);
        if (const Status status = detail::compress(options.deflate, alpha); !status) return status;
    }

    detail::PdfFile file(sink);
    const auto box = [&](detail::Writer& writer, const char* name) {
        writer.text(name);
        writer.text(" [0 0 ");
        writer.decimal(mesh.width);
        writer.text(" ");
        writer.decimal(mesh.height);
        writer.text("]");
    };
    const auto end_text_stream = [&](const char* text) {
        file.end_object(reinterpret_cast<const unsigned char*>(text), std::strlen(text));
    };
    const auto shading = [&](int count, const std::vector<unsigned char>& bytes) {
        detail::Writer& writer = file.begin_object();
        detail::write_shading_entries(writer, layout, count);
        if (options.deflate) writer.text("\n/Filter /FlateDecode");
        file.end_object(bytes.data(), bytes.size());
    };
    const auto group = [&](const char* space, const char* shading_name) {
        detail::Writer& writer = file.begin_object();
        writer.text("/Type /XObject /Subtype /Form ");
        box(writer, "/BBox");
        writer.text("\n/Group << /S /Transparency /CS /Device");
        writer.text(space);
        writer.text(" /I true >>\n/Resources << /Shading << /S0 ");
        writer.text(shading_name);
        writer.text(" 0 R >> >>");
        end_text_stream("/S0 sh");
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
    page.text(is_masked ? "/XObject << /X0 7 0 R >> /ExtGState << /G0 8 0 R >> >>\n"
                          "/Group << /S /Transparency /CS /DeviceRGB >>"
                        : "/Shading << /S0 6 0 R >> >>");
    file.end_object();
    file.begin_object();  // 5
    end_text_stream(is_masked ? "/G0 gs /X0 Do" : "/S0 sh");
    shading(components, colors);  // 6
    if (is_masked) {
        // The colours are a group and masked as a whole: poppler draws parts of a face over each other.
        group("RGB", "6");                                                                  // 7
        file.begin_object().text("/Type /ExtGState /SMask << /S /Luminosity /G 9 0 R >>");  // 8
        file.end_object();
        group("Gray", "10");  // 9
        shading(1, alpha);    // 10
    }
    return file.finish(2, 1);
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_PDF_HPP
