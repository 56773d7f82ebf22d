/// \file
/// ImageMesh: a mesh that knows how well it matches the image under it.
///
/// A half-edge mesh plus, for each vertex, position and colour, for each edge the moments of the pixels beside it, for each
/// face its energy. Positions are local to the rectangle of the moment table and lie on the 1/256 px grid. Every public
/// edit keeps moments and energies true to the geometry, so that a flip costs one walk, moving a vertex its spokes, and
/// nothing else is touched. begin/rollback undo any sequence of edits to the last byte; with them any operator is a
/// transaction: try it, re-optimise around it, read the exact energy, keep it or not.
///
/// The mesh may be a patch of a larger one (tiles/patch.hpp): then PatchContext tell what lies outside, its rim belongs to
/// other patches too and is frozen, and rim edges that are not on the image's border stay as they are.
///
/// Memory: about 560 bytes a vertex for up to 3 channels, of which 384 are edge moments.
#ifndef HMESH_FIT_IMAGE_MESH_HPP
#define HMESH_FIT_IMAGE_MESH_HPP

#include <algorithm>
#include <cstddef>
#include <vector>

#include "hmesh/core/assert.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/core/progress.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/core/undo_array.hpp"
#include "hmesh/fit/moment_table.hpp"
#include "hmesh/fit/ring.hpp"
#include "hmesh/mesh/halfedge_mesh.hpp"
#include "hmesh/mesh/limits.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/mesh/spatial_order.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// What a mesh knows of the image and the mesh that it is a patch of.
struct PatchContext {
    Rect image;                    ///< the whole image, in the pixels of the patch's table: x, y <= 0
    bool is_part = false;          ///< whether there are other patches
    double scale = 1;              ///< mean energy of a vertex in the whole mesh over that in the patch
    TaskProgress* task = nullptr;  ///< told that work goes on; asked whether to stop
};

template <int C>
class ImageMesh {
  public:
    /// Empty, of no image: only to be assigned to.
    ImageMesh() = default;
    /// Over a table that outlives the mesh. Colours are held within [low, high] widened by limits.color_overshoot.
    ImageMesh(const MomentTable<C>& table, double low, double high, const MeshLimits& limits = {})
        : ImageMesh(table, low, high, limits, {{0, 0, table.width(), table.height()}, false, 1, nullptr}) {}
    ImageMesh(const MomentTable<C>& table, double low, double high, const MeshLimits& limits, const PatchContext& surroundings)
        : table_(&table), limits_(limits), context_(surroundings) {
        const double slack = limits.color_overshoot * (high - low);
        color_low_ = std::max(low - slack, -1e300);  // slack may overflow: float images know no range
        color_high_ = std::min(high + slack, 1e300);
    }

