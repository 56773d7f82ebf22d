/// \file
/// BilateralTile: the kernel of bilateral_filter(), for one tile of an image, in vectors of floats.
///
/// methods/hierarchical/bilateral.hpp defines the filter; this header has the planes of samples, the weights, and the order in
/// which they are computed.
#ifndef HMESH_METHODS_HIERARCHICAL_BILATERAL_TILE_HPP
#define HMESH_METHODS_HIERARCHICAL_BILATERAL_TILE_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "hmesh/core/array.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/lanes.hpp"
#include "hmesh/image/image_view.hpp"

#include "hmesh/core/macros/push.hpp"

#if defined(__GNUC__) && !defined(__clang__)
/// Before a short loop over channels, which GCC does not unroll at -O2.
#define HMESH_UNROLL _Pragma("GCC unroll 16")
#else
#define HMESH_UNROLL
#endif

namespace hmesh::kit::detail {

// Floats: neighbouring pixels of one channel, as many as a register holds; one where the compiler or the processor has no
// vectors.
#if defined(__GNUC__) && (defined(__SSE__) || !defined(__i386__))
#if defined(__AVX2__)
inline constexpr int float_lanes = 8;
#else
inline constexpr int float_lanes = 4;
#endif
using Floats = float __attribute__((vector_size(4 * float_lanes)));
using Ints = std::int32_t __attribute__((vector_size(4 * float_lanes)));
using Bits = std::uint32_t __attribute__((vector_size(4 * float_lanes)));
HMESH_ALWAYS_INLINE Ints truncate(Floats x) { return __builtin_convertvector(x, Ints); }
HMESH_ALWAYS_INLINE Floats to_floats(Ints n) { return __builtin_convertvector(n, Floats); }
#else
inline constexpr int float_lanes = 1;
using Floats = float;
using Ints = std::int32_t;
using Bits = std::uint32_t;
HMESH_ALWAYS_INLINE Ints truncate(Floats x) { return static_cast<Ints>(x); }
HMESH_ALWAYS_INLINE Floats to_floats(Ints n) { return static_cast<Floats>(n); }
#endif

HMESH_ALWAYS_INLINE Floats load_floats(const float* from) {
    Floats x;
    std::memcpy(&x, from, sizeof x);
    return x;
}
template <class Values>
HMESH_ALWAYS_INLINE Bits bits_of(Values x) {
    Bits bits;
    std::memcpy(&bits, &x, sizeof bits);
    return bits;
}
HMESH_ALWAYS_INLINE void store_floats(Floats x, float* to) { std::memcpy(to, &x, sizeof x); }
HMESH_ALWAYS_INLINE Floats from_bits(Bits bits) {
    Floats x;
    std::memcpy(&x, &bits, sizeof x);
    return x;
}
HMESH_ALWAYS_INLINE Floats magnitude(Floats x) { return from_bits(bits_of(x) & 0x7fffffffU); }

/// The smallest exponent of 2 that a weight can have: 2^-125 is a normal float, and negligible beside the weight 1 of the
/// window's centre.
inline constexpr float min_exponent = -125;

/// 2^x for x <= 0, at least 2^min_exponent. The integer part of x is added to the bits of the exponent. For the fraction f, in
/// [-1, 0], a polynomial of degree 5 with the smallest largest relative error (Remez) approximates 2^f to 7.5e-8, with rounding
/// to 3e-7. The rounding of x itself, 2^-24 |x|, adds as much at weights of 1/8, and 1e-6 at weights of 2^-24, which hardly
/// count.
HMESH_ALWAYS_INLINE Floats power_of_2(Floats x) {
    const Floats lowest = Floats{} + min_exponent;
    x = x > lowest ? x : lowest;
    const Ints n = truncate(x);
    const Floats f = x - to_floats(n);
    Floats p = f * 0.000938788337F + 0.00918861173F;
    p = p * f + 0.0552797226F;
    p = p * f + 0.240172189F;
    p = p * f + 0.693142253F;
    p = p * f + 0.999999925F;
    return from_bits(bits_of(p) + (bits_of(n) << 23U));
}

/// Any index i mirrored at the centres of the first and the last of n pixels until it is in [0, n).
[[nodiscard]] inline int reflect(int i, int n) noexcept {
    if (n == 1) return 0;
    const int period = 2 * (n - 1), k = (i % period + period) % period;
    return k < n ? k : period - k;
}

/// The window of the filter, one tap of each pair of opposite ones, since two pixels have the same weight for each other.
/// Colours are in the unit of BilateralTile: samples times unit().
class BilateralWindow {
  public:
    /// The tap (dx, dy) below or to the right of the centre, and the tap (-dx, -dy).
    struct Pair {
        int dx, dy;      ///< px
        float exponent;  ///< log2 of the weight by nearness in the plane
    };

