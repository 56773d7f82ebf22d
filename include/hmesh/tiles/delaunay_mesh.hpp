/// \file
/// Delaunay triangulations of pixels as meshes of an image, the start of many methods. O(n).
#ifndef HMESH_TILES_DELAUNAY_MESH_HPP
#define HMESH_TILES_DELAUNAY_MESH_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "hmesh/core/array.hpp"
#include "hmesh/core/assert.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/fit/image_source.hpp"
#include "hmesh/mesh/delaunay.hpp"
#include "hmesh/mesh/geometry.hpp"
#include "hmesh/mesh/halfedge_mesh.hpp"
#include "hmesh/mesh/periodic.hpp"
#include "hmesh/mesh/samples.hpp"
#include "hmesh/mesh/spatial_order.hpp"
#include "hmesh/tiles/indexed_mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// The position, in px, of the vertex that stands for pixel number y * width + x: the pixel's centre, but on the border for the
/// outermost pixels, so that a mesh of such vertices covers the image. The centres of outermost points are on the border.
[[nodiscard]] inline Point pixel_vertex(std::uint32_t pixel, int width, int height, Samples samples = Samples::squares) noexcept {
    const double low = inset(samples);
    const auto place = [low](std::uint32_t i, int size) {
        return size == 1 ? 0.5 : i == 0 ? low : i + 1 == static_cast<std::uint32_t>(size) ? size - low : i + 0.5;
    };
    const auto columns = static_cast<std::uint32_t>(width);
    return {place(pixel % columns, width), place(pixel / columns, height)};
}

/// Inserts the vertices that stand for these pixels, given as y * width + x, in spatial order. False: go_on(), called between
/// some thousands, said so.
[[nodiscard]] HMESH_COLD inline bool insert_pixels(Delaunay& delaunay, const Array<std::uint32_t>& pixels,
                                                   FunctionRef<bool()> go_on) {
    const auto place = [&](std::uint32_t pixel) {
        return pixel_vertex(pixel, delaunay.width(), delaunay.height(), delaunay.samples());
    };
    delaunay.reserve(delaunay.positions().size() + pixels.size());
    std::size_t done = 0;
    for (const std::uint32_t pixel : in_spatial_order<std::uint32_t>(pixels, pixels.size(), place)) {
        if (++done % 4096 == 0 && !go_on()) return false;
        (void)delaunay.insert(place(pixel));
    }
    return true;
}

/// insert_pixels() of ascending pixels into a triangulation of the corners alone. Many are triangulated in bands of rows, by
/// parallel_for, which are joined: the same for any executor. Where bands meet a vertex stands on either side of the image.
/// False: go_on(), which the calling thread asks between calls of the executor, said so. O(n), a fifteenth of it on one thread.
[[nodiscard]] HMESH_COLD inline bool triangulate_pixels(Delaunay& delaunay, const Array<std::uint32_t>& pixels,
                                                        const ParallelFor& parallel_for, FunctionRef<bool()> go_on) {
    HMESH_ASSERT(std::is_sorted(pixels.begin(), pixels.end()));
    // Of 2048 pixels and 16 times their mean distance, or more: there is work where they meet.
    const auto columns = static_cast<std::uint32_t>(delaunay.width());
    const double count = static_cast<double>(pixels.size()), rows = std::sqrt(count * delaunay.height() / delaunay.width());
    const auto bands = static_cast<std::size_t>(std::min(rows / 16, count / 2048));
    Array<std::uint32_t> cuts(1, 0);  // the first row of each
    for (std::size_t k = 1; k < bands; ++k)
        if (const std::uint32_t row = pixels[pixels.size() / bands * k] / columns; row > cuts.back()) cuts.push_back(row);
    if (cuts.size() < 2) return insert_pixels(delaunay, pixels, go_on);

    const double low = inset(delaunay.samples());
    const auto insert_band = [&](Delaunay& band, std::size_t k) {
        const bool is_last = k + 1 == cuts.size();
        band.keep_rows(std::max<double>(low, cuts[k]), is_last ? delaunay.height() - low : cuts[k + 1]);
        const auto first = std::lower_bound(pixels.begin(), pixels.end(), cuts[k] * columns);
        const auto last = is_last ? pixels.end() : std::lower_bound(first, pixels.end(), cuts[k + 1] * columns);
        (void)insert_pixels(band, Array<std::uint32_t>(first, last), [] { return true; });
    };
    delaunay.reserve(pixels.size() + 4 + 2 * cuts.size());
    constexpr std::size_t at_once = 16;  // these are there twice, until they are joined
    for (std::size_t begin = 0, end = 0; begin < cuts.size(); begin = end) {
        end = std::min(cuts.size(), begin + at_once);
        const std::size_t own = begin == 0 ? 1 : 0;  // the first is the one that the others join
        std::vector<std::unique_ptr<Delaunay>> joining;
        for (std::size_t k = begin + own; k < end; ++k)
            joining.push_back(std::make_unique<Delaunay>(delaunay.width(), delaunay.height(), delaunay.samples()));
        parallel_for(end - begin, [&](std::size_t k) { insert_band(k < own ? delaunay : *joining[k - own], begin + k); });
        if (!go_on()) return false;
        delaunay.join(joining, parallel_for);
        if (!go_on()) return false;
    }
    return true;
}

