/// \file
/// ImageMesh: a triangle mesh over an image that knows its squared error.
///
/// A half-edge mesh that stores for each vertex position and colour, for each edge the moments of the pixels left of it, for
/// each face its energy. Positions are local to the rectangle of the moment table and lie on the 1/256 px grid. Every public
/// edit keeps moments and energies true to the geometry: a flip costs one walk, moving a vertex the walks of its spokes, and
/// nothing else is touched. begin/commit/rollback make any sequence of edits a transaction, undone to the last byte: try it,
/// re-optimise around it, read the exact energy, keep it or not.
///
/// The mesh may be a patch of a larger one (tiles/patch.hpp). PatchContext then tells what lies outside; the rim of the patch
/// belongs to other patches too and is locked, and rim edges that are not on the image's border stay as they are.
///
/// Memory: about 560 bytes a vertex for up to 3 channels, of which 384 are edge moments.
#ifndef HMESH_FIT_IMAGE_MESH_HPP
#define HMESH_FIT_IMAGE_MESH_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "hmesh/core/array.hpp"
#include "hmesh/core/assert.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/core/progress.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/fit/moment_table.hpp"
#include "hmesh/fit/ring.hpp"
#include "hmesh/mesh/halfedge_mesh.hpp"
#include "hmesh/mesh/limits.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/mesh/periodic.hpp"
#include "hmesh/mesh/samples.hpp"
#include "hmesh/mesh/spatial_order.hpp"
#include "hmesh/mesh/undo_array.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// What an ImageMesh knows of the image and of the whole mesh that it is a patch of.
struct PatchContext {
    Rect image;                    ///< the whole image in the coordinates of the patch's table: x, y <= 0
    bool is_part = false;          ///< whether there are other patches
    double scale = 1;              ///< ratio of mean energies a vertex, whole mesh / this patch; multiplies all tolerances
    TaskProgress* task = nullptr;  ///< told that work goes on, asked whether to stop; may be null
    /// Along which axes the image repeats: there it has no border, and may begin at any x or y.
    Periodic periodic = Periodic::none;
    /// Whether the lines where it repeats, image.x + k * image.width and image.y + k * image.height, are seams: edges of the mesh
    /// that are neither flipped nor left by their vertices.
    bool has_seams = false;
    Samples samples = Samples::squares;  ///< what the image has, and with that where the mesh's border lies (mesh/samples.hpp)
    bool has_fixed_border = false;       ///< whether vertices and edges on that border stay as they are
};

/// A triangle mesh of C channels over a moment table that knows the squared error of each face.
template <int C>
class ImageMesh {
  public:
    /// Placeholder without a table; assign another ImageMesh before use.
    ImageMesh() = default;
    /// An empty mesh over the table of a whole image, which must outlive it. Colours are kept within [low, high], widened by
    /// limits.color_overshoot.
    ImageMesh(const MomentTable<C>& table, double low, double high, const MeshLimits& limits = {})
        : ImageMesh(table, low, high, limits, context_of_whole(table)) {}
    /// An empty mesh over the table of a patch, which must outlive it.
    ImageMesh(const MomentTable<C>& table, double low, double high, const MeshLimits& limits, const PatchContext& context)
        : table_(&table), limits_(limits), context_(context) {
        const double slack = limits.color_overshoot * (high - low);
        color_low_ = std::max(low - slack, -1e300);  // slack may overflow: float images know no range
        color_high_ = std::min(high + slack, 1e300);
        const double gap = std::max(limits.border_gap, limits.position_step);
        low_ = first_place(gap), high_ = last_place(gap);
    }

