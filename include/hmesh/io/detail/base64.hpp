/// \file
/// Base64Sink: a sink that writes what it takes as base64 text, for files of text that hold bytes.
#ifndef HMESH_IO_DETAIL_BASE64_HPP
#define HMESH_IO_DETAIL_BASE64_HPP

#include <array>
#include <cstddef>
#include <cstdint>

#include "hmesh/io/sink.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

/// Base64 by RFC 4648, section 4: four letters for three bytes, no line breaks. finish() writes the last ones, with padding.
class Base64Sink {
  public:
    /// The text goes to this writer, which outlives the sink.
    explicit Base64Sink(Writer& writer) noexcept : writer_(&writer) {}

    /// Takes all: the writer remembers what its own sink refused.
    bool operator()(const void* bytes, std::size_t size) {
        const auto* from = static_cast<const unsigned char*>(bytes);
        std::array<char, 1024> text;
        std::size_t used = 0;
        for (std::size_t i = 0; i < size; ++i) {
            bits_ = bits_ << 8U | from[i];
            if (++held_ < 3) continue;
            for (std::size_t k = 0; k < 4; ++k) text[used++] = letter(bits_, k);
            bits_ = 0;
            held_ = 0;
            if (used < text.size()) continue;
            writer_->bytes(text.data(), used);
            used = 0;
        }
        writer_->bytes(text.data(), used);
        return true;
    }
    /// Writes the bytes that are left. The next byte begins another text.
    void finish() {
        if (held_ == 0) return;
        std::array<char, 4> text = {'=', '=', '=', '='};
        for (std::size_t k = 0; k <= held_; ++k) text[k] = letter(bits_ << (8 * (3 - held_)), k);
        writer_->bytes(text.data(), text.size());
        bits_ = 0;
        held_ = 0;
    }

  private:
    // The letter of the k-th six of 24 bits.
    [[nodiscard]] static char letter(std::uint32_t bits, std::size_t k) noexcept {
        return "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/"[(bits >> (18 - 6 * k)) & 63U];
    }

    Writer* writer_;
    std::uint32_t bits_ = 0;  // of the bytes held
    std::size_t held_ = 0;    // 0 to 2
};

}  // namespace hmesh::detail

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_DETAIL_BASE64_HPP
