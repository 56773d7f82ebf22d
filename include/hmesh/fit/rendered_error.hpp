/// \file
/// rendered_errors(): the squared and the largest error of a finished mesh, pixel by pixel, as render() draws it.
///
/// While a mesh is fitted its energy comes from sums along the image's rows (fit/moment_table.hpp). They are exact for integer
/// samples; those of floats lose 2^-53 of the largest sum, and where a sun of 1e6 stands beside shades of 0.1 that is more than
/// the whole error. Weights, and rows of very many pixels, leave too few digits for slivers (ImageSource::has_exact_sums()). The
/// error reported for such images is therefore measured here. Cost: some 5 ns a pixel.
#ifndef HMESH_FIT_RENDERED_ERROR_HPP
#define HMESH_FIT_RENDERED_ERROR_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "hmesh/core/array.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/fit/image_source.hpp"
#include "hmesh/fit/raster.hpp"
#include "hmesh/image/channel_weights.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/image/weights.hpp"
#include "hmesh/mesh/geometry.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/mesh/samples.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// The position of vertex v in the plane where the centre of pixel (i, j) is at (i + 1/2, j + 1/2) (mesh/samples.hpp).
[[nodiscard]] inline Point position(const Mesh& mesh, std::size_t v) noexcept {
    const double shift = inset(mesh.samples);
    return {static_cast<double>(mesh.positions[2 * v]) + shift, static_cast<double>(mesh.positions[2 * v + 1]) + shift};
}

/// Whether vertex v is inside of the rectangle that a mesh of its image covers, or on its border. Not for NaN.
[[nodiscard]] inline bool is_inside(const Mesh& mesh, std::size_t v) noexcept {
    const auto x = static_cast<double>(mesh.positions[2 * v]), y = static_cast<double>(mesh.positions[2 * v + 1]);
    return x >= 0 && x <= extent(mesh.width, mesh.samples) && y >= 0 && y <= extent(mesh.height, mesh.samples);
}

/// How far a mesh is from an image.
struct RenderedError {
    double energy = 0;   ///< sum over pixels and channels of squared differences in stored values, by weight
    double largest = 0;  ///< largest difference of a pixel and channel, in stored values; those of weight 0 do not count
};

namespace detail {

/// Adds to `sum` the error of a mesh in the faces [first, last), whose pixels the window has; else as rendered_errors(). Never
/// inlined: whatever is in memory, it rounds alike.
template <int C>
HMESH_NEVER_INLINE void add_rendered_errors(const Mesh& mesh, std::size_t first, std::size_t last, const ImageSource<C>& source,
                                            const SourceWindow<C>& window, const ChannelScale<C>& channels, RenderedError& sum) {
    constexpr int chunk = 32;  // pixels read at once
    const ClipRect clip{source.width(), 0, source.height(), far_sides(source.width(), source.height(), mesh.samples)};
    std::array<double, std::size_t{C}> largest{};  // of each channel
    for (std::size_t f = first; f < last; ++f) {
        const Triangle& t = mesh.faces[f];
        const Point a = position(mesh, t[0]), b = position(mesh, t[1]), c = position(mesh, t[2]);
        const PixelBarycentric weights_at(a, b, c);
        std::array<double, std::size_t{C}> at_a{}, to_b{}, to_c{};
        for (std::size_t k = 0; k < C; ++k) {
            const auto color = [&](std::uint32_t v) { return static_cast<double>(mesh.colors[C * std::size_t{v} + k]); };
            at_a[k] = color(t[0]), to_b[k] = color(t[1]) - at_a[k], to_c[k] = color(t[2]) - at_a[k];
        }
        double energy = 0;
        for_each_span(a, b, c, clip, [&](int j, int begin, int end) {
            double samples[std::size_t{chunk} * C], weights[chunk];
            for (int i = begin; i < end; ++i) {
                const int place = (i - begin) % chunk;
                if (place == 0) {
                    window.read(i, j, std::min(chunk, end - i), samples);
                    if (source.is_weighted()) source.read_weights(i, j, std::min(chunk, end - i), weights);
                }
                const double* const sample = samples + std::ptrdiff_t{C} * place;
                const Barycentric w = weights_at(i, j);
                const double times = source.is_weighted() ? weights[place] : 1;
                double square = 0;
                for (std::size_t k = 0; k < C; ++k) {
                    const double color = at_a[k] + w.b * to_b[k] + w.c * to_c[k];
                    const double off = color - sample[k], difference = channels.share[k] * off;
                    square += difference * difference;
                    largest[k] = std::max(largest[k], times > 0 ? std::abs(off) : 0);
                }
                energy += times * square;
            }
        });
        sum.energy += energy;
    }
    for (std::size_t k = 0; k < C; ++k)
        if (channels.share[k] > 0) sum.largest = std::max(sum.largest, largest[k]);
}

/// The errors of all faces of a mesh, from those that add(first, last, sum) adds of some in a row.
[[nodiscard]] HMESH_COLD inline RenderedError sum_rendered_errors(
    const Mesh& mesh, const ParallelFor& parallel_for,
    FunctionRef<void(std::size_t first, std::size_t last, RenderedError& sum)> add) {
    constexpr std::size_t grain = 256;
    Array<RenderedError> parts(mesh.faces.size() / grain + 1);
    for_each_chunk(parallel_for, mesh.faces.size(), grain,
                   [&](std::size_t first, std::size_t last) { add(first, last, parts[first / grain]); });
    RenderedError sum;
    for (const RenderedError& part : parts) {
        sum.energy += part.energy;
        sum.largest = std::max(sum.largest, part.largest);
    }
    return sum;
}

}  // namespace detail

/// The error of a mesh, of C channels, by the weights of pixels and of channels (the largest being 1). The mesh must cover the
/// image once with faces of positive area, which may stand out of it.
template <int C>
[[nodiscard]] HMESH_COLD RenderedError rendered_errors(const Mesh& mesh, const ImageSource<C>& source,
                                                       const ParallelFor& parallel_for = {},
                                                       const ChannelScale<C>& channels = {}) {
    if (source.is_read()) return source.calls().error(source, mesh, parallel_for, channels);
    return detail::sum_rendered_errors(mesh, parallel_for, [&](std::size_t first, std::size_t last, RenderedError& sum) {
        detail::add_rendered_errors(mesh, first, last, source, SourceWindow<C>{source}, channels, sum);
    });
}
/// The same of an image's view, with `unit` as by weight_unit().
template <class T, int C>
[[nodiscard]] RenderedError rendered_errors(const Mesh& mesh, const ImageView<T, C>& view,
                                            const ImageView<float, 1>& weights = {}, double unit = 1,
                                            const ParallelFor& parallel_for = {}, const ChannelScale<C>& channels = {}) {
    return rendered_errors(mesh, ImageSource<C>(view, weights, unit), parallel_for, channels);
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_FIT_RENDERED_ERROR_HPP
