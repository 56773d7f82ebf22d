/// \file
/// The first mesh of a rectangle: its border and that of what has data, triangulated, without what has none.
///
/// The border of the cells of data runs along unit edges of the lattice of whole positions. With all their ends as vertices, each
/// of these edges is in every Delaunay triangulation, since no other point of the lattice, nor of the rectangle's sides, is in
/// or on the circle over it: so what is without data can be cut away along them.
#ifndef HMESH_METHODS_BOUNDED_DOMAIN_HPP
#define HMESH_METHODS_BOUNDED_DOMAIN_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "hmesh/core/array.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/mesh/delaunay.hpp"
#include "hmesh/methods/bounded/height_field.hpp"
#include "hmesh/methods/bounded/sheet.hpp"
#include "hmesh/methods/bounded/side.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {
namespace detail {

/// Adds the ends of the edges between cells of data and others within a rectangle.
HMESH_COLD inline void add_rim(const HeightField& field, const Rect& rect, Array<Corner>& corners) {
    const bool squares = field.samples == Samples::squares;
    for (int j = rect.y; j <= rect.y + rect.height; ++j)
        for (int i = rect.x; i <= rect.x + rect.width; ++i) {
            // The four cells around a position, those outside of the rectangle left out: an edge to one of these is a side's.
            bool is_rim = false, seen = false, first = false;
            for (int y = j - 1; y <= j; ++y)
                for (int x = i - 1; x <= i; ++x) {
                    if (x < rect.x || y < rect.y || x >= rect.x + rect.width || y >= rect.y + rect.height) continue;
                    const bool cell = field.is_cell(x, y);
                    if (!seen) first = cell, seen = true;
                    else is_rim = is_rim || cell != first;
                }
            if (!is_rim) continue;
            Corner c;
            c.position = {static_cast<double>(i), static_cast<double>(j)};
            static_cast<void>(squares ? mean_height(field, i - 1, i, j - 1, j, c.heights)
                                      : mean_height(field, i, i, j, j, c.heights));
            corners.push_back(c);
        }
}

}  // namespace detail

/// The first mesh of a rectangle of the plane: sides as side_vertices() has them, within a limit for each in the order of
/// ImageSide, all faces in cells of data. Freedoms are 0. Empty where no cell has data.
[[nodiscard]] HMESH_COLD inline Sheet first_sheet(const HeightField& field, const Rect& rect, const double (&limits)[image_sides],
                                                  bool lift) {
    Array<Corner> corners;
    const int right = rect.x + rect.width, bottom = rect.y + rect.height;
    const SideLine lines[image_sides] = {{false, rect.y, rect.x, right},
                                         {false, bottom, rect.x, right},
                                         {true, rect.x, rect.y, bottom},
                                         {true, right, rect.y, bottom}};
    for (int k = 0; k < image_sides; ++k) {
        const Array<Corner> side = side_vertices(field, lines[k], limits[k], lift);
        corners.insert(corners.end(), side.begin(), side.end());
    }
    // Corners of the rectangle come twice, and ends of the rim on its sides: the first counts.
    if (!field.data.empty()) detail::add_rim(field, rect, corners);
    Array<Point> points;
    points.reserve(corners.size());
    const auto local = [&](Point p) { return Point{p.x - rect.x, p.y - rect.y}; };
    for (const Corner& corner : corners) points.push_back(local(corner.position));
    const Delaunay delaunay = triangulate(rect.width, rect.height, points);

    Sheet sheet;
    sheet.vertices.resize(delaunay.topology().vertex_slots());
    sheet.freedom.assign(sheet.vertices.size(), 0);
    // Corners sorted by position find their vertices, of several in one place the first.
    const auto before = [](Point a, Point b) { return a.y != b.y ? a.y < b.y : a.x < b.x; };
    Array<std::uint32_t> order(corners.size());
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = static_cast<std::uint32_t>(k);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        const Point p = corners[a].position, q = corners[b].position;
        return before(p, q) || (!before(q, p) && a < b);
    });
    for (const Vertex v : delaunay.topology().vertices()) {
        const Point p{delaunay.position(v).x + rect.x, delaunay.position(v).y + rect.y};
        const auto at = std::lower_bound(order.begin(), order.end(), p,
                                         [&](std::uint32_t k, Point q) { return before(corners[k].position, q); });
        sheet.vertices[v.index()] = corners[*at];
    }
    for (const Face f : delaunay.topology().faces()) {
        const auto v = delaunay.topology().vertices(f);
        if (!field.data.empty()) {
            const Point middle = centroid(sheet.vertices[v[0].index()].position, sheet.vertices[v[1].index()].position,
                                          sheet.vertices[v[2].index()].position);
            if (!field.is_cell(static_cast<int>(middle.x), static_cast<int>(middle.y))) continue;
        }
        sheet.faces.push_back({static_cast<std::uint32_t>(v[0].index()), static_cast<std::uint32_t>(v[1].index()),
                               static_cast<std::uint32_t>(v[2].index())});
    }
    if (!field.data.empty()) separate_fans(sheet);
    return sheet;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_BOUNDED_DOMAIN_HPP
