/// \file
/// Patches: cut a mesh into tiles, work on each by itself, put them together again.
///
/// A patch is the part of the mesh whose triangles have their centroid in one tile, as an ImageMesh with local coordinates
/// and a moment table of its own bounding box: about 3 MB at 256 px, so it stays in cache, and sums stay small, so no image
/// is too wide. A vertex is free in a patch when all its triangles are in it; the others are frozen. So patches share
/// nothing that changes and may be worked on in any order, on any number of threads, with the same result to the last bit.
/// Phases shift the tiling by half a tile, so that every vertex is free in turn.
///
/// A patch may have holes, several components, and frozen vertices where two fans of it meet: those it holds once a fan.
/// Cutting and putting back costs about 1 us a vertex and the table 5 ns a pixel.
#ifndef HMESH_TILES_PATCH_HPP
#define HMESH_TILES_PATCH_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "hmesh/core/assert.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/core/progress.hpp"
#include "hmesh/fit/image_mesh.hpp"
#include "hmesh/fit/image_source.hpp"
#include "hmesh/fit/moment_table.hpp"
#include "hmesh/tiles/indexed_mesh.hpp"
#include "hmesh/tiles/tiling.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

namespace detail {

/// Which triangles each tile has, and in which tile each vertex is free.
struct Cut {
    static constexpr std::uint32_t locked = 0xffffffffU;
    std::vector<std::uint32_t> triangles;  ///< those of tile k: [first[k], first[k + 1])
    std::vector<std::size_t> first;
    std::vector<std::uint32_t> owner;           ///< of a vertex: the tile where it is free, or frozen
    std::vector<std::uint32_t> number;          ///< of a vertex: its number among those free in its tile, or among the frozen
    std::vector<std::uint16_t> triangle_count;  ///< of a vertex, in the whole mesh
    std::vector<std::size_t> free_count;        ///< of a tile
    std::size_t frozen_count = 0;
};

template <int C>
[[nodiscard]] HMESH_COLD Cut cut(const IndexedMesh<C>& whole, const Tiling& tiling) {
    constexpr std::uint32_t none = 0xfffffffeU;
    const std::size_t n = whole.vertex_count();
    Cut cut;
    std::vector<std::uint32_t> tile(whole.faces.size());
    cut.first.assign(tiling.size() + 1, 0);
    cut.owner.assign(n, none);
    cut.triangle_count.assign(n, 0);
    for (std::size_t t = 0; t < whole.faces.size(); ++t) {
        double x = 0, y = 0;
        for (const std::uint32_t v : whole.faces[t]) x += whole.positions[v].x, y += whole.positions[v].y;
        tile[t] = static_cast<std::uint32_t>(tiling.tile_at({x / 3, y / 3}));
        ++cut.first[tile[t] + 1];
        for (const std::uint32_t v : whole.faces[t]) {
            ++cut.triangle_count[v];
            cut.owner[v] = cut.owner[v] == none || cut.owner[v] == tile[t] ? tile[t] : Cut::locked;
        }
    }
    for (std::size_t k = 0; k < tiling.size(); ++k) cut.first[k + 1] += cut.first[k];
    cut.triangles.resize(whole.faces.size());
    std::vector<std::size_t> at(cut.first.begin(), cut.first.end() - 1);
    for (std::size_t t = 0; t < tile.size(); ++t) cut.triangles[at[tile[t]]++] = static_cast<std::uint32_t>(t);
    cut.number.resize(n);
    cut.free_count.assign(tiling.size(), 0);
    for (std::size_t v = 0; v < n; ++v)
        cut.number[v] =
            static_cast<std::uint32_t>(cut.owner[v] == Cut::locked ? cut.frozen_count++ : cut.free_count[cut.owner[v]]++);
    return cut;
}

/// A tile's triangles with vertices numbered anew: first those that are free, by Cut::number, then the frozen ones, once for
/// each fan of triangles around them.
struct PatchTriangles {
    struct Frozen {
        std::uint32_t vertex;  ///< of the whole mesh
        int triangle_count;    ///< of this fan
    };
    std::vector<Triangle> triangles;
    std::vector<Frozen> locked;
};

template <int C>
[[nodiscard]] HMESH_COLD PatchTriangles renumber(const IndexedMesh<C>& whole, const Cut& cut, std::size_t tile) {
    PatchTriangles patch;
    struct Corner {  // of a triangle, in a frozen vertex
        std::uint32_t vertex, triangle, corner;
        std::uint32_t next, previous;  // the triangle's other vertices
        std::uint32_t fan;             // the corner of the group that stands for its fan
    };
    std::vector<Corner> corners;
    patch.triangles.reserve(cut.first[tile + 1] - cut.first[tile]);
    for (std::size_t k = cut.first[tile]; k < cut.first[tile + 1]; ++k) {
        const Triangle& t = whole.faces[cut.triangles[k]];
        Triangle local{};
        for (std::uint32_t c = 0; c < 3; ++c) {
            if (cut.owner[t[c]] != Cut::locked) local[c] = cut.number[t[c]];
            else
                corners.push_back(
                    {t[c], static_cast<std::uint32_t>(patch.triangles.size()), c, t[(c + 1) % 3], t[(c + 2) % 3], 0});
        }
        patch.triangles.push_back(local);
    }
    std::sort(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) {
        return a.vertex != b.vertex ? a.vertex < b.vertex : a.triangle < b.triangle;
    });
    const auto first_frozen = static_cast<std::uint32_t>(cut.free_count[tile]);
    for (std::size_t begin = 0, end = 0; begin < corners.size(); begin = end) {
        while (end < corners.size() && corners[end].vertex == corners[begin].vertex) ++end;
        // Triangles that share a side in this vertex are of one fan: the least corner of a fan spreads over it.
        for (std::size_t i = begin; i < end; ++i) corners[i].fan = static_cast<std::uint32_t>(i);
        for (bool changed = true; changed;) {
            changed = false;
            for (std::size_t i = begin; i < end; ++i)
                for (std::size_t k = begin; k < end; ++k)
                    if (corners[i].previous == corners[k].next && corners[i].fan != corners[k].fan) {
                        corners[i].fan = corners[k].fan = std::min(corners[i].fan, corners[k].fan);
                        changed = true;
                    }
        }
        std::size_t known = patch.locked.size();
        for (std::size_t i = begin; i < end; ++i) {
            if (corners[i].fan == i) patch.locked.push_back({corners[i].vertex, 0});
            std::size_t id = known;  // fans are numbered by their least corner
            for (std::size_t k = begin; k < corners[i].fan; ++k) id += corners[k].fan == k ? 1U : 0U;
            ++patch.locked[id].triangle_count;
            patch.triangles[corners[i].triangle][corners[i].corner] = first_frozen + static_cast<std::uint32_t>(id);
        }
    }
    return patch;
}

