// job - Folder: the files of a job, all in one folder, each written whole or not at all.
//
// A file is written beside its place, put on the disk and then given its name: whoever sees the name sees all of the file, after
// a kill, a power cut or a full disk, too, and two workers that write one file at once leave the one's or the other's. Names are
// paths from the job's folder on. Nothing outside of it is written: a file that a link leads out of it is refused.
#ifndef HMESH_JOB_FOLDER_HPP
#define HMESH_JOB_FOLDER_HPP

#include <string>
#include <utility>
#include <vector>

namespace job {

class Folder {
  public:
    explicit Folder(std::string path) : path_(std::move(path)) {}

    [[nodiscard]] const std::string& path() const noexcept { return path_; }
    // The path of a file of the job.
    [[nodiscard]] std::string path(const std::string& name) const;
    [[nodiscard]] bool has(const std::string& name) const;

    // What returns a string returns "" or what is wrong, a sentence.
    [[nodiscard]] std::string write(const std::string& name, const void* bytes, std::size_t size) const {
        return write(name, bytes, size, true);
    }
    [[nodiscard]] std::string write(const std::string& name, const std::string& text) const {
        return write(name, text.data(), text.size());
    }
    // The same unless there is one of that name by now, of another worker's: that one stays.
    [[nodiscard]] std::string write_new(const std::string& name, const std::string& text) const {
        return write(name, text.data(), text.size(), false);
    }
    [[nodiscard]] std::string read(const std::string& name, std::vector<unsigned char>& bytes) const;
    // Whether it is there or not.
    [[nodiscard]] std::string remove(const std::string& name) const;

  private:
    [[nodiscard]] std::string write(const std::string& name, const void* bytes, std::size_t size, bool replaces) const;

    std::string path_;
};

}  // namespace job

#endif  // HMESH_JOB_FOLDER_HPP
