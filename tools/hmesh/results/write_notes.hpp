// tools - writes what is said of a run: its report, and its rule for make.
#ifndef HMESH_TOOLS_RESULTS_WRITE_NOTES_HPP
#define HMESH_TOOLS_RESULTS_WRITE_NOTES_HPP

#include <string>
#include <vector>

#include "arguments/arguments.hpp"
#include "arguments/files.hpp"
#include "writers/depfile.hpp"
#include "writers/output_set.hpp"

namespace tool {

// Those that are asked for. `report`: the report's text. Returns "" or what went wrong, a sentence.
[[nodiscard]] inline std::string write_notes(OutputSet& files, const Arguments& arguments, const std::string& report) {
    if (!arguments.report.empty())
        if (std::string why = files.write_text(arguments.report, report); !why.empty()) return why;
    if (arguments.depfile.empty()) return {};
    std::vector<std::string> written = output_files(arguments);
    written.pop_back();  // itself
    return files.write_text(arguments.depfile, depfile(written, input_files(arguments)));
}

}  // namespace tool

#endif  // HMESH_TOOLS_RESULTS_WRITE_NOTES_HPP
