/// \file
/// Delaunay: a Delaunay triangulation of a rectangle, with insertion and removal of points.
///
/// Insertion walks to the face that holds the point, splits it and flips edges until all are locally Delaunay again (C. Lawson,
/// "Software for C1 surface interpolation", 1977). The visibility walk, which crosses any edge that separates it from its goal,
/// ends in every Delaunay triangulation (O. Devillers, S. Pion and M. Teillaud, "Walking in a triangulation", 2002): each
/// crossing lowers the power of the goal with respect to the face's circle, or keeps it among faces with one circle, whose
/// adjacency is a tree. Removal fills the hole by ears (mesh/hole_filler.hpp). All decisions are exact for points of the 1/256
/// px grid, so that no case is degenerate: collinear points, points on the border and cocircular points are allowed. Which of
/// several Delaunay triangulations results follows from the order of the calls alone.
///
/// Triangulations of rows of the rectangle, which threads may make, join to one: their sides are sewn together, and edges flip
/// from there.
///
/// Cost: 0.4 to 1 us an insertion and 0.2 to 0.6 us a removal, each near the previous one; a removal out of the cache takes up
/// to 3 us. Removing a vertex of valence k takes O(k^2). The walk visits about as many faces as lie on the straight way: 40 us
/// in random order at 100000 vertices, so insert in spatial order, as triangulate() does.
#ifndef HMESH_MESH_DELAUNAY_HPP
#define HMESH_MESH_DELAUNAY_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "hmesh/core/array.hpp"
#include "hmesh/core/assert.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/mesh/geometry.hpp"
#include "hmesh/mesh/halfedge_mesh.hpp"
#include "hmesh/mesh/handles.hpp"
#include "hmesh/mesh/hole_filler.hpp"
#include "hmesh/mesh/samples.hpp"
#include "hmesh/mesh/spatial_order.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// A Delaunay triangulation of a rectangle, with insertion and removal of points of the 1/256 px grid.
class Delaunay {
  public:
    /// The triangulation of the rectangle [0, width] x [0, height] with sides from 1 to 2^16; of an image of points, that of
    /// [1/2, width - 1/2] x [1/2, height - 1/2] with sides from 2 on (mesh/samples.hpp). Vertices 0 to 3 are its corners,
    /// clockwise on the screen from the upper left one, and cannot be removed.
    Delaunay(int width, int height, Samples samples = Samples::squares);

    [[nodiscard]] int width() const noexcept { return width_; }                              ///< px of the image
    [[nodiscard]] int height() const noexcept { return height_; }                            ///< px of the image
    [[nodiscard]] Samples samples() const noexcept { return samples_; }                      ///< of the image
    [[nodiscard]] const HalfedgeMesh& topology() const noexcept { return topology_; }        ///< the connectivity
    [[nodiscard]] Point position(Vertex v) const noexcept { return positions_[v.index()]; }  ///< position of a vertex
    /// Positions by vertex slot. The entries of deleted slots are meaningless.
    [[nodiscard]] const Array<Point>& positions() const noexcept { return positions_; }
    [[nodiscard]] static bool is_corner(Vertex v) noexcept { return v.index() < 4; }  ///< whether v is a corner

    /// Reserves memory for this number of vertices.
    void reserve(std::size_t vertices) {
        topology_.reserve(vertices);
        positions_.reserve(vertices);
    }

    /// A half-edge of a face that holds p, a point of the closed rectangle. If p is a vertex, the half-edge leaves it; if p is
    /// on an edge, the half-edge is one of that edge's. Walks from the place of the last insertion or removal.
    [[nodiscard]] Halfedge locate(Point p) const noexcept;

    /// Inserts p, a point of the 1/256 px grid in the closed rectangle, and returns its vertex: a new one, or the one already
    /// at p.
    Vertex insert(Point p);

    /// Removes the vertex v, which must not be a corner of the rectangle.
    void remove(Vertex v);

    /// Makes it the triangulation of that part of the rectangle which is between two heights, px on the grid: corners are moved
    /// there. Before anything is inserted.
    void keep_rows(double top, double bottom) noexcept;

