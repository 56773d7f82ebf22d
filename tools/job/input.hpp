// job - the input of a job: a file that tasks read from where it is, known by its size and time or by its bytes, so that none of
// them takes another one for it.
#ifndef HMESH_JOB_INPUT_HPP
#define HMESH_JOB_INPUT_HPP

#include <cstdint>
#include <optional>
#include <string>

#include "job/receipt.hpp"

namespace job {

// Which file it was, where it is a plain one.
struct InputIdentity {
    std::uint64_t bytes = 0;
    std::int64_t modified = 0;  // nanoseconds by the file system's clock
    std::string sha256;         // empty: it is known by the two above
};

struct Input {
    std::string path;  // as it was planned
    std::optional<InputIdentity> identity;
};

// What returns a string returns "" or what is wrong, a sentence.

// The path as any folder has it, and the identity: none of what is no plain file, as GDAL's names of other things are. `hashes`:
// by its bytes, too.
[[nodiscard]] std::string find_input(const std::string& path, bool hashes, Input& input);

// Whether the file at `path`, which may be a copy elsewhere, is the input that was planned.
[[nodiscard]] std::string check_input(const std::string& path, const Input& planned);

// How a sentence begins that says it is not.
[[nodiscard]] inline std::string not_as_planned(const std::string& path) {
    return "'" + path + "' is not the input that was planned: ";
}

// In a plan.
[[nodiscard]] Json value_of(const Input& input);
[[nodiscard]] Input input_of(const Json& value);

}  // namespace job

#endif  // HMESH_JOB_INPUT_HPP
