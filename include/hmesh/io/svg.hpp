/// \file
/// write_svg(): a mesh as an SVG picture, which browsers, Inkscape and office programs show.
///
/// SVG has no mesh of coloured vertices (mesh gradients were dropped from SVG 2), so each face is a path, filled in one of three
/// ways (SvgOptions::Kind). Edges of neighbours meet without a seam because the picture asks for crispEdges: no anti-aliasing,
/// every pixel to the face that holds its centre. At its own size the exact kind is within a step of 8 bits of render() but for
/// the few pixels beside needles narrower than what the viewer tells apart (1/256 px in librsvg). SVG interpolates in the stored
/// (sRGB) values, as meshes are fitted. Colours are held to [0, peak] and rounded to 8 bits.
///
/// Alpha is a mask of grey faces, left out where all is opaque. SVG interpolates colours before alpha is applied: those of
/// premultiplied meshes are divided by it at the corners; a corner without alpha takes the others' mean, so that transparent
/// edges carry no fringe. Ids are short and the same in every file: put several pictures in one page by img elements, not inline.
///
/// Cost: about 1 us a face, exact 3 us; memory only for the wireframe, 96 bytes a face, and where grey has alpha.
/// Source: W3C, SVG 1.1 and Compositing and Blending Level 1.
#ifndef HMESH_IO_SVG_HPP
#define HMESH_IO_SVG_HPP

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "hmesh/core/array.hpp"
#include "hmesh/core/coded_order.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/core/version.hpp"
#include "hmesh/io/detail/export_mesh.hpp"
#include "hmesh/io/detail/svg_gradient.hpp"
#include "hmesh/io/sink.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/mesh/unrolled.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// Options of write_svg().
struct SvgOptions {
    /// How faces are filled. A mesh of one channel needs one gradient a face, so gradient and exact are the same picture of it,
    /// from grey gradients and without blending.
    enum class Kind : std::uint8_t {
        gradient,  ///< one linear gradient a face, the best that there is (io/detail/svg_gradient.hpp): about 310 bytes a face
        /// Three layers, one a channel, added by mix-blend-mode: screen; over a face a channel is linear, hence a gradient shows
        /// it exactly. Viewers must know blend modes, as browsers and librsvg do. About 560 bytes a face.
        exact,
        flat,  ///< the mean of the corners' colours: about 70 bytes a face
    };

    Kind kind = Kind::gradient;  ///< how faces are filled
    bool wireframe = false;      ///< all edges over the faces, thin, white and half transparent, as wide at any zoom
};

namespace detail {

/// Refuses what write_svg() cannot draw. O(n).
[[nodiscard]] inline Status check_for_svg(const MeshView& mesh, const SvgOptions& options) noexcept {
    if (options.kind > SvgOptions::Kind::flat)
        return {Errc::invalid_argument, "the kind of SVG is none of those known", static_cast<std::int64_t>(options.kind), 2};
    return check_for_export(mesh);
}

/// A writer of the numbers, colours and names of SVG files, in as few bytes as they need.
class SvgWriter : public Writer {
  public:
    using Writer::Writer;

    /// Writes the attributes of a size in px.
    void size(int width, int height) {
        text("width=\"");
        decimal(width);
        text("\" height=\"");
        decimal(height);
        text("\"");
    }
    /// Writes a place in px. Three decimals are enough to tell the units of 1/256 px of which meshes are made, and many viewers'
    /// pictures too.
    void point(double x, double y) {
        fixed(x, 3);
        text(" ");
        fixed(y, 3);
    }
    /// Writes the attributes of a gradient's line.
    void ends(const GradientLine& line) {
        const std::array<double, 4> values = {line.from.x, line.from.y, line.to.x, line.to.y};
        static constexpr std::array<const char*, 4> names = {"x1=\"", "\" y1=\"", "\" x2=\"", "\" y2=\""};
        for (std::size_t i = 0; i < 4; ++i) {
            text(names[i]);
            fixed(values[i], line.places);
        }
        text("\"");
    }
    /// Writes a stop of a gradient, its offset with so many decimals.
    void stop(double offset, const Color4& color, int places = 0) {
        text("<stop offset=\"");
        fixed(offset, places);
        text("\" stop-color=\"");
        hex(color);
        text("\"/>");
    }
    /// Writes a colour as # and six digits.
    void hex(const Color4& color) {
        std::array<char, 8> out{'#'};
        for (std::size_t k = 0; k < 3; ++k) {
            const auto byte = static_cast<std::size_t>(color[k] + 0.5);
            out[1 + 2 * k] = "0123456789abcdef"[byte >> 4U];
            out[2 + 2 * k] = "0123456789abcdef"[byte & 15U];
        }
        text(out.data());
    }
    /// Writes the id of a number: letters alone, since the ids of other things have an underscore.
    void id(std::size_t number) {
        std::array<char, 14> letters{};  // 52^12 > 2^64
        std::size_t at = letters.size() - 1;
        do {
            letters[--at] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"[number % 52];
            number /= 52;
        } while (number != 0);
        text(letters.data() + at);
    }
};

/// What a layer of faces shows: one of three colours, the one channel of a mesh without colour, or alpha.
enum class SvgLayer : std::uint8_t { red, green, blue, gray, alpha };

/// A file of write_svg().
class SvgPage {
  public:
    /// Of a mesh that check_for_svg() accepts. All must outlive this object.
    SvgPage(const MeshView& mesh, const SvgOptions& options, Sink sink) : mesh_(mesh), options_(options), writer_(sink) {}

