/// \file
/// An ImageSource of an image that is not in memory: ReadImage, which reads it, and read_source(), which looks at it.
///
/// Pixels are read rectangle by rectangle into memory of their own, which is let go once it was looked at; from there on the work
/// is that of any image, by the same instructions, so that the same pixels give the same bits. Rectangles are those of patches,
/// bands of rows for what goes over all pixels, and squares of about 256 px for vertices that want the pixel under them.
#ifndef HMESH_FIT_READ_SOURCE_HPP
#define HMESH_FIT_READ_SOURCE_HPP

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "hmesh/core/array.hpp"
#include "hmesh/core/coded_order.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/fit/image_source.hpp"
#include "hmesh/fit/moment_table.hpp"
#include "hmesh/fit/raster.hpp"
#include "hmesh/fit/rendered_error.hpp"
#include "hmesh/image/channel_weights.hpp"
#include "hmesh/image/image_reader.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/image/premultiply.hpp"
#include "hmesh/mesh/geometry.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/mesh/periodic.hpp"
#include "hmesh/mesh/samples.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// The pixels of a reader, rectangle by rectangle, from any thread. Once a rectangle could not be read, or has a sample that is
/// not finite, all are black, and the reader is asked no more.
template <class T, int C>
class ReadImage {
  public:
    using Sample = T;  ///< type of the samples

    /// The pixels of a reader that check() accepts and that must outlive this. `premultiplied`: their colours are multiplied by
    /// alpha, which they have (image/premultiply.hpp).
    explicit ReadImage(const ImageReader<T, C>& reader, bool premultiplied = false) noexcept
        : reader_(&reader), premultiplied_(premultiplied) {}

    [[nodiscard]] int width() const noexcept { return reader_->width; }    ///< px
    [[nodiscard]] int height() const noexcept { return reader_->height; }  ///< px
    /// Whether a rectangle could not be read.
    [[nodiscard]] bool has_failed() const noexcept { return has_failed_.load(std::memory_order_relaxed); }
    /// Which one, and the first of several; ok: all could. Not while others read.
    [[nodiscard]] Status status() const noexcept { return status_; }

    /// The pixels of a rectangle, which may be anywhere where the image repeats: along both axes.
    [[nodiscard]] HMESH_COLD Image<T, C> fetch(const Rect& rect) const {
        Status status;
        Image<T, C> out = fetch(rect, status);
        if (!status) fail(status);
        return out;
    }
    /// The same; where a sample is not finite that is said by `status` alone, and the image has not failed.
    [[nodiscard]] HMESH_COLD Image<T, C> fetch(const Rect& rect, Status& status) const {
        Image<T, C> out(rect.width, rect.height);
        const std::ptrdiff_t stride = std::ptrdiff_t{rect.width} * C * static_cast<std::ptrdiff_t>(sizeof(T));
        for (int y = 0, rows = 0; y < rect.height; y += rows) {
            const int from_y = modulo(rect.y + y, height());
            rows = std::min(rect.height - y, height() - from_y);
            for (int x = 0, columns = 0; x < rect.width; x += columns) {
                const int from_x = modulo(rect.x + x, width());
                columns = std::min(rect.width - x, width() - from_x);
                read({from_x, from_y, columns, rows}, out.pixel(x, y), stride);
            }
        }
        if (has_failed()) return Image<T, C>(rect.width, rect.height);
        status = check_finite(out.view());
        if (status) return shown(std::move(out));
        status.value = modulo(rect.y + static_cast<int>(status.value), height());
        return Image<T, C>(rect.width, rect.height);
    }

  private:
    /// Holds the one place of those who do something.
    class Turn {
      public:
        explicit Turn(std::atomic_flag& busy) noexcept : busy_(busy) {
            while (busy_.test_and_set(std::memory_order_acquire)) {
            }
        }
        Turn(const Turn&) = delete;
        Turn& operator=(const Turn&) = delete;
        ~Turn() { busy_.clear(std::memory_order_release); }

      private:
        std::atomic_flag& busy_;
    };

    void read(const Rect& rect, T* to, std::ptrdiff_t stride) const {
        const auto fill = [&] {
            if (!has_failed() && !reader_->read(rect, to, stride)) fail(unread(rect));
        };
        if (reader_->is_concurrent) return fill();
        const Turn turn(reading_);
        fill();
    }
    void fail(const Status& status) const noexcept {
        const Turn turn(failing_);
        if (status_) status_ = status;
        has_failed_.store(true);
    }
    /// The pixels as they are meshed.
    [[nodiscard]] Image<T, C> shown(Image<T, C> pixels) const {
        if constexpr (has_alpha(C))
            if (premultiplied_) return premultiply(pixels.view());
        return pixels;
    }

    const ImageReader<T, C>* reader_;
    bool premultiplied_;
    mutable std::atomic_flag reading_ = ATOMIC_FLAG_INIT, failing_ = ATOMIC_FLAG_INIT;
    mutable std::atomic<bool> has_failed_{false};
    mutable Status status_;
};

