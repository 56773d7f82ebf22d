/// \file
/// is_finite(), is_nan(), is_within(): whether a number that came from outside can be calculated with; nearest_finite(): one that
/// can; as_float(): what a float keeps of it.
///
/// The first four look at bits in memory. Compilers that assume finite numbers (-ffast-math) answer std::isfinite() and
/// comparisons with NaN without looking, and clang++ assumes parameters and results of functions to be finite too; what users
/// hand over is checked with these, so that NaN is refused there as well.
#ifndef HMESH_CORE_FINITE_HPP
#define HMESH_CORE_FINITE_HPP

#include <cstdint>
#include <cstring>
#include <limits>

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

static_assert(std::numeric_limits<float>::is_iec559 && std::numeric_limits<double>::is_iec559, "hmesh needs IEEE 754");

/// Whether the value is neither NaN nor infinite.
[[nodiscard]] inline bool is_finite(const float& value) noexcept {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    return (bits & 0x7F800000U) != 0x7F800000U;
}

namespace detail {

/// The bits of a double.
[[nodiscard]] inline std::uint64_t bits_of_double(const double& value) noexcept {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    return bits;
}

/// The double with these bits. Infinity and NaN are made of them, because compilers that assume finite numbers warn of the
/// constants, and of whatever is called infinity.
[[nodiscard]] inline double double_of_bits(std::uint64_t bits) noexcept {
    double value = 0;
    std::memcpy(&value, &bits, sizeof value);
    return value;
}
/// Positive infinity.
[[nodiscard]] inline double infinite() noexcept { return double_of_bits(0x7FF0000000000000U); }
/// A quiet NaN.
[[nodiscard]] inline double nan() noexcept { return double_of_bits(0x7FF8000000000000U); }

}  // namespace detail

/// Whether the value is neither NaN nor infinite.
[[nodiscard]] inline bool is_finite(const double& value) noexcept {
    return (detail::bits_of_double(value) & 0x7FF0000000000000U) != 0x7FF0000000000000U;
}
/// Whether the value is NaN.
[[nodiscard]] inline bool is_nan(const double& value) noexcept {
    return (detail::bits_of_double(value) & 0x7FFFFFFFFFFFFFFFU) > 0x7FF0000000000000U;
}
/// The value, or the largest double of its sign where it is infinite; NaN stays NaN.
[[nodiscard]] inline double nearest_finite(const double& value) noexcept {
    const std::uint64_t bits = detail::bits_of_double(value);
    return detail::double_of_bits(bits - ((bits & 0x7FFFFFFFFFFFFFFFU) == 0x7FF0000000000000U ? 1 : 0));
}
/// Whether low <= value <= high; false for NaN and infinities.
[[nodiscard]] inline bool is_within(const double& value, double low, double high) noexcept {
    return is_finite(value) && value >= low && value <= high;
}

/// The float nearest to a value in the range of floats, as a double. g++ 11 and 12 with -O2 or -O3 forget the conversions of two
/// neighbours to float and back where they make one vector of them: {double(float(a)), double(float(b))} is {a, b} then.
[[nodiscard]] inline double as_float(double value) noexcept {
#if defined(__GNUC__) && !defined(__clang__)
    const volatile auto stored = static_cast<float>(value);
#else
    const auto stored = static_cast<float>(value);
#endif
    return static_cast<double>(stored);
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_CORE_FINITE_HPP
