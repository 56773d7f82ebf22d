/// \file
/// Result: what mesh_image() gives back, a mesh and what is known of it.
#ifndef HMESH_RESULT_HPP
#define HMESH_RESULT_HPP

#include <cstddef>
#include <vector>

#include "hmesh/core/progress.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/mesh/mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// What is known of a mesh. PSNR = 10 log10(peak^2 / MSE), MSE the mean over pixels AND channels of the squared difference in
/// stored values between the image and the mesh drawn at its size, colours neither rounded nor clamped after interpolation;
/// infinity for MSE 0. Of the premultiplied image where Options says so. With weights, each pixel counts in `energy` and in the
/// mean as often as its weight over the largest says.
struct Report {
    std::size_t vertices = 0;         ///< of the mesh
    std::size_t faces = 0;            ///< of the mesh
    double energy = 0;                ///< the sum of squared differences over pixels and channels
    double psnr = 0;                  ///< dB
    std::vector<StageReport> stages;  ///< what each stage left behind, in order
};

/// What mesh_image() gives back. A status that is not ok may come with a good mesh all the same: the nearest to a PSNR that was
/// not reached, or what there was when the work was cancelled.
struct [[nodiscard]] Result {
    Mesh mesh;      ///< valid whatever the status, or empty
    Report report;  ///< true of the mesh
    Status status;  ///< ok, or why not

    /// Whether there is a mesh, whatever the status.
    [[nodiscard]] bool has_mesh() const noexcept { return !mesh.faces.empty(); }
};

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_RESULT_HPP
