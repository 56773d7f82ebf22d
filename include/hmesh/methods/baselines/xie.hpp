// hmesh - xie: the method of Xie et al. (2014), as "Image meshing via hierarchical optimization" describes and compares it.
//
//     Adams' mesh -> (vertex search, flip queue) by turns until neither gains
//
// Colours are sampled, vertices stay on pixels. That text leaves the search open: here it is the pattern search of
// methods/baselines/vertex_search.hpp. Some 110 to 170 us a vertex.
#ifndef HMESH_METHODS_BASELINES_XIE_HPP
#define HMESH_METHODS_BASELINES_XIE_HPP

#include <cstddef>

#include "hmesh/core/finite.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/methods/baselines/flip_queue.hpp"
#include "hmesh/tiles/tiled_mesh.hpp"
#include "hmesh/methods/baselines/vertex_search.hpp"
#include "hmesh/methods/baselines/adams.hpp"
#include "hmesh/methods/stage.hpp"

namespace hmesh::kit {

// Options of the method `xie`.
struct XieOptions {
    AdamsOptions start;
    VertexSearch search;
    int flip_visits = 8;   // how often an edge is a suspect in a round
    int rounds = 8;        // at most; one that gains less than `enough` is the last
    double enough = 1e-3;  // of the energy
};

// Whether the options mean something; the sentence names the first that does not.
[[nodiscard]] inline Status check(const XieOptions& options) noexcept {
    if (const Status status = check(options.start); !status) return status;
    const auto bad = [](const char* what) -> Status { return {Errc::invalid_argument, what, 0, 0}; };
    if (options.search.first_step < 1 || options.search.first_step > 4096)
        return bad("xie.search.first_step must be in [1, 4096] px");
    if (options.search.visits < 1 || options.search.visits > 1000) return bad("xie.search.visits must be in [1, 1000]");
    if (options.flip_visits < 1 || options.flip_visits > 1000000) return bad("xie.flip_visits must be in [1, 1000000]");
    if (options.rounds < 0 || options.rounds > 1000) return bad("xie.rounds must be in [0, 1000]");
    if (!is_within(options.enough, 0, 1)) return bad("xie.enough must be in [0, 1]");
    return {};
}

// Makes a mesh of n vertices, 4 <= n <= max(4, pixels). False: cancelled; the mesh is valid but may have another count.
template <int C>
[[nodiscard]] bool xie(TiledMesh<C>& work, std::size_t n, const XieOptions& options) {
    if (!adams(work, n, options.start)) return false;
    for (int round = 0; round < options.rounds; ++round) {
        const double before = work.energy();
        if (!detail::whole_stage(work, "search", [&](ImageMesh<C>& mesh) { search_vertices(mesh, options.search); }) ||
            !detail::whole_stage(work, "flips", [&](ImageMesh<C>& mesh) { run_flip_queue(mesh, options.flip_visits); }))
            return false;
        if (!(before - work.energy() > options.enough * before)) break;
    }
    return true;
}

}  // namespace hmesh::kit

#endif  // HMESH_METHODS_BASELINES_XIE_HPP
