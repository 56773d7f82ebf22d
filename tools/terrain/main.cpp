// hmesh-terrain - the command: models of heights become meshes. See `hmesh-terrain --help`.
#include <string>
#include <vector>

#include "terminal/answer.hpp"
#include "terminal/say.hpp"
#include "terrain/arguments.hpp"
#include "terrain/job/command.hpp"
#include "terrain/run.hpp"

// What is no lack of memory is told by give_up() of say.hpp.
int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    tool::command_name = "hmesh-terrain";
    const std::vector<std::string> words(argv + (argc > 0 ? 1 : 0), argv + argc);
    if (words.empty() || words.front() != "job") {
        const terrain::CommandLine line = terrain::parse(words);
        return tool::answer(line, [&] { return terrain::run(line.arguments); });
    }
    terrain::JobCommandLine line = terrain::parse_job({words.begin() + 1, words.end()});
    if (line.arguments.program.empty()) line.arguments.program = tool::program_path(argv[0]);
    return tool::answer(line, [&] { return terrain::run_job(line.arguments); });
}
