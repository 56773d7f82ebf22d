// hmesh - weights: how much each pixel of an image counts.
//
// Weights are a second image of the same size with one float a pixel, >= 0; a view without data means that all pixels
// count alike. Their unit is free: weight_unit() makes the largest 1, so that what is measured in pixels (ridges, mean
// energies) keeps its meaning.
#ifndef HMESH_IMAGE_WEIGHTS_HPP
#define HMESH_IMAGE_WEIGHTS_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/core/parallel.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/image/image_view.hpp"

namespace hmesh {

// Whether these can be the weights of a width x height image: none at all, or a view of this size that check() accepts
// with samples that are finite and not negative. Reads each once.
template <class ParallelFor = SerialFor>
[[nodiscard]] Status check_weights(const ImageView<float, 1>& weights, int width, int height,
                                   const ParallelFor& parallel_for = {}) {
    if (weights.data == nullptr) return {};
    if (weights.width != width)
        return {Errc::invalid_argument, "the weights are not as wide as the image", weights.width, width};
    if (weights.height != height)
        return {Errc::invalid_argument, "the weights are not as high as the image", weights.height, height};
    if (const Status status = check(weights); !status) return status;
    enum Fault : unsigned char { none, negative, not_finite };
    std::vector<Fault> faults(static_cast<std::size_t>(height), none);
    for_each_chunk(parallel_for, faults.size(), 32, [&](std::size_t begin, std::size_t end) {
        for (std::size_t y = begin; y < end; ++y) {
            const float* row = weights.row(static_cast<int>(y));
            for (int x = 0; x < width; ++x) {
                if (!std::isfinite(row[x])) faults[y] = not_finite;
                else if (row[x] < 0 && faults[y] == none) faults[y] = negative;
            }
        }
    });
    for (std::size_t y = 0; y < faults.size(); ++y) {
        const auto row = static_cast<std::int64_t>(y);
        if (faults[y] == not_finite)
            return {Errc::not_finite, "the weights have one that is NaN or infinite, in row", row, 0};
        if (faults[y] == negative)
            return {Errc::invalid_argument, "the weights have one that is negative, in row", row, 0};
    }
    return {};
}

// 1 / the largest weight; 1 where there are no weights or all are 0. Of weights that check_weights() accepts.
template <class ParallelFor = SerialFor>
[[nodiscard]] double weight_unit(const ImageView<float, 1>& weights, const ParallelFor& parallel_for = {}) {
    if (weights.data == nullptr) return 1;
    std::vector<float> largest(static_cast<std::size_t>(weights.height), 0.0F);
    for_each_chunk(parallel_for, largest.size(), 32, [&](std::size_t begin, std::size_t end) {
        for (std::size_t y = begin; y < end; ++y) {
            const float* row = weights.row(static_cast<int>(y));
            largest[y] = *std::max_element(row, row + weights.width);
        }
    });
    const double most = static_cast<double>(*std::max_element(largest.begin(), largest.end()));
    return most > 0 ? 1 / most : 1;
}

// How many pixels of a width x height image count: the sum of unit * weight, added row by row; the number of pixels
// where there are no weights.
template <class ParallelFor = SerialFor>
[[nodiscard]] double weight_sum(const ImageView<float, 1>& weights, double unit, int width, int height,
                                const ParallelFor& parallel_for = {}) {
    if (weights.data == nullptr) return static_cast<double>(width) * height;
    return ordered_sum(parallel_for, static_cast<std::size_t>(height), 32, [&](std::size_t begin, std::size_t end) {
        double sum = 0;
        for (std::size_t y = begin; y < end; ++y) {
            const float* row = weights.row(static_cast<int>(y));
            double row_sum = 0;  // of its own, so that long sums lose nothing to rounding
            for (int x = 0; x < width; ++x) row_sum += unit * static_cast<double>(row[x]);
            sum += row_sum;
        }
        return sum;
    });
}

}  // namespace hmesh

#endif  // HMESH_IMAGE_WEIGHTS_HPP
