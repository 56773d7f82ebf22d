// tools - OutputSet: the files of one run, all of which get their names or none.
//
// Each is written beside its place, and when all are, they are named one after the other, which a first interrupt does not stop:
// only a kill between two of them, or a name that the system refuses, leaves new ones beside old ones. The standard output, pipes
// and devices are written at once. Folders that are to be made for the files are made when one is tried or written, again where
// another run that ended has taken an empty one away, and those that stay empty are removed.
#ifndef HMESH_TOOLS_WRITERS_OUTPUT_SET_HPP
#define HMESH_TOOLS_WRITERS_OUTPUT_SET_HPP

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "terminal/progress_bar.hpp"
#include "terminal/progress_watch.hpp"
#include "terminal/standard_streams.hpp"
#include "writers/new_folders.hpp"
#include "writers/output_file.hpp"

namespace tool {

class OutputSet {
  public:
    // With the folders to be made where they are not there.
    explicit OutputSet(std::vector<std::string> folders = {}) : folders_(std::move(folders)) {}

    // What returns a string returns "" or what went wrong, a sentence.

    // Whether these could be written now.
    [[nodiscard]] std::string test(const std::vector<std::string>& names) {
        for (const std::string& name : names) {
            OutputFile file(name);
            if (std::string why = open(name, file, &OutputFile::is_writable); !why.empty()) return why;
        }
        return {};
    }

    // Writes one: write(OutputFile&) gives its bytes and returns "" or what went wrong.
    template <class Write>
    [[nodiscard]] std::string write(const std::string& name, Write&& write) {
        if (is_standard(name)) wipe_bar();  // both may be one terminal
        auto file = std::make_unique<OutputFile>(name);
        if (std::string why = open(name, *file, &OutputFile::open); !why.empty()) return why;
        std::string why = write(*file);
        if (why.empty() && file->flush() && interrupted) why = "interrupted";
        if (!file->error().empty()) why = file->error();
        if (!why.empty()) return refusal(name, why);
        if (file->is_direct()) return file->commit() ? std::string() : refusal(name, file->error());
        files_.emplace_back(name, std::move(file));
        return {};
    }
    [[nodiscard]] std::string write_text(const std::string& name, const std::string& text) {
        return write(name, [&](OutputFile& file) { return file(text.data(), text.size()) ? "" : "the disk refused it"; });
    }

    // Names all that were written.
    [[nodiscard]] std::string commit() {
        for (auto& [name, file] : files_)
            if (!file->commit()) return refusal(name, file->error());
        files_.clear();
        return {};
    }

  private:
    // Again where another run takes its folder away in between.
    [[nodiscard]] std::string open(const std::string& name, OutputFile& file, bool (OutputFile::*try_to_open)()) {
        for (int tries = 1;; ++tries) {
            if (std::string why = make_folders(); !why.empty()) return why;
            if ((file.*try_to_open)()) return {};
            if (tries == 100 || folders_.empty() || !file.is_folder_missing()) return refusal(name, file.error());
        }
    }
    [[nodiscard]] std::string make_folders() {
        for (const std::string& folder : folders_)
            if (std::string why = made_.make(folder); !why.empty()) return why;
        return {};
    }
    [[nodiscard]] static std::string refusal(const std::string& name, const std::string& why) {
        return "cannot write " + (is_standard(name) ? "to the standard output" : "'" + name + "'") + ": " + why;
    }

    std::vector<std::string> folders_;
    NewFolders made_;  // outlives the files, which may be all that is in them
    std::vector<std::pair<std::string, std::unique_ptr<OutputFile>>> files_;
};

}  // namespace tool

#endif  // HMESH_TOOLS_WRITERS_OUTPUT_SET_HPP
