// tools - what `hmesh job` is asked for.
#ifndef HMESH_TOOLS_ARGUMENTS_TILE_JOB_HPP
#define HMESH_TOOLS_ARGUMENTS_TILE_JOB_HPP

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "arguments/job_call.hpp"
#include "hmesh/methods/annealed/options.hpp"
#include "hmesh/options.hpp"

namespace tool {

// How tiles are made.
struct TileOptions {
    hmesh::Effort effort = hmesh::Effort::normal;
    std::uint64_t seed = 1;
    int tile = 2047;                         // samples from line to line, at most
    int levels = 1;                          // of detail
    std::optional<double> border_tolerance;  // stored values; none: by the mean error
};

struct TileJob : JobCall {
    TileOptions tiles;                                   // of plan
    hmesh::Target target = hmesh::Target::percent(1.0);  // of plan: vertices, or a percentage of the samples
    std::string format;                                  // of join: that of the tiles in a folder; empty: the output is a file
};

struct TileJobLine {
    TileJob arguments;
    std::string wrong;   // what is wrong with the command line, a sentence; empty: nothing
    std::string answer;  // what is to be printed instead of running; empty: nothing
};

// The words after `hmesh job`.
[[nodiscard]] TileJobLine parse_tile_job(const std::vector<std::string>& words);

}  // namespace tool

#endif  // HMESH_TOOLS_ARGUMENTS_TILE_JOB_HPP
