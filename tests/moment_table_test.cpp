#include "hmesh/fit/moment_table.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <vector>

#include "hmesh/core/random.hpp"
#include "hmesh/image/weights.hpp"
#include "test_executors.hpp"
#include "test_images.hpp"

using hmesh::Image;
using hmesh::ImageView;
using hmesh::PixelTraits;
using hmesh::kit::MomentTable;
using hmesh::kit::Rect;

namespace {

template <class Sample, int Channels>
struct Kind {
    using T = Sample;
    static constexpr int channels = Channels;
};

// A sample type of a user: integers from -100 to 100.
struct Signed {
    std::int8_t value = 0;
};

// And one of integers from -1000 to 0.
struct Depth {
    std::int16_t value = 0;
};

}  // namespace

template <>
struct hmesh::PixelTraits<Signed> {
    static constexpr double peak = 100, lowest = -100, highest = 100;
    static constexpr bool is_integer = true;
    static double to_real(Signed sample) noexcept { return sample.value; }
    static Signed from_real(double value) noexcept {
        return {static_cast<std::int8_t>(std::lround(value < lowest ? lowest : value > highest ? highest : value))};
    }
};
template <>
struct hmesh::PixelTraits<Depth> {
    static constexpr double lowest = -1000, highest = 0;
    static constexpr bool is_integer = true;
    static double to_real(Depth sample) noexcept { return sample.value; }
};

namespace {

// Number k of entry (x, y).
template <int C>
double number(const MomentTable<C>& table, int x, int y, int k) {
    constexpr int lanes = MomentTable<C>::lanes;
    const auto entry = table.entry(x, y);
    return k < lanes ? entry.of_samples[k] : entry.by_column[k - lanes];
}

// How many numbers differ from sums over the view's pixels. Sums of integers must be equal, others to 1e-13 of the sum
// of their terms' magnitudes.
template <class T, int C>
int mistakes(const MomentTable<C>& table, const ImageView<T, C>& view, const Rect& rect) {
    int wrong = table.width() != rect.width || table.height() != rect.height;
    for (int y = 0; y < rect.height; ++y) {
        long double sum[2 * (C + 1)] = {}, size[2 * (C + 1)] = {};
        for (int x = 0; x <= rect.width; ++x) {
            for (int k = 0; k < 2 * MomentTable<C>::lanes; ++k) {
                const int half = k / MomentTable<C>::lanes, c = k % MomentTable<C>::lanes, i = half * (C + 1) + c;
                const double got = number(table, x, y, k);
                if (c > C) wrong += got != 0;  // padding
                else if (PixelTraits<T>::is_integer) wrong += static_cast<long double>(got) != sum[i];
                else wrong += !(std::abs(static_cast<long double>(got) - sum[i]) <= 1e-13L * size[i]);
            }
            if (x == rect.width) break;
            const auto add = [&](int i, long double value) {
                sum[i] += value;
                size[i] += std::abs(value);
            };
            const T* pixel = view.pixel(rect.x + x, rect.y + y);
            for (int c = 0; c < C; ++c) {
                const long double value = PixelTraits<T>::to_real(pixel[c]);
                add(c, value);
                add(C + 1 + c, x * value);
                add(2 * C + 1, value * value);
            }
            add(C, 1);
        }
    }
    return wrong;
}

template <int C>
bool same_bits(const MomentTable<C>& a, const MomentTable<C>& b) {
    if (a.width() != b.width() || a.height() != b.height() || a.is_int32() != b.is_int32()) return false;
    for (int y = 0; y < a.height(); ++y)
        for (int x = 0; x <= a.width(); ++x)
            for (int k = 0; k < MomentTable<C>::entry_size; ++k)
                if (number(a, x, y, k) != number(b, x, y, k)) return false;
    return true;
}

// How many numbers of a weighted table differ from sums over the view's pixels by more than 1e-13 of the sum of their
// terms' magnitudes.
template <class T, int C>
int weighted_mistakes(const MomentTable<C>& table, const ImageView<T, C>& view, const ImageView<float, 1>& weights, double unit,
                      const Rect& rect) {
    int wrong = table.width() != rect.width || table.height() != rect.height;
    wrong += !table.is_weighted() || table.is_int32();
    for (int y = 0; y < rect.height; ++y) {
        long double sum[2 * (C + 1) + 2] = {}, size[2 * (C + 1) + 2] = {};
        for (int x = 0; x <= rect.width; ++x) {
            const auto compare = [&](double got, int i) {
                wrong += !(std::abs(static_cast<long double>(got) - sum[i]) <= 1e-13L * size[i]);
            };
            for (int k = 0; k < MomentTable<C>::entry_size; ++k) {
                const int half = k / MomentTable<C>::lanes, c = k % MomentTable<C>::lanes;
                if (c > C) wrong += number(table, x, y, k) != 0;  // padding
                else compare(number(table, x, y, k), half * (C + 1) + c);
            }
            for (int k = 0; k < 2; ++k) compare(table.x_moments(table.offset(x, y))[k], 2 * (C + 1) + k);
            if (x == rect.width) break;
            const auto add = [&](int i, long double value) {
                sum[i] += value;
                size[i] += std::abs(value);
            };
            const T* pixel = view.pixel(rect.x + x, rect.y + y);
            const long double w = hmesh::kit::WeightScale(unit, view.width, view.height)(*weights.pixel(rect.x + x, rect.y + y));
            for (int c = 0; c < C; ++c) {
                const long double value = PixelTraits<T>::to_real(pixel[c]);
                add(c, w * value);
                add(C + 1 + c, w * x * value);
                add(2 * C + 1, w * value * value);
            }
            add(C, w);
            add(2 * C + 2, w * x);
            add(2 * C + 3, w * x * x);
        }
    }
    return wrong;
}

template <int C>
bool same_powers(const MomentTable<C>& a, const MomentTable<C>& b) {
    for (int y = 0; y < a.height(); ++y)
        for (int x = 0; x <= a.width(); ++x)
            for (int k = 0; k < 2; ++k)
                if (a.x_moments(a.offset(x, y))[k] != b.x_moments(b.offset(x, y))[k]) return false;
    return true;
}

}  // namespace

