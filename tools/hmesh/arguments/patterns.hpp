// tools - names of files that hold {name}, which stands for the name of the image: of in/rock.png it is rock; or {lod}, which
// stands for the number of a level of detail.
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

// What stands for the mark is not looked through again: a name may hold braces.
[[nodiscard]] inline std::string expand(const std::string& pattern, const std::string& name,
                                        const std::string& mark = name_mark) {
    std::string out;
    std::size_t from = 0;
    for (std::size_t at = 0; (at = pattern.find(mark, from)) != std::string::npos; from = at + mark.size())
        out.append(pattern, from, at - from).append(name);
    return out + pattern.substr(from);
}

inline constexpr char level_mark[] = "{lod}";

[[nodiscard]] inline bool has_level_mark(const std::string& file) { return file.find(level_mark) != std::string::npos; }

// The file of a level of detail: its number stands for {lod}; without that, _lod1 and so on come before the ending of all but the
// finest.
[[nodiscard]] inline std::string level_file(const std::string& file, int level) {
    if (has_level_mark(file)) return expand(file, std::to_string(level), level_mark);
    if (level == 0) return file;
    const std::filesystem::path path(file);
    const std::string name = path.stem().string() + "_lod" + std::to_string(level) + path.extension().string();
    return (path.parent_path() / name).string();
}

}  // namespace tool

#endif  // HMESH_TOOLS_ARGUMENTS_PATTERNS_HPP
