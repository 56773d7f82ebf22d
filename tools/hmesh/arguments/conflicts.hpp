// tools - what is wrong with a command line of which each option is right by itself.
#ifndef HMESH_TOOLS_ARGUMENTS_CONFLICTS_HPP
#define HMESH_TOOLS_ARGUMENTS_CONFLICTS_HPP

#include <functional>
#include <string>
#include <vector>

#include "arguments/arguments.hpp"

namespace tool {

// What a command line says, for all its images alike.
struct Said {
    std::function<bool(const char* option)> has;  // whether the option is given, as in "--rate"
    const std::vector<std::string>& inputs;
    const Arguments& arguments;
};

// An option that is given and makes a mesh, or compares it with an image; empty: there is none.
[[nodiscard]] std::string find_option_of_images(const Said& said);

// The sentence about that option, of an input that is a mesh.
[[nodiscard]] std::string means_nothing_to_mesh(const Arguments& arguments, const std::string& input);

// Returns "" or a sentence: options that exclude each other, or that lack what they are for.
[[nodiscard]] std::string find_conflict(const Said& said);

}  // namespace tool

#endif  // HMESH_TOOLS_ARGUMENTS_CONFLICTS_HPP
