/// \file
/// Status: how a function that checks its input reports what is wrong.
///
/// hmesh throws nothing of its own, prints nothing and never aborts; std::bad_alloc passes through (without exceptions, running
/// out of memory ends the program). A Status is a small value that allocates nothing; message() makes a sentence of it,
/// check_ranges() makes one from a table of options.
#ifndef HMESH_CORE_STATUS_HPP
#define HMESH_CORE_STATUS_HPP

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>

#include "hmesh/core/finite.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// Kinds of failure.
enum class Errc : std::uint8_t {
    ok,                   ///< success
    invalid_argument,     ///< a pointer, size, stride or option outside its range
    image_too_large,      ///< more pixels or a longer side than the library addresses
    target_out_of_range,  ///< a number of vertices that the image cannot hold, or a PSNR that no mesh of it reached
    not_finite,           ///< NaN or infinity where a finite number is needed
    write_failed,         ///< a sink refused bytes
    cancelled,            ///< the progress callback returned false
    read_failed,          ///< an image that is not in memory could not be read
};

/// The outcome of a function that checks its input. Converts to true on success.
struct [[nodiscard]] Status {
    Errc code = Errc::ok;    ///< kind of failure
    bool has_value = false;  ///< whether there is an offending number; else the sentence says all
    const char* what = "";   ///< a sentence without numbers, in static memory; empty on success
    double value = 0;        ///< the offending number; of read_failed the columns of the rectangle, by kit::pack_span()
    /// The bound that `value` violates, 0 where there is none to tell; of read_failed the rows.
    double limit = 0;

    /// Success.
    constexpr Status() noexcept = default;
    /// A failure. `sentence` must be in static memory.
    constexpr Status(Errc kind, const char* sentence) noexcept : code(kind), what(sentence) {}
    /// The same with numbers, which are of any arithmetic type (64-bit integers keep 53 bits).
    template <class Value, class Limit = int>
    constexpr Status(Errc kind, const char* sentence, Value offending, Limit bound = 0) noexcept
        : code(kind), has_value(true), what(sentence), value(static_cast<double>(offending)), limit(static_cast<double>(bound)) {}

    /// Whether the outcome is success.
    constexpr explicit operator bool() const noexcept { return code == Errc::ok; }
};

/// Text of at most 255 bytes, zero-terminated; longer text is cut. Allocates nothing.
class Message {
  public:
    [[nodiscard]] const char* c_str() const noexcept { return text_; }  ///< the text, valid as long as the Message
    [[nodiscard]] std::size_t size() const noexcept { return size_; }   ///< length in bytes, without the terminating zero

    /// Appends text.
    Message& operator<<(const char* text) noexcept {
        for (; *text != 0 && size_ + 1 < capacity; ++text) text_[size_++] = *text;
        text_[size_] = 0;
        return *this;
    }
    /// Appends a number in any locale alike: whole numbers below 1e15 with all digits, others with six significant ones.
    Message& operator<<(double number) noexcept {
        if (!kit::is_finite(number)) return *this << "a number that is not finite";
        if (number < 0) *this << "-";
        const double size = std::abs(number);
        if (size < 1e15 && size == std::floor(size)) return digits(static_cast<std::uint64_t>(size));
        int exponent = static_cast<int>(std::floor(std::log10(size)));
        const bool is_plain = exponent >= -5 && exponent < 6;
        // Six significant digits as a whole number, below 10^6 but for rounding, which is as good. By tens: pow() has tables of
        // 4 kB, which a program that is sent to browsers feels.
        double six = size;
        for (int k = exponent; k < 5; ++k) six *= 10;
        for (int k = exponent; k > 5; --k) six /= 10;
        const auto scaled = static_cast<std::uint64_t>(six + 0.5);
        if (is_plain) return fixed(scaled, 5 - exponent);
        fixed(scaled, 5) << "e";
        if (exponent < 0) *this << "-";
        exponent = exponent < 0 ? -exponent : exponent;
        return digits(static_cast<std::uint64_t>(exponent));
    }

  private:
    static constexpr std::size_t capacity = 256;

    /// Appends a whole number with all digits.
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
    /// Appends number / 10^places, without zeros at the end.
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

namespace kit {

/// The status of work that the progress callback cancelled.
[[nodiscard]] inline Status cancelled_by_callback() noexcept { return {Errc::cancelled, "cancelled by the progress callback"}; }
/// The status ok where `is_finished`, else that of a cancellation.
[[nodiscard]] inline Status finished_or_cancelled(bool is_finished) noexcept {
    return is_finished ? Status() : cancelled_by_callback();
}

/// `count` pixels of a row or a column from number `first` on, both in [0, 65536], as one number.
[[nodiscard]] constexpr double pack_span(int first, int count) noexcept { return first * 131072.0 + count; }
/// The first pixel of such a number.
[[nodiscard]] inline int span_first(double span) noexcept { return static_cast<int>(span / 131072); }
/// The number of pixels of such a number.
[[nodiscard]] inline int span_count(double span) noexcept { return static_cast<int>(span - 131072.0 * span_first(span)); }

}  // namespace kit

/// The sentence of a status with its numbers, as in "the image is too wide (70000, limit 65536)"; "ok" on success.
[[nodiscard]] inline Message message(const Status& status) noexcept {
    Message out;
    if (status) return out << "ok";
    out << status.what;
    if (status.code == Errc::read_failed) {
        const auto span = [&](double of) -> Message& {
            const int first = kit::span_first(of);
            return out << static_cast<double>(first) << " to " << static_cast<double>(first + kit::span_count(of) - 1);
        };
        out << " (columns ";
        span(status.value) << " of rows ";
        return span(status.limit) << ")";
    }
    // Bitwise, so that NaN counts as a number that is there even where compilers are told of finite ones only.
    const bool has_limit = !kit::is_finite(status.limit) || status.limit != 0;
    if (status.has_value) {
        out << " (" << status.value;
        if (has_limit) out << ", limit " << status.limit;
        out << ")";
    }
    return out;
}

namespace kit {

/// An option and the values that it may have, for check_ranges().
struct Range {
    const char* what;  ///< sentence for the user: what the option must be
    double value,      ///< value of the option
        low,           ///< smallest value allowed
        high;          ///< largest value allowed
};

/// invalid_argument for the first option that is outside its range, with the bound that it violates (NaN and infinities:
/// `high`).
[[nodiscard]] inline Status check_ranges(std::initializer_list<Range> ranges) noexcept {
    for (const Range& range : ranges)
        if (!is_within(range.value, range.low, range.high)) {
            const bool is_low = is_finite(range.value) && range.value < range.low;
            return {Errc::invalid_argument, range.what, range.value, is_low ? range.low : range.high};
        }
    return {};
}

}  // namespace kit
}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_CORE_STATUS_HPP
