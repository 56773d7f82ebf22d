/// \file
/// Budget: how many vertices each tile gets, and how a mesh comes to exactly n.
///
/// Before there is a common price, tiles share the budget by the error of a mesh of equal density in each. A mesh that is
/// near n already gets there by quotas: the cheapest removals wherever they are, or insertions in proportion to the error.
#ifndef HMESH_METHODS_ANNEALED_BUDGET_HPP
#define HMESH_METHODS_ANNEALED_BUDGET_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "hmesh/core/compiler.hpp"
#include "hmesh/edit/collapse.hpp"
#include "hmesh/edit/insert.hpp"
#include "hmesh/edit/relax.hpp"
#include "hmesh/edit/subdivide.hpp"
#include "hmesh/tiles/tiled_mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// A tile's share of the budget: area (E / area)^p, E being the error in it of a mesh of equal density everywhere. Equal
/// returns from all tiles ask for p = 0.65 where error falls with the 0.53th power of the vertices (1.6 dB a doubling); on
/// mosaics of photographs 0.8 came out 0.05 dB above 0.65, 0.1 above 0.5 (fast).
[[nodiscard]] inline double error_share(double area, double energy) noexcept {
    return area * std::pow(std::max(0.0, energy) / area, 0.8);
}

/// `count` things shared in proportion to `weights` >= 0 (equally, where only 0 is left), none getting more than its cap;
/// whole numbers that sum to `count` as long as the caps do. O(size) for each cap that is met, at most `size` times.
[[nodiscard]] inline std::vector<std::size_t> apportion(std::size_t count, std::vector<double> weights,
                                                        const std::vector<std::size_t>& caps) {
    const std::size_t size = weights.size();
    std::vector<std::size_t> out(size, 0);
    std::vector<unsigned char> full(size, 0);
    for (bool changed = true; changed;) {
        changed = false;
        std::size_t left = count;
        double total = 0, open = 0;
        for (std::size_t k = 0; k < size; ++k) {
            if (full[k] != 0) left -= std::min(left, out[k]);
            else total += weights[k], ++open;
        }
        if (!(total > 0)) weights.assign(size, 1.0), total = open;
        // Whole numbers by rounding running sums: they add up.
        double sum = 0;
        std::size_t given = 0;
        for (std::size_t k = 0; k < size; ++k) {
            if (full[k] != 0) continue;
            sum += weights[k];
            const auto upto = static_cast<std::size_t>(static_cast<double>(left) * std::min(1.0, sum / total) + 0.5);
            out[k] = std::max(upto, given) - given;
            given = std::max(upto, given);
        }
        for (std::size_t k = 0; k < size; ++k)
            if (full[k] == 0 && out[k] > caps[k]) {
                out[k] = caps[k];
                full[k] = 1;
                changed = true;
            }
    }
    return out;
}

namespace detail {

/// Removes `count` vertices: the cheapest of all patches. Returns whether any went.
template <int C>
HMESH_COLD bool remove_cheapest(TiledMesh<C>& tiled, const Tiling& tiling, std::size_t count, const Relaxation& relaxation) {
    std::vector<std::size_t> quota(tiling.size(), count);
    if (tiling.size() > 1) {
        std::vector<std::vector<double>> costs(tiling.size());
        if (!tiled.visit(tiling, [&](Patch<C>& patch, std::size_t tile, const std::uint32_t*) {
                RingScratch<C> ring;
                for (const Vertex v : patch.mesh().topology().vertices()) {
                    if (!patch.mesh().keep_going()) break;
                    const CollapseCandidate candidate = cheapest_collapse(patch.mesh(), ring, v);
                    if (candidate.halfedge.is_valid()) costs[tile].push_back(candidate.cost);
                }
            }))
            return false;
        std::vector<std::pair<double, std::size_t>> all;
        for (std::size_t k = 0; k < costs.size(); ++k)
            for (const double cost : costs[k]) all.emplace_back(cost, k);
        std::sort(all.begin(), all.end());
        quota.assign(tiling.size(), 0);
        for (std::size_t i = 0; i < std::min(count, all.size()); ++i) ++quota[all[i].second];
    }
    const std::size_t before = tiled.vertex_count();
    tiled.for_each(tiling, [&](Patch<C>& patch, std::size_t tile) {
        for (std::size_t left = quota[tile]; left > 0;) {
            // In large batches vertices go that are cheap only beside those that may not go at the same time.
            const std::size_t batch = std::max<std::size_t>(1, patch.vertex_count() / 32);
            const std::size_t removed = remove_batch(patch.mesh(), std::min(left, batch), relaxation);
            if (removed == 0) break;
            left -= removed;
        }
    });
    return tiled.vertex_count() < before;
}

/// Inserts `count` vertices where the error is, at the best sites of each patch. Returns whether any came.
template <int C>
HMESH_COLD bool insert_best(TiledMesh<C>& tiled, const Tiling& tiling, std::size_t count) {
    std::vector<double> energies(tiling.size(), 0.0);
    if (tiling.size() > 1 && !tiled.visit(tiling, [&](Patch<C>& patch, std::size_t tile, const std::uint32_t*) {
            energies[tile] = std::max(0.0, patch.mesh().energy());
        }))
        return false;
    const std::vector<std::size_t> quota = apportion(count, energies, std::vector<std::size_t>(tiling.size(), count));
    const std::size_t before = tiled.vertex_count();
    tiled.for_each(tiling, [&](Patch<C>& patch, std::size_t tile) {
        for (std::size_t left = quota[tile]; left > 0;) {
            const std::size_t inserted = insert_batch(patch.mesh(), left, {true, true});
            if (inserted == 0) {  // nothing to gain
                subdivide(patch.mesh(), left);
                break;
            }
            left -= inserted;
        }
    });
    return tiled.vertex_count() > before;
}

}  // namespace detail

/// Brings the mesh to exactly n vertices, in patches of about `tile` px. Returns false where it could not: cancelled, or more
/// than n vertices none of which can go.
template <int C>
HMESH_COLD bool reach_vertex_count(TiledMesh<C>& tiled, std::size_t n, double tile, const Relaxation& relaxation = {}) {
    const int width = tiled.source().width(), height = tiled.source().height();
    const auto count = [&] { return tiled.vertex_count(); };
    // Where one tiling is stuck, another may not be.
    for (int k = 0, stuck = 0; count() != n && stuck < 4 && !tiled.progress().stopped(); ++k) {
        const Tiling tiling(width, height, tile, (k & 2) == 0, (k & 1) == 0);
        const bool moved = count() > n ? detail::remove_cheapest(tiled, tiling, count() - n, relaxation)
                                       : detail::insert_best(tiled, tiling, n - count());
        stuck = moved ? 0 : stuck + 1;
    }
    if (count() < n && !tiled.progress().stopped())
        tiled.for_each(Tiling(width, height, std::max(width, height)),
                       [&](Patch<C>& patch, std::size_t) { subdivide(patch.mesh(), n - patch.mesh().vertex_count()); });
    return count() == n;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_ANNEALED_BUDGET_HPP
