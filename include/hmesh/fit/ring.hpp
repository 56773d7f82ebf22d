/// \file
/// Ring: the one-ring of a vertex, and the energy of its faces as a function of the vertex.
///
/// The squared errors of the faces around a vertex (fit/squared_error.hpp) are parabolas in its colour. Summed over the ring,
/// the best colour is b / A; with that colour put in, Gauss-Newton moves the vertex. The same code serves a vertex of the mesh
/// and one that might be inserted. Cost: about 13 ns a face for up to 3 channels.
#ifndef HMESH_FIT_RING_HPP
#define HMESH_FIT_RING_HPP

#include "hmesh/core/compiler.hpp"
#include "hmesh/fit/edge_moments.hpp"
#include "hmesh/fit/squared_error.hpp"
#include "hmesh/mesh/geometry.hpp"
#include "hmesh/mesh/handles.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// The largest valence of the centre of a Ring.
inline constexpr int ring_capacity = 64;

/// The squared error of a ring as a function of the centre's colour c: E(c) = d + sum over channels of (A c^2 - 2 b c).
template <int C>
struct RingFit {
    double a = 0,                   ///< A, the sum of lambda^2 over the ring
        d = 0;                      ///< the part that does not depend on c
    double squares = 0;             ///< sum of |I|^2 over the ring
    Color<C> b = Color<C>::zero();  ///< the sum of FaceFit::b; lane C is not zero and means nothing
    /// The squared error of the ring with the centre in colour c.
    [[nodiscard]] HMESH_ALWAYS_INLINE double energy(const Color<C>& c) const { return d + (c * (a * c - 2.0 * b)).sum(); }
};

/// The one-ring of a vertex, the centre, which itself is not part of it. Neighbours follow each other against the orientation
/// of the faces: face i joins the centre, neighbour i and neighbour i - 1; an open ring (around a boundary vertex) has no face
/// 0. An object takes ring_capacity Moments, 8 KB for 3 channels.
template <int C>
struct Ring {
    int size = 0;                                   ///< number of neighbours
    bool open = false;                              ///< whether the centre is on the boundary
    Halfedge halfedge[ring_capacity];               ///< from the centre to neighbour i, if the centre is in the mesh
    const VertexState<C>* neighbor[ring_capacity];  ///< neighbour i
    Moments<C> link[ring_capacity];                 ///< moments of the far side of face i, from neighbour i to neighbour i - 1

    [[nodiscard]] int first_face() const noexcept { return open ? 1 : 0; }  ///< index of the first face
    /// The index before i around the ring.
    [[nodiscard]] int before(int i) const noexcept { return i == 0 ? size - 1 : i - 1; }

    /// Whether all faces have at least the area min_double_area / 2, in px^2, with the centre at v.
    [[nodiscard]] HMESH_ALWAYS_INLINE bool accepts(Point v, double min_double_area) const noexcept {
        for (int i = first_face(); i < size; ++i)
            if (!(orient2d(v, neighbor[i]->position, neighbor[before(i)]->position) >= min_double_area)) return false;
        return true;
    }
};

/// The moments of the edges from the centre of a ring to its neighbours.
template <int C>
struct Spokes {
    Moments<C> spoke[ring_capacity];  ///< to neighbour i
};

/// Collects the moments of all edges from the centre at v to the neighbours.
template <int C>
HMESH_ALWAYS_INLINE void walk_spokes(const MomentTable<C>& table, const Ring<C>& ring, Point v, Spokes<C>& spokes) {
    for (int i = 0; i < ring.size; ++i) edge_moments(table, v, ring.neighbor[i]->position, spokes.spoke[i]);
}

/// The number of pixels in the ring; over a weighted table the sum of their weights, with its rounding.
template <int C>
[[nodiscard]] inline double ring_weight(const Ring<C>& ring, const Spokes<C>& spokes) noexcept {
    double sum = ring.open ? spokes.spoke[ring.size - 1].s[C] - spokes.spoke[0].s[C] : 0.0;
    for (int i = ring.first_face(); i < ring.size; ++i) sum += ring.link[i].s[C];
    return sum;
}

