/// \file
/// Lanes: N doubles that are added and multiplied together. And IntLanes, four integers.
///
/// The channels of a pixel, padded to a size the processor likes, so that the arithmetic of all channels costs that of one.
/// With GCC and Clang the lanes are vector-extension types of 2 or 4 doubles, which become SSE, AVX or NEON registers; with
/// another compiler they are plain doubles.
///
/// Pass Lanes by reference across calls that are not inlined: the vector ABI depends on -mavx, and translation units may differ
/// in it. The layout in memory does not.
#ifndef HMESH_CORE_LANES_HPP
#define HMESH_CORE_LANES_HPP

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>

#include "hmesh/core/compiler.hpp"

#include "hmesh/core/macros/push.hpp"

#if defined(__has_builtin)
#if __has_builtin(__builtin_elementwise_sqrt)
#define HMESH_HAS_ELEMENTWISE_SQRT 1
#endif
#endif
// GCC 12 converts vectors of two numbers one by one, with a dozen instructions where the processor has one.
#if defined(__GNUC__) && !defined(__clang__) && defined(__SSE2__)
#define HMESH_CONVERTS_PAIRS 1
#endif
#if defined(__GNUC__) && (defined(__SSE2__) || defined(__wasm_simd128__))
#define HMESH_HAS_INT_REGISTERS 1
#endif

namespace hmesh::kit {
namespace detail {

// The type of one register, the number of doubles in it, and the type of as many 32-bit integers.
template <int Width>
struct LaneBlock {
    using Type = double;
    static constexpr int width = 1;
};
#if defined(__GNUC__)
template <>
struct LaneBlock<2> {
    using Type = double __attribute__((vector_size(16)));
    using Ints = std::int32_t __attribute__((vector_size(8)));
    static constexpr int width = 2;
};
#if defined(__AVX__)
template <>
struct LaneBlock<4> {
    using Type = double __attribute__((vector_size(32)));
    using Ints = std::int32_t __attribute__((vector_size(16)));
    static constexpr int width = 4;
};
#else
// Two registers, told so: a type of four doubles would live in memory and stall whenever a lane of it is set.
template <>
struct LaneBlock<4> : LaneBlock<2> {};
#endif
#endif

#if defined(HMESH_CONVERTS_PAIRS)
using FourInts = std::int32_t __attribute__((vector_size(16)));
using TwoLongs = long long __attribute__((vector_size(16)));

// Two integers from memory as doubles.
[[nodiscard]] HMESH_ALWAYS_INLINE LaneBlock<2>::Type converted_pair(const std::int32_t* from) {
    long long both;
    std::memcpy(&both, from, sizeof both);
    return __builtin_ia32_cvtdq2pd(reinterpret_cast<FourInts>(TwoLongs{both, 0}));
}
// The first two integers, or the other two, as doubles.
[[nodiscard]] HMESH_ALWAYS_INLINE LaneBlock<2>::Type converted_pair(const FourInts& ints, bool other) {
    return __builtin_ia32_cvtdq2pd(other ? __builtin_shuffle(ints, FourInts{2, 3, 2, 3}) : ints);
}
// Writes two doubles as integers.
HMESH_ALWAYS_INLINE void store_pair(const LaneBlock<2>::Type& numbers, std::int32_t* to) {
    const long long both = reinterpret_cast<TwoLongs>(__builtin_ia32_cvttpd2dq(numbers))[0];
    std::memcpy(to, &both, sizeof both);
}
#endif

}  // namespace detail

struct IntLanes;

/// The number of lanes that holds n values: 1, 2 or the next multiple of 4.
constexpr int lanes_for(int n) { return n <= 2 ? n : (n + 3) / 4 * 4; }

/// N doubles, N = lanes_for(N); arithmetic is lane by lane.
template <int N>
struct Lanes {
    static_assert(N == lanes_for(N), "1, 2 or a multiple of 4 lanes");
    using Block = typename detail::LaneBlock<(N < 4 ? N : 4)>::Type;         ///< the type of one register
    static constexpr int width = detail::LaneBlock<(N < 4 ? N : 4)>::width;  ///< doubles in a register
    static constexpr int blocks = N / width;                                 ///< number of registers

