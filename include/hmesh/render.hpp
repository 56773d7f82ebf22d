/// \file
/// render(): draws a mesh into an image of any size, pixel for pixel as a GPU does; with psnr() and to_pixels().
///
/// A pixel takes the colour of the face that holds its centre, by the top-left rule of fit/raster.hpp, interpolated linearly
/// (Gouraud) at that centre. At the mesh's own size these are the very pixels that were counted when the mesh was fitted. Each
/// edge is evaluated from its upper to its lower end, so that the two faces beside it agree to the bit and leave no gap at any
/// size. Samples that are points (mesh/samples.hpp) are drawn into points: the corners of the mesh are the picture's corner
/// samples. Cost: about 5 ns a pixel and 60 ns a face; memory beside the image: 16 bytes a vertex and about 14 a face.
#ifndef HMESH_RENDER_HPP
#define HMESH_RENDER_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "hmesh/core/array.hpp"
#include "hmesh/core/finite.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/core/psnr.hpp"
#include "hmesh/core/srgb.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/fit/raster.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/mesh/geometry.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/mesh/unrolled.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// Options of render().
struct RenderOptions {
    /// Which values are interpolated between the corners of a face.
    enum class Interpolation : std::uint8_t {
        encoded,  ///< the stored values, as GPUs do with colours that they take for plain numbers
        /// Linear light, as glTF renderers do: colours are clamped to [0, peak], decoded from sRGB (IEC 61966-2-1) and
        /// interpolated; pixels are encoded again. Alpha, the last of 2 or 4 channels, is clamped to [0, peak] but not decoded.
        /// Costs another 15 ns a pixel and channel.
        linear,
    };

    std::optional<int> width{},                            ///< px of the picture, 1 to kit::max_side; empty: the mesh's width
        height{};                                          ///< px of the picture, 1 to kit::max_side; empty: the mesh's height
    Interpolation interpolation = Interpolation::encoded;  ///< which values are interpolated
};

/// What render() returns: a picture of C channels, or why there is none.
template <int C>
struct [[nodiscard]] RenderResult {
    Image<float, C> image;  ///< the picture; empty unless the status is ok
    Status status;          ///< ok, or why there is no picture
};

namespace detail {

// Rows that are drawn as one piece of work.
inline constexpr int band_rows = 32;

/// A range of rows of a picture, or of bands.
struct RowRange {
    int first = 0, last = 0;  ///< [first, last)
};

/// A corner of a face: position in the picture, in px, and colour.
template <int C>
struct Corner {
    kit::Point at;
    const float* color;
};

/// The colours of a face as linear functions of the pixel.
template <int C>
class Shading {
  public:
    Shading(const Corner<C>& a, const Corner<C>& b, const Corner<C>& c) noexcept : weights_(a.at, b.at, c.at) {
        for (std::size_t k = 0; k < C; ++k) {
            base_[k] = static_cast<double>(a.color[k]);
            to_b_[k] = static_cast<double>(b.color[k]) - base_[k];
            to_c_[k] = static_cast<double>(c.color[k]) - base_[k];
        }
    }
    /// Writes pixels [begin, end) of row j to `pixel`.
    void fill(int j, int begin, int end, float* pixel) const noexcept {
        for (int i = begin; i < end; ++i, pixel += C) {
            const kit::Barycentric w = weights_(i, j);
            for (std::size_t k = 0; k < C; ++k) pixel[k] = static_cast<float>(base_[k] + w.b * to_b_[k] + w.c * to_c_[k]);
        }
    }

