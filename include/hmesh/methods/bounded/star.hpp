/// \file
/// Star: the samples around a vertex as a linear function of its heights, in floats, for choosing heights and places quickly.
///
/// At a sample of a face with corners v, a, b the mesh is off by l_v z + r, with l_v the barycentric coordinate of v, z its
/// height and r = l_a z_a + l_b z_b - sample. A star holds l_v and r for all samples of some faces around v, in units of the
/// bound, so that heights are tried at 0.2 ns a sample. Samples are taken eight at a time, those outside of the face as 0, which
/// counts for nothing. Floats decide what is worth a change; whether it holds is asked of face_error().
///
/// The energy of a star is the sum of the 16th powers of what samples are off, close to the largest of them and smooth: squares
/// cost a fifth more triangles, 8th powers 3 %, 32nd powers 1 %.
#ifndef HMESH_METHODS_BOUNDED_STAR_HPP
#define HMESH_METHODS_BOUNDED_STAR_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "hmesh/core/array.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/mesh/geometry.hpp"
#include "hmesh/methods/bounded/detail/wide.hpp"
#include "hmesh/methods/bounded/face_error.hpp"
#include "hmesh/methods/bounded/height_field.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// What samples are off, in units of the bound.
struct Fit {
    double energy = 0;  ///< sum of 16th powers over samples and channels
    double most = 0;    ///< the largest
};

/// Whether a new face is fit to be: positively oriented, and nowhere narrower than 0.02 px. Slivers hold samples by steep planes,
/// which floats and other programs evaluate badly, and gain nothing.
[[nodiscard]] HMESH_ALWAYS_INLINE bool is_well_shaped(Point a, Point b, Point c) noexcept {
    const double area = orient2d(a, b, c);
    if (!(area > 1e-3)) return false;
    const auto square = [](Point p, Point q) { return (q.x - p.x) * (q.x - p.x) + (q.y - p.y) * (q.y - p.y); };
    return area * area >= 4e-4 * std::max({square(a, b), square(b, c), square(c, a)});
}

namespace detail {

/// Barycentric coordinates of the corners b and c of a face (a, b, c) as functions of column and row, in samples.
struct FaceCoordinates {
    HMESH_ALWAYS_INLINE FaceCoordinates(const HeightField& field, Point a, Point b, Point c) noexcept {
        const double per_area = 1 / orient2d(a, b, c), offset = field.offset();
        x = a.x - offset, y = a.y - offset;
        bx = (c.y - a.y) * per_area, by = (a.x - c.x) * per_area;
        cx = (a.y - b.y) * per_area, cy = (b.x - a.x) * per_area;
    }
    double x, y;    ///< corner a
    double bx, by;  ///< rise of b's coordinate a column and a row
    double cx, cy;  ///< of c's
};

/// Calls body(j, i, b, c) for blocks of 8 samples from (i, j) on that hold all samples of the face (a, b, c): b and c are their
/// barycentric coordinates. A sample is of the face where `inside`, the least of the three, is >= bound; see there.
template <class Body>
HMESH_ALWAYS_INLINE void for_each_block(const HeightField& field, const FaceCoordinates& at, Point a, Point b, Point c,
                                        Body&& body) {
    using WideFloats = Wide<float>;
    const double offset = field.offset();
    const Wholes columns(std::max(0.0, std::min({a.x, b.x, c.x}) - offset), std::max({a.x, b.x, c.x}) - offset);
    const Wholes rows(std::max(0.0, std::min({a.y, b.y, c.y}) - offset), std::max({a.y, b.y, c.y}) - offset);
    const int left = columns.begin, right = std::min(field.width, columns.end), bottom = std::min(field.height, rows.end);
    if (left >= right) return;
    // What rounding to float may take from a coordinate: samples beside an edge may count too, those on it always do.
    const double reach = 1 + (right - left + 8) * (std::abs(at.bx) + std::abs(at.cx)) +
                         (bottom - rows.begin) * (std::abs(at.by) + std::abs(at.cy));
    const WideFloats bound = WideFloats::all(static_cast<float>(-3e-7 * reach));
    const bool is_narrow = right - left <= WideFloats::lanes;
    const double ax = -at.bx - at.cx;
    const double per_a = 1 / ax, per_b = 1 / at.bx, per_c = 1 / at.cx;
    const WideFloats counting = WideFloats::counting();
    for (int j = rows.begin; j < bottom; ++j) {
        double begin_b = at.bx * (left - at.x) + at.by * (j - at.y), begin_c = at.cx * (left - at.x) + at.cy * (j - at.y);
        int first = left, last = right;
        if (!is_narrow) {
            // Where the row enters and leaves the face, with a margin of a quarter of a column.
            double low = 0, high = right - left - 1;
            const auto cut = [&](double value, double step, double per_step) {
                const double zero = -value * per_step;
                if (step > 0) low = std::max(low, zero - 0.25);
                else if (step < 0) high = std::min(high, zero + 0.25);
            };
            cut(begin_b, at.bx, per_b);
            cut(begin_c, at.cx, per_c);
            cut(1 - begin_b - begin_c, ax, per_a);
            if (!(low <= high)) continue;
            const int skip = static_cast<int>(low);
            last = left + static_cast<int>(high) + 1;
            first = left + skip;
            begin_b += skip * at.bx, begin_c += skip * at.cx;
        }
        for (int i = first; i < last; i += WideFloats::lanes) {
            const WideFloats cb = WideFloats::all(static_cast<float>(begin_b)) + counting * static_cast<float>(at.bx);
            const WideFloats cc = WideFloats::all(static_cast<float>(begin_c)) + counting * static_cast<float>(at.cx);
            body(j, i, cb, cc, bound);
            begin_b += WideFloats::lanes * at.bx, begin_c += WideFloats::lanes * at.cx;
        }
    }
}

/// The 16th power of each lane, of at most 100.
[[nodiscard]] HMESH_ALWAYS_INLINE Wide<float> power16(const Wide<float>& off) noexcept {
    const Wide<float> held = smaller(off, Wide<float>::all(100.0F));
    const Wide<float> square = held * held, fourth = square * square, eighth = fourth * fourth;
    return eighth * eighth;
}

}  // namespace detail

