// job - Phase: tasks that share nothing and wait for tasks of phases before alone; and the files by which engines run them.
#ifndef HMESH_JOB_PHASES_HPP
#define HMESH_JOB_PHASES_HPP

#include <string>
#include <vector>

#include "job/folder.hpp"

namespace job {

struct Task {
    std::string name;                // of letters, digits and '_'
    std::vector<std::string> needs;  // tasks whose receipts it reads
};

struct Phase {
    std::string what;  // "tiles"
    std::vector<Task> tasks;
};

// Writes into the job's folder build.ninja, slurm.sh with slurm_task.sh, and parallel.sh with phase_1.txt, phase_2.txt ..., which
// list tasks, one a line. Each task is run as `PROGRAM job run . TASK` from there. Returns "" or what is wrong, a sentence.
[[nodiscard]] std::string write_engines(const Folder& folder, const std::string& program, const std::vector<Phase>& phases);

}  // namespace job

#endif  // HMESH_JOB_PHASES_HPP
