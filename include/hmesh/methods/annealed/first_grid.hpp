/// \file
/// First grid: the mesh that the recipe Annealed starts from.
///
/// A single tile gets a regular grid. Several tiles get a grid each, joined to the nodes on the seams between them
/// (methods/annealed/seams.hpp), so that each tile can then be meshed by itself. Only the seams look at the picture; the stages
/// after this one adapt the rest.
#ifndef HMESH_METHODS_ANNEALED_FIRST_GRID_HPP
#define HMESH_METHODS_ANNEALED_FIRST_GRID_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/core/compiler.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/fit/image_source.hpp"
#include "hmesh/mesh/geometry.hpp"
#include "hmesh/methods/annealed/seams.hpp"
#include "hmesh/tiles/indexed_mesh.hpp"
#include "hmesh/tiles/tiling.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {
namespace detail {

/// Appends the faces of a grid of columns times rows vertices, of which (i, j) is number(i, j); the diagonals alternate.
inline void add_grid_faces(std::uint32_t columns, std::uint32_t rows, std::vector<Triangle>& faces,
                           FunctionRef<std::uint32_t(std::uint32_t, std::uint32_t)> number) {
    for (std::uint32_t j = 0; j + 1 < rows; ++j)
        for (std::uint32_t i = 0; i + 1 < columns; ++i) {
            const std::uint32_t a = number(i, j), b = number(i + 1, j), c = number(i + 1, j + 1), d = number(i, j + 1);
            if ((i + j) % 2 != 0) {
                faces.push_back({a, b, c});
                faces.push_back({a, c, d});
            } else {
                faces.push_back({a, b, d});
                faces.push_back({b, c, d});
            }
        }
}

/// A vertex of a polyline that runs along a side of a tile.
struct ChainVertex {
    std::uint32_t vertex;  ///< its index in the mesh
    double along;          ///< px along the direction of the polyline
};
/// Appends the faces between two polylines that run the same way, `inner` on the right of `outer` as seen along them (y down). A
/// vertex is joined to those of the other polyline that are nearest to it along the direction.
HMESH_COLD inline void add_strip(const std::vector<ChainVertex>& outer, const std::vector<ChainVertex>& inner,
                                 std::vector<Triangle>& faces) {
    std::size_t a = 0, b = 0;
    while (a + 1 < outer.size() || b + 1 < inner.size()) {
        const bool on_outer = b + 1 == inner.size() || (a + 1 < outer.size() && outer[a].along + outer[a + 1].along <=
                                                                                    inner[b].along + inner[b + 1].along);
        if (on_outer) {
            faces.push_back({outer[a].vertex, outer[a + 1].vertex, inner[b].vertex});
            ++a;
        } else {
            faces.push_back({outer[a].vertex, inner[b + 1].vertex, inner[b].vertex});
            ++b;
        }
    }
}

}  // namespace detail

/// A regular grid of at most `count` >= 4 vertices over the image, with the colours of the pixels under the vertices.
template <int C>
[[nodiscard]] HMESH_COLD IndexedMesh<C> regular_grid(const ImageSource<C>& source, double count) {
    const int width = source.width(), height = source.height();
    const auto cells = [&](double side, double other, int pixels) {
        const double n = std::floor(std::sqrt(count * side / other)) - 1;
        return static_cast<std::uint32_t>(std::max(1.0, std::min(n, static_cast<double>(pixels))));
    };
    std::uint32_t nx = cells(width, height, width), ny = cells(height, width, height);
    while (nx > 1 && (nx + 1.0) * (ny + 1.0) > count) --nx;
    while (ny > 1 && (nx + 1.0) * (ny + 1.0) > count) --ny;
    IndexedMesh<C> mesh;
    mesh.width = width;
    mesh.height = height;
    for (std::uint32_t j = 0; j <= ny; ++j)
        for (std::uint32_t i = 0; i <= nx; ++i) {
            const Point p = snap(Point{static_cast<double>(width) * i / nx, static_cast<double>(height) * j / ny});
            mesh.add(p, source.pixel(static_cast<int>(p.x), static_cast<int>(p.y)));
        }
    detail::add_grid_faces(nx + 1, ny + 1, mesh.faces, [&](std::uint32_t i, std::uint32_t j) { return j * (nx + 1) + i; });
    return mesh;
}