/// What the samples of a positively oriented face are off, in units of 1 / per_unit.
[[nodiscard]] HMESH_NEVER_INLINE inline Fit face_fit(const HeightField& field, const Corner& a, const Corner& b, const Corner& c,
                                                     float per_unit) noexcept {
    using WideFloats = Wide<float>;
    const detail::FaceCoordinates at(field, a.position, b.position, c.position);
    WideFloats energy = WideFloats::all(0), most = WideFloats::all(0);
    for (int channel = 0; channel < field.channels; ++channel) {
        const float base = a.heights[channel];
        const float rise_b = b.heights[channel] - base, rise_c = c.heights[channel] - base;
        detail::for_each_block(field, at, a.position, b.position, c.position,
                               [&](int j, int i, const WideFloats& cb, const WideFloats& cc, const WideFloats& bound) {
                                   const WideFloats inside = smaller(smaller(cb, cc), WideFloats::all(1) - cb - cc);
                                   const WideFloats sample = WideFloats::load(field.row(channel, j) + i) - WideFloats::all(base);
                                   const WideFloats off =
                                       where_at_least(inside, bound, magnitude(cb * rise_b + cc * rise_c - sample) * per_unit);
                                   most = larger(most, off);
                                   energy = energy + detail::power16(off);
                               });
    }
    return {static_cast<double>(energy.sum()), static_cast<double>(most.largest())};
}

/// The samples of faces around a vertex, the apex, as a linear function of its heights.
class Star {
  public:
    /// Units of 1 / `per_unit`, in which all that follows is told. `limit`: how far corners may be out of all samples' range.
    Star(const HeightField& field, double per_unit, double limit) : field_(&field), per_unit_(per_unit), limit_(limit) {}

