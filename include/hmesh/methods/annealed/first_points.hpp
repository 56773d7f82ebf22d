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
/// Cost: some 13 ns a pixel of 3 channels, 20 without AVX, of which 3 are for the mask; 4 bytes a pixel.
#ifndef HMESH_METHODS_ANNEALED_FIRST_POINTS_HPP
#define HMESH_METHODS_ANNEALED_FIRST_POINTS_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>

#include "hmesh/core/array.hpp"
#include "hmesh/core/assert.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/lanes.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/fit/image_source.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/mesh/coded_order.hpp"
#include "hmesh/mesh/geometry.hpp"
#include "hmesh/mesh/periodic.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {
namespace detail {

// Rows hold their samples pixel after pixel, so that one loop does all channels: `step` places before a sample is that of the
// pixel to its left. Loops take four samples at once and go up to 3 beyond the end, where rows have room.

/// to[i] = before[i] + 2 here[i] + after[i], 0 <= i < size: the binomial filter [1 2 1] times 4, along rows or across them.
inline void add_binomial(const double* before, const double* here, const double* after, std::ptrdiff_t size,
                         double* to) noexcept {
    for (std::ptrdiff_t i = 0; i < size; i += 4)
        (Lanes<4>::load(before + i) + 2 * Lanes<4>::load(here + i) + Lanes<4>::load(after + i)).store(to + i);
}

/// Writes, for each sample of a row, twice the largest magnitude of a second directional derivative.
inline void find_bends(const double* above, const double* here, const double* below, std::ptrdiff_t step, std::ptrdiff_t size,
                       double* to) noexcept {
    const auto load = [](const double* from) { return Lanes<4>::load(from); };
    for (std::ptrdiff_t i = 0; i < size; i += 4) {
        const auto twice = 2 * load(here + i);
        const auto xx = load(here + i - step) - twice + load(here + i + step), yy = load(above + i) - twice + load(below + i);
        const auto xy = load(above + i - step) + load(below + i + step) - load(above + i + step) - load(below + i - step);
        const auto half_xy = 0.5 * xy, difference = xx - yy;
        (abs(xx + yy) + sqrt(difference * difference + half_xy * half_xy)).store(to + i);
    }
}

/// Rows of an image from top to bottom, smoothed by the binomial filter in both directions. The last three are kept, so that
/// they stay in the cache.
template <int C>
class SmoothRows {
  public:
    explicit SmoothRows(const ImageSource<C>& source)
        : source_(&source), size_(std::ptrdiff_t{C} * source.width()), stride_(size_ + std::ptrdiff_t{2 * C + 4}),
          numbers_(static_cast<std::size_t>(8 * stride_), 0.0) {}

    /// Reads row y of the image as row k, one more than the last time.
    void read(int k, int y) noexcept {
        // The peak counts as 1, the filters multiply by 4 each, and find_bends() by 2: powers of two, which change no bit else.
        source_->row(y, 1 / (32 * source_->peak()), row(k % 3));
    }
    /// Smooths row k - 1, now that row k is read.
    void smooth(int k) noexcept {
        double *const across = row(6), *const along = row(3 + k % 3);
        add_binomial(row((k + 1) % 3), row((k + 2) % 3), row(k % 3), size_, across);
        repeat_ends(across);
        add_binomial(across - C, across, across + C, size_, along);
        repeat_ends(along);
    }
    /// The bends of each sample of row k - 2, now that row k - 1 is smoothed.
    [[nodiscard]] const double* bends(int k) noexcept {
        find_bends(row(3 + (k + 1) % 3), row(3 + (k + 2) % 3), row(3 + k % 3), C, size_, row(7));
        return row(7);
    }

  private:
    [[nodiscard]] double* row(int place) noexcept { return numbers_.data() + place * stride_ + C; }
    /// Beyond the image its outermost pixels go on, or those of the other side come.
    void repeat_ends(double* row) const noexcept {
        const bool wraps = wraps_x(source_->periodic());
        const double *const first = row, *const last = row + size_ - C;
        std::copy_n(wraps ? last : first, C, row - C);
        std::copy_n(wraps ? first : last, C, row + size_);
    }

