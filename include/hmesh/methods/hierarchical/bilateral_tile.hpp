/// \file
/// BilateralTile: the bilateral filter at work on a tile of an image, in vectors of floats.
///
/// The definition is in bilateral.hpp. Here are the planes, the weights and the order of the work.
#ifndef HMESH_METHODS_HIERARCHICAL_BILATERAL_TILE_HPP
#define HMESH_METHODS_HIERARCHICAL_BILATERAL_TILE_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "hmesh/core/compiler.hpp"
#include "hmesh/core/lanes.hpp"
#include "hmesh/image/image_view.hpp"

#include "hmesh/core/macros/push.hpp"

// GCC leaves short loops over channels as they are at -O2.
#if defined(__GNUC__) && !defined(__clang__)
#define HMESH_UNROLL _Pragma("GCC unroll 16")
#else
#define HMESH_UNROLL
#endif

namespace hmesh::kit::detail {

// Neighbouring pixels of one channel, as many as a register holds. One at a time where compiler or processor has no vectors.
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

/// The least exponent of 2 that a weight can have: 2^-125 is a float, and nothing beside the weight 1 of the centre.
inline constexpr float least_exponent = -125;

/// 2^x for x <= 0, no less than 2^least_exponent. The integer part goes to the exponent's bits; the polynomial is that of
/// degree 5 with the least relative error of 2^f over -1 <= f <= 0 (Remez), 7.5e-8; with rounding it is 3e-7. Rounding
/// of x itself, 2^-24 |x|, adds as much at weights of 1/8 and 1e-6 at 2^-24, which hardly count.
HMESH_ALWAYS_INLINE Floats power_of_2(Floats x) {
    const Floats least = Floats{} + least_exponent;
    x = x > least ? x : least;
    const Ints n = truncate(x);
    const Floats f = x - to_floats(n);
    Floats p = f * 0.000938788337F + 0.00918861173F;
    p = p * f + 0.0552797226F;
    p = p * f + 0.240172189F;
    p = p * f + 0.693142253F;
    p = p * f + 0.999999925F;
    return from_bits(bits_of(p) + (bits_of(n) << 23U));
}

/// Index i, also one outside [0, n), mirrored at the centres of the first and the last of n pixels until it is inside.
[[nodiscard]] inline int reflect(int i, int n) noexcept {
    if (n == 1) return 0;
    const int period = 2 * (n - 1), k = (i % period + period) % period;
    return k < n ? k : period - k;
}

/// Half of the window, since two pixels have one weight for each other, in the units of BilateralTile: samples times unit().
class BilateralWindow {
  public:
    /// The tap (dx, dy) below or to the right of the centre, and the one opposite.
    struct Pair {
        int dx, dy;
        float exponent;  ///< log2 of the weight by nearness in the plane
    };

    /// The radius in px, sigma of colours in stored values, sigma of places in px; both finite and at least 0.
    BilateralWindow(int radius, double sigma_color, double sigma_space) : radius_(radius) {
        constexpr double log2_e = 1.4426950408889634;
        for (int dy = 0; dy <= radius_; ++dy)
            for (int dx = dy > 0 ? -radius_ : 1; dx <= radius_; ++dx) {
                const int square = dx * dx + dy * dy;
                if (square > radius_ * radius_) continue;
                const double distance = std::sqrt(static_cast<double>(square)) / sigma_space;
                const double exponent = -log2_e / 2 * distance * distance;
                pairs_.push_back({dx, dy, static_cast<float>(std::max(exponent, static_cast<double>(least_exponent)))});
            }
        // A power of two, so that products do not round. From 2^-72, which keeps any float below the 2^57 of the tile
        // however large sigma, to 2^1000, which has an inverse; the factor takes what is left.
        const double scale = std::sqrt(log2_e / 2) / std::max(1e-290, sigma_color);
        unit_ = std::ldexp(1.0, std::max(-72, std::min(1000, std::ilogb(scale))));
        factor_ = static_cast<float>(std::min(4.0, (scale / unit_) * (scale / unit_)));
    }

    [[nodiscard]] int radius() const noexcept { return radius_; }
    [[nodiscard]] const std::vector<Pair>& pairs() const noexcept { return pairs_; }  ///< by rising dy
    [[nodiscard]] double unit() const noexcept { return unit_; }
    [[nodiscard]] float factor() const noexcept { return factor_; }  ///< -log2 of the weight of colours 1 apart, in [0, 4]

