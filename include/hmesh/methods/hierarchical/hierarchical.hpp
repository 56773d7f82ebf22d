/// \file
/// Hierarchical: "Image meshing via hierarchical optimization", its Algorithm 1.
///
///     bilateral levels -> Adams' mesh on the coarsest -> per level, coarse to fine, r times: geometry step, flip queue
///
/// All levels have the image's size, so each takes over the mesh of the level before as it is. What the paper leaves open is an
/// option of Hierarchical, with the effect that was measured. Colours are the least-squares ones.
///
/// Cost: some 100 us a vertex, half of it for Adams' mesh.
#ifndef HMESH_METHODS_HIERARCHICAL_HIERARCHICAL_HPP
#define HMESH_METHODS_HIERARCHICAL_HIERARCHICAL_HPP

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "hmesh/core/status.hpp"
#include "hmesh/fit/image_source.hpp"
#include "hmesh/methods/baselines/adams.hpp"
#include "hmesh/methods/baselines/flip_queue.hpp"
#include "hmesh/methods/hierarchical/bilateral.hpp"
#include "hmesh/methods/hierarchical/geometry_step.hpp"
#include "hmesh/methods/hierarchical/pyramid.hpp"
#include "hmesh/methods/stage.hpp"
#include "hmesh/solve/optimal_colors.hpp"
#include "hmesh/tiles/tiled_mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

namespace kit::detail {

/// Optimises the mesh on one level, the paper's AlternatingOptimization: `rounds` times a geometry step and a flip queue in
/// which an edge is tried up to `flip_visits` times. False: cancelled.
template <int C>
[[nodiscard]] bool optimize_level(TiledMesh<C>& mesh, const GeometryStep& geometry, int rounds, int flip_visits) {
    for (int round = 0; round < rounds; ++round) {
        const bool go_on = run_one_tile_stage<C>(mesh, "geometry", [&](ImageMesh<C>& piece) {
            // The mesh comes with sampled colours, or with those of the coarser level.
            if (round == 0 && geometry.rule == StepRule::safeguarded) optimal_colors(piece, geometry.pcg, mesh.parallel_for());
            const PcgReport report = geometry_step(piece, geometry, mesh.source().peak(), mesh.parallel_for());
            mesh.progress().note_solve(report.iterations, report.residual);
        });
        if (!go_on || !run_one_tile_stage<C>(mesh, "flips", [&](ImageMesh<C>& piece) { run_flip_queue(piece, flip_visits); }))
            return false;
    }
    return true;
}

}  // namespace kit::detail

/// The recipe of the paper's method, "Image meshing via hierarchical optimization": Adams' mesh on the coarsest of a few
/// bilateral levels, then on each level, coarse to fine, geometry steps and flips by turns. Safeguarded by default
/// (kit::StepRule); colours are the least-squares ones unless Options::colors says otherwise.
///
/// The whole image is one piece of work; filters, foot points and sums use the executor. Some 100 us a vertex. Differences below
/// are in dB over the six meshes of Lena and Fruits at 1, 2 and 3 %, the MSE being over pixels and channels; docs/paper.md has
/// all figures.
struct Hierarchical {
    int levels = 2;                     ///< N, in [1, 20], the image itself included; the paper: 2 or 3; 3 lose 0.1 to 0.9 dB
    kit::BilateralOptions bilateral{};  ///< the filter from level to level; diameter 9 and sigmas 50, as in the paper
    kit::LevelFilter filter{};          ///< if set, used in place of the bilateral filter; must outlive the call of mesh_image()
    Adams start{6, 3};                  ///< for the first mesh; density 6 is 0.02 to 0.15 dB above 4.5
    /// Whether the first mesh is made on the coarsest level, as in the paper, or on the image itself. The latter is better by
    /// 0.2 to 0.6 dB in five of six: the mesh then has points in textures that the filter removes.
    bool start_filtered = true;
    kit::GeometryStep geometry{};  ///< how positions and colours are solved for, and how the solution is used
    int rounds = 2;       ///< of geometry step and flips on each level, in [0, 1000]; two in the paper; four gain 0.1 to 0.2 dB
    int flip_visits = 8;  ///< how often an edge is tried in a round at most, in [1, 1000000]; never reached in practice

    static constexpr const char* name = "hierarchical";  ///< for reports
    static constexpr Colors colors = Colors::optimal;    ///< final colours where Options::colors says nothing

