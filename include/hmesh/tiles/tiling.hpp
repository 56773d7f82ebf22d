/// \file
/// Tiling: a cut of the image into rectangular tiles, each of which becomes a patch and a piece of work (tiles/patch.hpp).
#ifndef HMESH_TILES_TILING_HPP
#define HMESH_TILES_TILING_HPP

#include <algorithm>
#include <cstddef>

#include "hmesh/core/array.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/mesh/geometry.hpp"
#include "hmesh/mesh/periodic.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// The image's plane cut by vertical lines x_0 = 0 < x_1 < ... and horizontal lines y_0 = 0 < y_1 < ... at whole pixels. Tile
/// (i, j) is [x_i, x_(i+1)) times [y_j, y_(j+1)); tiles are numbered row after row. Of a periodic image x_0 and y_0 may be
/// larger: the last tile goes on beyond the image then, where its first pixels come again.
class Tiling {
  public:
    /// Cuts an image of width * height px into tiles of nearly equal sides of about `tile` > 0 px. `shift_x` and `shift_y` move
    /// the lines by half a tile, so that tiles at these borders have half the width or height; one tile alone is not shifted.
    /// Along the axes of a `periodic` image there is no border: all tiles have their size, one alone is shifted too, and lines
    /// are a quarter of a tile off x = 0 and y = 0, where the mesh may have to run along a seam (Options::straight_border).
    Tiling(int width, int height, double tile, bool shift_x = false, bool shift_y = false, Periodic periodic = Periodic::none)
        : x_(lines(width, tile, shift_x, wraps_x(periodic))), y_(lines(height, tile, shift_y, wraps_y(periodic))) {}

    [[nodiscard]] int left() const noexcept { return x_.front(); }  ///< x_0, px; not 0 only along axes of a periodic image
    [[nodiscard]] int top() const noexcept { return y_.front(); }   ///< y_0, px; likewise
    /// The number of tiles in a row.
    [[nodiscard]] std::size_t columns() const noexcept { return x_.size() - 1; }
    /// The number of tiles in a column.
    [[nodiscard]] std::size_t rows() const noexcept { return y_.size() - 1; }
    /// The number of tiles.
    [[nodiscard]] std::size_t size() const noexcept { return columns() * rows(); }
    /// The pixels of tile number `tile` < size().
    [[nodiscard]] Rect rect(std::size_t tile) const noexcept {
        const std::size_t i = tile % columns(), j = tile / columns();
        return {x_[i], y_[j], x_[i + 1] - x_[i], y_[j + 1] - y_[j]};
    }
    /// The number of the tile that holds p, in px of the image; points beyond the image belong to the nearest tile. O(log
    /// size()).
    [[nodiscard]] std::size_t tile_at(Point p) const noexcept { return find(y_, p.y) * columns() + find(x_, p.x); }

    /// Whether the lines are the same.
    [[nodiscard]] friend bool operator==(const Tiling& a, const Tiling& b) noexcept { return a.x_ == b.x_ && a.y_ == b.y_; }
    [[nodiscard]] friend bool operator!=(const Tiling& a, const Tiling& b) noexcept { return !(a == b); }  ///< whether not

  private:
    /// The lines across a side of `size` px, from 0 to `size`; where it `wraps`, from the first line on as far.
    [[nodiscard]] static Array<int> lines(int size, double tile, bool shift, bool wraps) {
        const int count = std::max(1, static_cast<int>(std::min(65536.0, size / tile + 0.5)));
        const auto line = [&](double k) { return static_cast<int>(size * k / count + 0.5); };
        if (wraps) {
            const double first = shift ? 0.75 : 0.25;
            Array<int> at{line(first)};
            for (int k = 1; k <= count; ++k)
                if (const int next = k == count ? at.front() + size : line(k + first); next > at.back()) at.push_back(next);
            return at;
        }
        Array<int> at{0};
        // Where tiles are about a pixel wide, rounding may bring two lines together: one of them is left out.
        for (int k = shift && count > 1 ? 0 : 1; k < count; ++k)
            if (const int next = line(shift ? k + 0.5 : k); next > at.back() && next < size) at.push_back(next);
        at.push_back(size);
        return at;
    }
    /// The index of the interval of `at` that holds x.
    [[nodiscard]] static std::size_t find(const Array<int>& at, double x) noexcept {
        const auto after = std::upper_bound(at.begin() + 1, at.end() - 1, x, [](double a, int b) { return a < b; });
        return static_cast<std::size_t>(after - at.begin()) - 1;
    }
    Array<int> x_, y_;  ///< the lines, px
};

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_TILES_TILING_HPP
