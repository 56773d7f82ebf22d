/// \file
/// First points: where the vertices of the first mesh stand, many where the image bends and few where it is flat.
///
/// A piecewise linear picture errs with the second derivatives: the density of points follows their magnitude, plus a tenth of
/// its mean, so that no part is without points. (Least squares of a smooth picture ask for its power 2 / 3: a face of density r
/// errs by the magnitude over r, and the sum of squares is least where r^3 follows the magnitude's square. By the power 3 / 4,
/// which is nearer, a draft of photographs loses 0.2 to 0.3 dB, a mesh of effort normal 0.01 to 0.02.)
///
/// A pixel becomes a point if its value in a mask, evenly distributed in [0, 1), is below its density times a factor: each pixel
/// decides by itself, which error diffusion does not allow, and any tiles and threads choose the same points. The mask is the R2
/// sequence, x / g + y / g^2 modulo 1 with g^3 = g + 1 (M. Roberts, "The unreasonable effectiveness of quasirandom sequences",
/// 2018), whose values nearby differ as much as they can.
///
/// Cost: some 13 ns a pixel of 3 channels, 20 without AVX, of which 3 are for the mask; 4 bytes a pixel. Images that are not in
/// memory: points_by_rows.hpp.
#ifndef HMESH_METHODS_ANNEALED_FIRST_POINTS_HPP
#define HMESH_METHODS_ANNEALED_FIRST_POINTS_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>

#include "hmesh/core/array.hpp"
#include "hmesh/core/assert.hpp"
#include "hmesh/core/coded_order.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/lanes.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/fit/image_source.hpp"
#include "hmesh/image/image_view.hpp"
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
    /// Of an image, with the pixels of a window.
    SmoothRows(const ImageSource<C>& source, const SourceWindow<C>& window)
        : source_(&source), window_(&window), size_(std::ptrdiff_t{C} * source.width()),
          stride_(size_ + std::ptrdiff_t{2 * C + 4}), numbers_(static_cast<std::size_t>(8 * stride_), 0.0) {}

    /// Reads row y of the image as row k, one more than the last time.
    void read(int k, int y) noexcept {
        // The peak counts as 1, the filters multiply by 4 each, and find_bends() by 2: powers of two, which change no bit else.
        window_->source.row(y - window_->y, 1 / (32 * source_->peak()), row(k % 3));
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
    const SourceWindow<C>* window_;
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

/// Rows of the density that are a piece of work.
inline constexpr std::size_t density_band = 32;

/// The density in rows [begin, end), a band or less, but for the part that all pixels have alike; written row after row. Returns
/// its sum. Never inlined: it rounds alike, whatever is in memory.
template <int C>
HMESH_NEVER_INLINE double find_density(const ImageSource<C>& source, std::size_t begin, std::size_t end, float* to) {
    const int width = source.width(), first = static_cast<int>(begin), count = static_cast<int>(end - begin);
    constexpr auto most = static_cast<double>(std::numeric_limits<float>::max());
    double sum = 0;
    Rect rect{0, first - 2, width, count + 4};
    if (!wraps_y(source.periodic())) {
        rect.y = std::max(0, first - 2);
        rect.height = std::min(source.height(), first + count + 2) - rect.y;
    }
    source.with_window(rect, [&](const SourceWindow<C>& window) {
        SmoothRows<C> smooth_rows(source, window);
        Array<double> values(static_cast<std::size_t>(width), 0.0);
        for (int k = 0; k < count + 4; ++k) {
            smooth_rows.read(k, first + k - 2);
            if (k >= 2) smooth_rows.smooth(k);
            if (k < 4) continue;
            const int y = first + k - 4;
            const double* bends = smooth_rows.bends(k);
            for (std::size_t x = 0; x < values.size(); ++x, bends += C) {
                double value = 0;
                for (int c = 0; c < C; ++c) value = static_cast<double>(static_cast<float>(std::min(value + bends[c], most)));
                values[x] = value;
            }
            if (source.is_weighted())
                for (int x = 0; x < width; ++x) values[static_cast<std::size_t>(x)] *= std::sqrt(source.weight(x, y));
            for (int x = 0; x < width; ++x) {
                const double value = values[static_cast<std::size_t>(x)];
                sum += value;
                *to++ = static_cast<float>(value);
            }
        }
    });
    return sum;
}

/// The part of the density that all pixels have alike, from the sum of the rest.
[[nodiscard]] inline float even_density(double sum, double pixels) noexcept {
    return static_cast<float>(std::max(0.1 * sum / pixels, static_cast<double>(std::numeric_limits<float>::min())));
}

/// Turns the densities of the pixels [begin, end) of row y into ranks. Never inlined, likewise.
HMESH_NEVER_INLINE inline void rank_row(float* densities, int begin, int end, int y) noexcept {
    for (int x = begin; x < end; ++x, ++densities)
        *densities = static_cast<float>((mask_at(x, y) + 1e-6) / static_cast<double>(*densities));
}

}  // namespace detail

