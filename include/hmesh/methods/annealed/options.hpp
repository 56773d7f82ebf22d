/// \file
/// Annealed: the recipe of best fidelity, which is the default; its options and the meaning of its efforts.
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
#include "hmesh/edit/tolerance.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/methods/recipe.hpp"
#include "hmesh/options.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// How much work goes into a mesh. Counted in steps, never in seconds: an effort is the same work on every machine.
enum class Effort : std::uint8_t {
    draft,   ///< 1.65 times as many points as wanted, whose cheapest are removed
    fast,    ///< 1.4 times as many, removal, then 2 sweeps of annealing: 1.1 to 3.6 dB above draft
    normal,  ///< three times as many, removal, then 6 sweeps of annealing: 0.3 to 1.2 dB above fast
    fine,    ///< the same with 50 sweeps: 0.1 to 0.5 dB above normal in four to five times its time
    best,    ///< the same with 1000 sweeps
};

namespace kit {

/// Options of the annealing (methods/annealed/annealing.hpp). mu is the price of a vertex and T the temperature, both energies.
/// The screens compare the change of the energy before any relaxation, which is cheap to know, and skip moves without a chance.
struct AnnealingOptions {
    int sweeps = 6;              ///< in [0, 1e6]; 0: no annealing
    double temperature = 0.5;    ///< T in the first sweep, in units of mu, in [0, 1000]
    double cooling = 1;          ///< exponent, in [0, 100]: T / mu falls as (1 - t)^cooling, t = sweep / sweeps
    double try_probability = 1;  ///< probability, in a sweep, that a vertex is tried for removal and a site for insertion
    double jump = 0;             ///< probability, in a sweep, that a free vertex is displaced at random
    double jump_reach = 0.3;     ///< largest displacement, in mean lengths of the vertex's edges, in [0, 1]
    /// Removals whose cost is above removal_screen * mu + 3 T are not tried; in [0, 1e6].
    double removal_screen = 3;
    /// Insertions whose gain is not above insertion_screen * mu are not tried; in [0, 1e6].
    double insertion_screen = 0.28;
    /// Flips that raise the energy by flip_screen * mu or more are not tried; in [0, 1e6].
    double flip_screen = 3;
    /// mu in the first sweep, in units of first_price(), in [1e-6, 1e6]. At 0.9 the mesh grows to 1.4 times the target, which
    /// lets the sweeps after it choose among more vertices; at 2 it stays about as it is.
    double start_price = 0.9;
    /// How far the number of vertices may leave the target in the first sweep, as a share of the target, in [0, 1]; falls
    /// linearly to 0.
    double count_tolerance = 0.5;
};

/// The steps of the recipe Annealed in their order; the defaults are those of Effort::normal.
struct AnnealedSteps {
    double points = 3;             ///< o: vertices of the first mesh, in units of the target, in [1, 100]; 1: no collapse
    int settle_rounds = 1;         ///< of visits and flips over the first mesh, in [0, 1000]
    double collapse_batch = 0.25;  ///< vertices removed at a time, as a share of those present, in [0.001, 1]
    int polish_rounds = 2;         ///< flips and a sweep at the end, in [0, 1000]
    /// Flips in the first mesh that gain up to this are not made; in mean energies of a vertex, in [0, 1e6]. Small gains can
    /// wait, since the collapse changes the surroundings anyway.
    double settle_flip_gain = 3e-2;
    Tolerance settle{1e-1, 2e-2};  ///< of the visits in the first mesh
    /// Thresholds of the sweeps at the end; flips at the end gain more than polish.propagate_above.
    Tolerance polish{1e-3, 5e-3};
    Relaxation relaxation{1, 1e-2};  ///< around each removal; rounds in [0, 100]
    AnnealingOptions annealing;      ///< the annealing after the collapse
};

/// The steps of an effort.
[[nodiscard]] HMESH_COLD inline AnnealedSteps annealed_steps(Effort effort) noexcept {
    AnnealedSteps steps;
    switch (effort) {
        case Effort::draft:
            steps.points = 1.65;
            steps.settle_rounds = 2;
            steps.collapse_batch = 0.5;
            steps.relaxation.min_gain = 3e-2;
            steps.annealing.sweeps = 0;
            break;
        case Effort::fast:
            steps.points = 1.4;
            steps.settle_rounds = 2;
            steps.collapse_batch = 0.5;
            steps.annealing.sweeps = 2;
            steps.annealing.start_price = 1;
            steps.annealing.insertion_screen = 0.3;
            steps.annealing.temperature = 0.2;  // two sweeps have little time to cool down
            break;
        case Effort::normal: break;
        case Effort::fine:
            steps.annealing.sweeps = 50;
            steps.annealing.insertion_screen = 0.25;
            steps.annealing.jump = 0.1;
            break;
        case Effort::best:
            steps.annealing.sweeps = 1000;
            steps.annealing.cooling = 2;
            steps.annealing.try_probability = 0.3;
            steps.annealing.jump = 0.3;
            steps.annealing.insertion_screen = 0.2;
            steps.annealing.flip_screen = 1;
            break;
    }
    return steps;
}

/// Whether all steps are in range: Errc::invalid_argument for the first that is not, with its name, value and bound.
[[nodiscard]] HMESH_COLD inline Status check(const AnnealedSteps& steps) noexcept {
    const AnnealingOptions& annealing = steps.annealing;
    const Tolerance &settle = steps.settle, &polish = steps.polish;
    return check_ranges({
        {"annealed points must be in [1, 100]", steps.points, 1, 100},
        {"annealed settle_rounds must be in [0, 1000]", static_cast<double>(steps.settle_rounds), 0, 1000},
        {"annealed settle_flip_gain must be in [0, 1e6]", steps.settle_flip_gain, 0, 1e6},
        {"annealed settle.propagate_above must be in [0, 1e6]", settle.propagate_above, 0, 1e6},
        {"annealed settle.min_gain must be in [0, 1e6]", settle.min_gain, 0, 1e6},
        {"annealed collapse_batch must be in [0.001, 1]", steps.collapse_batch, 1e-3, 1},
        {"annealed polish_rounds must be in [0, 1000]", static_cast<double>(steps.polish_rounds), 0, 1000},
        {"annealed relaxation.rounds must be in [0, 100]", static_cast<double>(steps.relaxation.rounds), 0, 100},
        {"annealed relaxation.min_gain must be in [0, 1e6]", steps.relaxation.min_gain, 0, 1e6},
        {"annealed polish.propagate_above must be in [0, 1e6]", polish.propagate_above, 0, 1e6},
        {"annealed polish.min_gain must be in [0, 1e6]", polish.min_gain, 0, 1e6},
        {"annealed annealing.sweeps must be in [0, 1e6]", static_cast<double>(annealing.sweeps), 0, 1e6},
        {"annealed annealing.temperature must be in [0, 1000]", annealing.temperature, 0, 1e3},
        {"annealed annealing.cooling must be in [0, 100]", annealing.cooling, 0, 100},
        {"annealed annealing.try_probability must be in [0, 1]", annealing.try_probability, 0, 1},
        {"annealed annealing.jump must be in [0, 1]", annealing.jump, 0, 1},
        {"annealed annealing.jump_reach must be in [0, 1]", annealing.jump_reach, 0, 1},
        {"annealed annealing.start_price must be in [1e-6, 1e6]", annealing.start_price, 1e-6, 1e6},
        {"annealed annealing.removal_screen must be in [0, 1e6]", annealing.removal_screen, 0, 1e6},
        {"annealed annealing.insertion_screen must be in [0, 1e6]", annealing.insertion_screen, 0, 1e6},
        {"annealed annealing.flip_screen must be in [0, 1e6]", annealing.flip_screen, 0, 1e6},
        {"annealed annealing.count_tolerance must be in [0, 1]", annealing.count_tolerance, 0, 1},
    });
}

template <int C>
class TiledMesh;

/// How long the stages of a run take, in microseconds of one core for 3 channels: only the ratios matter, for progress. From
/// two photographs at 1 to 4 %; the larger stages are within a third.
struct AnnealedWork {
    double start = 0;     ///< points, or what a mesh to start from takes
    double settle = 0;    ///< 0: no such stage
    double collapse = 0;  ///< 0: no such stage
    double anneal = 0;    ///< 0: no such stage
    double polish = 0;    ///< at the end
    double colors = 0;    ///< the final ones

