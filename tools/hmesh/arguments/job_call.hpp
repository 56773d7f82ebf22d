// tools - what `COMMAND job` is asked for, whatever it makes.
#ifndef HMESH_TOOLS_ARGUMENTS_JOB_CALL_HPP
#define HMESH_TOOLS_ARGUMENTS_JOB_CALL_HPP

#include <cstdint>
#include <string>
#include <vector>

#include "arguments/named.hpp"

namespace tool {

enum class JobCommand : std::uint8_t { plan, run, status, join };

inline constexpr Named<JobCommand> job_commands[] = {
    {"plan", JobCommand::plan}, {"run", JobCommand::run}, {"status", JobCommand::status}, {"join", JobCommand::join}};

struct JobCall {
    JobCommand command = JobCommand::plan;
    std::string folder;
    std::string input;                        // of plan; of run: where it is on this machine, empty: where it was planned
    bool hashes = false;                      // of plan: the input's bytes
    std::string program;                      // of plan: how engines call it; empty: as it was called
    std::vector<std::string> tasks;           // of run
    unsigned jobs = 1;                        // of run: threads; 0: as many as cores
    bool mends = false, lists_ready = false;  // of status
    std::string output;                       // of join
    bool quiet = false;
};

}  // namespace tool

#endif  // HMESH_TOOLS_ARGUMENTS_JOB_CALL_HPP
