/// \file
/// Annealed: the recipe of best fidelity, which is the default, and its options.
///
/// The method itself is in methods/annealed/annealed.hpp. This header does not include it, so that a program may name the recipe
/// and leave its compilation to another file.
#ifndef HMESH_METHODS_ANNEALED_OPTIONS_HPP
#define HMESH_METHODS_ANNEALED_OPTIONS_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "hmesh/core/compiler.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/methods/annealed/steps.hpp"
#include "hmesh/methods/annealed/work.hpp"
#include "hmesh/methods/recipe.hpp"
#include "hmesh/options.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

namespace kit {

template <int C>
class TiledMesh;

}  // namespace kit

/// The default recipe of mesh_image(), and the one of best fidelity: too many points are drawn, those whose loss costs least
/// are removed, and simulated annealing moves vertices from where they are worth little to where they are worth much.
///
/// Meshes have least-squares colours unless Options::colors says otherwise. The same options and seed give the same bits for any
/// number of threads. The interface of a recipe is described in methods/recipe.hpp, the method in methods/annealed/annealed.hpp.
struct Annealed {
    Effort effort = Effort::normal;  ///< how much work goes into the mesh
    std::uint64_t seed = 1;          ///< of the annealing's random numbers; any value. draft uses none but by compact_image()
    /// The side of a tile in px, 64 to 65536, or 0 for the default. Images larger than a tile are meshed in tiles of about this
    /// size, each of them a piece of work for a thread. The default is the side at which a tile holds 200 vertices on average,
    /// 400 where there are less than 6 sweeps of annealing and 640 where there are none, within 128 to 256 px, and 256 px beyond
    /// 4194304 pixels. Where a tile would hold less than 180 vertices on average, or 256 where there are less than 6 sweeps,
    /// tiles are made larger, up to the image. Tiles of the default that are annealed, of an image of up to 4194304 pixels that
    /// does not repeat, are as many as that, but not of one size: where there are more vertices they are smaller, so that each
    /// holds about as many.
    int tile = 0;
    /// The steps in detail, in place of those that `effort` stands for: start from kit::annealed_steps(effort) and change some.
    std::optional<kit::AnnealedSteps> steps{};
    /// A mesh of the image to go on from in place of the points, with any number of vertices: it is brought to the number
    /// asked for, then annealed and polished. It must outlive the call; null: none. Errc::invalid_argument, and no mesh, where it
    /// is no mesh of the image: size, channels, positions off the 1/256 px grid, colours that are not finite, faces that do not
    /// tile the image, more than 63 of them around a vertex, Mesh::periodic or Mesh::samples other than those of the options, a
    /// border that is to be straight and is not.
    const Mesh* start = nullptr;
    /// Of images whose samples are points: where set, >= 0, each side of the mesh is the polyline of the fewest of its samples
    /// that passes all others within so much, in stored values. It then follows from that row of samples and this tolerance
    /// alone: the meshes of images that share a row, as tiles do, share its vertices to the bit, whatever else is in them.
    /// Neither weights of pixels nor Options::round_colors count there; channel_weights are refused, and a mesh to start from is
    /// one with these very sides. Errc::target_out_of_range where fewer vertices are asked for than the sides have, or a level
    /// of detail would have fewer; so ends a search for a PSNR that comes to try fewer.
    std::optional<double> border_tolerance{};

    static constexpr const char* name = "annealed";    ///< for reports
    static constexpr Colors colors = Colors::optimal;  ///< final colours where Options::colors says nothing
    static constexpr bool can_be_periodic = true;      ///< whether it makes meshes of periodic images

