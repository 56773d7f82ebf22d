// hmesh tests - color_at(): the colour of a mesh at a sample that is a point, told without the library's geometry: in whole
// numbers of 1/256 px, and by a search through all faces.
#ifndef HMESH_TESTS_POINT_COLORS_HPP
#define HMESH_TESTS_POINT_COLORS_HPP

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "grid_point.hpp"
#include "hmesh/mesh/mesh.hpp"

namespace hmesh_test {

// The colour of the mesh at sample (i, j): that of any face which holds it, since they agree on their edges. NaN: none does.
inline std::vector<double> color_at(const hmesh::Mesh& mesh, int i, int j) {
    const auto channels = static_cast<std::size_t>(mesh.channels);
    const auto corner = [&](std::size_t v) {
        return on_grid({static_cast<double>(mesh.positions[2 * v]), static_cast<double>(mesh.positions[2 * v + 1])});
    };
    const GridPoint p{256 * std::int64_t{i}, 256 * std::int64_t{j}};
    for (const hmesh::Triangle& face : mesh.faces) {
        const GridPoint a = corner(face[0]), b = corner(face[1]), c = corner(face[2]);
        const std::int64_t at_a = double_area(p, b, c), at_b = double_area(a, p, c), at_c = double_area(a, b, p);
        if (at_a < 0 || at_b < 0 || at_c < 0) continue;
        std::vector<double> color(channels);
        for (std::size_t k = 0; k < channels; ++k) {
            const auto of = [&](std::size_t n) { return static_cast<double>(mesh.colors[channels * face[n] + k]); };
            color[k] =
                (static_cast<double>(at_a) * of(0) + static_cast<double>(at_b) * of(1) + static_cast<double>(at_c) * of(2)) /
                static_cast<double>(double_area(a, b, c));
        }
        return color;
    }
    return std::vector<double>(channels, std::numeric_limits<double>::quiet_NaN());
}

}  // namespace hmesh_test

#endif  // HMESH_TESTS_POINT_COLORS_HPP
