#include "hmesh/core/srgb.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "hmesh/io/detail/export_mesh.hpp"

namespace {

using hmesh::kit::linear_to_srgb;
using hmesh::kit::linear_to_srgb_slope;
using hmesh::kit::srgb_to_linear;

// IEC 61966-2-1 as it is printed there.
double decoded(double share) { return share <= 0.04045 ? share / 12.92 : std::pow((share + 0.055) / 1.055, 2.4); }
double encoded(double light) { return light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055; }

}  // namespace

TEST_CASE("sRGB is decoded and encoded as IEC 61966-2-1 has it, to 1e-14 and 1e-12") {
    double worst_light = 0, worst_share = 0;
    for (int i = 0; i <= 20000; ++i) {
        const double x = i / 20000.0;
        worst_light = std::max(worst_light, std::abs(srgb_to_linear(x) - decoded(x)));
        worst_share = std::max(worst_share, std::abs(linear_to_srgb(x) - encoded(x)));
    }
    CHECK(worst_light < 1e-14);
    CHECK(worst_share < 1e-12);
    CHECK(srgb_to_linear(0) == 0);
    CHECK(linear_to_srgb(0) == 0);
    CHECK(linear_to_srgb(-1e-9) == doctest::Approx(-12.92e-9).epsilon(1e-12));  // what rounding may make of 0
    CHECK(hmesh::detail::to_u16(srgb_to_linear(1)) == 65535);
}

TEST_CASE("the slope of the encoding is its difference quotient") {
    for (int i = 1; i < 2000; ++i) {
        const double x = i / 2000.0, h = 1e-5;
        if (std::abs(x - 0.0031308) < h) continue;
        const double quotient = (encoded(x + h) - encoded(x - h)) / (2 * h);
        CHECK(linear_to_srgb_slope(x, encoded(x)) == doctest::Approx(quotient).epsilon(1e-4));
    }
}

TEST_CASE("in 16 bits of linear light all 256 stored values stay apart, to 0.02 of one") {
    for (int i = 0; i <= 255; ++i) {
        const int code = hmesh::detail::to_u16(srgb_to_linear(i / 255.0));
        CHECK(code == std::lround(decoded(i / 255.0) * 65535));
        CHECK(std::abs(linear_to_srgb(code / 65535.0) * 255 - i) < 0.03);
    }
}

TEST_CASE("all channels are light but the last of two and of four, which is alpha") {
    using hmesh::kit::has_alpha;
    using hmesh::kit::is_light;
    for (int channels = 1; channels <= 16; ++channels) {
        CHECK(has_alpha(channels) == (channels == 2 || channels == 4));
        for (int k = 0; k < channels; ++k) CHECK(is_light(k, channels) == !(has_alpha(channels) && k == channels - 1));
    }
}
