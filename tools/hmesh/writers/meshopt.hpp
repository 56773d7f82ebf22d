// tools - .glb files compressed by meshoptimizer, where the command is built with it.
#ifndef HMESH_TOOLS_WRITERS_MESHOPT_HPP
#define HMESH_TOOLS_WRITERS_MESHOPT_HPP

#include <string>
#include <vector>

#include "hmesh/core/status.hpp"
#include "hmesh/io/gltf.hpp"
#include "hmesh/mesh/mesh.hpp"

namespace tool {

// "meshoptimizer 0.18"; empty: there is none.
[[nodiscard]] std::string gltf_compressor();

// hmesh::GltfCompress by meshoptimizer.
[[nodiscard]] bool compress_gltf(const hmesh::GltfArray& array, std::vector<unsigned char>& out);

// Puts faces and vertices into the order that compresses best: a strip's, 0.2 to 0.4 bytes a vertex less than
// hmesh::order_for_gpu(), whose faces use the vertex cache better by a tenth. Refuses what that does.
[[nodiscard]] hmesh::Status order_to_compress(hmesh::Mesh& mesh);

}  // namespace tool

#endif  // HMESH_TOOLS_WRITERS_MESHOPT_HPP
