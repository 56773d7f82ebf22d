/// \file
/// Images: ImageView over the user's pixels, Image that owns pixels, PixelTraits for what a sample means.
///
/// The plane: pixel (i, j) is the unit square [i, i+1] x [j, j+1], its centre is (i + 1/2, j + 1/2), and y runs down.
#ifndef HMESH_IMAGE_IMAGE_VIEW_HPP
#define HMESH_IMAGE_IMAGE_VIEW_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <vector>

#include "hmesh/core/array.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/finite.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/lanes.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/core/srgb.hpp"
#include "hmesh/core/status.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

namespace kit {

/// The largest number of channels of an image.
inline constexpr int max_channels = 16;
/// Whether alpha, of which `peak` is full, is above a threshold in 255ths of full alpha: by a millionth, since floats that are to
/// be at the threshold are rounded by up to 6e-8 of it.
[[nodiscard]] constexpr bool is_alpha_above(double alpha, double threshold, double peak) noexcept {
    return 255 * alpha > (1 + 1e-6) * threshold * peak;
}
/// Whether colours of so many channels can be multiplied by alpha; else invalid_argument.
[[nodiscard]] HMESH_COLD inline Status check_premultiplied(int channels) noexcept {
    if (has_alpha(channels)) return {};
    return {Errc::invalid_argument, "an image is premultiplied by alpha, which those of 2 or 4 channels have", channels, 4};
}
/// The longest side of an image, in px: positions on the 1/256 px grid are then exact in float (16 + 8 bits).
inline constexpr int max_side = 65536;
/// The largest number of pixels of an image: the handles of a mesh with one vertex a pixel then fit 32 bits.
inline constexpr std::int64_t max_pixels = std::int64_t{1} << 28;

/// A rectangle of pixels [x, x + width) x [y, y + height).
struct Rect {
    int x = 0,       ///< column of the leftmost pixels
        y = 0,       ///< row of the topmost pixels
        width = 0,   ///< px
        height = 0;  ///< px
};

}  // namespace kit

/// What a sample of type T means. Specialised for std::uint8_t, std::uint16_t and float; specialise it for a sample type of
/// your own with the same static members (examples/custom_pixel.cpp):
///
/// - `peak`: the value of full intensity, for PSNR = 10 log10(peak^2 / MSE), and "white" for exporters;
/// - `lowest`, `highest`: the range of vertex colours, which end where floats do;
/// - `is_integer`: whether to_real() yields integers from `lowest` to `highest`, both of magnitude at most 65535: all moments
///   are then exact;
/// - `to_real(T)`: the sample as a double;
/// - `from_real(double)`: the nearest sample, clamped to the range.
template <class T>
struct PixelTraits;

namespace detail {

template <class T>
struct UnsignedTraits {
    static constexpr double peak = std::numeric_limits<T>::max();
    static constexpr double lowest = 0;
    static constexpr double highest = peak;
    static constexpr bool is_integer = true;
    static double to_real(T value) noexcept { return static_cast<double>(value); }
    static T from_real(double value) noexcept {
        return static_cast<T>(value > lowest ? (value < highest ? value + 0.5 : highest) : lowest);
    }
};

}  // namespace detail

/// Samples of 8 bits: integers from 0 to the peak, 255.
template <>
struct PixelTraits<std::uint8_t> : detail::UnsignedTraits<std::uint8_t> {};
/// Samples of 16 bits: integers from 0 to the peak, 65535.
template <>
struct PixelTraits<std::uint16_t> : detail::UnsignedTraits<std::uint16_t> {};
/// Samples of type float: any finite value, with the peak 1.
template <>
struct PixelTraits<float> {
    static constexpr double peak = 1;                                                          ///< value of full intensity
    static constexpr double highest = static_cast<double>(std::numeric_limits<float>::max());  ///< largest finite float
    static constexpr double lowest = -highest;                                                 ///< smallest finite float
    static constexpr bool is_integer = false;                                                  ///< moments are rounded
    static double to_real(float value) noexcept { return static_cast<double>(value); }         ///< the value itself
    /// The nearest float, clamped to the finite ones; NaN becomes the lowest.
    static float from_real(double value) noexcept {
        return static_cast<float>(value > lowest ? (value < highest ? value : highest) : lowest);
    }
};