    /// Begins anew, with the apex at `place`; heights are told relative to `apex`'s.
    void begin(const Corner& apex, Point place) noexcept {
        base_ = apex;
        place_ = place;
        faces_.clear();
        used_ = 0;
    }
    /// Adds the face (apex, a, b). False where it is not well shaped.
    [[nodiscard]] bool add(const Corner& a, const Corner& b) {
        if (!is_well_shaped(place_, a.position, b.position)) return false;
        add_blocks(a, b);
        return true;
    }
    /// What samples are off with the apex at heights[0], heights[1] .., one for each channel.
    [[nodiscard]] Fit fit(const double* heights) const noexcept {
        using WideFloats = Wide<float>;
        WideFloats energy = WideFloats::all(0), most = WideFloats::all(0);
        const std::size_t stride = block_size();
        if (used_ == 0) return {0, 0};  // there may be no blocks
        for (int c = 0; c < field_->channels; ++c) {
            const auto z = static_cast<float>(heights[c]);
            const float* const rest = blocks_.data() + place_of(c);
            for (std::size_t k = 0; k < used_; k += stride) {
                const WideFloats off = magnitude(WideFloats::load(blocks_.data() + k) * z + WideFloats::load(rest + k));
                most = larger(most, off);
                energy = energy + detail::power16(off);
            }
        }
        return {static_cast<double>(energy.sum()), static_cast<double>(most.largest())};
    }
    /// Changes heights[c], from where they are, so that the largest differences above and below the samples become equal, which
    /// makes the largest of all as small as it gets: at most `steps` steps of the secants. O(samples) each.
    Fit lift(double* heights, int steps) const noexcept {
        for (int c = 0; c < field_->channels; ++c) balance(c, heights[c], steps);
        return fit(heights);
    }
    /// A step of place and heights at once that lowers the energy: where it would be least if each sample's weight stayed what it
    /// is now (the Gauss-Newton method on reweighted squares). `fit` is that of `heights`. step[0] and step[1] are for x and y,
    /// in px, 0 where they may not slide; step[2 + c] is for heights[c]. False where there is none.
    [[nodiscard]] HMESH_NEVER_INLINE bool direction(const double* heights, const Fit& fit, bool slide_x, bool slide_y,
                                                    double (&step)[2 + max_bounded_channels]) const noexcept {
        using WideFloats = Wide<float>;
        constexpr int most = 2 + max_bounded_channels;
        double matrix[most][most] = {}, side[most] = {};
        const std::size_t stride = block_size();
        const float per_most = static_cast<float>(1 / std::max(1e-6, fit.most));
        double weight = 0;
        for (int c = 0; c < field_->channels; ++c) {
            const auto z = static_cast<float>(heights[c]);
            std::size_t k = 0;
            for (const StarFace& face : faces_) {
                WideFloats squares = WideFloats::all(0), pulls = WideFloats::all(0);
                for (; k < face.end; k += stride) {
                    const WideFloats own = WideFloats::load(blocks_.data() + k);
                    const WideFloats off = (own * z + WideFloats::load(blocks_.data() + k + place_of(c))) * per_most;
                    const WideFloats s = off * off, s2 = s * s, s4 = s2 * s2;
                    const WideFloats pull = s4 * s2 * s * own;  // 14th power
                    squares = squares + pull * own;
                    pulls = pulls + pull * off;
                }
                const auto square = static_cast<double>(squares.sum());
                if (!(square > 0)) continue;
                const double pull = static_cast<double>(pulls.sum()) * fit.most;
                const double d[3] = {slide_x ? -static_cast<double>(face.own_x * z + face.rest_x[c]) : 0,
                                     slide_y ? -static_cast<double>(face.own_y * z + face.rest_y[c]) : 0, 1};
                const int at[3] = {0, 1, 2 + c};
                for (int m = 0; m < 3; ++m) {
                    side[at[m]] -= pull * d[m];
                    for (int n = 0; n < 3; ++n) matrix[at[m]][at[n]] += square * d[m] * d[n];
                }
                weight += square;
            }
        }
        if (!(weight > 0)) return false;
        // A px costs what a hundredth of the bound does, where nothing else says how far to go.
        const int size = 2 + field_->channels;
        for (int m = 0; m < size; ++m) matrix[m][m] = matrix[m][m] * 1.001 + (m < 2 ? 1e-4 : 1e-9) * weight;
        // Cholesky's decomposition.
        for (int m = 0; m < size; ++m) {
            for (int n = 0; n <= m; ++n) {
                double sum = matrix[m][n];
                for (int k = 0; k < n; ++k) sum -= matrix[m][k] * matrix[n][k];
                if (m != n) matrix[m][n] = sum / matrix[n][n];
                else if (sum > 0) matrix[m][m] = std::sqrt(sum);
                else return false;
            }
        }
        for (int m = 0; m < size; ++m) {
            double sum = side[m];
            for (int k = 0; k < m; ++k) sum -= matrix[m][k] * step[k];
            step[m] = sum / matrix[m][m];
        }
        for (int m = size - 1; m >= 0; --m) {
            double sum = step[m];
            for (int k = m + 1; k < size; ++k) sum -= matrix[k][m] * step[k];
            step[m] = sum / matrix[m][m];
        }
        return true;
    }

    /// The corner with the apex at these heights, rounded to finite floats. Between samples a steep face may rise to any height,
    /// and what holds the mesh, such as numbers of 15 bits, has an end: so no corner is farther out of the samples' range than
    /// samples may be.
    [[nodiscard]] Corner apex(const double* heights) const noexcept {
        Corner corner;
        corner.position = place_;
        for (int c = 0; c < field_->channels; ++c) {
            const double low = static_cast<double>(field_->lowest[c]) - limit_,
                         high = static_cast<double>(field_->highest[c]) + limit_;
            const double height = static_cast<double>(base_.heights[c]) + heights[c] / per_unit_;
            corner.heights[c] = PixelTraits<float>::from_real(std::max(low, std::min(high, height)));
        }
        return corner;
    }

  private:
    /// Where in a block the numbers of a channel are, behind the weights.
    [[nodiscard]] static constexpr std::size_t place_of(int channel) noexcept {
        return static_cast<std::size_t>(Wide<float>::lanes) * (static_cast<std::size_t>(channel) + 1);
    }

