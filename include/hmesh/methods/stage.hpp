// hmesh - stages: what all methods are made of, as far as progress and reports go.
#ifndef HMESH_METHODS_STAGE_HPP
#define HMESH_METHODS_STAGE_HPP

#include <algorithm>
#include <cstddef>

#include "hmesh/core/status.hpp"
#include "hmesh/tiles/tiled_mesh.hpp"
#include "hmesh/tiles/tiling.hpp"

namespace hmesh::kit {

// The status of work that the progress callback stopped.
[[nodiscard]] inline Status cancelled_by_callback() noexcept {
    return {Errc::cancelled, "cancelled by the progress callback", 0, 0};
}

namespace detail {

// Runs body(), which says whether to go on, as a stage of this name. Returns whether to go on.
template <int C, class Body>
bool stage(TiledMesh<C>& work, const char* name, Body&& body) {
    return work.monitor().begin(name, work.vertex_count(), work.energy()) && body() &&
           work.monitor().end(work.vertex_count(), work.energy());
}

// The whole image as one tile: how the paper's methods work.
template <int C>
[[nodiscard]] Tiling one_tile(const ImageSource<C>& source) {
    return Tiling(source.width(), source.height(), std::max(source.width(), source.height()));
}

// A stage of work(mesh) on the whole mesh at once.
template <int C, class Work>
bool whole_stage(TiledMesh<C>& work, const char* name, Work&& body) {
    return stage(work, name, [&] {
        work.monitor().set_range(0, 1);
        return work.for_each(one_tile(work.source()), [&](Patch<C>& patch, std::size_t) { body(patch.mesh()); });
    });
}

}  // namespace detail
}  // namespace hmesh::kit

#endif  // HMESH_METHODS_STAGE_HPP
