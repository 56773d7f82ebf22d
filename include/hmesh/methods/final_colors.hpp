/// \file
/// Final colors: sampled or bounded colours for all vertices of a tiled mesh, the last step of every recipe. What gives a mesh
/// its colours returns how far it is from a sample at most, see largest_error(); 0 for samples that are floats or have weights.
///
/// Cost: 2 us a vertex in tiles, 1 us in one piece; of an image without a table of its own three moment tables for each tile; for
/// whole numbers 1 ns a pixel for the largest error.
#ifndef HMESH_METHODS_FINAL_COLORS_HPP
#define HMESH_METHODS_FINAL_COLORS_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/core/array.hpp"
#include "hmesh/core/assert.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/fit/image_mesh.hpp"
#include "hmesh/fit/largest_error.hpp"
#include "hmesh/methods/stage.hpp"
#include "hmesh/solve/bounded_colors.hpp"
#include "hmesh/solve/sampled_colors.hpp"
#include "hmesh/solve/tied_colors.hpp"
#include "hmesh/tiles/tiled_mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

namespace detail {

/// Measures the mesh's energy, each patch after work(), where set.
template <int C>
[[nodiscard]] HMESH_COLD double measure_finally(TiledMesh<C>& tiled, const Tiling& tiling,
                                                typename TiledMesh<C>::PatchLook work = {}) {
    Array<double> largest(tiling.size(), 0.0);
    tiled.measure(tiling, [&](Patch<C>& patch, std::size_t tile, const std::uint32_t* faces) {
        if (work) work(patch, tile, faces);
        if (tiled.source().has_plain_samples()) largest[tile] = largest_error(patch.mesh());
    });
    return *std::max_element(largest.begin(), largest.end());
}

/// Calls give(k, color) for each k < count with the colour of the image at at(k), bilinear; beyond the sides of a periodic image
/// it goes on. In any order.
template <int C>
HMESH_COLD void find_colors(const ImageSource<C>& source, std::size_t count, FunctionRef<Point(std::size_t k)> at,
                            FunctionRef<void(std::size_t k, const Color<C>& color)> give) {
    const Torus torus{source.width(), source.height(), source.periodic()};
    // In the middle of three images, which go on on both sides.
    const bool x = wraps_x(source.periodic()), y = wraps_y(source.periodic());
    const int left = x ? source.width() : 0, top = y ? source.height() : 0;
    const auto place = [&](std::size_t k) { return inside(at(k), torus); };
    source.visit(count, place, [&](const SourceWindow<C>& window, std::size_t k) {
        const Point p = place(k);
        give(k, sampled_color<C>((x ? 3 : 1) * source.width(), (y ? 3 : 1) * source.height(), {p.x + left, p.y + top},
                                 [&](int i, int j) { return window.pixel(i - left, j - top); }));
    });
}

/// bounded_colors() of a periodic mesh, in which a vertex and its copies are one. Vertices on a straight border are tied to the
/// image's colour there, as if that were a quarter of a pixel: the few pixels beside the seam would else leave some of them free
/// to be anything, which shows as a spike where the picture is enlarged.
template <int C>
HMESH_COLD double tied_colors(TiledMesh<C>& tiled, const Tiling& tiling, ColorRange range) {
    constexpr double tie_weight = 0.25;
    const ImageSource<C>& source = tiled.source();
    Array<CornerSums<C>> corners(3 * tiled.indexed().faces.size(), raw);
    clear(tiled.parallel_for(), corners.data(), corners.size() * sizeof(CornerSums<C>));  // to be added to
    tiled.visit(tiling, [&](Patch<C>& patch, std::size_t, const std::uint32_t* faces) {
        for (const Face f : patch.mesh().topology().faces()) {
            const std::size_t k = 3 * std::size_t{faces[f.index()]};
            sum_face(patch.mesh(), f, corners[k], corners[k + 1], corners[k + 2]);
        }
    });
    if (tiled.progress().stopped()) std::fill(corners.begin(), corners.end(), CornerSums<C>());  // only the ridge is left
    IndexedMesh<C>& mesh = tiled.indexed();
    const TiedRows tied = tied_rows(mesh.roots);
    Array<std::uint32_t> rows;
    Array<Color<C>> colors;
    Array<ColorTie<C>> ties;
    Array<Point> tie_points;
    colors.reserve(tied.vertices.size());
    for (const std::uint32_t v : tied.vertices) {
        colors.push_back(mesh.colors[v]);
        clamp_channels<C>(colors.back(), range.low, range.high);
        if (!source.has_straight_seams() || tiled.progress().stopped()) continue;
        const Point p = mesh.positions[v];
        if ((wraps_x(mesh.periodic) && std::fmod(p.x, mesh.width) == 0) ||
            (wraps_y(mesh.periodic) && std::fmod(p.y, mesh.height) == 0)) {
            ties.push_back({tied.rows[v], tie_weight, Color<C>::zero()});
            tie_points.push_back(p);
        }
    }
    find_colors<C>(
        source, ties.size(), [&](std::size_t k) { return tie_points[k]; },
        [&](std::size_t k, const Color<C>& color) { ties[k].color = color; });
    rows.reserve(corners.size());
    for (const Triangle& face : mesh.faces)
        for (const std::uint32_t v : face) rows.push_back(tied.rows[v]);
    const auto system = tied_color_system(rows, corners, ties, colors, tiled.limits().ridge, tiled.parallel_for());
    (void)descend(system, range, colors, [&] { return tiled.progress().poll(); });
    for (std::size_t v = 0; v < mesh.colors.size(); ++v) mesh.colors[v] = colors[tied.rows[v]];
    return measure_finally(tiled, tiling);
}

/// Some faces of a mesh, and their sums.
template <int C>
struct SummedFaces {
    Array<std::uint32_t> vertices;  ///< three of each face
    Array<CornerSums<C>> corners;   ///< of the same
};

/// bounded_colors() of some of a mesh's vertices, those with is_solved[v] == 0, all of whose faces are among the `parts`.
template <int C>
HMESH_COLD void solve_rest(Array<Color<C>>& colors, const Array<unsigned char>& is_solved,
                           const std::vector<SummedFaces<C>>& parts, ColorRange range, double ridge) {
    constexpr std::uint32_t none = 0xffffffffU;
    Array<std::uint32_t> row_of(colors.size(), none), vertex_of, rows;
    Array<CornerSums<C>> corners;
    Array<Color<C>> its;
    for (const SummedFaces<C>& part : parts) {
        for (const std::uint32_t v : part.vertices) {
            if (row_of[v] == none) {
                row_of[v] = static_cast<std::uint32_t>(vertex_of.size());
                vertex_of.push_back(v);
                its.push_back(colors[v]);
            }
            rows.push_back(row_of[v]);
        }
        for (const CornerSums<C>& corner : part.corners) corners.push_back(corner);
    }
    auto system = tied_color_system<C>(rows, corners, {}, its, ridge);
    for (std::size_t k = 0; k < vertex_of.size(); ++k)
        if (is_solved[vertex_of[k]] != 0) system.hold(k);
    (void)descend(system, range, its);
    for (std::size_t k = 0; k < vertex_of.size(); ++k) colors[vertex_of[k]] = its[k];
}

/// bounded_colors() of a mesh tile by tile, so that all threads work and nothing but the mesh is as large as it. What the border
/// of a tile holds is felt a few rings of vertices away. So first come those that are free in one tiling, as if there were
/// nothing beyond its borders, whose colours may be far from their best; then those that are free in another, whose borders hold
/// what has been found; then the few that are free in neither, all at once; then again those of the first. 0.001 dB are lost at
/// most.
template <int C>
HMESH_COLD double colors_by_tiles(TiledMesh<C>& tiled, double tile, ColorRange range) {
    const ImageSource<C>& source = tiled.source();
    const Tiling first = tiled.tiling_or(Tiling(source.width(), source.height(), tile));
    const Tiling second(source.width(), source.height(), tile, true, true);
    tiled.for_each(first, [&](Patch<C>& patch, std::size_t) {
        ImageMesh<C>& part = patch.mesh();
        (void)bounded_colors(part, range, {}, {}, !part.has_fixed_border());
    });
    IndexedMesh<C>& mesh = tiled.indexed();
    for (Color<C>& color : mesh.colors) to_allowed<C>(color, range);
    Array<unsigned char> is_solved(mesh.vertex_count(), 1);
    for (std::size_t v = 0; v < mesh.locked_count; ++v) is_solved[v] = mesh.has_fixed_border && mesh.is_on_border(v) ? 1 : 0;
    const auto solve = [&](Patch<C>& patch, std::size_t, const std::uint32_t* faces) {
        if (tiled.progress().stopped()) return;
        ImageMesh<C>& part = patch.mesh();
        (void)bounded_colors(part, range);
        // No other tile reads or writes what is known of this one's free vertices.
        for (const Face f : part.topology().faces()) {
            const auto vertices = part.topology().vertices(f);
            for (std::size_t c = 0; c < 3; ++c) {
                if (part.vertex(vertices[c]).mobility == Mobility::locked) continue;
                const std::uint32_t v = mesh.faces[faces[f.index()]][c];
                mesh.colors[v] = part.color(vertices[c]);
                is_solved[v] = 1;
            }
        }
    };
    std::vector<SummedFaces<C>> rest(second.size());
    tiled.visit(second, [&](Patch<C>& patch, std::size_t k, const std::uint32_t* faces) {
        solve(patch, k, faces);
        for (const Face f : patch.mesh().topology().faces()) {
            const Triangle& at = mesh.faces[faces[f.index()]];
            if (is_solved[at[0]] != 0 && is_solved[at[1]] != 0 && is_solved[at[2]] != 0) continue;
            CornerSums<C> sums[3];
            sum_face(patch.mesh(), f, sums[0], sums[1], sums[2]);
            for (std::size_t c = 0; c < 3; ++c) {
                rest[k].vertices.push_back(at[c]);
                rest[k].corners.push_back(sums[c]);
            }
        }
    });
    if (!tiled.progress().stopped()) solve_rest(mesh.colors, is_solved, rest, range, tiled.limits().ridge);
    return measure_finally<C>(tiled, first, solve);
}

}  // namespace detail

