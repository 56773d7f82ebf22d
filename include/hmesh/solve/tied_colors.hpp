/// \file
/// Tied colors: the least-squares system of a mesh in which some vertices are copies of one another and have one colour.
///
/// A periodic mesh is cut open (mesh/torus.hpp), and a vertex on the cut has copies on both sides. In the system of its colours
/// (solve/bounded_colors.hpp) they are one unknown, whose row is the sum of theirs: the system of the torus. Cost: 0.2 us a
/// vertex.
#ifndef HMESH_SOLVE_TIED_COLORS_HPP
#define HMESH_SOLVE_TIED_COLORS_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "hmesh/core/array.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/fit/squared_error.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/mesh/torus.hpp"
#include "hmesh/solve/bounded_colors.hpp"
#include "hmesh/solve/normal_equations.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// The unknowns of vertices some of which are copies of one another.
struct TiedRows {
    Array<std::uint32_t> rows;      ///< of each vertex: its unknown
    Array<std::uint32_t> vertices;  ///< of each unknown: the root of its vertices
};

/// One unknown for each vertex that is its own root, in the order of the vertices; copies have that of their root.
[[nodiscard]] HMESH_COLD inline TiedRows tied_rows(const Array<std::uint32_t>& roots) {
    TiedRows tied;
    tied.rows.resize(roots.size());
    for (std::uint32_t v = 0; v < roots.size(); ++v) {
        if (roots[v] != v) continue;
        tied.rows[v] = static_cast<std::uint32_t>(tied.vertices.size());
        tied.vertices.push_back(v);
    }
    for (std::size_t v = 0; v < roots.size(); ++v) tied.rows[v] = tied.rows[roots[v]];
    return tied;
}

/// Sums the entries of a symmetric matrix up, corner by corner of the faces; those of one place add up in their order.
class TiedMatrix {
  public:
    /// A matrix of `size` rows, each of which has a diagonal, for about so many corners.
    TiedMatrix(std::size_t size, std::size_t corners) : diagonal_(size, 0.0) { entries_.reserve(corners); }
    /// Adds to the diagonal of a row.
    void add_to_diagonal(std::uint32_t row, double value) { diagonal_[row] += value; }
    /// Adds what the corner of a face at row a, whose next corner is at row b, brings.
    void add_corner(std::uint32_t a, std::uint32_t b, double square, double coupling) {
        add_to_diagonal(a, square);
        if (a != b) return entries_.push_back({std::min(a, b), std::max(a, b), coupling});
        add_to_diagonal(a, coupling);
        add_to_diagonal(a, coupling);
    }
    /// The matrix, with which the sums end. In turns of the executor.
    [[nodiscard]] HMESH_COLD SymmetricMatrix sum(const ParallelFor& parallel_for = {}) {
        for (const auto row : {&Entry::high, &Entry::low}) parallel_for(1, [&](std::size_t) { sort_by(row); });
        std::size_t places = 0;
        for (const Entry& entry : entries_) {
            if (places > 0 && entries_[places - 1].is_at(entry)) entries_[places - 1].value += entry.value;
            else entries_[places++] = entry;
        }
        entries_.resize(places);
        // Entries of each row before the diagonal and behind it: how many, then where the next one goes. They come in the order
        // of their columns.
        const std::size_t size = diagonal_.size();
        Array<int> before(size, 0), behind(size, 0);
        for (const Entry& side : entries_) {
            ++behind[side.low];
            ++before[side.high];
        }
        SymmetricMatrix matrix;
        matrix.columns.resize_raw(size + 2 * places);
        matrix.values.resize_raw(size + 2 * places);
        const auto put = [&](int at, std::size_t column, double value) {
            matrix.columns[static_cast<std::size_t>(at)] = static_cast<int>(column);
            matrix.values[static_cast<std::size_t>(at)] = value;
        };
        matrix.starts.reserve(size + 1);
        for (std::size_t row = 0; row < size; ++row) {
            const int start = matrix.starts.back(), at = start + before[row];
            put(at, row, diagonal_[row]);
            matrix.starts.push_back(at + 1 + behind[row]);
            before[row] = start;
            behind[row] = at + 1;
        }
        parallel_for(1, [&](std::size_t) {
            for (const Entry& side : entries_) {
                put(behind[side.low]++, side.high, side.value);
                put(before[side.high]++, side.low, side.value);
            }
        });
        return matrix;
    }

  private:
    /// An entry above the diagonal, and the one across it.
    struct Entry {
        std::uint32_t low, high;  // rows
        double value;
        [[nodiscard]] bool is_at(const Entry& other) const noexcept { return low == other.low && high == other.high; }
    };
    /// Sorts the entries by one of their rows, those of one row in their order.
    void sort_by(std::uint32_t Entry::*row) {
        Array<std::uint32_t> next(diagonal_.size(), 0);  // of each row: how many there are, then where the next one goes
        for (const Entry& entry : entries_) ++next[entry.*row];
        std::uint32_t first = 0;
        for (std::uint32_t& at : next) at = std::exchange(first, first + at);
        Array<Entry> sorted(entries_.size(), raw);
        for (const Entry& entry : entries_) sorted[next[entry.*row]++] = entry;
        entries_ = std::move(sorted);
    }

    Array<double> diagonal_;
    Array<Entry> entries_;
};

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
[[nodiscard]] HMESH_COLD detail::ColorSystem<C> tied_color_system(const Array<std::uint32_t>& rows,
                                                                  const Array<CornerSums<C>>& corners,
                                                                  const Array<ColorTie<C>>& ties, const Array<Color<C>>& colors,
                                                                  double ridge, const ParallelFor& parallel_for = {}) {
    const std::size_t size = colors.size();
    detail::ColorSystem<C> system;
    system.ridge = ridge;
    system.anchor = colors;
    system.rhs.assign(size, Color<C>::zero());
    TiedMatrix gram(size, rows.size());
    for (std::size_t k = 0; k < rows.size(); ++k) {
        gram.add_corner(rows[k], rows[k % 3 == 2 ? k - 2 : k + 1], corners[k].square, corners[k].coupling);
        system.rhs[rows[k]] += corners[k].image;
    }
    for (const ColorTie<C>& tie : ties) {
        gram.add_to_diagonal(tie.row, tie.weight);
        system.rhs[tie.row] += tie.weight * tie.color;
    }
    system.gram = gram.sum(parallel_for);
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
