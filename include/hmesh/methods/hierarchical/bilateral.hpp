/// \file
/// Bilateral filter: smooths an image and keeps its edges.
///
/// Tomasi and Manduchi, "Bilateral filtering for gray and color images" (1998): each pixel becomes the mean of the pixels in a
/// disc around it, weighted by nearness in the plane and in colour. Window, distance of colours (L1) and border follow OpenCV's
/// bilateralFilter, in whose parameters the paper states its filter: diameter 9, both sigmas 50.
///
/// Cost: 9 ns a pixel of 3 channels, and for each tap of the disc (49 at diameter 9) some 0.5 ns with vectors of 8 floats, 1.1
/// ns with vectors of 4. Memory beyond the output: the planes of a tile, some 300 kB a thread at diameter 9 and 1 MB at diameter
/// 99, whatever the image's size.
#ifndef HMESH_METHODS_HIERARCHICAL_BILATERAL_HPP
#define HMESH_METHODS_HIERARCHICAL_BILATERAL_HPP

#include <algorithm>
#include <cstddef>
#include <limits>

#include "hmesh/core/assert.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/methods/hierarchical/bilateral_tile.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// Options of bilateral_filter().
struct BilateralOptions {
    int diameter = 9;         ///< of the window, px, in [1, 99]; its radius is diameter / 2 rounded down
    double sigma_color = 50;  ///< of the weight by colour, in 1/255 of the peak of the pixel type, finite, at least 1e-300
    double sigma_space = 50;  ///< of the weight by distance, px, finite, at least 1e-300
};

/// Whether all options are in range: Errc::invalid_argument for the first that is not, with its name, value and bound.
[[nodiscard]] inline Status check(const BilateralOptions& options) noexcept {
    constexpr double most = std::numeric_limits<double>::max();
    return check_ranges({{"bilateral diameter must be in [1, 99] px", static_cast<double>(options.diameter), 1, 99},
                         {"bilateral sigma_color must be at least 1e-300, and finite", options.sigma_color, 1e-300, most},
                         {"bilateral sigma_space must be at least 1e-300, and finite", options.sigma_space, 1e-300, most}});
}

/// The view filtered, an image of the same size; samples are rounded by PixelTraits<T>::from_real(). The distance of two colours
/// is the sum over channels of their absolute differences, in stored values. Beyond the border the image is mirrored without
/// repeating the outermost pixels. check() must accept the view and the options, and float samples must be finite. Bands of 64
/// rows are pieces of work; 34 ns a pixel of 3 channels at diameter 9 with vectors of 8 floats.
template <class T, int C>
[[nodiscard]] Image<T, C> bilateral_filter(const ImageView<T, C>& view, const BilateralOptions& options = {},
                                           const ParallelFor& parallel_for = {}) {
    HMESH_ASSERT(check(view) && check(options));
    using Tile = detail::BilateralTile<C>;
    const double sigma_color = std::max(Tile::template min_sigma<T>, options.sigma_color * (PixelTraits<T>::peak / 255));
    const detail::BilateralWindow window(options.diameter / 2, sigma_color, options.sigma_space);
    Image<T, C> out(view.width, view.height);
    const auto rows = static_cast<std::size_t>(view.height);
    for_each_chunk(parallel_for, rows, Tile::max_height, [&](std::size_t begin, std::size_t end) {
        Tile tile(window, view.width);
        const int y = static_cast<int>(begin), height = static_cast<int>(end - begin);
        for (int x = 0; x < view.width; x += Tile::max_width)
            tile.filter(view, {x, y, std::min(Tile::max_width, view.width - x), height}, out);
    });
    return out;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_HIERARCHICAL_BILATERAL_HPP
