// tools - ProgressWatch: the progress callback of the command. Times the stages, draws a bar on a terminal, and
// passes on Ctrl-C. The library has no clock; the seconds in the report come from here.
#ifndef HMESH_TOOLS_PROGRESS_WATCH_HPP
#define HMESH_TOOLS_PROGRESS_WATCH_HPP

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "hmesh/core/progress.hpp"

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

    explicit ProgressWatch(bool draws) : draws_(draws) {}
    ProgressWatch(const ProgressWatch&) = delete;
    ProgressWatch& operator=(const ProgressWatch&) = delete;

    // The callback.
    bool operator()(const hmesh::ProgressInfo& info) { return update(info); }

    // Ends the last stage and wipes the bar.
    void finish() {
        end_stage(Clock::now());
        if (drawn_ > 0) std::fprintf(stderr, "\r%*s\r", drawn_, "");
        drawn_ = 0;
    }

    // Wall-clock seconds since the watch was made.
    [[nodiscard]] double seconds() const { return seconds_between(begin_, Clock::now()); }

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
        const bool is_new = stages_.empty() || std::strcmp(stages_.back().last.stage, info.stage) != 0 ||
                            (stages_.back().last.fraction >= 1 && info.fraction < 1);
        if (is_new) {
            end_stage(now);
            stages_.push_back({info, 0});
            stage_begin_ = now;
        }
        stages_.back().last = info;
        // Calls come every few milliseconds, and a terminal is slow.
        if (draws_ && (drawn_ == 0 || seconds_between(last_draw_, now) > 0.1)) draw(info, now);
        return !interrupted;
    }

    void end_stage(Clock::time_point now) {
        if (!stages_.empty()) stages_.back().seconds = seconds_between(stage_begin_, now);
    }

    void draw(const hmesh::ProgressInfo& info, Clock::time_point now) {
        constexpr int length = 30;
        const int done = info.fraction > 0 ? static_cast<int>(length * (info.fraction < 1 ? info.fraction : 1)) : 0;
        const std::string bar =
            std::string(static_cast<std::size_t>(done), '#') + std::string(static_cast<std::size_t>(length - done), '.');
        const int written = std::fprintf(stderr, "\r[%s] %3d %% %.24s, %zu vertices", bar.c_str(), done * 100 / length,
                                         info.stage, info.vertices) -
                            1;
        if (written < drawn_) std::fprintf(stderr, "%*s", drawn_ - written, "");
        if (written > drawn_) drawn_ = written;
        std::fflush(stderr);
        last_draw_ = now;
    }

    Clock::time_point begin_ = Clock::now(), stage_begin_ = begin_, last_draw_ = begin_;
    std::vector<Stage> stages_;
    int drawn_ = 0;  // the widest line drawn, in characters
    bool draws_;
};

}  // namespace tool

#endif  // HMESH_TOOLS_PROGRESS_WATCH_HPP
