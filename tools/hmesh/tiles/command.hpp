// tools - the command `hmesh job`.
#ifndef HMESH_TOOLS_TILES_COMMAND_HPP
#define HMESH_TOOLS_TILES_COMMAND_HPP

#include "arguments/tile_job.hpp"

namespace tool {

// Says how it went, in lines or in a sentence on the standard error. Returns the exit status.
[[nodiscard]] int run_tile_job(const TileJob& arguments);

}  // namespace tool

#endif  // HMESH_TOOLS_TILES_COMMAND_HPP
