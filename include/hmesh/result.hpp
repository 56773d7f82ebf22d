/// \file
/// Result: what mesh_image() returns, a mesh with its error and a status.
#ifndef HMESH_RESULT_HPP
#define HMESH_RESULT_HPP

#include <cstddef>
#include <vector>

#include "hmesh/core/progress.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/mesh/mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// Size and error of a mesh. The error is that of the mesh drawn at its own size, colours neither rounded nor clamped after
/// interpolation, against the image's stored values (against the premultiplied image where Options::premultiplied is set). With
/// weights, a pixel counts with its weight / the largest weight, and so does a channel, in `energy` as in the mean.
struct Report {
    std::size_t vertices = 0;  ///< number of vertices; of a periodic mesh a vertex and its copies on the border count once
    std::size_t faces = 0;     ///< number of faces
    double energy = 0;         ///< sum of squared differences over pixels and channels, in squares of stored values
    /// PSNR in dB, 10 log10(peak^2 / MSE), with the MSE the mean over pixels AND channels; infinity for MSE 0.
    double psnr = 0;
    std::vector<StageReport> stages;  ///< size and error after each stage of the method, in order
    /// Largest |mesh - sample| over pixels and channels, in stored values; those of weight 0 do not count, and other weights do
    /// not change it.
    double max_error = 0;
};

/// What mesh_image() returns. A status that is not ok may come with a good mesh (has_mesh()): the nearest one to a PSNR that
/// was not reached, or the one reached when the work was cancelled.
struct [[nodiscard]] Result {
    Mesh mesh;      ///< a valid mesh whatever the status, or empty
    Report report;  ///< size and error of `mesh`
    Status status;  ///< ok, or why not

    /// Whether there is a mesh, whatever the status.
    [[nodiscard]] bool has_mesh() const noexcept { return !mesh.faces.empty(); }
};

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_RESULT_HPP
