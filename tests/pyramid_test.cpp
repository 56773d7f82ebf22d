#include "hmesh/methods/hierarchical/pyramid.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "test_executors.hpp"
#include "test_images.hpp"

using hmesh::Image;
using hmesh::ImageView;
using hmesh::kit::apply_filter;
using hmesh::kit::bilateral_filter;
using hmesh::kit::BilateralOptions;
using hmesh::kit::make_pyramid;
using hmesh::kit::Pyramid;

namespace {

// A LevelFilter that notes what it was called with.
struct Calls {
    int count = 0, width = 0, height = 0, channels = 0;
    std::vector<float> seen;
    std::vector<float> answer;  // for the first samples; the others are left alone

    void operator()(const float* from, float* to, int of_width, int of_height, int of_channels) {
        ++count;
        width = of_width;
        height = of_height;
        channels = of_channels;
        seen.assign(from, from + static_cast<std::ptrdiff_t>(width) * height * channels);
        for (std::size_t i = 0; i < answer.size(); ++i) to[i] = answer[i];
    }
};

void halve(const float* from, float* to, int width, int height, int channels) {
    for (int i = 0; i < width * height * channels; ++i) to[i] = from[i] / 2;
}

template <class T, int C>
std::vector<T> samples_of(const ImageView<T, C>& view) {
    std::vector<T> samples;
    for (int y = 0; y < view.height; ++y) samples.insert(samples.end(), view.row(y), view.row(y) + view.width * C);
    return samples;
}

}  // namespace

TEST_CASE("level 0 is the user's memory, whatever its stride, and a pyramid of one level filters nothing") {
    const auto image = hmesh_test::noise<std::uint8_t, 3>(8, 5, 1);
    const hmesh_test::PaddedCopy<std::uint8_t, 3> copy(image, 4, true, 0);
    const auto view = copy.view();
    const Pyramid<std::uint8_t, 3> pyramid(view, 1, [](const ImageView<std::uint8_t, 3>&) {
        FAIL("there is no level 1");
        return Image<std::uint8_t, 3>();
    });
    CHECK(pyramid.size() == 1);
    CHECK(pyramid.level(0).data == view.data);
    CHECK(pyramid.level(0).row_stride == view.row_stride);
    CHECK(samples_of(pyramid.level(0)) == hmesh_test::samples_of(image));
}

TEST_CASE("level i is the filter applied to level i - 1, in the size of the input") {
    const auto image = hmesh_test::noise<std::uint16_t, 2>(7, 4, 1);
    int calls = 0;
    const Pyramid<std::uint16_t, 2> pyramid(image.view(), 4, [&](const ImageView<std::uint16_t, 2>& view) {
        Image<std::uint16_t, 2> out(view.width, view.height);
        for (std::size_t i = 0; i < out.size(); ++i) out.data()[i] = static_cast<std::uint16_t>(samples_of(view)[i] / 3);
        ++calls;
        return out;
    });
    CHECK(pyramid.size() == 4);
    CHECK(calls == 3);
    std::vector<std::uint16_t> expected = hmesh_test::samples_of(image);
    for (int i = 0; i < 4; ++i) {
        CHECK(pyramid.level(i).width == 7);
        CHECK(pyramid.level(i).height == 4);
        CHECK(samples_of(pyramid.level(i)) == expected);
        for (std::uint16_t& sample : expected) sample = static_cast<std::uint16_t>(sample / 3);
    }
}

TEST_CASE("levels stay where they are when the pyramid is moved") {
    const auto image = hmesh_test::noise<std::uint8_t, 1>(6, 6, 1);
    Pyramid<std::uint8_t, 1> pyramid = make_pyramid(image.view(), 3);
    const ImageView<std::uint8_t, 1> before = pyramid.level(2);
    const std::vector<std::uint8_t> samples = samples_of(before);
    const Pyramid<std::uint8_t, 1> moved = std::move(pyramid);
    CHECK(moved.level(2).data == before.data);
    CHECK(samples_of(moved.level(2)) == samples);
}

TEST_CASE("without a user's filter levels are the bilateral filter's, in any order of work") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(50, 70, 2);
    const BilateralOptions options{5, 40, 2};
    const auto first = bilateral_filter(image.view(), options);
    const auto second = bilateral_filter(first.view(), options);
    const auto check = [&](const Pyramid<std::uint8_t, 3>& pyramid) {
        CHECK(pyramid.size() == 3);
        CHECK(samples_of(pyramid.level(0)) == hmesh_test::samples_of(image));
        CHECK(samples_of(pyramid.level(1)) == hmesh_test::samples_of(first));
        CHECK(samples_of(pyramid.level(2)) == hmesh_test::samples_of(second));
    };
    check(make_pyramid(image.view(), 3, options));
    check(make_pyramid(image.view(), 3, options, {}, hmesh_test::ThreadFor{3}));
    CHECK(hmesh_test::samples_of(first) != hmesh_test::samples_of(image));
    CHECK(hmesh_test::samples_of(second) != hmesh_test::samples_of(first));
}

TEST_CASE("a user's filter takes the place of the bilateral one") {
    const auto image = hmesh_test::noise<float, 3>(9, 4, 1);
    const auto pyramid = make_pyramid(image.view(), 3, {}, halve);
    std::vector<float> expected = hmesh_test::samples_of(image);
    for (float& sample : expected) sample /= 4;
    CHECK(samples_of(pyramid.level(2)) == expected);
}

TEST_CASE_TEMPLATE("a user's filter sees packed rows of stored values, also of a bottom-up view", T, std::uint8_t, std::uint16_t,
                   float) {
    const auto image = hmesh_test::noise<T, 3>(5, 4, 3);
    const hmesh_test::PaddedCopy<T, 3> copy(image, 2, true, T(77));
    Calls calls;
    const Image<T, 3> out = apply_filter(calls, copy.view());
    CHECK(calls.count == 1);
    CHECK(calls.width == 5);
    CHECK(calls.height == 4);
    CHECK(calls.channels == 3);
    CHECK(calls.seen == std::vector<float>(image.data(), image.data() + image.size()));
    CHECK(hmesh_test::samples_of(out) == hmesh_test::samples_of(image));  // it wrote nothing, and `to` began as a copy
}

TEST_CASE("what a user's filter writes is rounded and clamped; what is not finite keeps the sample") {
    constexpr float infinity = std::numeric_limits<float>::infinity();
    constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();
    Calls calls;
    calls.answer = {99.4F, 99.6F, -3, 1e30F, not_a_number, infinity, -infinity};
    const auto bytes = hmesh_test::constant_image<std::uint8_t, 1>(3, 3, 50 / 255.0);
    CHECK(hmesh_test::samples_of(apply_filter(calls, bytes.view())) ==
          std::vector<std::uint8_t>{99, 100, 0, 255, 50, 50, 50, 50, 50});
    const auto floats = hmesh_test::constant_image<float, 1>(3, 3, 0.25);
    CHECK(hmesh_test::samples_of(apply_filter(calls, floats.view())) ==
          std::vector<float>{99.4F, 99.6F, -3, 1e30F, 0.25F, 0.25F, 0.25F, 0.25F, 0.25F});
}
