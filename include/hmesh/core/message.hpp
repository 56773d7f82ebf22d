/// \file
/// message(): a Status as a sentence with its numbers.
#ifndef HMESH_CORE_MESSAGE_HPP
#define HMESH_CORE_MESSAGE_HPP

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "hmesh/core/finite.hpp"
#include "hmesh/core/status.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// A sentence of at most 255 bytes, ended by a zero; what is longer is cut. Allocates nothing.
class Message {
  public:
    [[nodiscard]] const char* c_str() const noexcept { return text_; }
    [[nodiscard]] std::size_t size() const noexcept { return size_; }  ///< bytes, without the zero

    /// Appends text.
    Message& operator<<(const char* text) noexcept {
        for (; *text != 0 && size_ + 1 < capacity; ++text) text_[size_++] = *text;
        text_[size_] = 0;
        return *this;
    }
    /// Appends a number: whole ones below 1e15 with all digits, others with six significant ones, whatever the locale.
    Message& operator<<(double number) noexcept {
        if (!kit::is_finite(number)) return *this << "a number that is not finite";
        if (number < 0) *this << "-";
        const double size = std::abs(number);
        if (size < 1e15 && size == std::floor(size)) return digits(static_cast<std::uint64_t>(size));
        int exponent = static_cast<int>(std::floor(std::log10(size)));
        const bool is_plain = exponent >= -5 && exponent < 6;
        // Six significant digits as a whole number, below 10^6 but for rounding, which is as good.
        // In two steps for the smallest doubles, for which 10^308 is not enough.
        const int lift = exponent < -300 ? 30 : 0;
        const auto scaled = static_cast<std::uint64_t>(size * std::pow(10.0, lift) * std::pow(10.0, 5 - exponent - lift) + 0.5);
        if (is_plain) return fixed(scaled, 5 - exponent);
        fixed(scaled, 5) << "e";
        if (exponent < 0) *this << "-";
        exponent = exponent < 0 ? -exponent : exponent;
        return digits(static_cast<std::uint64_t>(exponent));
    }

  private:
    static constexpr std::size_t capacity = 256;

    Message& digits(std::uint64_t number) noexcept {
        char text[21];
        std::size_t at = sizeof text - 1;
        text[at] = 0;
        do {
            text[--at] = static_cast<char>('0' + number % 10);
            number /= 10;
        } while (number != 0);
        return *this << text + at;
    }
    // number / 10^places, without zeros at the end.
    Message& fixed(std::uint64_t number, int places) noexcept {
        std::uint64_t power = 1;
        for (; places > 0 && number % 10 == 0; --places) number /= 10;
        for (int k = 0; k < places; ++k) power *= 10;
        digits(number / power);
        if (places == 0) return *this;
        *this << ".";
        for (std::uint64_t rest = number % power; places > 0; --places, rest %= power) {
            power /= 10;
            digits(rest / power);
        }
        return *this;
    }

    char text_[capacity] = {};
    std::size_t size_ = 0;
};

/// What a status says, with the numbers that it has: "the image is too wide (70000, limit 65536)"; "ok" when all is well.
[[nodiscard]] inline Message message(const Status& status) noexcept {
    Message out;
    if (status) return out << "ok";
    out << status.what;
    // Bitwise, so that NaN counts as a number that is there even where compilers are told of finite ones only.
    const bool has_limit = !kit::is_finite(status.limit) || status.limit != 0;
    if (has_limit || !kit::is_finite(status.value) || status.value != 0) {
        out << " (" << status.value;
        if (has_limit) out << ", limit " << status.limit;
        out << ")";
    }
    return out;
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_CORE_MESSAGE_HPP
