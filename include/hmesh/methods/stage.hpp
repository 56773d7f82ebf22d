/// \file
/// Stages: what recipes are made of, as far as progress and reports go.
#ifndef HMESH_METHODS_STAGE_HPP
#define HMESH_METHODS_STAGE_HPP

#include <algorithm>

#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/tiles/tiled_mesh.hpp"
#include "hmesh/tiles/tiling.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// The status of work that the progress callback stopped.
[[nodiscard]] inline Status cancelled_by_callback() noexcept { return {Errc::cancelled, "cancelled by the progress callback"}; }
/// The status of work that says whether it was finished.
[[nodiscard]] inline Status finished_or_cancelled(bool is_finished) noexcept {
    return is_finished ? Status() : cancelled_by_callback();
}

/// Runs body(), which says whether to go on, as a stage of this static name. Returns whether to go on.
template <int C>
bool run_stage(TiledMesh<C>& tiled, const char* name, FunctionRef<bool()> body) {
    return tiled.progress().begin(name, tiled.vertex_count(), tiled.energy()) && body() &&
           tiled.progress().end(tiled.vertex_count(), tiled.energy());
}

/// The whole image as one tile: how the paper's methods work.
template <int C>
[[nodiscard]] Tiling one_tile(const ImageSource<C>& source) {
    return Tiling(source.width(), source.height(), std::max(source.width(), source.height()));
}

/// A stage of body(mesh) on the whole mesh at once. Returns whether to go on.
template <int C>
bool run_whole_stage(TiledMesh<C>& tiled, const char* name, typename TiledMesh<C>::MeshWork body) {
    return run_stage(tiled, name, [&] {
        tiled.progress().set_range(0, 1);
        return tiled.for_each(one_tile(tiled.source()), [&](Patch<C>& patch, std::size_t) { body(patch.mesh()); });
    });
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_STAGE_HPP
