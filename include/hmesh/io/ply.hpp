/// \file
/// write_ply(): a mesh as a PLY file, which MeshLab, CloudCompare, Blender and others open.
///
/// Vertices are `float x y z` in pixels with y up (y = height - y of the mesh) and z = 0, so that the picture stands upright;
/// faces are counter-clockwise, so that it is seen from the front. Colours are `uchar red green blue` for 3 channels, with
/// `alpha` for 4 and for grey with alpha, one `uchar intensity` for 1; 255 is the mesh's peak, and alpha is straight. The file is
/// binary and little-endian unless it is asked to be text.
///
/// Groups of channels (io/channel_groups.hpp) are properties in their order: the first colour as above, but grey with alpha as
/// `uchar intensity alpha`, a normal as `float nx ny nz` of length 1, and all else as `uchar NAME`, or NAME_0, NAME_1 and so on
/// where a group has several channels.
///
/// 15 bytes a vertex of 3 channels and 13 a face. O(n); nothing is allocated unless there is alpha.
/// Source: Greg Turk, The PLY Polygon File Format, 1994.
#ifndef HMESH_IO_PLY_HPP
#define HMESH_IO_PLY_HPP

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "hmesh/core/compiler.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/io/channel_groups.hpp"
#include "hmesh/io/detail/export_mesh.hpp"
#include "hmesh/io/detail/model_parts.hpp"
#include "hmesh/io/sink.hpp"
#include "hmesh/mesh/mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// Options of write_ply().
struct PlyOptions {
    /// Numbers are text, with the digits that give the same floats: about 1.7 times the size.
    bool ascii = false;
    /// Colours are `property float`, 1 being the peak: they are rounded to floats only and may lie outside [0, 1], so that a
    /// program can have the mesh back. Most viewers know `uchar` colours only: MeshLab and CloudCompare show these as none.
    bool float_colors = false;
    /// What the channels mean. None: they are one colour.
    ChannelGroups groups{};
};

namespace detail {

/// Refuses what a PLY file cannot hold. O(n).
[[nodiscard]] inline Status check_for_ply(const MeshView& mesh, const PlyOptions& options) noexcept {
    if (const Status status =
            check_counts(mesh, most_numbered, most_numbered, "the mesh has more vertices or faces than a PLY file numbers");
        !status)
        return status;
    if (const Status status = check(options.groups, mesh); !status) return status;
    if (const Status status = check_for_export(mesh, options.groups.is_empty() ? 4 : 16); !status) return status;
    const auto channels = static_cast<std::size_t>(mesh.channels);
    constexpr auto largest = static_cast<double>(std::numeric_limits<float>::max());
    if (options.float_colors)
        for (std::size_t i = 0; i < channels * mesh.vertex_count; ++i)
            if (std::abs(static_cast<double>(mesh.colors[i]) / mesh.peak) > largest)
                return {Errc::not_finite, "the mesh has a colour whose share of the peak no float holds, at vertex",
                        static_cast<std::int64_t>(i / channels), 0};
    return {};
}

/// The lines of a group's properties. `has_color`: one before it is a colour.
HMESH_COLD inline void write_ply_properties(Writer& writer, const ChannelGroup& group, bool has_color, bool are_floats) {
    constexpr std::array<const char*, 4> rgba{"red", "green", "blue", "alpha"}, unit{"nx", "ny", "nz", ""},
        suffixes{"_0", "_1", "_2", "_3"};
    const bool is_normal = group.meaning == ChannelGroup::Meaning::normal;
    const bool is_color = group.meaning == ChannelGroup::Meaning::color && !has_color;
    for (std::size_t k = 0; k < static_cast<std::size_t>(group.channels); ++k) {
        writer.text(are_floats || is_normal ? "property float " : "property uchar ");
        if (is_normal) writer.text(unit[k]);
        else if (is_color && group.channels == 1) writer.text("intensity");
        else if (is_color && group.channels == 2) writer.text(k == 0 ? "intensity" : "alpha");
        else if (is_color) writer.text(rgba[k]);
        else writer.text(group.name);
        if (!is_normal && !is_color && group.channels > 1) writer.text(suffixes[k]);
        writer.text("\n");
    }
}

/// The lines before the numbers.
inline void write_ply_header(Writer& writer, const MeshView& mesh, const PlyOptions& options) {
    begin_ply(writer, mesh, nullptr, options.ascii);
    write_ply_floats(writer, {"x", "y", "z"});
    bool has_color = false;
    for (const ChannelGroup& group : options.groups) {
        write_ply_properties(writer, group, has_color, options.float_colors);
        has_color = has_color || group.meaning == ChannelGroup::Meaning::color;
    }
    if (options.groups.is_empty())
        write_ply_properties(writer, {"", ChannelGroup::Meaning::color, mesh.channels}, false, options.float_colors);
    end_ply_head(writer, mesh);
}

/// The numbers of a PLY file, in order: bytes, or words with spaces between them.
class PlyNumbers {
  public:
    /// Puts them into a writer, which outlives this object.
    PlyNumbers(Writer& writer, bool ascii) noexcept : writer_(&writer), ascii_(ascii) {}

