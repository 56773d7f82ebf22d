// Fuzzes pack_for_gpu(). What a GPU draws of the buffers has to be the mesh's faces, each once and turned as it was.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "fuzz_exports.hpp"
#include "fuzz_input.hpp"
#include "hmesh/io/gpu.hpp"

namespace {

using hmesh_test::demand;
// The bits of both coordinates of each corner, turned to the least of the three that are one face.
using Face = std::array<std::array<std::uint32_t, 2>, 3>;

std::uint32_t number_at(const std::vector<std::uint8_t>& bytes, std::size_t at, std::uint32_t size) {
    std::uint32_t value = 0;
    for (std::uint32_t i = 0; i < size; ++i) value |= std::uint32_t{bytes.at(at + i)} << (8 * i);
    return value;
}

void add(std::vector<Face>& faces, Face face) {
    Face least = face;  // corners may lie on one another
    for (int i = 0; i < 2; ++i) {
        std::rotate(face.begin(), face.begin() + 1, face.end());
        least = std::min(least, face);
    }
    faces.push_back(least);
}

std::vector<Face> faces_of(const hmesh::MeshView& mesh) {
    std::vector<Face> faces;
    for (std::size_t f = 0; f < mesh.face_count; ++f) {
        const hmesh::Triangle& corners = mesh.faces[f];
        if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
        Face face{};
        for (std::size_t k = 0; k < 3; ++k) std::memcpy(face[k].data(), mesh.positions + 2 * std::size_t{corners[k]}, 8);
        add(faces, face);
    }
    return faces;
}

// The faces that are drawn. Checks what GpuChunk says of the indices.
std::vector<Face> drawn(const hmesh::GpuBuffers& buffers) {
    const hmesh::GpuLayout& layout = buffers.layout;
    const bool is_strip = layout.topology == hmesh::GpuTopology::triangle_strip;
    const std::uint32_t size = hmesh::size_of(layout.index);
    std::vector<Face> faces;
    std::size_t count = 0;
    for (const hmesh::GpuChunk& chunk : buffers.chunks) {
        demand(chunk.first_index == count, "chunks are one after another");
        count += chunk.index_count;
        demand(std::size_t{chunk.first_vertex} + chunk.vertex_count <= buffers.vertex_count(), "a window lies in the buffer");
        std::vector<std::uint32_t> strip;
        for (std::size_t i = 0; i < chunk.index_count; ++i) {
            const std::uint32_t index = number_at(buffers.indices, (chunk.first_index + i) * size, size);
            if (is_strip && index == layout.restart) {
                strip.clear();
                continue;
            }
            demand(index < chunk.vertex_count, "an index lies in the window");
            strip.push_back(chunk.first_vertex + index);
            const std::size_t n = strip.size();
            if (n < 3) continue;
            hmesh::Triangle corners{strip[n - 3], strip[n - 2], strip[n - 1]};
            if (!is_strip) strip.clear();
            else if (n % 2 == 0) std::swap(corners[0], corners[1]);
            if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
            Face face{};
            for (std::size_t k = 0; k < 3; ++k)
                for (std::uint32_t axis = 0; axis < 2; ++axis)
                    face[k][axis] = number_at(buffers.vertices, std::size_t{corners[k]} * layout.stride + 4 * axis,
                                              layout.position.format == hmesh::GpuFormat::float32x2 ? 4 : 0);
            add(faces, face);
        }
    }
    demand((count * size + 3) / 4 * 4 == buffers.indices.size(), "chunks are all that is in the index buffer");
    return faces;
}

hmesh::GpuOptions options_of(hmesh_test::FuzzInput& input) {
    using hmesh::GpuFormat;
    hmesh::GpuOptions options;
    options.position = input.one_of<GpuFormat>({GpuFormat::float32x2, GpuFormat::unorm16x2});
    options.color = input.one_of<GpuFormat>({GpuFormat::unorm8x4, GpuFormat::unorm16x4});
    options.topology = input.one_of<hmesh::GpuTopology>({hmesh::GpuTopology::triangle_list, hmesh::GpuTopology::triangle_strip});
    options.index = input.one_of<hmesh::GpuIndexFormat>({hmesh::GpuIndexFormat::uint16, hmesh::GpuIndexFormat::uint32});
    options.alpha = static_cast<hmesh::GpuAlpha>(input.within(0, 2));
    options.chunk_vertices = input.one_in(2) ? static_cast<std::uint32_t>(input.within(3, 30)) : 0;
    return options;
}

// Makes an option any number at all.
void spoil(hmesh_test::FuzzInput& input, hmesh::GpuOptions& options) {
    switch (input.within(0, 5)) {
        case 0: options.position = static_cast<hmesh::GpuFormat>(input.byte()); break;
        case 1: options.color = static_cast<hmesh::GpuFormat>(input.byte()); break;
        case 2: options.topology = static_cast<hmesh::GpuTopology>(input.byte()); break;
        case 3: options.index = static_cast<hmesh::GpuIndexFormat>(input.byte()); break;
        case 4: options.alpha = static_cast<hmesh::GpuAlpha>(input.byte()); break;
        default: options.chunk_vertices = input.bits<std::uint32_t>();
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    hmesh_test::FuzzInput input(bytes, size);
    hmesh::GpuOptions options = options_of(input);
    const bool is_spoiled = input.one_in(8);
    if (is_spoiled) spoil(input, options);
    const hmesh_test::FuzzMesh mesh = hmesh_test::FuzzMeshDraw(input).mesh();
    const hmesh::GpuBuffers buffers = hmesh::pack_for_gpu(mesh.view, options);
    demand(static_cast<bool>(buffers.status) == (*buffers.status.what == 0), "a status has a sentence if and only if it is bad");
    if (!buffers.status) {
        demand(buffers.vertices.empty() && buffers.indices.empty() && buffers.chunks.empty(), "what is refused has no buffers");
        demand(!mesh.is_good || is_spoiled, "a good mesh is packed");
        return 0;
    }
    std::vector<Face> got = drawn(buffers), wanted = faces_of(mesh.view);
    demand(got.size() == wanted.size(), "each face is drawn once");
    if (buffers.layout.position.format != hmesh::GpuFormat::float32x2) return 0;
    std::sort(got.begin(), got.end());
    std::sort(wanted.begin(), wanted.end());
    demand(got == wanted, "the faces drawn are the mesh's");
    return 0;
}
