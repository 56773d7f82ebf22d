#include "hmesh/core/finite.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <limits>

#include "hmesh/core/random.hpp"

TEST_CASE_TEMPLATE("is_finite and is_nan agree with the standard library", T, float, double) {
    using Limits = std::numeric_limits<T>;
    for (const T value : {T(0), T(-1), Limits::min(), Limits::max(), Limits::lowest(), Limits::denorm_min()}) {
        CHECK(hmesh::kit::is_finite(value));
        CHECK(hmesh::kit::is_finite(-value));
    }
    for (const T value : {Limits::infinity(), Limits::quiet_NaN(), Limits::signaling_NaN()}) {
        CHECK_FALSE(hmesh::kit::is_finite(value));
        CHECK_FALSE(hmesh::kit::is_finite(-value));
    }
    hmesh::kit::Random random(1);
    int wrong = 0, wrong_nans = 0, finite = 0;
    for (int i = 0; i < 100000; ++i) {
        std::uint64_t bits = std::uint64_t{random.next()} << 32U | random.next();
        if (i % 2 == 0) bits |= 0x7FE000007F000000U;  // else few would not be finite
        T value = 0;
        std::memcpy(&value, &bits, sizeof value);
        wrong += hmesh::kit::is_finite(value) != std::isfinite(value);
        wrong_nans += hmesh::kit::is_nan(static_cast<double>(value)) != std::isnan(value);
        finite += std::isfinite(value);
    }
    CHECK(wrong == 0);
    CHECK(wrong_nans == 0);
    CHECK(finite > 40000);
    CHECK(finite < 90000);
}

TEST_CASE("numbers made of bits are what they are called") {
    CHECK(hmesh::kit::detail::infinite() == std::numeric_limits<double>::infinity());
    CHECK(std::isnan(hmesh::kit::detail::nan()));
}

TEST_CASE("is_within includes the ends and refuses what is no number") {
    CHECK(hmesh::kit::is_within(0, 0, 1));
    CHECK(hmesh::kit::is_within(1, 0, 1));
    CHECK_FALSE(hmesh::kit::is_within(std::nextafter(1.0, 2.0), 0, 1));
    CHECK_FALSE(hmesh::kit::is_within(-1e-300, 0, 1));
    CHECK_FALSE(hmesh::kit::is_within(std::numeric_limits<double>::quiet_NaN(), 0, 1));
    constexpr double infinity = std::numeric_limits<double>::infinity();
    CHECK_FALSE(hmesh::kit::is_within(infinity, 0, infinity));
}

TEST_CASE("nearest_finite takes infinities alone for the largest doubles") {
    using Limits = std::numeric_limits<double>;
    for (const double value : {0.0, -0.0, 1.5, -2e-310, Limits::max(), Limits::lowest(), Limits::denorm_min()}) {
        CHECK(hmesh::kit::nearest_finite(value) == value);
        CHECK(std::signbit(hmesh::kit::nearest_finite(value)) == std::signbit(value));
    }
    CHECK(hmesh::kit::nearest_finite(Limits::infinity()) == Limits::max());
    CHECK(hmesh::kit::nearest_finite(-Limits::infinity()) == Limits::lowest());
    CHECK(std::isnan(hmesh::kit::nearest_finite(Limits::quiet_NaN())));
}

TEST_CASE("as_float keeps what a float keeps, of neighbours too") {
    const auto stored = [](const std::array<double, 2>& at) {
        return std::array<double, 2>{hmesh::kit::as_float(at[0]), hmesh::kit::as_float(at[1])};
    };
    hmesh::kit::Random random(2);
    int wrong = 0;
    for (int i = 0; i < 1000; ++i) {
        const std::array<double, 2> at = {5e6 * random.uniform(), -random.uniform()}, kept = stored(at);
        for (std::size_t k = 0; k < 2; ++k) {
            const auto nearest = static_cast<float>(at[k]);  // in memory, for std::nextafter()
            const double apart = std::fabs(kept[k] - at[k]);
            for (const float other : {std::nextafter(nearest, -1e9F), nearest, std::nextafter(nearest, 1e9F)})
                wrong += std::fabs(static_cast<double>(other) - at[k]) < apart;
            wrong += static_cast<double>(static_cast<float>(kept[k])) != kept[k];
        }
    }
    CHECK(wrong == 0);
    CHECK(stored({0.1, 0.2})[0] != 0.1);
    CHECK(hmesh::kit::as_float(0.5) == 0.5);
}
