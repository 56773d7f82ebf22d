/// \file
/// Recipes: what mesh_image() wants of a method, and how to write one of your own (examples/own_method.cpp does).
///
/// A recipe is a struct of options with these members:
///
///     static constexpr const char* name = "grid";                     // for reports
///     static constexpr hmesh::Colors colors = hmesh::Colors::optimal; // what colors vertices end with by default
///     hmesh::Status check(int width, int height) const;               // refuses options, or sizes of images
///     double tile_size(int width, int height, std::size_t n) const;   // px, for the final colors; the longer side: one piece
///     template <int C> hmesh::Status run(hmesh::kit::TiledMesh<C>& mesh, std::size_t n) const;
///
/// run() makes a mesh of exactly n vertices of mesh.source(), 4 <= n <= max(4, pixels), in place of what `mesh` held, and says
/// whether it was finished; cancelled, it leaves a valid mesh. It may also be declared with the image between its two arguments,
/// `template <class T, int C> run(TiledMesh<C>&, const ImageView<T, C>&, std::size_t)`, where it wants the pixels themselves.
/// mesh_image() does the rest: checks, premultiplication, weights, the search for a PSNR, final colors, the report. What it works
/// with are the building blocks of hmesh::kit, which are public, documented, and free to change before version 1.
#ifndef HMESH_METHODS_RECIPE_HPP
#define HMESH_METHODS_RECIPE_HPP

#include <cstddef>
#include <type_traits>
#include <utility>

#include "hmesh/image/image_view.hpp"
#include "hmesh/options.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

template <class Recipe, class = void>
inline constexpr bool is_recipe = false;
/// Whether a type names itself and its colors as recipes do.
template <class Recipe>
inline constexpr bool is_recipe<Recipe, std::enable_if_t<std::is_same_v<std::remove_const_t<decltype(Recipe::colors)>, Colors> &&
                                                         std::is_convertible_v<decltype(Recipe::name), const char*>>> = true;

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_RECIPE_HPP
