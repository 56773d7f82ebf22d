// hmesh-terrain - a finished job as one file, or as a folder of tiles.
#ifndef HMESH_TERRAIN_JOB_JOIN_HPP
#define HMESH_TERRAIN_JOB_JOIN_HPP

#include <cstdint>
#include <string>

#include "terrain/job/plan.hpp"

namespace terrain {

// One .ply, .obj or .glb: vertices that tiles share stand in it once. Tiles are read three times, one at a time; of the rest the
// vertices of seams are in memory alone. Returns "" or what is wrong, a sentence: then the file is not written.
[[nodiscard]] std::string join_into_file(const Plan& plan, const std::string& output, std::string& said);

// The job's folder tiles/ as another one: its files whole, their index last. Files of it that are the same are left as they are.
[[nodiscard]] std::string join_into_folder(const Plan& plan, const std::string& output, std::string& said);

}  // namespace terrain

#endif  // HMESH_TERRAIN_JOB_JOIN_HPP