TEST_CASE_TEMPLATE("MomentTable holds the prefix sums of each row, exact for integers, for any type and number of channels", K,
                   Kind<std::uint8_t, 1>, Kind<std::uint8_t, 2>, Kind<std::uint8_t, 3>, Kind<std::uint8_t, 4>,
                   Kind<std::uint8_t, 5>, Kind<std::uint8_t, 7>, Kind<std::uint8_t, 8>, Kind<std::uint8_t, 16>,
                   Kind<std::uint16_t, 1>, Kind<std::uint16_t, 3>, Kind<std::uint16_t, 4>, Kind<std::uint16_t, 16>,
                   Kind<float, 1>, Kind<float, 3>, Kind<float, 7>, Kind<Signed, 2>, Kind<Signed, 3>) {
    using T = typename K::T;
    constexpr int n = K::channels;
    // Widths around the multiples of 8, where a strip of the table is full.
    for (const int width : {1, 2, 7, 8, 9, 16, 33})
        for (const int height : {1, 2, 37}) {
            const Image<T, n> image = hmesh_test::noise<T, n>(width, height, 1);
            const MomentTable<n> table(image.view(), image.view().bounds());
            CHECK(mistakes(table, image.view(), image.view().bounds()) == 0);
        }
}

TEST_CASE("MomentTable sums negative samples of a user's type exactly") {
    Image<Signed, 2> image(50, 9);
    hmesh::kit::Random random(1);
    hmesh_test::for_each_sample(
        image, [&](Signed& sample) { sample.value = static_cast<std::int8_t>(static_cast<int>(random.below(201)) - 100); });
    const MomentTable<2> table(image.view(), image.view().bounds());
    CHECK(table.is_int32());
    CHECK(mistakes(table, image.view(), image.view().bounds()) == 0);
    CHECK_FALSE(MomentTable<3>(Image<Signed, 3>(8, 8).view(), {0, 0, 8, 8}).is_int32());  // no bytes
}

