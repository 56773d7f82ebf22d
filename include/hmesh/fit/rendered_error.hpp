/// \file
/// rendered_error(): the squared error of a finished mesh, pixel by pixel, as render() draws it.
///
/// While a mesh is fitted its energy comes from sums along the image's rows (fit/moment_table.hpp). They are exact for integer
/// samples; those of floats lose 2^-53 of the largest sum, and where a sun of 1e6 stands beside shades of 0.1 that is more than
/// the whole error. The error reported for float images is therefore measured here. Cost: some 5 ns a pixel.
#ifndef HMESH_FIT_RENDERED_ERROR_HPP
#define HMESH_FIT_RENDERED_ERROR_HPP

#include <array>
#include <cstddef>
#include <cstdint>

#include "hmesh/core/parallel.hpp"
#include "hmesh/image/channel_weights.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/image/weights.hpp"
#include "hmesh/mesh/geometry.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/mesh/raster.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {
namespace detail {

/// The position of vertex v.
[[nodiscard]] inline Point position(const Mesh& mesh, std::size_t v) noexcept {
    return {static_cast<double>(mesh.positions[2 * v]), static_cast<double>(mesh.positions[2 * v + 1])};
}

}  // namespace detail

/// The sum over pixels and channels of squared differences in stored values between a mesh, of C channels, and an image, times
/// the weights of pixels (`unit` as by weight_unit()) and of channels (the largest being 1). The mesh must cover the image once
/// with faces of positive area, which may stand out of it.
template <class T, int C>
[[nodiscard]] double rendered_error(const Mesh& mesh, const ImageView<T, C>& view, const ImageView<float, 1>& weights = {},
                                    double unit = 1, const ParallelFor& parallel_for = {}, const ChannelScale<C>& channels = {}) {
    const WeightScale scale(unit, view.width, view.height);
    const auto face = [&](const Triangle& t) {
        const Point a = detail::position(mesh, t[0]), b = detail::position(mesh, t[1]), c = detail::position(mesh, t[2]);
        const PixelBarycentric weights_at(a, b, c);
        std::array<double, std::size_t{C}> at_a{}, to_b{}, to_c{};
        for (std::size_t k = 0; k < C; ++k) {
            const auto color = [&](std::uint32_t v) { return static_cast<double>(mesh.colors[C * std::size_t{v} + k]); };
            at_a[k] = color(t[0]), to_b[k] = color(t[1]) - at_a[k], to_c[k] = color(t[2]) - at_a[k];
        }
        double energy = 0;
        for_each_span(a, b, c, {view.width, 0, view.height}, [&](int j, int begin, int end) {
            const T* sample = view.pixel(begin, j);
            const float* weight = weights.data != nullptr ? weights.pixel(begin, j) : nullptr;
            for (int i = begin; i < end; ++i, sample += C) {
                const Barycentric w = weights_at(i, j);
                double square = 0;
                for (std::size_t k = 0; k < C; ++k) {
                    const double color = at_a[k] + w.b * to_b[k] + w.c * to_c[k];
                    const double difference = channels.share[k] * (color - PixelTraits<T>::to_real(sample[k]));
                    square += difference * difference;
                }
                energy += weight != nullptr ? scale(weight[i - begin]) * square : square;
            }
        });
        return energy;
    };
    return ordered_sum(parallel_for, mesh.faces.size(), 256, [&](std::size_t begin, std::size_t end) {
        double sum = 0;
        for (std::size_t f = begin; f < end; ++f) sum += face(mesh.faces[f]);
        return sum;
    });
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_FIT_RENDERED_ERROR_HPP
