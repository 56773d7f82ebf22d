/// \file
/// ImageReader: an image that is not in memory, as a function that fills rectangles.
///
///     const auto read = [&](const hmesh::kit::Rect& rect, std::uint8_t* samples, std::ptrdiff_t row_stride) {
///         return file.read(rect.x, rect.y, rect.width, rect.height, samples, row_stride);
///     };
///     hmesh::ImageReader<std::uint8_t, 3> reader{file.width(), file.height(), read};
///
/// mesh_image() of hmesh/large.hpp takes it in place of an ImageView. The library opens no files: what is read, and from where,
/// is the function's business. A view of memory, that of a mapped file too, is read by ViewReader.
#ifndef HMESH_IMAGE_IMAGE_READER_HPP
#define HMESH_IMAGE_IMAGE_READER_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/image/image_view.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// Fills a rectangle of an image with interleaved samples, row after row: that of pixel (rect.x + i, rect.y + j) and channel c
/// goes to samples[i * C + c] of row j, and rows begin row_stride bytes apart. Returns whether it could. The rectangle is within
/// the image, and may be as wide as it is.
template <class T>
using ReadRect = FunctionRef<bool(const kit::Rect& rect, T* samples, std::ptrdiff_t row_stride)>;

/// An image of C interleaved channels of type T whose pixels are read where they are needed. check() says whether it is valid.
///
/// The same rectangle must give the same samples each time: each is read several times, as hmesh/large.hpp says. After read()
/// has returned false it is called no more.
template <class T, int C>
struct ImageReader {
    static_assert(C >= 1 && C <= kit::max_channels, "an image has 1 to 16 channels");
    int width = 0,       ///< px, 1 to kit::max_side
        height = 0;      ///< px, 1 to kit::max_side
    ReadRect<T> read{};  ///< its callable must outlive the reader
    /// Whether read() may be called by several threads at once, where the executor has several. By default it is not: others
    /// wait, busily, until it returns. A function that takes its time does better to lock a mutex and to say true.
    bool is_concurrent = false;
};

/// Whether a reader is valid: it has a function, and 1 to kit::max_side px a side. Otherwise invalid_argument or
/// image_too_large. Unlike a view it may have more than kit::max_pixels. Reads nothing.
template <class T, int C>
[[nodiscard]] Status check(const ImageReader<T, C>& reader) noexcept {
    if (reader.width < 1) return {Errc::invalid_argument, "the image's width must be at least 1", reader.width, 1};
    if (reader.height < 1) return {Errc::invalid_argument, "the image's height must be at least 1", reader.height, 1};
    if (reader.width > kit::max_side) return {Errc::image_too_large, "the image is too wide", reader.width, kit::max_side};
    if (reader.height > kit::max_side) return {Errc::image_too_large, "the image is too high", reader.height, kit::max_side};
    if (!reader.read) return {Errc::invalid_argument, "the image's reader has no function"};
    return {};
}

/// Reads a view, whose pixels must outlive it; the view may have any number of pixels. By several threads at once.
template <class T, int C>
class ViewReader {
  public:
    /// Of a view whose pointer, sides and stride are valid.
    explicit ViewReader(const ImageView<T, C>& view) noexcept : view_(view) {}
    /// Copies a rectangle, as ReadRect says.
    bool operator()(const kit::Rect& rect, T* samples, std::ptrdiff_t row_stride) const {
        for (int y = 0; y < rect.height; ++y)
            std::copy_n(view_.pixel(rect.x, rect.y + y), std::ptrdiff_t{C} * rect.width,
                        reinterpret_cast<T*>(reinterpret_cast<unsigned char*>(samples) + y * row_stride));
        return true;
    }
    /// The reader of the view; valid as long as this is.
    [[nodiscard]] ImageReader<T, C> reader() const noexcept { return {view_.width, view_.height, ReadRect<T>(*this), true}; }

  private:
    ImageView<T, C> view_;
};

namespace kit {

/// The status of a rectangle that could not be read.
[[nodiscard]] inline Status unread(const Rect& rect) noexcept {
    return {Errc::read_failed, "the image could not be read", pack_span(rect.x, rect.width), pack_span(rect.y, rect.height)};
}

}  // namespace kit
}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IMAGE_IMAGE_READER_HPP