/// Drops the pixels, given as y * width + x, on the sides along which the image repeats, whose vertices would be on the sides.
HMESH_COLD inline void leave_out_sides(Array<std::uint32_t>& pixels, int width, int height, Periodic periodic) {
    const auto columns = static_cast<std::uint32_t>(width), rows = static_cast<std::uint32_t>(height);
    const auto is_outermost = [](std::uint32_t i, std::uint32_t size) { return size > 1 && (i == 0 || i + 1 == size); };
    std::size_t kept = 0;
    for (const std::uint32_t pixel : pixels)
        if (!(wraps_x(periodic) && is_outermost(pixel % columns, columns)) &&
            !(wraps_y(periodic) && is_outermost(pixel / columns, rows)))
            pixels[kept++] = pixel;
    pixels.resize(kept);
}

/// Inserts for each vertex on a side along which the image repeats the one opposite to it, so that the sides pair.
HMESH_COLD inline void pair_sides(Delaunay& delaunay, Periodic periodic) {
    const double width = delaunay.width(), height = delaunay.height();
    Array<Point> opposite;
    for (const Vertex v : delaunay.topology().vertices()) {
        const Point p = delaunay.position(v);
        if (wraps_x(periodic) && (p.x == 0 || p.x == width)) opposite.push_back({width - p.x, p.y});
        if (wraps_y(periodic) && (p.y == 0 || p.y == height)) opposite.push_back({p.x, height - p.y});
    }
    for (const Point p : opposite) (void)delaunay.insert(p);
}

/// The mesh of a Delaunay triangulation of the image's rectangle, whose vertices and faces are in the order of
/// delaunay.topology(), without the colours, which take_colors() finds: the triangulation is as large as all of them, and may be
/// gone by then. The energy is not computed: ImageMesh::assign() and TiledMesh::measure() do that. O(n).
template <int C>
[[nodiscard]] HMESH_COLD IndexedMesh<C> uncolored_mesh(const ImageSource<C>& source, const Delaunay& delaunay,
                                                       const ParallelFor& parallel_for = {}) {
    HMESH_ASSERT(delaunay.width() == source.width() && delaunay.height() == source.height());
    HMESH_ASSERT(delaunay.samples() == source.samples());
    IndexedMesh<C> mesh;
    mesh.width = source.width();
    mesh.height = source.height();
    mesh.samples = source.samples();
    const HalfedgeMesh& topology = delaunay.topology();
    mesh.positions.reserve(topology.vertex_count());
    for_each_in_turn(parallel_for, topology.vertex_slots(), 1U << 17, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v)
            if (!topology.is_deleted(Vertex(v))) mesh.positions.push_back(delaunay.position(Vertex(v)));
    });
    mesh.faces = topology.triangles(parallel_for);
    return mesh;
}
/// Gives each vertex the colour of the pixel under it. O(n).
template <int C>
HMESH_COLD void take_colors(IndexedMesh<C>& mesh, const ImageSource<C>& source, const ParallelFor& parallel_for = {}) {
    mesh.colors.resize_raw(mesh.positions.size());
    mesh.dirty.resize(mesh.positions.size(), 1);
    source.visit(
        mesh.positions.size(), [&](std::size_t k) { return mesh.positions[k]; },
        [&](const SourceWindow<C>& window, std::size_t k) {
            const Point p = mesh.positions[k];
            mesh.colors[k] = window.pixel(static_cast<int>(p.x), static_cast<int>(p.y));
        },
        parallel_for);
}
/// Both.
template <int C>
[[nodiscard]] HMESH_COLD IndexedMesh<C> delaunay_mesh(const ImageSource<C>& source, const Delaunay& delaunay) {
    IndexedMesh<C> mesh = uncolored_mesh(source, delaunay);
    take_colors(mesh, source);
    return mesh;
}

