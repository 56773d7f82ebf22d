// tools - depfile(): the rule of a makefile that says what a run of the command has read to write what it has written.
// make, Ninja and CMake read it and run the command again when one of the files has changed.
#ifndef HMESH_TOOLS_WRITERS_DEPFILE_HPP
#define HMESH_TOOLS_WRITERS_DEPFILE_HPP

#include <string>
#include <vector>

namespace tool {
namespace detail {

// A name as makefiles have it: a backslash before blanks and #, a dollar doubled. Ninja reads it alike.
[[nodiscard]] inline std::string make_name(const std::string& name) {
    std::string out;
    for (const char c : name) {
        if (c == ' ' || c == '#') out += '\\';
        if (c == '$') out += '$';
        out += c;
    }
    return out;
}

}  // namespace detail

[[nodiscard]] inline std::string depfile(const std::vector<std::string>& written, const std::vector<std::string>& read) {
    std::string rule;
    for (const std::string& name : written) rule += detail::make_name(name) + (&name == &written.back() ? ":" : " ");
    for (const std::string& name : read) rule += " \\\n  " + detail::make_name(name);
    return rule + "\n";
}

}  // namespace tool

#endif  // HMESH_TOOLS_WRITERS_DEPFILE_HPP