    /// Takes in triangulations of other parts of the rectangle, each of which begins where the one before ends, the first where
    /// this one does: points were inserted into them, none there, and none removed. Where they meet a vertex stays on either side
    /// of the rectangle. O(n), by `parallel_for`, and some O(sqrt(n)) a seam, whose edges flip until all are Delaunay's.
    HMESH_COLD void join(const std::vector<std::unique_ptr<Delaunay>>& parts, const ParallelFor& parallel_for);

    /// Verifies that the faces tile the rectangle and are positively oriented, and that every edge is locally Delaunay, which
    /// makes all circumcircles empty. Otherwise invalid_argument, with the index where. O(n).
    [[nodiscard]] Status check() const;

  private:
    /// Twice the signed area of h and p, positive for p on the side of h's face.
    [[nodiscard]] double side(Halfedge h, Point p) const noexcept {
        return orient2d(position(topology_.from_vertex(h)), position(topology_.to_vertex(h)), p);
    }
    [[nodiscard]] Vertex apex(Halfedge h) const noexcept { return topology_.to_vertex(topology_.next(h)); }
    /// Flips edges around v, a new vertex, until the circumcircles of its faces are empty.
    void legalize(Vertex v);
    /// Flips the edges on the stack that are not Delaunay's, and others until all are. `is_star`: they are across from one new
    /// vertex, and only those need be looked at that come to be.
    void flip_stack(bool is_star);
    [[nodiscard]] Status check_border() const;

    /// The corners in the order of their vertices.
    [[nodiscard]] std::array<Point, 4> corners() const noexcept {
        const double left = inset(samples_), right = width_ - left;
        return {Point{left, top_}, {right, top_}, {right, bottom_}, {left, bottom_}};
    }

    int width_, height_;
    Samples samples_;
    double top_, bottom_;  ///< of the rectangle, px
    HalfedgeMesh topology_;
    Array<Point> positions_;
    Vertex last_{0};  ///< where walks begin
    Array<Halfedge> stack_, spokes_;
    HoleFiller filler_;
};

/// The Delaunay triangulation of the corners of the rectangle [0, width] x [0, height] and of `points` of the 1/256 px grid in
/// it. Vertices 0 to 3 are the corners. The points follow in spatial order, so that neighbours are near each other in memory
/// too; a point that repeats an earlier one or a corner makes no vertex.
[[nodiscard]] inline Delaunay triangulate(int width, int height, const Array<Point>& points) {
    Array<std::uint32_t> indices(points.size());
    for (std::size_t k = 0; k < indices.size(); ++k) indices[k] = static_cast<std::uint32_t>(k);
    Delaunay mesh(width, height);
    mesh.reserve(points.size() + 4);
    for (const std::uint32_t k :
         in_spatial_order<std::uint32_t>(indices, indices.size(), [&](std::uint32_t i) { return points[i]; }))
        mesh.insert(points[k]);
    return mesh;
}

HMESH_COLD inline Delaunay::Delaunay(int width, int height, Samples samples)
    : width_(width), height_(height), samples_(samples), top_(inset(samples)), bottom_(height - top_) {
    HMESH_ASSERT(extent(width, samples) >= 1 && width <= 65536 && extent(height, samples) >= 1 && height <= 65536);
    const std::array<Point, 4> at = corners();
    positions_.assign(at.begin(), at.end());
    const Status status = topology_.assign(4, {{0, 1, 2}, {0, 2, 3}});
    HMESH_ASSERT(status);
    static_cast<void>(status);
}

inline Halfedge Delaunay::locate(Point p) const noexcept {
    Halfedge h = topology_.halfedge(last_);
    if (topology_.is_boundary(h) || side(h, p) < 0) h = HalfedgeMesh::opposite(h);
    // p is never on the far side of h, so an edge of the border, with p beyond it, is never crossed.
    for (;;) {
        const Halfedge second = topology_.next(h), third = topology_.next(second);
        const double beside_second = side(second, p);
        if (beside_second < 0) {
            h = HalfedgeMesh::opposite(second);
            continue;
        }
        const double beside_third = side(third, p);
        if (beside_third < 0) {
            h = HalfedgeMesh::opposite(third);
            continue;
        }
        // In a corner two sides are zero, and the one that leaves it follows the other.
        const bool on_first = side(h, p) == 0;
        if (beside_third == 0) return on_first ? h : third;
        return beside_second == 0 ? second : h;
    }
}

