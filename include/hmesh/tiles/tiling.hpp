/// \file
/// Tiling: a cut of the image into rectangular tiles, each of which becomes a patch and a piece of work (tiles/patch.hpp).
/// TileGrid: where its lines lie, for all phases.
#ifndef HMESH_TILES_TILING_HPP
#define HMESH_TILES_TILING_HPP

#include <algorithm>
#include <array>
#include <cstddef>

#include "hmesh/core/array.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/mesh/geometry.hpp"
#include "hmesh/mesh/periodic.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// Where the lines of tilings lie, and with them those that move by half a tile. The places along an axis are 4 n + 1 for n
/// tiles, in px, ascending from 0 to the side of the image, at steps of a quarter of a tile.
class TileGrid {
  public:
    /// Tiles of nearly equal sides of about `tile` > 0 px.
    HMESH_COLD TileGrid(int width, int height, double tile) : even_x_(even(width, tile)), y_(even(height, tile)) {}
    /// As many, of which rows, and tiles within a row, hold about as many of `points` each, which are of the image: at most 1.25
    /// times the mean, and for tiles 1.25 times that of the row, where no half of a tile would get narrower than half of what
    /// equal ones have. So threads that work on a few tiles end together. O(rows * points).
    HMESH_COLD TileGrid(int width, int height, double tile, const Array<Point>& points) : TileGrid(width, height, tile) {
        balance(y_, points, &Point::y, &Point::x, 0, width);
        for (const bool shift : {false, true}) {
            Array<int> rows, &row_places = x_[shift ? 1 : 0];
            add_y(shift, false, rows);
            for (std::size_t row = 0; row + 1 < rows.size(); ++row) {
                Array<int> places = even_x_;
                balance(places, points, &Point::x, &Point::y, rows[row], rows[row + 1]);
                row_places.insert(row_places.end(), places.begin(), places.end());
            }
        }
    }
    /// Adds the lines between rows, with the image's sides: shifted by half a tile or not, and as they go around an axis that
    /// `wraps`, which is of equal tiles.
    void add_y(bool shift, bool wraps, Array<int>& lines) const { add_lines(y_.data(), y_.size(), shift, wraps, lines); }
    /// Adds the lines within this row of the tiling that is shifted along y or not, likewise.
    void add_x(std::size_t row, bool shift_y, bool shift, bool wraps, Array<int>& lines) const {
        const Array<int>& rows = x_[shift_y ? 1 : 0];
        const std::size_t count = even_x_.size();
        add_lines(rows.empty() ? even_x_.data() : rows.data() + row * count, count, shift, wraps, lines);
    }

  private:
    HMESH_COLD static void add_lines(const int* places, std::size_t count, bool shift, bool wraps, Array<int>& lines) {
        const std::size_t first = wraps ? (shift ? 3 : 1) : shift && count > 5 ? 2 : 4;
        const int begin = wraps ? places[first] : 0, end = begin + places[count - 1];
        lines.push_back(begin);
        // Where tiles are about a pixel wide, rounding may bring two lines together: one of them is left out.
        for (std::size_t k = first; k + 1 < count; k += 4)
            if (places[k] > lines.back() && places[k] < end) lines.push_back(places[k]);
        lines.push_back(end);
    }
    /// Places at equal distances.
    [[nodiscard]] HMESH_COLD static Array<int> even(int size, double tile) {
        const int count = std::max(1, static_cast<int>(std::min(65536.0, size / tile + 0.5)));
        Array<int> at(4 * static_cast<std::size_t>(count) + 1);
        for (std::size_t k = 0; k < at.size(); ++k) at[k] = static_cast<int>(size * static_cast<double>(k) / (4.0 * count) + 0.5);
        return at;
    }
    /// Moves places `along` an axis from equal distances to equal shares of a mass, of which 0.8 is that of the points in
    /// [low, high) `across` it, and the rest is spread evenly, as far as no distance of half a tile is halved.
    HMESH_COLD static void balance(Array<int>& places, const Array<Point>& points, double Point::*along, double Point::*across,
                                   int low, int high) {
        const auto size = static_cast<std::size_t>(places.back()), steps = places.size() - 1;
        const double step = static_cast<double>(size) / static_cast<double>(steps);
        Array<double> mass(size + 1, 0.0), wanted(steps + 1, static_cast<double>(size));
        double count = 0, before = 0, moved = 1;  // how much of the way from equal distances is gone
        for (const Point& p : points)
            if (p.*across >= low && p.*across < high) ++mass[static_cast<std::size_t>(p.*along)], ++count;
        if (count == 0) return;
        const double rest = 0.25 * count / static_cast<double>(size), share = 1.25 * count / static_cast<double>(steps);
        std::size_t k = 0;
        for (std::size_t px = 0; px < size; ++px) {
            const double here = mass[px] + rest;
            for (; k < steps && before + here >= share * static_cast<double>(k); ++k)
                wanted[k] = static_cast<double>(px) + (share * static_cast<double>(k) - before) / here;
            before += here;
        }
        for (k = 2; k <= steps; k += 2)
            if (const double gap = wanted[k] - wanted[k - 2]; gap < step) moved = std::min(moved, step / (2 * step - gap));
        for (k = 0; k < steps; ++k)
            places[k] = static_cast<int>((1 - moved) * step * static_cast<double>(k) + moved * wanted[k] + 0.5);
    }

