/// \file
/// Moments: sums over the pixels of a face, collected along its edges.
///
/// The energy of a face, its normal equations, gradients and Gauss-Newton blocks all follow from the sums over its pixels of 1,
/// x, y, x^2, xy, y^2, I_c, x I_c, y I_c and |I|^2. By Green's theorem these are the signed sums of the moments of its three
/// edges, and an edge's moments are a walk down the pixel rows that it crosses, over the prefix sums of a MomentTable: O(rows),
/// not O(pixels).
///
/// For integer samples all moments are integers, exact as long as they stay below 2^53: shared edges cancel and every pixel is
/// counted once, whatever the rounding of coordinates. An edge with p pixels to its left in its rows reaches 2^53 at C p = 2^21
/// for 16-bit samples (their squares), 2^37 for 8-bit ones, and in sums of x^2 beyond widths of 8,192 px at as many rows; edges
/// of a fitted mesh cross few rows and stay far below.
///
/// Over a weighted table each pixel counts with its weight in all of these sums ("number of pixels" is then a sum of weights).
/// Sums without samples are multiples of the weights' step, exact below 2^53 steps; beyond, where no pixel counts, some 1e-16
/// of the sums to the left may remain, of either sign.
///
/// Pixels have integer coordinates here: pixel (i, j) of the table's rectangle is the point (i, j), half a pixel off its centre
/// in the plane, (i + 1/2, j + 1/2).
#ifndef HMESH_FIT_EDGE_MOMENTS_HPP
#define HMESH_FIT_EDGE_MOMENTS_HPP

#include <cstddef>
#include <cstdint>
#include <limits>

#include "hmesh/core/compiler.hpp"
#include "hmesh/core/lanes.hpp"
#include "hmesh/fit/moment_table.hpp"
#include "hmesh/fit/raster.hpp"
#include "hmesh/mesh/geometry.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// Sums over a set of pixels of C channels. The constant 1 is carried as channel C, so that sums of I and of 1 shift and
/// combine alike.
template <int C>
struct Moments {
    static constexpr int one = C;              ///< lane of the constant 1
    using Channels = Lanes<lanes_for(C + 1)>;  ///< the channels and 1, padded
    Channels s;                                ///< sums of (I_0 .. I_{C-1}, 1)
    Channels sx;                               ///< sums of x (I_0 .. I_{C-1}, 1)
    Channels sy;                               ///< sums of y (I_0 .. I_{C-1}, 1)
    Lanes<4> q;                                ///< sums of x^2, xy, y^2, |I|^2

    /// The moments of no pixels.
    [[nodiscard]] static HMESH_ALWAYS_INLINE Moments zero() {
        return {Channels::zero(), Channels::zero(), Channels::zero(), Lanes<4>::zero()};
    }
    /// These sums times a number, as a rule the sign 1 or -1.
    [[nodiscard]] HMESH_ALWAYS_INLINE Moments operator*(double sign) const { return {s * sign, sx * sign, sy * sign, q * sign}; }
    /// Adds the moments of other pixels.
    HMESH_ALWAYS_INLINE Moments& operator+=(const Moments& o) {
        s += o.s, sx += o.sx, sy += o.sy, q += o.q;
        return *this;
    }
    /// Subtracts the moments of pixels.
    HMESH_ALWAYS_INLINE Moments& operator-=(const Moments& o) {
        s -= o.s, sx -= o.sx, sy -= o.sy, q -= o.q;
        return *this;
    }
    /// Multiplies all sums, as a rule by the sign 1 or -1.
    HMESH_ALWAYS_INLINE Moments& operator*=(double sign) { return *this = *this * sign; }
};

/// Pixels that together count for less than this count for nothing, in pixels: it may be the rounding of weighted sums.
inline constexpr double least_weight = 1e-9;

namespace detail {

/// The sums over the pixels left of an edge that follow from its columns alone, gathered row by row, downwards, as the sums of
/// i^2, 0, i and 1 that a table has for each column. Nothing is multiplied by rows: in a sum of sums counts d times what was
/// added d rows before its end, and d (d + 1) / 2 times in a sum of those. Nobody asks these for the first two, which registers
/// of two doubles therefore do not add.
struct ColumnSums {
    Lanes<4> x = Lanes<4>::zero(), x_d = x, x_dd = x;  ///< of a table's sums, sums of these, and sums of those

    /// Adds the next row.
    HMESH_ALWAYS_INLINE void add(const Lanes<4>& powers) noexcept {
        x += powers;
        x_d += x;
        x_dd += x_d;
    }
    /// The sums of j times these, where `end` is the row behind the last one: j = end - d.
    [[nodiscard]] HMESH_ALWAYS_INLINE Lanes<4> by_row(double end) const noexcept { return x * end - x_d; }
    /// The sums of j^2 times these, likewise.
    [[nodiscard]] HMESH_ALWAYS_INLINE Lanes<4> by_row_squared(double end) const noexcept {
        return (by_row(end) - x_d) * end + (x_dd + x_dd - x_d);
    }
};

/// The sums over the pixels left of an edge that samples take part in, gathered row by row, downwards, from a table whose entries
/// are doubles.
template <int C>
struct EntrySums {
    using Table = MomentTable<C>;
    using PixelLanes = typename Table::PixelLanes;
    PixelLanes s = PixelLanes::zero(), sx = s, sy = s;                 ///< as in Moments
    double squares = 0;                                                ///< of all samples, where these leave no lane of sx for it
    static constexpr int most_rows = std::numeric_limits<int>::max();  ///< that may be added

