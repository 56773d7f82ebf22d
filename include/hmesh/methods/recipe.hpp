/// \file
/// Recipes: the interface between mesh_image() and a method, and how to write a recipe of one's own (as examples/own_method.cpp
/// does).
///
/// A recipe is a struct whose data members are the method's options, with these members besides:
///
///     static constexpr const char* name = "grid";                     // for reports
///     static constexpr hmesh::Colors colors = hmesh::Colors::optimal; // final colours where Options::colors says nothing
///     hmesh::Status check(int width, int height) const;               // refuses options, or images by their size in px
///     double tile_size(int width, int height, std::size_t n) const;   // px, of the tiles in which final colours are found
///     template <int C> hmesh::Status run(hmesh::kit::TiledMesh<C>& mesh, std::size_t n) const;
///
/// run() replaces `mesh` by a mesh of exactly n vertices of the image mesh.source(), 4 <= n <= max(4, pixels), and returns an ok
/// status; cancelled, it leaves a valid mesh and returns Errc::cancelled, and where it fails, any other status: mesh_image() then
/// returns its mesh, unless it failed before its first stage (methods/stage.hpp) had ended. A recipe that wants the pixels
/// themselves declares run() with the image between its arguments, `template <class T, int C> run(TiledMesh<C>&, const
/// ImageView<T, C>&, std::size_t)`. One that can go on from a mesh of another run makes searches for a PSNR cheaper, by `Recipe
/// from(const hmesh::kit::Beginning&) const`, the recipe for one run of a search, and `hmesh::kit::Trials trials() const`, what
/// drafts and sketches foretell of whole runs; a `double work(int width, int height, std::size_t n) const`, how long a run takes,
/// in any unit, lets the progress of such a search run evenly. `static constexpr bool can_be_periodic = true` says that run()
/// makes periodic meshes, cut open as tiles/recut.hpp says, of sources that are periodic(); without it such images are refused.
/// run() may tell mesh.progress() by plan() how long its stages take. A tile_size() of the image's longer side means one piece.
/// mesh_image() does the rest: checks, premultiplication, weights, the search for a PSNR, final colours, the report. Recipes are
/// made of the building blocks in hmesh::kit, which are public, documented, and free to change before version 1.
#ifndef HMESH_METHODS_RECIPE_HPP
#define HMESH_METHODS_RECIPE_HPP

#include <cstddef>
#include <type_traits>
#include <utility>

#include "hmesh/image/image_view.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/options.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// How much work one run of a search is worth.
enum class Work : unsigned char {
    whole,   ///< as much as the recipe says
    refine,  ///< what makes a mesh of nearly as many vertices as good as a whole run
    touch,   ///< what keeps a mesh as good whose vertices change by a few per cent, in half the time of that
    trim,    ///< the same where they fall by a few per cent, or rise by one at most, in a third of the time of that
    sketch,  ///< what tells the PSNR of a whole run to within some 0.3 dB, in a quarter of its time
    draft,   ///< what tells it to within 2 dB, in a tenth
};

/// Whether such a run goes on from the mesh of another.
[[nodiscard]] constexpr bool goes_on(Work work) noexcept { return work >= Work::refine && work <= Work::trim; }

/// What drafts and sketches foretell of whole runs.
struct Trials {
    double draft = 0.5;  ///< a whole run is as good as a draft with this share of its vertices; in (0, 1]
    double sketch = 0;   ///< the same of sketches; 0: none are made, where they take longer than what they save
};

/// What one run of a search begins with.
struct Beginning {
    const Mesh* mesh = nullptr;  ///< the mesh of another run, of about as many vertices; null: none, a run from the start
    Work work = Work::whole;     ///< for it
};

/// Whether a type is a recipe, by its members `name` and `colors`.
template <class Recipe, class = void>
inline constexpr bool is_recipe = false;
/// True for types with the members `name` and `colors` of a recipe.
template <class Recipe>
inline constexpr bool is_recipe<Recipe, std::enable_if_t<std::is_same_v<std::remove_const_t<decltype(Recipe::colors)>, Colors> &&
                                                         std::is_convertible_v<decltype(Recipe::name), const char*>>> = true;

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_RECIPE_HPP
