/// \file
/// Plane geometry: points, the grid of positions, orientation, circles, barycentric coordinates.
///
/// y runs down. A face (a, b, c) is positively oriented when orient2d(a, b, c) > 0, which looks clockwise on the screen.
#ifndef HMESH_MESH_GEOMETRY_HPP
#define HMESH_MESH_GEOMETRY_HPP

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "hmesh/core/compiler.hpp"
#include "hmesh/core/lanes.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// A point of the image plane, in px, y down.
struct Point {
    double x = 0,                                                                                     ///< px from the left
        y = 0;                                                                                        ///< px from the top
    friend constexpr bool operator==(Point a, Point b) noexcept { return a.x == b.x && a.y == b.y; }  ///< same coordinates
    friend constexpr bool operator!=(Point a, Point b) noexcept { return !(a == b); }                 ///< other coordinates
};

/// The point half way from a to b.
[[nodiscard]] constexpr Point midpoint(Point a, Point b) noexcept { return {0.5 * (a.x + b.x), 0.5 * (a.y + b.y)}; }
/// The mean of the corners a, b, c of a triangle.
[[nodiscard]] constexpr Point centroid(Point a, Point b, Point c) noexcept {
    return {(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3};
}

/// A number without its fraction, as an integer; x in [0, 2^31). Of a conversion engines of WebAssembly make a dozen instructions
/// and a branch, since it may trap; of this half as many, and none.
[[nodiscard]] HMESH_ALWAYS_INLINE int truncated(double x) noexcept {
#if defined(__wasm__) && !defined(__FAST_MATH__)
    constexpr double shift = 6755399441055744;  // 1.5 * 2^52: in a sum with it the last bits are those of the nearest integer
    const double sum = x + shift;
    std::int64_t bits;
    std::memcpy(&bits, &sum, sizeof bits);
    return static_cast<std::int32_t>(bits) - (sum - shift > x ? 1 : 0);
#else
    return static_cast<int>(x);
#endif
}

/// Steps a px of the grid of positions, 1/256 px: exact in float, the sub-pixel grid of GPUs, and fine enough to cost no
/// fidelity (rounding to 1/16 px would cost 0.02 dB). Coordinates are >= 0.
inline constexpr double grid_steps = 256;
/// A coordinate rounded to the nearest step of the 1/256 px grid, halves up. x in [0, 2^23 - 1/512).
[[nodiscard]] HMESH_ALWAYS_INLINE double snap(double x) noexcept {
    return static_cast<double>(truncated(x * grid_steps + 0.5)) * (1 / grid_steps);
}
/// A coordinate rounded to the nearest multiple of a step that is a power of two, halves up. x in [0, (2^31 - 1/2) step).
[[nodiscard]] HMESH_ALWAYS_INLINE double snap(double x, double step) noexcept {
    return static_cast<double>(truncated(x / step + 0.5)) * step;
}
/// A point rounded to the 1/256 px grid.
[[nodiscard]] HMESH_ALWAYS_INLINE Point snap(Point p) noexcept { return {snap(p.x), snap(p.y)}; }
/// Whether a point is one that snap() leaves where it is; of any numbers, NaN among them.
[[nodiscard]] inline bool is_on_grid(Point p) noexcept {
    const auto is_snapped = [](double x) { return x >= 0 && x <= 8388608 - 1 / grid_steps && snap(x) == x; };
    return is_snapped(p.x) && is_snapped(p.y);
}

/// Twice the signed area of the triangle (a, b, c), in px^2. Exact on the 1/256 px grid for coordinates below 2^16.
[[nodiscard]] HMESH_ALWAYS_INLINE double orient2d(Point a, Point b, Point c) noexcept {
    return (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
}

/// A point with whole coordinates, such as steps of the grid of 1/256 px.
struct GridPoint {
    std::int32_t x = 0,                                                                                       ///< to the right
        y = 0;                                                                                                ///< down
    friend constexpr bool operator==(GridPoint a, GridPoint b) noexcept { return a.x == b.x && a.y == b.y; }  ///< same place
    friend constexpr bool operator!=(GridPoint a, GridPoint b) noexcept { return !(a == b); }                 ///< other place
};
/// Twice the signed area of the triangle (a, b, c), exact for coordinates that differ by less than 2^30.
[[nodiscard]] constexpr std::int64_t orient2d(GridPoint a, GridPoint b, GridPoint c) noexcept {
    return (std::int64_t{b.x} - a.x) * (std::int64_t{c.y} - a.y) - (std::int64_t{c.x} - a.x) * (std::int64_t{b.y} - a.y);
}
/// How far p is from o on in the direction from a to b, times the length of that; exact for coordinates that differ by less than
/// 2^30.
[[nodiscard]] constexpr std::int64_t along(GridPoint o, GridPoint a, GridPoint b, GridPoint p) noexcept {
    return (std::int64_t{b.x} - a.x) * (std::int64_t{p.x} - o.x) + (std::int64_t{b.y} - a.y) * (std::int64_t{p.y} - o.y);
}

namespace detail {

/// The sign of a0 b0 + a1 b1 + a2 b2 for |a|, |b| <= 2^51. In digits of 26 bits no product and no sum leaves 64 bits.
[[nodiscard]] inline int sign_of_products(const std::int64_t (&a)[3], const std::int64_t (&b)[3]) noexcept {
    constexpr std::int64_t base = std::int64_t{1} << 26;
    std::int64_t high = 0, middle = 0, low = 0;
    for (int k = 0; k < 3; ++k) {
        const std::int64_t a1 = a[k] / base, a0 = a[k] % base, b1 = b[k] / base, b0 = b[k] % base;
        high += a1 * b1;
        middle += a1 * b0 + a0 * b1;
        low += a0 * b0;
    }
    // Carried, a digit is smaller than the base in magnitude, so the first that is not 0 decides, whatever its signs are.
    middle += low / base, low %= base;
    high += middle / base, middle %= base;
    const std::int64_t first = high != 0 ? high : middle != 0 ? middle : low;
    return first > 0 ? 1 : first < 0 ? -1 : 0;
}

/// in_circle() of differences to d, in integers of grid units: at most 2^24, so that squares and products are at most 2^49.
[[nodiscard]] HMESH_NEVER_INLINE inline int in_circle_of_integers(Point a, Point b, Point c) noexcept {
    const auto units = [](double x) { return static_cast<std::int64_t>(x * grid_steps); };
    const std::int64_t ax = units(a.x), ay = units(a.y), bx = units(b.x), by = units(b.y), cx = units(c.x), cy = units(c.y);
    return sign_of_products({ax * ax + ay * ay, bx * bx + by * by, cx * cx + cy * cy},
                            {bx * cy - cx * by, cx * ay - ax * cy, ax * by - bx * ay});
}

}  // namespace detail

/// The position of d relative to the circle through the positively oriented a, b, c: 1 inside, 0 on it, -1 outside. Exact on
/// the 1/256 px grid for coordinates in [0, 2^16]. About 5 ns; 25 ns for a circle of more than some 20 px with d on it, or off
/// it by some 1e-15 of its radius.
[[nodiscard]] inline int in_circle(Point a, Point b, Point c, Point d) noexcept {
    const double ax = a.x - d.x, ay = a.y - d.y, bx = b.x - d.x, by = b.y - d.y, cx = c.x - d.x, cy = c.y - d.y;
    // Up to here and in both factors of the products nothing rounds: all are below 2^50 grid units or their squares.
    const double pa = (ax * ax + ay * ay) * (bx * cy - cx * by);
    const double pb = (bx * bx + by * by) * (cx * ay - ax * cy);
    const double pc = (cx * cx + cy * cy) * (ax * by - bx * ay);
    const double sum = pa + pb + pc, size = std::abs(pa) + std::abs(pb) + std::abs(pc);
    // A product passes at most three roundings of 2^-53 each; the fourth pays for those of `size` and second orders.
    const double bound = size * (4.0 / 9007199254740992.0);
    if (sum > bound) return 1;
    if (sum < -bound) return -1;
    // Products are multiples of 2^-32 px^4: below 2^53 of these nothing has rounded.
    if (size < 2097152.0) return sum > 0 ? 1 : sum < 0 ? -1 : 0;
    return detail::in_circle_of_integers({ax, ay}, {bx, by}, {cx, cy});
}

/// Barycentric coordinates: the weights of the corners a, b, c that make a point. They sum to 1 and are all >= 0 inside the
/// triangle.
struct Barycentric {
    double a = 0,  ///< weight of corner a
        b = 0,     ///< weight of corner b
        c = 0;     ///< weight of corner c
};
/// The barycentric coordinates of p, anywhere in the plane, in the triangle (a, b, c), whose area must not be 0.
[[nodiscard]] inline Barycentric barycentric(Point a, Point b, Point c, Point p) noexcept {
    const double area = orient2d(a, b, c);
    const double wb = orient2d(a, p, c) / area, wc = orient2d(a, b, p) / area;
    return {1 - wb - wc, wb, wc};
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_MESH_GEOMETRY_HPP
