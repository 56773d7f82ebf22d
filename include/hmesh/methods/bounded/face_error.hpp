/// \file
/// The largest difference between a face and the samples that it holds, in double: what the bound is about.
///
/// A face holds the samples of the closed triangle: one on an edge is held against both faces. On the 1/256 px grid that is
/// decided exactly (fit/raster.hpp has the argument), and for whole numbers at whole positions so is the difference, which is
/// calculated times the face's area. Costs some 40 ns and 0.3 ns a sample.
#ifndef HMESH_METHODS_BOUNDED_FACE_ERROR_HPP
#define HMESH_METHODS_BOUNDED_FACE_ERROR_HPP

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "hmesh/core/compiler.hpp"
#include "hmesh/mesh/geometry.hpp"
#include "hmesh/methods/bounded/detail/wide.hpp"
#include "hmesh/methods/bounded/height_field.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// A corner of a face: where it stands and how high, in each channel.
struct Corner {
    Point position;                            ///< px
    float heights[max_bounded_channels] = {};  ///< stored values
};

namespace detail {

/// The whole numbers of [low, high], as [begin, end), for low > -1.
struct Wholes {
    HMESH_ALWAYS_INLINE Wholes(double low, double high) noexcept
        : begin(static_cast<int>(low) + (static_cast<double>(static_cast<int>(low)) < low ? 1 : 0)),
          end(static_cast<int>(high + 1)) {}
    int begin, end;
};

}  // namespace detail

/// Calls body(j, begin, end) for each row of samples, top to bottom, of which the closed triangle (a, b, c) holds some: those of
/// columns [begin, end).
template <class Body>
HMESH_ALWAYS_INLINE void for_each_closed_span(const HeightField& field, Point a, Point b, Point c, Body&& body) {
    if (b.y < a.y) std::swap(a, b);
    if (c.y < b.y) std::swap(b, c);
    if (b.y < a.y) std::swap(a, b);
    constexpr double slack = 1.0 / 8589934592.0;  // 2^-33 px: larger than rounding, less than what any other sample is off
    const double offset = field.offset();
    const double slope = c.y > a.y ? (c.x - a.x) / (c.y - a.y) : 0;
    const double upper = b.y > a.y ? (b.x - a.x) / (b.y - a.y) : 0, lower = c.y > b.y ? (c.x - b.x) / (c.y - b.y) : 0;
    const detail::Wholes rows(a.y - offset, c.y - offset);
    const int last = std::min(rows.end, field.height);
    for (int j = std::max(0, rows.begin); j < last; ++j) {
        const double y = j + offset;
        // On the level of b both sides count: of a level edge all is held.
        const double one = a.x + (y - a.y) * slope, above = a.x + (y - a.y) * upper, below = b.x + (y - b.y) * lower;
        double left = 0, right = 0;
        if (y < b.y) left = std::min(one, above), right = std::max(one, above);
        else if (y > b.y) left = std::min(one, below), right = std::max(one, below);
        else
            left = std::min(c.y > a.y ? one : std::min(a.x, c.x), b.x),
            right = std::max(c.y > a.y ? one : std::max(a.x, c.x), b.x);
        const detail::Wholes columns(left - offset - slack, right - offset + slack);
        const int begin = std::max(0, columns.begin), end = std::min(field.width, columns.end);
        if (begin < end) body(j, begin, end);
    }
}

/// The worst sample of a face.
struct WorstSample {
    double error = 0;  ///< face_error(); what rounding itself may leave counts as 0
    int i = -1,        ///< column; -1: no sample differs
        j = -1;        ///< row
};

/// The heights of a face along its rows, times twice its area: differences to a channel's samples are linear in it, and whole
/// for whole numbers at whole positions.
struct ScaledPlane {
    double area;   ///< twice the area of the face, px^2, > 0
    double base;   ///< height of corner a
    double dx,     ///< rise a column, times `area`
        dy;        ///< rise a row, times `area`
    double x,      ///< px of corner a
        y;         ///< px of corner a
    double slack;  ///< what rounding may leave of a difference of 0
    /// Of the positively oriented face (a, b, c).
    HMESH_ALWAYS_INLINE ScaledPlane(const Corner& a, const Corner& b, const Corner& c, double twice_area, int channel) noexcept
        : area(twice_area), base(static_cast<double>(a.heights[channel])), x(a.position.x), y(a.position.y) {
        const double rise_b = static_cast<double>(b.heights[channel]) - base,
                     rise_c = static_cast<double>(c.heights[channel]) - base;
        dx = (c.position.y - y) * rise_b - (b.position.y - y) * rise_c;
        dy = (b.position.x - x) * rise_c - (c.position.x - x) * rise_b;
        // Each of the two products passes four roundings of 2^-53, of at most area * rise; 2^-50 is less than half a step of a
        // whole-numbered difference of 16 bits, which is 1 / area > 2^-33.
        slack = std::max(std::abs(rise_b), std::abs(rise_c)) * (1.0 / 1125899906842624.0);
    }
    /// (height at column i, row j - base) * area, for a sample at (i, j) + offset.
    [[nodiscard]] HMESH_ALWAYS_INLINE double at(double i, double j, double offset) const noexcept {
        return (i + offset - x) * dx + (j + offset - y) * dy;
    }
};

