// What the calls that make a mesh of an image share.
#ifndef HMESH_BINDING_CALLS_HPP
#define HMESH_BINDING_CALLS_HPP

#include <cstdint>

#include "hmesh/core/progress.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/methods/annealed/options.hpp"
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

inline hmesh::Annealed recipe_of(int effort, double seed) {
    hmesh::Annealed recipe;
    recipe.effort = static_cast<hmesh::Effort>(effort);
    recipe.seed = static_cast<std::uint64_t>(seed);
    return recipe;
}

// Calls body() with the view of an image of 3 or 4 channels.
template <class Body>
auto with_view(const std::uint8_t* pixels, int width, int height, int channels, Body&& body) {
    if (channels == 3) return body(hmesh::ImageView<std::uint8_t, 3>{pixels, width, height});
    return body(hmesh::ImageView<std::uint8_t, 4>{pixels, width, height});
}

}  // namespace binding

#endif  // HMESH_BINDING_CALLS_HPP
