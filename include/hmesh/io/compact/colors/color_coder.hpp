/// \file
/// ColorCoder: the colours of the vertices of a triangulation, in whole numbers.
///
/// Vertices come in the order of their points; each is foretold by its neighbours, in one of the ways of foretelling.hpp, and
/// told by its difference to that, exactly or in steps. Three channels are coded as a luma and two differences: exact ones by H.
/// Malvar and G. Sullivan, "YCoCg-R: a color space with RGB reversibility and low dynamic range", 2003, coarse ones as three that
/// are orthogonal; alpha comes before all. How large a difference may be is told by how much the neighbours differ, by how well
/// they were foretold themselves, by their distance, and by the channels before.
///
/// Cost: O(n), some 150 ns a number.
#ifndef HMESH_IO_COMPACT_COLORS_COLOR_CODER_HPP
#define HMESH_IO_COMPACT_COLORS_COLOR_CODER_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "hmesh/core/srgb.hpp"
#include "hmesh/io/compact/arithmetic_coder.hpp"
#include "hmesh/io/compact/colors/color_choice.hpp"
#include "hmesh/io/compact/colors/foretelling.hpp"
#include "hmesh/io/compact/mixer.hpp"
#include "hmesh/io/compact/sites.hpp"
#include "hmesh/io/compact/start_table.hpp"
#include "hmesh/io/compact/triangulation.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

/// Numbers 0 to `most` as luma and differences, which are those of red to blue and of green to both, each from 0 to 2 most.
[[nodiscard]] inline std::array<std::int64_t, 3> to_luma(const std::array<std::int64_t, 3>& rgb, std::int64_t most) noexcept {
    const std::int64_t orange = rgb[0] - rgb[2], middle = rgb[2] + (orange + 2 * most) / 2 - most;
    const std::int64_t green = rgb[1] - middle;
    return {middle + (green + 2 * most) / 2 - most, orange + most, green + most};
}
/// The numbers of which to_luma() gives these. They lie outside [0, most] where there are none.
[[nodiscard]] inline std::array<std::int64_t, 3> from_luma(const std::array<std::int64_t, 3>& luma, std::int64_t most) noexcept {
    const std::int64_t green = luma[2] - most, orange = luma[1] - most, middle = luma[0] - ((green + 2 * most) / 2 - most);
    const std::int64_t blue = middle - ((orange + 2 * most) / 2 - most);
    return {blue + orange, green + middle, blue};
}

/// Coarse colours: planes of a luma and two differences that are orthogonal, each in 16ths of a 255th, the differences with
/// 8192 more;
/// of one or two channels the channels themselves. What is coded of a plane is a multiple of the vertex's step, from
/// its guess on.
struct CoarseColors {
    static constexpr std::int64_t most = 16383, middle = 8192;

    std::int64_t step = 0;         ///< of a vertex of mean area, 1 to 4095; 0: colours are exact
    std::int64_t mean_area = 0;    ///< of 256 times the faces around a vertex, twice the area
    std::vector<double> wanted{};  ///< where it is written: the planes of each point

