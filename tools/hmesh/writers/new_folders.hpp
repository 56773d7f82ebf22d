// tools - NewFolders: makes folders for what a run writes, and leaves none behind that stayed empty.
#ifndef HMESH_TOOLS_WRITERS_NEW_FOLDERS_HPP
#define HMESH_TOOLS_WRITERS_NEW_FOLDERS_HPP

#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

namespace tool {

class NewFolders {
  public:
    NewFolders() = default;
    NewFolders(const NewFolders&) = delete;
    NewFolders& operator=(const NewFolders&) = delete;
    ~NewFolders() {
        std::error_code is_used;
        for (auto folder = made_.rbegin(); folder != made_.rend(); ++folder) std::filesystem::remove(*folder, is_used);
    }

    // The folder and those around it, where they are not there. Returns "" or why not, as a sentence.
    [[nodiscard]] std::string make(const std::filesystem::path& folder) {
        std::error_code code;
        for (int tries = 0; tries < 100; ++tries) {
            if (folder.empty() || std::filesystem::exists(folder, code)) return {};
            if (folder.has_relative_path() && folder.parent_path() != folder)
                if (std::string why = make(folder.parent_path()); !why.empty()) return why;
            if (std::filesystem::create_directory(folder, code)) made_.push_back(folder);
            if (code != std::errc::no_such_file_or_directory) break;  // another run has just taken one around it away
        }
        return code ? "cannot make the folder '" + folder.string() + "': " + code.message() : "";
    }

  private:
    std::vector<std::filesystem::path> made_;  // an outer one before those in it
};

}  // namespace tool

#endif  // HMESH_TOOLS_WRITERS_NEW_FOLDERS_HPP