    /// The window of `radius` px; sigma_color in stored values and sigma_space in px, both finite and >= 0.
    BilateralWindow(int radius, double sigma_color, double sigma_space) : radius_(radius) {
        constexpr double log2_e = 1.4426950408889634;
        for (int dy = 0; dy <= radius_; ++dy)
            for (int dx = dy > 0 ? -radius_ : 1; dx <= radius_; ++dx) {
                const int square = dx * dx + dy * dy;
                if (square > radius_ * radius_) continue;
                const double distance = std::sqrt(static_cast<double>(square)) / sigma_space;
                const double exponent = -log2_e / 2 * distance * distance;
                pairs_.push_back({dx, dy, static_cast<float>(std::max(exponent, static_cast<double>(min_exponent)))});
            }
        // unit_ is a power of two, so that products do not round: at least 2^-72, which keeps any float below the 2^57 of the
        // tile however large sigma is, at most 2^1000, which has an inverse. factor_ takes the rest of the scale.
        const double scale = std::sqrt(log2_e / 2) / std::max(1e-290, sigma_color);
        unit_ = std::ldexp(1.0, std::max(-72, std::min(1000, std::ilogb(scale))));
        factor_ = static_cast<float>(std::min(4.0, (scale / unit_) * (scale / unit_)));
    }

    /// The radius in px.
    [[nodiscard]] int radius() const noexcept { return radius_; }
    /// All pairs of taps, by rising dy.
    [[nodiscard]] const Array<Pair>& pairs() const noexcept { return pairs_; }
    /// The factor that samples are multiplied by.
    [[nodiscard]] double unit() const noexcept { return unit_; }
    /// -log2 of the weight of two colours whose distance is 1 / unit() stored values; in [0, 4].
    [[nodiscard]] float factor() const noexcept { return factor_; }

  private:
    int radius_;
    Array<Pair> pairs_;
    double unit_ = 1;
    float factor_ = 1;
};

/// A tile of an image as planes of floats, with a margin of the window's radius, and the sums over its windows.
///
/// Range: samples are multiplied by the window's unit and clamped to +-2^57, where the steps of floats are far longer than
/// sigma. Distances over 16 channels stay below 2^62, their squares times the factor below 2^126, and a difference of 2^58 times
/// the smallest weight is negligible: whatever the samples, no sum overflows. Integers need no clamping if sigma_color is at
/// least min_sigma, and a smaller sigma_color would give the same weights, since all differences are 0 or at least 1.
///
/// Order: row by row, the weights of all pairs are computed and kept for as many rows as the pairs reach down. Each pixel then
/// takes the weights of its own row for the taps ahead, and the kept ones for the taps behind, which halves the number of
/// weights. Pairs whose rows together take more than max_kept floats are left for another turn over the tile.
///
/// float_lanes is a parameter so that files compiled for different processors do not share functions with one layout.
template <int C, int = float_lanes>
class BilateralTile {
  public:
    static constexpr int max_width = 128, max_height = 64;
    static constexpr double limit = 144115188075855872.0;  ///< 2^57, of samples
    template <class T>
    static constexpr double min_sigma = PixelTraits<T>::is_integer
                                            ? std::max(PixelTraits<T>::highest, -PixelTraits<T>::lowest) / limit
                                            : 0;
    static constexpr std::size_t max_kept = 16384;  ///< floats: 64 kB; diameter 9 needs some 9,000

