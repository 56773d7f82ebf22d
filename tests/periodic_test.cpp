#include "hmesh/mesh/periodic.hpp"

#include <doctest/doctest.h>

using hmesh::Periodic;
using hmesh::kit::modulo;

TEST_CASE("an image repeats along the axes that its name says") {
    CHECK((!hmesh::kit::wraps_x(Periodic::none) && !hmesh::kit::wraps_y(Periodic::none)));
    CHECK((hmesh::kit::wraps_x(Periodic::x) && !hmesh::kit::wraps_y(Periodic::x)));
    CHECK((!hmesh::kit::wraps_x(Periodic::y) && hmesh::kit::wraps_y(Periodic::y)));
    CHECK((hmesh::kit::wraps_x(Periodic::xy) && hmesh::kit::wraps_y(Periodic::xy)));
}

TEST_CASE("a place modulo a period is within the first one, on both sides of 0") {
    for (int x = -20; x <= 20; ++x)
        for (int n = 1; n < 6; ++n) {
            CHECK((modulo(x, n) >= 0 && modulo(x, n) < n));
            CHECK((x - modulo(x, n)) % n == 0);
        }
}
