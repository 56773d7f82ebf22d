/// \file
/// TiledMesh: a mesh of any size that is worked on patch by patch.
///
/// A TiledMesh is what recipes are given (methods/recipe.hpp): the mesh, the image, the progress, and the executor. for_each()
/// cuts the mesh along a tiling, has each patch worked on through the executor, and merges the results, of small images only when
/// another tiling or the mesh itself is asked for.
///
/// Cost of a cut and a merge: about 1 us a vertex in the patches, which is parallel, and 0.2 us a vertex, which is not.
#ifndef HMESH_TILES_TILED_MESH_HPP
#define HMESH_TILES_TILED_MESH_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "hmesh/core/array.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/core/progress.hpp"
#include "hmesh/fit/image_mesh.hpp"
#include "hmesh/fit/image_source.hpp"
#include "hmesh/tiles/indexed_mesh.hpp"
#include "hmesh/tiles/patch.hpp"
#include "hmesh/tiles/recut.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// What the runs of a search find out about the image once, each for the next.
template <int C>
struct ImageNotes {
    MomentTable<C> table;         ///< of the whole image, or empty
    Image<float, 1> point_ranks;  ///< one number a pixel by which a recipe places its first points, or empty
};

/// A mesh of an image of C channels, as the patches of a tiling or, between phases, as an IndexedMesh.
template <int C>
class TiledMesh {
  public:
    /// What is done to the mesh of one patch.
    using MeshWork = FunctionRef<void(ImageMesh<C>& mesh)>;
    /// What is done to the patch of a tile.
    using PatchWork = FunctionRef<void(Patch<C>& patch, std::size_t tile)>;
    /// What visit() calls.
    using PatchLook = FunctionRef<void(Patch<C>& patch, std::size_t tile, const std::uint32_t* faces)>;

    /// An empty mesh. The image source, the progress reporter and the executor must outlive the TiledMesh.
    HMESH_NEVER_INLINE HMESH_COLD TiledMesh(const ImageSource<C>& source, const MeshLimits& limits, ProgressReporter& progress,
                                            const ParallelFor& parallel_for = {})
        : source_(&source), limits_(limits), progress_(&progress), polling_(progress, parallel_for), parallel_for_(polling_) {}
    TiledMesh(const TiledMesh&) = delete;             ///< not copied: its executor refers to it
    TiledMesh& operator=(const TiledMesh&) = delete;  ///< not assigned