/// The largest |plane - sample| * area of samples [begin, end) of a row. `from` is its value at column `begin`.
[[nodiscard]] HMESH_ALWAYS_INLINE double largest_difference(const ScaledPlane& plane, const float* row, double from, int begin,
                                                            int end) noexcept {
    using Numbers = Wide<double>;
    const Numbers counting = Numbers::counting();
    const Numbers area = Numbers::all(plane.area), base = Numbers::all(plane.base);
    Numbers most = Numbers::all(0), column = counting;
    const Numbers start = Numbers::all(from), step = Numbers::all(Numbers::lanes);
    const int whole = begin + (end - begin) / Numbers::lanes * Numbers::lanes;
    const auto difference = [&](int i) {
        return magnitude(start + column * plane.dx - area * (Numbers::load_floats(row + i) - base));
    };
    int i = begin;
    for (; i < whole; i += Numbers::lanes) {
        most = larger(most, difference(i));
        column = column + step;
    }
    if (i < end) most = larger(most, where_at_least(Numbers::all(end - i - 0.5), counting, difference(i)));
    return most.largest();
}

/// largest_difference() of samples [begin, end) of row j, less the room that the field gives them, times area.
[[nodiscard]] HMESH_COLD HMESH_NEVER_INLINE inline double difference_beyond_room(const HeightField& field,
                                                                                 const ScaledPlane& plane, int channel, int j,
                                                                                 int begin, int end) noexcept {
    double most = 0;
    for (int i = begin; i < end; ++i) {
        const double rise = static_cast<double>(field.row(channel, j)[i]) - plane.base;
        const double off = std::abs(plane.at(i, j, field.offset()) - plane.area * rise);
        most = std::max(most, off - field.room_at(i, j) * plane.area);
    }
    return most;
}

/// The same for any row, fast where the field gives no room.
[[nodiscard]] HMESH_ALWAYS_INLINE double row_difference(const HeightField& field, const ScaledPlane& plane, int channel, int j,
                                                        int begin, int end) noexcept {
    if (field.has_room(j, begin, end)) return difference_beyond_room(field, plane, channel, j, begin, end);
    return largest_difference(plane, field.row(channel, j), plane.at(begin, j, field.offset()), begin, end);
}

/// The largest |face - sample| of the positively oriented face (a, b, c), in any channel, less the room that the field gives
/// samples along its sides; any number above `enough` where it is larger than that.
[[nodiscard]] HMESH_NEVER_INLINE inline double face_error(const HeightField& field, const Corner& a, const Corner& b,
                                                          const Corner& c, double enough) noexcept {
    const double area = orient2d(a.position, b.position, c.position);
    double worst = 0;
    for (int channel = 0; channel < field.channels && worst <= enough; ++channel) {
        const ScaledPlane plane(a, b, c, area, channel);
        // More than rounding makes of `enough`: what is left out must not come back as a face that is not above it.
        const double too_much = (enough + plane.slack) * area * (1 + 1.0 / 281474976710656.0);  // 1 + 2^-48
        double most = 0;
        for_each_closed_span(field, a.position, b.position, c.position, [&](int j, int begin, int end) {
            if (most > too_much) return;
            most = std::max(most, row_difference(field, plane, channel, j, begin, end));
        });
        worst = std::max(worst, most / area - plane.slack);
    }
    return worst;
}

/// The worst sample of the positively oriented face (a, b, c); of several the first, row after row.
[[nodiscard]] HMESH_NEVER_INLINE inline WorstSample worst_sample(const HeightField& field, const Corner& a, const Corner& b,
                                                                 const Corner& c) noexcept {
    const double area = orient2d(a.position, b.position, c.position), offset = field.offset();
    WorstSample worst;
    for (int channel = 0; channel < field.channels; ++channel) {
        const ScaledPlane plane(a, b, c, area, channel);
        double most = (worst.error + plane.slack) * area;
        int first = 0, last = 0, row = -1;
        for_each_closed_span(field, a.position, b.position, c.position, [&](int j, int begin, int end) {
            const double here = row_difference(field, plane, channel, j, begin, end);
            if (!(here > most)) return;
            most = here;
            first = begin, last = end, row = j;
        });
        if (row < 0) continue;
        worst = {most / area - plane.slack, first, row};
        // Which column: products may have been contracted otherwise above, hence the largest and not the equal one.
        double largest = std::numeric_limits<double>::lowest();
        for (int i = first; i < last; ++i) {
            const double difference =
                std::abs(plane.at(i, row, offset) - area * (static_cast<double>(field.row(channel, row)[i]) - plane.base)) -
                field.room_at(i, row) * area;
            if (difference > largest) largest = difference, worst.i = i;
        }
    }
    return worst;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_BOUNDED_FACE_ERROR_HPP
