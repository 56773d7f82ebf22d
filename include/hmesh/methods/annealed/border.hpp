/// \file
/// Borders alone: the vertices on the sides of an image, those of each side from its row of samples and nothing else.
///
/// Images that share a row of samples, as tiles of a heightmap do (Samples::points), are then meshed each by itself, and their
/// meshes share the vertices of that row to the bit. Vertices stand on samples and have their values, so that the side is a
/// polyline; it has the fewest of them with which no sample of the row is off by more than a tolerance (polyline.hpp).
#ifndef HMESH_METHODS_ANNEALED_BORDER_HPP
#define HMESH_METHODS_ANNEALED_BORDER_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "hmesh/core/array.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/fit/image_source.hpp"
#include "hmesh/fit/squared_error.hpp"
#include "hmesh/mesh/geometry.hpp"
#include "hmesh/methods/annealed/polyline.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// The vertices on the sides of an image of points, in the plane where it is fitted (mesh/samples.hpp), each once.
template <int C>
[[nodiscard]] HMESH_COLD Array<Point> border_vertices(const ImageSource<C>& source, double tolerance) {
    Array<Point> vertices;
    const auto add_side = [&](const Rect& side, bool has_ends, FunctionRef<Point(int i)> place) HMESH_COLD {
        Array<double> samples;
        source.with_window(side, [&](const SourceWindow<C>& window) {
            for (int i = 0; i < std::max(side.width, side.height); ++i) {
                const Point p = place(i);
                const auto color = window.pixel(static_cast<int>(p.x), static_cast<int>(p.y));
                for (int c = 0; c < C; ++c) samples.push_back(color[c]);
            }
        });
        const Array<std::uint32_t> nodes = PolylineFinder(std::move(samples), C).nodes(tolerance);
        for (std::size_t k = has_ends ? 0 : 1; k + (has_ends ? 0 : 1) < nodes.size(); ++k)
            vertices.push_back(place(static_cast<int>(nodes[k])));
    };
    const int width = source.width(), height = source.height();
    add_side({0, 0, width, 1}, true, [](int i) { return Point{i + 0.5, 0.5}; });
    add_side({0, height - 1, width, 1}, true, [&](int i) { return Point{i + 0.5, height - 0.5}; });
    add_side({0, 0, 1, height}, false, [](int i) { return Point{0.5, i + 0.5}; });
    add_side({width - 1, 0, 1, height}, false, [&](int i) { return Point{width - 0.5, i + 0.5}; });
    return vertices;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_ANNEALED_BORDER_HPP
