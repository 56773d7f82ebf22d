/// \file
/// The sRGB transfer function of IEC 61966-2-1, both ways: between stored values and light, as shares of full intensity; and
/// which of a colour's channels it is not for: alpha.
///
/// Nothing but sums, products, quotients and square roots, which are the same on all machines; the last bit of std::pow differs
/// between standard libraries. About 10 ns a call.
#ifndef HMESH_CORE_SRGB_HPP
#define HMESH_CORE_SRGB_HPP

#include <cmath>

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// Whether the last of this number of channels is alpha.
[[nodiscard]] constexpr bool has_alpha(int channels) noexcept { return channels == 2 || channels == 4; }
/// Whether a channel of so many is light, which sRGB encodes: all are but alpha.
[[nodiscard]] constexpr bool is_light(int channel, int channels) noexcept {
    return !has_alpha(channels) || channel + 1 != channels;
}

/// The linear light, as a share of full light, of an sRGB-encoded share in [0, 1]. Error below 1e-14. The power 2.4 is the
/// twelfth power of the fifth root, found by Newton's method.
[[nodiscard]] inline double srgb_to_linear(double share) noexcept {
    if (share <= 0.04045) return share / 12.92;
    const double x = (share + 0.055) / 1.055;
    double root = 0.582 + x * (0.73 - 0.318 * x);  // off by 0.03 at most; an error e becomes 2 e^2 / root
    for (int i = 0; i < 4; ++i) {
        const double square = root * root, fourth = square * square;
        root = 0.8 * root + 0.2 * x / fourth;
    }
    const double square = root * root, fourth = square * square;
    return fourth * fourth * fourth;
}

/// The sRGB-encoded share of a share of light in [0, 1]. Error below 1e-12. The power 1 / 2.4 is the square root of the square
/// root times the cube root of the square root, found by Halley's method.
[[nodiscard]] inline double linear_to_srgb(double light) noexcept {
    if (light <= 0.0031308) return 12.92 * light;
    const double s = std::sqrt(light);
    double root = 0.32 + s * (1.375 - 0.738 * s);  // off by 0.045 of itself at most; an error e becomes 2/3 e^3
    for (int i = 0; i < 2; ++i) {
        const double cube = root * root * root;
        root *= (cube + 2 * s) / (2 * cube + s);
    }
    return 1.055 * (std::sqrt(s) * root) - 0.055;
}

/// The derivative of linear_to_srgb() at `light`, of which `share` is the encoded value: 12.92 near black, 0.44 at white.
[[nodiscard]] inline double linear_to_srgb_slope(double light, double share) noexcept {
    return light <= 0.0031308 ? 12.92 : (share + 0.055) / (2.4 * light);
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_CORE_SRGB_HPP
