/// \file
/// Psnr search of a method that can go on from a mesh: the fewest vertices whose mesh reaches a given PSNR, from runs that go on
/// from one another.
///
/// Drafts first tell how steep the curve is and about how many vertices it takes; then comes one whole run, of rather too many
/// vertices, and all further ones go on from the one before: down to fewer loses nothing, and the last per cent are trimmed
/// without annealing. Cost: some 2 runs of the method, seldom more than 2.5.
#ifndef HMESH_METHODS_PSNR_SEARCH_GOING_ON_HPP
#define HMESH_METHODS_PSNR_SEARCH_GOING_ON_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "hmesh/core/compiler.hpp"
#include "hmesh/core/finite.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/methods/psnr_search.hpp"
#include "hmesh/methods/recipe.hpp"
#include "hmesh/result.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {
namespace detail {

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

/// A search of fewest_vertices_going_on() under way.
class SearchGoingOn {
  public:
    /// As fewest_vertices_going_on() is called.
    HMESH_COLD SearchGoingOn(double psnr, const Trials& trials, std::size_t first, std::size_t most, std::size_t all,
                             FunctionRef<Result(std::size_t n, const Beginning& from)> mesh_from)
        : psnr_(psnr), trials_(trials), most_(most), all_(all), mesh_from_(mesh_from),
          limit_(std::max(most, std::min(all, 2 * most))), n_(first) {}

    /// The result of the search.
    [[nodiscard]] HMESH_COLD Result run() {
        if (make_drafts() && make_sketches() && make_whole()) {
            refine();
            make_more_wholes();
            rough_ = best_->take();
        }
        settle(rough_);
        return std::move(rough_);
    }

  private:
    /// The whole run has so many times the vertices foretold, since growing costs more than losing what was too much.
    static constexpr double whole_surplus = 1.05;
    /// Meshes of the most vertices that are made, each from the one before, where all that reached the PSNR have more.
    static constexpr int settlings = 3;
    // All others are doublings of the number of vertices.
    /// Two drafts foretell what is needed up to so far from the second; one does to a third of that.
    static constexpr double draft_reach = 1.4;
    /// A sketch tells enough for the whole run up to so far from it.
    static constexpr double sketch_reach = 0.6;
    /// So many too many end the search: 1 %.
    static constexpr double harmless_excess = 0.014;
    /// More than so many too many are worth any number of runs, as small meshes may have them.
    static constexpr double bearable_excess = 0.018;
    /// A run goes on to fewer by up to so many: it is as good as a whole one then.
    static constexpr double loss_limit = 1;
    /// A run goes on to more by up to so many, and loses 0.1 to 0.3 dB; each run after it wins half of that back.
    static constexpr double growth_limit = 0.3;
    /// Growth by up to so many loses nothing.
    static constexpr double harmless_growth = 0.1;
    /// Little work keeps the mesh as good up to so many more or fewer.
    static constexpr double touch_limit = 0.08;
    /// The mesh may grow without annealing by up to so many.
    static constexpr double trim_limit = 0.015;

    [[nodiscard]] static double doublings(double from, double to) noexcept { return std::log2(to / from); }
    [[nodiscard]] double count() const noexcept { return static_cast<double>(n_); }
    /// The allowed number of vertices that is nearest to n.
    [[nodiscard]] HMESH_COLD std::size_t allowed(double n) const noexcept {
        return std::max<std::size_t>(4, static_cast<std::size_t>(std::llround(std::min(static_cast<double>(limit_), n))));
    }

    /// Ends the search with a run that failed or was cancelled: the better one of its mesh and the one before gets its status.
    /// False.
    HMESH_COLD bool end_with(Result last) {
        if (!rough_.has_mesh() || last.report.psnr >= rough_.report.psnr) rough_ = std::move(last);
        else rough_.status = last.status;
        return false;
    }

