#include "hmesh/core/psnr.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

using hmesh::kit::psnr_of_energy;

TEST_CASE("PSNR is 10 log10(peak^2 / MSE) over pixels and channels, infinite without error") {
    CHECK(psnr_of_energy(300.0, 300, 255) == doctest::Approx(20 * std::log10(255.0)));
    CHECK(psnr_of_energy(0.01, 1, 1) == doctest::Approx(20));
    CHECK(psnr_of_energy(100, 1, 1) == doctest::Approx(-20));
    CHECK(psnr_of_energy(65535.0 * 65535.0, 1, 65535) == doctest::Approx(0));
    CHECK(psnr_of_energy(0, 300, 255) == std::numeric_limits<double>::infinity());
    CHECK(psnr_of_energy(-1e-12, 300, 255) == std::numeric_limits<double>::infinity());  // rounding
    CHECK(std::isnan(psnr_of_energy(std::numeric_limits<double>::quiet_NaN(), 300, 255)));
}
