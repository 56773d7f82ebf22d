/// \file
/// mesh_image(): turns an image into a mesh. The place to begin.
///
///     hmesh::ImageView<std::uint8_t, 3> view{pixels, width, height};
///     const hmesh::Result result = hmesh::mesh_image(view);                 // one vertex for 100 pixels
///     if (!result.has_mesh()) std::puts(hmesh::message(result.status).c_str());
///
/// The error that is minimised and reported is that of the final mesh as a GPU draws it, with positions on the 1/256 px grid
/// and colours rounded to the pixel type: the squared difference to the image's stored values (sRGB-encoded for usual files),
/// summed over pixels and channels.
///
/// Compiling a call takes seconds. A program of many files can define HMESH_COMPILED for all of them: they then see
/// declarations only, and one file, which defines HMESH_IMPLEMENTATION too, says HMESH_INSTANTIATE(std::uint8_t, 3) for each
/// kind of image in use.
#ifndef HMESH_MESH_IMAGE_HPP
#define HMESH_MESH_IMAGE_HPP

#include <type_traits>

#include "hmesh/core/compiler.hpp"
#include "hmesh/core/lanes.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/methods/annealed/options.hpp"
#include "hmesh/methods/recipe.hpp"
#include "hmesh/options.hpp"
#include "hmesh/result.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// Turns an image into a mesh of the number of vertices that options.target asks for.
///
/// \param view          the image, which check() must accept; 1 to 16 channels of 8-bit, 16-bit, float or own samples
/// \param options       number of vertices, and what else all methods share
/// \param recipe        the method with its options: Annealed, another one of the folder methods/, or one's own
///     (methods/recipe.hpp)
/// \param parallel_for  executor of the tiles and of the passes over pixels (core/parallel.hpp); by default the calling thread
/// \return              the mesh, its error, and a status:
///     - invalid_argument, image_too_large or not_finite where the image or an option is refused, a mesh to start from too
///       (no mesh);
///     - target_out_of_range for a number of vertices that the image cannot hold, or that the sides have more of by
///       Annealed::border_tolerance (no mesh), and for one that limits.position_step leaves no places for, or for a PSNR that no
///       mesh reached (with the nearest mesh);
///     - cancelled by options.progress (with the mesh reached so far).
///
/// The same image, options and recipe give the same bytes with any executor and any number of threads. Throws nothing of its
/// own; std::bad_alloc passes through.
///
/// Memory: 0.28 KB a vertex asked for with Effort::draft, 0.54 KB with normal, and 0.6 KB for each vertex placed in the tiles
/// at work. Of an image of up to 4194304 px (of 4 channels 3.3 million, of 16 1.3) all tiles are kept from phase to phase: 1.2
/// to 2.5 KB a vertex in all. Moment tables take 16 bytes a pixel for 8-bit RGB (64 beyond 4104 px of width), 92 with weights:
/// images of so many px are one table where they are 16384 px wide at most, 4096 with weights; of others, and of periodic ones,
/// each tile at work has its own. With recipes other than Annealed any image is one tile. Stack on each thread that works: 0.2 MB
/// for up to 4 channels, 0.5 MB for 16. Never inlined: all calls run the same instructions, so that they round alike.
template <class T, int C, class Recipe = Annealed, class = std::enable_if_t<kit::is_recipe<Recipe>>>
[[nodiscard]] HMESH_NEVER_INLINE Result mesh_image(const ImageView<T, C>& view, const Options& options = {},
                                                   const Recipe& recipe = {}, const ParallelFor& parallel_for = {});

/// mesh_image() by the default recipe, with an executor.
template <class T, int C>
[[nodiscard]] Result mesh_image(const ImageView<T, C>& view, const Options& options, const ParallelFor& parallel_for) {
    return mesh_image(view, options, Annealed(), parallel_for);
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

/// Compiles mesh_image() with the default recipe for images of C channels of type T. Only in the file that defines
/// HMESH_IMPLEMENTATION, outside of any namespace.
#define HMESH_INSTANTIATE(T, C) HMESH_INSTANTIATE_RECIPE(T, C, ::hmesh::Annealed)
/// Compiles mesh_image() with the recipe type RECIPE for images of C channels of type T, as HMESH_INSTANTIATE does for the
/// default one. Not for Bounded, which is compiled in each file that calls it.
#define HMESH_INSTANTIATE_RECIPE(T, C, RECIPE)                                                                         \
    template ::hmesh::Result hmesh::mesh_image<T, C, RECIPE>(const ::hmesh::ImageView<T, C>&, const ::hmesh::Options&, \
                                                             const RECIPE&, const ::hmesh::ParallelFor&);

#include "hmesh/mesh_image.ipp"

#endif  // HMESH_MESH_IMAGE_HPP
