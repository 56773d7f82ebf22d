/// \file
/// Sink: where exporters put their bytes. And the buffered writer that they all use.
///
/// hmesh itself opens no file. What the writer puts depends neither on the byte order of the machine nor on its locale.
#ifndef HMESH_IO_SINK_HPP
#define HMESH_IO_SINK_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>

#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/status.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// Takes the bytes of a file, piece after piece, `size` > 0 of them a call: any callable of this signature, such as a lambda
/// around fwrite(), a std::vector or a socket. False says that the bytes were refused: the sink is called no more, and the
/// exporter returns Errc::write_failed with the number of bytes that were taken. The callable must live until the exporter
/// returns; the bytes may be read until the sink does. What returns another type than bool, as fwrite() does, does not compile.
using Sink = FunctionRef<bool(const void* bytes, std::size_t size)>;

namespace kit {

/// What a sink may refer to that appends all it is given to `bytes`, a std::string or a vector of bytes, which must outlive it:
/// write_ply(mesh, append_to(bytes)).
template <class Bytes>
[[nodiscard]] auto append_to(Bytes& bytes) noexcept {
    using Byte = typename Bytes::value_type;
    static_assert(sizeof(Byte) == 1, "bytes are appended to a container of bytes");
    return [&bytes](const void* from, std::size_t size) {
        const auto* const first = static_cast<const Byte*>(from);
        bytes.insert(bytes.end(), first, first + size);
        return true;
    };
}

}  // namespace kit

namespace detail {

/// Puts bytes, numbers and words into a sink, 4 KiB at a time. After the sink's first refusal everything is dropped.
class Writer {
  public:
    /// What the sink refers to must outlive the writer.
    explicit Writer(Sink sink) noexcept : sink_(sink) {}

    /// Puts bytes as they are.
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
    /// Puts an integer of 8 bits.
    void u8(std::uint8_t value) { bytes(&value, 1); }
    /// Puts an integer of 16 bits.
    void u16(std::uint16_t value) { little_endian<2>(value); }
    /// Puts an integer of 32 bits.
    void u32(std::uint32_t value) { little_endian<4>(value); }
    /// Puts a number as IEEE 754 binary32.
    void f32(float value) {
        static_assert(std::numeric_limits<float>::is_iec559 && sizeof(float) == 4, "float is IEEE 754 binary32");
        std::uint32_t bits = 0;
        std::memcpy(&bits, &value, 4);
        u32(bits);
    }

    // --- text ---
    /// Puts a text that ends with a zero, without the zero.
    void text(const char* words) { bytes(words, std::strlen(words)); }
    /// Puts an integer in decimal digits.
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
    /// Puts a finite number with at most `places` <= 9 digits after the point, rounded, without zeros at the end. Magnitudes
    /// above 2^53 / 10^places are held to that.
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
    /// Puts a finite number with nine significant digits or more, so that a float is read back as itself. Multiples of 1/256
    /// up to 2^22, as vertex positions are, and numbers in [0.1, 2^22) are put plainly, the others with an exponent.
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

    /// The number of bytes that were put so far, whether the sink took them or not: where the next one stands in the file.
    [[nodiscard]] std::int64_t position() const noexcept { return flushed_ + static_cast<std::int64_t>(used_); }

    /// Hands over what is left, and says whether the sink took everything. If not: Errc::write_failed, and how many bytes it
    /// took.
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
        if (used_ == 0) return;
        const auto size = static_cast<std::int64_t>(used_);
        refused_ = refused_ || !sink_(buffer_.data(), used_);
        if (!refused_) accepted_ += size;
        flushed_ += size;
        used_ = 0;
    }

    Sink sink_;
    std::int64_t flushed_ = 0, accepted_ = 0;
    std::size_t used_ = 0;
    bool refused_ = false;
    std::array<unsigned char, 4096> buffer_;
};

}  // namespace detail
}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_SINK_HPP