TEST_CASE("MomentTable: a sample is as large as its distance from 0, above or below, in sums that 32 bits hold or not") {
    // 1000 w (w - 1) / 2 < 2^31 up to 2072 px.
    for (const int width : {2072, 2073}) {
        Image<Depth, 1> image(width, 2);
        hmesh_test::for_each_sample(image, [](Depth& sample) { sample.value = -1000; });
        const MomentTable<1> table(image.view(), image.view().bounds());
        CHECK(table.is_int32() == (width == 2072));
        CHECK(mistakes(table, image.view(), image.view().bounds()) == 0);
    }
}

TEST_CASE("MomentTable: sums of samples that 16 bits with a sign do not hold are doubles, however few") {
    for (const int most : {32767, 32768, 46340}) {
        const auto read = [&](int, int, int count, auto* to) {
            for (int i = 0; i < count; ++i) to[i] = static_cast<std::remove_reference_t<decltype(*to)>>(most);
        };
        const MomentTable<1> table({0, 0, 1, 2}, {read, read, {}}, {static_cast<double>(most), false, false});
        CHECK(table.is_int32() == (most == 32767));
        CHECK(table.entry(1, 1).of_samples[0] == most);
        CHECK(table.entry(1, 1).by_column[1] == static_cast<double>(most) * most);
    }
}

TEST_CASE("MomentTable: 8-bit sums stay in 32 bits as long as the brightest image fits, and are exact on both sides of it") {
    const auto is_int32 = [](const auto& image) {
        const auto view = image.view();
        const MomentTable table(view, view.bounds());
        CHECK(mistakes(table, view, view.bounds()) == 0);
        return table.is_int32();
    };
    // 255 w (w - 1) / 2 < 2^31 up to 4104 px; with 16 channels 16 * 255^2 w < 2^31 up to 2064 px.
    CHECK(is_int32(hmesh_test::constant_image<std::uint8_t, 1>(4104, 2, 1)));
    CHECK_FALSE(is_int32(hmesh_test::constant_image<std::uint8_t, 1>(4105, 2, 1)));
    CHECK(is_int32(hmesh_test::constant_image<std::uint8_t, 3>(4104, 2, 1)));
    CHECK_FALSE(is_int32(hmesh_test::constant_image<std::uint8_t, 3>(4105, 2, 1)));
    CHECK(is_int32(hmesh_test::constant_image<std::uint8_t, 16>(2064, 2, 1)));
    CHECK_FALSE(is_int32(hmesh_test::constant_image<std::uint8_t, 16>(2065, 2, 1)));
    CHECK(is_int32(hmesh_test::constant_image<std::uint16_t, 1>(1, 1, 0)) == false);
    CHECK_FALSE(is_int32(hmesh_test::constant_image<std::uint16_t, 3>(65536, 1, 1)));
    CHECK_FALSE(is_int32(hmesh_test::constant_image<std::uint8_t, 3>(65536, 1, 1)));
    CHECK_FALSE(is_int32(hmesh_test::noise<float, 1>(5, 5, 1)));
}

TEST_CASE_TEMPLATE("MomentTable of a rectangle is the table of that part alone, in local coordinates", K, Kind<std::uint8_t, 3>,
                   Kind<std::uint16_t, 3>, Kind<float, 2>, Kind<std::uint8_t, 1>) {
    using T = typename K::T;
    constexpr int n = K::channels;
    const Image<T, n> image = hmesh_test::noise<T, n>(60, 40, 2);
    hmesh::kit::Random random(3);
    for (int round = 0; round < 30; ++round) {
        Rect rect;
        rect.width = 1 + static_cast<int>(random.below(60));
        rect.height = 1 + static_cast<int>(random.below(40));
        rect.x = static_cast<int>(random.below(static_cast<std::size_t>(61 - rect.width)));
        rect.y = static_cast<int>(random.below(static_cast<std::size_t>(41 - rect.height)));
        Image<T, n> part(rect.width, rect.height);
        for (int y = 0; y < rect.height; ++y)
            for (int x = 0; x < rect.width; ++x)
                for (int c = 0; c < n; ++c) part.pixel(x, y)[c] = image.pixel(rect.x + x, rect.y + y)[c];
        const MomentTable<n> table(image.view(), rect);
        CHECK(same_bits(table, MomentTable<n>(part.view(), part.view().bounds())));
        CHECK(mistakes(table, image.view(), rect) == 0);
    }
}

