// tools - from types chosen at run time to hmesh's templates: meshes an ImageFile and draws the mesh, whatever the bits and
// channels of the file.
#ifndef HMESH_TOOLS_MESHING_HPP
#define HMESH_TOOLS_MESHING_HPP

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hmesh/core/parallel.hpp"
#include "hmesh/core/progress.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/lods/mesh_lods.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/methods/annealed/options.hpp"
#include "hmesh/options.hpp"
#include "hmesh/outline.hpp"
#include "hmesh/result.hpp"
#include "hmesh/sprite.hpp"
#include "readers/image_file.hpp"
#include "writers/picture_file.hpp"

namespace tool {

// How meshes are made. All but the first are there to be compared with: they know no effort, seed or tile.
enum class Method : std::uint8_t { annealed, hierarchical, xie, adams, adaptive_thinning };

// Between which values of the vertices programs that show the mesh are to interpolate: each as its file's format says.
enum class FitSpace : std::uint8_t { stored, linear, each };

// What a mesh is to be like.
struct MeshingOptions {
    hmesh::Target target;
    Method method = Method::annealed;
    hmesh::Effort effort = hmesh::Effort::normal;
    std::uint64_t seed = 1;
    int tile = 0;                         // px; 0: as the library chooses
    int levels = 1;                       // of detail, the mesh included
    std::optional<hmesh::Colors> colors;  // none: those of the method
    FitSpace fit_space = FitSpace::stored;
    bool premultiplied = false;
    hmesh::Periodic periodic = hmesh::Periodic::none;
    bool straight_border = false;  // of a periodic mesh
    hmesh::Samples samples = hmesh::Samples::squares;
    std::optional<double> border_tolerance;  // see hmesh::Annealed
    double position_step = 1.0 / 256;        // px: see hmesh::MeshLimits
    std::vector<double> channel_weights;     // one for each channel; empty: all alike
    std::size_t bytes = 0;                   // the most of the compact file that the mesh is made for; 0: of none
    bool start_table = true;                 // whether that begins with what photographs have taught
    double transparent = -1;             // 255ths of alpha of faces that drop_faces() drops, which searches count; below 0: none
    const hmesh::Mesh* start = nullptr;  // a mesh to bring to the target without more ado; null: none
    hmesh::ImageView<float, 1> weights;  // none: all pixels count the same
    hmesh::Progress progress;
    // What a search for a PSNR goes by, as hmesh::Options::psnr_of; the mesh has its final colours but those for linear light.
    hmesh::FunctionRef<double(const hmesh::Mesh& mesh, double psnr)> psnr_of;
};

// About how long the mesh takes, in microseconds of one core.
[[nodiscard]] double meshing_work(const ImageFile& image, const MeshingOptions& options) noexcept;
// The same of colours for linear light.
[[nodiscard]] double light_work(const ImageFile& image) noexcept;

// The colours that a mesh made with these options has.
[[nodiscard]] hmesh::Colors final_colors(const MeshingOptions& options) noexcept;

// What is wrong with options that are right each by itself, a sentence; empty: nothing.
[[nodiscard]] std::string find_conflict(const MeshingOptions& options);

// All levels of detail. Without any, the status says why.
[[nodiscard]] hmesh::Lods mesh_levels(const ImageFile& image, const MeshingOptions& options,
                                      const hmesh::ParallelFor& parallel_for);
// The first of them, which leaves them, with the status of all.
[[nodiscard]] hmesh::Result first_level(hmesh::Lods& lods);
// The same without the others.
[[nodiscard]] hmesh::Result mesh_file(const ImageFile& image, const MeshingOptions& options,
                                      const hmesh::ParallelFor& parallel_for);

// The mesh of a compact file of at most options.bytes bytes, 1 or more, and that file. Of images of 8 bits alone.
[[nodiscard]] hmesh::Result fit_bytes(const ImageFile& image, const MeshingOptions& options,
                                      const hmesh::ParallelFor& parallel_for, std::vector<unsigned char>& file);

// Drops the faces of a mesh made with these options that show nothing, those of at most options.transparent.
hmesh::SpriteReport drop_faces(const ImageFile& image, const MeshingOptions& options, hmesh::Result& outcome,
                               const hmesh::ParallelFor& parallel_for);

// Few vertices around the image's pixels.
[[nodiscard]] hmesh::Outline outline_file(const ImageFile& image, const hmesh::OutlineOptions& options);

// A mesh for programs that interpolate linear light.
struct LightMesh {
    hmesh::Mesh mesh;
    double psnr = 0;         // dB, drawn so
    double stored_psnr = 0;  // dB, of the mesh that it was made from, drawn so
};

// The same mesh with colours that are fitted for linear light; straight colours alone.
[[nodiscard]] LightMesh light_mesh(const ImageFile& image, const MeshingOptions& options, const hmesh::Mesh& mesh,
                                   const hmesh::ParallelFor& parallel_for);

struct DrawOptions {
    int scale = 1;              // picture over mesh
    bool linear_light = false;  // see hmesh::RenderOptions
};

// The image's samples in stored values, colours times alpha where `premultiplied`.
[[nodiscard]] std::vector<float> wanted_samples(const ImageFile& image, bool premultiplied,
                                                const hmesh::ParallelFor& parallel_for);

// The mesh drawn at its own size, in stored values with as many channels as it has, not rounded.
[[nodiscard]] hmesh::Status draw_samples(const hmesh::MeshView& mesh, bool linear_light, std::vector<float>& samples,
                                         const hmesh::ParallelFor& parallel_for = {});

// The mesh drawn at 8 bits, with as many channels as it has, straight colours.
[[nodiscard]] hmesh::Status draw(const hmesh::MeshView& mesh, const DrawOptions& options, Picture& picture);

}  // namespace tool

#endif  // HMESH_TOOLS_MESHING_HPP
