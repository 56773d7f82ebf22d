// tools - names of files that hold {name}, which stands for the name of the image: of in/rock.png it is rock.
#ifndef HMESH_TOOLS_ARGUMENTS_PATTERNS_HPP
#define HMESH_TOOLS_ARGUMENTS_PATTERNS_HPP

#include <cstddef>
#include <filesystem>
#include <string>

#include "terminal/standard_streams.hpp"

namespace tool {

inline constexpr char name_mark[] = "{name}";

[[nodiscard]] inline bool is_pattern(const std::string& file) { return file.find(name_mark) != std::string::npos; }

// Without its folder and its last ending; that of the standard input is "stdin". Empty: a folder, as in "in/".
[[nodiscard]] inline std::string image_name(const std::string& input) {
    return is_standard(input) ? "stdin" : std::filesystem::path(input).stem().string();
}

// What stands for {name} is not looked through again: a name may hold braces.
[[nodiscard]] inline std::string expand(const std::string& pattern, const std::string& name) {
    std::string out;
    std::size_t from = 0;
    for (std::size_t at = 0; (at = pattern.find(name_mark, from)) != std::string::npos; from = at + sizeof name_mark - 1)
        out.append(pattern, from, at - from).append(name);
    return out + pattern.substr(from);
}

}  // namespace tool

#endif  // HMESH_TOOLS_ARGUMENTS_PATTERNS_HPP
