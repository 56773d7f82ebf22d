/// \file
/// HeightField: the samples that a bounded mesh keeps to, as planes of floats, with what has no data.
///
/// A copy of the image, so that all that follows is compiled once for all types of samples: 4 bytes a sample and channel, and
/// one for the mask where there is one. What rounding to float takes is known, of all samples and of those along each side, and
/// comes off the bound.
#ifndef HMESH_METHODS_BOUNDED_HEIGHT_FIELD_HPP
#define HMESH_METHODS_BOUNDED_HEIGHT_FIELD_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "hmesh/core/array.hpp"
#include "hmesh/core/finite.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/mesh/samples.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// The most channels that are kept within a bound.
inline constexpr int max_bounded_channels = 4;

/// What rounding to floats takes of some samples.
struct Rounding {
    double slack = 0;    ///< largest |float - sample|
    double largest = 0;  ///< largest |sample| with data
    /// One sample more.
    void add(double sample, float rounded) noexcept {
        slack = std::max(slack, std::abs(static_cast<double>(rounded) - sample));
        largest = std::max(largest, std::abs(sample));
    }
    /// The samples of another one, too.
    void add(const Rounding& other) noexcept {
        slack = std::max(slack, other.slack);
        largest = std::max(largest, other.largest);
    }
};

/// The sides of an image, in the order of arrays that have something for each.
enum ImageSide { top_side, bottom_side, left_side, right_side, image_sides };

/// The samples of an image as planes of floats. Sample (i, j) stands at (i + offset(), j + offset()).
struct HeightField {
    int width = 0,                       ///< samples in a row
        height = 0,                      ///< rows
        channels = 1;                    ///< 1 to 4
    Samples samples = Samples::squares;  ///< where samples stand
    Rounding rounding,                   ///< of all samples
        rounding_along[image_sides];     ///< of those along each side
    /// How much more than others the samples along each side may be off, in stored values: where the border, which follows from
    /// them alone, may be off by more than the inside, which others have a say in.
    double room[image_sides] = {};
    float lowest[max_bounded_channels] = {},  ///< of each channel the lowest sample with data, as float; 0 without any
        highest[max_bounded_channels] = {};   ///< and the highest
    int bad_row = -1;                         ///< a row with a sample that has data and is no finite float; or -1
    Array<float> values;                      ///< plane after plane, rows packed, some floats more at the end; 0 without data
    Array<std::uint8_t> data;                 ///< 1 for samples with data; empty: all

    /// 1/2 for squares, 0 for points.
    [[nodiscard]] double offset() const noexcept { return samples == Samples::squares ? 0.5 : 0.0; }
    /// The mesh is [0, right()] x [0, bottom()].
    [[nodiscard]] int right() const noexcept { return samples == Samples::squares ? width : width - 1; }
    [[nodiscard]] int bottom() const noexcept { return samples == Samples::squares ? height : height - 1; }  ///< see right()
    /// Row j of a channel; at least 8 floats can be read behind its end.
    [[nodiscard]] const float* row(int channel, int j) const noexcept {
        return values.data() +
               (static_cast<std::size_t>(channel) * static_cast<std::size_t>(height) + static_cast<std::size_t>(j)) *
                   static_cast<std::size_t>(width);
    }
    /// Whether sample (i, j) has data.
    [[nodiscard]] bool has_data(int i, int j) const noexcept {
        return data.empty() ||
               data[static_cast<std::size_t>(j) * static_cast<std::size_t>(width) + static_cast<std::size_t>(i)] != 0;
    }
    /// Whether some of the samples [begin, end) of row j may be off by more than others.
    [[nodiscard]] bool has_room(int j, int begin, int end) const noexcept {
        return (j == 0 && room[top_side] > 0) || (j == height - 1 && room[bottom_side] > 0) ||
               (begin == 0 && room[left_side] > 0) || (end == width && room[right_side] > 0);
    }
    /// How much more than others sample (i, j) may be off.
    [[nodiscard]] double room_at(int i, int j) const noexcept {
        return std::max({j == 0 ? room[top_side] : 0, j == height - 1 ? room[bottom_side] : 0, i == 0 ? room[left_side] : 0,
                         i == width - 1 ? room[right_side] : 0});
    }
    /// Whether unit square [i, i + 1] x [j, j + 1] of the plane is a cell of data: for points its four samples have data, for
    /// squares the one in its middle. False outside.
    [[nodiscard]] bool is_cell(int i, int j) const noexcept {
        if (i < 0 || j < 0 || i >= right() || j >= bottom()) return false;
        if (samples == Samples::squares) return has_data(i, j);
        return has_data(i, j) && has_data(i + 1, j) && has_data(i, j + 1) && has_data(i + 1, j + 1);
    }
    /// Whether the mesh must cover sample (i, j): it has data, and one of the cells at it is a cell of data.
    [[nodiscard]] bool is_wanted(int i, int j) const noexcept {
        if (data.empty()) return true;
        if (samples == Samples::squares) return has_data(i, j);
        return has_data(i, j) && (is_cell(i, j) || is_cell(i - 1, j) || is_cell(i, j - 1) || is_cell(i - 1, j - 1));
    }
};

