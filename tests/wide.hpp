// hmesh tests - Wide: integers of 128 bits, which the library does without and exact checks of it want.
//
// Written out for compilers that have none: all for 32-bit x86, and Visual C++.
#ifndef HMESH_TESTS_WIDE_HPP
#define HMESH_TESTS_WIDE_HPP

#include <cstdint>

namespace hmesh_test {

#if defined(__SIZEOF_INT128__)
__extension__ using Wide = __int128;
#else
// Two's complement; sums and products modulo 2^128.
class Wide {
  public:
    Wide() = default;
    Wide(std::int64_t value) : high_(value < 0 ? ~std::uint64_t{0} : 0), low_(static_cast<std::uint64_t>(value)) {}

    friend Wide operator-(Wide a) { return Wide(~a.high_, ~a.low_) + Wide(1); }
    friend Wide operator+(Wide a, Wide b) {
        const std::uint64_t low = a.low_ + b.low_;
        return {a.high_ + b.high_ + (low < a.low_ ? 1U : 0U), low};
    }
    friend Wide operator-(Wide a, Wide b) { return a + -b; }
    friend Wide operator*(Wide a, Wide b) {
        constexpr std::uint64_t digit = 0xffffffffU;
        const std::uint64_t a0 = a.low_ & digit, a1 = a.low_ >> 32U, b0 = b.low_ & digit, b1 = b.low_ >> 32U;
        const std::uint64_t middle = (a0 * b0 >> 32U) + (a0 * b1 & digit) + (a1 * b0 & digit);
        const std::uint64_t high = a1 * b1 + (a0 * b1 >> 32U) + (a1 * b0 >> 32U) + (middle >> 32U);
        return {high + a.high_ * b.low_ + a.low_ * b.high_, a.low_ * b.low_};
    }
    Wide& operator+=(Wide b) { return *this = *this + b; }

    friend bool operator==(Wide a, Wide b) { return a.high_ == b.high_ && a.low_ == b.low_; }
    friend bool operator<(Wide a, Wide b) {
        constexpr std::uint64_t sign = std::uint64_t{1} << 63U;  // flipped, negative numbers come first
        return a.high_ != b.high_ ? (a.high_ ^ sign) < (b.high_ ^ sign) : a.low_ < b.low_;
    }
    friend bool operator>(Wide a, Wide b) { return b < a; }
    friend bool operator<=(Wide a, Wide b) { return !(b < a); }

  private:
    Wide(std::uint64_t high, std::uint64_t low) : high_(high), low_(low) {}
    std::uint64_t high_ = 0, low_ = 0;
};
#endif

}  // namespace hmesh_test

#endif  // HMESH_TESTS_WIDE_HPP
