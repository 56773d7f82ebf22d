/// \file
/// mesh_lods(): levels of detail, meshes of n, n / 2, n / 4 .. vertices of one image.
///
///     const hmesh::Lods lods = hmesh::mesh_lods(view, options);   // five levels
///     for (const hmesh::Result& level : lods.levels) draw(level.mesh);
///
/// The first level is the mesh of mesh_image(). Each further one is made of the level before: the vertices whose loss raises the
/// error least are removed, and a few sweeps of annealing let those that are left find their places. Levels share no vertices:
/// each is as good as a mesh of its own. lods/progressive_mesh.hpp makes levels that share one vertex buffer.
///
/// Cost: of efforts normal, fine and fast, all coarser levels together take 0.3 to 0.55 of the processor time of as many meshes
/// of mesh_image(), as benchmarks/lods measures it: half of what the first level takes, or less. All of them share one moment
/// table.
#ifndef HMESH_LODS_MESH_LODS_HPP
#define HMESH_LODS_MESH_LODS_HPP

#include <vector>

#include "hmesh/core/compiler.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/mesh_image.hpp"
#include "hmesh/methods/annealed/options.hpp"
#include "hmesh/options.hpp"
#include "hmesh/result.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// Options of mesh_lods().
struct LodOptions {
    /// How many levels, the finest included, in [1, 32]. The chain ends before a level that would have less than 4 vertices, the
    /// corners of the image.
    int levels = 5;
};

/// Whether the options are in range; else Errc::invalid_argument with value and bound.
[[nodiscard]] HMESH_COLD inline Status check(const LodOptions& options) noexcept {
    if (options.levels < 1) return {Errc::invalid_argument, "there is at least 1 level of detail", options.levels, 1};
    if (options.levels > 32) return {Errc::invalid_argument, "there are at most 32 levels of detail", options.levels, 32};
    return {};
}

/// What mesh_lods() returns.
struct [[nodiscard]] Lods {
    std::vector<Result> levels;  ///< the finest first; each has a mesh
    Status status;               ///< ok, or why not all levels are there
};

/// Turns an image into levels of detail.
///
/// \param view          the image, as for mesh_image()
/// \param options       what all methods share; options.target is that of the finest level
/// \param lods          how many levels
/// \param recipe        the default recipe with its options, those of the finest level
/// \param parallel_for  executor, as for mesh_image(). Coarser levels are made in tiles of 384 px unless recipe.tile says
///     otherwise: those of small images are one piece of work, on one thread
/// \return              the levels, of n, n / 2, n / 4 .. vertices, rounded down, and a status:
///     - that of mesh_image() where the finest level fails (no levels);
///     - invalid_argument where the number of levels is refused (no levels);
///     - target_out_of_range where no mesh reached the PSNR asked for, or MeshLimits::position_step leaves no places for so many
///       vertices: the levels are those of the nearest mesh; or where it leaves none for those of a level, or a level would have
///       fewer vertices than the sides by Annealed::border_tolerance: those before it;
///     - cancelled by options.progress, with the levels that were finished; before there is one, with the mesh of the first as
///       it was, whose status is cancelled too.
///
/// ProgressInfo::total goes over all levels; a stage `collapse` begins each coarser one. The same input gives the same bytes with
/// any executor. Memory: that of mesh_image(), and the meshes.
template <class T, int C>
[[nodiscard]] HMESH_NEVER_INLINE Lods mesh_lods(const ImageView<T, C>& view, const Options& options = {},
                                                const LodOptions& lods = {}, const Annealed& recipe = {},
                                                const ParallelFor& parallel_for = {});

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

/// Compiles mesh_lods() for images of C channels of type T; where and why, see mesh_image.hpp. It needs HMESH_INSTANTIATE(T, C)
/// too.
#define HMESH_INSTANTIATE_LODS(T, C)                                                                        \
    template ::hmesh::Lods hmesh::mesh_lods<T, C>(const ::hmesh::ImageView<T, C>&, const ::hmesh::Options&, \
                                                  const ::hmesh::LodOptions&, const ::hmesh::Annealed&,     \
                                                  const ::hmesh::ParallelFor&);

#include "hmesh/lods/mesh_lods.ipp"

#endif  // HMESH_LODS_MESH_LODS_HPP
