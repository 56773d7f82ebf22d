// hmesh - Progress: how long work reports where it is, and is told to stop.
#ifndef HMESH_CORE_PROGRESS_HPP
#define HMESH_CORE_PROGRESS_HPP

#include <cstddef>

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

    [[nodiscard]] bool operator()(const StageInfo& info) const { return call == nullptr || call(user, info); }
};

}  // namespace hmesh

#endif  // HMESH_CORE_PROGRESS_HPP
