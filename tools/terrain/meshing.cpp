#include "terrain/meshing.hpp"

#include "hmesh/methods/bounded/bounded.hpp"

namespace terrain {
namespace {

hmesh::Bounded::Effort bounded_effort(Effort effort) {
    switch (effort) {
        case Effort::draft: return hmesh::Bounded::Effort::draft;
        case Effort::fast: return hmesh::Bounded::Effort::fast;
        case Effort::normal: break;
        case Effort::best: return hmesh::Bounded::Effort::best;
    }
    return hmesh::Bounded::Effort::normal;
}

}  // namespace

hmesh::Result mesh_within(const Arguments& arguments, const Window& window, const Within& within, hmesh::Progress progress,
                          const hmesh::ParallelFor& parallel_for) {
    hmesh::Options options;
    options.samples = hmesh::Samples::points;
    options.nan_is_no_data = true;
    options.progress = progress;
    hmesh::Bounded recipe;
    recipe.max_error = within.bound;
    recipe.effort = bounded_effort(within.effort);
    recipe.free_borders = arguments.has_free_borders;
    recipe.border_error = within.border;
    recipe.inside_error = within.inside;
    return hmesh::mesh_image(window.tile(), options, recipe, parallel_for);
}

}  // namespace terrain
