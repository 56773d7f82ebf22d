/// \file
/// MomentTable: row prefix sums of a rectangle of an image, from which edges collect their moments.
///
/// Entry (x, y), 0 <= x <= width, 0 <= y < height, holds the sums over the pixels (i, y), 0 <= i < x, of
///
///     I_0 .. I_{C-1}, 1     and     i I_0 .. i I_{C-1}, |I|^2          (|I|^2: summed over channels)
///
/// in coordinates local to the rectangle. By Green's theorem (Leu, "Computing a shape's moments from its boundary", 1991) the
/// moments of any polygon are signed sums of such entries along its edges (fit/edge_moments.hpp).
///
/// Sums of 8-bit samples are 32-bit integers as long as they fit (rectangles up to about 4,000 px wide); all others are
/// doubles, exact for 16-bit samples too. Cost: 2 * lanes_for(C + 1) numbers a pixel, that is 32 bytes for 8-bit RGB, and about
/// 5 ns a pixel to build. The entries of a column strip of 2 pixels are contiguous down the rows, because walks run down edges:
/// this keeps them in few cache lines and pages.
///
/// With weights, each of these sums carries the weight w of its pixel (1 becomes w), and two more sums,
///
///     w i  and  w i^2,
///
/// which follow from x where all weights are 1, stand in an array of their own. All are then doubles, exact for 8-bit samples,
/// because WeightScale rounds the weights. The samples cannot be recovered from sums with weights of 0: they are kept as
/// floats. Cost: 2 * lanes_for(C + 1) + 2 doubles and C floats a pixel, that is 92 bytes for RGB.
#ifndef HMESH_FIT_MOMENT_TABLE_HPP
#define HMESH_FIT_MOMENT_TABLE_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>

#include "hmesh/core/assert.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/lanes.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/image/weights.hpp"
#include "hmesh/mesh/raster.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// Row prefix sums of a rectangle of an image of C channels, from which edges collect their moments.
template <int C>
class MomentTable {
  public:
    static constexpr int lanes = lanes_for(C + 1);  ///< numbers in one half of an entry
    static constexpr int entry_size = 2 * lanes;    ///< numbers in an entry

    /// No table; to be assigned to.
    MomentTable() = default;

    /// The table of `rect`, which must lie in a view that check() accepts; all pixels count the same. Bands of rows are
    /// independent pieces of work for the executor.
    template <class T>
    explicit MomentTable(const ImageView<T, C>& view, const Rect& rect, const ParallelFor& parallel_for = {})
        : MomentTable(view, ImageView<float, 1>(), 1.0, rect, parallel_for) {}

    /// The table of `rect` with pixel (i, j) counting as WeightScale(unit, view.width, view.height) says of weight (i, j).
    /// check_weights() must accept the weights; the largest one times `unit` is at most about 1 (weight_unit()). A view of
    /// weights without data: all pixels count the same.
    template <class T>
    MomentTable(const ImageView<T, C>& view, const ImageView<float, 1>& weights, double unit, const Rect& rect,
                const ParallelFor& parallel_for = {})
        : MomentTable(view, weights, WeightScale(unit, view.width, view.height), rect, parallel_for) {}

    /// The same with weights that are those of a part of a larger image, whose scale this is.
    template <class T>
    MomentTable(const ImageView<T, C>& view, const ImageView<float, 1>& weights, const WeightScale& scale, const Rect& rect,
                const ParallelFor& parallel_for = {})
        : width_(rect.width), height_(rect.height), weighted_(weights.data != nullptr),
          int32_(!weighted_ && fits_32_bits<T>(rect.width)) {
        HMESH_ASSERT(rect.x >= 0 && rect.y >= 0 && rect.width >= 1 && rect.height >= 1);
        HMESH_ASSERT(rect.width <= view.width - rect.x && rect.height <= view.height - rect.y);
        HMESH_ASSERT(!weighted_ || (weights.width == view.width && weights.height == view.height));
        strip_size_ = static_cast<std::size_t>(height_) * strip_width * entry_size;
        // Sizes beyond PTRDIFF_MAX become the largest allocation, so that new[] throws std::bad_alloc.
        const std::size_t size = fits_memory(width_, height_) ? (static_cast<std::size_t>(width_) / strip_width + 1) * strip_size_
                                                              : std::numeric_limits<std::ptrdiff_t>::max() / sizeof(double);
        // Not initialised: fill writes all that is ever read.
        size_ = size;
        if (int32_) {
            int32_entries_.reset(new std::int32_t[size]);
            fill(view, rect, parallel_for, int32_entries_.get());
            return;
        }
        float64_entries_.reset(new double[size]);
        if (!weighted_) {
            fill(view, rect, parallel_for, float64_entries_.get());
            return;
        }
        x_moment_entries_.reset(new double[size / lanes]);
        samples_.reset(new float[sample_count()]);
        for_each_row(parallel_for, [&](int y) { fill_weighted_row(view, weights, scale, rect, y); });
    }

