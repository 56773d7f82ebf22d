/// \file
/// Contours: the border of the pixels of a mask, each grown by a margin, as polygons with right angles.
///
/// Coordinates are whole numbers of 1/256 px, so that all that is asked of them is exact: products of differences stay below
/// 2^52. A contour has its inside where orient2d() is positive: outer borders run clockwise on the screen, holes the other
/// way. No two contours meet, nor does one meet itself: where pixels touch at a corner alone, the corner is filled.
/// Cost: O(pixels), 2 to 5 bytes each.
#ifndef HMESH_OUTLINE_CONTOUR_HPP
#define HMESH_OUTLINE_CONTOUR_HPP

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "hmesh/mesh/geometry.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// Units a px, of which points have whole numbers in [0, 2^24], y down.
inline constexpr int units_per_px = 256;

/// A closed polygon: its corners in order, the first not repeated.
using Loop = std::vector<GridPoint>;

/// Twice the signed area of a polygon in square units: > 0 of outer borders, < 0 of holes.
[[nodiscard]] inline std::int64_t double_area(const Loop& loop) noexcept {
    std::int64_t sum = 0;
    for (std::size_t i = 2; i < loop.size(); ++i) sum += orient2d(loop[0], loop[i - 1], loop[i]);
    return sum;
}

/// Whether p is inside of a polygon, whatever its orientation; on its border it may be either. Exact.
[[nodiscard]] inline bool is_inside(const Loop& loop, GridPoint p) noexcept {
    bool is_in = false;
    for (std::size_t i = 0, j = loop.size() - 1; i < loop.size(); j = i++) {
        const bool up = loop[i].y > p.y, before = loop[j].y > p.y;
        if (up == before) continue;
        const std::int64_t side = orient2d(loop[j], loop[i], p);
        if (up ? side > 0 : side < 0) is_in = !is_in;
    }
    return is_in;
}

/// Which pixels count, row after row: not 0.
struct Mask {
    int width = 0,                     ///< px
        height = 0;                    ///< px
    std::vector<std::uint8_t> pixels;  ///< width * height of them
};

namespace detail {

/// The intervals into which the sides of all grown pixels divide an axis of the image.
struct Intervals {
    std::vector<std::int32_t> ends;  ///< where they meet, in units: interval i is [ends[i], ends[i + 1]]
    std::vector<std::size_t> first,  ///< of each pixel, the first interval that it covers
        last;                        ///< and that behind its last one

    Intervals(int size, int margin) : first(static_cast<std::size_t>(size)), last(first.size()) {
        const std::int32_t all = size * units_per_px;
        const auto low = [&](int i) { return std::max(0, i * units_per_px - margin); };
        const auto high = [&](int i) { return std::min(all, (i + 1) * units_per_px + margin); };
        ends = {0, all};
        for (int i = 0; i < size; ++i) ends.insert(ends.end(), {low(i), high(i)});
        std::sort(ends.begin(), ends.end());
        ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
        const auto place = [&](std::int32_t x) {
            return static_cast<std::size_t>(std::lower_bound(ends.begin(), ends.end(), x) - ends.begin());
        };
        for (int i = 0; i < size; ++i)
            first[static_cast<std::size_t>(i)] = place(low(i)), last[static_cast<std::size_t>(i)] = place(high(i));
    }
    /// The number of intervals.
    [[nodiscard]] std::size_t count() const noexcept { return ends.size() - 1; }
};

/// The cells of two axes' intervals that grown pixels cover.
class Cells {
  public:
    /// Of a mask, its pixels grown by `margin` units.
    Cells(const Mask& mask, int margin)
        : across_(mask.width, margin), down_(mask.height, margin), columns_(across_.count()), rows_(down_.count()),
          cells_(columns_ * rows_, 0) {
        std::vector<std::vector<std::uint8_t>> drawn(static_cast<std::size_t>(mask.height));  // cells of each row of pixels
        std::vector<std::uint32_t> depth(columns_, 0);  // rows of pixels that cover a cell of the row at hand
        std::size_t enters = 0, leaves = 0;
        for (std::size_t row = 0; row < rows_; ++row) {
            for (; leaves < enters && down_.last[leaves] <= row; ++leaves) {
                for (std::size_t i = 0; i < columns_; ++i) depth[i] -= drawn[leaves][i];
                std::vector<std::uint8_t>().swap(drawn[leaves]);
            }
            for (; enters < drawn.size() && down_.first[enters] <= row; ++enters) {
                drawn[enters] = row_of(mask, enters);
                for (std::size_t i = 0; i < columns_; ++i) depth[i] += drawn[enters][i];
            }
            for (std::size_t i = 0; i < columns_; ++i) cells_[row * columns_ + i] = depth[i] != 0 ? 1 : 0;
        }
    }

