#include "hmesh/io/detail/color_shares.hpp"

#include <doctest/doctest.h>

#include <array>
#include <limits>

#include "test_exports.hpp"

TEST_CASE("a mesh without a width, a height or with 2 channels is not exported") {
    using hmesh::detail::check_for_export;
    hmesh::Mesh<3> mesh = hmesh_test::two_faces<3>();
    CHECK(check_for_export(mesh.view()));
    for (const int size : {0, -7}) {
        hmesh::Mesh<3> bad = mesh;
        bad.width = size;
        CHECK(check_for_export(bad.view()).value == size);
        bad = mesh;
        bad.height = size;
        CHECK(check_for_export(bad.view()).value == size);
    }
    const hmesh::Mesh<2> with_alpha = hmesh_test::two_faces<2>();
    CHECK(check_for_export(with_alpha.view()).value == 2);
}

TEST_CASE("shares of the peak are held to [0, 1]") {
    CHECK(hmesh::detail::share_of_peak(51, 255) == 0.2);
    CHECK(hmesh::detail::share_of_peak(-1, 255) == 0);
    CHECK(hmesh::detail::share_of_peak(256, 255) == 1);
    CHECK(hmesh::detail::share_of_peak(std::numeric_limits<float>::max(), 1e-300) == 1);
}

TEST_CASE("every integer of 8 and 16 bits comes back from its share") {
    for (int i = 0; i <= 255; ++i) CHECK(hmesh::detail::to_u8(hmesh::detail::share_of_peak(static_cast<float>(i), 255)) == i);
    int wrong = 0;
    for (int i = 0; i <= 65535; ++i)
        wrong += hmesh::detail::to_u16(hmesh::detail::share_of_peak(static_cast<float>(i), 65535)) != i;
    CHECK(wrong == 0);
}

TEST_CASE("grey is red, green and blue; without alpha a vertex is opaque") {
    using Shares = std::array<double, 4>;
    hmesh::Mesh<1> grey = hmesh_test::two_faces<1>();
    hmesh::Mesh<3> colour = hmesh_test::two_faces<3>();
    hmesh::Mesh<4> alpha = hmesh_test::two_faces<4>();
    grey.peak = colour.peak = alpha.peak = 40;
    CHECK(hmesh::detail::rgba_shares(grey.view(), 1) == Shares{0.25, 0.25, 0.25, 1});
    CHECK(hmesh::detail::rgba_shares(colour.view(), 2) == Shares{0.5, 21.0 / 40, 22.0 / 40, 1});
    CHECK(hmesh::detail::rgba_shares(alpha.view(), 2) == Shares{0.5, 21.0 / 40, 22.0 / 40, 23.0 / 40});
}
