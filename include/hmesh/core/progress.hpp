/// \file
/// Progress: how long work reports how far it is, and learns that it should stop.
#ifndef HMESH_CORE_PROGRESS_HPP
#define HMESH_CORE_PROGRESS_HPP

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <vector>

#include "hmesh/core/array.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/core/psnr.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

struct Mesh;

/// How far the work is, as told to the progress callback.
struct ProgressInfo {
    const char* stage = "";    ///< name of the stage, in static memory
    double fraction = 0;       ///< how much of the stage is done, in [0, 1]
    std::size_t vertices = 0;  ///< number of vertices of the mesh reached so far
    double energy = 0;         ///< sum of squared differences over pixels and channels; 0 before there is a mesh
    /// How much of the whole call is done, in [0, 1]: an estimate of the share of its time, for one bar over all stages and, in a
    /// search for a PSNR, over all runs. Never falls; 1 in the last call, unless the work was cancelled or failed.
    double total = 0;
    /// Makes the mesh so far, for programs that show it while it grows: valid, with colours in the range of the pixel type that
    /// are neither rounded nor the final ones (sampled where channels have weights), and as many vertices as `vertices` says,
    /// often more than the target. Empty where there is none to be had. mesh_image(), but not with Bounded, and mesh_lods() offer
    /// it at the end of each stage and of each sweep of annealing, on the thread that called them; with Hierarchical of those
    /// stages alone that work on the image itself, not on a filtered level. To be called within this call of the callback alone;
    /// takes 0.1 to 0.3 us a vertex, and changes no byte of the result.
    FunctionRef<Mesh()> mesh_so_far{};
};

/// The progress callback: returns true to go on, false to cancel; the last valid mesh is then returned with Errc::cancelled.
///
/// It is called with fraction 0 when a stage begins, with 1 when it ends, and every few milliseconds in between where vertices
/// and edges are worked on or all pixels are read; from the threads that do the work, but never from two at a time (calls are
/// ordered as by a lock). There are no calls before the first stage, while floats and weights are checked, some 2 ns a pixel, and
/// while a mesh is put together: 0.1 to 0.2 us a vertex, and 3 us for the final colours of a periodic one.
///
/// A Progress refers to a callable that must outlive the work: keep a lambda in a variable of its own.
using Progress = FunctionRef<bool(const ProgressInfo& info)>;

/// Size and error of the mesh after one stage.
struct StageReport {
    const char* name = "";     ///< name of the stage, in static memory
    std::size_t vertices = 0;  ///< number of vertices
    double energy = 0;         ///< sum of squared differences over pixels and channels
    double psnr = 0;           ///< dB, from `energy` by kit::psnr_of_energy()
    int iterations = 0;   ///< number of iterations of the linear systems that the stage solved, in all; 0 where it solved none
    double residual = 0;  ///< largest residual of these systems, relative to the right-hand side
};

namespace kit {

/// The part of the whole call that one run of a method is, as ProgressInfo::total counts; 0 <= from <= to <= 1.
struct ProgressSpan {
    double from = 0;  ///< where the run begins
    double to = 1;    ///< where it ends
};

/// Takes a Progress through the stages of a method and notes the mesh after each stage. begin(), update(), set_range(),
/// plan() and end() are called from one thread while no task runs; poll(), add() and stopped() from any thread. Once cancelled
/// it stays cancelled.
class ProgressReporter {
  public:
    /// `samples`: number of pixels (or sum of their weights) times channels; `peak`: value of full intensity. Both are for the
    /// PSNR of reports. `span`: what the stages are of the whole call.
    ProgressReporter(const Progress& progress, double samples, double peak, const ProgressSpan& span = {})
        : progress_(progress), samples_(samples), peak_(peak), span_(span) {
        info_.total = span.from;
    }

