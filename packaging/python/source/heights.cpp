// Python module - heights within a bound.
#include "hmesh/terrain.hpp"
#include "meshing.hpp"

hmesh::Result python::mesh_heights(const Pixels& pixels, const hmesh::Options& options, const hmesh::Bounded& recipe,
                                   const hmesh::ParallelFor& parallel_for) {
    return with_view<1>(pixels, [&](const auto& view) { return hmesh::mesh_image(view, options, recipe, parallel_for); });
}