    /// The planes of a colour in 255ths.
    [[nodiscard]] static std::array<double, 4> planes(std::array<double, 4> color, bool is_rgb) noexcept {
        for (double& value : color) value *= 16;
        if (is_rgb) {
            const auto [r, g, b, a] = color;
            color = {(r + g + b) / 3, (r - b) / 2 + middle, (2 * g - r - b) / 6 + middle, a};
        }
        return color;
    }
    /// The colour of planes, in 255ths.
    [[nodiscard]] static std::array<std::int64_t, 4> color(std::array<std::int64_t, 4> plane, bool is_rgb) noexcept {
        if (is_rgb) {
            const std::int64_t luma = plane[0], orange = plane[1] - middle, green = plane[2] - middle;
            plane = {luma + orange - green, luma + 2 * green, luma - orange - green, plane[3]};
        }
        for (std::int64_t& value : plane) value = std::min<std::int64_t>((std::max<std::int64_t>(value, 0) + 8) / 16, 255);
        return plane;
    }
    /// What a unit off in a plane adds to the squared error of all channels.
    [[nodiscard]] static double weight(std::size_t channel, bool is_rgb) noexcept {
        static constexpr std::array<double, 4> weights{3, 2, 6, 1};
        return weights[is_rgb ? channel : 3];
    }
    /// What a bit is worth, in the units of ColorChoice::price() times weight(): D ln 4 of the error D = step^2 / 12 of uniform
    /// steps, at a vertex of mean area whose neighbours make good of it what they can.
    [[nodiscard]] double bit_price(bool is_rgb) const noexcept {
        const auto of_mean = static_cast<double>(step) * (is_rgb ? 10 : 17) / 16;
        const double price = 1.4 * static_cast<double>(mean_area) / 256;
        return 1.2 * 1.386 / 12 * of_mean * of_mean * weight(is_rgb ? 0 : 3, is_rgb) * price;
    }
    /// The steps of a vertex in 16ths of those of one of mean area, 4 to 64: of a fourth of the area they are twice as large, so
    /// that all errors count the same. `area`: twice that of the faces around the vertex.
    [[nodiscard]] std::int64_t share_of(std::int64_t area) const noexcept {
        const std::int64_t ratio = std::max<std::int64_t>(16, std::min<std::int64_t>(mean_area / area, 4096));
        std::int64_t root = 0;
        for (std::int64_t digit = 64; digit > 0; digit /= 2) root += (root + digit) * (root + digit) <= ratio ? digit : 0;
        return root;
    }
    /// The step of a plane of a vertex with such a share.
    [[nodiscard]] std::int64_t step_of(std::int64_t share, std::size_t channel, bool is_rgb) const noexcept {
        static constexpr std::array<std::int64_t, 4> shares{10, 12, 7, 17};  // of the vectors' lengths: 17.3, 17.0, 17.1, 17
        return std::max<std::int64_t>(1, step * share * shares[is_rgb ? channel : 3] / 256);
    }
};

/// Codes colours. `channels` numbers a vertex, interleaved. `Foretelling` is one of foretelling.hpp.
template <class Foretelling>
class ColorCoder {
  public:
    /// Of a triangulation of n points, with the coder that it writes to or reads from, which outlives it, as the tables and
    /// `coarse` do.
    ColorCoder(ArithmeticCoder& coder, const Logistic& logistic, std::size_t n, const ColorNumbers& numbers, CoarseColors& coarse)
        : coder_(&coder), coarse_(&coarse), channels_(numbers.channels), most_(numbers.most), foretelling_(n, numbers),
          sizes_(logistic, 4 * steps, 21845), spread_(steps * 4 * 20), misses_(steps * 4 * 20), others_(steps * 4 * 20),
          place_(steps * 4 * 20 * 8), signs_(std::size_t{4} * 9 * 3), digits_(steps * 4 * 8) {}

    /// Codes the colours of those vertices that are `used`; others are left as they are. False: what is read ended before, or is
    /// no colour.
    bool code(const Triangulation& mesh, const std::vector<bool>& used, std::vector<std::uint32_t>& colors) {
        const std::size_t n = mesh.point_count();
        const bool is_rgb = channels_ >= 3 && most_ < 65536;
        const bool is_coarse = coarse_->step > 0;
        const bool begins_with_alpha = kit::has_alpha(static_cast<int>(channels_));
        if (is_coarse && coder_->writes()) choice_ = ColorChoice(mesh, used, coarse_->wanted, channels_);
        std::size_t last = n;  // the vertex coded before
        for (std::size_t v = 0; v < n; ++v) {
            if (!used[v]) continue;
            foretelling_.look(mesh, used, v, last);
            const std::int64_t share = is_coarse ? coarse_->share_of(foretelling_.area(mesh)) : 0;
            std::uint32_t* const color = colors.data() + v * channels_;
            std::array<std::int64_t, 4> truth{};
            if (coder_->writes() && !is_coarse) {
                for (std::size_t k = 0; k < channels_; ++k) truth[k] = color[k];
                if (is_rgb) {
                    const auto luma = to_luma({truth[0], truth[1], truth[2]}, most_);
                    std::copy(luma.begin(), luma.end(), truth.begin());
                }
            }
            std::array<std::size_t, 2> before{};  // sizes of the differences of two channels before
            std::array<std::size_t, 2> turns{};   // and their signs: 0, 1 above, 2 below
            for (std::size_t k = 0; k < channels_; ++k) {
                const std::size_t channel = begins_with_alpha ? (k == 0 ? channels_ - 1 : k - 1) : k;
                const bool is_difference = is_rgb && (channel == 1 || channel == 2);
                Plane plane{channel, is_difference ? 2 * most_ : most_, 1, 0};
                if (is_coarse) plane.most = CoarseColors::most, plane.step = coarse_->step_of(share, channel, is_rgb);
                plane.first = !is_coarse ? (plane.most + 1) / 2 : is_difference ? CoarseColors::middle : 2048;
                const std::int64_t got = code_number(v, plane, truth[channel], before, turns);
                if (got < 0) return false;
                truth[channel] = got;
            }
            foretelling_.close();
            if (is_coarse && coder_->writes()) choice_.close(v);
            if (is_coarse) {
                truth = CoarseColors::color(truth, is_rgb);
            } else if (is_rgb) {
                const auto rgb = from_luma({truth[0], truth[1], truth[2]}, most_);
                std::copy(rgb.begin(), rgb.end(), truth.begin());
            }
            for (std::size_t k = 0; k < channels_; ++k) {
                if (truth[k] < 0 || truth[k] > most_) return false;
                color[k] = static_cast<std::uint32_t>(truth[k]);
            }
            if (coder_->is_exhausted()) return false;
            last = v;
        }
        return true;
    }

