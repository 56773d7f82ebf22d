/// \file
/// ArithmeticCoder: bits of any probability as bytes, and back.
///
/// An interval of 32-bit numbers is divided at each bit as its probability says, and gives off its first byte where both ends
/// agree in it (after M. Mahoney, "Adaptive weighing of context models for lossless data compression", 2005). One class writes
/// and reads, so that what is modelled around it is written down once and the two cannot differ. About 5 ns a bit.
#ifndef HMESH_IO_COMPACT_ARITHMETIC_CODER_HPP
#define HMESH_IO_COMPACT_ARITHMETIC_CODER_HPP

#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

/// Writes bits to a vector, or reads them from memory. Never reads behind the end: there it finds zeros, and counts them.
class ArithmeticCoder {
  public:
    /// One that writes, to a vector that outlives it.
    explicit ArithmeticCoder(std::vector<std::uint8_t>& out) noexcept : out_(&out) {}
    /// One that reads `size` bytes, which outlive it.
    ArithmeticCoder(const std::uint8_t* bytes, std::size_t size) noexcept : begin_(bytes), next_(bytes), end_(bytes + size) {
        for (int k = 0; k < 4; ++k) code_ = code_ << 8 | take();
    }

    /// Whether it writes.
    [[nodiscard]] bool writes() const noexcept { return out_ != nullptr; }
    /// Whether more was read than was there: what it returned last means nothing.
    [[nodiscard]] bool is_exhausted() const noexcept { return missing_ > 4; }

    /// The bytes written, or read so far.
    [[nodiscard]] std::size_t position() const noexcept {
        return writes() ? out_->size() : static_cast<std::size_t>(next_ - begin_);
    }

    /// Codes a bit that is 1 with probability p / 65536, p in [1, 65535]. Returns it, which is `value` where it writes.
    bool bit(bool value, std::uint32_t p) {
        const std::uint32_t range = high_ - low_;
        const std::uint32_t middle = low_ + (range >> 16) * p + (((range & 0xffffU) * p) >> 16);
        if (!writes()) value = code_ <= middle;
        if (value) high_ = middle;
        else low_ = middle + 1;
        while (((low_ ^ high_) & 0xff000000U) == 0) shift();
        return value;
    }
    /// Codes the `count` <= 32 low bits of a number that may be any, the highest first. Returns it.
    std::uint32_t bits(std::uint32_t value, int count) {
        std::uint32_t got = 0;
        while (count-- > 0) {
            // No processor guesses them: without branches they are read in a third of the time.
            const std::uint32_t middle = low_ + (high_ - low_) / 2;
            const std::uint32_t is_one = writes() ? value >> count & 1U : code_ <= middle ? 1U : 0U, ones = 0U - is_one;
            high_ = (middle & ones) | (high_ & ~ones);
            low_ = (low_ & ones) | ((middle + 1) & ~ones);
            got = got << 1 | is_one;
            while (((low_ ^ high_) & 0xff000000U) == 0) shift();
        }
        return got;
    }

    /// Ends what was written: with the fewest bytes, at most 4, that lie in the interval when zeros follow.
    void finish() {
        for (int k = 0; k < tail_size(); ++k) out_->push_back(static_cast<std::uint8_t>(tail() >> (24 - 8 * k)));
    }
    /// Whether what was read ends here as finish() ends it, to the byte.
    [[nodiscard]] bool is_at_end() const noexcept { return next_ == end_ && missing_ + tail_size() == 4 && code_ == tail(); }

  private:
    [[nodiscard]] std::uint32_t take() noexcept {
        if (next_ != end_) return *next_++;
        if (missing_ < 5) ++missing_;
        return 0;
    }
    void shift() {
        if (writes()) out_->push_back(static_cast<std::uint8_t>(high_ >> 24));
        else code_ = code_ << 8 | take();
        low_ <<= 8;
        high_ = high_ << 8 | 0xffU;
    }
    // The first of the interval's numbers that ends in 32 - 8 bytes zeros.
    [[nodiscard]] std::uint64_t rounded(int bytes) const noexcept {
        const std::uint64_t unit = std::uint64_t{1} << (32 - 8 * bytes);
        return (low_ + unit - 1) / unit * unit;
    }
    [[nodiscard]] int tail_size() const noexcept {
        int bytes = 0;
        while (rounded(bytes) > high_) ++bytes;
        return bytes;
    }
    [[nodiscard]] std::uint32_t tail() const noexcept { return static_cast<std::uint32_t>(rounded(tail_size())); }

    std::vector<std::uint8_t>* out_ = nullptr;
    const std::uint8_t *begin_ = nullptr, *next_ = nullptr, *end_ = nullptr;
    std::uint32_t low_ = 0, high_ = 0xffffffffU;
    std::uint32_t code_ = 0;  // of what is read, the 4 bytes at the interval
    int missing_ = 0;         // bytes behind the end that were asked for, at most 5 counted
};

}  // namespace hmesh::detail

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_COMPACT_ARITHMETIC_CODER_HPP
