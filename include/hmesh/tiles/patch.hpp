/// \file
/// Patches: parts of a mesh, one for each tile, that are worked on independently and then put together again.
///
/// A patch is the part of the mesh whose faces have their centroid in one tile, as an ImageMesh over the moment table of the
/// whole image or, with local coordinates, of its own bounding box: then sums stay small, so no image is too wide. A vertex is
/// free in a patch if all its faces belong to the patch; the others are locked. Patches share nothing that changes, so they may
/// be worked on in any order and on any number of threads, with the same result to the last bit. Phases shift the tiling by half
/// a tile, so that every vertex is free in turn.
///
/// A patch may have holes and several components. A locked vertex in which two or more fans of the patch's faces meet is held
/// once for each fan.
///
/// Cost: cutting and putting back about 1 us a vertex, the table 2 to 5 ns a pixel.
#ifndef HMESH_TILES_PATCH_HPP
#define HMESH_TILES_PATCH_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "hmesh/core/array.hpp"
#include "hmesh/core/assert.hpp"
#include "hmesh/core/coded_order.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/core/progress.hpp"
#include "hmesh/fit/image_mesh.hpp"
#include "hmesh/fit/image_source.hpp"
#include "hmesh/fit/moment_table.hpp"
#include "hmesh/tiles/fans.hpp"
#include "hmesh/tiles/indexed_mesh.hpp"
#include "hmesh/tiles/tiling.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

namespace detail {

/// A cut of a mesh along a tiling: which faces each tile has, and in which tile each vertex is free.
struct Cut {
    static constexpr std::uint32_t locked = 0xffffffffU;  ///< the owner of vertices that are free in no tile
    Array<std::uint32_t> faces;            ///< faces of the mesh by tile; those of tile k at [first[k], first[k + 1])
    Array<std::size_t> first;              ///< one more entry than tiles
    Array<std::uint32_t> owner;            ///< of each vertex: the tile where it is free, or `locked`
    Array<std::uint32_t> number;           ///< of each vertex: its place among the free ones of its tile or the locked
    Array<std::uint16_t> face_count;       ///< of each vertex: its faces in the mesh, those of its copies included
    Array<std::size_t> free_count;         ///< of each tile: the vertices that are free in it
    Array<std::uint32_t> locked_vertices;  ///< those that are free in no tile, by their number
};

/// Cuts a mesh along a tiling. `roots`: of a periodic mesh, as IndexedMesh has them, whose copies and the vertices that have some
/// are free in no tile; else empty. The executor finds the tiles of faces. O(faces).
[[nodiscard]] HMESH_PATCHWISE inline Cut cut(const Array<Point>& positions, const Array<Triangle>& faces, const Tiling& tiling,
                                             const Array<std::uint32_t>& roots = {}, const ParallelFor& parallel_for = {}) {
    constexpr std::uint32_t none = 0xfffffffeU;
    const std::size_t n = positions.size();
    Cut cut;
    Array<std::uint32_t> tile;
    tile.resize_raw(faces.size());
    for_each_chunk(parallel_for, faces.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            const Triangle& face = faces[t];
            tile[t] =
                static_cast<std::uint32_t>(tiling.tile_at(centroid(positions[face[0]], positions[face[1]], positions[face[2]])));
        }
    });
    cut.first.resize(tiling.size() + 1);
    cut.owner = Array<std::uint32_t>(n, none);
    cut.face_count.resize(n);
    for (std::size_t v = 0; v < roots.size(); ++v)
        if (roots[v] != v) cut.owner[v] = cut.owner[roots[v]] = Cut::locked;
    constexpr std::size_t at_once = std::size_t{1} << 18;  // some ms
    for_each_in_turn(parallel_for, faces.size(), at_once, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            ++cut.first[tile[t] + 1];
            for (const std::uint32_t v : faces[t]) {
                ++cut.face_count[v];
                cut.owner[v] = cut.owner[v] == none || cut.owner[v] == tile[t] ? tile[t] : Cut::locked;
            }
        }
    });
    for (std::size_t v = 0; v < roots.size(); ++v)
        if (roots[v] != v) cut.face_count[roots[v]] = static_cast<std::uint16_t>(cut.face_count[roots[v]] + cut.face_count[v]);
    for (std::size_t v = 0; v < roots.size(); ++v) cut.face_count[v] = cut.face_count[roots[v]];
    for (std::size_t k = 0; k < tiling.size(); ++k) cut.first[k + 1] += cut.first[k];
    cut.faces.resize_raw(faces.size());
    Array<std::size_t> at(cut.first.begin(), cut.first.end() - 1);
    for_each_in_turn(parallel_for, faces.size(), at_once, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) cut.faces[at[tile[t]]++] = static_cast<std::uint32_t>(t);
    });
    cut.number.resize_raw(n);
    cut.free_count.resize(tiling.size());
    for_each_in_turn(parallel_for, n, at_once, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
            const bool is_locked = cut.owner[v] == Cut::locked;
            cut.number[v] = static_cast<std::uint32_t>(is_locked ? cut.locked_vertices.size() : cut.free_count[cut.owner[v]]++);
            if (is_locked) cut.locked_vertices.push_back(static_cast<std::uint32_t>(v));
        }
    });
    return cut;
}

