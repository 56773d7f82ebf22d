// tools - what the command says of a mesh that it has made: lines for one image, one line for each of several.
#ifndef HMESH_TOOLS_RESULTS_SUMMARY_HPP
#define HMESH_TOOLS_RESULTS_SUMMARY_HPP

#include <cstdio>
#include <optional>
#include <vector>

#include "arguments/arguments.hpp"
#include "readers/image_file.hpp"
#include "results/made.hpp"

namespace tool {

void print_summary(std::FILE* to, const Arguments& arguments, const ImageFile& image, const Made& made);

void print_line(std::FILE* to, const Arguments& arguments, const ImageFile& image, const Made& made);

}  // namespace tool

#endif  // HMESH_TOOLS_RESULTS_SUMMARY_HPP
