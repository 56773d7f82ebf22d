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
/// Sums of 8-bit samples are 32-bit integers as long as they fit (rectangles up to about 4,000 px wide), and kept for every
/// second x alone, with the samples of the pixel between, from which the other entries follow. All other sums are doubles, exact
/// for 16-bit samples too. Cost: 16 bytes a pixel for 8-bit RGB, 32 with alpha, and about 2 ns a pixel to build; 64 and 128
/// bytes, and 6 ns, for other samples; 64 bytes a column. Entries of a column are contiguous down the rows, those of doubles of
/// two columns, because walks run down edges: this keeps them in few cache lines and pages.
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
#include <cstring>
#include <limits>

#include "hmesh/core/array.hpp"
#include "hmesh/core/assert.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/lanes.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/fit/raster.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/image/weights.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// Row prefix sums of a rectangle of an image of C channels, from which edges collect their moments.
template <int C>
class MomentTable {
  public:
    static constexpr int lanes = lanes_for(C + 1);  ///< numbers in one half of an entry
    static constexpr int entry_size = 2 * lanes;    ///< numbers in an entry
    using Channels = Lanes<lanes>;                  ///< one half of an entry
    using PixelLanes = Lanes<lanes_for(C)>;         ///< the samples of a pixel, padded
    /// Whether PixelLanes hold lane C of a half too.
    static constexpr bool has_spare_lane = lanes_for(C) > C;

    /// The sums of an entry.
    struct Entry {
        Channels of_samples;  ///< I_0 .. I_{C-1}, 1
        Channels by_column;   ///< i I_0 .. i I_{C-1}, |I|^2
    };

    /// No table; to be assigned to.
    MomentTable() = default;
    /// Moved and not copied, being large.
    MomentTable(MomentTable&&) noexcept = default;
    MomentTable& operator=(MomentTable&&) noexcept = default;  ///< the same

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
        : MomentTable(rect,
                      {[&](int x, int y, int count, double* to) { read_pixels(view, x, y, count, to); },
                       [&](int x, int y, int count, std::int16_t* to) { read_pixels(view, x, y, count, to); },
                       [&](int x, int y, int count, double* to) { scale.read(weights, x, y, count, to); }},
                      {largest_sample<T>(), PixelTraits<T>::lowest < 0, weights.data != nullptr}, parallel_for) {
        HMESH_ASSERT(rect.x >= 0 && rect.y >= 0);
        HMESH_ASSERT(rect.width <= view.width - rect.x && rect.height <= view.height - rect.y);
        HMESH_ASSERT(!weighted_ || (weights.width == view.width && weights.height == view.height));
    }

    /// What is known of the pixels of a table.
    struct Kind {
        double largest;    ///< the largest magnitude of a sample where all are whole numbers; of others the largest double
        bool is_signed;    ///< whether there may be samples < 0
        bool is_weighted;  ///< whether pixels have weights
    };
    /// What reads the pixels of a table, one of the first two, on any thread.
    struct Readers {
        PixelReader samples;     ///< where sums are doubles
        IntegerReader integers;  ///< where sums are 32-bit integers
        PixelReader weights;     ///< as WeightScale rounds them, where there are some
    };
    /// The table of the pixels of `rect`, from wherever they are read.
    MomentTable(const Rect& rect, const Readers& read, const Kind& kind, const ParallelFor& parallel_for = {})
        : width_(rect.width), height_(rect.height), weighted_(kind.is_weighted),
          int32_(!weighted_ && fits_32_bits(rect.width, kind)) {
        HMESH_ASSERT(rect.width >= 1 && rect.height >= 1);
        strip_size_ = static_cast<std::size_t>(height_) * (int32_ ? pair_size : strip_width * entry_size);
        // Sizes beyond PTRDIFF_MAX become the largest allocation, so that there is a std::bad_alloc.
        const std::size_t size = fits_memory(width_, height_) ? (static_cast<std::size_t>(width_) / strip_width + 1) * strip_size_
                                                              : std::numeric_limits<std::ptrdiff_t>::max() / sizeof(double);
        // Not initialised: what is ever read is written first.
        size_ = size;
        if (int32_) int32_entries_.resize_raw(size);
        else float64_entries_.resize_raw(size);
        if (weighted_) {
            x_moment_entries_.resize_raw(size / lanes);
            samples_.resize_raw(sample_count());
        } else {
            fill_columns();
        }
        for_each_chunk(parallel_for, static_cast<std::size_t>(height_), band, [&](std::size_t first, std::size_t last) {
            const int begin = static_cast<int>(first), end = static_cast<int>(last);
            if (int32_) fill_pairs(rect, read.integers, begin, end);
            else if (!weighted_) fill(rect, read.samples, begin, end);
            else fill_weighted(rect, read.samples, read.weights, begin, end);
        });
    }
    /// The memory of a pixel in a table of such pixels and of this width, in bytes.
    [[nodiscard]] static std::size_t pixel_bytes(int width, const Kind& kind) noexcept {
        if (kind.is_weighted) return (entry_size + 2) * sizeof(double) + C * sizeof(float);
        return fits_32_bits(width, kind) ? pair_size * sizeof(std::int32_t) / strip_width : entry_size * sizeof(double);
    }
    /// What Kind::largest is of samples of a type.
    template <class T>
    [[nodiscard]] static constexpr double largest_sample() noexcept {
        using Traits = PixelTraits<T>;
        if constexpr (!Traits::is_integer) return std::numeric_limits<double>::max();
        else return std::max(Traits::highest, -Traits::lowest);
    }