/// The density of points that the image asks for, one value > 0 a pixel; only their ratios matter. Weights count as their square
/// roots, since errors do. Bands of 32 rows are pieces of work. go_on(), where set, is called before each, on any thread; once it
/// says false, the result is meaningless.
template <int C>
[[nodiscard]] HMESH_COLD Image<float, 1> point_density(const ImageSource<C>& source, const ParallelFor& parallel_for,
                                                       FunctionRef<bool()> go_on = {}) {
    Image<float, 1> density(source.width(), source.height(), raw);
    const double all = ordered_sum(parallel_for, static_cast<std::size_t>(source.height()), detail::density_band,
                                   [&](std::size_t begin, std::size_t end) {
                                       float* const to = density.pixel(0, static_cast<int>(begin));
                                       if (!go_on || go_on()) return detail::find_density(source, begin, end, to);
                                       std::fill(to, density.pixel(0, static_cast<int>(end)), 0.0F);
                                       return 0.0;
                                   });
    const float least = detail::even_density(all, source.pixels());
    for_each_chunk(parallel_for, density.size(), 65536, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) density.data()[k] += least;
    });
    return density;
}

/// The ranks of pixels as points, the least first: the ratios of mask and density.
[[nodiscard]] HMESH_COLD inline Image<float, 1> point_ranks(Image<float, 1> density, const ParallelFor& parallel_for = {}) {
    for_each_chunk(parallel_for, static_cast<std::size_t>(density.height()), 32, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) {
            const int y = static_cast<int>(row);
            detail::rank_row(density.pixel(0, y), 0, density.width(), y);
        }
    });
    return density;
}

