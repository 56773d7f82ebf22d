#include "hmesh/methods/annealed/points_by_rows.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/methods/annealed/first_points.hpp"
#include "test_executors.hpp"
#include "test_images.hpp"
#include "test_meshes.hpp"

namespace kit = hmesh::kit;
using hmesh::kit::ImageSource;

namespace {

using Points = std::vector<std::uint32_t>;

template <int C>
Points points_of_image(const ImageSource<C>& source, std::size_t count) {
    return kit::first_points(kit::point_ranks(kit::point_density(source, {})), count);
}
struct Found {
    Points points;
    int asked = 0;  // before bands and rows of the sample, and before ranks of bands
};
template <int C>
Found points_by_rows(const ImageSource<C>& source, std::size_t count, const hmesh::ParallelFor& parallel_for = {}) {
    std::atomic<int> asked{0};
    const auto go_on = [&] { return ++asked > 0; };
    Found found;
    found.points = kit::points_by_rows(source, count, parallel_for, go_on);
    found.asked = asked;
    return found;
}
template <int C>
void check_counts(const ImageSource<C>& source) {
    const auto pixels = static_cast<std::size_t>(source.pixels());
    for (const std::size_t count : {std::size_t{0}, std::size_t{1}, pixels / 100, pixels / 2, pixels - 1, pixels}) {
        CAPTURE(count);
        CHECK(points_by_rows(source, count).points == points_of_image(source, count));
    }
}

}  // namespace

TEST_CASE("points found by rows are those found with a rank for each pixel") {
    check_counts(ImageSource<3>(hmesh_test::scene<std::uint8_t, 3>(40, 30, 3).view()));
    check_counts(ImageSource<3>(hmesh_test::scene<std::uint8_t, 3>(577, 531, 3).view()));
    check_counts(ImageSource<1>(hmesh_test::noise<float, 1>(700, 400, 1).view()));
    check_counts(ImageSource<1>(hmesh_test::constant_image<std::uint16_t, 1>(640, 480, 0.4).view()));
    check_counts(ImageSource<1>(hmesh_test::noise<std::uint8_t, 1>(9, 40000, 1).view()));
    check_counts(ImageSource<1>(hmesh_test::noise<std::uint8_t, 1>(40000, 9, 1).view()));
    const auto wave = hmesh_test::draw<float, 1>(
        600, 500, [](int x, int y, int) { return 0.5 + 0.4 * std::sin(0.7 * x) * std::sin(0.5 * y * y / 500.0); });
    const auto weights = hmesh_test::draw<float, 1>(600, 500, [](int x, int, int) { return x < 300 ? 0.0 : 1.0; });
    check_counts(ImageSource<1>(wave.view(), weights.view()));
    for (const double factor : {1e-38, 1e30, 3e38}) {
        CAPTURE(factor);
        check_counts(ImageSource<1>(hmesh_test::scaled(wave, factor).view()));
    }
}

TEST_CASE("a sample of rows saves two passes of three, and costs as little where it misleads") {
    const auto scene = hmesh_test::scene<std::uint8_t, 1>(1024, 1024, 3);
    const Found found = points_by_rows(ImageSource<1>(scene.view()), 10000);
    CHECK(found.points == points_of_image(ImageSource<1>(scene.view()), 10000));
    CHECK(found.asked == 64 + 2 * 32);
    // All but one row is flat, and no row of the sample is beside that one.
    const auto lines = [](int where) {
        return hmesh_test::draw<std::uint8_t, 1>(1024, 1024, [=](int x, int y, int) { return y == where ? (x % 7) / 7.0 : 0.5; });
    };
    int misled = 0;
    for (const int where : {200, 203, 206, 209, 212}) {
        const auto image = lines(where);
        const Found line = points_by_rows(ImageSource<1>(image.view()), 10000);
        CHECK(line.points == points_of_image(ImageSource<1>(image.view()), 10000));
        CHECK(line.asked <= 64 + 4 * 32);
        misled += line.asked > 64 + 2 * 32;
    }
    CHECK(misled > 0);
}

TEST_CASE("points by rows are the same for any executor") {
    const auto scene = hmesh_test::scene<std::uint8_t, 3>(640, 480, 5);
    const ImageSource<3> source(scene.view());
    const Points points = points_of_image(source, 4000);
    CHECK(points_by_rows(source, 4000, hmesh_test::ReverseFor{}).points == points);
    CHECK(points_by_rows(source, 4000, hmesh_test::ShuffledFor{3}).points == points);
    CHECK(points_by_rows(source, 4000, hmesh_test::ThreadFor{5}).points == points);
}

TEST_CASE("told to stop at any band it gives no other numbers than those of pixels, row by row") {
    // With a sample of rows and without, and where a band that is left out has more points than others or fewer.
    for (const int width : {300, 1024})
        for (const double factor : {1e-3, 1e3}) {
            const auto image = hmesh_test::scaled(hmesh_test::noise<float, 1>(width, 300, 1), factor);
            const ImageSource<1> source(image.view());
            const int all = points_by_rows(source, 3000).asked;
            for (int last = 0; last < all; last += width == 300 ? 1 : 7) {
                CAPTURE(width);
                CAPTURE(factor);
                CAPTURE(last);
                int asked = 0;
                const Points points = kit::points_by_rows(source, 3000, {}, [&] { return asked++ < last; });
                CHECK(asked > last);
                CHECK(points.size() <= 3000);
                CHECK(std::is_sorted(points.begin(), points.end()));
                CHECK((points.empty() || points.back() < image.size()));
            }
        }
}
