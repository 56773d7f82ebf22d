// tools - TileLevel: a level of detail of a job, a mesh of its own, of the image at 1, 1/2, 1/4 .. of its size and with as many
// vertices for its pixels. TileImage makes its samples.
//
// Tiles of all levels have sides of about as many samples. Lines between those of one level are lines of the next finer one too:
// tile (x, y) of it stands within tile (x / 2, y / 2).
#ifndef HMESH_TOOLS_TILES_LEVELS_HPP
#define HMESH_TOOLS_TILES_LEVELS_HPP

#include <cstddef>
#include <vector>

namespace tool {

struct TileLevel {
    int step = 1;  // px of the image from one sample of the level to the next
    int width = 0, height = 0;
    std::size_t vertices = 0;        // of the whole
    std::vector<int> columns, rows;  // samples on the lines between tiles, the first and the last sample included

    [[nodiscard]] int across() const noexcept { return static_cast<int>(columns.size()) - 1; }
    [[nodiscard]] int down() const noexcept { return static_cast<int>(rows.size()) - 1; }
    [[nodiscard]] std::size_t tile_count() const noexcept { return (columns.size() - 1) * (rows.size() - 1); }
};

// The finest first; at most `most` of them, fewer where the next one would have a side of a single sample. Tiles are of at most
// `tile` samples from line to line. An image of 2 x 2 px or more.
[[nodiscard]] std::vector<TileLevel> find_levels(int width, int height, std::size_t vertices, int tile, int most);

}  // namespace tool

#endif  // HMESH_TOOLS_TILES_LEVELS_HPP
