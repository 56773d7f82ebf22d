/// \file
/// Channel weights: how much each channel of an image counts.
///
/// A sum of squared differences in which channel c counts w_c times is the plain sum of squared differences of an image whose
/// channels are multiplied by sqrt(w_c). Geometry is chosen on such a copy, with the largest weight scaled to 1 and samples
/// rounded to 16 bits, whose sums are exact; the final colours, of which each channel is a problem of its own whatever its
/// weight, and the error are those of the image itself.
#ifndef HMESH_IMAGE_CHANNEL_WEIGHTS_HPP
#define HMESH_IMAGE_CHANNEL_WEIGHTS_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/core/compiler.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/image/image_view.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// Whether `weights` can be those of an image's channels: none at all, or one number in [0, 1e30] for each, not all 0. Otherwise
/// invalid_argument.
[[nodiscard]] HMESH_COLD inline Status check_channel_weights(const std::vector<double>& weights, int channels) noexcept {
    if (weights.empty()) return {};
    if (weights.size() != static_cast<std::size_t>(channels))
        return {Errc::invalid_argument, "channel_weights must have one weight for each channel of the image",
                static_cast<std::int64_t>(weights.size()), channels};
    for (const double weight : weights)
        if (const Status status = check_ranges({{"a weight of a channel must be in [0, 1e30]", weight, 0, 1e30}}); !status)
            return status;
    if (*std::max_element(weights.begin(), weights.end()) == 0)
        return {Errc::invalid_argument, "the weights of the channels are all 0"};
    return {};
}

/// Whether weights that check_channel_weights() accepts make a difference.
[[nodiscard]] HMESH_COLD inline bool differ(const std::vector<double>& channel_weights) noexcept {
    return std::any_of(channel_weights.begin(), channel_weights.end(), [&](double w) { return w != channel_weights.front(); });
}

/// A channel's weight as a share of the largest one, for weights that check_channel_weights() accepts; 1 where there are none.
[[nodiscard]] HMESH_COLD inline double weight_share(const std::vector<double>& weights, std::size_t channel) noexcept {
    return weights.empty() ? 1 : weights[channel] / *std::max_element(weights.begin(), weights.end());
}
/// The square root of weight_share() of each channel.
template <int C>
[[nodiscard]] HMESH_COLD std::array<double, std::size_t{C}> channel_shares(const std::vector<double>& weights) {
    std::array<double, std::size_t{C}> shares{};
    for (std::size_t c = 0; c < C; ++c) shares[c] = std::sqrt(weight_share(weights, c));
    return shares;
}

/// From the stored values of an image to those of one whose channels are scaled by their weights: (stored - offset) * factor.
template <int C>
struct ChannelScale {
    double offset = 0;                                                 ///< a stored value
    double unit = 1;                                                   ///< the factor of channels of the largest weight, > 0
    std::array<double, std::size_t{C}> share = channel_shares<C>({});  ///< channel_shares(): the factor is unit * share

    /// For how many channels of the largest weight all count together.
    [[nodiscard]] double sum() const noexcept {
        double weights = 0;
        for (const double root : share) weights += root * root;
        return weights;
    }
    /// Scales the stored values of a colour (Lanes).
    template <class Color>
    void to_scaled(Color& color) const noexcept {
        for (int c = 0; c < C; ++c) color.set(c, (color[c] - offset) * factor(c));
    }
    /// Scales the stored values of pixels that follow each other, and rounds them to the whole numbers in [0, 65535].
    void to_samples(double* values, int pixels) const noexcept {
        for (int i = 0; i < pixels; ++i, values += C)
            for (int c = 0; c < C; ++c) values[c] = static_cast<double>(static_cast<int>((values[c] - offset) * factor(c) + 0.5));
    }
    /// The stored value nearest to this one of which to_samples() makes such a number in each channel.
    [[nodiscard]] double limited(double value) const noexcept { return std::max(offset, std::min(offset + 65535 / unit, value)); }
    /// The way back; channels of weight 0 become `offset`.
    template <class Color>
    void to_stored(Color& color) const noexcept {
        for (int c = 0; c < C; ++c) color.set(c, offset + (factor(c) > 0 ? color[c] / factor(c) : 0));
    }

  private:
    [[nodiscard]] double factor(int c) const noexcept { return unit * share[static_cast<std::size_t>(c)]; }
};

/// The values between which samples lie.
struct SampleRange {
    double low = 0,  ///< the smallest, or one below
        high = 0;    ///< the largest, or one above
};

/// That of an image: of whole numbers what their type can be, of others what they are in the channels whose weight is not 0; with
/// no weights, in all.
template <class T, int C>
[[nodiscard]] HMESH_COLD SampleRange sample_range(const ImageView<T, C>& view, const std::vector<double>& weights = {}) {
    SampleRange range{PixelTraits<T>::lowest, PixelTraits<T>::highest};
    if constexpr (!PixelTraits<T>::is_integer) {
        const auto counts = [&](int c) { return weights.empty() || weights[static_cast<std::size_t>(c)] != 0; };
        int first = 0;
        while (first + 1 < C && !counts(first)) ++first;
        range.low = range.high = PixelTraits<T>::to_real(view.data[first]);
        for (int y = 0; y < view.height; ++y) {
            const T* sample = view.row(y);
            for (int x = 0; x < view.width; ++x)
                for (int c = 0; c < C; ++c, ++sample) {
                    if (!counts(c)) continue;
                    range.low = std::min(range.low, PixelTraits<T>::to_real(*sample));
                    range.high = std::max(range.high, PixelTraits<T>::to_real(*sample));
                }
        }
    }
    return range;
}

/// The scale for an image with samples of this range, which then lie in [0, 65535], and weights that check_channel_weights()
/// accepts, one a channel.
template <int C>
[[nodiscard]] HMESH_COLD ChannelScale<C> channel_scale(const SampleRange& range, const std::vector<double>& weights) {
    ChannelScale<C> scale;
    scale.offset = range.low;
    if (range.high > range.low) scale.unit = 65535 / (range.high - range.low);
    scale.share = channel_shares<C>(weights);
    return scale;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IMAGE_CHANNEL_WEIGHTS_HPP
