// hmesh-terrain - from heights to a mesh: all that the command asks of hmesh::mesh_image(), a file for each method.
#ifndef HMESH_TERRAIN_MESHING_HPP
#define HMESH_TERRAIN_MESHING_HPP

#include "hmesh/core/parallel.hpp"
#include "hmesh/core/progress.hpp"
#include "hmesh/result.hpp"
#include "terrain/arguments.hpp"
#include "terrain/tiles.hpp"

namespace terrain {

// A bound, in heights of the file, what is asked of which samples, and how much is done for having few triangles.
struct Within {
    double bound;   // of all
    double inside;  // of those that are not along the tile's sides
    double border;  // of the others
    Effort effort;
};

// As few triangles as the effort finds within the bound.
[[nodiscard]] hmesh::Result mesh_within(const Arguments& arguments, const Window& window, const Within& within,
                                        hmesh::Progress progress, const hmesh::ParallelFor& parallel_for);

// The least squared error with as many vertices as the arguments say, or as a last tile has samples: of a window whose samples
// all have data.
[[nodiscard]] hmesh::Result mesh_with_vertices(const Arguments& arguments, const Window& window, hmesh::Progress progress,
                                               const hmesh::ParallelFor& parallel_for);

}  // namespace terrain

#endif  // HMESH_TERRAIN_MESHING_HPP
