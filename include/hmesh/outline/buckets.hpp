/// \file
/// Buckets: a grid of squares that finds sides of polygons, and points, by where they are.
#ifndef HMESH_OUTLINE_BUCKETS_HPP
#define HMESH_OUTLINE_BUCKETS_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/outline/contour.hpp"
#include "hmesh/outline/grid_geometry.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// Numbers of sides or points in the squares that they touch. Adding and removing takes as long as a side is in squares.
class Buckets {
  public:
    /// For about `count` sides within `box`.
    Buckets(const GridBox& box, std::size_t count) : left_(box.left), top_(box.top) {
        const double width = std::max(1.0, static_cast<double>(box.right) - box.left);
        const double height = std::max(1.0, static_cast<double>(box.bottom) - box.top);
        size_ = std::max(1.0, std::sqrt(width * height / static_cast<double>(std::max<std::size_t>(1, count))));
        size_ = std::max(size_, std::max(width, height) / 2048);
        columns_ = static_cast<std::size_t>(width / size_) + 1;
        rows_ = static_cast<std::size_t>(height / size_) + 1;
        squares_.resize(columns_ * rows_);
    }

    /// Adds the side from a to b, or a point twice.
    void add(std::uint32_t number, GridPoint a, GridPoint b) {
        for_each_square(a, b, [&](std::vector<std::uint32_t>& square) { square.push_back(number); });
    }
    /// Removes what was added so.
    void remove(std::uint32_t number, GridPoint a, GridPoint b) {
        for_each_square(a, b, [&](std::vector<std::uint32_t>& square) {
            const auto found = std::find(square.begin(), square.end(), number);
            if (found != square.end()) *found = square.back(), square.pop_back();
        });
    }
    /// Calls body(number) for all that may touch the box, some of them more than once, until it returns false. Whether it never
    /// did.
    template <class Body>
    bool visit(const GridBox& box, Body&& body) const {
        const std::size_t last_column = column(box.right), last_row = row(box.bottom);
        for (std::size_t j = row(box.top); j <= last_row; ++j)
            for (std::size_t i = column(box.left); i <= last_column; ++i)
                for (const std::uint32_t number : squares_[j * columns_ + i])
                    if (!body(number)) return false;
        return true;
    }

  private:
    [[nodiscard]] static std::size_t place(double at, std::size_t count) noexcept {
        return static_cast<std::size_t>(std::max(0.0, std::min(static_cast<double>(count - 1), std::floor(at))));
    }
    [[nodiscard]] std::size_t column(double x) const noexcept { return place((x - left_) / size_, columns_); }
    [[nodiscard]] std::size_t row(double y) const noexcept { return place((y - top_) / size_, rows_); }

    // Row after row of squares, those between the places where the side enters and leaves the row, and a unit around them.
    template <class Body>
    void for_each_square(GridPoint a, GridPoint b, Body&& body) {
        if (b.y < a.y) std::swap(a, b);
        const std::size_t last = row(b.y);
        for (std::size_t j = row(a.y); j <= last; ++j) {
            double from = a.x, to = b.x;
            if (b.y > a.y) {
                const double slope = (static_cast<double>(b.x) - a.x) / (static_cast<double>(b.y) - a.y);
                const auto at = [&](double y) { return a.x + slope * (std::max<double>(a.y, std::min<double>(b.y, y)) - a.y); };
                from = at(top_ + static_cast<double>(j) * size_ - 1);
                to = at(top_ + static_cast<double>(j + 1) * size_ + 1);
            }
            const std::size_t end = column(std::max(from, to) + 1);
            for (std::size_t i = column(std::min(from, to) - 1); i <= end; ++i) body(squares_[j * columns_ + i]);
        }
    }

    double left_, top_, size_ = 1;
    std::size_t columns_ = 1, rows_ = 1;
    std::vector<std::vector<std::uint32_t>> squares_;
};

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_OUTLINE_BUCKETS_HPP
