/// \file
/// SiteCoder: which sites of a rectangular lattice are occupied, in no order of their own: that is what makes a set of points
/// cheap.
///
/// The lattice is halved again and again, and of each half with points it is said how many of them lie in its first half. As long
/// as there are less than some eight cells a point, all cells of a size come after one another, so that counts of neighbours,
/// some of them halved already, tell how many to expect; within a cell of the smallest such size, its few points come one after
/// another, and the bits of a lone one are as they are. After P.-M. Gandoin and O. Devillers, "Progressive lossless compression
/// of arbitrary simplicial complexes", 2002.
///
/// Cost: O(n log n), some 150 ns and 64 bytes a point.
#ifndef HMESH_IO_COMPACT_SITES_HPP
#define HMESH_IO_COMPACT_SITES_HPP

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/io/compact/arithmetic_coder.hpp"
#include "hmesh/io/compact/mixer.hpp"
#include "hmesh/io/compact/start_table.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

/// A site of a lattice: its column and row.
struct Site {
    std::uint32_t x = 0,  ///< column
        y = 0;            ///< row
};

/// The number of binary digits of a number.
[[nodiscard]] constexpr int digits_of(std::uint64_t value) noexcept {
#if defined(__GNUC__)
    return value == 0 ? 0 : 64 - __builtin_clzll(value);
#else
    int digits = 0;
    for (; value != 0; value >>= 1) ++digits;
    return digits;
#endif
}

/// How a lattice is halved: into columns or rows, the longer side first, as if both sides were powers of two.
class Halving {
  public:
    /// Of width x height sites, both from 1 to 2^25.
    Halving(std::uint32_t width, std::uint32_t height) noexcept
        : size_{width, height}, bits_{digits_of(width - 1), digits_of(height - 1)} {
        std::array<int, 2> left = bits_;
        while (left[0] + left[1] > 0) {
            const bool is_row = left[1] > left[0];
            axis_[static_cast<std::size_t>(levels_)] = is_row ? 1 : 0;
            left_[static_cast<std::size_t>(levels_++)] = left;
            --left[is_row ? 1 : 0];
        }
        left_[static_cast<std::size_t>(levels_)] = left;
    }

    /// How often it is halved until cells are sites.
    [[nodiscard]] int levels() const noexcept { return levels_; }
    /// Along which axis the cells of a level are halved: 0 into columns, 1 into rows.
    [[nodiscard]] std::size_t axis(int level) const noexcept { return axis_[static_cast<std::size_t>(level)]; }
    /// The binary logarithm of the size of the cells of a level along an axis.
    [[nodiscard]] int side(int level, std::size_t axis) const noexcept { return left_[static_cast<std::size_t>(level)][axis]; }
    /// The sites along an axis.
    [[nodiscard]] std::uint32_t size(std::size_t axis) const noexcept { return size_[axis]; }

    /// The way to a site: at each level whether it is in the second half, the first level highest.
    [[nodiscard]] std::uint64_t way(Site site) const noexcept {
        std::uint64_t way = 0;
        std::array<int, 2> left = bits_;
        for (int level = 0; level < levels_; ++level) {
            const std::size_t a = axis(level);
            way = way << 1 | ((a == 0 ? site.x : site.y) >> --left[a] & 1U);
        }
        return way;
    }
    /// The first site of a cell, whose way this is.
    [[nodiscard]] Site first(std::uint64_t way, int level) const noexcept {
        std::array<std::uint32_t, 2> at{};
        for (int k = 0; k < level; ++k) at[axis(k)] = at[axis(k)] << 1 | static_cast<std::uint32_t>(way >> (level - 1 - k) & 1U);
        return {at[0] << side(level, 0), at[1] << side(level, 1)};
    }
    /// Whether all sites of a cell, whose first this is, are of the lattice.
    [[nodiscard]] bool is_whole(Site cell, int level) const noexcept {
        return cell.x + (std::uint64_t{1} << side(level, 0)) <= size_[0] &&
               cell.y + (std::uint64_t{1} << side(level, 1)) <= size_[1];
    }
    /// The site that a way ends at, from a cell on.
    [[nodiscard]] Site follow(Site cell, int level, std::uint64_t way) const noexcept {
        for (; level < levels_; ++level) {
            const std::size_t a = axis(level);
            const auto digit = static_cast<std::uint32_t>(way >> (levels_ - 1 - level) & 1U);
            (a == 0 ? cell.x : cell.y) += digit << (side(level, a) - 1);
        }
        return cell;
    }
    /// The digits of ways at a level that belong to an axis.
    [[nodiscard]] std::uint64_t digits(int level, std::size_t of_axis) const noexcept {
        std::uint64_t mask = 0;
        for (int k = 0; k < level; ++k) mask = mask << 1 | (axis(k) == of_axis ? 1U : 0U);
        return mask;
    }

