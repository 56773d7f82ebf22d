// hmesh - hierarchical: "Image meshing via hierarchical optimization", its Algorithm 1.
//
//     bilateral levels -> Adams' mesh on the coarsest -> per level, coarse to fine, r times: geometry step, flip queue
//
// The next level takes the mesh over as it is. What the text leaves open is an option below, with what was measured about it;
// PSNR with the MSE over pixels and channels, on Lena and Fruits at 1, 2 and 3 %. Colours are those solved for. Some 100 us a
// vertex, half of it for Adams' mesh.
#ifndef HMESH_METHODS_HIERARCHICAL_HIERARCHICAL_HPP
#define HMESH_METHODS_HIERARCHICAL_HIERARCHICAL_HPP

#include <cstddef>
#include <utility>
#include <vector>

#include "hmesh/core/finite.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/solve/bounded_colors.hpp"
#include "hmesh/methods/baselines/flip_queue.hpp"
#include "hmesh/methods/hierarchical/geometry_step.hpp"
#include "hmesh/tiles/tiled_mesh.hpp"
#include "hmesh/methods/hierarchical/bilateral.hpp"
#include "hmesh/fit/image_source.hpp"
#include "hmesh/methods/hierarchical/pyramid.hpp"
#include "hmesh/methods/baselines/adams.hpp"
#include "hmesh/methods/stage.hpp"

namespace hmesh::kit {

// Figures: dB over the six meshes of Lena and Fruits at 1, 2 and 3 % (docs/paper.md has all of them).
struct HierarchicalOptions {
    int levels = 2;              // N; the paper: two or three, of which three lose 0.1 to 0.9
    BilateralOptions bilateral;  // diameter 9, sigmas 50, as in the paper
    LevelFilter filter;          // in place of the bilateral one, if set
    AdamsOptions start{6, 3};    // a density of 6 is worth 0.05 to 0.15 above 4.5 in five of the six
    // The first mesh is that of the coarsest level, as in the paper. From the image itself it is better by 0.2 to 0.6 in five of
    // the six: it has points in the textures that the filter removes.
    bool start_filtered = true;
    GeometryStep geometry;
    int rounds = 2;       // of geometry step and flips, per level; the paper: two; four are worth 0.1 to 0.2
    int flip_visits = 8;  // how often an edge is a suspect in a round; never reached in practice
};

// Whether the options mean something; the sentence names the first that does not.
[[nodiscard]] inline Status check(const HierarchicalOptions& options) noexcept {
    if (const Status status = check(options.start); !status) return status;
    if (const Status status = check(options.bilateral); !status) return status;
    const auto bad = [](const char* what) -> Status { return {Errc::invalid_argument, what, 0, 0}; };
    const GeometryStep& geometry = options.geometry;
    if (!is_within(options.levels, 1, 20)) return bad("hierarchical.levels must be in [1, 20]");
    if (!is_within(options.rounds, 0, 1000)) return bad("hierarchical.rounds must be in [0, 1000]");
    if (!is_within(options.flip_visits, 1, 1000000)) return bad("hierarchical.flip_visits must be in [1, 1000000]");
    if (geometry.search > FootSearch::one_ring) return bad("hierarchical.geometry.search must be one of those known");
    if (geometry.rule > StepRule::literal) return bad("hierarchical.geometry.rule must be one of those known");
    if (!is_within(geometry.color_scale, 1e-3, 1e3)) return bad("hierarchical.geometry.color_scale must be in [0.001, 1000] px");
    if (!is_within(geometry.pull, 1e-9, 1e3)) return bad("hierarchical.geometry.pull must be in [1e-9, 1000] pixels");
    if (!is_within(geometry.halvings, 0, 20)) return bad("hierarchical.geometry.halvings must be in [0, 20]");
    if (!is_within(geometry.pcg.max_iterations, 1, 100000))
        return bad("hierarchical.geometry.pcg.max_iterations must be in [1, 100000]");
    if (!is_within(geometry.pcg.tolerance, 1e-15, 1)) return bad("hierarchical.geometry.pcg.tolerance must be in [1e-15, 1]");
    return {};
}

namespace detail {

// The paper's AlternatingOptimization on the image that work is of. False: cancelled.
template <int C>
bool alternate(TiledMesh<C>& work, const HierarchicalOptions& options) {
    const GeometryStep& geometry = options.geometry;
    for (int round = 0; round < options.rounds; ++round) {
        const bool go_on = whole_stage(work, "geometry", [&](ImageMesh<C>& mesh) {
            // A mesh from elsewhere has the colours of another picture.
            if (round == 0 && geometry.rule == StepRule::safeguarded) optimal_colors(mesh, geometry.pcg, work.parallel_for());
            const PcgReport report = geometry_step(mesh, geometry, work.source().peak(), work.parallel_for());
            work.monitor().note_solve(report.iterations, report.residual);
        });
        if (!go_on || !whole_stage(work, "flips", [&](ImageMesh<C>& mesh) { run_flip_queue(mesh, options.flip_visits); }))
            return false;
    }
    return true;
}

}  // namespace detail

// Makes a mesh of n vertices, 4 <= n <= max(4, pixels), of the image that work is of. `coarse`: the levels from 1 to N - 1,
// of the same size. False: cancelled; the mesh is valid but may have another count.
template <int C>
[[nodiscard]] bool hierarchical(TiledMesh<C>& work, const std::vector<ImageSource<C>>& coarse, std::size_t n,
                                const HierarchicalOptions& options) {
    bool go_on = true, has_mesh = false;
    IndexedMesh<C> mesh;
    if (!options.start_filtered || coarse.empty()) {
        go_on = adams(work, n, options.start);
        mesh = std::move(work.indexed());
        has_mesh = true;
    }
    for (std::size_t level = coarse.size(); level > 0 && go_on; --level) {
        TiledMesh<C> filtered(coarse[level - 1], work.limits(), work.monitor(), work.parallel_for());
        if (has_mesh) filtered.indexed() = std::move(mesh);
        else go_on = adams(filtered, n, options.start);
        has_mesh = true;
        go_on = go_on && detail::alternate(filtered, options);
        mesh = std::move(filtered.indexed());
    }
    work.indexed() = std::move(mesh);
    return go_on && detail::alternate(work, options);
}

}  // namespace hmesh::kit

#endif  // HMESH_METHODS_HIERARCHICAL_HIERARCHICAL_HPP
