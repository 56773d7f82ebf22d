/// \file
/// ImageSource: an image of any pixel type, from which moment tables are made.
///
/// Methods work patch by patch, and each patch has a table of its own rectangle (fit/moment_table.hpp). Only this class knows
/// the type of the samples and whether pixels have weights, so that everything above it depends on the number of channels
/// alone.
#ifndef HMESH_FIT_IMAGE_SOURCE_HPP
#define HMESH_FIT_IMAGE_SOURCE_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/core/assert.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/lanes.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/fit/moment_table.hpp"
#include "hmesh/fit/rendered_error.hpp"
#include "hmesh/image/channel_weights.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/image/weights.hpp"
#include "hmesh/mesh/geometry.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/mesh/periodic.hpp"
#include "hmesh/mesh/raster.hpp"
#include "hmesh/mesh/samples.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

namespace detail {

/// A rectangle of the plane that a view repeats in, as an image of its own.
template <class T, int N>
[[nodiscard]] HMESH_COLD Image<T, N> unrolled(const ImageView<T, N>& view, const Rect& rect) {
    Image<T, N> out(rect.width, rect.height);
    for (int y = 0; y < rect.height; ++y)
        for (int x = 0, count = 0; x < rect.width; x += count) {
            const int from = modulo(rect.x + x, view.width);
            count = std::min(rect.width - x, view.width - from);
            std::copy_n(view.pixel(from, modulo(rect.y + y, view.height)), static_cast<std::ptrdiff_t>(count) * N,
                        out.pixel(x, y));
        }
    return out;
}

}  // namespace detail

template <int C>
class ImageSource;

/// What a source looks at in place of itself, see ImageSource::with_window().
template <int C>
struct SourceWindow {
    const ImageSource<C>& source;  ///< pixel (i - x, j - y) of which is pixel (i, j)
    int x = 0,                     ///< px
        y = 0;                     ///< px

    /// ImageSource::pixel() of pixel (i, j).
    [[nodiscard]] auto pixel(int i, int j) const noexcept { return source.pixel(i - x, j - y); }
};

/// How a source looks at an image that is not in memory (fit/read_source.hpp).
template <int C>
struct SourceCalls {
    const void* image = nullptr;  ///< what the functions look at; must outlive the source
    /// ImageSource::table(), of squares.
    MomentTable<C> (*table)(const ImageSource<C>&, const Rect&, const ParallelFor&) = nullptr;
    /// ImageSource::rendered_errors().
    RenderedError (*error)(const ImageSource<C>&, const Mesh&, const ParallelFor&, const ChannelScale<C>&) = nullptr;
    /// ImageSource::with_window().
    void (*window)(const ImageSource<C>&, const Rect&, FunctionRef<void(const SourceWindow<C>&)> look) = nullptr;
    /// ImageSource::visit().
    void (*visit)(const ImageSource<C>&, std::size_t count, FunctionRef<Point(std::size_t k)> at,
                  FunctionRef<void(const SourceWindow<C>&, std::size_t k)> look) = nullptr;
    /// The `count` pixels, as y * width + x, where first points stand (methods/annealed/first_points.hpp).
    std::vector<std::uint32_t> (*points)(const ImageSource<C>&, std::size_t count, const ParallelFor&,
                                         FunctionRef<bool()> go_on) = nullptr;
};

/// An image of C channels of any pixel type, with or without weights, from which moment tables are made.
template <int C>
class ImageSource {
  public:
    /// The image of a view that check() accepts, with weights that check_weights() accepts (or none) in the unit of
    /// weight_unit(). Both must outlive the source.
    template <class T>
    explicit ImageSource(const ImageView<T, C>& view, const ImageView<float, 1>& weights = {}, double unit = 1) noexcept
        : data_(view.data), width_(view.width), height_(view.height), row_stride_(view.row_stride), weights_(weights),
          unit_(unit), low_(PixelTraits<T>::lowest), high_(PixelTraits<T>::highest), peak_(PixelTraits<T>::peak),
          is_integer_(PixelTraits<T>::is_integer), make_(&make<T>), sample_(&sample<T>), row_(&read_row<T>), error_(&error<T>) {}