namespace detail {

/// What a row of samples adds to what is known of a field.
template <int C>
struct HeightRow {
    Rounding rounding, left, right;                         ///< of all samples, of the first and of the last
    std::array<float, std::size_t{C}> lowest{}, highest{};  ///< of each channel; lowest > highest: there is none
    bool has_holes = false, is_bad = false;  ///< samples without data; samples that are not finite, as floats or before
};

/// Writes row j of a view to a field of its size, whose `data` are as many as its samples where some may have none.
template <class T, int C>
[[nodiscard]] HeightRow<C> take_row(const ImageView<T, C>& view, std::size_t j, const std::uint8_t* masked, bool nan_is_no_data,
                                    HeightField& field) {
    constexpr float huge = std::numeric_limits<float>::max();
    const auto width = static_cast<std::size_t>(field.width), rows = static_cast<std::size_t>(field.height);
    HeightRow<C> row;
    row.lowest.fill(huge), row.highest.fill(-huge);
    const T* from = view.row(static_cast<int>(j));
    for (std::size_t i = 0; i < width; ++i, from += C) {
        bool has_data = masked == nullptr || masked[i] != 0;
        double value[std::size_t{C}];
        for (int c = 0; c < C; ++c) {
            value[c] = PixelTraits<T>::to_real(from[c]);
            if (nan_is_no_data && !is_finite(value[c])) has_data = false;
        }
        if (!field.data.empty()) field.data[j * width + i] = has_data ? 1 : 0;
        row.has_holes = row.has_holes || !has_data;
        for (std::size_t c = 0; c < C; ++c) {
            const auto rounded = has_data ? static_cast<float>(value[c]) : 0.0F;
            field.values[(c * rows + j) * width + i] = rounded;
            if (!has_data) continue;
            if (!is_finite(value[c]) || !is_finite(rounded)) {
                row.is_bad = true;
                continue;
            }
            row.rounding.add(value[c], rounded);
            if (i == 0) row.left.add(value[c], rounded);
            if (i + 1 == width) row.right.add(value[c], rounded);
            row.lowest[c] = std::min(row.lowest[c], rounded);
            row.highest[c] = std::max(row.highest[c], rounded);
        }
    }
    return row;
}

}  // namespace detail

/// The samples of a view, which check() must accept. `mask`: of the view's size, 0 for no data; or empty. `nan_is_no_data`:
/// whether a NaN in any channel means that a sample has no data.
template <class T, int C>
[[nodiscard]] HeightField height_field(const ImageView<T, C>& view, Samples samples, const ImageView<std::uint8_t, 1>& mask,
                                       bool nan_is_no_data, const ParallelFor& parallel_for) {
    static_assert(C <= max_bounded_channels, "a bounded mesh has 1 to 4 channels");
    HeightField field;
    field.width = view.width;
    field.height = view.height;
    field.channels = C;
    field.samples = samples;
    const auto width = static_cast<std::size_t>(view.width), count = static_cast<std::size_t>(view.height);
    field.values.resize(width * count * C + 16);
    nan_is_no_data = nan_is_no_data && !PixelTraits<T>::is_integer;
    if (mask.data != nullptr || nan_is_no_data) field.data.resize(width * count);
    Array<detail::HeightRow<C>> rows(count);
    for_each_chunk(parallel_for, count, 32, [&](std::size_t begin, std::size_t end) {
        for (std::size_t j = begin; j < end; ++j) {
            const std::uint8_t* const masked = mask.data != nullptr ? mask.row(static_cast<int>(j)) : nullptr;
            rows[j] = detail::take_row(view, j, masked, nan_is_no_data, field);
        }
    });
    bool has_holes = false;
    for (std::size_t j = 0; j < count; ++j) {
        field.rounding.add(rows[j].rounding);
        field.rounding_along[left_side].add(rows[j].left);
        field.rounding_along[right_side].add(rows[j].right);
        has_holes = has_holes || rows[j].has_holes;
        if (rows[j].is_bad && field.bad_row < 0) field.bad_row = static_cast<int>(j);
    }
    field.rounding_along[top_side] = rows[0].rounding;
    field.rounding_along[bottom_side] = rows[count - 1].rounding;
    if (!has_holes) field.data = {};
    for (std::size_t c = 0; c < C; ++c) {
        float low = rows[0].lowest[c], high = rows[0].highest[c];
        for (const detail::HeightRow<C>& row : rows) {
            low = std::min(low, row.lowest[c]);
            high = std::max(high, row.highest[c]);
        }
        if (low <= high) field.lowest[c] = low, field.highest[c] = high;
    }
    return field;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_BOUNDED_HEIGHT_FIELD_HPP
