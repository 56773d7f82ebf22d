#include "hmesh/fit/image_source.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "hmesh/fit/moment_table.hpp"
#include "hmesh/image/weights.hpp"
#include "test_executors.hpp"
#include "test_images.hpp"

using hmesh::Image;
using hmesh::ImageView;
using hmesh::PixelTraits;
using hmesh::kit::ImageSource;
using hmesh::kit::MomentTable;
using hmesh::kit::Rect;

namespace {

template <int C>
double number(const MomentTable<C>& table, int x, int y, int k) {
    constexpr int lanes = MomentTable<C>::lanes;
    const auto entry = table.entry(x, y);
    return k < lanes ? entry.of_samples[k] : entry.by_column[k - lanes];
}

template <int C>
bool same_bits(const MomentTable<C>& a, const MomentTable<C>& b) {
    bool same =
        a.width() == b.width() && a.height() == b.height() && a.is_int32() == b.is_int32() && a.is_weighted() == b.is_weighted();
    for (int y = 0; same && y < a.height(); ++y)
        for (int x = 0; x <= a.width(); ++x) {
            for (int k = 0; k < MomentTable<C>::entry_size; ++k) same = same && number(a, x, y, k) == number(b, x, y, k);
            for (int k = 0; a.is_weighted() && k < 2; ++k)
                same = same && a.x_moments(a.offset(x, y))[k] == b.x_moments(b.offset(x, y))[k];
        }
    return same;
}

template <class T, int C>
void check_pixels(const ImageSource<C>& source, const ImageView<T, C>& view) {
    CHECK(source.width() == view.width);
    CHECK(source.height() == view.height);
    CHECK(source.pixels() == static_cast<double>(view.width) * view.height);
    CHECK(source.low() == PixelTraits<T>::lowest);
    CHECK(source.high() == PixelTraits<T>::highest);
    CHECK(source.peak() == PixelTraits<T>::peak);
    for (int y = -3; y < view.height + 3; ++y)
        for (int x = -3; x < view.width + 3; ++x) {
            const T* nearest = view.pixel(std::clamp(x, 0, view.width - 1), std::clamp(y, 0, view.height - 1));
            const auto got = source.pixel(x, y);
            for (int k = 0; k < hmesh::kit::lanes_for(C + 1); ++k)
                REQUIRE(got[k] == (k < C ? PixelTraits<T>::to_real(nearest[k]) : 0.0));
        }
    std::vector<double> row(static_cast<std::size_t>(view.width) * C + 1, 7.0);
    for (int y = -3; y < view.height + 3; ++y) {
        source.row(y, 0.25, row.data());
        for (int k = 0; k < view.width * C; ++k)
            REQUIRE(row[static_cast<std::size_t>(k)] ==
                    0.25 * PixelTraits<T>::to_real(view.row(std::clamp(y, 0, view.height - 1))[k]));
        REQUIRE(row.back() == 7);
    }
}

// A packed image and copies of it with other strides, with weights and without.
template <class T, int C>
void check_source(const Image<T, C>& image) {
    const int width = image.width(), height = image.height();
    const Image<float, 1> weights = hmesh_test::random_weights(width, height, 3);
    const double unit = hmesh::kit::weight_unit(weights.view());
    const hmesh_test::PaddedCopy<T, C> padded(image, 5, false, T{}), upside_down(image, 3, true, T{});
    for (const ImageView<T, C>& view : {image.view(), padded.view(), upside_down.view()}) {
        const ImageSource<C> source(view), weighted(view, weights.view(), unit);
        check_pixels(source, image.view());
        check_pixels(weighted, image.view());
        CHECK(!source.is_weighted());
        CHECK(weighted.is_weighted());
        for (const Rect& rect : {Rect{0, 0, width, height}, Rect{width / 2, height / 3, width - width / 2, height - height / 3},
                                 Rect{0, 0, 1, 1}, Rect{width - 1, 0, 1, height}, Rect{0, height - 1, width, 1}}) {
            CHECK(same_bits(source.table(rect), MomentTable<C>(image.view(), rect)));
            CHECK(same_bits(source.table(rect, hmesh_test::ReverseFor{}), MomentTable<C>(image.view(), rect)));
            CHECK(same_bits(weighted.table(rect), MomentTable<C>(image.view(), weights.view(), unit, rect)));
        }
    }
}

// A sample type of a user: steps of a half, from -50 to 50, of which 40 is full intensity.
struct Halves {
    std::int8_t value = 0;
};

}  // namespace

template <>
struct hmesh::PixelTraits<Halves> {
    static constexpr double peak = 40, lowest = -50, highest = 50;
    static constexpr bool is_integer = false;
    static double to_real(Halves sample) noexcept { return 0.5 * sample.value; }
    static Halves from_real(double value) noexcept { return {static_cast<std::int8_t>(2 * std::clamp(value, lowest, highest))}; }
};

TEST_CASE("tables and pixels are those of the view, for any sample type, stride, rectangle and weights, clamped outside") {
    check_source(hmesh_test::noise<std::uint8_t, 1>(17, 13, 1));
    check_source(hmesh_test::noise<std::uint8_t, 3>(17, 13, 2));
    check_source(hmesh_test::noise<std::uint16_t, 2>(14, 19, 3));
    check_source(hmesh_test::noise<float, 4>(12, 11, 4));
    check_source(hmesh_test::noise<float, 16>(5, 7, 5));
    check_source(hmesh_test::noise<Halves, 3>(9, 8, 6));
    check_source(hmesh_test::noise<std::uint8_t, 3>(1, 1, 7));
    check_source(hmesh_test::noise<float, 1>(1, 20, 8));
    check_source(hmesh_test::noise<std::uint16_t, 1>(20, 1, 9));
    check_source(hmesh_test::noise<std::uint8_t, 3>(6, 131, 10));  // several bands of rows
}