    /// Puts a `float`.
    void f32(float value) {
        if (!ascii_) return writer_->f32(value);
        separate();
        writer_->real(static_cast<double>(value));
    }
    /// Puts a `uchar`.
    void u8(std::uint8_t value) {
        if (!ascii_) return writer_->u8(value);
        separate();
        writer_->decimal(value);
    }
    /// Puts an `int`, below 2^31.
    void u32(std::uint32_t value) {
        if (!ascii_) return writer_->u32(value);
        separate();
        writer_->decimal(value);
    }
    /// Ends a vertex or a face.
    void end_line() {
        if (ascii_) writer_->text("\n");
        line_begins_ = true;
    }

  private:
    void separate() {
        if (!line_begins_) writer_->text(" ");
        line_begins_ = false;
    }

    Writer* writer_;
    bool ascii_;
    bool line_begins_ = true;
};

}  // namespace detail

/// Writes a mesh of 1 to 4 channels, or with groups of up to 16, as a PLY file. A mesh that has no size, numbers that are not
/// finite, faces without their vertices, 2^31 vertices or faces, or colours that are no floats as shares, and groups that
/// check() refuses, give a Status that says so, and no byte is written; a sink that refuses bytes gives Errc::write_failed.
inline Status write_ply(const MeshView& source, Sink sink, const PlyOptions& options = {}) {
    if (const Status status = detail::check_for_ply(source, options); !status) return status;
    const auto wanted = !options.groups.is_empty() ? detail::Premultiplied::grouped
                        : options.float_colors     ? detail::Premultiplied::divided_only
                                                   : detail::Premultiplied::divided;
    const detail::ExportMesh exported(source, wanted);
    const MeshView& mesh = exported.view();
    detail::Writer writer(sink);
    detail::write_ply_header(writer, mesh, options);
    detail::PlyNumbers numbers(writer, options.ascii);
    const auto channels = static_cast<std::size_t>(mesh.channels);
    const auto put_shares = [&](const float* color, std::size_t count) {
        for (std::size_t k = 0; k < count; ++k) {
            if (options.float_colors) numbers.f32(static_cast<float>(static_cast<double>(color[k]) / mesh.peak));
            else numbers.u8(detail::to_u8(detail::share_of_peak(color[k], mesh.peak)));
        }
    };
    for (std::size_t v = 0; v < mesh.vertex_count; ++v) {
        numbers.f32(mesh.positions[2 * v]);
        numbers.f32(static_cast<float>(detail::y_up(mesh, v)));
        numbers.f32(0);
        const float* color = mesh.colors + channels * v;
        for (const ChannelGroup& group : options.groups) {
            if (group.meaning == ChannelGroup::Meaning::normal)
                for (const double x : detail::unit_normal(color, mesh.peak)) numbers.f32(static_cast<float>(x));
            else put_shares(color, static_cast<std::size_t>(group.channels));
            color += group.channels;
        }
        if (options.groups.is_empty()) put_shares(color, channels);
        numbers.end_line();
    }
    for (std::size_t f = 0; f < mesh.face_count; ++f) {
        numbers.u8(3);
        for (const std::uint32_t v : detail::turned(mesh.faces[f])) numbers.u32(v);
        numbers.end_line();
    }
    return writer.finish();
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_PLY_HPP
