/// \file
/// Annealed: the method behind the default recipe (methods/annealed/options.hpp).
///
///    grid -> greedy insertion to o n vertices -> collapse to u n -> s sweeps of priced moves -> exactly n -> polish
///
/// Too many vertices are inserted, each where it lowers the energy most; then those whose loss raises it least are removed;
/// vertices move and edges flip throughout. Annealing (methods/annealed/annealing.hpp) then moves vertices between places at one
/// common price. Whenever a vertex is visited, its colour becomes the least-squares one. o, u and s are
/// AnnealedSteps::insert_factor, collapse_factor and annealing.sweeps; collapse is left out where o = 1, annealing where s = 0.
///
/// A mesh to go on from (Annealed::start) takes the place of the grid, greedy insertion and collapse: the cheapest vertices are
/// removed, or the best ones inserted, until there are n.
///
/// All stages work in patches (tiles/patch.hpp). First each tile is meshed by itself, with a share of the budget and with the
/// vertices on its seams locked; then phases shift the tiling, so that no trace of the seams remains.
#ifndef HMESH_METHODS_ANNEALED_ANNEALED_HPP
#define HMESH_METHODS_ANNEALED_ANNEALED_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "hmesh/core/compiler.hpp"
#include "hmesh/core/finite.hpp"
#include "hmesh/core/progress.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/edit/collapse.hpp"
#include "hmesh/edit/flip.hpp"
#include "hmesh/edit/insert.hpp"
#include "hmesh/edit/move.hpp"
#include "hmesh/edit/subdivide.hpp"
#include "hmesh/methods/annealed/annealing.hpp"
#include "hmesh/methods/annealed/budget.hpp"
#include "hmesh/methods/annealed/first_grid.hpp"
#include "hmesh/methods/annealed/options.hpp"
#include "hmesh/methods/stage.hpp"
#include "hmesh/tiles/tiled_mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {
namespace kit::detail {

/// Inserts vertices greedily, in batches with flips and sweeps in between, until the mesh has n vertices; by subdivision where
/// nothing gains any more.
template <int C>
HMESH_COLD void grow(ImageMesh<C>& mesh, std::size_t n, const AnnealedSteps& options) {
    const std::size_t first = mesh.vertex_count();
    mesh.reserve(n);
    const auto fraction = [&](std::size_t count) { return static_cast<double>(count - first) / static_cast<double>(n - first); };
    while (mesh.vertex_count() < n && mesh.keep_going()) {
        const std::size_t count = mesh.vertex_count(), missing = n - count;
        std::size_t batch =
            std::min(missing, static_cast<std::size_t>(std::ceil(static_cast<double>(count) * options.insert_batch)));
        if (missing - batch < batch / 2) batch = missing;  // no small last batch
        const double from = fraction(count), step = fraction(count + batch) - from, next = static_cast<double>(count + batch);
        mesh.expect(from + 0.5 * step, 4.0 * static_cast<double>(count));
        if (insert_batch(mesh, batch, {}) == 0) break;
        mesh.expect(from + 0.7 * step, 3.5 * next);
        flip_edges(mesh, options.insert_flip_gain);
        mesh.expect(from + step, 0.8 * next * options.insert_sweeps);
        for (int i = 0; i < options.insert_sweeps; ++i) sweep(mesh, options.insert_tolerance);
        if (mesh.task() != nullptr) mesh.task()->set_fraction(fraction(mesh.vertex_count()));
    }
    if (mesh.vertex_count() < n && mesh.keep_going()) subdivide(mesh, n - mesh.vertex_count());
}

/// Removes the cheapest vertices in batches until n are left, or none of those left can be removed.
template <int C>
HMESH_COLD void shrink(ImageMesh<C>& mesh, std::size_t n, const AnnealedSteps& options) {
    const std::size_t first = mesh.vertex_count();
    const auto fraction = [&](std::size_t count) { return static_cast<double>(first - count) / static_cast<double>(first - n); };
    while (mesh.vertex_count() > n && mesh.keep_going()) {
        const std::size_t count = mesh.vertex_count(), surplus = count - n;
        const auto largest = static_cast<std::size_t>(std::ceil(static_cast<double>(count) * options.collapse_batch));
        const std::size_t batch = std::min(surplus, largest);
        mesh.expect(fraction(count - batch), static_cast<double>(count) + 1.7 * static_cast<double>(batch));
        if (remove_batch(mesh, batch, options.relaxation) == 0) break;
        if (mesh.task() != nullptr) mesh.task()->set_fraction(fraction(mesh.vertex_count()));
    }
}

/// Whether this is a mesh of the image, with finite colours; else Errc::invalid_argument.
template <int C>
[[nodiscard]] HMESH_COLD Status check_start(const IndexedMesh<C>& mesh, const ImageSource<C>& source) {
    if (mesh.vertex_count() == 0) return {Errc::invalid_argument, "the mesh to start from has not the image's channels"};
    if (mesh.width != source.width())
        return {Errc::invalid_argument, "the mesh to start from is not as wide as the image", mesh.width, source.width()};
    if (mesh.height != source.height())
        return {Errc::invalid_argument, "the mesh to start from is not as high as the image", mesh.height, source.height()};
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
        for (int c = 0; c < C; ++c)
            if (!is_finite(mesh.colors[v][c]))
                return {Errc::invalid_argument, "the mesh to start from has a colour that is not finite, at vertex",
                        static_cast<std::int64_t>(v), 0};
    return check(mesh);
}

/// Tells progress of the stages of a run.
HMESH_COLD inline void plan_stages(ProgressReporter& progress, const AnnealedSteps& steps, double pixels, std::size_t n,
                                   bool has_start) {
    const AnnealedWork work = annealed_work(steps, pixels, static_cast<double>(n), has_start);
    const bool collapses = work.collapse > 0, anneals = work.anneal > 0;
    if (has_start && anneals) progress.plan({work.grid, work.anneal, work.polish, work.colors});
    else if (has_start) progress.plan({work.grid, work.polish, work.colors});
    else if (collapses && anneals) progress.plan({work.grid, work.insert, work.collapse, work.anneal, work.polish, work.colors});
    else if (collapses || anneals) progress.plan({work.grid, work.insert, work.collapse + work.anneal, work.polish, work.colors});
    else progress.plan({work.grid, work.insert, work.polish, work.colors});
}

/// The state of a tile of the aligned tiling after the last stage.
struct TileState {
    std::size_t free = 0;    ///< vertices that are free in the tile
    double energy = 0;       ///< of the tile's faces
    std::size_t placed = 0;  ///< target of insertion, in free vertices
};

/// One run of the method for n vertices: the stages, and what they know of the tiles.
template <int C>
class AnnealedRun {
  public:
    AnnealedRun(TiledMesh<C>& tiled, std::size_t n, const AnnealedSteps& steps, std::uint64_t seed, double tile)
        : tiled_(&tiled), n_(n), steps_(steps), seed_(seed), tile_(tile), aligned_(tiling(0)) {}

