/// \file
/// What exporters have in common: which meshes they refuse, and how positions, faces and colours become what files hold.
///
/// Files of models have y up; faces that are clockwise on the screen with y down stay so, seen from the front, when two of
/// their corners change places. Files hold shares of full intensity: optimal colours may lie outside [0, peak], and are held
/// to it where a format has integers or asks for [0, 1]. No format knows grey with alpha: such a mesh is written as red, green,
/// blue and alpha, the first three equal.
///
/// Pictures (SVG, PDF, EPS, the web page) of periodic meshes have copies of faces wherever these touch the image's rectangle
/// (mesh/unrolled.hpp), so that it is covered; models and GPU buffers hold the mesh as it is, to be repeated by who loads it.
#ifndef HMESH_IO_DETAIL_EXPORT_MESH_HPP
#define HMESH_IO_DETAIL_EXPORT_MESH_HPP

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "hmesh/core/array.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/mesh/torus.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

// --- what is refused ---

/// How many vertices, and how many faces, readers of most formats can number.
inline constexpr std::uint64_t most_numbered = std::numeric_limits<std::int32_t>::max();

/// Refuses a mesh of more vertices or faces than a format numbers, with the sentence `what`; reads none of them.
[[nodiscard]] inline Status check_counts(const MeshView& mesh, std::uint64_t most_vertices, std::uint64_t most_faces,
                                         const char* what) noexcept {
    const std::array<std::array<std::uint64_t, 2>, 2> limits = {
        {{mesh.vertex_count, most_vertices}, {mesh.face_count, most_faces}}};
    constexpr std::uint64_t most_reported = std::numeric_limits<std::int64_t>::max();
    for (const auto& [count, most] : limits)
        if (count > most)
            return {Errc::invalid_argument, what, static_cast<std::int64_t>(std::min(count, most_reported)),
                    static_cast<std::int64_t>(most)};
    return {};
}

/// Refuses a mesh without a size in px, which for one of points is that between them, and what check() refuses, more than
/// `most_channels` among it. O(n).
[[nodiscard]] inline Status check_for_export(const MeshView& mesh, int most_channels = 4) noexcept {
    if (mesh.width < 1) return {Errc::invalid_argument, "the mesh's width must be at least 1", mesh.width, 1};
    if (mesh.height < 1) return {Errc::invalid_argument, "the mesh's height must be at least 1", mesh.height, 1};
    if (mesh.right() < 1 || mesh.bottom() < 1)
        return {Errc::invalid_argument, "a mesh whose samples are points must have at least 2 along each axis",
                std::min(mesh.width, mesh.height), 2};
    return check(mesh, most_channels);
}

// --- positions and faces ---

/// The y of a vertex in px with y up: 0 at the lower side of the image, mesh.bottom() at the upper one.
[[nodiscard]] inline double y_up(const MeshView& mesh, std::size_t vertex) noexcept {
    return mesh.bottom() - static_cast<double>(mesh.positions[2 * vertex + 1]);
}

/// The corners of a face in the order that makes it counter-clockwise, seen from the front, with y up.
[[nodiscard]] inline Triangle turned(const Triangle& face) noexcept { return {face[0], face[2], face[1]}; }

// --- colours ---

/// A stored value as a share of the peak, held to [0, 1].
[[nodiscard]] inline double share_of_peak(float value, double peak) noexcept {
    return std::max(0.0, std::min(1.0, static_cast<double>(value) / peak));
}

/// A share in [0, 1] as an integer of 8 bits, rounded; 255 is full intensity.
[[nodiscard]] inline std::uint8_t to_u8(double share) noexcept { return static_cast<std::uint8_t>(share * 255 + 0.5); }
/// A share in [0, 1] as an integer of 16 bits, rounded; 65535 is full intensity.
[[nodiscard]] inline std::uint16_t to_u16(double share) noexcept { return static_cast<std::uint16_t>(share * 65535 + 0.5); }

/// Red, green, blue and alpha of a colour of 1 to 4 channels as shares in [0, 1]. One channel is all three colours, of 2 or 4 the
/// last is alpha, and what has none is opaque.
[[nodiscard]] inline std::array<double, 4> rgba_shares(const float* color, int channels, double peak) noexcept {
    const auto share = [&](int k) { return share_of_peak(color[k], peak); };
    if (channels < 3) return {share(0), share(0), share(0), channels == 2 ? share(1) : 1.0};
    return {share(0), share(1), share(2), channels == 4 ? share(3) : 1.0};
}
/// The same of a vertex.
[[nodiscard]] inline std::array<double, 4> rgba_shares(const MeshView& mesh, std::size_t vertex) noexcept {
    return rgba_shares(mesh.colors + static_cast<std::size_t>(mesh.channels) * vertex, mesh.channels, mesh.peak);
}

