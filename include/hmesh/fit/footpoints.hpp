// hmesh - foot points: the point of the mesh that is nearest to a pixel in the space of position and colour.
//
// The paper's convexification (section 4.4, Fig. 3b; as in Xiong et al., "Robust surface reconstruction via dictionary
// learning", 2014): with its colours the mesh is a surface in 2 + C dimensions, and a pixel belongs to the point of it that is
// nearest, not to the point under it. The barycentric coordinates of these foot points are the columns of the K that lets
// least squares move vertices; with the coordinates under the pixels V K = P holds exactly, and nothing moves.
//
// The nearest point of a triangle needs two dot products and a case distinction (Ericson, "Real-time collision detection",
// 2005, section 5.1.5, written with inner products only, hence true in any dimension): about 30 ns a pixel and face.
#ifndef HMESH_FIT_FOOTPOINTS_HPP
#define HMESH_FIT_FOOTPOINTS_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "hmesh/core/parallel.hpp"
#include "hmesh/fit/barycentric.hpp"
#include "hmesh/fit/image_mesh.hpp"

namespace hmesh {

// Where a pixel's foot point is looked for.
enum class FootSearch : std::uint8_t {
    plane,      // not at all: the point under the pixel, so that least squares changes colours only
    own_face,   // in the face under the pixel
    one_ring,   // in all faces that share a vertex with that one: at most 0.06 dB better, four times as long
};

// A pixel or vertex in 2 + C dimensions.
template <int C>
struct LiftedPoint {
    Point position;
    Color<C> color;  // times the px that a unit of colour is worth; 0 in the lanes above C
    [[nodiscard]] HMESH_ALWAYS_INLINE LiftedPoint minus(const LiftedPoint& o) const {
        return {{position.x - o.position.x, position.y - o.position.y}, color - o.color};
    }
    [[nodiscard]] HMESH_ALWAYS_INLINE double dot(const LiftedPoint& o) const {
        return position.x * o.position.x + position.y * o.position.y + (color * o.color).sum();
    }
};

// A triangle a, b, c in that space.
template <int C>
class LiftedFace {
  public:
    LiftedFace(const LiftedPoint<C>& a, const LiftedPoint<C>& b, const LiftedPoint<C>& c)
        : a_(a), ab_(b.minus(a)), ac_(c.minus(a)), bb_(ab_.dot(ab_)), bc_(ab_.dot(ac_)), cc_(ac_.dot(ac_)) {}

    // The point nearest to p as weights of the corners, all >= 0, and its squared distance.
    [[nodiscard]] HMESH_ALWAYS_INLINE Barycentric foot(const LiftedPoint<C>& p, double& distance2) const {
        const LiftedPoint<C> ap = p.minus(a_);
        const double pb = ab_.dot(ap), pc = ac_.dot(ap);  // d1, d2 in Ericson
        const Barycentric w = nearest(pb, pc);
        // |ap - b ab - c ac|^2
        distance2 = std::max(0.0, ap.dot(ap) - 2 * (w.b * pb + w.c * pc) + w.b * w.b * bb_ + 2 * w.b * w.c * bc_ + w.c * w.c * cc_);
        return w;
    }

  private:
    [[nodiscard]] HMESH_ALWAYS_INLINE Barycentric nearest(double pb, double pc) const noexcept {
        if (pb <= 0 && pc <= 0) return {1, 0, 0};
        const double pb_b = pb - bb_, pc_b = pc - bc_, pb_c = pb - bc_, pc_c = pc - cc_;  // seen from b and from c
        if (pb_b >= 0 && pc_b <= pb_b) return {0, 1, 0};
        if (pc_c >= 0 && pb_c <= pc_c) return {0, 0, 1};
        const double in_c = pb * pc_b - pb_b * pc;  // >= 0 on c's side of ab, and so on
        if (in_c <= 0 && pb >= 0 && pb_b <= 0) return along(pb, bb_, 1);
        const double in_b = pb_c * pc - pb * pc_c;
        if (in_b <= 0 && pc >= 0 && pc_c <= 0) return along(pc, cc_, 2);
        const double in_a = pb_b * pc_c - pb_c * pc_b, to_c = pc_b - pb_b, to_b = pb_c - pc_c;
        if (in_a <= 0 && to_c >= 0 && to_b >= 0) {
            const double t = to_c + to_b > 0 ? to_c / (to_c + to_b) : 0.0;
            return {0, 1 - t, t};
        }
        const double all = in_a + in_b + in_c;
        if (!(all > 0)) return {1, 0, 0};  // a face without extent, to rounding
        const double b = in_b / all, c = in_c / all;
        return {std::max(0.0, 1 - b - c), b, c};
    }
    [[nodiscard]] static Barycentric along(double share, double whole, int corner) noexcept {
        const double t = whole > 0 ? share / whole : 0.0;
        return corner == 1 ? Barycentric{1 - t, t, 0} : Barycentric{1 - t, 0, t};
    }