    alignas(N < 4 ? 8 * N : 32) Block block[std::size_t{blocks}];  ///< lane i is in block i / width

    [[nodiscard]] static HMESH_ALWAYS_INLINE Lanes zero() { return Lanes{}; }  ///< 0 in all lanes
    /// The value in all lanes.
    [[nodiscard]] static HMESH_ALWAYS_INLINE Lanes all(double value) {
        Lanes r;
        each([&](std::size_t k) { r.block[k] = value - Block{}; });  // and no sum, which would be computed: -0 + 0 is 0
        return r;
    }
    /// M <= N lanes, and 0 in those above them.
    template <int M>
    [[nodiscard]] static HMESH_ALWAYS_INLINE Lanes extended(const Lanes<M>& o) {
        Lanes r{};
        if constexpr (Lanes<M>::width == width) {  // register by register, so that nothing goes through memory
            each([&](std::size_t k) { r.block[k] = k < std::size_t{Lanes<M>::blocks} ? o.block[k] : Block{}; });
        } else if constexpr (width == 4 && M == 2) {  // likewise; lane by lane a mesh of two channels takes 1.08 of the time
            r.block[0] = Block{o[0], o[1], 0, 0};
        } else {
            for (int i = 0; i < M; ++i) r.set(i, o[i]);
        }
        return r;
    }
    /// N numbers from memory, which need not be aligned.
    [[nodiscard]] static HMESH_ALWAYS_INLINE Lanes load(const double* from) {
        Lanes r;  // register by register: GCC 12 copies two of them at once to the stack first
        each([&](std::size_t k) {
            std::memcpy(&r.block[k], from + std::ptrdiff_t{width} * static_cast<std::ptrdiff_t>(k), sizeof(Block));
        });
        return r;
    }
    /// N integers from memory, which need not be aligned, converted to double.
    [[nodiscard]] static HMESH_ALWAYS_INLINE Lanes load(const std::int32_t* from) {
        Lanes r;
#if defined(HMESH_CONVERTS_PAIRS)
        if constexpr (width == 2) {
            each([&](std::size_t k) { r.block[k] = detail::converted_pair(from + 2 * k); });
            return r;
        }
#endif
#if defined(__GNUC__)
        if constexpr (width > 1) {
            using Ints = typename detail::LaneBlock<(N < 4 ? N : 4)>::Ints;
            for (int k = 0; k < blocks; ++k) {
                Ints ints;
                std::memcpy(&ints, from + std::ptrdiff_t{width} * k, sizeof ints);
                r.block[k] = converted(ints);
            }
            return r;
        }
#endif
        for (int i = 0; i < N; ++i) r.set(i, static_cast<double>(from[i]));
        return r;
    }

    /// The three lower bytes of an integer as they stand in it: byte k times 2^(8 k) in lane k; 0 in the lanes above. N >= 4.
    [[nodiscard]] static HMESH_ALWAYS_INLINE Lanes bytes(std::int32_t from) {
        constexpr std::int32_t mask[std::size_t{N < 4 ? 4 : N}] = {0xff, 0xff00, 0xff0000};
        Lanes r;
#if defined(HMESH_CONVERTS_PAIRS)
        if constexpr (width == 2) {
            const detail::FourInts ints = (detail::FourInts{} + from) & detail::FourInts{mask[0], mask[1], mask[2], 0};
            each([&](std::size_t k) { r.block[k] = k < 2 ? detail::converted_pair(ints, k == 1) : Block{}; });
            return r;
        }
#endif
#if defined(__GNUC__)
        if constexpr (width > 1) {
            using Ints = typename detail::LaneBlock<(N < 4 ? N : 4)>::Ints;
            each([&](std::size_t k) {
                Ints ints;
                std::memcpy(&ints, mask + width * k, sizeof ints);
                ints &= Ints{} + from;
                r.block[k] = converted(ints);
            });
            return r;
        }
#endif
        for (int i = 0; i < N; ++i) r.set(i, static_cast<double>(from & mask[i]));
        return r;
    }

