/// \file
/// Adams: the method of Adams, "A flexible content-adaptive mesh-generation strategy for image representation" (2011).
///
///     feature map -> error diffusion to d n points -> Delaunay triangulation -> greedy point removal to n
///
/// Colours are sampled; edges are Delaunay edges whatever the picture. The paper's baseline, and where it starts from. Some
/// 40 us a vertex of the result.
#ifndef HMESH_METHODS_BASELINES_ADAMS_HPP
#define HMESH_METHODS_BASELINES_ADAMS_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/core/status.hpp"
#include "hmesh/mesh/delaunay.hpp"
#include "hmesh/mesh/spatial_order.hpp"
#include "hmesh/methods/baselines/error_diffusion.hpp"
#include "hmesh/methods/baselines/feature_map.hpp"
#include "hmesh/methods/baselines/point_removal.hpp"
#include "hmesh/methods/stage.hpp"
#include "hmesh/options.hpp"
#include "hmesh/tiles/delaunay_mesh.hpp"
#include "hmesh/tiles/indexed_mesh.hpp"
#include "hmesh/tiles/tiled_mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {
namespace kit::detail {

/// The Delaunay triangulation of the corners and of these pixels, with their colours, in place of what work had. False: cancelled.
template <int C>
bool triangulate_pixels(TiledMesh<C>& tiled, const std::vector<std::uint32_t>& pixels) {
    const ImageSource<C>& source = tiled.source();
    const int width = source.width(), height = source.height();
    const auto place = [&](std::uint32_t pixel) { return pixel_vertex(pixel, width, height); };
    Delaunay mesh(width, height);
    mesh.reserve(pixels.size() + 4);
    std::size_t done = 0;
    for (const std::uint32_t pixel : in_spatial_order<std::uint32_t>(pixels, pixels.size(), place)) {
        if (++done % 4096 == 0 && !tiled.progress().poll()) return false;
        (void)mesh.insert(place(pixel));
    }
    tiled.indexed() = delaunay_mesh(source, mesh);
    tiled.progress().set_range(1, 1);
    return tiled.for_each(one_tile(source), [](Patch<C>&, std::size_t) {});  // from here on its energy is known
}

/// Removal to n vertices, as a stage.
template <int C>
bool remove_points(TiledMesh<C>& tiled, std::size_t n) {
    return run_whole_stage<C>(tiled, "removal", [&](ImageMesh<C>& mesh) { PointRemoval<C>(mesh).remove_down_to(n); });
}

}  // namespace kit::detail

/// Adams' method, with sampled colors.
struct Adams {
    /// Points before the removal, in units of the target, in [1, 1000], as far as there are pixels. They cost time in
    /// proportion: / Lena at 1 % has 27.06 dB with 2, 28.05 with 4.5, 28.21 with 8; Fruits 26.29, 27.14 and 27.06.
    double density = 4.5;
    int smoothing =
        3;  ///< passes of [1 2 1] / 4 before the derivatives, in [0, 100]; none costs 0.1 to 0.4 dB on Lena and Fruits

    static constexpr const char* name = "adams";
    static constexpr Colors colors = Colors::sampled;

    /// Whether the options mean something.
    [[nodiscard]] Status check(int = 1, int = 1) const noexcept {
        return kit::check_ranges({{"adams density must be in [1, 1000]", density, 1, 1000},
                                  {"adams smoothing must be in [0, 100] passes", static_cast<double>(smoothing), 0, 100}});
    }
    /// px: the image in one piece.
    [[nodiscard]] static double tile_size(int width, int height, std::size_t) noexcept { return std::max(width, height); }
    /// Makes a mesh of n vertices, 4 <= n <= max(4, pixels).
    template <int C>
    [[nodiscard]] Status run(kit::TiledMesh<C>& mesh, std::size_t n) const {
        const kit::ImageSource<C>& source = mesh.source();
        mesh.indexed() = kit::corner_mesh(source);  // what a cancellation finds
        const bool go_on = kit::run_stage<C>(mesh, "points", [&] {
            const double wanted = std::ceil(density * static_cast<double>(n));
            const auto count = static_cast<std::size_t>(std::min(source.pixels(), wanted));
            const Image<float, 1> map = kit::feature_map(source, smoothing, mesh.parallel_for());
            const auto points = kit::diffused_points(map.view(), count, [&] { return mesh.progress().poll(); });
            return !points.empty() && kit::detail::triangulate_pixels(mesh, points);
        });
        return kit::finished_or_cancelled(go_on && kit::detail::remove_points(mesh, n));
    }
};

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_BASELINES_ADAMS_HPP
