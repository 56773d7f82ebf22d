/// \file
/// Sheet: a bounded mesh as arrays, whole or a part of it, and what each vertex is free to do.
#ifndef HMESH_METHODS_BOUNDED_SHEET_HPP
#define HMESH_METHODS_BOUNDED_SHEET_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "hmesh/core/array.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/methods/bounded/face_error.hpp"
#include "hmesh/methods/bounded/height_field.hpp"
#include "hmesh/tiles/fans.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// What a vertex is free to do, as a set of bits.
enum Freedom : std::uint8_t {
    can_lift = 1,      ///< its heights may change
    can_slide_x = 2,   ///< it may move along a row
    can_slide_y = 4,   ///< and along a column
    can_leave = 8,     ///< it may be removed
    on_rim = 16,       ///< it is on the border of what has data, within the image, and is removed along it only
    on_side = 32,      ///< it is on a side of the image, likewise
    is_locked = 64,    ///< it is part of the border of a tile: nothing of the above, for now
    is_settled = 128,  ///< nothing around it has changed since its removal was tried
};

/// A bounded mesh as arrays.
struct Sheet {
    Array<Corner> vertices;       ///< where they stand and how high
    Array<std::uint8_t> freedom;  ///< bits of Freedom, for each vertex
    Array<Triangle> faces;        ///< positively oriented
};

/// Gives each fan of faces a vertex of its own, and drops vertices without faces; the others keep their order. Returns which one
/// each vertex of the new sheet was before. O(n log n).
HMESH_COLD inline Array<std::uint32_t> separate_fans(Sheet& sheet) {
    Array<FanCorner> corners;
    corners.reserve(3 * sheet.faces.size());
    for (std::size_t f = 0; f < sheet.faces.size(); ++f)
        for (std::size_t k = 0; k < 3; ++k)
            corners.push_back({sheet.faces[f][k], static_cast<std::uint32_t>(f), static_cast<std::uint32_t>(k),
                               sheet.faces[f][(k + 1) % 3], sheet.faces[f][(k + 2) % 3], 0});
    Sheet out;
    out.faces = sheet.faces;
    Array<std::uint32_t> origin;
    Array<std::uint32_t> number;  // of the fan that begins at a corner, by the corner's place
    find_fans(corners, [&](std::size_t begin, std::size_t end) {
        number.assign(end - begin, 0);
        for (std::size_t i = begin; i < end; ++i) {
            if (corners[i].fan == i) {
                number[i - begin] = static_cast<std::uint32_t>(out.vertices.size());
                out.vertices.push_back(sheet.vertices[corners[i].vertex]);
                out.freedom.push_back(sheet.freedom[corners[i].vertex]);
                origin.push_back(corners[i].vertex);
            }
            out.faces[corners[i].face][corners[i].corner] = number[corners[i].fan - begin];
        }
    });
    sheet = std::move(out);
    return origin;
}

/// The vertices that are on the border of the sheet: 1 for these.
[[nodiscard]] HMESH_COLD inline Array<std::uint8_t> border_vertices(const Sheet& sheet) {
    Array<std::uint64_t> sides;
    sides.reserve(3 * sheet.faces.size());
    for (const Triangle& t : sheet.faces)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t a = t[k], b = t[(k + 1) % 3];
            sides.push_back(std::uint64_t{std::min(a, b)} << 32U | std::max(a, b));
        }
    std::sort(sides.begin(), sides.end());
    Array<std::uint8_t> border(sheet.vertices.size(), 0);
    for (std::size_t k = 0, end = 0; k < sides.size(); k = end) {
        while (end < sides.size() && sides[end] == sides[k]) ++end;
        const auto a = static_cast<std::size_t>(sides[k] >> 32U), b = static_cast<std::size_t>(sides[k] & 0xffffffffU);
        if (end - k == 1) border[a] = border[b] = 1;
    }
    return border;
}

/// Whether what has data begins or ends at p, a place on a side of the image, which is upright or level.
[[nodiscard]] inline bool is_end_of_side(const HeightField& field, Point p, bool upright) noexcept {
    if (field.data.empty()) return false;
    const int x = std::min(static_cast<int>(p.x), field.right() - 1), y = std::min(static_cast<int>(p.y), field.bottom() - 1);
    if (upright) return static_cast<double>(y) == p.y && field.is_cell(x, y - 1) != field.is_cell(x, y);
    return static_cast<double>(x) == p.x && field.is_cell(x - 1, y) != field.is_cell(x, y);
}

/// Sets what each vertex of a sheet that is the whole mesh is free to do.
HMESH_COLD inline void set_freedom(Sheet& sheet, const HeightField& field, bool free_borders) {
    // A mesh of all samples has no border but the sides.
    const Array<std::uint8_t> border = field.data.empty() ? Array<std::uint8_t>() : border_vertices(sheet);
    for (std::size_t v = 0; v < sheet.vertices.size(); ++v) {
        const Point p = sheet.vertices[v].position;
        const bool upright = p.x == 0 || p.x == field.right(), level = p.y == 0 || p.y == field.bottom();
        const bool is_inside = p.x > 0 && p.x < field.right() && p.y > 0 && p.y < field.bottom();
        std::uint8_t freedom = can_lift | can_leave | can_slide_x | can_slide_y;
        if (is_inside && !border.empty() && border[v] != 0) freedom = can_lift | can_leave | on_rim;
        if (!is_inside) {
            freedom = on_side;
            if (free_borders) freedom |= can_lift;
            if (free_borders && upright != level && !is_end_of_side(field, p, upright))
                freedom |= can_leave | (upright ? can_slide_y : can_slide_x);
        }
        sheet.freedom[v] = freedom;
    }
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_BOUNDED_SHEET_HPP
