// tools - a finished job of `hmesh job` as one file, or as a folder of tiles.
#ifndef HMESH_TOOLS_TILES_JOIN_HPP
#define HMESH_TOOLS_TILES_JOIN_HPP

#include <string>

#include "tiles/plan.hpp"

namespace tool {

// What returns a string returns "" or what is wrong, a sentence.

// One file of a format that the command writes, by its ending: vertices of seams stand in it once. The whole mesh is in memory,
// and the tiles one at a time.
[[nodiscard]] std::string join_into_file(const TilePlan& plan, const std::string& output, std::string& said);

// A folder with a file for each tile, in the place that the tile has in the whole, or of .hmc files as the job has them, from the
// tile's own corner; and index.json, last, which says what they are. Tiles are in memory one at a time.
[[nodiscard]] std::string join_into_folder(const TilePlan& plan, const std::string& output, const std::string& ending,
                                           std::string& said);

}  // namespace tool

#endif  // HMESH_TOOLS_TILES_JOIN_HPP