    /// Whether a table of the largest kind for width x height >= 1 pixels has at most `most` bytes, by default what can be
    /// addressed: always true with 64-bit pointers.
    [[nodiscard]] static bool fits_memory(int width, int height,
                                          std::int64_t most = std::numeric_limits<std::ptrdiff_t>::max()) noexcept {
        const std::int64_t entries = (std::int64_t{width} + strip_width) * height;
        return entries <= most / std::int64_t{(entry_size + 2) * sizeof(double) + C * sizeof(float)};
    }

    [[nodiscard]] int width() const noexcept { return width_; }    ///< px
    [[nodiscard]] int height() const noexcept { return height_; }  ///< px
    /// The sides of the mesh with centres of pixels on them, in the coordinates of the table; infinite where there are none.
    [[nodiscard]] const FarSides& far_sides() const noexcept { return far_sides_; }
    /// Whether pixels are points (Samples::points), and these sides are not infinite.
    [[nodiscard]] HMESH_ALWAYS_INLINE bool has_far_sides() const noexcept { return has_far_sides_; }
    /// Says that pixels are points, of a mesh with these sides.
    void set_far_sides(const FarSides& sides) noexcept {
        far_sides_ = sides;
        has_far_sides_ = true;
    }
    [[nodiscard]] bool is_int32() const noexcept { return int32_; }        ///< whether sums are 32-bit integers, not doubles
    [[nodiscard]] bool is_weighted() const noexcept { return weighted_; }  ///< whether pixels have weights
    /// The memory of the table in bytes.
    [[nodiscard]] std::size_t bytes() const noexcept {
        if (int32_) return size_ * sizeof(std::int32_t);
        if (!weighted_) return size_ * sizeof(double);
        return (size_ + size_ / lanes) * sizeof(double) + sample_count() * sizeof(float);
    }

    /// The samples of pixel (x, y), 0 <= x < width, 0 <= y < height, whatever its weight; 0 in the lanes above them.
    void pixel(int x, int y, Lanes<lanes>& out) const noexcept {
        if (weighted_) {
            const float* samples = samples_.get() + sample_offset(x, y);
            for (int c = 0; c < lanes; ++c) out.set(c, c < C ? static_cast<double>(samples[c]) : 0.0);
            return;
        }
        const auto sample = [&](const auto* entries) {
            for (int c = 0; c < lanes; ++c)
                out.set(c, c < C ? static_cast<double>(entries[offset(x + 1, y) + static_cast<std::size_t>(c)] -
                                                       entries[offset(x, y) + static_cast<std::size_t>(c)])
                                 : 0.0);
        };
        if (int32_) sample(int32_entries_.get());
        else sample(float64_entries_.get());
    }

    /// How often pixel (x, y) counts, with the rounding of the sums over the pixels to its left.
    [[nodiscard]] double weight(int x, int y) const noexcept {
        return weighted_ ? float64_entries_[offset(x + 1, y) + C] - float64_entries_[offset(x, y) + C] : 1.0;
    }

    /// The entries, of type N: std::int32_t if is_int32(), else double.
    template <class N>
    [[nodiscard]] HMESH_ALWAYS_INLINE const N* entries() const noexcept {
        if constexpr (sizeof(N) == sizeof(std::int32_t)) return int32_entries_.get();
        else return float64_entries_.get();
    }
    /// The offset of entry (x, y), 0 <= x <= width, 0 <= y < height, in numbers from entries().
    [[nodiscard]] HMESH_ALWAYS_INLINE std::size_t offset(int x, int y) const noexcept {
        // Unsigned: a division of what may be negative would take three instructions more.
        constexpr unsigned strip = strip_width;
        const auto column = static_cast<unsigned>(x), row = static_cast<unsigned>(y);
        return column / strip * strip_size_ + std::size_t{row * strip + column % strip} * entry_size;
    }
    /// The sums of w i and w i^2 that belong to the entry at this offset; only if is_weighted().
    [[nodiscard]] HMESH_ALWAYS_INLINE const double* x_moments(std::size_t offset) const noexcept {
        return x_moment_entries_.get() + offset / lanes;
    }

  private:
    /// Columns whose entries are contiguous down the rows.
    static constexpr int strip_width = 2;
    static constexpr std::size_t numbers = entry_size;  ///< entry_size as the size of an array
    static constexpr std::size_t band = 64;             ///< rows that are a piece of work

