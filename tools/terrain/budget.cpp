// The method that is given a number of vertices.
#include "hmesh/mesh_image.hpp"
#include "terrain/meshing.hpp"

namespace terrain {
namespace {

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

hmesh::Result mesh_with_vertices(const Arguments& arguments, const Window& window, hmesh::Progress progress,
                                 const hmesh::ParallelFor& parallel_for) {
    hmesh::Options options;
    options.samples = hmesh::Samples::points;
    options.progress = progress;
    options.target =
        arguments.vertices ? hmesh::Target::vertices(*arguments.vertices) : hmesh::Target::percent(*arguments.percent);
    hmesh::Annealed recipe;
    recipe.effort = annealed_effort(arguments.effort);
    recipe.border_tolerance = arguments.border_tolerance;
    return hmesh::mesh_image(window.tile(), options, recipe, parallel_for);
}

}  // namespace terrain
