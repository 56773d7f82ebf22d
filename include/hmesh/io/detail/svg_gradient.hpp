/// \file
/// The linear gradients of write_svg(): where a gradient's line runs so that it shows a face's colours.
///
/// Over a face a colour is linear; a gradient is constant across its direction. Of all gradients, whatever their direction and
/// stops, the one with the least squared error over the face's area is found in closed form. Fix a direction, and number the
/// corners a, b, c along it. The best colour at a place t on the line is the mean over the chord across the face at t: the
/// colour at the chord's middle, which runs straight from a to the middle of the chord through b, and from there to c. So three
/// stops are enough. What is missed is linear along each chord; chords lengthen linearly up to b's, so the mean of the error is
/// |d|^2 / 24, d the difference of colour between the ends of b's chord: between b and a point of the edge ac. Over all
/// directions that is least where that point has the colour nearest to b's: the foot of b on the line ac in the space of
/// colours. And over the choice of b it is least opposite to the longest side there, where the foot always is between a and c.
/// The stops are means of corner colours, so none leaves the range of colours. Where |d| is a few steps of 8 bits, two stops
/// save a tenth of the file.
#ifndef HMESH_IO_DETAIL_SVG_GRADIENT_HPP
#define HMESH_IO_DETAIL_SVG_GRADIENT_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

/// A place in the image, in px.
struct PlanePoint {
    double x = 0, y = 0;
};

using FacePoints = std::array<PlanePoint, 3>;  ///< the places of a face's corners
using Color4 = std::array<double, 4>;          ///< red, green, blue, alpha, or grey, 0, 0, 0; in [0, 255]
using FaceColors = std::array<Color4, 3>;      ///< the colours of a face's corners

/// The mean of the corners' colours, which is the mean over the face.
[[nodiscard]] inline Color4 mean_color(const FaceColors& colors) noexcept {
    Color4 mean{};
    for (std::size_t c = 0; c < 4; ++c) mean[c] = (colors[0][c] + colors[1][c] + colors[2][c]) / 3;
    return mean;
}

/// Divides colours that are multiplied by alpha by it. A corner without alpha has no colour: it takes the others' mean. Other
/// than in ExportMesh it is the mean of this face alone, since faces are painted one by one.
inline void divide_by_alpha(FaceColors& colors) noexcept {
    for (std::size_t c = 0; c < 3; ++c) {
        const double alphas = colors[0][3] + colors[1][3] + colors[2][3];
        const double mean = alphas > 0 ? 255 * (colors[0][c] + colors[1][c] + colors[2][c]) / alphas : 0;
        for (Color4& color : colors) color[c] = std::min(255.0, color[3] > 0 ? 255 * color[c] / color[3] : mean);
    }
}

/// The line along which a gradient changes.
struct GradientLine {
    PlanePoint from, to;             ///< the places of the offsets 0 and 1
    int places = 0;                  ///< decimals to write of the places
    double low_at = 0, high_at = 1;  ///< the offsets at which the function is 0 and 1
    int offset_places = 4;           ///< decimals to write of offsets
};

/// The line on which a function that is linear over the face, given by its values at the corners, goes from 0 at low_at to 1 at
/// high_at; it passes by the face's centroid. Some viewers hold the line's ends in 1/65536 px, which would turn it across a
/// needle: so it is at least half as long as the face reaches to its sides, and the two offsets come closer. Offsets they hold
/// in 65536ths: from 8 px on it is the root of twice that reach, where both errors are alike. Ends and offsets have so many
/// decimals that on the face neither puts a value off by more than `error`; at most 9. The face has an area and the function is
/// not constant.
[[nodiscard]] inline GradientLine gradient_line(const FacePoints& at, const std::array<double, 3>& values,
                                                double error) noexcept {
    const double bx = at[1].x - at[0].x, by = at[1].y - at[0].y, cx = at[2].x - at[0].x, cy = at[2].y - at[0].y;
    const double area = bx * cy - by * cx, b = values[1] - values[0], c = values[2] - values[0];
    const double slope_x = (b * cy - c * by) / area, slope_y = (c * bx - b * cx) / area;
    const double squared = slope_x * slope_x + slope_y * slope_y, length = 1 / std::sqrt(squared);
    const PlanePoint center{at[0].x + (bx + cx) / 3, at[0].y + (by + cy) / 3};
    double reach = 0;  // px to the sides
    for (const PlanePoint& p : at)
        reach = std::max(reach, std::abs((p.x - center.x) * slope_y - (p.y - center.y) * slope_x) * length);

    GradientLine line;
    const double times = std::max(1.0, std::min(reach / 2, std::sqrt(2 * reach)) / length);
    line.low_at = (1 - 1 / times) / 2;
    line.high_at = (1 + 1 / times) / 2;
    const double step_x = times * slope_x / squared, step_y = times * slope_y / squared;
    const double center_at = line.low_at + (values[0] + (b + c) / 3) / times;
    line.from = {center.x - center_at * step_x, center.y - center_at * step_y};
    line.to = {line.from.x + step_x, line.from.y + step_y};

    // Ends off by e px, e <= unit / sqrt(2), shift the function by e / length and turn it by 2 e / (times length).
    const double per_unit = std::sqrt(0.5) * (1 + 2 * reach / (times * length)) / length;
    for (double unit = 1; line.places < 9 && per_unit * unit > error; unit /= 10) ++line.places;
    for (double off = 0.00005 * times; line.offset_places < 9 && off > error; off /= 10) ++line.offset_places;
    return line;
}

