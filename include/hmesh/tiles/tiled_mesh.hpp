/// \file
/// TiledMesh: a mesh of any size that is worked on patch by patch.
///
/// A TiledMesh is what recipes are given (methods/recipe.hpp): the mesh, the image, the progress, and the executor. for_each()
/// cuts the mesh along a tiling, has each patch worked on through the executor, and merges the results.
///
/// Cost of a cut and a merge: about 1 us a vertex in the patches, which is parallel, and 0.2 us a vertex, which is not.
#ifndef HMESH_TILES_TILED_MESH_HPP
#define HMESH_TILES_TILED_MESH_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "hmesh/core/compiler.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/core/progress.hpp"
#include "hmesh/fit/image_mesh.hpp"
#include "hmesh/fit/image_source.hpp"
#include "hmesh/tiles/indexed_mesh.hpp"
#include "hmesh/tiles/patch.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// A mesh of an image of C channels, as the patches of a tiling or, between phases, as an IndexedMesh.
template <int C>
class TiledMesh {
  public:
    /// What is done to the mesh of one patch.
    using MeshWork = FunctionRef<void(ImageMesh<C>& mesh)>;

    /// An empty mesh. The image source, the progress reporter and the executor must outlive the TiledMesh.
    TiledMesh(const ImageSource<C>& source, const MeshLimits& limits, ProgressReporter& progress,
              const ParallelFor& parallel_for = {})
        : source_(&source), limits_(limits), progress_(&progress), parallel_for_(parallel_for) {}

    /// The image to be meshed.
    [[nodiscard]] const ImageSource<C>& source() const noexcept { return *source_; }
    /// The bounds that patches keep.
    [[nodiscard]] const MeshLimits& limits() const noexcept { return limits_; }
    /// Told of stages and of the work in patches; says whether the work was cancelled.
    [[nodiscard]] ProgressReporter& progress() const noexcept { return *progress_; }
    /// The executor of pieces of work.
    [[nodiscard]] const ParallelFor& parallel_for() const noexcept { return parallel_for_; }
    /// The mesh between phases, to read or to replace; not within for_each() or visit(). After for_each() vertices and faces are
    /// in spatial order within each tile.
    [[nodiscard]] HMESH_COLD IndexedMesh<C>& indexed() {
        put_together();
        return indexed_;
    }
    /// The number of vertices; unlike indexed(), never converts the mesh.
    [[nodiscard]] HMESH_COLD std::size_t vertex_count() const noexcept {
        if (!is_cut()) return indexed_.vertex_count();
        std::size_t count = cut_.locked_count;
        for (std::size_t k = 0; k < patches_.size(); ++k)
            count += patches_[k] != nullptr ? patches_[k]->free_count() : cut_.free_count[k];
        return count;
    }
    /// The squared error over pixels and channels, as of the last for_each() or measure(); rounding may leave it slightly
    /// negative. Not known after a cancellation.
    [[nodiscard]] HMESH_COLD double energy() const noexcept {
        if (!is_cut()) return indexed_.energy;
        double energy = 0;
        for (const auto& patch : patches_)
            if (patch != nullptr) energy += patch->mesh().energy();
        return energy;
    }
    /// The energy per vertex, >= 0.
    [[nodiscard]] double mean_energy() const noexcept { return std::max(0.0, energy()) / static_cast<double>(vertex_count()); }

