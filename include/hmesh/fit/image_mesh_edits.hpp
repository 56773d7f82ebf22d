// hmesh - how an ImageMesh is edited: the topology's edits, with moments and energies kept true. Include image_mesh.hpp.
#ifndef HMESH_FIT_IMAGE_MESH_EDITS_HPP
#define HMESH_FIT_IMAGE_MESH_EDITS_HPP

#include <cstddef>

#include "hmesh/fit/image_mesh.hpp"

namespace hmesh::kit {

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

#endif  // HMESH_FIT_IMAGE_MESH_EDITS_HPP
