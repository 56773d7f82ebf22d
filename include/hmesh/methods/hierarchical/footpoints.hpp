/// \file
/// Foot points: for each pixel the nearest point of the mesh in the space of position and colour.
///
/// The paper's convexification (section 4.4, Fig. 3b; as in Xiong et al., "Robust surface reconstruction via dictionary
/// learning", 2014): with its colours the mesh is a surface in 2 + C dimensions, and a pixel is assigned to the nearest point of
/// this surface, its foot point, not to the point of the mesh under its centre. With the barycentric coordinates of foot points
/// as the columns of K, least squares moves vertices; with the coordinates under the pixels V K = P holds exactly, and no vertex
/// moves.
///
/// Cost: three inner products project a pixel into the plane of a face, where its foot is inside the face or on one of three
/// sides: about 30 ns a pixel and face.
#ifndef HMESH_METHODS_HIERARCHICAL_FOOTPOINTS_HPP
#define HMESH_METHODS_HIERARCHICAL_FOOTPOINTS_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "hmesh/core/array.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/fit/image_mesh.hpp"
#include "hmesh/fit/raster.hpp"
#include "hmesh/solve/normal_equations.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// Where the foot point of a pixel is searched.
enum class FootSearch : std::uint8_t {
    plane,     ///< nowhere: it is the point under the pixel's centre, so that least squares changes colours only
    own_face,  ///< in the face that the pixel belongs to
    one_ring,  ///< in all faces that share a vertex with the pixel's: 0.01 to 0.08 dB worse, ten times the time
};

/// A pixel or a vertex as a point in 2 + C dimensions.
template <int C>
struct LiftedPoint {
    Point position;  ///< px
    Color<C> color;  ///< stored values times color_scale, hence in px; 0 in the lanes above C
    /// This point less another.
    [[nodiscard]] HMESH_ALWAYS_INLINE LiftedPoint minus(const LiftedPoint& o) const {
        return {{position.x - o.position.x, position.y - o.position.y}, color - o.color};
    }
    /// All coordinates times a factor.
    [[nodiscard]] HMESH_ALWAYS_INLINE LiftedPoint times(double factor) const {
        return {{position.x * factor, position.y * factor}, color * factor};
    }
    /// The inner product of all 2 + C coordinates.
    [[nodiscard]] HMESH_ALWAYS_INLINE double dot(const LiftedPoint& o) const {
        return position.x * o.position.x + position.y * o.position.y + (color * o.color).sum();
    }
};

/// A face a, b, c lifted to 2 + C dimensions; it may degenerate to a segment or a point. The plane of the face has an
/// orthonormal frame with its origin in a and its first axis along the longer of the sides ab and ac. Rounding then moves a foot
/// point by no more than some 1e-15 of the lengths involved, for slivers and for colours of any size; normal equations would
/// square the condition number.
template <int C>
class LiftedFace {
  public:
    /// Makes the frame of the face with these corners.
    LiftedFace(const LiftedPoint<C>& a, const LiftedPoint<C>& b, const LiftedPoint<C>& c) : a_(a) {
        LiftedPoint<C> base = b.minus(a), other = c.minus(a);
        is_swapped_ = base.dot(base) < other.dot(other);
        if (is_swapped_) std::swap(base, other);
        length_ = std::sqrt(base.dot(base));
        x_axis_ = base.times(inverse(length_));
        apex_x_ = other.dot(x_axis_);
        LiftedPoint<C> height = other.minus(x_axis_.times(apex_x_));
        height = height.minus(x_axis_.times(height.dot(x_axis_)));  // again: the first subtraction leaves rounding along the axis
        apex_y_ = std::sqrt(height.dot(height));
        y_axis_ = height.times(inverse(apex_y_));
        inverse_length_ = inverse(length_);
        inverse_height_ = inverse(apex_y_);
        inverse_near2_ = inverse(apex_x_ * apex_x_ + apex_y_ * apex_y_);
        inverse_far2_ = inverse((apex_x_ - length_) * (apex_x_ - length_) + apex_y_ * apex_y_);
    }