/// What becomes of a patch, in the plane of the whole image.
template <int C>
struct PatchResult {
    std::vector<Point> positions;  ///< of free vertices
    std::vector<Color<C>> colors;
    std::vector<unsigned char> dirty;
    std::vector<Triangle> triangles;    ///< free vertices by their place above, frozen ones after them
    std::vector<std::uint32_t> locked;  ///< of the whole mesh, may repeat
    std::vector<std::uint32_t> locked_dirty;
    double energy = 0;
};

/// A tile's part of the whole that nobody worked on. Its energy is not known.
template <int C>
[[nodiscard]] HMESH_COLD PatchResult<C> unchanged(const IndexedMesh<C>& whole, const Cut& cut, std::size_t tile) {
    PatchResult<C> out;
    out.positions.resize(cut.free_count[tile]);
    out.colors.resize(cut.free_count[tile]);
    out.dirty.resize(cut.free_count[tile]);
    for (std::size_t k = cut.first[tile]; k < cut.first[tile + 1]; ++k) {
        Triangle t = whole.faces[cut.triangles[k]];
        for (std::uint32_t& v : t) {
            const std::uint32_t number = cut.number[v];
            if (cut.owner[v] == Cut::locked) {
                out.locked.push_back(v);
                if (whole.dirty[v] != 0) out.locked_dirty.push_back(v);
                v = static_cast<std::uint32_t>(cut.free_count[tile] + out.locked.size() - 1);
                continue;
            }
            out.positions[number] = whole.positions[v];
            out.colors[number] = whole.colors[v];
            out.dirty[number] = whole.dirty[v];
            v = number;
        }
        out.triangles.push_back(t);
    }
    return out;
}

}  // namespace detail