/// The number of faces of each tile.
[[nodiscard]] HMESH_COLD inline Array<double> face_counts(const Cut& cut) {
    Array<double> counts(cut.first.size() - 1);
    for (std::size_t k = 0; k < counts.size(); ++k) counts[k] = static_cast<double>(cut.first[k + 1] - cut.first[k]);
    return counts;
}

/// The tiles of size > 0, the largest first or in their order.
[[nodiscard]] HMESH_COLD inline Array<std::size_t> order_of_work(const Array<double>& sizes, bool largest_first) {
    Array<std::size_t> tiles;
    const auto code = [&](std::uint32_t k) { return largest_first ? code_of(-sizes[k]) : 0; };
    for (const Coded& at : sorted_numbers(sizes.size(), code))
        if (sizes[at.number] > 0) tiles.push_back(at.number);
    return tiles;
}

/// The faces of a tile with vertices numbered for its patch: first the free ones, by Cut::number, then the locked ones, once for
/// each fan of the tile's faces around them.
struct PatchFaces {
    /// A locked vertex with one fan of faces.
    struct Locked {
        std::uint32_t vertex;  ///< in the indexed mesh
        int face_count;        ///< faces of this fan
    };
    Array<Triangle> faces;          ///< in the order of Cut::faces
    Array<Locked> locked;           ///< vertices after the free ones
    Array<std::uint32_t> vertices;  ///< all of them by their index in the indexed mesh
};

/// Numbers the vertices of a tile's faces for its patch. O(faces of the tile), and the square of the faces around each locked
/// vertex.
[[nodiscard]] HMESH_PATCHWISE inline PatchFaces renumber(const Array<Triangle>& faces, const Cut& cut, std::size_t tile) {
    PatchFaces patch;
    Array<FanCorner> corners;  // at locked vertices
    patch.faces.reserve(cut.first[tile + 1] - cut.first[tile]);
    patch.vertices.resize(cut.free_count[tile]);
    for (std::size_t k = cut.first[tile]; k < cut.first[tile + 1]; ++k) {
        const Triangle& t = faces[cut.faces[k]];
        Triangle local{};
        for (std::uint32_t c = 0; c < 3; ++c) {
            if (cut.owner[t[c]] != Cut::locked) patch.vertices[local[c] = cut.number[t[c]]] = t[c];
            else corners.push_back({t[c], static_cast<std::uint32_t>(patch.faces.size()), c, t[(c + 1) % 3], t[(c + 2) % 3], 0});
        }
        patch.faces.push_back(local);
    }
    const auto first_locked = static_cast<std::uint32_t>(cut.free_count[tile]);
    find_fans(corners, [&](std::size_t begin, std::size_t end) {
        const std::size_t known = patch.locked.size();
        for (std::size_t i = begin; i < end; ++i) {
            if (corners[i].fan == i) patch.locked.push_back({corners[i].vertex, 0});
            std::size_t id = known;  // fans are numbered by their first corner
            for (std::size_t k = begin; k < corners[i].fan; ++k) id += corners[k].fan == k ? 1U : 0U;
            ++patch.locked[id].face_count;
            patch.faces[corners[i].face][corners[i].corner] = first_locked + static_cast<std::uint32_t>(id);
        }
    });
    for (const PatchFaces::Locked& f : patch.locked) patch.vertices.push_back(f.vertex);
    return patch;
}