  private:
    int radius_;
    std::vector<Pair> pairs_;
    double unit_ = 1;
    float factor_ = 1;
};

/// A tile of an image as planes of floats, with a margin of the window's radius, and the sums over its windows.
//
/// Samples are multiplied by the window's unit and kept within +-2^57; a float's own steps are there far longer than
/// sigma. Distances over 16 channels stay below 2^62, their squares times the factor below 2^126, and a difference of
/// 2^58 times the least weight is still nothing: whatever the samples, no sum overflows. Integers are within by
/// themselves if sigma of colours is at least least_sigma: where all differences are 0 or at least 1, a smaller one
/// has no other weights.
//
/// Row by row, the weights of all pairs are found and kept for as many rows as the pairs reach down; then each pixel
/// takes those of its own row for the taps ahead and the kept ones for the taps behind. That halves the work on weights.
/// Pairs whose rows together are longer than max_kept wait for another turn.
/// float_lanes is a parameter so that files compiled for different processors do not share one layout's functions.
template <class T, int C, int = float_lanes>
class BilateralTile {
  public:
    static constexpr int max_width = 128, max_height = 64;
    static constexpr double least_sigma =
        PixelTraits<T>::is_integer ? std::max(PixelTraits<T>::highest, -PixelTraits<T>::lowest) / 144115188075855872.0 : 0;
    static constexpr std::size_t max_kept = 16384;  ///< floats: 64 kB; diameter 9 needs some 9,000

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

    /// Filters the pixels of `rect`, at most max_width x max_height, of the view into the same place of `out`.
    void filter(const ImageView<T, C>& view, const Rect& rect, Image<T, C>& out) {
        load(view, rect);
        const auto weights = sums_.begin() + static_cast<std::ptrdiff_t>(C) * width_ * max_height;
        std::fill(sums_.begin(), weights, 0.0F);
        std::fill(weights, sums_.end(), 1.0F);  // of the centre
        for (Tap *begin = taps_.data(), *last = begin + taps_.size(), *end = begin; begin < last; begin = end) {
            for (end = begin + 1; end < last && end->kept > 0;) ++end;
            for (int y = -end[-1].pair.dy; y < rect.height; ++y) {
                for (Tap* tap = begin; tap < end; ++tap)
                    if (y + tap->pair.dy >= 0) weigh(*tap, y);
                if (y >= 0) add(begin, end, y);
            }
        }
        for (int y = 0; y < rect.height; ++y)
            store(sums(y), view.pixel(rect.x, rect.y + y), rect.width, out.pixel(rect.x, rect.y + y));
    }

  private:
    struct Tap {
        BilateralWindow::Pair pair;
        std::size_t kept;             ///< where the pair.dy + 1 rows of its weights begin; 0: another turn begins with it
        std::ptrdiff_t offset;        ///< of the samples ahead
        const float *ahead, *behind;  ///< weights of the row at hand, and of the row pair.dy above it from -pair.dx on
    };

    [[nodiscard]] const float* samples(int y) const noexcept { return samples_.data() + (y + radius_) * stride_ + radius_; }
    [[nodiscard]] float* sums(int y) noexcept { return sums_.data() + static_cast<std::ptrdiff_t>(y) * width_; }

    void load(const ImageView<T, C>& view, const Rect& rect) {
        for (std::ptrdiff_t x = 0; x < stride_; ++x)
            columns_[static_cast<std::size_t>(x)] = reflect(rect.x + static_cast<int>(x) - radius_, view.width) * C;
        const std::ptrdiff_t plane = plane_;
        const double unit = window_.unit(), most = 144115188075855872.0;  // 2^57
        for (int y = -radius_; y < rect.height + radius_; ++y) {
            const T* row = view.row(reflect(rect.y + y, view.height));
            float* to = samples_.data() + (y + radius_) * stride_;
            for (const int column : columns_) {
                for (int c = 0; c < C; ++c) {
                    double value = PixelTraits<T>::to_real(row[column + c]) * unit;
                    if (!PixelTraits<T>::is_integer) value = std::max(-most, std::min(most, value));
                    to[c * plane] = static_cast<float>(value);
                }
                ++to;
            }
        }
    }
    /// The samples `from` and the means of the differences to them. Stores of bytes may change any member: hence locals.
    void store(const float* sum, const T* from, int width, T* to) const {
        const std::ptrdiff_t plane = static_cast<std::ptrdiff_t>(width_) * max_height;
        const double unit = 1 / window_.unit();
        for (int x = 0; x < width; ++x, ++sum) {
            const double scale = unit / static_cast<double>(sum[C * plane]);
            for (int c = 0; c < C; ++c, ++from, ++to)
                *to = PixelTraits<T>::from_real(PixelTraits<T>::to_real(*from) + static_cast<double>(sum[c * plane]) * scale);
        }
    }

    /// The weights of row y, -pair.dy <= y, for the pixels that have the tile's as their tap ahead or behind.
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

    /// Adds the weights of row y and the weighted differences of the samples to those of the pixel in the middle.
    /// Differences, because those of integers are exact and those to a huge neighbour not lost, and because an image of
    /// one colour stays what it is.
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
    std::ptrdiff_t stride_, plane_;  ///< floats from row to row and from channel to channel
    std::vector<float> samples_;
    std::vector<int> columns_;  ///< of the view's rows, for each column of the planes
    std::vector<float> sums_;   ///< of channels and then of weights, a plane of width_ x max_height each
    std::vector<float> weights_;
    std::vector<Tap> taps_;
};

}  // namespace hmesh::kit::detail

#include "hmesh/core/macros/pop.hpp"

#undef HMESH_UNROLL

#endif  // HMESH_METHODS_HIERARCHICAL_BILATERAL_TILE_HPP