    /// Says how long the stages to come take: each that begins takes the next of these shares, of any unit, >= 0 and not all 0.
    /// The last one is that of the final colours, which mesh_image() adds. Only the first call counts, so that a method may be
    /// the start of another. Stages beyond the plan, or without one, take half of what is left until the final colours.
    HMESH_COLD void plan(std::initializer_list<double> shares) {
        if (!plan_.empty()) return;
        plan_ = shares;
        double sum = 0;
        for (const double share : plan_) sum += share;
        for (double& share : plan_) share /= sum;
    }
    /// Begins a stage, whose name is in static memory, with a mesh of this size and energy. False once cancelled.
    HMESH_COLD bool begin(const char* stage, std::size_t vertices, double energy) {
        const double rest = 1 - (plan_.empty() ? 0 : plan_.back()) - stage_to_;
        const bool is_planned = planned_ + 1 < plan_.size();
        return begin_stage(stage, vertices, energy, stage_to_,
                           stage_to_ + std::max(0.0, is_planned ? plan_[planned_++] : 0.5 * rest));
    }
    /// The energies to come are in this unit, by which they are multiplied in all that is told; > 0, 1 at first.
    void set_energy_unit(double unit) noexcept { energy_unit_ = unit; }
    /// Begins the last stage, that of the final colours.
    HMESH_COLD bool begin_colors(std::size_t vertices, double energy) { return begin_last("colors", vertices, energy); }
    /// Begins the last stage of a method whose last one has another name, in static memory.
    HMESH_COLD bool begin_last(const char* stage, std::size_t vertices, double energy) {
        const double from = plan_.empty() ? stage_to_ : std::max(stage_to_, 1 - plan_.back());
        return begin_stage(stage, vertices, energy, from, 1);
    }
    /// Reports that this fraction of the stage is done, in [0, 1], with a mesh of this size and energy, which the callback can
    /// ask for unless `mesh_so_far` is empty. False once cancelled.
    bool update(double fraction, std::size_t vertices, double energy, FunctionRef<Mesh()> mesh_so_far = {}) {
        set_range(fraction, fraction);
        return tell(vertices, energy, mesh_so_far);
    }
    /// The tasks that follow take the stage from fraction `from` to fraction `to`, both in [0, 1]. A fraction of 1 is told as a
    /// little less: the stage has not ended.
    void set_range(double from, double to) noexcept {
        from_ = std::max(0.0, std::min(before_end, from));
        to_ = std::max(0.0, std::min(before_end, to));
        done_ = 0;
    }
    /// The range as set_range() left it.
    [[nodiscard]] std::array<double, 2> range() const noexcept { return {from_, to_}; }
    /// Ends the stage and notes its StageReport with a mesh of this size and energy, as update() tells it. False once cancelled.
    bool end(std::size_t vertices, double energy, FunctionRef<Mesh()> mesh_so_far = {}) {
        stages_.push_back(
            {info_.stage, vertices, told(energy), psnr_of_energy(told(energy), samples_, peak_), iterations_, residual_});
        from_ = to_ = 1;
        return tell(vertices, energy, mesh_so_far);
    }
    /// Notes for the report of the stage that a linear system was solved. From one task at a time.
    void note_solve(int iterations, double residual) noexcept {
        iterations_ += iterations;
        residual_ = std::max(residual_, residual);
    }
    [[nodiscard]] const std::vector<StageReport>& stages() const noexcept { return stages_; }  ///< of the stages ended, in order

    /// Asks the callback unless another thread is doing so. False once cancelled. From any thread.
    bool poll() {
        if (stopped_.load(std::memory_order_relaxed)) return false;
        if (!progress_ || asking_.test_and_set(std::memory_order_acquire)) return true;
        return ask();
    }
    /// Reports that this share of the range of set_range() is done. From any thread.
    void add(double share) noexcept { done_ += static_cast<std::int64_t>(share * whole); }
    [[nodiscard]] bool stopped() const noexcept { return stopped_.load(); }  ///< whether the work was cancelled; from any thread

  private:
    /// The value of done_ for a whole range. An integer: a sum of integers is the same in any order.
    static constexpr double whole = 1e15;
    static constexpr double before_end = 1 - 1e-9;