    /// The same weights with other pixels, an image of the same size.
    template <class T>
    [[nodiscard]] ImageSource with_pixels(const ImageView<T, C>& view) const noexcept {
        return ImageSource(view, weights_, unit_).with_periodic(periodic_, has_straight_seams_).with_samples(samples_);
    }
    /// The same image, whose samples are these: of points there are two at least along each axis, and they do not repeat.
    [[nodiscard]] ImageSource with_samples(Samples samples) const noexcept {
        ImageSource out = *this;
        out.samples_ = samples;
        return out;
    }
    /// The same image, which repeats along these axes. `straight`: edges of meshes run along the lines where it does.
    [[nodiscard]] ImageSource with_periodic(Periodic periodic, bool straight) const noexcept {
        ImageSource out = *this;
        out.periodic_ = periodic;
        out.has_straight_seams_ = straight && periodic != Periodic::none;
        return out;
    }
    /// The same weights with the pixels of scale_channels(). The scale must outlive the source.
    [[nodiscard]] ImageSource with_scaled_pixels(const ImageView<std::uint16_t, C>& view,
                                                 const ChannelScale<C>& scale) const noexcept {
        ImageSource out = ImageSource(view, weights_, unit_).with_periodic(periodic_, has_straight_seams_).with_samples(samples_);
        out.scale_ = &scale;
        return out;
    }
    /// The same image, whose pixels are not in memory but where these calls find them; that of the view is not looked at.
    [[nodiscard]] ImageSource with_calls(const SourceCalls<C>& calls) const noexcept {
        ImageSource out = *this;
        out.data_ = calls.image;
        out.make_ = calls.table;
        out.error_ = calls.error;
        out.window_ = calls.window;
        out.visit_ = calls.visit;
        out.points_ = calls.points;
        return out;
    }
    /// Whether pixels are read when they are asked for. pixel() and row() are those of windows then.
    [[nodiscard]] bool is_read() const noexcept { return window_ != nullptr; }
    /// What with_calls() was given, of a source that is_read().
    [[nodiscard]] const void* image() const noexcept { return data_; }

    /// Of a source that is_read(): the `count` pixels where first points stand, found without a number for each pixel in memory.
    /// Meaningless once go_on(), called on any thread, has said false.
    [[nodiscard]] std::vector<std::uint32_t> points(std::size_t count, const ParallelFor& parallel_for,
                                                    FunctionRef<bool()> go_on) const {
        return points_(*this, count, parallel_for, go_on);
    }

    /// Calls look() with a window that has the pixels of a rectangle, which may reach beyond the image along the axes of
    /// periodic(): this source itself or, where it is_read(), a copy of them, which neither repeats nor has weights.
    void with_window(const Rect& rect, FunctionRef<void(const SourceWindow<C>&)> look) const {
        if (is_read()) window_(*this, rect, look);
        else look({*this});
    }
    /// Calls look(window, k) for each k < count, with a window that has the pixels around at(k), a point of the image: those less
    /// than 2 px away. In any order, on this thread.
    void visit(std::size_t count, FunctionRef<Point(std::size_t k)> at,
               FunctionRef<void(const SourceWindow<C>&, std::size_t k)> look) const {
        if (is_read()) return visit_(*this, count, at, look);
        for (std::size_t k = 0; k < count; ++k) look({*this}, k);
    }

    /// How stored values became the samples; null: they are the samples.
    [[nodiscard]] const ChannelScale<C>* scale() const noexcept { return scale_; }

    [[nodiscard]] int width() const noexcept { return width_; }                                     ///< px
    [[nodiscard]] int height() const noexcept { return height_; }                                   ///< px
    [[nodiscard]] double pixels() const noexcept { return static_cast<double>(width_) * height_; }  ///< number of pixels
    [[nodiscard]] double low() const noexcept { return low_; }              ///< smallest colour of the pixel type
    [[nodiscard]] double high() const noexcept { return high_; }            ///< largest colour of the pixel type
    [[nodiscard]] Periodic periodic() const noexcept { return periodic_; }  ///< along which axes the image repeats
    [[nodiscard]] Samples samples() const noexcept { return samples_; }     ///< where the samples stand
    /// Whether the lines where the image repeats are edges of its meshes.
    [[nodiscard]] bool has_straight_seams() const noexcept { return has_straight_seams_; }
    /// Whether samples are whole numbers, so that sums of them are exact.
    [[nodiscard]] bool is_integer() const noexcept { return is_integer_; }
    [[nodiscard]] double peak() const noexcept { return peak_; }  ///< value of full intensity

    /// The moment table of a rectangle of the image, which may reach beyond it along the axes of periodic(). Bands of its rows
    /// are pieces of work.
    [[nodiscard]] MomentTable<C> table(const Rect& rect, const ParallelFor& parallel_for = {}) const {
        MomentTable<C> table = make_(*this, rect, parallel_for);
        if (samples_ == Samples::points) {
            const FarSides sides = far_sides(width_, height_, samples_);
            table.set_far_sides({sides.right - rect.x, sides.bottom - rect.y});
        }
        return table;
    }

    /// The error of a finished mesh as drawn, with the weights of pixels and these of channels: rendered_errors() of
    /// fit/rendered_error.hpp. Where is_integer() and all channels count the same, the energy of the fit is exact and need not be
    /// measured.
    [[nodiscard]] RenderedError rendered_errors(const Mesh& mesh, const ParallelFor& parallel_for,
                                                const ChannelScale<C>& channels = {}) const {
        return error_(*this, mesh, parallel_for, channels);
    }

