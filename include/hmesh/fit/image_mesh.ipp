// hmesh - the longer member functions of ImageMesh. Included by image_mesh.hpp only.
#ifndef HMESH_FIT_IMAGE_MESH_IPP
#define HMESH_FIT_IMAGE_MESH_IPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/core/array.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

// --- building, recoloring and checking -----------------------------------------------------------------------------

template <int C>
Status ImageMesh<C>::check_vertices(const Array<Point>& positions, const Array<Color<C>>& colors) const noexcept {
    if (!colors.empty() && colors.size() != positions.size())
        return {Errc::invalid_argument, "the colours are not as many as the vertices", colors.size(), positions.size()};
    const Point low = first_place(0), high = last_place(0);
    for (std::size_t i = 0; i < positions.size(); ++i) {
        const Point p = positions[i];
        if (!is_finite(p.x) || !is_finite(p.y))
            return {Errc::not_finite, "the mesh has a position that is NaN or infinite, at vertex", i};
        if (!(p.x >= low.x && p.x <= high.x && p.y >= low.y && p.y <= high.y))
            return {Errc::invalid_argument, "the mesh has a position outside its image, at vertex", i};
        if (!is_on_grid(p)) return {Errc::invalid_argument, "the mesh has a position off the grid of 1/256 px, at vertex", i};
    }
    for (std::size_t i = 0; i < colors.size(); ++i)
        for (int k = 0; k < C; ++k)
            if (const double value = colors[i][k]; !is_finite(value))
                return {Errc::not_finite, "the mesh has a colour that is NaN or infinite, at vertex", i};
    return {};
}

template <int C>
Status ImageMesh<C>::refuse(const Status& status) {
    topology_ = HalfedgeMesh();
    vertices_.resize(0);
    moments_.resize(0);
    energies_.resize(0);
    dirty_.clear();
    energy_ = twice_area_ = 0;
    return status;
}

