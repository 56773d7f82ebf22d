#include "results/mesh_file.hpp"

#include "hmesh/io/compact/photographs.hpp"

namespace tool {

hmesh::CompactMesh read_mesh_file(const std::vector<unsigned char>& bytes) {
    hmesh::CompactLimits limits;
    limits.max_vertices = 1 << 24;
    return hmesh::read_compact(bytes.data(), bytes.size(), limits, &hmesh::compact_photographs);
}

hmesh::CompactColors compact_colors(int bits) noexcept {
    return bits == 8 ? hmesh::CompactColors::bits8 : bits == 16 ? hmesh::CompactColors::bits16 : hmesh::CompactColors::floats;
}

}  // namespace tool
