/// \file
/// shrink(): takes vertices from a mesh within the bound, by the moves that an effort has.
#ifndef HMESH_METHODS_BOUNDED_SHRINK_HPP
#define HMESH_METHODS_BOUNDED_SHRINK_HPP

#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/core/compiler.hpp"
#include "hmesh/mesh/spatial_order.hpp"
#include "hmesh/methods/bounded/bounded_mesh.hpp"
#include "hmesh/methods/bounded/options.hpp"
#include "hmesh/methods/bounded/relax.hpp"
#include "hmesh/methods/bounded/removal.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// Takes vertices from a mesh within its limit, in at most `passes` passes, until one takes none
/// or mesh.keep_going() says stop; it holds all the time.
HMESH_COLD inline void shrink(BoundedMesh& mesh, Bounded::Effort effort, int passes) {
    if (effort == Bounded::Effort::draft) return;
    const bool can_lift_any = mesh.limit > 0;
    const Moves moves{effort >= Bounded::Effort::normal && can_lift_any, effort == Bounded::Effort::best && can_lift_any};
    Relaxation relaxation(mesh, moves);
    Removal removal(mesh, relaxation, moves);
    const auto position = [&](Vertex v) { return mesh.position(v); };
    std::vector<std::uint32_t> relaxed(mesh.topology.vertex_slots(), 0);
    std::uint32_t flipped = 0;
    for (int pass = 0; pass < passes && mesh.keep_going(); ++pass) {
        const std::vector<Vertex> vertices = spatial_vertices(mesh.topology, position);
        if (moves.heights) {
            const std::uint32_t begin = mesh.clock;
            for (const Edge e : spatial_edges(mesh.topology, position)) {
                if (!mesh.keep_going()) break;
                const Halfedge h = HalfedgeMesh::halfedge(e);
                if (mesh.changed[mesh.topology.to_vertex(h).index()] > flipped ||
                    mesh.changed[mesh.topology.from_vertex(h).index()] > flipped)
                    relaxation.flip(e, false);
            }
            flipped = begin;
            for (const Vertex v : vertices) {
                if (!mesh.keep_going()) break;
                if (mesh.changed[v.index()] <= relaxed[v.index()]) continue;
                relaxed[v.index()] = mesh.clock;
                if (relaxation.move(v, false)) relaxed[v.index()] = 0;
            }
        }
        const std::size_t gone = removal.pass(vertices);
        if (gone == 0) break;
    }
    removal.settle();
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_BOUNDED_SHRINK_HPP
