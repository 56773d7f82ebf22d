// tools - the manual page of a command, in section 1, from the words of the help: roff with the macros of man(7).
#ifndef HMESH_TOOLS_ARGUMENTS_MAN_PAGE_HPP
#define HMESH_TOOLS_ARGUMENTS_MAN_PAGE_HPP

#include <string>

#include "arguments/command_words.hpp"

namespace tool {

[[nodiscard]] std::string man_page(const CommandWords& words);

}  // namespace tool

#endif  // HMESH_TOOLS_ARGUMENTS_MAN_PAGE_HPP
