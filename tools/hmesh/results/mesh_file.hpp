// tools - compact files as meshes.
#ifndef HMESH_TOOLS_RESULTS_MESH_FILE_HPP
#define HMESH_TOOLS_RESULTS_MESH_FILE_HPP

#include <vector>

#include "hmesh/io/compact.hpp"

namespace tool {

// The mesh of a compact file of up to 2^24 vertices, with or without the start table.
[[nodiscard]] hmesh::CompactMesh read_mesh_file(const std::vector<unsigned char>& bytes);

// How a compact file holds colours of an image of so many bits a sample: as they are.
[[nodiscard]] hmesh::CompactColors compact_colors(int bits) noexcept;

}  // namespace tool

#endif  // HMESH_TOOLS_RESULTS_MESH_FILE_HPP
