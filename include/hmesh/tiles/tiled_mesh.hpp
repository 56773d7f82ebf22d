/// \file
/// TiledMesh: a mesh of any size under work, patch by patch.
///
/// What a method holds: the whole mesh, the image, and how to run pieces of work. for_each cuts the mesh along a tiling, lets
/// each patch be worked on through the executor, and merges the results: a serial part of about 0.2 us a vertex.
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

template <int C>
class TiledMesh {
  public:
    /// Work on the mesh of one patch.
    using MeshWork = FunctionRef<void(ImageMesh<C>& mesh)>;

    /// Over an image, a progress and an executor that outlive it.
    TiledMesh(const ImageSource<C>& source, const MeshLimits& limits, ProgressReporter& progress,
              const ParallelFor& parallel_for = {})
        : source_(&source), limits_(limits), progress_(&progress), parallel_for_(parallel_for) {}

    [[nodiscard]] const ImageSource<C>& source() const noexcept { return *source_; }
    [[nodiscard]] const MeshLimits& limits() const noexcept { return limits_; }
    [[nodiscard]] ProgressReporter& progress() const noexcept { return *progress_; }
    [[nodiscard]] const ParallelFor& parallel_for() const noexcept { return parallel_for_; }
    /// The mesh between phases, in spatial order.
    [[nodiscard]] IndexedMesh<C>& indexed() {
        put_back();
        return indexed_;
    }
    /// Of the mesh, which may go on being one patch.
    [[nodiscard]] std::size_t vertex_count() const noexcept { return only_ ? only_->vertex_count() : indexed_.vertex_count(); }
    [[nodiscard]] double energy() const noexcept { return only_ ? only_->mesh().energy() : indexed_.energy; }
    /// Of a vertex, never below 0, where rounding may leave less than nothing.
    [[nodiscard]] double mean_energy() const noexcept { return std::max(0.0, energy()) / static_cast<double>(vertex_count()); }

    /// Calls work(patch, tile) for the patch of each tile that has triangles, then puts all together again. The pieces
    /// together are what the progress expects. Returns whether to go on; after a cancellation the mesh is valid, some patches
    /// being worked on in part and some not at all, and indexed().energy is not known any more.
    HMESH_COLD bool for_each(const Tiling& tiling, FunctionRef<void(Patch<C>& patch, std::size_t tile)> work) {
        if (tiling.size() == 1) {
            work_on_only(work);
            return !progress_->stopped();
        }
        put_back();
        const detail::Cut cut = detail::cut(indexed_, tiling);
        std::vector<detail::PatchResult<C>> results(tiling.size());
        run(
            cut,
            [&](Patch<C>& patch, std::size_t tile) {
                work(patch, tile);
                results[tile] = patch.result();
            },
            [&](std::size_t tile) { results[tile] = detail::unchanged(indexed_, cut, tile); });
        merge(cut, results);
        return !progress_->stopped();
    }

    /// Calls look(patch, tile, faces) in the same way and changes nothing; faces[f] is the face of the whole mesh
    /// that is face f of the patch. After a cancellation patches may have been left out, unless `all`.
    HMESH_COLD bool visit(const Tiling& tiling,
                          FunctionRef<void(Patch<C>& patch, std::size_t tile, const std::uint32_t* faces)> look,
                          bool all = false) {
        put_back();
        const detail::Cut cut = detail::cut(indexed_, tiling);
        run(
            cut, [&](Patch<C>& patch, std::size_t tile) { look(patch, tile, cut.triangles.data() + cut.first[tile]); },
            [](std::size_t) {}, all);
        return !progress_->stopped();
    }

    /// Computes the energy of indexed(), with the positions and colours that it has now.
    HMESH_COLD void measure(const Tiling& tiling) {
        std::vector<double> energies(tiling.size(), 0.0);
        visit(
            tiling, [&](Patch<C>& patch, std::size_t k, const std::uint32_t*) { energies[k] = patch.mesh().energy(); }, true);
        indexed_.energy = 0;
        for (const double energy : energies) indexed_.energy += energy;
    }

  private:
    /// Lets a mesh tell its progress as long as this lives, also if its work throws.
    class TaskGuard {
      public:
        TaskGuard(ImageMesh<C>& mesh, TaskProgress& task) : mesh_(mesh) { mesh_.set_task(&task); }
        TaskGuard(const TaskGuard&) = delete;
        TaskGuard& operator=(const TaskGuard&) = delete;
        ~TaskGuard() { mesh_.set_task(nullptr); }