    /// Lane i, 0 <= i < N.
    HMESH_ALWAYS_INLINE double operator[](int i) const {
        if constexpr (width == 1) return block[i];
        else return block[i / width][i % width];
    }
    /// Sets lane i, 0 <= i < N.
    HMESH_ALWAYS_INLINE void set(int i, double value) {
        if constexpr (width == 1) block[i] = value;
        else block[i / width][i % width] = value;
    }
    /// Writes N numbers to memory, which need not be aligned.
    HMESH_ALWAYS_INLINE void store(double* to) const { std::memcpy(to, block, sizeof block); }
    /// Writes N integers to memory, which need not be aligned: the lanes, whole numbers that 32 bits hold.
    HMESH_ALWAYS_INLINE void store(std::int32_t* to) const {
#if defined(HMESH_CONVERTS_PAIRS)
        if constexpr (width == 2) {
            each([&](std::size_t k) { detail::store_pair(block[k], to + 2 * k); });
            return;
        }
#endif
#if defined(__GNUC__)
        if constexpr (width > 1) {
            using Ints = typename detail::LaneBlock<(N < 4 ? N : 4)>::Ints;
            each([&](std::size_t k) {
                Ints ints;
#if defined(__AVX__) && !defined(__clang__)
                if constexpr (width == 4) ints = __builtin_ia32_cvttpd2dq256(block[k]);  // GCC 12 makes four instructions of:
                else
#endif
                    ints = __builtin_convertvector(block[k], Ints);
                std::memcpy(to + width * k, &ints, sizeof ints);
            });
            return;
        }
#endif
        for (int i = 0; i < N; ++i) to[i] = static_cast<std::int32_t>((*this)[i]);
    }

    /// Adds lane by lane.
    HMESH_ALWAYS_INLINE Lanes& operator+=(const Lanes& o) {
        each([&](std::size_t k) { block[k] += o.block[k]; });
        return *this;
    }
    /// Subtracts lane by lane.
    HMESH_ALWAYS_INLINE Lanes& operator-=(const Lanes& o) {
        each([&](std::size_t k) { block[k] -= o.block[k]; });
        return *this;
    }
    /// Multiplies all lanes by a number.
    HMESH_ALWAYS_INLINE Lanes& operator*=(double s) {
        each([&](std::size_t k) { block[k] *= s; });
        return *this;
    }
    /// The sum, lane by lane.
    friend HMESH_ALWAYS_INLINE Lanes operator+(const Lanes& a, const Lanes& b) {
        Lanes r = a;
        return r += b;
    }
    /// The difference, lane by lane.
    friend HMESH_ALWAYS_INLINE Lanes operator-(const Lanes& a, const Lanes& b) {
        Lanes r = a;
        return r -= b;
    }
    /// The product with a number.
    friend HMESH_ALWAYS_INLINE Lanes operator*(const Lanes& a, double s) {
        Lanes r = a;
        return r *= s;
    }
    friend HMESH_ALWAYS_INLINE Lanes operator*(double s, const Lanes& a) { return a * s; }  ///< product with a number
    /// The product, lane by lane.
    friend HMESH_ALWAYS_INLINE Lanes operator*(const Lanes& a, const Lanes& b) {
        Lanes r = a;
        each([&](std::size_t k) { r.block[k] *= b.block[k]; });
        return r;
    }
    /// These lanes, but for one, which is that of others: no number leaves its register.
    template <int lane>
    [[nodiscard]] HMESH_ALWAYS_INLINE Lanes with(const Lanes& others) const {
        Lanes r = *this;
#if defined(__GNUC__)
        if constexpr (width > 1) {
            constexpr int k = lane / width;
            decltype(Block{} < Block{}) is_other{};
            is_other[lane % width] = -1;
            r.block[k] = is_other ? others.block[k] : block[k];
            return r;
        }
#endif
        r.set(lane, others[lane]);
        return r;
    }
    /// The negative of each lane.
    friend HMESH_ALWAYS_INLINE Lanes operator-(const Lanes& a) {
        Lanes r;
        each([&](std::size_t k) { r.block[k] = -a.block[k]; });
        return r;
    }