    /// Replaces the mesh by a triangulation of the rectangle, or of a part of it if this is a patch, with one colour a vertex or
    /// none (an empty vector): then the colour of a vertex is that of the pixel at its position. Refuses, and leaves the mesh
    /// empty: positions outside the rectangle or off the 1/256 px grid, another number of colours than of vertices, numbers that
    /// are not finite, and what HalfedgeMesh::assign() refuses. Whether faces are positively oriented and tile the rectangle is
    /// for check() to say. The executor fills in edges and faces.
    [[nodiscard]] HMESH_PATCHWISE Status assign(const Array<Point>& positions, const Array<Triangle>& triangles,
                                                const Array<Color<C>>& colors, const ParallelFor& parallel_for = {});
    /// Replaces the mesh by a triangulation as above, with the colours of the pixels.
    [[nodiscard]] Status assign(const Array<Point>& positions, const Array<Triangle>& triangles,
                                const ParallelFor& parallel_for = {}) {
        return assign(positions, triangles, {}, parallel_for);
    }
    /// Replaces the mesh by one in plain arrays, of C channels and for an image of the size of the table, to go on working on it.
    /// Vertices and faces keep their numbers. to_mesh() is the way back. Refuses what the other overloads refuse.
    [[nodiscard]] HMESH_COLD Status assign(const Mesh& mesh, const ParallelFor& parallel_for = {});

    /// The connectivity.
    [[nodiscard]] const HalfedgeMesh& topology() const noexcept { return topology_; }
    /// The moment table of the image, or of the patch's rectangle.
    [[nodiscard]] const MomentTable<C>& table() const noexcept { return *table_; }
    /// The limits on faces, positions and colours.
    [[nodiscard]] const MeshLimits& limits() const noexcept { return limits_; }
    [[nodiscard]] double color_low() const noexcept { return color_low_; }    ///< smallest value of a colour while fitting
    [[nodiscard]] double color_high() const noexcept { return color_high_; }  ///< largest value of a colour while fitting
    /// What the image's samples are.
    [[nodiscard]] Samples samples() const noexcept { return context_.samples; }
    [[nodiscard]] int width() const noexcept { return table_->width(); }    ///< px, of the table
    [[nodiscard]] int height() const noexcept { return table_->height(); }  ///< px, of the table
    /// The number of vertices.
    [[nodiscard]] std::size_t vertex_count() const noexcept { return topology_.vertex_count(); }
    /// The state of vertex v.
    [[nodiscard]] const VertexState<C>& vertex(Vertex v) const noexcept { return vertices_[v.index()]; }
    /// The position of vertex v, in px.
    [[nodiscard]] Point position(Vertex v) const noexcept { return vertex(v).position; }
    /// The colour of vertex v.
    [[nodiscard]] const Color<C>& color(Vertex v) const noexcept { return vertex(v).color; }
    /// The squared error of a face: the sum of squared differences over its pixels and channels.
    [[nodiscard]] double energy(Face f) const noexcept { return energies_[f.index()]; }
    /// The squared error of the mesh: the sum over all faces.
    [[nodiscard]] double energy() const noexcept { return energy_; }
    /// The squared error of the faces of a ring, which gather() collected from this mesh.
    [[nodiscard]] double energy(const Ring<C>& ring) const noexcept {
        double sum = 0;
        for (int i = ring.first_face(); i < ring.size; ++i) sum += energy(topology_.face(ring.halfedge[i]));
        return sum;
    }
    /// The mean energy of a vertex, in a patch that of the whole mesh; >= 0. It is the scale of all tolerances: measured by its
    /// own mean, an easy patch would be polished for nothing.
    [[nodiscard]] double mean_energy() const noexcept {
        return context_.scale * std::max(0.0, energy_) / static_cast<double>(vertex_count());
    }
    /// Whether to go on. Long work calls it every few microseconds, and ends as it is when it returns false.
    [[nodiscard]] bool keep_going() const { return context_.task == nullptr || context_.task->keep_going(); }
    /// Tells the task, if there is one, what TaskProgress::expect() is told.
    void expect(double fraction, double beats) const noexcept {
        if (context_.task != nullptr) context_.task->expect(fraction, beats);
    }
    /// The task that is told of progress; may be null.
    [[nodiscard]] TaskProgress* task() const noexcept { return context_.task; }
    /// Sets the task that is told of progress; it must outlive its use here, null: none.
    void set_task(TaskProgress* task) noexcept { context_.task = task; }

