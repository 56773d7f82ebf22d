/// \file
/// Adaptive thinning: the method of Demaret and Iske, "Advances in digital image compression by adaptive thinning" (2004).
///
///    Delaunay triangulation of all pixels -> greedy point removal to n
///
/// Colours are sampled. What Adams' method is a short cut of. Costs 8 us and 0.7 KB a pixel of the image, whatever the target,
/// and is not always better: above that method in 38 of 90 meshes of 256 x 256 px, with optimal colours in 80, then by 0.2 dB on
/// average (docs/paper.md).
#ifndef HMESH_METHODS_BASELINES_ADAPTIVE_THINNING_HPP
#define HMESH_METHODS_BASELINES_ADAPTIVE_THINNING_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "hmesh/methods/baselines/adams.hpp"
#include "hmesh/methods/stage.hpp"
#include "hmesh/options.hpp"
#include "hmesh/tiles/tiled_mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// Adaptive thinning, with sampled colors.
struct AdaptiveThinning {
    static constexpr std::int64_t max_pixels = std::int64_t{1} << 22;  ///< of an image: its mesh takes 3 GB at first

    static constexpr const char* name = "adaptive_thinning";
    static constexpr Colors colors = Colors::sampled;

    /// Whether the image is small enough.
    [[nodiscard]] static Status check(int width, int height) noexcept {
        const std::int64_t pixels = std::int64_t{width} * height;
        if (pixels <= max_pixels) return {};
        return {Errc::image_too_large, "adaptive thinning starts from all pixels, and the image has too many", pixels,
                max_pixels};
    }
    /// px: the image in one piece.
    [[nodiscard]] static double tile_size(int width, int height, std::size_t) noexcept { return std::max(width, height); }
    /// Makes a mesh of n vertices, 4 <= n <= max(4, pixels).
    template <int C>
    [[nodiscard]] Status run(kit::TiledMesh<C>& mesh, std::size_t n) const {
        const kit::ImageSource<C>& source = mesh.source();
        mesh.indexed() = kit::corner_mesh(source);  // what a cancellation finds
        const bool go_on = kit::run_stage<C>(mesh, "points", [&] {
            std::vector<std::uint32_t> pixels(static_cast<std::size_t>(source.pixels()));
            std::iota(pixels.begin(), pixels.end(), 0U);
            return kit::detail::triangulate_pixels(mesh, pixels);
        });
        return kit::finished_or_cancelled(go_on && kit::detail::remove_points(mesh, n));
    }
};

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_BASELINES_ADAPTIVE_THINNING_HPP
