/// \file
/// Seams: vertices on the straight line between two tiles, chosen before either tile has a mesh.
///
/// Along a seam the picture is a curve, the mean of the pixels on both sides, and a mesh will show the linear interpolation
/// between the seam's nodes. Dynamic programming finds the nodes that minimise squared error + price * number of nodes exactly;
/// one price for all seams shares a number of nodes among them. The colours of the nodes are then the least-squares ones. Both
/// tiles have the same nodes, so that they meet without T-junctions.
///
/// Cost: nodes lie at multiples of `step` px; with s = length / step places, a seam takes some s^2 / 2 evaluations of 5 ns.
#ifndef HMESH_METHODS_ANNEALED_SEAMS_HPP
#define HMESH_METHODS_ANNEALED_SEAMS_HPP

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

#include "hmesh/core/compiler.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/lanes.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/fit/image_source.hpp"
#include "hmesh/fit/ring.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// A line between pixels of the image, inside it: from (x, y) down if it is vertical, else to the right.
struct Seam {
    int x = 0;              ///< px, of the start
    int y = 0;              ///< px, of the start
    int length = 1;         ///< px
    bool vertical = false;  ///< down; else to the right
};

/// The nodes of a seam and their colours, without the ends of the seam.
template <int C>
struct SeamLine {
    std::vector<int> offsets;      ///< px from the seam's start, in (0, length), rising
    std::vector<Color<C>> colors;  ///< of each node
};

namespace detail {

/// The picture along a seam, as prefix sums over its rows of pixels j: of s, (j + 1/2) s and |s|^2, s being the mean of both
/// sides.
template <int C>
class SeamCurve {
  public:
    SeamCurve(const ImageSource<C>& source, const Seam& seam) : length_(seam.length) {
        const auto count = static_cast<std::size_t>(length_) + 1;
        sums_.assign(count, Color<C>::zero());
        moments_.assign(count, Color<C>::zero());
        squares_.assign(count, 0.0);
        values_.assign(count, Color<C>::zero());
        Color<C> last = at(source, seam, -1);
        for (int j = 0; j <= length_; ++j) {
            const auto k = static_cast<std::size_t>(j);
            const Color<C> s = at(source, seam, j);
            values_[k] = 0.5 * (last + s);
            last = s;
            if (j == length_) break;
            sums_[k + 1] = sums_[k] + s;
            moments_[k + 1] = moments_[k] + (j + 0.5) * s;
            squares_[k + 1] = squares_[k] + (s * s).sum();
        }
    }
    /// The length of the seam in px.
    [[nodiscard]] int length() const noexcept { return length_; }
    /// The picture at offset j, 0 <= j <= length(): the mean of the four pixels around.
    [[nodiscard]] const Color<C>& value(int j) const noexcept { return values_[static_cast<std::size_t>(j)]; }

    /// Sums over the rows between two offsets, with t running from 0 to 1 between them.
    struct Part {
        Color<C> from;   ///< of (1 - t) s
        Color<C> to;     ///< of t s
        double squares;  ///< of |s|^2
    };
    /// The sums over the rows between offsets a < b.
    [[nodiscard]] Part part(int a, int b) const noexcept {
        const auto i = static_cast<std::size_t>(a), k = static_cast<std::size_t>(b);
        const Color<C> sum = sums_[k] - sums_[i];
        const Color<C> to = (1.0 / (b - a)) * (moments_[k] - moments_[i] - static_cast<double>(a) * sum);
        return {sum - to, to, squares_[k] - squares_[i]};
    }
    /// The sum of t^2 over n rows, which is also that of (1 - t)^2.
    [[nodiscard]] static double square(int n) noexcept { return n / 3.0 - 1 / (12.0 * n); }
    /// The sum of t (1 - t) over n rows.
    [[nodiscard]] static double coupling(int n) noexcept { return n / 6.0 + 1 / (12.0 * n); }

    /// The squared error of linear interpolation between the values at offsets a < b, summed over rows and channels.
    [[nodiscard]] double error(int a, int b) const noexcept {
        const Part p = part(a, b);
        const Color<C>&ca = value(a), &cb = value(b);
        const double aa = square(b - a), ab = coupling(b - a);
        return p.squares + (ca * (aa * ca + 2.0 * (ab * cb - p.from)) + cb * (aa * cb - 2.0 * p.to)).sum();
    }

  private:
    /// The mean of the pixels on both sides at row j.
    [[nodiscard]] static HMESH_ALWAYS_INLINE Color<C> at(const ImageSource<C>& source, const Seam& seam, int j) noexcept {
        const int x = seam.vertical ? seam.x : seam.x + j, y = seam.vertical ? seam.y + j : seam.y;
        const int x1 = seam.vertical ? x - 1 : x, y1 = seam.vertical ? y : y - 1;
        return 0.5 * (source.pixel(x, y) + source.pixel(x1, y1));
    }
    int length_;
    std::vector<Color<C>> sums_, moments_, values_;
    std::vector<double> squares_;
};

}  // namespace detail