    /// Of all stages.
    [[nodiscard]] double sum() const noexcept { return start + settle + collapse + anneal + polish + colors; }
};

/// The work of a run for n vertices with these steps, of an image of so many pixels, from the start or from a mesh.
[[nodiscard]] HMESH_COLD inline AnnealedWork annealed_work(const AnnealedSteps& steps, double pixels, double n,
                                                           bool has_start) noexcept {
    AnnealedWork work;
    const double points = steps.points * n;
    work.start = 0.045 * pixels + (has_start ? 4 * n : 1.3 * points);
    if (!has_start) {
        work.settle = 0.9 * points * steps.settle_rounds;
        if (steps.points > 1) work.collapse = 16 * n * (steps.points - 1);
    }
    if (steps.annealing.sweeps > 0)
        work.anneal = n * (7 + (steps.annealing.try_probability < 1 ? 8 : 13) * steps.annealing.sweeps);
    work.polish = n * (1.5 * steps.polish_rounds + (has_start ? 4 : 1));
    work.colors = 0.001 * pixels + 1.2 * n;
    return work;
}

/// The steps of a level of detail of n vertices that is made of the one before, of twice as many. Of the sweeps about half are
/// left, of few ones less, since most of what they find the level before has found. Up to 1024 vertices, where few sweeps try too
/// little, there are more: they cost next to nothing.
[[nodiscard]] HMESH_COLD inline AnnealedSteps coarser_steps(AnnealedSteps steps, std::size_t n) noexcept {
    AnnealingOptions& annealing = steps.annealing;
    if (annealing.sweeps == 0) {  // as draft has it
        steps.relaxation.rounds = 0;
        steps.collapse_batch = 0.25;
        steps.polish_rounds = 1;
        return steps;
    }
    steps.collapse_batch = std::min(steps.collapse_batch, 0.18);
    annealing.sweeps = static_cast<int>(12LL * annealing.sweeps / 25);
    if (annealing.sweeps > 0) annealing.sweeps += n > 1024 ? 0 : n > 512 ? 1 : n > 256 ? 2 : 3;
    annealing.start_price = 0.85;
    const bool are_few = annealing.sweeps < 8;
    annealing.temperature = are_few ? 0.1 : 0.3;  // few sweeps have no time to cool down
    if (are_few) annealing.flip_screen = std::min(annealing.flip_screen, 2.0);
    return steps;
}

/// The work of such a level of n vertices, made of one of `from`.
[[nodiscard]] HMESH_COLD inline AnnealedWork coarser_work(const AnnealedSteps& steps, double pixels, double from,
                                                          double n) noexcept {
    AnnealedWork work = annealed_work(steps, pixels, n, true);
    work.start = 0;
    work.collapse = 16 * (from - n);
    return work;
}

}  // namespace kit

