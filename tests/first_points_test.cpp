#include "hmesh/methods/annealed/first_points.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "test_executors.hpp"
#include "test_images.hpp"
#include "test_meshes.hpp"

namespace kit = hmesh::kit;
using hmesh::Image;
using hmesh::kit::ImageSource;
using hmesh::kit::point_density;
using hmesh::kit::point_ranks;

namespace {

using Points = std::vector<std::uint32_t>;

Points masked_points(const Image<float, 1>& density, std::size_t count, const hmesh::ParallelFor& parallel_for = {}) {
    return hmesh::kit::first_points(point_ranks(density, parallel_for), count, parallel_for);
}

template <int C>
Points points_of(const ImageSource<C>& source, std::size_t count, const hmesh::ParallelFor& parallel_for = {}) {
    const Image<float, 1> density = point_density(source, parallel_for);
    for (std::size_t k = 0; k < density.size(); ++k) REQUIRE((density.data()[k] > 0 && std::isfinite(density.data()[k])));
    return masked_points(density, count, parallel_for);
}
template <class T, int C>
Points points_of(const Image<T, C>& image, std::size_t count) {
    return points_of(ImageSource<C>(image.view()), count);
}

// Exactly `count` pixels, each once, row by row.
void check_points(const Points& points, std::size_t count, std::size_t pixels) {
    REQUIRE(points.size() == count);
    CHECK(std::adjacent_find(points.begin(), points.end(), [](std::uint32_t a, std::uint32_t b) { return a >= b; }) ==
          points.end());
    if (count > 0) CHECK(points.back() < pixels);
}
template <class T, int C>
void check_every_count(const Image<T, C>& image) {
    const ImageSource<C> source(image.view());
    const auto pixels = static_cast<std::size_t>(source.pixels());
    for (std::size_t count = 0; count <= pixels; ++count) check_points(points_of(source, count), count, pixels);
}

}  // namespace

TEST_CASE("there are exactly as many points as asked for, for every number from none to all pixels") {
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 2}, {2, 1}, {1, 17}, {23, 1}, {2, 2}, {3, 3}, {9, 35}}) {
        check_every_count(hmesh_test::noise<std::uint8_t, 3>(width, height, 1));
        check_every_count(hmesh_test::constant_image<std::uint8_t, 1>(width, height, 0.4));
        check_every_count(hmesh_test::affine_image<float, 2>(width, height));
        check_every_count(hmesh_test::checkerboard<std::uint16_t, 1>(width, height, 1));
    }
}

TEST_CASE("of pixels whose ratios are equal, the first are taken") {
    // As float the mask has ties in a million pixels; a density that falls as the mask makes all of them equal.
    Image<float, 1> even(1024, 1024);
    std::fill(even.data(), even.data() + even.size(), 1.0F);
    for (const std::size_t count : {1U, 12345U, 999999U, 1048575U}) check_points(masked_points(even, count), count, even.size());
    Image<float, 1> masked(40, 30);
    for (int y = 0; y < 30; ++y)
        for (int x = 0; x < 40; ++x) *masked.pixel(x, y) = static_cast<float>((kit::detail::mask_at(x, y) + 1e-6) * 0x1p-20);
    const Image<float, 1> ratios = point_ranks(masked);
    const auto [least, most] = std::minmax_element(ratios.data(), ratios.data() + ratios.size());
    REQUIRE(*most - *least <= 0.25F);  // a few last bits of 2^20
    for (std::size_t count = 0; count <= 1200; count += 7) check_points(masked_points(masked, count), count, 1200);
}

TEST_CASE("floats of any size, and weights of 0 in a part or everywhere, give the exact number") {
    const auto scene = hmesh_test::scene<float, 3>(40, 36, 3);
    for (const double factor : {1e-45, 1e-38, 1e-20, 1.0, 1e20, 1e37, 3e38}) {
        const auto image = hmesh_test::scaled(scene, factor);
        for (const std::size_t count : {1U, 50U, 1000U, 1440U}) check_points(points_of(image, count), count, 1440);
    }
    // A power of two changes no point.
    CHECK(points_of(hmesh_test::scaled(scene, 0x1p40), 200) == points_of(scene, 200));
    const float highest = std::numeric_limits<float>::max();
    const auto wild = hmesh_test::draw<float, 1>(
        20, 16, [&](int x, int y, int) { return (x + y) % 2 == 0 ? double{highest} : -double{highest}; });
    for (const std::size_t count : {1U, 160U, 320U}) check_points(points_of(wild, count), count, 320);
    for (const float outside : {0.0F, 1.0F, 1e30F}) {
        Image<float, 1> weights(40, 36);
        for (int y = 0; y < 36; ++y)
            for (int x = 0; x < 40; ++x) *weights.pixel(x, y) = x < 20 ? 0.0F : outside;
        const ImageSource<3> source(scene.view(), weights.view());
        for (const std::size_t count : {1U, 50U, 1000U, 1440U}) check_points(points_of(source, count), count, 1440);
        if (outside == 0) continue;
        const Points points = points_of(source, 200);
        CHECK(std::count_if(points.begin(), points.end(), [](std::uint32_t p) { return p % 40 < 20; }) < 60);
    }
}

