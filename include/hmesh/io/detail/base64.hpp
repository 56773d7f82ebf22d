/// \file
/// Base64Sink: a sink that writes what it takes as base64 text, for files of text that hold bytes.
#ifndef HMESH_IO_DETAIL_BASE64_HPP
#define HMESH_IO_DETAIL_BASE64_HPP

#include <array>
#include <cstddef>
#include <cstdint>

#include "hmesh/io/sink.hpp"

namespace hmesh::detail {

/// Base64 by RFC 4648, section 4: four letters for three bytes, no line breaks. finish() writes the last ones, with padding.
class Base64Sink {
  public:
    /// The text goes to this writer, which outlives the sink.
    explicit Base64Sink(Writer& writer) noexcept : writer_(&writer) {}

    /// Takes all: the writer remembers what its own sink refused.
    bool operator()(const void* bytes, std::size_t size) {
        const auto* from = static_cast<const unsigned char*>(bytes);
        for (std::size_t i = 0; i < size; ++i) {
            bits_ = bits_ << 8U | from[i];
            if (++held_ == 3) put(4);
        }
        return true;
    }
    /// Writes the bytes that are left. The next byte begins another text.
    void finish() {
        if (held_ == 0) return;
        const std::size_t digits = held_ + 1;
        bits_ <<= 8 * (3 - held_);
        put(digits);
    }

  private:
    void put(std::size_t digits) {
        std::array<char, 4> text = {'=', '=', '=', '='};
        for (std::size_t i = 0; i < digits; ++i)
            text[i] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/"[(bits_ >> (18 - 6 * i)) & 63U];
        writer_->bytes(text.data(), text.size());
        bits_ = 0;
        held_ = 0;
    }

    Writer* writer_;
    std::uint32_t bits_ = 0;  // of the bytes held
    std::size_t held_ = 0;    // 0 to 2
};

}  // namespace hmesh::detail

#endif  // HMESH_IO_DETAIL_BASE64_HPP