TEST_CASE("MomentTable depends on the pixels alone: not on the stride, and not on the order of the work") {
    const Image<std::uint8_t, 3> bytes = hmesh_test::noise<std::uint8_t, 3>(45, 70, 4);
    const Image<float, 4> floats = hmesh_test::noise<float, 4>(45, 70, 4);
    const Rect rect{3, 5, 40, 61};
    const MomentTable<3> from_bytes(bytes.view(), rect);
    const MomentTable<4> from_floats(floats.view(), rect);
    for (const int padding : {0, 5})
        for (const bool bottom_up : {false, true}) {
            const hmesh_test::PaddedCopy<std::uint8_t, 3> byte_copy(bytes, padding, bottom_up, 200);
            const hmesh_test::PaddedCopy<float, 4> float_copy(floats, padding, bottom_up,
                                                              std::numeric_limits<float>::quiet_NaN());
            CHECK(same_bits(MomentTable<3>(byte_copy.view(), rect), from_bytes));
            CHECK(same_bits(MomentTable<4>(float_copy.view(), rect), from_floats));
        }
    CHECK(same_bits(MomentTable<3>(bytes.view(), rect, hmesh_test::ReverseFor()), from_bytes));
    CHECK(same_bits(MomentTable<4>(floats.view(), rect, hmesh_test::ReverseFor()), from_floats));
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        CHECK(same_bits(MomentTable<3>(bytes.view(), rect, hmesh_test::ShuffledFor{seed}), from_bytes));
        CHECK(same_bits(MomentTable<4>(floats.view(), rect, hmesh_test::ShuffledFor{seed}), from_floats));
    }
}

TEST_CASE_TEMPLATE("MomentTable::pixel gives the samples back, and zeros in the lanes above", K, Kind<std::uint8_t, 1>,
                   Kind<std::uint8_t, 3>, Kind<std::uint8_t, 5>, Kind<std::uint16_t, 4>, Kind<float, 2>) {
    using T = typename K::T;
    constexpr int n = K::channels;
    const Image<T, n> image = hmesh_test::noise<T, n>(31, 9, 5);
    const Rect rect{4, 2, 25, 6};
    const MomentTable<n> table(image.view(), rect);
    int wrong = 0;
    for (int y = 0; y < rect.height; ++y)
        for (int x = 0; x < rect.width; ++x) {
            hmesh::kit::Lanes<MomentTable<n>::lanes> samples = hmesh::kit::Lanes<MomentTable<n>::lanes>::all(99);
            table.pixel(x, y, samples);
            for (int k = 0; k < MomentTable<n>::lanes; ++k) {
                const double expected = k < n ? PixelTraits<T>::to_real(image.pixel(rect.x + x, rect.y + y)[k]) : 0;
                wrong += !(std::abs(samples[k] - expected) <= (PixelTraits<T>::is_integer ? 0.0 : 1e-13));
            }
        }
    CHECK(wrong == 0);
}

TEST_CASE_TEMPLATE("a weighted MomentTable holds the weighted prefix sums of each row, for weights that may be 0", K,
                   Kind<std::uint8_t, 1>, Kind<std::uint8_t, 2>, Kind<std::uint8_t, 3>, Kind<std::uint8_t, 4>,
                   Kind<std::uint8_t, 8>, Kind<std::uint16_t, 1>, Kind<std::uint16_t, 3>, Kind<std::uint16_t, 8>, Kind<float, 1>,
                   Kind<float, 2>, Kind<float, 3>, Kind<float, 4>, Kind<Signed, 2>) {
    using T = typename K::T;
    constexpr int n = K::channels;
    for (const int width : {1, 2, 3, 7, 16, 33})
        for (const int height : {1, 2, 37}) {
            const Image<T, n> image = hmesh_test::noise<T, n>(width, height, 1);
            const Image<float, 1> weights = hmesh_test::random_weights(width, height, 2), zeros(width, height);
            const Rect whole = image.view().bounds();
            for (const double unit : {1.0, 1.0 / 37}) {
                const MomentTable<n> table(image.view(), weights.view(), unit, whole);
                CHECK(weighted_mistakes(table, image.view(), weights.view(), unit, whole) == 0);
            }
            const MomentTable<n> empty(image.view(), zeros.view(), 1, whole);
            CHECK(weighted_mistakes(empty, image.view(), zeros.view(), 1, whole) == 0);
            if (width < 7) continue;
            const Rect rect{2, height / 2, width - 3, height - height / 2};
            const MomentTable<n> part(image.view(), weights.view(), 0.5, rect);
            CHECK(weighted_mistakes(part, image.view(), weights.view(), 0.5, rect) == 0);
        }
}

