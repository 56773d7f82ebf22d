/// \file
/// Sampled colors: vertex colours read from the image, as in the methods of Adams and of Xie and in section 1 of the paper.
///
/// A vertex takes the colour of the image at its position: of the pixel if it lies on a pixel's centre, else bilinear between
/// the four nearest centres. Positions beyond the outermost centres take the colour of the nearest point between these. Optimal
/// colours (solve/bounded_colors.hpp) are 0.3 to 1.4 dB better on the meshes of Adams and Xie, for a few microseconds a vertex.
#ifndef HMESH_SOLVE_SAMPLED_COLORS_HPP
#define HMESH_SOLVE_SAMPLED_COLORS_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "hmesh/core/array.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/lanes.hpp"
#include "hmesh/fit/image_mesh.hpp"
#include "hmesh/fit/moment_table.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// The colour at p, in px, in [0, width] x [0, height], of an image whose pixels are pixel(x, y); bilinear.
template <int C, class Pixel>
[[nodiscard]] HMESH_ALWAYS_INLINE Color<C> sampled_color(int width, int height, Point p, Pixel&& pixel) {
    const double x = std::max(0.0, std::min(width - 1.0, p.x - 0.5)), y = std::max(0.0, std::min(height - 1.0, p.y - 0.5));
    const int left = static_cast<int>(x), top = static_cast<int>(y);
    const double right_share = x - left, low_share = y - top;
    if (right_share == 0 && low_share == 0) return pixel(left, top);
    const int right = std::min(width - 1, left + 1), low = std::min(height - 1, top + 1);
    const Color<C> above = pixel(left, top) * (1 - right_share) + pixel(right, top) * right_share;
    const Color<C> below = pixel(left, low) * (1 - right_share) + pixel(right, low) * right_share;
    return above * (1 - low_share) + below * low_share;
}
/// The colour at p, in px of the table's rectangle, of the image that the table was made from; bilinear.
template <int C>
[[nodiscard]] HMESH_ALWAYS_INLINE Color<C> sampled_color(const MomentTable<C>& table, Point p) {
    return sampled_color<C>(table.width(), table.height(), p, [&](int x, int y) {
        Color<C> color;
        table.pixel(x, y, color);
        return color;
    });
}

/// Gives all vertices the colours of the image at their positions. The energy of the mesh follows.
template <int C>
void sample_colors(ImageMesh<C>& mesh, const ParallelFor& parallel_for = {}) {
    Array<Color<C>> colors(mesh.topology().vertex_slots(), Color<C>::zero());
    for (const Vertex v : mesh.topology().vertices()) colors[v.index()] = sampled_color(mesh.table(), mesh.position(v));
    mesh.set_colors(colors, parallel_for);
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_SOLVE_SAMPLED_COLORS_HPP
