/// \file
/// Foot points: the point of the mesh that is nearest to a pixel in the space of position and colour.
///
/// The paper's convexification (section 4.4, Fig. 3b; as in Xiong et al., "Robust surface reconstruction via dictionary
/// learning", 2014): with its colours the mesh is a surface in 2 + C dimensions, and a pixel belongs to the point of it that is
/// nearest, not to the point under it. The barycentric coordinates of these foot points are the columns of the K that lets
/// least squares move vertices; with the coordinates under the pixels V K = P holds exactly, and nothing moves.
///
/// Three inner products take a pixel into the plane of a face, where it is inside or nearest to one of three sides: about
/// 30 ns a pixel and face.
#ifndef HMESH_METHODS_HIERARCHICAL_FOOTPOINTS_HPP
#define HMESH_METHODS_HIERARCHICAL_FOOTPOINTS_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "hmesh/core/compiler.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/fit/image_mesh.hpp"
#include "hmesh/mesh/raster.hpp"
#include "hmesh/solve/normal_equations.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// Where a pixel's foot point is looked for.
enum class FootSearch : std::uint8_t {
    plane,     ///< not at all: the point under the pixel, so that least squares changes colours only
    own_face,  ///< in the face under the pixel
    one_ring,  ///< in all faces that share a vertex with that one: worse by 0.01 to 0.08 dB, ten times as long
};

/// A pixel or vertex in 2 + C dimensions.
template <int C>
struct LiftedPoint {
    Point position;
    Color<C> color;  ///< times the px that a unit of colour is worth; 0 in the lanes above C
    /// The difference of two points.
    [[nodiscard]] HMESH_ALWAYS_INLINE LiftedPoint minus(const LiftedPoint& o) const {
        return {{position.x - o.position.x, position.y - o.position.y}, color - o.color};
    }
    /// All coordinates by a factor.
    [[nodiscard]] HMESH_ALWAYS_INLINE LiftedPoint times(double factor) const {
        return {{position.x * factor, position.y * factor}, color * factor};
    }
    /// The inner product of all 2 + C coordinates.
    [[nodiscard]] HMESH_ALWAYS_INLINE double dot(const LiftedPoint& o) const {
        return position.x * o.position.x + position.y * o.position.y + (color * o.color).sum();
    }
};

/// A triangle a, b, c in that space; it may be a segment or a point. Its own plane gets an orthonormal frame, with the origin
/// in a and the first axis along the longer of the two sides there, so that slivers and colours of any size move the foot by no
/// more than some 1e-15 of what is measured: a system in inner products would square the condition.
template <int C>
class LiftedFace {
  public:
    /// Of its corners.
    LiftedFace(const LiftedPoint<C>& a, const LiftedPoint<C>& b, const LiftedPoint<C>& c) : a_(a) {
        LiftedPoint<C> base = b.minus(a), other = c.minus(a);
        is_swapped_ = base.dot(base) < other.dot(other);
        if (is_swapped_) std::swap(base, other);
        length_ = std::sqrt(base.dot(base));
        x_axis_ = base.times(inverse(length_));
        apex_x_ = other.dot(x_axis_);
        LiftedPoint<C> height = other.minus(x_axis_.times(apex_x_));
        height = height.minus(x_axis_.times(height.dot(x_axis_)));  // once more: the first time leaves rounding along the axis
        apex_y_ = std::sqrt(height.dot(height));
        y_axis_ = height.times(inverse(apex_y_));
        inverse_length_ = inverse(length_);
        inverse_height_ = inverse(apex_y_);
        inverse_near2_ = inverse(apex_x_ * apex_x_ + apex_y_ * apex_y_);
        inverse_far2_ = inverse((apex_x_ - length_) * (apex_x_ - length_) + apex_y_ * apex_y_);
    }

    /// The point nearest to p as weights of the corners, all >= 0, and its squared distance.
    [[nodiscard]] HMESH_ALWAYS_INLINE Barycentric foot(const LiftedPoint<C>& p, double& distance2) const {
        const LiftedPoint<C> ap = p.minus(a_);
        const double x = ap.dot(x_axis_), y = ap.dot(y_axis_), off_plane = std::max(0.0, ap.dot(ap) - x * x - y * y);
        const double h = y * inverse_height_, t = (x - h * apex_x_) * inverse_length_, rest = 1 - t - h;
        distance2 = off_plane;
        if (h >= 0 && t >= 0 && rest >= 0) return weights(rest, t, h);
        // Outside, so on one of the three sides.
        const double on_base = unit(x * inverse_length_), on_near = unit((x * apex_x_ + y * apex_y_) * inverse_near2_);
        const double on_far = unit(((x - length_) * (apex_x_ - length_) + y * apex_y_) * inverse_far2_);
        const double base2 = square(x - on_base * length_) + y * y;
        const double near2 = square(x - on_near * apex_x_) + square(y - on_near * apex_y_);
        const double far2 = square(x - length_ - on_far * (apex_x_ - length_)) + square(y - on_far * apex_y_);
        distance2 += std::min(base2, std::min(near2, far2));
        if (base2 <= near2 && base2 <= far2) return weights(1 - on_base, on_base, 0);
        return near2 <= far2 ? weights(1 - on_near, 0, on_near) : weights(0, 1 - on_far, on_far);
    }

