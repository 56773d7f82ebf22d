// hmesh - the command: image files become meshes. See `hmesh --help`.
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "arguments/arguments.hpp"
#include "arguments/clashes.hpp"
#include "arguments/tile_job.hpp"
#include "job.hpp"
#include "terminal/answer.hpp"
#include "terminal/progress_watch.hpp"
#include "terminal/say.hpp"
#include "terminal/standard_streams.hpp"
#include "thread_pool.hpp"
#include "tiles/command.hpp"

namespace tool {
namespace {

// Of several images, those that are left are meshed where one fails. Returns the exit status.
int run(const std::vector<Arguments>& images) {
    catch_interrupt();
    let_interrupts_end_waiting();
    outlive_readers();
    if (const std::string clash = find_clash(images); !clash.empty()) return fail(wrong_usage, clash);
    std::optional<example::ThreadPool> pool;
    std::size_t begun = 0, failures = 0;
    while (begun < images.size() && !interrupted) {
        const JobEnd end = run_job(images[begun++], images.size() > 1, pool);
        failures += end == JobEnd::done ? 0 : 1;
        if (end == JobEnd::failed_for_all) break;
    }
    if (failures == 0 && begun == images.size()) return done;
    if (images.size() == 1) return failed;
    const auto of_all = [&](std::size_t n) { return std::to_string(n) + " of " + std::to_string(images.size()) + " images "; };
    const std::string left = begun < images.size() ? of_all(images.size() - begun) + "were not begun" : "";
    if (failures == 0) return fail(failed, "interrupted: " + left);
    return fail(failed, of_all(failures) + "failed" + (left.empty() ? "" : ", and " + left));
}

}  // namespace
}  // namespace tool

int main(int argc, char** argv) {
    const std::vector<std::string> words(argv + (argc > 0 ? 1 : 0), argv + argc);
    // An image named job is ./job.
    if (words.empty() || words.front() != "job") {
        const tool::CommandLine line = tool::parse(words);
        return tool::answer(line, [&] { return tool::run(line.images); });
    }
    tool::TileJobLine line = tool::parse_tile_job({words.begin() + 1, words.end()});
    if (line.arguments.program.empty()) line.arguments.program = tool::program_path(argv[0]);
    return tool::answer(line, [&] { return tool::run_tile_job(line.arguments); });
}
