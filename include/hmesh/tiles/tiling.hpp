/// \file
/// Tiling: a cut of the image into rectangular tiles, each of which becomes a patch and a piece of work (tiles/patch.hpp).
/// TileGrid: where its lines lie, for all phases.
#ifndef HMESH_TILES_TILING_HPP
#define HMESH_TILES_TILING_HPP

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "hmesh/core/array.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/mesh/geometry.hpp"
#include "hmesh/mesh/periodic.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// Where the lines of tilings lie, and with them those that move by half a tile: the places along an axis are 2 n + 1 for n
/// tiles, in px, ascending from 0 to the side of the image, at steps of half a tile.
struct TileGrid {
    Array<int> y;                              ///< places of the lines between rows
    std::array<std::vector<Array<int>>, 2> x;  ///< places within each row of a tiling, and of one that is shifted along y

    /// Tiles of nearly equal sides of about `tile` > 0 px.
    TileGrid(int width, int height, double tile) : y(even(height, tile)) { lay_rows(even(width, tile)); }
    /// As many, of which rows, and tiles within a row, hold about as many of `points` each, which are of the image: at most 1.25
    /// times the mean, and for tiles 1.25 times that of the row, where no half of a tile would get narrower than half of what
    /// equal ones have. So threads that work on a few tiles end together. O(n log n).
    TileGrid(int width, int height, double tile, Array<Point> points) : y(even(height, tile)) {
        std::sort(points.begin(), points.end(), [](Point a, Point b) { return a.y < b.y; });
        Array<double> along(points.size());
        for (std::size_t k = 0; k < points.size(); ++k) along[k] = points[k].y;
        balance(y, along);
        lay_rows(even(width, tile));
        for (std::size_t shift = 0; shift < 2; ++shift) {
            const Array<int> rows = lines(y, shift != 0);
            std::size_t k = 0;
            for (std::size_t row = 0; row + 1 < rows.size(); ++row) {
                along.clear();
                for (; k < points.size() && (points[k].y < rows[row + 1] || row + 2 == rows.size()); ++k)
                    along.push_back(points[k].x);
                std::sort(along.begin(), along.end());
                balance(x[shift][row], along);
            }
        }
    }
    /// The lines of a tiling along an axis with these places.
    [[nodiscard]] static Array<int> lines(const Array<int>& places, bool shift) {
        Array<int> at{0};
        // Where tiles are about a pixel wide, rounding may bring two lines together: one of them is left out.
        for (std::size_t k = shift && places.size() > 3 ? 1 : 2; k + 1 < places.size(); k += 2)
            if (places[k] > at.back() && places[k] < places.back()) at.push_back(places[k]);
        at.push_back(places.back());
        return at;
    }

  private:
    /// Gives each row these places.
    void lay_rows(const Array<int>& places) {
        for (std::size_t shift = 0; shift < 2; ++shift) x[shift].assign(lines(y, shift != 0).size() - 1, places);
    }
    /// Places at equal distances.
    [[nodiscard]] static Array<int> even(int size, double tile) {
        const int count = std::max(1, static_cast<int>(std::min(65536.0, size / tile + 0.5)));
        Array<int> at(2 * static_cast<std::size_t>(count) + 1);
        for (std::size_t k = 0; k < at.size(); ++k) at[k] = static_cast<int>(size * static_cast<double>(k) / (2.0 * count) + 0.5);
        return at;
    }
    /// Moves places from equal distances to equal shares of a mass, of which 0.8 is that of the points, which are sorted, and the
    /// rest is spread evenly, as far as no distance is halved.
    static void balance(Array<int>& places, const Array<double>& points) {
        constexpr double share = 0.8;
        if (points.empty()) return;
        const double size = places.back(), steps = static_cast<double>(places.size() - 1), step = size / steps;
        Array<double> wanted(places.size(), 0.0);
        std::size_t before = 0;  // points
        for (std::size_t k = 1; k + 1 < places.size(); ++k) {
            const auto mass = [&](double to, std::size_t count) {
                return share * static_cast<double>(count) / static_cast<double>(points.size()) + (1 - share) * to / size;
            };
            const double goal = static_cast<double>(k) / steps;
            while (before < points.size() && mass(points[before], before + 1) <= goal) ++before;
            // The mass passes the goal between two points, where the rest rises, or at one.
            const double x = (goal - mass(0, before)) * size / (1 - share);
            wanted[k] = before < points.size() ? std::min(x, points[before]) : x;
        }
        wanted.back() = size;
        double moved = 1;  // of the way
        for (std::size_t k = 1; k < places.size(); ++k)
            if (const double gap = wanted[k] - wanted[k - 1]; gap < step / 2) moved = std::min(moved, step / 2 / (step - gap));
        for (std::size_t k = 1; k + 1 < places.size(); ++k)
            places[k] = static_cast<int>((1 - moved) * static_cast<double>(k) * step + moved * wanted[k] + 0.5);
    }
};

