/// \file
/// The squared error of a face: all its closed forms, from the moments of its pixels.
///
/// In a face the picture is linear, so its squared error to the image is a polynomial in the moments of the face's pixels
/// (fit/edge_moments.hpp), the colours of its corners and their positions. This header holds the error itself (face_energy),
/// the error as a function of one corner's colour with what moves that corner (FaceFit), and what the corners add to the normal
/// equations of all colours (CornerSums). An energy of another kind is another header like this one.
///
/// In a face (v, a, b) with the origin in v the picture is f = c (1 + l.x) + f1 x + f2 y, where c is v's colour, l the gradient
/// of v's hat function and (f1, f2) what the colours of a and b contribute. Its squared error is
///     E = d + sum over channels of (A c^2 - 2 b c),     A = sum of lambda^2,  b = sum of lambda (I - f1 x - f2 y),
/// all sums over the face's pixels. Cost: about 13 ns a face for up to 3 channels.
#ifndef HMESH_FIT_SQUARED_ERROR_HPP
#define HMESH_FIT_SQUARED_ERROR_HPP

#include <algorithm>

#include "hmesh/core/compiler.hpp"
#include "hmesh/core/lanes.hpp"
#include "hmesh/fit/edge_moments.hpp"
#include "hmesh/mesh/geometry.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// The channels of a colour, padded with zeros to the lanes of Moments (lane C, where moments carry 1, is 0 in a colour).
template <int C>
using Color = typename Moments<C>::Channels;

namespace detail {

/// Clamps the channels to [low, high]; the padding stays 0.
template <int C>
HMESH_ALWAYS_INLINE void clamp_channels(Color<C>& c, double low, double high) {
    c.clamp(low, high);
    for (int k = C; k < lanes_for(C + 1); ++k) c.set(k, 0);  // padding stays 0 whatever the range
}

}  // namespace detail

/// Where a vertex may go.
enum class Mobility : unsigned char {
    free,     ///< anywhere
    along_x,  ///< along a horizontal side of the image
    along_y,  ///< along a vertical side of the image
    corner,   ///< nowhere: a corner of the image
    locked,   ///< nowhere: it belongs to other patches too, keeps its colour and is not removed
};

/// The largest valence that an operator gives a vertex.
inline constexpr int max_valence = 40;

/// What an ImageMesh stores of a vertex, apart from its edges.
template <int C>
struct VertexState {
    Color<C> color;     ///< colour in stored values
    Point position;     ///< px, in the rectangle of the moment table
    Mobility mobility;  ///< where the vertex may go
    /// Largest valence allowed, smaller for a locked vertex, whose other patches may add edges too.
    unsigned char valence_limit = max_valence;
};

/// The moments of a face with the origin moved to its corner v, in coordinates of the plane.
template <int C>
struct ShiftedMoments {
    Color<C> mx,  ///< sums of x (I, 1)
        my;       ///< sums of y (I, 1)
    double sx,    ///< sum of x
        sy;       ///< sum of y
    double sxx,   ///< sum of x^2
        sxy,      ///< sum of xy
        syy;      ///< sum of y^2
    /// The moments m of a face, as an ImageMesh stores them, with the origin moved to v.
    HMESH_ALWAYS_INLINE ShiftedMoments(const Moments<C>& m, Point v) {
        const double ox = v.x - 0.5, oy = v.y - 0.5;  // the origin in pixel coordinates
        mx = m.sx - ox * m.s, my = m.sy - oy * m.s;
        sx = mx[C], sy = my[C];
        sxx = m.q[0] - ox * (m.sx[C] + sx), syy = m.q[2] - oy * (m.sy[C] + sy);
        sxy = m.q[1] - ox * m.sy[C] - oy * sx;
    }
};

/// The squared error of a face of a ring as a function of the centre's colour. The formulas are at the top of
/// fit/squared_error.hpp.
template <int C>
struct FaceFit {
    double a;        ///< A, the sum of lambda^2
    double lx,       ///< x of the gradient of the centre's hat function
        ly;          ///< y of that gradient
    double squares;  ///< sum of |I|^2; d = squares + rest.sum()
    Color<C> b,      ///< b, the sum of lambda (I - f1 x - f2 y)
        f1,          ///< x of the picture's gradient, the part of the other corners
        f2,          ///< y of the picture's gradient, the part of the other corners
        rest;        ///< the part of d that depends on the other corners
    /// The squared error of the face with the centre in colour c.
    [[nodiscard]] HMESH_ALWAYS_INLINE double energy(const Color<C>& c) const {
        return squares + (rest + c * (a * c - 2.0 * b)).sum();
    }
};