// Samples of which floats do not hold all.
template <>
struct hmesh::PixelTraits<double> {
    static constexpr double peak = 1, highest = std::numeric_limits<double>::max(), lowest = -highest;
    static constexpr bool is_integer = false;
    static double to_real(double value) noexcept { return value; }
    static double from_real(double value) noexcept { return value; }
};

TEST_CASE("colours keep within floats, which meshes hold, though samples could be larger") {
    const double samples[] = {3e38, -3e38};
    const ImageSource<1> source(ImageView<double, 1>{samples, 2, 1, 0});
    CHECK(source.high() == static_cast<double>(std::numeric_limits<float>::max()));
    CHECK(source.low() == -source.high());
    CHECK(source.pixel(1, 0)[0] == -3e38);
}

TEST_CASE("a source can be copied, and sees what becomes of the pixels") {
    Image<std::uint8_t, 1> image = hmesh_test::noise<std::uint8_t, 1>(4, 3, 1);
    const ImageSource<1> source(image.view()), copy = source;
    *image.pixel(2, 1) = 77;
    CHECK(source.pixel(2, 1)[0] == 77);
    CHECK(copy.pixel(2, 1)[0] == 77);
}

TEST_CASE("tables of an image that repeats reach beyond it, with its weights, and pixels and rows do too") {
    using hmesh::Periodic;
    constexpr int width = 7, height = 5;
    const Image<std::uint8_t, 3> image = hmesh_test::noise<std::uint8_t, 3>(width, height, 4);
    const Image<float, 1> weights = hmesh_test::random_weights(width, height, 5);
    // The image three times in each direction.
    Image<std::uint8_t, 3> all(3 * width, 3 * height);
    Image<float, 1> all_weights(3 * width, 3 * height);
    for (int y = 0; y < 3 * height; ++y)
        for (int x = 0; x < 3 * width; ++x) {
            std::copy_n(image.pixel(x % width, y % height), 3, all.pixel(x, y));
            *all_weights.pixel(x, y) = *weights.pixel(x % width, y % height);
        }
    const double unit = hmesh::kit::weight_unit(weights.view());
    const hmesh::kit::WeightScale scale(unit, width, height);
    for (const bool is_weighted : {false, true}) {
        const auto own = is_weighted ? weights.view() : hmesh::ImageView<float, 1>();
        const auto source = ImageSource<3>(image.view(), own, unit).with_periodic(Periodic::xy, true);
        CHECK(source.has_straight_seams());
        CHECK_FALSE(source.with_periodic(Periodic::none, true).has_straight_seams());
        for (const Rect rect : {Rect{-3, -4, 9, 12}, Rect{5, 3, 4, 4}, Rect{2, 1, 3, 2}, Rect{-7, 0, 14, 5}, Rect{6, 4, 1, 1}}) {
            const MomentTable<3> table = source.table(rect);
            const Rect far{rect.x + width, rect.y + height, rect.width, rect.height};
            const auto wide = is_weighted ? all_weights.view() : hmesh::ImageView<float, 1>();
            const MomentTable<3> expected(all.view(), wide, scale, far);
            REQUIRE((table.width() == rect.width && table.height() == rect.height && table.is_weighted() == is_weighted));
            for (int y = 0; y < rect.height; ++y)
                for (int x = 0; x <= rect.width; ++x)
                    for (int k = 0; k < MomentTable<3>::entry_size; ++k)
                        REQUIRE(number(table, x, y, k) == number(expected, x, y, k));
        }
    }
    const auto along_x = ImageSource<3>(image.view()).with_periodic(Periodic::x, false);
    CHECK(along_x.pixel(-1, -1)[1] == *(image.pixel(width - 1, 0) + 1));
    CHECK(along_x.pixel(width, height)[0] == *image.pixel(0, height - 1));
    std::vector<double> row(3 * width);
    ImageSource<3>(image.view()).with_periodic(Periodic::y, false).row(-2, 1, row.data());
    CHECK(row[4] == *(image.pixel(1, height - 2) + 1));
}

TEST_CASE("read() goes from pixel to pixel, over the lines where the image repeats, and with_scale() rounds scaled channels") {
    const int width = 5, height = 4;
    const auto image = hmesh_test::noise<float, 2>(width, height, 8);
    const auto source = ImageSource<2>(image.view()).with_periodic(hmesh::Periodic::xy, false);
    hmesh::kit::ChannelScale<2> scale;
    scale.offset = -0.25;
    scale.unit = 40000;
    scale.share = {1, 0.5};
    const auto scaled = source.with_scale(scale);
    CHECK((!source.is_integer() && scaled.is_integer() && scaled.scale() == &scale));
    CHECK((scaled.low() == 0 && scaled.high() == 65535 && scaled.peak() == 65535));
    double read[2 * 13], rounded[2 * 13];
    source.read(-7, -1, 13, read);
    scaled.read(-7, -1, 13, rounded);
    for (int i = 0; i < 13; ++i)
        for (int c = 0; c < 2; ++c) {
            const auto value = static_cast<double>(image.pixel((i + 3) % width, height - 1)[c]);
            CHECK(read[2 * i + c] == value);
            CHECK(rounded[2 * i + c] == std::floor((value + 0.25) * (c == 0 ? 40000 : 20000) + 0.5));
        }
    CHECK(scaled.table({0, 0, width, height}).is_int32() == false);  // of 16 bits
}
