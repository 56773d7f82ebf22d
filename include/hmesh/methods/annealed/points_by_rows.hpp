/// \file
/// The first points of an image that is not in memory: those of first_points.hpp, without a number for each pixel.
///
/// A rank needs the mean of all densities, and the rank of the last point needs all ranks: three passes over the pixels. A few
/// rows foretell both, and then one pass finds the mean and all pixels that may be points. Where the rows misled, as those of a
/// picture do that is empty but for one corner, two passes more find what three would have found; the points are always the same.
///
/// Cost: some 18 ns a pixel of 3 channels; 12 bytes a point.
#ifndef HMESH_METHODS_ANNEALED_POINTS_BY_ROWS_HPP
#define HMESH_METHODS_ANNEALED_POINTS_BY_ROWS_HPP

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "hmesh/core/array.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/fit/image_source.hpp"
#include "hmesh/methods/annealed/first_points.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {
namespace detail {

/// The densities of rows of an image, and their ranks, found anew each time that they are asked for.
template <int C>
class DensityRows {
  public:
    /// Once go_on() says false, what is found is meaningless. It is called on any thread. Both must outlive this.
    DensityRows(const ImageSource<C>& source, FunctionRef<bool()> go_on) noexcept : source_(&source), go_on_(go_on) {}

    [[nodiscard]] std::size_t width() const noexcept { return static_cast<std::size_t>(source_->width()); }
    [[nodiscard]] std::size_t count() const noexcept { return static_cast<std::size_t>(source_->height()); }
    /// Writes the densities in rows [begin, end), a band or less, but for `even`, the part that all pixels have alike. Returns
    /// their sum.
    double find(std::size_t begin, std::size_t end, float* to) const {
        if (go_on_()) return find_density(*source_, begin, end, to);
        std::fill_n(to, (end - begin) * width(), 1.0F);
        return 0;
    }
    /// Turns such densities into ranks.
    void rank(std::size_t begin, std::size_t end, float even, float* densities) const noexcept {
        for (std::size_t y = begin; y < end; ++y, densities += width()) {
            for (std::size_t x = 0; x < width(); ++x) densities[x] += even;
            rank_row(densities, 0, static_cast<int>(width()), static_cast<int>(y));
        }
    }

