/// \file
/// Wide: as many floats or doubles as fit 32 bytes, for loops over samples.
///
/// With GCC and Clang these are vector-extension types, which become AVX, SSE or NEON registers; with another compiler plain
/// numbers. Like Lanes (core/lanes.hpp) they are passed by reference across calls that are not inlined.
#ifndef HMESH_METHODS_BOUNDED_DETAIL_WIDE_HPP
#define HMESH_METHODS_BOUNDED_DETAIL_WIDE_HPP

#include <cstddef>
#include <cstring>

#include "hmesh/core/compiler.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {
namespace detail {

// One register of numbers of type T, and as many floats.
template <class T>
struct WideBlock {
    using Type = T;
    using Floats = float;
};
#if defined(__GNUC__)
#if defined(__AVX__)
template <>
struct WideBlock<float> {
    using Type = float __attribute__((vector_size(32)));
    using Floats = Type;
};
template <>
struct WideBlock<double> {
    using Type = double __attribute__((vector_size(32)));
    using Floats = float __attribute__((vector_size(16)));
};
#else
template <>
struct WideBlock<float> {
    using Type = float __attribute__((vector_size(16)));
    using Floats = Type;
};
template <>
struct WideBlock<double> {
    using Type = double __attribute__((vector_size(16)));
    using Floats = float __attribute__((vector_size(8)));
};
#endif
#endif

}  // namespace detail

/// 8 floats or 4 doubles; arithmetic is lane by lane.
template <class T>
struct Wide {
    using Block = typename detail::WideBlock<T>::Type;                         ///< the type of one register
    static constexpr int lanes = 32 / static_cast<int>(sizeof(T));             ///< numbers in all
    static constexpr int width = static_cast<int>(sizeof(Block) / sizeof(T));  ///< numbers in a register
    static constexpr int blocks = lanes / width;                               ///< number of registers

    Block block[std::size_t{blocks}];  ///< lane i is in block i / width

    /// The value in all lanes.
    [[nodiscard]] static HMESH_ALWAYS_INLINE Wide all(T value) {
        Wide r;
        for (int k = 0; k < blocks; ++k) r.block[k] = Block{} + value;
        return r;
    }
    /// 0, 1, 2 and so on.
    [[nodiscard]] static HMESH_ALWAYS_INLINE Wide counting() {
        static constexpr T numbers[8] = {0, 1, 2, 3, 4, 5, 6, 7};
        return load(numbers);
    }
    /// Numbers from memory, which need not be aligned.
    [[nodiscard]] static HMESH_ALWAYS_INLINE Wide load(const T* from) {
        Wide r;
        std::memcpy(r.block, from, sizeof r.block);
        return r;
    }
    /// Floats from memory, which need not be aligned, as numbers of type T.
    [[nodiscard]] static HMESH_ALWAYS_INLINE Wide load_floats(const float* from) {
        Wide r;
        for (int k = 0; k < blocks; ++k) {
            typename detail::WideBlock<T>::Floats floats;
            std::memcpy(&floats, from + std::ptrdiff_t{k} * width, sizeof floats);
#if defined(__GNUC__)
            r.block[k] = __builtin_convertvector(floats, Block);
#else
            r.block[k] = static_cast<T>(floats);
#endif
        }
        return r;
    }
    /// Writes all lanes to memory, which need not be aligned.
    HMESH_ALWAYS_INLINE void store(T* to) const { std::memcpy(to, block, sizeof block); }

    /// The sum, lane by lane.
    friend HMESH_ALWAYS_INLINE Wide operator+(const Wide& a, const Wide& b) {
        Wide r;
        for (int k = 0; k < blocks; ++k) r.block[k] = a.block[k] + b.block[k];
        return r;
    }
    /// The difference, lane by lane.
    friend HMESH_ALWAYS_INLINE Wide operator-(const Wide& a, const Wide& b) {
        Wide r;
        for (int k = 0; k < blocks; ++k) r.block[k] = a.block[k] - b.block[k];
        return r;
    }
    /// The product, lane by lane.
    friend HMESH_ALWAYS_INLINE Wide operator*(const Wide& a, const Wide& b) {
        Wide r;
        for (int k = 0; k < blocks; ++k) r.block[k] = a.block[k] * b.block[k];
        return r;
    }
    /// The product with a number.
    friend HMESH_ALWAYS_INLINE Wide operator*(const Wide& a, T b) {
        Wide r;
        for (int k = 0; k < blocks; ++k) r.block[k] = a.block[k] * b;
        return r;
    }
    /// The larger one, lane by lane.
    [[nodiscard]] friend HMESH_ALWAYS_INLINE Wide larger(const Wide& a, const Wide& b) {
        Wide r;
        for (int k = 0; k < blocks; ++k) r.block[k] = a.block[k] > b.block[k] ? a.block[k] : b.block[k];
        return r;
    }
    /// The smaller one, lane by lane.
    [[nodiscard]] friend HMESH_ALWAYS_INLINE Wide smaller(const Wide& a, const Wide& b) {
        Wide r;
        for (int k = 0; k < blocks; ++k) r.block[k] = a.block[k] < b.block[k] ? a.block[k] : b.block[k];
        return r;
    }
    /// The magnitude, lane by lane.
    [[nodiscard]] friend HMESH_ALWAYS_INLINE Wide magnitude(const Wide& a) {
        Wide r;
        for (int k = 0; k < blocks; ++k) r.block[k] = a.block[k] < 0 ? -a.block[k] : a.block[k];
        return r;
    }
    /// In each lane `value` where `key` >= `bound`, else 0.
    [[nodiscard]] friend HMESH_ALWAYS_INLINE Wide where_at_least(const Wide& key, const Wide& bound, const Wide& value) {
        Wide r;
        for (int k = 0; k < blocks; ++k) r.block[k] = key.block[k] >= bound.block[k] ? value.block[k] : Block{};
        return r;
    }
    /// In each lane `value` where `key` < `bound`, else 0.
    [[nodiscard]] friend HMESH_ALWAYS_INLINE Wide where_below(const Wide& key, const Wide& bound, const Wide& value) {
        Wide r;
        for (int k = 0; k < blocks; ++k) r.block[k] = key.block[k] < bound.block[k] ? value.block[k] : Block{};
        return r;
    }

    /// The sum of all lanes.
    [[nodiscard]] HMESH_ALWAYS_INLINE T sum() const {
        T lane[std::size_t{lanes}];
        store(lane);
        T s[4] = {lane[0], lane[1], lane[2], lane[3]};
        for (int k = 4; k < lanes; ++k) s[k % 4] += lane[k];
        return (s[0] + s[2]) + (s[1] + s[3]);
    }
    /// The largest lane.
    [[nodiscard]] HMESH_ALWAYS_INLINE T largest() const {
        T lane[std::size_t{lanes}];
        store(lane);
        T m = lane[0];
        for (int k = 1; k < lanes; ++k) m = lane[k] > m ? lane[k] : m;
        return m;
    }
};

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_BOUNDED_DETAIL_WIDE_HPP
