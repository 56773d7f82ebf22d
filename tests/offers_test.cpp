#include "hmesh/outline/offers.hpp"

#include <doctest/doctest.h>

#include <cstdint>
#include <limits>
#include <utility>

using hmesh::kit::detail::Offers;

TEST_CASE("the cheapest offer comes first, and of a corner the last one counts") {
    Offers offers(4);
    CHECK_FALSE(offers.take_out());
    for (const std::uint32_t corner : {0U, 1U, 2U, 3U}) offers.add(corner, 4.0 - corner);
    offers.add(0, 0.5);
    offers.add(2, 7);
    offers.take_back(3);
    CHECK(offers.least_price() == 0.5);
    for (const auto& [corner, price] : {std::pair{0U, 0.5}, {1U, 3.0}, {2U, 7.0}}) {
        const auto best = offers.take_out();
        REQUIRE(best);
        CHECK(best->corner == corner);
        CHECK(best->price == price);
    }
    CHECK_FALSE(offers.take_out());
}

TEST_CASE("of equal offers the one with the least corner comes first, and none that waits has no price") {
    Offers offers(40);
    CHECK(offers.least_price() == std::numeric_limits<double>::max());
    for (std::uint32_t i = 0; i < 40; ++i) offers.add(i * 7 % 40, 1.5);
    for (std::uint32_t i = 0; i < 40; ++i) {
        const auto best = offers.take_out();
        REQUIRE(best);
        CHECK(best->corner == i);
    }
    CHECK(offers.least_price() == std::numeric_limits<double>::max());
}
