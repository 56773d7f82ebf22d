#include "terrain/meshing.hpp"

#include "hmesh/mesh_image.hpp"
#include "hmesh/terrain.hpp"

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

hmesh::Effort annealed_effort(Effort effort) {
    switch (effort) {
        case Effort::draft: return hmesh::Effort::draft;
        case Effort::fast: return hmesh::Effort::fast;
        case Effort::normal: break;
        case Effort::best: return hmesh::Effort::best;
    }
    return hmesh::Effort::normal;
}

}  // namespace

hmesh::Result mesh_window(const Arguments& arguments, const Window& window, double bound, hmesh::Progress progress,
                          const hmesh::ParallelFor& parallel_for) {
    hmesh::Options options;
    options.samples = hmesh::Samples::points;
    options.progress = progress;
    if (!arguments.max_error) {
        options.target = arguments.vertices ? hmesh::Target::vertices(*arguments.vertices) : hmesh::Target::percent(*arguments.percent);
        return hmesh::mesh_image(window.tile(), options, hmesh::Annealed{annealed_effort(arguments.effort)}, parallel_for);
    }
    options.nan_is_no_data = true;
    hmesh::Bounded recipe;
    recipe.max_error = bound;
    recipe.effort = bounded_effort(arguments.effort);
    return hmesh::mesh_image(window.tile(), options, recipe, parallel_for);
}

}  // namespace terrain
