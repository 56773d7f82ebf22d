// tools - what the command says of a mesh that it has made: lines for one image, one line for each of several.
#ifndef HMESH_TOOLS_RESULTS_SUMMARY_HPP
#define HMESH_TOOLS_RESULTS_SUMMARY_HPP

#include <cstdio>
#include <optional>
#include <vector>

#include "arguments/arguments.hpp"
#include "hmesh/result.hpp"
#include "hmesh/sprite.hpp"
#include "meshing.hpp"
#include "readers/image_file.hpp"
#include "results/written_psnr.hpp"

namespace tool {

void print_summary(std::FILE* to, const Arguments& arguments, const ImageFile& image, const hmesh::Result& outcome,
                   const std::optional<LightMesh>& light, const std::optional<hmesh::SpriteReport>& sprite,
                   const std::vector<WrittenPsnr>& written, double seconds);

void print_line(std::FILE* to, const Arguments& arguments, const ImageFile& image, const hmesh::Result& outcome, double seconds);

}  // namespace tool

#endif  // HMESH_TOOLS_RESULTS_SUMMARY_HPP
