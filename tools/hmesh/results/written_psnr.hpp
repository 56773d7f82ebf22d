// tools - the PSNR that the files have which are written, as whoever reads them measures it: their own numbers, with the bits
// that their formats keep, drawn as the formats say.
#ifndef HMESH_TOOLS_RESULTS_WRITTEN_PSNR_HPP
#define HMESH_TOOLS_RESULTS_WRITTEN_PSNR_HPP

#include <optional>
#include <string>
#include <vector>

#include "arguments/arguments.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "meshing.hpp"
#include "readers/image_file.hpp"

namespace tool {

struct WrittenPsnr {
    std::string file;
    std::string ending;  // that of its format: ".png" of a picture
    double psnr = 0;     // dB
};

// The mesh files that hold the mesh's numbers, and the picture of --render at the size of the image. Left out are .svg whose
// faces have one gradient or colour, which is another picture, and .obj and .eps of images with alpha, which they do not keep.
class WrittenFiles {
  public:
    // All arguments outlive this object; `options` are those of the mesh, with weights.
    WrittenFiles(const Arguments& arguments, const ImageFile& image, const MeshingOptions& options,
                 const hmesh::ParallelFor& parallel_for)
        : arguments_(arguments), image_(image), options_(options), parallel_for_(parallel_for) {}

    // Of a finished mesh. `psnr` is its own, drawn as --fit-space says; `light`: its twin for .glb, where there is one.
    [[nodiscard]] std::vector<WrittenPsnr> measure(const hmesh::Mesh& mesh, double psnr,
                                                   const std::optional<LightMesh>& light) const;

    // Of a mesh within a search, whose colours are not fitted for linear light yet: the least of its own PSNR and those of the
    // files. See hmesh::Options::psnr_of.
    [[nodiscard]] double operator()(const hmesh::Mesh& mesh, double psnr) const;

  private:
    const Arguments& arguments_;
    const ImageFile& image_;
    const MeshingOptions& options_;
    const hmesh::ParallelFor& parallel_for_;
    mutable std::vector<float> wanted_;  // the image's samples; read when they are first needed
};

}  // namespace tool

#endif  // HMESH_TOOLS_RESULTS_WRITTEN_PSNR_HPP
