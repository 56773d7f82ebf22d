/// \file
/// Coded order: things sorted by 64-bit codes.
///
/// Whatever is to be sorted is told as numbers with codes, so that there is one sort to compile. It is a radix sort: O(n) for
/// each 11 bits in which codes differ, some 3 ns a number, and things of one code stay in their order.
#ifndef HMESH_CORE_CODED_ORDER_HPP
#define HMESH_CORE_CODED_ORDER_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "hmesh/core/array.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/function_ref.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// Something by its number, and the code that it is sorted by.
struct Coded {
    std::uint64_t code;    ///< the least comes first
    std::uint32_t number;  ///< whatever the caller counts
};

/// A code for numbers of any size: of two that are not NaN, the smaller one has the smaller code, and equal ones have one code.
[[nodiscard]] inline std::uint64_t code_of(double value) noexcept {
    constexpr std::uint64_t sign = std::uint64_t{1} << 63U;
    value += 0.0;  // -0 becomes 0
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    return (bits & sign) != 0 ? ~bits : bits | sign;
}
/// A code for two numbers: the first counts, of equal ones the second.
[[nodiscard]] constexpr std::uint64_t code_of(std::uint32_t first, std::uint32_t second) noexcept {
    return std::uint64_t{first} << 32U | second;
}

/// Sorts by code; items of one code stay in their order.
HMESH_NEVER_INLINE inline void sort_by_code(Array<Coded>& items) {
    if (items.empty()) return;
    std::uint64_t differing = 0;
    for (const Coded& item : items) differing |= item.code ^ items.front().code;
    Array<Coded> sorted(items.size(), raw);
    constexpr unsigned most = 11;
    unsigned digit_bits = most;  // fewer for few items, lest clearing counters takes longest
    while (digit_bits > 4 && items.size() >> (digit_bits - 1) == 0) --digit_bits;
    const unsigned mask = (1U << digit_bits) - 1;
    for (unsigned shift = 0; shift < 64 && (differing >> shift) != 0; shift += digit_bits) {
        if (((differing >> shift) & mask) == 0) continue;
        std::uint32_t start[(1U << most) + 1];
        std::fill_n(start, mask + 2, 0);
        for (const Coded& item : items) ++start[((item.code >> shift) & mask) + 1];
        for (unsigned k = 1; k <= mask; ++k) start[k] += start[k - 1];
        for (const Coded& item : items) sorted[start[(item.code >> shift) & mask]++] = item;
        items.swap(sorted);
    }
}

/// The numbers 0 to count - 1 sorted by their codes, those of one code in their order.
[[nodiscard]] HMESH_NEVER_INLINE HMESH_COLD inline Array<Coded> sorted_numbers(
    std::size_t count, FunctionRef<std::uint64_t(std::uint32_t number)> code) {
    Array<Coded> items(count, raw);
    for (std::uint32_t k = 0; k < count; ++k) items[k] = {code(k), k};
    sort_by_code(items);
    return items;
}
/// The same by two codes, the second of which counts where the first is the same.
[[nodiscard]] HMESH_NEVER_INLINE HMESH_COLD inline Array<Coded> sorted_numbers(
    std::size_t count, FunctionRef<std::uint64_t(std::uint32_t number)> first,
    FunctionRef<std::uint64_t(std::uint32_t number)> second) {
    Array<Coded> items = sorted_numbers(count, second);
    for (Coded& item : items) item.code = first(item.number);
    sort_by_code(items);
    return items;
}

/// The things of these numbers, in their order.
template <class Thing>
[[nodiscard]] Array<Thing> in_order(const Array<Thing>& things, const Array<Coded>& order) {
    Array<Thing> out;
    out.reserve(order.size());
    for (const Coded& item : order) out.push_back(things[item.number]);
    return out;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_CORE_CODED_ORDER_HPP