namespace detail {

/// SourceCalls for a ReadImage with samples of any type, by the windows of its source.
template <int C>
struct ReadCalls {
    /// Faces that follow each other are near each other, and share a rectangle where it does not become large.
    [[nodiscard]] HMESH_COLD static RenderedError error(const ImageSource<C>& source, const Mesh& mesh,
                                                        const ParallelFor& parallel_for, const ChannelScale<C>& channels) {
        const int width = source.width(), height = source.height();
        const auto bounds = [&](std::size_t f, double(&box)[4]) {
            for (const std::uint32_t v : mesh.faces[f]) {
                const Point p = position(mesh, v);
                box[0] = std::min(box[0], std::floor(p.x)), box[1] = std::min(box[1], std::floor(p.y));
                box[2] = std::max(box[2], std::ceil(p.x)), box[3] = std::max(box[3], std::ceil(p.y));
            }
        };
        const auto rect_of = [&](const double(&box)[4]) {
            const int x = static_cast<int>(std::max(0.0, box[0])), y = static_cast<int>(std::max(0.0, box[1]));
            return Rect{x, y, static_cast<int>(std::min<double>(width, box[2])) - x,
                        static_cast<int>(std::min<double>(height, box[3])) - y};
        };
        return sum_rendered_errors(mesh, parallel_for, [&](std::size_t first, std::size_t last, RenderedError& sum) {
            constexpr double largest = 1 << 18;  // px
            for (std::size_t f = first, next = f; f < last; f = next) {
                double box[4] = {1e9, 1e9, -1e9, -1e9};
                bounds(f, box);
                for (next = f + 1; next < last; ++next) {
                    double more[4] = {box[0], box[1], box[2], box[3]};
                    bounds(next, more);
                    if ((more[2] - more[0]) * (more[3] - more[1]) > largest) break;
                    std::copy(more, more + 4, box);
                }
                const Rect rect = rect_of(box);
                if (rect.width <= 0 || rect.height <= 0) continue;  // faces of a periodic mesh that stand out of the image
                source.with_window(rect, [&](const SourceWindow<C>& pixels) {
                    add_rendered_errors(mesh, f, next, source, pixels, channels, sum);
                });
            }
        });
    }

    /// Square after square, each once.
    HMESH_COLD static void visit(const ImageSource<C>& source, std::size_t count, FunctionRef<Point(std::size_t k)> at,
                                 FunctionRef<void(const SourceWindow<C>&, std::size_t k)> look) {
        constexpr double side = 256;  // px of a square
        const auto place = [&](std::size_t k) {
            const Point p = at(k);
            return Point{std::floor(std::min(p.x, source.width() - 1.0)), std::floor(std::min(p.y, source.height() - 1.0))};
        };
        // Row by row, so that who reads the image may keep what lies beside a square; a curve through them would turn back.
        const Array<Coded> items = sorted_numbers(count, [&](std::uint32_t k) {
            const Point p = place(k);
            return code_of(static_cast<std::uint32_t>(p.y / side), static_cast<std::uint32_t>(p.x / side));
        });
        for (std::size_t k = 0, next = 0; k < count; k = next) {
            Point low = place(items[k].number), high = low;
            for (next = k; next < count && items[next].code == items[k].code; ++next) {
                const Point p = place(items[next].number);
                low = {std::min(low.x, p.x), std::min(low.y, p.y)};
                high = {std::max(high.x, p.x), std::max(high.y, p.y)};
            }
            int left = static_cast<int>(low.x) - 2, top = static_cast<int>(low.y) - 2;
            int right = static_cast<int>(high.x) + 3, bottom = static_cast<int>(high.y) + 3;
            if (!wraps_x(source.periodic())) left = std::max(0, left), right = std::min(source.width(), right);
            if (!wraps_y(source.periodic())) top = std::max(0, top), bottom = std::min(source.height(), bottom);
            source.with_window({left, top, right - left, bottom - top}, [&](const SourceWindow<C>& pixels) {
                for (std::size_t i = k; i < next; ++i) look(pixels, items[i].number);
            });
        }
    }
};

/// Brings samples into the range that the scale was made for. Beyond it are some of an image that has changed since, or is black
/// since, for it could not be read.
template <class T, int C>
HMESH_COLD void limit_samples(Image<T, C>& image, const ChannelScale<C>& scale) {
    for (std::size_t k = 0; k < image.size(); ++k) {
        const double value = PixelTraits<T>::to_real(image.data()[k]), limited = scale.limited(value);
        if (value != limited) image.data()[k] = PixelTraits<T>::from_real(limited);
    }
}

/// ImageSource::with_window() of a ReadImage<T, C>.
template <class T, int C>
HMESH_COLD void read_window(const ImageSource<C>& source, const Rect& rect, FunctionRef<void(const SourceWindow<C>&)> look) {
    Image<T, C> pixels = static_cast<const ReadImage<T, C>*>(source.calls().image)->fetch(rect);
    const auto* const scale = source.scale();
    if (!PixelTraits<T>::is_integer && scale != nullptr) limit_samples(pixels, *scale);
    const ImageSource<C> own(pixels.view());
    look({scale != nullptr ? own.with_scale(*scale) : own, rect.x, rect.y});
}

}  // namespace detail

/// The source of an image that is read, with weights as ImageSource has them; all must outlive it. `points`: see SourceCalls.
template <class T, int C>
[[nodiscard]] ImageSource<C> read_source(const ReadImage<T, C>& image, const ImageView<float, 1>& weights = {}, double unit = 1,
                                         decltype(SourceCalls<C>::points) points = nullptr) {
    using Calls = detail::ReadCalls<C>;
    const ImageView<T, C> none{nullptr, image.width(), image.height(), 0};
    return ImageSource<C>(none, weights, unit)
        .with_calls({&image, &Calls::error, &detail::read_window<T, C>, &Calls::visit, points});
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_FIT_READ_SOURCE_HPP
