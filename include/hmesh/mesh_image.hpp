/// \file
/// mesh_image(): an image in, a mesh out. The place to begin.
///
///     hmesh::ImageView<std::uint8_t, 3> view{pixels, width, height};
///     const hmesh::Result result = hmesh::mesh_image(view);                 // one vertex for 100 pixels
///     if (!result.has_mesh()) std::puts(hmesh::message(result.status).c_str());
///
/// The error that is minimised and reported is that of the final mesh - positions on the 1/256 px grid, colours rounded to the
/// pixel type - as a GPU draws it: the squared difference in the image's stored values (sRGB-encoded for usual files), summed over
/// pixels and channels.
///
/// Compiling a call takes seconds. A program of many files defines HMESH_COMPILED for all of them: they then see declarations only,
/// and one file that defines HMESH_IMPLEMENTATION too says HMESH_INSTANTIATE(std::uint8_t, 3) for each kind of image in use.
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

/// Meshes an image.
///
/// \param view          the image, which check() must accept; 1 to 16 channels of 8-bit, 16-bit, float or own samples
/// \param options       how many vertices, and what else all methods share
/// \param recipe        the method and its options: Annealed, another one of methods/, or one's own (methods/recipe.hpp)
/// \param parallel_for  runs the tiles and the passes over pixels (core/parallel.hpp)
///
/// Same image, options and recipe give the same bytes, whatever the executor does.
///
/// Status: invalid_argument, image_too_large or not_finite where the image or an option is refused (no mesh);
/// target_out_of_range for a number of vertices that the image cannot hold (no mesh) or a PSNR that no mesh reached (the nearest
/// one is returned); cancelled by options.progress (the mesh reached so far is returned). std::bad_alloc passes through.
///
/// Memory: about 0.7 KB a vertex, and for each tile at work its moment table (32 bytes a pixel for 8-bit RGB, 92 with weights) and
/// 0.6 KB for each vertex placed there; a small image is one tile, and any image is for recipes other than Annealed. Stack, on each
/// thread that works: up to 4 channels 0.2 MB, for 16 channels 0.5 MB. Never inlined: all calls run the same instructions, so that
/// they round alike.
template <class T, int C, class Recipe = Annealed, class = std::enable_if_t<kit::is_recipe<Recipe>>>
[[nodiscard]] HMESH_NEVER_INLINE Result mesh_image(const ImageView<T, C>& view, const Options& options = {},
                                                   const Recipe& recipe = {}, const ParallelFor& parallel_for = {});

/// The same by the default recipe, on the user's threads.
template <class T, int C>
[[nodiscard]] Result mesh_image(const ImageView<T, C>& view, const Options& options, const ParallelFor& parallel_for) {
    return mesh_image(view, options, Annealed(), parallel_for);
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

/// Compiles mesh_image() for images of C channels of type T by the default recipe, in the file that defines HMESH_IMPLEMENTATION.
#define HMESH_INSTANTIATE(T, C) HMESH_INSTANTIATE_RECIPE(T, C, ::hmesh::Annealed)
/// The same by another recipe.
#define HMESH_INSTANTIATE_RECIPE(T, C, RECIPE)                                                                         \
    template ::hmesh::Result hmesh::mesh_image<T, C, RECIPE>(const ::hmesh::ImageView<T, C>&, const ::hmesh::Options&, \
                                                             const RECIPE&, const ::hmesh::ParallelFor&);

#include "hmesh/mesh_image.ipp"

#endif  // HMESH_MESH_IMAGE_HPP
