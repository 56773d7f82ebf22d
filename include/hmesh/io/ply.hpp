/// \file
/// write_ply(): a mesh as a PLY file, which MeshLab, CloudCompare, Blender and others open.
///
/// Vertices are `float x y z` in pixels with y up (y = height - y of the mesh) and z = 0, so that the picture stands upright;
/// faces are counter-clockwise, so that it is seen from the front. Colours are `uchar red green blue` for 3 channels, with
/// `alpha` for 4 and for grey with alpha, one `uchar intensity` for 1; 255 is the mesh's peak, and alpha is straight. The file is
/// binary and little-endian unless it is asked to be text.
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

#include "hmesh/core/status.hpp"
#include "hmesh/core/version.hpp"
#include "hmesh/io/detail/export_mesh.hpp"
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
};

namespace detail {

/// Refuses what a PLY file cannot hold. O(n).
[[nodiscard]] inline Status check_for_ply(const MeshView& mesh, const PlyOptions& options) noexcept {
    constexpr std::uint64_t most = std::numeric_limits<std::int32_t>::max();
    if (const Status status = check_counts(mesh, most, most, "the mesh has more vertices or faces than a PLY file numbers");
        !status)
        return status;
    if (const Status status = check_for_export(mesh); !status) return status;
    const auto channels = static_cast<std::size_t>(mesh.channels);
    constexpr auto largest = static_cast<double>(std::numeric_limits<float>::max());
    if (options.float_colors)
        for (std::size_t i = 0; i < channels * mesh.vertex_count; ++i)
            if (std::abs(static_cast<double>(mesh.colors[i]) / mesh.peak) > largest)
                return {Errc::not_finite, "the mesh has a colour whose share of the peak no float holds, at vertex",
                        static_cast<std::int64_t>(i / channels), 0};
    return {};
}

/// The lines before the numbers.
inline void write_ply_header(Writer& writer, const MeshView& mesh, const PlyOptions& options) {
    writer.text(options.ascii ? "ply\nformat ascii 1.0\n" : "ply\nformat binary_little_endian 1.0\n");
    writer.text("comment made by hmesh " HMESH_VERSION_STRING "\nelement vertex ");
    writer.decimal(static_cast<std::int64_t>(mesh.vertex_count));
    writer.text("\nproperty float x\nproperty float y\nproperty float z\n");
    constexpr std::array<const char*, 4> rgba{"red", "green", "blue", "alpha"};
    for (std::size_t k = 0; k < static_cast<std::size_t>(mesh.channels); ++k) {
        writer.text(options.float_colors ? "property float " : "property uchar ");
        writer.text(mesh.channels == 1 ? "intensity" : rgba[k]);
        writer.text("\n");
    }
    writer.text("element face ");
    writer.decimal(static_cast<std::int64_t>(mesh.face_count));
    writer.text("\nproperty list uchar int vertex_indices\nend_header\n");
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

/// Writes a mesh of 1 to 4 channels as a PLY file. A mesh that has no size, numbers that are not finite, faces without their
/// vertices, 2^31 vertices or faces, or colours that are no floats as shares gives a Status that says so, and no byte is
/// written; a sink that refuses bytes gives Errc::write_failed.
inline Status write_ply(const MeshView& source, Sink sink, const PlyOptions& options = {}) {
    if (const Status status = detail::check_for_ply(source, options); !status) return status;
    const auto wanted = options.float_colors ? detail::Premultiplied::divided_only : detail::Premultiplied::divided;
    const detail::ExportMesh exported(source, wanted);
    const MeshView& mesh = exported.view();
    detail::Writer writer(sink);
    detail::write_ply_header(writer, mesh, options);
    detail::PlyNumbers numbers(writer, options.ascii);
    const auto channels = static_cast<std::size_t>(mesh.channels);
    for (std::size_t v = 0; v < mesh.vertex_count; ++v) {
        numbers.f32(mesh.positions[2 * v]);
        numbers.f32(static_cast<float>(detail::y_up(mesh, v)));
        numbers.f32(0);
        for (std::size_t k = 0; k < channels; ++k) {
            const float value = mesh.colors[channels * v + k];
            if (options.float_colors) numbers.f32(static_cast<float>(static_cast<double>(value) / mesh.peak));
            else numbers.u8(detail::to_u8(detail::share_of_peak(value, mesh.peak)));
        }
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
