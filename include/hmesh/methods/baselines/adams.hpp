/// \file
/// Adams: the method of Adams, "A flexible content-adaptive mesh-generation strategy for image representation" (2011).
///
///     feature map -> error diffusion to d n points -> Delaunay triangulation -> greedy point removal to n
///
/// Colours are sampled, and edges are Delaunay edges whatever the picture. The paper compares itself with this method, and
/// starts from its meshes.
///
/// Cost: some 40 us a vertex of the result.
#ifndef HMESH_METHODS_BASELINES_ADAMS_HPP
#define HMESH_METHODS_BASELINES_ADAMS_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "hmesh/core/array.hpp"
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

/// Replaces the mesh by the Delaunay triangulation of the image's corners and of these pixels, given as y * width + x, with the
/// pixels' colours, and measures it. False: cancelled.
template <int C>
bool triangulate_pixels(TiledMesh<C>& tiled, const Array<std::uint32_t>& pixels) {
    const ImageSource<C>& source = tiled.source();
    {
        Delaunay mesh(source.width(), source.height(), source.samples());
        if (!insert_pixels(mesh, pixels, [&] { return tiled.progress().poll(); })) return false;
        tiled.indexed() = uncolored_mesh(source, mesh);
    }
    take_colors(tiled.indexed(), source);
    tiled.progress().set_range(1, 1);
    return tiled.for_each(one_tile(source), [](Patch<C>&, std::size_t) {});  // makes the patch, which has the energy
}

/// Removes the cheapest points until n vertices are left (methods/baselines/point_removal.hpp), as a stage. False: cancelled.
template <int C>
bool remove_points(TiledMesh<C>& tiled, std::size_t n) {
    return run_one_tile_stage<C>(tiled, "removal", [&](ImageMesh<C>& mesh) { PointRemoval<C>(mesh).remove_down_to(n); });
}

}  // namespace kit::detail

/// The recipe of Adams' method (2011): error-diffused points with a density that follows the second derivatives of the image,
/// their Delaunay triangulation, and greedy removal of the points whose loss costs least. Colours are sampled unless
/// Options::colors says otherwise. The whole image is one piece of work, on one thread but for the feature map; some 40 us a
/// vertex.
struct Adams {
    /// Points before the removal, in units of the target, in [1, 1000]; at most one for each pixel. Time is proportional to it.
    /// Lena at 1 % has 27.06 dB with 2, 28.05 with 4.5, 28.21 with 8; Fruits 26.30, 27.03 and 27.12 (docs/paper.md).
    double density = 4.5;
    /// Passes of the binomial filter [1 2 1] / 4 before the derivatives, in [0, 100]; 0 costs 0.1 to 0.4 dB on Lena and Fruits.
    int smoothing = 3;

    static constexpr const char* name = "adams";       ///< for reports
    static constexpr Colors colors = Colors::sampled;  ///< final colours where Options::colors says nothing

    /// Whether all options are in range, for images of any size; else Errc::invalid_argument with the offending value and its
    /// bound.
    [[nodiscard]] Status check(int = 1, int = 1) const noexcept {
        return kit::check_ranges({{"adams density must be in [1, 1000]", density, 1, 1000},
                                  {"adams smoothing must be in [0, 100] passes", static_cast<double>(smoothing), 0, 100}});
    }
    /// The image's longer side in px: the image is one piece.
    [[nodiscard]] static double tile_size(int width, int height, std::size_t) noexcept { return std::max(width, height); }
    /// Replaces `mesh` by a mesh of n vertices of its image, 4 <= n <= max(4, pixels). Errc::cancelled: it is valid, with any
    /// number of vertices.
    template <int C>
    [[nodiscard]] Status run(kit::TiledMesh<C>& mesh, std::size_t n) const {
        const kit::ImageSource<C>& source = mesh.source();
        mesh.indexed() = kit::corner_mesh(source);  // the mesh after a cancellation in the first stage
        mesh.progress().plan({0.3, 0.67, 0.03});
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