    /// Writes the moments of a half-edge (those of its edge, with a sign) to `out`.
    HMESH_ALWAYS_INLINE void moments(Halfedge h, Moments<C>& out) const { out = moments_[h.index() >> 1U] * sign(h); }
    /// Adds the moments of a half-edge to `out`.
    HMESH_ALWAYS_INLINE void add_moments(Halfedge h, Moments<C>& out) const { out += moments_[h.index() >> 1U] * sign(h); }
    /// Writes the moments of the pixels of a face to `out`.
    void face_moments(Face f, Moments<C>& out) const {
        const Halfedge h = topology_.halfedge(f);
        moments(h, out);
        add_moments(topology_.next(h), out);
        add_moments(topology_.next(topology_.next(h)), out);
    }

    /// Collects the one-ring of v and the moments of its spokes. v has at most ring_capacity neighbours.
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
    /// The position nearest to p where a vertex of this mobility may be: on the grid, within the table, and limits().border_gap
    /// off the image's border unless the vertex lies on it. A coordinate that is not free to move is returned as given.
    [[nodiscard]] Point clamp(Point p, Mobility mobility) const noexcept;
    /// Whether vertices and edges on the image's border stay as they are.
    [[nodiscard]] bool has_fixed_border() const noexcept { return context_.has_fixed_border; }
    /// The mobility of a vertex at p: Mobility::free unless p is on the image's border.
    [[nodiscard]] HMESH_NEVER_INLINE Mobility mobility_at(Point p) const noexcept {
        const Rect& image = context_.image;
        const double in = inset(context_.samples);
        bool on_x = p.x == image.x + in || p.x == image.x + image.width - in;
        bool on_y = p.y == image.y + in || p.y == image.y + image.height - in;
        if (wraps_x(context_.periodic)) on_x = context_.has_seams && is_seam(p.x, image.x, image.width);
        if (wraps_y(context_.periodic)) on_y = context_.has_seams && is_seam(p.y, image.y, image.height);
        if (context_.has_fixed_border && (on_x || on_y)) return Mobility::locked;
        return on_x && on_y ? Mobility::corner : on_x ? Mobility::along_y : on_y ? Mobility::along_x : Mobility::free;
    }
    /// Whether e, inside the mesh, runs along a seam of a periodic image and must stay there.
    [[nodiscard]] HMESH_ALWAYS_INLINE bool is_on_seam(Edge e) const noexcept {
        return context_.has_seams && seam_mobility(e) != Mobility::free;
    }
    /// The mobility of a vertex that would split e; Mobility::locked for a rim edge of the patch, which must not be split.
    [[nodiscard]] Mobility edge_mobility(Edge e) const noexcept {
        if (context_.has_seams) {  // the rim of the patch may run along one
            const Mobility mobility = seam_mobility(e);
            if (mobility != Mobility::free) return topology_.is_boundary(e) ? Mobility::locked : mobility;
        }
        if (!topology_.is_boundary(e)) return Mobility::free;
        const Halfedge h = HalfedgeMesh::halfedge(e);
        const Mobility mobility = mobility_at(midpoint(position(topology_.from_vertex(h)), position(topology_.to_vertex(h))));
        return mobility == Mobility::free ? Mobility::locked : mobility;
    }
    /// Whether v may get one more edge.
    [[nodiscard]] bool can_gain_edge(Vertex v) const noexcept { return topology_.valence(v) < vertex(v).valence_limit; }
    /// Sets PatchContext::scale.
    void set_scale(double scale) noexcept { context_.scale = scale; }
    /// Locks v: it keeps position and colour, and has at most `valence_limit` edges. Not undone by rollback().
    void lock(Vertex v, int valence_limit) noexcept {
        VertexState<C>& state = vertices_.raw(v.index());
        state.mobility = Mobility::locked;
        state.valence_limit = static_cast<unsigned char>(valence_limit);
    }

