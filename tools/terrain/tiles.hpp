// hmesh-terrain - Tile: a part of a model, meshed by itself, which shares its outermost rows and columns of samples with its
// neighbours; Window: its heights.
#ifndef HMESH_TERRAIN_TILES_HPP
#define HMESH_TERRAIN_TILES_HPP

#include <cstddef>
#include <string>
#include <vector>

#include "hmesh/image/image_view.hpp"
#include "terrain/arguments.hpp"
#include "terrain/dem.hpp"

namespace terrain {

struct Tile {
    TileName name;
    int column = 0, row = 0;    // of its north-western sample
    int width = 0, height = 0;  // samples
    std::string file;
    double skirt = 0;  // how deep walls hang from its sides in .glb, in the file's heights
};

// Of so many samples, tiles of so many cells a side: the last one is what is left. 0 where there is no cell.
[[nodiscard]] constexpr int tiles_along(int samples, int cells) noexcept { return samples < 2 ? 0 : (samples - 2) / cells + 1; }

// Whether so many tiles across and down are no more than a run or a job has. Returns "" or a sentence.
[[nodiscard]] std::string find_too_many(const std::string& input, int across, int down);

// A sample that tiles share is the own one of the north-westernmost of them: the own samples of all tiles are the model's.
[[nodiscard]] constexpr bool is_own(const Tile& tile, int i, int j) noexcept {
    return (i > 0 || tile.column == 0) && (j > 0 || tile.row == 0);
}
[[nodiscard]] constexpr std::size_t own_samples(const Tile& tile) noexcept {
    return static_cast<std::size_t>(tile.width - (tile.column > 0 ? 1 : 0)) *
           static_cast<std::size_t>(tile.height - (tile.row > 0 ? 1 : 0));
}

// One of the tiles of so many cells that so many samples are cut into. It has no file yet.
[[nodiscard]] Tile tile_at(int cells, int width, int height, const TileName& name);

// The tiles that the arguments ask for, row after row from the north; one of all samples without --tiles. Returns "" or what is
// wrong, a sentence.
[[nodiscard]] std::string find_tiles(const Arguments& arguments, const Dem& dem, std::vector<Tile>& tiles);

// The samples of a tile and one more on each side, where there is one: normals are those of the whole model.
struct Window {
    int columns = 0, rows = 0;    // of `heights`
    int left = 0, top = 0;        // the place in it of the tile's first sample, 0 or 1
    int width = 0, height = 0;    // of the tile
    std::vector<float> heights;   // NaN where there is no data
    double rounding = 0;          // the most by which one differs from the file
    std::size_t no_data = 0;      // samples of the tile without data
    std::size_t own_no_data = 0;  // the same of its own
    bool has_cell = false;        // whether four neighbours have data: else there is nothing to mesh
    double low = 0, high = 0;     // of the tile's heights

    // All of it, and the tile alone.
    [[nodiscard]] hmesh::ImageView<float, 1> around() const noexcept { return {heights.data(), columns, rows, 0}; }
    [[nodiscard]] hmesh::ImageView<float, 1> tile() const noexcept {
        return {heights.data() + static_cast<std::size_t>(top) * static_cast<std::size_t>(columns) + left, width, height,
                static_cast<std::ptrdiff_t>(columns) * static_cast<std::ptrdiff_t>(sizeof(float))};
    }
};

// Returns "" or what is wrong, as Dem::read() does.
[[nodiscard]] std::string read_window(Dem& dem, const Tile& tile, Window& window);

// Whether the four samples of a cell, of which (i, j) is the north-western one, have data.
[[nodiscard]] bool has_data(const hmesh::ImageView<float, 1>& heights, int i, int j) noexcept;

}  // namespace terrain

#endif  // HMESH_TERRAIN_TILES_HPP