    /// Calls body(patch, tile) for the patch of each tile that has faces, as pieces of work. All pieces together are the range that
    /// progress().set_range() announced. With one tile the body runs on the calling thread, so that it may use the executor
    /// itself. Patches of small images are kept for the next call with the same tiling, which then costs nothing; others are
    /// merged at once. Returns whether to go on: false after a cancellation, when the mesh is valid, some patches worked on in
    /// part and some not at all.
    HMESH_COLD bool for_each(const Tiling& tiling, FunctionRef<void(Patch<C>& patch, std::size_t tile)> body) {
        if (!is_cut() || tiling_ != tiling) {
            put_together();
            tiling_ = tiling;
            cut_ = detail::cut(indexed_.positions, indexed_.faces, tiling);
            patches_.resize(tiling.size());
        }
        const MomentTable<C>* const whole = whole_table(tiling.size() == 1);
        const double mean = mean_energy();
        std::vector<detail::PatchResult<C>> results(whole == nullptr ? tiling.size() : 0);
        run(
            cut_,
            [&](std::size_t tile, TaskProgress& task) {
                if (patches_[tile] == nullptr)
                    patches_[tile] = std::make_unique<Patch<C>>(indexed_, *source_, cut_, tile, limits_, whole);
                Patch<C>& patch = *patches_[tile];
                const TaskGuard guard(patch.mesh(), task);
                patch.set_mean_energy(mean);
                body(patch, tile);
                if (whole != nullptr) return;
                results[tile] = patch.result();
                patches_[tile].reset();
            },
            [&](std::size_t tile) {
                if (whole == nullptr) results[tile] = detail::unchanged(indexed_, cut_, tile);
            });
        if (whole == nullptr) merge(results);
        return !progress_->stopped();
    }

    /// Calls look(patch, tile, faces) for the patch of each tile that has faces, as pieces of work, and drops the patches: the
    /// mesh stays as it is. faces[f] is the face of indexed() that is face f of the patch. Returns whether to go on; after a
    /// cancellation patches are left out, unless `all`.
    HMESH_COLD bool visit(const Tiling& tiling,
                          FunctionRef<void(Patch<C>& patch, std::size_t tile, const std::uint32_t* faces)> look,
                          bool all = false) {
        put_together();
        const detail::Cut cut = detail::cut(indexed_.positions, indexed_.faces, tiling);
        const MomentTable<C>* const whole = whole_table(tiling.size() == 1);
        run(
            cut,
            [&](std::size_t tile, TaskProgress& task) {
                Patch<C> patch(indexed_, *source_, cut, tile, limits_, whole);
                const TaskGuard guard(patch.mesh(), task);
                patch.set_mean_energy(indexed_.mean_energy());
                look(patch, tile, cut.faces.data() + cut.first[tile]);
            },
            [](std::size_t) {}, all);
        return !progress_->stopped();
    }

    /// Computes indexed().energy for the positions and colours that the mesh has now, also after a cancellation. One table of
    /// each tile.
    HMESH_COLD void measure(const Tiling& tiling) {
        std::vector<double> energies(tiling.size(), 0.0);
        visit(
            tiling, [&](Patch<C>& patch, std::size_t k, const std::uint32_t*) { energies[k] = patch.mesh().energy(); }, true);
        indexed_.energy = 0;
        for (const double energy : energies) indexed_.energy += energy;
    }

  private:
    /// Connects a mesh with a task's progress for the guard's lifetime, also where the body throws.
    class TaskGuard {
      public:
        TaskGuard(ImageMesh<C>& mesh, TaskProgress& task) : mesh_(mesh) { mesh_.set_task(&task); }
        TaskGuard(const TaskGuard&) = delete;
        TaskGuard& operator=(const TaskGuard&) = delete;
        ~TaskGuard() { mesh_.set_task(nullptr); }

      private:
        ImageMesh<C>& mesh_;
    };

    /// The table of the whole image, made when first asked for, if it is `wanted` or the image is small; else null. Patches that
    /// share it need none of their own, which would take them a third of their time.
    [[nodiscard]] HMESH_COLD const MomentTable<C>* whole_table(bool wanted) {
        if (!wanted && source_->pixels() > 4194304) return nullptr;
        if (table_.width() == 0) table_ = source_->table({0, 0, source_->width(), source_->height()}, parallel_for_);
        return &table_;
    }

