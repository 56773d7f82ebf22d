// tools - the command's report as JSON (RFC 8259). An infinite PSNR is the string "inf"; seconds that were not measured are
// null; what is no UTF-8 in names of files is replaced.
#ifndef HMESH_TOOLS_RESULTS_REPORT_HPP
#define HMESH_TOOLS_RESULTS_REPORT_HPP

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "arguments/arguments.hpp"
#include "hmesh/outline.hpp"
#include "meshing.hpp"
#include "readers/image_file.hpp"
#include "results/made.hpp"
#include "terminal/progress_watch.hpp"

namespace tool {

// What the PSNR of a mesh made with these arguments is, for people.
[[nodiscard]] std::string psnr_formula(const Arguments& arguments);

enum class Layout : std::uint8_t { indented, one_line };

// Ends with a line feed.
[[nodiscard]] std::string report_json(const Arguments& arguments, const ImageFile& image, const Made& made,
                                      const ProgressWatch& watch, Layout layout);

// The same of an outline.
[[nodiscard]] std::string outline_json(const Arguments& arguments, const ImageFile& image, const hmesh::Outline& outline,
                                       double seconds, Layout layout);

// The line in its place where there is no mesh: why not.
[[nodiscard]] std::string failure_json(const Arguments& arguments, const std::string& why);

}  // namespace tool

#endif  // HMESH_TOOLS_RESULTS_REPORT_HPP
