// What a project might write that compiles with more warnings than hmesh's own, and takes hmesh's headers for its own: a call of
// mesh_image() by each recipe, a mesh drawn and written.
#include <hmesh/hmesh.hpp>
#include <hmesh/paper.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace {

template <class Recipe>
bool works(const hmesh::ImageView<std::uint8_t, 1>& image, const Recipe& recipe) {
    const hmesh::Result result = hmesh::mesh_image(image, {}, recipe);
    std::size_t bytes = 0;
    const auto sink = [&](const void*, std::size_t size) { return bytes += size, true; };
    return result.status && hmesh::render<1>(result.mesh.view()).status && hmesh::write_ply(result.mesh.view(), sink) &&
           bytes > 0;
}

}  // namespace

int main() {
    constexpr int side = 16;
    std::vector<std::uint8_t> samples;
    for (int k = 0; k < side * side; ++k) samples.push_back(static_cast<std::uint8_t>(k));
    const hmesh::ImageView<std::uint8_t, 1> image{samples.data(), side, side};
    return works(image, hmesh::Annealed{}) && works(image, hmesh::Hierarchical{}) && works(image, hmesh::Xie{}) &&
                   works(image, hmesh::Adams{}) && works(image, hmesh::AdaptiveThinning{})
               ? 0
               : 1;
}
