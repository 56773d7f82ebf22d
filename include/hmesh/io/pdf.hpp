// hmesh - write_pdf(): a mesh as a PDF 1.4 page that is exactly a Gouraud-shaded mesh: vectors, no pixels.
//
// One page of the image's size, 1 px = 1/72 inch (Acrobat opens pages of up to 14400 px), with a shading of type 4 in
// DeviceRGB, or DeviceGray for 1 channel; see shading_stream.hpp. For 4 channels the fourth is opacity: colours are drawn
// straight (not premultiplied) under a soft mask (ISO 32000-1, 11.6.5.3) that is a shading of the opacity. No date and no
// random identifier: the same mesh gives the same bytes.
//
// Size of an RGB mesh of 256 px or more: 21 bytes a vertex, deflated 12; without strips 59 and 16. Time: some 100 MB/s in
// strips, of which finding them takes most.
#ifndef HMESH_IO_PDF_HPP
#define HMESH_IO_PDF_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <vector>

#include "hmesh/core/assert.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/core/version.hpp"
#include "hmesh/io/detail/gouraud_stream.hpp"
#include "hmesh/io/detail/straight_colors.hpp"
#include "hmesh/io/detail/strips.hpp"
#include "hmesh/io/sink.hpp"
#include "hmesh/mesh/mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

// Options of write_pdf().
struct PdfOptions {
    Deflate deflate = nullptr;  // compresses the mesh (shading_stream.hpp); none: it is written as it is
    void* deflate_user = nullptr;
    bool strips = true;  // faces share vertices with the one before; false: each by itself in the mesh's order
};

namespace detail {

template <class Sink>
struct CountingSink {
    Sink* sink;
    std::int64_t count = 0;
    bool operator()(const void* bytes, std::size_t size) {
        count += static_cast<std::int64_t>(size);
        return (*sink)(bytes, size);
    }
};

// Objects one after the other, numbered from 1, and the table of where each begins.
template <class Sink>
class PdfFile {
  public:
    using Output = Writer<CountingSink<Sink>>;

    explicit PdfFile(Sink& sink) noexcept : sink_{&sink}, writer_(sink_) {
        writer_.text("%PDF-1.4\n%\xe2\xe3\xcf\xd3\n");  // 4 bytes above 127 say that the file is binary
    }
    PdfFile(const PdfFile&) = delete;
    PdfFile& operator=(const PdfFile&) = delete;

    Output& begin_object() {
        static_cast<void>(writer_.finish());  // whether bytes were refused is asked at the end
        HMESH_ASSERT(objects_ < offsets_.size());
        offsets_[objects_++] = sink_.count;
        writer_.decimal(static_cast<std::int64_t>(objects_));
        writer_.text(" 0 obj\n<< ");
        return writer_;
    }
    void end_object() { writer_.text(" >>\nendobj\n"); }
    // Ends the object's dictionary and puts its stream.
    void end_object(const unsigned char* bytes, std::size_t size) {
        writer_.text("\n/Length ");
        writer_.decimal(static_cast<std::int64_t>(size));
        writer_.text(" >>\nstream\n");
        writer_.bytes(bytes, size);
        writer_.text("\nendstream\nendobj\n");
    }
    [[nodiscard]] Status finish(int root, int info) {
        static_cast<void>(writer_.finish());
        const std::int64_t table = sink_.count;
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
    CountingSink<Sink> sink_;
    Output writer_;
    std::array<std::int64_t, 10> offsets_{};
    std::size_t objects_ = 0;
};

}  // namespace detail

// Writes the mesh to the sink (see sink.hpp). Colours are held to [0, peak]. Faces are drawn in another order than the
// mesh's when in strips, which shows only where they overlap. A mesh of 2 or more than 4 channels, an empty one and others
// that cannot be written give a Status and no byte, and so does a compressor that fails.
template <class Sink>
Status write_pdf(const MeshView& source, Sink&& sink, const PdfOptions& options = {}) {
    detail::ShadingLayout layout;
    if (const Status status = detail::plan_shading(source, layout); !status) return status;
    const detail::StraightMesh straight(source);
    const MeshView& mesh = straight.view();
    const auto channels = static_cast<std::size_t>(mesh.channels);
    const int components = mesh.channels == 1 ? 1 : 3;
    const bool has_alpha = mesh.channels == 4;

    const auto share = [&](std::size_t v, std::size_t k) {
        return static_cast<double>(mesh.colors[channels * v + k]) / mesh.peak;
    };
    const std::vector<detail::StripVertex> vertices = detail::strip_vertices(mesh, options.strips);
    std::vector<unsigned char> colors = detail::shading_bytes(
        mesh, vertices, layout, components, [&](std::size_t v, int k) { return share(v, static_cast<std::size_t>(k)); });
    if (const Status status = detail::compress(options.deflate, options.deflate_user, colors); !status) return status;
    std::vector<unsigned char> alpha;
    if (has_alpha) {
        alpha = detail::shading_bytes(mesh, vertices, layout, 1, [&](std::size_t v, int) { return share(v, 3); });
        if (const Status status = detail::compress(options.deflate, options.deflate_user, alpha); !status) return status;
    }

    detail::PdfFile<std::remove_reference_t<Sink>> file(sink);
    const auto box = [&](auto& writer, const char* name) {
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
        auto& writer = file.begin_object();
        detail::write_shading_entries(writer, layout, count);
        if (options.deflate != nullptr) writer.text("\n/Filter /FlateDecode");
        file.end_object(bytes.data(), bytes.size());
    };
    const auto group = [&](const char* space, const char* shading_name) {
        auto& writer = file.begin_object();
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
    auto& page = file.begin_object();  // 4
    page.text("/Type /Page /Parent 3 0 R ");
    box(page, "/MediaBox");
    page.text(" /Contents 5 0 R\n/Resources << ");
    page.text(has_alpha ? "/XObject << /X0 7 0 R >> /ExtGState << /G0 8 0 R >> >>\n"
                          "/Group << /S /Transparency /CS /DeviceRGB >>"
                        : "/Shading << /S0 6 0 R >> >>");
    file.end_object();
    file.begin_object();  // 5
    end_text_stream(has_alpha ? "/G0 gs /X0 Do" : "/S0 sh");
    shading(components, colors);  // 6
    if (has_alpha) {
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