    /// The image to be meshed.
    [[nodiscard]] const ImageSource<C>& source() const noexcept { return *source_; }
    /// The bounds that patches keep.
    [[nodiscard]] const MeshLimits& limits() const noexcept { return limits_; }
    /// Told of stages and of the work in patches; says whether the work was cancelled.
    [[nodiscard]] ProgressReporter& progress() const noexcept { return *progress_; }
    /// From now on another reporter is told, which must outlive the TiledMesh; between phases only.
    void report_to(ProgressReporter& progress) noexcept {
        progress_ = &progress;
        polling_.report_to(progress);
    }
    /// From now on mesh_so_far() is this, whose callable must outlive the work.
    void offer(FunctionRef<Mesh()> mesh_so_far) noexcept { mesh_so_far_ = mesh_so_far; }
    /// What progress() may offer as ProgressInfo::mesh_so_far between phases; empty: nothing.
    [[nodiscard]] FunctionRef<Mesh()> mesh_so_far() const noexcept { return mesh_so_far_; }
    /// The executor of pieces of work, which asks the callback of progress() before each.
    [[nodiscard]] const ParallelFor& parallel_for() const noexcept { return parallel_for_; }
    /// The mesh between phases, to read or to replace; not within for_each() or visit(). After for_each() vertices and faces are
    /// in spatial order within each tile.
    [[nodiscard]] HMESH_COLD IndexedMesh<C>& indexed() {
        put_together();
        return indexed_;
    }
    /// A copy of indexed() that leaves the mesh as it is held, and so all later work on it; between phases only.
    [[nodiscard]] HMESH_COLD IndexedMesh<C> copy() { return is_cut() ? joined({}, true) : indexed_; }
    /// The number of vertices, a copy not counted; unlike indexed(), never converts the mesh.
    [[nodiscard]] HMESH_COLD std::size_t vertex_count() const noexcept {
        if (!is_cut()) return indexed_.distinct_count();
        std::size_t count = cut_.locked_vertices.size() - indexed_.copy_count;
        for (std::size_t k = 0; k < patches_.size(); ++k) count += patches_[k] ? patches_[k]->free_count() : cut_.free_count[k];
        return count;
    }
    /// Whether there is a moment table of the whole image: it is small and not periodic. Patches have none of their own then. One
    /// table of more pixels, larger than any cache, would take as long and several times the memory.
    [[nodiscard]] HMESH_COLD bool has_whole_table() const noexcept { return source_->periodic() == Periodic::none && is_small(); }
    /// What is known of the image: may be moved from one mesh to the next of the same source, between phases.
    [[nodiscard]] ImageNotes<C>& notes() noexcept { return notes_; }
    /// Whether the image is so small, 2^22 pixels, widest_table() and, as if it had weights, 512 MiB at most, that patches stay
    /// for the next call with the same tiling, and one may be of the whole.
    [[nodiscard]] HMESH_COLD bool is_small() const noexcept {
        return source_->pixels() <= 4194304 && source_->width() <= source_->widest_table() &&
               MomentTable<C>::fits_memory(source_->width(), source_->height(), std::int64_t{1} << 29U);
    }
    /// Whether the mesh is cut by patches' borders: there are several, or it is periodic and cut open.
    [[nodiscard]] bool has_seams(const Tiling& tiling) const noexcept {
        return tiling.size() > 1 || source_->periodic() != Periodic::none;
    }
    /// The tiling as whose patches the mesh is held, so that for_each() along it need not make them; else `other`.
    [[nodiscard]] HMESH_COLD Tiling tiling_or(const Tiling& other) const { return is_cut() ? tiling_ : other; }
    /// The number of vertices that were free in no patch of the last for_each().
    [[nodiscard]] std::size_t locked_count() const noexcept {
        return is_cut() ? cut_.locked_vertices.size() : indexed_.locked_count;
    }
    /// The squared error over pixels and channels, as of the last for_each() or measure(); rounding may leave it slightly
    /// negative.
    [[nodiscard]] HMESH_COLD double energy() const noexcept {
        if (!is_cut()) return indexed_.energy;
        detail::EnergySum sum;
        for (std::size_t k = 0; k < patches_.size(); ++k)
            if (patches_[k]) sum.add(patches_[k]->first_energy(), patches_[k]->mesh().energy());
            else if (cut_.first[k] < cut_.first[k + 1]) sum.leave_out();
        return sum.energy(indexed_.energy);
    }
    /// The energy per vertex, >= 0.
    [[nodiscard]] double mean_energy() const noexcept { return std::max(0.0, energy()) / static_cast<double>(vertex_count()); }

    /// Calls body(patch, tile) for the patch of each tile that has faces, as pieces of work. All pieces together are the range
    /// that progress().set_range() announced. With one tile the body runs on the calling thread, so that it may use the executor
    /// itself. Patches of small images are kept for the next call with the same tiling, which then costs nothing; others are
    /// merged at once. Where `step` > 1 those of each step-th tile alone. Returns whether to go on: false after a cancellation,
    /// when the mesh is valid, some patches worked on in part and some not at all.
    HMESH_COLD bool for_each(const Tiling& tiling, PatchWork body, std::size_t step = 1) {
        return cut_and_run(tiling, {false, true, step}, body);
    }
    /// The same for the patches alone in which vertices are free that were locked in the last for_each(), which had another
    /// tiling: they are in patch.take_was_locked().
    HMESH_COLD bool for_each_seam(const Tiling& tiling, PatchWork body) { return cut_and_run(tiling, {true, true, 1}, body); }
    /// for_each() with a body that changes no mesh, for the patches of each `step`-th tile alone: the next call with this tiling
    /// finds the same patches, vertex for vertex.
    HMESH_COLD bool look_at_each(const Tiling& tiling, PatchWork body, std::size_t step = 1) {
        return cut_and_run(tiling, {false, false, step}, body);
    }
    /// for_each_seam() with a body that changes no mesh.
    HMESH_COLD bool look_at_each_seam(const Tiling& tiling, PatchWork body) {
        return cut_and_run(tiling, {true, false, 1}, body);
    }
    /// The step for what some patches tell well enough: 1 where patches stay for the next call, else up to 7, so that there are
    /// 16 of them at least.
    [[nodiscard]] HMESH_COLD std::size_t sample_step(const Tiling& tiling) const noexcept {
        return is_small() ? 1 : std::max<std::size_t>(1, std::min<std::size_t>(7, tiling.size() / 16));
    }
    /// Finds energy() of a mesh of which it is not known, or about that, by some of its patches. Returns whether to go on.
    HMESH_COLD bool estimate_energy(const Tiling& tiling) {
        const std::size_t step = sample_step(tiling);
        Array<double> energies(tiling.size(), 0.0);
        const bool go_on = look_at_each(
            tiling, [&](Patch<C>& patch, std::size_t tile) { energies[tile] = patch.mesh().energy(); }, step);
        double energy = 0, faces = 0;
        for (std::size_t k = 0; k < energies.size(); k += step) {
            energy += energies[k];
            faces += static_cast<double>(cut_.first[k + 1] - cut_.first[k]);
        }
        indexed_.energy = faces > 0 ? energy * static_cast<double>(cut_.faces.size()) / faces : 0;
        return go_on;
    }

