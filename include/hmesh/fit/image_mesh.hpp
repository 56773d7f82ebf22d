// hmesh - ImageMesh: a mesh that knows how well it matches the image under it.
//
// A half-edge mesh plus, for each vertex, position and colour, for each edge the moments of the pixels beside it, for each
// face its energy. Positions are local to the rectangle of the moment table and lie on the 1/256 px grid. Every public
// edit keeps moments and energies true to the geometry, so that a flip costs one walk, moving a vertex its spokes, and
// nothing else is touched. begin/rollback undo any sequence of edits to the last byte; with them any operator is a
// transaction: try it, re-optimise around it, read the exact energy, keep it or not.
//
// Memory: about 560 bytes a vertex for up to 3 channels, of which 384 are edge moments.
#ifndef HMESH_FIT_IMAGE_MESH_HPP
#define HMESH_FIT_IMAGE_MESH_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "hmesh/core/assert.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/core/undo_array.hpp"
#include "hmesh/fit/ring.hpp"
#include "hmesh/image/moment_table.hpp"
#include "hmesh/mesh/halfedge_mesh.hpp"
#include "hmesh/mesh/spatial_order.hpp"

namespace hmesh {

template <int C>
class ImageMesh {
  public:
    // Over a table that outlives the mesh. Colours are held within [low, high] widened by limits.color_overshoot.
    ImageMesh(const MomentTable<C>& table, double low, double high, const MeshLimits& limits = {})
        : table_(&table), limits_(limits) {
        const double slack = limits.color_overshoot * (high - low);
        color_low_ = std::max(low - slack, -1e300);  // slack may overflow: float images know no range
        color_high_ = std::min(high + slack, 1e300);
    }

    // Takes over a triangulation of the rectangle with corners on the 1/256 px grid; colours are the pixels under the
    // vertices. Refuses what HalfedgeMesh::assign refuses. Edges and faces are filled in through the executor.
    template <class ParallelFor = SerialFor>
    [[nodiscard]] Status assign(const std::vector<Point>& positions, const std::vector<Triangle>& triangles,
                                const ParallelFor& parallel_for = {});

