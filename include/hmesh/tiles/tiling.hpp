/// \file
/// Tiling: the image cut into tiles, the units of work (tiles/patch.hpp).
#ifndef HMESH_TILES_TILING_HPP
#define HMESH_TILES_TILING_HPP

#include <algorithm>
#include <cstddef>
#include <vector>

#include "hmesh/image/image_view.hpp"
#include "hmesh/mesh/geometry.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// The plane cut by vertical and horizontal lines at whole pixels. Tile (i, j) is [lines_x[i], lines_x[i + 1]) times
/// [lines_y[j], lines_y[j + 1]); tiles are numbered row after row.
class Tiling {
  public:
    /// Of an image of this size into tiles as equal as can be, of about `tile` px; shifted by half a tile to the left or
    /// upwards where asked, so that tiles at the border are half as wide.
    Tiling(int width, int height, double tile, bool shift_x = false, bool shift_y = false)
        : x_(lines(width, tile, shift_x)), y_(lines(height, tile, shift_y)) {}

    [[nodiscard]] std::size_t columns() const noexcept { return x_.size() - 1; }
    [[nodiscard]] std::size_t rows() const noexcept { return y_.size() - 1; }
    [[nodiscard]] std::size_t size() const noexcept { return columns() * rows(); }
    /// The pixels of a tile.
    [[nodiscard]] Rect rect(std::size_t tile) const noexcept {
        const std::size_t i = tile % columns(), j = tile / columns();
        return {x_[i], y_[j], x_[i + 1] - x_[i], y_[j + 1] - y_[j]};
    }
    /// The tile that holds a point of the image.
    [[nodiscard]] std::size_t tile_at(Point p) const noexcept { return find(y_, p.y) * columns() + find(x_, p.x); }

  private:
    [[nodiscard]] static std::vector<int> lines(int size, double tile, bool shift) {
        const int count = std::max(1, static_cast<int>(std::min(65536.0, size / tile + 0.5)));
        std::vector<int> at{0};
        const auto line = [&](double k) { return static_cast<int>(size * k / count + 0.5); };
        // Rounding may bring lines together where tiles are of about a pixel: then one of them is left out.
        for (int k = shift && count > 1 ? 0 : 1; k < count; ++k)
            if (const int next = line(shift ? k + 0.5 : k); next > at.back() && next < size) at.push_back(next);
        at.push_back(size);
        return at;
    }
    [[nodiscard]] static std::size_t find(const std::vector<int>& at, double x) noexcept {
        const auto after = std::upper_bound(at.begin() + 1, at.end() - 1, x, [](double a, int b) { return a < b; });
        return static_cast<std::size_t>(after - at.begin()) - 1;
    }
    std::vector<int> x_, y_;
};

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_TILES_TILING_HPP
