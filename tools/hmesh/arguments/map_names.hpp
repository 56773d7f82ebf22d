// tools - the names of the maps of a material: of rock_albedo.png and rock_normal.png they are albedo and normal.
#ifndef HMESH_TOOLS_ARGUMENTS_MAP_NAMES_HPP
#define HMESH_TOOLS_ARGUMENTS_MAP_NAMES_HPP

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "arguments/patterns.hpp"
#include "hmesh/io/channel_groups.hpp"

namespace tool {

namespace detail {

[[nodiscard]] inline bool is_separator(char c) { return c == '_' || c == '-' || c == '.' || c == ' '; }

// The length of the beginning that all names share, to the end of a word.
[[nodiscard]] inline std::size_t shared_words(const std::vector<std::string>& names) {
    const auto ends_word = [&](std::size_t length) {
        return std::all_of(names.begin(), names.end(), [&](const std::string& name) {
            return length == 0 || length == name.size() || is_separator(name[length]) || is_separator(name[length - 1]);
        });
    };
    std::size_t length = 0, shared = 0;
    const auto agree = [&](const std::string& name) { return length < name.size() && name[length] == names[0][length]; };
    while (std::all_of(names.begin(), names.end(), agree))
        if (ends_word(++length)) shared = length;
    return shared;
}

// Without separators before and behind, and with underscores for all that hmesh::ChannelGroup takes in no name.
[[nodiscard]] inline std::string as_name(std::string text) {
    while (!text.empty() && is_separator(text.back())) text.pop_back();
    text.erase(text.begin(), std::find_if_not(text.begin(), text.end(), is_separator));
    for (char& c : text)
        if (!hmesh::detail::is_name(std::string(1, c).c_str())) c = '_';
    return text;
}

}  // namespace detail

// A name for each file, the first of which is the colour: what its name has beyond the words that all begin with, or "color" of
// the first and "map" of others that have no more. A name that files give to positions and colours has "_map" behind it.
[[nodiscard]] inline std::vector<std::string> map_names(const std::vector<std::string>& files) {
    std::vector<std::string> names;
    names.reserve(files.size());
    for (const std::string& file : files) names.push_back(image_name(file));
    const std::size_t shared = detail::shared_words(names);
    for (std::size_t i = 0; i < names.size(); ++i) {
        names[i] = detail::as_name(names[i].substr(shared));
        if (names[i].empty()) names[i] = i == 0 ? "color" : "map";
        if (hmesh::detail::is_reserved_name(names[i].c_str())) names[i] += "_map";
    }
    return names;
}

// Whether a map of this name is a normal: normal, normals, or a name that ends so.
[[nodiscard]] inline bool is_normal_map(const std::string& name) {
    for (const std::string end : {"normal", "normals"})
        if (name.size() >= end.size() && hmesh::detail::is_same_name(name.c_str() + name.size() - end.size(), end.c_str()))
            return true;
    return false;
}

}  // namespace tool

#endif  // HMESH_TOOLS_ARGUMENTS_MAP_NAMES_HPP
