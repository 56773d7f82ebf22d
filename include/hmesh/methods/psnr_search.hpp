/// \file
/// Psnr search: the fewest vertices whose mesh reaches a given PSNR.
///
/// PSNR rises by about 1.6 dB a doubling of the vertices, the slope of piecewise linear fits to photographs; steps of this slope
/// lead to two runs that enclose the target. From then on the next count is that of the secant between the two, or the middle
/// (of the logarithms) after more than two runs in a row on the same side.
///
/// Cost: ends when the two counts differ by at most 0.5 % (or 1), after some 5 to 8 runs of the method.
///
/// Of a method that can go on from a mesh, drafts first tell the slope and about how many vertices it takes; then comes one whole
/// run, and all further ones go on from the one before. Cost: some 2 runs of the method.
#ifndef HMESH_METHODS_PSNR_SEARCH_HPP
#define HMESH_METHODS_PSNR_SEARCH_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
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
        // Two sketches and two refinements are usual, and the first draft has a quarter of the vertices that the others have.
        double later = work_of(Work::refine) * (!goes_on(kind) ? 1.4 : count == 1 ? 0.6 : 0.1);
        if (kind == Work::draft || kind == Work::sketch) later += work_of(Work::whole);
        if (kind == Work::draft || count == 1)
            later += (kind == Work::draft ? 2 : kind == Work::sketch ? 1 : 0) * work_of(Work::sketch);
        return next(work_of(kind), kind == Work::draft && count == 1 ? 4 * later : later);
    }

  private:
    double reached_ = 0;
    int runs_ = 0;
    std::array<int, 5> runs_of_{};  ///< by Work
};

namespace detail {

/// The best result of a search: of those that reach the PSNR the one of the fewest vertices, else the one of the best PSNR.
class BestResult {
  public:
    explicit BestResult(double psnr, Result first) : psnr_(psnr), result_(std::move(first)) {}

    [[nodiscard]] bool is_reached() const noexcept { return result_.report.psnr >= psnr_; }  ///< whether one reached the PSNR
    [[nodiscard]] double excess() const noexcept { return result_.report.psnr - psnr_; }     ///< dB above it; below: < 0
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
    [[nodiscard]] Result take() {
        if (result_.status && !is_reached())
            result_.status = {Errc::target_out_of_range, "no mesh of this image reached the PSNR asked for, in dB",
                              result_.report.psnr, psnr_};
        return std::move(result_);
    }
    [[nodiscard]] bool is_ok() const noexcept { return static_cast<bool>(result_.status); }  ///< whether the last run went well

  private:
    double psnr_;
    Result result_;
};

}  // namespace detail

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
    Result result = mesh_of(first);
    Run run{std::log2(static_cast<double>(first)), result.report.psnr, first};
    detail::BestResult best(psnr, std::move(result));
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

/// The same for a method that can go on from a mesh. mesh_from(n, beginning) makes the mesh of n vertices. The result has at most
/// some 1 % more vertices than those that the method would need from the start, and may have fewer: a mesh gets better with each
/// run that goes on from it.
[[nodiscard]] HMESH_COLD inline Result fewest_vertices_going_on(
    double psnr, double gain_over_sketch, std::size_t first, std::size_t most,
    FunctionRef<Result(std::size_t n, const Beginning& from)> mesh_from) {
    constexpr double near_enough = 0.035;  // dB above the target: 1.5 % of the vertices
    constexpr double wasteful = 0.1;       // dB above it that are worth any number of runs, as small meshes may be
    constexpr double is_nearby = 0.4;      // doublings of the vertices up to which a run goes on from the one before
    constexpr double is_known = 0.6;       // up to which a sketch tells enough for the whole run
    constexpr double is_touched = 0.05;    // up to which little work keeps the mesh as good
    double slope = 1.6;                    // dB for each doubling of the vertices
    const auto doublings = [](std::size_t from, std::size_t to) {
        return std::log2(static_cast<double>(to) / static_cast<double>(from));
    };
    const auto next_after = [&](std::size_t n, double missing) {  // where a run of n vertices missed so many dB
        const double count = static_cast<double>(n) * std::exp2(std::max(-4.0, std::min(2.3, missing / slope)));
        return std::max<std::size_t>(4, std::min(most, static_cast<std::size_t>(std::llround(count))));
    };
    const auto learn = [&](std::size_t from, double from_psnr, std::size_t to, double to_psnr) {
        const double distance = doublings(from, to);
        if (is_finite(to_psnr) && std::abs(distance) > 0.2)
            slope = std::max(0.6, std::min(8.0, (to_psnr - from_psnr) / distance));
    };

    // Drafts, 6 % of a whole run each, lead near a sketch, and sketches to the whole run. How far a draft is below a sketch
    // differs much between images: rather too few vertices than too many, which take longer.
    std::size_t n = first, before = 0;
    double before_psnr = 0;
    Result rough;                              // the last one but the very last; without a mesh at first
    const auto better_of = [&](Result last) {  // that and one that failed or was cancelled, with its status
        if (!rough.has_mesh() || last.report.psnr >= rough.report.psnr) return last;
        rough.status = last.status;
        return std::move(rough);
    };
    for (int drafts = 0, sketches = 0; drafts < 4 && sketches < 4;) {
        const bool is_sketch = sketches != 0 || drafts == 3 || (before != 0 && std::abs(doublings(before, n)) < 1);
        Result result = mesh_from(n, {nullptr, is_sketch ? Work::sketch : Work::draft});
        if (!result.status) return better_of(std::move(result));
        if (!is_finite(result.report.psnr)) break;
        if (before != 0 && (sketches != 0) == is_sketch) learn(before, before_psnr, n, result.report.psnr);
        before = n, before_psnr = result.report.psnr;
        ++(is_sketch ? sketches : drafts);
        const double missing = psnr - gain_over_sketch - (is_sketch ? 0 : 2) - result.report.psnr;
        // The further away, the steeper: curves rise fast while there are few vertices for what is in the picture.
        if (drafts == 1 && sketches == 0) slope = 1.6 + 0.06 * std::min(10.0, std::abs(missing));
        n = next_after(n, missing);
        if (is_sketch && std::abs(doublings(before, n)) < is_known) break;
        rough = std::move(result);
    }

    Result whole = mesh_from(n, {});
    if (!whole.status) return better_of(std::move(whole));
    double now = whole.report.psnr;
    Mesh last = whole.mesh;
    detail::BestResult best(psnr, std::move(whole));
    double spent = 0;  // whole runs, since then only to save vertices
    for (int runs = 1; (spent < 0.4 || best.excess() > wasteful) && runs < 20; ++runs) {
        const bool is_reached = now >= psnr;
        if (is_reached ? n == 4 || now <= psnr + near_enough : n == most) break;
        std::size_t next = next_after(n, is_finite(now) ? psnr + 0.3 * near_enough - now : -slope);
        if (next == n) next = is_reached ? n - 1 : n + 1;
        const double distance = std::abs(doublings(n, next));
        const Work work = distance > is_nearby ? Work::whole : distance > is_touched ? Work::refine : Work::touch;
        Result result = mesh_from(next, {work == Work::whole ? nullptr : &last, work});
        const double then = result.report.psnr;
        Mesh reached = result.mesh;
        if (!best.offer(std::move(result))) break;
        learn(n, now, next, then);
        if (then >= psnr || now >= psnr) spent += work == Work::refine ? 0.375 : work == Work::touch ? 0.2 : 0;
        n = next, now = then;
        last = std::move(reached);
    }
    return best.take();
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_PSNR_SEARCH_HPP