/// The offsets of one seam's nodes, in px: the multiples of `step` between its ends that minimise error + price * number of
/// nodes, none further than `reach` >= step px from the next. O((length / step) * (reach / step)).
template <int C>
[[nodiscard]] HMESH_COLD std::vector<int> seam_nodes(const detail::SeamCurve<C>& curve, int step, int reach, double price) {
    const int length = curve.length(), places = (length + step - 1) / step;  // place k is at min(length, k step)
    const auto at = [&](int k) { return std::min(length, k * step); };
    std::vector<double> best(static_cast<std::size_t>(places) + 1, std::numeric_limits<double>::max());
    std::vector<int> from(best.size(), 0);
    best[0] = 0;
    for (int k = 1; k <= places; ++k)
        for (int i = k - 1; i >= 0 && at(k) - at(i) <= std::max(reach, step); --i) {
            const double cost = best[static_cast<std::size_t>(i)] + curve.error(at(i), at(k)) + price;
            if (cost < best[static_cast<std::size_t>(k)]) {
                best[static_cast<std::size_t>(k)] = cost;
                from[static_cast<std::size_t>(k)] = i;
            }
        }
    std::vector<int> nodes;
    for (int k = from[static_cast<std::size_t>(places)]; k > 0; k = from[static_cast<std::size_t>(k)]) nodes.push_back(at(k));
    std::reverse(nodes.begin(), nodes.end());
    return nodes;
}

/// The least-squares colours of a seam's nodes, the ends of the seam keeping the value of the picture; solves a tridiagonal
/// system.
template <int C>
[[nodiscard]] HMESH_COLD std::vector<Color<C>> seam_colors(const detail::SeamCurve<C>& curve, const std::vector<int>& nodes) {
    using Curve = detail::SeamCurve<C>;
    const std::size_t n = nodes.size();
    std::vector<Color<C>> right(n, Color<C>::zero());
    std::vector<double> diagonal(n, 0.0), above(n, 0.0);
    for (std::size_t k = 0; k <= n; ++k) {
        const int a = k == 0 ? 0 : nodes[k - 1], b = k == n ? curve.length() : nodes[k];
        const auto part = curve.part(a, b);
        if (k > 0) {
            diagonal[k - 1] += Curve::square(b - a);
            right[k - 1] += part.from;
            if (k == n) right[k - 1] -= Curve::coupling(b - a) * curve.value(b);
            else above[k - 1] = Curve::coupling(b - a);
        }
        if (k < n) {
            diagonal[k] += Curve::square(b - a);
            right[k] += part.to;
            if (k == 0) right[k] -= Curve::coupling(b - a) * curve.value(a);
        }
    }
    for (std::size_t k = 1; k < n; ++k) {  // elimination: the matrix is diagonally dominant
        const double factor = above[k - 1] / diagonal[k - 1];
        diagonal[k] -= factor * above[k - 1];
        right[k] -= factor * right[k - 1];
    }
    for (std::size_t k = n; k-- > 0;) {
        if (k + 1 < n) right[k] -= above[k] * right[k + 1];
        right[k] *= 1 / diagonal[k];
    }
    return right;
}

/// Chooses about `count` nodes on all seams together, at one price, at multiples of `step` px and none further than `reach` px
/// from the next. The price is searched until the number of nodes is within 10 % of `count`, in at most 12 rounds. go_on() is
/// called from any thread; seams that are reached after it said false have no nodes.
template <int C>
[[nodiscard]] HMESH_COLD std::vector<SeamLine<C>> seam_lines(const ImageSource<C>& source, const std::vector<Seam>& seams,
                                                             double count, int step, int reach, FunctionRef<bool()> go_on,
                                                             const ParallelFor& parallel_for = {}) {
    std::vector<SeamLine<C>> lines(seams.size());
    const auto choose = [&](double price) {
        for_each_chunk(parallel_for, seams.size(), 1, [&](std::size_t i, std::size_t) {
            lines[i].offsets.clear();
            if (go_on()) lines[i].offsets = seam_nodes(detail::SeamCurve<C>(source, seams[i]), step, reach, price);
        });
        double nodes = 0;
        for (const SeamLine<C>& line : lines) nodes += static_cast<double>(line.offsets.size());
        return nodes;
    };
    // The price lies between 0 and the error of seams without nodes; the number of nodes falls roughly as its inverse root.
    double price = ordered_sum(parallel_for, seams.size(), 1,
                               [&](std::size_t i, std::size_t) {
                                   return detail::SeamCurve<C>(source, seams[i]).error(0, seams[i].length);
                               }) /
                   std::max(1.0, count);
    for (int k = 0; k < 12; ++k) {
        const double nodes = choose(price);
        if (nodes <= 1.1 * count && nodes >= 0.9 * count) break;
        const double ratio = std::max(nodes, 1.0) / std::max(count, 1.0);
        price *= std::max(0.05, std::min(20.0, ratio * ratio));
    }
    for_each_chunk(parallel_for, seams.size(), 1, [&](std::size_t i, std::size_t) {
        lines[i].colors = seam_colors(detail::SeamCurve<C>(source, seams[i]), lines[i].offsets);
    });
    return lines;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_ANNEALED_SEAMS_HPP