    /// Calls look(patch, tile, faces) for the patch of each tile that has faces, as pieces of work, and drops the patches: the
    /// mesh stays as it is. faces[f] is the face of indexed() that is face f of the patch. Returns whether to go on; after a
    /// cancellation patches are left out, unless `all`.
    HMESH_COLD bool visit(const Tiling& tiling, PatchLook look, bool all = false) {
        put_together();
        recut(indexed_, tiling.left(), tiling.top(), parallel_for_);
        const detail::Cut cut = detail::cut(indexed_.positions, indexed_.faces, tiling, indexed_.roots, parallel_for_);
        const MomentTable<C>* const whole = whole_table(tiling.size() == 1);
        run(
            detail::face_counts(cut),
            [&](std::size_t tile, TaskProgress& task) {
                Patch<C> patch(indexed_, *source_, cut, tile, limits_, whole);
                const TaskGuard guard(patch.mesh(), task);
                patch.set_mean_energy(indexed_.mean_energy());
                look(patch, tile, cut.faces.data() + cut.first[tile]);
            },
            all);
        return !progress_->stopped();
    }

    /// Computes indexed().energy for the positions and colours that the mesh has now, also after a cancellation. One table of
    /// each tile. look(), where set, is called as visit() does, before the patch's energy is read: it may change colours of free
    /// vertices, in the patch and in the mesh.
    HMESH_COLD void measure(const Tiling& tiling, PatchLook look = {}) {
        Array<double> energies(tiling.size(), 0.0);
        const auto body = [&](Patch<C>& patch, std::size_t k, const std::uint32_t* faces) {
            if (look) look(patch, k, faces);
            energies[k] = patch.mesh().energy();
        };
        visit(tiling, body, true);
        indexed_.energy = 0;
        for (const double energy : energies) indexed_.energy += energy;
    }

  private:
    using Patches = std::vector<std::optional<Patch<C>>>;

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

    /// The table of the whole image, made when first asked for, if it is `wanted` or has_whole_table(); else null.
    [[nodiscard]] HMESH_COLD const MomentTable<C>* whole_table(bool wanted) {
        if (source_->periodic() != Periodic::none || (!wanted && !has_whole_table())) return nullptr;
        if (notes_.table.width() == 0) notes_.table = source_->table({0, 0, source_->width(), source_->height()}, parallel_for_);
        return &notes_.table;
    }