/// The image's plane cut by horizontal lines y_0 = 0 < y_1 < ..., and each row by vertical lines x_0 = 0 < x_1 < ..., at whole
/// pixels. Tile (i, j) is [x_i, x_(i+1)) times [y_j, y_(j+1)), by the x of row j; tiles are numbered row after row. Of a periodic
/// image x_0 and y_0 may be larger: the last tile goes on beyond the image then, where its first pixels come again.
class Tiling {
  public:
    /// Cuts an image of width * height px into tiles of nearly equal sides of about `tile` > 0 px. `shift_x` and `shift_y` move
    /// the lines by half a tile, so that tiles at these borders have half the width or height; one tile alone is not shifted.
    /// Along the axes of a `periodic` image there is no border: all tiles have their size, one alone is shifted too, and lines
    /// are a quarter of a tile off x = 0 and y = 0, where the mesh may have to run along a seam (Options::straight_border).
    Tiling(int width, int height, double tile, bool shift_x = false, bool shift_y = false, Periodic periodic = Periodic::none)
        : Tiling(TileGrid(width, height, tile), shift_x, shift_y, periodic) {}
    /// The same along the lines of a grid, whose tiles are equal if the image is periodic.
    explicit Tiling(const TileGrid& grid, bool shift_x = false, bool shift_y = false, Periodic periodic = Periodic::none)
        : y_(wraps_y(periodic) ? around(grid.y, shift_y) : TileGrid::lines(grid.y, shift_y)) {
        for (std::size_t row = 0; row < rows(); ++row) {
            const Array<int>& places = grid.x[shift_y ? 1 : 0][wraps_y(periodic) ? 0 : row];
            x_.push_back(wraps_x(periodic) ? around(places, shift_x) : TileGrid::lines(places, shift_x));
            first_.push_back(first_.back() + x_.back().size() - 1);
        }
    }

    [[nodiscard]] int left() const noexcept {
        return x_.front().front();
    }                                                              ///< x_0, px; not 0 only along axes of a periodic image
    [[nodiscard]] int top() const noexcept { return y_.front(); }  ///< y_0, px; likewise
    /// The number of tiles in a row.
    [[nodiscard]] std::size_t columns(std::size_t row = 0) const noexcept { return x_[row].size() - 1; }
    /// The number of rows.
    [[nodiscard]] std::size_t rows() const noexcept { return y_.size() - 1; }
    /// The number of tiles.
    [[nodiscard]] std::size_t size() const noexcept { return first_.back(); }
    /// The pixels of tile number `tile` < size(). O(log rows()).
    [[nodiscard]] Rect rect(std::size_t tile) const noexcept {
        const auto after = std::upper_bound(first_.begin(), first_.end(), tile);
        const std::size_t j = static_cast<std::size_t>(after - first_.begin()) - 1, i = tile - first_[j];
        return {x_[j][i], y_[j], x_[j][i + 1] - x_[j][i], y_[j + 1] - y_[j]};
    }
    /// The number of the tile that holds p, in px of the image; points beyond the image belong to the nearest tile. O(log
    /// size()).
    [[nodiscard]] std::size_t tile_at(Point p) const noexcept {
        const std::size_t j = find(y_, p.y);
        return first_[j] + find(x_[j], p.x);
    }

    /// Whether the lines are the same.
    [[nodiscard]] friend bool operator==(const Tiling& a, const Tiling& b) noexcept { return a.x_ == b.x_ && a.y_ == b.y_; }
    [[nodiscard]] friend bool operator!=(const Tiling& a, const Tiling& b) noexcept { return !(a == b); }  ///< whether not

  private:
    /// The lines around an axis that repeats, of equal tiles, from the first line on as far as the image's side.
    [[nodiscard]] static Array<int> around(const Array<int>& places, bool shift) {
        const int size = places.back();
        const std::size_t count = places.size() / 2;
        const auto line = [&](double k) { return static_cast<int>(size * k / static_cast<double>(count) + 0.5); };
        const double first = shift ? 0.75 : 0.25;
        Array<int> at{line(first)};
        for (std::size_t k = 1; k <= count; ++k)
            if (const int next = k == count ? at.front() + size : line(static_cast<double>(k) + first); next > at.back())
                at.push_back(next);
        return at;
    }
    /// The index of the interval of `at` that holds x.
    [[nodiscard]] static std::size_t find(const Array<int>& at, double x) noexcept {
        const auto after = std::upper_bound(at.begin() + 1, at.end() - 1, x, [](double a, int b) { return a < b; });
        return static_cast<std::size_t>(after - at.begin()) - 1;
    }
    Array<int> y_;                       ///< the lines between rows, px
    std::vector<Array<int>> x_;          ///< those in each row
    std::vector<std::size_t> first_{0};  ///< the number of each row's first tile, and of all tiles
};

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_TILES_TILING_HPP
