#include "tiles/command.hpp"

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "job/plan_file.hpp"
#include "job/work.hpp"
#include "terminal/progress_watch.hpp"
#include "terminal/say.hpp"
#include "terminal/standard_streams.hpp"
#include "thread_pool.hpp"
#include "tiles/join.hpp"
#include "tiles/plan.hpp"
#include "tiles/tasks.hpp"

namespace tool {
namespace {

int plan_job(const TileJob& arguments) {
    TilePlan plan;
    if (const std::string why = make_tile_plan(arguments, plan); !why.empty()) return fail(failed, why);
    if (arguments.quiet) return done;
    return print("input      " + plan.input.path + ", " + std::to_string(plan.width) + " x " + std::to_string(plan.height) +
                 " px, " + std::to_string(plan.level(0).vertices) + " vertices\n" + job::lines_of(phases_of(plan)) +
                 "written    " + plan.folder.path("plan.json") + ", build.ninja, slurm.sh, parallel.sh\n");
}

int run_tasks(const TileJob& arguments) {
    TilePlan plan;
    if (const std::string why = read_tile_plan(arguments.folder, arguments.input, plan); !why.empty()) return fail(failed, why);
    TileTask task;
    for (const std::string& name : arguments.tasks)
        if (const std::string why = find_task(plan, name, task); !why.empty()) return fail(failed, why);
    std::optional<example::ThreadPool> pool;
    try {
        pool.emplace(arguments.jobs);
    } catch (const std::system_error& error) {
        return fail(failed, "cannot start the threads: " + error.code().message());
    }
    TileWorker worker(plan);
    return job::run_tasks(arguments.tasks, arguments.quiet, [&](const std::string& name, std::string& said) {
        const std::string why = find_task(plan, name, task);
        return why.empty() ? worker.run(task, *pool, said) : why;
    });
}

int tell_status(const TileJob& arguments) {
    TilePlan plan;
    if (const std::string why = read_tile_plan(arguments.folder, "", plan); !why.empty()) return fail(failed, why);
    return job::tell_status(plan.folder, plan.identity, phases_of(plan),
                            {arguments.mends, arguments.lists_ready, arguments.quiet});
}

int join_job(const TileJob& arguments) {
    TilePlan plan;
    if (const std::string why = read_tile_plan(arguments.folder, "", plan); !why.empty()) return fail(failed, why);
    if (const std::string why = job::check_output(plan.folder, plan.input, arguments.output); !why.empty())
        return fail(failed, why);
    job::Json facts;
    const job::Done index = job::find_done(plan.folder, plan.identity, "index", job::Look::bytes, facts);
    if (!index.why.empty()) return fail(failed, index.why);
    if (facts["open"].get<std::int64_t>() > 0)
        return fail(failed, "the tiles do not all meet, first " + facts["first"].get<std::string>());
    std::string said;
    if (const std::string why = arguments.format.empty() ? join_into_file(plan, arguments.output, said)
                                                         : join_into_folder(plan, arguments.output, "." + arguments.format, said);
        !why.empty())
        return fail(failed, why);
    if (arguments.quiet) return done;
    return print("joined     " + said + "\nseams      " + facts["shared"].dump() + " vertices shared\nPSNR       " +
                 job::words_of(facts["psnr"]) + " dB of the samples of all tiles (10 log10(peak^2 / MSE))\nwritten    " +
                 arguments.output + "\n");
}

}  // namespace

int run_tile_job(const TileJob& arguments) {
    catch_interrupt();
    let_interrupts_end_waiting();
    outlive_readers();
    try {
        switch (arguments.command) {
            case JobCommand::plan: return plan_job(arguments);
            case JobCommand::run: return run_tasks(arguments);
            case JobCommand::status: return tell_status(arguments);
            case JobCommand::join: break;
        }
        return join_job(arguments);
    } catch (const job::Json::exception&) {  // a value that is missing or of another kind, and yet the checksum is right
        return fail(failed, "'" + arguments.folder + "' holds what no plan and no task of hmesh's wrote");
    }
}

}  // namespace tool
