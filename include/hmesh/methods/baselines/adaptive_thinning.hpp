/// \file
/// Adaptive thinning: the method of Demaret and Iske, "Advances in digital image compression by adaptive thinning" (2004).
///
///    Delaunay triangulation of all pixels -> greedy point removal to n
///
/// Colours are sampled. Adams' method is a short cut of this one, which is not always better: it is above Adams' in 39 of 90
/// meshes of 256 x 256 px and, with optimal colours for both, in 80, by 0.2 dB on average (docs/paper.md).
///
/// Cost: 8 us and 0.7 KB a pixel of the image, whatever the target.
#ifndef HMESH_METHODS_BASELINES_ADAPTIVE_THINNING_HPP
#define HMESH_METHODS_BASELINES_ADAPTIVE_THINNING_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>

#include "hmesh/core/array.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/methods/baselines/adams.hpp"
#include "hmesh/methods/stage.hpp"
#include "hmesh/options.hpp"
#include "hmesh/tiles/tiled_mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// The recipe of adaptive thinning (Demaret and Iske 2004): the Delaunay triangulation of all pixels, and greedy removal of the
/// points whose loss costs least. For small images: 8 us and 0.7 KB for each pixel, on one thread. Colours are sampled unless
/// Options::colors says otherwise. There are no options.
struct AdaptiveThinning {
    static constexpr std::int64_t max_pixels = std::int64_t{1} << 22;  ///< of an image, whose first mesh then takes 3 GB

    static constexpr const char* name = "adaptive_thinning";  ///< for reports
    static constexpr Colors colors = Colors::sampled;         ///< final colours where Options::colors says nothing

    /// Whether the image has at most max_pixels; else Errc::image_too_large with the number of pixels and that bound.
    [[nodiscard]] static Status check(int width, int height) noexcept {
        const std::int64_t pixels = std::int64_t{width} * height;
        if (pixels <= max_pixels) return {};
        return {Errc::image_too_large, "adaptive thinning starts from all pixels, and the image has too many", pixels,
                max_pixels};
    }
    /// The image's longer side in px: the image is one piece.
    [[nodiscard]] static double tile_size(int width, int height, std::size_t) noexcept { return std::max(width, height); }
    /// Replaces `mesh` by a mesh of n vertices of its image, 4 <= n <= max(4, pixels). Errc::cancelled: it is valid, with any
    /// number of vertices.
    template <int C>
    [[nodiscard]] Status run(kit::TiledMesh<C>& mesh, std::size_t n) const {
        const kit::ImageSource<C>& source = mesh.source();
        mesh.indexed() = kit::corner_mesh(source);  // the mesh after a cancellation in the first stage
        mesh.progress().plan({0.16, 0.83, 0.01});
        const bool go_on = kit::run_stage<C>(mesh, "points", [&] {
            kit::Array<std::uint32_t> pixels(static_cast<std::size_t>(source.pixels()));
            std::iota(pixels.begin(), pixels.end(), 0U);
            return kit::detail::triangulate_pixels(mesh, pixels);
        });
        return kit::finished_or_cancelled(go_on && kit::detail::remove_points(mesh, n));
    }
};

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_BASELINES_ADAPTIVE_THINNING_HPP
