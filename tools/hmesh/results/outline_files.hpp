// tools - the files of an outline, for the image as their texture, and what is said of it.
#ifndef HMESH_TOOLS_RESULTS_OUTLINE_FILES_HPP
#define HMESH_TOOLS_RESULTS_OUTLINE_FILES_HPP

#include <cstdio>
#include <string>

#include "arguments/arguments.hpp"
#include "hmesh/outline.hpp"
#include "readers/image_file.hpp"
#include "results/report.hpp"
#include "writers/output_set.hpp"

namespace tool {

// Writes all files, or none (OutputSet). Returns "" or what went wrong.
[[nodiscard]] std::string write_outline_files(const Arguments& arguments, const ImageFile& image, const hmesh::Outline& outline,
                                              const std::string& report, OutputSet& files);

// Lines for one image, or one line for each of several.
void print_outline(std::FILE* to, const Arguments& arguments, const ImageFile& image, const hmesh::Outline& outline,
                   bool is_one_of_several, double seconds);

}  // namespace tool

#endif  // HMESH_TOOLS_RESULTS_OUTLINE_FILES_HPP