/// A non-owning view of an image: pixels of C interleaved samples of type T, row after row. check() says whether it is valid.
template <class T, int C>
struct ImageView {
    static_assert(C >= 1 && C <= kit::max_channels, "an image has 1 to 16 channels");
    const T* data = nullptr;  ///< first sample of row 0; must outlive the view
    int width = 0,            ///< px, 1 to kit::max_side
        height = 0;           ///< px, 1 to kit::max_side
    /// Bytes from one row to the next, a multiple of alignof(T). 0: rows are packed, width * C * sizeof(T) bytes apart.
    /// Negative: rows are stored bottom up, and `data` is the last row in memory.
    std::ptrdiff_t row_stride = 0;

    /// The first sample of row y, 0 <= y < height.
    [[nodiscard]] const T* row(int y) const noexcept {
        const std::ptrdiff_t packed = static_cast<std::ptrdiff_t>(width) * C * static_cast<std::ptrdiff_t>(sizeof(T));
        const auto* bytes = reinterpret_cast<const unsigned char*>(data) + (row_stride != 0 ? row_stride : packed) * y;
        return reinterpret_cast<const T*>(bytes);
    }
    /// The first sample of pixel (x, y).
    [[nodiscard]] const T* pixel(int x, int y) const noexcept { return row(y) + static_cast<std::ptrdiff_t>(x) * C; }
    /// The rectangle of all pixels.
    [[nodiscard]] kit::Rect bounds() const noexcept { return {0, 0, width, height}; }
};

/// An image that owns its pixels: packed rows of C interleaved samples of type T. Default-constructed it is empty.
template <class T, int C>
class Image {
    static_assert(!std::is_same_v<std::remove_cv_t<T>, bool>, "an image owns no samples of type bool: take a struct of one");

  public:
    /// The empty image.
    Image() = default;
    /// An image of width x height pixels, both >= 0, with all samples T().
    Image(int width, int height)
        : samples_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * C), width_(width), height_(height) {}
    /// The same without values: where several threads write the samples the system hands out their memory by several, too.
    Image(int width, int height, kit::Raw) : width_(width), height_(height) {
        const std::size_t size = static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * C;
        if constexpr (std::is_trivially_copyable_v<T>) samples_.resize_raw(size);
        else samples_.resize(size);
    }

    [[nodiscard]] int width() const noexcept { return width_; }    ///< px
    [[nodiscard]] int height() const noexcept { return height_; }  ///< px
    /// The first sample of pixel (x, y), for writing.
    [[nodiscard]] T* pixel(int x, int y) noexcept { return samples_.data() + offset(x, y); }
    /// The first sample of pixel (x, y).
    [[nodiscard]] const T* pixel(int x, int y) const noexcept { return samples_.data() + offset(x, y); }
    /// A view of all pixels; valid until the image is assigned to or destroyed.
    [[nodiscard]] ImageView<T, C> view() const noexcept { return {samples_.data(), width_, height_, 0}; }
    /// All samples, pixel after pixel, row after row, for writing; valid until the image is assigned to or destroyed.
    [[nodiscard]] T* data() noexcept { return samples_.data(); }
    /// All samples, pixel after pixel, row after row; valid until the image is assigned to or destroyed.
    [[nodiscard]] const T* data() const noexcept { return samples_.data(); }
    /// The number of samples: width * height * C.
    [[nodiscard]] std::size_t size() const noexcept { return samples_.size(); }

  private:
    [[nodiscard]] std::size_t offset(int x, int y) const noexcept {
        return (static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)) * C;
    }
    std::conditional_t<std::is_trivially_copyable_v<T>, kit::Array<T>, std::vector<T>> samples_;
    int width_ = 0, height_ = 0;
};

