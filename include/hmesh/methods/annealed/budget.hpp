/// \file
/// Budget: how many vertices each tile gets, and how a mesh is brought to exactly n vertices.
///
/// Tiles have quotas: the cheapest removals wherever they are, or insertions in proportion to the error.
#ifndef HMESH_METHODS_ANNEALED_BUDGET_HPP
#define HMESH_METHODS_ANNEALED_BUDGET_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "hmesh/core/array.hpp"
#include "hmesh/core/coded_order.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/edit/collapse.hpp"
#include "hmesh/edit/insert.hpp"
#include "hmesh/edit/relax.hpp"
#include "hmesh/edit/subdivide.hpp"
#include "hmesh/tiles/tiled_mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// Apportions `count` items in proportion to `weights` >= 0, item k getting at most caps[k]; where only weights of 0 are left,
/// equally. The result is of whole numbers, whose sum is `count` or, if less, the sum of the caps. O(size) for each round in
/// which a cap is reached, at most `size` rounds.
[[nodiscard]] HMESH_COLD inline Array<std::size_t> apportion(std::size_t count, Array<double> weights,
                                                             const Array<std::size_t>& caps) {
    const std::size_t size = weights.size();
    Array<std::size_t> out(size, 0);
    Array<unsigned char> full(size, 0);
    for (bool changed = true; changed;) {
        changed = false;
        std::size_t left = count;
        double total = 0, open = 0;
        for (std::size_t k = 0; k < size; ++k) {
            if (full[k] != 0) left -= std::min(left, out[k]);
            else total += weights[k], ++open;
        }
        if (!(total > 0)) std::fill(weights.begin(), weights.end(), 1.0), total = open;
        // Rounded running sums give whole numbers with the right sum.
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

/// Removes the `count` cheapest of the vertices that cheapest_removals() has chosen in the patches of a tiling, removals[k] in
/// that of tile k. Returns how many went.
template <int C>
HMESH_COLD std::size_t remove_chosen(TiledMesh<C>& tiled, const Tiling& tiling, const std::vector<Array<Removal>>& removals,
                                     std::size_t count, const Relaxation& relaxation) {
    Array<Coded> all;  // by their costs, with the patch of the vertex
    for (std::size_t k = 0; k < removals.size(); ++k)
        for (const Removal& removal : removals[k]) all.push_back({code_of(removal.cost), static_cast<std::uint32_t>(k)});
    sort_by_code(all);
    Array<std::size_t> quota(tiling.size(), 0);
    for (std::size_t k = 0; k < std::min(count, all.size()); ++k) ++quota[all[k].number];
    const std::size_t before = tiled.vertex_count();
    tiled.for_each(tiling, [&](Patch<C>& patch, std::size_t tile) {
        patch.mesh().expect(1, static_cast<double>(quota[tile]));
        remove_batch(patch.mesh(), removals[tile], quota[tile], relaxation);
    });
    return before - tiled.vertex_count();
}

/// Removes up to `count` vertices, the cheapest ones wherever they are, no two of them neighbours, from the patches of a tiling;
/// `at_seams`: only such that were locked in the last phase, which had another tiling. Returns how many went, after a
/// cancellation any number.
template <int C>
HMESH_COLD std::size_t remove_cheapest(TiledMesh<C>& tiled, const Tiling& tiling, std::size_t count, const Relaxation& relaxation,
                                       bool at_seams = false) {
    std::vector<Array<Removal>> removals(tiling.size());
    const auto [from, to] = tiled.progress().range();
    tiled.progress().set_range(from, 0.5 * (from + to));
    const auto choose = [&](Patch<C>& patch, std::size_t tile) {
        const Array<Vertex> vertices = at_seams ? patch.take_was_locked() : patch.free_vertices();
        patch.mesh().expect(1, static_cast<double>(vertices.size()));
        removals[tile] = cheapest_removals(patch.mesh(), vertices, count);
    };
    const bool go_on = at_seams ? tiled.look_at_each_seam(tiling, choose) : tiled.look_at_each(tiling, choose);
    tiled.progress().set_range(0.5 * (from + to), to);
    return go_on ? remove_chosen(tiled, tiling, removals, count, relaxation) : 0;
}

/// The same, from patches that may have to be made twice to remove just so many: about so many, by what some of the patches tell
/// of the dearest vertex that is to go. Exactly so many where patches stay.
template <int C>
HMESH_COLD void remove_cheap(TiledMesh<C>& tiled, const Tiling& tiling, std::size_t count, const Relaxation& relaxation) {
    if (tiled.sample_step(tiling) == 1) return (void)remove_cheapest(tiled, tiling, count, relaxation);
    const auto [from, to] = tiled.progress().range();
    const double middle = from + 0.1 * (to - from);
    tiled.progress().set_range(from, middle);
    std::vector<Array<double>> costs(tiling.size());
    Array<double> free_counts(tiling.size(), 0.0);
    const auto choose = [&](Patch<C>& patch) {
        const Array<Vertex> vertices = patch.free_vertices();
        patch.mesh().expect(1, static_cast<double>(vertices.size()));
        return cheapest_removals(patch.mesh(), vertices, vertices.size());
    };
    const bool go_on = tiled.look_at_some(tiling, [&](Patch<C>& patch, std::size_t tile) {
        for (const Removal& removal : choose(patch)) costs[tile].push_back(removal.cost);
        free_counts[tile] = static_cast<double>(patch.free_count());
    });
    if (!go_on) return;
    Array<double> all;
    double looked_at = 0;
    for (std::size_t k = 0; k < costs.size(); ++k) {
        looked_at += free_counts[k];
        for (const double cost : costs[k]) all.push_back(cost);
    }
    const double share = looked_at / static_cast<double>(tiled.vertex_count() - tiled.locked_count());
    const auto wanted = static_cast<std::size_t>(share * static_cast<double>(count));
    double dearest = std::numeric_limits<double>::infinity();
    if (wanted < all.size()) {
        std::nth_element(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(wanted), all.end());
        dearest = all[wanted];
    }
    tiled.progress().set_range(middle, to);
    tiled.for_each(tiling, [&](Patch<C>& patch, std::size_t) {
        const Array<Removal> removals = choose(patch);
        std::size_t cheap = 0;
        while (cheap < removals.size() && removals[cheap].cost < dearest) ++cheap;
        patch.mesh().expect(1, static_cast<double>(cheap));
        remove_batch(patch.mesh(), removals, cheap, relaxation);
    });
}

/// Inserts `count` vertices, shared among patches in proportion to their error, at the best sites of each. Returns whether any
/// vertex was inserted; false also after a cancellation.
template <int C>
HMESH_COLD bool insert_best(TiledMesh<C>& tiled, const Tiling& tiling, std::size_t count) {
    Array<double> energies(tiling.size(), 0.0);
    const auto [from, to] = tiled.progress().range();
    tiled.progress().set_range(from, from);
    if (!tiled.look_at_each(tiling,
                            [&](Patch<C>& patch, std::size_t tile) { energies[tile] = std::max(0.0, patch.mesh().energy()); }))
        return false;
    tiled.progress().set_range(from, to);
    const Array<std::size_t> quota = apportion(count, energies, Array<std::size_t>(tiling.size(), count));
    const std::size_t before = tiled.vertex_count();
    tiled.for_each(tiling, [&](Patch<C>& patch, std::size_t tile) {
        patch.mesh().expect(1, 4.0 * static_cast<double>(patch.vertex_count()));
        for (std::size_t left = quota[tile]; left > 0;) {
            const std::size_t inserted = insert_batch(patch.mesh(), left, {true, true});
            if (inserted == 0) {  // no site lowers the energy
                subdivide(patch.mesh(), left);
                break;
            }
            left -= inserted;
        }
    });
    return tiled.vertex_count() > before;
}

}  // namespace detail

/// Brings the mesh to exactly n vertices by removal or insertion, in the patches of the tilings tiling_of(0), tiling_of(1), ..,
/// as many as it takes; in any four in a row every vertex must be free once. False: cancelled, or more than n vertices are left
/// and none of them can be removed.
template <int C>
HMESH_COLD bool reach_vertex_count(TiledMesh<C>& tiled, std::size_t n, const Relaxation& relaxation,
                                   FunctionRef<const Tiling&(int k)> tiling_of) {
    const int width = tiled.source().width(), height = tiled.source().height();
    const auto count = [&] { return tiled.vertex_count(); };
    auto [from, to] = tiled.progress().range();
    // Only four tilings without a change mean that nothing can change. A batch of removals is 1/32 of the vertices, since large
    // ones reach vertices that are not cheap; four of them go from one tiling.
    for (int k = 0, stuck = 0; count() != n && stuck < 4 && !tiled.progress().stopped(); ++k) {
        tiled.progress().set_range(from, 0.5 * (from + to));
        from = 0.5 * (from + to);
        const Tiling& tiling = tiling_of(k / 4 + stuck);
        const std::size_t batch = (count() + 31) / 32;
        const bool moved = count() > n ? detail::remove_cheapest(tiled, tiling, std::min(count() - n, batch), relaxation) > 0
                                       : detail::insert_best(tiled, tiling, n - count());
        stuck = moved ? 0 : stuck + 1;
    }
    if (count() < n && !tiled.progress().stopped())
        tiled.for_each(Tiling(width, height, std::max(width, height)),
                       [&](Patch<C>& patch, std::size_t) { subdivide(patch.mesh(), n - count()); });
    return count() == n;
}
/// The same in patches of about `tile` px.
template <int C>
HMESH_COLD bool reach_vertex_count(TiledMesh<C>& tiled, std::size_t n, double tile, const Relaxation& relaxation = {}) {
    const Tilings tilings(tiled.source().width(), tiled.source().height(), tile, tiled.source().periodic());
    return reach_vertex_count(tiled, n, relaxation, [&](int k) -> const Tiling& { return tilings[k]; });
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_ANNEALED_BUDGET_HPP