    /// Takes over a triangulation of the rectangle or of a part of it, with one colour a vertex or none: then they are those of
    /// the pixels under the vertices. Refuses places outside the rectangle or off the 1/256 px grid, colours that are not as many
    /// as the vertices, numbers that are not finite, and what HalfedgeMesh::assign refuses; the mesh is then empty. Whether faces
    /// turn the right way and tile the rectangle is for check() to say. Edges and faces are filled in through the executor.
    [[nodiscard]] HMESH_COLD Status assign(const std::vector<Point>& positions, const std::vector<Triangle>& triangles,
                                           const std::vector<Color<C>>& colors, const ParallelFor& parallel_for = {});
    [[nodiscard]] Status assign(const std::vector<Point>& positions, const std::vector<Triangle>& triangles,
                                const ParallelFor& parallel_for = {}) {
        return assign(positions, triangles, {}, parallel_for);
    }
    /// The same from plain arrays, to go on working on a mesh of C channels whose image is as large as the table: vertex i is
    /// number i there, face f number f. to_mesh() is the way back.
    [[nodiscard]] HMESH_COLD Status assign(const Mesh& mesh, const ParallelFor& parallel_for = {});

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
    /// The mean of its corners.
    [[nodiscard]] Point centroid(Face f) const noexcept {
        const auto v = topology_.vertices(f);
        const Point a = position(v[0]), b = position(v[1]), c = position(v[2]);
        return {(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3};
    }
    /// The squared error over the pixels of a face, summed over channels; and over all faces.
    [[nodiscard]] double energy(Face f) const noexcept { return energies_[f.index()]; }
    [[nodiscard]] double energy() const noexcept { return energy_; }
    /// Over the faces of a ring that was gathered here.
    [[nodiscard]] double energy(const Ring<C>& ring) const noexcept {
        double sum = 0;
        for (int i = ring.first_face(); i < ring.size; ++i) sum += energy(topology_.face(ring.halfedge[i]));
        return sum;
    }
    /// The mean energy of a vertex, of the whole mesh if this is a patch: the scale of all tolerances, or easy patches
    /// would be polished for nothing; 0 where rounding left less.
    [[nodiscard]] double mean_energy() const noexcept {
        return context_.scale * std::max(0.0, energy_) / static_cast<double>(vertex_count());
    }
    /// To be called by long work every few microseconds; where it says false, the work ends as it is.
    [[nodiscard]] bool keep_going() const { return context_.task == nullptr || context_.task->keep_going(); }
    [[nodiscard]] TaskProgress* task() const noexcept { return context_.task; }
    void set_task(TaskProgress* task) noexcept { context_.task = task; }

    /// The moments of a half-edge (those of its edge, with a sign), written to `out`.
    HMESH_ALWAYS_INLINE void moments(Halfedge h, Moments<C>& out) const {
        out = moments_[h.index() >> 1U];
        if ((h.index() & 1U) != 0) out *= -1.0;
    }
    /// The same, added.
    HMESH_ALWAYS_INLINE void add_moments(Halfedge h, Moments<C>& out) const {
        const Moments<C>& m = moments_[h.index() >> 1U];
        if ((h.index() & 1U) != 0) out -= m;
        else out += m;
    }
    /// Of the pixels of a face.
    void face_moments(Face f, Moments<C>& out) const {
        const Halfedge h = topology_.halfedge(f);
        moments(h, out);
        add_moments(topology_.next(h), out);
        add_moments(topology_.next(topology_.next(h)), out);
    }

    /// The ring of v and the moments of its spokes. v has at most ring_capacity neighbours.
    void gather(Vertex v, Ring<C>& ring, Spokes<C>& spokes) const {
        ring.size = 0;
        ring.open = topology_.is_boundary(v);
        for (const Halfedge h : topology_.outgoing(v)) {
            HMESH_ASSERT(ring.size < ring_capacity);
            const int i = ring.size++;
            ring.halfedge[i] = h;
            ring.neighbor[i] = &vertex(topology_.to_vertex(h));
            moments(h, spokes.spoke[i]);
            if (!topology_.is_boundary(h)) moments(topology_.next(h), ring.link[i]);
        }
    }
    /// Where a vertex with this mobility may be: on the grid, within the table, off the image's border unless it lives
    /// there. A coordinate that is not free to move is returned as given.
    [[nodiscard]] Point clamp(Point p, Mobility mobility) const noexcept;
    /// Of a vertex at p: free unless p is on the image's border.
    [[nodiscard]] Mobility mobility_at(Point p) const noexcept {
        const Rect& image = context_.image;
        const bool on_x = p.x == image.x || p.x == image.x + image.width, on_y = p.y == image.y || p.y == image.y + image.height;
        return on_x && on_y ? Mobility::corner : on_x ? Mobility::along_y : on_y ? Mobility::along_x : Mobility::free;
    }
    /// Of a vertex that splits e; frozen: a rim edge of the patch, which must not be split.
    [[nodiscard]] Mobility edge_mobility(Edge e) const noexcept {
        if (!topology_.is_boundary(e)) return Mobility::free;
        const Halfedge h = HalfedgeMesh::halfedge(e);
        const Mobility mobility = mobility_at(midpoint(position(topology_.from_vertex(h)), position(topology_.to_vertex(h))));
        return mobility == Mobility::free ? Mobility::locked : mobility;
    }
    /// Whether v may get one more edge.
    [[nodiscard]] bool can_gain_edge(Vertex v) const noexcept { return topology_.valence(v) < vertex(v).valence_limit; }
    void set_scale(double scale) noexcept { context_.scale = scale; }
    /// From now on v stays as it is, with at most this many edges. Not undone by rollback.
    void lock(Vertex v, int valence_limit) noexcept {
        VertexState<C>& state = vertices_.raw(v.index());
        state.mobility = Mobility::locked;
        state.valence_limit = static_cast<unsigned char>(valence_limit);
    }

    // --- edits ---
    /// A new state for v whose consequences are known: fits of its ring's faces and, if it moved, moments of its spokes.
    void apply_fit(Vertex v, const Ring<C>& ring, Point position, const Color<C>& color, const FaceFit<C>* faces,
                   const Spokes<C>* moved);
    /// A new state for v; spokes are walked. All faces around must have positive area.
    void place(Vertex v, Point position, const Color<C>& color);
    /// Turns edge e, whose moments and whose faces' energies after the turn are known.
    void flip(Edge e, const Moments<C>& m, double energy_own, double energy_opposite);
    /// New vertices. The caller makes sure that the new faces have positive area.
    Vertex split(Edge e, Point position, const Color<C>& color);
    Vertex split(Face f, Point position, const Color<C>& color);
    /// Merges from_vertex(h) into to_vertex(h), which stays where it is.
    void collapse(Halfedge h);
    /// New colours for all vertices, indexed by slot; energies follow.
    HMESH_COLD void set_colors(const std::vector<Color<C>>& colors, const ParallelFor& parallel_for = {});

    // --- transactions; they nest ---
    struct Mark {
        HalfedgeMesh::Mark topology;
        typename UndoArray<VertexState<C>>::Mark vertices;
        typename UndoArray<Moments<C>>::Mark moments;
        UndoArray<double>::Mark energies;
        double energy;
    };
    /// From here on changes can be undone.
    [[nodiscard]] Mark begin() {
        ++depth_;
        return {topology_.begin(), vertices_.mark(), moments_.mark(), energies_.mark(), energy_};
    }
    /// Keeps what was done since.
    void commit(const Mark& mark) noexcept {
        topology_.commit(mark.topology);
        close();
    }
    /// Brings all back to what it was at that mark.
    void rollback(const Mark& mark) {
        vertices_.rollback(mark.vertices);
        moments_.rollback(mark.moments);
        energies_.rollback(mark.energies);
        energy_ = mark.energy;
        topology_.rollback(mark.topology);
        close();
    }

    /// Room for this many vertices at once, so that growing up to it copies nothing.
    void reserve(std::size_t vertices) {
        topology_.reserve(vertices);
        vertices_.reserve(vertices);
        moments_.reserve(3 * vertices);
        energies_.reserve(2 * vertices);
        dirty_.reserve(vertices);
    }

    /// Vertices whose surroundings changed since they were last optimised; sweeps visit only these.
    [[nodiscard]] bool is_dirty(Vertex v) const noexcept { return dirty_[v.index()] != 0; }
    void set_dirty(Vertex v, bool due) noexcept { dirty_[v.index()] = due ? 1 : 0; }
    /// V and its neighbours.
    void set_ring_dirty(Vertex v) noexcept {
        set_dirty(v, true);
        for (const Halfedge h : topology_.outgoing(v)) set_dirty(topology_.to_vertex(h), true);
    }

    /// Proves what this class promises: the topology's invariants, faces that turn the right way and tile what they tiled
    /// when assigned (the rectangle, unless the mesh is a patch), moments as walked afresh, energies as computed afresh
    /// (1e-9 relative). O(edges).
    [[nodiscard]] HMESH_COLD Status check() const;

  private:
    /// Why these cannot be the vertices, if they cannot.
    [[nodiscard]] Status check_vertices(const std::vector<Point>& positions, const std::vector<Color<C>>& colors) const noexcept;
    /// Empties the mesh and gives back why.
    Status refuse(const Status& status);
    /// A transaction; the outermost forgets all notes.
    void close() noexcept {
        if (--depth_ > 0) return;
        vertices_.stop_recording();
        moments_.stop_recording();
        energies_.stop_recording();
    }
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
    /// Grows the arrays to the topology's slots after a split, and fills in everything around the new vertex.
    void adopt(Vertex v, Point position, const Color<C>& color, Mobility mobility);
    void refresh_ring(Vertex v);

    const MomentTable<C>* table_ = nullptr;
    MeshLimits limits_;
    PatchContext context_;
    double color_low_ = 0, color_high_ = 0;
    HalfedgeMesh topology_;
    UndoArray<VertexState<C>> vertices_;
    UndoArray<Moments<C>> moments_;  ///< per edge, of halfedge(e)
    UndoArray<double> energies_;     ///< per face
    double energy_ = 0;
    double twice_area_ = 0;  ///< of all faces
    std::vector<unsigned char> dirty_;
    int depth_ = 0;
};

/// As plain arrays: vertices and faces in the order of topology(), deleted ones left out, positions in the plane of the table,
/// colours rounded to float. `peak`: the colour value of full intensity.
template <int C>
[[nodiscard]] HMESH_COLD Mesh to_mesh(const ImageMesh<C>& from, double peak);

/// Vertices, faces and edges in the order in which operators visit them, see mesh/spatial_order.hpp.
template <int C>
[[nodiscard]] std::vector<Vertex> spatial_vertices(const ImageMesh<C>& mesh) {
    return spatial_vertices(mesh.topology(), [&](Vertex v) { return mesh.position(v); });
}
template <int C>
[[nodiscard]] std::vector<Face> spatial_faces(const ImageMesh<C>& mesh) {
    return spatial_faces(mesh.topology(), [&](Vertex v) { return mesh.position(v); });
}
template <int C>
[[nodiscard]] std::vector<Edge> spatial_edges(const ImageMesh<C>& mesh) {
    return spatial_edges(mesh.topology(), [&](Vertex v) { return mesh.position(v); });
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#include "hmesh/fit/image_mesh.ipp"

#endif  // HMESH_FIT_IMAGE_MESH_HPP