inline Vertex Delaunay::insert(Point p) {
    HMESH_ASSERT(p.x >= inset(samples_) && p.x <= width_ - inset(samples_));
    HMESH_ASSERT(p.y >= top_ && p.y <= bottom_ && snap(p) == p);
    const Halfedge h = locate(p);
    last_ = topology_.from_vertex(h);
    if (position(last_) == p) return last_;
    last_ = side(h, p) == 0 ? topology_.split(HalfedgeMesh::edge(h)) : topology_.split(topology_.face(h));
    if (last_.index() == positions_.size()) positions_.push_back(p);
    else positions_[last_.index()] = p;
    legalize(last_);
    return last_;
}

inline void Delaunay::legalize(Vertex v) {
    stack_.clear();  // edges across from v, in faces of v
    for (const Halfedge h : topology_.outgoing(v))
        if (!topology_.is_boundary(h)) stack_.push_back(topology_.next(h));
    flip_stack(true);
}

inline void Delaunay::flip_stack(bool is_star) {
    while (!stack_.empty()) {
        const Halfedge h = stack_.back(), o = HalfedgeMesh::opposite(h);
        stack_.pop_back();
        if (topology_.is_boundary(o)) continue;
        const Halfedge first = topology_.next(h), left = topology_.next(o), right = topology_.next(left);
        const Point a = position(topology_.to_vertex(o)), b = position(topology_.to_vertex(h));
        const Point p = position(topology_.to_vertex(first)), q = position(topology_.to_vertex(left));
        if (in_circle(a, b, p, q) <= 0) continue;
        const Halfedge second = topology_.next(first);
        topology_.flip(HalfedgeMesh::edge(h));
        stack_.push_back(left);
        stack_.push_back(right);
        if (is_star) continue;
        stack_.push_back(first);
        stack_.push_back(second);
    }
}

inline void Delaunay::keep_rows(double top, double bottom) noexcept {
    HMESH_ASSERT(positions_.size() == 4 && top_ <= top && top < bottom && bottom <= bottom_);
    top_ = top;
    bottom_ = bottom;
    const std::array<Point, 4> at = corners();
    std::copy(at.begin(), at.end(), positions_.begin());
}

inline void Delaunay::join(const std::vector<std::unique_ptr<Delaunay>>& parts, const ParallelFor& parallel_for) {
    if (parts.empty()) return;
    // Corners 2 and 3 of this or a part, right and left, are 1 and 0 of the next. They get two slots in front of its others; the
    // last part's become those of the whole.
    Array<HalfedgeMesh::Place> places;
    std::size_t vertices = positions_.size(), edges = topology_.edge_slots(), faces = topology_.face_slots();
    const std::size_t had_vertices = vertices, had_edges = edges, had_faces = faces;
    for (const std::unique_ptr<Delaunay>& part : parts) {
        const Vertex right(vertices), left(vertices + 1);
        if (!places.empty()) places.back().corners[2] = right, places.back().corners[3] = left;
        places.push_back({{left, right, Vertex(2), Vertex(3)}, vertices - 2, 2 * edges, faces});
        vertices += part->positions_.size() - 2;
        edges += part->topology_.edge_slots();
        faces += part->topology_.face_slots();
    }
    topology_.add_slots(vertices - had_vertices, edges - had_edges, faces - had_faces);
    positions_.resize_raw(vertices);
    for (std::size_t k = 0; k < 2; ++k) {
        topology_.move(Vertex(2 + k), Vertex(had_vertices + k));
        positions_[had_vertices + k] = positions_[2 + k];
    }
    parallel_for(parts.size(), [&](std::size_t k) {
        const Array<Point>& from = parts[k]->positions_;
        topology_.copy(parts[k]->topology_, places[k]);
        for (std::size_t i = 2; i < from.size(); ++i) positions_[places[k].number(Vertex(i)).index()] = from[i];
    });
    stack_.clear();
    for (std::size_t k = 0; k < parts.size(); ++k) {
        // The half-edge of a boundary vertex is the boundary's, which runs against the faces.
        const std::size_t from_right = parts[k]->topology_.halfedge(Vertex(1)).index();
        stack_.push_back(topology_.halfedge(places[k].corners[0]));
        topology_.sew(stack_.back(), Halfedge(places[k].halfedges + from_right));
    }
    flip_stack(false);
    bottom_ = parts.back()->bottom_;
}

