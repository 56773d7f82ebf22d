#include "job/phases.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "job/receipt.hpp"

namespace job {
namespace {

// As a word of a shell.
std::string quoted(const std::string& word) {
    std::string text = "'";
    for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return text + "'";
}

// As a word of a shell in which GNU parallel finds no {}, {.}, {#} or the like to replace: quotes end and begin behind a brace.
std::string quoted_from_parallel(const std::string& word) {
    std::string text;
    for (const char c : quoted(word)) text += c == '{' ? std::string("{''") : std::string(1, c);
    return text;
}

// As a value of ninja's.
std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text) out += c == '$' ? std::string("$$") : std::string(1, c);
    return out;
}

std::string ninja_text(const std::string& program, const std::vector<Phase>& phases) {
    std::string text =
        "# All tasks of this job: ninja -C JOB. What files were damaged in, JOB alone, `job status JOB --mend` has made anew.\n"
        "ninja_required_version = 1.3\n"
        "program = " +
        escaped(quoted(program)) +
        "\n"
        "rule task\n"
        "  command = $program job run . $task --quiet\n"
        "  description = $task\n"
        "  restat = 1\n";
    for (const Phase& phase : phases)
        for (const Task& task : phase.tasks) {
            text += "build " + receipt_of(task.name) + ": task | plan.json";
            for (const std::string& need : task.needs) text += " " + receipt_of(need);
            text += "\n  task = " + task.name + "\n";
        }
    return text;
}

std::string list_name(std::size_t phase) { return "phase_" + std::to_string(phase + 1) + ".txt"; }

std::string parallel_text(const std::string& program, const std::vector<Phase>& phases) {
    std::string text =
        "#!/bin/sh\n"
        "# Runs all tasks of this job by GNU parallel, one phase after the other.\n"
        "# usage: JOB/parallel.sh [OPTION OF parallel...]     such as --jobs 8, or --sshlogin one,two --workdir \"$PWD/JOB\"\n"
        "set -eu\n"
        "if ! parallel --version 2>/dev/null | grep -q GNU; then\n"
        "    echo \"$0: this needs GNU parallel, and 'parallel' is missing or another program\" >&2\n"
        "    exit 1\n"
        "fi\n"
        "CDPATH='' cd \"$(dirname \"$0\")\"\n";
    for (std::size_t k = 0; k < phases.size(); ++k)
        text += "parallel \"$@\" --arg-file " + list_name(k) + " " + quoted(quoted_from_parallel(program)) +
                " job run . {} --quiet  # " + phases[k].what + "\n";
    return text;
}

// Arrays have at most 1001 elements where nobody said otherwise (MaxArraySize), so that an element may be several tasks.
constexpr std::size_t most_elements = 1000;

std::string slurm_text(const std::vector<Phase>& phases) {
    std::string text =
        "#!/bin/sh\n"
        "# Submits this job to Slurm: an array for each phase, which waits for the one before it. Prints the last one's number.\n"
        "# usage: JOB/slurm.sh [OPTION OF sbatch...]     such as --partition=short --time=60 --mem=1G\n"
        "set -eu\n"
        "CDPATH='' cd \"$(dirname \"$0\")\"\n"
        "mkdir -p log\n"
        "after=\n"
        "submit() {  # ELEMENTS LIST TASKS_OF_AN_ELEMENT\n"
        "    elements=$1 list=$2 each=$3\n"
        "    shift 3\n"
        "    # shellcheck disable=SC2086\n"
        "    after=$(sbatch --parsable $after --array=\"0-$((elements - 1))\" \"$@\" slurm_task.sh \"$list\" \"$each\")\n"
        "    after=\"--dependency=afterok:${after%%;*} --kill-on-invalid-dep=yes\"\n"
        "}\n";
    for (std::size_t k = 0; k < phases.size(); ++k) {
        const std::size_t tasks = phases[k].tasks.size(), each = (tasks + most_elements - 1) / most_elements;
        text += "submit " + std::to_string((tasks + each - 1) / each) + " " + list_name(k) + " " + std::to_string(each) +
                " \"$@\"  # " + phases[k].what + "\n";
    }
    return text + "after=${after#*:}\necho \"${after%% *}\"\n";
}

std::string slurm_task_text(const std::string& program) {
    return "#!/bin/sh\n"
           "#SBATCH --job-name=hmesh\n"
           "#SBATCH --output=log/%A_%a.txt\n"
           "#SBATCH --ntasks=1\n"
           "#SBATCH --cpus-per-task=1\n"
           "# An element of an array: some lines of a list of tasks. Submitted by slurm.sh.\n"
           "sed -n \"$((SLURM_ARRAY_TASK_ID * $2 + 1)),$(((SLURM_ARRAY_TASK_ID + 1) * $2))p\" \"$1\" |\n"
           "    xargs " +
           quoted(program) + " job run .\n";
}

}  // namespace

std::string write_engines(const Folder& folder, const std::string& program, const std::vector<Phase>& phases) {
    const auto write = [&](const std::string& name, const std::string& text) {
        std::string why = folder.write(name, text);
        const bool is_script = name.size() > 3 && name.compare(name.size() - 3, 3, ".sh") == 0;
        std::error_code none;  // `sh JOB/slurm.sh` does as well
        using Bits = std::filesystem::perms;
        if (why.empty() && is_script)
            std::filesystem::permissions(folder.path(name), Bits::owner_exec | Bits::group_exec | Bits::others_exec,
                                         std::filesystem::perm_options::add, none);
        return why;
    };
    for (std::size_t k = 0; k < phases.size(); ++k) {
        std::string list;
        for (const Task& task : phases[k].tasks) list += task.name + "\n";
        if (std::string why = write(list_name(k), list); !why.empty()) return why;
    }
    if (std::string why = write("parallel.sh", parallel_text(program, phases)); !why.empty()) return why;
    if (std::string why = write("slurm_task.sh", slurm_task_text(program)); !why.empty()) return why;
    if (std::string why = write("slurm.sh", slurm_text(phases)); !why.empty()) return why;
    return write("build.ninja", ninja_text(program, phases));
}

}  // namespace job
