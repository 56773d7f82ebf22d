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

#include "hmesh/core/array.hpp"
#include "hmesh/core/assert.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/lanes.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/fit/moment_table.hpp"
#include "hmesh/fit/raster.hpp"
#include "hmesh/image/channel_weights.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/image/weights.hpp"
#include "hmesh/mesh/geometry.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/mesh/periodic.hpp"
#include "hmesh/mesh/samples.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

struct RenderedError;

template <int C>
class ImageSource;

/// What a source looks at in place of itself, see ImageSource::with_window().
template <int C>
struct SourceWindow {
    const ImageSource<C>& source;  ///< pixel (i - x, j - y) of which is pixel (i, j)
    int x = 0,                     ///< px
        y = 0;                     ///< px

    /// ImageSource::pixel() of pixel (i, j).
    [[nodiscard]] HMESH_ALWAYS_INLINE auto pixel(int i, int j) const noexcept { return source.pixel(i - x, j - y); }
    /// ImageSource::read() from pixel (i, j).
    template <class Number>
    void read(int i, int j, int count, Number* to) const noexcept {
        source.read(i - x, j - y, count, to);
    }
};

/// How a source looks at an image that is not in memory (fit/read_source.hpp).
template <int C>
struct SourceCalls {
    const void* image = nullptr;  ///< what the functions look at; must outlive the source
    /// rendered_errors() of the source.
    RenderedError (*error)(const ImageSource<C>&, const Mesh&, const ParallelFor&, const ChannelScale<C>&) = nullptr;
    /// ImageSource::with_window().
    void (*window)(const ImageSource<C>&, const Rect&, FunctionRef<void(const SourceWindow<C>&)> look) = nullptr;
    /// ImageSource::visit().
    void (*visit)(const ImageSource<C>&, std::size_t count, FunctionRef<Point(std::size_t k)> at,
                  FunctionRef<void(const SourceWindow<C>&, std::size_t k)> look) = nullptr;
    /// The `count` pixels, as y * width + x, where first points stand (methods/annealed/points_by_rows.hpp), found without a
    /// number for each pixel in memory. Meaningless once go_on(), called on any thread, has said false.
    Array<std::uint32_t> (*points)(const ImageSource<C>&, std::size_t count, const ParallelFor&,
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
        : ImageSource({view.data, view.width, view.height, view.row_stride, PixelTraits<T>::lowest, PixelTraits<T>::highest,
                       PixelTraits<T>::peak, MomentTable<C>::template largest_sample<T>(), &read_view<T, double>,
                       &read_view<T, std::int16_t>},
                      weights, unit) {}

    /// The same weights with other pixels, an image of the same size.
    template <class T>
    [[nodiscard]] ImageSource with_pixels(const ImageView<T, C>& view) const noexcept {
        ImageSource out(view, weights_, unit_);
        out.periodic_ = periodic_;
        out.has_straight_seams_ = has_straight_seams_;
        out.samples_ = samples_;
        return out;
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
    /// The same image with its channels scaled and rounded to 16 bits. The scale must outlive the source.
    [[nodiscard]] ImageSource with_scale(const ChannelScale<C>& scale) const noexcept {
        ImageSource out = *this;
        out.scale_ = &scale;
        out.low_ = 0;
        out.high_ = out.peak_ = out.largest_ = 65535;
        return out;
    }
    /// The same image, whose pixels are not in memory but where these calls find them; that of the view is not looked at.
    [[nodiscard]] ImageSource with_calls(const SourceCalls<C>& calls) const noexcept {
        ImageSource out = *this;
        out.calls_ = calls;
        return out;
    }
    /// Whether pixels are read when they are asked for. read(), pixel() and row() are those of windows then.
    [[nodiscard]] bool is_read() const noexcept { return calls_.window != nullptr; }
    /// What with_calls() was given, of a source that is_read().
    [[nodiscard]] const SourceCalls<C>& calls() const noexcept { return calls_; }

    /// Calls look() with a window that has the pixels of a rectangle, which may reach beyond the image along the axes of
    /// periodic(): this source itself or, where it is_read(), a copy of them, which neither repeats nor has weights.
    void with_window(const Rect& rect, FunctionRef<void(const SourceWindow<C>&)> look) const {
        if (is_read()) calls_.window(*this, rect, look);
        else look({*this});
    }
    /// Calls look(window, k) for each k < count, with a window that has the pixels around at(k), a point of the image: those less
    /// than 2 px away. In any order; of a source that is_read() on this thread, of others 4096 are a piece of work.
    void visit(std::size_t count, FunctionRef<Point(std::size_t k)> at,
               FunctionRef<void(const SourceWindow<C>&, std::size_t k)> look, const ParallelFor& parallel_for = {}) const {
        if (is_read()) return calls_.visit(*this, count, at, look);
        for_each_chunk(parallel_for, count, 4096, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) look({*this}, k);
        });
    }