  private:
    kit::PixelBarycentric weights_;
    std::array<double, std::size_t{C}> base_, to_b_, to_c_;
};

/// Draws the rows of a face that lie in `rows`. `sides`: of the mesh, in the picture.
template <int C>
void draw_face(const Corner<C>& a, const Corner<C>& b, const Corner<C>& c, RowRange rows, const kit::FarSides& sides,
               Image<float, C>& out) {
    const Shading<C> shading(a, b, c);
    kit::for_each_span(a.at, b.at, c.at, {out.width(), rows.first, rows.last, sides},
                       [&](int j, int begin, int end) { shading.fill(j, begin, end, out.pixel(begin, j)); });
}

/// Which faces touch which band of rows: those of band b are faces[starts[b]] .. faces[starts[b + 1] - 1], in order.
struct Bands {
    kit::Array<std::size_t> starts;
    kit::Array<std::uint32_t> faces;
};

/// The faces of each band of a picture of `height` rows, by their positions `at` in the picture.
[[nodiscard]] inline Bands sort_into_bands(const MeshView& mesh, const kit::Array<kit::Point>& at, int height,
                                           const ParallelFor& parallel_for) {
    kit::ClipRect picture;
    picture.last = height;
    picture.sides.bottom = kit::far_sides(1, height, mesh.samples).bottom;
    kit::Array<RowRange> touched(mesh.face_count);  // in bands
    kit::for_each_chunk(parallel_for, mesh.face_count, 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t f = begin; f < end; ++f) {
            const std::array<std::uint32_t, 3>& face = mesh.faces[f];
            const auto [low, high] = std::minmax({at[face[0]].y, at[face[1]].y, at[face[2]].y});
            const int first = picture.row(low), last = picture.row(high);
            if (first < last) touched[f] = {first / band_rows, (last - 1) / band_rows + 1};
        }
    });
    const auto count = static_cast<std::size_t>((height - 1) / band_rows + 1);
    Bands bands;
    bands.starts.assign(count + 1, 0);
    for (const RowRange& t : touched)
        for (int b = t.first; b < t.last; ++b) ++bands.starts[static_cast<std::size_t>(b) + 1];
    for (std::size_t b = 0; b < count; ++b) bands.starts[b + 1] += bands.starts[b];
    bands.faces.resize(bands.starts[count]);
    kit::Array<std::size_t> next(bands.starts.begin(), bands.starts.end() - 1);
    for (std::size_t f = 0; f < touched.size(); ++f)
        for (int b = touched[f].first; b < touched[f].last; ++b)
            bands.faces[next[static_cast<std::size_t>(b)]++] = static_cast<std::uint32_t>(f);
    return bands;
}

/// Whether the mesh can be drawn into a picture of C channels and this size.
template <int C>
[[nodiscard]] Status check_drawing(const MeshView& mesh, int width, int height,
                                   RenderOptions::Interpolation interpolation) noexcept {
    if (mesh.width < 1) return {Errc::invalid_argument, "the mesh's width must be at least 1", mesh.width, 1};
    if (mesh.height < 1) return {Errc::invalid_argument, "the mesh's height must be at least 1", mesh.height, 1};
    if (width < 1) return {Errc::invalid_argument, "the picture to draw must be at least 1 pixel wide", width, 1};
    if (height < 1) return {Errc::invalid_argument, "the picture to draw must be at least 1 pixel high", height, 1};
    if (mesh.samples == Samples::points) {
        constexpr const char* of_points = "a mesh whose samples are points, and a picture of it, have at least 2 along each axis";
        for (const int side : {mesh.width, mesh.height, width, height})
            if (side < 2) return {Errc::invalid_argument, of_points, side, 2};
    }
    if (width > kit::max_side) return {Errc::image_too_large, "the picture to draw is too wide", width, kit::max_side};
    if (height > kit::max_side) return {Errc::image_too_large, "the picture to draw is too high", height, kit::max_side};
    const std::int64_t pixels = std::int64_t{width} * height;
    if (pixels > kit::max_pixels)
        return {Errc::image_too_large, "the picture to draw has too many pixels", pixels, kit::max_pixels};
    // Comes only where pointers have 32 bits.
    constexpr std::int64_t most = std::numeric_limits<std::ptrdiff_t>::max() / (C * std::int64_t{sizeof(float)});
    if (pixels > most) return {Errc::image_too_large, "the picture to draw has too many pixels", pixels, most};
    if (const Status status = check(mesh, kit::max_channels); !status) return status;
    if (mesh.channels != C)
        return {Errc::invalid_argument, "the mesh has not the picture's number of channels", mesh.channels, C};
    if (interpolation != RenderOptions::Interpolation::encoded && interpolation != RenderOptions::Interpolation::linear)
        return {Errc::invalid_argument, "the interpolation is none of those known", static_cast<int>(interpolation), 1};
    if (interpolation == RenderOptions::Interpolation::linear && mesh.premultiplied)
        return {Errc::invalid_argument, "linear light is drawn from straight colours, and the mesh's are premultiplied"};
    return {};
}

