// hmesh-terrain - the command: models of heights become meshes. See `hmesh-terrain --help`.
#include <exception>
#include <new>

#include "terminal/say.hpp"
#include "terrain/arguments.hpp"
#include "terrain/run.hpp"

int main(int argc, char** argv) {
    tool::command_name = "hmesh-terrain";
    const terrain::CommandLine line = terrain::parse({argv + (argc > 0 ? 1 : 0), argv + argc});
    if (!line.wrong.empty()) return tool::fail(tool::wrong_usage, line.wrong);
    if (!line.answer.empty()) return tool::print(line.answer);
    std::set_terminate(tool::give_up);
    try {
        return terrain::run(line.arguments);
    } catch (const std::bad_alloc&) {
        return tool::fail(tool::failed, tool::no_memory);
    }
}
