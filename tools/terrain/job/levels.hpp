// hmesh-terrain - Level: a level of detail, a model of its own: of every 2nd, 4th, 8th .. sample, within 2, 4, 8 .. times the
// bound. So tiles of each have as many samples as those of the finest, and meet by what makes those meet.
//
// The bound of a level is kept at its own samples. What lies between them may be further off: that is measured.
#ifndef HMESH_TERRAIN_JOB_LEVELS_HPP
#define HMESH_TERRAIN_JOB_LEVELS_HPP

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "terrain/arguments.hpp"
#include "terrain/dem.hpp"
#include "terrain/frame.hpp"
#include "terrain/tiles.hpp"
#include "terrain/written/surface.hpp"

namespace terrain {

struct Level {
    int across = 0, down = 0;   // tiles from the west and from the north
    int step = 1;               // a sample of this level is every so manyth of the input, along both axes
    int column = 0, row = 0;    // in the input, of the first one
    int width = 0, height = 0;  // samples
    Arguments arguments;        // of its tiles
    Frame frame;                // in which its samples stand
};

// Where the tiles of the finest level are among those of Cesium's, which cut the degrees in halves: tile (x, y) of it is tile
// (west + x, north - y) of this zoom.
struct GlobeGrid {
    int zoom = 0, west = 0, north = 0;
};

// The finest first, at most so many: fewer where samples are too few for one cell, or, of Cesium's grid, no tile of the next
// one is within the input.
[[nodiscard]] std::vector<Level> find_levels(const Arguments& arguments, const Frame& frame, int width, int height,
                                             const std::optional<GlobeGrid>& globe, int most);

// The samples of a level of a model that outlives this one.
[[nodiscard]] std::unique_ptr<Dem> thinned(Dem& dem, const Level& level);

// How far the surface of a tile is from all samples of the input that it covers, read in bands of no more samples than the
// tile has. Returns "" or what is wrong, as Dem::read() does.
[[nodiscard]] std::string measure_all(const Level& level, const Tile& tile, Surface surface, Dem& dem, double& max_error);

// How deep walls must hang from the sides of a tile so that no crack to a tile of any other level beside it is seen, in heights
// of the input. Along a row of samples a level is off them by its bound and by what lies between its own samples; a crack is no
// wider than what two levels are off. Of levels of one origin. Returns "" or what is wrong, as Dem::read() does.
[[nodiscard]] std::string find_skirt(const std::vector<Level>& levels, int level, const Tile& tile, Dem& dem, double& depth);

}  // namespace terrain

#endif  // HMESH_TERRAIN_JOB_LEVELS_HPP
