#include "hmesh/mesh/limits.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <limits>

using hmesh::Errc;
using hmesh::MeshLimits;
using hmesh::Status;

namespace {

// The range of a limit is [low, high], and what is out of it is refused by name.
void check_limit(double MeshLimits::*limit, const char* name, double low, double high) {
    const auto with = [limit](double value) {
        MeshLimits limits;
        limits.*limit = value;
        return check(limits);
    };
    CHECK(with(low));
    CHECK(with(high));
    for (const bool is_low : {true, false}) {
        const double bound = is_low ? low : high, beyond = std::nextafter(bound, is_low ? -1e300 : 1e300);
        const Status status = with(beyond);
        CHECK(status.code == Errc::invalid_argument);
        CHECK(std::strstr(status.what, name) != nullptr);
        CHECK(status.value == beyond);
        CHECK(status.limit == bound);
    }
    CHECK(with(std::numeric_limits<double>::quiet_NaN()).code == Errc::invalid_argument);
    CHECK(with(std::numeric_limits<double>::infinity()).code == Errc::invalid_argument);
}

}  // namespace

TEST_CASE("limits are accepted as they are by default and up to their bounds, and refused beyond") {
    CHECK(check(MeshLimits()));
    check_limit(&MeshLimits::min_double_area, "min_double_area", 1e-4, 0.25);
    check_limit(&MeshLimits::border_gap, "border_gap", 1.0 / 256, 0.25);
    check_limit(&MeshLimits::position_step, "position_step", 1.0 / 256, 16);
    check_limit(&MeshLimits::color_overshoot, "color_overshoot", 0, 100);
    check_limit(&MeshLimits::ridge, "ridge", 1e-9, 1);
}

TEST_CASE("the step of positions is a power of two") {
    MeshLimits limits;
    for (limits.position_step = 1.0 / 256; limits.position_step <= 16; limits.position_step *= 2) CHECK(check(limits));
    for (const double step : {1.0 / 255, 0.1, 3.0 / 256, std::nextafter(0.125, 0), std::nextafter(0.125, 1)}) {
        limits.position_step = step;
        const Status status = check(limits);
        CHECK(status.code == Errc::invalid_argument);
        CHECK(std::strstr(status.what, "position_step") != nullptr);
        CHECK(status.value == step);
    }
}