    /// Workspace for tiles of an image of this width in px; the window must outlive it.
    BilateralTile(const BilateralWindow& window, int image_width)
        : window_(window), radius_(window.radius()),
          width_((std::min(max_width, image_width) + float_lanes - 1) / float_lanes * float_lanes),
          stride_(width_ + 2 * radius_ + float_lanes), plane_(stride_ * (max_height + 2 * radius_)),
          samples_(static_cast<std::size_t>(plane_) * C), columns_(static_cast<std::size_t>(stride_)),
          sums_(static_cast<std::size_t>((C + 1) * width_ * max_height)) {
        std::size_t kept = 0, most = 0;
        for (const BilateralWindow::Pair& pair : window.pairs()) {
            const auto rows = static_cast<std::size_t>((pair.dy + 1) * stride_);
            if (kept + rows > max_kept) kept = 0;
            taps_.push_back({pair, kept, pair.dy * stride_ + pair.dx, nullptr, nullptr});
            kept += rows;
            most = std::max(most, kept);
        }
        weights_.resize(most);
    }

    /// Filters the pixels in `rect` of the view, at most max_width x max_height, into the same pixels of `out`.
    template <class T>
    void filter(const ImageView<T, C>& view, const Rect& rect, Image<T, C>& out) {
        load(view, rect);
        sum_windows(rect.height);
        for (int y = 0; y < rect.height; ++y)
            store(sums(y), view.pixel(rect.x, rect.y + y), rect.width, out.pixel(rect.x, rect.y + y));
    }

  private:
    /// A pair of taps and where its weights are.
    struct Tap {
        BilateralWindow::Pair pair;
        std::size_t kept;             ///< where its pair.dy + 1 rows of weights begin in weights_; 0: another turn begins with it
        std::ptrdiff_t offset;        ///< from a sample to the one ahead, in floats
        const float *ahead, *behind;  ///< weights of the current row, and of the row pair.dy above it from -pair.dx on
    };

    /// The sums over the windows of all pixels in the rows [0, height).
    void sum_windows(int height) {
        const auto weights = sums_.begin() + static_cast<std::ptrdiff_t>(C) * width_ * max_height;
        std::fill(sums_.begin(), weights, 0.0F);
        std::fill(weights, sums_.end(), 1.0F);  // the weight of the centre itself
        for (Tap *begin = taps_.data(), *last = begin + taps_.size(), *end = begin; begin < last; begin = end) {
            for (end = begin + 1; end < last && end->kept > 0;) ++end;
            for (int y = -end[-1].pair.dy; y < height; ++y) {
                for (Tap* tap = begin; tap < end; ++tap)
                    if (y + tap->pair.dy >= 0) weigh(*tap, y);
                if (y >= 0) add(begin, end, y);
            }
        }
    }

    [[nodiscard]] const float* samples(int y) const noexcept { return samples_.data() + (y + radius_) * stride_ + radius_; }
    [[nodiscard]] float* sums(int y) noexcept { return sums_.data() + static_cast<std::ptrdiff_t>(y) * width_; }

    /// Fills the planes with the samples of `rect` and its margin.
    template <class T>
    void load(const ImageView<T, C>& view, const Rect& rect) {
        for (std::ptrdiff_t x = 0; x < stride_; ++x)
            columns_[static_cast<std::size_t>(x)] = reflect(rect.x + static_cast<int>(x) - radius_, view.width) * C;
        const std::ptrdiff_t plane = plane_;
        const double unit = window_.unit();
        for (int y = -radius_; y < rect.height + radius_; ++y) {
            const T* row = view.row(reflect(rect.y + y, view.height));
            float* to = samples_.data() + (y + radius_) * stride_;
            for (const int column : columns_) {
                for (int c = 0; c < C; ++c) {
                    double value = PixelTraits<T>::to_real(row[column + c]) * unit;
                    if (!PixelTraits<T>::is_integer) value = std::max(-limit, std::min(limit, value));
                    to[c * plane] = static_cast<float>(value);
                }
                ++to;
            }
        }
    }
    /// Writes a row: the samples `from` plus the weighted means of the differences from them. Members are copied to locals, since
    /// stores of bytes might change any member.
    template <class T>
    void store(const float* sum, const T* from, int width, T* to) const {
        const std::ptrdiff_t plane = static_cast<std::ptrdiff_t>(width_) * max_height;
        const double unit = 1 / window_.unit();
        for (int x = 0; x < width; ++x, ++sum) {
            const double scale = unit / static_cast<double>(sum[C * plane]);
            for (int c = 0; c < C; ++c, ++from, ++to)
                *to = PixelTraits<T>::from_real(PixelTraits<T>::to_real(*from) + static_cast<double>(sum[c * plane]) * scale);
        }
    }

