// What a project might write that compiles with more warnings than hmesh's own, and takes hmesh's headers for its own: a call of
// mesh_image() by each recipe, a mesh drawn and written, and a call of each of the other umbrellas.
#include <hmesh/compact.hpp>
#include <hmesh/gpu.hpp>
#include <hmesh/hmesh.hpp>
#include <hmesh/large.hpp>
#include <hmesh/lods.hpp>
#include <hmesh/paper.hpp>
#include <hmesh/terrain.hpp>

#include <algorithm>
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
    const auto read = [&](const hmesh::kit::Rect& rect, std::uint8_t* to, std::ptrdiff_t row_stride) {
        for (int y = 0; y < rect.height; ++y) std::copy_n(image.pixel(rect.x, rect.y + y), rect.width, to + y * row_stride);
        return true;
    };
    const hmesh::ImageReader<std::uint8_t, 1> reader{side, side, read, false};
    const hmesh::ImageView<std::uint8_t, 4> sprite{samples.data(), side / 2, side / 2};
    if (!hmesh::mesh_image(reader).status || !hmesh::mesh_lods(image, {}, {}).status || !hmesh::outline(sprite).status ||
        !hmesh::compact_image(image).status)
        return 1;
    return works(image, hmesh::Annealed{}) && works(image, hmesh::Bounded{}) && works(image, hmesh::Hierarchical{}) &&
                   works(image, hmesh::Xie{}) && works(image, hmesh::Adams{}) && works(image, hmesh::AdaptiveThinning{})
               ? 0
               : 1;
}