namespace detail {

/// How many faces each vertex is a corner of.
[[nodiscard]] HMESH_COLD inline Array<int> corner_counts(std::size_t vertex_count, const Array<Triangle>& faces) {
    Array<int> counts(vertex_count, 0);
    for (const Triangle& t : faces)
        for (const std::uint32_t v : t) ++counts[v];
    return counts;
}

/// The work of bound_valence().
template <int C>
class ValenceBound {
  public:
    /// Of a mesh and its connectivity, which both change and must outlive this.
    ValenceBound(IndexedMesh<C>& mesh, HalfedgeMesh& topology, int limit) noexcept
        : mesh_(&mesh), topology_(&topology), limit_(limit) {}

    /// Whether v has few enough edges in the end. A new vertex takes about `limit` edges, and those around v must have room for
    /// the next ones: their last places are kept for a second and a third layer of them.
    HMESH_COLD bool apply(Vertex v) {
        for (const int kept : {4, 2, 0}) {
            most_ = limit_ - kept;
            for (bool is_better = true; is_better && topology_->valence(v) > limit_;) {
                const int before = topology_->valence(v);
                flip_spokes(v);
                if (topology_->valence(v) > limit_ && split_spoke(v)) flip_spokes(v);  // to the new vertex
                is_better = topology_->valence(v) < before;
            }
        }
        return topology_->valence(v) <= limit_;
    }

  private:
    static constexpr double least_area = 0.25;  ///< twice a face's, in px^2: the most that MeshLimits may ask for

    [[nodiscard]] Point at(Vertex v) const noexcept { return mesh_->positions[v.index()]; }
    /// The corners beside an edge with two faces.
    [[nodiscard]] Vertex far_corner(Halfedge h) const noexcept { return topology_->to_vertex(topology_->next(h)); }
    [[nodiscard]] bool has_room(Vertex v) const noexcept { return topology_->valence(v) < most_; }

