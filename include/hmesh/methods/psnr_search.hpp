/// \file
/// Psnr search: the fewest vertices whose mesh reaches a given PSNR.
///
/// PSNR rises by about 1.6 dB a doubling of the vertices, the slope of piecewise linear fits to photographs; steps of this slope
/// lead to two runs that enclose the target. From then on the next count is that of the secant between the two, or the middle
/// (of the logarithms) after more than two runs in a row on the same side.
///
/// Cost: ends when the two counts differ by at most 0.5 % (or 1), after some 5 to 8 runs of the method.
///
/// Of a method that can go on from a mesh, drafts first tell how steep the curve is and about how many vertices it takes; then
/// comes one whole run, of rather too many vertices, and all further ones go on from the one before: down to fewer loses nothing,
/// and the last per cent are trimmed without annealing. Cost: some 2 runs of the method, seldom more than 2.5.
#ifndef HMESH_METHODS_PSNR_SEARCH_HPP
#define HMESH_METHODS_PSNR_SEARCH_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
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

/// The sentence of a search in which all went well and no mesh reached the PSNR.
inline constexpr char psnr_not_reached[] = "no mesh of this image reached the PSNR asked for, in dB";

namespace detail {

/// The best result of a search: of those that reach the PSNR the one of the fewest vertices, else the one of the best PSNR.
class BestResult {
  public:
    explicit BestResult(double psnr, Result first) : psnr_(psnr), result_(std::move(first)) {}

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
        if (result_.status && !is_reached())
            result_.status = {Errc::target_out_of_range, psnr_not_reached, result_.report.psnr, psnr_};
        return std::move(result_);
    }
    [[nodiscard]] bool is_ok() const noexcept { return static_cast<bool>(result_.status); }  ///< whether the last run went well

  private:
    double psnr_;
    Result result_;
};

/// The PSNR over the number of vertices, after runs of one kind: about a straight line in the fourth root of that number, as of
/// photographs between 20 and 42 dB; where all but their grain is fitted, they rise less.
class PsnrCurve {
  public:
    /// After a first run of n vertices.
    PsnrCurve(std::size_t n, double psnr) noexcept : root_(root_of(static_cast<double>(n))), psnr_(psnr), rise_(rise_of(1.6)) {}
    /// Through a run of n vertices, as steep as before.
    void shift(std::size_t n, double psnr) noexcept {
        root_ = root_of(static_cast<double>(n));
        psnr_ = psnr;
    }
    /// Through a run of n vertices and the one before, if they are far enough apart to tell more than chance. A run that
    /// `goes_on` from the one before may have won or lost some dB by that, which only makes the curve seem flatter.
    HMESH_COLD void pass(std::size_t n, double psnr, bool goes_on) noexcept {
        const double step = root_of(static_cast<double>(n)) - root_, gain = psnr - psnr_;
        const bool is_far = std::abs(step) > 0.035 * root_;  // a fifth of a doubling
        shift(n, psnr);
        if (is_far) rise_ = std::max(goes_on ? rise_ : rise_of(0.6), std::min(rise_of(16), gain / step));
    }
    /// The curve of runs that reach as much by this share of the vertices.
    void scale(double share) noexcept {
        root_ *= root_of(share);
        rise_ /= root_of(share);
    }
    /// The number of vertices for a PSNR.
    [[nodiscard]] double count(double psnr) const noexcept {
        const double root = std::max(root_ / 2, root_ + (psnr - psnr_) / rise_);
        return root * root * root * root;
    }

  private:
    [[nodiscard]] static double root_of(double n) noexcept { return std::sqrt(std::sqrt(n)); }
    /// The rise that is so many dB for a doubling.
    [[nodiscard]] double rise_of(double slope) const noexcept { return slope / (0.1733 * root_); }  // log(2) / 4

