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

/// Which vertices remove_cheapest() removes.
enum class Removals : std::uint8_t {
    exactly,    ///< so many
    from_some,  ///< so many: where patches are made anew each time, of some patches alone, which may have none
    about,      ///< about so many: where patches are made anew each time, the costs in some stand for all
    at_seams,   ///< so many of those that were locked in the last phase, which had another tiling
};

/// How many removals of each patch are among the `count` cheapest of all. `dearest` becomes the code of the cost of the first
/// that is not, or the largest code.
[[nodiscard]] HMESH_COLD inline Array<std::size_t> shares_of_cheapest(const std::vector<Array<Removal>>& removals,
                                                                      std::size_t count, std::uint64_t& dearest) {
    Array<Coded> all;  // by their costs, with the patch of the vertex
    for (std::size_t k = 0; k < removals.size(); ++k)
        for (const Removal& removal : removals[k]) all.push_back({code_of(removal.cost), static_cast<std::uint32_t>(k)});
    sort_by_code(all);
    dearest = count < all.size() ? all[count].code : ~std::uint64_t{0};
    Array<std::size_t> quota(removals.size(), 0);
    for (std::size_t k = 0; k < std::min(count, all.size()); ++k) ++quota[all[k].number];
    return quota;
}
/// How many of these removals, the cheapest first, cost less than `dearest`; of those that cost just that, so many that there are
/// `fair` of them.
[[nodiscard]] HMESH_COLD inline std::size_t count_cheap(const Array<Removal>& removals, std::uint64_t dearest, double fair) {
    std::size_t count = 0;
    for (const Removal& removal : removals) {
        const std::uint64_t code = code_of(removal.cost);
        if (code > dearest || (code == dearest && static_cast<double>(count) >= fair)) break;
        ++count;
    }
    return count;
}

/// Whether to remove `count` vertices from some patches of a tiling, where all would have to be made for it: 1/256 at most.
template <int C>
[[nodiscard]] HMESH_COLD bool do_some_suffice(const TiledMesh<C>& tiled, const Tiling& tiling, std::size_t count) {
    return count <= tiled.vertex_count() / 256 && tiled.sample_step(tiling) > 1;
}

/// Removes up to `count` vertices, the cheapest ones wherever they are, no two of them neighbours, from the patches of a tiling.
/// Returns how many went, after a cancellation any number.
template <int C>
HMESH_COLD std::size_t remove_cheapest(TiledMesh<C>& tiled, const Tiling& tiling, std::size_t count, const Relaxation& relaxation,
                                       Removals which = Removals::exactly) {
    const bool is_sample = which == Removals::about || which == Removals::from_some;
    const std::size_t before = tiled.vertex_count(), step = is_sample ? tiled.sample_step(tiling) : 1;
    const bool is_guess = which == Removals::about && step > 1;
    std::vector<Array<Removal>> removals(tiling.size());
    Array<double> choices(tiling.size(), 0.0);
    const auto choose = [&](Patch<C>& patch, std::size_t tile) {
        const Array<Vertex> vertices = which == Removals::at_seams ? patch.take_was_locked() : patch.free_vertices();
        choices[tile] = static_cast<double>(vertices.size());
        patch.mesh().expect(1, choices[tile]);
        removals[tile] = cheapest_removals(patch.mesh(), vertices, is_guess ? vertices.size() : count);
    };
    const auto [from, to] = tiled.progress().range();
    const double middle = from + (is_guess ? 0.1 : 0.5) * (to - from);
    tiled.progress().set_range(from, middle);
    const bool go_on =
        which == Removals::at_seams ? tiled.look_at_each_seam(tiling, choose) : tiled.look_at_each(tiling, choose, step);
    if (!go_on) return 0;
    auto wanted = static_cast<double>(count);
    const double share = wanted / std::max(1.0, static_cast<double>(before - tiled.locked_count()));
    if (is_guess) {
        wanted = 0;
        for (const double choice : choices) wanted += share * choice;
    }
    std::uint64_t dearest = 0;
    const Array<std::size_t> quota = shares_of_cheapest(removals, static_cast<std::size_t>(wanted), dearest);
    tiled.progress().set_range(middle, to);
    tiled.for_each(
        tiling,
        [&](Patch<C>& patch, std::size_t tile) {
            if (is_guess) choose(patch, tile);
            const std::size_t its = is_guess ? count_cheap(removals[tile], dearest, share * choices[tile]) : quota[tile];
            patch.mesh().expect(1, static_cast<double>(its));
            remove_batch(patch.mesh(), removals[tile], its, relaxation);
        },
        is_guess ? 1 : step);
    return before - tiled.vertex_count();
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
    // Only four tilings without a change mean that nothing can change, and one more where some patches alone were asked. A batch
    // of removals is 1/32 of the vertices, since large ones reach vertices that are not cheap; four of them go from one tiling.
    for (int k = 0, stuck = 0; count() != n && stuck < 5 && !tiled.progress().stopped(); ++k) {
        tiled.progress().set_range(from, 0.5 * (from + to));
        from = 0.5 * (from + to);
        const Tiling& tiling = tiling_of(k / 4 + stuck);
        const std::size_t before = count(), batch = std::min(before - std::min(before, n), (before + 31) / 32);
        const bool some = stuck == 0 && detail::do_some_suffice(tiled, tiling, batch);
        const detail::Removals which = some ? detail::Removals::from_some : detail::Removals::exactly;
        if (batch == 0) detail::insert_best(tiled, tiling, n - before);
        else detail::remove_cheapest(tiled, tiling, batch, relaxation, which);
        stuck = count() != before ? 0 : stuck + 1;
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