inline void Delaunay::remove(Vertex v) {
    HMESH_ASSERT(!is_corner(v) && !topology_.is_deleted(v));
    spokes_.clear();
    for (const Halfedge h : topology_.outgoing(v)) spokes_.push_back(h);
    const auto spoke = [this](int k) { return spokes_[static_cast<std::size_t>(k)]; };
    const Array<Ear>& ears = filler_.fill(
        static_cast<int>(spokes_.size()), [&](int k) { return position(topology_.to_vertex(spoke(k))); },
        topology_.is_boundary(v));
    // Between two flips a face of v may have no area, or a negative one: only the end counts.
    for (std::size_t k = 0; k + 1 < ears.size(); ++k) topology_.flip(HalfedgeMesh::edge(spoke(ears[k].tip)));
    // The first neighbour that is left: around a border vertex its half-edge is the boundary's.
    const Halfedge last = spoke(ears.back().before);
    last_ = topology_.to_vertex(last);
    topology_.collapse(last);
}

inline Status Delaunay::check_border() const {
    const auto fail = [](const char* what, Vertex v) -> Status {
        return {Errc::invalid_argument, what, static_cast<std::int64_t>(v.index()), 0};
    };
    const std::array<Point, 4> at = corners();
    const Point first = at[0], last = at[2];
    for (std::size_t k = 0; k < 4; ++k)
        if (topology_.is_deleted(Vertex(k)) || position(Vertex(k)) != at[k])
            return fail("a corner of the rectangle is not where it was", Vertex(k));
    double length = 0;
    for (const Vertex v : topology_.vertices()) {
        if (!topology_.is_boundary(v)) continue;
        // Against the faces: to the left along the upper side, down the left one, and so on.
        const Point a = position(v), b = position(topology_.to_vertex(topology_.halfedge(v)));
        const double dx = b.x - a.x, dy = b.y - a.y;
        const bool level = dy == 0 && ((a.y == first.y && dx < 0) || (a.y == last.y && dx > 0));
        const bool upright = dx == 0 && ((a.x == first.x && dy > 0) || (a.x == last.x && dy < 0));
        if (!level && !upright) return fail("a boundary edge does not run along a side of the rectangle, from vertex", v);
        length += std::abs(dx) + std::abs(dy);
    }
    if (length != 2 * (last.x - first.x + (last.y - first.y)))
        return fail("the boundary does not run around the rectangle once", Vertex(0));
    return {};
}

inline Status Delaunay::check() const {
    if (const Status status = topology_.check(); !status) return status;
    if (positions_.size() != topology_.vertex_slots())
        return {Errc::invalid_argument, "there are not as many positions as vertices",
                static_cast<std::int64_t>(positions_.size()), static_cast<std::int64_t>(topology_.vertex_slots())};
    // Faces that all turn the same way, with a boundary that runs around the rectangle once, cover each point once.
    if (const Status status = check_border(); !status) return status;
    for (const Face f : topology_.faces()) {
        const auto v = topology_.vertices(f);
        if (!(orient2d(position(v[0]), position(v[1]), position(v[2])) > 0))
            return {Errc::invalid_argument, "a face is not positively oriented", static_cast<std::int64_t>(f.index()), 0};
    }
    for (const Edge e : topology_.edges()) {
        if (topology_.is_boundary(e)) continue;
        const Halfedge h = HalfedgeMesh::halfedge(e), o = HalfedgeMesh::opposite(h);
        const Point a = position(topology_.to_vertex(o)), b = position(topology_.to_vertex(h));
        if (in_circle(a, b, position(apex(h)), position(apex(o))) > 0)
            return {Errc::invalid_argument, "an edge is not locally Delaunay", static_cast<std::int64_t>(e.index()), 0};
    }
    return {};
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_MESH_DELAUNAY_HPP