/// Fits all faces of the ring, with the centre at v, and their sum. False when twice the area of one is below min_double_area.
template <int C>
[[nodiscard]] HMESH_NEVER_INLINE bool fit_ring(const Ring<C>& ring, const Spokes<C>& spokes, Point v, double min_double_area,
                                               FaceFit<C>* faces, RingFit<C>& out) {
    // Sums of its own: those in `out` would go through memory for each face.
    Color<C> rest = Color<C>::zero(), b = rest;
    double a = 0, squares = 0;
    for (int i = ring.first_face(); i < ring.size; ++i) {
        const int j = ring.before(i);
        Moments<C> m = spokes.spoke[i];
        m += ring.link[i];
        m -= spokes.spoke[j];
        if (!fit_face(m, v, *ring.neighbor[i], *ring.neighbor[j], min_double_area, faces[i])) return false;
        a += faces[i].a;
        b += faces[i].b;
        rest += faces[i].rest;
        squares += faces[i].squares;
    }
    out = {a, squares + rest.sum(), squares, b};
    return true;
}

/// The colour of the centre that minimises the ring's energy, with the ridge toward `current`, clamped to [low, high]. A sum of
/// squares that the rounding of weighted sums made negative counts as 0.
template <int C>
[[nodiscard]] HMESH_ALWAYS_INLINE Color<C> best_color(const RingFit<C>& fit, const Color<C>& current, double ridge, double low,
                                                      double high) {
    Color<C> c = (fit.b + ridge * current) * (1 / ((fit.a > 0 ? fit.a : 0.0) + ridge));
    detail::clamp_channels<C>(c, low, high);
    return c;
}

/// A step of the centre of a ring.
struct RingStep {
    double dx = 0,         ///< px
        dy = 0;            ///< px
    double predicted = 0;  ///< decrease of energy that the linear model expects to first order, >= 0
};

/// The Gauss-Newton step of the centre with its colour eliminated, from the fit at the colour c = best_color(). With the
/// gradient of the picture g_t = (f1 + lx c, f2 + ly c) in face t,
///
///     grad = -2 sum_t g_t (A_t c - b_t),     H = 2 [sum A_t g_t g_t' - (sum A_t g_t)(sum A_t g_t)' / sum A_t],
///
/// summed over channels; pixels that change sides add no terms, because the picture is continuous. H is damped by 2 % of its
/// trace (H is singular where the picture is flat in one direction). Half of grad and H are used. No step where the picture is
/// flat.
template <int C>
[[nodiscard]] HMESH_ALWAYS_INLINE RingStep gauss_newton_step(const Ring<C>& ring, const FaceFit<C>* faces, const RingFit<C>& fit,
                                                             const Color<C>& c, Mobility mobility) {
    using Vec = Color<C>;
    Vec g1 = Vec::zero(), g2 = g1, h11 = g1, h12 = g1, h22 = g1, mean1 = g1, mean2 = g1;
    for (int i = ring.first_face(); i < ring.size; ++i) {
        const FaceFit<C>& face = faces[i];
        const Vec d1 = face.f1 + face.lx * c, d2 = face.f2 + face.ly * c;
        const Vec r = face.b - face.a * c;
        g1 += d1 * r;
        g2 += d2 * r;
        const Vec a1 = face.a * d1, a2 = face.a * d2;
        h11 += a1 * d1;
        h12 += a1 * d2;
        h22 += a2 * d2;
        mean1 += a1;
        mean2 += a2;
    }
    const double inverse_a = 1 / ((fit.a > 0 ? fit.a : 0.0) + 1e-3);
    const Vec m1 = mean1 * inverse_a, m2 = mean2 * inverse_a;
    const double gx = g1.sum(), gy = g2.sum();
    double xx = (h11 - m1 * mean1).sum(), xy = (h12 - m1 * mean2).sum(), yy = (h22 - m2 * mean2).sum();
    RingStep step;
    const double trace = xx + yy, damping = 0.02 * trace;
    // A flat picture gives no direction, only what rounding of its squares left; also when a number is not finite.
    if (!(trace > 1e-24 * fit.squares)) return step;
    xx += damping;
    yy += damping;
    if (!(xx > 0 && yy > 0)) return step;  // what rounding of weighted sums left
    if (mobility == Mobility::along_x) {
        step.dx = -gx / xx;
    } else if (mobility == Mobility::along_y) {
        step.dy = -gy / yy;
    } else if (mobility == Mobility::free) {
        const double det = xx * yy - xy * xy;
        if (!(det > 1e-12 * trace * trace)) return step;
        step.dx = -(yy * gx - xy * gy) / det;
        step.dy = -(xx * gy - xy * gx) / det;
    }
    step.predicted = -(gx * step.dx + gy * step.dy);
    return step;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_FIT_RING_HPP
