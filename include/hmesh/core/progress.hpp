// hmesh - Progress: how long work reports where it is, and is told to stop.
#ifndef HMESH_CORE_PROGRESS_HPP
#define HMESH_CORE_PROGRESS_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace hmesh {

// Where the work is: the stage's name (static), how much of it is done in [0, 1], and the mesh reached so far.
struct StageInfo {
    const char* stage = "";
    double fraction = 0;
    std::size_t vertices = 0;
    double energy = 0;  // sum of squared differences over pixels and channels; 0 before there is a mesh
};

// A callback and the pointer handed to it. Called on the calling thread, at least with fraction 0 when a stage begins and
// 1 when it ends. Returning false cancels: the last valid mesh comes back with Errc::cancelled.
struct Progress {
    bool (*call)(void* user, const StageInfo& info) = nullptr;
    void* user = nullptr;
};

// What a stage left behind.
struct StageReport {
    const char* name = "";
    std::size_t vertices = 0;
    double energy = 0;
    double psnr = 0;  // dB, see psnr_of_energy
};

// 10 log10(peak^2 / MSE), MSE = energy / samples the mean over pixels AND channels. Infinity for energy 0.
[[nodiscard]] inline double psnr_of_energy(double energy, double samples, double peak) noexcept {
    if (!(energy > 0)) return std::numeric_limits<double>::infinity();
    return 10 * std::log10(peak * peak * samples / energy);
}

// Carries a Progress through the stages of a method and notes what each stage left.
class Monitor {
  public:
    // `samples`: pixels times channels.
    Monitor(const Progress& progress, double samples, double peak) : progress_(progress), samples_(samples), peak_(peak) {}

    // Each returns whether to go on; once told to stop it stays so.
    bool begin(const char* stage, std::size_t vertices, double energy) {
        stage_ = stage;
        return update(0, vertices, energy);
    }
    bool update(double fraction, std::size_t vertices, double energy) {
        if (stopped_) return false;
        const StageInfo info{stage_, std::max(0.0, std::min(1.0, fraction)), vertices, energy};
        if (progress_.call != nullptr && !progress_.call(progress_.user, info)) stopped_ = true;
        return !stopped_;
    }
    bool end(std::size_t vertices, double energy) {
        energy = std::max(0.0, energy);  // rounding may leave less than nothing
        stages_.push_back({stage_, vertices, energy, psnr_of_energy(energy, samples_, peak_)});
        return update(1, vertices, energy);
    }
    [[nodiscard]] bool stopped() const noexcept { return stopped_; }
    [[nodiscard]] const std::vector<StageReport>& stages() const noexcept { return stages_; }

  private:
    Progress progress_;
    double samples_, peak_;
    const char* stage_ = "";
    bool stopped_ = false;
    std::vector<StageReport> stages_;
};

}  // namespace hmesh

#endif  // HMESH_CORE_PROGRESS_HPP