    /// Runs all stages. False: cancelled, or more than n vertices are left and none of them can be removed.
    bool run() {
        plan_stages(progress(), steps_, tiled_->source().pixels(), n_, false);
        tiled_->indexed() = corner_mesh(tiled_->source());  // the mesh after a cancellation in the first stage
        return stage("grid", [&] { return start(); }) && stage("insert", [&] { return insert(); }) &&
               (steps_.insert_factor <= 1 || stage("collapse", [&] { return collapse(); })) && finish();
    }
    /// The same from `mesh` on, which check_start() accepts.
    bool run_from(IndexedMesh<C> mesh) {
        plan_stages(progress(), steps_, tiled_->source().pixels(), n_, true);
        tiled_->indexed() = std::move(mesh);
        return stage("start",
                     [&] {
                         tiled_->measure(aligned_);
                         return reach_vertex_count(*tiled_, n_, tile_, steps_.relaxation);
                     }) &&
               finish();
    }

  private:
    bool finish() {
        return (steps_.annealing.sweeps == 0 || stage("anneal", [&] { return anneal(); })) && stage("polish", [&] {
                   progress().set_range(0, 0.35);
                   return reach_vertex_count(*tiled_, n_, tile_, steps_.relaxation) && polish(0.35);
               });
    }
    [[nodiscard]] ProgressReporter& progress() noexcept { return tiled_->progress(); }
    /// The tiling of phase k: in any 4 phases in a row, every vertex is within a tile in at least one.
    [[nodiscard]] Tiling tiling(int phase) const {
        constexpr bool shift_x[] = {false, true, true, false}, shift_y[] = {false, true, false, true};
        return Tiling(tiled_->source().width(), tiled_->source().height(), tile_, shift_x[phase & 3], shift_y[phase & 3]);
    }
    bool stage(const char* name, FunctionRef<bool()> body) { return run_stage<C>(*tiled_, name, body); }

