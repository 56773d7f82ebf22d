/// \file
/// Random: a small random number generator that gives the same numbers on every machine.
///
/// PCG-XSH-RR with 64 bits of state and 32 of output (M. O'Neill, "PCG: A family of simple fast space-efficient statistically
/// good algorithms for random number generation", 2014). The distributions of the standard library differ between
/// implementations, so hmesh has two of its own.
#ifndef HMESH_CORE_RANDOM_HPP
#define HMESH_CORE_RANDOM_HPP

#include <cstddef>
#include <cstdint>

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// A PCG-XSH-RR generator: 64 bits of state, 32 of output.
class Random {
  public:
    /// Different streams of one seed are independent sequences: hmesh uses one per patch and phase.
    explicit Random(std::uint64_t seed, std::uint64_t stream = 0) noexcept : increment_((stream << 1U) | 1U) {
        next();
        state_ += seed;
        next();
    }

    /// 32 uniform random bits.
    std::uint32_t next() noexcept {
        const std::uint64_t old = state_;
        state_ = old * 6364136223846793005ULL + increment_;
        const auto shifted = static_cast<std::uint32_t>(((old >> 18U) ^ old) >> 27U);
        const auto turn = static_cast<std::uint32_t>(old >> 59U);
        return (shifted >> turn) | (shifted << ((32U - turn) & 31U));
    }

    /// A uniform random number in (0, 1), never 0, so that its logarithm is finite.
    double uniform() noexcept { return (static_cast<double>(next()) + 0.5) * (1.0 / 4294967296.0); }

    /// A uniform random integer in [0, n), n in [1, 2^32). The bias is below n / 2^32.
    std::size_t below(std::size_t n) noexcept {
        return static_cast<std::size_t>((static_cast<std::uint64_t>(next()) * static_cast<std::uint64_t>(n)) >> 32U);
    }

  private:
    std::uint64_t state_ = 0;
    std::uint64_t increment_;
};

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_CORE_RANDOM_HPP
