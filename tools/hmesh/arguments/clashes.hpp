// tools - what is wrong with the names of all files of a run together, found before anything is read.
#ifndef HMESH_TOOLS_ARGUMENTS_CLASHES_HPP
#define HMESH_TOOLS_ARGUMENTS_CLASHES_HPP

#include <string>
#include <vector>

#include "arguments/arguments.hpp"

namespace tool {

// Whether an output would overwrite what is read or another output, an input is an output that was not finished, or a standard
// stream is named for two things, or is a terminal that would be shown no text. Devices may be named twice. Returns "" or a
// sentence.
[[nodiscard]] std::string find_clash(const std::vector<Arguments>& images);

}  // namespace tool

#endif  // HMESH_TOOLS_ARGUMENTS_CLASHES_HPP