/// The colours of a mesh as shares of `peak` in [0, 1], light decoded from sRGB.
[[nodiscard]] inline kit::Array<float> decoded_colors(const MeshView& mesh, const ParallelFor& parallel_for) {
    const auto channels = static_cast<std::size_t>(mesh.channels);
    kit::Array<float> out(channels * mesh.vertex_count);
    kit::for_each_chunk(parallel_for, mesh.vertex_count, 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = channels * begin; i < channels * end; ++i) {
            const double share = std::max(0.0, std::min(1.0, static_cast<double>(mesh.colors[i]) / mesh.peak));
            const bool is_encoded = kit::is_light(static_cast<int>(i % channels), mesh.channels);
            out[i] = static_cast<float>(is_encoded ? kit::srgb_to_linear(share) : share);
        }
    });
    return out;
}
/// Turns pixels drawn from decoded_colors() back into stored values.
template <int C>
void encode_rows(const MeshView& mesh, RowRange rows, Image<float, C>& out) {
    float* pixel = out.pixel(0, rows.first);
    float* const end = pixel + static_cast<std::size_t>(rows.last - rows.first) * static_cast<std::size_t>(out.width()) * C;
    for (; pixel != end; pixel += C)
        for (int k = 0; k < C; ++k) {
            const auto share = static_cast<double>(pixel[k]);
            pixel[k] = static_cast<float>((kit::is_light(k, mesh.channels) ? kit::linear_to_srgb(share) : share) * mesh.peak);
        }
}

}  // namespace detail

