// tools - what main() of a command does with a command line that was parsed.
#ifndef HMESH_TOOLS_TERMINAL_ANSWER_HPP
#define HMESH_TOOLS_TERMINAL_ANSWER_HPP

#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <system_error>

#include "terminal/say.hpp"

namespace tool {

// Says what is wrong with the line, prints its answer, or calls run(). Returns the exit status.
template <class Line, class Run>
[[nodiscard]] int answer(const Line& line, Run run) {
    if (!line.wrong.empty()) return fail(wrong_usage, line.wrong);
    if (!line.answer.empty()) return print(line.answer);
    std::set_terminate(give_up);
    try {
        return run();
    } catch (const std::bad_alloc&) {
        return fail(failed, no_memory);
    }
}

// Where engines find this program: as it was called, by a path that holds in any folder, or by its name.
[[nodiscard]] inline std::string program_path(const std::string& called) {
    std::error_code none;
    const std::filesystem::path path(called);
    return path.has_parent_path() ? std::filesystem::absolute(path, none).lexically_normal().string() : called;
}

}  // namespace tool

#endif  // HMESH_TOOLS_TERMINAL_ANSWER_HPP