namespace detail {

/// The ranks of the pixels of rows [begin, end), row after row; `room` is for whoever has to calculate them.
using RanksOfRows = FunctionRef<const float*(std::size_t begin, std::size_t end, Array<float>& room)>;

/// Pixels that may be among the first points, row by row.
struct PointCandidates {
    Array<std::uint32_t> pixels;  ///< y * width + x
    Array<std::uint32_t> ranks;   ///< bits_of() each pixel's rank
};

/// The upper bits of a rank are its bin: few pixels are in that of the last point, as a rule.
inline constexpr std::uint32_t rank_bin_shift = 20;
using RankBins = std::array<std::uint32_t, 1U << (31 - rank_bin_shift)>;

/// Of so many pixels those of the least ranks, and of equal ranks those that come first. count <= pixels.
[[nodiscard]] HMESH_COLD inline Array<std::uint32_t> least_of(PointCandidates candidates, std::size_t count) {
    Array<std::uint32_t>&points = candidates.pixels, &ranks = candidates.ranks;
    RankBins bins{};
    for (const std::uint32_t rank : ranks) ++bins[rank >> rank_bin_shift];
    std::uint32_t last_bin = 0;
    std::size_t below = 0;  // points in lower bins
    while (below + bins[last_bin] < count) below += bins[last_bin++];
    // Of those in the last bin as many as are missing.
    Array<Coded> in_last;
    for (std::size_t k = 0; k < points.size(); ++k)
        if (ranks[k] >> rank_bin_shift == last_bin) in_last.push_back({ranks[k], points[k]});
    sort_by_code(in_last);
    in_last.push_back({(std::uint64_t{last_bin} + 1) << rank_bin_shift, 0});
    const Coded& left_out = in_last[count - below];  // the first of them
    std::size_t kept = 0;
    for (std::size_t k = 0; k < points.size(); ++k)
        if (ranks[k] < left_out.code || (ranks[k] == left_out.code && points[k] < left_out.number)) points[kept++] = points[k];
    points.resize(kept);
    return std::move(points);
}

/// first_points(), with pieces of work of `band` rows. Ranks are asked for twice.
[[nodiscard]] HMESH_COLD inline Array<std::uint32_t> least_ranks(std::size_t width, std::size_t rows, std::size_t band,
                                                                 RanksOfRows ranks, std::size_t count,
                                                                 const ParallelFor& parallel_for) {
    Array<RankBins> of_band(rows / band + 1, RankBins{});
    for_each_chunk(parallel_for, rows, band, [&](std::size_t begin, std::size_t end) {
        RankBins& bins = of_band[begin / band];
        Array<float> room;
        const float* const at = ranks(begin, end, room);
        for (std::size_t k = 0; k < (end - begin) * width; ++k) ++bins[bits_of(at[k]) >> rank_bin_shift];
    });
    // Candidates: the pixels in the bins up to that of the last point.
    Array<std::size_t> first(of_band.size() + 1, 0);  // candidate of each band
    std::uint32_t last_bin = 0;
    for (std::size_t total = 0;; ++last_bin) {
        for (std::size_t k = 0; k < of_band.size(); ++k) {
            first[k + 1] += of_band[k][last_bin];
            total += of_band[k][last_bin];
        }
        if (total >= count) break;
    }
    for (std::size_t k = 0; k < of_band.size(); ++k) first[k + 1] += first[k];
    PointCandidates candidates{Array<std::uint32_t>(first.back(), raw), Array<std::uint32_t>(first.back(), raw)};
    for_each_chunk(parallel_for, rows, band, [&](std::size_t begin, std::size_t end) {
        std::size_t to = first[begin / band];
        const std::size_t last = first[begin / band + 1];
        Array<float> room;
        const float* const at = ranks(begin, end, room);
        // Ranks are others than before where who finds them was told to stop, or reads an image that has changed: `last` keeps
        // such a band from the next one's room, and what is left of its own holds its last pixel.
        for (std::size_t k = 0; k < (end - begin) * width; ++k)
            if (const std::uint32_t here = bits_of(at[k]); here >> rank_bin_shift <= last_bin && to < last) {
                candidates.pixels[to] = static_cast<std::uint32_t>(begin * width + k);
                candidates.ranks[to++] = here;
            }
        const auto last_pixel = static_cast<std::uint32_t>(end * width - 1);
        std::fill(candidates.pixels.begin() + to, candidates.pixels.begin() + last, last_pixel);
        std::fill(candidates.ranks.begin() + to, candidates.ranks.begin() + last, last_bin << rank_bin_shift);
    });
    return least_of(std::move(candidates), count);
}

}  // namespace detail

/// The `count` pixels, as y * width + x, of the least point_ranks(); of equal ranks those that come first, row by row.
/// 0 <= count <= pixels. Bands of some 65,536 pixels are pieces of work.
[[nodiscard]] HMESH_COLD inline Array<std::uint32_t> first_points(const Image<float, 1>& ranks, std::size_t count,
                                                                  const ParallelFor& parallel_for = {}) {
    HMESH_ASSERT(count <= ranks.size());
    const auto width = static_cast<std::size_t>(ranks.width()), rows = static_cast<std::size_t>(ranks.height());
    const auto of_rows = [&](std::size_t begin, std::size_t, Array<float>&) { return ranks.pixel(0, static_cast<int>(begin)); };
    return detail::least_ranks(width, rows, 65536 / (width + 1) + 1, of_rows, count, parallel_for);
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_ANNEALED_FIRST_POINTS_HPP
