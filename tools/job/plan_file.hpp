// job - plan.json: what a job makes and by which program, in words that no task changes.
//
// The plan's identity is the checksum of all that it says, the program's version and compiler among it: receipts carry it, and
// what is of another plan is refused.
#ifndef HMESH_JOB_PLAN_FILE_HPP
#define HMESH_JOB_PLAN_FILE_HPP

#include <string>
#include <vector>

#include "job/folder.hpp"
#include "job/input.hpp"
#include "job/receipt.hpp"

namespace job {

// What returns a string returns "" or what is wrong, a sentence.

// Whether a plan may be written there: a new folder, an empty one, or a job.
[[nodiscard]] std::string check_new(const Folder& folder);

// How the values of a plan begin: which program it is of, its version and its compiler.
[[nodiscard]] Json begin_plan(const std::string& program);

// Writes the values. A plan that is there already may be the same.
[[nodiscard]] std::string write_plan(const Folder& folder, const Json& values);

// Reads them, where they are a plan of this very program's.
[[nodiscard]] std::string read_plan(const Folder& folder, const std::string& program, Json& values, std::string& identity);

// What is wrong with the place where what is joined of a job is to be written, or "": it is not the input, and not within a job,
// whose files are its own.
[[nodiscard]] std::string check_output(const Folder& folder, const Input& input, const std::string& output);

// A number of a task's name or a file's, with as many digits as `most` has and four at least, so that names sort.
[[nodiscard]] std::string digits(int number, int most);

// What stands between the '_' of a task's name: its kind, then numbers. None where these are no numbers.
struct NameParts {
    std::string kind;
    std::vector<int> numbers;
};
[[nodiscard]] NameParts parts_of(const std::string& name);

// The sentence about a name that is none of this job's.
[[nodiscard]] inline std::string no_task(const std::string& name) {
    return "'" + name + "' is no task of this job: phase_1.txt and so on list them";
}

}  // namespace job

#endif  // HMESH_JOB_PLAN_FILE_HPP