/// Grids of about `count` vertices in the tiles of a tiling without shift, joined to about `seam_count` nodes on the seams.
/// Either number is exceeded where the other one would give vertices too many neighbours. Seams are searched by seam_lines() as
/// long as go_on() says true.
template <int C>
[[nodiscard]] HMESH_COLD IndexedMesh<C> tiled_grid(const ImageSource<C>& source, const Tiling& tiling, double count,
                                                   double seam_count, FunctionRef<bool()> go_on,
                                                   const ParallelFor& parallel_for = {}) {
    const auto columns = static_cast<std::uint32_t>(tiling.columns()), rows = static_cast<std::uint32_t>(tiling.rows());
    const auto tile = [&](std::uint32_t i, std::uint32_t j) { return tiling.rect(std::size_t{j} * columns + i); };
    IndexedMesh<C> mesh;
    mesh.width = source.width();
    mesh.height = source.height();
    const auto add = [&](double x, double y) {
        const Point p = snap(Point{x, y});
        mesh.add(p, source.pixel(static_cast<int>(p.x), static_cast<int>(p.y)));
    };

    // Vertices are the corners of tiles, then the nodes on vertical sides, of which (i, j) is left of tile (i, j), then those on
    // horizontal sides, of which (i, j) is above tile (i, j). Sides within the image are seams.
    const auto at_x = [&](std::uint32_t i) { return i == columns ? source.width() : tile(i, 0).x; };
    const auto at_y = [&](std::uint32_t j) { return j == rows ? source.height() : tile(0, j).y; };
    for (std::uint32_t j = 0; j <= rows; ++j)
        for (std::uint32_t i = 0; i <= columns; ++i) add(at_x(i), at_y(j));
    const auto corner = [&](std::uint32_t i, std::uint32_t j) { return j * (columns + 1) + i; };
    std::vector<Seam> sides, seams;
    std::vector<std::size_t> seam_of;
    const auto add_side = [&](const Seam& side, bool on_border) {
        seam_of.push_back(on_border ? seams.max_size() : seams.size());
        if (!on_border) seams.push_back(side);
        sides.push_back(side);
    };
    for (std::uint32_t j = 0; j < rows; ++j)
        for (std::uint32_t i = 0; i <= columns; ++i)
            add_side({at_x(i), at_y(j), at_y(j + 1) - at_y(j), true}, i == 0 || i == columns);
    const std::size_t first_horizontal = sides.size();
    for (std::uint32_t j = 0; j <= rows; ++j)
        for (std::uint32_t i = 0; i < columns; ++i)
            add_side({at_x(i), at_y(j), at_x(i + 1) - at_x(i), false}, j == 0 || j == rows);
    double seam_length = 0;
    for (const Seam& seam : seams) seam_length += seam.length;
    const double seam_spacing = seam_length / std::max(1.0, seam_count), even = std::sqrt(source.pixels() / std::max(1.0, count));
    const double spacing = seams.empty() ? even : std::max(1.0, std::min(even, 1.5 * seam_spacing));
    const int step = std::max(1, static_cast<int>(seam_spacing / 5 + 0.5));
    const int reach = std::max(step, static_cast<int>(std::min(8 * seam_spacing, 6 * spacing)));
    const std::vector<SeamLine<C>> lines = seam_lines(source, seams, seam_count, step, reach, go_on, parallel_for);

    std::vector<std::uint32_t> first_node;  // of a side
    for (std::size_t k = 0; k < sides.size(); ++k) {
        const Seam& side = sides[k];
        first_node.push_back(static_cast<std::uint32_t>(mesh.vertex_count()));
        if (seam_of[k] < seams.size()) {
            const SeamLine<C>& line = lines[seam_of[k]];
            for (std::size_t m = 0; m < line.offsets.size(); ++m) {
                const int offset = line.offsets[m];
                mesh.add({static_cast<double>(side.x + (side.vertical ? 0 : offset)),
                          static_cast<double>(side.y + (side.vertical ? offset : 0))},
                         line.colors[m]);
            }
        } else {
            const int parts = std::max(1, std::min(side.length, static_cast<int>(side.length / spacing + 0.5)));
            for (int m = 1; m < parts; ++m) {
                const double offset = static_cast<double>(side.length) * m / parts;
                add(side.x + (side.vertical ? 0 : offset), side.y + (side.vertical ? offset : 0));
            }
        }
    }
    first_node.push_back(static_cast<std::uint32_t>(mesh.vertex_count()));

    // Each tile gets a grid, and four strips of faces between the grid and the tile's sides, clockwise on the screen.
    for (std::uint32_t j = 0; j < rows; ++j)
        for (std::uint32_t i = 0; i < columns; ++i) {
            const Rect rect = tile(i, j);
            const auto inner = [&](int length) {
                return static_cast<std::uint32_t>(std::max(1, std::min(length, static_cast<int>(length / spacing + 0.5)) - 1));
            };
            const std::uint32_t nx = inner(rect.width), ny = inner(rect.height);
            const auto first = static_cast<std::uint32_t>(mesh.vertex_count());
            for (std::uint32_t m = 0; m < ny; ++m)
                for (std::uint32_t k = 0; k < nx; ++k)
                    add(rect.x + rect.width * (k + 1.0) / (nx + 1), rect.y + rect.height * (m + 1.0) / (ny + 1));
            const auto number = [&](std::uint32_t k, std::uint32_t m) { return first + m * nx + k; };
            detail::add_grid_faces(nx, ny, mesh.faces, number);

            const std::size_t left = std::size_t{j} * (columns + 1) + i, above = first_horizontal + std::size_t{j} * columns + i;
            const auto strip = [&](std::size_t side, std::uint32_t from, std::uint32_t to, bool reversed,
                                   std::uint32_t inner_count, FunctionRef<std::uint32_t(std::uint32_t)> inner_at) {
                std::vector<std::uint32_t> nodes;
                for (std::uint32_t v = first_node[side]; v < first_node[side + 1]; ++v) nodes.push_back(v);
                if (reversed) std::reverse(nodes.begin(), nodes.end());
                const auto along = [&](std::uint32_t v) {
                    const double place = sides[side].vertical ? mesh.positions[v].y : mesh.positions[v].x;
                    return reversed ? -place : place;
                };
                std::vector<detail::ChainVertex> outer{{from, along(from)}}, grid;
                for (const std::uint32_t v : nodes) outer.push_back({v, along(v)});
                outer.push_back({to, along(to)});
                for (std::uint32_t k = 0; k < inner_count; ++k) grid.push_back({inner_at(k), along(inner_at(k))});
                detail::add_strip(outer, grid, mesh.faces);
            };
            strip(above, corner(i, j), corner(i + 1, j), false, nx, [&](std::uint32_t k) { return number(k, 0); });
            strip(left + 1, corner(i + 1, j), corner(i + 1, j + 1), false, ny,
                  [&](std::uint32_t m) { return number(nx - 1, m); });
            strip(above + columns, corner(i + 1, j + 1), corner(i, j + 1), true, nx,
                  [&](std::uint32_t k) { return number(nx - 1 - k, ny - 1); });
            strip(left, corner(i, j + 1), corner(i, j), true, ny, [&](std::uint32_t m) { return number(0, ny - 1 - m); });
        }
    return mesh;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_ANNEALED_FIRST_GRID_HPP