    /// The samples of pixel (x, y), of the nearest one or, along the axes of periodic(), of the repeated image outside of it; 0
    /// in the lanes above them.
    [[nodiscard]] HMESH_ALWAYS_INLINE Lanes<lanes_for(C + 1)> pixel(int x, int y) const noexcept {
        Lanes<lanes_for(C + 1)> out;
        sample_(*this, place(x, width_, wraps_x(periodic_)), place(y, height_, wraps_y(periodic_)), out);
        return out;
    }

    /// Writes the samples of row y, or of the one that stands for it as in pixel(), times a factor, pixel after pixel: width() *
    /// C numbers.
    void row(int y, double factor, double* to) const noexcept { row_(*this, place(y, height_, wraps_y(periodic_)), factor, to); }

    /// The weights of pixels, in any unit; without data: all count the same.
    [[nodiscard]] const ImageView<float, 1>& weights() const noexcept { return weights_; }
    /// How weights become numbers of pixels.
    [[nodiscard]] WeightScale weight_scale() const noexcept { return WeightScale(unit_, width_, height_); }
    /// Whether pixels have weights.
    [[nodiscard]] bool is_weighted() const noexcept { return weights_.data != nullptr; }
    /// The weight of pixel (x, y), in the unit of the weights; 1 where there are none.
    [[nodiscard]] double weight(int x, int y) const noexcept {
        return weights_.data == nullptr ? 1 : static_cast<double>(*weights_.pixel(x, y)) / unit_;
    }

  private:
    template <class T>
    [[nodiscard]] ImageView<T, C> view() const noexcept {
        return {static_cast<const T*>(data_), width_, height_, row_stride_};
    }
    /// The pixel of a side of `size` px that stands for pixel x of the plane.
    [[nodiscard]] static int place(int x, int size, bool wraps) noexcept {
        return wraps ? modulo(x, size) : std::max(0, std::min(size - 1, x));
    }
    template <class T>
    [[nodiscard]] static MomentTable<C> make(const ImageSource& source, const Rect& rect, const ParallelFor& parallel_for) {
        ImageView<T, C> pixels = source.view<T>();
        ImageView<float, 1> weights = source.weights_;
        Rect from = rect;
        Image<T, C> own_pixels;
        Image<float, 1> own_weights;
        if (rect.x < 0 || rect.y < 0 || rect.width > source.width_ - rect.x || rect.height > source.height_ - rect.y) {
            HMESH_ASSERT(source.periodic_ != Periodic::none);
            own_pixels = detail::unrolled(pixels, rect);
            pixels = own_pixels.view();
            if (weights.data != nullptr) {
                own_weights = detail::unrolled(weights, rect);
                weights = own_weights.view();
            }
            from = pixels.bounds();
        }
        return MomentTable<C>(pixels, weights, source.weight_scale(), from, parallel_for);
    }
    template <class T>
    [[nodiscard]] static RenderedError error(const ImageSource& source, const Mesh& mesh, const ParallelFor& parallel_for,
                                             const ChannelScale<C>& channels) {
        return kit::rendered_errors(mesh, source.view<T>(), source.weights_, source.unit_, parallel_for, channels);
    }
    template <class T>
    static void sample(const ImageSource& source, int x, int y, Lanes<lanes_for(C + 1)>& out) noexcept {
        out = Lanes<lanes_for(C + 1)>::zero();
        const T* pixel = source.view<T>().pixel(x, y);
        for (int c = 0; c < C; ++c) out.set(c, PixelTraits<T>::to_real(pixel[c]));
    }

    template <class T>
    static void read_row(const ImageSource& source, int y, double factor, double* to) noexcept {
        const T* const samples = source.view<T>().row(y);
        const std::ptrdiff_t size = std::ptrdiff_t{source.width_} * C;
        for (std::ptrdiff_t i = 0; i < size; ++i) to[i] = PixelTraits<T>::to_real(samples[i]) * factor;
    }

    const void* data_;
    int width_, height_;
    std::ptrdiff_t row_stride_;
    ImageView<float, 1> weights_;
    double unit_;  ///< of the weights, see weight_unit()
    double low_, high_, peak_;
    bool is_integer_;
    bool has_straight_seams_ = false;
    Periodic periodic_ = Periodic::none;
    Samples samples_ = Samples::squares;
    MomentTable<C> (*make_)(const ImageSource&, const Rect&, const ParallelFor&);
    void (*sample_)(const ImageSource&, int, int, Lanes<lanes_for(C + 1)>&) noexcept;
    void (*row_)(const ImageSource&, int, double, double*) noexcept;
    RenderedError (*error_)(const ImageSource&, const Mesh&, const ParallelFor&, const ChannelScale<C>&);
    const ChannelScale<C>* scale_ = nullptr;
    decltype(SourceCalls<C>::window) window_ = nullptr;  ///< null: the pixels are in memory
    decltype(SourceCalls<C>::visit) visit_ = nullptr;
    decltype(SourceCalls<C>::points) points_ = nullptr;
};

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_FIT_IMAGE_SOURCE_HPP