    /// Drafts, each a tenth of a whole run, foretell about how many vertices that takes: the last of about as many. False: one
    /// failed or was cancelled, which ends the search with `rough_`, as for the next two.
    [[nodiscard]] HMESH_COLD bool make_drafts() {
        for (int runs = 1; runs <= 4; ++runs) {
            Result draft = mesh_from_(n_, {nullptr, Work::draft});
            if (!draft.status) return end_with(std::move(draft));
            const double reached = draft.report.psnr;
            if (!is_finite(reached)) break;
            if (curve_) curve_->pass(n_, reached, false);
            else curve_.emplace(n_, reached);
            const double drafted = count(), needed = curve_->count(psnr_);
            n_ = allowed(std::min(5 * drafted, trials_.draft * needed));
            if (std::abs(doublings(drafted, needed)) < (runs == 1 ? draft_reach / 3 : draft_reach) || count() == drafted) break;
            rough_ = std::move(draft);
        }
        if (curve_) curve_->scale(trials_.draft);
        return true;
    }

    /// Up to two sketches, where the method has them, foretell it more exactly.
    [[nodiscard]] HMESH_COLD bool make_sketches() {
        for (int runs = 0; curve_ && trials_.sketch > 0 && runs < 2; ++runs) {
            Result sketch = mesh_from_(n_, {nullptr, Work::sketch});
            if (!sketch.status) return end_with(std::move(sketch));
            if (!is_finite(sketch.report.psnr)) break;
            curve_->scale(1 / trials_.sketch);
            curve_->shift(n_, sketch.report.psnr);
            curve_->scale(trials_.sketch);
            const double sketched = count();
            n_ = allowed(curve_->count(psnr_));
            if (std::abs(doublings(sketched, count())) < sketch_reach) break;
            rough_ = std::move(sketch);
        }
        return true;
    }

    /// The whole run that all others go on from.
    [[nodiscard]] HMESH_COLD bool make_whole() {
        // Where even twice as many as are allowed would not do, more are of no use.
        if (limit_ < all_ && (!curve_ || curve_->count(psnr_) > static_cast<double>(limit_))) limit_ = most_;
        n_ = allowed((trials_.draft < 1 ? whole_surplus : 1) * count());
        Result whole = mesh_from_(n_, {});
        if (!whole.status) return end_with(std::move(whole));
        reached_ = whole.report.psnr;
        if (!curve_) curve_.emplace(n_, reached_);
        else if (is_finite(reached_)) curve_->shift(n_, reached_);
        last_ = whole.mesh;
        best_.emplace(psnr_, most_ < all_, std::move(whole));
        most_whole_ = n_;
        return true;
    }

    /// Runs that go on from one another until the last has as few vertices as do.
    HMESH_COLD void refine() {
        for (int runs = 1; runs < 20; ++runs) {
            const double needed = foretold();
            if (is_enough(needed) || !go_on_to(next_count(needed))) return;
        }
    }
    /// The number of vertices that seems to be needed, after the last run.
    [[nodiscard]] HMESH_COLD double foretold() const {
        const double needed = is_finite(reached_) ? curve_->count(psnr_) : count() / 2;
        // A curve that tells more than what has done already is wrong.
        if (reached_ < psnr_ && best_->is_reached() && count() < best_->vertices())
            return std::min(needed, std::sqrt(count() * best_->vertices()));
        return needed;
    }
    /// Whether no run is worth its time that goes on from the last.
    [[nodiscard]] HMESH_COLD bool is_enough(double needed) const {
        const double excess = doublings(needed, count());
        // Where no more are allowed, a refinement may make up for a few that lack.
        if (reached_ >= psnr_ ? n_ == 4 || (excess <= harmless_excess && grown_ <= harmless_growth)
                              : n_ == limit_ && (spent_ >= 0.5 || excess < -touch_limit))
            return true;
        return best_->is_reached() && spent_ >= 0.5 && doublings(needed, best_->vertices()) <= bearable_excess;
    }
    /// The number of vertices of the next run.
    [[nodiscard]] HMESH_COLD std::size_t next_count(double needed) const {
        const double excess = doublings(needed, count());
        // Rather too many than too few, and the more so the farther away: a trim costs next to nothing.
        double aim = needed * (1.003 + std::min(0.035, 0.07 * std::abs(excess)));
        // A curve that promised so much too much still does.
        if (doublings(count(), aim) > growth_limit) aim = 1.2 * needed;
        const std::size_t next = allowed(aim);
        if (next != n_) return next;
        return reached_ >= psnr_ ? n_ - 1 : std::min(n_ + 1, limit_);
    }
    /// The least work that makes a good mesh of `next` vertices of the last one.
    [[nodiscard]] HMESH_COLD Work work_to(std::size_t next) const noexcept {
        const double growth = doublings(count(), static_cast<double>(next));
        if (growth > growth_limit || growth < -loss_limit) return Work::whole;
        if (std::abs(growth) > touch_limit || next == n_) return Work::refine;
        return growth > trim_limit || grown_ > harmless_growth ? Work::touch : Work::trim;
    }
    /// One run. False: it failed or was cancelled.
    HMESH_COLD bool go_on_to(std::size_t next) {
        const double growth = doublings(count(), static_cast<double>(next));
        const Work work = work_to(next);
        Result result = mesh_from_(next, {work == Work::whole ? nullptr : &last_, work});
        reached_ = result.report.psnr;
        Mesh mesh = result.mesh;
        if (!best_->offer(std::move(result))) return false;
        if (is_finite(reached_)) curve_->pass(next, reached_, goes_on(work));
        if (work == Work::whole) most_whole_ = std::max(most_whole_, next);
        spent_ += work == Work::whole ? 1 : work == Work::refine ? 0.4 : work == Work::touch ? 0.2 : 0.1;
        if (work == Work::whole) grown_ = 0;
        else if (work != Work::trim) grown_ = grown_ / 2 + std::max(0.0, growth);
        n_ = next;
        last_ = std::move(mesh);
        return true;
    }

