/// \file
/// Psnr search: the fewest vertices whose mesh reaches a given PSNR.
///
/// PSNR rises by about 1.6 dB a doubling of the vertices, the slope of piecewise linear fits to photographs; steps of this slope
/// lead to two runs that enclose the target. From then on the next count is that of the secant between the two, or the middle
/// (of the logarithms) after more than two runs in a row on the same side.
///
/// Cost: ends when the two counts differ by at most 0.5 % (or 1), after some 5 to 8 runs of the method.
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

/// Searches for the fewest vertices that reach `psnr`, in dB. mesh_of(n) makes the mesh of n vertices, 4 <= n <= most, with its
/// status and report.psnr; the search begins with `first` vertices, in the same range, and makes at most 60 runs. Returns the
/// result of the fewest vertices that reached the PSNR; where none did, that of the best PSNR with Errc::target_out_of_range;
/// where a run fails or is cancelled, the best result until then, its own included, with the status of that run.
[[nodiscard]] HMESH_COLD inline Result fewest_vertices(double psnr, std::size_t first, std::size_t most,
                                                       FunctionRef<Result(std::size_t n)> mesh_of) {
    constexpr double slope = 1.6;  // dB for each doubling of the vertices
    struct Run {
        double log_n = 0, psnr = 0;
        std::size_t n = 0;
    };
    Run low, high;  // the most vertices that missed the PSNR, the fewest that reached it; n = 0: none yet
    Result best = mesh_of(first);
    Run run{std::log2(static_cast<double>(first)), best.report.psnr, first};
    bool reached = false;
    int same_side = 0;  // runs in a row that fell on one side
    bool last_side = false;
    double stride = 0.1;  // in log2(n); grows while the target is not enclosed, since curves can be flat
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
            // The secant, kept off both ends, where a run would tell nothing new.
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
        if (!result.status) {  // failed or cancelled: the best so far, which may be this run's mesh
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