    Array<int> even_x_;              ///< places in rows of equal tiles
    Array<int> y_;                   ///< places of the lines between rows
    std::array<Array<int>, 2> x_{};  ///< places in each row, one after another, of a tiling that is not or is shifted along y;
                                     ///< empty: those of equal tiles
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
    HMESH_COLD explicit Tiling(const TileGrid& grid, bool shift_x = false, bool shift_y = false,
                               Periodic periodic = Periodic::none) {
        grid.add_y(shift_y, wraps_y(periodic), lines_);
        rows_ = lines_.size() - 1;
        lines_.resize(2 * rows_ + 2);
        for (std::size_t j = 0; j < rows_; ++j) {
            lines_[rows_ + 1 + j] = static_cast<int>(lines_.size());
            grid.add_x(j, shift_y, shift_x, wraps_x(periodic), lines_);
        }
        lines_[2 * rows_ + 1] = static_cast<int>(lines_.size());
    }

    [[nodiscard]] int left() const noexcept { return x(0)[0]; }        ///< x_0, px; not 0 only along axes of a periodic image
    [[nodiscard]] int top() const noexcept { return lines_.front(); }  ///< y_0, px; likewise
    /// The number of tiles in a row.
    [[nodiscard]] std::size_t columns(std::size_t row = 0) const noexcept { return first(row + 1) - first(row); }
    /// The number of rows.
    [[nodiscard]] std::size_t rows() const noexcept { return rows_; }
    /// The number of tiles.
    [[nodiscard]] std::size_t size() const noexcept { return first(rows_); }
    /// The pixels of tile number `tile` < size(). O(rows()).
    [[nodiscard]] HMESH_COLD Rect rect(std::size_t tile) const noexcept {
        std::size_t j = 0;
        while (first(j + 1) <= tile) ++j;
        const int *const line = x(j) + (tile - first(j)), *const y = lines_.data() + j;
        return {line[0], y[0], line[1] - line[0], y[1] - y[0]};
    }
    /// The number of the tile that holds p, in px of the image; points beyond the image belong to the nearest tile. O(log
    /// size()).
    [[nodiscard]] std::size_t tile_at(Point p) const noexcept {
        const std::size_t j = find(lines_.data(), rows_, p.y);
        return first(j) + find(x(j), columns(j), p.x);
    }

    /// Whether the lines are the same.
    [[nodiscard]] friend bool operator==(const Tiling& a, const Tiling& b) noexcept { return a.lines_ == b.lines_; }
    [[nodiscard]] friend bool operator!=(const Tiling& a, const Tiling& b) noexcept { return !(a == b); }  ///< whether not

  private:
    /// The lines within row j.
    [[nodiscard]] const int* x(std::size_t j) const noexcept { return lines_.data() + lines_[rows_ + 1 + j]; }
    /// The number of the first tile of row j <= rows(): in each row there are as many lines and one more.
    [[nodiscard]] std::size_t first(std::size_t j) const noexcept {
        return static_cast<std::size_t>(lines_[rows_ + 1 + j]) - 2 * (rows_ + 1) - j;
    }
    /// Which of `count` intervals between lines holds x.
    [[nodiscard]] static std::size_t find(const int* at, std::size_t count, double x) noexcept {
        const auto after = std::upper_bound(at + 1, at + count, x, [](double a, int b) { return a < b; });
        return static_cast<std::size_t>(after - at) - 1;
    }
    std::size_t rows_;
    /// In px, the lines between rows; then where in this array those within each row begin, and its end; then these.
    Array<int> lines_;
};

/// The tilings of phases, of which four take turns: every place is off the lines of one of them at least, and off those of the
/// first or the second, but for where lines of both cross.
class Tilings {
  public:
    /// Of nearly equal tiles with sides of about `tile` > 0 px.
    HMESH_COLD Tilings(int width, int height, double tile, Periodic periodic = Periodic::none)
        : Tilings(TileGrid(width, height, tile), periodic) {}
    /// Along the lines of a grid.
    HMESH_COLD explicit Tilings(const TileGrid& grid, Periodic periodic = Periodic::none)
        : of_phase_{Tiling(grid, false, false, periodic), Tiling(grid, true, true, periodic), Tiling(grid, true, false, periodic),
                    Tiling(grid, false, true, periodic)} {}
    /// That of phase number `phase` >= 0.
    [[nodiscard]] const Tiling& operator[](int phase) const noexcept { return of_phase_[static_cast<std::size_t>(phase & 3)]; }

  private:
    std::array<Tiling, 4> of_phase_;
};

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_TILES_TILING_HPP