    /// The foot point of p on the face, as weights of the corners, all >= 0 with sum 1; `distance2` is set to its squared
    /// distance from p.
    [[nodiscard]] HMESH_ALWAYS_INLINE Barycentric foot(const LiftedPoint<C>& p, double& distance2) const {
        const LiftedPoint<C> ap = p.minus(a_);
        const double x = ap.dot(x_axis_), y = ap.dot(y_axis_), off_plane = std::max(0.0, ap.dot(ap) - x * x - y * y);
        const double h = y * inverse_height_, t = (x - h * apex_x_) * inverse_length_, rest = 1 - t - h;
        distance2 = off_plane;
        if (h >= 0 && t >= 0 && rest >= 0) return weights(rest, t, h);
        // The projection is outside the face: the foot is on one of the three sides.
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
    /// 1 / size, 0 for 0.
    [[nodiscard]] static double inverse(double size) noexcept { return size > 0 ? 1 / size : 0.0; }
    [[nodiscard]] static HMESH_ALWAYS_INLINE double square(double x) noexcept { return x * x; }
    [[nodiscard]] static HMESH_ALWAYS_INLINE double unit(double x) noexcept { return std::max(0.0, std::min(1.0, x)); }
    /// Weights of a, of the end of the base and of the apex, in the order of the corners.
    [[nodiscard]] HMESH_ALWAYS_INLINE Barycentric weights(double a, double base, double apex) const noexcept {
        return is_swapped_ ? Barycentric{a, apex, base} : Barycentric{a, base, apex};
    }

    LiftedPoint<C> a_, x_axis_, y_axis_;
    /// In the frame, a is (0, 0), the end of the base (length_, 0), the apex (apex_x_, apex_y_).
    double length_, apex_x_, apex_y_;
    double inverse_length_, inverse_height_, inverse_near2_, inverse_far2_;  ///< of the sides, squared the last two; 0 for 1 / 0
    bool is_swapped_;                                                        ///< c ends the base, b is the apex
};

namespace detail {

/// Face f of the mesh, lifted with color_scale px for a unit of stored value.
template <int C>
[[nodiscard]] LiftedFace<C> lift(const ImageMesh<C>& mesh, Face f, double color_scale) {
    const auto v = mesh.topology().vertices(f);
    const auto at = [&](Vertex u) { return LiftedPoint<C>{mesh.position(u), mesh.color(u) * color_scale}; };
    return {at(v[0]), at(v[1]), at(v[2])};
}

/// Adds a pixel of this weight, with its foot point w, to the sums of a face's corners a, b and c.
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

/// Sets `faces` to f and all faces that share a vertex with f, f first, none twice.
inline void faces_around(const HalfedgeMesh& topology, Face f, Array<Face>& faces) {
    faces.assign(1, f);
    for (const Vertex v : topology.vertices(f))
        for (const Halfedge h : topology.outgoing(v)) {
            const Face g = topology.face(h);
            if (g.is_valid() && std::find(faces.begin(), faces.end(), g) == faces.end()) faces.push_back(g);
        }
}

/// foot_sums() by foot points on lifted faces.
template <int C>
class FootSums {
  public:
    /// Of a mesh that outlives this.
    FootSums(const ImageMesh<C>& mesh, double color_scale)
        : mesh_(&mesh), topology_(&mesh.topology()), color_scale_(color_scale), corners_(2 * mesh.topology().edge_slots()) {
        clip_.sides = mesh.table().far_sides();
    }