    /// Calls body(tile, task) for the tiles that have faces, those with most faces first; once cancelled, and unless `all`, calls
    /// skip(tile) instead.
    HMESH_COLD void run(const detail::Cut& cut, FunctionRef<void(std::size_t, TaskProgress&)> body,
                        FunctionRef<void(std::size_t)> skip, bool all = false) {
        const std::vector<std::size_t> tiles = detail::largest_first(cut);
        const auto piece = [&](std::size_t i) {
            const std::size_t k = tiles[i];
            if (!progress_->poll() && !all) return skip(k);
            TaskProgress task(*progress_,
                              static_cast<double>(cut.first[k + 1] - cut.first[k]) / static_cast<double>(cut.faces.size()));
            body(k, task);
        };
        if (tiles.size() == 1) piece(0);
        else parallel_for_(tiles.size(), piece);
    }

    /// Whether the mesh is held as patches of tiling_.
    [[nodiscard]] bool is_cut() const noexcept { return !patches_.empty(); }
    /// Ends is_cut().
    HMESH_COLD void put_together() {
        if (!is_cut()) return;
        std::vector<detail::PatchResult<C>> results(patches_.size());
        parallel_for_(patches_.size(), [&](std::size_t k) {
            results[k] = patches_[k] != nullptr ? patches_[k]->result() : detail::unchanged(indexed_, cut_, k);
            patches_[k].reset();
        });
        merge(results);
    }
    /// Makes indexed_ of the locked vertices of cut_ and the results of all its tiles, in the order of the tiles.
    HMESH_COLD void merge(const std::vector<detail::PatchResult<C>>& results) {
        const detail::Cut& cut = cut_;
        IndexedMesh<C> merged;
        merged.width = indexed_.width;
        merged.height = indexed_.height;
        std::vector<std::size_t> first_vertex(results.size() + 1, cut.locked_count), first_face(results.size() + 1, 0);
        for (std::size_t k = 0; k < results.size(); ++k) {
            first_vertex[k + 1] = first_vertex[k] + results[k].positions.size();
            first_face[k + 1] = first_face[k] + results[k].faces.size();
            merged.energy += results[k].energy;
        }
        merged.positions.resize(first_vertex.back());
        merged.colors.resize(first_vertex.back());
        merged.dirty.resize(first_vertex.back());
        merged.faces.resize(first_face.back());
        for (std::size_t v = 0; v < indexed_.vertex_count(); ++v) {
            if (cut.owner[v] != detail::Cut::locked) continue;
            merged.positions[cut.number[v]] = indexed_.positions[v];
            merged.colors[cut.number[v]] = indexed_.colors[v];
        }
        parallel_for_(results.size(), [&](std::size_t k) {
            const detail::PatchResult<C>& result = results[k];
            const auto to = static_cast<std::ptrdiff_t>(first_vertex[k]);
            std::copy(result.positions.begin(), result.positions.end(), merged.positions.begin() + to);
            std::copy(result.colors.begin(), result.colors.end(), merged.colors.begin() + to);
            std::copy(result.dirty.begin(), result.dirty.end(), merged.dirty.begin() + to);
            const std::size_t free = result.positions.size();
            for (std::size_t t = 0; t < result.faces.size(); ++t)
                for (std::size_t c = 0; c < 3; ++c) {
                    const std::uint32_t v = result.faces[t][c];
                    merged.faces[first_face[k] + t][c] =
                        v < free ? static_cast<std::uint32_t>(first_vertex[k]) + v : cut.number[result.locked[v - free]];
                }
        });
        for (const detail::PatchResult<C>& result : results)
            for (const std::uint32_t v : result.locked_dirty) merged.dirty[cut.number[v]] = 1;
        indexed_ = std::move(merged);
        cut_ = {};
        patches_.clear();
    }

    const ImageSource<C>* source_;
    MeshLimits limits_;
    ProgressReporter* progress_;
    ParallelFor parallel_for_;
    IndexedMesh<C> indexed_;
    Tiling tiling_{1, 1, 1};
    detail::Cut cut_;                                 ///< of indexed_ along tiling_, where the mesh is held as patches
    std::vector<std::unique_ptr<Patch<C>>> patches_;  ///< of the tiles, in place of indexed_'s faces and free vertices; or none
    MomentTable<C> table_;                            ///< of the whole image, or empty
};

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_TILES_TILED_MESH_HPP