    /// Whether all options are in range, for images of any size; else Errc::invalid_argument with the offending value and its
    /// bound.
    [[nodiscard]] Status check(int = 1, int = 1) const noexcept {
        if (const Status status = start.check(); !status) return status;
        if (const Status status = kit::check(bilateral); !status) return status;
        if (geometry.search > kit::FootSearch::one_ring)
            return {Errc::invalid_argument, "hierarchical geometry.search must be one of those known",
                    static_cast<int>(geometry.search), 2};
        if (geometry.rule > kit::StepRule::literal)
            return {Errc::invalid_argument, "hierarchical geometry.rule must be one of those known",
                    static_cast<int>(geometry.rule), 1};
        const auto iterations = static_cast<double>(geometry.pcg.max_iterations);
        return kit::check_ranges(
            {{"hierarchical levels must be in [1, 20]", static_cast<double>(levels), 1, 20},
             {"hierarchical rounds must be in [0, 1000]", static_cast<double>(rounds), 0, 1000},
             {"hierarchical flip_visits must be in [1, 1000000]", static_cast<double>(flip_visits), 1, 1e6},
             {"hierarchical geometry.color_scale must be in [0.001, 1000] px", geometry.color_scale, 1e-3, 1e3},
             {"hierarchical geometry.ridge must be in [1e-9, 1000] pixels", geometry.ridge, 1e-9, 1e3},
             {"hierarchical geometry.halvings must be in [0, 20]", static_cast<double>(geometry.halvings), 0, 20},
             {"hierarchical geometry.pcg.max_iterations must be in [1, 100000]", iterations, 1, 1e5},
             {"hierarchical geometry.pcg.tolerance must be in [1e-15, 1]", geometry.pcg.tolerance, 1e-15, 1}});
    }
    /// The image's longer side in px: the image is one piece.
    [[nodiscard]] static double tile_size(int width, int height, std::size_t) noexcept { return std::max(width, height); }
    /// Replaces `mesh` by a mesh of n vertices of `image`, which is the one that mesh.source() reads, 4 <= n <= max(4, pixels).
    /// Errc::cancelled: it is valid, with any number of vertices.
    template <class T, int C>
    [[nodiscard]] Status run(kit::TiledMesh<C>& mesh, const ImageView<T, C>& image, std::size_t n) const {
        // Levels, points, removal, and four times geometry and flips: of other options too, whose stages are more or fewer.
        mesh.progress().plan({5, 15, 37, 12, 2, 10, 2, 9, 1, 6, 1, 1});
        if (!mesh.progress().begin("levels", mesh.vertex_count(), mesh.energy())) return kit::cancelled_by_callback();
        const kit::Pyramid<T, C> pyramid = kit::make_pyramid(image, levels, bilateral, filter, mesh.parallel_for());
        std::vector<kit::ImageSource<C>> coarse;
        for (int level = 1; level < levels; ++level) coarse.push_back(mesh.source().with_pixels(pyramid.level(level)));
        {
            // The stage reports the error of the mesh at hand. A TiledMesh of its own measures it, so that its table is freed at
            // once.
            kit::TiledMesh<C> corners(mesh.source(), mesh.limits(), mesh.progress(), mesh.parallel_for());
            corners.indexed() = std::move(mesh.indexed());
            corners.measure(kit::one_tile(mesh.source()));
            mesh.indexed() = std::move(corners.indexed());
        }
        if (!mesh.progress().end(mesh.vertex_count(), mesh.energy())) return kit::cancelled_by_callback();
        return run(mesh, coarse, n);
    }
    /// Replaces `mesh` by a mesh of n vertices, given the levels 1 to N - 1 in `coarse`; they must be of the size of
    /// mesh.source(), which is level 0. An empty `coarse` means one level. Errc::cancelled: the mesh is valid, with any number
    /// of vertices.
    template <int C>
    [[nodiscard]] Status run(kit::TiledMesh<C>& mesh, const std::vector<kit::ImageSource<C>>& coarse, std::size_t n) const {
        Status status;
        bool has_mesh = false;
        kit::IndexedMesh<C> last;
        if (!start_filtered || coarse.empty()) {
            status = start.run(mesh, n);
            last = std::move(mesh.indexed());
            has_mesh = true;
        }
        for (std::size_t level = coarse.size(); level > 0 && status; --level) {
            kit::TiledMesh<C> filtered(coarse[level - 1], mesh.limits(), mesh.progress(), mesh.parallel_for());
            if (has_mesh) filtered.indexed() = std::move(last);
            else status = start.run(filtered, n);
            has_mesh = true;
            if (status) status = optimize(filtered);
            last = std::move(filtered.indexed());
        }
        mesh.indexed() = std::move(last);
        return status ? optimize(mesh) : status;
    }

  private:
    /// The rounds of one level.
    template <int C>
    [[nodiscard]] Status optimize(kit::TiledMesh<C>& mesh) const {
        return kit::finished_or_cancelled(kit::detail::optimize_level(mesh, geometry, rounds, flip_visits));
    }
};

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_HIERARCHICAL_HIERARCHICAL_HPP