    /// Computes the weights of a pair for row y >= -pair.dy, for all pixels that have a pixel of the tile as their tap or are
    /// one.
    HMESH_NEVER_INLINE void weigh(Tap& tap, int y) {
        const int dx = tap.pair.dx, dy = tap.pair.dy;
        const auto kept_row = [&](int row) { return weights_.data() + tap.kept + (row + dy) % (dy + 1) * stride_ + radius_; };
        float* out = kept_row(y);
        tap.ahead = out;
        if (y >= 0) tap.behind = kept_row(y - dy) - dx;
        const std::ptrdiff_t plane = plane_, offset = tap.offset;
        const float factor = window_.factor(), exponent = tap.pair.exponent;
        const int begin = std::min(0, -dx), end = width_ + std::max(0, -dx);
        const float* row = samples(y);
        for (int x = begin; x < end; x += float_lanes) {
            const float* here = row + x;
            Floats distance = {};
            HMESH_UNROLL
            for (int c = 0; c < C; ++c)
                distance += magnitude(load_floats(here + offset + c * plane) - load_floats(here + c * plane));
            store_floats(power_of_2(exponent - factor * (distance * distance)), out + x);
        }
    }

    /// Adds to the sums of row y the weights of the taps and the weighted differences of their samples from the centre's.
    /// Differences of integers are exact, those from a huge neighbour are not lost, and an image of one colour stays as it is.
    HMESH_NEVER_INLINE void add(const Tap* begin, const Tap* end, int y) {
        const std::ptrdiff_t plane = plane_, sums_plane = static_cast<std::ptrdiff_t>(width_) * max_height;
        for (int x = 0; x < width_; x += float_lanes) {
            const float* here = samples(y) + x;
            float* out = sums(y) + x;
            Floats middle[std::size_t{C}], sum[std::size_t{C}], weight = load_floats(out + C * sums_plane);
            HMESH_UNROLL
            for (int c = 0; c < C; ++c) {
                middle[c] = load_floats(here + c * plane);
                sum[c] = load_floats(out + c * sums_plane);
            }
            for (const Tap* tap = begin; tap < end; ++tap) {
                const Floats ahead = load_floats(tap->ahead + x), behind = load_floats(tap->behind + x);
                const float *a = here + tap->offset, *b = here - tap->offset;
                weight += ahead + behind;
                HMESH_UNROLL
                for (int c = 0; c < C; ++c)
                    sum[c] +=
                        ahead * (load_floats(a + c * plane) - middle[c]) + behind * (load_floats(b + c * plane) - middle[c]);
            }
            store_floats(weight, out + C * sums_plane);
            HMESH_UNROLL
            for (int c = 0; c < C; ++c) store_floats(sum[c], out + c * sums_plane);
        }
    }

    const BilateralWindow& window_;
    int radius_, width_;
    std::ptrdiff_t stride_, plane_;  ///< floats from one row to the next, and from one channel to the next
    Array<float> samples_;
    Array<int> columns_;  ///< for each column of the planes the index of its samples in a row of the view
    Array<float> sums_;   ///< of the channels, then of the weights, planes of width_ x max_height
    Array<float> weights_;
    Array<Tap> taps_;
};

}  // namespace hmesh::kit::detail

#include "hmesh/core/macros/pop.hpp"

#undef HMESH_UNROLL

#endif  // HMESH_METHODS_HIERARCHICAL_BILATERAL_TILE_HPP
