#include "terrain/tiles.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>

namespace terrain {
namespace {

constexpr std::int64_t most_tiles = 1000000;

// NAME_x_y.glb beside NAME.glb.
std::string tile_file(const std::string& output, const TileName& name) {
    const std::filesystem::path path(output);
    const std::string file =
        path.stem().string() + "_" + std::to_string(name.x) + "_" + std::to_string(name.y) + path.extension().string();
    return (path.parent_path() / file).string();
}

// Whether windows of tiles are no larger than images that become meshes, before any is read. Returns "" or a sentence.
std::string find_too_large(const Arguments& arguments, const Dem& dem) {
    const int cells = arguments.tile;
    const auto longest = [&](int samples) {
        const int tiles = cells == 0 ? 1 : tiles_along(samples, cells);
        return std::int64_t{tiles == 1 ? samples : cells + std::min(tiles, 3)};  // two tiles have a neighbour each, others two
    };
    const std::int64_t wide = longest(dem.width), high = longest(dem.height);
    if (std::max(wide, high) <= hmesh::kit::max_side && wide * high <= hmesh::kit::max_pixels) return {};
    return "'" + arguments.input + "' has " + (cells == 0 ? "" : "tiles of ") + std::to_string(wide) + " x " +
           std::to_string(high) + " samples" + (cells == 0 ? "" : ", those beside them counted") + ", more than " +
           std::to_string(hmesh::kit::max_side) + " a side or " + std::to_string(hmesh::kit::max_pixels) +
           " in all: --tiles cuts it smaller";
}

}  // namespace

std::string find_too_many(const std::string& input, int across, int down) {
    const std::int64_t count = std::int64_t{across} * down;
    if (count <= most_tiles) return {};
    return "'" + input + "' would be " + std::to_string(count) + " tiles, more than " + std::to_string(most_tiles) +
           ": take larger ones by --tiles";
}

Tile tile_at(int cells, int width, int height, const TileName& name) {
    Tile tile;
    tile.name = name;
    tile.column = name.x * cells;
    tile.row = name.y * cells;
    tile.width = std::min(cells + 1, width - tile.column);
    tile.height = std::min(cells + 1, height - tile.row);
    return tile;
}

std::string find_tiles(const Arguments& arguments, const Dem& dem, std::vector<Tile>& tiles) {
    if (dem.width < 2 || dem.height < 2)
        return "'" + arguments.input + "' has " + std::to_string(dem.width) + " x " + std::to_string(dem.height) +
               " samples, and a surface has at least 2 x 2";
    if (std::string why = find_too_large(arguments, dem); !why.empty()) return why;
    tiles.clear();
    if (arguments.tile == 0) {
        tiles.push_back({{}, 0, 0, dem.width, dem.height, arguments.output});
        return {};
    }
    const int across = tiles_along(dem.width, arguments.tile), down = tiles_along(dem.height, arguments.tile);
    const auto add = [&](const TileName& name) {
        tiles.push_back(tile_at(arguments.tile, dem.width, dem.height, name));
        tiles.back().file = tile_file(arguments.output, name);
    };
    for (const TileName& name : arguments.only) {
        if (name.x >= across || name.y >= down)
            return "--only '" + std::to_string(name.x) + "_" + std::to_string(name.y) + "' is not one of the " +
                   std::to_string(across) + " x " + std::to_string(down) + " tiles of '" + arguments.input + "'";
        const std::string file = tile_file(arguments.output, name);  // a tile named twice is made once
        if (std::none_of(tiles.begin(), tiles.end(), [&](const Tile& tile) { return tile.file == file; })) add(name);
    }
    if (!tiles.empty()) return {};
    if (std::string why = find_too_many(arguments.input, across, down); !why.empty()) return why;
    for (int y = 0; y < down; ++y)
        for (int x = 0; x < across; ++x) add({x, y});
    return {};
}

std::string read_window(Dem& dem, const Tile& tile, Window& window) {
    const int west = std::max(0, tile.column - 1), north = std::max(0, tile.row - 1);
    const int east = std::min(dem.width - 1, tile.column + tile.width) + 1;
    const int south = std::min(dem.height - 1, tile.row + tile.height) + 1;
    window = {};
    window.columns = east - west;
    window.rows = south - north;
    window.left = tile.column - west;
    window.top = tile.row - north;
    window.width = tile.width;
    window.height = tile.height;
    window.heights.resize(static_cast<std::size_t>(window.columns) * static_cast<std::size_t>(window.rows));
    if (std::string why = dem.read(west, north, window.columns, window.rows, window.heights.data(), window.rounding);
        !why.empty())
        return why;
    const hmesh::ImageView<float, 1> view = window.tile();
    bool has_height = false;
    for (int j = 0; j < tile.height; ++j)
        for (int i = 0; i < tile.width; ++i) {
            const float height = *view.pixel(i, j);
            if (std::isnan(height)) {
                ++window.no_data;
                window.own_no_data += is_own(tile, i, j) ? 1 : 0;
                continue;
            }
            const auto value = static_cast<double>(height);
            window.low = has_height ? std::min(window.low, value) : value;
            window.high = has_height ? std::max(window.high, value) : value;
            has_height = true;
            window.has_cell = window.has_cell || (i + 1 < tile.width && j + 1 < tile.height && has_data(view, i, j));
        }
    return {};
}

bool has_data(const hmesh::ImageView<float, 1>& heights, int i, int j) noexcept {
    const float *const upper = heights.pixel(i, j), *const lower = heights.pixel(i, j + 1);
    return !std::isnan(upper[0]) && !std::isnan(upper[1]) && !std::isnan(lower[0]) && !std::isnan(lower[1]);
}

}  // namespace terrain