    [[nodiscard]] const HalfedgeMesh& topology() const noexcept { return topology_; }
    [[nodiscard]] const MomentTable<C>& table() const noexcept { return *table_; }
    [[nodiscard]] const MeshLimits& limits() const noexcept { return limits_; }
    [[nodiscard]] double color_low() const noexcept { return color_low_; }
    [[nodiscard]] double color_high() const noexcept { return color_high_; }
    [[nodiscard]] int width() const noexcept { return table_->width(); }
    [[nodiscard]] int height() const noexcept { return table_->height(); }
    [[nodiscard]] std::size_t vertex_count() const noexcept { return topology_.vertex_count(); }
    [[nodiscard]] const VertexState<C>& vertex(Vertex v) const noexcept { return vertices_[v.index()]; }
    [[nodiscard]] Point position(Vertex v) const noexcept { return vertex(v).position; }
    [[nodiscard]] const Color<C>& color(Vertex v) const noexcept { return vertex(v).color; }
    [[nodiscard]] Point centroid(Face f) const noexcept {
        const auto v = topology_.vertices(f);
        const Point a = position(v[0]), b = position(v[1]), c = position(v[2]);
        return {(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3};
    }
    // The squared error over the pixels of a face, summed over channels; and over all faces.
    [[nodiscard]] double energy(Face f) const noexcept { return energies_[f.index()]; }
    [[nodiscard]] double energy() const noexcept { return energy_; }
    // The mean energy of a vertex: the scale of all tolerances.
    [[nodiscard]] double mean_energy() const noexcept { return energy_ / static_cast<double>(vertex_count()); }

    // The moments of a half-edge (those of its edge, with a sign), written to or added to `out`.
    HMESH_ALWAYS_INLINE void moments(Halfedge h, Moments<C>& out) const {
        out = moments_[h.index() >> 1U];
        if ((h.index() & 1U) != 0) out *= -1.0;
    }
    HMESH_ALWAYS_INLINE void add_moments(Halfedge h, Moments<C>& out) const {
        const Moments<C>& m = moments_[h.index() >> 1U];
        if ((h.index() & 1U) != 0) out -= m;
        else out += m;
    }
    void face_moments(Face f, Moments<C>& out) const {
        const Halfedge h = topology_.halfedge(f);
        moments(h, out);
        add_moments(topology_.next(h), out);
        add_moments(topology_.next(topology_.next(h)), out);
    }

    // The ring of v and the moments of its spokes. v has at most ring_capacity neighbours.
    void gather(Vertex v, Ring<C>& ring, Spokes<C>& spokes) const {
        ring.size = 0;
        ring.open = topology_.is_boundary(v);
        for (const Halfedge h : topology_.outgoing(v)) {
            HMESH_ASSERT(ring.size < ring_capacity);
            const int i = ring.size++;
            ring.halfedge[i] = h;
            ring.neighbour[i] = &vertex(topology_.to_vertex(h));
            moments(h, spokes.spoke[i]);
            if (!topology_.is_boundary(h)) moments(topology_.next(h), ring.link[i]);
        }
    }
    // Where a vertex with this mobility may be: on the grid, off the border unless it lives there.
    [[nodiscard]] Point clamp(Point p, Mobility mobility) const noexcept {
        const double gap = limits_.border_gap, w = width() - gap, h = height() - gap;
        Point q = p;
        if (mobility == Mobility::free || mobility == Mobility::along_x) q.x = snap(std::max(gap, std::min(w, p.x)));
        if (mobility == Mobility::free || mobility == Mobility::along_y) q.y = snap(std::max(gap, std::min(h, p.y)));
        return q;
    }
    [[nodiscard]] Mobility edge_mobility(Edge e) const noexcept {  // of a vertex that splits e
        if (!topology_.is_boundary(e)) return Mobility::free;
        const Halfedge h = HalfedgeMesh::halfedge(e);
        const double y0 = position(topology_.from_vertex(h)).y, y1 = position(topology_.to_vertex(h)).y;
        return y0 == y1 ? Mobility::along_x : Mobility::along_y;
    }

    // --- edits ---
    // A new state for v whose consequences are known: fits of its ring's faces and, if it moved, moments of its spokes.
    void settle(Vertex v, const Ring<C>& ring, Point position, const Color<C>& color, const FaceFit<C>* faces,
                const Spokes<C>* moved);
    // A new state for v; spokes are walked. All faces around must have positive area.
    void place(Vertex v, Point position, const Color<C>& color);
    // Turns edge e, whose moments and whose faces' energies after the turn are known.
    void flip(Edge e, const Moments<C>& m, double energy_own, double energy_opposite);
    // New vertices. The caller makes sure that the new faces have positive area.
    Vertex split(Edge e, Point position, const Color<C>& color);
    Vertex split(Face f, Point position, const Color<C>& color);
    // Merges from_vertex(h) into to_vertex(h), which stays where it is.
    void collapse(Halfedge h);
    // New colours for all vertices, indexed by slot; energies follow.
    template <class ParallelFor = SerialFor>
    void set_colors(const std::vector<Color<C>>& colors, const ParallelFor& parallel_for = {});

    // --- transactions; they nest ---
    struct Mark {
        HalfedgeMesh::Mark topology;
        typename UndoArray<VertexState<C>>::Mark vertices;
        typename UndoArray<Moments<C>>::Mark moments;
        UndoArray<double>::Mark energies;
        double energy;
    };
    [[nodiscard]] Mark begin() {
        ++depth_;
        return {topology_.begin(), vertices_.mark(), moments_.mark(), energies_.mark(), energy_};
    }
    void commit(const Mark& mark) noexcept {
        topology_.commit(mark.topology);
        if (--depth_ > 0) return;
        vertices_.stop_recording();
        moments_.stop_recording();
        energies_.stop_recording();
    }
    void rollback(const Mark& mark) {
        vertices_.rollback(mark.vertices);
        moments_.rollback(mark.moments);
        energies_.rollback(mark.energies);
        energy_ = mark.energy;
        topology_.rollback(mark.topology);
        if (--depth_ > 0) return;
        vertices_.stop_recording();
        moments_.stop_recording();
        energies_.stop_recording();
    }

    // Renumbers all elements in spatial order, without deleted slots, in new memory with room for `room` vertices: what is
    // near in the plane is then near in memory. Positions, colours and due vertices stay.
    template <class ParallelFor = SerialFor>
    void compact(std::size_t room, const ParallelFor& parallel_for = {});

    // Room for this many vertices at once, so that growing up to it copies nothing.
    void reserve(std::size_t vertices) {
        topology_.reserve(vertices);
        vertices_.reserve(vertices);
        moments_.reserve(3 * vertices);
        energies_.reserve(2 * vertices);
        visits_.reserve(vertices);
    }

    // Vertices whose surroundings changed since they were last optimised; sweeps visit only these.
    [[nodiscard]] bool is_due(Vertex v) const noexcept { return visits_[v.index()] != 0; }
    void set_due(Vertex v, bool due) noexcept { visits_[v.index()] = due ? 1 : 0; }
    void set_ring_due(Vertex v) noexcept {
        set_due(v, true);
        for (const Halfedge h : topology_.outgoing(v)) set_due(topology_.to_vertex(h), true);
    }

    // Proves what this class promises: the topology's invariants, faces that turn the right way and tile the rectangle,
    // moments as walked afresh, energies as computed afresh (1e-9 relative). O(edges).
    [[nodiscard]] Status check() const;

  private:
    void walk(Halfedge h) {
        Moments<C> m;
        edge_moments(*table_, position(topology_.from_vertex(h)), position(topology_.to_vertex(h)), m);
        if ((h.index() & 1U) != 0) m *= -1.0;
        moments_.edit(h.index() >> 1U) = m;
    }
    [[nodiscard]] double fresh_energy(Face f) const {
        Moments<C> m;
        face_moments(f, m);
        const auto v = topology_.vertices(f);
        return face_energy(m, vertex(v[0]), vertex(v[1]), vertex(v[2]));
    }
    void set_energy(Face f, double energy) {
        double& stored = energies_.edit(f.index());
        energy_ += energy - stored;
        stored = energy;
    }
    // Grows the arrays to the topology's slots after a split, and fills in everything around the new vertex.
    void adopt(Vertex v, Point position, const Color<C>& color, Mobility mobility);
    void refresh_ring(Vertex v);

    const MomentTable<C>* table_;
    MeshLimits limits_;
    double color_low_ = 0, color_high_ = 0;
    HalfedgeMesh topology_;
    UndoArray<VertexState<C>> vertices_;
    UndoArray<Moments<C>> moments_;  // per edge, of halfedge(e)
    UndoArray<double> energies_;     // per face
    double energy_ = 0;
    std::vector<unsigned char> visits_;
    int depth_ = 0;
};

template <int C>
template <class ParallelFor>
Status ImageMesh<C>::assign(const std::vector<Point>& positions, const std::vector<Triangle>& triangles,
                            const ParallelFor& parallel_for) {
    if (const Status status = topology_.assign(positions.size(), triangles); !status) return status;
    vertices_.resize(positions.size());
    moments_.resize(topology_.edge_slots());
    energies_.resize(topology_.face_slots());
    visits_.assign(positions.size(), 1);
    for (std::size_t i = 0; i < positions.size(); ++i) {
        const Point p = positions[i];
        const bool on_x = p.x == 0 || p.x == width(), on_y = p.y == 0 || p.y == height();
        VertexState<C>& state = vertices_.raw(i);
        state.position = p;
        state.mobility = on_x && on_y ? Mobility::fixed : on_x ? Mobility::along_y : on_y ? Mobility::along_x : Mobility::free;
        table_->pixel(std::min(static_cast<int>(p.x), width() - 1), std::min(static_cast<int>(p.y), height() - 1), state.color);
    }
    for_each_chunk(parallel_for, topology_.edge_slots(), 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t e = begin; e < end; ++e) {
            const Halfedge h = HalfedgeMesh::halfedge(Edge(e));
            edge_moments(*table_, position(topology_.from_vertex(h)), position(topology_.to_vertex(h)), moments_.raw(e));
        }
    });
    energy_ = ordered_sum(parallel_for, topology_.face_slots(), 1024, [&](std::size_t begin, std::size_t end) {
        double sum = 0;
        for (std::size_t f = begin; f < end; ++f) sum += energies_.raw(f) = fresh_energy(Face(f));
        return sum;
    });
    return {};
}

