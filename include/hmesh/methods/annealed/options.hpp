/// \file
/// Annealed: the recipe of best fidelity, and the default. What it can be told, and what its efforts mean.
///
/// What it does is in annealed.hpp; this header needs none of that, so that a program may name the recipe and leave its
/// compilation to another file.
#ifndef HMESH_METHODS_ANNEALED_OPTIONS_HPP
#define HMESH_METHODS_ANNEALED_OPTIONS_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "hmesh/core/compiler.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/edit/tolerance.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/options.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// How much work goes into a mesh, counted in steps, never in seconds.
enum class Effort : std::uint8_t {
    draft,   ///< greedy insertion
    fast,    ///< insertion of twice as many, then removal: about +2 dB
    normal,  ///< insertion of three times as many, removal, then 8 sweeps of annealing: about +1 dB
    best,    ///< 1000 sweeps
};

namespace kit {

/// Options of AnnealingSchedule and AnnealingSweep.
struct AnnealingOptions {
    int sweeps = 8;
    double temperature = 0.5;        ///< T at the start, in prices mu
    double cooling = 1;              ///< T falls as (1 - t)^cooling, t in [0, 1)
    double try_probability = 1;      ///< probability that a vertex is tried for removal, a site for insertion, in a sweep
    double jump = 0.1;               ///< probability that a vertex is displaced in a sweep
    double jump_reach = 0.3;         ///< by at most this, in mean spoke lengths
    double removal_screen = 3;       ///< removals that cost more than this many mu + 3 T before relaxing are not tried
    double insertion_screen = 0.35;  ///< insertions that gain less than this many mu so are not tried
    double flip_screen = 3;          ///< flips that cost more than this many mu so are not tried
    double start_price = 0.2;        ///< mu at the start, in mean energies of a vertex
    double count_tolerance = 0.5;    ///< the count may leave the target by this share in the first sweep, ever less later
};

/// The steps of the method, in their order. What differs between efforts is set by annealed_steps().
struct AnnealedSteps {
    double insert_factor = 3;      ///< o: vertices placed before the collapse, in units of the target; 1 for none
    double collapse_factor = 1;    ///< u: vertices that the collapse leaves, in units of the target
    double start = 0.3;            ///< vertices of the first grid, share of those placed
    double insert_batch = 0.4;     ///< vertices inserted at a time, share of those there
    double collapse_batch = 0.15;  ///< vertices removed at a time, share of those there
    int insert_sweeps = 2;         ///< after each insertion
    int polish_rounds = 2;         ///< flips and a sweep, at the end
    /// While the mesh grows, small gains wait: the next insertion changes the neighbourhood anyway. Against the tight
    /// 1e-3 and {1e-3, 0} this buys a second sweep for the time of one, +0.2 dB.
    double insert_flip_gain = 3e-2;  ///< gains up to this wait, in units of the mean energy of a vertex
    Tolerance insert_tolerance{5e-2, 5e-3};
    Tolerance polish{1e-3, 5e-3};
    Relaxation relaxation{1, 1e-3};  ///< around each removal
    AnnealingOptions annealing;      ///< sweeps = 0: none
};

/// The steps that make an effort.
[[nodiscard]] inline AnnealedSteps annealed_steps(Effort effort) noexcept {
    AnnealedSteps steps;
    switch (effort) {
        case Effort::draft:
            steps.insert_factor = 1;
            steps.insert_batch = 0.3;
            steps.polish_rounds = 0;
            steps.annealing.sweeps = 0;
            break;
        case Effort::fast:
            steps.insert_factor = 2;
            steps.insert_batch = 0.2;
            steps.collapse_factor = 0.92;  // what is missing goes where it is worth most: 0.08 dB
            steps.polish_rounds = 3;
            steps.annealing.sweeps = 0;
            break;
        case Effort::normal: break;
        case Effort::best:
            steps.insert_factor = 4;
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

/// Whether the steps mean something; the sentence names the first that does not.
[[nodiscard]] HMESH_COLD inline Status check(const AnnealedSteps& steps) noexcept {
    const AnnealingOptions& annealing = steps.annealing;
    const Tolerance &insert = steps.insert_tolerance, &polish = steps.polish;
    return check_ranges({
        {"annealed insert_factor must be in [1, 100]", steps.insert_factor, 1, 100},
        {"annealed collapse_factor must be in [0.1, 1]", steps.collapse_factor, 0.1, 1},
        {"annealed start must be in [0, 1]", steps.start, 0, 1},
        {"annealed insert_batch must be in [0.001, 10]", steps.insert_batch, 1e-3, 10},
        {"annealed collapse_batch must be in [0.001, 1]", steps.collapse_batch, 1e-3, 1},
        {"annealed insert_sweeps must be in [0, 1000]", static_cast<double>(steps.insert_sweeps), 0, 1000},
        {"annealed polish_rounds must be in [0, 1000]", static_cast<double>(steps.polish_rounds), 0, 1000},
        {"annealed relaxation.rounds must be in [0, 100]", static_cast<double>(steps.relaxation.rounds), 0, 100},
        {"annealed relaxation.min_gain must be in [0, 1e6]", steps.relaxation.min_gain, 0, 1e6},
        {"annealed insert_flip_gain must be in [0, 1e6]", steps.insert_flip_gain, 0, 1e6},
        {"annealed insert_tolerance.propagate_above must be in [0, 1e6]", insert.propagate_above, 0, 1e6},
        {"annealed insert_tolerance.min_gain must be in [0, 1e6]", insert.min_gain, 0, 1e6},
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

}  // namespace kit

/// The default recipe: too many vertices are placed, those that are missed least go, and annealing exchanges the others between
/// places at one common price. The interface of a recipe is described in methods/recipe.hpp.
struct Annealed {
    Effort effort = Effort::normal;  ///< how much work
    std::uint64_t seed = 1;          ///< of the random numbers of the annealing
    /// px: larger images are meshed in tiles of about this size, 64 to 65536, each of which is a piece of work for a thread.
    /// 0: in one piece up to a megapixel and 16384 vertices, in tiles of 256 px beyond. Where a tile would hold less than 256
    /// vertices on average, tiles are larger, up to the image, and so is the memory for each.
    int tile = 0;
    /// In place of what `effort` means: start from kit::annealed_steps(effort) and change what you like.
    std::optional<kit::AnnealedSteps> steps{};

    static constexpr const char* name = "annealed";
    static constexpr Colors colors = Colors::optimal;

    /// Whether the recipe's options mean something.
    [[nodiscard]] Status check(int /*width*/, int /*height*/) const noexcept {
        if (tile != 0 && (tile < 64 || tile > kit::max_side))
            return {Errc::invalid_argument, "the tile must be 0, for the default, or 64 to 65536 px", tile,
                    tile < 64 ? 64 : kit::max_side};
        if (steps) return kit::check(*steps);
        if (effort <= Effort::best) return {};
        return {Errc::invalid_argument, "the effort is none of those known", static_cast<int>(effort), 3};
    }
    /// px: the size of the tiles for a mesh of n vertices.
    [[nodiscard]] double tile_size(int width, int height, std::size_t n) const noexcept {
        // Up to here one tile is as fast as several, and no seam needs healing.
        const bool is_small = static_cast<double>(width) * height <= 1048576 && n <= 16384;
        double size = tile != 0 ? tile : is_small ? std::max(width, height) : 256;
        const double needed = 256.0 * width * height / static_cast<double>(n), longest = std::max(width, height);
        while (size < longest && std::min<double>(size, width) * std::min<double>(size, height) < needed) size *= 1.25;
        return size;
    }
    /// Makes a mesh of n vertices in place of what `mesh` was (annealed.hpp).
    template <int C>
    [[nodiscard]] Status run(kit::TiledMesh<C>& mesh, std::size_t n) const;
};

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_ANNEALED_OPTIONS_HPP
