/// \file
/// Progress: how long work reports where it is, and is told to stop.
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

/// Where the work is: the stage's name (static), how much of it is done in [0, 1], and the mesh reached so far.
struct ProgressInfo {
    const char* stage = "";
    double fraction = 0;
    std::size_t vertices = 0;
    double energy = 0;  ///< sum of squared differences over pixels and channels; 0 before there is a mesh
};

/// The progress callback: true to go on, false to cancel, and then the last valid mesh comes back with Errc::cancelled. Called
/// with fraction 0 when a stage begins, 1 when it ends, and every few milliseconds of work in between where vertices and edges
/// are worked on, from the threads that do the work but never from two at a time (calls are ordered as by a lock). Silent are
/// parts that pass over all pixels once, some 0.2 s a megapixel at most, and the putting together of a mesh, some 0.8 us a
/// vertex. Refers to a callable that must outlive the work: keep a lambda in a variable of its own.
using Progress = FunctionRef<bool(const ProgressInfo& info)>;

/// What a stage left behind.
struct StageReport {
    const char* name = "";
    std::size_t vertices = 0;
    double energy = 0;
    double psnr = 0;  ///< dB, see core/psnr.hpp
    /// Of stages that solve linear systems for a result of their own: iterations, and the largest residual relative to its
    /// right-hand side.
    int iterations = 0;
    double residual = 0;
};

namespace kit {

/// Carries a Progress through the stages of a method and notes what each stage left.
class ProgressReporter {
  public:
    /// `samples`: pixels times channels.
    ProgressReporter(const Progress& progress, double samples, double peak)
        : progress_(progress), samples_(samples), peak_(peak) {}

    /// begin, update, set_range and end are called between pieces of work. Those that return something tell whether to go on;
    /// once told to stop it stays so. A stage begins: `stage` is a static name, the mesh has so many vertices and this energy.
    bool begin(const char* stage, std::size_t vertices, double energy) {
        info_.stage = stage;
        iterations_ = 0;
        residual_ = 0;
        return update(0, vertices, energy);
    }
    /// Within a stage: this fraction of it is done, in [0, 1].
    bool update(double fraction, std::size_t vertices, double energy) {
        set_range(fraction, fraction);
        info_.vertices = vertices;
        info_.energy = std::max(0.0, energy);  // rounding may leave less than nothing
        return poll();
    }
    /// The pieces of work that come next take the stage from fraction `from` to `to`.
    void set_range(double from, double to) noexcept {
        from_ = std::max(0.0, std::min(1.0, from));
        to_ = std::max(0.0, std::min(1.0, to));
        done_ = 0;
    }
    /// The stage ends, and its report is noted with what the mesh is now.
    bool end(std::size_t vertices, double energy) {
        energy = std::max(0.0, energy);
        stages_.push_back({info_.stage, vertices, energy, psnr_of_energy(energy, samples_, peak_), iterations_, residual_});
        return update(1, vertices, energy);
    }
    /// Within a stage, by one piece of work at a time: a system was solved.
    void note_solve(int iterations, double residual) noexcept {
        iterations_ += iterations;
        residual_ = std::max(residual_, residual);
    }
    [[nodiscard]] const std::vector<StageReport>& stages() const noexcept { return stages_; }

    /// From any thread: whether to go on, asking the callback unless another thread is doing so.
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
    /// From any thread: this share of the pieces expected is done.
    void add(double share) noexcept { done_ += static_cast<std::int64_t>(share * whole); }
    [[nodiscard]] bool stopped() const noexcept { return stopped_.load(); }

  private:
    static constexpr double whole = 1e15;  ///< of done_: a sum of integers is the same in any order
    Progress progress_;
    double samples_, peak_;
    ProgressInfo info_;
    double from_ = 0, to_ = 0;
    int iterations_ = 0;  ///< of the stage at work
    double residual_ = 0;
    std::atomic<std::int64_t> done_{0};
    std::atomic<bool> stopped_{false};
    std::atomic_flag asking_ = ATOMIC_FLAG_INIT;
    std::vector<StageReport> stages_;
};

/// One piece of work among those that run at once, as a ProgressReporter sees it. Work beats it every few microseconds.
class TaskProgress {
  public:
    /// A piece that is `share` in [0, 1] of what the monitor expects.
    TaskProgress(ProgressReporter& monitor, double share) noexcept : monitor_(&monitor), share_(share) {}
    TaskProgress(const TaskProgress&) = delete;
    TaskProgress& operator=(const TaskProgress&) = delete;
    ~TaskProgress() { set_fraction(1); }

    /// Whether to go on. Every 256th call asks the callback, which is every few milliseconds.
    bool keep_going() { return (++beats_ & 255U) != 0 ? !monitor_->stopped() : monitor_->poll(); }
    /// This fraction of the piece is done. Never falls.
    void set_fraction(double fraction) noexcept {
        if (!(fraction > reached_)) return;
        monitor_->add(share_ * (std::min(1.0, fraction) - reached_));
        reached_ = std::min(1.0, fraction);
    }
    [[nodiscard]] bool stopped() const noexcept { return monitor_->stopped(); }

  private:
    ProgressReporter* monitor_;
    double share_, reached_ = 0;
    unsigned beats_ = 0;
};

}  // namespace kit
}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_CORE_PROGRESS_HPP