    /// How stored values became the samples; null: they are the samples.
    [[nodiscard]] const ChannelScale<C>* scale() const noexcept { return scale_; }

    [[nodiscard]] int width() const noexcept { return width_; }                                     ///< px
    [[nodiscard]] int height() const noexcept { return height_; }                                   ///< px
    [[nodiscard]] double pixels() const noexcept { return static_cast<double>(width_) * height_; }  ///< number of pixels
    [[nodiscard]] double low() const noexcept { return low_; }              ///< smallest colour of the pixel type, in a float
    [[nodiscard]] double high() const noexcept { return high_; }            ///< largest colour of the pixel type, in a float
    [[nodiscard]] Periodic periodic() const noexcept { return periodic_; }  ///< along which axes the image repeats
    [[nodiscard]] Samples samples() const noexcept { return samples_; }     ///< where the samples stand
    /// Whether the lines where the image repeats are edges of its meshes.
    [[nodiscard]] bool has_straight_seams() const noexcept { return has_straight_seams_; }
    /// Whether samples are whole numbers, so that sums of them are exact.
    [[nodiscard]] bool is_integer() const noexcept { return largest_ <= 65535; }
    [[nodiscard]] double peak() const noexcept { return peak_; }  ///< value of full intensity

    /// Of a table by which a mesh is chosen, px: sums of i^2 along a row grow with the cube of its width. At 65536 px they pass
    /// 2^53 in 64 rows, with weights (WeightScale) in 2, and what rounding takes of them is multiplied by squares of slopes.
    /// With weights that costs 0.6 dB of photographs and 30 dB of smooth pictures at 16384 px.
    [[nodiscard]] int widest_table() const noexcept { return is_weighted() ? 4096 : 16384; }
    /// Whether samples are whole numbers that all count the same.
    [[nodiscard]] bool has_plain_samples() const noexcept { return is_integer() && !is_weighted(); }
    /// Whether the energy of a mesh, as tables of this width tell it, is that of the mesh as it is drawn. With weights slivers,
    /// whose slopes reach 1e4 a pixel, may lose more than all faces have: of photographs of 1536 x 1024 px up to 0.5 dB, from
    /// 4096 px a row on 4 dB and more.
    [[nodiscard]] bool has_exact_sums(double table_width) const noexcept {
        return has_plain_samples() && std::min<double>(table_width, width_) <= widest_table();
    }

    /// The moment table of a rectangle of the image, which may reach beyond it along the axes of periodic(). Bands of its rows
    /// are pieces of work.
    [[nodiscard]] HMESH_COLD MomentTable<C> table(const Rect& rect, const ParallelFor& parallel_for = {}) const {
        MomentTable<C> table;
        with_window(rect, [&](const SourceWindow<C>& window) {
            table = MomentTable<C>(rect,
                                   {[&](int x, int y, int count, double* to) { window.read(x, y, count, to); },
                                    [&](int x, int y, int count, std::int16_t* to) { window.read(x, y, count, to); },
                                    [this](int x, int y, int count, double* to) { read_weights(x, y, count, to); }},
                                   kind(), parallel_for);
        });
        if (samples_ == Samples::points) {
            const FarSides sides = far_sides(width_, height_, samples_);
            table.set_far_sides({sides.right - rect.x, sides.bottom - rect.y});
        }
        return table;
    }

    /// Writes the samples of the `count` pixels from (x, y) to the right, pixel after pixel, as a PixelReader does. They may lie
    /// beyond the image along the axes of periodic().
    void read(int x, int y, int count, double* to) const noexcept {
        read_parts(read_, x, y, count, to);
        if (scale_ != nullptr) scale_->to_samples(to, count);
    }
    /// The same of a source without scale(), as an IntegerReader does.
    void read(int x, int y, int count, std::int16_t* to) const noexcept { read_parts(read_integers_, x, y, count, to); }
    /// Writes how often these pixels count, as WeightScale rounds it; only if is_weighted().
    void read_weights(int x, int y, int count, double* to) const noexcept {
        for_each_part(x, y, count, [&](int from, int row, int part) {
            weight_scale_.read(weights_, from, row, part, to);
            to += part;
        });
    }
    /// The samples of pixel (x, y), of the nearest one or, along the axes of periodic(), of the repeated image outside of it; 0
    /// in the lanes above them.
    [[nodiscard]] HMESH_ALWAYS_INLINE Lanes<lanes_for(C + 1)> pixel(int x, int y) const noexcept {
        double samples[std::size_t{C}];
        read_one(x, y, samples);
        auto out = Lanes<lanes_for(C + 1)>::zero();
        for (int c = 0; c < C; ++c) out.set(c, samples[c]);
        return out;
    }
    /// Writes the samples of row y, or of the one that stands for it as in pixel(), times a factor, pixel after pixel: width() *
    /// C numbers.
    void row(int y, double factor, double* to) const noexcept {
        read(0, place(y, height_, wraps_y(periodic_)), width_, to);
        for (std::ptrdiff_t i = 0; i < std::ptrdiff_t{width_} * C; ++i) to[i] *= factor;
    }

