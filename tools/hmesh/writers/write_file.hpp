// tools - writes one file whole or not at all, and says why not as a sentence.
#ifndef HMESH_TOOLS_WRITERS_WRITE_FILE_HPP
#define HMESH_TOOLS_WRITERS_WRITE_FILE_HPP

#include <string>
#include <utility>

#include "writers/output_set.hpp"

namespace tool {

// As OutputSet::write(), of a set of one.
template <class Write>
[[nodiscard]] std::string write_file(const std::string& name, Write&& write) {
    OutputSet files;
    const std::string why = files.write(name, std::forward<Write>(write));
    return why.empty() ? files.commit() : why;
}

[[nodiscard]] inline std::string write_text(const std::string& name, const std::string& text) {
    OutputSet files;
    const std::string why = files.write_text(name, text);
    return why.empty() ? files.commit() : why;
}

}  // namespace tool

#endif  // HMESH_TOOLS_WRITERS_WRITE_FILE_HPP
