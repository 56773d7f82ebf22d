// tools - endings of files' names, by which formats are known.
#ifndef HMESH_TOOLS_WRITERS_ENDING_HPP
#define HMESH_TOOLS_WRITERS_ENDING_HPP

#include <cstddef>
#include <string>

namespace tool {

// Whether the name ends so, in lower or upper case, and has more before it. The ending is in lower case.
[[nodiscard]] inline bool has_ending(const std::string& name, const std::string& ending) {
    if (name.size() <= ending.size()) return false;
    for (std::size_t i = 0; i < ending.size(); ++i) {
        const char c = name[name.size() - ending.size() + i];
        if ((c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c) != ending[i]) return false;
    }
    return true;
}

}  // namespace tool

#endif  // HMESH_TOOLS_WRITERS_ENDING_HPP