/// Fits the face (v, a, b) with moments m; `va` and `vb` are its other corners. False when twice its area is below
/// min_double_area.
template <int C>
[[nodiscard]] HMESH_ALWAYS_INLINE bool fit_face(const Moments<C>& m, Point v, const VertexState<C>& va, const VertexState<C>& vb,
                                                double min_double_area, FaceFit<C>& out) {
    const double ax = va.position.x - v.x, ay = va.position.y - v.y, bx = vb.position.x - v.x, by = vb.position.y - v.y;
    const double area = ax * by - ay * bx;
    if (!(area >= min_double_area)) return false;
    const double inverse = 1 / area;
    const double lx = (ay - by) * inverse, ly = (bx - ax) * inverse;
    const Color<C> f1 = (by * inverse) * va.color - (ay * inverse) * vb.color;
    const Color<C> f2 = (ax * inverse) * vb.color - (bx * inverse) * va.color;
    const ShiftedMoments<C> shifted(m, v);
    const auto& [mx, my, sx, sy, sxx, sxy, syy] = shifted;
    const double m1 = sx + lx * sxx + ly * sxy, m2 = sy + lx * sxy + ly * syy;
    const Color<C> hat = m.s + lx * mx + ly * my;
    out.a = hat[C] + lx * m1 + ly * m2;
    out.lx = lx;
    out.ly = ly;
    out.f1 = f1;
    out.f2 = f2;
    out.b = hat - m1 * f1 - m2 * f2;
    out.rest = f1 * (sxx * f1 - 2.0 * mx + (2 * sxy) * f2) + f2 * (syy * f2 - 2.0 * my);
    out.squares = m.q[3];
    return true;
}

/// The squared error of the face (v0, v1, v2) with moments m and positive area.
template <int C>
[[nodiscard]] HMESH_ALWAYS_INLINE double face_energy(const Moments<C>& m, const VertexState<C>& v0, const VertexState<C>& v1,
                                                     const VertexState<C>& v2) {
    const Point v = v0.position;
    const double ax = v1.position.x - v.x, ay = v1.position.y - v.y, bx = v2.position.x - v.x, by = v2.position.y - v.y;
    const double inverse = 1 / (ax * by - ay * bx);
    const Color<C> ca = v1.color - v0.color, cb = v2.color - v0.color;
    const Color<C> gx = (by * inverse) * ca - (ay * inverse) * cb, gy = (ax * inverse) * cb - (bx * inverse) * ca;
    const ShiftedMoments<C> shifted(m, v);
    const auto& [mx, my, sx, sy, sxx, sxy, syy] = shifted;
    const double n = m.s[C];
    const Color<C>& c = v0.color;
    return m.q[3] +
           (c * (n * c - 2.0 * m.s) + gx * (sxx * gx + 2.0 * (sx * c + sxy * gy - mx)) + gy * (syy * gy + 2.0 * (sy * c - my)))
               .sum();
}

/// What one corner of a face adds to the normal equations. It belongs to the half-edge that leaves the corner within the face.
/// Sums are over the face's pixels; lambda is the corner's hat function.
template <int C>
struct CornerSums {
    double square = 0;                  ///< sum of lambda^2
    double coupling = 0;                ///< sum of lambda times the hat function of the half-edge's other end
    double x = 0,                       ///< sum of lambda x, x of the pixel's centre in the plane
        y = 0;                          ///< sum of lambda y, y of the pixel's centre in the plane
    Color<C> image = Color<C>::zero();  ///< sum of lambda I; lane C: of lambda
};

/// The sums of the corners of the face (v0, v1, v2) with moments m and positive area; left as they are for a face without
/// pixels.
///
/// With the origin in v0, lambda_1 = u / area and lambda_2 = w / area for u = b_y x - b_x y and w = a_x y - a_y x. Dividing
/// last and nesting sums of products as below keeps everything before exact on the 1/256 px grid for faces of common size:
/// slivers, where terms of 1e8 cancel, lose nothing.
template <int C>
void sum_corners(const Moments<C>& m, Point v0, Point v1, Point v2, CornerSums<C>& out0, CornerSums<C>& out1,
                 CornerSums<C>& out2) {
    const double n = m.s[C];
    if (!(n > least_weight)) return;  // sums of float samples and of weights leave rounding where there is no pixel
    const double ax = v1.x - v0.x, ay = v1.y - v0.y, bx = v2.x - v0.x, by = v2.y - v0.y;
    const double inverse = 1 / (ax * by - ay * bx), inverse2 = inverse * inverse;
    const ShiftedMoments<C> shifted(m, v0);
    const auto& [mx, my, sx, sy, sxx, sxy, syy] = shifted;
    const double ux = by * sxx - bx * sxy, uy = by * sxy - bx * syy;
    const double wx = ax * sxy - ay * sxx, wy = ax * syy - ay * sxy;
    const double l1 = (by * sx - bx * sy) * inverse, l2 = (ax * sy - ay * sx) * inverse;
    const double l11 = (by * ux - bx * uy) * inverse2, l22 = (ax * wy - ay * wx) * inverse2;
    const double l12 = (ax * uy - ay * ux) * inverse2;
    out1.square = l11;
    out1.coupling = l12;
    out1.image = (by * mx - bx * my) * inverse;
    out1.x = v0.x * l1 + ux * inverse;
    out1.y = v0.y * l1 + uy * inverse;
    out2.square = l22;
    out2.coupling = l2 - l12 - l22;
    out2.image = (ax * my - ay * mx) * inverse;
    out2.x = v0.x * l2 + wx * inverse;
    out2.y = v0.y * l2 + wy * inverse;
    out0.square = n - 2 * (l1 + l2) + l11 + 2 * l12 + l22;
    out0.coupling = l1 - l11 - l12;
    out0.image = m.s - out1.image - out2.image;
    out0.x = n * v0.x + sx - out1.x - out2.x;
    out0.y = n * v0.y + sy - out1.y - out2.y;
    // Rounding of weighted sums may have made squares negative.
    out0.square = std::max(0.0, out0.square);
    out1.square = std::max(0.0, out1.square);
    out2.square = std::max(0.0, out2.square);
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_FIT_SQUARED_ERROR_HPP
