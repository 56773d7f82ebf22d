#include "hmesh/methods/hierarchical/bilateral.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <string>
#include <vector>

#include "test_executors.hpp"
#include "test_images.hpp"

using hmesh::Errc;
using hmesh::Image;
using hmesh::ImageView;
using hmesh::PixelTraits;
using hmesh::kit::bilateral_filter;
using hmesh::kit::BilateralOptions;

namespace {

// A sample type of a user: whole numbers down to -1000.
struct Depth {
    std::int16_t value = 0;
};

}  // namespace

template <>
struct hmesh::PixelTraits<Depth> {
    static constexpr double peak = 1000, lowest = -1000, highest = 0;
    static constexpr bool is_integer = true;
    static double to_real(Depth sample) noexcept { return sample.value; }
    static Depth from_real(double value) noexcept {
        return {static_cast<std::int16_t>(value > lowest ? std::lround(std::min(value, highest)) : std::lround(lowest))};
    }
};

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

// Walks back from a mirror at pixel 0 and one at pixel n - 1 until it is inside.
int mirrored(int i, int n) {
    if (n == 1) return 0;
    while (i < 0 || i >= n) i = i < 0 ? -i : 2 * (n - 1) - i;
    return i;
}

// The definition, tap by tap, in double precision.
template <class T, int C>
std::vector<double> exact(const ImageView<T, C>& view, const BilateralOptions& options) {
    const int r = options.diameter / 2;
    const double unit = 255 / PixelTraits<T>::peak;
    std::vector<double> means;
    for (int y = 0; y < view.height; ++y)
        for (int x = 0; x < view.width; ++x) {
            double sums[C] = {}, weights = 0;
            for (int dy = -r; dy <= r; ++dy)
                for (int dx = -r; dx <= r; ++dx) {
                    if (dx * dx + dy * dy > r * r) continue;
                    const T* there = view.pixel(mirrored(x + dx, view.width), mirrored(y + dy, view.height));
                    double distance = 0;
                    for (int c = 0; c < C; ++c)
                        distance += std::abs(static_cast<double>(there[c]) - static_cast<double>(view.pixel(x, y)[c]));
                    const double space = std::hypot(dx, dy) / options.sigma_space, color = distance * unit / options.sigma_color;
                    const double weight = std::exp(-space * space / 2) * std::exp(-color * color / 2);
                    weights += weight;
                    for (int c = 0; c < C; ++c) sums[c] += weight * static_cast<double>(there[c]);
                }
            for (const double sum : sums) means.push_back(sum / weights);
        }
    return means;
}

// How many samples are not the exact ones, rounded. An exact value closer to a rounding boundary than 1e-6 of the peak
// (some 2^-20, what weights of 24 bits can do) may go either way; floats may be off by as much.
template <class T, int C>
int wrong_samples(const ImageView<T, C>& view, const BilateralOptions& options) {
    const Image<T, C> filtered = bilateral_filter(view, options);
    if (filtered.width() != view.width || filtered.height() != view.height) return -1;
    const std::vector<double> means = exact(view, options);
    const double tolerance = 1e-6 * PixelTraits<T>::peak;
    int wrong = 0;
    for (std::size_t i = 0; i < means.size(); ++i) {
        const double off = std::abs(static_cast<double>(filtered.data()[i]) - means[i]);
        wrong += off > (PixelTraits<T>::is_integer ? 0.5 : 0) + tolerance;
    }
    return wrong;
}

template <class T, int C>
struct Pixel {
    using Sample = T;
    static constexpr int channels = C;
};

// The standard deviation of channel 0 over columns [begin, end).
double deviation(const Image<std::uint8_t, 3>& image, int begin, int end) {
    double sum = 0, squares = 0, n = 0;
    for (int y = 0; y < image.height(); ++y)
        for (int x = begin; x < end; ++x) {
            const double value = image.pixel(x, y)[0];
            sum += value;
            squares += value * value;
            ++n;
        }
    return std::sqrt(squares / n - sum / n * (sum / n));
}

}  // namespace

TEST_CASE_TEMPLATE("the filter is its definition, for every size of image and window", P, Pixel<std::uint8_t, 1>,
                   Pixel<std::uint8_t, 3>, Pixel<std::uint8_t, 4>, Pixel<std::uint16_t, 3>, Pixel<float, 3>) {
    using T = typename P::Sample;
    constexpr int channels = P::channels;
    const int sizes[][2] = {{1, 1}, {1, 7}, {5, 1}, {3, 3}, {2, 2}, {20, 13}, {70, 9}};
    for (const auto& size : sizes)
        for (const int diameter : {1, 2, 5, 9, 15}) {
            CAPTURE(size[0]);
            CAPTURE(size[1]);
            CAPTURE(diameter);
            CHECK(wrong_samples(hmesh_test::noise<T, channels>(size[0], size[1], 3).view(), {diameter, 50, 50}) == 0);
            CHECK(wrong_samples(hmesh_test::scene<T, channels>(size[0], size[1], 3).view(), {diameter, 20, 3}) == 0);
        }
}

