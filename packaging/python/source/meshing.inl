// Python module - what a file that setup.py writes is made of: mesh_image() and, of up to 4, compact_image() of images of
// HMESH_PYTHON_CHANNELS channels.
#include "hmesh/mesh_image.hpp"
#include "meshing.hpp"

template <>
hmesh::Result python::mesh_channels<HMESH_PYTHON_CHANNELS>(const Pixels& pixels, const hmesh::Options& options,
                                                           const hmesh::Annealed& recipe,
                                                           const hmesh::ParallelFor& parallel_for) {
    return with_view<HMESH_PYTHON_CHANNELS>(
        pixels, [&](const auto& view) { return hmesh::mesh_image(view, options, recipe, parallel_for); });
}

#if HMESH_PYTHON_CHANNELS <= 4
template <>
hmesh::CompactImage python::compact_channels<HMESH_PYTHON_CHANNELS>(const Pixels& pixels,
                                                                    const hmesh::CompactImageOptions& options,
                                                                    const hmesh::Annealed& recipe,
                                                                    const hmesh::ParallelFor& parallel_for) {
    return with_view<HMESH_PYTHON_CHANNELS>(
        pixels, [&](const auto& view) { return hmesh::compact_image(view, options, recipe, parallel_for); });
}
#endif