TEST_CASE("a weighted MomentTable has the sums of the widest rows too") {
    const Image<std::uint8_t, 1> image = hmesh_test::noise<std::uint8_t, 1>(65536, 1, 1);
    const Image<float, 1> weights = hmesh_test::random_weights(65536, 1, 2);
    const Rect row = image.view().bounds();
    CHECK(weighted_mistakes(MomentTable<1>(image.view(), weights.view(), 1, row), image.view(), weights.view(), 1, row) == 0);
}

TEST_CASE_TEMPLATE("a MomentTable with weights that have no data is the table without weights", K, Kind<std::uint8_t, 3>,
                   Kind<std::uint16_t, 1>, Kind<float, 2>) {
    using T = typename K::T;
    constexpr int n = K::channels;
    const Image<T, n> image = hmesh_test::noise<T, n>(45, 20, 4);
    const Rect rect{3, 5, 40, 11};
    const MomentTable<n> table(image.view(), ImageView<float, 1>{}, 0.25, rect), plain(image.view(), rect);
    CHECK_FALSE(table.is_weighted());
    CHECK_FALSE(plain.is_weighted());
    CHECK(same_bits(table, plain));
    CHECK(table.bytes() == plain.bytes());
    CHECK(mistakes(table, image.view(), rect) == 0);
}

TEST_CASE("a weighted MomentTable depends on pixels and weights alone: not on strides, nor on the order of the work") {
    const Image<std::uint8_t, 3> image = hmesh_test::noise<std::uint8_t, 3>(45, 70, 4);
    const Image<float, 1> weights = hmesh_test::random_weights(45, 70, 5);
    const hmesh_test::PaddedCopy<float, 1> copy(weights, 3, true, std::numeric_limits<float>::quiet_NaN());
    const Rect rect{3, 5, 40, 61};
    const MomentTable<3> table(image.view(), weights.view(), 0.3, rect);
    const auto same = [&](const MomentTable<3>& other) { return same_bits(other, table) && same_powers(other, table); };
    CHECK(same(MomentTable<3>(image.view(), copy.view(), 0.3, rect)));
    CHECK(same(MomentTable<3>(image.view(), weights.view(), 0.3, rect, hmesh_test::ReverseFor())));
    for (std::uint64_t seed = 1; seed <= 5; ++seed)
        CHECK(same(MomentTable<3>(image.view(), weights.view(), 0.3, rect, hmesh_test::ShuffledFor{seed})));
}

TEST_CASE_TEMPLATE("MomentTable::pixel gives the samples back whatever the weights, also of 0", K, Kind<std::uint8_t, 1>,
                   Kind<std::uint8_t, 3>, Kind<std::uint16_t, 4>, Kind<float, 2>) {
    using T = typename K::T;
    constexpr int n = K::channels;
    const Image<T, n> image = hmesh_test::noise<T, n>(31, 9, 5);
    const Rect rect{4, 2, 25, 6};
    int wrong = 0;
    for (const Image<float, 1>& weights : {hmesh_test::random_weights(31, 9, 6), Image<float, 1>(31, 9)}) {
        const MomentTable<n> table(image.view(), weights.view(), 0.7, rect);
        for (int y = 0; y < rect.height; ++y)
            for (int x = 0; x < rect.width; ++x) {
                hmesh::kit::Lanes<MomentTable<n>::lanes> samples = hmesh::kit::Lanes<MomentTable<n>::lanes>::all(99);
                table.pixel(x, y, samples);
                for (int k = 0; k < MomentTable<n>::lanes; ++k)
                    wrong += samples[k] != (k < n ? PixelTraits<T>::to_real(image.pixel(rect.x + x, rect.y + y)[k]) : 0.0);
            }
    }
    CHECK(wrong == 0);
}