/// How a format wants the colours of meshes that are premultiplied, that is stored multiplied by alpha / peak.
enum class Premultiplied : std::uint8_t {
    kept,          ///< as they are; the view says whether they are premultiplied
    divided,       ///< divided by alpha / peak and held to [0, peak]
    divided_only,  ///< divided, and held only to what floats can say, as shares of the peak too
    grouped,       ///< as they are, of 2 channels too: groups say what each of them means
};

/// A mesh as exporters write it: with 1, 3 or 4 channels, but as many as it has where they are grouped, and, if it is so wanted,
/// straight colours. Where the mesh has them already it is a view of it and nothing is copied; else it has colours of its own,
/// 16 bytes a vertex.
///
/// Vertices without alpha have no straight colour. They take the mean of those with which they share faces, weighted by
/// alpha, so that no fringe runs into the faces between; black where all of those are transparent. Between vertices the
/// picture is that of straight colours, which is the premultiplied one where alpha or the colour does not change.
/// O(vertices + faces).
class ExportMesh {
  public:
    /// Of a mesh that check_for_export() accepts and that outlives this one.
    ExportMesh(const MeshView& mesh, Premultiplied wanted) : view_(mesh) {
        if (wanted == Premultiplied::grouped) return;
        if (mesh.channels == 2) spread_gray();
        if (wanted != Premultiplied::kept && view_.premultiplied && view_.channels == 4)
            divide_by_alpha(wanted == Premultiplied::divided);
    }
    ExportMesh(const ExportMesh&) = delete;
    ExportMesh& operator=(const ExportMesh&) = delete;

    /// Valid as long as this object.
    [[nodiscard]] const MeshView& view() const noexcept { return view_; }

  private:
    void spread_gray() {
        colors_.reserve(4 * view_.vertex_count);
        for (std::size_t v = 0; v < view_.vertex_count; ++v) {
            for (int k = 0; k < 3; ++k) colors_.push_back(view_.colors[2 * v]);
            colors_.push_back(view_.colors[2 * v + 1]);
        }
        view_.colors = colors_.data();
        view_.channels = 4;
    }

    void divide_by_alpha(bool is_held) {
        if (colors_.empty()) colors_.assign(view_.colors, view_.colors + 4 * view_.vertex_count);
        const auto value = [&](std::size_t v, std::size_t k) { return static_cast<double>(colors_[4 * v + k]); };
        kit::Array<double> sums;  // of vertices without alpha: what their neighbours have, a neighbour for each face shared
        for (std::size_t f = 0; f < view_.face_count; ++f)
            for (const std::uint32_t v : view_.faces[f]) {
                if (value(v, 3) > 0) continue;
                if (sums.empty()) sums.resize(4 * view_.vertex_count);
                for (const std::uint32_t other : view_.faces[f])
                    for (std::size_t k = 0; k < 4 && value(other, 3) > 0; ++k) sums[4 * std::size_t{v} + k] += value(other, k);
            }
        if (!sums.empty() && view_.periodic != Periodic::none) add_up_copies(sums);
        // Half of the largest float: a share is a float too where the peak is below 1, and rounding leads to no infinity.
        const double most =
            is_held ? view_.peak : 0.5 * static_cast<double>(std::numeric_limits<float>::max()) * std::min(1.0, view_.peak);
        const double least = is_held ? 0 : -most;
        for (std::size_t v = 0; v < view_.vertex_count; ++v) {
            const bool is_clear = !(value(v, 3) > 0);
            const auto part = [&](std::size_t k) { return !is_clear ? value(v, k) : sums.empty() ? 0.0 : sums[4 * v + k]; };
            for (std::size_t k = 0; k < 3; ++k) {
                const double color = part(3) > 0 ? part(k) * view_.peak / part(3) : 0;
                colors_[4 * v + k] = static_cast<float>(std::max(least, std::min(most, color)));
            }
        }
        view_.colors = colors_.data();
        view_.premultiplied = false;
    }

    // Gives the copies of a vertex on the border the sum of what they have: they are one vertex, and keep one colour.
    void add_up_copies(kit::Array<double>& sums) const {
        const kit::Array<std::uint32_t> roots =
            kit::tied_vertices(kit::positions_of(view_), {view_.width, view_.height, view_.periodic});
        for (std::size_t v = 0; v < roots.size(); ++v)
            for (std::size_t k = 0; k < 4 && roots[v] != v; ++k) sums[4 * std::size_t{roots[v]} + k] += sums[4 * v + k];
        for (std::size_t v = 0; v < roots.size(); ++v)
            for (std::size_t k = 0; k < 4; ++k) sums[4 * v + k] = sums[4 * std::size_t{roots[v]} + k];
    }

    MeshView view_;
    kit::Array<float> colors_;  // 4 a vertex, or none
};

}  // namespace hmesh::detail

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_DETAIL_EXPORT_MESH_HPP