  private:
    const ImageSource<C>* source_;
    FunctionRef<bool()> go_on_;
};

/// What some rows foretell of all.
struct RankGuess {
    float even = 1;   ///< even_density()
    float limit = 0;  ///< few points, if any, have a rank above it
};

/// By 64 rows, or more of narrow images, spread over the image by the mask: as equal distances they might fall into its step.
template <int C>
[[nodiscard]] HMESH_COLD RankGuess guess_ranks(const DensityRows<C>& rows, std::size_t count, const ParallelFor& parallel_for) {
    const std::size_t width = rows.width(), all = rows.count() * width;
    const std::size_t step = std::max<std::size_t>(1, std::min(rows.count() / 64, all >> 16U)), samples = rows.count() / step;
    const auto row_of = [&](std::size_t k) {
        return k * step + static_cast<std::size_t>(mask_at(static_cast<int>(k), 0) * static_cast<double>(step));
    };
    Array<float> ranks(samples * width);
    const double sum = ordered_sum(parallel_for, samples, 1, [&](std::size_t k, std::size_t) {
        return rows.find(row_of(k), row_of(k) + 1, ranks.data() + k * width);
    });
    RankGuess guess;
    guess.even = even_density(sum, static_cast<double>(ranks.size()));
    for (std::size_t k = 0; k < samples; ++k) rows.rank(row_of(k), row_of(k) + 1, guess.even, ranks.data() + k * width);
    // Half as many again as there should be.
    const double share = 1.5 * static_cast<double>(count) / static_cast<double>(all);
    const auto last = std::min(ranks.size() - 1, static_cast<std::size_t>(share * static_cast<double>(ranks.size())) + 16);
    std::nth_element(ranks.begin(), ranks.begin() + last, ranks.end());
    guess.limit = ranks[last];
    return guess;
}

/// Some pixels of a band of rows.
struct LikelyPoints {
    Array<std::uint32_t> pixels;  ///< y * width + x
    Array<float> values;          ///< of each, the density without the even part, and then the rank
};

/// Finds the pixels of each band whose rank is at most the limit by this guess. Returns the sum of all densities. Nothing of
/// some bands is found where there are more than `most` pixels: `is_complete` tells.
template <int C>
[[nodiscard]] HMESH_COLD double find_likely(const DensityRows<C>& rows, const RankGuess& guess, std::size_t most,
                                            std::vector<LikelyPoints>& of_band, bool& is_complete,
                                            const ParallelFor& parallel_for) {
    std::atomic<std::size_t> found{0};
    const double sum = ordered_sum(parallel_for, rows.count(), density_band, [&](std::size_t begin, std::size_t end) {
        Array<float> densities((end - begin) * rows.width());
        const double part = rows.find(begin, end, densities.data());
        if (!(guess.limit > 0) || found > most) return part;
        Array<float> ranks = densities;
        rows.rank(begin, end, guess.even, ranks.data());
        LikelyPoints likely;
        for (std::size_t k = 0; k < ranks.size(); ++k)
            if (ranks[k] <= guess.limit) {
                likely.pixels.push_back(static_cast<std::uint32_t>(begin * rows.width() + k));
                likely.values.push_back(densities[k]);
            }
        found += likely.pixels.size();
        if (found <= most) of_band[begin / density_band] = std::move(likely);
        return part;
    });
    is_complete = guess.limit > 0 && found <= most;
    return sum;
}

/// These pixels, which are given up, with their ranks. A band is a piece of work, and left as it is once go_on() says false.
[[nodiscard]] HMESH_COLD inline PointCandidates with_ranks(std::vector<LikelyPoints>& of_band, std::size_t width, float even,
                                                           const ParallelFor& parallel_for, FunctionRef<bool()> go_on) {
    parallel_for(of_band.size(), [&](std::size_t band) {
        if (!go_on()) return;
        LikelyPoints& likely = of_band[band];
        for (std::size_t k = 0; k < likely.pixels.size(); ++k) {
            const auto x = static_cast<int>(likely.pixels[k] % width), y = static_cast<int>(likely.pixels[k] / width);
            likely.values[k] += even;
            rank_row(&likely.values[k], x, x + 1, y);
        }
    });
    PointCandidates out;
    for (LikelyPoints& likely : of_band) {
        for (std::size_t k = 0; k < likely.pixels.size(); ++k) {
            out.pixels.push_back(likely.pixels[k]);
            out.ranks.push_back(bits_of(likely.values[k]));
        }
        likely = {};
    }
    return out;
}

/// The rank below which all pixels are among those at most at the limit by this guess, when the even part is known.
[[nodiscard]] inline float sure_rank(const RankGuess& guess, float even) noexcept {
    // A density grows by the factor even / guess.even at most, and its rank shrinks so; the last factor is for what floats round.
    // Beyond 1e28 the sum of a density and the even part could be infinite.
    const double growth = std::max(1.0, static_cast<double>(even) / static_cast<double>(guess.even));
    return even < 1e28F ? static_cast<float>(static_cast<double>(guess.limit) / growth * (1 - 1e-6)) : 0.0F;
}

}  // namespace detail

/// The `count` pixels, as y * width + x, of the least point_ranks() of point_density(), 0 <= count <= pixels; those of
/// first_points(). Once go_on() says false, or where the image changes meanwhile, they are other pixels, in ascending order, and
/// maybe fewer. It is called on any thread, before each band of 32 rows and before its ranks.
template <int C>
[[nodiscard]] HMESH_COLD Array<std::uint32_t> points_by_rows(const ImageSource<C>& source, std::size_t count,
                                                             const ParallelFor& parallel_for, FunctionRef<bool()> go_on) {
    constexpr double worth_a_guess = 1 << 18;  // pixels; of fewer the rows would be most of the image
    const detail::DensityRows<C> rows(source, go_on);
    detail::RankGuess guess;
    if (source.pixels() >= worth_a_guess) guess = detail::guess_ranks(rows, count, parallel_for);
    std::vector<detail::LikelyPoints> of_band((rows.count() + detail::density_band - 1) / detail::density_band);
    bool is_complete = false;
    const double sum = detail::find_likely(rows, guess, 2 * count + 65536, of_band, is_complete, parallel_for);
    const float even = detail::even_density(sum, source.pixels());
    if (is_complete) {
        detail::PointCandidates candidates = detail::with_ranks(of_band, rows.width(), even, parallel_for, go_on);
        const std::uint32_t sure = detail::bits_of(detail::sure_rank(guess, even));
        const auto is_sure = [&](std::uint32_t rank) { return rank < sure; };
        if (static_cast<std::size_t>(std::count_if(candidates.ranks.begin(), candidates.ranks.end(), is_sure)) >= count)
            return detail::least_of(std::move(candidates), count);
    }
    of_band = {};
    const auto ranks = [&](std::size_t begin, std::size_t end, Array<float>& room) -> const float* {
        room.resize((end - begin) * rows.width());
        (void)rows.find(begin, end, room.data());
        rows.rank(begin, end, even, room.data());
        return room.data();
    };
    return detail::least_ranks(rows.width(), rows.count(), detail::density_band, ranks, count, parallel_for);
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_ANNEALED_POINTS_BY_ROWS_HPP
