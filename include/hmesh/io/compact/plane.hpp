/// \file
/// Exact plane geometry in whole numbers: orientation, circles, angles.
///
/// Coordinates are in steps of 1/256 px and differ by at most 2^25. Nothing here rounds, so that every machine decides alike; a
/// triangle (a, b, c) is positive if orient2d(a, b, c) > 0, which looks clockwise on the screen as y runs down.
#ifndef HMESH_IO_COMPACT_PLANE_HPP
#define HMESH_IO_COMPACT_PLANE_HPP

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "hmesh/mesh/geometry.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

using kit::GridPoint;
using kit::orient2d;

/// The place of d relative to the circle through the positive a, b, c: 1 inside, 0 on it, -1 outside.
[[nodiscard]] inline int in_circle_sign(GridPoint a, GridPoint b, GridPoint c, GridPoint d) noexcept {
    const std::int64_t ax = std::int64_t{a.x} - d.x, ay = std::int64_t{a.y} - d.y, bx = std::int64_t{b.x} - d.x,
                       by = std::int64_t{b.y} - d.y, cx = std::int64_t{c.x} - d.x, cy = std::int64_t{c.y} - d.y;
    const std::int64_t sa = ax * ax + ay * ay, sb = bx * bx + by * by, sc = cx * cx + cy * cy;
    const std::int64_t pa = bx * cy - cx * by, pb = cx * ay - ax * cy, pc = ax * by - bx * ay;
    // Of distances below 2^15 each product is below 2^61: |p| is at most half of the sum of two squares.
    constexpr std::int64_t within = std::int64_t{1} << 30;
    if (sa < within && sb < within && sc < within) {
        const std::int64_t sum = sa * pa + sb * pb + sc * pc;
        return sum > 0 ? 1 : sum < 0 ? -1 : 0;
    }
    return kit::detail::sign_of_products({sa, sb, sc}, {pa, pb, pc});
}

/// The angle at p between a and b, (p, a, b) positive, in 64ths of a half turn: 0 to 63, of which 31 is up to a right angle.
[[nodiscard]] inline int angle64(GridPoint p, GridPoint a, GridPoint b) noexcept {
    // 64 cot(k pi / 64), rounded, for k = 1 .. 32.
    static constexpr std::array<std::int16_t, 32> cotangents{1303, 650, 431, 322, 256, 211, 179, 155, 135, 120, 107,
                                                             96,   86,  78,  71,  64,  58,  53,  47,  43,  38,  34,
                                                             30,   27,  23,  19,  16,  13,  9,   6,   3,   0};
    // How many of them are above a whole number.
    static constexpr auto above = [] {
        std::array<std::uint8_t, 1304> table{};
        for (std::size_t q = 0; q < table.size(); ++q)
            while (table[q] < cotangents.size() && cotangents[table[q]] > static_cast<int>(q)) ++table[q];
        return table;
    }();
    const std::int64_t product = kit::along(p, p, a, b), area = orient2d(p, a, b);
    const auto size = static_cast<std::uint64_t>(64 * (product < 0 ? -product : product)),
               unit = static_cast<std::uint64_t>(area);
    // A cotangent is above a fraction where it is above its whole part, and above none where that is 1304 or more. Of short edges
    // 32 bits hold all: a third of the time.
    const bool is_short = (size | unit) >> 32U == 0;
    const std::uint64_t cotangent = is_short ? static_cast<std::uint32_t>(size) / static_cast<std::uint32_t>(unit) : size / unit;
    const int k = above[static_cast<std::size_t>(std::min<std::uint64_t>(cotangent, above.size() - 1))];
    return product >= 0 ? k : 63 - k;
}

}  // namespace hmesh::detail

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_COMPACT_PLANE_HPP
