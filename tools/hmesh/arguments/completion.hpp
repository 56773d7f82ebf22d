// tools - completion of a command line: scripts for bash, zsh and fish. They offer options, the values of those that have a
// few, and files.
#ifndef HMESH_TOOLS_ARGUMENTS_COMPLETION_HPP
#define HMESH_TOOLS_ARGUMENTS_COMPLETION_HPP

#include <cstdint>
#include <string>

#include "arguments/command_words.hpp"
#include "arguments/named.hpp"

namespace tool {

enum class Shell : std::uint8_t { bash, zsh, fish };

inline constexpr Named<Shell> shells[] = {{"bash", Shell::bash}, {"zsh", Shell::zsh}, {"fish", Shell::fish}};

[[nodiscard]] std::string completion(const CommandWords& words, Shell shell);

}  // namespace tool

#endif  // HMESH_TOOLS_ARGUMENTS_COMPLETION_HPP