/// A colour without the lanes that fill a vector register up.
template <int C>
using TightColor = std::array<double, static_cast<std::size_t>(C)>;

/// The channels of a colour.
template <int C>
[[nodiscard]] TightColor<C> tight(const Color<C>& color) noexcept {
    TightColor<C> out{};
    for (int c = 0; c < C; ++c) out[static_cast<std::size_t>(c)] = color[c];
    return out;
}

/// A patch after work, in the coordinates of the whole image, ready to be merged.
template <int C>
struct PatchResult {
    Array<Point> positions;             ///< of the free vertices, px of the image
    Array<TightColor<C>> colors;        ///< of the free vertices
    Array<unsigned char> dirty;         ///< of the free vertices, as in IndexedMesh
    Array<Triangle> faces;              ///< indices of free vertices, then of `locked`
    Array<std::uint32_t> locked;        ///< locked vertices by their index in the cut mesh; may repeat
    Array<std::uint32_t> locked_dirty;  ///< those that are dirty, by their index in the cut mesh
    double first_energy = 0;            ///< of the patch's faces before the work
    double energy = 0;                  ///< of the patch's faces
};

/// The result of a tile that was not worked on; its energies are not known.
template <int C>
[[nodiscard]] HMESH_COLD PatchResult<C> unchanged(const IndexedMesh<C>& indexed, const Cut& cut, std::size_t tile) {
    PatchResult<C> out;
    out.positions.resize(cut.free_count[tile]);
    out.colors.resize(cut.free_count[tile]);
    out.dirty.resize(cut.free_count[tile]);
    for (std::size_t k = cut.first[tile]; k < cut.first[tile + 1]; ++k) {
        Triangle t = indexed.faces[cut.faces[k]];
        for (std::uint32_t& v : t) {
            const std::uint32_t number = cut.number[v];
            if (cut.owner[v] == Cut::locked) {
                out.locked.push_back(v);
                if (indexed.dirty[v] != 0) out.locked_dirty.push_back(v);
                v = static_cast<std::uint32_t>(cut.free_count[tile] + out.locked.size() - 1);
                continue;
            }
            out.positions[number] = indexed.positions[v];
            out.colors[number] = tight<C>(indexed.colors[v]);
            out.dirty[number] = indexed.dirty[v];
            v = number;
        }
        out.faces.push_back(t);
    }
    return out;
}

/// The energy of a mesh from those of its patches.
class EnergySum {
  public:
    /// Adds a patch, whose energy was `first` and is `now`.
    void add(double first, double now) noexcept { now_ += now, change_ += now - first; }
    /// Says that a part of the mesh is in no patch.
    void leave_out() noexcept { is_whole_ = false; }
    /// The energy of the mesh, which was `before` if a part of it was left out.
    [[nodiscard]] double energy(double before) const noexcept { return is_whole_ ? now_ : before + change_; }

  private:
    double now_ = 0, change_ = 0;
    bool is_whole_ = true;
};

}  // namespace detail

