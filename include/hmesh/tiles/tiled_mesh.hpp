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
    [[nodiscard]] IndexedMesh<C>& indexed() {
        put_back();
        return indexed_;
    }
    /// The number of vertices; unlike indexed(), never converts the mesh.
    [[nodiscard]] std::size_t vertex_count() const noexcept {
        return single_ ? single_->vertex_count() : indexed_.vertex_count();
    }
    /// The squared error over pixels and channels, as of the last for_each() or measure(); rounding may leave it slightly
    /// negative.
    [[nodiscard]] double energy() const noexcept { return single_ ? single_->mesh().energy() : indexed_.energy; }
    /// The energy per vertex, >= 0.
    [[nodiscard]] double mean_energy() const noexcept { return std::max(0.0, energy()) / static_cast<double>(vertex_count()); }

    /// Calls body(patch, tile) for the patch of each tile that has faces, as pieces of work, then merges the patches. All pieces
    /// together are the range that progress().set_range() announced. With one tile the body runs on the calling thread. Returns
    /// whether to go on: false after a cancellation, when the mesh is valid, some patches worked on in part and some not at all,
    /// and indexed().energy is no longer known.
    HMESH_COLD bool for_each(const Tiling& tiling, FunctionRef<void(Patch<C>& patch, std::size_t tile)> body) {
        if (tiling.size() == 1) {
            run_single(body);
            return !progress_->stopped();
        }
        put_back();
        const detail::Cut cut = detail::cut(indexed_.positions, indexed_.faces, tiling);
        std::vector<detail::PatchResult<C>> results(tiling.size());
        run(
            cut,
            [&](Patch<C>& patch, std::size_t tile) {
                body(patch, tile);
                results[tile] = patch.result();
            },
            [&](std::size_t tile) { results[tile] = detail::unchanged(indexed_, cut, tile); });
        merge(cut, results);
        return !progress_->stopped();
    }

    /// Calls look(patch, tile, faces) for the patch of each tile that has faces, as pieces of work, and drops the patches: the
    /// mesh stays as it is. faces[f] is the face of indexed() that is face f of the patch. Returns whether to go on; after a
    /// cancellation patches are left out, unless `all`.
    HMESH_COLD bool visit(const Tiling& tiling,
                          FunctionRef<void(Patch<C>& patch, std::size_t tile, const std::uint32_t* faces)> look,
                          bool all = false) {
        put_back();
        const detail::Cut cut = detail::cut(indexed_.positions, indexed_.faces, tiling);
        run(
            cut, [&](Patch<C>& patch, std::size_t tile) { look(patch, tile, cut.faces.data() + cut.first[tile]); },
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

    /// for_each() with a single tile: the one patch is kept alive between phases and converted back only when indexed() is
    /// called. Runs on the calling thread, so that the body may use the executor itself.
    HMESH_COLD void run_single(FunctionRef<void(Patch<C>&, std::size_t)> body) {
        if (!progress_->poll()) return;
        TaskProgress task(*progress_, 1);
        if (!single_) {
            const Tiling whole(indexed_.width, indexed_.height, std::max(indexed_.width, indexed_.height));
            const detail::Cut cut = detail::cut(indexed_.positions, indexed_.faces, whole);
            single_ = std::make_unique<Patch<C>>(indexed_, *source_, cut, 0, limits_, nullptr, whole_table(true));
        }
        const TaskGuard guard(single_->mesh(), task);
        body(*single_, 0);
    }
    /// Converts the single patch, if there is one, back to indexed_.
    HMESH_COLD void put_back() {
        if (!single_) return;
        detail::PatchResult<C> result = single_->result();
        indexed_.positions = std::move(result.positions);
        indexed_.colors = std::move(result.colors);
        indexed_.dirty = std::move(result.dirty);
        indexed_.faces = std::move(result.faces);
        indexed_.energy = result.energy;
        single_.reset();
    }

    /// The table of the whole image, made when first asked for, if it is `wanted` or has at most 2^22 pixels; else null. Patches
    /// that share it need none of their own, which would take them a third of their time.
    [[nodiscard]] HMESH_COLD const MomentTable<C>* whole_table(bool wanted) {
        if (!wanted && source_->pixels() > 4194304) return nullptr;
        if (table_.width() == 0) table_ = source_->table({0, 0, source_->width(), source_->height()}, parallel_for_);
        return &table_;
    }

    /// Calls body(patch, tile) for the patches that have faces, those with most faces first; once cancelled, and unless `all`,
    /// calls skip(tile) instead.
    HMESH_COLD void run(const detail::Cut& cut, FunctionRef<void(Patch<C>&, std::size_t)> body,
                        FunctionRef<void(std::size_t)> skip, bool all = false) {
        const std::vector<std::size_t> tiles = detail::largest_first(cut);
        const MomentTable<C>* const whole = whole_table(tiles.size() == 1);
        parallel_for_(tiles.size(), [&](std::size_t i) {
            const std::size_t k = tiles[i];
            if (!progress_->poll() && !all) return skip(k);
            TaskProgress task(*progress_,
                              static_cast<double>(cut.first[k + 1] - cut.first[k]) / static_cast<double>(indexed_.faces.size()));
            Patch<C> patch(indexed_, *source_, cut, k, limits_, &task, whole);
            body(patch, k);
        });
    }

    /// Makes indexed_ of the locked vertices of a cut and the results of all its tiles, in the order of the tiles.
    HMESH_COLD void merge(const detail::Cut& cut, const std::vector<detail::PatchResult<C>>& results) {
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
    }

    const ImageSource<C>* source_;
    MeshLimits limits_;
    ProgressReporter* progress_;
    ParallelFor parallel_for_;
    IndexedMesh<C> indexed_;
    std::unique_ptr<Patch<C>> single_;  ///< the whole mesh as one patch, in place of indexed_; or null
    MomentTable<C> table_;              ///< of the whole image, or empty
};

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_TILES_TILED_MESH_HPP