    /// The magnitude of each lane.
    [[nodiscard]] friend HMESH_ALWAYS_INLINE Lanes abs(const Lanes& a) {
        Lanes r;
#if defined(__GNUC__)
        if constexpr (width > 1) {
            each([&](std::size_t k) { r.block[k] = a.block[k] < 0 ? -a.block[k] : a.block[k]; });
            return r;
        }
#endif
        for (int i = 0; i < N; ++i) r.set(i, std::abs(a[i]));
        return r;
    }
    /// The larger of each pair of lanes; of equal ones, and where one is NaN, that of `a`.
    [[nodiscard]] friend HMESH_ALWAYS_INLINE Lanes max(const Lanes& a, const Lanes& b) {
        Lanes r;
#if defined(__GNUC__)
        if constexpr (width > 1) {
            each([&](std::size_t k) { r.block[k] = a.block[k] < b.block[k] ? b.block[k] : a.block[k]; });
            return r;
        }
#endif
        for (int i = 0; i < N; ++i) r.set(i, a[i] < b[i] ? b[i] : a[i]);
        return r;
    }
    /// The square root of each lane, correctly rounded. Compilers make single ones of a loop over std::sqrt(), because of errno.
    [[nodiscard]] friend HMESH_ALWAYS_INLINE Lanes sqrt(const Lanes& a) {
        Lanes r;
#if defined(HMESH_HAS_ELEMENTWISE_SQRT)
        if constexpr (width > 1) {
            for (int k = 0; k < blocks; ++k) r.block[k] = __builtin_elementwise_sqrt(a.block[k]);
            return r;
        }
#elif defined(__GNUC__) && !defined(__clang__) && defined(__SSE2__)
#if defined(__AVX__)
        if constexpr (width == 4) {
            for (int k = 0; k < blocks; ++k) r.block[k] = __builtin_ia32_sqrtpd256(a.block[k]);
            return r;
        }
#endif
        if constexpr (width == 2) {
            for (int k = 0; k < blocks; ++k) r.block[k] = __builtin_ia32_sqrtpd(a.block[k]);
            return r;
        }
#endif
        for (int i = 0; i < N; ++i) r.set(i, std::sqrt(a[i]));
        return r;
    }

    /// Clamps each lane to [low, high], low <= high.
    HMESH_ALWAYS_INLINE void clamp(double low, double high) {
#if defined(__GNUC__)
        if constexpr (width > 1) {
            const Block lows = Block{} + low, highs = Block{} + high;
            each([&](std::size_t k) {
                block[k] = block[k] < lows ? lows : block[k];
                block[k] = block[k] > highs ? highs : block[k];
            });
            return;
        }
#endif
        for (int i = 0; i < N; ++i) set(i, (*this)[i] < low ? low : ((*this)[i] > high ? high : (*this)[i]));
    }

    /// The sum of all lanes.
    [[nodiscard]] HMESH_ALWAYS_INLINE double sum() const {
        // Four columns of lanes, of which the even and the odd ones are added: the same bits for registers of 2 and of 4.
        if constexpr (width == 4) {
            Block s = block[0];
            each([&](std::size_t k) { s = k > 0 ? s + block[k] : s; });
            return (s[0] + s[2]) + (s[1] + s[3]);
        } else if constexpr (width == 2) {
            Block s[2] = {block[0], Block{}};
            each([&](std::size_t k) { s[k % 2] = k > 0 ? s[k % 2] + block[k] : s[k % 2]; });
            if constexpr (blocks > 1) s[0] += s[1];
            return s[0][0] + s[0][1];
        } else {
            double s = block[0];
            for (int k = 1; k < blocks; ++k) s += block[k];
            return s;
        }
    }