/// The part of a mesh that belongs to one tile, as an ImageMesh over a moment table of its own.
template <int C>
class Patch {
  public:
    /// Makes the patch of tile number `tile` of a cut of the mesh. `whole`: a table of the whole image, which must outlive the
    /// patch; null: the patch makes one of its own bounding box. The executor fills in edges and faces.
    HMESH_PATCHWISE Patch(const IndexedMesh<C>& indexed, const ImageSource<C>& source, const detail::Cut& cut, std::size_t tile,
                          const MeshLimits& limits, const MomentTable<C>* whole = nullptr, const ParallelFor& parallel_for = {})
        : numbered_(detail::renumber(indexed.faces, cut, tile)), free_(cut.free_count[tile]),
          box_(whole != nullptr ? Rect() : box_of(indexed)), table_(whole != nullptr ? MomentTable<C>() : source.table(box_)),
          mesh_(whole != nullptr ? *whole : table_, source.low(), source.high(), limits, context_of(indexed, source)) {
        const Array<std::uint32_t> vertices = std::move(numbered_.vertices);
        Array<Point> positions;
        Array<Color<C>> colors;
        positions.reserve(vertices.size());
        colors.reserve(vertices.size());
        for (const std::uint32_t v : vertices) {
            positions.push_back({indexed.positions[v].x - box_.x, indexed.positions[v].y - box_.y});
            colors.push_back(indexed.colors[v]);
        }
        const Status status = mesh_.assign(positions, numbered_.faces, colors, parallel_for);
        HMESH_ASSERT(status);
        (void)status;
        first_energy_ = mesh_.energy();
        for (std::size_t k = 0; k < vertices.size(); ++k) mesh_.set_dirty(Vertex(k), indexed.dirty[vertices[k]] != 0);
        for (std::size_t k = 0; k < free_; ++k)
            if (vertices[k] < indexed.locked_count) was_locked_.emplace_back(k);
        for (std::size_t k = 0; k < numbered_.locked.size(); ++k) {
            // Each fan of a locked vertex may grow in proportion to its faces: together they stay within max_valence.
            const detail::PatchFaces::Locked& f = numbered_.locked[k];
            mesh_.lock(Vertex(free_ + k), f.face_count * (max_valence - 1) / cut.face_count[f.vertex] + 1);
        }
    }
    Patch(const Patch&) = delete;
    Patch& operator=(const Patch&) = delete;
    HMESH_NEVER_INLINE ~Patch() = default;  ///< not a part of all who hold one

    /// The mesh to work on; coordinates are those of the patch's table, px from its upper left corner.
    [[nodiscard]] ImageMesh<C>& mesh() noexcept { return mesh_; }
    [[nodiscard]] const ImageMesh<C>& mesh() const noexcept { return mesh_; }  ///< the same to look at
    /// Tells the patch the mean energy of a vertex of the whole mesh, which tolerances use; 0: it is not known.
    void set_mean_energy(double mean) noexcept {
        mesh_.set_scale(1);
        // A patch without error would ask for an infinite scale.
        if (mean > 0 && mesh_.energy() > 0) mesh_.set_scale(std::min(1e3, mean / mesh_.mean_energy()));
    }
    /// The energy with which the patch began.
    [[nodiscard]] double first_energy() const noexcept { return first_energy_; }
    /// The vertices that are not locked, in spatial order.
    [[nodiscard]] HMESH_PATCHWISE Array<Vertex> free_vertices() const {
        Array<Vertex> vertices = spatial_vertices(mesh_);
        vertices.erase(std::remove_if(vertices.begin(), vertices.end(),
                                      [&](Vertex v) { return mesh_.vertex(v).mobility == Mobility::locked; }),
                       vertices.end());
        return vertices;
    }
    /// The vertices that are free here and were locked in the phase before, in spatial order, as far as they are left; handed out
    /// once, then none.
    [[nodiscard]] HMESH_PATCHWISE Array<Vertex> take_was_locked() {
        was_locked_.erase(
            std::remove_if(was_locked_.begin(), was_locked_.end(), [&](Vertex v) { return mesh_.topology().is_deleted(v); }),
            was_locked_.end());
        const Array<Vertex> vertices = std::exchange(was_locked_, {});
        return in_spatial_order<Vertex>(vertices, vertices.size(), [&](Vertex v) { return mesh_.position(v); });
    }
    /// The same and their free neighbours, which could not do all that they can either.
    [[nodiscard]] HMESH_PATCHWISE Array<Vertex> take_hindered() {
        Array<Vertex> vertices = take_was_locked();
        Array<unsigned char> known(mesh_.topology().vertex_slots(), 0);
        for (const Vertex v : vertices) known[v.index()] = 1;
        const std::size_t count = vertices.size();
        for (std::size_t k = 0; k < count; ++k)
            for (const Halfedge h : mesh_.topology().outgoing(vertices[k])) {
                const Vertex u = mesh_.topology().to_vertex(h);
                if (mesh_.vertex(u).mobility == Mobility::locked || std::exchange(known[u.index()], 1) != 0) continue;
                vertices.push_back(u);
            }
        return in_spatial_order<Vertex>(vertices, vertices.size(), [&](Vertex v) { return mesh_.position(v); });
    }
    /// All vertices of the patch, a locked one once for each of its fans.
    [[nodiscard]] std::size_t vertex_count() const noexcept { return mesh_.vertex_count(); }
    /// Vertices that may be changed and removed: all but the locked ones.
    [[nodiscard]] std::size_t free_count() const noexcept { return mesh_.vertex_count() - numbered_.locked.size(); }