template <int C>
Status ImageMesh<C>::assign(const Array<Point>& positions, const Array<Triangle>& triangles,
                            const Array<Color<C>>& colors, const ParallelFor& parallel_for) {
    HMESH_ASSERT(table_ != nullptr && depth_ == 0);
    if (const Status status = check_vertices(positions, colors); !status) return refuse(status);
    if (const Status status = topology_.assign(positions.size(), triangles); !status) return refuse(status);
    vertices_.resize(positions.size());
    moments_.resize(topology_.edge_slots());
    energies_.resize(topology_.face_slots());
    dirty_.assign(positions.size(), 1);
    for (std::size_t i = 0; i < positions.size(); ++i) {
        const Point p = positions[i];
        VertexState<C>& state = vertices_.raw(i);
        state.position = p;
        state.mobility = mobility_at(p);
        state.valence_limit = max_valence;
        state.color = Color<C>::zero();
        for (int k = 0; k < C && !colors.empty(); ++k) state.color.set(k, colors[i][k]);
        if (colors.empty())
            table_->pixel(std::min(static_cast<int>(p.x), width() - 1), std::min(static_cast<int>(p.y), height() - 1),
                          state.color);
    }
    twice_area_ = 0;
    for (const Triangle& t : triangles) twice_area_ += orient2d(positions[t[0]], positions[t[1]], positions[t[2]]);
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
Status ImageMesh<C>::assign(const Mesh& mesh, const ParallelFor& parallel_for) {
    HMESH_ASSERT(table_ != nullptr);
    const std::size_t n = mesh.vertex_count();
    if (mesh.channels != C)
        return refuse({Errc::invalid_argument, "the mesh has not the image's number of channels", mesh.channels, C});
    if (mesh.positions.size() != 2 * n || mesh.colors.size() != C * n)
        return refuse({Errc::invalid_argument, "the mesh's arrays are not of one number of vertices"});
    if (mesh.width != width())
        return refuse({Errc::invalid_argument, "the mesh is not as wide as the image", mesh.width, width()});
    if (mesh.height != height())
        return refuse({Errc::invalid_argument, "the mesh is not as high as the image", mesh.height, height()});
    if (mesh.samples != context_.samples)
        return refuse({Errc::invalid_argument, "the mesh's samples are not what the image's are", static_cast<int>(mesh.samples),
                       static_cast<int>(context_.samples)});
    const double shift = inset(mesh.samples);
    Array<Point> positions(n);
    Array<Color<C>> colors(n, Color<C>::zero());
    for (std::size_t v = 0; v < n; ++v) {
        positions[v] = {static_cast<double>(mesh.positions[2 * v]) + shift, static_cast<double>(mesh.positions[2 * v + 1]) + shift};
        for (std::size_t k = 0; k < C; ++k) colors[v].set(static_cast<int>(k), static_cast<double>(mesh.colors[C * v + k]));
    }
    return assign(positions, mesh.faces, colors, parallel_for);
}

template <int C>
Mesh to_mesh(const ImageMesh<C>& from, double peak) {
    const HalfedgeMesh& topology = from.topology();
    Mesh to;
    to.channels = C;
    to.width = from.width(), to.height = from.height(), to.peak = peak;
    to.samples = from.samples();
    const double shift = inset(to.samples);
    to.positions.reserve(2 * topology.vertex_count());
    to.colors.reserve(C * topology.vertex_count());
    for (const Vertex v : topology.vertices()) {
        to.positions.push_back(static_cast<float>(from.position(v).x - shift));
        to.positions.push_back(static_cast<float>(from.position(v).y - shift));
        for (int k = 0; k < C; ++k) to.colors.push_back(static_cast<float>(from.color(v)[k]));
    }
    to.faces = topology.triangles();
    return to;
}

template <int C>
void ImageMesh<C>::set_colors(const Array<Color<C>>& colors, const ParallelFor& parallel_for) {
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
Status ImageMesh<C>::check() const {
    if (const Status status = topology_.check(); !status) return status;
    const auto fail = [](const char* what, std::size_t where) -> Status {
        return {Errc::invalid_argument, what, static_cast<std::int64_t>(where), 0};
    };
    for (const Vertex v : topology_.vertices()) {
        const VertexState<C>& state = vertex(v);
        if (!is_on_grid(state.position)) return fail("a vertex is off the grid", v.index());
        if (state.color[C] != 0) return fail("a colour's padding is not zero", v.index());
        // A vertex on a seam is inside the mesh.
        if (state.mobility != Mobility::locked &&
            (state.mobility != mobility_at(state.position) ||
             (!context_.has_seams && topology_.is_boundary(v) == (state.mobility == Mobility::free))))
            return fail("a vertex's mobility is wrong", v.index());
    }
    // Sum of |I|^2 over the whole rectangle: a patch in it may own no pixel, and yet its moments are differences of such sums.
    double squares = 0;
    for (int y = 0; y < height(); ++y) squares += table_->entry(width(), y).by_column[C];
    double area = 0, energy = 0;
    for (const Face f : topology_.faces()) {
        const auto v = topology_.vertices(f);
        const double twice = orient2d(position(v[0]), position(v[1]), position(v[2]));
        if (!(twice > 0)) return fail("a face is flipped or has no area", f.index());
        area += twice;
        Moments<C> m;
        face_moments(f, m);
        const double fresh = fresh_energy(f);
        // Rounding is relative to the squares that cancel, and grows with the slopes of slivers.
        if (!(std::abs(fresh - this->energy(f)) <= 1e-9 * (m.q[3] + std::abs(energy_)) + 1e-12 * squares))
            return fail("a face's energy is stale", f.index());
        energy += fresh;
    }
    const Point low = first_place(0), high = last_place(0);
    if (area != (context_.is_part ? twice_area_ : 2.0 * (high.x - low.x) * (high.y - low.y)))
        return fail("the faces do not tile what they should", 0);
    if (!(std::abs(energy - energy_) <= 1e-9 * std::abs(energy) + 1e-12 * squares)) return fail("the total energy is stale", 0);
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

// --- places --------------------------------------------------------------------------------------------------------

template <int C>
Point ImageMesh<C>::clamp(Point p, Mobility mobility) const noexcept {
    const double step = limits_.position_step;
    Point q = p;
    if (mobility == Mobility::free || mobility == Mobility::along_x)
        q.x = snap(std::max(low_.x, std::min(high_.x, p.x)), step);
    if (mobility == Mobility::free || mobility == Mobility::along_y)
        q.y = snap(std::max(low_.y, std::min(high_.y, p.y)), step);
    return q;
}

// --- edits ---------------------------------------------------------------------------------------------------------

template <int C>
void ImageMesh<C>::apply_fit(Vertex v, const Ring<C>& ring, Point position, const Color<C>& color, const FaceFit<C>* faces,
                             const Spokes<C>* moved) {
    VertexState<C>& state = vertices_.edit(v.index());
    state.position = position;
    state.color = color;
    for (int i = ring.first_face(); i < ring.size; ++i) set_energy(topology_.face(ring.halfedge[i]), faces[i].energy(color));
    if (moved == nullptr) return;
    for (int i = 0; i < ring.size; ++i) {
        const Halfedge h = ring.halfedge[i];
        moments_.edit(h.index() >> 1U) = moved->spoke[i] * sign(h);
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
    const VertexState<C> state{color, position, mobility, max_valence};
    if (v.index() == vertices_.size()) vertices_.push_back(state);
    else vertices_.edit(v.index()) = state;
    if (v.index() >= dirty_.size()) dirty_.push_back(1);
    dirty_[v.index()] = 1;
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

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_FIT_IMAGE_MESH_IPP
