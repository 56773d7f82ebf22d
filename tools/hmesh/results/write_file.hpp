// tools - writes one file whole or not at all, and says why not as a sentence: texts, pictures, and the rule for make.
#ifndef HMESH_TOOLS_RESULTS_WRITE_FILE_HPP
#define HMESH_TOOLS_RESULTS_WRITE_FILE_HPP

#include <string>
#include <vector>

#include "arguments/arguments.hpp"
#include "terminal/progress_bar.hpp"
#include "terminal/progress_watch.hpp"
#include "terminal/standard_streams.hpp"
#include "terminal/words.hpp"
#include "writers/depfile.hpp"
#include "writers/output_file.hpp"
#include "writers/picture_file.hpp"
#include "writers/pictures.hpp"

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

// Writes a picture as PNG, unless drawing it ended with a status that is not ok.
[[nodiscard]] inline std::string write_picture(const std::string& name, const hmesh::Status& drawn, const Picture& picture) {
    if (!drawn) return "cannot draw '" + name + "': " + in_words(drawn);
    return write_file(name, [&](OutputFile& file) {
        return write_png(picture, file) ? "" : "it has more than 2^30 samples, or there is no memory";
    });
}

[[nodiscard]] inline std::string write_depfile(const Arguments& arguments) {
    std::vector<std::string> written = output_files(arguments), read = {arguments.input};
    written.pop_back();  // itself
    for (const OtherMap& other : arguments.others) read.push_back(other.file);
    if (!arguments.weights.empty()) read.push_back(arguments.weights);
    return write_text(arguments.depfile, depfile(written, read));
}

}  // namespace tool

#endif  // HMESH_TOOLS_RESULTS_WRITE_FILE_HPP