    struct StarFace {
        std::size_t end;                     // of its blocks, in floats
        float own_x, own_y;                  // rise of the apex's coordinate
        float rest_x[max_bounded_channels],  // rise of the heights of the other two, a column
            rest_y[max_bounded_channels];    // and a row
    };

    [[nodiscard]] std::size_t block_size() const noexcept {
        return static_cast<std::size_t>(Wide<float>::lanes) * static_cast<std::size_t>(1 + field_->channels);
    }
    HMESH_NEVER_INLINE void add_blocks(const Corner& a, const Corner& b) {
        using WideFloats = Wide<float>;
        const detail::FaceCoordinates at(*field_, place_, a.position, b.position);
        const int channels = field_->channels;
        const std::size_t stride = block_size();
        const auto per_unit = static_cast<float>(per_unit_);
        StarFace face;
        face.own_x = static_cast<float>(-at.bx - at.cx);
        face.own_y = static_cast<float>(-at.by - at.cy);
        float rise_a[max_bounded_channels], rise_b[max_bounded_channels];
        for (int c = 0; c < channels; ++c) {
            rise_a[c] = a.heights[c] - base_.heights[c];
            rise_b[c] = b.heights[c] - base_.heights[c];
            face.rest_x[c] = (rise_a[c] * static_cast<float>(at.bx) + rise_b[c] * static_cast<float>(at.cx)) * per_unit;
            face.rest_y[c] = (rise_a[c] * static_cast<float>(at.by) + rise_b[c] * static_cast<float>(at.cy)) * per_unit;
        }
        detail::for_each_block(*field_, at, place_, a.position, b.position,
                               [&](int j, int i, const WideFloats& ca, const WideFloats& cb, const WideFloats& bound) {
                                   if (used_ + stride > blocks_.size())
                                       blocks_.resize(std::max<std::size_t>(4096, 2 * blocks_.size()));
                                   float* const block = blocks_.data() + used_;
                                   used_ += stride;
                                   const WideFloats own = WideFloats::all(1) - ca - cb, inside = smaller(smaller(ca, cb), own);
                                   where_at_least(inside, bound, own).store(block);
                                   for (int c = 0; c < channels; ++c) {
                                       const WideFloats sample =
                                           WideFloats::load(field_->row(c, j) + i) - WideFloats::all(base_.heights[c]);
                                       where_at_least(inside, bound, (ca * rise_a[c] + cb * rise_b[c] - sample) * per_unit)
                                           .store(block + place_of(c));
                                   }
                               });
        face.end = used_;
        faces_.push_back(face);
    }
    /// lift() of one channel.
    void balance(int channel, double& height, int steps) const noexcept {
        using WideFloats = Wide<float>;
        if (used_ == 0) return;  // there may be no blocks
        const std::size_t stride = block_size();
        const float* const own = blocks_.data();
        const float* const rest = own + place_of(channel);
        for (int step = 0; step < steps; ++step) {
            // The largest above and below, and the coordinates there.
            const auto z = static_cast<float>(height);
            WideFloats above = WideFloats::all(0), below = WideFloats::all(0), by_above = WideFloats::all(0),
                       by_below = WideFloats::all(0);
            for (std::size_t k = 0; k < used_; k += stride) {
                const WideFloats share = WideFloats::load(own + k), off = share * z + WideFloats::load(rest + k);
                by_above = where_at_least(off, above, share) + where_below(off, above, by_above);
                above = larger(above, off);
                const WideFloats depth = off * -1.0F;
                by_below = where_at_least(depth, below, share) + where_below(depth, below, by_below);
                below = larger(below, depth);
            }
            float up[8], down[8], by_up[8], by_down[8];
            above.store(up), below.store(down), by_above.store(by_up), by_below.store(by_down);
            int u = 0, d = 0;
            for (int k = 1; k < 8; ++k) {
                if (up[k] > up[u]) u = k;
                if (down[k] > down[d]) d = k;
            }
            const double slopes = static_cast<double>(by_up[u]) + static_cast<double>(by_down[d]);
            if (!(slopes > 1e-4)) return;
            const double change = (static_cast<double>(down[d]) - static_cast<double>(up[u])) / slopes;
            height += change;
            if (std::abs(change) < 1e-3) return;
        }
    }

    const HeightField* field_;
    double per_unit_, limit_;
    Corner base_;
    Point place_;
    Array<StarFace> faces_;
    Array<float> blocks_;   ///< for each block 8 coordinates of the apex, then 8 rests for each channel
    std::size_t used_ = 0;  ///< floats of blocks_
};

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_BOUNDED_STAR_HPP
