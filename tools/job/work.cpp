#include "job/work.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <nlohmann/json.hpp>

#include "terminal/progress_watch.hpp"
#include "terminal/say.hpp"

namespace job {

std::string do_task(const Folder& folder, const std::string& plan, const std::string& task, std::string& said, const Work& work) {
    Json facts;
    if (find_done(folder, plan, task, Look::bytes, facts).found == Found::whole) {
        said = "done before";
        return {};
    }
    const auto begin = std::chrono::steady_clock::now();
    const std::clock_t began = std::clock();
    std::vector<Made> made;
    if (std::string why = work(made, facts, said); !why.empty()) return why;
    if (tool::interrupted) return "interrupted; " + task + " is not done";
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    // In the receipt alone: no other file says how long anything took.
    facts["seconds"] = std::round(seconds * 1e6) / 1e6;
    facts["processor_seconds"] = static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC;
    return write_receipt(folder, plan, task, made, facts);
}

int run_tasks(const std::vector<std::string>& tasks, bool quiet,
              const std::function<std::string(const std::string& task, std::string& said)>& run) {
    int status = tool::done;
    for (const std::string& task : tasks) {
        if (tool::interrupted) return tool::failed;
        std::string said;
        if (const std::string why = run(task, said); !why.empty()) status = tool::fail(tool::failed, why);
        else if (!quiet && tool::print(task + "  " + said + "\n") != tool::done) return tool::failed;
    }
    return tool::interrupted ? tool::failed : status;
}

int tell_status(const Folder& folder, const std::string& plan, const std::vector<Phase>& phases, const StatusOptions& options) {
    std::string text, faults, ready;
    std::size_t all = 0, all_done = 0;
    std::vector<std::string> whole;  // sorted, of the phases before
    for (std::size_t k = 0; k < phases.size(); ++k) {
        std::size_t done = 0, damaged = 0;
        std::vector<std::string> found;
        for (const Task& task : phases[k].tasks) {
            if (tool::interrupted) return tool::fail(tool::failed, "interrupted");
            Json facts;
            const Done state = find_done(folder, plan, task.name, Look::bytes, facts);
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
            if (options.mends)
                if (const std::string why = folder.remove(receipt_of(task.name)); !why.empty())
                    return tool::fail(tool::failed, why);
        }
        whole.insert(whole.end(), found.begin(), found.end());
        std::sort(whole.begin(), whole.end());
        text += "phase " + std::to_string(k + 1) + "    " + phases[k].what + ": " + std::to_string(done) + " of " +
                count_of(phases[k].tasks.size(), "task") + " done";
        if (damaged > 0) text += ", " + std::to_string(damaged) + (options.mends ? " taken back" : " damaged");
        text += "\n";
        all += phases[k].tasks.size();
        all_done += done;
    }
    if (!options.quiet || options.lists_ready)
        if (const int status = tool::print(options.lists_ready ? ready : text + faults); status != tool::done) return status;
    return all == all_done ? tool::done : tool::failed;
}

std::string lines_of(const std::vector<Phase>& phases) {
    std::string text;
    for (std::size_t k = 0; k < phases.size(); ++k)
        text +=
            "phase " + std::to_string(k + 1) + "    " + phases[k].what + ": " + count_of(phases[k].tasks.size(), "task") + "\n";
    return text;
}

std::string count_of(std::size_t count, const char* one) { return std::to_string(count) + " " + one + (count == 1 ? "" : "s"); }

}  // namespace job
