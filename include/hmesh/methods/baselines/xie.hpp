/// \file
/// Xie: the method of Xie et al. (2014), as "Image meshing via hierarchical optimization" describes and compares it.
///
///     Adams' mesh -> (vertex search, flip queue) by turns until neither gains
///
/// Colours are sampled, and vertices move in whole pixels. The paper does not say how vertices are searched; here it is the
/// pattern search of methods/baselines/vertex_search.hpp.
///
/// Cost: some 110 to 170 us a vertex.
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

/// The recipe of the method of Xie et al. (2014), the paper's baseline: Adams' mesh, then vertices searched from pixel to pixel
/// and edges flipped by turns. Colours are sampled unless Options::colors says otherwise. The whole image is one piece of work,
/// on one thread but for the feature map; some 110 to 170 us a vertex.
struct Xie {
    Adams start{};               ///< the recipe of the mesh to start from
    kit::VertexSearch search{};  ///< how far and how often vertices move in a round
    int flip_visits = 8;         ///< how often an edge is tried in a round at most, in [1, 1000000]
    int rounds = 8;              ///< of a search and flips at most, in [0, 1000]; 0 leaves the mesh of `start`
    double enough = 1e-3;        ///< a round that lowers the energy by this share of it or less is the last; in [0, 1]

    static constexpr const char* name = "xie";         ///< for reports
    static constexpr Colors colors = Colors::sampled;  ///< final colours where Options::colors says nothing

    /// Whether all options are in range, for images of any size; else Errc::invalid_argument with the offending value and its
    /// bound.
    [[nodiscard]] Status check(int = 1, int = 1) const noexcept {
        if (const Status status = start.check(); !status) return status;
        return kit::check_ranges(
            {{"xie search.first_step must be in [1, 4096] px", static_cast<double>(search.first_step), 1, 4096},
             {"xie search.visits must be in [1, 1000]", static_cast<double>(search.visits), 1, 1000},
             {"xie flip_visits must be in [1, 1000000]", static_cast<double>(flip_visits), 1, 1e6},
             {"xie rounds must be in [0, 1000]", static_cast<double>(rounds), 0, 1000},
             {"xie enough must be in [0, 1]", enough, 0, 1}});
    }
    /// The image's longer side in px: the image is one piece.
    [[nodiscard]] static double tile_size(int width, int height, std::size_t) noexcept { return std::max(width, height); }
    /// Replaces `mesh` by a mesh of n vertices of its image, 4 <= n <= max(4, pixels). Errc::cancelled: it is valid, with any
    /// number of vertices.
    template <int C>
    [[nodiscard]] Status run(kit::TiledMesh<C>& mesh, std::size_t n) const {
        using kit::ImageMesh;
        // Points, removal, and searches and flips by turns: six rounds are usual.
        mesh.progress().plan({13, 20, 25, 2, 13, 2, 8, 2, 6, 2, 5, 2, 5, 2, 1});
        if (const Status status = start.run(mesh, n); !status) return status;
        for (int round = 0; round < rounds; ++round) {
            const double before = mesh.energy();
            const bool go_on =
                kit::run_one_tile_stage<C>(mesh, "search", [&](ImageMesh<C>& piece) { search_vertices(piece, search); }) &&
                kit::run_one_tile_stage<C>(mesh, "flips", [&](ImageMesh<C>& piece) { run_flip_queue(piece, flip_visits); });
            if (!go_on) return kit::cancelled_by_callback();
            if (!(before - mesh.energy() > enough * before)) break;
        }
        return {};
    }
};

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_BASELINES_XIE_HPP
