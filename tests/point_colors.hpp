// hmesh tests - color_at(): the colour of a mesh at a sample that is a point, told without the library's geometry: in whole
// numbers of 1/256 px, and by a search through all faces.
#ifndef HMESH_TESTS_POINT_COLORS_HPP
#define HMESH_TESTS_POINT_COLORS_HPP

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "hmesh/mesh/mesh.hpp"

namespace hmesh_test {

namespace detail {

struct WholeCorner {
    std::int64_t x, y;
};

inline std::int64_t twice_area(WholeCorner a, WholeCorner b, WholeCorner c) {
    return (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
}

inline WholeCorner corner_of(const hmesh::Mesh& mesh, std::uint32_t v) {
    const auto units = [](float x) { return static_cast<std::int64_t>(std::llround(256 * static_cast<double>(x))); };
    return {units(mesh.positions[2 * std::size_t{v}]), units(mesh.positions[2 * std::size_t{v} + 1])};
}

}  // namespace detail

// The colour of the mesh at sample (i, j): that of any face which holds it, since they agree on their edges. NaN: none does.
inline std::vector<double> color_at(const hmesh::Mesh& mesh, int i, int j) {
    using detail::WholeCorner;
    const auto channels = static_cast<std::size_t>(mesh.channels);
    const WholeCorner p{256 * std::int64_t{i}, 256 * std::int64_t{j}};
    for (const hmesh::Triangle& face : mesh.faces) {
        const WholeCorner a = detail::corner_of(mesh, face[0]), b = detail::corner_of(mesh, face[1]),
                          c = detail::corner_of(mesh, face[2]);
        const std::int64_t at_a = detail::twice_area(p, b, c), at_b = detail::twice_area(a, p, c),
                           at_c = detail::twice_area(a, b, p);
        if (at_a < 0 || at_b < 0 || at_c < 0) continue;
        std::vector<double> color(channels);
        for (std::size_t k = 0; k < channels; ++k) {
            const auto of = [&](std::size_t n) { return static_cast<double>(mesh.colors[channels * face[n] + k]); };
            color[k] =
                (static_cast<double>(at_a) * of(0) + static_cast<double>(at_b) * of(1) + static_cast<double>(at_c) * of(2)) /
                static_cast<double>(detail::twice_area(a, b, c));
        }
        return color;
    }
    return std::vector<double>(channels, std::numeric_limits<double>::quiet_NaN());
}

}  // namespace hmesh_test

#endif  // HMESH_TESTS_POINT_COLORS_HPP
