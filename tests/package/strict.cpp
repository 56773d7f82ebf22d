// What a project might write that compiles with more warnings than hmesh's own, and takes hmesh's headers for its own.
#include <hmesh/hmesh.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

int main() {
    constexpr int side = 16;
    std::vector<std::uint8_t> samples;
    for (int k = 0; k < side * side; ++k) samples.push_back(static_cast<std::uint8_t>(k));
    const hmesh::ImageView<std::uint8_t, 1> image{samples.data(), side, side};
    const auto result = hmesh::mesh_image(image);
    std::size_t bytes = 0;
    const auto sink = [&](const void*, std::size_t size) { return bytes += size, true; };
    return result.status && hmesh::write_ply(result.mesh.view(), sink) && bytes > 0 ? 0 : 1;
}
