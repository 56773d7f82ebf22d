// hmesh - the command: image files become meshes. See `hmesh --help`.
#include <cstddef>
#include <exception>
#include <new>
#include <optional>
#include <string>
#include <vector>

#include "arguments/arguments.hpp"
#include "arguments/clashes.hpp"
#include "job.hpp"
#include "terminal/progress_watch.hpp"
#include "terminal/say.hpp"
#include "terminal/standard_streams.hpp"
#include "thread_pool.hpp"

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
    const tool::CommandLine line = tool::parse({argv + (argc > 0 ? 1 : 0), argv + argc});
    if (!line.wrong.empty()) return tool::fail(tool::wrong_usage, line.wrong);
    if (!line.answer.empty()) return tool::print(line.answer);
    std::set_terminate(tool::give_up);
    try {
        return tool::run(line.images);
    } catch (const std::bad_alloc&) {
        return tool::fail(tool::failed, tool::no_memory);
    }
}
