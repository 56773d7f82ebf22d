/// \file
/// AdaptiveBit and Mixer: how probable it is that the next bit is 1, learnt from the bits before it in its contexts.
///
/// A context is a place in a table that holds how often its bits were 1. Several contexts of a bit are mixed in the logistic
/// domain, ln(p / (1 - p)), with weights that learn which of them to believe (M. Mahoney, 2005). All numbers are integers, so
/// that every processor computes the same: probabilities in 2^16ths or finer, logarithms in 256ths. About 15 ns a bit of five
/// contexts.
#ifndef HMESH_IO_COMPACT_MIXER_HPP
#define HMESH_IO_COMPACT_MIXER_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/io/compact/arithmetic_coder.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

/// A probability that follows the bits of its context: 22 bits of it, and 10 that count the bits seen, up to `most_seen`.
class AdaptiveBit {
  public:
    AdaptiveBit() = default;  ///< that has seen nothing
    /// As after `seen` <= 160 bits, with the probability p16 in 2^-16, in [1, 65535].
    AdaptiveBit(std::uint32_t p16, std::uint32_t seen) noexcept : state_(p16 << 16 | seen) {}

    /// How many bits it has seen; of more than 160, that.
    [[nodiscard]] std::uint32_t seen() const noexcept { return state_ & 1023U; }
    /// The probability of a 1, in 2^-12.
    [[nodiscard]] std::uint32_t p12() const noexcept { return state_ >> 20; }
    /// The probability of a 1 in 2^-16, in [1, 65535].
    [[nodiscard]] std::uint32_t p16() const noexcept {
        const std::uint32_t p = state_ >> 16;
        return p == 0 ? 1 : p;
    }
    /// Moves toward a bit that was seen, by 1 / (n + 3/2) of the way after n others.
    void learn(bool bit) noexcept {
        const std::uint32_t seen = state_ & 1023U;
        const std::uint32_t p = state_ >> 10, gap = bit ? 4194303 - p : p, way = gap / 8 * shares[seen] / 1024;
        state_ = (bit ? p + way : p - way) << 10 | (seen < most_seen ? seen + 1 : seen);
    }
    /// Codes a bit by this context alone.
    bool code(ArithmeticCoder& coder, bool value) {
        value = coder.bit(value, p16());
        learn(value);
        return value;
    }

  private:
    static constexpr std::uint32_t most_seen = 160;
    // 16384 / (2 n + 3), rounded down.
    static constexpr auto shares = [] {
        std::array<std::uint32_t, most_seen + 1> table{};
        for (std::size_t n = 0; n < table.size(); ++n) table[n] = static_cast<std::uint32_t>(16384 / (2 * n + 3));
        return table;
    }();
    std::uint32_t state_ = std::uint32_t{1} << 31;
};

/// The logistic function and its inverse, as tables.
class Logistic {
  public:
    /// Makes the tables: some 10 us.
    Logistic() noexcept {
        int s = -limit;
        for (std::uint32_t k = 0; k < inverse_.size(); ++k) {
            while (s < limit && probability(s) < 16 * k + 8) ++s;
            inverse_[k] = static_cast<std::int16_t>(s);
        }
    }
    /// The largest logarithm, 11 in 256ths.
    static constexpr int limit = 2816;
    /// 65536 / (1 + e^(-s / 256)), in [1, 65535]: between every 64 of s by a straight line.
    [[nodiscard]] static std::uint32_t probability(int s) noexcept {
        // 65536 / (1 + e^(-k / 4)), rounded, for k = 0 .. 44.
        static constexpr std::array<std::uint16_t, 45> table{
            32768, 36843, 40793, 44511, 47911, 50941, 53581, 55834, 57724, 59287, 60565, 61598, 62428, 63090, 63615,
            64030, 64357, 64614, 64816, 64974, 65097, 65194, 65269, 65328, 65374, 65410, 65438, 65459, 65476, 65489,
            65500, 65508, 65514, 65519, 65523, 65526, 65528, 65530, 65531, 65532, 65533, 65534, 65534, 65535, 65535};
        const int size = s < 0 ? -s : s;
        if (size >= limit) return s < 0 ? 1 : 65535;
        const auto k = static_cast<std::size_t>(size / 64);
        const auto rest = static_cast<std::uint32_t>(size % 64);
        const std::uint32_t p = (table[k] * (64 - rest) + table[k + 1] * rest) / 64;
        return s < 0 ? 65536 - p : p;
    }
    /// 256 ln(p / (1 - p)) of a probability in 2^-12.
    [[nodiscard]] int logarithm(std::uint32_t p12) const noexcept { return inverse_[p12]; }

  private:
    std::array<std::int16_t, 4096> inverse_{};
};

/// Mixes the contexts of a bit. `Inputs` of them at most.
template <std::size_t Inputs>
class Mixer {
  public:
    /// With so many sets of weights, each of which learns by itself.
    Mixer(const Logistic& logistic, std::size_t sets, std::int32_t first_weight)
        : logistic_(&logistic), weights_(sets * Inputs, first_weight) {}

    /// The probability in 2^-16 that a bit in these contexts is 1, as code() would have it.
    [[nodiscard]] std::uint32_t probability(const std::array<AdaptiveBit*, Inputs>& contexts, std::size_t set) const noexcept {
        std::int64_t sum = 0;
        for (std::size_t k = 0; k < Inputs; ++k)
            sum += std::int64_t{logistic_->logarithm(contexts[k]->p12())} * weights_[set * Inputs + k];
        return Logistic::probability(held(sum / 65536));
    }

    /// Codes a bit in these contexts with a set of weights, and lets all learn.
    bool code(ArithmeticCoder& coder, bool value, const std::array<AdaptiveBit*, Inputs>& contexts, std::size_t set) {
        std::int32_t* const weights = weights_.data() + set * Inputs;
        std::array<int, Inputs> logs{};
        std::int64_t sum = 0;
        for (std::size_t k = 0; k < Inputs; ++k) {
            logs[k] = logistic_->logarithm(contexts[k]->p12());
            sum += std::int64_t{logs[k]} * weights[k];
        }
        const std::uint32_t p = Logistic::probability(held(sum / 65536));
        value = coder.bit(value, p);
        const std::int32_t error = (value ? 65536 : 0) - static_cast<std::int32_t>(p);
        for (std::size_t k = 0; k < Inputs; ++k) {
            const std::int32_t w = weights[k] + logs[k] * error / 16384;
            weights[k] = w > most ? most : w < -most ? -most : w;
        }
        for (std::size_t k = 0; k < Inputs; ++k) contexts[k]->learn(value);
        return value;
    }
    /// The weights, in 2^-16: of each set, one for each context.
    [[nodiscard]] std::vector<std::int32_t>& weights() noexcept { return weights_; }

  private:
    [[nodiscard]] static int held(std::int64_t s) noexcept {
        return s > Logistic::limit ? Logistic::limit : s < -Logistic::limit ? -Logistic::limit : static_cast<int>(s);
    }
    static constexpr std::int32_t most = 524288;
    const Logistic* logistic_;
    std::vector<std::int32_t> weights_;  // in 2^-16
};

}  // namespace hmesh::detail

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IO_COMPACT_MIXER_HPP
