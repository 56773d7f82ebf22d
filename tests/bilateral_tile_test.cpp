#include "hmesh/methods/hierarchical/bilateral_tile.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

using namespace hmesh::kit::detail;

namespace {

double power(float exponent) {
    std::vector<float> in(float_lanes, exponent), out(float_lanes);
    store_floats(power_of_2(load_floats(in.data())), out.data());
    for (const float value : out) CHECK(value == out[0]);
    return static_cast<double>(out[0]);
}

}  // namespace

TEST_CASE("power_of_2 is within 3e-7 of the power, relatively, from 1 down to 2^-125, and stays there below") {
    double furthest = 0;
    for (double x = 0; x > -125; x -= 0.0117) {
        const auto exponent = static_cast<float>(x);
        furthest = std::max(furthest, std::abs(power(exponent) / std::exp2(static_cast<double>(exponent)) - 1));
    }
    CHECK(furthest < 3e-7);
    for (const float exponent : {-125.0F, -125.5F, -1000.0F, -3e38F}) CHECK(power(exponent) == doctest::Approx(std::exp2(-125)));
}

TEST_CASE("reflect mirrors at the centres of the first and last pixels, again and again") {
    for (const int n : {1, 2, 3, 7})
        for (int i = -50; i <= 50; ++i) {
            int expected = i;
            while (n > 1 && (expected < 0 || expected >= n)) expected = expected < 0 ? -expected : 2 * (n - 1) - expected;
            CHECK(reflect(i, n) == (n == 1 ? 0 : expected));
        }
}

TEST_CASE("a window's pairs and what is opposite are its disc without the center, each tap once") {
    for (const int radius : {0, 1, 2, 4, 7, 49}) {
        const BilateralWindow window(radius, 50, 3);
        std::set<std::pair<int, int>> taps;
        int row = 0;
        for (const BilateralWindow::Pair& pair : window.pairs()) {
            CHECK(pair.dy >= row);
            row = pair.dy;
            CHECK(taps.insert({pair.dx, pair.dy}).second);
            CHECK(taps.insert({-pair.dx, -pair.dy}).second);
            const double exponent = -(pair.dx * pair.dx + pair.dy * pair.dy) / 18.0 / std::log(2.0);
            CHECK(pair.exponent == doctest::Approx(std::max(-125.0, exponent)));
        }
        std::size_t expected = 0;
        for (int dy = -radius; dy <= radius; ++dy)
            for (int dx = -radius; dx <= radius; ++dx) expected += std::hypot(dx, dy) <= radius;
        CHECK(taps.size() + 1 == expected);
    }
}

TEST_CASE("the unit of a window is a power of two, and with the factor it is sigma") {
    for (const double sigma : {1e-3, 0.2, 50.0, 12850.0, 1e15}) {
        const BilateralWindow window(1, sigma, 50);
        int exponent = 0;
        CHECK(std::frexp(window.unit(), &exponent) == 0.5);
        CHECK(window.factor() >= 1);
        CHECK(window.factor() <= 4);
        const double distance = 0.7 * sigma * window.unit();
        CHECK(std::exp2(-window.factor() * distance * distance) == doctest::Approx(std::exp(-0.49 / 2)));
    }
}