    [[nodiscard]] HMESH_COLD bool turns_well(Halfedge a) const noexcept {
        if (!topology_->is_flip_ok(HalfedgeMesh::edge(a))) return false;
        const Vertex left = far_corner(a), right = far_corner(HalfedgeMesh::opposite(a));
        const Point from = at(topology_->from_vertex(a)), to = at(topology_->to_vertex(a));
        return orient2d(from, at(right), at(left)) >= least_area && orient2d(at(right), to, at(left)) >= least_area &&
               has_room(left) && has_room(right);
    }
    /// Turns spokes of v as long as there are too many, round after round.
    HMESH_COLD void flip_spokes(Vertex v) {
        int valence = topology_->valence(v), misses = 0;
        for (Halfedge h = topology_->halfedge(v); valence > limit_ && misses < valence;) {
            const Halfedge next = topology_->next(HalfedgeMesh::opposite(h));
            if (turns_well(h)) {
                topology_->flip(HalfedgeMesh::edge(h));
                --valence;
                misses = 0;
            } else {
                ++misses;
            }
            h = next;
        }
    }
    /// Puts a vertex in the middle of the spoke of v whose faces are largest. False: no face may get smaller.
    HMESH_COLD bool split_spoke(Vertex v) {
        Halfedge best;
        double largest = 0;
        for (const Halfedge h : topology_->outgoing(v)) {
            const Halfedge back = HalfedgeMesh::opposite(h);
            if (topology_->is_boundary(h) || topology_->is_boundary(back)) continue;
            const Vertex left = far_corner(h), right = far_corner(back);
            const double area = std::min(orient2d(at(v), at(topology_->to_vertex(h)), at(left)),
                                         orient2d(at(v), at(right), at(topology_->to_vertex(h))));
            if (area <= largest || area < 2 * least_area || !has_room(left) || !has_room(right)) continue;
            best = h;
            largest = area;
        }
        if (!best.is_valid()) return false;
        const Vertex end = topology_->to_vertex(best);
        const Point middle = snap({0.5 * (at(v).x + at(end).x), 0.5 * (at(v).y + at(end).y)});
        const Vertex left = far_corner(best), right = far_corner(HalfedgeMesh::opposite(best));
        for (const Vertex side : {v, end}) {  // of the line from right to left: snapping may move the middle off the spoke
            const double turn = side == v ? 1 : -1;
            if (turn * orient2d(at(side), middle, at(left)) < least_area) return false;
            if (turn * orient2d(at(side), at(right), middle) < least_area) return false;
        }
        Color<C> color = Color<C>::zero();
        for (int c = 0; c < C; ++c) color.set(c, 0.5 * (mesh_->colors[v.index()][c] + mesh_->colors[end.index()][c]));
        mesh_->add(middle, color);
        (void)topology_->split(HalfedgeMesh::edge(best));
        return true;
    }

    IndexedMesh<C>* mesh_;
    HalfedgeMesh* topology_;
    int limit_;
    int most_ = 0;  ///< edges that a flip or a split may give another vertex
};

}  // namespace detail

/// Flips edges until no vertex has more than `limit` >= 16 edges, without giving another vertex more, and splits edges where
/// flips are not enough: a point in a flat part sees all those at a sharp edge around it, and where that edge is straight none
/// of their edges can turn. Twice the area of a new face is 0.25 px^2 at least. Whether it succeeded; else some vertices have
/// more edges. O(n) where there is nothing to do.
template <int C>
[[nodiscard]] HMESH_COLD bool bound_valence(IndexedMesh<C>& mesh, int limit) {
    const Array<int> faces = detail::corner_counts(mesh.vertex_count(), mesh.faces);
    // A vertex on the border has one edge more than faces.
    if (std::none_of(faces.begin(), faces.end(), [&](int count) { return count + 1 > limit; })) return true;
    HalfedgeMesh topology;
    if (!topology.assign(mesh.vertex_count(), mesh.faces)) return false;
    detail::ValenceBound<C> bound(mesh, topology, limit);
    bool is_bounded = true;
    for (std::size_t v = 0; v < faces.size(); ++v)
        if (faces[v] + 1 > limit) is_bounded = bound.apply(Vertex(v)) && is_bounded;
    mesh.faces = topology.triangles();
    return is_bounded;
}

/// Where bound_valence() has failed: drops every second of the pixels, given as y * width + x, whose vertices share a face with
/// one that has about `limit` edges or more. False: there is none. O(n), and a byte for each pixel of the image.
[[nodiscard]] HMESH_COLD inline bool leave_out_crowd(Array<std::uint32_t>& pixels, const Array<Point>& positions,
                                                     const Array<Triangle>& faces, int width, int height, int limit) {
    const Array<int> counts = detail::corner_counts(positions.size(), faces);
    const auto columns = static_cast<std::size_t>(width);
    Array<std::uint8_t> is_crowded(columns * static_cast<std::size_t>(height), 0);
    for (const Triangle& t : faces)
        for (const std::uint32_t center : t)
            for (const std::uint32_t v : t)
                if (counts[center] >= limit)
                    is_crowded[static_cast<std::size_t>(positions[v].y) * columns + static_cast<std::size_t>(positions[v].x)] = 1;
    std::size_t kept = 0, crowded = 0;
    for (const std::uint32_t pixel : pixels)
        if (is_crowded[pixel] == 0 || ++crowded % 2 == 0) pixels[kept++] = pixel;
    pixels.resize(kept);
    return crowded > 0;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_TILES_DELAUNAY_MESH_HPP
