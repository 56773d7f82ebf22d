// tools - how the command ends, and says why.
#ifndef HMESH_TOOLS_TERMINAL_SAY_HPP
#define HMESH_TOOLS_TERMINAL_SAY_HPP

#include <cstdio>
#include <string>

#include "terminal/progress_bar.hpp"

namespace tool {

inline constexpr int done = 0, failed = 1, wrong_usage = 2;

// Says the sentence on the standard error. Returns the exit status.
inline int fail(int exit_status, const std::string& sentence) {
    wipe_bar();
    std::fprintf(stderr, "hmesh: %s\n", sentence.c_str());
    if (exit_status == wrong_usage) std::fprintf(stderr, "Try 'hmesh --help'.\n");
    return exit_status;
}

}  // namespace tool

#endif  // HMESH_TOOLS_TERMINAL_SAY_HPP
