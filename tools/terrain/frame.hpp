// hmesh-terrain - Frame: where the samples of a model stand in the coordinates of a file: metres from its south-western
// sample, or degrees.
#ifndef HMESH_TERRAIN_FRAME_HPP
#define HMESH_TERRAIN_FRAME_HPP

#include <array>
#include <optional>
#include <string>

#include "terrain/arguments.hpp"
#include "terrain/dem.hpp"
#include "terrain/tiles.hpp"

namespace terrain {

// Sample (i, j) with height h is at (x_origin + x_step i, y_origin - y_step j, z_offset + z_scale h): in units of the file, local
// metres times --scale, +x to the east, +y to the north.
struct Frame {
    double x_origin = 0, y_origin = 0, x_step = 1, y_step = 1;
    double z_offset = 0, z_scale = 1;
    std::array<double, 2> metres{1, 1};  // in a unit of the map, to the east and to the north
    std::array<double, 2> origin{0, 0};  // in units of the map: where x and y are 0
    std::optional<Extent> extent;        // of the outermost samples, in degrees, where they are known
};

// Returns "" or what is wrong, a sentence.
[[nodiscard]] std::string find_frame(const Arguments& arguments, const Dem& dem, Frame& frame);

// The degrees of the outermost samples of a tile, of a model of so many samples.
[[nodiscard]] Extent extent_of(const Frame& frame, int width, int height, const Tile& tile);

}  // namespace terrain

#endif  // HMESH_TERRAIN_FRAME_HPP