    /// What it has learnt.
    [[nodiscard]] Learnt learnt() { return {{&spread_, &misses_, &others_, &place_, &signs_, &digits_}, &sizes_.weights()}; }

  private:
    static constexpr std::size_t steps = 36;  // of the number of digits of a difference

    // What is coded of a vertex: a channel, its largest number, its step and what the first vertex is foretold as.
    struct Plane {
        std::size_t channel;
        std::int64_t most, step, first;
    };

    // Where the contexts of a difference's size begin, and its sets of weights.
    struct Sizes {
        std::size_t spread, misses, others, place, set;
        [[nodiscard]] std::array<AdaptiveBit*, 4> contexts(ColorCoder& of, std::size_t size) const noexcept {
            return {&of.spread_[spread + size], &of.misses_[misses + size], &of.others_[others + size], &of.place_[place + size]};
        }
    };

    // Which multiple of a plane's step is best: of the least error and bits together.
    [[nodiscard]] std::int64_t coarse_difference(std::size_t v, const Plane& plane, std::int64_t guess, const Sizes& sizes) {
        const auto step = static_cast<double>(plane.step);
        const double off = (choice_.wanted(v, plane.channel) - static_cast<double>(guess)) / step;
        const double weight = CoarseColors::weight(plane.channel, channels_ >= 3) * step * step * choice_.price(v);
        const double bit_price = coarse_->bit_price(channels_ >= 3);
        const std::int64_t room = (off < 0 ? guess : plane.most - guess) / plane.step;
        const std::int64_t most = std::min(static_cast<std::int64_t>(std::abs(off)) + 1, room);
        const std::size_t largest = size_of(std::max(guess, plane.most - guess) / plane.step);
        std::int64_t best = 0;
        double least = std::numeric_limits<double>::max(), bits = 0;  // of being larger than `size`
        std::size_t size = 0;
        const auto is_larger = [&] { return sizes_.probability(sizes.contexts(*this, size), sizes.set + size); };
        for (std::int64_t k = 0; k <= most; k = k == 0 ? std::max<std::int64_t>(1, most - 3) : k + 1) {  // 0 and the last four
            for (; size < size_of(k); ++size) bits += bits_of(is_larger());
            double all = bits + static_cast<double>(size);  // its sign, and its digits behind the first
            if (size < largest) all += bits_of(65536 - is_larger());
            const double missed = std::abs(off) - static_cast<double>(k), cost = weight * missed * missed + bit_price * all;
            if (cost < least) least = cost, best = k;
        }
        return off < 0 ? -best : best;
    }
    [[nodiscard]] static double bits_of(std::uint32_t p16) noexcept { return 16 - std::log2(static_cast<double>(p16)); }

