#include "hmesh/core/status.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>

using hmesh::Errc;
using hmesh::Status;
using hmesh::kit::check_ranges;

TEST_CASE("options in their ranges, ends included, are accepted, and so are none at all") {
    CHECK(check_ranges({}));
    CHECK(check_ranges({{"a must be in [1, 2]", 1, 1, 2}, {"b must be in [1, 2]", 2, 1, 2}, {"c must be 0", 0, 0, 0}}));
}

TEST_CASE("an option out of its range is named, with its value and the bound that it missed") {
    const Status low = check_ranges({{"a must be in [1, 2]", std::nextafter(1.0, 0.0), 1, 2}});
    CHECK(low.code == Errc::invalid_argument);
    CHECK(std::string(low.what) == "a must be in [1, 2]");
    CHECK(low.value == std::nextafter(1.0, 0.0));
    CHECK(low.limit == 1);
    const Status high = check_ranges({{"a must be in [1, 2]", std::nextafter(2.0, 3.0), 1, 2}});
    CHECK(high.code == Errc::invalid_argument);
    CHECK(high.value == std::nextafter(2.0, 3.0));
    CHECK(high.limit == 2);
}

TEST_CASE("of several options the first that is wrong is named") {
    const Status status = check_ranges({{"a must be in [0, 1]", 0.5, 0, 1},
                                        {"b must be in [0, 1]", -3, 0, 1},
                                        {"c must be in [0, 1]", std::numeric_limits<double>::quiet_NaN(), 0, 1}});
    CHECK(std::string(status.what) == "b must be in [0, 1]");
    CHECK(status.value == -3);
    CHECK(status.limit == 0);
}

TEST_CASE("what is not finite is in no range, not even in one without ends, and misses the upper bound") {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), infinity, -infinity}) {
        const Status status = check_ranges({{"a must be in [0, 1]", bad, 0, 1}});
        CHECK(status.code == Errc::invalid_argument);
        CHECK((std::isnan(bad) ? std::isnan(status.value) : status.value == bad));
        CHECK(status.limit == 1);
        CHECK_FALSE(check_ranges({{"a must be a number", bad, -infinity, infinity}}));
    }
}
