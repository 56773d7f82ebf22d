#include "hmesh/core/coded_order.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "hmesh/core/array.hpp"
#include "hmesh/core/random.hpp"

using hmesh::kit::code_of;
using hmesh::kit::Coded;
using hmesh::kit::Random;
using hmesh::kit::sorted_numbers;

namespace {

std::vector<std::uint32_t> numbers(const hmesh::kit::Array<Coded>& order) {
    std::vector<std::uint32_t> out;
    for (const Coded& item : order) out.push_back(item.number);
    return out;
}

// What std::stable_sort() makes of the same codes.
template <class Code>
std::vector<std::uint32_t> expected(std::size_t count, Code&& code) {
    std::vector<std::uint32_t> out(count);
    for (std::size_t k = 0; k < count; ++k) out[k] = static_cast<std::uint32_t>(k);
    std::stable_sort(out.begin(), out.end(), [&](std::uint32_t a, std::uint32_t b) { return code(a) < code(b); });
    return out;
}

}  // namespace

TEST_CASE("numbers come by rising code, whatever its bits, and in their order where codes are equal") {
    Random random(1);
    for (const std::size_t count : {0U, 1U, 2U, 9U, 16U, 17U, 300U, 5000U})
        for (const std::uint64_t mask : {std::uint64_t{0}, std::uint64_t{3}, std::uint64_t{0xffffffff},
                                         std::uint64_t{0xff} << 56U, std::uint64_t{0xf0000000f0000001}, ~std::uint64_t{0}}) {
            std::vector<std::uint64_t> codes(count);
            for (std::uint64_t& code : codes) code = code_of(random.next(), random.next()) & mask;
            const auto code = [&](std::uint32_t k) { return codes[k]; };
            REQUIRE(numbers(sorted_numbers(count, code)) == expected(count, code));
        }
}

TEST_CASE("of two codes the second counts where the first is the same") {
    Random random(2);
    const std::size_t count = 2000;
    std::vector<std::uint32_t> first(count), second(count);
    for (std::size_t k = 0; k < count; ++k) {
        first[k] = static_cast<std::uint32_t>(random.below(40));
        second[k] = static_cast<std::uint32_t>(random.below(20)) << 27U;
    }
    const auto order = sorted_numbers(
        count, [&](std::uint32_t k) { return std::uint64_t{first[k]}; },
        [&](std::uint32_t k) { return std::uint64_t{second[k]}; });
    CHECK(numbers(order) == expected(count, [&](std::uint32_t k) { return code_of(first[k], second[k]); }));
}

TEST_CASE("codes of numbers are in their order, and those of 0 and -0 the same") {
    const double infinity = std::numeric_limits<double>::infinity(), most = std::numeric_limits<double>::max();
    const double least = std::numeric_limits<double>::denorm_min();
    const std::vector<double> rising{-infinity, -most,  -2,  -1.5, -1, -1e-300, -least,  0,
                                     least,     1e-300, 0.5, 1,    3,  most,    infinity};
    for (std::size_t k = 0; k + 1 < rising.size(); ++k) CHECK(code_of(rising[k]) < code_of(rising[k + 1]));
    CHECK(code_of(-0.0) == code_of(0.0));
}

TEST_CASE("things are put in the order of numbers") {
    const hmesh::kit::Array<double> things{5, -1, 3};
    const auto order = sorted_numbers(things.size(), [&](std::uint32_t k) { return code_of(things[k]); });
    CHECK((in_order(things, order) == hmesh::kit::Array<double>{-1, 3, 5}));
}
