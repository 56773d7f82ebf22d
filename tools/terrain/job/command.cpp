#include "terrain/job/command.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "job/plan_file.hpp"
#include "job/receipt.hpp"
#include "job/work.hpp"
#include "terminal/progress_watch.hpp"
#include "terminal/say.hpp"
#include "terminal/standard_streams.hpp"
#include "terrain/job/join.hpp"
#include "terrain/job/plan.hpp"
#include "terrain/job/tasks.hpp"
#include "thread_pool.hpp"
#include "writers/ending.hpp"

namespace terrain {
namespace {

using job::Found;
using job::Json;
using tool::JobCommand;

int plan_job(const JobArguments& arguments) {
    Plan plan;
    if (const std::string why = make_plan(arguments, plan); !why.empty()) return tool::fail(tool::failed, why);
    if (arguments.quiet) return tool::done;
    std::string text =
        "input      " + plan.input.path + ", " + std::to_string(plan.width) + " x " + std::to_string(plan.height) + " samples\n";
    text += job::lines_of(phases_of(plan));
    text += "written    " + plan.folder.path("plan.json") + ", build.ninja, slurm.sh, parallel.sh\n";
    if (plan.arguments.format == Format::quantized_mesh && !plan.globe)
        text += "note       no layer.json: the tiles are not those of Cesium's grid, see docs/jobs.md\n";
    return tool::print(text);
}

int run_tasks(const JobArguments& arguments) {
    Plan plan;
    if (const std::string why = read_plan(arguments.folder, arguments.input, plan); !why.empty())
        return tool::fail(tool::failed, why);
    std::vector<TaskName> tasks(arguments.tasks.size());
    for (std::size_t k = 0; k < tasks.size(); ++k)
        if (const std::string why = find_task(plan, arguments.tasks[k], tasks[k]); !why.empty())
            return tool::fail(tool::failed, why);
    std::optional<example::ThreadPool> pool;
    try {
        pool.emplace(arguments.jobs);
    } catch (const std::system_error& error) {
        return tool::fail(tool::failed, "cannot start the threads: " + error.code().message());
    }
    Worker worker(plan);
    std::size_t next = 0;
    return job::run_tasks(arguments.tasks, arguments.quiet,
                          [&](const std::string&, std::string& said) { return worker.run(tasks[next++], *pool, said); });
}

int tell_status(const JobArguments& arguments) {
    Plan plan;
    if (const std::string why = read_plan(arguments.folder, "", plan); !why.empty()) return tool::fail(tool::failed, why);
    return job::tell_status(plan.folder, plan.identity, phases_of(plan),
                            {arguments.mends, arguments.lists_ready, arguments.quiet});
}

int join_job(const JobArguments& arguments) {
    Plan plan;
    if (const std::string why = read_plan(arguments.folder, "", plan); !why.empty()) return tool::fail(tool::failed, why);
    if (const std::string why = job::check_output(plan.folder, plan.input, arguments.output); !why.empty())
        return tool::fail(tool::failed, why);
    Json facts;
    const job::Done done = job::find_done(plan.folder, plan.identity, "index", job::Look::bytes, facts);
    if (done.found != Found::whole) return tool::fail(tool::failed, done.why);
    const Seams seams = seams_of(facts);
    if (seams.open > 0 && !arguments.takes_open_seams)
        return tool::fail(tool::failed, "the tiles do not all meet: " + std::to_string(seams.open) +
                                            (seams.open == 1 ? " vertex" : " vertices") +
                                            " of one that the other has not, first of " + seams.first +
                                            "; --open-seams joins them nevertheless");
    const Format format = format_of(arguments.output);
    const bool is_file = format == Format::ply || format == Format::obj || format == Format::glb;
    const bool is_folder = format == Format::none && tool::may_be_folder(arguments.output);
    if (!is_file && !is_folder)
        return tool::fail(tool::failed,
                          "'" + arguments.output + "' is none of .ply, .obj, .glb and a folder, whose name may end in a slash");
    std::string said;
    if (const std::string why =
            is_file ? join_into_file(plan, arguments.output, said) : join_into_folder(plan, arguments.output, said);
        !why.empty())
        return tool::fail(tool::failed, why);
    if (arguments.quiet) return tool::done;
    std::string text = "joined     " + said + "\n" + "seams      " + std::to_string(seams.shared) + " vertices shared\n";
    if (seams.no_data > 0)
        text += "note       " + std::to_string(seams.no_data) + " vertices of seams beside samples without data stand alone\n";
    return tool::print(text + "written    " + arguments.output + "\n");
}

}  // namespace

int run_job(const JobArguments& arguments) {
    tool::catch_interrupt();
    tool::let_interrupts_end_waiting();
    tool::outlive_readers();
    try {
        switch (arguments.command) {
            case JobCommand::plan: return plan_job(arguments);
            case JobCommand::run: return run_tasks(arguments);
            case JobCommand::status: return tell_status(arguments);
            case JobCommand::join: break;
        }
        return join_job(arguments);
    } catch (const Json::exception&) {  // a value that is missing or of another kind, and yet the checksum is right
        return tool::fail(tool::failed, "'" + arguments.folder + "' holds what no plan and no task of hmesh-terrain's wrote");
    }
}

}  // namespace terrain