    HMESH_COLD bool start() {
        const double placed = static_cast<double>(n_) * steps_.insert_factor, pixels = tiled_->source().pixels();
        const double count = std::max(4.0, std::min(placed, pixels) * steps_.start);
        if (aligned_.size() == 1) {
            tiled_->indexed() = regular_grid(tiled_->source(), count);
        } else {
            // 0.7 of the nodes that a square grid of n vertices would have on the seams.
            const double length = static_cast<double>(aligned_.columns() - 1) * tiled_->source().height() +
                                  static_cast<double>(aligned_.rows() - 1) * tiled_->source().width();
            IndexedMesh<C> grid = tiled_grid<C>(
                tiled_->source(), aligned_, count, 0.7 * length * std::sqrt(static_cast<double>(n_) / pixels),
                [&] { return progress().poll(); }, tiled_->parallel_for());
            if (progress().stopped()) return false;
            tiled_->indexed() = std::move(grid);
        }
        progress().set_range(0, 1);
        return for_each_tile([&](ImageMesh<C>& mesh, std::size_t, std::size_t) {
            for (int i = 0; i < 2; ++i) sweep(mesh, steps_.polish);
        });
    }

    /// Calls body(mesh, k, rim) for the patch of each tile k of the aligned tiling; `rim` is the number of its locked vertices.
    bool for_each_tile(FunctionRef<void(ImageMesh<C>& mesh, std::size_t tile, std::size_t rim)> body) {
        tiles_.resize(aligned_.size());
        return tiled_->for_each(aligned_, [&](Patch<C>& patch, std::size_t k) {
            body(patch.mesh(), k, patch.vertex_count() - patch.free_count());
            tiles_[k].free = patch.free_count();
            tiles_[k].energy = patch.mesh().energy();
        });
    }
    /// The number of vertices that are free in no tile.
    [[nodiscard]] std::size_t seam_count() noexcept {
        std::size_t count = tiled_->vertex_count();
        for (const TileState& tile : tiles_) count -= tile.free;
        return count;
    }

    /// Grows all tiles until they have about `count` vertices together, shared among them by area or, where `by_error`, by the
    /// error that the tiles have now (error_share() in methods/annealed/budget.hpp).
    HMESH_COLD bool grow_tiles(double count, bool by_error) {
        std::vector<double> weights;
        std::vector<std::size_t> caps;
        for (std::size_t k = 0; k < tiles_.size(); ++k) {
            const Rect rect = aligned_.rect(k);
            const double area = static_cast<double>(rect.width) * rect.height;
            weights.push_back(by_error ? error_share(area, tiles_[k].energy) : area);
            caps.push_back(2 * static_cast<std::size_t>(area));
        }
        const std::size_t total = static_cast<std::size_t>(std::round(count)), seams = seam_count();
        const std::vector<std::size_t> placed = apportion(total - std::min(total, seams), weights, caps);
        for (std::size_t k = 0; k < tiles_.size(); ++k) tiles_[k].placed = placed[k];
        return for_each_tile(
            [&](ImageMesh<C>& mesh, std::size_t k, std::size_t rim) { grow(mesh, rim + tiles_[k].placed, steps_); });
    }

    HMESH_COLD bool insert() {
        const double n = static_cast<double>(n_), pixels = std::max(4.0, tiled_->source().pixels());
        const double placed = std::max(n, std::min(pixels, std::round(n * steps_.insert_factor)));
        // Growing by area first gives flat tiles more than their share, so that removal has more to choose from: 0.1 dB.
        const bool in_two = aligned_.size() > 1 && placed > n;
        if (in_two) {
            progress().set_range(0, 0.4);
            if (!grow_tiles(n, false)) return false;
        }
        progress().set_range(in_two ? 0.4 : 0, 1);
        return grow_tiles(placed, true);
    }

    HMESH_COLD bool collapse() {
        // The free vertices of all tiles shrink by the same ratio.
        const auto left = static_cast<std::size_t>(std::round(static_cast<double>(n_) * steps_.collapse_factor));
        double placed = 0;
        for (const TileState& tile : tiles_) placed += static_cast<double>(tile.placed);
        const double ratio = static_cast<double>(left - std::min(left, seam_count())) / std::max(1.0, placed);
        progress().set_range(0, 1);
        const bool go_on = for_each_tile([&](ImageMesh<C>& mesh, std::size_t k, std::size_t rim) {
            shrink(mesh, rim + static_cast<std::size_t>(std::round(static_cast<double>(tiles_[k].placed) * ratio)), steps_);
        });
        (void)tiled_->indexed();  // renumbers a single patch without its many deleted slots
        return go_on;
    }