/// Gives all vertices the colours of the image at their positions (solve/sampled_colors.hpp), rounded to multiples of `grid`
/// where grid > 0.
template <int C>
HMESH_COLD void take_sampled_colors(IndexedMesh<C>& mesh, const ImageSource<C>& source, double grid = 0) {
    detail::find_colors<C>(
        source, mesh.vertex_count(), [&](std::size_t v) { return mesh.positions[v]; },
        [&](std::size_t v, const Color<C>& sampled) {
            Color<C>& color = mesh.colors[v] = sampled;
            if (grid > 0)
                for (int c = 0; c < C; ++c) color.set(c, std::floor(color[c] / grid + 0.5) * grid);
        });
}
/// The same, which measures the mesh's energy with them, in tiles of `tile` px.
template <int C>
HMESH_COLD double sample_colors(TiledMesh<C>& tiled, double tile, double grid) {
    const ImageSource<C>& source = tiled.source();
    take_sampled_colors(tiled.indexed(), source, grid);
    return detail::measure_finally(tiled, Tiling(source.width(), source.height(), tile));
}

/// Gives all vertices the colours of least squared error that a range allows (solve/bounded_colors.hpp), and measures the mesh's
/// energy with them, in tiles of `tile` px; those of periodic meshes, and of few vertices, all at once. After a cancellation
/// colours are only clamped and rounded, and the energy is still true of them.
template <int C>
HMESH_COLD double bounded_colors(TiledMesh<C>& tiled, double tile, ColorRange range) {
    const ImageSource<C>& source = tiled.source();
    const Tiling tiling(source.width(), source.height(), tile);
    if (source.periodic() != Periodic::none) return detail::tied_colors(tiled, tiling, range);
    // Of fewer vertices a tile most would be at its border. They take no time.
    constexpr std::size_t few = 64;
    const bool at_once = tiling.size() == 1 || (tiled.is_small() && tiled.vertex_count() < few * tiling.size());
    double largest = 0;
    const bool is_done = at_once && tiled.for_each(one_tile(source), [&](Patch<C>& patch, std::size_t) {
        (void)bounded_colors(patch.mesh(), range, tiled.parallel_for(), [&] { return tiled.progress().poll(); });
        if (source.has_plain_samples()) largest = largest_error(patch.mesh(), tiled.parallel_for());
    });
    return is_done ? largest : detail::colors_by_tiles(tiled, tile, range);
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_FINAL_COLORS_HPP