    double root_, psnr_;
    double rise_;  ///< dB for one more of the root
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

/// The same for a method that can go on from a mesh. mesh_from(n, beginning) makes the mesh of n vertices, also of up to twice as
/// many as `most`, and at most `all`, where it seems that as many are needed: coming down from these it may do with what is
/// allowed. The result has at most 1 to 2 % more vertices than those that the method would need from the start, and may have
/// fewer: a mesh gets better with each run that goes on from it. Cancelled, it may have more than `most`.
[[nodiscard]] HMESH_COLD inline Result fewest_vertices_going_on(
    double psnr, const Trials& trials, std::size_t first, std::size_t most, std::size_t all,
    FunctionRef<Result(std::size_t n, const Beginning& from)> mesh_from) {
    constexpr double likely_enough = 1.05;  // times what is foretold, since growing costs more than losing what was too much
    // In doublings of the vertices:
    constexpr double near_enough = 0.014;  // that may be too many: 1 %
    constexpr double wasteful = 0.018;     // too many that are worth any number of runs, as small meshes may be
    constexpr double is_known = 1.4;       // up to where two drafts foretell what is needed; one does to a third of that
    constexpr double most_fewer = 1;       // by which a run goes on to fewer: as good as a whole one
    constexpr double most_more = 0.3;    // by which it goes on to more, and loses 0.1 to 0.3 dB; each run after it wins half back
    constexpr double is_made_up = 0.1;   // of these, up to where nothing is lost
    constexpr double is_touched = 0.08;  // up to where little work keeps the mesh as good
    constexpr double is_trimmed = 0.015;  // by which it may grow without annealing
    constexpr double is_sketched = 0.6;   // up to where a sketch tells enough for the whole run
    constexpr int most_refined = 3;       // meshes of the most vertices that come down from more
    const auto doublings = [](double from, double to) { return std::log2(to / from); };
    std::size_t limit = std::max(most, std::min(all, 2 * most));
    const auto allowed = [&](double n) {
        return std::max<std::size_t>(4, static_cast<std::size_t>(std::llround(std::min(static_cast<double>(limit), n))));
    };

    Result rough;                              // the last one but the very last; without a mesh at first
    const auto better_of = [&](Result last) {  // that and one that failed or was cancelled, with its status
        if (!rough.has_mesh() || last.report.psnr >= rough.report.psnr) return last;
        rough.status = last.status;
        return std::move(rough);
    };
    // Drafts, each a tenth of a whole run, foretell about how many vertices that takes: the last of about as many.
    std::size_t n = first;
    std::optional<detail::PsnrCurve> curve;
    for (int runs = 1; runs <= 4; ++runs) {
        Result draft = mesh_from(n, {nullptr, Work::draft});
        if (!draft.status) return better_of(std::move(draft));
        const double reached = draft.report.psnr;
        if (!is_finite(reached)) break;
        if (curve) curve->pass(n, reached, false);
        else curve.emplace(n, reached);
        const auto count = static_cast<double>(n), needed = curve->count(psnr);
        n = allowed(std::min(5 * count, trials.draft * needed));
        if (std::abs(doublings(count, needed)) < (runs == 1 ? is_known / 3 : is_known) || static_cast<double>(n) == count) break;
        rough = std::move(draft);
    }
    if (curve) curve->scale(trials.draft);
    for (int runs = 0; curve && trials.sketch > 0 && runs < 2; ++runs) {
        Result sketch = mesh_from(n, {nullptr, Work::sketch});
        if (!sketch.status) return better_of(std::move(sketch));
        if (!is_finite(sketch.report.psnr)) break;
        curve->scale(1 / trials.sketch);
        curve->shift(n, sketch.report.psnr);
        curve->scale(trials.sketch);
        const std::size_t before = std::exchange(n, allowed(curve->count(psnr)));
        if (std::abs(doublings(static_cast<double>(before), static_cast<double>(n))) < is_sketched) break;
        rough = std::move(sketch);
    }

    if (limit < all && (!curve || curve->count(psnr) > static_cast<double>(limit))) limit = most;  // more would be of no use
    n = allowed((trials.draft < 1 ? likely_enough : 1) * static_cast<double>(n));
    Result whole = mesh_from(n, {});
    if (!whole.status) return better_of(std::move(whole));
    double now = whole.report.psnr;
    if (!curve) curve.emplace(n, now);
    else if (is_finite(now)) curve->shift(n, now);
    Mesh last = whole.mesh;
    detail::BestResult best(psnr, std::move(whole));
    double grown = 0;  // doublings by which it grew, but for what annealing has made up for since
    double spent = 0;  // whole runs since then
    std::size_t most_whole = n;
    for (int runs = 1; runs < 20; ++runs) {
        const auto count = static_cast<double>(n);
        double needed = is_finite(now) ? curve->count(psnr) : count / 2;
        // A curve that tells more than what has done already is wrong.
        if (now < psnr && best.is_reached() && count < best.vertices())
            needed = std::min(needed, std::sqrt(count * best.vertices()));
        const double excess = doublings(needed, count);
        // Where no more are allowed, a refinement may make up for a few that lack.
        if (now >= psnr ? n == 4 || (excess <= near_enough && grown <= is_made_up)
                        : n == limit && (spent >= 0.5 || excess < -is_touched))
            break;
        if (best.is_reached() && spent >= 0.5 && doublings(needed, best.vertices()) <= wasteful) break;
        // Rather too many than too few, and the more so the farther away: a trim costs next to nothing.
        double aim = needed * (1.003 + std::min(0.035, 0.07 * std::abs(excess)));
        if (doublings(count, aim) > most_more) aim = 1.2 * needed;  // a curve that promised so much too much still does
        std::size_t next = allowed(aim);
        if (next == n) next = now >= psnr ? n - 1 : std::min(n + 1, limit);
        const double growth = doublings(count, static_cast<double>(next));
        const Work work = growth > most_more || growth < -most_fewer   ? Work::whole
                          : std::abs(growth) > is_touched || next == n ? Work::refine
                          : growth > is_trimmed || grown > is_made_up  ? Work::touch
                                                                       : Work::trim;
        Result result = mesh_from(next, {work == Work::whole ? nullptr : &last, work});
        now = result.report.psnr;
        Mesh reached = result.mesh;
        if (!best.offer(std::move(result))) break;
        if (is_finite(now)) curve->pass(next, now, goes_on(work));
        if (work == Work::whole) most_whole = std::max(most_whole, next);
        spent += work == Work::whole ? 1 : work == Work::refine ? 0.4 : work == Work::touch ? 0.2 : 0.1;
        if (work == Work::whole) grown = 0;
        else if (work != Work::trim) grown = grown / 2 + std::max(0.0, growth);
        n = next;
        last = std::move(reached);
    }
    // What went on from mesh to mesh may be stuck below the PSNR, which whole runs are not.
    for (n = std::min(n, most); best.is_ok() && !best.is_reached() && most_whole < most; most_whole = n) {
        n = most_whole < n ? n : std::min(most, 2 * n);
        best.offer(mesh_from(n, {}));
    }
    Result found = best.take();
    if (found.report.vertices <= most || !(found.status || found.status.code == Errc::target_out_of_range)) return found;
    detail::BestResult bounded(psnr, mesh_from(most, {&found.mesh, Work::refine}));
    for (int k = 1; k < most_refined && bounded.is_ok() && !bounded.is_reached(); ++k)
        bounded.offer(mesh_from(most, {&bounded.mesh(), Work::refine}));
    return bounded.take();
}

/// The search of a method.
using PsnrSearch = Result(double psnr, const Trials& trials, std::size_t first, std::size_t most, std::size_t all,
                          FunctionRef<Result(std::size_t n, const Beginning& from)> mesh_from);
/// That of a method that cannot go on: fewest_vertices(), which `trials` and `all` mean nothing to.
[[nodiscard]] inline Result fewest_vertices_anew(double psnr, const Trials& /*trials*/, std::size_t first, std::size_t most,
                                                 std::size_t /*all*/,
                                                 FunctionRef<Result(std::size_t n, const Beginning& from)> mesh_from) {
    return fewest_vertices(psnr, first, most, [&](std::size_t n) { return mesh_from(n, {}); });
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_PSNR_SEARCH_HPP