    /// Whether pixels have weights.
    [[nodiscard]] bool is_weighted() const noexcept { return weights_.data != nullptr; }
    /// The weight of pixel (x, y) as a share of the largest one; 1 where there are none.
    [[nodiscard]] double weight(int x, int y) const noexcept {
        return weights_.data == nullptr ? 1 : unit_ * static_cast<double>(*weights_.pixel(x, y));
    }

  private:
    /// A view without its type of samples.
    struct Pixels {
        const void* data;
        int width, height;
        std::ptrdiff_t row_stride;
        double low, high, peak;
        double largest;  ///< as MomentTable::Kind has it
        void (*read)(const ImageSource&, int, int, int, double*) noexcept;
        void (*read_integers)(const ImageSource&, int, int, int, std::int16_t*) noexcept;
    };
    HMESH_NEVER_INLINE HMESH_COLD ImageSource(const Pixels& pixels, const ImageView<float, 1>& weights, double unit) noexcept
        : data_(pixels.data), width_(pixels.width), height_(pixels.height), row_stride_(pixels.row_stride), weights_(weights),
          unit_(unit), low_(std::max(pixels.low, PixelTraits<float>::lowest)),
          high_(std::min(pixels.high, PixelTraits<float>::highest)), peak_(pixels.peak), largest_(pixels.largest),
          weight_scale_(unit, pixels.width, pixels.height), read_(pixels.read), read_integers_(pixels.read_integers) {}

    [[nodiscard]] typename MomentTable<C>::Kind kind() const noexcept { return {largest_, low_ < 0, is_weighted()}; }
    HMESH_NEVER_INLINE void read_one(int x, int y, double* to) const noexcept {
        read(place(x, width_, wraps_x(periodic_)), place(y, height_, wraps_y(periodic_)), 1, to);
    }
    /// The pixel of a side of `size` px that stands for pixel x of the plane.
    [[nodiscard]] static int place(int x, int size, bool wraps) noexcept {
        return wraps ? modulo(x, size) : std::max(0, std::min(size - 1, x));
    }
    /// Calls body(from, row, part) for the parts of a run of pixels between the lines where the image repeats, as pixels of it.
    template <class Body>
    HMESH_ALWAYS_INLINE void for_each_part(int x, int y, int count, Body&& body) const {
        if (wraps_y(periodic_)) y = modulo(y, height_);
        if (!wraps_x(periodic_)) {
            body(x, y, count);
            return;
        }
        for (int part = 0; count > 0; x += part, count -= part) {
            const int from = modulo(x, width_);
            part = std::min(count, width_ - from);
            body(from, y, part);
        }
    }
    /// Reads them by a function for pixels of the image.
    template <class Number>
    void read_parts(void (*part_reader)(const ImageSource&, int, int, int, Number*) noexcept, int x, int y, int count,
                    Number* to) const noexcept {
        for_each_part(x, y, count, [&](int from, int row, int part) {
            part_reader(*this, from, row, part, to);
            to += std::ptrdiff_t{C} * part;
        });
    }
    template <class T, class Number>
    static void read_view(const ImageSource& source, int x, int y, int count, Number* to) noexcept {
        const ImageView<T, C> view{static_cast<const T*>(source.data_), source.width_, source.height_, source.row_stride_};
        read_pixels(view, x, y, count, to);
    }

    const void* data_;
    int width_, height_;
    std::ptrdiff_t row_stride_;
    ImageView<float, 1> weights_;
    double unit_;  ///< of the weights, see weight_unit()
    double low_, high_, peak_;
    double largest_;  ///< as MomentTable::Kind has it
    WeightScale weight_scale_;
    bool has_straight_seams_ = false;
    Periodic periodic_ = Periodic::none;
    Samples samples_ = Samples::squares;
    void (*read_)(const ImageSource&, int, int, int, double*) noexcept;
    void (*read_integers_)(const ImageSource&, int, int, int, std::int16_t*) noexcept;
    const ChannelScale<C>* scale_ = nullptr;
    SourceCalls<C> calls_;  ///< without a window: the pixels are in memory
};

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_FIT_IMAGE_SOURCE_HPP
