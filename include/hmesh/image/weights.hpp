/// \file
/// Weights: how much each pixel of an image counts.
///
/// Weights are a second image of the same size with one float >= 0 a pixel; a view without data means that all pixels count the
/// same. Their unit is free: weight_unit() scales the largest to 1, so that what is measured in pixels (ridges, mean energies)
/// keeps its meaning. Scaled weights are rounded to a step, a power of two between 2^-24 and 2^-8, so that sums over them are
/// exact and cancel like those of pixels that all count 1 (WeightScale).
#ifndef HMESH_IMAGE_WEIGHTS_HPP
#define HMESH_IMAGE_WEIGHTS_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "hmesh/core/array.hpp"
#include "hmesh/core/finite.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/image/image_view.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// Whether `weights` can be the weights of a width x height image: none at all, or a view of this size that check() accepts
/// with finite samples >= 0. Otherwise invalid_argument, image_too_large or not_finite. Reads each sample once.
[[nodiscard]] inline Status check_weights(const ImageView<float, 1>& weights, int width, int height,
                                          const ParallelFor& parallel_for = {}) {
    if (weights.data == nullptr) return {};
    if (weights.width != width) return {Errc::invalid_argument, "the weights are not as wide as the image", weights.width, width};
    if (weights.height != height)
        return {Errc::invalid_argument, "the weights are not as high as the image", weights.height, height};
    if (const Status status = check(weights); !status) return status;
    enum Fault : unsigned char { none, negative, not_finite };
    Array<Fault> faults(static_cast<std::size_t>(height), none);
    for_each_chunk(parallel_for, faults.size(), 32, [&](std::size_t begin, std::size_t end) {
        for (std::size_t y = begin; y < end; ++y) {
            const float* row = weights.row(static_cast<int>(y));
            for (int x = 0; x < width; ++x) {
                if (!is_finite(row[x])) faults[y] = not_finite;
                else if (row[x] < 0 && faults[y] == none) faults[y] = negative;
            }
        }
    });
    for (std::size_t y = 0; y < faults.size(); ++y) {
        const auto row = static_cast<std::int64_t>(y);
        if (faults[y] == not_finite) return {Errc::not_finite, "the weights have one that is NaN or infinite, in row", row, 0};
        if (faults[y] == negative) return {Errc::invalid_argument, "the weights have one that is negative, in row", row, 0};
    }
    return {};
}

/// 1 / the largest weight; 1 where there are no weights or all are 0. check_weights() must accept the weights.
[[nodiscard]] inline double weight_unit(const ImageView<float, 1>& weights, const ParallelFor& parallel_for = {}) {
    if (weights.data == nullptr) return 1;
    Array<float> largest(static_cast<std::size_t>(weights.height), 0.0F);
    for_each_chunk(parallel_for, largest.size(), 32, [&](std::size_t begin, std::size_t end) {
        for (std::size_t y = begin; y < end; ++y) {
            const float* row = weights.row(static_cast<int>(y));
            largest[y] = *std::max_element(row, row + weights.width);
        }
    });
    const auto most = static_cast<double>(*std::max_element(largest.begin(), largest.end()));
    return most > 0 ? 1 / most : 1;
}

/// The number of pixels that a pixel with a given weight counts for: the weight times a unit, rounded to a multiple of step().
///
/// Unrounded, the moments of a face would keep the rounding of the sums over all pixels to its left. Its energy multiplies them
/// by the squares of the picture's slopes, so slivers, whose slopes reach 1e4 a pixel, would win by rounding alone. The step is
/// as fine as keeps the sums of w x^2, w x y and w y^2 along edges that cross at most 32 rows of the image below 2^53 steps
/// (sums along longer ones may be rounded): 2^-20 at 512 x 512 px, 2^-12 at 4000 x 3000. Sums of 8-bit samples are then exact
/// too. Weights below half a step count as 0.
class WeightScale {
  public:
    /// The scale for the weights of a width x height image; `unit` as by weight_unit().
    WeightScale(double unit, int width, int height) noexcept {
        const double w = width, h = height, rows = std::min(32, height);
        int bits = 0;  // of the largest sum
        (void)std::frexp(rows * w * std::max(w * w / 3, std::max(w * h / 2, h * h)), &bits);
        const int digits = std::max(8, std::min(24, 53 - bits));
        step_ = std::ldexp(1.0, -digits);
        factor_ = std::ldexp(unit, digits);
    }
    [[nodiscard]] double step() const noexcept { return step_; }  ///< the step, a power of two
    /// The weight scaled by the unit and rounded to a multiple of the step.
    [[nodiscard]] double operator()(float weight) const noexcept {
        return std::floor(factor_ * static_cast<double>(weight) + 0.5) * step_;
    }
    /// Reads weights of an image as a PixelReader does, scaled and rounded.
    void read(const ImageView<float, 1>& weights, int x, int y, int count, double* to) const noexcept {
        const float* const from = weights.pixel(x, y);
        for (int i = 0; i < count; ++i) to[i] = (*this)(from[i]);
    }

  private:
    double step_ = 1, factor_ = 1;
};

/// How many pixels of a width x height image count: the sum of its weights as rounded by WeightScale, added row by row; the
/// number of pixels where there are no weights.
[[nodiscard]] inline double weight_sum(const ImageView<float, 1>& weights, double unit, int width, int height,
                                       const ParallelFor& parallel_for = {}) {
    if (weights.data == nullptr) return static_cast<double>(width) * height;
    const WeightScale scale(unit, width, height);
    return ordered_sum(parallel_for, static_cast<std::size_t>(height), 32, [&](std::size_t begin, std::size_t end) {
        double sum = 0;
        for (std::size_t y = begin; y < end; ++y) {
            const float* row = weights.row(static_cast<int>(y));
            for (int x = 0; x < width; ++x) sum += scale(row[x]);
        }
        return sum;
    });
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IMAGE_WEIGHTS_HPP
