// hmesh - bilateral_filter: smooths an image and keeps its edges.
//
// Tomasi and Manduchi, "Bilateral filtering for gray and color images" (1998): each pixel becomes the mean of those in a
// disc around it, weighted by nearness in the plane and in colour. Window, distance of colours (L1) and border follow
// OpenCV's bilateralFilter, whose parameters the hierarchical method states: diameter 9, both sigmas 50.
//
// Cost: the taps of the disc (49 at diameter 9), of which each costs about 0.5 ns a pixel of 3 channels with vectors of 8
// floats and 1.5 ns with vectors of 4. Memory beyond the output: planes of a tile, some 100 kB a thread at diameter 9.
#ifndef HMESH_IMAGE_BILATERAL_HPP
#define HMESH_IMAGE_BILATERAL_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "hmesh/core/assert.hpp"
#include "hmesh/core/lanes.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/image/image_view.hpp"

namespace hmesh {

struct BilateralOptions {
    int diameter = 9;         // of the window, px, in [1, 99]; its radius is diameter / 2 rounded down
    double sigma_color = 50;  // in 1/255 of the peak of the pixel type, > 0
    double sigma_space = 50;  // px, > 0
};

// Whether all options are in range.
[[nodiscard]] inline Status check(const BilateralOptions& options) noexcept {
    const auto bad = [](const char* what) -> Status { return {Errc::invalid_argument, what, 0, 0}; };
    const auto positive = [](double value) { return value > 0 && std::isfinite(value); };  // false for NaN
    if (options.diameter < 1) return {Errc::invalid_argument, "bilateral.diameter must be at least 1", options.diameter, 1};
    if (options.diameter > 99) return {Errc::invalid_argument, "bilateral.diameter must be at most 99", options.diameter, 99};
    if (!positive(options.sigma_color)) return bad("bilateral.sigma_color must be positive and finite");
    if (!positive(options.sigma_space)) return bad("bilateral.sigma_space must be positive and finite");
    return {};
}

namespace detail {

// Neighbouring pixels of one channel, as many as a register holds. One at a time where the compiler has no vectors.
#if defined(__GNUC__)
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
HMESH_ALWAYS_INLINE Floats from_bits(Bits bits) {
    Floats x;
    std::memcpy(&x, &bits, sizeof x);
    return x;
}
HMESH_ALWAYS_INLINE Floats magnitude(Floats x) { return from_bits(bits_of(x) & 0x7fffffffU); }

// The least exponent of 2 that a weight can have: 2^-125 is a float, and nothing beside the weight 1 of the centre.
inline constexpr float least_exponent = -125;

// 2^x for x <= 0, no less than 2^least_exponent. The integer part goes to the exponent's bits; the polynomial is that of
// degree 5 with the least relative error of 2^f over -1 <= f <= 0 (Remez), 7.5e-8; with rounding it is 2.5e-7. Rounding
// of x itself, 2^-24 |x|, adds as much at weights of 1/8 and 1e-6 at 2^-24, which hardly count.
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

// Index i, also one outside [0, n), mirrored at the centres of the first and the last of n pixels until it is inside.
[[nodiscard]] inline int reflect(int i, int n) noexcept {
    if (n == 1) return 0;
    const int period = 2 * (n - 1), k = (i % period + period) % period;
    return k < n ? k : period - k;
}

// The window and its weights in the units of BilateralTile: samples times unit().
class BilateralWindow {
  public:
    struct Tap {
        int dx, dy;
        float exponent;  // log2 of its weight by nearness in the plane
    };

    BilateralWindow(const BilateralOptions& options, double peak) : radius_(options.diameter / 2) {
        constexpr double log2_e = 1.4426950408889634;
        for (int dy = -radius_; dy <= radius_; ++dy)
            for (int dx = -radius_; dx <= radius_; ++dx) {
                const int square = dx * dx + dy * dy;
                if (square > radius_ * radius_) continue;
                const double distance = std::sqrt(static_cast<double>(square)) / options.sigma_space;
                const double exponent = -log2_e / 2 * distance * distance;
                taps_.push_back({dx, dy, static_cast<float>(std::max<double>(exponent, least_exponent))});
            }
        // Powers of two do not round. Up to 2^72 a sample of any size stays below the 2^57 of the tile, however large
        // sigma; 2^1000 keeps 1 / unit a normal number. Beyond, the factor takes what is left.
        const double sigma = std::max(1e-290, options.sigma_color * (peak / 255));
        const double scale = std::sqrt(log2_e / 2) / sigma;
        unit_ = std::ldexp(1.0, std::max(-72, std::min(1000, std::ilogb(scale))));
        factor_ = static_cast<float>(std::min(4.0, (scale / unit_) * (scale / unit_)));
    }

    [[nodiscard]] int radius() const noexcept { return radius_; }
    [[nodiscard]] const std::vector<Tap>& taps() const noexcept { return taps_; }
    [[nodiscard]] double unit() const noexcept { return unit_; }
    // -log2 of the weight of a distance 1 of colours, in [0, 4].
    [[nodiscard]] float factor() const noexcept { return factor_; }

