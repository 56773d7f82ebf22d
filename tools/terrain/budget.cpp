// The method that is given a number of vertices.
#include <algorithm>
#include <cstdint>

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

// The last tiles of a row and of a column are what is left, and may have fewer samples than vertices are asked for.
hmesh::Target target_of(const Arguments& arguments, const Window& window) {
    if (!arguments.vertices) return hmesh::Target::percent(*arguments.percent);
    const std::int64_t samples = std::int64_t{window.width} * window.height, side = std::int64_t{arguments.tile} + 1;
    return hmesh::Target::vertices(samples < side * side ? std::min(samples, *arguments.vertices) : *arguments.vertices);
}

}  // namespace

hmesh::Result mesh_with_vertices(const Arguments& arguments, const Window& window, hmesh::Progress progress,
                                 const hmesh::ParallelFor& parallel_for) {
    hmesh::Options options;
    options.samples = hmesh::Samples::points;
    options.progress = progress;
    options.target = target_of(arguments, window);
    hmesh::Annealed recipe;
    recipe.effort = annealed_effort(arguments.effort);
    recipe.border_tolerance = arguments.border_tolerance;
    return hmesh::mesh_image(window.tile(), options, recipe, parallel_for);
}

}  // namespace terrain