    /// Each pixel's foot point is on the face that it lies in.
    void add_own_faces(const ParallelFor& parallel_for) {  // faces write to their own corners only
        for_each_chunk(parallel_for, topology_->face_slots(), 256, [&](std::size_t first, std::size_t last) {
            for (std::size_t k = first; k < last; ++k) {
                const Face f(k);
                if (topology_->is_deleted(f)) continue;
                const LiftedFace<C> face = lift(*mesh_, f, color_scale_);
                CornerSums<C> a, b, c;
                for_each_pixel(f, [&](const LiftedPoint<C>& pixel, const Color<C>& image, double weight) {
                    double distance2 = 0;
                    add_pixel(face.foot(pixel, distance2), weight, pixel.position, image, a, b, c);
                });
                const Sums to = sums_of(f);
                *to.a = a, *to.b = b, *to.c = c;
            }
        });
    }
    /// Each pixel's foot point is on the nearest of that face and those around it. Ends where mesh.keep_going() says stop.
    void add_rings() {
        Array<Face> faces;
        std::vector<LiftedFace<C>> lifted;
        for (const Face f : topology_->faces()) {
            if (!mesh_->keep_going()) break;
            faces_around(*topology_, f, faces);
            lifted.clear();
            for (const Face g : faces) lifted.push_back(lift(*mesh_, g, color_scale_));
            for_each_pixel(f, [&](const LiftedPoint<C>& pixel, const Color<C>& image, double weight) {
                double lowest = std::numeric_limits<double>::max();
                Barycentric best;
                std::size_t nearest = 0;
                for (std::size_t k = 0; k < faces.size(); ++k) {
                    double distance2 = 0;
                    const Barycentric w = lifted[k].foot(pixel, distance2);
                    if (!(distance2 < lowest)) continue;
                    lowest = distance2;
                    best = w;
                    nearest = k;
                }
                const Sums to = sums_of(faces[nearest]);
                add_pixel(best, weight, pixel.position, image, *to.a, *to.b, *to.c);
            });
        }
    }
    /// The sums, which are given up.
    [[nodiscard]] Array<CornerSums<C>> take() noexcept { return std::move(corners_); }

  private:
    struct Sums {
        CornerSums<C>*a, *b, *c;
    };
    [[nodiscard]] Sums sums_of(Face f) noexcept {
        const Halfedge a = topology_->halfedge(f), b = topology_->next(a), c = topology_->next(b);
        return {&corners_[a.index()], &corners_[b.index()], &corners_[c.index()]};
    }
    /// Calls body(the pixel lifted, its colour, its weight) for the pixels of a face.
    template <class Body>
    void for_each_pixel(Face f, Body&& body) const {
        const MomentTable<C>& table = mesh_->table();
        const auto v = topology_->vertices(f);
        for_each_span(mesh_->position(v[0]), mesh_->position(v[1]), mesh_->position(v[2]), clip_, [&](int j, int begin, int end) {
            for (int i = begin; i < end; ++i) {
                Color<C> image;
                table.pixel(i, j, image);
                body(LiftedPoint<C>{{i + 0.5, j + 0.5}, image * color_scale_}, image, table.weight(i, j));
            }
        });
    }

    const ImageMesh<C>* mesh_;
    const HalfedgeMesh* topology_;
    double color_scale_;
    ClipRect clip_;
    Array<CornerSums<C>> corners_;  ///< by half-edge
};

}  // namespace detail

/// The corner sums of the K whose columns are the foot points of the pixels, indexed as those of corner_sums(): with them
/// gram_matrix(), position_rhs() and image_rhs() make K K^T, K P^T and K I^T (solve/eigen.hpp). `color_scale` > 0: px that a
/// unit of stored value is worth. The mesh must tile its table's rectangle.
///
/// Chunks of faces are pieces of work, except with one_ring, which is serial because faces add to each other's corners; it
/// leaves out the faces that remain when mesh.keep_going() says stop. Lane C of `image` stays 0 unless `search` is
/// FootSearch::plane.
template <int C>
[[nodiscard]] Array<CornerSums<C>> foot_sums(const ImageMesh<C>& mesh, FootSearch search, double color_scale,
                                             const ParallelFor& parallel_for = {}) {
    if (search == FootSearch::plane) return corner_sums(mesh, parallel_for);
    detail::FootSums<C> sums(mesh, color_scale);
    if (search == FootSearch::own_face) sums.add_own_faces(parallel_for);
    else sums.add_rings();
    return sums.take();
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_HIERARCHICAL_FOOTPOINTS_HPP
