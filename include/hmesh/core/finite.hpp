// hmesh - is_finite(), is_within(): can a number that came from outside be calculated with?
//
// Answered by the bits. Compilers that are told of finite numbers only (-ffast-math) take std::isfinite() and comparisons
// with NaN to be true without looking; what users hand over is checked with these two, so that it is refused there too.
#ifndef HMESH_CORE_FINITE_HPP
#define HMESH_CORE_FINITE_HPP

#include <cstdint>
#include <cstring>
#include <limits>

namespace hmesh {

static_assert(std::numeric_limits<float>::is_iec559 && std::numeric_limits<double>::is_iec559, "hmesh needs IEEE 754");

// Whether it is neither NaN nor infinite.
[[nodiscard]] inline bool is_finite(float value) noexcept {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    return (bits & 0x7F800000U) != 0x7F800000U;
}
[[nodiscard]] inline bool is_finite(double value) noexcept {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    return (bits & 0x7FF0000000000000U) != 0x7FF0000000000000U;
}

// Whether low <= value <= high; false for NaN.
[[nodiscard]] inline bool is_within(double value, double low, double high) noexcept {
    return is_finite(value) && value >= low && value <= high;
}

}  // namespace hmesh

#endif  // HMESH_CORE_FINITE_HPP
