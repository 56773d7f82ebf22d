// hmesh-terrain - a mesh of heights as the bytes of a file, in the format that the arguments ask for.
#ifndef HMESH_TERRAIN_MODEL_FILE_HPP
#define HMESH_TERRAIN_MODEL_FILE_HPP

#include <vector>

#include "hmesh/core/status.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "terrain/arguments.hpp"
#include "terrain/dem.hpp"
#include "terrain/frame.hpp"
#include "terrain/tiles.hpp"

namespace terrain {

// The heights that the 15 bits of quantized-mesh span, in those of the file; the same twice: those of each mesh.
struct HeightRange {
    double low = 0, high = 0;
};

[[nodiscard]] hmesh::Status write_model(const Arguments& arguments, const Dem& dem, const Frame& frame, const HeightRange& range,
                                        const Tile& tile, const Window& window, const hmesh::MeshView& mesh,
                                        std::vector<unsigned char>& bytes);

}  // namespace terrain

#endif  // HMESH_TERRAIN_MODEL_FILE_HPP
