// job - a receipt is what a task leaves behind when it is done, the file done/TASK.json: which files it made, their sizes and
// checksums, and what it found out. It is written after them: a task is done if its receipt is there.
//
// A receipt says of which plan it is, and has a checksum of its own: what is missing, of another plan or damaged is told apart.
#ifndef HMESH_JOB_RECEIPT_HPP
#define HMESH_JOB_RECEIPT_HPP

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "job/folder.hpp"

namespace job {

using Json = nlohmann::ordered_json;

// A file of the job as it was written.
struct Made {
    std::string name, sha256;
    std::uint64_t bytes = 0;
};

enum class Found : std::uint8_t {
    nothing,  // the task is not done
    whole,
    foreign,  // of another plan
    damaged,  // the receipt, or a file of its
};

// How closely files are looked at.
enum class Look : std::uint8_t { sizes, bytes };

// The name of a task's receipt.
[[nodiscard]] std::string receipt_of(const std::string& task);

// Writes the receipt. Returns "" or what is wrong, a sentence.
[[nodiscard]] std::string write_receipt(const Folder& folder, const std::string& plan, const std::string& task,
                                        const std::vector<Made>& made, const Json& facts);

// What there is of a task: `why`, a sentence, where it is not whole; what its receipt says where it is.
struct Done {
    Found found = Found::nothing;
    std::string why;
    std::vector<Made> made;
};
[[nodiscard]] Done find_done(const Folder& folder, const std::string& plan, const std::string& task, Look look, Json& facts);

// A fact in words: text and whole numbers as they are, others with two decimals.
[[nodiscard]] std::string words_of(const Json& fact);

// Reads a file that a task made, if it is as it was. Returns "" or what is wrong, a sentence.
[[nodiscard]] std::string read_made(const Folder& folder, const Made& made, std::vector<unsigned char>& bytes);

// Writes a file and says what it is.
[[nodiscard]] std::string write_made(const Folder& folder, const std::string& name, const void* bytes, std::size_t size,
                                     Made& made);

// JSON as a file of the job, with the checksum of all else in it: `check` is the last of its values. parse_checked() returns
// whether it is that.
[[nodiscard]] std::string checked_text(const Json& values);
[[nodiscard]] bool parse_checked(const std::vector<unsigned char>& text, Json& values);

}  // namespace job

#endif  // HMESH_JOB_RECEIPT_HPP
