#include "hmesh/methods/baselines/feature_map.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "hmesh/core/random.hpp"
#include "hmesh/fit/image_source.hpp"
#include "test_executors.hpp"
#include "test_images.hpp"

using hmesh::Image;
using hmesh::kit::feature_map;
using hmesh::kit::ImageSource;

namespace {

// One channel with the pixels beyond the border those on it.
struct Channel {
    int width, height;
    std::vector<double> values;
    [[nodiscard]] double at(int x, int y) const {
        return values[static_cast<std::size_t>(std::clamp(y, 0, height - 1) * width + std::clamp(x, 0, width - 1))];
    }
};

// The binomial filter by its nine weights.
Channel smoothed(const Channel& from) {
    constexpr double weights[3] = {1, 2, 1};
    Channel to = from;
    for (int y = 0; y < from.height; ++y)
        for (int x = 0; x < from.width; ++x) {
            double sum = 0;
            for (int j = 0; j < 3; ++j)
                for (int i = 0; i < 3; ++i) sum += weights[i] * weights[j] * from.at(x + i - 1, y + j - 1);
            to.values[static_cast<std::size_t>(y * from.width + x)] = sum / 16;
        }
    return to;
}

// The largest second derivative, over 1800 directions: that of the best one is at most 8e-7 of it larger.
double largest_derivative(const Channel& f, int x, int y) {
    struct Direction {
        double xx, xy, yy;
    };
    static const std::vector<Direction> directions = [] {
        std::vector<Direction> all;
        for (int k = 0; k < 1800; ++k) {
            const double c = std::cos(k * 3.141592653589793 / 1800), s = std::sin(k * 3.141592653589793 / 1800);
            all.push_back({c * c, 2 * c * s, s * s});
        }
        return all;
    }();
    const double xx = f.at(x + 1, y) + f.at(x - 1, y) - 2 * f.at(x, y);
    const double yy = f.at(x, y + 1) + f.at(x, y - 1) - 2 * f.at(x, y);
    const double xy = (f.at(x + 1, y + 1) - f.at(x - 1, y + 1) - f.at(x + 1, y - 1) + f.at(x - 1, y - 1)) / 4;
    double largest = 0;
    for (const Direction& d : directions) largest = std::max(largest, std::abs(d.xx * xx + d.xy * xy + d.yy * yy));
    return largest;
}

template <class T, int C>
void check_map(const Image<T, C>& image) {
    const int width = image.width(), height = image.height();
    const ImageSource<C> source(image.view());
    for (const int passes : {0, 1, 3}) {
        std::vector<double> expected(static_cast<std::size_t>(width * height), 0.0);
        double peak = 0;
        for (int c = 0; c < C; ++c) {
            Channel channel{width, height, {}};
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x) channel.values.push_back(static_cast<double>(image.pixel(x, y)[c]));
            for (const double value : channel.values) peak = std::max(peak, std::abs(value));
            for (int pass = 0; pass < passes; ++pass) channel = smoothed(channel);
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x)
                    expected[static_cast<std::size_t>(y * width + x)] += largest_derivative(channel, x, y);
        }
        const Image<float, 1> map = feature_map(source, passes);
        REQUIRE(map.width() == width);
        REQUIRE(map.height() == height);
        int wrong = 0;
        for (std::size_t k = 0; k < expected.size(); ++k)  // the sum is rounded to float with each channel
            wrong += !(std::abs(static_cast<double>(map.data()[k]) - expected[k]) <= 2e-6 * expected[k] + 1e-14 * peak);
        CHECK(wrong == 0);
    }
}

bool same_bytes(const Image<float, 1>& a, const Image<float, 1>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

}  // namespace

TEST_CASE("the map is the largest second derivative in any direction after smoothing, summed over channels") {
    check_map(hmesh_test::scene<std::uint8_t, 3>(19, 14, 1));
    check_map(hmesh_test::noise<std::uint8_t, 1>(17, 15, 2));
    check_map(hmesh_test::noise<std::uint16_t, 2>(9, 16, 3));
    check_map(hmesh_test::noise<float, 4>(8, 9, 4));
    check_map(hmesh_test::checkerboard<std::uint8_t, 2>(12, 11, 3));
}

TEST_CASE("images of one or two rows or columns have the map that the definition gives") {
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 2}, {2, 1}, {2, 2}, {1, 9}, {23, 1}, {2, 7}, {7, 2}, {3, 3}})
        check_map(hmesh_test::noise<std::uint8_t, 2>(width, height, 5));
    const auto pixel = hmesh_test::noise<float, 3>(1, 1, 6);
    CHECK(feature_map(ImageSource<3>(pixel.view()), 2).data()[0] == 0);
}

