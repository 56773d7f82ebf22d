// tools - from types chosen at run time to hmesh's templates: meshes an ImageFile and draws the mesh, whatever the bits and
// channels of the file. What is told to the library stands in channels.hpp alone.
#ifndef HMESH_TOOLS_MESHING_HPP
#define HMESH_TOOLS_MESHING_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "hmesh/core/parallel.hpp"
#include "hmesh/core/progress.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/mesh/mesh_view.hpp"
#include "hmesh/methods/options.hpp"
#include "image_file.hpp"

namespace tool {

// How meshes are made. All but the first are there to be compared with: they know no effort, seed or tile.
enum class Method : std::uint8_t { annealed, hierarchical, xie, adams, adaptive_thinning };

// What a mesh is to be like.
struct MeshingOptions {
    hmesh::Target target;
    Method method = Method::annealed;
    hmesh::Effort effort = hmesh::Effort::normal;
    std::uint64_t seed = 1;
    int tile = 0;                         // px; 0: as the library chooses
    std::optional<hmesh::Colors> colors;  // none: those of the method
    hmesh::FitSpace fit_space = hmesh::FitSpace::stored;
    bool premultiplied = false;
    hmesh::ImageView<float, 1> weights;  // none: all pixels count the same
    hmesh::Progress progress;
};

// The colours that a mesh made with these options has.
[[nodiscard]] hmesh::Colors final_colors(const MeshingOptions& options) noexcept;

// What mesh_image() returns, with the number of channels known at run time.
struct Mesh {
    std::vector<float> positions, colors;
    std::vector<std::array<std::uint32_t, 3>> faces;
    int channels = 0, width = 0, height = 0;
    double peak = 0;
    bool premultiplied = false;

    [[nodiscard]] hmesh::MeshView view() const noexcept {
        return {positions.data(), colors.data(), faces.data(), positions.size() / 2, faces.size(), channels, width,
                height,           peak,          premultiplied};
    }
};
struct Report {
    std::size_t vertices = 0, faces = 0;
    double energy = 0, psnr = 0;
    std::vector<hmesh::StageReport> stages;
};
struct Outcome {
    Mesh mesh;
    Report report;
    hmesh::Status status;

    [[nodiscard]] bool has_mesh() const noexcept { return !mesh.faces.empty(); }
};

[[nodiscard]] Outcome mesh_file(const ImageFile& image, const MeshingOptions& options, const hmesh::ParallelFor& parallel_for);

struct DrawOptions {
    int scale = 1;              // picture over mesh
    bool linear_light = false;  // see hmesh::RenderOptions
};

// The mesh drawn at 8 bits, with as many channels as it has, straight colours.
[[nodiscard]] hmesh::Status draw(const hmesh::MeshView& mesh, const DrawOptions& options, Picture& picture);

namespace detail {

// Defined in channels.hpp, compiled in channels_grey.cpp and channels_color.cpp.
template <int C>
[[nodiscard]] Outcome mesh_channels(const ImageFile& image, const MeshingOptions& options,
                                    const hmesh::ParallelFor& parallel_for);
template <int C>
[[nodiscard]] hmesh::Status draw_channels(const hmesh::MeshView& mesh, const DrawOptions& options, Picture& picture);

}  // namespace detail
}  // namespace tool

#endif  // HMESH_TOOLS_MESHING_HPP