  private:
    friend struct IntLanes;
#if defined(__GNUC__)
    /// Integers as doubles.
    template <class Ints>
    [[nodiscard]] static HMESH_ALWAYS_INLINE Block converted(const Ints& ints) {
#if defined(__AVX__) && !defined(__clang__)
        if constexpr (width == 4) return __builtin_ia32_cvtdq2pd256(ints);  // GCC 12 makes four instructions of:
        else
#endif
            return __builtin_convertvector(ints, Block);
    }
#endif
    /// Calls body(k) for each register. Not in a loop: compilers unroll it long after they begin to keep lanes in registers, and
    /// take half as long again over all that works with lanes.
    template <class Body>
    static HMESH_ALWAYS_INLINE void each(Body&& body) {
        each(body, std::make_index_sequence<std::size_t{blocks}>());
    }
    template <class Body, std::size_t... K>
    static HMESH_ALWAYS_INLINE void each(Body& body, std::index_sequence<K...>) {
        (body(K), ...);
    }
};

/// The scalar product: the sum of the products of lanes.
template <int N>
[[nodiscard]] HMESH_ALWAYS_INLINE double dot(const Lanes<N>& a, const Lanes<N>& b) {
    return (a * b).sum();
}

/// Four 32-bit integers; arithmetic is lane by lane and wraps around.
struct IntLanes {
#if defined(HMESH_HAS_INT_REGISTERS)
    using Block = std::uint32_t __attribute__((vector_size(16)));  ///< the type of the register
    static constexpr bool is_register = true;                      ///< whether all four are added at once
#else
    using Block = std::array<std::uint32_t, 4>;  ///< four numbers
    static constexpr bool is_register = false;   ///< whether all four are added at once
#endif
    Block block;  ///< all lanes, as they are without a sign

    /// 0 in all lanes.
    [[nodiscard]] static HMESH_ALWAYS_INLINE IntLanes zero() { return IntLanes{Block{}}; }
    /// The value in all lanes.
    [[nodiscard]] static HMESH_ALWAYS_INLINE IntLanes all(std::int32_t value) {
        const auto bits = static_cast<std::uint32_t>(value);
        return IntLanes{Block{bits, bits, bits, bits}};
    }
    /// Four integers from memory, which need not be aligned.
    [[nodiscard]] static HMESH_ALWAYS_INLINE IntLanes load(const std::int32_t* from) {
        IntLanes r;
        std::memcpy(&r.block, from, sizeof r.block);
        return r;
    }
    /// In each lane the integers of 16 bits at lower[i] and, in the upper half, at upper[i].
    [[nodiscard]] static HMESH_ALWAYS_INLINE IntLanes halves(const std::int16_t* lower, const std::int16_t* upper) {
#if defined(HMESH_HAS_INT_REGISTERS)
        using Shorts = short __attribute__((vector_size(16)));
        using Pair = std::int64_t __attribute__((vector_size(16)));
        std::int64_t low = 0, high = 0;
        std::memcpy(&low, lower, sizeof low);
        std::memcpy(&high, upper, sizeof high);
        const auto x = reinterpret_cast<Shorts>(Pair{low, 0}), y = reinterpret_cast<Shorts>(Pair{high, 0});
#if defined(__clang__)
        return IntLanes{reinterpret_cast<Block>(__builtin_shufflevector(x, y, 0, 8, 1, 9, 2, 10, 3, 11))};
#else
        return IntLanes{reinterpret_cast<Block>(__builtin_shuffle(x, y, Shorts{0, 8, 1, 9, 2, 10, 3, 11}))};
#endif
#else
        IntLanes r;
        for (std::size_t i = 0; i < 4; ++i) r.block[i] = half_pair(lower[i], upper[i]);
        return r;
#endif
    }
    /// The same two integers of 16 bits in all lanes.
    [[nodiscard]] static HMESH_ALWAYS_INLINE IntLanes halves(int lower, int upper) {
        return all(static_cast<std::int32_t>(half_pair(lower, upper)));
    }
    /// The bytes of an integer, each in a lane, the lowest in the first.
    [[nodiscard]] static HMESH_ALWAYS_INLINE IntLanes bytes(std::int32_t from) {
        const auto bits = static_cast<std::uint32_t>(from);
#if defined(HMESH_HAS_INT_REGISTERS) && defined(__clang__)
        // By way of 16 bits: of what Clang makes of one step, engines of WebAssembly make twenty instructions.
        using Bytes = std::uint8_t __attribute__((vector_size(16)));
        using Words = std::uint16_t __attribute__((vector_size(16)));
        const auto parts = reinterpret_cast<Bytes>(Block{bits, bits, bits, bits});
        const Words words = __builtin_convertvector(__builtin_shufflevector(parts, parts, 0, 1, 2, 3, 4, 5, 6, 7), Words);
        return IntLanes{__builtin_convertvector(__builtin_shufflevector(words, words, 0, 1, 2, 3), Block)};
#elif defined(HMESH_HAS_INT_REGISTERS)
        using Chars = char __attribute__((vector_size(16)));
        using Shorts = short __attribute__((vector_size(16)));
        const auto words = reinterpret_cast<Shorts>(__builtin_ia32_punpcklbw128(reinterpret_cast<Chars>(Block{bits}), Chars{}));
        return IntLanes{reinterpret_cast<Block>(__builtin_ia32_punpcklwd128(words, Shorts{}))};
#else
        return IntLanes{Block{bits & 255U, bits >> 8U & 255U, bits >> 16U & 255U, bits >> 24U}};
#endif
    }

