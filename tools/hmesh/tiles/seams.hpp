// tools - whether tiles meet: neighbours have the same vertices and colours along their common row of samples, bit for bit.
#ifndef HMESH_TOOLS_TILES_SEAMS_HPP
#define HMESH_TOOLS_TILES_SEAMS_HPP

#include <cstdint>
#include <string>

#include "tiles/plan.hpp"

namespace tool {

struct TileSeams {
    std::int64_t pairs = 0;   // of neighbours
    std::int64_t shared = 0;  // vertices that are the same, of all pairs
    std::int64_t open = 0;    // vertices of a pair that the other has not
    std::string first;        // "tile_0_0000_0000 and tile_0_0001_0000": the first open pair
};

// Of the tiles of a level's row from west to east and with the row below it. Returns "" or what is wrong, a sentence.
[[nodiscard]] std::string find_seams(const TilePlan& plan, int level, int y, TileSeams& seams);

}  // namespace tool

#endif  // HMESH_TOOLS_TILES_SEAMS_HPP
