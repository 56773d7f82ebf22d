/// \file
/// The first price of annealing, measured: what one more vertex gains where it gains much, and what the cheapest ones cost.
///
/// At the price of the first sweep the mesh is to grow by a third or so: fewer vertices leave little to choose from, more are
/// pressed out again in a hurry. Which price that is follows from the insertions on offer. Over seven photographs at 0.3, 1 and
/// 3 % of the pixels, the mesh grew to 1.3 times the target at 2.35 times the median, over the vertices, of the best gain among
/// a vertex's insertion sites, with a standard deviation of 4 % between pictures; in units of the mean energy of a vertex, or of
/// what the cheapest quarter of the vertices cost, it was 35 to 56 %. At 8 % faces are too small to be split, and the cost
/// counts.
#ifndef HMESH_METHODS_ANNEALED_FIRST_PRICE_HPP
#define HMESH_METHODS_ANNEALED_FIRST_PRICE_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "hmesh/core/array.hpp"
#include "hmesh/core/coded_order.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/edit/blocks.hpp"
#include "hmesh/edit/collapse.hpp"
#include "hmesh/edit/insert.hpp"
#include "hmesh/fit/image_mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// What some vertices of a mesh are worth, energies.
struct VertexWorths {
    Array<double> gains;  ///< of each, the best gain among its insertion sites, >= 0
    Array<double> costs;  ///< of the cheapest collapses of those that have one
};

/// Adds the worths of every `step`-th of these vertices. Some 4 us each.
template <int C>
HMESH_COLD void sample_worths(const ImageMesh<C>& mesh, const Array<Vertex>& vertices, std::size_t step, VertexWorths& worths) {
    RingScratch<C> scratch;
    Array<Vertex> one(1);
    for (std::size_t k = 0; k < vertices.size() && mesh.keep_going(); k += step) {
        one[0] = vertices[k];
        const CollapseCandidate collapse = cheapest_collapse(mesh, scratch, one[0]);
        if (collapse.halfedge.is_valid()) worths.costs.push_back(collapse.cost);
        double best = 0;
        for (const InsertionSite site : own_sites(mesh, one)) best = std::max(best, candidate_at(mesh, scratch, site, true).gain);
        worths.gains.push_back(best);
    }
}

/// 2.35 times the median gain, but at least 0.3 of the mean of the lowest quarter of the costs; an energy, 0 where there are no
/// worths.
[[nodiscard]] HMESH_COLD inline double first_price(const VertexWorths& worths) {
    const auto rising = [](const Array<double>& values) {
        return in_order(values, sorted_numbers(values.size(), [&](std::uint32_t k) { return code_of(values[k]); }));
    };
    const Array<double> gains = rising(worths.gains), costs = rising(worths.costs);
    const double median = gains.empty() ? 0 : gains[gains.size() / 2];
    const std::size_t quarter = (costs.size() + 3) / 4;
    double sum = 0;
    for (std::size_t k = 0; k < quarter; ++k) sum += std::max(0.0, costs[k]);
    return std::max(2.35 * median, quarter > 0 ? 0.3 * (sum / static_cast<double>(quarter)) : 0);
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_ANNEALED_FIRST_PRICE_HPP
