// hmesh-terrain - a run: from the file of heights to those of its tiles.
#ifndef HMESH_TERRAIN_RUN_HPP
#define HMESH_TERRAIN_RUN_HPP

#include "terrain/arguments.hpp"

namespace terrain {

// Says how it went, in a summary or in a sentence on the standard error. Returns the exit status.
[[nodiscard]] int run(const Arguments& arguments);

}  // namespace terrain

#endif  // HMESH_TERRAIN_RUN_HPP
