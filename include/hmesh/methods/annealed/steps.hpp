/// \file
/// The efforts of Annealed, and the steps that each stands for.
#ifndef HMESH_METHODS_ANNEALED_STEPS_HPP
#define HMESH_METHODS_ANNEALED_STEPS_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "hmesh/core/compiler.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/edit/tolerance.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// How much work goes into a mesh. Counted in steps, never in seconds: an effort is the same work on every machine.
enum class Effort : std::uint8_t {
    draft,   ///< 1.65 times as many points as wanted, whose cheapest are removed
    fast,    ///< 1.4 times as many, removal, then 2 sweeps of annealing: 0.9 to 3.1 dB above draft
    normal,  ///< three times as many, removal, then 6 sweeps of annealing: 0.3 to 1.2 dB above fast
    fine,    ///< the same with 40 sweeps: 0.1 to 0.5 dB above normal in four to five times its time
    best,    ///< the same with 300 sweeps
};

namespace kit {

/// Options of the annealing (methods/annealed/annealing.hpp). mu is the price of a vertex and T the temperature, both energies.
/// The screens compare the change of the energy before any relaxation, which is cheap to know, and skip moves without a chance.
struct AnnealingOptions {
    int sweeps = 6;              ///< in [0, 1e6]; 0: no annealing
    double temperature = 0.4;    ///< T in the first sweep, in units of mu, in [0, 1000]
    double cooling = 1;          ///< exponent, in [0, 100]: T / mu falls as (1 - t)^cooling, t = sweep / sweeps
    double try_probability = 1;  ///< probability, in a sweep, that a vertex is tried for removal and a site for insertion
    double jump = 0;             ///< probability, in a sweep, that a free vertex is displaced at random
    double jump_reach = 0.3;     ///< largest displacement, in mean lengths of the vertex's edges, in [0, 1]
    /// How many displacements of up to 2 px, after which nothing is re-optimised, are tried of each vertex in a sweep; in
    /// [0, 1000].
    int nudges = 3;
    /// Removals whose cost is above removal_screen * mu + 3 T are not tried; in [0, 1e6].
    double removal_screen = 3;
    /// Insertions whose gain is not above insertion_screen * mu are not tried; in [0, 1e6].
    double insertion_screen = 0.3;
    /// Flips that raise the energy by flip_screen * mu or more are not tried; in [0, 1e6].
    double flip_screen = 2;
    /// mu in the first sweep, in units of first_price(), in [1e-6, 1e6]. At 0.9 the mesh grows to 1.4 times the target, which
    /// lets the sweeps after it choose among more vertices; at 2 it stays about as it is.
    double start_price = 0.9;
    /// How far the number of vertices may leave the target in the first sweep, as a share of the target, in [0, 1]; falls
    /// linearly to 0.
    double count_tolerance = 0.5;
};

/// The steps of the recipe Annealed in their order; the defaults are those of Effort::normal.
struct AnnealedSteps {
    double points = 3;      ///< o: vertices of the first mesh, in units of the target, in [1, 100]; 1: no collapse
    int settle_rounds = 1;  ///< of visits and flips over the first mesh, in [0, 1000]
    /// Flips in the first mesh that gain up to this are not made; in mean energies of a vertex, in [0, 1e6]. Small gains can
    /// wait, since the collapse changes the surroundings anyway.
    double settle_flip_gain = 3e-2;
    Tolerance settle{1e-1, 2e-2};    ///< of the visits in the first mesh
    double collapse_batch = 0.25;    ///< vertices removed at a time, as a share of those present, in [0.001, 1]
    Relaxation relaxation{1, 1e-2};  ///< around each removal; rounds in [0, 100]
    AnnealingOptions annealing;      ///< the annealing after the collapse
    int polish_rounds = 2;           ///< flips and a sweep at the end, in [0, 1000]
    /// Thresholds of the sweeps at the end; flips at the end gain more than polish.propagate_above.
    Tolerance polish{1e-3, 5e-3};
};

/// The steps of an effort.
[[nodiscard]] HMESH_COLD inline AnnealedSteps annealed_steps(Effort effort) noexcept {
    AnnealedSteps steps;
    AnnealingOptions& annealing = steps.annealing;
    switch (effort) {
        case Effort::draft:
            steps.points = 1.65;
            steps.settle_rounds = 3;
            steps.relaxation.min_gain = 3e-2;
            annealing.sweeps = 0;
            break;
        case Effort::fast:
            steps.points = 1.4;
            steps.settle_rounds = 2;
            steps.collapse_batch = 0.5;
            annealing.sweeps = 2;
            annealing.start_price = 1;
            annealing.flip_screen = 3;
            annealing.nudges = 0;         // a third sweep gains more in the same time
            annealing.temperature = 0.2;  // two sweeps have little time to cool down
            break;
        case Effort::normal: break;
        case Effort::fine:
            annealing.sweeps = 40;
            annealing.temperature = 0.5;
            annealing.try_probability = 0.6;
            annealing.jump = 0.1;
            annealing.nudges = 8;
            annealing.insertion_screen = 0.25;
            annealing.flip_screen = 3;
            break;
        case Effort::best:
            annealing.sweeps = 300;
            annealing.temperature = 0.3;
            annealing.cooling = 1.5;
            annealing.try_probability = 0.6;
            annealing.jump = 1;
            annealing.nudges = 10;
            annealing.insertion_screen = 0.2;
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
        {"annealed annealing.nudges must be in [0, 1000]", static_cast<double>(annealing.nudges), 0, 1e3},
        {"annealed annealing.removal_screen must be in [0, 1e6]", annealing.removal_screen, 0, 1e6},
        {"annealed annealing.insertion_screen must be in [0, 1e6]", annealing.insertion_screen, 0, 1e6},
        {"annealed annealing.flip_screen must be in [0, 1e6]", annealing.flip_screen, 0, 1e6},
        {"annealed annealing.count_tolerance must be in [0, 1]", annealing.count_tolerance, 0, 1},
    });
}

/// The steps of a level of detail of n vertices that is made of the one before, of twice as many. Of the sweeps about half are
/// left, of few ones less, since most of what they find the level before has found. Up to 1024 vertices, where few sweeps try too
/// little, there are more, and up to 512 also where none are left: they cost next to nothing, and levels of fast with 75 to 150
/// vertices gain a decibel.
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
    if (annealing.sweeps > 0 || n <= 512) annealing.sweeps += n > 1024 ? 0 : n > 512 ? 1 : n > 256 ? 2 : n > 128 ? 4 : 6;
    annealing.start_price = 0.85;
    const bool are_few = annealing.sweeps < 8;
    annealing.temperature = are_few ? 0.1 : 0.3;  // few sweeps have no time to cool down
    if (are_few) annealing.flip_screen = std::min(annealing.flip_screen, 2.0);
    return steps;
}

}  // namespace kit
}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_ANNEALED_STEPS_HPP