template <int C>
template <class ParallelFor>
void ImageMesh<C>::compact(std::size_t room, const ParallelFor& parallel_for) {
    HMESH_ASSERT(depth_ == 0);
    ImageMesh fresh(*table_, color_low_, color_high_, limits_);
    fresh.color_low_ = color_low_;
    fresh.color_high_ = color_high_;
    {
        std::vector<Point> positions;
        std::vector<Color<C>> colors;
        std::vector<std::uint32_t> number(topology_.vertex_slots());
        std::vector<Triangle> triangles;
        positions.reserve(vertex_count());
        colors.reserve(vertex_count());
        triangles.reserve(topology_.face_count());
        std::vector<unsigned char> visits;
        visits.reserve(vertex_count());
        for (const Vertex v : in_spatial_order<Vertex>(topology_.vertices(), vertex_count(), [&](Vertex u) { return position(u); })) {
            number[v.index()] = static_cast<std::uint32_t>(positions.size());
            positions.push_back(position(v));
            colors.push_back(color(v));
            visits.push_back(visits_[v.index()]);
        }
        for (const Face f : in_spatial_order<Face>(topology_.faces(), topology_.face_count(), [&](Face g) { return centroid(g); })) {
            const auto v = topology_.vertices(f);
            triangles.push_back({number[v[0].index()], number[v[1].index()], number[v[2].index()]});
        }
        topology_ = {};  // gives its memory back before the new one is filled
        vertices_ = {};
        moments_ = {};
        energies_ = {};
        fresh.reserve(std::max(room, positions.size()));
        const Status status = fresh.assign(positions, triangles, parallel_for);
        HMESH_ASSERT(status);
        (void)status;
        fresh.set_colors(colors, parallel_for);
        fresh.visits_ = std::move(visits);
    }
    *this = std::move(fresh);
}