  private:
    std::array<std::uint32_t, 2> size_;
    std::array<int, 2> bits_;
    std::array<std::size_t, 50> axis_{};
    std::array<std::array<int, 2>, 51> left_{};
    int levels_ = 0;
};

/// Codes sets of sites. What it learns of one it knows for the next.
class SiteCoder {
  public:
    /// With the coder that it writes to or reads from, which outlives it, as the tables do.
    SiteCoder(ArithmeticCoder& coder, const Logistic& logistic)
        : coder_(&coder), mixer_(logistic, kinds * 2, 21845), neighbors_(kinds * 256), wide_(kinds * 256), far_(kinds * 256),
          depth_(kinds * 64), inner_(kinds * 2) {}

    /// Codes `count` <= width * height different sites. They are written in any order, and left, written or read, in that of
    /// their ways through the halvings. False: what is read ended before, and `sites` are as they may be.
    bool code(std::uint32_t width, std::uint32_t height, std::size_t count, std::vector<Site>& sites) {
        if (count == 0) return true;
        const Halving halving(width, height);
        ways_.clear();
        if (coder_->writes()) {
            for (const Site site : sites) ways_.push_back(halving.way(site));
            std::sort(ways_.begin(), ways_.end());
        }
        sites.clear();
        sites.reserve(count);
        const int dense = std::min(halving.levels(), digits_of(count) + 2);
        counts_.assign(1, static_cast<std::uint32_t>(count));
        for (int level = 0; level < dense; ++level)
            if (!halve_all(halving, level)) return false;
        std::size_t at = 0;
        for (std::size_t cell = 0; cell < counts_.size(); ++cell) {
            if (counts_[cell] == 0) continue;
            split(halving, dense, halving.first(cell, dense), counts_[cell], at, sites);
            at += counts_[cell];
            if (coder_->is_exhausted()) return false;
        }
        return true;
    }

    /// What it has learnt.
    [[nodiscard]] Learnt learnt() { return {{&neighbors_, &wide_, &far_, &depth_, &inner_}, &mixer_.weights()}; }

  private:
    static constexpr std::size_t kinds = 48;  // of decisions, see kind_of()

    // The kind of the decision `node` of those that say how many of n points are in the first half: nodes are 1, 2 or 3, and so
    // on down a binary tree.
    [[nodiscard]] static std::size_t kind_of(std::uint32_t n, std::uint32_t node) noexcept {
        if (n <= 3) return n == 1 ? 0 : 3 * n - 6 + std::min(node, 3U);  // 0; 1 to 3; 4 to 6
        const std::size_t size = static_cast<std::size_t>(std::min(digits_of(n) - 3, 4));
        return 8 + 8 * size + (node < 8 ? node : 7);
    }
    [[nodiscard]] static std::size_t upto3(std::uint32_t count) noexcept { return count < 3 ? count : 3; }
    [[nodiscard]] static std::size_t upto7(std::uint32_t count) noexcept { return count < 7 ? count : 7; }

