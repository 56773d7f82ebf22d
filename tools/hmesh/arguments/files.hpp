// tools - the files that a command line names: which are read, which are written, and what stands in them for {name} and {lod}.
#ifndef HMESH_TOOLS_ARGUMENTS_FILES_HPP
#define HMESH_TOOLS_ARGUMENTS_FILES_HPP

#include <string>
#include <vector>

#include "arguments/arguments.hpp"

namespace tool {

// The pictures of --render: one, or where there are several maps one for each, with its name before the ending.
[[nodiscard]] std::vector<std::string> render_files(const Arguments& arguments);

// Every file that the command writes for this image.
[[nodiscard]] std::vector<std::string> output_files(const Arguments& arguments);

// Every file that it reads for it, the image first.
[[nodiscard]] std::vector<std::string> input_files(const Arguments& arguments);

// Whether the standard output is one of them.
[[nodiscard]] bool writes_standard_output(const Arguments& arguments);

// Whether a mesh is to be written with this ending.
[[nodiscard]] bool has_output(const Arguments& arguments, const std::string& ending);

// Whether {name} stands in a file's name.
[[nodiscard]] bool has_pattern(const Arguments& arguments);

// The arguments of one image, of those that all images share: its name stands in place of {name}, files of levels of detail and
// of materials have names, and so do the folders that are to be made.
[[nodiscard]] Arguments for_image(Arguments all, const std::string& input);

// Gives the maps names. Returns "" or what is wrong with them, as a sentence.
[[nodiscard]] std::string name_maps(Arguments& arguments);

}  // namespace tool

#endif  // HMESH_TOOLS_ARGUMENTS_FILES_HPP
