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
/// and 110 bytes a face to find the strips.
#ifndef HMESH_IO_PDF_HPP
#define HMESH_IO_PDF_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/core/array.hpp"
#include "hmesh/core/assert.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/core/version.hpp"
#include "hmesh/io/detail/export_mesh.hpp"
#include "hmesh/io/detail/gouraud_stream.hpp"
#include "hmesh/io/detail/pdf_file.hpp"
#include "hmesh/io/detail/shading_parts.hpp"
#include "hmesh/io/detail/strips.hpp"
#include "hmesh/io/page_options.hpp"
#include "hmesh/io/sink.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/mesh/unrolled.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

namespace detail {

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

/// The shadings of a mesh, one after another, and where they stand among the objects of a file: those of its colours and, where
/// it has alpha, those of the mask of these.
class PdfPage {
  public:
    /// Of a mesh of 1 to 4 channels with straight colours. It and the options must outlive the page.
    PdfPage(const MeshView& mesh, const ShadingLayout& layout, const PageOptions& options) noexcept
        : mesh_(&mesh), layout_(layout), options_(&options) {}

    /// Makes all shadings and numbers the objects. Errc::write_failed where the compressor fails.
    [[nodiscard]] Status plan() {
        if (const Status status = make(mesh_->channels == 1 ? 1 : 3, 0, colors_); !status) return status;
        if (is_masked())
            if (const Status status = make(1, 3, alpha_); !status) return status;
        // The functions that multiply stored colours come last.
        group_at_ = first_color + static_cast<int>(colors_.size());
        first_alpha_ = group_at_ + 3;
        int next_function = is_masked() ? first_alpha_ + static_cast<int>(alpha_.size()) : group_at_;
        for (std::vector<PdfShading>* const shadings : {&colors_, &alpha_})
            for (PdfShading& shading : *shadings)
                if (shading.colors.factor != 1) shading.colors.function = next_function++;
        return {};
    }
    /// Puts all objects into a file that has none.
    void put(PdfFile& file) const {
        file.begin_object().text("/Producer (hmesh " HMESH_VERSION_STRING ")");  // maker
        file.end_object();
        file.begin_object().text("/Type /Catalog /Pages 3 0 R");  // catalog
        file.end_object();
        file.begin_object().text("/Type /Pages /Kids [4 0 R] /Count 1");  // 3
        file.end_object();
        put_page(file);
        put_shadings(file, colors_);
        if (is_masked()) {
            // The colours are a group and masked as a whole: poppler draws parts of a face over each other.
            put_group(file, "RGB", first_color, colors_.size());
            put_reference(file.begin_object(), "/Type /ExtGState /SMask << /S /Luminosity /G ", group_at_ + 2);
            file.end_object(" >>");
            put_group(file, "Gray", first_alpha_, alpha_.size());
            put_shadings(file, alpha_);
        }
        put_functions(file, colors_);
        put_functions(file, alpha_);
    }
    static constexpr int maker = 1, catalog = 2;  ///< numbers of these objects

  private:
    static constexpr int first_color = 6;

    [[nodiscard]] bool is_masked() const noexcept { return mesh_->channels == 4 && mesh_->face_count != 0; }

    /// Makes the shadings of these channels.
    [[nodiscard]] Status make(int count, std::size_t first_channel, std::vector<PdfShading>& shadings) const {
        if (mesh_->face_count == 0) return {};  // a shading has at least one
        const auto channels = static_cast<std::size_t>(mesh_->channels);
        kit::Array<double> shares;
        shares.reserve(static_cast<std::size_t>(count) * mesh_->vertex_count);
        for (std::size_t v = 0; v < mesh_->vertex_count; ++v)
            for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k)
                shares.push_back(static_cast<double>(mesh_->colors[channels * v + first_channel + k]) / mesh_->peak);
        return make_shadings(*mesh_, layout_, count, shares, *options_, shadings);
    }

