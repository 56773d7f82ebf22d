#include "terrain/job/command.hpp"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "job/receipt.hpp"
#include "terminal/progress_watch.hpp"
#include "terminal/say.hpp"
#include "terminal/standard_streams.hpp"
#include "terrain/job/join.hpp"
#include "terrain/job/plan.hpp"
#include "terrain/job/tasks.hpp"
#include "thread_pool.hpp"

namespace terrain {
namespace {

using job::Found;
using job::Json;

std::string count_of(std::size_t count, const char* one) { return std::to_string(count) + " " + one + (count == 1 ? "" : "s"); }

int plan_job(const JobArguments& arguments) {
    Plan plan;
    if (const std::string why = make_plan(arguments, plan); !why.empty()) return tool::fail(tool::failed, why);
    if (arguments.quiet) return tool::done;
    std::string text =
        "input      " + plan.input + ", " + std::to_string(plan.width) + " x " + std::to_string(plan.height) + " samples\n";
    const std::vector<job::Phase> phases = phases_of(plan);
    for (std::size_t k = 0; k < phases.size(); ++k)
        text +=
            "phase " + std::to_string(k + 1) + "    " + phases[k].what + ": " + count_of(phases[k].tasks.size(), "task") + "\n";
    text += "written    " + plan.folder.path("plan.json") + ", build.ninja, slurm.sh, parallel.sh\n";
    if (plan.arguments.format == Format::quantized_mesh && !plan.globe)
        text += "note       no layer.json: the tiles are not those of Cesium's grid, see docs/terrain.md\n";
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
    int status = tool::done;
    for (std::size_t k = 0; k < tasks.size() && !tool::interrupted; ++k) {
        std::string said;
        // One that fails keeps no other from being done.
        if (const std::string why = worker.run(tasks[k], *pool, said); !why.empty()) status = tool::fail(tool::failed, why);
        else if (!arguments.quiet && tool::print(arguments.tasks[k] + "  " + said + "\n") != tool::done) return tool::failed;
    }
    return tool::interrupted ? tool::failed : status;
}

int tell_status(const JobArguments& arguments) {
    Plan plan;
    if (const std::string why = read_plan(arguments.folder, "", plan); !why.empty()) return tool::fail(tool::failed, why);
    std::string text, faults, ready;
    std::size_t all = 0, all_done = 0;
    const std::vector<job::Phase> phases = phases_of(plan);
    std::vector<std::string> whole;  // sorted, of the phases before
    for (std::size_t k = 0; k < phases.size(); ++k) {
        std::size_t done = 0, damaged = 0;
        std::vector<std::string> found;
        for (const job::Task& task : phases[k].tasks) {
            if (tool::interrupted) return tool::fail(tool::failed, "interrupted");
            Json facts;
            const job::Done state = job::find_done(plan.folder, plan.identity, task.name, job::Look::bytes, facts);
            if (state.found == Found::whole) {
                ++done;
                found.push_back(task.name);
                continue;
            }
            bool is_ready = true;
            for (const std::string& need : task.needs)
                is_ready = is_ready && std::binary_search(whole.begin(), whole.end(), need);
            if (is_ready) ready += task.name + "\n";
            if (state.found == Found::nothing) continue;
            ++damaged;
            faults += (state.found == Found::foreign ? "foreign    " : "damaged    ") + state.why + "\n";
            if (arguments.mends)
                if (const std::string why = plan.folder.remove(job::receipt_of(task.name)); !why.empty())
                    return tool::fail(tool::failed, why);
        }
        std::sort(found.begin(), found.end());
        whole = std::move(found);
        text += "phase " + std::to_string(k + 1) + "    " + phases[k].what + ": " + std::to_string(done) + " of " +
                count_of(phases[k].tasks.size(), "task") + " done";
        if (damaged > 0) text += ", " + std::to_string(damaged) + (arguments.mends ? " taken back" : " damaged");
        text += "\n";
        all += phases[k].tasks.size();
        all_done += done;
    }
    if (!arguments.quiet || arguments.lists_ready)
        if (const int status = tool::print(arguments.lists_ready ? ready : text + faults); status != tool::done) return status;
    return all == all_done ? tool::done : tool::failed;
}

int join_job(const JobArguments& arguments) {
    Plan plan;
    if (const std::string why = read_plan(arguments.folder, "", plan); !why.empty()) return tool::fail(tool::failed, why);
    Json facts;
    const job::Done done = job::find_done(plan.folder, plan.identity, "index", job::Look::bytes, facts);
    if (done.found != Found::whole) return tool::fail(tool::failed, done.why);
    const Seams seams = seams_of(facts);
    if (seams.open > 0 && !arguments.takes_open_seams)
        return tool::fail(tool::failed, "the tiles do not all meet: " + count_of(static_cast<std::size_t>(seams.open), "vertex") +
                                            " of one that the other has not, first of " + seams.first +
                                            "; --open-seams joins them nevertheless");
    const Format format = format_of(arguments.output);
    const bool is_file = format == Format::ply || format == Format::obj || format == Format::glb;
    if (format != Format::none && !is_file)
        return tool::fail(tool::failed, "'" + arguments.output + "' is none of .ply, .obj, .glb and a folder");
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
