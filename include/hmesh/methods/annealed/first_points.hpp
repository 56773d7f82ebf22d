/// \file
/// First points: where the vertices of the first mesh stand, many where the image bends and few where it is flat.
///
/// A piecewise linear picture errs with the second derivatives: the density of points follows their magnitude to the power 3 / 4,
/// plus a tenth of its mean, so that no part is without points. (Powers from 0.4 to 1 change the mesh by 0.05 dB.)
///
/// A pixel becomes a point if its value in a mask, evenly distributed in [0, 1), is below its density times a factor: each pixel
/// decides by itself, which error diffusion does not allow, and any tiles and threads choose the same points. The mask is the R2
/// sequence, x / g + y / g^2 modulo 1 with g^3 = g + 1 (M. Roberts, "The unreasonable effectiveness of quasirandom sequences",
/// 2018), whose values nearby differ as much as they can.
///
/// Cost: some 30 ns a pixel of 3 channels, 4 bytes a pixel.
#ifndef HMESH_METHODS_ANNEALED_FIRST_POINTS_HPP
#define HMESH_METHODS_ANNEALED_FIRST_POINTS_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "hmesh/core/assert.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/fit/image_source.hpp"
#include "hmesh/image/image_view.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {
namespace detail {

/// Rows of one channel of an image, smoothed once by the binomial filter [1 2 1] / 4 in both directions.
struct SmoothRows {
    int width = 0;               ///< px
    std::vector<double> values;  ///< row after row
    [[nodiscard]] double* row(int k) noexcept {
        return values.data() + static_cast<std::size_t>(k) * static_cast<std::size_t>(width);
    }
    /// Smooths rows 0 .. count + 1 into rows 0 .. count - 1.
    void smooth(int count) noexcept {
        for (int k = 0; k < count; ++k) {
            double *above = row(k), *here = row(k + 1), *below = row(k + 2);
            for (int x = 0; x < width; ++x) above[x] = 0.25 * above[x] + 0.5 * here[x] + 0.25 * below[x];
            double left = above[0];
            for (int x = 0; x < width; ++x) {
                const double value = above[x], right = above[std::min(x + 1, width - 1)];
                above[x] = 0.25 * left + 0.5 * value + 0.25 * right;
                left = value;
            }
        }
    }
};

/// Adds to `to`, for each pixel of a row, the largest magnitude of a second directional derivative.
inline void add_bends(const double* above, const double* here, const double* below, int width, float* to) noexcept {
    for (int x = 0; x < width; ++x) {
        const int left = std::max(0, x - 1), right = std::min(width - 1, x + 1);
        const double xx = here[left] - 2 * here[x] + here[right], yy = above[x] - 2 * here[x] + below[x];
        const double xy = 0.25 * (above[left] + below[right] - above[right] - below[left]);
        const double half = 0.5 * (xx - yy), largest = 0.5 * std::abs(xx + yy) + std::sqrt(half * half + xy * xy);
        to[x] = static_cast<float>(
            std::min(static_cast<double>(to[x]) + largest, static_cast<double>(std::numeric_limits<float>::max())));
    }
}

/// The mask at a pixel, in [0, 1).
[[nodiscard]] inline double mask_at(int x, int y) noexcept {
    const double value = 0.7548776662466927 * (x + 1) + 0.5698402909980532 * (y + 1);
    return value - std::floor(value);
}

}  // namespace detail