    /// Adds row j, whose first i pixels are left of the edge.
    HMESH_ALWAYS_INLINE void add(const Table& table, int i, int j) {
        const double* const entry = table.entries() + table.offset(i, j);
        const PixelLanes low = PixelLanes::load(entry);
        s += low, sx += PixelLanes::load(entry + Table::lanes), sy += low * static_cast<double>(j);
        if constexpr (!Table::has_spare_lane) squares += entry[Table::lanes + C];
    }
    /// Ends the sums before the row `end`. The sum of the squares.
    [[nodiscard]] HMESH_ALWAYS_INLINE double finish(int /*end*/) const {
        if constexpr (Table::has_spare_lane) return sx[C];
        else return squares;
    }
};

/// The same from a table of pairs of integers, hence exact. As in ColumnSums nothing is multiplied by rows.
template <int C, bool in_integers = C == 3 && IntLanes::is_register>
struct PairSums {
    using Table = MomentTable<C>;
    using PixelLanes = typename Table::PixelLanes;
    PixelLanes s = PixelLanes::zero(), sx = s, sy = s;  ///< as in Moments; sy is the sum of all s until finish()
    PixelLanes last_squares = s;                        ///< of the pixels that pairs do not hold
    std::int64_t squares = 0;                           ///< of all other samples, where these leave no lane of sx for it
    static constexpr int most_rows = std::numeric_limits<int>::max();  ///< that may be added

    /// Adds row j, whose first i pixels are left of the edge.
    HMESH_ALWAYS_INLINE void add(const Table& table, int i, int j) {
        const std::int32_t* const pair = table.pair(i, j);
        const PixelLanes pixel = table.beyond(pair, i);  // the last one
        s += PixelLanes::load(pair) + pixel;
        sx += PixelLanes::load(pair + Table::lanes) + pixel * (i - 1.0);
        last_squares += pixel * pixel;
        sy += s;
        if constexpr (!Table::has_spare_lane) squares += pair[Table::lanes + C];
    }
    /// Ends the sums before the row `end`. The sum of the squares.
    [[nodiscard]] HMESH_ALWAYS_INLINE double finish(int end) {
        sy = s * static_cast<double>(end) - sy;
        if constexpr (Table::has_spare_lane) return sx[C] + last_squares.sum();
        else return static_cast<double>(squares) + last_squares.sum();
    }
};

/// The same of pairs whose samples are bytes, in integers as far as 32 bits hold them: an edge takes 0.65 to 0.8 of the time
/// where registers hold but two doubles, and 0.95 to 1 where they hold four.
template <>
struct PairSums<3, true> {
    using Table = MomentTable<3>;
    Table::PixelLanes s{}, sx{}, sy{};  ///< as in Moments, from finish() on
    /// A row's samples sum up to less than 2^20 (Table::is_int32()), and their sums over these rows to less than 2^31.
    static constexpr int most_rows = 62;

    /// Adds row j, whose first i pixels are left of the edge.
    HMESH_ALWAYS_INLINE void add(const Table& table, int i, int j) {
        const std::int32_t* const pair = table.pair(i, j);
        const Table::Column& column = table.column(i);
        const IntLanes next = IntLanes::bytes(Table::bytes_after(pair)), last = next & column.is_odd;
        sum_ += IntLanes::load(pair) + last;
        by_column_ += (IntLanes::load(pair + Table::lanes) + product_of_halves(next, column.last)).doubles();
        last_squares_ += product_of_halves(last, last);
        sum_of_sums_ += sum_;
    }
    /// Ends the sums before the row `end`. The sum of the squares.
    [[nodiscard]] HMESH_ALWAYS_INLINE double finish(int end) {
        s = sum_.doubles();
        sx = by_column_;
        sy = s * static_cast<double>(end) - sum_of_sums_.doubles();
        return sx[3] + (last_squares_[0] + last_squares_[1] + last_squares_[2]);
    }

