/// \file
/// Line points: those of the first points that stand on lines of their own, the seams of a periodic image, the sides of one whose
/// samples are points, and the long sides of one of a single row or column.
///
/// Of r points a px^2 there are the root of r on a px of a line. What is due is added up along it, and a point stands where one
/// is.
///
/// Cost: for seams one sum over the density of all pixels; sides see their own samples alone.
#ifndef HMESH_METHODS_ANNEALED_LINE_POINTS_HPP
#define HMESH_METHODS_ANNEALED_LINE_POINTS_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "hmesh/core/array.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/fit/image_source.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/mesh/geometry.hpp"
#include "hmesh/mesh/periodic.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// Points on the lines x = 0 and y = 0 where a periodic image begins again, as far apart as points of this density are elsewhere
/// when there are `count` in the image; half of `count` at most. O(pixels).
[[nodiscard]] HMESH_COLD inline Array<Point> seam_points(const Image<float, 1>& density, double count, Periodic periodic) {
    const int width = density.width(), height = density.height();
    double sum = 0;
    for (std::size_t k = 0; k < density.size(); ++k) sum += static_cast<double>(density.data()[k]);
    Array<Point> points;
    // Of r points a px^2 there are the root of r on a px of a line.
    const auto walk = [&](int length, FunctionRef<double(int)> density_at, FunctionRef<Point(double)> place) {
        double due = 0.5;
        for (int i = 0; i < length; ++i) {
            due += std::min(1.0, std::sqrt(count * density_at(i) / sum));
            if (due < 1) continue;
            points.push_back(place(i + 0.5));
            due -= 1;
        }
    };
    const auto at = [&](int x, int y) { return static_cast<double>(*density.pixel(x, y)); };
    if (wraps_x(periodic))
        walk(
            height, [&](int y) { return 0.5 * (at(0, y) + at(width - 1, y)); },
            [](double y) {
                return Point{0, y};
            });
    if (wraps_y(periodic))
        walk(
            width, [&](int x) { return 0.5 * (at(x, 0) + at(x, height - 1)); },
            [](double x) {
                return Point{x, 0};
            });
    while (2 * static_cast<double>(points.size()) > count) {  // images of few rows or columns: every other one goes
        std::size_t kept = 0;
        for (std::size_t k = 1; k < points.size(); k += 2) points[kept++] = points[k];
        points.resize(kept);
    }
    return points;
}

/// Points on the sides of an image whose samples are points, in the plane where it is fitted (mesh/samples.hpp), as far apart on
/// the average as those of the image are when there are `count`; half of `count` at most. The vertices of a side alone fit the
/// samples on it, and chances of the density would leave it some `width * r` of them where a line asks for `width * sqrt(r)`.
/// They stand on samples, the closer the more the row bends: of r points a px^2 there are the root of r on a px of a line, and r
/// follows the bends. O(width + height).
template <int C>
[[nodiscard]] HMESH_COLD Array<Point> side_points(const ImageSource<C>& source, double count) {
    const int width = source.width(), height = source.height();
    Array<double> bends;  // of the sides, one after another
    const auto add_side = [&](const Rect& side) HMESH_COLD {
        const auto length = static_cast<std::size_t>(std::max(side.width, side.height));
        const std::size_t first = bends.size();
        bends.resize(first + length, 0.0);
        source.with_window(side, [&](const SourceWindow<C>& window) HMESH_COLD {
            const auto at = [&](std::size_t k) {
                const int i = static_cast<int>(std::min(k, length - 1));
                return window.pixel(side.width > 1 ? side.x + i : side.x, side.width > 1 ? side.y : side.y + i);
            };
            for (std::size_t k = 1; k + 1 < length; ++k) {
                // The second difference of the row smoothed by [1 2 1] / 4, in peaks.
                const auto bend = (at(k < 2 ? 0 : k - 2) - 2.0 * at(k) + at(k + 2)) * (1 / (4 * source.peak()));
                double most = 0;
                for (int c = 0; c < C; ++c) most = std::max(most, std::abs(bend[c]));
                bends[first + k] = std::sqrt(most);
            }
        });
    };
    add_side({0, 0, width, 1});
    add_side({0, height - 1, width, 1});
    add_side({0, 0, 1, height});
    add_side({width - 1, 0, 1, height});
    double sum = 0;
    for (const double bend : bends) sum += bend;
    const auto perimeter = static_cast<double>(bends.size());
    const double least = sum > 0 ? 0.1 * sum / perimeter : 1;
    const double wanted = std::min(0.5 * count, perimeter * std::sqrt(count / source.pixels()));
    const double each = wanted / (sum + least * perimeter);
    Array<Point> points;
    double due = 0.5;
    const auto place = [&](std::size_t k) {
        const auto columns = static_cast<std::size_t>(width), rows = static_cast<std::size_t>(height);
        const bool is_row = k < 2 * columns;
        const std::size_t side = is_row ? k / columns : (k - 2 * columns) / rows;
        const double along = static_cast<double>(is_row ? k % columns : (k - 2 * columns) % rows) + 0.5;
        return is_row ? Point{along, side == 0 ? 0.5 : height - 0.5} : Point{side == 0 ? 0.5 : width - 0.5, along};
    };
    for (std::size_t k = 0; k < bends.size(); ++k) {
        due += std::min(1.0, each * (bends[k] + least));
        if (due < 1) continue;
        points.push_back(place(k));
        due -= 1;
    }
    return points;
}

/// Points on the long sides of an image of one row or column, by turns on one and the other, beside these pixels, which are
/// numbered along it and rise. In its middle the points would be on one line: none sees another but those next to it, and corners
/// would have all of them for neighbours, which a mesh of a thousand points cannot bear.
[[nodiscard]] HMESH_COLD inline Array<Point> points_by_turns(const Array<std::uint32_t>& pixels, bool is_row) {
    Array<Point> points;
    points.reserve(pixels.size());
    for (std::size_t k = 0; k < pixels.size(); ++k) {
        const double along = pixels[k] + 0.5, across = k % 2 == 0 ? 0 : 1;
        points.push_back(is_row ? Point{along, across} : Point{across, along});
    }
    return points;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_ANNEALED_LINE_POINTS_HPP
