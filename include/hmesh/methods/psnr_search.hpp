/// \file
/// Psnr search: the fewest vertices whose mesh reaches a given PSNR.
///
/// PSNR rises by about 1.6 dB a doubling of the vertices, the slope of piecewise linear fits to photographs; steps of this slope
/// lead to two runs that enclose the target. From then on the next count is that of the secant between the two, or the middle
/// (of the logarithms) after more than two runs in a row on the same side.
///
/// Cost: ends when the two counts differ by at most 0.5 % (or 1), after some 5 to 8 runs of the method. Of a method that can go
/// on from a mesh some 2 do, by psnr_search_going_on.hpp.
#ifndef HMESH_METHODS_PSNR_SEARCH_HPP
#define HMESH_METHODS_PSNR_SEARCH_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "hmesh/core/compiler.hpp"
#include "hmesh/core/finite.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/progress.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/methods/recipe.hpp"
#include "hmesh/result.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// The progress of a search, of which nobody knows how many runs it takes: each is given its share of what is left, from
/// estimates of what comes after it.
class SearchProgress {
  public:
    /// The part of a run that takes `work`, where some `later` is expected to follow; in the same unit, > 0 and >= 0.
    [[nodiscard]] HMESH_COLD ProgressSpan next(double work, double later) noexcept {
        const double from = reached_;
        reached_ += (1 - reached_) * (work / (work + later));
        return {from, reached_};
    }
    /// The same for a run of fewest_vertices().
    [[nodiscard]] HMESH_COLD ProgressSpan next() noexcept { return next(1, std::max(1.0, 6.0 - runs_++)); }
    /// The same for a run of fewest_vertices_going_on(): work_of(Work) is that of a run of as many vertices.
    [[nodiscard]] HMESH_COLD ProgressSpan next(Work kind, FunctionRef<double(Work kind)> work_of) {
        int& count = runs_of_[static_cast<std::size_t>(kind)];
        ++count;
        // A refinement and a touch or trims are usual, and the first draft has a quarter of the vertices that the others have.
        double later = work_of(Work::refine) * (!goes_on(kind) ? 1.6 : count == 1 ? 0.6 : 0.2);
        if (kind == Work::draft || kind == Work::sketch) later += work_of(Work::whole);
        return next(work_of(kind), kind == Work::draft && count == 1 ? 4 * later : later);
    }

  private:
    double reached_ = 0;
    int runs_ = 0;
    std::array<int, 6> runs_of_{};  ///< by Work
};

/// The status of a search in which all went well and no mesh reached `psnr`, the best one `reached`; `is_bounded`: more vertices
/// than were allowed might.
[[nodiscard]] HMESH_COLD inline Status psnr_not_reached(double reached, double psnr, bool is_bounded) noexcept {
    return {Errc::target_out_of_range,
            is_bounded ? "no mesh of so few vertices reached the PSNR asked for, in dB"
                       : "no mesh of this image reached the PSNR asked for, in dB",
            reached, psnr};
}

namespace detail {

/// The best result of a search: of those that reach the PSNR the one of the fewest vertices, else the one of the best PSNR.
class BestResult {
  public:
    /// After a first run, of a search as psnr_not_reached() knows it.
    BestResult(double psnr, bool is_bounded, Result first) : psnr_(psnr), is_bounded_(is_bounded), result_(std::move(first)) {}

    [[nodiscard]] bool is_reached() const noexcept { return result_.report.psnr >= psnr_; }  ///< whether one reached the PSNR
    [[nodiscard]] const Mesh& mesh() const noexcept { return result_.mesh; }                 ///< its mesh
    [[nodiscard]] double vertices() const noexcept { return static_cast<double>(result_.report.vertices); }  ///< that it has
    /// Offers the result of one more run. False: it failed or was cancelled, which ends the search; its mesh counts where none
    /// reached the PSNR before.
    bool offer(Result result) {
        const Status status = result.status;
        const bool is_smaller = status && result.report.psnr >= psnr_ && result.report.vertices < result_.report.vertices;
        if (is_reached() ? is_smaller : result.report.psnr > result_.report.psnr) result_ = std::move(result);
        result_.status = status;
        return static_cast<bool>(status);
    }
    /// The result: Errc::target_out_of_range where all went well and none reached the PSNR.
    [[nodiscard]] HMESH_COLD Result take() {
        if (result_.status && !is_reached()) result_.status = psnr_not_reached(result_.report.psnr, psnr_, is_bounded_);
        return std::move(result_);
    }
    [[nodiscard]] bool is_ok() const noexcept { return static_cast<bool>(result_.status); }  ///< whether the last run went well

  private:
    double psnr_;
    bool is_bounded_;
    Result result_;
};

}  // namespace detail

/// Searches for the fewest vertices that reach `psnr`, in dB. mesh_of(n) makes the mesh of n vertices, 4 <= n <= most, with its
/// status and report.psnr; the search begins with `first` vertices, in the same range, and makes at most 60 runs. Returns the
/// result of the fewest vertices that reached the PSNR; where none did, that of the best PSNR with psnr_not_reached(), which
/// `is_bounded` is for; where a run fails or is cancelled, the best result until then, its own included, with the status of that
/// run.
[[nodiscard]] HMESH_COLD inline Result fewest_vertices(double psnr, std::size_t first, std::size_t most,
                                                       FunctionRef<Result(std::size_t n)> mesh_of, bool is_bounded = false) {
    constexpr double slope = 1.6;  // dB for each doubling of the vertices
    struct Run {
        double log_n = 0, psnr = 0;
        std::size_t n = 0;
    };
    Run low, high;  // the most vertices that missed the PSNR, the fewest that reached it; n = 0: none yet
    Result result = mesh_of(first);
    Run run{std::log2(static_cast<double>(first)), result.report.psnr, first};
    detail::BestResult best(psnr, is_bounded, std::move(result));
    int same_side = 0;  // runs in a row that fell on one side
    bool last_side = false;
    double stride = 0.1;  // in log2(n); grows while the target is not enclosed, since curves can be flat
    for (int runs = 1; best.is_ok(); ++runs) {
        (run.psnr >= psnr ? high : low) = run;
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

        result = mesh_of(n);
        run = {std::log2(static_cast<double>(n)), result.report.psnr, n};
        best.offer(std::move(result));
    }
    return best.take();
}

/// The search of a method.
using PsnrSearch = Result(double psnr, const Trials& trials, std::size_t first, std::size_t most, std::size_t all,
                          FunctionRef<Result(std::size_t n, const Beginning& from)> mesh_from);
/// That of a method that cannot go on: fewest_vertices(), which `trials` mean nothing to.
[[nodiscard]] inline Result fewest_vertices_anew(double psnr, const Trials& /*trials*/, std::size_t first, std::size_t most,
                                                 std::size_t all,
                                                 FunctionRef<Result(std::size_t n, const Beginning& from)> mesh_from) {
    const auto mesh_of = [&](std::size_t n) { return mesh_from(n, {}); };
    return fewest_vertices(psnr, first, most, mesh_of, most < all);
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_PSNR_SEARCH_HPP
