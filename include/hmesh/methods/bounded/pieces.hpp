/// \file
/// Pieces: an image of any size meshed in tiles, on any number of threads, with the same bytes.
///
/// Each tile is meshed by itself: its sides follow from the samples along them alone (methods/bounded/side.hpp), so that tiles
/// meet. Then the mesh is cut again, along lines half a tile off, three times: what was a side is inside now, and its vertices
/// leave like others. A vertex with faces in several pieces is locked while these are at work. What has been tried in one phase
/// is not tried again in the next unless something around it was locked. Memory follows the mesh, not the image.
#ifndef HMESH_METHODS_BOUNDED_PIECES_HPP
#define HMESH_METHODS_BOUNDED_PIECES_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "hmesh/core/array.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/core/progress.hpp"
#include "hmesh/methods/bounded/bounded_mesh.hpp"
#include "hmesh/methods/bounded/domain.hpp"
#include "hmesh/methods/bounded/height_field.hpp"
#include "hmesh/methods/bounded/insertion.hpp"
#include "hmesh/methods/bounded/options.hpp"
#include "hmesh/methods/bounded/removal.hpp"
#include "hmesh/methods/bounded/sheet.hpp"
#include "hmesh/tiles/tiling.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// The side of a tile, in px: its mesh and samples fit the cache of a core, and seams are few.
inline constexpr double bounded_tile = 512;

namespace detail {

/// A piece of a sheet, with the places of its vertices there.
struct SheetPiece {
    Sheet sheet;
    Array<std::uint32_t> origin;  // of each vertex: its number in the whole
};

/// The pieces of a sheet by tiles of a tiling; vertices with faces in several are locked in each.
[[nodiscard]] HMESH_COLD inline std::vector<SheetPiece> cut(const Sheet& whole, const Tiling& tiling) {
    constexpr std::uint32_t none = 0xffffffffU, several = 0xfffffffeU;
    std::vector<SheetPiece> pieces(tiling.size());
    Array<std::uint32_t> tile_of(whole.faces.size()), owner(whole.vertices.size(), none), number(whole.vertices.size(), none);
    for (std::size_t f = 0; f < whole.faces.size(); ++f) {
        const Triangle& t = whole.faces[f];
        tile_of[f] = static_cast<std::uint32_t>(tiling.tile_at(
            centroid(whole.vertices[t[0]].position, whole.vertices[t[1]].position, whole.vertices[t[2]].position)));
        for (const std::uint32_t v : t) owner[v] = owner[v] == none || owner[v] == tile_of[f] ? tile_of[f] : several;
    }
    for (std::size_t f = 0; f < whole.faces.size(); ++f) pieces[tile_of[f]].sheet.faces.push_back(whole.faces[f]);
    for (SheetPiece& piece : pieces) {
        for (Triangle& t : piece.sheet.faces)
            for (std::uint32_t& v : t) {
                if (number[v] == none) {
                    number[v] = static_cast<std::uint32_t>(piece.origin.size());
                    piece.origin.push_back(v);
                    piece.sheet.vertices.push_back(whole.vertices[v]);
                    const std::uint8_t locked = owner[v] == several ? is_locked : 0;
                    piece.sheet.freedom.push_back(static_cast<std::uint8_t>(whole.freedom[v] | locked));
                }
                v = number[v];
            }
        for (const std::uint32_t v : piece.origin) number[v] = none;
        // Two fans of one piece may meet in a locked vertex.
        Array<std::uint32_t> places = separate_fans(piece.sheet);
        for (std::uint32_t& v : places) v = piece.origin[v];
        piece.origin = std::move(places);
    }
    return pieces;
}

/// Vertices by position, to find those that two pieces share: the number of the first with this position and these heights.
[[nodiscard]] HMESH_COLD inline Array<std::uint32_t> shared_numbers(const Sheet& sheet) {
    Array<std::uint32_t> order;
    for (std::size_t v = 0; v < sheet.vertices.size(); ++v)
        if ((sheet.freedom[v] & is_locked) != 0) order.push_back(static_cast<std::uint32_t>(v));
    const auto before = [&](std::uint32_t a, std::uint32_t b) {
        const Point p = sheet.vertices[a].position, q = sheet.vertices[b].position;
        return p.y != q.y ? p.y < q.y : p.x != q.x ? p.x < q.x : a < b;
    };
    std::sort(order.begin(), order.end(), before);
    Array<std::uint32_t> number(sheet.vertices.size());
    for (std::size_t v = 0; v < number.size(); ++v) number[v] = static_cast<std::uint32_t>(v);
    for (std::size_t k = 1; k < order.size(); ++k)
        if (sheet.vertices[order[k]].position == sheet.vertices[order[k - 1]].position) number[order[k]] = number[order[k - 1]];
    return number;
}

}  // namespace detail

