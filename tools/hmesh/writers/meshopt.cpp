// The only file that compiles meshoptimizer.
#include "writers/meshopt.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "hmesh/gpu.hpp"

#ifdef HMESH_HAS_MESHOPT
#include <meshoptimizer.h>
#endif

namespace tool {

#ifdef HMESH_HAS_MESHOPT

std::string gltf_compressor() {
    return "meshoptimizer " + std::to_string(MESHOPTIMIZER_VERSION / 1000) + "." +
           std::to_string(MESHOPTIMIZER_VERSION / 10 % 100);
}

bool compress_gltf(const hmesh::GltfArray& array, std::vector<unsigned char>& out) {
    if (!array.is_indices) {
        meshopt_encodeVertexVersion(0);
        out.resize(meshopt_encodeVertexBufferBound(array.count, array.stride));
        out.resize(meshopt_encodeVertexBuffer(out.data(), out.size(), array.bytes, array.count, array.stride));
        return !out.empty();
    }
    std::vector<unsigned int> indices(array.count, 0);
    unsigned int most = 0;
    for (std::size_t i = 0; i < array.count; ++i) {
        for (std::size_t k = array.stride; k-- > 0;) indices[i] = indices[i] << 8U | array.bytes[array.stride * i + k];
        most = std::max(most, indices[i]);
    }
    meshopt_encodeIndexVersion(1);
    out.resize(meshopt_encodeIndexBufferBound(array.count, std::size_t{most} + 1));
    out.resize(meshopt_encodeIndexBuffer(out.data(), out.size(), indices.data(), indices.size()));
    return !out.empty();
}

hmesh::Status order_to_compress(hmesh::Mesh& mesh) {
    if (hmesh::Status status = order_for_gpu(mesh); !status) return status;  // drops what is to be dropped
    const std::size_t corners = 3 * mesh.face_count(), vertices = mesh.vertex_count();
    std::vector<unsigned int> indices;
    indices.reserve(corners);
    for (const hmesh::Triangle& face : mesh.faces) indices.insert(indices.end(), {face[0], face[2], face[1]});  // as in the file
    meshopt_optimizeVertexCacheStrip(indices.data(), indices.data(), corners, vertices);
    std::vector<unsigned int> slots(vertices);
    meshopt_optimizeVertexFetchRemap(slots.data(), indices.data(), corners, vertices);
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
        mesh.faces[f] = {slots[indices[3 * f]], slots[indices[3 * f + 2]], slots[indices[3 * f + 1]]};
    meshopt_remapVertexBuffer(mesh.positions.data(), mesh.positions.data(), vertices, 2 * sizeof(float), slots.data());
    meshopt_remapVertexBuffer(mesh.colors.data(), mesh.colors.data(), vertices,
                              static_cast<std::size_t>(mesh.channels) * sizeof(float), slots.data());
    return {};
}

#else

std::string gltf_compressor() { return {}; }
bool compress_gltf(const hmesh::GltfArray&, std::vector<unsigned char>&) { return false; }
hmesh::Status order_to_compress(hmesh::Mesh& mesh) { return order_for_gpu(mesh); }

#endif

}  // namespace tool