    LiftedPoint<C> a_, ab_, ac_;
    double bb_, bc_, cc_;
};

namespace detail {

template <int C>
[[nodiscard]] LiftedFace<C> lift(const ImageMesh<C>& mesh, Face f, double color_scale) {
    const auto v = mesh.topology().vertices(f);
    const auto at = [&](Vertex u) { return LiftedPoint<C>{mesh.position(u), mesh.color(u) * color_scale}; };
    return {at(v[0]), at(v[1]), at(v[2])};
}

// Adds a pixel that counts `weight` times to the sums of the corners of face f, the first of which halfedge(f) leaves.
template <int C>
HMESH_ALWAYS_INLINE void add_pixel(const Barycentric& w, double weight, Point centre, const Color<C>& image, CornerSums<C>& a,
                                   CornerSums<C>& b, CornerSums<C>& c) {
    const auto add = [&](CornerSums<C>& sums, double own, double next) {
        const double share = weight * own;
        sums.square += share * own;
        sums.coupling += share * next;
        sums.x += share * centre.x;
        sums.y += share * centre.y;
        sums.image += share * image;
    };
    add(a, w.a, w.b);
    add(b, w.b, w.c);
    add(c, w.c, w.a);
}

// The faces that share a vertex with f, f first, none twice.
inline void faces_around(const HalfedgeMesh& topology, Face f, std::vector<Face>& faces) {
    faces.assign(1, f);
    for (const Vertex v : topology.vertices(f))
        for (const Halfedge h : topology.outgoing(v)) {
            const Face g = topology.face(h);
            if (g.is_valid() && std::find(faces.begin(), faces.end(), g) == faces.end()) faces.push_back(g);
        }
}

}  // namespace detail

// What each corner of each face adds to the normal equations of the K of foot points, by half-edge as in corner_sums
// (fit/barycentric.hpp): gram_matrix, position_rhs and image_rhs make K K^T, K P^T and K I^T of it. `color_scale`: px that a
// unit of colour is worth, > 0. The mesh must tile its table's rectangle.
template <int C, class ParallelFor = SerialFor>
[[nodiscard]] std::vector<CornerSums<C>> foot_sums(const ImageMesh<C>& mesh, FootSearch search, double color_scale,
                                                   const ParallelFor& parallel_for = {}) {
    if (search == FootSearch::plane) return corner_sums(mesh, parallel_for);
    const HalfedgeMesh& topology = mesh.topology();
    const MomentTable<C>& table = mesh.table();
    std::vector<CornerSums<C>> corners(2 * topology.edge_slots());
    struct Sums {
        CornerSums<C>*a, *b, *c;
    };
    const auto sums_of = [&](Face f) -> Sums {
        const Halfedge a = topology.halfedge(f), b = topology.next(a), c = topology.next(b);
        return {&corners[a.index()], &corners[b.index()], &corners[c.index()]};
    };
    const auto for_each_pixel = [&](Face f, auto&& body) {
        const auto v = topology.vertices(f);
        for_each_span(mesh.position(v[0]), mesh.position(v[1]), mesh.position(v[2]), [&](int j, int begin, int end) {
            for (int i = begin; i < end; ++i) {
                Color<C> image;
                table.pixel(i, j, image);
                body(Point{i + 0.5, j + 0.5}, image, table.weight(i, j));
            }
        });
    };
    if (search == FootSearch::own_face) {  // faces write to their own corners only
        for_each_chunk(parallel_for, topology.face_slots(), 256, [&](std::size_t first, std::size_t last) {
            for (std::size_t k = first; k < last; ++k) {
                const Face f(k);
                if (topology.is_deleted(f)) continue;
                const LiftedFace<C> face = detail::lift(mesh, f, color_scale);
                CornerSums<C> a, b, c;
                for_each_pixel(f, [&](Point centre, const Color<C>& image, double weight) {
                    double distance2 = 0;
                    detail::add_pixel(face.foot({centre, image * color_scale}, distance2), weight, centre, image, a, b, c);
                });
                const Sums to = sums_of(f);
                *to.a = a, *to.b = b, *to.c = c;
            }
        });
        return corners;
    }
    std::vector<Face> faces;
    std::vector<LiftedFace<C>> lifted;
    for (const Face f : topology.faces()) {
        detail::faces_around(topology, f, faces);
        lifted.clear();
        for (const Face g : faces) lifted.push_back(detail::lift(mesh, g, color_scale));
        for_each_pixel(f, [&](Point centre, const Color<C>& image, double weight) {
            const LiftedPoint<C> pixel{centre, image * color_scale};
            double least = std::numeric_limits<double>::infinity();
            Barycentric best;
            std::size_t nearest = 0;
            for (std::size_t k = 0; k < faces.size(); ++k) {
                double distance2 = 0;
                const Barycentric w = lifted[k].foot(pixel, distance2);
                if (!(distance2 < least)) continue;
                least = distance2;
                best = w;
                nearest = k;
            }
            const Sums to = sums_of(faces[nearest]);
            detail::add_pixel(best, weight, centre, image, *to.a, *to.b, *to.c);
        });
    }
    return corners;
}

}  // namespace hmesh

#endif  // HMESH_FIT_FOOTPOINTS_HPP
