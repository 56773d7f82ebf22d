// hmesh - sinks: where exporters put their bytes, and the small buffered writer that they all use.
//
// A sink is any callable
//
//     bool sink(const void* bytes, std::size_t size)      // size > 0; false: the bytes were refused, ask no more
//
// a lambda around fwrite, std::vector or a socket. hmesh itself opens no file. What the writer puts depends neither on
// the byte order of the machine nor on its locale.
#ifndef HMESH_IO_SINK_HPP
#define HMESH_IO_SINK_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>

#include "hmesh/core/status.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

// Collects bytes and hands them to the sink 4 KiB at a time. After the sink's first refusal everything is dropped.
template <class Sink>
class Writer {
  public:
    explicit Writer(Sink& sink) noexcept : sink_(&sink) {}

    void bytes(const void* from, std::size_t size) {
        const auto* at = static_cast<const unsigned char*>(from);
        while (size > 0) {
            if (used_ == buffer_.size()) flush();
            const std::size_t part = std::min(size, buffer_.size() - used_);
            std::memcpy(buffer_.data() + used_, at, part);
            used_ += part;
            at += part;
            size -= part;
        }
    }

    // --- binary numbers, little-endian ---
    void u8(std::uint8_t value) { bytes(&value, 1); }
    void u16(std::uint16_t value) { little_endian<2>(value); }
    void u32(std::uint32_t value) { little_endian<4>(value); }
    void f32(float value) {
        static_assert(std::numeric_limits<float>::is_iec559 && sizeof(float) == 4, "float is IEEE 754 binary32");
        std::uint32_t bits = 0;
        std::memcpy(&bits, &value, 4);
        u32(bits);
    }

    // --- text ---
    void text(const char* words) { bytes(words, std::strlen(words)); }
    void decimal(std::int64_t value) {
        std::array<char, 20> digits{};  // a sign and the 19 digits of 2^63
        std::size_t at = digits.size();
        auto rest = value < 0 ? 0 - static_cast<std::uint64_t>(value) : static_cast<std::uint64_t>(value);
        do {
            digits[--at] = static_cast<char>('0' + rest % 10);
            rest /= 10;
        } while (rest != 0);
        if (value < 0) digits[--at] = '-';
        bytes(digits.data() + at, digits.size() - at);
    }
    // A finite number with at most `places` <= 9 digits after the point, rounded, without zeros at the end; its magnitude
    // is below 2^53 / 10^places, beyond which it is held to that.
    void fixed(double value, int places) {
        std::int64_t power = 1;
        for (int i = 0; i < places; ++i) power *= 10;
        const double scaled = std::floor(std::abs(value) * static_cast<double>(power) + 0.5);
        std::int64_t rest = static_cast<std::int64_t>(std::min(scaled, 9007199254740992.0));
        if (value < 0 && rest != 0) bytes("-", 1);
        decimal(rest / power);
        rest %= power;
        std::array<char, 10> digits{'.'};
        std::size_t used = rest != 0 ? 1 : 0;
        for (; rest != 0; rest %= power) {
            power /= 10;
            digits[used++] = static_cast<char>('0' + rest / power);
        }
        bytes(digits.data(), used);
    }
    // A finite number with nine significant digits or more, so that a float is read back as itself. Multiples of 1/256 up to
    // 2^22, as vertex positions are, and numbers in [0.1, 2^22) are written plainly and the others with an exponent.
    void real(double value) {
        const double size = std::abs(value);
        // Below 2^22 fixed() is exact for nine places: 2^22 10^9 < 2^52.
        if (size < 4194304 && (size >= 0.1 || size * 256 == std::floor(size * 256))) return fixed(value, 9);
        int exponent = 0;
        double digits = size;  // to [1, 10), off by some 50 roundings at most: 1e-14 of it
        for (; digits >= 10; ++exponent) digits /= 10;
        for (; digits < 1; --exponent) digits *= 10;
        fixed(value < 0 ? -digits : digits, 8);  // 9.999999999 becomes 10, which is as good
        text("e");
        decimal(exponent);
    }

    // Hands over what is left, and says whether the sink took everything; `got` is the number of bytes that it took.
    Status finish() {
        flush();
        if (refused_) return {Errc::write_failed, "the sink refused bytes, after", accepted_, 0};
        return {};
    }

  private:
    template <std::size_t Size>
    void little_endian(std::uint32_t value) {
        std::array<unsigned char, Size> out{};
        for (std::size_t i = 0; i < Size; ++i) out[i] = static_cast<unsigned char>((value >> (8 * i)) & 0xffU);
        bytes(out.data(), Size);
    }
    void flush() {
        if (used_ > 0 && !refused_) {
            if ((*sink_)(static_cast<const void*>(buffer_.data()), used_)) accepted_ += static_cast<std::int64_t>(used_);
            else refused_ = true;
        }
        used_ = 0;
    }

    static_assert(std::is_same_v<bool, std::invoke_result_t<Sink&, const void*, std::size_t>>,
                  "a sink returns a bool, whether it took all bytes: fwrite(...) == size, not the count");

    Sink* sink_;
    std::int64_t accepted_ = 0;
    std::size_t used_ = 0;
    bool refused_ = false;
    std::array<unsigned char, 4096> buffer_;
};

}  // namespace hmesh::detail

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_SINK_HPP