TEST_CASE("a quadratic picture has the map of its coefficients") {
    struct Case {
        double a, b, c, expected;  // a x^2 + b x y + c y^2 and the largest eigenvalue's magnitude
    };
    for (const Case& k : {Case{1, 0, 0, 2}, Case{0, 0, -3, 6}, Case{2, 0, -1, 4}, Case{0, 5, 0, 5}, Case{1, 2, 1, 4},
                          Case{-3, 4, 3, 2 * std::sqrt(13.0)}}) {
        Image<float, 2> image(12, 9);
        for (int y = 0; y < 9; ++y)
            for (int x = 0; x < 12; ++x) {
                const double value = k.a * x * x + k.b * x * y + k.c * y * y + 7 * x - 3 * y + 1;
                image.pixel(x, y)[0] = static_cast<float>(value);
                image.pixel(x, y)[1] = static_cast<float>(-2 * value);
            }
        for (const int passes : {0, 2}) {
            const Image<float, 1> map = feature_map(ImageSource<2>(image.view()), passes);
            for (int y = 1 + passes; y < 8 - passes; ++y)
                for (int x = 1 + passes; x < 11 - passes; ++x)
                    CHECK(static_cast<double>(*map.pixel(x, y)) == doctest::Approx(3 * k.expected).epsilon(1e-6));
        }
    }
}

TEST_CASE("a linear picture has a map of 0 as far from the border as it is smoothed, a constant one everywhere") {
    Image<std::uint16_t, 2> image(20, 17);
    for (int y = 0; y < 17; ++y)
        for (int x = 0; x < 20; ++x) {
            image.pixel(x, y)[0] = static_cast<std::uint16_t>(100 + 31 * x + 17 * y);
            image.pixel(x, y)[1] = static_cast<std::uint16_t>(60000 - 101 * x + 3 * y);
        }
    for (const int passes : {0, 1, 4}) {
        const Image<float, 1> map = feature_map(ImageSource<2>(image.view()), passes);
        float inside = 0, border = 0;
        for (int y = 0; y < 17; ++y)
            for (int x = 0; x < 20; ++x) {
                const bool is_inside = std::min({x, y, 19 - x, 16 - y}) > passes;
                (is_inside ? inside : border) = std::max(is_inside ? inside : border, *map.pixel(x, y));
            }
        CHECK(inside == 0);  // sums of integers over 4^passes: exact
        CHECK(border > 10);  // where the slope ends
    }
    const auto flat = hmesh_test::constant_image<std::uint8_t, 3>(9, 8, 0.7);
    const Image<float, 1> map = feature_map(ImageSource<3>(flat.view()), 3);
    for (const float value : hmesh_test::samples_of(map)) REQUIRE(value == 0);
}

TEST_CASE("floats up to the largest give a map that is finite, and the smallest one that is not negative") {
    const float most = std::numeric_limits<float>::max();
    for (const float size : {1e38F, most, 1e-38F, std::numeric_limits<float>::denorm_min()}) {
        hmesh::kit::Random random(1);
        Image<float, 16> image(12, 11);
        hmesh_test::for_each_sample(image, [&](float& sample) { sample = random.below(2) == 0 ? size : -size; });
        for (const int passes : {0, 3}) {
            float largest = 0;
            const Image<float, 1> map = feature_map(ImageSource<16>(image.view()), passes);
            for (const float value : hmesh_test::samples_of(map)) {
                REQUIRE(std::isfinite(value));
                REQUIRE(value >= 0);
                largest = std::max(largest, value);
            }
            if (size == most) CHECK(largest == most);  // for there is none larger
        }
    }
}

TEST_CASE("the map is the same to the last byte on executors of any order and on threads") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(37, 150, 3);  // of 5 pieces
    const ImageSource<3> source(image.view());
    const Image<float, 1> map = feature_map(source, 3);
    CHECK(same_bytes(feature_map(source, 3, hmesh_test::ReverseFor{}), map));
    CHECK(same_bytes(feature_map(source, 3, hmesh_test::ShuffledFor{2}), map));
    CHECK(same_bytes(feature_map(source, 3, hmesh_test::ThreadFor{2}), map));
    CHECK(same_bytes(feature_map(source, 3, hmesh_test::ThreadFor{5}), map));
    CHECK_FALSE(same_bytes(feature_map(source, 2), map));
}