    /// Adds lane by lane.
    HMESH_ALWAYS_INLINE IntLanes& operator+=(const IntLanes& o) {
#if defined(HMESH_HAS_INT_REGISTERS)
        block += o.block;
#else
        for (std::size_t i = 0; i < 4; ++i) block[i] += o.block[i];
#endif
        return *this;
    }
    /// The sum, lane by lane.
    friend HMESH_ALWAYS_INLINE IntLanes operator+(const IntLanes& a, const IntLanes& b) {
        IntLanes r = a;
        return r += b;
    }
    /// The bits that are in both, lane by lane.
    [[nodiscard]] friend HMESH_ALWAYS_INLINE IntLanes operator&(const IntLanes& a, const IntLanes& b) {
        IntLanes r = a;
#if defined(HMESH_HAS_INT_REGISTERS)
        r.block &= b.block;
#else
        for (std::size_t i = 0; i < 4; ++i) r.block[i] &= b.block[i];
#endif
        return r;
    }
    /// Lane by lane the product of the lower halves and that of the upper ones, added: of integers of 16 bits with their signs.
    /// Of numbers from 0 to 2^15 - 1 it is the product.
    [[nodiscard]] friend HMESH_ALWAYS_INLINE IntLanes product_of_halves(const IntLanes& a, const IntLanes& b) {
#if defined(HMESH_HAS_INT_REGISTERS)
        using Shorts = short __attribute__((vector_size(16)));
        const auto x = reinterpret_cast<Shorts>(a.block), y = reinterpret_cast<Shorts>(b.block);
#if defined(__wasm__)
        return IntLanes{reinterpret_cast<Block>(__builtin_wasm_dot_s_i32x4_i16x8(x, y))};
#else
        return IntLanes{reinterpret_cast<Block>(__builtin_ia32_pmaddwd128(x, y))};
#endif
#else
        IntLanes r;
        for (std::size_t i = 0; i < 4; ++i) {
            const std::uint32_t x = a.block[i], y = b.block[i];
            r.block[i] = half(x) * half(y) + half(x >> 16U) * half(y >> 16U);
        }
        return r;
#endif
    }