    /// Whether all sums over rows of this width fit 32-bit integers.
    template <class T>
    [[nodiscard]] static bool fits_32_bits(int width) noexcept {
        if constexpr (!PixelTraits<T>::is_integer) return false;
        const double w = width, highest = std::max(PixelTraits<T>::highest, -PixelTraits<T>::lowest);
        const double largest = 2147483647.0;
        return highest * w * (w - 1) / 2 <= largest && C * highest * highest * w <= largest;
    }

    [[nodiscard]] std::size_t sample_offset(int x, int y) const noexcept {
        return (static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)) * C;
    }
    [[nodiscard]] std::size_t sample_count() const noexcept { return sample_offset(0, height_); }

    template <class Body>
    void for_each_row(const ParallelFor& parallel_for, Body&& body) const {
        for_each_chunk(parallel_for, static_cast<std::size_t>(height_), band, [&](std::size_t begin, std::size_t end) {
            for (std::size_t y = begin; y < end; ++y) body(static_cast<int>(y));
        });
    }

    template <class T, class N>
    void fill(const ImageView<T, C>& view, const Rect& rect, const ParallelFor& parallel_for, N* entries) const {
        for_each_chunk(parallel_for, static_cast<std::size_t>(height_), band, [&](std::size_t begin, std::size_t end) {
            fill_band(view, rect, static_cast<int>(begin), static_cast<int>(end), entries);
        });
    }

    /// Strip by strip, because the rows of a strip follow each other in memory, 64 of them in a page for 8-bit RGB: takes a third
    /// of the time of row by row.
    ///
    /// Never inlined, as is fill_weighted_row(): tables of one rectangle have the same bits, whatever is in memory.
    template <class T, class N>
    HMESH_NEVER_INLINE void fill_band(const ImageView<T, C>& view, const Rect& rect, int begin, int end, N* entries) const {
        N sums[band][numbers] = {};
        for (int x0 = 0; x0 <= width_; x0 += strip_width) {
            N* entry = entries + offset(x0, begin);
            for (int y = begin; y < end; ++y) {
                N* const sum = sums[y - begin];
                const T* const pixels = view.pixel(rect.x, rect.y + y);
                for (int x = x0; x < x0 + strip_width; ++x, entry += entry_size) {
                    for (int k = 0; k < entry_size; ++k) entry[k] = sum[k];
                    if (x >= width_) continue;
                    const T* const pixel = pixels + static_cast<std::ptrdiff_t>(x) * C;
                    N square = 0;
                    for (int c = 0; c < C; ++c) {
                        const N value = static_cast<N>(PixelTraits<T>::to_real(pixel[c]));
                        sum[c] += value;
                        sum[lanes + c] += static_cast<N>(x) * value;
                        square += value * value;
                    }
                    sum[C] += 1;
                    sum[lanes + C] += square;
                }
            }
        }
    }

    template <class T>
    HMESH_NEVER_INLINE void fill_weighted_row(const ImageView<T, C>& view, const ImageView<float, 1>& weights,
                                              const WeightScale& scale, const Rect& rect, int y) const {
        const T* pixel = view.pixel(rect.x, rect.y + y);
        const float* weight = weights.pixel(rect.x, rect.y + y);
        float* samples = samples_.get() + sample_offset(0, y);
        double sum[numbers] = {}, powers[2] = {};
        for (int x = 0;; ++x, pixel += C, samples += C, ++weight) {
            double* entry = float64_entries_.get() + offset(x, y);
            double* entry_powers = x_moment_entries_.get() + offset(x, y) / lanes;
            for (int k = 0; k < entry_size; ++k) entry[k] = sum[k];
            for (int k = 0; k < 2; ++k) entry_powers[k] = powers[k];
            if (x == width_) break;
            const double w = scale(*weight);
            double square = 0;
            for (int c = 0; c < C; ++c) {
                const double value = PixelTraits<T>::to_real(pixel[c]), part = w * value;
                samples[c] = static_cast<float>(value);
                sum[c] += part;
                sum[lanes + c] += x * part;
                square += value * value;
            }
            sum[C] += w;
            sum[lanes + C] += w * square;
            powers[0] += x * w;
            powers[1] += static_cast<double>(x) * x * w;
        }
    }

    int width_ = 0, height_ = 0;
    bool weighted_ = false;
    bool int32_ = true;
    bool has_far_sides_ = false;
    std::size_t strip_size_ = 0;
    std::size_t size_ = 0;
    std::unique_ptr<std::int32_t[]> int32_entries_;
    std::unique_ptr<double[]> float64_entries_;
    std::unique_ptr<double[]> x_moment_entries_;  ///< of weighted tables: w i, w i^2
    FarSides far_sides_;
    std::unique_ptr<float[]> samples_;  ///< of weighted tables: I_0 .. I_{C-1}, row after row
};

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_FIT_MOMENT_TABLE_HPP