    // How many of n points of a cell can be and are in its first half. `at`: where its points begin in ways_.
    struct Halves {
        std::uint32_t least, most;
    };
    [[nodiscard]] static Halves bounds(const Halving& halving, int level, Site cell, std::uint32_t n) noexcept {
        const std::size_t a = halving.axis(level);
        std::array<std::uint64_t, 2> size{};
        for (std::size_t k = 0; k < 2; ++k) {
            const std::uint64_t whole = std::uint64_t{1} << halving.side(level, k), begin = k == 0 ? cell.x : cell.y;
            size[k] = std::min(whole, halving.size(k) - begin);
        }
        const std::uint64_t half = std::min(std::uint64_t{1} << (halving.side(level, a) - 1), size[a]);
        const std::uint64_t first = half * size[1 - a], second = (size[a] - half) * size[1 - a];
        return {static_cast<std::uint32_t>(n > second ? n - second : 0),
                static_cast<std::uint32_t>(std::min<std::uint64_t>(n, first))};
    }
    [[nodiscard]] std::uint32_t count_first(const Halving& halving, int level, std::size_t at, std::uint32_t n) const noexcept {
        if (!coder_->writes()) return 0;
        const std::uint64_t digit = std::uint64_t{1} << (halving.levels() - 1 - level);
        std::uint32_t k = 0;
        while (k < n && (ways_[at + k] & digit) == 0) ++k;
        return k;
    }

    // Halves all cells of a level.
    bool halve_all(const Halving& halving, int level) {
        const std::size_t a = halving.axis(level);
        // A neighbour's way differs in the digits of one axis alone: with the others set or not, carries pass over them.
        const std::uint64_t along = halving.digits(level, a), across = halving.digits(level, 1 - a);
        // Cells in the last column or row may reach over the end; of the others each half holds so many.
        const std::uint64_t last = halving.way({halving.size(0) - 1, halving.size(1) - 1}) >> (halving.levels() - level);
        const std::uint64_t capacity = std::uint64_t{1} << (halving.levels() - level - 1);
        halves_.assign(2 * counts_.size(), 0);
        std::size_t at = 0;
        const auto step = [](std::size_t from, std::uint64_t digits, bool is_up, std::size_t& to) {
            const std::uint64_t own = from & digits;
            if (is_up ? own == digits : own == 0) return false;
            to = static_cast<std::size_t>(((is_up ? (from | ~digits) + 1 : own - 1) & digits) | (from & ~digits));
            return true;
        };
        const auto deeper = static_cast<std::size_t>(std::min(halving.levels() - level, 31));
        for (std::size_t cell = 0; cell < counts_.size(); ++cell) {
            const std::uint32_t n = counts_[cell];
            if (n == 0) continue;
            Halves may{0, n};
            const bool is_last = (cell & along) == (last & along) || (cell & across) == (last & across);
            if (is_last || n > capacity) may = bounds(halving, level, halving.first(cell, level), n);
            std::uint32_t first = may.least;
            if (may.least != may.most) {
                // The cells before it along both axes have been halved, and the one before along both.
                std::size_t there = 0, corner = 0;
                std::uint32_t before_second = 0, before = 0, after = 0, side_first = 0, side_second = 0, beyond = 0,
                              corner_half = 0, diagonal = 0;
                if (step(cell, along, false, there)) {
                    before_second = halves_[2 * there + 1];
                    before = counts_[there];
                    if (step(there, across, true, corner)) diagonal += counts_[corner];
                }
                if (step(cell, along, true, there)) {
                    after = counts_[there];
                    if (step(there, across, true, corner)) diagonal += counts_[corner];
                    if (step(there, across, false, corner)) diagonal += counts_[corner];
                }
                if (step(cell, across, false, there)) {
                    side_first = halves_[2 * there];
                    side_second = halves_[2 * there + 1];
                    if (step(there, along, false, corner)) corner_half = halves_[2 * corner + 1];
                }
                if (step(cell, across, true, there)) beyond = counts_[there];
                const std::size_t neighbors =
                    upto3(before_second) << 6 | upto3(after) << 4 | upto3(side_first) << 2 | upto3(side_second);
                const std::size_t wide = upto7(before) << 5 | upto7(after) << 2 | (std::min<std::size_t>(deeper, 4) - 1);
                const std::size_t others = upto3(side_first + side_second) << 6 | upto3(beyond) << 4 | upto3(corner_half) << 2 |
                                           upto3((diagonal + 1) / 2);
                first = tell(may, n, count_first(halving, level, at, n), [&](std::size_t kind, bool bit) {
                    return mixer_.code(*coder_, bit,
                                       {&neighbors_[kind * 256 + neighbors], &wide_[kind * 256 + wide],
                                        &far_[kind * 256 + others], &depth_[kind * 64 + a * 32 + deeper]},
                                       kind * 2 + (deeper < 4 ? 1 : 0));
                });
                if (coder_->is_exhausted()) return false;
            }
            halves_[2 * cell] = first;
            halves_[2 * cell + 1] = n - first;
            at += n;
        }
        counts_.swap(halves_);
        return true;
    }

