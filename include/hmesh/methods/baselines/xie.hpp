/// \file
/// Xie: the method of Xie et al. (2014), as "Image meshing via hierarchical optimization" describes and compares it.
///
///     Adams' mesh -> (vertex search, flip queue) by turns until neither gains
///
/// Colours are sampled, vertices stay on pixels. That text leaves the search open: here it is the pattern search of
/// methods/baselines/vertex_search.hpp. Some 110 to 170 us a vertex.
#ifndef HMESH_METHODS_BASELINES_XIE_HPP
#define HMESH_METHODS_BASELINES_XIE_HPP

#include <algorithm>
#include <cstddef>

#include "hmesh/core/status.hpp"
#include "hmesh/methods/baselines/adams.hpp"
#include "hmesh/methods/baselines/flip_queue.hpp"
#include "hmesh/methods/baselines/vertex_search.hpp"
#include "hmesh/methods/stage.hpp"
#include "hmesh/tiles/tiled_mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// The method of Xie et al., with sampled colors.
struct Xie {
    Adams start{};               ///< the mesh that it starts from
    kit::VertexSearch search{};  ///< how vertices move
    int flip_visits = 8;         ///< how often an edge is a suspect in a round, in [1, 1000000]
    int rounds = 8;              ///< at most, in [0, 1000]; one that gains less than `enough` is the last
    double enough = 1e-3;        ///< of the energy, in [0, 1]

    static constexpr const char* name = "xie";
    static constexpr Colors colors = Colors::sampled;

    /// Whether the options mean something.
    [[nodiscard]] Status check(int = 1, int = 1) const noexcept {
        if (const Status status = start.check(); !status) return status;
        return kit::check_ranges(
            {{"xie search.first_step must be in [1, 4096] px", static_cast<double>(search.first_step), 1, 4096},
             {"xie search.visits must be in [1, 1000]", static_cast<double>(search.visits), 1, 1000},
             {"xie flip_visits must be in [1, 1000000]", static_cast<double>(flip_visits), 1, 1e6},
             {"xie rounds must be in [0, 1000]", static_cast<double>(rounds), 0, 1000},
             {"xie enough must be in [0, 1]", enough, 0, 1}});
    }
    /// px: the image in one piece.
    [[nodiscard]] static double tile_size(int width, int height, std::size_t) noexcept { return std::max(width, height); }
    /// Makes a mesh of n vertices, 4 <= n <= max(4, pixels).
    template <int C>
    [[nodiscard]] Status run(kit::TiledMesh<C>& mesh, std::size_t n) const {
        using kit::ImageMesh;
        if (const Status status = start.run(mesh, n); !status) return status;
        for (int round = 0; round < rounds; ++round) {
            const double before = mesh.energy();
            const bool go_on =
                kit::run_whole_stage<C>(mesh, "search", [&](ImageMesh<C>& piece) { search_vertices(piece, search); }) &&
                kit::run_whole_stage<C>(mesh, "flips", [&](ImageMesh<C>& piece) { run_flip_queue(piece, flip_visits); });
            if (!go_on) return kit::cancelled_by_callback();
            if (!(before - mesh.energy() > enough * before)) break;
        }
        return {};
    }
};

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_BASELINES_XIE_HPP
