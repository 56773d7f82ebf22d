// tools - OutputFile: writes a file whole or not at all.
//
// The bytes go to a file beside the target, which takes the target's name and permissions when all of them are written. A program
// that is killed leaves it behind, and the next one uses it again. A target that exists and is no regular file (a device, a
// pipe) is written directly, and so is the standard output, whose name is "-"; a symbolic link is followed.
#ifndef HMESH_TOOLS_WRITERS_OUTPUT_FILE_HPP
#define HMESH_TOOLS_WRITERS_OUTPUT_FILE_HPP

#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <string>

namespace tool {

// The path or, where it is a link to a file that is to be made, that file's.
[[nodiscard]] std::string end_of_links(std::string path);

// One name of a file, which may be still to be made, by whatever links and folders it is named.
[[nodiscard]] std::string full_name(const std::string& path);

// Whether a file of this name is one that is being written, or that a killed program left behind: NAME.hmesh-part and a number.
[[nodiscard]] bool is_part(const std::string& name);
// The sentence about one that is to be read.
[[nodiscard]] inline std::string unfinished(const std::string& name) {
    return "'" + name + "' is what a run has not finished writing, and the next one writes over it";
}

class OutputFile {
  public:
    // Follows links and decides where the bytes go; opens nothing.
    explicit OutputFile(std::string path);
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;
    ~OutputFile() { discard(); }

    // Whether the file could be opened now: creates the file beside the target and removes it again.
    [[nodiscard]] bool is_writable();

    [[nodiscard]] bool open();
    // A sink, as the exporters of hmesh want it.
    [[nodiscard]] bool operator()(const void* bytes, std::size_t size);
    // Hands what was written to the system, which may find that there is no room for it.
    [[nodiscard]] bool flush();
    // Closes the file and gives it its name. A lasting one is on the disk then, and a power cut leaves it as it is.
    [[nodiscard]] bool commit(bool is_lasting = false) { return commit(is_lasting, true); }
    // The same of a lasting one, unless there is a file of that name by now, which stays as it is: true then, too.
    [[nodiscard]] bool commit_new() { return commit(true, false); }

    // Whether it is written directly, and has had its name all the time.
    [[nodiscard]] bool is_direct() const noexcept { return in_place_ || is_standard_; }
    // Why the last call returned false.
    [[nodiscard]] const std::string& error() const noexcept { return error_; }
    // Whether that was for want of the folder.
    [[nodiscard]] bool is_folder_missing() const noexcept { return reason_ == ENOENT; }

  private:
    [[nodiscard]] bool commit(bool is_lasting, bool replaces);
    [[nodiscard]] bool may_replace() const;
    void discard();
    bool fail(int why);

    std::FILE* file_ = nullptr;
    std::string target_, error_;
    std::string temporary_;  // the file beside the target while it exists, else empty
    int refusal_ = 0;        // why the target can be no file, as errno has it
    int reason_ = 0;         // of error_, as errno has it
    bool in_place_ = false;
    bool is_standard_ = false;  // the standard output, which stays open
};

}  // namespace tool

#endif  // HMESH_TOOLS_WRITERS_OUTPUT_FILE_HPP