      private:
        ImageMesh<C>& mesh_;
    };

    /// Single-tile case: the one patch is kept alive between phases and put back only when indexed() is called. On the calling
    /// thread, so that the work may use the executor itself.
    HMESH_COLD void work_on_only(FunctionRef<void(Patch<C>&, std::size_t)> work) {
        if (!progress_->poll()) return;
        TaskProgress task(*progress_, 1);
        if (!only_) {
            const detail::Cut cut =
                detail::cut(indexed_, Tiling(indexed_.width, indexed_.height, std::max(indexed_.width, indexed_.height)));
            only_ = std::make_unique<Patch<C>>(indexed_, *source_, cut, 0, limits_, nullptr, std::move(table_));
        }
        const TaskGuard guard(only_->mesh(), task);
        work(*only_, 0);
    }
    HMESH_COLD void put_back() {
        if (!only_) return;
        detail::PatchResult<C> result = only_->result();
        indexed_.positions = std::move(result.positions);
        indexed_.colors = std::move(result.colors);
        indexed_.dirty = std::move(result.dirty);
        indexed_.faces = std::move(result.triangles);
        indexed_.energy = result.energy;
        table_ = only_->take_table();
        only_.reset();
    }

    /// The patches that have triangles, the largest first; skip(tile) instead of work(patch, tile) once cancelled.
    HMESH_COLD void run(const detail::Cut& cut, FunctionRef<void(Patch<C>&, std::size_t)> work,
                        FunctionRef<void(std::size_t)> skip, bool all = false) {
        const auto count = [&](std::size_t k) { return cut.first[k + 1] - cut.first[k]; };
        std::vector<std::size_t> tiles;
        for (std::size_t k = 0; k + 1 < cut.first.size(); ++k)
            if (count(k) > 0) tiles.push_back(k);
        std::sort(tiles.begin(), tiles.end(),
                  [&](std::size_t a, std::size_t b) { return count(a) != count(b) ? count(a) > count(b) : a < b; });
        parallel_for_(tiles.size(), [&](std::size_t i) {
            const std::size_t k = tiles[i];
            if (!progress_->poll() && !all) return skip(k);
            TaskProgress task(*progress_, static_cast<double>(count(k)) / static_cast<double>(indexed_.faces.size()));
            const bool only = tiles.size() == 1;
            Patch<C> patch(indexed_, *source_, cut, k, limits_, &task, only ? std::move(table_) : MomentTable<C>());
            work(patch, k);
            if (only) table_ = patch.take_table();
        });
    }

    HMESH_COLD void merge(const detail::Cut& cut, const std::vector<detail::PatchResult<C>>& results) {
        IndexedMesh<C> merged;
        merged.width = indexed_.width;
        merged.height = indexed_.height;
        std::vector<std::size_t> first_vertex(results.size() + 1, cut.frozen_count), first_triangle(results.size() + 1, 0);
        for (std::size_t k = 0; k < results.size(); ++k) {
            first_vertex[k + 1] = first_vertex[k] + results[k].positions.size();
            first_triangle[k + 1] = first_triangle[k] + results[k].triangles.size();
            merged.energy += results[k].energy;
        }
        merged.positions.resize(first_vertex.back());
        merged.colors.resize(first_vertex.back());
        merged.dirty.resize(first_vertex.back());
        merged.faces.resize(first_triangle.back());
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
            for (std::size_t t = 0; t < result.triangles.size(); ++t)
                for (std::size_t c = 0; c < 3; ++c) {
                    const std::uint32_t v = result.triangles[t][c];
                    merged.faces[first_triangle[k] + t][c] =
                        v < free ? static_cast<std::uint32_t>(first_vertex[k]) + v : cut.number[result.locked[v - free]];
                }
        });
        for (const detail::PatchResult<C>& result : results)
            for (const std::uint32_t v : result.locked_dirty) merged.dirty[cut.number[v]] = 1;
        indexed_ = std::move(merged);
    }

    const ImageSource<C>* source_;
    MeshLimits limits_;
    ProgressReporter* progress_;
    ParallelFor parallel_for_;
    IndexedMesh<C> indexed_;
    std::unique_ptr<Patch<C>> only_;  ///< in place of whole_, where one patch is all of it
    MomentTable<C> table_;            ///< of the whole image, for that patch: made once
};

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_TILES_TILED_MESH_HPP
