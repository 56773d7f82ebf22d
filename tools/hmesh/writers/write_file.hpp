// tools - writes one file whole or not at all, and says why not as a sentence.
#ifndef HMESH_TOOLS_WRITERS_WRITE_FILE_HPP
#define HMESH_TOOLS_WRITERS_WRITE_FILE_HPP

#include <string>

#include "terminal/progress_bar.hpp"
#include "terminal/progress_watch.hpp"
#include "terminal/standard_streams.hpp"
#include "writers/output_file.hpp"

namespace tool {

// Writes one file whole: write(OutputFile&) gives its bytes and returns "" or what went wrong.
template <class Write>
[[nodiscard]] std::string write_file(const std::string& name, Write&& write) {
    if (is_standard(name)) wipe_bar();  // both may be one terminal
    OutputFile file(name);
    std::string why = file.open() ? write(file) : file.error();
    if (!file.error().empty()) why = file.error();
    if (why.empty() && interrupted) why = "interrupted";
    if (why.empty() && !file.commit()) why = file.error();
    return why.empty() ? "" : "cannot write " + (is_standard(name) ? "to the standard output" : "'" + name + "'") + ": " + why;
}

[[nodiscard]] inline std::string write_text(const std::string& name, const std::string& text) {
    return write_file(name, [&](OutputFile& file) { return file(text.data(), text.size()) ? "" : "the disk refused it"; });
}

}  // namespace tool

#endif  // HMESH_TOOLS_WRITERS_WRITE_FILE_HPP
