// hmesh-terrain - the command `hmesh-terrain job`.
#ifndef HMESH_TERRAIN_JOB_COMMAND_HPP
#define HMESH_TERRAIN_JOB_COMMAND_HPP

#include "terrain/arguments.hpp"

namespace terrain {

// Says how it went, in a few lines or in a sentence on the standard error. Returns the exit status.
[[nodiscard]] int run_job(const JobArguments& arguments);

}  // namespace terrain

#endif  // HMESH_TERRAIN_JOB_COMMAND_HPP