  private:
    IntLanes sum_ = IntLanes::zero(), sum_of_sums_ = sum_;
    Table::PixelLanes by_column_ = Table::PixelLanes::zero();
    IntLanes last_squares_ = sum_;  ///< of the pixels that pairs do not hold
};

/// Lane C of the sums of samples and of 1 becomes the last of others.
template <int C>
HMESH_ALWAYS_INLINE void set_one(typename Moments<C>::Channels& sums, const Lanes<4>& others) {
    if constexpr (C == 3) sums = sums.template with<3>(others);
    else sums.set(C, others[3]);
}

/// `sign` times the moments of the pixels left of the edge from a down to b in the rows [first, last), one at least, that it
/// crosses, over a table without weights, of which SampleSums (one of those above) reads the entries.
template <class SampleSums, int C>
HMESH_ALWAYS_INLINE void walk(const MomentTable<C>& table, Point a, Point b, int first, int last, double sign, Moments<C>& m) {
    using Channels = typename Moments<C>::Channels;
    const EdgeWalker crossing(a, b);
    double below = crossing.below(first);
    Channels signs = Channels::all(sign);
    for (int c = C + 1; c < MomentTable<C>::lanes; ++c) signs.set(c, 0);  // where pairs have what means nothing
    int j = first;
    do {
        const bool is_first = j == first;
        const int end = last - j > SampleSums::most_rows ? j + SampleSums::most_rows : last;
        SampleSums samples;
        ColumnSums columns;
        for (; j < end; ++j, below += 1) {
            const int i = crossing.column_below(below);
            samples.add(table, i, j);
            columns.add(table.column(i).powers);
        }
        const double squares = samples.finish(end);
        Channels s = Channels::extended(samples.s), sx = Channels::extended(samples.sx), sy = Channels::extended(samples.sy);
        const Lanes<4> by_row = columns.by_row(end);
        set_one<C>(s, columns.x);
        set_one<C>(sx, Lanes<4>::all(columns.x[2]));
        set_one<C>(sy, by_row);
        Lanes<4> q = columns.x;
        q.set(1, by_row[2]);
        q.set(2, columns.by_row_squared(end)[3]);
        q.set(3, squares);
        const Moments<C> rows{s * signs, sx * signs, sy * signs, q * sign};
        if (is_first) m = rows;
        else m += rows;
    } while (j < last);
}

/// walk() over a weighted table. Never inlined: the two walks without weights are to stay as small and as fast as they are.
template <int C>
HMESH_NEVER_INLINE void weighted_walk(const MomentTable<C>& table, Point a, Point b, int first, int last, double sign,
                                      Moments<C>& m) {
    using Channels = typename Moments<C>::Channels;
    Channels s = Channels::zero(), sx = s, sy = s;
    double x1 = 0, x2 = 0, xy = 0, yy = 0;
    const EdgeWalker crossing(a, b);
    const double* const entries = table.entries();
    for (int j = first; j < last; ++j) {
        const std::size_t at = table.offset(crossing.column(j), j);
        const double* powers = table.x_moments(at);
        const double y = j;
        const Channels low = Channels::load(entries + at);
        s += low;
        sx += Channels::load(entries + at + MomentTable<C>::lanes);
        sy += low * y;
        x1 += powers[0];
        x2 += powers[1];
        xy += powers[0] * y;
        yy += y * y * low[C];
    }
    const double squares = sx[C];
    sx.set(C, x1);
    m.s = s * sign, m.sx = sx * sign, m.sy = sy * sign;
    m.q.set(0, sign * x2);
    m.q.set(1, sign * xy);
    m.q.set(2, sign * yy);
    m.q.set(3, sign * squares);
}

/// edge_moments() with points as numbers: two halves of a point that registers brought, stored and loaded as one, would stall.
template <int C>
HMESH_NEVER_INLINE void edge_moments(const MomentTable<C>& table, double ax, double ay, double bx, double by, Moments<C>& m) {
    const bool is_up = by < ay;
    const double sign = is_up ? -1 : 1;
    Point a{is_up ? bx : ax, is_up ? by : ay}, b{is_up ? ax : bx, is_up ? ay : by};
    int first = first_row(a.y), last = first_row(b.y);
    if (table.has_far_sides()) {
        const FarSides& sides = table.far_sides();
        const double beyond = sides.beyond(a, b);
        a.x += beyond, b.x += beyond;
        first = sides.first_row(a.y), last = sides.first_row(b.y);
    }
    if (first >= last) m = Moments<C>::zero() * sign;
    else if (table.is_int32()) walk<PairSums<C>>(table, a, b, first, last, sign, m);
    else if (!table.is_weighted()) walk<EntrySums<C>>(table, a, b, first, last, sign, m);
    else weighted_walk(table, a, b, first, last, sign, m);
}

}  // namespace detail

/// The moments of the pixels left of the edge from a to b, positive where it runs down (to larger y), negative where it runs
/// up. So edge_moments(a, b) = -edge_moments(b, a), and the sum over the edges of a polygon of positive orientation is the
/// moments of its pixels, where these are points up to the far sides of the mesh. Points lie in [0, width] x [0, height] of the
/// table. Cost: some 16 ns, and 3.6 ns a row crossed.
template <int C>
HMESH_ALWAYS_INLINE void edge_moments(const MomentTable<C>& table, Point a, Point b, Moments<C>& m) {
    detail::edge_moments(table, a.x, a.y, b.x, b.y, m);
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_FIT_EDGE_MOMENTS_HPP