    /// Energies as they are told: rounding may leave less than nothing.
    [[nodiscard]] double told(double energy) const noexcept { return std::max(0.0, energy * energy_unit_); }
    bool tell(std::size_t vertices, double energy, FunctionRef<Mesh()> mesh_so_far) {
        info_.vertices = vertices;
        info_.energy = told(energy);
        info_.mesh_so_far = mesh_so_far;
        const bool go_on = poll();
        info_.mesh_so_far = {};
        return go_on;
    }
    bool begin_stage(const char* stage, std::size_t vertices, double energy, double from, double to) {
        info_.stage = stage;
        iterations_ = 0;
        residual_ = 0;
        stage_from_ = std::min(1.0, from);
        stage_to_ = std::min(1.0, to);
        return update(0, vertices, energy);
    }
    /// Calls the callback, as the one thread that set asking_.
    HMESH_NEVER_INLINE HMESH_COLD bool ask() {
        ProgressInfo info = info_;
        info.fraction = from_ + (to_ - from_) * std::min(1.0, static_cast<double>(done_.load()) / whole);
        const double of_run = info.fraction < 1 ? stage_from_ + (stage_to_ - stage_from_) * info.fraction : stage_to_;
        info.total = of_run < 1 ? span_.from + (span_.to - span_.from) * of_run : span_.to;
        info.total = info_.total = std::max(info_.total, info.total);  // rounding may lead a little back
        const bool go_on = stopped_.load() || progress_(info);
        if (!go_on) stopped_.store(true);
        asking_.clear(std::memory_order_release);
        return !stopped_.load();
    }

    Progress progress_;
    double samples_, peak_;
    double energy_unit_ = 1;
    ProgressSpan span_;
    Array<double> plan_;                    ///< shares of the run, whose sum is 1; or none
    std::size_t planned_ = 0;               ///< stages of the plan that have begun
    double stage_from_ = 0, stage_to_ = 0;  ///< of the run: the stage that began last
    ProgressInfo info_;
    double from_ = 0, to_ = 0;
    int iterations_ = 0;  ///< of the current stage
    double residual_ = 0;
    std::atomic<std::int64_t> done_{0};
    std::atomic<bool> stopped_{false};
    std::atomic_flag asking_ = ATOMIC_FLAG_INIT;
    std::vector<StageReport> stages_;
};

/// An executor that asks the callback before each piece, for pieces that do not look at the progress themselves: they are all
/// done, also once the work was cancelled.
class PollingExecutor {
  public:
    /// Both must outlive it.
    PollingExecutor(ProgressReporter& reporter, const ParallelFor& parallel_for) noexcept
        : reporter_(&reporter), parallel_for_(parallel_for) {}
    /// From now on another reporter is asked, which must outlive it too.
    void report_to(ProgressReporter& reporter) noexcept { reporter_ = &reporter; }

    /// Runs the pieces, as the executor that it was made of does.
    HMESH_COLD void operator()(std::size_t n, Piece piece) const {
        parallel_for_(n, [&](std::size_t i) {
            (void)reporter_->poll();
            piece(i);
        });
    }

  private:
    ProgressReporter* reporter_;
    ParallelFor parallel_for_;
};

/// The progress of one of the tasks that run at once under a ProgressReporter. Not shared between threads.
class TaskProgress {
  public:
    /// A task that is `share`, in [0, 1], of the range of ProgressReporter::set_range().
    TaskProgress(ProgressReporter& reporter, double share) noexcept : reporter_(&reporter), share_(share) {}
    /// Not copied: its destructor reports.
    TaskProgress(const TaskProgress&) = delete;
    TaskProgress& operator=(const TaskProgress&) = delete;  ///< not assigned
    /// Reports that the task is done.
    ~TaskProgress() { set_fraction(1); }

    /// Whether to go on; called every few microseconds of work. Every 256th call asks the callback, which is every few
    /// milliseconds.
    bool keep_going() { return (++beats_ & 255U) != 0 ? !reporter_->stopped() : beat(); }
    /// Says what fraction of the task will be done after about this many more calls of keep_going(), which lead there evenly.
    HMESH_COLD void expect(double fraction, double beats) noexcept {
        limit_ = fraction;
        step_ = (fraction - reached_) * 256 / std::max(256.0, beats);
    }
    /// Reports that this fraction of the task is done, in [0, 1]. It never falls.
    void set_fraction(double fraction) noexcept {
        if (!(fraction > reached_)) return;
        reporter_->add(share_ * (std::min(1.0, fraction) - reached_));
        reached_ = std::min(1.0, fraction);
    }
    [[nodiscard]] bool stopped() const noexcept { return reporter_->stopped(); }  ///< whether the work was cancelled

  private:
    HMESH_NEVER_INLINE HMESH_COLD bool beat() {
        set_fraction(std::min(limit_, reached_ + step_));
        return reporter_->poll();
    }

    ProgressReporter* reporter_;
    double share_, reached_ = 0;
    double limit_ = 0, step_ = 0;  ///< see expect()
    unsigned beats_ = 0;
};

}  // namespace kit
}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_CORE_PROGRESS_HPP
