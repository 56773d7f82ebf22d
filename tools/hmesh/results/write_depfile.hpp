// tools - writes the rule for make of one run.
#ifndef HMESH_TOOLS_RESULTS_WRITE_DEPFILE_HPP
#define HMESH_TOOLS_RESULTS_WRITE_DEPFILE_HPP

#include <string>
#include <vector>

#include "arguments/arguments.hpp"
#include "writers/depfile.hpp"
#include "writers/write_file.hpp"

namespace tool {

[[nodiscard]] inline std::string write_depfile(const Arguments& arguments) {
    std::vector<std::string> written = output_files(arguments), read = {arguments.input};
    written.pop_back();  // itself
    for (const OtherMap& other : arguments.others) read.push_back(other.file);
    if (!arguments.weights.empty()) read.push_back(arguments.weights);
    return write_text(arguments.depfile, depfile(written, read));
}

}  // namespace tool

#endif  // HMESH_TOOLS_RESULTS_WRITE_DEPFILE_HPP