    /// Whether all options are in range, for images of any size; else Errc::invalid_argument with the offending value and its
    /// bound.
    [[nodiscard]] Status check(int /*width*/, int /*height*/) const noexcept {
        if (tile != 0 && (tile < 64 || tile > kit::max_side))
            return {Errc::invalid_argument, "the tile must be 0, for the default, or 64 to 65536 px", tile,
                    tile < 64 ? 64 : kit::max_side};
        if (border_tolerance)
            if (const Status status =
                    kit::check_ranges({{"border_tolerance must be at least 0 and a finite float, in stored values",
                                        *border_tolerance, 0, PixelTraits<float>::highest}});
                !status)
                return status;
        if (steps) return kit::check(*steps);
        if (effort <= Effort::best) return {};
        return {Errc::invalid_argument, "the effort is none of those known", static_cast<int>(effort),
                static_cast<int>(Effort::best)};
    }
    /// The side of the tiles in px for a mesh of n vertices; the image's longer side or more: one piece.
    [[nodiscard]] HMESH_COLD double tile_size(int width, int height, std::size_t n) const noexcept {
        const double pixels = static_cast<double>(width) * height, per_vertex = pixels / static_cast<double>(n);
        const double longest = std::max(width, height);
        // The fewer vertices a tile has, the more of them are hindered by its border, which more sweeps make up for.
        const int sweeps = steps.value_or(kit::annealed_steps(effort)).annealing.sweeps;
        const double wanted = sweeps == 0 ? 640 : sweeps < 6 ? 400 : 200, fewest = std::min(0.9 * wanted, 256.0);
        double size = tile != 0                ? tile
                      : pixels > most_balanced ? 256
                                               : std::max(128.0, std::min(256.0, std::sqrt(wanted * per_vertex)));
        while (size < longest && std::min<double>(size, width) * std::min<double>(size, height) < fewest * per_vertex)
            size *= 1.25;
        return size;
    }
    /// The recipe for one run of a search. Sketches are of effort fast, and meshes refined with 3 / 8 of the sweeps, which makes
    /// them as good as whole runs where they come from 0.9 to 1.4 times the vertices, and touched with 1 / 8. Trimmed ones are
    /// polished alone: 4 % fewer vertices cost at most 0.03 dB more than with the sweep of a touch, 1 % more at most 0.02 dB.
    [[nodiscard]] Annealed from(const kit::Beginning& beginning) const {
        Annealed out = *this;
        if (beginning.work == kit::Work::whole && beginning.mesh == nullptr) return out;
        out.start = beginning.mesh;
        if (beginning.work == kit::Work::draft || beginning.work == kit::Work::sketch) {
            out.effort = beginning.work == kit::Work::draft ? Effort::draft : std::min(effort, Effort::fast);
            out.steps.reset();
        } else if (kit::goes_on(beginning.work)) {
            out.steps = steps.value_or(kit::annealed_steps(effort));
            const int eighths = beginning.work == kit::Work::refine ? 3 : beginning.work == kit::Work::touch ? 1 : 0;
            const int sweeps = out.steps->annealing.sweeps;  // these are rounded, but not to none
            out.steps->annealing.sweeps = std::max(std::min(eighths * sweeps, 1), (eighths * sweeps + 4) / 8);
            out.steps->annealing.start_price = 0.85;
            out.steps->annealing.temperature = 0.1;  // few sweeps have no time to cool down
        }
        return out;
    }
    /// The recipe of a level of n vertices in a chain of levels of detail (lods/mesh_lods.hpp), which coarsen() makes of the one
    /// before. Tiles have 384 px, since fewer seams matter more here than more pieces of work.
    [[nodiscard]] Annealed coarser(std::size_t n) const {
        Annealed out = *this;
        out.start = nullptr;
        out.steps = kit::coarser_steps(steps.value_or(kit::annealed_steps(effort)), n);
        out.seed = seed + n;  // another one in each level
        if (tile == 0) out.tile = 384;
        return out;
    }
    /// How long a run for n vertices takes, in the unit of kit::AnnealedWork: for the progress of searches. A mesh to start from
    /// that has fewer vertices, or none as yet, stands for one of n.
    [[nodiscard]] double work(int width, int height, std::size_t n) const noexcept {
        const std::size_t from = start != nullptr ? std::max(n, start->vertex_count()) : 0;
        return kit::annealed_work(steps.value_or(kit::annealed_steps(effort)), static_cast<double>(width) * height,
                                  static_cast<double>(n), static_cast<double>(from))
            .sum();
    }
    /// What drafts and sketches foretell. A run at normal took 0.40 to 0.76 of the vertices that drafts took for PSNRs of 20.5
    /// to 40 dB of 14 photographs, and 0.52 on the mean; one at fast 0.62.
    [[nodiscard]] kit::Trials trials() const noexcept {
        switch (effort) {
            case Effort::draft: return {1, 0};
            case Effort::fast: return {0.6, 0};
            case Effort::normal: return {0.5, 0};
            default: return {0.45, 0.77};
        }
    }
    /// Replaces `mesh` by a mesh of n vertices of its image, 4 <= n <= max(4, pixels). Errc::cancelled: it is valid, with any
    /// number of vertices. Defined in methods/annealed/annealed.hpp.
    template <int C>
    [[nodiscard]] Status run(kit::TiledMesh<C>& mesh, std::size_t n) const;
    /// The same from the mesh that `mesh` holds, which has more than n vertices and whose energy is known: those that are
    /// cheapest to remove go, then it is annealed and polished.
    template <int C>
    [[nodiscard]] Status coarsen(kit::TiledMesh<C>& mesh, std::size_t n) const;

  private:
    static constexpr double most_balanced = 4194304;  ///< pixels of images whose tiles may differ in size, and be small

    template <int C, class Run>
    [[nodiscard]] Status run_or_grow(kit::TiledMesh<C>& mesh, std::size_t n, Run&& run) const;
};

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_ANNEALED_OPTIONS_HPP
