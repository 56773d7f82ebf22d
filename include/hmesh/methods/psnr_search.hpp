/// \file
/// The search for the fewest vertices that reach a PSNR.
///
/// PSNR rises by about 1.6 dB a doubling of the vertices, the slope of a piecewise linear fit to photographs; that first
/// guess is replaced by the secant of the two runs that enclose the target as soon as there are two, and by the middle between
/// them where the same side moved twice. Ends when the counts on both sides differ by at most 0.5 % (or 1): some 5 to 8 runs.
#ifndef HMESH_METHODS_PSNR_SEARCH_HPP
#define HMESH_METHODS_PSNR_SEARCH_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "hmesh/core/compiler.hpp"
#include "hmesh/core/finite.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/result.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// `mesh_of(n)` makes a result with .status and .report.psnr, meshes of 4 <= n <= most vertices. Returns that of the fewest
/// vertices that reached `psnr`, or of the best PSNR with target_out_of_range when none did; where a run fails, what there is
/// then with its status.
[[nodiscard]] HMESH_COLD inline Result fewest_vertices(double psnr, std::size_t first, std::size_t most,
                                                       FunctionRef<Result(std::size_t n)> mesh_of) {
    constexpr double slope = 1.6;  // dB a doubling
    struct Run {
        double log_n = 0, psnr = 0;
        std::size_t n = 0;
    };
    Run low, high;  // the most vertices that failed, the fewest that reached it; n = 0: none yet
    Result best = mesh_of(first);
    Run run{std::log2(static_cast<double>(first)), best.report.psnr, first};
    bool reached = false;
    int same_side = 0;  // runs in a row that fell on one side
    bool last_side = false;
    double stride = 0.1;  // while the target is not enclosed, steps grow: curves can be flat
    for (int runs = 1;; ++runs) {
        if (!best.status) return best;
        if (run.psnr >= psnr) high = run, reached = true;
        else low = run;
        same_side = runs > 1 && last_side == (run.psnr >= psnr) ? same_side + 1 : 1;
        last_side = run.psnr >= psnr;
        if (high.n == 4 || low.n == most || runs == 60) break;
        if (low.n != 0 && high.n != 0 &&
            static_cast<double>(high.n - low.n) <= std::max(1.0, 0.005 * static_cast<double>(high.n)))
            break;

        double log_n = 0;
        if (low.n != 0 && high.n != 0) {
            // The secant, kept off the ends: a run that teaches nothing would repeat.
            const double t = is_finite(high.psnr) ? (psnr - low.psnr) / std::max(1e-9, high.psnr - low.psnr) : 0.5;
            const double aim = same_side > 2 ? 0.5 : std::max(0.1, std::min(0.9, t + (last_side ? -0.02 : 0.02)));
            log_n = low.log_n + aim * (high.log_n - low.log_n);
        } else {
            const double needed = is_finite(run.psnr) ? std::abs(psnr - run.psnr) / slope + 0.1 : 2;
            stride = std::min(3.0, std::max(needed, 2 * stride));
            log_n = run.log_n + (last_side ? -stride : stride);
        }
        auto n = static_cast<std::size_t>(std::llround(std::exp2(log_n)));
        n = std::max<std::size_t>(low.n != 0 ? low.n + 1 : 4, std::min(n, high.n != 0 ? high.n - 1 : most));

        Result result = mesh_of(n);
        run = {std::log2(static_cast<double>(n)), result.report.psnr, n};
        const bool better = run.psnr >= psnr ? true : !reached && run.psnr > best.report.psnr;
        if (!result.status) {  // cancelled: the best so far, which may be what this run came to
            const Status why = result.status;
            if (!reached && run.psnr > best.report.psnr) best = std::move(result);
            best.status = why;
            return best;
        }
        if (better) best = std::move(result);
    }
    if (!reached)
        best.status = {Errc::target_out_of_range, "no mesh of this image reached the PSNR asked for, in dB", best.report.psnr,
                       psnr};
    return best;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_PSNR_SEARCH_HPP
