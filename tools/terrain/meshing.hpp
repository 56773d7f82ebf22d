// hmesh-terrain - from heights to a mesh: all that the command asks of hmesh::mesh_image().
#ifndef HMESH_TERRAIN_MESHING_HPP
#define HMESH_TERRAIN_MESHING_HPP

#include "hmesh/core/parallel.hpp"
#include "hmesh/core/progress.hpp"
#include "hmesh/result.hpp"
#include "terrain/arguments.hpp"
#include "terrain/tiles.hpp"

namespace terrain {

// Within the bound, in heights of the file; or as many vertices as the arguments say where they ask for that.
[[nodiscard]] hmesh::Result mesh_window(const Arguments& arguments, const Window& window, double bound, hmesh::Progress progress,
                                        const hmesh::ParallelFor& parallel_for);

}  // namespace terrain

#endif  // HMESH_TERRAIN_MESHING_HPP