    // --- edits ---
    /// Commits a trial state of v: `faces` are the fits of the faces of its ring, `moved` the moments of its spokes (null: v
    /// did not move). Saves the edge walks of place().
    void apply_fit(Vertex v, const Ring<C>& ring, Point position, const Color<C>& color, const FaceFit<C>* faces,
                   const Spokes<C>* moved);
    /// Gives v a new position and colour; walks its spokes. All faces around v must have positive area.
    void place(Vertex v, Point position, const Color<C>& color);
    /// Flips e, for which HalfedgeMesh::is_flip_ok(): `m` are the moments of the flipped edge's even half-edge, and the
    /// energies are those of the new faces of that half-edge and of its opposite.
    void flip(Edge e, const Moments<C>& m, double energy_own, double energy_opposite);
    /// Puts a new vertex on e; the new faces must have positive area. It is dirty.
    Vertex split(Edge e, Point position, const Color<C>& color);
    /// Puts a new vertex in f; the new faces must have positive area. It is dirty.
    Vertex split(Face f, Point position, const Color<C>& color);
    /// Merges from_vertex(h) into to_vertex(h), which keeps its position; for HalfedgeMesh::is_collapse_ok(). The remaining
    /// faces must have positive area.
    void collapse(Halfedge h);
    /// Gives all vertices new colours, indexed by vertex slot, and updates all energies. Outside a transaction only.
    HMESH_COLD void set_colors(const Array<Color<C>>& colors, const ParallelFor& parallel_for = {});

    // --- transactions; they nest ---
    /// The beginning of a transaction.
    struct Mark {
        HalfedgeMesh::Mark topology;                        ///< connectivity
        typename UndoArray<VertexState<C>>::Mark vertices;  ///< states of vertices
        typename UndoArray<Moments<C>>::Mark moments;       ///< moments of edges
        UndoArray<double>::Mark energies;                   ///< energies of faces
        double energy;                                      ///< energy of the mesh
    };
    /// Begins a transaction: from here on changes can be undone. Transactions nest; the inner one ends first.
    [[nodiscard]] HMESH_NEVER_INLINE Mark begin() {
        ++depth_;
        return {topology_.begin(), vertices_.mark(), moments_.mark(), energies_.mark(), energy_};
    }
    /// Ends a transaction and keeps its changes.
    void commit(const Mark& mark) noexcept {
        topology_.commit(mark.topology);
        close();
    }
    /// Ends a transaction and undoes its changes, to the last byte.
    void rollback(const Mark& mark) {
        vertices_.rollback(mark.vertices);
        moments_.rollback(mark.moments);
        energies_.rollback(mark.energies);
        energy_ = mark.energy;
        topology_.rollback(mark.topology);
        close();
    }

    /// Reserves memory for this number of vertices, so that growing up to it copies nothing.
    void reserve(std::size_t vertices) {
        topology_.reserve(vertices);
        vertices_.reserve(vertices);
        moments_.reserve(3 * vertices);
        energies_.reserve(2 * vertices);
        dirty_.reserve(vertices);
    }

    /// Whether v or its neighbourhood changed since v was last optimised; sweeps visit only dirty vertices.
    [[nodiscard]] bool is_dirty(Vertex v) const noexcept { return dirty_[v.index()] != 0; }
    /// Marks v as dirty or not. Not undone by rollback().
    void set_dirty(Vertex v, bool dirty) noexcept { dirty_[v.index()] = dirty ? 1 : 0; }
    /// Marks v and its neighbours as dirty. Not undone by rollback().
    void set_ring_dirty(Vertex v) noexcept {
        set_dirty(v, true);
        for (const Halfedge h : topology_.outgoing(v)) set_dirty(topology_.to_vertex(h), true);
    }

    /// Verifies what this class promises: the invariants of the topology, faces of positive area that tile what they tiled when
    /// assigned (the rectangle, unless the mesh is a patch), moments as walked afresh, energies as computed afresh (to 1e-9 of
    /// their size). Otherwise invalid_argument with a sentence and an index. O(edges).
    [[nodiscard]] HMESH_COLD Status check() const;