/// Whether the corners are not on one line.
[[nodiscard]] inline bool has_area(const FacePoints& at) noexcept {
    return (at[1].x - at[0].x) * (at[2].y - at[0].y) != (at[1].y - at[0].y) * (at[2].x - at[0].x);
}

/// Steps of 8 bits: corners that differ by less need no gradient.
inline constexpr double least_range = 0.5;

/// One channel of a face, exactly. Usually on a line along which it goes from 0 to 255, with the stops that all such faces
/// share. A viewer that gives a face a pixel whose centre is 1/256 px outside, or gives its line's ends in such units, shows
/// steep faces in colours far off; those of more than `steepest` get stops of their own, which hold them to the corners'
/// colours.
struct ChannelGradient {
    static constexpr double steepest = 128;  ///< steps of 8 bits a px

    bool is_plain = true;        ///< the face has one colour, `mean`
    bool is_steep = false;       ///< the stops are `low` and `high` and not those shared
    double mean = 0;             ///< in [0, 255]
    double low = 0, high = 255;  ///< the values at the line's two offsets
    GradientLine line;           ///< unless the face is plain

    /// Of a face, and which of its channels.
    ChannelGradient(const FacePoints& at, const FaceColors& colors, std::size_t channel) noexcept {
        std::array<double, 3> values = {colors[0][channel], colors[1][channel], colors[2][channel]};
        mean = (values[0] + values[1] + values[2]) / 3;
        const auto [least, most] = std::minmax({values[0], values[1], values[2]});
        if (most - least < least_range || !has_area(at)) return;
        is_plain = false;
        for (double& value : values) value /= 255;
        // An error of e steps of 8 bits rounds one pixel in 1/e to the next step: 1/64 leaves more than 70 dB.
        line = gradient_line(at, values, 1.0 / 64 / 255);
        const double length = (line.high_at - line.low_at) * std::hypot(line.to.x - line.from.x, line.to.y - line.from.y);
        is_steep = line.low_at > 0 || length * steepest < 255;
        if (!is_steep) return;
        low = least;
        high = most;
        for (double& value : values) value = (value * 255 - low) / (high - low);
        line = gradient_line(at, values, 0.25 / (high - low));
    }
};

/// Red, green and blue of a face by the best gradient.
struct FaceGradient {
    static constexpr double least_miss = 4;  ///< steps of 8 bits, worth a third stop

    bool is_plain = true;              ///< the face has one colour, the mean of its corners'
    bool has_middle = false;           ///< there are three stops
    GradientLine line;                 ///< unless the face is plain
    Color4 first{}, middle{}, last{};  ///< the stops' colours
    double middle_at = 0;              ///< the middle's offset in [0, 1]

    /// Of a face.
    FaceGradient(const FacePoints& at, const FaceColors& colors) noexcept {
        const auto product = [&](std::size_t from, std::size_t one, std::size_t other) {
            double sum = 0;
            for (std::size_t c = 0; c < 3; ++c) sum += (colors[one][c] - colors[from][c]) * (colors[other][c] - colors[from][c]);
            return sum;
        };
        std::size_t b = 0;
        double longest = -1;
        for (std::size_t k = 0; k < 3; ++k) {
            const double side = product((k + 1) % 3, (k + 2) % 3, (k + 2) % 3);
            if (side > longest) longest = side, b = k;
        }
        const std::size_t a = (b + 1) % 3, c = (b + 2) % 3;
        if (longest < least_range * least_range || !has_area(at)) return;
        is_plain = false;
        middle_at = std::max(0.0, std::min(1.0, product(a, b, c) / longest));
        first = colors[a];
        last = colors[c];
        Color4 miss{};  // between b and its foot
        for (std::size_t k = 0; k < 3; ++k) {
            const double foot = first[k] + middle_at * (last[k] - first[k]);
            miss[k] = colors[b][k] - foot;
            middle[k] = foot + miss[k] / 2;
            has_middle = has_middle || std::abs(miss[k]) >= least_miss;
        }
        // Two stops do it on the line through the corners' mean: |d|^2 / 18 in place of |d|^2 / 24.
        for (std::size_t k = 0; k < 3 && !has_middle; ++k) {
            first[k] = std::max(0.0, std::min(255.0, first[k] + miss[k] / 3));
            last[k] = std::max(0.0, std::min(255.0, last[k] + miss[k] / 3));
        }
        std::array<double, 3> values{};
        values[b] = middle_at;
        values[c] = 1;
        line = gradient_line(at, values, 0.25 / std::sqrt(longest));  // a quarter of a step of 8 bits
        middle_at = line.low_at + middle_at * (line.high_at - line.low_at);
    }
};

}  // namespace hmesh::detail

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_DETAIL_SVG_GRADIENT_HPP