    /// Calls body(tile, task) for the tiles of size > 0, the largest first or, of an image that is read, in their order, so that
    /// who reads it may keep what lies beside a tile; after a cancellation no more, unless `all`.
    HMESH_COLD void run(const Array<double>& sizes, FunctionRef<void(std::size_t, TaskProgress&)> body, bool all = false) {
        const Array<std::size_t> tiles = detail::order_of_work(sizes, !source_->is_read());
        double sum = 0;
        for (const double size : sizes) sum += size;
        const auto piece = [&](std::size_t i) {
            if (progress_->stopped() && !all) return;
            TaskProgress task(*progress_, sizes[tiles[i]] / sum);
            body(tiles[i], task);
        };
        if (tiles.size() == 1) piece(0);
        else parallel_for_(tiles.size(), piece);
    }
    /// Which patches are worked on.
    struct Which {
        bool at_seams = false;  ///< those alone with vertices that were locked
        bool changes = true;    ///< whether the work changes their meshes
        std::size_t step = 1;   ///< those of each step-th tile alone
    };
    /// The four calls above.
    HMESH_COLD bool cut_and_run(const Tiling& tiling, const Which& which, PatchWork body) {
        cut_along(tiling);
        Array<double> sizes = which.at_seams ? Array<double>(tiling.size(), 0.0) : detail::face_counts(cut_);
        for (std::size_t v = 0; which.at_seams && v < indexed_.locked_count; ++v)
            if (cut_.owner[v] != detail::Cut::locked) ++sizes[cut_.owner[v]];
        for (std::size_t k = 0; k < sizes.size(); ++k)
            if (k % which.step != 0) sizes[k] = 0;
        const MomentTable<C>* const whole = whole_table(sizes.size() == 1);
        const double mean = mean_energy();
        const bool stays = is_small() || (whole != nullptr && sizes.size() == 1);
        std::vector<detail::PatchResult<C>> results(!stays && which.changes ? sizes.size() : 0);
        run(sizes, [&](std::size_t tile, TaskProgress& task) {
            std::optional<Patch<C>>& patch = patches_[tile];
            if (!patch)
                patch.emplace(indexed_, *source_, cut_, tile, limits_, whole, sizes.size() == 1 ? parallel_for_ : ParallelFor());
            {
                const TaskGuard guard(patch->mesh(), task);
                patch->set_mean_energy(mean);
                body(*patch, tile);
            }
            if (stays) return;
            if (which.changes) results[tile] = patch->result();
            patch.reset();
        });
        if (!results.empty()) put_together(std::move(results));
        return !progress_->stopped();
    }

