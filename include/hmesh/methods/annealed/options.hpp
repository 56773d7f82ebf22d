// hmesh - what the method `annealed` can be told, and what the four efforts mean.
#ifndef HMESH_METHODS_ANNEALED_OPTIONS_HPP
#define HMESH_METHODS_ANNEALED_OPTIONS_HPP

#include <cstdint>

#include "hmesh/core/finite.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/methods/annealed/annealing.hpp"
#include "hmesh/edit/relax.hpp"
#include "hmesh/edit/move.hpp"

namespace hmesh::kit {

// How much work goes into a mesh, counted in steps, never in seconds.
enum class Effort : std::uint8_t {
    draft,   // greedy insertion
    fast,    // insertion of twice as many, then removal: about +2 dB
    normal,  // insertion of three times as many, removal, then 8 sweeps of annealing: about +1 dB
    best,    // 1000 sweeps
};

// Options of the method `annealed`. What differs between efforts is set by annealed_options().
struct AnnealedOptions {
    double insert_factor = 3;     // o: vertices placed before the collapse, in units of the target; 1 for none
    double collapse_factor = 1;    // u: vertices that the collapse leaves, in units of the target
    double start = 0.3;       // vertices of the first grid, share of those placed
    double insert_batch = 0.4;      // vertices inserted at a time, share of those there
    double collapse_batch = 0.15;  // vertices removed at a time, share of those there
    int insert_sweeps = 2;    // after each insertion
    int polish_rounds = 2;    // flips and a sweep, at the end
    // While the mesh grows, small gains wait: the next insertion changes the neighbourhood anyway. Against the tight
    // 1e-3 and {1e-3, 0} this buys a second sweep for the time of one, +0.2 dB.
    double insert_flip_gain = 3e-2;  // gains up to this wait, in units of the mean energy of a vertex
    Tolerance insert_tolerance{5e-2, 5e-3};
    Tolerance polish{1e-3, 5e-3};
    Relaxation relaxation{1, 1e-3};  // around each removal
    AnnealingOptions annealing;      // sweeps = 0: none
    std::uint64_t seed = 1;          // of the annealing
};

// The options that make an effort.
[[nodiscard]] inline AnnealedOptions annealed_options(Effort effort) noexcept {
    AnnealedOptions options;
    switch (effort) {
        case Effort::draft:
            options.insert_factor = 1;
            options.insert_batch = 0.3;
            options.polish_rounds = 0;
            options.annealing.sweeps = 0;
            break;
        case Effort::fast:
            options.insert_factor = 2;
            options.insert_batch = 0.2;
            options.collapse_factor = 0.92;  // what is missing goes where it is worth most: 0.08 dB
            options.polish_rounds = 3;
            options.annealing.sweeps = 0;
            break;
        case Effort::normal: break;
        case Effort::best:
            options.insert_factor = 4;
            options.annealing.sweeps = 1000;
            options.annealing.cooling = 2;
            options.annealing.try_probability = 0.3;
            options.annealing.jump = 0.3;
            options.annealing.insertion_screen = 0.2;
            options.annealing.flip_screen = 1;
            break;
    }
    return options;
}

// Whether the options mean something; the sentence names the first that does not.
[[nodiscard]] inline Status check(const AnnealedOptions& options) noexcept {
    const auto bad = [](const char* what) -> Status { return {Errc::invalid_argument, what, 0, 0}; };
    const AnnealingOptions& annealing = options.annealing;
    if (!is_within(options.insert_factor, 1, 100)) return bad("annealed.insert_factor must be in [1, 100]");
    if (!is_within(options.collapse_factor, 0.1, 1)) return bad("annealed.collapse_factor must be in [0.1, 1]");
    if (!is_within(options.start, 0, 1)) return bad("annealed.start must be in [0, 1]");
    if (!is_within(options.insert_batch, 1e-3, 10)) return bad("annealed.insert_batch must be in [0.001, 10]");
    if (!is_within(options.collapse_batch, 1e-3, 1)) return bad("annealed.collapse_batch must be in [0.001, 1]");
    if (!is_within(options.insert_sweeps, 0, 1000)) return bad("annealed.insert_sweeps must be in [0, 1000]");
    if (!is_within(options.polish_rounds, 0, 1000)) return bad("annealed.polish_rounds must be in [0, 1000]");
    if (!is_within(options.relaxation.rounds, 0, 100)) return bad("annealed.relaxation.rounds must be in [0, 100]");
    if (!is_within(options.relaxation.least, 0, 1e6)) return bad("annealed.relaxation.least must be in [0, 1e6]");
    if (!is_within(options.insert_flip_gain, 0, 1e6)) return bad("annealed.insert_flip_gain must be in [0, 1e6]");
    for (const Tolerance& t : {options.insert_tolerance, options.polish})
        if (!is_within(t.spread, 0, 1e6) || !is_within(t.least, 0, 1e6)) return bad("annealed tolerances must be in [0, 1e6]");
    if (!is_within(annealing.sweeps, 0, 1e6)) return bad("annealed.annealing.sweeps must be in [0, 1e6]");
    if (!is_within(annealing.temperature, 0, 1e3)) return bad("annealed.annealing.temperature must be in [0, 1000]");
    if (!is_within(annealing.cooling, 0, 100)) return bad("annealed.annealing.cooling must be in [0, 100]");
    if (!is_within(annealing.try_probability, 0, 1) || !is_within(annealing.jump, 0, 1))
        return bad("annealed.annealing probabilities must be in [0, 1]");
    if (!is_within(annealing.jump_reach, 0, 1)) return bad("annealed.annealing.jump_reach must be in [0, 1]");
    if (!is_within(annealing.start_price, 1e-6, 1e6)) return bad("annealed.annealing.start_price must be in [1e-6, 1e6]");
    for (const double screen : {annealing.removal_screen, annealing.insertion_screen, annealing.flip_screen})
        if (!is_within(screen, 0, 1e6)) return bad("annealed.annealing screens must be in [0, 1e6]");
    if (!is_within(annealing.count_tolerance, 0, 1)) return bad("annealed.annealing.count_tolerance must be in [0, 1]");
    return {};
}

}  // namespace hmesh::kit

#endif  // HMESH_METHODS_ANNEALED_OPTIONS_HPP