TEST_CASE("the filter is its definition across tiles and chunks of rows") {
    CHECK(wrong_samples(hmesh_test::scene<std::uint8_t, 3>(150, 3, 5).view(), {}) == 0);
    CHECK(wrong_samples(hmesh_test::scene<std::uint8_t, 3>(260, 2, 5).view(), {5, 30, 4}) == 0);
    CHECK(wrong_samples(hmesh_test::scene<std::uint8_t, 3>(7, 70, 5).view(), {}) == 0);
    CHECK(wrong_samples(hmesh_test::noise<std::uint8_t, 1>(131, 67, 5).view(), {3, 80, 2}) == 0);
    CHECK(wrong_samples(hmesh_test::noise<std::uint8_t, 2>(9, 5, 6).view(), {99, 50, 30}) == 0);
    CHECK(wrong_samples(hmesh_test::noise<std::uint8_t, 16>(9, 5, 6).view(), {7, 500, 3}) == 0);
}

TEST_CASE("the filter is its definition for sigmas of any size") {
    const Image<std::uint8_t, 3> bytes = hmesh_test::noise<std::uint8_t, 3>(12, 7, 2);
    const Image<float, 3> floats = hmesh_test::noise<float, 3>(12, 7, 2);
    for (const double color : {1e-300, 1e-30, 0.01, 1.0, 7.0, 300.0, 1e30, 1e300})
        for (const double space : {1e-300, 0.3, 1.0, 1e10, 1e300}) {
            CAPTURE(color);
            CAPTURE(space);
            CHECK(wrong_samples(bytes.view(), {5, color, space}) == 0);
            CHECK(wrong_samples(floats.view(), {5, color, space}) == 0);
        }
}

TEST_CASE_TEMPLATE("an image of one colour stays as it is, to the last bit", T, std::uint8_t, std::uint16_t, float) {
    for (const double level : {0.0, 0.1, 0.7, 1.0}) {
        const Image<T, 3> image = hmesh_test::constant_image<T, 3>(40, 35, level);
        CHECK(hmesh_test::samples_of(bilateral_filter(image.view())) == hmesh_test::samples_of(image));
    }
}

TEST_CASE("a diameter of 1 changes nothing, nor does a colour sigma far below the steps of the samples") {
    const Image<float, 2> floats = hmesh_test::noise<float, 2>(33, 20, 1);
    CHECK(hmesh_test::samples_of(bilateral_filter(floats.view(), {1, 50, 50})) == hmesh_test::samples_of(floats));
    CHECK(hmesh_test::samples_of(bilateral_filter(floats.view(), {9, 1e-12, 50})) == hmesh_test::samples_of(floats));
    Image<Depth, 1> depths(33, 20);
    for (std::size_t k = 0; k < depths.size(); ++k)
        depths.data()[k].value = static_cast<std::int16_t>(-static_cast<int>(k * k % 1001));
    const Image<Depth, 1> filtered = bilateral_filter(depths.view(), {9, 1e-300, 50});
    for (std::size_t k = 0; k < depths.size(); ++k) CHECK(filtered.data()[k].value == depths.data()[k].value);
}

TEST_CASE("8-bit, 16-bit and float images of one picture are filtered alike") {
    const auto bytes = bilateral_filter(hmesh_test::scene<std::uint8_t, 3>(40, 30, 4).view());
    const auto words = bilateral_filter(hmesh_test::scene<std::uint16_t, 3>(40, 30, 4).view());
    const auto floats = bilateral_filter(hmesh_test::scene<float, 3>(40, 30, 4).view());
    double furthest = 0;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        const double value = 255 * static_cast<double>(floats.data()[i]);
        furthest = std::max(furthest, std::abs(value - bytes.data()[i]));
        furthest = std::max(furthest, std::abs(value - words.data()[i] / 257.0));
    }
    CHECK(furthest < 0.5 + 1e-3);
}