  private:
    int radius_;
    std::vector<Tap> taps_;
    double unit_ = 1;
    float factor_ = 1;
};

// A tile of an image as planes of floats, with a margin of the window's radius.
//
// Samples are multiplied by the window's unit and kept within +-2^57: so far apart in units of sigma, a float's own
// steps are long weights of 0. Distances of up to 16 channels stay below 2^62, their squares times the factor below 2^126, and
// a difference of 2^58 times the least weight is still nothing: whatever the samples, no sum overflows.
template <class T, int C>
class BilateralTile {
  public:
    static constexpr int block_vectors = 2;  // the sums of both and a few more registers are all there is
    static constexpr int block = block_vectors * float_lanes;
    static constexpr int max_width = 128, max_height = 32;

    BilateralTile(const BilateralWindow& window, int image_width)
        : window_(window), radius_(window.radius()),
          stride_((std::min(max_width, image_width) + block - 1) / block * block + 2 * radius_),
          plane_(stride_ * (max_height + 2 * radius_)), samples_(static_cast<std::size_t>(plane_) * C),
          columns_(static_cast<std::size_t>(stride_)) {
        for (const BilateralWindow::Tap tap : window.taps())
            taps_.push_back({static_cast<std::ptrdiff_t>(tap.dy) * stride_ + tap.dx, tap.exponent});
    }

    // Filters the pixels of `rect`, at most max_width x max_height, of the view into the same place of `out`.
    void filter(const ImageView<T, C>& view, const Rect& rect, Image<T, C>& out) {
        load(view, rect);
        float means[C][block];
        for (int y = 0; y < rect.height; ++y)
            for (int x = 0; x < rect.width; x += block) {
                average(samples_.data() + (y + radius_) * stride_ + x + radius_, means);
                const int end = std::min(block, rect.width - x);
                const T* from = view.pixel(rect.x + x, rect.y + y);
                T* to = out.pixel(rect.x + x, rect.y + y);
                for (int i = 0; i < end; ++i)
                    for (int c = 0; c < C; ++c, ++from, ++to)
                        *to = PixelTraits<T>::from_real(PixelTraits<T>::to_real(*from) +
                                                        static_cast<double>(means[c][i]) / window_.unit());
            }
    }

  private:
    struct Tap {
        std::ptrdiff_t offset;
        float exponent;
    };

    void load(const ImageView<T, C>& view, const Rect& rect) {
        for (std::ptrdiff_t x = 0; x < stride_; ++x)
            columns_[static_cast<std::size_t>(x)] = reflect(rect.x + static_cast<int>(x) - radius_, view.width) * C;
        for (int y = 0; y < rect.height + 2 * radius_; ++y) {
            const T* row = view.row(reflect(rect.y + y - radius_, view.height));
            float* to = samples_.data() + y * stride_;
            for (const int column : columns_) {
                for (int c = 0; c < C; ++c) to[c * plane_] = scaled(row[column + c]);
                ++to;
            }
        }
    }
    [[nodiscard]] float scaled(T sample) const noexcept {
        constexpr double most = 0x1p57;
        const double value = PixelTraits<T>::to_real(sample) * window_.unit();
        return static_cast<float>(value > -most ? (value < most ? value : most) : -most);
    }

    // The means of the samples' differences to those at `centre` and the block - 1 pixels to its right. Differences,
    // because they are exact for integers, keep a constant image what it is, and lose nothing to a large mean.
    HMESH_NEVER_INLINE void average(const float* centre, float (&means)[C][block]) const {
        Floats sums[C][block_vectors] = {}, weights[block_vectors] = {};
        for (const Tap tap : taps_)
            for (int k = 0; k < block_vectors; ++k) {
                const float* here = centre + k * float_lanes;
                Floats differences[C], distance = {};
                for (int c = 0; c < C; ++c) {
                    differences[c] = load_floats(here + tap.offset + c * plane_) - load_floats(here + c * plane_);
                    distance += magnitude(differences[c]);
                }
                const Floats weight = power_of_2(tap.exponent - window_.factor() * (distance * distance));
                weights[k] += weight;
                for (int c = 0; c < C; ++c) sums[c][k] += weight * differences[c];
            }
        for (int c = 0; c < C; ++c)
            for (int k = 0; k < block_vectors; ++k) {
                const Floats mean = sums[c][k] / weights[k];
                std::memcpy(means[c] + k * float_lanes, &mean, sizeof mean);
            }
    }

    const BilateralWindow& window_;
    int radius_;
    std::ptrdiff_t stride_, plane_;  // floats from row to row and from channel to channel
    std::vector<float> samples_;
    std::vector<int> columns_;  // of the view's rows, for each column of the planes
    std::vector<Tap> taps_;
};

}  // namespace detail

// The view filtered, of the same size; samples are rounded by PixelTraits<T>::from_real. Colours are as far apart as the sum
// over channels of their absolute differences, in stored values; beyond the border the image is mirrored without
// repeating the pixels there. check() accepts the view and the options, and float samples are finite. Rows are independent work.
template <class T, int C, class ParallelFor = SerialFor>
[[nodiscard]] Image<T, C> bilateral_filter(const ImageView<T, C>& view, const BilateralOptions& options = {},
                                           const ParallelFor& parallel_for = {}) {
    HMESH_ASSERT(check(view) && check(options));
    using Tile = detail::BilateralTile<T, C>;
    const detail::BilateralWindow window(options, PixelTraits<T>::peak);
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

}  // namespace hmesh

#endif  // HMESH_IMAGE_BILATERAL_HPP