    /// What went on from mesh to mesh may be stuck below the PSNR, which whole runs are not.
    HMESH_COLD void make_more_wholes() {
        for (n_ = std::min(n_, most_); best_->is_ok() && !best_->is_reached() && most_whole_ < most_; most_whole_ = n_) {
            n_ = most_whole_ < n_ ? n_ : std::min(most_, 2 * n_);
            best_->offer(mesh_from_(n_, {}));
        }
    }

    /// Brings what was found down to the most vertices where it has more.
    HMESH_COLD void settle(Result& found) {
        if (found.report.vertices <= most_ || !(found.status || found.status.code == Errc::target_out_of_range)) return;
        BestResult bounded(psnr_, most_ < all_, mesh_from_(most_, {&found.mesh, Work::refine}));
        for (int k = 1; k < settlings && bounded.is_ok() && !bounded.is_reached(); ++k)
            bounded.offer(mesh_from_(most_, {&bounded.mesh(), Work::refine}));
        found = bounded.take();
    }

    double psnr_;
    Trials trials_;
    std::size_t most_, all_;
    FunctionRef<Result(std::size_t n, const Beginning& from)> mesh_from_;

    std::size_t limit_;  ///< the most vertices of a run
    std::size_t n_;      ///< vertices of the last run, or of the next as far as it is known
    std::optional<PsnrCurve> curve_;
    Result rough_;  ///< of drafts and sketches the last but the very last, without a mesh at first; in the end what is returned
    std::optional<BestResult> best_;
    Mesh last_;                   ///< the mesh of the last run
    double reached_ = 0;          ///< its PSNR
    double grown_ = 0;            ///< doublings by which it grew, but for what annealing has made up for since
    double spent_ = 0;            ///< whole runs since the first
    std::size_t most_whole_ = 0;  ///< the most vertices of a whole run
};

}  // namespace detail

/// fewest_vertices() for a method that can go on from a mesh. mesh_from(n, beginning) makes the mesh of n vertices, also of up to
/// twice as many as `most`, and at most `all`, where it seems that as many are needed: coming down from these it may do with what
/// is allowed. The result has at most 1 to 2 % more vertices than those that the method would need from the start, and may have
/// fewer: a mesh gets better with each run that goes on from it. Cancelled, it may have more than `most`.
[[nodiscard]] HMESH_COLD inline Result fewest_vertices_going_on(
    double psnr, const Trials& trials, std::size_t first, std::size_t most, std::size_t all,
    FunctionRef<Result(std::size_t n, const Beginning& from)> mesh_from) {
    return detail::SearchGoingOn(psnr, trials, first, most, all, mesh_from).run();
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_PSNR_SEARCH_GOING_ON_HPP
