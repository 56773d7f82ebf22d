// tools - depfile(): the rule of a makefile that says what a run of the command has read to write what it has written.
// make, Ninja and CMake read it and run the command again when one of the files has changed.
#ifndef HMESH_TOOLS_WRITERS_DEPFILE_HPP
#define HMESH_TOOLS_WRITERS_DEPFILE_HPP

#include <cstring>
#include <string>
#include <vector>

namespace tool {

// What no name in a makefile can hold: make takes it for a pattern, an assignment or the begin of a command, or Ninja ends a name
// there.
inline constexpr char foreign_to_make[] = R"(\ * ? [ ] % = ; | < > ^ & ~ ' " `)";

// Whether make and Ninja read a name as depfile() writes it.
[[nodiscard]] inline bool is_make_name(const std::string& name) {
    if (!name.empty() && name.back() == ')') return false;  // to make it is a member of an archive
    for (const char c : name)
        if (static_cast<unsigned char>(c) < ' ' || (c != ' ' && std::strchr(foreign_to_make, c) != nullptr)) return false;
    return true;
}

namespace detail {

// A name as makefiles have it: a backslash before blanks, # and :, a dollar doubled. Ninja reads it alike.
[[nodiscard]] inline std::string make_name(const std::string& name) {
    std::string out;
    for (const char c : name) {
        if (c == ' ' || c == '#' || c == ':') out += '\\';
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