/// Whether a view is valid: it has a pointer, sizes and a stride that fit together, and at most kit::max_side px a side and
/// kit::max_pixels in all. Otherwise invalid_argument or image_too_large. Reads no pixel.
template <class T, int C>
[[nodiscard]] Status check(const ImageView<T, C>& view) noexcept {
    if (view.width < 1) return {Errc::invalid_argument, "the image's width must be at least 1", view.width, 1};
    if (view.height < 1) return {Errc::invalid_argument, "the image's height must be at least 1", view.height, 1};
    if (view.width > kit::max_side) return {Errc::image_too_large, "the image is too wide", view.width, kit::max_side};
    if (view.height > kit::max_side) return {Errc::image_too_large, "the image is too high", view.height, kit::max_side};
    const std::int64_t pixels = std::int64_t{view.width} * view.height;
    if (pixels > kit::max_pixels) return {Errc::image_too_large, "the image has too many pixels", pixels, kit::max_pixels};
    if (view.data == nullptr) return {Errc::invalid_argument, "the image's data pointer is null"};
    // Where a row begins is a pointer difference, which has 32 bits on some machines; no processor addresses more than 2^57.
    constexpr std::int64_t farthest =
        sizeof(std::ptrdiff_t) < 8 ? std::int64_t{std::numeric_limits<std::ptrdiff_t>::max()} : std::int64_t{1} << 57U;
    const std::int64_t longest = farthest / view.height;
    if (view.row_stride < -longest || view.row_stride > longest)
        return {Errc::invalid_argument, "the row stride is absurdly long, in bytes", view.row_stride, longest};
    const std::int64_t packed = std::int64_t{view.width} * C * static_cast<std::int64_t>(sizeof(T));
    const std::int64_t stride = view.row_stride < 0 ? -std::int64_t{view.row_stride} : std::int64_t{view.row_stride};
    if (packed > longest) return {Errc::image_too_large, "the image has too many bytes", packed * view.height, farthest};
    if (stride != 0 && stride < packed)
        return {Errc::invalid_argument, "the row stride is smaller than a row of pixels, in bytes", stride, packed};
    if (stride % static_cast<std::int64_t>(alignof(T)) != 0)
        return {Errc::invalid_argument, "the row stride is no multiple of the sample's alignment, in bytes", stride,
                static_cast<std::int64_t>(alignof(T))};
    if (reinterpret_cast<std::uintptr_t>(view.data) % alignof(T) != 0)
        return {Errc::invalid_argument, "the image's data pointer is not aligned as its samples are, in bytes",
                static_cast<std::int64_t>(reinterpret_cast<std::uintptr_t>(view.data) % alignof(T)), 0};
    return {};
}

namespace kit {

/// Reads pixels of any sample type as real numbers, so that what works on them is compiled once: writes the samples of the
/// `count` pixels from (x, y) to the right, pixel after pixel, to to[0] .. to[count * C - 1].
using PixelReader = FunctionRef<void(int x, int y, int count, double* to)>;
/// The same of samples that are integers of magnitude 32767 at most.
using IntegerReader = FunctionRef<void(int x, int y, int count, std::int16_t* to)>;

/// Reads pixels of a view as a PixelReader or an IntegerReader does, all of which must lie in it. The row four below, which a
/// tile's reading comes to by the time that it has arrived, is asked for: rows of a large image lie in pages of their own.
template <class T, int C, class Number>
void read_pixels(const ImageView<T, C>& view, int x, int y, int count, Number* to) noexcept {
    const T* const from = view.pixel(x, y);
    const T* const later = view.pixel(x, std::min(y + 4, view.height - 1));
    constexpr int in_line = sizeof(T) < 64 ? static_cast<int>(64 / sizeof(T)) : 1;  // samples may be larger than a cache line
    for (int i = 0; i < count * C; i += in_line) HMESH_PREFETCH(later + i);
    int i = 0;
    if constexpr (std::is_same_v<T, std::uint8_t> && std::is_same_v<Number, std::int16_t>)
        for (; count * C - i >= 16; i += 16) widen(from + i, to + i);
    for (; i < count * C; ++i) to[i] = static_cast<Number>(PixelTraits<T>::to_real(from[i]));
}

/// Whether all samples are finite as floats, which is what meshes hold; otherwise not_finite. Costs nothing for integer
/// samples.
template <class T, int C>
[[nodiscard]] Status check_finite(const ImageView<T, C>& view, const ParallelFor& parallel_for = {}) {
    using Traits = PixelTraits<T>;
    static_assert(!Traits::is_integer || (Traits::lowest >= -65535 && Traits::highest <= 65535),
                  "is_integer: of 16 bits at most");
    if constexpr (!Traits::is_integer) {
        constexpr auto most = static_cast<double>(std::numeric_limits<float>::max());
        const auto is_good = [](const T& sample) {
            if constexpr (std::is_same_v<T, float>) return is_finite(sample);
            else return is_within(Traits::to_real(sample), -most, most);
        };
        Array<unsigned char> bad(static_cast<std::size_t>(view.height), 0);
        for_each_chunk(parallel_for, bad.size(), 32, [&](std::size_t begin, std::size_t end) {
            for (std::size_t y = begin; y < end; ++y) {
                const T* row = view.row(static_cast<int>(y));
                for (int k = 0; k < view.width * C; ++k)
                    if (!is_good(row[k])) bad[y] = 1;
            }
        });
        for (std::size_t y = 0; y < bad.size(); ++y)
            if (bad[y] != 0)
                return {Errc::not_finite, "the image has a sample that is NaN, infinite or beyond all floats, in row",
                        static_cast<std::int64_t>(y), 0};
    }
    return {};
}

}  // namespace kit
}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IMAGE_IMAGE_VIEW_HPP