  private:
    /// The context of the one patch that an image is.
    [[nodiscard]] static PatchContext context_of_whole(const MomentTable<C>& table) noexcept {
        PatchContext context;
        context.image = {0, 0, table.width(), table.height()};
        if (table.has_far_sides()) context.samples = Samples::points;
        return context;
    }
    /// The least coordinates within the table that are `gap` inside of the mesh's border, 0 <= gap < 1/2.
    [[nodiscard]] Point first_place(double gap) const noexcept {
        const double in = inset(context_.samples) + gap;
        return {wraps_x(context_.periodic) ? 0 : std::max(0.0, context_.image.x + in),
                wraps_y(context_.periodic) ? 0 : std::max(0.0, context_.image.y + in)};
    }
    /// The largest ones.
    [[nodiscard]] Point last_place(double gap) const noexcept {
        const double in = inset(context_.samples) + gap, right = width(), low = height();
        const Rect& image = context_.image;
        return {wraps_x(context_.periodic) ? right : std::min(right, image.x + image.width - in),
                wraps_y(context_.periodic) ? low : std::min(low, image.y + image.height - in)};
    }
    /// Why these cannot be the vertices of the mesh, or ok.
    [[nodiscard]] Status check_vertices(const Array<Point>& positions, const Array<Color<C>>& colors) const noexcept;
    /// Empties the mesh and returns the status.
    HMESH_COLD Status refuse(const Status& status);
    /// Ends a transaction; the outermost one forgets all notes.
    void close() noexcept {
        if (--depth_ > 0) return;
        vertices_.stop_recording();
        moments_.stop_recording();
        energies_.stop_recording();
    }
    /// Of the moments of a half-edge, which are those of its edge or their negatives. Computed, since a branch on it is
    /// mispredicted half of the time.
    [[nodiscard]] static HMESH_ALWAYS_INLINE double sign(Halfedge h) noexcept {
        return 1.0 - 2.0 * static_cast<double>(static_cast<int>(h.index() & 1U));
    }
    /// Whether x is on one of the lines that begin at `from`, `period` apart.
    [[nodiscard]] static bool is_seam(double x, int from, int period) noexcept {
        const double turns = (x - from) / period;
        return std::floor(turns) == turns;
    }
    /// How a vertex on e may move if e runs along a seam of a periodic image; else free.
    [[nodiscard]] HMESH_NEVER_INLINE HMESH_COLD Mobility seam_mobility(Edge e) const noexcept {
        const Halfedge h = HalfedgeMesh::halfedge(e);
        const Point a = position(topology_.from_vertex(h)), b = position(topology_.to_vertex(h));
        const Rect& image = context_.image;
        if (wraps_x(context_.periodic) && a.x == b.x && is_seam(a.x, image.x, image.width)) return Mobility::along_y;
        if (wraps_y(context_.periodic) && a.y == b.y && is_seam(a.y, image.y, image.height)) return Mobility::along_x;
        return Mobility::free;
    }
    void walk(Halfedge h) {
        Moments<C> m;
        edge_moments(*table_, position(topology_.from_vertex(h)), position(topology_.to_vertex(h)), m);
        moments_.edit(h.index() >> 1U) = m * sign(h);
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
    Point low_, high_;  ///< bounds of free coordinates
    HalfedgeMesh topology_;
    UndoArray<VertexState<C>> vertices_;
    UndoArray<Moments<C>> moments_;  ///< of halfedge(e), by edge
    UndoArray<double> energies_;     ///< by face
    double energy_ = 0;
    double twice_area_ = 0;  ///< of all faces, when assigned
    Array<unsigned char> dirty_;
    int depth_ = 0;
};

/// A mesh as plain arrays: live vertices and faces in the order of topology(), positions in the coordinates of the table (of an
/// image of points those of the samples), colours rounded to float. `peak`: colour value of full intensity.
template <int C>
[[nodiscard]] HMESH_COLD Mesh to_mesh(const ImageMesh<C>& from, double peak);

/// The vertices of the mesh in spatial order (mesh/spatial_order.hpp).
template <int C>
[[nodiscard]] Array<Vertex> spatial_vertices(const ImageMesh<C>& mesh) {
    return spatial_vertices(mesh.topology(), [&](Vertex v) { return mesh.position(v); });
}
/// The faces of the mesh in spatial order (mesh/spatial_order.hpp).
template <int C>
[[nodiscard]] Array<Face> spatial_faces(const ImageMesh<C>& mesh) {
    return spatial_faces(mesh.topology(), [&](Vertex v) { return mesh.position(v); });
}
/// The edges of the mesh in spatial order (mesh/spatial_order.hpp).
template <int C>
[[nodiscard]] Array<Edge> spatial_edges(const ImageMesh<C>& mesh) {
    return spatial_edges(mesh.topology(), [&](Vertex v) { return mesh.position(v); });
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#include "hmesh/fit/image_mesh.ipp"

#endif  // HMESH_FIT_IMAGE_MESH_HPP