    /// Whether a table of the largest kind for width x height >= 1 pixels, its columns not counted, has at most `most` bytes, by
    /// default what can be addressed: always true with 64-bit pointers.
    [[nodiscard]] static bool fits_memory(int width, int height,
                                          std::int64_t most = std::numeric_limits<std::ptrdiff_t>::max()) noexcept {
        const std::int64_t entries = (std::int64_t{width} + strip_width) * height;
        constexpr Kind weighted{0, false, true};
        return entries <= most / static_cast<std::int64_t>(pixel_bytes(width, weighted));
    }

    [[nodiscard]] int width() const noexcept { return width_; }    ///< px
    [[nodiscard]] int height() const noexcept { return height_; }  ///< px
    /// The sides of the mesh with centres of pixels on them, in the coordinates of the table; beyond all points if it has none.
    [[nodiscard]] const FarSides& far_sides() const noexcept { return far_sides_; }
    /// Whether pixels are points (Samples::points), and there are such sides.
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
        if (weighted_) return (size_ + size_ / lanes) * sizeof(double) + sample_count() * sizeof(float);
        return size_ * (int32_ ? sizeof(std::int32_t) : sizeof(double)) + columns_.size() * sizeof(Column);
    }

    /// The samples of pixel (x, y), 0 <= x < width, 0 <= y < height, whatever its weight; 0 in the lanes above them.
    void pixel(int x, int y, Lanes<lanes>& out) const noexcept {
        if (weighted_) {
            const float* samples = samples_.data() + sample_offset(x, y);
            for (int c = 0; c < lanes; ++c) out.set(c, c < C ? static_cast<double>(samples[c]) : 0.0);
            return;
        }
        if (!int32_) out = Channels::load(entries() + offset(x + 1, y)) - Channels::load(entries() + offset(x, y));
        else if (x % 2 == 0) out = Channels::extended(beyond(pair(x, y), 1));
        else out = Channels::load(pair(x + 1, y)) - Channels::load(pair(x, y)) - Channels::extended(beyond(pair(x, y), 1));
        for (int c = C; c < lanes; ++c) out.set(c, 0);
    }

    /// How often pixel (x, y) counts, with the rounding of the sums over the pixels to its left.
    [[nodiscard]] double weight(int x, int y) const noexcept {
        return weighted_ ? float64_entries_[offset(x + 1, y) + C] - float64_entries_[offset(x, y) + C] : 1.0;
    }

    /// Entry (x, y), 0 <= x <= width, 0 <= y < height; 0 in the lanes above C.
    [[nodiscard]] Entry entry(int x, int y) const noexcept {
        if (!int32_) {
            const double* const sums = entries() + offset(x, y);
            return {Channels::load(sums), Channels::load(sums + lanes)};
        }
        const std::int32_t* const sums = pair(x, y);
        const Channels last = Channels::extended(beyond(sums, x));
        Entry out{Channels::load(sums) + last, Channels::load(sums + lanes) + last * (x - 1.0)};
        for (int c = C + 1; c < lanes; ++c) {
            out.of_samples.set(c, 0);
            out.by_column.set(c, 0);
        }
        out.of_samples.set(C, x);
        out.by_column.set(C, sums[lanes + C] + (last * last).sum());
        return out;
    }
    /// The sum of the squares of a row's samples, of all channels; where is_int32() without the last one of an odd number.
    [[nodiscard]] double squares(int y) const noexcept {
        return int32_ ? pair(width_, y)[lanes + C] : entries()[offset(width_, y) + lanes + C];
    }
    /// Where entries (x, y) of even and odd x begin whose sums are 32-bit integers: the two halves of that of even x, in which
    /// lane C of the first and the lanes above it mean nothing, and what beyond() reads. Only if is_int32().
    [[nodiscard]] HMESH_ALWAYS_INLINE const std::int32_t* pair(int x, int y) const noexcept {
        return int32_entries_.data() + pair_offset(x, y);
    }
    /// The samples of the pixel by which entry (x, y) is beyond its pair(): 0 where x is even, and in the lanes above them.
    [[nodiscard]] static HMESH_ALWAYS_INLINE PixelLanes beyond(const std::int32_t* pair, int x) noexcept {
        const PixelLanes part = PixelLanes::load(parts.of[static_cast<unsigned>(x) % 2]);
        if constexpr (has_bytes) return PixelLanes::bytes(pair[C]) * part;
        else return PixelLanes::load(pair + pixel_at) * part;
    }
    /// The samples of the pixel after the pair that begins here: of three channels, one a byte, the first in the lowest.
    [[nodiscard]] static HMESH_ALWAYS_INLINE std::int32_t bytes_after(const std::int32_t* pair) noexcept {
        static_assert(has_bytes, "pairs of three channels have bytes");
        return pair[C];
    }
    /// The entries as doubles; only if not is_int32().
    [[nodiscard]] HMESH_ALWAYS_INLINE const double* entries() const noexcept { return float64_entries_.data(); }
    /// The offset of entry (x, y), 0 <= x <= width, 0 <= y < height, in numbers from entries().
    [[nodiscard]] HMESH_ALWAYS_INLINE std::size_t offset(int x, int y) const noexcept {
        // Unsigned: a division of what may be negative would take three instructions more.
        constexpr unsigned strip = strip_width;
        const auto column = static_cast<unsigned>(x), row = static_cast<unsigned>(y);
        return column / strip * strip_size_ + std::size_t{row * strip + column % strip} * entry_size;
    }
    /// What all entries (x, y) of one x share.
    struct Column {
        Lanes<4> powers;  ///< the sums of i^2, 0, i and 1 over the pixels (i, y), 0 <= i < x
        IntLanes is_odd,  ///< -1 in all lanes where x is odd, else 0
            last;         ///< x - 1 in all lanes where x is odd, else 0
    };
    /// Column 0 <= x <= width; only if not is_weighted().
    [[nodiscard]] HMESH_ALWAYS_INLINE const Column& column(int x) const noexcept { return columns_[static_cast<unsigned>(x)]; }
    /// The sums of w i and w i^2 that belong to the entry at this offset; only if is_weighted().
    [[nodiscard]] HMESH_ALWAYS_INLINE const double* x_moments(std::size_t offset) const noexcept {
        return x_moment_entries_.data() + offset / lanes;
    }

  private:
    /// Columns whose entries are contiguous down the rows; of integers one of them is kept, and the pixel between.
    static constexpr int strip_width = 2;
    /// Where the pixel's samples stand in a pair: as whole numbers behind the channels or, where these leave no room, behind both
    /// halves; but of three channels as the bytes of the number behind them.
    static constexpr bool has_bytes = C == 3;
    static constexpr int pixel_at = has_bytes || lanes >= 2 * C ? C : 2 * lanes;
    static constexpr int pair_size = pixel_at == C ? 2 * lanes : 3 * lanes;  ///< numbers in a pair
    /// What beyond() multiplies what stands there with, for even and for odd x.
    struct Parts {
        double of[2][std::size_t{lanes}] = {};
        constexpr Parts() noexcept {
            for (int c = 0; c < C; ++c) of[1][c] = has_bytes && c > 0 ? of[1][c - 1] / 256 : 1;
        }
    };
    static constexpr Parts parts{};
    static constexpr std::size_t numbers = entry_size;  ///< entry_size as the size of an array
    static constexpr std::size_t band = 64;             ///< rows that are a piece of work
    static constexpr int chunk = 64;                    ///< most pixels read at once, an even number

    /// Whether all sums over rows of this width fit 32-bit integers, samples and columns an IntegerReader's 16 bits and, where a
    /// pair has bytes for samples, these.
    [[nodiscard]] static bool fits_32_bits(double width, const Kind& kind) noexcept {
        const double largest = 2147483647.0, sample = kind.largest;
        return sample <= 32767 && sample * width * (width - 1) / 2 <= largest && C * sample * sample * width <= largest &&
               width <= 32768 && (!has_bytes || (sample <= 255 && !kind.is_signed));
    }

    [[nodiscard]] HMESH_ALWAYS_INLINE std::size_t pair_offset(int x, int y) const noexcept {
        return static_cast<unsigned>(x) / 2 * strip_size_ + std::size_t{static_cast<unsigned>(y)} * pair_size;
    }
    [[nodiscard]] std::size_t sample_offset(int x, int y) const noexcept {
        return (static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)) * C;
    }
    [[nodiscard]] std::size_t sample_count() const noexcept { return sample_offset(0, height_); }

    HMESH_COLD void fill_columns() {
        columns_.resize_raw(static_cast<std::size_t>(width_) + 1);
        double powers[4] = {};
        for (int x = 0; x <= width_; ++x) {
            const std::int32_t is_odd = -(x & 1);
            columns_[static_cast<unsigned>(x)] = {Lanes<4>::load(powers), IntLanes::all(is_odd), IntLanes::all(is_odd & (x - 1))};
            powers[0] += static_cast<double>(x) * x;
            powers[2] += x;
            powers[3] += 1;
        }
    }

    /// From entry (x, y) to entry (x + 1, y).
    [[nodiscard]] std::size_t step_after(int x) const noexcept {
        return (x + 1) % strip_width != 0 ? std::size_t{entry_size}
                                          : strip_size_ - std::size_t{strip_width - 1} * std::size_t{entry_size};
    }
    /// Calls body(y, x0, count, samples) for the pixels of the rows [begin, end), `count` <= chunk of them from column x0 on,
    /// run after run, because the rows of a strip of columns follow each other in memory, 128 of them in a page for 8-bit
    /// RGB: takes a third of the time of row by row.
    template <class Number, class Body>
    HMESH_ALWAYS_INLINE void for_each_run(const Rect& rect, FunctionRef<void(int, int, int, Number*)> pixels, int begin, int end,
                                          Body&& body) const {
        Number samples[(chunk + 1) * std::size_t{C} + 4] = {};  // as many as are loaded with the last one and its neighbour
        for (int x0 = 0; x0 < width_; x0 += chunk)
            for (int y = begin; y < end; ++y) {
                const int count = std::min(width_ - x0, chunk);
                pixels(rect.x + x0, rect.y + y, count, samples);
                body(y, x0, count, samples);
            }
    }

    /// The sums over the pixels of a row so far, of four channels.
    struct FourSums {
        IntLanes of_samples, by_column;
        std::uint32_t squares;
    };
    static constexpr std::size_t fours = (C + 3) / 4;  ///< groups of four channels

    void fill_pairs(const Rect& rect, IntegerReader pixels, int begin, int end) {
        FourSums sums[band][fours];
        for (auto& of_row : sums)
            for (FourSums& of_four : of_row) of_four = {IntLanes::zero(), IntLanes::zero(), 0};
        for_each_run<std::int16_t>(rect, pixels, begin, end, [&](int y, int x0, int count, const std::int16_t* pixel) {
            write_pairs<0>(x0, count, pixel, int32_entries_.data() + pair_offset(x0, y), sums[y - begin]);
        });
    }
    /// Writes the pairs of a run of a row from column x0 on, the first to `pair`, of the channels from `first` on.
    template <int first>
    HMESH_ALWAYS_INLINE void write_pairs(int x0, int count, const std::int16_t* pixels, std::int32_t* pair,
                                         FourSums (&sums)[fours]) const {
        FourSums sum = sums[first / 4];
        IntLanes columns = IntLanes::halves(x0, x0 + 1);
        const std::int16_t* pixel = pixels + first;
        std::size_t at = 0;
        for (int i = 0; i <= count; i += 2, pixel += std::ptrdiff_t{2} * C, at += strip_size_) {
            std::int32_t* const to = pair + at;
            const std::int32_t squares_before = first > 0 ? to[lanes + C] : 0;  // what is stored next may cover them
            store(sum.of_samples, to + first);
            store(sum.by_column, to + lanes + first);
            to[lanes + C] = squares_before + static_cast<std::int32_t>(sum.squares);
            if constexpr (first == 0) keep(pixel, to);  // where i == count, what nobody looks at
            if (i == count) break;
            // Nobody looks at lanes above the channels either, nor at sums with a pixel beyond the last of a row.
            const IntLanes both = IntLanes::halves(pixel, pixel + C), squares = product_of_halves(both, both);
            sum.of_samples += product_of_halves(both, IntLanes::halves(1, 1));
            sum.by_column += product_of_halves(both, columns);
            for (int c = 0; c < std::min(C - first, 4); ++c) sum.squares += static_cast<std::uint32_t>(squares[c]);
            columns += IntLanes::halves(2, 2);
        }
        sums[first / 4] = sum;
        if constexpr (first + 4 < C) write_pairs<first + 4>(x0, count, pixels, pair, sums);
    }
    /// Writes the sums of four channels, or of the first alone where there are no more.
    static HMESH_ALWAYS_INLINE void store(const IntLanes& sums, std::int32_t* to) noexcept {
        if constexpr (C == 1) *to = sums[0];
        else sums.store(to);
    }
    /// Writes a pixel's samples into a pair, and 0 into the lanes above them, which beyond() loads.
    static HMESH_ALWAYS_INLINE void keep(const std::int16_t* samples, std::int32_t* pair) noexcept {
        if constexpr (has_bytes) pair[C] = samples[0] | samples[1] << 8 | samples[2] << 16;
        else
            for (int c = 0; c < lanes_for(C); ++c) pair[pixel_at + c] = c < C ? samples[c] : 0;
    }

    HMESH_PATCHWISE void fill(const Rect& rect, PixelReader pixels, int begin, int end) {
        Entry sums[band];
        for (Entry& of_row : sums) of_row.of_samples = of_row.by_column = Channels::zero();
        // What is added for each pixel. Loops of their own: lanes set one by one are loaded as one sooner than they are stored.
        double added[chunk][numbers] = {};
        for (auto& of_pixel : added) of_pixel[C] = 1;
        for_each_run<double>(rect, pixels, begin, end, [&](int y, int x0, int count, const double* pixel) {
            for (int i = 0; i < count; ++i, pixel += C) {
                double square = 0;
                for (int c = 0; c < C; ++c) {
                    added[i][c] = pixel[c];
                    added[i][lanes + c] = (x0 + i) * pixel[c];
                    square += pixel[c] * pixel[c];
                }
                added[i][lanes + C] = square;
            }
            Entry sum = sums[y - begin];
            double* entry = float64_entries_.data() + offset(x0, y);
            for (int i = 0;; ++i) {
                sum.of_samples.store(entry);
                sum.by_column.store(entry + lanes);
                if (i == count) break;
                entry += step_after(x0 + i);
                sum.of_samples += Channels::load(added[i]);
                sum.by_column += Channels::load(added[i] + lanes);
            }
            sums[y - begin] = sum;
        });
    }

    HMESH_PATCHWISE void fill_weighted(const Rect& rect, PixelReader pixels, PixelReader weights, int begin, int end) {
        double sums[band][numbers] = {}, powers[band][2] = {};
        for_each_run<double>(rect, pixels, begin, end, [&](int y, int x0, int count, const double* pixel) {
            double *const sum = sums[y - begin], *const power = powers[y - begin];
            double weight[chunk];
            weights(rect.x + x0, rect.y + y, count, weight);
            float* samples = samples_.data() + sample_offset(x0, y);
            for (int x = x0;; ++x, pixel += C, samples += C) {
                double* const entry = float64_entries_.data() + offset(x, y);
                double* const entry_powers = x_moment_entries_.data() + offset(x, y) / lanes;
                for (int k = 0; k < entry_size; ++k) entry[k] = sum[k];
                for (int k = 0; k < 2; ++k) entry_powers[k] = power[k];
                if (x == x0 + count) break;
                const double w = weight[x - x0];
                double square = 0;
                for (int c = 0; c < C; ++c) {
                    const double value = pixel[c], part = w * value;
                    samples[c] = static_cast<float>(value);
                    sum[c] += part;
                    sum[lanes + c] += x * part;
                    square += value * value;
                }
                sum[C] += w;
                sum[lanes + C] += w * square;
                power[0] += x * w;
                power[1] += static_cast<double>(x) * x * w;
            }
        });
    }

    int width_ = 0, height_ = 0;
    bool weighted_ = false;
    bool int32_ = true;
    bool has_far_sides_ = false;
    std::size_t strip_size_ = 0;
    std::size_t size_ = 0;
    Array<std::int32_t> int32_entries_;
    Array<double> float64_entries_;
    Array<Column> columns_;           ///< of other than weighted tables
    Array<double> x_moment_entries_;  ///< of weighted tables: w i, w i^2
    FarSides far_sides_;
    Array<float> samples_;  ///< of weighted tables: I_0 .. I_{C-1}, row after row
};

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_FIT_MOMENT_TABLE_HPP