    /// Writes the file. To be called once.
    Status write() {
        begin();
        const bool is_masked = mesh_.channels == 4 && !is_opaque();
        if (is_masked) {
            writer_.text("<mask id=\"_m\" maskUnits=\"userSpaceOnUse\" x=\"0\" y=\"0\" ");
            writer_.size(mesh_.right(), mesh_.bottom());
            writer_.text(">\n");
            layer(SvgLayer::alpha);
            writer_.text("</mask>\n<g mask=\"url(#_m)\">\n");
        }
        if (mesh_.channels == 1) layer(SvgLayer::gray);
        else if (options_.kind == SvgOptions::Kind::exact) screened_layers();
        else if (options_.kind == SvgOptions::Kind::gradient) gradients();
        else flat_faces();
        if (is_masked) writer_.text("</g>\n");
        if (options_.wireframe && mesh_.face_count > 0) wireframe();
        writer_.text("</svg>\n");
        return writer_.finish();
    }

  private:
    // --- parts of the page ---
    void begin() {
        writer_.text("<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" ");
        writer_.size(mesh_.right(), mesh_.bottom());
        writer_.text(" viewBox=\"0 0 ");
        writer_.decimal(mesh_.right());
        writer_.text(" ");
        writer_.decimal(mesh_.bottom());
        writer_.text("\" shape-rendering=\"crispEdges\">\n<!-- made by hmesh " HMESH_VERSION_STRING " -->\n");
    }
    void flat_faces() {
        for (std::size_t f = 0; f < mesh_.face_count; ++f) plain_face(f, mean_color(face_colors(f)));
    }
    void gradients() {
        for (std::size_t f = 0; f < mesh_.face_count; ++f) {
            const FaceColors colors = face_colors(f);
            const FaceGradient gradient(face_points(f), colors);
            if (gradient.is_plain) {
                plain_face(f, mean_color(colors));
                continue;
            }
            writer_.text("<linearGradient id=\"");
            writer_.id(next_id_);
            writer_.text("\" gradientUnits=\"userSpaceOnUse\" ");
            writer_.ends(gradient.line);
            writer_.text(">");
            writer_.stop(gradient.line.low_at, gradient.first, gradient.line.offset_places);
            if (gradient.has_middle) writer_.stop(gradient.middle_at, gradient.middle, gradient.line.offset_places);
            writer_.stop(gradient.line.high_at, gradient.last, gradient.line.offset_places);
            writer_.text("</linearGradient>");
            shaded_face(f);
        }
    }
    void screened_layers() {
        // Each channel's layer is black in the others, so that screen, a + b - a b, adds. The first is screened on nothing, which
        // leaves it as it is.
        writer_.text("<g style=\"isolation:isolate\">\n");
        for (const SvgLayer channel : {SvgLayer::red, SvgLayer::green, SvgLayer::blue}) {
            writer_.text("<g style=\"mix-blend-mode:screen\">\n");
            layer(channel);
            writer_.text("</g>\n");
        }
        writer_.text("</g>\n");
    }
    // Faces in one channel. All gradients of a layer run from 0 to full, on lines as long as that takes, and share stops.
    void layer(SvgLayer kind) {
        static constexpr std::array<Color4, 5> full = {Color4{255, 0, 0, 0}, Color4{0, 255, 0, 0}, Color4{0, 0, 255, 0},
                                                       Color4{255, 255, 255, 0}, Color4{255, 255, 255, 0}};
        static constexpr std::array<std::size_t, 5> channels = {0, 1, 2, 0, 3};
        const auto index = static_cast<std::size_t>(kind);
        const std::array<char, 3> name = {'_', "rgbwa"[index], 0};
        writer_.text("<linearGradient id=\"");
        writer_.text(name.data());
        writer_.text("\" gradientUnits=\"userSpaceOnUse\">");
        writer_.stop(0, Color4{});
        writer_.stop(1, full[index]);
        writer_.text("</linearGradient>\n");
        for (std::size_t f = 0; f < mesh_.face_count; ++f) {
            const FaceColors colors = face_colors(f);
            const ChannelGradient gradient(face_points(f), colors, channels[index]);
            if (gradient.is_plain || options_.kind == SvgOptions::Kind::flat) {
                plain_face(f, part(full[index], gradient.mean));
                continue;
            }
            writer_.text("<linearGradient id=\"");
            writer_.id(next_id_);
            writer_.text("\" xlink:href=\"#");
            writer_.text(name.data());
            writer_.text("\" ");
            writer_.ends(gradient.line);
            if (gradient.is_steep) {
                writer_.text(">");
                writer_.stop(gradient.line.low_at, part(full[index], gradient.low), gradient.line.offset_places);
                writer_.stop(gradient.line.high_at, part(full[index], gradient.high), gradient.line.offset_places);
                writer_.text("</linearGradient>");
            } else {
                writer_.text("/>");
            }
            shaded_face(f);
        }
    }
    [[nodiscard]] static Color4 part(Color4 color, double share) noexcept {
        for (double& value : color) value *= share / 255;
        return color;
    }
    // Every edge once, in strokes as long as vertices of rising numbers lead.
    void wireframe() {
        kit::Array<kit::Coded> edges;
        edges.reserve(3 * mesh_.face_count);
        for (std::size_t f = 0; f < mesh_.face_count; ++f)
            for (std::size_t k = 0; k < 3; ++k) {
                const auto [low, high] = std::minmax({mesh_.faces[f][k], mesh_.faces[f][(k + 1) % 3]});
                edges.push_back({kit::code_of(low, high), high});
            }
        kit::sort_by_code(edges);
        const auto is_same = [](const kit::Coded& a, const kit::Coded& b) { return a.code == b.code; };
        edges.erase(std::unique(edges.begin(), edges.end(), is_same), edges.end());
        kit::Array<std::size_t> next(mesh_.vertex_count + 1);  // the first edge of each vertex that is still to draw
        for (const kit::Coded& edge : edges) ++next[static_cast<std::size_t>(edge.code >> 32U) + 1];
        for (std::size_t v = 0; v < mesh_.vertex_count; ++v) next[v + 1] += next[v];
        const kit::Array<std::size_t> begins = next;

        writer_.text(
            "<path fill=\"none\" stroke=\"#fff\" stroke-opacity=\".5\" vector-effect=\"non-scaling-stroke\" "
            "shape-rendering=\"auto\" d=\"");
        for (std::size_t v = 0; v < mesh_.vertex_count; ++v)
            while (next[v] < begins[v + 1]) {
                writer_.text("M");
                point(v);
                for (std::size_t at = v; next[at] < begins[at + 1];) {
                    at = edges[next[at]++].number;
                    writer_.text(" ");
                    point(at);
                }
            }
        writer_.text("\"/>\n");
    }

    // --- faces ---
    void plain_face(std::size_t f, const Color4& color) {
        writer_.text("<path fill=\"");
        writer_.hex(color);
        writer_.text("\"");
        outline(f);
    }
    void shaded_face(std::size_t f) {
        writer_.text("<path fill=\"url(#");
        writer_.id(next_id_++);
        writer_.text(")\"");
        outline(f);
    }
    void outline(std::size_t f) {
        writer_.text(" d=\"M");
        for (std::size_t k = 0; k < 3; ++k) {
            if (k > 0) writer_.text(" ");
            point(mesh_.faces[f][k]);
        }
        writer_.text("z\"/>\n");
    }
    void point(std::size_t v) {
        writer_.point(static_cast<double>(mesh_.positions[2 * v]), static_cast<double>(mesh_.positions[2 * v + 1]));
    }

    // --- the mesh ---
    [[nodiscard]] FacePoints face_points(std::size_t f) const {
        FacePoints points;
        for (std::size_t k = 0; k < 3; ++k) {
            const float* at = mesh_.positions + 2 * std::size_t{mesh_.faces[f][k]};
            points[k] = {static_cast<double>(at[0]), static_cast<double>(at[1])};
        }
        return points;
    }
    [[nodiscard]] FaceColors face_colors(std::size_t f) const {
        FaceColors colors{};
        const auto channels = static_cast<std::size_t>(mesh_.channels);
        for (std::size_t k = 0; k < 3; ++k)
            for (std::size_t c = 0; c < channels; ++c)
                colors[k][c] = share_of_peak(mesh_.colors[channels * mesh_.faces[f][k] + c], mesh_.peak) * 255;
        if (channels == 4 && mesh_.premultiplied) divide_by_alpha(colors);
        return colors;
    }
    [[nodiscard]] bool is_opaque() const {
        for (std::size_t v = 0; v < mesh_.vertex_count; ++v)
            if (static_cast<double>(mesh_.colors[4 * v + 3]) / mesh_.peak * 255 < 254.5) return false;
        return true;
    }

    const MeshView& mesh_;
    const SvgOptions& options_;
    SvgWriter writer_;
    std::size_t next_id_ = 0;
};

}  // namespace detail

/// Writes a mesh of 1 to 4 channels as an SVG file. A mesh that has no size, numbers that are not finite or faces without their
/// vertices, and a kind that is none of SvgOptions::Kind give a Status that says so, and no byte is written; a sink that refuses
/// bytes gives Errc::write_failed.
inline Status write_svg(const MeshView& mesh, Sink sink, const SvgOptions& options = {}) {
    if (const Status status = detail::check_for_svg(mesh, options); !status) return status;
    if (mesh.periodic != Periodic::none) {
        const Mesh whole = kit::unrolled(mesh);
        return write_svg(whole.view(), sink, options);
    }
    const detail::ExportMesh exported(mesh, detail::Premultiplied::kept);
    return detail::SvgPage(exported.view(), options, sink).write();
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_SVG_HPP
