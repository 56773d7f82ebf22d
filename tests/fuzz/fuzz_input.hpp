// hmesh tests - the bytes that a fuzzer is given, read as numbers and choices; and demand(), by which it reports a finding.
//
// Bytes that are used up are zeros, and zeros mean what is usual: a short input is an ordinary one with few surprises.
#ifndef HMESH_TESTS_FUZZ_FUZZ_INPUT_HPP
#define HMESH_TESTS_FUZZ_FUZZ_INPUT_HPP

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>

namespace hmesh_test {

// Ends the program, which libFuzzer counts as a finding, unless the promise is kept.
inline void demand(bool kept, const char* promise) {
    if (kept) return;
    std::fprintf(stderr, "broken promise: %s\n", promise);
    std::abort();
}

class FuzzInput {
  public:
    FuzzInput(const std::uint8_t* bytes, std::size_t size) noexcept : at_(bytes), end_(bytes + size) {}

    [[nodiscard]] std::size_t left() const noexcept { return static_cast<std::size_t>(end_ - at_); }
    [[nodiscard]] std::uint8_t byte() noexcept { return at_ != end_ ? *at_++ : std::uint8_t{0}; }

    // Any value of a type that is nothing but its bits: floats may be NaN.
    template <class T>
    [[nodiscard]] T bits() noexcept {
        std::array<unsigned char, sizeof(T)> bytes{};
        for (unsigned char& b : bytes) b = byte();
        T value{};
        std::memcpy(&value, bytes.data(), sizeof(T));
        return value;
    }

    // --- choices, each from one byte if it can be ---
    [[nodiscard]] bool flag() noexcept { return (byte() & 1U) != 0; }
    // 1 <= n <= 255. False for the byte 0.
    [[nodiscard]] bool one_in(unsigned n) noexcept { return byte() % n == n - 1; }
    // 0 <= high - low < 65536. `low` for zeros.
    [[nodiscard]] int within(int low, int high) noexcept {
        const unsigned count = static_cast<unsigned>(high - low) + 1;
        return low + static_cast<int>((count <= 256 ? byte() : bits<std::uint16_t>()) % count);
    }
    template <class T, std::size_t N>
    [[nodiscard]] T one_of(const T (&values)[N]) noexcept {
        static_assert(N <= 256, "one byte chooses");
        return values[byte() % N];
    }
    // In [0, 1], in steps of 1/65535.
    [[nodiscard]] double share() noexcept { return bits<std::uint16_t>() / 65535.0; }

    // --- numbers that nobody should pass, and their likes ---
    [[nodiscard]] double wild_real() noexcept {
        using Limits = std::numeric_limits<double>;
        constexpr double most_float = std::numeric_limits<float>::max();
        // clang-format off
        static constexpr double wild[] = {
            0.0, -0.0, -1.0, 1.0, 0.1, 255.0, 65536.0, 4294967296.0, 1e6, 1e15, 1e-9, 1.4e-45, most_float, -most_float,
            Limits::quiet_NaN(), Limits::infinity(), -Limits::infinity(), Limits::max(), -Limits::max(), Limits::min(),
            Limits::denorm_min(), Limits::epsilon()};
        // clang-format on
        switch (byte() % 4) {
            case 0: return one_of(wild);
            case 1: return static_cast<double>(bits<float>());
            case 2: return std::ldexp(2 * share() - 1, within(-160, 160));
            default: return bits<double>();
        }
    }
    [[nodiscard]] int wild_int() noexcept {
        using Limits = std::numeric_limits<int>;
        // clang-format off
        static constexpr int wild[] = {
            0, -1, 1, 2, 3, 19, 63, 64, 255, 1000, 4096, 65535, 65536, 65537, 1000000, Limits::max(), Limits::max() - 1,
            Limits::min(), Limits::min() + 1};
        // clang-format on
        return flag() ? bits<int>() : one_of(wild);
    }

  private:
    const std::uint8_t* at_;
    const std::uint8_t* end_;
};

}  // namespace hmesh_test

#endif  // HMESH_TESTS_FUZZ_FUZZ_INPUT_HPP
