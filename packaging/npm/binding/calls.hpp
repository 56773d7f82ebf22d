// How JavaScript hears of progress.
#ifndef HMESH_BINDING_PROGRESS_HPP
#define HMESH_BINDING_PROGRESS_HPP

#include "hmesh/core/progress.hpp"
#include "module.hpp"

// Told of progress: returns 0 to stop, 1 to go on, and 2 to go on after show() where there `is_mesh`. `stage` ends with a zero.
HMESH_IMPORT(progress)
int hmesh_progress(const char* stage, double fraction, double total, double vertices, double energy, int is_mesh);

namespace binding {

// What JavaScript answers.
inline int tell(const hmesh::ProgressInfo& info) {
    return hmesh_progress(info.stage, info.fraction, info.total, static_cast<double>(info.vertices), info.energy,
                          bool{info.mesh_so_far});
}

}  // namespace binding

#endif  // HMESH_BINDING_PROGRESS_HPP
