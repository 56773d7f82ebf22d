// tools - the options of `COMMAND job` that all jobs have. Included by the files alone that compile CLI11.
#ifndef HMESH_TOOLS_ARGUMENTS_JOB_OPTIONS_HPP
#define HMESH_TOOLS_ARGUMENTS_JOB_OPTIONS_HPP

#include <string>
#include <vector>

#include "arguments/job_call.hpp"
#include "arguments/parser.hpp"
#include "arguments/values.hpp"
#include "terminal/standard_streams.hpp"

namespace tool {

inline void add_text(CLI::App& app, const char* names, const char* value, const char* description, std::string& text) {
    add(app, names, value, description, [&text](const std::string& given) {
        text = given;
        return "";
    });
}

inline void add_jobs(CLI::App& app, const char* description, unsigned& jobs) {
    add(app, "--jobs", "N", description, [&jobs](const std::string& text) { return parse_in_range(text, 0, 1024, jobs); });
}

// What is said, the last of all groups.
inline void add_quiet(CLI::App& app, bool& quiet, const char* version_words) {
    app.option_defaults()->group("What is said");
    app.add_flag_callback(
        "-q,--quiet", [&quiet] { quiet = true; }, "print errors only");
    add_help(app, version_words);
}

// One or more names.
inline void add_names(CLI::App& app, const char* name, const std::string& description, std::vector<std::string>& names) {
    const auto set = [&names](const CLI::results_t& texts) {
        names = texts;
        return true;
    };
    app.add_option(name, set, description)->expected(1, CLI::detail::expected_max_vector_size)->allow_extra_args()->required();
}

// Options of the group "The job"; `inputs` is what help calls the words without a name.
inline void begin_job(CLI::App& app, const char* inputs) {
    lay_out(app, inputs);
    app.option_defaults()->group("The job");
}

// Of `job plan`, but for what is made.
inline void add_plan_options(CLI::App& app, JobCall& out) {
    add_text(app, "-o,--output", "JOB", "the folder to write the job into", out.folder);
    app.add_flag_callback(
        "--hash", [&out] { out.hashes = true; },
        "the input is known by its bytes, for machines that have copies of it; else by its size\nand time");
    add_text(app, "--program", "PATH", "how engines find this program (default: as it was called now)", out.program);
}

inline void add_folder(CLI::App& app, JobCall& out) {
    app.add_option("JOB", out.folder, "the job's folder")->required()->type_name("");
}

inline void add_run_options(CLI::App& app, JobCall& out, const char* version_words) {
    begin_job(app, "What is done");
    app.footer(
        "A task that is done already is not done again. One whose input is missing, of another plan or damaged says so and\n"
        "writes nothing.");
    add_folder(app, out);
    add_names(app, "TASK", "names of tasks, as phase_1.txt lists them", out.tasks);
    add_text(app, "--input", "PATH", "where the input is on this machine, in place of where it was planned", out.input);
    out.jobs = 1;
    add_jobs(app, "work with N threads, 1 to 1024, or 0, all cores (default: 1)", out.jobs);
    add_quiet(app, out.quiet, version_words);
}

inline void add_status_options(CLI::App& app, JobCall& out, const char* version_words) {
    begin_job(app, "What is done");
    app.footer("Exit status: 0 all is done, 1 not yet.");
    add_folder(app, out);
    app.add_flag_callback(
        "--mend", [&out] { out.mends = true; },
        "take back receipts of tasks whose files are damaged, so that engines do them again");
    app.add_flag_callback(
        "--ready", [&out] { out.lists_ready = true; },
        "print the names of tasks that can be done now, one a line, and nothing else");
    add_quiet(app, out.quiet, version_words);
}

// Begins the parsing of the words after `COMMAND job`: whether there is a subcommand to be parsed, which `out` gets; else `wrong`
// or `answer`, which is `help`, is set.
[[nodiscard]] inline bool find_job_command(const std::vector<std::string>& words, const char* help, JobCall& out,
                                           std::string& wrong, std::string& answer) {
    const std::string command = words.empty() ? "" : words.front();
    if (command.empty()) wrong = "job is given without plan, run, status or join";
    else if (command == "-h" || command == "--help") answer = help;
    else if (const std::string why = find_name(job_commands, command, out.command); !why.empty())
        wrong = "job '" + command + "' " + why;
    return wrong.empty() && answer.empty();
}

// What is wrong with where tiles are joined into, or "".
[[nodiscard]] inline std::string find_output_conflict(const JobCall& join) {
    if (join.output.empty()) return "no output is given: -o names it";
    return is_standard(join.output) ? "--output - is no file and no folder, which tiles are joined into" : "";
}

// What is missing where words without a name are.
[[nodiscard]] inline const char* missing_words(JobCommand command) {
    return command == JobCommand::plan  ? "no input file is given"
           : command == JobCommand::run ? "no folder or no task is given"
                                        : "no folder is given";
}

}  // namespace tool

#endif  // HMESH_TOOLS_ARGUMENTS_JOB_OPTIONS_HPP
