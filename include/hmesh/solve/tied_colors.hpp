/// \file
/// Tied colors: the least-squares system of a mesh in which some vertices are copies of one another and have one colour.
///
/// A periodic mesh is cut open (mesh/torus.hpp), and a vertex on the cut has copies on both sides. In the system of its colours
/// (solve/bounded_colors.hpp) they are one unknown, whose row is the sum of theirs: the system of the torus. Cost: 0.5 us a
/// vertex.
#ifndef HMESH_SOLVE_TIED_COLORS_HPP
#define HMESH_SOLVE_TIED_COLORS_HPP

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "hmesh/core/compiler.hpp"
#include "hmesh/fit/squared_error.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/mesh/torus.hpp"
#include "hmesh/solve/bounded_colors.hpp"
#include "hmesh/solve/normal_equations.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// The matrix of `size` rows with these entries, (row and column, value) each with row = first / size and column = first % size;
/// those of one place add up, in their order.
[[nodiscard]] HMESH_COLD inline SymmetricMatrix summed_matrix(std::size_t size,
                                                              const std::vector<std::pair<std::uint64_t, double>>& entries) {
    const std::vector<std::uint32_t> order = sorted_numbers(entries.size(), [&](std::uint32_t a, std::uint32_t b) {
        return entries[a].first != entries[b].first ? entries[a].first < entries[b].first : a < b;
    });
    SymmetricMatrix matrix;
    std::uint64_t row = 0;
    for (std::size_t k = 0; k < order.size(); ++k) {
        const auto& [place, value] = entries[order[k]];
        if (k > 0 && place == entries[order[k - 1]].first) {
            matrix.values.back() += value;
            continue;
        }
        for (; row < place / size; ++row) matrix.starts.push_back(static_cast<int>(matrix.values.size()));
        matrix.columns.push_back(static_cast<int>(place % size));
        matrix.values.push_back(value);
    }
    for (; row < size; ++row) matrix.starts.push_back(static_cast<int>(matrix.values.size()));
    return matrix;
}

/// One more sample that a colour is to meet.
template <int C>
struct ColorTie {
    std::uint32_t row;  ///< whose colour
    double weight;      ///< for how many pixels the sample counts
    Color<C> color;     ///< the sample, stored values
};

/// The system of colours of a mesh whose face f joins the unknowns rows[3 f], rows[3 f + 1] and rows[3 f + 2] and has the corner
/// sums corners[3 f] .. corners[3 f + 2]; `colors`, one for each unknown, become the anchor. `ties` are samples beside the
/// pixels.
template <int C>
[[nodiscard]] HMESH_COLD detail::ColorSystem<C> tied_color_system(const std::vector<std::uint32_t>& rows,
                                                                  const std::vector<CornerSums<C>>& corners,
                                                                  const std::vector<ColorTie<C>>& ties,
                                                                  const std::vector<Color<C>>& colors, double ridge) {
    const std::size_t size = colors.size();
    detail::ColorSystem<C> system;
    system.ridge = ridge;
    system.anchor = colors;
    system.rhs.assign(size, Color<C>::zero());
    std::vector<std::pair<std::uint64_t, double>> entries;
    entries.reserve(3 * rows.size() + size);
    const auto add = [&](std::uint64_t row, std::uint64_t column, double value) {
        entries.emplace_back(row * size + column, value);
    };
    for (std::size_t row = 0; row < size; ++row) add(row, row, 0);
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const std::uint32_t a = rows[k], b = rows[k % 3 == 2 ? k - 2 : k + 1];
        add(a, a, corners[k].square);
        add(a, b, corners[k].coupling);
        add(b, a, corners[k].coupling);
        system.rhs[a] += corners[k].image;
    }
    for (const ColorTie<C>& tie : ties) {
        add(tie.row, tie.row, tie.weight);
        system.rhs[tie.row] += tie.weight * tie.color;
    }
    system.gram = summed_matrix(size, entries);
    system.inverse.assign(size, 0.0);
    for (std::size_t row = 0; row < size; ++row) {
        system.rhs[row].set(C, 0);
        if (const double diagonal = system.gram.diagonal(row) + ridge; diagonal > 0) system.inverse[row] = 1 / diagonal;
    }
    return system;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_SOLVE_TIED_COLORS_HPP
