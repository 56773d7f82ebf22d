// hmesh - Base64Writer: bytes and little-endian numbers as base64 text (RFC 4648, with padding), for files that embed data.
#ifndef HMESH_IO_DETAIL_BASE64_HPP
#define HMESH_IO_DETAIL_BASE64_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>

#include "hmesh/io/sink.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

template <class Sink>
class Base64Writer {
  public:
    explicit Base64Writer(Writer<Sink>& writer) noexcept : writer_(&writer) {}

    void u8(std::uint8_t value) {
        bits_ = bits_ << 8U | value;
        if (++held_ == 3) flush(4);
    }
    void u16(std::uint16_t value) {
        u8(static_cast<std::uint8_t>(value & 0xffU));
        u8(static_cast<std::uint8_t>(value >> 8U));
    }
    void u32(std::uint32_t value) {
        u16(static_cast<std::uint16_t>(value & 0xffffU));
        u16(static_cast<std::uint16_t>(value >> 16U));
    }
    void f32(float value) {
        static_assert(std::numeric_limits<float>::is_iec559 && sizeof(float) == 4, "float is IEEE 754 binary32");
        std::uint32_t bits = 0;
        std::memcpy(&bits, &value, 4);
        u32(bits);
    }
    // Writes what is left. The next byte begins another text.
    void finish() {
        if (held_ == 0) return;
        const std::size_t digits = held_ + 1;
        bits_ <<= 8 * (3 - held_);
        flush(digits);
    }

  private:
    void flush(std::size_t digits) {
        std::array<char, 4> text = {'=', '=', '=', '='};
        for (std::size_t i = 0; i < digits; ++i)
            text[i] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/"[(bits_ >> (18 - 6 * i)) & 63U];
        writer_->bytes(text.data(), text.size());
        bits_ = 0;
        held_ = 0;
    }

    Writer<Sink>* writer_;
    std::uint32_t bits_ = 0;  // of the bytes held
    std::size_t held_ = 0;    // 0 to 2
};

}  // namespace hmesh::detail

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_DETAIL_BASE64_HPP