    /// Fills what touches at a corner alone, until nothing does.
    void fill_corners() {
        std::vector<std::size_t> waiting;  // upper left cells of squares of four
        const auto look = [&](std::size_t at) {
            const std::size_t other = at + 1, below = at + columns_, across = below + 1;
            if (cells_[at] != cells_[across] || cells_[other] != cells_[below] || cells_[at] == cells_[other]) return;
            const std::size_t filled = cells_[at] != 0 ? other : at;
            cells_[filled] = 1;
            const std::size_t x = filled % columns_, y = filled / columns_;
            for (std::size_t j = y - (y > 0 ? 1 : 0); j <= y && j + 1 < rows_; ++j)
                for (std::size_t i = x - (x > 0 ? 1 : 0); i <= x && i + 1 < columns_; ++i) waiting.push_back(j * columns_ + i);
        };
        for (std::size_t y = 0; y + 1 < rows_; ++y)
            for (std::size_t x = 0; x + 1 < columns_; ++x) {
                look(y * columns_ + x);
                while (!waiting.empty()) {
                    const std::size_t at = waiting.back();
                    waiting.pop_back();
                    look(at);
                }
            }
    }

    /// Fills what has no way to the border of the image.
    void fill_holes() {
        std::vector<std::size_t> open;
        std::vector<std::uint8_t> is_outside(cells_.size(), 0);
        const auto reach = [&](std::size_t at) {
            if (cells_[at] != 0 || is_outside[at] != 0) return;
            is_outside[at] = 1;
            open.push_back(at);
        };
        for (std::size_t x = 0; x < columns_; ++x) reach(x), reach((rows_ - 1) * columns_ + x);
        for (std::size_t y = 0; y < rows_; ++y) reach(y * columns_), reach(y * columns_ + columns_ - 1);
        while (!open.empty()) {
            const std::size_t at = open.back(), x = at % columns_;
            open.pop_back();
            if (x > 0) reach(at - 1);
            if (x + 1 < columns_) reach(at + 1);
            if (at >= columns_) reach(at - columns_);
            if (at + columns_ < cells_.size()) reach(at + columns_);
        }
        for (std::size_t i = 0; i < cells_.size(); ++i) cells_[i] = is_outside[i] != 0 ? 0 : 1;
    }

    /// The borders, by their upper left corners. fill_corners() must have run.
    [[nodiscard]] std::vector<Loop> borders() const {
        std::vector<Loop> loops;
        std::vector<std::uint8_t> is_walked(cells_.size(), 0);  // along the upper side
        for (std::size_t y = 0; y < rows_; ++y)
            for (std::size_t x = 0; x < columns_; ++x)
                if (is_in(x, y) && !is_in(x, y - 1) && is_walked[y * columns_ + x] == 0) loops.push_back(walk(x, y, is_walked));
        return loops;
    }