    const ImageSource<C>* source_;
    std::ptrdiff_t size_,    ///< samples of a row
        stride_;             ///< from row to row: a pixel more on both sides, and the room that loops need
    Array<double> numbers_;  ///< three rows as read, three smoothed ones, one smoothed across, one of bends
};

/// The mask at a pixel, in [0, 1).
[[nodiscard]] inline double mask_at(int x, int y) noexcept {
    const double value = 0.7548776662466927 * (x + 1) + 0.5698402909980532 * (y + 1);  // below 2^17
    return value - static_cast<double>(static_cast<int>(value));
}

/// The bits of a float; those of positive floats are in their order.
[[nodiscard]] inline std::uint32_t bits_of(float value) noexcept {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    return bits;
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
    constexpr auto most = static_cast<double>(std::numeric_limits<float>::max());
    Array<double> sums((rows + band - 1) / band, 0.0);
    for_each_chunk(parallel_for, rows, band, [&](std::size_t begin, std::size_t end) {
        if (go_on && !go_on()) return;
        const int first = static_cast<int>(begin), count = static_cast<int>(end - begin);
        detail::SmoothRows<C> smooth_rows(source);
        Array<double> values(static_cast<std::size_t>(width) + 3, 0.0);  // three of 0, so that four can be taken at once
        double sum = 0;
        for (int k = 0; k < count + 4; ++k) {
            smooth_rows.read(k, first + k - 2);
            if (k >= 2) smooth_rows.smooth(k);
            if (k < 4) continue;
            const int y = first + k - 4;
            const double* bends = smooth_rows.bends(k);
            for (std::size_t x = 0; x + 3 < values.size(); ++x, bends += C) {
                double value = 0;
                for (int c = 0; c < C; ++c) value = static_cast<double>(static_cast<float>(std::min(value + bends[c], most)));
                values[x] = value;
            }
            if (source.is_weighted())
                for (int x = 0; x < width; ++x) values[static_cast<std::size_t>(x)] *= std::sqrt(source.weight(x, y));
            // The sum in the loop of the roots: one waits for additions, the other for roots.
            for (std::size_t x = 0; x + 3 < values.size(); x += 4) {
                const auto root = sqrt(Lanes<4>::load(&values[x])), value = root * sqrt(root);
                value.store(&values[x]);
                for (int i = 0; i < 4; ++i) sum += value[i];
            }
            float* const row = density.pixel(0, y);
            for (int x = 0; x < width; ++x) row[x] = static_cast<float>(values[static_cast<std::size_t>(x)]);
        }
        sums[begin / band] = sum;
    });
    double sum = 0;
    for (const double of_band : sums) sum += of_band;
    const auto least =
        static_cast<float>(std::max(0.1 * sum / source.pixels(), static_cast<double>(std::numeric_limits<float>::min())));
    for_each_chunk(parallel_for, density.size(), 65536, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) density.data()[k] += least;
    });
    return density;
}

/// Points on the lines x = 0 and y = 0 where a periodic image begins again, as far apart as points of this density are elsewhere
/// when there are `count` in the image; half of `count` at most. O(pixels).
[[nodiscard]] HMESH_COLD inline Array<Point> seam_points(const Image<float, 1>& density, double count, Periodic periodic) {
    const int width = density.width(), height = density.height();
    double sum = 0;
    for (std::size_t k = 0; k < density.size(); ++k) sum += static_cast<double>(density.data()[k]);
    Array<Point> points;
    // Of r points a px^2 there are the root of r on a px of a line.
    const auto walk = [&](int length, FunctionRef<double(int)> density_at, FunctionRef<Point(double)> place) {
        double due = 0.5;
        for (int i = 0; i < length; ++i) {
            due += std::min(1.0, std::sqrt(count * density_at(i) / sum));
            if (due < 1) continue;
            points.push_back(place(i + 0.5));
            due -= 1;
        }
    };
    const auto at = [&](int x, int y) { return static_cast<double>(*density.pixel(x, y)); };
    if (wraps_x(periodic))
        walk(
            height, [&](int y) { return 0.5 * (at(0, y) + at(width - 1, y)); },
            [](double y) {
                return Point{0, y};
            });
    if (wraps_y(periodic))
        walk(
            width, [&](int x) { return 0.5 * (at(x, 0) + at(x, height - 1)); },
            [](double x) {
                return Point{x, 0};
            });
    while (2 * static_cast<double>(points.size()) > count) {  // images of few rows or columns: every other one goes
        std::size_t kept = 0;
        for (std::size_t k = 1; k < points.size(); k += 2) points[kept++] = points[k];
        points.resize(kept);
    }
    return points;
}