TEST_CASE_TEMPLATE("MomentTable::weight says how often a pixel counts: its scaled weight, or once where none are given", K,
                   Kind<std::uint8_t, 1>, Kind<std::uint8_t, 3>, Kind<std::uint16_t, 4>, Kind<float, 2>) {
    using T = typename K::T;
    constexpr int n = K::channels;
    const Image<T, n> image = hmesh_test::noise<T, n>(31, 9, 5);
    const Image<float, 1> weights = hmesh_test::random_weights(31, 9, 6);
    const double unit = hmesh::kit::weight_unit(weights.view());
    const hmesh::kit::WeightScale scale(unit, 31, 9);
    const Rect rect{4, 2, 25, 6};
    const MomentTable<n> table(image.view(), weights.view(), unit, rect), plain(image.view(), rect);
    int wrong = 0, zeros = 0, large = 0;
    for (int y = 0; y < rect.height; ++y)
        for (int x = 0; x < rect.width; ++x) {
            const float weight = *weights.pixel(rect.x + x, rect.y + y);
            wrong += table.weight(x, y) != scale(weight);  // multiples of a step: sums and differences are exact
            wrong += !(std::abs(table.weight(x, y) - unit * static_cast<double>(weight)) <= 0.5 * scale.step());
            wrong += plain.weight(x, y) != 1;
            zeros += weight == 0;
            large += table.weight(x, y) > 0.5;
        }
    CHECK(wrong == 0);
    CHECK(zeros > 10);
    CHECK(large > 10);
}

TEST_CASE("a weighted MomentTable takes 92 bytes a pixel for RGB, and less than 8 columns more") {
    const Image<std::uint8_t, 3> image(100, 50);
    const Image<float, 1> weights(100, 50);
    const MomentTable<3> table(image.view(), weights.view(), 1, image.view().bounds());
    CHECK(table.bytes() >= 92U * 100 * 50);
    CHECK(table.bytes() <= 92U * 108 * 50);
}

TEST_CASE("MomentTable takes 16 bytes a pixel for 8-bit RGB, 32 with alpha, and less than 4 columns more; 64 bytes a column") {
    const Image<std::uint8_t, 3> image(100, 50);
    const MomentTable<3> table(image.view(), image.view().bounds());
    const std::size_t columns = 64U * 101, entries = table.bytes() - columns;
    CHECK(entries >= 16U * 101 * 50);
    CHECK(entries <= 16U * 104 * 50);
    const Image<std::uint8_t, 4> with_alpha(100, 50);
    CHECK(MomentTable<4>(with_alpha.view(), with_alpha.view().bounds()).bytes() == 2 * entries + columns);
    CHECK(MomentTable<3>().bytes() == 0);
}

TEST_CASE("fits_memory is true of no table that is larger than what can be addressed, and of nearly all others") {
    using Table = MomentTable<4>;
    const Image<std::uint8_t, 4> image(33, 9);
    const Image<float, 1> weights(33, 9);
    const Table table(image.view(), weights.view(), 1.0, hmesh::kit::Rect{0, 0, 33, 9});
    const auto bytes = static_cast<std::int64_t>(table.bytes());
    CHECK(Table::fits_memory(33, 9, 2 * bytes));
    CHECK_FALSE(Table::fits_memory(33, 9, bytes - 1));
    // 65536 x 4096 px of 16 numbers are 0 numbers in 32 bits.
    CHECK_FALSE(Table::fits_memory(65536, 4096, std::numeric_limits<std::int32_t>::max()));
    CHECK(Table::fits_memory(65536, 4096, std::numeric_limits<std::int64_t>::max()));
    CHECK(Table::fits_memory(65536, 4096) == (sizeof(std::ptrdiff_t) > 4));
}