template <int C>
template <class ParallelFor>
void ImageMesh<C>::set_colors(const std::vector<Color<C>>& colors, const ParallelFor& parallel_for) {
    HMESH_ASSERT(depth_ == 0 && colors.size() == vertices_.size());
    for (std::size_t i = 0; i < colors.size(); ++i) vertices_.raw(i).color = colors[i];
    energy_ = ordered_sum(parallel_for, topology_.face_slots(), 1024, [&](std::size_t begin, std::size_t end) {
        double sum = 0;
        for (std::size_t f = begin; f < end; ++f)
            if (!topology_.is_deleted(Face(f))) sum += energies_.raw(f) = fresh_energy(Face(f));
        return sum;
    });
}

template <int C>
void ImageMesh<C>::settle(Vertex v, const Ring<C>& ring, Point position, const Color<C>& color, const FaceFit<C>* faces,
                          const Spokes<C>* moved) {
    VertexState<C>& state = vertices_.edit(v.index());
    state.position = position;
    state.color = color;
    for (int i = ring.first_face(); i < ring.size; ++i) set_energy(topology_.face(ring.halfedge[i]), faces[i].energy(color));
    if (moved == nullptr) return;
    for (int i = 0; i < ring.size; ++i) {
        const std::size_t h = ring.halfedge[i].index();
        Moments<C>& m = moments_.edit(h >> 1U);
        m = moved->spoke[i];
        if ((h & 1U) != 0) m *= -1.0;
    }
}

template <int C>
void ImageMesh<C>::refresh_ring(Vertex v) {
    for (const Halfedge h : topology_.outgoing(v)) walk(h);
    for (const Halfedge h : topology_.outgoing(v))
        if (!topology_.is_boundary(h)) set_energy(topology_.face(h), fresh_energy(topology_.face(h)));
}

template <int C>
void ImageMesh<C>::place(Vertex v, Point position, const Color<C>& color) {
    VertexState<C>& state = vertices_.edit(v.index());
    state.position = position;
    state.color = color;
    refresh_ring(v);
}

template <int C>
void ImageMesh<C>::flip(Edge e, const Moments<C>& m, double energy_own, double energy_opposite) {
    topology_.flip(e);
    moments_.edit(e.index()) = m;
    const Halfedge h = HalfedgeMesh::halfedge(e);
    set_energy(topology_.face(h), energy_own);
    set_energy(topology_.face(HalfedgeMesh::opposite(h)), energy_opposite);
}

template <int C>
void ImageMesh<C>::adopt(Vertex v, Point position, const Color<C>& color, Mobility mobility) {
    const VertexState<C> state{color, position, mobility};
    if (v.index() == vertices_.size()) vertices_.push_back(state);
    else vertices_.edit(v.index()) = state;
    if (v.index() >= visits_.size()) visits_.push_back(1);
    visits_[v.index()] = 1;
    while (moments_.size() < topology_.edge_slots()) moments_.push_back(Moments<C>::zero());
    while (energies_.size() < topology_.face_slots()) energies_.push_back(0.0);
    refresh_ring(v);
}