/// A tile's part of a whole mesh, as an ImageMesh over a table of its own.
template <int C>
class Patch {
  public:
    /// `table`: a table to use if it is that of the patch's rectangle; it is taken.
    HMESH_COLD Patch(const IndexedMesh<C>& whole, const ImageSource<C>& source, const detail::Cut& cut, std::size_t tile,
                     const MeshLimits& limits, TaskProgress* task, MomentTable<C> table = {})
        : numbered_(detail::renumber(whole, cut, tile)), free_(cut.free_count[tile]) {
        std::vector<std::uint32_t> vertices(free_ + numbered_.locked.size());  // of the whole mesh
        for (std::size_t k = 0; k < numbered_.locked.size(); ++k) vertices[free_ + k] = numbered_.locked[k].vertex;
        for (std::size_t k = cut.first[tile]; k < cut.first[tile + 1]; ++k)
            for (const std::uint32_t v : whole.faces[cut.triangles[k]])
                if (cut.owner[v] != detail::Cut::locked) vertices[cut.number[v]] = v;

        Point low{1e9, 1e9}, high{0, 0};
        for (const std::uint32_t v : vertices) {
            const Point p = whole.positions[v];
            low = {std::min(low.x, p.x), std::min(low.y, p.y)};
            high = {std::max(high.x, p.x), std::max(high.y, p.y)};
        }
        const int x = static_cast<int>(low.x), y = static_cast<int>(low.y);
        origin_ = {static_cast<double>(x), static_cast<double>(y)};
        const Rect rect{x, y, static_cast<int>(std::ceil(high.x)) - x, static_cast<int>(std::ceil(high.y)) - y};
        table_ = table.width() == source.width() && table.height() == source.height() && rect.width == table.width() &&
                         rect.height == table.height()
                     ? std::move(table)
                     : source.table(rect);
        std::vector<Point> positions;
        std::vector<Color<C>> colors;
        positions.reserve(vertices.size());
        colors.reserve(vertices.size());
        for (const std::uint32_t v : vertices) {
            positions.push_back({whole.positions[v].x - x, whole.positions[v].y - y});
            colors.push_back(whole.colors[v]);
        }
        mesh_ = ImageMesh<C>(table_, source.low(), source.high(), limits,
                             {{-x, -y, source.width(), source.height()}, !numbered_.locked.empty(), 1, task});
        const Status status = mesh_.assign(positions, numbered_.triangles, colors, {});
        HMESH_ASSERT(status);
        (void)status;
        for (std::size_t k = 0; k < vertices.size(); ++k) mesh_.set_dirty(Vertex(k), whole.dirty[vertices[k]] != 0);
        for (std::size_t k = 0; k < numbered_.locked.size(); ++k) {
            // Each of its fans may grow in proportion: together they stay within the bound.
            const detail::PatchTriangles::Frozen& f = numbered_.locked[k];
            mesh_.lock(Vertex(free_ + k), f.triangle_count * (max_valence - 1) / cut.triangle_count[f.vertex] + 1);
        }
        // A patch without error would ask for infinite tolerance.
        if (whole.energy > 0 && mesh_.energy() > 0) mesh_.set_scale(std::min(1e3, whole.mean_energy() / mesh_.mean_energy()));
    }
    Patch(const Patch&) = delete;
    Patch& operator=(const Patch&) = delete;

    [[nodiscard]] ImageMesh<C>& mesh() noexcept { return mesh_; }
    /// Gives its table away; the patch is of no more use.
    [[nodiscard]] MomentTable<C> take_table() noexcept { return std::move(table_); }
    [[nodiscard]] std::size_t vertex_count() const noexcept { return mesh_.vertex_count(); }
    /// Vertices that may be changed: all but the frozen ones.
    [[nodiscard]] std::size_t free_count() const noexcept { return mesh_.vertex_count() - numbered_.locked.size(); }

    /// The patch as it is now, in spatial order.
    [[nodiscard]] HMESH_COLD detail::PatchResult<C> result() const {
        detail::PatchResult<C> out;
        std::vector<std::uint32_t> number(mesh_.topology().vertex_slots());
        const auto is_frozen = [&](Vertex v) { return v.index() >= free_ && v.index() < free_ + numbered_.locked.size(); };
        out.positions.reserve(free_count());
        out.colors.reserve(free_count());
        out.dirty.reserve(free_count());
        for (const Vertex v : spatial_vertices(mesh_)) {
            if (is_frozen(v)) continue;
            number[v.index()] = static_cast<std::uint32_t>(out.positions.size());
            const Point p = mesh_.position(v);
            out.positions.push_back({p.x + origin_.x, p.y + origin_.y});
            out.colors.push_back(mesh_.color(v));
            out.dirty.push_back(mesh_.is_dirty(v) ? 1 : 0);
        }
        out.locked.reserve(numbered_.locked.size());
        for (std::size_t k = 0; k < numbered_.locked.size(); ++k) {
            number[free_ + k] = static_cast<std::uint32_t>(free_count() + k);
            out.locked.push_back(numbered_.locked[k].vertex);
            if (mesh_.is_dirty(Vertex(free_ + k))) out.locked_dirty.push_back(numbered_.locked[k].vertex);
        }
        out.triangles.reserve(mesh_.topology().face_count());
        for (const Face f : spatial_faces(mesh_)) {
            const auto v = mesh_.topology().vertices(f);
            out.triangles.push_back({number[v[0].index()], number[v[1].index()], number[v[2].index()]});
        }
        out.energy = mesh_.energy();
        return out;
    }

  private:
    detail::PatchTriangles numbered_;
    std::size_t free_;  ///< vertices [0, free_) were free at first, those after them are frozen, later ones are new
    Point origin_;
    MomentTable<C> table_;
    ImageMesh<C> mesh_;
};

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_TILES_PATCH_HPP