/// The default recipe of mesh_image(), and the one of best fidelity: too many points are drawn, those whose loss costs least
/// are removed, and simulated annealing moves vertices from where they are worth little to where they are worth much.
///
/// Meshes have least-squares colours unless Options::colors says otherwise. The same options and seed give the same bits for any
/// number of threads. The interface of a recipe is described in methods/recipe.hpp, the method in methods/annealed/annealed.hpp.
struct Annealed {
    Effort effort = Effort::normal;  ///< how much work goes into the mesh
    std::uint64_t seed = 1;          ///< of the annealing's random numbers; any value. draft uses none
    /// The side of a tile in px, 64 to 65536, or 0 for the default. Images larger than a tile are meshed in tiles of about this
    /// size, each of them a piece of work for a thread. The default is the side at which a tile holds 400 vertices on average,
    /// or 640 where nothing is annealed, within 128 to 256 px, and 256 px beyond 4194304 pixels. Where a tile would hold less
    /// than 256 vertices on average, tiles are made larger, up to the image. Tiles of the default that are annealed, of an
    /// image of up to 4194304 pixels that does not repeat, are as many as that, but not of one size: where there are more
    /// vertices they are smaller, so that each holds about as many.
    int tile = 0;
    /// The steps in detail, in place of those that `effort` stands for: start from kit::annealed_steps(effort) and change some.
    std::optional<kit::AnnealedSteps> steps{};
    /// A mesh of the image to go on from in place of the points, with any number of vertices: it is brought to the number
    /// asked for, then annealed and polished. It must outlive the call; null: none. Errc::invalid_argument, and the image's two
    /// triangles for a mesh, where it is no mesh of the image: size, channels, positions off the 1/256 px grid, colours that are
    /// not finite, faces that do not tile the image, more than 63 of them around a vertex, Mesh::periodic or Mesh::samples other
    /// than those of the options, a border that is to be straight and is not.
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
        const double wanted = steps.value_or(kit::annealed_steps(effort)).annealing.sweeps > 0 ? 400 : 640;
        double size = tile != 0                ? tile
                      : pixels > most_balanced ? 256
                                               : std::max(128.0, std::min(256.0, std::sqrt(wanted * per_vertex)));
        while (size < longest && std::min<double>(size, width) * std::min<double>(size, height) < 256 * per_vertex) size *= 1.25;
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
    /// How long a run for n vertices takes, in the unit of kit::AnnealedWork: for the progress of searches.
    [[nodiscard]] double work(int width, int height, std::size_t n) const noexcept {
        return kit::annealed_work(steps.value_or(kit::annealed_steps(effort)), static_cast<double>(width) * height,
                                  static_cast<double>(n), start != nullptr)
            .sum();
    }
    /// What drafts and sketches foretell. A run at normal took 0.28 to 0.74 of the vertices that drafts took for the PSNRs, 28 to
    /// 40 dB, of 32 photographs.
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