    HMESH_COLD bool anneal() {
        const AnnealingOptions& annealing = steps_.annealing;
        AnnealingSchedule schedule(annealing, n_, tiled_->mean_energy());
        // Sweeps take less and less time; the first one, in which the mesh grows, a half more.
        const auto done = [&](int k) {
            const double sweeps = annealing.sweeps, t = k / sweeps;
            return k == 0 ? 0 : (0.4 + sweeps * t * (1.08 - 0.15 * t)) / (0.4 + 0.93 * sweeps);
        };
        for (int k = 0; k < annealing.sweeps; ++k) {
            const auto total = static_cast<double>(tiled_->vertex_count()), target = static_cast<double>(n_);
            const Tiling phase = tiling(k + 1);
            std::vector<AnnealingCounts> counts(phase.size());
            const double tolerance = annealing.count_tolerance * (1 - static_cast<double>(k) / annealing.sweeps);
            progress().set_range(done(k), done(k + 1));
            const bool go_on = tiled_->for_each(phase, [&](Patch<C>& patch, std::size_t tile) {
                const double share = static_cast<double>(patch.mesh().vertex_count()) * target / total;
                const CountRange range{(1 - tolerance) * share, (1 + tolerance) * share};
                const Random random(seed_, (static_cast<std::uint64_t>(k) << 32U) + tile);
                counts[tile] =
                    AnnealingSweep<C>(patch.mesh(), annealing, schedule.price(), schedule.temperature(k), range, random).run();
            });
            if (!go_on) return false;
            AnnealingCounts sum;
            for (const AnnealingCounts& c : counts) {
                sum.removed += c.removed;
                sum.inserted += c.inserted;
            }
            schedule.steer(sum, tiled_->vertex_count(), tiled_->mean_energy());
            if (!progress().update(done(k + 1), tiled_->vertex_count(), tiled_->energy())) return false;
        }
        return true;
    }

    /// Begins where this fraction of the stage is done.
    HMESH_COLD bool polish(double from) {
        // Without annealing no phase has shifted the tiling yet: one round at least works across the seams.
        const bool has_seams = aligned_.size() > 1 && steps_.annealing.sweeps == 0;
        const int rounds = std::max(steps_.polish_rounds, has_seams ? 1 : 0);
        for (int k = 0; k < rounds; ++k) {
            progress().set_range(from + (1 - from) * k / rounds, from + (1 - from) * (k + 1) / rounds);
            if (!tiled_->for_each(tiling(k + 1), [&](Patch<C>& patch, std::size_t) {
                    patch.mesh().expect(1, 4.0 * static_cast<double>(patch.mesh().vertex_count()));
                    flip_edges(patch.mesh(), steps_.polish.propagate_above);
                    sweep(patch.mesh(), steps_.polish);
                }))
                return false;
        }
        return true;
    }

    TiledMesh<C>* tiled_;
    std::size_t n_;
    AnnealedSteps steps_;
    std::uint64_t seed_;
    double tile_;
    Tiling aligned_;
    std::vector<TileState> tiles_;
};

}  // namespace kit::detail

template <int C>
Status Annealed::run(kit::TiledMesh<C>& mesh, std::size_t n) const {
    const kit::ImageSource<C>& source = mesh.source();
    const double size = tile_size(source.width(), source.height(), n);
    kit::AnnealedSteps plan = steps.value_or(kit::annealed_steps(effort));
    kit::detail::AnnealedRun<C> first(mesh, n, plan, seed, size);
    bool is_done = false;
    if (start != nullptr) {
        kit::IndexedMesh<C> from = kit::to_indexed_mesh<C>(*start);
        if (const Status status = kit::detail::check_start(from, source); !status) return status;
        is_done = first.run_from(std::move(from));
    } else {
        is_done = first.run();
    }
    if (is_done) return {};
    if (mesh.progress().stopped()) return kit::cancelled_by_callback();
    // More than n vertices are left, each of whose collapses would make a face below min_double_area. Growing to n in one piece,
    // without a collapse, always ends at n.
    plan.insert_factor = 1;
    plan.annealing.sweeps = 0;
    is_done = kit::detail::AnnealedRun<C>(mesh, n, plan, seed, std::max(source.width(), source.height())).run();
    return kit::finished_or_cancelled(is_done);
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_ANNEALED_ANNEALED_HPP