    /// Whether the mesh is held as patches of tiling_.
    [[nodiscard]] bool is_cut() const noexcept { return !patches_.empty(); }
    /// Makes the mesh is_cut() along a tiling.
    HMESH_COLD void cut_along(const Tiling& tiling) {
        if (is_cut() && tiling_ == tiling) return;
        put_together();
        recut(indexed_, tiling.left(), tiling.top(), parallel_for_);
        tiling_ = tiling;
        cut_ = detail::cut(indexed_.positions, indexed_.faces, tiling, indexed_.roots, parallel_for_);
        Patches(tiling.size()).swap(patches_);  // resize() would move patches
    }
    /// Ends is_cut(): indexed_ becomes what is joined().
    HMESH_COLD void put_together(std::vector<detail::PatchResult<C>> results = {}) {
        if (!is_cut()) return;
        indexed_ = joined(std::move(results), false);
        cut_ = {};
        patches_.clear();
    }
    /// The mesh of a TiledMesh that is_cut(), of the locked vertices of cut_, of patches_, and of the results of patches that are
    /// gone. Unless it `stays` as it is held, what is done with is freed.
    [[nodiscard]] HMESH_PATCHWISE IndexedMesh<C> joined(std::vector<detail::PatchResult<C>> results, bool stays) {
        const double energy = take_results(results);
        Array<std::size_t> first_vertex(results.size() + 1, cut_.locked_vertices.size()), first_face(results.size() + 1, 0);
        for (std::size_t k = 0; k < results.size(); ++k) {
            first_vertex[k + 1] = first_vertex[k] + results[k].positions.size();
            first_face[k + 1] = first_face[k] + results[k].faces.size();
        }
        IndexedMesh<C> merged = locked_part(first_vertex.back());
        merged.energy = energy;
        // Three meshes would be too many for those that fill the memory.
        if (!stays) {
            indexed_ = {};
            cut_.faces = {};
            cut_.owner = {};
        }
        merged.positions.resize_raw(first_vertex.back());
        merged.colors.resize_raw(first_vertex.back());
        merged.dirty.resize_raw(first_vertex.back());
        merged.faces.resize_raw(first_face.back());
        parallel_for_(results.size(), [&](std::size_t k) { put(results[k], first_vertex[k], first_face[k], merged); });
        for (const detail::PatchResult<C>& result : results)
            for (const std::uint32_t v : result.locked_dirty) merged.dirty[cut_.number[v]] = 1;
        return merged;
    }
    /// Completes the results by those of patches_ and, of tiles where nothing was done, by what indexed_ has there. Returns the
    /// energy of the mesh.
    [[nodiscard]] HMESH_PATCHWISE double take_results(std::vector<detail::PatchResult<C>>& results) {
        results.resize(patches_.size());
        parallel_for_(patches_.size(), [&](std::size_t k) {
            if (patches_[k]) results[k] = patches_[k]->result();
        });
        detail::EnergySum sum;
        for (std::size_t k = 0; k < results.size(); ++k) {
            if (cut_.first[k] == cut_.first[k + 1]) continue;
            if (!results[k].faces.empty()) {
                sum.add(results[k].first_energy, results[k].energy);
                continue;
            }
            (void)progress_->poll();
            results[k] = detail::unchanged(indexed_, cut_, k);
            sum.leave_out();
        }
        return sum.energy(indexed_.energy);
    }
    /// A mesh like indexed_ of its locked vertices alone, without faces; roots are those of `count` vertices.
    [[nodiscard]] HMESH_PATCHWISE IndexedMesh<C> locked_part(std::size_t count) const {
        IndexedMesh<C> out;
        out.width = indexed_.width;
        out.height = indexed_.height;
        out.locked_count = cut_.locked_vertices.size();
        out.periodic = indexed_.periodic;
        out.samples = indexed_.samples;
        out.has_fixed_border = indexed_.has_fixed_border;
        out.copy_count = indexed_.copy_count;
        out.positions.resize_raw(out.locked_count);
        out.colors.resize_raw(out.locked_count);
        out.dirty.resize(out.locked_count);
        for (std::size_t k = 0; k < out.locked_count; ++k) {
            out.positions[k] = indexed_.positions[cut_.locked_vertices[k]];
            out.colors[k] = indexed_.colors[cut_.locked_vertices[k]];
        }
        if (out.periodic == Periodic::none) return out;
        out.roots.resize(count);
        for (std::size_t v = 0; v < count; ++v) out.roots[v] = static_cast<std::uint32_t>(v);
        for (std::size_t v = 0; v < indexed_.vertex_count(); ++v)  // copies and what they are copies of are locked
            if (indexed_.roots[v] != v) out.roots[cut_.number[v]] = cut_.number[indexed_.roots[v]];
        return out;
    }
    /// Puts the vertices and faces of a patch to where its first ones stand in a mesh.
    HMESH_PATCHWISE void put(const detail::PatchResult<C>& result, std::size_t first_vertex, std::size_t first_face,
                             IndexedMesh<C>& mesh) const {
        const auto to = static_cast<std::ptrdiff_t>(first_vertex);
        std::copy(result.positions.begin(), result.positions.end(), mesh.positions.begin() + to);
        for (std::size_t v = 0; v < result.colors.size(); ++v) {
            Color<C> color = Color<C>::zero();
            for (int c = 0; c < C; ++c) color.set(c, result.colors[v][static_cast<std::size_t>(c)]);
            mesh.colors[first_vertex + v] = color;
        }
        std::copy(result.dirty.begin(), result.dirty.end(), mesh.dirty.begin() + to);
        const std::size_t free = result.positions.size();
        for (std::size_t t = 0; t < result.faces.size(); ++t)
            for (std::size_t c = 0; c < 3; ++c) {
                const std::uint32_t v = result.faces[t][c];
                mesh.faces[first_face + t][c] =
                    v < free ? static_cast<std::uint32_t>(first_vertex) + v : cut_.number[result.locked[v - free]];
            }
    }

    const ImageSource<C>* source_;
    MeshLimits limits_;
    ProgressReporter* progress_;
    PollingExecutor polling_;
    ParallelFor parallel_for_;  ///< polling_
    FunctionRef<Mesh()> mesh_so_far_;
    IndexedMesh<C> indexed_;
    Tiling tiling_{1, 1, 1};
    detail::Cut cut_;  ///< of indexed_ along tiling_, where the mesh is held as patches
    Patches patches_;  ///< of the tiles, in place of indexed_'s faces and free vertices; or none
    ImageNotes<C> notes_;
};

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_TILES_TILED_MESH_HPP
