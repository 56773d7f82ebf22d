// hmesh-terrain - the command: models of heights become meshes. See `hmesh-terrain --help`.
#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <vector>

#include "terminal/say.hpp"
#include "terrain/arguments.hpp"
#include "terrain/job/command.hpp"
#include "terrain/run.hpp"

namespace {

template <class Line, class Run>
int answer(const Line& line, Run run) {
    if (!line.wrong.empty()) return tool::fail(tool::wrong_usage, line.wrong);
    if (!line.answer.empty()) return tool::print(line.answer);
    std::set_terminate(tool::give_up);
    try {
        return run(line.arguments);
    } catch (const std::bad_alloc&) {
        return tool::fail(tool::failed, tool::no_memory);
    }
}

// Where engines find this program: as it was called, by a path that holds in any folder, or by its name.
std::string program_path(const std::string& called) {
    std::error_code none;
    const std::filesystem::path path(called);
    return path.has_parent_path() ? std::filesystem::absolute(path, none).lexically_normal().string() : called;
}

}  // namespace

int main(int argc, char** argv) {
    tool::command_name = "hmesh-terrain";
    const std::vector<std::string> words(argv + (argc > 0 ? 1 : 0), argv + argc);
    if (words.empty() || words.front() != "job") return answer(terrain::parse(words), terrain::run);
    terrain::JobCommandLine line = terrain::parse_job({words.begin() + 1, words.end()});
    if (line.arguments.program.empty()) line.arguments.program = program_path(argv[0]);
    return answer(line, terrain::run_job);
}
