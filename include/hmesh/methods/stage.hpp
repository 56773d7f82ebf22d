/// \file
/// Stages: the named steps of a recipe, which progress and reports tell of.
#ifndef HMESH_METHODS_STAGE_HPP
#define HMESH_METHODS_STAGE_HPP

#include <algorithm>

#include "hmesh/core/function_ref.hpp"
#include "hmesh/tiles/tiled_mesh.hpp"
#include "hmesh/tiles/tiling.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// Runs body() as a stage: tells progress of its begin and end, and adds its StageReport. `name` must be a static string; body()
/// returns whether to go on. Returns whether to go on; false: cancelled.
template <int C>
bool run_stage(TiledMesh<C>& tiled, const char* name, FunctionRef<bool()> body) {
    return tiled.progress().begin(name, tiled.vertex_count(), tiled.energy()) && body() &&
           tiled.progress().end(tiled.vertex_count(), tiled.energy(), tiled.mesh_so_far());
}

/// The tiling of one tile over the whole image, in which the paper's methods and the baselines work.
template <int C>
[[nodiscard]] Tiling one_tile(const ImageSource<C>& source) {
    return Tiling(source.width(), source.height(), std::max(source.width(), source.height()));
}

/// Runs body(mesh) as a stage on the whole mesh as one patch, on the calling thread; see run_stage(). Returns whether to go on.
template <int C>
bool run_one_tile_stage(TiledMesh<C>& tiled, const char* name, typename TiledMesh<C>::MeshWork body) {
    return run_stage(tiled, name, [&] {
        tiled.progress().set_range(0, 1);
        return tiled.for_each(one_tile(tiled.source()), [&](Patch<C>& patch, std::size_t) { body(patch.mesh()); });
    });
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_STAGE_HPP