TEST_CASE("noise shrinks on both sides of an edge, and the edge stays") {
    hmesh::kit::Random random(1);
    const auto image = hmesh_test::draw<std::uint8_t, 3>(
        60, 30, [&random](int x, int, int) { return (x < 30 ? 40 : 210) / 255.0 + (random.uniform() - 0.5) * 20 / 255; });
    const Image<std::uint8_t, 3> filtered = bilateral_filter(image.view());
    // Means over 25 to 49 taps: the deviation falls by 5 to 7.
    CHECK(deviation(filtered, 0, 30) < deviation(image, 0, 30) / 4);
    CHECK(deviation(filtered, 30, 60) < deviation(image, 30, 60) / 4);
    for (int y = 0; y < 30; ++y) {
        CHECK(filtered.pixel(29, y)[1] < 50);
        CHECK(filtered.pixel(30, y)[1] > 200);
    }
}

TEST_CASE("floats of any finite size give finite means, and those alone at their height stay") {
    constexpr float most = std::numeric_limits<float>::max();
    Image<float, 4> image = hmesh_test::noise<float, 4>(30, 9, 1);
    for (int c = 0; c < 4; ++c) {
        image.pixel(3, 3)[c] = most;
        image.pixel(4, 3)[c] = -most;
        image.pixel(20, 5)[c] = 1e30F;
        image.pixel(21, 5)[c] = 1e12F;
        image.pixel(25, 2)[c] = std::numeric_limits<float>::denorm_min();
    }
    for (const double color : {1e-300, 0.1, 50.0, 1e20}) {
        CHECK(wrong_samples(image.view(), {1, color, 50}) == 0);
        const Image<float, 4> filtered = bilateral_filter(image.view(), {9, color, 50});
        for (const float value : hmesh_test::samples_of(filtered)) CHECK(std::isfinite(value));
        for (int c = 0; c < 4; ++c) {
            CHECK(filtered.pixel(3, 3)[c] == most);
            CHECK(filtered.pixel(4, 3)[c] == -most);
            CHECK(filtered.pixel(20, 5)[c] == 1e30F);
        }
        // A pixel of noise beside them does not feel them.
        if (color == 50) CHECK(std::abs(filtered.pixel(5, 3)[0] - 0.5F) < 0.5F);
    }
    // All alike within sigma: a blur of huge values.
    hmesh_test::for_each_sample(image, [&](float& value) { value = value > 0.5F ? most : -most; });
    const Image<float, 4> blurred = bilateral_filter(image.view(), {9, 1e300, 50});
    for (const float value : hmesh_test::samples_of(blurred)) CHECK(std::abs(value) < most);
}

TEST_CASE_TEMPLATE("a padded and a bottom-up view are filtered like the packed image", T, std::uint8_t, float) {
    const Image<T, 3> image = hmesh_test::noise<T, 3>(37, 11, 1);
    const Image<T, 3> expected = bilateral_filter(image.view());
    for (const int padding : {0, 5})
        for (const bool bottom_up : {false, true}) {
            const hmesh_test::PaddedCopy<T, 3> copy(image, padding, bottom_up, T(200));
            CHECK(hmesh_test::samples_of(bilateral_filter(copy.view())) == hmesh_test::samples_of(expected));
        }
}

TEST_CASE("any executor gives the same bytes") {
    const Image<float, 3> image = hmesh_test::noise<float, 3>(140, 100, 1);
    const Image<float, 3> expected = bilateral_filter(image.view(), {5, 50, 50});
    CHECK(hmesh_test::samples_of(bilateral_filter(image.view(), {5, 50, 50}, hmesh_test::ReverseFor())) ==
          hmesh_test::samples_of(expected));
    CHECK(hmesh_test::samples_of(bilateral_filter(image.view(), {5, 50, 50}, hmesh_test::ShuffledFor())) ==
          hmesh_test::samples_of(expected));
    CHECK(hmesh_test::samples_of(bilateral_filter(image.view(), {5, 50, 50}, hmesh_test::ThreadFor{3})) ==
          hmesh_test::samples_of(expected));
}

TEST_CASE("check refuses windows and sigmas that mean nothing") {
    CHECK(check(BilateralOptions()));
    for (const int diameter : {1, 2, 98, 99}) CHECK(check(BilateralOptions{diameter, 1e-300, 1e300}));
    for (const int diameter : {0, -1, std::numeric_limits<int>::min()}) {
        const hmesh::Status status = check(BilateralOptions{diameter, 50, 50});
        CHECK(status.code == Errc::invalid_argument);
        CHECK(status.value == diameter);
        CHECK(status.limit == 1);
    }
    CHECK(check(BilateralOptions{100, 50, 50}).limit == 99);
    for (const double sigma : {0.0, -1.0, infinity, -infinity, not_a_number}) {
        CHECK(std::string(check(BilateralOptions{9, sigma, 50}).what).find("sigma_color") != std::string::npos);
        CHECK(std::string(check(BilateralOptions{9, 50, sigma}).what).find("sigma_space") != std::string::npos);
    }
}
