// tools - endings of files' names, by which formats are known.
#ifndef HMESH_TOOLS_WRITERS_ENDING_HPP
#define HMESH_TOOLS_WRITERS_ENDING_HPP

#include <cstddef>
#include <filesystem>
#include <string>
#include <system_error>

namespace tool {

// Whether the name ends so, in lower or upper case, and has more before it. The ending is in lower case.
[[nodiscard]] inline bool has_ending(const std::string& name, const std::string& ending) {
    if (name.size() <= ending.size() || name[name.size() - ending.size() - 1] == '/') return false;
    for (std::size_t i = 0; i < ending.size(); ++i) {
        const char c = name[name.size() - ending.size() + i];
        if ((c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c) != ending[i]) return false;
    }
    return true;
}

// Whether a name that ends in no format may be meant for a folder: it is there as one, ends in a slash, or has no ending at all.
// That of "out/.ply" is one with nothing before it.
[[nodiscard]] inline bool may_be_folder(const std::string& name) {
    const std::string last = std::filesystem::path(name).filename().string();
    std::error_code none;
    return last.find('.') == std::string::npos || last == "." || last == ".." || std::filesystem::is_directory(name, none);
}

}  // namespace tool

#endif  // HMESH_TOOLS_WRITERS_ENDING_HPP