/// Draws a mesh, scaled to the size of the picture. Where samples are points, its corners come onto the picture's corner samples,
/// of which there are two at least along each axis. Pixels hold interpolated stored values, neither rounded nor clamped;
/// to_pixels() rounds them. Of a periodic mesh copies are drawn as well, so that the picture is covered. Faces outside the
/// picture are clipped; where faces overlap the later one wins; pixels in no face are 0. A premultiplied mesh gives a
/// premultiplied picture, and cannot be drawn in linear light.
///
/// \param mesh          of C channels; its arrays must live until the call returns
/// \param options       size of the picture and kind of interpolation
/// \param parallel_for  executor of the rows, in bands of 32
/// \return              the picture, or the status invalid_argument, image_too_large or not_finite
template <int C>
[[nodiscard]] RenderResult<C> render(const MeshView& mesh, const RenderOptions& options = {},
                                     const ParallelFor& parallel_for = {}) {
    RenderResult<C> result;
    const int width = options.width.value_or(mesh.width), height = options.height.value_or(mesh.height);
    result.status = detail::check_drawing<C>(mesh, width, height, options.interpolation);
    if (!result.status) return result;
    if (mesh.periodic != Periodic::none) {
        const Mesh whole = kit::unrolled(mesh);
        return render<C>(whole.view(), options, parallel_for);
    }
    const bool is_linear = options.interpolation == RenderOptions::Interpolation::linear;

    // A position on the mesh's border comes out on the picture's: the product is exact and the quotient rounded once.
    const double from_right = kit::extent(mesh.width, mesh.samples), from_bottom = kit::extent(mesh.height, mesh.samples);
    const double to_right = kit::extent(width, mesh.samples), to_bottom = kit::extent(height, mesh.samples);
    const double shift = kit::inset(mesh.samples);
    const kit::FarSides sides = kit::far_sides(width, height, mesh.samples);
    kit::Array<kit::Point> at(mesh.vertex_count);
    kit::for_each_chunk(parallel_for, mesh.vertex_count, 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v)
            at[v] = {static_cast<double>(mesh.positions[2 * v]) * to_right / from_right + shift,
                     static_cast<double>(mesh.positions[2 * v + 1]) * to_bottom / from_bottom + shift};
    });
    constexpr double farthest = 16.0 * kit::max_side;  // px, so that columns fit an int
    for (std::size_t v = 0; v < at.size(); ++v)
        if (std::abs(at[v].x) > farthest || std::abs(at[v].y) > farthest) {
            result.status = {Errc::invalid_argument, "the mesh has a position far outside its image, at vertex", v};
            return result;
        }

    const detail::Bands bands = detail::sort_into_bands(mesh, at, height, parallel_for);
    kit::Array<float> light;
    if (is_linear) light = detail::decoded_colors(mesh, parallel_for);
    const float* const colors = is_linear ? light.data() : mesh.colors;
    result.image = Image<float, C>(width, height, kit::raw);
    Image<float, C>& out = result.image;
    parallel_for(bands.starts.size() - 1, [&](std::size_t band) {
        const int first = static_cast<int>(band) * detail::band_rows;
        const detail::RowRange rows{first, std::min(height, first + detail::band_rows)};
        const auto corner = [&](std::uint32_t v) { return detail::Corner<C>{at[v], colors + std::size_t{v} * C}; };
        std::fill(out.pixel(0, rows.first), out.pixel(0, rows.last), 0.0F);
        for (std::size_t i = bands.starts[band]; i < bands.starts[band + 1]; ++i) {
            const std::array<std::uint32_t, 3>& face = mesh.faces[bands.faces[i]];
            detail::draw_face(corner(face[0]), corner(face[1]), corner(face[2]), rows, sides, out);
        }
        if (is_linear) detail::encode_rows(mesh, rows, out);
    });
    return result;
}

/// The PSNR of a picture against a reference image, in dB: 10 log10(peak^2 / MSE), with the MSE the mean of the squared
/// differences of stored values over pixels AND channels, and peak that of the reference's pixel type. Infinity for equal
/// images; NaN for views that check() refuses or of different sizes.
template <class T, class U, int C>
[[nodiscard]] double psnr(const ImageView<T, C>& reference, const ImageView<U, C>& rendered,
                          const ParallelFor& parallel_for = {}) {
    if (!check(reference) || !check(rendered) || reference.width != rendered.width || reference.height != rendered.height)
        return kit::detail::nan();
    const double energy =
        kit::ordered_sum(parallel_for, static_cast<std::size_t>(reference.height), 32, [&](std::size_t begin, std::size_t end) {
            double sum = 0;
            for (std::size_t y = begin; y < end; ++y) {
                const T* a = reference.row(static_cast<int>(y));
                const U* b = rendered.row(static_cast<int>(y));
                for (int k = 0; k < reference.width * C; ++k) {
                    const double difference = PixelTraits<T>::to_real(a[k]) - PixelTraits<U>::to_real(b[k]);
                    sum += difference * difference;
                }
            }
            return sum;
        });
    const double samples = static_cast<double>(reference.width) * reference.height * C;
    return kit::psnr_of_energy(energy, samples, PixelTraits<T>::peak);
}

/// A picture in pixels of type T: values rounded to nearest and clamped to the type's range (PixelTraits::from_real).
template <class T, int C>
[[nodiscard]] Image<T, C> to_pixels(const Image<float, C>& image, const ParallelFor& parallel_for = {}) {
    Image<T, C> out(image.width(), image.height(), kit::raw);
    const float* const from = image.data();
    T* const to = out.data();
    kit::for_each_chunk(parallel_for, image.size(), 65536, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) to[k] = PixelTraits<T>::from_real(static_cast<double>(from[k]));
    });
    return out;
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_RENDER_HPP