template <int C>
Vertex ImageMesh<C>::split(Edge e, Point position, const Color<C>& color) {
    const Mobility mobility = edge_mobility(e);
    const Vertex v = topology_.split(e);
    adopt(v, position, color, mobility);
    return v;
}

template <int C>
Vertex ImageMesh<C>::split(Face f, Point position, const Color<C>& color) {
    const Vertex v = topology_.split(f);
    adopt(v, position, color, Mobility::free);
    return v;
}

template <int C>
void ImageMesh<C>::collapse(Halfedge h) {
    const Halfedge o = HalfedgeMesh::opposite(h);
    const Vertex v = topology_.to_vertex(o);
    const Halfedge left = topology_.is_boundary(h) ? Halfedge() : topology_.next(topology_.next(h));
    const Halfedge right = topology_.is_boundary(o) ? Halfedge() : topology_.next(o);
    Halfedge spokes[ring_capacity];  // that turn from v to the other vertex
    Face faces[ring_capacity];       // likewise
    int spoke_count = 0, face_count = 0;
    for (const Halfedge s : topology_.outgoing(v)) {
        if (s != h && s != right && s != HalfedgeMesh::opposite(left)) spokes[spoke_count++] = s;
        if (topology_.is_boundary(s)) continue;
        const Face f = topology_.face(s);
        if (f == topology_.face(h) || f == topology_.face(o)) set_energy(f, 0);
        else faces[face_count++] = f;
    }
    topology_.collapse(h);
    for (int i = 0; i < spoke_count; ++i) walk(spokes[i]);
    for (int i = 0; i < face_count; ++i) set_energy(faces[i], fresh_energy(faces[i]));
}

template <int C>
Status ImageMesh<C>::check() const {
    if (const Status status = topology_.check(); !status) return status;
    const auto fail = [](const char* what, std::size_t where) -> Status {
        return {Errc::invalid_argument, what, static_cast<std::int64_t>(where), 0};
    };
    for (const Vertex v : topology_.vertices()) {
        const VertexState<C>& state = vertex(v);
        if (snap(state.position) != state.position) return fail("a vertex is off the grid", v.index());
        if (state.color[C] != 0) return fail("a colour's padding is not zero", v.index());
        if (topology_.is_boundary(v) == (state.mobility == Mobility::free)) return fail("a vertex's mobility is wrong", v.index());
    }
    double area = 0, energy = 0, scale = 0;
    for (const Face f : topology_.faces()) {
        const auto v = topology_.vertices(f);
        const double twice = cross(position(v[0]), position(v[1]), position(v[2]));
        if (!(twice > 0)) return fail("a face is flipped or has no area", f.index());
        area += twice;
        Moments<C> m;
        face_moments(f, m);
        const double fresh = fresh_energy(f);
        // Rounding is relative to the squares that cancel, and grows with the slopes of slivers.
        if (!(std::abs(fresh - this->energy(f)) <= 1e-9 * (m.q[3] + energy_) + 1e-6))
            return fail("a face's energy is stale", f.index());
        energy += fresh;
        scale += m.q[3];
    }
    if (area != 2.0 * width() * height()) return fail("the faces do not tile the rectangle", 0);
    if (!(std::abs(energy - energy_) <= 1e-9 * (energy + scale) + 1e-6)) return fail("the total energy is stale", 0);
    for (const Edge e : topology_.edges()) {
        const Halfedge h = HalfedgeMesh::halfedge(e);
        Moments<C> fresh;
        edge_moments(*table_, position(topology_.from_vertex(h)), position(topology_.to_vertex(h)), fresh);
        const Moments<C>& m = moments_[e.index()];
        for (int k = 0; k < C + 1; ++k)
            if (fresh.s[k] != m.s[k] || fresh.sx[k] != m.sx[k] || fresh.sy[k] != m.sy[k])
                return fail("an edge's moments are stale", e.index());
        for (int k = 0; k < 4; ++k)
            if (fresh.q[k] != m.q[k]) return fail("an edge's moments are stale", e.index());
    }
    return {};
}

}  // namespace hmesh

#endif  // HMESH_FIT_IMAGE_MESH_HPP