TEST_CASE("the unit of weights changes no point, however large or small they are") {
    const auto scene = hmesh_test::scaled(hmesh_test::scene<float, 3>(40, 36, 3), 0x1p60);
    const auto points = [&](double unit) {
        const auto weights = hmesh_test::draw<float, 1>(40, 36, [&](int x, int, int) { return x < 20 ? 0.25 * unit : unit; });
        return points_of(ImageSource<3>(scene.view(), weights.view(), kit::weight_unit(weights.view())), 200);
    };
    const Points usual = points(1);
    for (const double unit : {0x1p-147, 0x1p-120, 0x1p-30, 0x1p40, 0x1p127}) {
        CAPTURE(unit);
        CHECK(points(unit) == usual);
    }
}

TEST_CASE("points are dense where the image bends, few where it is flat or a slope, and more where pixels count more") {
    // A wave in the right half, a slope in the left.
    const auto image = hmesh_test::draw<std::uint8_t, 1>(
        200, 100, [](int x, int y, int) { return x < 100 ? 0.004 * x : 0.5 + 0.4 * std::sin(0.7 * x) * std::sin(0.5 * y); });
    const auto right_of = [](const Points& points) {
        return std::count_if(points.begin(), points.end(), [](std::uint32_t p) { return p % 200 >= 100; });
    };
    const Points points = points_of(image, 1000);
    CHECK(right_of(points) > 800);
    CHECK(right_of(points) < 1000 - 20);  // the slope is not without points
    // Of a wave all over, the half that counts 16 times as much gets 4^(3/4) = 2.8 times as many.
    const auto wave = hmesh_test::draw<std::uint8_t, 1>(
        200, 100, [](int x, int y, int) { return 0.5 + 0.4 * std::sin(0.7 * x) * std::sin(0.5 * y); });
    Image<float, 1> weights(200, 100);
    for (int y = 0; y < 100; ++y)
        for (int x = 0; x < 200; ++x) *weights.pixel(x, y) = x < 100 ? 1.0F : 16.0F;
    CHECK(std::abs(right_of(points_of(wave, 1000)) - 500) < 30);
    const auto heavy = right_of(points_of(ImageSource<1>(wave.view(), weights.view()), 1000));
    CHECK(heavy > 650);
    CHECK(heavy < 800);
}

TEST_CASE("points are the same for any executor, for any stride and in any other place of memory") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(70, 131, 5);  // several bands of rows
    const Points points = points_of(image, 900);
    const ImageSource<3> source(image.view());
    CHECK(points_of(source, 900, hmesh_test::ReverseFor{}) == points);
    CHECK(points_of(source, 900, hmesh_test::ShuffledFor{3}) == points);
    CHECK(points_of(source, 900, hmesh_test::ThreadFor{5}) == points);
    Image<std::uint8_t, 3> wide(101, 131);
    for (int y = 0; y < 131; ++y) std::copy_n(image.pixel(0, y), 3 * 70, wide.pixel(0, y));
    hmesh::ImageView<std::uint8_t, 3> part = wide.view();
    part.width = 70;
    part.row_stride = 3 * 101;
    CHECK(points_of(ImageSource<3>(part), 900) == points);
}

TEST_CASE("the mask is laid over bands of rows by any executor") {
    for (const auto& [width, height] : {std::pair{400, 500}, {70000, 3}, {2, 70000}}) {
        Image<float, 1> density(width, height);
        for (std::size_t k = 0; k < density.size(); ++k) density.data()[k] = 1 + static_cast<float>(k % 7);
        for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{40000}, density.size()}) {
            const Points points = masked_points(density, count);
            check_points(points, count, density.size());
            CHECK(masked_points(density, count, hmesh_test::ThreadFor{3}) == points);
        }
    }
}

TEST_CASE("more points are the same ones and others") {
    const auto image = hmesh_test::scene<std::uint8_t, 1>(60, 50, 5);
    Points before;
    for (const std::size_t count : {10U, 11U, 300U, 2000U, 3000U}) {
        const Points points = points_of(image, count);
        CHECK(std::includes(points.begin(), points.end(), before.begin(), before.end()));
        before = points;
    }
}

TEST_CASE("the mask is evenly distributed: all squares of an even density hold about as many points") {
    Image<float, 1> density(256, 256);
    std::fill(density.data(), density.data() + density.size(), 1.0F);
    for (const std::size_t count : {1024U, 4096U, 16384U}) {
        const Points points = masked_points(density, count);
        check_points(points, count, 65536);
        for (const std::uint32_t side : {32U, 64U, 128U}) {
            std::vector<double> held((256 / side) * (256 / side), 0.0);
            for (const std::uint32_t p : points) held[p / 256 / side * (256 / side) + p % 256 / side] += 1;
            const double mean = static_cast<double>(count) / static_cast<double>(held.size());
            // Points at random would be off by 3 sqrt(mean) somewhere; these by about the root of a square's side in points.
            for (const double here : held) CHECK(std::abs(here - mean) <= 2 + 0.8 * std::sqrt(mean));
        }
    }
    // No two points are close together where there is room.
    const Points points = masked_points(density, 1024);
    double closest = 1e9;
    for (std::size_t i = 0; i < points.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            closest = std::min(closest, std::hypot(static_cast<double>(points[i] % 256) - static_cast<double>(points[j] % 256),
                                                   static_cast<double>(points[i] >> 8U) - static_cast<double>(points[j] >> 8U)));
    CHECK(closest > 3);  // 8.6 px in a perfect lattice
}

TEST_CASE("told to stop it asks no band again") {
    const auto image = hmesh_test::scene<std::uint8_t, 1>(20, 300, 5);  // ten bands
    int asked = 0;
    (void)point_density(ImageSource<1>(image.view()), {}, [&] { return ++asked < 3; });
    CHECK(asked <= 10);
    CHECK(asked >= 3);
}
