// tools - writes all files of one image: meshes, pictures, report and depfile.
#ifndef HMESH_TOOLS_RESULTS_WRITING_HPP
#define HMESH_TOOLS_RESULTS_WRITING_HPP

#include <string>
#include <vector>

#include "arguments/arguments.hpp"
#include "readers/image_file.hpp"
#include "results/made.hpp"
#include "terminal/progress_watch.hpp"
#include "writers/output_set.hpp"

namespace tool {

// About how long write_files() and the colours of a .glb for linear light take, in microseconds of one core.
[[nodiscard]] double writing_work(const Arguments& arguments, const ImageFile& image);

// Writes all files, or none (OutputSet). `bytes` are those of the image's file, for .html; `report`: the report's text; `watch`
// is told of each file. Returns "" or what went wrong.
[[nodiscard]] std::string write_files(const Arguments& arguments, const ImageFile& image, const std::vector<unsigned char>& bytes,
                                      const Made& made, const std::string& report, OutputSet& files, ProgressWatch& watch);

}  // namespace tool

#endif  // HMESH_TOOLS_RESULTS_WRITING_HPP