    /// Writes four integers to memory, which need not be aligned.
    HMESH_ALWAYS_INLINE void store(std::int32_t* to) const { std::memcpy(to, &block, sizeof block); }
    /// Lane i, 0 <= i < 4.
    [[nodiscard]] HMESH_ALWAYS_INLINE std::int32_t operator[](int i) const {
        return static_cast<std::int32_t>(block[static_cast<std::size_t>(i)]);
    }
    /// The lanes as doubles.
    [[nodiscard]] HMESH_ALWAYS_INLINE Lanes<4> doubles() const {
        Lanes<4> r;
#if defined(HMESH_HAS_INT_REGISTERS) && defined(__clang__) && !defined(__AVX__)
        using Ints = std::int32_t __attribute__((vector_size(16)));
        const auto ints = reinterpret_cast<Ints>(block);
        r.block[0] = __builtin_convertvector(__builtin_shufflevector(ints, ints, 0, 1), Lanes<4>::Block);
        const Ints upper = upper_half(ints);
        r.block[1] = __builtin_convertvector(__builtin_shufflevector(upper, upper, 0, 1), Lanes<4>::Block);
#elif defined(HMESH_HAS_INT_REGISTERS) && !defined(__AVX__)
        const auto ints = reinterpret_cast<detail::FourInts>(block);
        r.block[0] = detail::converted_pair(ints, false), r.block[1] = detail::converted_pair(ints, true);
#elif defined(HMESH_HAS_INT_REGISTERS)
        using Ints = std::int32_t __attribute__((vector_size(16)));
        r.block[0] = Lanes<4>::converted(reinterpret_cast<Ints>(block));
#else
        for (int i = 0; i < 4; ++i) r.set(i, (*this)[i]);
#endif
        return r;
    }

  private:
#if defined(HMESH_HAS_INT_REGISTERS) && defined(__clang__)
    /// The upper two of four integers, twice.
    template <class Ints>
    [[nodiscard]] static HMESH_ALWAYS_INLINE Ints upper_half(const Ints& ints) {
#if defined(__wasm__)  // where nobody asks for the other two, Clang takes byte 0 for them, and engines five instructions for one
        using Bytes = signed char __attribute__((vector_size(16)));
        const auto bytes = reinterpret_cast<Bytes>(ints);
        return reinterpret_cast<Ints>(
            __builtin_wasm_shuffle_i8x16(bytes, bytes, 8, 9, 10, 11, 12, 13, 14, 15, 8, 9, 10, 11, 12, 13, 14, 15));
#else
        return __builtin_shufflevector(ints, ints, 2, 3, 2, 3);
#endif
    }
#endif
    /// Two integers of 16 bits, in the halves of one of 32.
    [[nodiscard]] static HMESH_ALWAYS_INLINE std::uint32_t half_pair(int lower, int upper) {
        return (static_cast<std::uint32_t>(upper) << 16U) | (static_cast<std::uint32_t>(lower) & 0xffffU);
    }
    /// The lower half, an integer of 16 bits, with its sign.
    [[nodiscard]] static HMESH_ALWAYS_INLINE std::uint32_t half(std::uint32_t bits) {
        return ((bits & 0xffffU) ^ 0x8000U) - 0x8000U;
    }
};

/// Writes 16 bytes as integers of 16 bits. Neither need be aligned; they must not overlap, which g++ takes for possible of what a
/// loop writes, so that below -O3 it converts them one by one.
HMESH_ALWAYS_INLINE void widen(const std::uint8_t* from, std::int16_t* to) noexcept {
#if defined(HMESH_HAS_INT_REGISTERS)
    using Bytes = std::uint8_t __attribute__((vector_size(16)));
    Bytes bytes;
    std::memcpy(&bytes, from, sizeof bytes);
#if defined(__clang__)
    const Bytes low = __builtin_shufflevector(bytes, Bytes{}, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
    const Bytes high = __builtin_shufflevector(bytes, Bytes{}, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);
#else
    const Bytes low = __builtin_shuffle(bytes, Bytes{}, Bytes{0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23});
    const Bytes high = __builtin_shuffle(bytes, Bytes{}, Bytes{8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31});
#endif
    std::memcpy(to, &low, sizeof low);
    std::memcpy(to + 8, &high, sizeof high);
#else
    for (int i = 0; i < 16; ++i) to[i] = from[i];
#endif
}

}  // namespace hmesh::kit

#undef HMESH_HAS_ELEMENTWISE_SQRT
#undef HMESH_CONVERTS_PAIRS
#undef HMESH_HAS_INT_REGISTERS
#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_CORE_LANES_HPP
