// tools - ProgressWatch: the progress of the command, from reading to writing. Times the stages, draws one bar on a terminal, and
// passes on Ctrl-C. The library has no clock; the seconds in the report come from here.
#ifndef HMESH_TOOLS_TERMINAL_PROGRESS_WATCH_HPP
#define HMESH_TOOLS_TERMINAL_PROGRESS_WATCH_HPP

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <vector>

#include "hmesh/core/progress.hpp"
#include "terminal/progress_bar.hpp"

namespace tool {

// Set by a signal handler and read on any thread: hence atomic, and without a lock.
inline std::atomic<bool> interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler must not wait for a lock");

// From now on Ctrl-C sets `interrupted`, and so do a request to end and the end of the terminal; a second one ends the program at
// once. What was ignored, as nohup wants it, stays so.
inline void catch_interrupt() {
    const auto note = [](int signal) {
        interrupted = true;
        std::signal(signal, SIG_DFL);
    };
    for (const int signal : {
             SIGINT,
             SIGTERM,
#ifdef SIGHUP
             SIGHUP,
#endif
         })
        if (std::signal(signal, note) == SIG_IGN) std::signal(signal, SIG_IGN);
}

// Takes calls from any thread, one at a time, each after the one before it, as the library makes them: has no lock.
class ProgressWatch {
  public:
    struct Stage {
        hmesh::ProgressInfo last;  // what the callback said last
        double seconds;
    };

    explicit ProgressWatch(bool draws) : draws_(draws) { show("reading", 0); }
    ~ProgressWatch() {
        if (draws_) wipe_bar();
    }
    ProgressWatch(const ProgressWatch&) = delete;
    ProgressWatch& operator=(const ProgressWatch&) = delete;

    // The image is read; the seconds of the mesh begin. What takes how long is estimated, in any unit.
    void begin_mesh(double reading, double meshing, double writing) {
        const double sum = reading + meshing + writing;
        mesh_from_ = reading / sum;
        mesh_to_ = (reading + meshing) / sum;
        unit_ = 1 / sum;
        mesh_begin_ = Clock::now();
    }

    // After the mesh: what is done next, and its part of the writing.
    void step(const char* name, double work) {
        fraction_ = std::max(fraction_, mesh_to_) + next_;
        next_ = work * unit_;
        show(name, 0);
    }

    // The callback.
    bool operator()(const hmesh::ProgressInfo& info) { return update(info); }

    // The mesh is there, or there will be none: ends the last stage.
    void end_mesh() { end_stage(Clock::now()); }

    // Shows 100 %, then wipes the bar.
    void finish() {
        fraction_ = 1;
        show("done", 0);
        if (draws_) wipe_bar();
        draws_ = false;
    }

    // Wall-clock seconds since the image was read.
    [[nodiscard]] double seconds() const { return seconds_between(mesh_begin_, Clock::now()); }

    // The seconds of the stage that left this behind, or -1 when the callback never saw it. A search runs every stage
    // many times.
    [[nodiscard]] double seconds_of(const hmesh::StageReport& stage) const {
        for (auto it = stages_.rbegin(); it != stages_.rend(); ++it)
            if (std::strcmp(it->last.stage, stage.name) == 0 && it->last.vertices == stage.vertices &&
                !(it->last.energy < stage.energy) && !(it->last.energy > stage.energy))
                return it->seconds;
        return -1;
    }

  private:
    using Clock = std::chrono::steady_clock;

    [[nodiscard]] static double seconds_between(Clock::time_point a, Clock::time_point b) {
        return std::chrono::duration<double>(b - a).count();
    }

    bool update(const hmesh::ProgressInfo& info) {
        const Clock::time_point now = Clock::now();
        // The last word of a search comes after the end of a stage that has been told already.
        const bool is_over = !stages_.empty() && stages_.back().last.fraction >= 1 && info.fraction >= 1 &&
                             std::strcmp(stages_.back().last.stage, info.stage) == 0;
        const bool is_new = stages_.empty() || std::strcmp(stages_.back().last.stage, info.stage) != 0 ||
                            (stages_.back().last.fraction >= 1 && info.fraction < 1);
        if (is_new) {
            end_stage(now);
            stages_.push_back({info, 0});
            stage_begin_ = now;
        }
        if (!is_over) stages_.back().last = info;
        fraction_ = std::max(fraction_, mesh_from_ + (mesh_to_ - mesh_from_) * info.total);
        vertices_ = info.vertices;
        show(info.stage, 0.1);
        return !interrupted;
    }

    void end_stage(Clock::time_point now) {
        if (!stages_.empty()) stages_.back().seconds = seconds_between(stage_begin_, now);
    }

    // Draws the bar unless that was done less than `pause` seconds ago: calls come every few milliseconds, a terminal is slow.
    void show(const char* stage, double pause) {
        const Clock::time_point now = Clock::now();
        if (!draws_ || seconds_between(last_draw_, now) < pause) return;
        last_draw_ = now;
        draw_bar({fraction_, seconds_left(seconds_between(begin_, now)), stage, vertices_});
    }

    // From the mean of what the latest draws said of the whole time; -1 while they say little.
    [[nodiscard]] double seconds_left(double seconds) {
        if (fraction_ < 0.02 || seconds < 0.5 || fraction_ >= 1) return -1;
        const double whole = seconds / fraction_;
        whole_ = whole_ > 0 ? whole_ + 0.15 * (whole - whole_) : whole;
        return seconds >= 1 ? std::max(0.0, whole_ - seconds) : -1;
    }

    Clock::time_point begin_ = Clock::now(), mesh_begin_ = begin_, stage_begin_ = begin_, last_draw_ = begin_;
    std::vector<Stage> stages_;
    double mesh_from_ = 0, mesh_to_ = 1, unit_ = 0;  // of the whole run
    double fraction_ = 0, next_ = 0;                 // reached; what the step that goes on adds
    double whole_ = 0;                               // seconds that the run takes, as estimated; 0: not yet
    std::size_t vertices_ = 0;
    bool draws_;
};

}  // namespace tool

#endif  // HMESH_TOOLS_TERMINAL_PROGRESS_WATCH_HPP
