// hmesh - MomentTable: row prefix sums of a rectangle of an image, from which edges collect their moments.
//
// Entry (x, y), 0 <= x <= width, 0 <= y < height, holds the sums over the pixels (i, y), 0 <= i < x, of
//
//     I_0 .. I_{C-1}, 1     and     i I_0 .. i I_{C-1}, |I|^2          (|I|^2: summed over channels)
//
// in coordinates local to the rectangle. By Green's theorem (Leu, "Computing a shape's moments from its boundary", 1991)
// the moments of any polygon are signed sums of such entries along its edges, see fit/moments.hpp.
//
// Sums of 8-bit samples are 32-bit integers as long as they fit (rectangles up to about 4,000 px wide); all others are
// doubles, exact for 16-bit samples too. Cost: 2 * lanes_for(C + 1) numbers a pixel, that is 32 bytes for 8-bit RGB, and
// about 5 ns a pixel to build. Entries of one column strip of 2 pixels are contiguous down the rows, because walks run
// down edges: this keeps them in few cache lines and pages.
#ifndef HMESH_IMAGE_MOMENT_TABLE_HPP
#define HMESH_IMAGE_MOMENT_TABLE_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "hmesh/core/assert.hpp"
#include "hmesh/core/lanes.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/image/image_view.hpp"

namespace hmesh {

template <int C>
class MomentTable {
  public:
    static constexpr int lanes = lanes_for(C + 1);  // of one half of an entry
    static constexpr int entry_size = 2 * lanes;

    MomentTable() = default;

    // The table of `rect`, which must lie in a view that check() accepts. Rows are independent pieces of work.
    template <class T, class ParallelFor = SerialFor>
    explicit MomentTable(const ImageView<T, C>& view, const Rect& rect, const ParallelFor& parallel_for = {})
        : width_(rect.width), height_(rect.height), narrow_(fits_32_bits<T>(rect.width)) {
        HMESH_ASSERT(rect.x >= 0 && rect.y >= 0 && rect.width >= 1 && rect.height >= 1);
        HMESH_ASSERT(rect.width <= view.width - rect.x && rect.height <= view.height - rect.y);
        strip_size_ = static_cast<std::size_t>(height_) * strip_width * entry_size;
        const std::size_t size = (static_cast<std::size_t>(width_) / strip_width + 1) * strip_size_;
        // Not initialised: fill writes all that is ever read.
        size_ = size;
        if (narrow_) {
            narrow_entries_.reset(new std::int32_t[size]);
            fill(view, rect, parallel_for, narrow_entries_.get());
        } else {
            wide_entries_.reset(new double[size]);
            fill(view, rect, parallel_for, wide_entries_.get());
        }
    }

    [[nodiscard]] int width() const noexcept { return width_; }
    [[nodiscard]] int height() const noexcept { return height_; }
    [[nodiscard]] bool is_narrow() const noexcept { return narrow_; }  // 32-bit integers or doubles?
    [[nodiscard]] std::size_t bytes() const noexcept {
        return size_ * (narrow_ ? sizeof(std::int32_t) : sizeof(double));
    }

    // The samples of pixel (x, y), 0 <= x < width, 0 <= y < height, and 0 in the lanes above them.
    void pixel(int x, int y, Lanes<lanes>& out) const noexcept {
        const auto sample = [&](const auto* entries) {
            for (int c = 0; c < lanes; ++c)
                out.set(c, c < C ? static_cast<double>(entries[offset(x + 1, y) + static_cast<std::size_t>(c)] -
                                                       entries[offset(x, y) + static_cast<std::size_t>(c)])
                                 : 0.0);
        };
        if (narrow_) sample(narrow_entries_.get());
        else sample(wide_entries_.get());
    }

    // Where entries of type N (std::int32_t if is_narrow(), else double) begin, and the offset of one in numbers.
    template <class N>
    [[nodiscard]] HMESH_ALWAYS_INLINE const N* entries() const noexcept {
        if constexpr (sizeof(N) == sizeof(std::int32_t)) return narrow_entries_.get();
        else return wide_entries_.get();
    }
    [[nodiscard]] HMESH_ALWAYS_INLINE std::size_t offset(int x, int y) const noexcept {
        return static_cast<std::size_t>(x / strip_width) * strip_size_ +
               static_cast<std::size_t>(y * strip_width + x % strip_width) * entry_size;
    }

  private:
    static constexpr int strip_width = 2;

    template <class T>
    [[nodiscard]] static bool fits_32_bits(int width) noexcept {
        if constexpr (!PixelTraits<T>::is_integer) return false;
        const double w = width, highest = PixelTraits<T>::highest;
        const double largest = 2147483647.0;
        return highest * w * (w - 1) / 2 <= largest && C * highest * highest * w <= largest;
    }

    template <class T, class ParallelFor, class N>
    void fill(const ImageView<T, C>& view, const Rect& rect, const ParallelFor& parallel_for, N* entries) const {
        for_each_chunk(parallel_for, static_cast<std::size_t>(height_), 16, [&](std::size_t begin, std::size_t end) {
            for (std::size_t y = begin; y < end; ++y) fill_row(view, rect, static_cast<int>(y), entries);
        });
    }

    template <class T, class N>
    void fill_row(const ImageView<T, C>& view, const Rect& rect, int y, N* entries) const {
        const T* pixel = view.pixel(rect.x, rect.y + y);
        N sum[entry_size] = {};
        N add[entry_size] = {};
        add[C] = 1;
        for (int x0 = 0; x0 <= width_; x0 += strip_width) {
            N* entry = entries + offset(x0, y);
            const int end = std::min(width_, x0 + strip_width);
            for (int x = x0; x < end; ++x, pixel += C, entry += entry_size) {
                N square = 0;
                for (int c = 0; c < C; ++c) {
                    const N value = static_cast<N>(PixelTraits<T>::to_real(pixel[c]));
                    add[c] = value;
                    add[lanes + c] = static_cast<N>(x) * value;
                    square += value * value;
                }
                add[lanes + C] = square;
                for (int k = 0; k < entry_size; ++k) entry[k] = sum[k];
                for (int k = 0; k < entry_size; ++k) sum[k] += add[k];
            }
            if (end == width_ && end < x0 + strip_width)
                for (int k = 0; k < entry_size; ++k) entry[k] = sum[k];
        }
    }

    int width_ = 0, height_ = 0;
    bool narrow_ = true;
    std::size_t strip_size_ = 0;
    std::size_t size_ = 0;
    std::unique_ptr<std::int32_t[]> narrow_entries_;
    std::unique_ptr<double[]> wide_entries_;
};

}  // namespace hmesh

#endif  // HMESH_IMAGE_MOMENT_TABLE_HPP