/// The density of points that the image asks for, one value > 0 a pixel; only their ratios matter. Weights count as their square
/// roots, since errors do. Bands of 32 rows are pieces of work. go_on(), where set, is called before each, on any thread; once it
/// says false, the result is meaningless.
template <int C>
[[nodiscard]] HMESH_COLD Image<float, 1> point_density(const ImageSource<C>& source, const ParallelFor& parallel_for,
                                                       FunctionRef<bool()> go_on = {}) {
    const int width = source.width(), height = source.height();
    Image<float, 1> density(width, height);
    const auto rows = static_cast<std::size_t>(height);
    constexpr std::size_t band = 32;
    std::vector<double> sums((rows + band - 1) / band, 0.0);
    const double scale = 1 / source.peak();
    for_each_chunk(parallel_for, rows, band, [&](std::size_t begin, std::size_t end) {
        if (go_on && !go_on()) return;
        const int first = static_cast<int>(begin), count = static_cast<int>(end - begin);
        const std::size_t size = static_cast<std::size_t>(width) * static_cast<std::size_t>(count + 4);
        std::vector<detail::SmoothRows> planes(std::size_t{C}, {width, std::vector<double>(size)});
        for (int k = 0; k < count + 4; ++k)
            for (int x = 0; x < width; ++x) {
                const auto pixel = source.pixel(x, first + k - 2);
                for (int c = 0; c < C; ++c) planes[static_cast<std::size_t>(c)].row(k)[x] = pixel[c] * scale;
            }
        double sum = 0;
        for (detail::SmoothRows& plane : planes) plane.smooth(count + 2);
        for (int k = 0; k < count; ++k) {
            const int y = first + k;
            float* const row = density.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
            for (detail::SmoothRows& plane : planes)
                detail::add_bends(plane.row(k), plane.row(k + 1), plane.row(k + 2), width, row);
            for (int x = 0; x < width; ++x) {
                const double root = std::sqrt(static_cast<double>(row[x]) * std::sqrt(source.weight(x, y))),
                             value = root * std::sqrt(root);
                row[x] = static_cast<float>(value);
                sum += value;
            }
        }
        sums[begin / band] = sum;
    });
    double sum = 0;
    for (const double of_band : sums) sum += of_band;
    const double least = std::max(0.1 * sum / source.pixels(), static_cast<double>(std::numeric_limits<float>::min()));
    for (std::size_t k = 0; k < density.size(); ++k) density.data()[k] += static_cast<float>(least);
    return density;
}

/// The `count` pixels, as y * width + x, whose ratio of mask and density is least; of equal ratios those that come first, row by
/// row. 0 <= count <= pixels. `density` is left with these ratios.
[[nodiscard]] inline std::vector<std::uint32_t> masked_points(Image<float, 1>& density, std::size_t count) {
    HMESH_ASSERT(count <= density.size());
    const int width = density.width(), height = density.height();
    // Positive floats are in the order of their bits: the threshold is found by their upper half, then by their lower half.
    const auto bits_of = [](float value) {
        std::uint32_t bits = 0;
        std::memcpy(&bits, &value, sizeof bits);
        return bits;
    };
    std::vector<std::size_t> histogram(65536, 0);
    float* at = density.data();
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x, ++at) {
            *at = static_cast<float>((detail::mask_at(x, y) + 1e-6) / static_cast<double>(*at));
            ++histogram[bits_of(*at) >> 16U];
        }
    std::size_t left = count;  // to be taken from the bin
    const auto bin_of_last = [&] {
        std::uint32_t bin = 0;
        while (left > histogram[bin]) left -= histogram[bin++];
        return bin;
    };
    const std::uint32_t upper = bin_of_last();
    std::fill(histogram.begin(), histogram.end(), 0);
    for (std::size_t k = 0; k < density.size(); ++k)
        if (const std::uint32_t bits = bits_of(density.data()[k]); bits >> 16U == upper) ++histogram[bits & 65535U];
    const std::uint32_t threshold = upper << 16U | bin_of_last();
    std::vector<std::uint32_t> points;
    points.reserve(count);
    for (std::size_t k = 0; k < density.size(); ++k) {
        const std::uint32_t bits = bits_of(density.data()[k]);
        if (bits > threshold || (bits == threshold && left == 0)) continue;
        left -= bits == threshold ? 1 : 0;
        points.push_back(static_cast<std::uint32_t>(k));
    }
    return points;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_ANNEALED_FIRST_POINTS_HPP
