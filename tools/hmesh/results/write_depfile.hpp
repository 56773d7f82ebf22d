// tools - writes the rule for make of one run.
#ifndef HMESH_TOOLS_RESULTS_WRITE_DEPFILE_HPP
#define HMESH_TOOLS_RESULTS_WRITE_DEPFILE_HPP

#include <string>
#include <vector>

#include "arguments/arguments.hpp"
#include "writers/depfile.hpp"
#include "writers/output_set.hpp"

namespace tool {

[[nodiscard]] inline std::string write_depfile(OutputSet& files, const Arguments& arguments) {
    std::vector<std::string> written = output_files(arguments);
    written.pop_back();  // itself
    return files.write_text(arguments.depfile, depfile(written, input_files(arguments)));
}

}  // namespace tool

#endif  // HMESH_TOOLS_RESULTS_WRITE_DEPFILE_HPP