    // The `count` low digits of a number, as they are.
    std::uint64_t digits(std::uint64_t number, int count) {
        const int rest = std::max(0, count - 32);
        const std::uint64_t high = coder_->bits(static_cast<std::uint32_t>(number >> 32U), rest);
        return high << 32U | coder_->bits(static_cast<std::uint32_t>(number), count - rest);
    }

    // Says which of the numbers from may.least to may.most `first` is, the middle of those left against each.
    template <class Code>
    std::uint32_t tell(Halves may, std::uint32_t n, std::uint32_t first, Code&& code) {
        for (std::uint32_t node = 1; may.least != may.most;) {
            const std::uint32_t middle = may.least + (may.most - may.least) / 2;
            const bool is_above = code(kind_of(n, node), first > middle);
            if (is_above) may.least = middle + 1;
            else may.most = middle;
            node = std::min(2 * node + (is_above ? 1U : 0U), 8U);
        }
        return may.least;
    }

    // The n sites of a cell, one half after the other.
    void split(const Halving& halving, int level, Site cell, std::uint32_t n, std::size_t at, std::vector<Site>& sites) {
        for (; level < halving.levels(); ++level) {
            if (n == 1 && halving.is_whole(cell, level)) {
                // What is told is whether it is in the first half: a way has the contrary.
                const std::uint64_t told = digits(coder_->writes() ? ~ways_[at] : 0, halving.levels() - level);
                sites.push_back(halving.follow(cell, level, ~told));
                return;
            }
            const std::size_t a = halving.axis(level);
            const Halves may = bounds(halving, level, cell, n);
            std::uint32_t first = may.least;
            if (may.least != may.most) {
                const std::uint32_t truth = count_first(halving, level, at, n);
                if (n == 1) first = coder_->bits(truth, 1);
                else
                    first =
                        tell(may, n, truth, [&](std::size_t kind, bool bit) { return inner_[2 * kind + a].code(*coder_, bit); });
            }
            Site second = cell;
            (a == 0 ? second.x : second.y) += std::uint32_t{1} << (halving.side(level, a) - 1);
            if (first == n) continue;
            if (first != 0) split(halving, level + 1, cell, first, at, sites);
            at += first;
            n -= first;
            cell = second;
        }
        sites.push_back(cell);
    }

    ArithmeticCoder* coder_;
    Mixer<4> mixer_;
    std::vector<AdaptiveBit> neighbors_, wide_, far_, depth_, inner_;
    std::vector<std::uint64_t> ways_;
    std::vector<std::uint32_t> counts_, halves_;
};

}  // namespace hmesh::detail

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_COMPACT_SITES_HPP