  private:
    [[nodiscard]] static double inverse(double size) noexcept { return size > 0 ? 1 / size : 0.0; }
    [[nodiscard]] static HMESH_ALWAYS_INLINE double square(double x) noexcept { return x * x; }
    [[nodiscard]] static HMESH_ALWAYS_INLINE double unit(double x) noexcept { return std::max(0.0, std::min(1.0, x)); }
    [[nodiscard]] HMESH_ALWAYS_INLINE Barycentric weights(double a, double base, double apex) const noexcept {
        return is_swapped_ ? Barycentric{a, apex, base} : Barycentric{a, base, apex};
    }

    LiftedPoint<C> a_, x_axis_, y_axis_;
    /// In the frame: a at 0, the end of the base at (length, 0), the apex.
    double length_, apex_x_, apex_y_;
    double inverse_length_, inverse_height_, inverse_near2_, inverse_far2_;  ///< of the sides, squared the last two; 0 for 1 / 0
    bool is_swapped_;                                                        ///< c ends the base, b is the apex
};

namespace detail {

template <int C>
[[nodiscard]] LiftedFace<C> lift(const ImageMesh<C>& mesh, Face f, double color_scale) {
    const auto v = mesh.topology().vertices(f);
    const auto at = [&](Vertex u) { return LiftedPoint<C>{mesh.position(u), mesh.color(u) * color_scale}; };
    return {at(v[0]), at(v[1]), at(v[2])};
}

/// Adds a pixel that counts `weight` times to the sums of the corners of face f, the first of which halfedge(f) leaves.
template <int C>
HMESH_ALWAYS_INLINE void add_pixel(const Barycentric& w, double weight, Point center, const Color<C>& image, CornerSums<C>& a,
                                   CornerSums<C>& b, CornerSums<C>& c) {
    const auto add = [&](CornerSums<C>& sums, double own, double next) {
        const double share = weight * own;
        sums.square += share * own;
        sums.coupling += share * next;
        sums.x += share * center.x;
        sums.y += share * center.y;
        sums.image += share * image;
    };
    add(a, w.a, w.b);
    add(b, w.b, w.c);
    add(c, w.c, w.a);
}

/// The faces that share a vertex with f, f first, none twice.
inline void faces_around(const HalfedgeMesh& topology, Face f, std::vector<Face>& faces) {
    faces.assign(1, f);
    for (const Vertex v : topology.vertices(f))
        for (const Halfedge h : topology.outgoing(v)) {
            const Face g = topology.face(h);
            if (g.is_valid() && std::find(faces.begin(), faces.end(), g) == faces.end()) faces.push_back(g);
        }
}

}  // namespace detail

/// What each corner of each face adds to the normal equations of the K of foot points, by half-edge as in corner_sums
/// (solve/normal_equations.hpp): gram_matrix, position_rhs and image_rhs make K K^T, K P^T and K I^T of it. `color_scale`: px
/// that a unit of colour is worth, > 0. The mesh must tile its table's rectangle. Faces are independent pieces of work, but not
/// in one_ring, which runs serially: there they add to each other's corners. Told to stop, one_ring leaves the sums of some faces
/// out. Lane C of `image` stays 0 where there is a search.
template <int C>
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
        for_each_span(mesh.position(v[0]), mesh.position(v[1]), mesh.position(v[2]), {}, [&](int j, int begin, int end) {
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
                for_each_pixel(f, [&](Point center, const Color<C>& image, double weight) {
                    double distance2 = 0;
                    detail::add_pixel(face.foot({center, image * color_scale}, distance2), weight, center, image, a, b, c);
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
        if (!mesh.keep_going()) break;
        detail::faces_around(topology, f, faces);
        lifted.clear();
        for (const Face g : faces) lifted.push_back(detail::lift(mesh, g, color_scale));
        for_each_pixel(f, [&](Point center, const Color<C>& image, double weight) {
            const LiftedPoint<C> pixel{center, image * color_scale};
            double least = std::numeric_limits<double>::max();
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
            detail::add_pixel(best, weight, center, image, *to.a, *to.b, *to.c);
        });
    }
    return corners;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_HIERARCHICAL_FOOTPOINTS_HPP