    [[nodiscard]] static std::size_t size_of(std::int64_t difference) noexcept {
        return static_cast<std::size_t>(digits_of(static_cast<std::uint64_t>(difference < 0 ? -difference : difference)));
    }

    // Codes one number of a plane. Below 0: what is read is none.
    std::int64_t code_number(std::size_t v, const Plane& plane, std::int64_t truth, std::array<std::size_t, 2>& before,
                             std::array<std::size_t, 2>& turns) {
        const std::size_t channel = plane.channel;
        const std::int64_t most = plane.most, step = plane.step, first = plane.first;
        const Foretold foretold = foretelling_.foretell(channel, first, most);
        const std::int64_t guess = foretold.guess;
        // Four times the mean, in steps and half powers of two.
        const auto level = [&](std::int64_t total) {
            if (foretold.weights == 0) return std::size_t{19};
            return std::min<std::size_t>(half_digits_of(static_cast<std::uint64_t>(total / (foretold.weights * step / 4 + 1))),
                                         18);
        };
        const std::size_t spread_level = level(foretold.spread), missed_level = level(foretold.missed);
        std::int64_t difference = truth - guess;
        const std::size_t other = std::min<std::size_t>(before[0], 9) + (before[1] > before[0] ? 10 : 0);
        const std::size_t at = channel * 20 * steps;
        const Sizes sizes{at + spread_level * steps, at + missed_level * steps, at + other * steps,
                          channel * 20 * 8 * steps + (foretelling_.coded().digits() * 8 + foretelling_.coded().count()) * steps,
                          channel * steps};
        if (coarse_->step > 0 && coder_->writes()) difference = coarse_difference(v, plane, guess, sizes);
        // The number of digits of the difference, one by one.
        const std::size_t wanted = size_of(difference), largest = size_of(std::max(guess, most - guess) / step);
        std::size_t size = 0;
        for (; size < largest; ++size) {
            const bool is_larger = sizes_.code(*coder_, wanted > size, sizes.contexts(*this, size), sizes.set + size);
            if (!is_larger) break;
        }
        std::int64_t number = guess;
        std::size_t turn = 0;
        if (size > 0) {
            const bool is_below = signs_[(channel * 9 + turns[0] * 3 + turns[1]) * 3].code(*coder_, difference < 0);
            const auto full = static_cast<std::uint64_t>(difference < 0 ? -difference : difference);
            std::uint64_t digits = 1;
            std::size_t node = 1;
            for (std::size_t left = size - 1; left > 0; --left) {
                const bool bit = (full >> (left - 1) & 1U) != 0;
                bool got = bit;
                if (node < 4) {
                    got = digits_[(channel * steps + size) * 8 + node].code(*coder_, bit);
                    node = 2 * node + (got ? 1 : 0);
                } else {
                    got = coder_->bits(bit ? 1 : 0, 1) != 0;
                }
                digits = digits << 1 | (got ? 1U : 0U);
            }
            number += is_below ? -step * static_cast<std::int64_t>(digits) : step * static_cast<std::int64_t>(digits);
            turn = is_below ? 2 : 1;
        }
        if (number < 0 || number > most) return -1;
        foretelling_.note(channel, number, number > guess ? number - guess : guess - number);
        if (coarse_->step > 0 && coder_->writes()) {
            choice_.set(v, channel, static_cast<double>(number));
        }
        before = {size, before[0]};
        turns = {turn, turns[0]};
        return number;
    }
    // Twice the binary logarithm, rounded down, and 1; 0 of 0.
    [[nodiscard]] static std::size_t half_digits_of(std::uint64_t value) noexcept {
        if (value < 2) return static_cast<std::size_t>(value);
        const int digits = digits_of(value);
        return static_cast<std::size_t>(2 * digits - 2 + static_cast<int>(value >> (digits - 2) & 1U));
    }

    ArithmeticCoder* coder_;
    CoarseColors* coarse_;
    std::size_t channels_;
    std::int64_t most_;
    Foretelling foretelling_;
    Mixer<4> sizes_;
    std::vector<AdaptiveBit> spread_, misses_, others_, place_, signs_, digits_;
    ColorChoice choice_;
};

}  // namespace hmesh::detail

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_COMPACT_COLORS_COLOR_CODER_HPP