/// The ranks of pixels as points, the least first: the ratios of mask and density.
[[nodiscard]] HMESH_COLD inline Image<float, 1> point_ranks(Image<float, 1> density, const ParallelFor& parallel_for = {}) {
    for_each_chunk(parallel_for, static_cast<std::size_t>(density.height()), 32, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) {
            const int y = static_cast<int>(row);
            float* const at = density.pixel(0, y);
            for (int x = 0; x < density.width(); ++x)
                at[x] = static_cast<float>((detail::mask_at(x, y) + 1e-6) / static_cast<double>(at[x]));
        }
    });
    return density;
}

/// The `count` pixels, as y * width + x, of the least point_ranks(); of equal ranks those that come first, row by row.
/// 0 <= count <= pixels. Bands of some 65,536 pixels are pieces of work.
[[nodiscard]] HMESH_COLD inline Array<std::uint32_t> first_points(const Image<float, 1>& ranks, std::size_t count,
                                                                  const ParallelFor& parallel_for = {}) {
    HMESH_ASSERT(count <= ranks.size());
    // The upper bits of a rank are its bin: few pixels are in that of the last point, as a rule.
    constexpr std::uint32_t shift = 20;
    using Bins = std::array<std::uint32_t, 1U << (31 - shift)>;
    const auto width = static_cast<std::size_t>(ranks.width()), rows = static_cast<std::size_t>(ranks.height());
    const std::size_t band = 65536 / (width + 1) + 1;
    Array<Bins> of_band(rows / band + 1, Bins{});
    for_each_chunk(parallel_for, rows, band, [&](std::size_t begin, std::size_t end) {
        Bins& bins = of_band[begin / band];
        for (std::size_t row = begin; row < end; ++row) {
            const float* const at = ranks.pixel(0, static_cast<int>(row));
            for (std::size_t x = 0; x < width; ++x) ++bins[detail::bits_of(at[x]) >> shift];
        }
    });
    // Candidates: the pixels in the bins up to that of the last point.
    Array<std::size_t> first(of_band.size() + 1, 0);  // candidate of each band
    std::uint32_t last_bin = 0;
    std::size_t below = 0;  // points in lower bins
    for (std::size_t total = 0;; below = total, ++last_bin) {
        for (std::size_t k = 0; k < of_band.size(); ++k) {
            first[k + 1] += of_band[k][last_bin];
            total += of_band[k][last_bin];
        }
        if (total >= count) break;
    }
    for (std::size_t k = 0; k < of_band.size(); ++k) first[k + 1] += first[k];
    Array<std::uint32_t> points(first.back());
    for_each_chunk(parallel_for, rows, band, [&](std::size_t begin, std::size_t end) {
        std::size_t to = first[begin / band];
        for (std::size_t k = begin * width; k < end * width; ++k)
            if (detail::bits_of(ranks.data()[k]) >> shift <= last_bin) points[to++] = static_cast<std::uint32_t>(k);
    });
    // Of those in the last bin as many as are missing.
    const auto bits_at = [&](std::uint32_t point) { return detail::bits_of(ranks.data()[point]); };
    Array<Coded> in_last;  // the last bin's
    for (const std::uint32_t point : points)
        if (bits_at(point) >> shift == last_bin) in_last.push_back({bits_at(point), point});
    const std::size_t missing = count - below;
    if (missing == in_last.size()) return points;
    sort_by_code(in_last);
    const Coded& left_out = in_last[missing];  // the first of them
    std::size_t kept = 0;
    for (const std::uint32_t point : points)
        if (const std::uint32_t bits = bits_at(point); bits < left_out.code || (bits == left_out.code && point < left_out.number))
            points[kept++] = point;
    points.resize(kept);
    return points;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_ANNEALED_FIRST_POINTS_HPP