/// What face_error() may be, and what the border may be off.
struct BoundedLimits {
    double inside = 0;               ///< face_error()
    double seams = 0;                ///< of the border of a tile, where it is none of the image
    double sides[image_sides] = {};  ///< of the border of the image
};

/// Meshes a field in tiles.
class BoundedPieces {
  public:
    /// Of this field, within these limits.
    BoundedPieces(const HeightField& field, const BoundedLimits& limits, const Bounded& recipe, ProgressReporter& progress,
                  const ParallelFor& parallel_for)
        : field_(&field), limits_(limits), recipe_(recipe), progress_(&progress), parallel_for_(parallel_for) {}

    /// The mesh, or what there was of it that holds when progress said stop: an empty one while samples were being inserted.
    /// `energy` gives that of a sheet, for progress.
    [[nodiscard]] HMESH_COLD Sheet run(FunctionRef<double(const Sheet&)> energy) {
        const int width = field_->right(), height = field_->bottom();
        const auto tiling = [&](bool shift_x, bool shift_y) { return Tiling(width, height, bounded_tile, shift_x, shift_y); };
        const Tiling first = tiling(false, false);
        const bool is_whole = first.size() == 1;
        const bool is_draft = recipe_.effort == Bounded::Effort::draft || recipe_.inside_error == 0;
        if (!progress_->begin("insertion", 0, 0)) return {};
        progress_->set_range(0, 1);
        std::vector<detail::SheetPiece> pieces(first.size());
        parallel_for_(first.size(),
                      [&](std::size_t k) { pieces[k].sheet = inserted(first.rect(k), 1.0 / static_cast<double>(first.size())); });
        if (progress_->stopped()) return {};
        Sheet whole = joined(pieces);
        if (!is_whole || !field_->data.empty()) weld(whole);
        set_freedom(whole, *field_, recipe_.free_borders);
        double reached = energy(whole);
        if (!progress_->end(whole.vertices.size(), reached) || is_draft || whole.faces.empty()) return whole;

        const char* const names[] = {"removal", "seams", "seams", "seams"};
        const bool shifts[][2] = {{false, false}, {true, true}, {true, false}, {false, true}};
        for (int phase = 0; phase < (is_whole ? 1 : 4); ++phase) {
            if (!progress_->begin(names[phase], whole.vertices.size(), reached)) break;
            progress_->set_range(0, 1);
            pieces = detail::cut(whole, tiling(shifts[phase][0], shifts[phase][1]));
            const double share = 1.0 / static_cast<double>(pieces.size());
            parallel_for_(pieces.size(), [&](std::size_t k) {
                shrink_piece(pieces[k], share, phase > 0 ? 6 : recipe_.effort == Bounded::Effort::best ? 30 : 14);
            });
            whole = joined(pieces, whole);
            reached = energy(whole);
            if (!progress_->end(whole.vertices.size(), reached)) break;
        }
        return whole;
    }

