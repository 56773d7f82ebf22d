/// \file
/// Final colors: sampled or bounded colours for all vertices of a tiled mesh, the last step of every recipe.
///
/// Cost: about 1 us a vertex, and one moment table for each tile.
#ifndef HMESH_METHODS_FINAL_COLORS_HPP
#define HMESH_METHODS_FINAL_COLORS_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/core/assert.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/methods/stage.hpp"
#include "hmesh/solve/bounded_colors.hpp"
#include "hmesh/solve/sampled_colors.hpp"
#include "hmesh/tiles/tiled_mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// Gives all vertices the colours of the image at their positions (solve/sampled_colors.hpp), rounded to multiples of `grid`
/// where grid > 0, and measures the mesh's energy with them. `tiling`: the pieces of the measurement.
template <int C>
HMESH_COLD void sample_colors(TiledMesh<C>& tiled, const Tiling& tiling, double grid) {
    IndexedMesh<C>& mesh = tiled.indexed();
    const ImageSource<C>& source = tiled.source();
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
        Color<C>& color = mesh.colors[v];
        color = sampled_color<C>(source.width(), source.height(), mesh.positions[v],
                                 [&](int x, int y) { return source.pixel(x, y); });
        if (grid > 0)
            for (int c = 0; c < C; ++c) color.set(c, std::floor(color[c] / grid + 0.5) * grid);
    }
    tiled.measure(tiling);
}

/// Gives all vertices the colours of least squared error in [low, high] that are multiples of `grid` where grid > 0
/// (solve/bounded_colors.hpp), and measures the mesh's energy with them. `tiling`: the patches over which sums are taken where
/// the image has no table of its own; the system is solved for the whole mesh. After a cancellation colours are only clamped and
/// rounded, and the energy is still true of them.
template <int C>
HMESH_COLD BoundedReport bounded_colors(TiledMesh<C>& tiled, const Tiling& tiling, double low, double high, double grid) {
    BoundedReport report;
    if ((tiling.size() == 1 || tiled.has_whole_table()) &&
        tiled.for_each(one_tile(tiled.source()), [&](Patch<C>& patch, std::size_t) {
            report = bounded_colors(patch.mesh(), low, high, grid, tiled.parallel_for());
        }))
        return report;
    IndexedMesh<C>& mesh = tiled.indexed();
    for (Color<C>& c : mesh.colors) detail::clamp_channels<C>(c, low, high);
    HalfedgeMesh topology;
    const Status status = topology.assign(mesh.vertex_count(), mesh.faces);
    HMESH_ASSERT(status);
    (void)status;
    std::vector<CornerSums<C>> corners(2 * topology.edge_slots());
    tiled.visit(tiling, [&](Patch<C>& patch, std::size_t, const std::uint32_t* faces) {
        for (const Face f : patch.mesh().topology().faces()) {
            const Halfedge h0 = topology.halfedge(Face(faces[f.index()])), h1 = topology.next(h0), h2 = topology.next(h1);
            detail::sum_face(patch.mesh(), f, corners[h0.index()], corners[h1.index()], corners[h2.index()]);
        }
    });
    if (tiled.progress().stopped()) std::fill(corners.begin(), corners.end(), CornerSums<C>());  // only the ridge is left
    const auto system = detail::color_system(topology, corners, mesh.colors, tiled.limits().ridge, tiled.parallel_for());
    report = detail::descend(system, low, high, grid, mesh.colors, [&] { return tiled.progress().poll(); });
    tiled.measure(tiling);
    return report;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_FINAL_COLORS_HPP
