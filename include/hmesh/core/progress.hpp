/// \file
/// Progress: how long work reports how far it is, and learns that it should stop.
#ifndef HMESH_CORE_PROGRESS_HPP
#define HMESH_CORE_PROGRESS_HPP

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/psnr.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// How far the work is, as told to the progress callback.
struct ProgressInfo {
    const char* stage = "";    ///< name of the stage, in static memory
    double fraction = 0;       ///< how much of the stage is done, in [0, 1]
    std::size_t vertices = 0;  ///< number of vertices of the mesh reached so far
    double energy = 0;         ///< sum of squared differences over pixels and channels; 0 before there is a mesh
};

/// The progress callback: returns true to go on, false to cancel; the last valid mesh is then returned with Errc::cancelled.
///
/// It is called with fraction 0 when a stage begins, with 1 when it ends, and every few milliseconds in between where vertices
/// and edges are worked on; from the threads that do the work, but never from two at a time (calls are ordered as by a lock).
/// There are no calls during passes over all pixels, some 0.2 s a megapixel at most, and while a mesh is put together, some 0.8
/// us a vertex.
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

/// Takes a Progress through the stages of a method and notes the mesh after each stage. begin(), update(), set_range() and
/// end() are called from one thread while no task runs; poll(), add() and stopped() from any thread. Once cancelled it stays
/// cancelled.
class ProgressReporter {
  public:
    /// `samples`: number of pixels (or sum of their weights) times channels; `peak`: value of full intensity. Both are for the
    /// PSNR of reports.
    ProgressReporter(const Progress& progress, double samples, double peak)
        : progress_(progress), samples_(samples), peak_(peak) {}

    /// Begins a stage, whose name is in static memory, with a mesh of this size and energy. False once cancelled.
    bool begin(const char* stage, std::size_t vertices, double energy) {
        info_.stage = stage;
        iterations_ = 0;
        residual_ = 0;
        return update(0, vertices, energy);
    }
    /// Reports that this fraction of the stage is done, in [0, 1], with a mesh of this size and energy. False once cancelled.
    bool update(double fraction, std::size_t vertices, double energy) {
        set_range(fraction, fraction);
        info_.vertices = vertices;
        info_.energy = std::max(0.0, energy);  // rounding may leave less than nothing
        return poll();
    }
    /// The tasks that follow take the stage from fraction `from` to fraction `to`, both in [0, 1].
    void set_range(double from, double to) noexcept {
        from_ = std::max(0.0, std::min(1.0, from));
        to_ = std::max(0.0, std::min(1.0, to));
        done_ = 0;
    }
    /// Ends the stage and notes its StageReport with a mesh of this size and energy. False once cancelled.
    bool end(std::size_t vertices, double energy) {
        energy = std::max(0.0, energy);
        stages_.push_back({info_.stage, vertices, energy, psnr_of_energy(energy, samples_, peak_), iterations_, residual_});
        return update(1, vertices, energy);
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
        ProgressInfo info = info_;
        info.fraction = from_ + (to_ - from_) * std::min(1.0, static_cast<double>(done_.load()) / whole);
        const bool go_on = stopped_.load() || progress_(info);
        if (!go_on) stopped_.store(true);
        asking_.clear(std::memory_order_release);
        return !stopped_.load();
    }
    /// Reports that this share of the range of set_range() is done. From any thread.
    void add(double share) noexcept { done_ += static_cast<std::int64_t>(share * whole); }
    [[nodiscard]] bool stopped() const noexcept { return stopped_.load(); }  ///< whether the work was cancelled; from any thread

  private:
    /// The value of done_ for a whole range. An integer: a sum of integers is the same in any order.
    static constexpr double whole = 1e15;
    Progress progress_;
    double samples_, peak_;
    ProgressInfo info_;
    double from_ = 0, to_ = 0;
    int iterations_ = 0;  ///< of the current stage
    double residual_ = 0;
    std::atomic<std::int64_t> done_{0};
    std::atomic<bool> stopped_{false};
    std::atomic_flag asking_ = ATOMIC_FLAG_INIT;
    std::vector<StageReport> stages_;
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
    bool keep_going() { return (++beats_ & 255U) != 0 ? !reporter_->stopped() : reporter_->poll(); }
    /// Reports that this fraction of the task is done, in [0, 1]. It never falls.
    void set_fraction(double fraction) noexcept {
        if (!(fraction > reached_)) return;
        reporter_->add(share_ * (std::min(1.0, fraction) - reached_));
        reached_ = std::min(1.0, fraction);
    }
    [[nodiscard]] bool stopped() const noexcept { return reporter_->stopped(); }  ///< whether the work was cancelled

  private:
    ProgressReporter* reporter_;
    double share_, reached_ = 0;
    unsigned beats_ = 0;
};

}  // namespace kit
}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_CORE_PROGRESS_HPP