  private:
    /// The mesh of a rectangle by greedy insertion.
    [[nodiscard]] Sheet inserted(const Rect& rect, double share) const {
        TaskProgress task(*progress_, share);
        const bool is_side[image_sides] = {rect.y == 0, rect.y + rect.height == field_->bottom(), rect.x == 0,
                                           rect.x + rect.width == field_->right()};
        double limits[image_sides];
        for (int k = 0; k < image_sides; ++k) limits[k] = is_side[k] ? limits_.sides[k] : limits_.seams;
        Sheet sheet = first_sheet(*field_, rect, limits, recipe_.effort >= Bounded::Effort::normal);
        // Vertices of the rectangle's sides are those that other tiles have, too.
        for (std::size_t v = 0; v < sheet.vertices.size(); ++v) {
            const Point p = sheet.vertices[v].position;
            if (p.x == rect.x || p.y == rect.y || p.x == rect.x + rect.width || p.y == rect.y + rect.height)
                sheet.freedom[v] = is_locked;
        }
        if (sheet.faces.empty()) return sheet;
        BoundedMesh mesh(*field_, limits_.inside, sheet, task);
        GreedyInsertion(mesh).run();
        return mesh.sheet();
    }
    void shrink_piece(detail::SheetPiece& piece, double share, int passes) const {
        if (piece.sheet.faces.empty()) return;
        TaskProgress task(*progress_, share);
        BoundedMesh mesh(*field_, limits_.inside, piece.sheet, task);
        shrink(mesh, recipe_.effort, passes);
        Array<std::uint32_t> origin;
        for (const Vertex v : mesh.topology.vertices()) origin.push_back(piece.origin[v.index()]);
        piece.sheet = mesh.sheet();
        piece.origin = std::move(origin);
    }
    /// Pieces one after another, each with its own vertices.
    [[nodiscard]] static Sheet joined(const std::vector<detail::SheetPiece>& pieces) {
        Sheet whole;
        for (const detail::SheetPiece& piece : pieces) {
            const auto first = static_cast<std::uint32_t>(whole.vertices.size());
            whole.vertices.insert(whole.vertices.end(), piece.sheet.vertices.begin(), piece.sheet.vertices.end());
            whole.freedom.insert(whole.freedom.end(), piece.sheet.freedom.begin(), piece.sheet.freedom.end());
            for (const Triangle& t : piece.sheet.faces) whole.faces.push_back({t[0] + first, t[1] + first, t[2] + first});
        }
        return whole;
    }
    /// Makes one vertex of those on the sides of tiles that stand in one place, and of each fan one of its own again.
    static void weld(Sheet& whole) {
        const Array<std::uint32_t> number = detail::shared_numbers(whole);
        for (Triangle& t : whole.faces)
            for (std::uint32_t& v : t) v = number[v];
        separate_fans(whole);
    }
    /// Pieces of `before` put together: locked vertices, which are as they were, are those of `before`.
    [[nodiscard]] static Sheet joined(const std::vector<detail::SheetPiece>& pieces, const Sheet& before) {
        constexpr std::uint32_t none = 0xffffffffU;
        Sheet whole;
        Array<std::uint32_t> number(before.vertices.size(), none), local;
        for (const detail::SheetPiece& piece : pieces) {
            local.clear();
            for (std::size_t v = 0; v < piece.origin.size(); ++v) {
                std::uint32_t at = none;
                const bool locked = (piece.sheet.freedom[v] & is_locked) != 0;
                if (locked) at = number[piece.origin[v]];
                if (at == none) {
                    at = static_cast<std::uint32_t>(whole.vertices.size());
                    whole.vertices.push_back(piece.sheet.vertices[v]);
                    whole.freedom.push_back(static_cast<std::uint8_t>(piece.sheet.freedom[v] & ~is_locked));
                    if (locked) number[piece.origin[v]] = at;
                }
                local.push_back(at);
            }
            for (const Triangle& t : piece.sheet.faces) whole.faces.push_back({local[t[0]], local[t[1]], local[t[2]]});
        }
        return whole;
    }

    const HeightField* field_;
    BoundedLimits limits_;
    Bounded recipe_;
    ProgressReporter* progress_;
    ParallelFor parallel_for_;
};

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_BOUNDED_PIECES_HPP