    /// The patch as it is now, in the coordinates of the whole image; free vertices and faces are in spatial order.
    [[nodiscard]] HMESH_PATCHWISE detail::PatchResult<C> result() const {
        detail::PatchResult<C> out;
        Array<std::uint32_t> number(mesh_.topology().vertex_slots());
        const auto is_locked = [&](Vertex v) { return v.index() >= free_ && v.index() < free_ + numbered_.locked.size(); };
        out.positions.reserve(free_count());
        out.colors.reserve(free_count());
        out.dirty.reserve(free_count());
        for (const Vertex v : spatial_vertices(mesh_)) {
            if (is_locked(v)) continue;
            number[v.index()] = static_cast<std::uint32_t>(out.positions.size());
            const Point p = mesh_.position(v);
            out.positions.push_back({p.x + box_.x, p.y + box_.y});
            out.colors.push_back(detail::tight<C>(mesh_.color(v)));
            out.dirty.push_back(mesh_.is_dirty(v) ? 1 : 0);
        }
        out.locked.reserve(numbered_.locked.size());
        for (std::size_t k = 0; k < numbered_.locked.size(); ++k) {
            number[free_ + k] = static_cast<std::uint32_t>(free_count() + k);
            out.locked.push_back(numbered_.locked[k].vertex);
            if (mesh_.is_dirty(Vertex(free_ + k))) out.locked_dirty.push_back(numbered_.locked[k].vertex);
        }
        out.faces.reserve(mesh_.topology().face_count());
        for (const Face f : spatial_faces(mesh_)) {
            const auto v = mesh_.topology().vertices(f);
            out.faces.push_back({number[v[0].index()], number[v[1].index()], number[v[2].index()]});
        }
        out.first_energy = first_energy_;
        out.energy = mesh_.energy();
        return out;
    }

  private:
    /// The pixels around all vertices of the patch. A periodic mesh stands out of the image, also to the left and above.
    [[nodiscard]] HMESH_PATCHWISE Rect box_of(const IndexedMesh<C>& indexed) const {
        Point low{1e9, 1e9}, high{-1e9, -1e9};
        for (const std::uint32_t v : numbered_.vertices) {
            const Point p = indexed.positions[v];
            low = {std::min(low.x, p.x), std::min(low.y, p.y)};
            high = {std::max(high.x, p.x), std::max(high.y, p.y)};
        }
        const int x = static_cast<int>(std::floor(low.x)), y = static_cast<int>(std::floor(low.y));
        return {x, y, static_cast<int>(std::ceil(high.x)) - x, static_cast<int>(std::ceil(high.y)) - y};
    }
    [[nodiscard]] PatchContext context_of(const IndexedMesh<C>& indexed, const ImageSource<C>& source) const {
        PatchContext context;
        context.image = {-box_.x, -box_.y, source.width(), source.height()};
        context.is_part = !numbered_.locked.empty();
        context.periodic = source.periodic();
        context.has_seams = source.has_straight_seams();
        context.samples = source.samples();
        context.has_fixed_border = indexed.has_fixed_border;
        return context;
    }

    detail::PatchFaces numbered_;
    std::size_t free_;  ///< slots [0, free_) began as free vertices, then come the locked ones, later slots are new vertices
    Rect box_;          ///< that the table of its own is of; or none, at the origin
    double first_energy_ = 0;
    Array<Vertex> was_locked_;
    MomentTable<C> table_;  ///< of its own, or empty
    ImageMesh<C> mesh_;
};

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_TILES_PATCH_HPP