    /// The page, object 4, and what draws it, object 5.
    void put_page(PdfFile& file) const {
        Writer& page = file.begin_object();
        page.text("/Type /Page /Parent 3 0 R ");
        put_box(page, "/MediaBox");
        page.text(" /Contents 5 0 R\n/Resources << ");
        if (is_masked()) {
            put_reference(page, "/XObject << /X0 ", group_at_);
            put_reference(page, " >> /ExtGState << /G0 ", group_at_ + 1);
            page.text(" >> >>\n/Group << /S /Transparency /CS /DeviceRGB >>");
        } else {
            put_resources(page, first_color, colors_.size());
        }
        file.end_object();
        file.begin_object();
        if (is_masked()) end_drawing(file, "/G0 gs /X0 Do", 13);
        else end_drawing(file, colors_.size());
    }
    /// A group that draws so many shadings, the first of which is object `first`.
    void put_group(PdfFile& file, const char* space, int first, std::size_t count) const {
        Writer& writer = file.begin_object();
        writer.text("/Type /XObject /Subtype /Form ");
        put_box(writer, "/BBox");
        writer.text("\n/Group << /S /Transparency /CS /Device");
        writer.text(space);
        writer.text(" /I true >>\n/Resources << ");
        put_resources(writer, first, count);
        end_drawing(file, count);
    }
    void put_shadings(PdfFile& file, const std::vector<PdfShading>& shadings) const {
        for (const PdfShading& shading : shadings) {
            Writer& writer = file.begin_object();
            write_shading_entries(writer, layout_, shading.colors);
            if (options_->deflate) writer.text("\n/Filter /FlateDecode");
            file.end_object(shading.bytes.data(), shading.bytes.size());
        }
    }
    static void put_functions(PdfFile& file, const std::vector<PdfShading>& shadings) {
        for (const PdfShading& shading : shadings)
            if (shading.colors.factor != 1) put_multiplier(file, shading.colors);
    }

    void put_box(Writer& writer, const char* name) const {
        writer.text(name);
        writer.text(" [0 0 ");
        writer.decimal(mesh_->right());
        writer.text(" ");
        writer.decimal(mesh_->bottom());
        writer.text("]");
    }
    static void put_reference(Writer& writer, const char* before, int number) {
        writer.text(before);
        writer.decimal(number);
        writer.text(" 0 R");
    }
    /// The names S0, S1 .. of so many shadings.
    static void put_resources(Writer& writer, int first, std::size_t count) {
        writer.text("/Shading <<");
        for (std::size_t i = 0; i < count; ++i) {
            writer.text(" /S");
            writer.decimal(static_cast<std::int64_t>(i));
            put_reference(writer, " ", first + static_cast<int>(i));
        }
        writer.text(" >> >>");
    }
    /// Ends an object by the stream that draws so many shadings.
    static void end_drawing(PdfFile& file, std::size_t count) {
        static constexpr char all[] = "/S0 sh /S1 sh /S2 sh /S3 sh /S4 sh";
        const std::size_t size = count == 0 ? 0 : 7 * count - 1;
        HMESH_ASSERT(size < sizeof all);
        end_drawing(file, all, size);
    }
    static void end_drawing(PdfFile& file, const char* text, std::size_t size) {
        file.end_object(reinterpret_cast<const unsigned char*>(text), size);
    }

    const MeshView* mesh_;
    ShadingLayout layout_;
    const PageOptions* options_;
    std::vector<PdfShading> colors_, alpha_;
    int group_at_ = 0, first_alpha_ = 0;  ///< objects: three that mask the colours, and the first shading of the mask
};

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
    detail::PdfPage page(exported.view(), layout, options);
    if (const Status status = page.plan(); !status) return status;
    detail::PdfFile file(sink);
    page.put(file);
    return file.finish(detail::PdfPage::catalog, detail::PdfPage::maker);
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_PDF_HPP
