/// \file
/// How long the stages of Annealed take: for the progress of runs and of searches, never for what is done.
#ifndef HMESH_METHODS_ANNEALED_WORK_HPP
#define HMESH_METHODS_ANNEALED_WORK_HPP

#include <algorithm>

#include "hmesh/core/compiler.hpp"
#include "hmesh/methods/annealed/steps.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

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

/// The work of a removal in a collapse, its share in the costs of others included.
inline constexpr double removal_work = 16;

/// The work of a run for n vertices with these steps, of an image of so many pixels, from a mesh of `from` vertices; 0: from
/// points.
[[nodiscard]] HMESH_COLD inline AnnealedWork annealed_work(const AnnealedSteps& steps, double pixels, double n,
                                                           double from) noexcept {
    AnnealedWork work;
    const double points = steps.points * n;
    const bool has_start = from > 0;
    work.start = 0.045 * pixels + (has_start ? 4 * n + removal_work * std::max(0.0, from - n) : 1.3 * points);
    if (!has_start) {
        work.settle = 0.9 * points * steps.settle_rounds;
        if (steps.points > 1) work.collapse = removal_work * n * (steps.points - 1);
    }
    const AnnealingOptions& annealing = steps.annealing;
    if (annealing.sweeps > 0)
        work.anneal =
            n * (7 + (8 + 4 * annealing.try_probability + 3 * annealing.jump + 0.4 * annealing.nudges) * annealing.sweeps);
    work.polish = n * (1.5 * steps.polish_rounds + (has_start ? 4 : 1));
    work.colors = 0.001 * pixels + 1.2 * n;
    return work;
}

/// The work of a level of detail of n vertices, made of one of `from` with coarser_steps().
[[nodiscard]] HMESH_COLD inline AnnealedWork coarser_work(const AnnealedSteps& steps, double pixels, double from,
                                                          double n) noexcept {
    AnnealedWork work = annealed_work(steps, pixels, n, from);
    work.start = 0;
    work.collapse = removal_work * (from - n);
    return work;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_ANNEALED_WORK_HPP
