// hmesh - straight colours of premultiplied meshes, for formats that know no others.
#ifndef HMESH_IO_DETAIL_STRAIGHT_COLORS_HPP
#define HMESH_IO_DETAIL_STRAIGHT_COLORS_HPP

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "hmesh/mesh/mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

// A mesh as it is or, if it is premultiplied and has alpha, with colours of its own that are divided by it: color * peak /
// alpha at each vertex, held to [0, peak] or else to what floats hold, as shares of the peak too. Vertices without alpha have
// no colour; they take the mean of those with which they share faces, weighted by alpha, so that no fringe runs into the faces
// between; none, 0, where all are transparent. Between vertices the picture is that of straight colours, which agrees with the
// premultiplied one where alpha or the colour does not change. Of a mesh that check() accepts and that outlives this one.
// O(vertices + faces).
class StraightMesh {
  public:
    explicit StraightMesh(const MeshView& mesh, bool is_held = true) : view_(mesh) {
        if (!mesh.premultiplied || (mesh.channels != 2 && mesh.channels != 4)) return;
        const auto channels = static_cast<std::size_t>(mesh.channels), alpha = channels - 1;
        const auto from = [&](std::size_t v, std::size_t k) { return static_cast<double>(mesh.colors[channels * v + k]); };
        std::vector<double> sums;  // of vertices without alpha: what their neighbours have, a neighbour for each face shared
        for (std::size_t f = 0; f < mesh.face_count; ++f)
            for (const std::uint32_t v : mesh.faces[f]) {
                if (from(v, alpha) > 0) continue;
                if (sums.empty()) sums.resize(channels * mesh.vertex_count);
                for (const std::uint32_t other : mesh.faces[f])
                    for (std::size_t k = 0; k < channels && from(other, alpha) > 0; ++k) sums[channels * v + k] += from(other, k);
            }
        const double most =
            is_held ? mesh.peak : 0.5 * static_cast<double>(std::numeric_limits<float>::max()) * std::min(1.0, mesh.peak);
        const double least = is_held ? 0 : -most;
        colors_.resize(channels * mesh.vertex_count);
        for (std::size_t v = 0; v < mesh.vertex_count; ++v) {
            const bool is_clear = !(from(v, alpha) > 0);
            const auto part = [&](std::size_t k) { return !is_clear ? from(v, k) : sums.empty() ? 0.0 : sums[channels * v + k]; };
            for (std::size_t k = 0; k < alpha; ++k) {
                const double color = part(alpha) > 0 ? part(k) * mesh.peak / part(alpha) : 0;
                colors_[channels * v + k] = static_cast<float>(std::max(least, std::min(most, color)));
            }
            colors_[channels * v + alpha] = mesh.colors[channels * v + alpha];
        }
        view_.colors = colors_.data();
        view_.premultiplied = false;
    }
    StraightMesh(const StraightMesh&) = delete;
    StraightMesh& operator=(const StraightMesh&) = delete;

    [[nodiscard]] const MeshView& view() const noexcept { return view_; }

  private:
    MeshView view_;
    std::vector<float> colors_;
};

}  // namespace hmesh::detail

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_DETAIL_STRAIGHT_COLORS_HPP
