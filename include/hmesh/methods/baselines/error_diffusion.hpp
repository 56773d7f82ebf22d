/// \file
/// Error diffusion: points with a density in proportion to a map, about as many as wanted.
///
/// The map is halftoned by the method of Floyd and Steinberg ("An adaptive algorithm for spatial greyscale", 1976), rows running
/// left and right in turn: a pixel becomes a point if its density plus the errors that its neighbours left is at least 1/2, and
/// passes its own error on. Yang, Wernick and Brankov ("A fast approach for accurate content-adaptive mesh generation", 2003)
/// place the vertices of a mesh in this way. Errors must add up before the first point, which therefore lies some 0.3 / density
/// rows below the top.
///
/// Cost: the factor from map to density is found by bisection, in some 10 passes of 4 to 6 ns a pixel.
#ifndef HMESH_METHODS_BASELINES_ERROR_DIFFUSION_HPP
#define HMESH_METHODS_BASELINES_ERROR_DIFFUSION_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "hmesh/core/array.hpp"
#include "hmesh/core/assert.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/image/image_view.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {
namespace detail {

/// Calls point(x, y) for points of the density min(1, factor * (map + floor)). Errors that would leave the image at a side go to
/// the nearest pixel below; only the last row loses errors, up to half a point for each of its pixels. In an image of a few rows
/// that could be most of the points, and the rest would stand only where the map is largest: images more than 8 times as wide as
/// high are therefore passed column by column.
template <class Point>
void diffuse(const ImageView<float, 1>& map, double factor, double floor, Point&& point) {
    const bool is_flat = map.width > 8 * map.height;
    const int width = is_flat ? map.height : map.width, height = is_flat ? map.width : map.height;
    const auto value = [&](int x, int y) { return static_cast<double>(is_flat ? map.row(x)[y] : map.row(y)[x]); };
    // Errors for this row and the next, with a margin on both sides for what falls over the border.
    Array<double> here(static_cast<std::size_t>(width) + 2, 0.0), below = here;
    for (int y = 0; y < height; ++y) {
        const int step = y % 2 == 0 ? 1 : -1;
        double* const errors = here.data() + 1;
        double* const next = below.data() + 1;
        double carried = 0;
        for (int x = step > 0 ? 0 : width - 1; x >= 0 && x < width; x += step) {
            const double wanted = std::min(1.0, factor * (value(x, y) + floor)) + errors[x] + carried;
            double error = wanted;
            if (wanted >= 0.5) {
                if (is_flat) point(y, x);
                else point(x, y);
                error -= 1;
            }
            carried = 7.0 / 16 * error;
            next[x - step] += 3.0 / 16 * error;
            next[x] += 5.0 / 16 * error;
            next[x + step] += 1.0 / 16 * error;
        }
        next[0] += next[-1];
        next[width - 1] += next[width];
        next[step > 0 ? width - 1 : 0] += carried;
        here.swap(below);
        std::fill(below.begin(), below.end(), 0.0);
    }
}

}  // namespace detail

/// At least `count` <= pixels points, and about 1 % more at most where the map allows, as pixel numbers y * width + x. They come
/// row by row, left and right in turn, or column by column in images more than 8 times as wide as high. Values of the map must
/// be finite and >= 0; a map that is 0 everywhere stands for an even density. go_on(), where set, is called between passes; once
/// it says false, the result is empty.
[[nodiscard]] inline Array<std::uint32_t> diffused_points(const ImageView<float, 1>& map, std::size_t count,
                                                          FunctionRef<bool()> go_on = {}) {
    const std::size_t pixels = static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height);
    HMESH_ASSERT(count <= pixels);
    double sum = 0, largest = 0;
    for (int y = 0; y < map.height; ++y)
        for (int x = 0; x < map.width; ++x) {
            sum += static_cast<double>(map.row(y)[x]);
            largest = std::max(largest, static_cast<double>(map.row(y)[x]));
        }
    // With a floor of 1e-9 of the largest value, pixels of value 0 become points only when nearly all others are, and with a
    // large enough factor all pixels are points.
    const double floor = largest > 0 ? 1e-9 * largest : 1;
    const auto number_at = [&](double factor) {
        std::size_t number = 0;
        detail::diffuse(map, factor, floor, [&](int, int) { ++number; });
        return number;
    };
    double low = 0, high = static_cast<double>(count) / (sum + floor * static_cast<double>(pixels));
    std::size_t number = 0;
    while ((number = number_at(high)) < count) {
        if (go_on && !go_on()) return {};
        low = high;
        high *= 2;
    }
    for (int pass = 0; pass < 40 && number > count + count / 128; ++pass) {
        if (go_on && !go_on()) return {};
        const double middle = 0.5 * (low + high);
        const std::size_t now = number_at(middle);
        if (now < count) low = middle;
        else high = middle, number = now;
    }
    Array<std::uint32_t> points;
    points.reserve(number);
    detail::diffuse(map, high, floor, [&](int x, int y) {
        points.push_back(static_cast<std::uint32_t>(y) * static_cast<std::uint32_t>(map.width) + static_cast<std::uint32_t>(x));
    });
    return points;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_BASELINES_ERROR_DIFFUSION_HPP
