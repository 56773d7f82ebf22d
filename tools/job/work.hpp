// job - how tasks are done and looked at, whatever they make.
#ifndef HMESH_JOB_WORK_HPP
#define HMESH_JOB_WORK_HPP

#include <functional>
#include <string>
#include <vector>

#include "job/folder.hpp"
#include "job/phases.hpp"
#include "job/receipt.hpp"

namespace job {

// A task's work: it names the files that it wrote, and what it found out, and `said` becomes what is to be said of it. Returns ""
// or what is wrong, a sentence.
using Work = std::function<std::string(std::vector<Made>& made, Json& facts, std::string& said)>;

// Does a task, unless it is done, and writes its receipt. Returns "" or what is wrong, a sentence: then it is not done.
[[nodiscard]] std::string do_task(const Folder& folder, const std::string& plan, const std::string& task, std::string& said,
                                  const Work& work);

// Does tasks one after another by run(), which is told a name and returns as do_task(); one that fails keeps no other from being
// done. Returns the exit status.
[[nodiscard]] int run_tasks(const std::vector<std::string>& tasks, bool quiet,
                            const std::function<std::string(const std::string& task, std::string& said)>& run);

struct StatusOptions {
    bool mends = false;        // takes back receipts of tasks whose files are damaged
    bool lists_ready = false;  // prints the names of tasks that can be done now, and nothing else
    bool quiet = false;
};

// Says what is done, and what is missing or damaged. Returns the exit status: 0 where all is done and whole.
[[nodiscard]] int tell_status(const Folder& folder, const std::string& plan, const std::vector<Phase>& phases,
                              const StatusOptions& options);

// "phase 1    tiles: 12 tasks", a line each.
[[nodiscard]] std::string lines_of(const std::vector<Phase>& phases);

// "1 task", "2 tasks".
[[nodiscard]] std::string count_of(std::size_t count, const char* one);

}  // namespace job

#endif  // HMESH_JOB_WORK_HPP
