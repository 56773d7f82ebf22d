/// \file
/// BoundedMesh: a mesh that can be changed and undone, over a height field.
///
/// The half-edge mesh, a corner for each vertex, and when what is around a vertex last changed. Nothing here looks at the bound;
/// what changes the mesh does (methods/bounded/insertion.hpp, removal.hpp and the others).
#ifndef HMESH_METHODS_BOUNDED_BOUNDED_MESH_HPP
#define HMESH_METHODS_BOUNDED_BOUNDED_MESH_HPP

#include <cstddef>
#include <cstdint>

#include "hmesh/core/array.hpp"
#include "hmesh/core/assert.hpp"
#include "hmesh/core/progress.hpp"
#include "hmesh/mesh/halfedge_mesh.hpp"
#include "hmesh/mesh/undo_array.hpp"
#include "hmesh/methods/bounded/face_error.hpp"
#include "hmesh/methods/bounded/height_field.hpp"
#include "hmesh/methods/bounded/sheet.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// A vertex of a BoundedMesh.
struct BoundedVertex {
    Corner corner;             ///< where it stands and how high
    std::uint8_t freedom = 0;  ///< bits of Freedom
    /// Whether it may do this.
    [[nodiscard]] bool can(Freedom what) const noexcept { return (freedom & (what | is_locked)) == what; }
};

/// A mesh over a height field, of which all faces are positively oriented.
struct BoundedMesh {
    const HeightField* field;  ///< the samples
    double limit;              ///< what face_error() may be, >= 0
    TaskProgress* progress;    ///< is asked whether to go on

    HalfedgeMesh topology;              ///< the connectivity
    UndoArray<BoundedVertex> vertices;  ///< by vertex slot
    /// When the star of a vertex last changed, by vertex slot: the value of `clock` then. Not undone.
    Array<std::uint32_t> changed;
    std::uint32_t clock = 1;  ///< rises with each change

    /// The mesh of a sheet.
    BoundedMesh(const HeightField& height_field, double bound, const Sheet& sheet, TaskProgress& task)
        : field(&height_field), limit(bound), progress(&task) {
        const Status status = topology.assign(sheet.vertices.size(), sheet.faces);
        HMESH_ASSERT(status);
        static_cast<void>(status);
        vertices.reserve(sheet.vertices.size());
        for (std::size_t v = 0; v < sheet.vertices.size(); ++v) vertices.push_back({sheet.vertices[v], sheet.freedom[v]});
        for (const std::uint8_t freedom : sheet.freedom) changed.push_back((freedom & is_settled) != 0 ? 0 : clock);
    }

    /// The corner of a vertex.
    [[nodiscard]] const Corner& corner(Vertex v) const noexcept { return vertices[v.index()].corner; }
    /// The position of a vertex.
    [[nodiscard]] Point position(Vertex v) const noexcept { return vertices[v.index()].corner.position; }
    /// face_error() of a face.
    [[nodiscard]] double error(Face f, double enough) const noexcept {
        const auto v = topology.vertices(f);
        return face_error(*field, corner(v[0]), corner(v[1]), corner(v[2]), enough);
    }
    /// Whether all faces at v are within the limit.
    [[nodiscard]] bool holds_around(Vertex v) const noexcept {
        for (const Halfedge h : topology.outgoing(v))
            if (!topology.is_boundary(h) && error(topology.face(h), limit) > limit) return false;
        return true;
    }
    /// Notes that v and what is around it has changed.
    void touch(Vertex v) noexcept {
        ++clock;
        changed[v.index()] = clock;
        for (const Halfedge h : topology.outgoing(v)) changed[topology.to_vertex(h).index()] = clock;
    }
    /// Whether to go on.
    [[nodiscard]] bool keep_going() const { return progress->keep_going(); }

    /// The mesh as arrays, vertices and faces in the order of their slots.
    [[nodiscard]] HMESH_COLD Sheet sheet() const {
        Sheet out;
        out.vertices.reserve(topology.vertex_count());
        out.freedom.reserve(topology.vertex_count());
        for (const Vertex v : topology.vertices()) {
            out.vertices.push_back(corner(v));
            out.freedom.push_back(vertices[v.index()].freedom);
        }
        out.faces = topology.triangles();
        return out;
    }
};

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_BOUNDED_BOUNDED_MESH_HPP