    /// Twice the area covered, in square units.
    [[nodiscard]] double double_area() const noexcept {
        double sum = 0;
        for (std::size_t y = 0; y < rows_; ++y) {
            std::int64_t width = 0;
            for (std::size_t x = 0; x < columns_; ++x)
                if (cells_[y * columns_ + x] != 0) width += across_.ends[x + 1] - across_.ends[x];
            sum += 2.0 * static_cast<double>(width) * (down_.ends[y + 1] - down_.ends[y]);
        }
        return sum;
    }

  private:
    [[nodiscard]] std::vector<std::uint8_t> row_of(const Mask& mask, std::size_t y) const {
        std::vector<std::uint8_t> out(columns_, 0);
        const std::uint8_t* pixel = mask.pixels.data() + y * static_cast<std::size_t>(mask.width);
        std::size_t done = 0;
        for (std::size_t x = 0; x < static_cast<std::size_t>(mask.width); ++x) {
            if (pixel[x] == 0) continue;
            done = std::max(done, across_.first[x]);
            for (; done < across_.last[x]; ++done) out[done] = 1;
        }
        return out;
    }
    // Numbers wrap around below 0.
    [[nodiscard]] bool is_in(std::size_t x, std::size_t y) const noexcept {
        return x < columns_ && y < rows_ && cells_[y * columns_ + x] != 0;
    }
    // From the corner (x, y) along the upper side of its cell, with what is covered to the right, around.
    [[nodiscard]] Loop walk(std::size_t x, std::size_t y, std::vector<std::uint8_t>& is_walked) const {
        Loop loop;
        const std::size_t from_x = x, from_y = y;
        int direction = 0, before = 3;  // right, down, left, up; the first corner turns
        do {
            if (direction == 0) is_walked[y * columns_ + x] = 1;
            if (direction != before) loop.push_back({across_.ends[x], down_.ends[y]});
            before = direction;
            if (direction == 0) ++x;
            else if (direction == 1) ++y;
            else if (direction == 2) --x;
            else --y;
            // The cells ahead: to the right of the way and to its left.
            const std::size_t left = x - 1, up = y - 1;
            const bool right_ahead = direction == 0   ? is_in(x, y)
                                     : direction == 1 ? is_in(left, y)
                                     : direction == 2 ? is_in(left, up)
                                                      : is_in(x, up);
            const bool left_ahead = direction == 0   ? is_in(x, up)
                                    : direction == 1 ? is_in(x, y)
                                    : direction == 2 ? is_in(left, y)
                                                     : is_in(left, up);
            if (left_ahead) direction = (direction + 3) % 4;
            else if (!right_ahead) direction = (direction + 1) % 4;
        } while (x != from_x || y != from_y || direction != 0);
        return loop;
    }

    Intervals across_, down_;
    std::size_t columns_, rows_;
    std::vector<std::uint8_t> cells_;
};

}  // namespace detail

/// The borders of what a mask covers.
struct Contours {
    std::vector<Loop> loops;  ///< outer borders and those of holes, in no order that means anything
    double area = 0;          ///< px^2 inside of them
    double length = 0;        ///< px along them, less what steps take more than slopes of all directions do on average
};

/// The contours of a mask whose pixels are grown by `margin` units to all sides, as far as the image goes. Without `holes` these
/// are filled, with all that is in them. Widths and heights of 1 to 65536.
[[nodiscard]] inline Contours contours_of(const Mask& mask, int margin, bool holes) {
    detail::Cells cells(mask, margin);
    cells.fill_corners();
    if (!holes) cells.fill_holes();
    Contours contours{cells.borders(), cells.double_area() / (2.0 * units_per_px * units_per_px), 0};
    constexpr double slopes = 0.785398163397448;  // pi / 4: steps are longer by the mean of |cos| + |sin|
    for (const Loop& loop : contours.loops)
        for (std::size_t i = 0; i < loop.size(); ++i) {
            const GridPoint a = loop[i], b = loop[(i + 1) % loop.size()];
            contours.length += slopes / units_per_px * (std::abs(b.x - a.x) + std::abs(b.y - a.y));
        }
    return contours;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_OUTLINE_CONTOUR_HPP
