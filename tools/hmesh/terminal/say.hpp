// tools - how a command ends, and says why.
#ifndef HMESH_TOOLS_TERMINAL_SAY_HPP
#define HMESH_TOOLS_TERMINAL_SAY_HPP

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <string>

#include "terminal/progress_bar.hpp"

namespace tool {

inline constexpr int done = 0, failed = 1, wrong_usage = 2;

// The name of the command, with which its sentences begin. main() of another one says its own before anything else.
inline const char* command_name = "hmesh";

// Says the sentence on the standard error. Returns the exit status.
inline int fail(int exit_status, const std::string& sentence) {
    wipe_bar();
    std::fprintf(stderr, "%s: %s\n", command_name, sentence.c_str());
    if (exit_status == wrong_usage) std::fprintf(stderr, "Try '%s --help'.\n", command_name);
    return exit_status;
}

// Prints the text on the standard output. Returns the exit status.
inline int print(const std::string& text) {
    const bool printed = std::fputs(text.c_str(), stdout) >= 0 && std::fflush(stdout) == 0;
    return printed ? done : fail(failed, "cannot write to the standard output");
}

inline constexpr char no_memory[] = "there is not enough memory for this image and these options";

// For std::set_terminate(): where a worker of the pool, which throws nothing, has no memory.
[[noreturn]] inline void give_up() {
    try {
        if (std::exception_ptr why = std::current_exception()) std::rethrow_exception(why);
    } catch (const std::bad_alloc&) {
        wipe_bar();
        std::fprintf(stderr, "%s: %s\n", command_name, no_memory);
        std::_Exit(failed);
    } catch (...) {
    }
    std::abort();
}

}  // namespace tool

#endif  // HMESH_TOOLS_TERMINAL_SAY_HPP
