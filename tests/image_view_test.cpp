#include "hmesh/image/image_view.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "test_executors.hpp"
#include "test_images.hpp"

using hmesh::Errc;
using hmesh::Image;
using hmesh::ImageView;
using hmesh::PixelTraits;
using hmesh::Status;
using hmesh::kit::check_finite;
using hmesh_test::samples_of;

static_assert(std::is_aggregate_v<ImageView<std::uint8_t, 3>>);
static_assert(std::is_trivially_copyable_v<ImageView<float, 16>>);

// Larger than a cache line: a height among other numbers.
struct Record {
    double height = 0;
    double others[9] = {};
};

template <>
struct hmesh::PixelTraits<Record> {
    static constexpr double peak = 1, lowest = 0, highest = 1;
    static constexpr bool is_integer = false;
    static double to_real(const Record& value) noexcept { return value.height; }
    static Record from_real(double value) noexcept { return {value, {}}; }
};

template <>
struct hmesh::PixelTraits<double> {
    static constexpr double peak = 1, lowest = -1e308, highest = 1e308;
    static constexpr bool is_integer = false;
    static double to_real(double value) noexcept { return value; }
    static double from_real(double value) noexcept { return value; }
};

namespace {

template <class T, int C>
bool refused(const ImageView<T, C>& view, Errc code, std::int64_t value, std::int64_t limit) {
    const Status status = check(view);
    CHECK(status.code == code);
    CHECK(std::string(status.what).size() > 10);
    CHECK(status.value == value);
    CHECK(status.limit == limit);
    return !status;
}

constexpr std::uint8_t byte = 0;
constexpr std::uint16_t word = 0;

}  // namespace

TEST_CASE("check refuses a null pointer") {
    CHECK(refused(ImageView<std::uint8_t, 3>{nullptr, 4, 4, 0}, Errc::invalid_argument, 0, 0));
}

TEST_CASE("check refuses sizes of zero and below") {
    constexpr int lowest = std::numeric_limits<int>::min();
    for (const int size : {0, -1, -1000, lowest}) {
        CHECK(refused(ImageView<std::uint8_t, 3>{&byte, size, 4, 0}, Errc::invalid_argument, size, 1));
        CHECK(refused(ImageView<std::uint8_t, 3>{&byte, 4, size, 0}, Errc::invalid_argument, size, 1));
        CHECK(refused(ImageView<std::uint8_t, 3>{&byte, size, size, 0}, Errc::invalid_argument, size, 1));
    }
    CHECK(refused(ImageView<std::uint8_t, 3>{}, Errc::invalid_argument, 0, 1));
}

TEST_CASE("check refuses sides and products that are too large, also those that overflow 32 bits") {
    constexpr int largest = std::numeric_limits<int>::max();
    CHECK(refused(ImageView<std::uint8_t, 1>{&byte, hmesh::kit::max_side + 1, 1, 0}, Errc::image_too_large, 65537, 65536));
    CHECK(refused(ImageView<std::uint8_t, 1>{&byte, 1, hmesh::kit::max_side + 1, 0}, Errc::image_too_large, 65537, 65536));
    CHECK(refused(ImageView<std::uint8_t, 1>{&byte, largest, largest, 0}, Errc::image_too_large, largest, 65536));
    // 65536 * 65536 is 0 in 32 bits.
    CHECK(refused(ImageView<std::uint8_t, 1>{&byte, 65536, 65536, 0}, Errc::image_too_large, std::int64_t{1} << 32,
                  hmesh::kit::max_pixels));
    CHECK(refused(ImageView<std::uint8_t, 1>{&byte, 65536, 4097, 0}, Errc::image_too_large, 65536LL * 4097,
                  hmesh::kit::max_pixels));
}

TEST_CASE("check accepts the largest and the smallest sizes") {
    CHECK(check(ImageView<std::uint8_t, 1>{&byte, 65536, 4096, 0}));
    CHECK(check(ImageView<std::uint8_t, 3>{&byte, 1, 1, 0}));
    CHECK(check(ImageView<std::uint8_t, 3>{&byte, 1, 65536, 0}));
    CHECK(check(ImageView<std::uint8_t, 3>{&byte, 65536, 1, 0}));
}

TEST_CASE("check refuses packed images that need longer pointers, and only those") {
    constexpr ImageView<std::uint16_t, 16> large{&word, 4096, 65536, 0};
    constexpr ImageView<std::uint8_t, 7> small{&byte, 4096, 65536, 0};
    CHECK(check(small));
    if constexpr (sizeof(std::ptrdiff_t) > 4) CHECK(check(large));
    else CHECK(refused(large, Errc::image_too_large, std::int64_t{1} << 33U, std::numeric_limits<std::ptrdiff_t>::max()));
}

TEST_CASE("check refuses a stride smaller than a row, whichever its sign") {
    CHECK(refused(ImageView<std::uint8_t, 3>{&byte, 10, 4, 29}, Errc::invalid_argument, 29, 30));
    CHECK(refused(ImageView<std::uint8_t, 3>{&byte, 10, 4, 1}, Errc::invalid_argument, 1, 30));
    CHECK_FALSE(check(ImageView<std::uint8_t, 3>{&byte, 10, 4, -29}));
    CHECK(refused(ImageView<std::uint16_t, 3>{&word, 10, 4, 58}, Errc::invalid_argument, 58, 60));
    CHECK(check(ImageView<std::uint8_t, 3>{&byte, 10, 4, 30}));
    CHECK(check(ImageView<std::uint8_t, 3>{&byte, 10, 4, 31}));
    CHECK(check(ImageView<std::uint8_t, 3>{&byte, 10, 4, -30}));
    CHECK(check(ImageView<std::uint8_t, 3>{&byte, 10, 4, 0}));
}

TEST_CASE("check refuses a stride that would misalign the samples") {
    constexpr float sample = 0;
    CHECK(refused(ImageView<std::uint16_t, 1>{&word, 10, 4, 21}, Errc::invalid_argument, 21, 2));
    CHECK(check(ImageView<std::uint16_t, 1>{&word, 10, 4, 22}));
    for (const std::ptrdiff_t stride : {41, 42, 43, -41, -42, -43})
        CHECK_FALSE(check(ImageView<float, 1>{&sample, 10, 4, stride}));
    CHECK(check(ImageView<float, 1>{&sample, 10, 4, 44}));
    CHECK(check(ImageView<float, 1>{&sample, 10, 4, -44}));
}

TEST_CASE("check refuses a data pointer that is not aligned as its samples are") {
    alignas(float) unsigned char bytes[64]{};
    for (std::size_t offset = 0; offset < 8; ++offset) {
        const void* data = bytes + offset;
        CHECK(bool(check(ImageView<float, 1>{static_cast<const float*>(data), 2, 2, 0})) == (offset % alignof(float) == 0));
        CHECK(check(ImageView<std::uint8_t, 1>{static_cast<const std::uint8_t*>(data), 2, 2, 0}));
    }
}

TEST_CASE("check refuses strides so long that the place of the last row overflows a pointer difference") {
    constexpr std::ptrdiff_t lowest = std::numeric_limits<std::ptrdiff_t>::min();  // has no absolute value
    constexpr std::ptrdiff_t largest = std::numeric_limits<std::ptrdiff_t>::max();
    for (const std::ptrdiff_t stride : {lowest, lowest + 1, largest, largest / 2, lowest / 2})
        CHECK(check(ImageView<std::uint8_t, 3>{&byte, 10, 4, stride}).code == Errc::invalid_argument);
    if (sizeof(std::ptrdiff_t) < 8) return;
    // Nor are there so many bytes where it does not.
    CHECK(check(ImageView<std::uint8_t, 3>{&byte, 10, 4, largest / 8}).code == Errc::invalid_argument);
    CHECK(check(ImageView<std::uint8_t, 3>{&byte, 10, 1, largest / 8}).code == Errc::invalid_argument);
}

TEST_CASE_TEMPLATE("a padded view and a bottom-up view show the same pixels as the packed image", T, std::uint8_t, std::uint16_t,
                   float) {
    const Image<T, 3> image = hmesh_test::noise<T, 3>(7, 5, 1);
    for (const int padding : {0, 1, 6})
        for (const bool bottom_up : {false, true}) {
            const hmesh_test::PaddedCopy<T, 3> copy(image, padding, bottom_up, T(1));
            const ImageView<T, 3> view = copy.view();
            CHECK(check(view));
            CHECK((view.row_stride < 0) == bottom_up);
            for (int y = 0; y < 5; ++y)
                for (int x = 0; x < 7; ++x)
                    for (int c = 0; c < 3; ++c) CHECK(view.pixel(x, y)[c] == image.view().pixel(x, y)[c]);
        }
}

TEST_CASE("an Image is packed, starts at zero, and is empty by default") {
    Image<std::uint16_t, 4> image(5, 3);
    CHECK(image.width() == 5);
    CHECK(image.height() == 3);
    CHECK(image.size() == 60);
    CHECK(image.data() == image.view().data);
    CHECK(image.data() == image.pixel(0, 0));
    CHECK(samples_of(image) == std::vector<std::uint16_t>(60, 0));
    image.pixel(2, 1)[3] = 9;
    CHECK(image.data()[(1 * 5 + 2) * 4 + 3] == 9);
    CHECK(image.view().pixel(2, 1)[3] == 9);
    image.data()[0] = 5;
    const Image<std::uint16_t, 4> copy = image;
    CHECK(copy.data()[0] == 5);
    CHECK(copy.data() != image.data());
    CHECK(copy.size() == 60);
    static_assert(std::is_same_v<decltype(copy.data()), const std::uint16_t*>);
    CHECK(image.view().row_stride == 0);
    const hmesh::kit::Rect bounds = image.view().bounds();
    CHECK((bounds.x == 0 && bounds.y == 0 && bounds.width == 5 && bounds.height == 3));
    CHECK(Image<std::uint16_t, 4>().size() == 0);
    CHECK_FALSE(check(Image<std::uint16_t, 4>().view()));
    const Image<std::uint16_t, 4> raw(5, 3, hmesh::kit::raw);  // says nothing of its samples
    CHECK((raw.width() == 5 && raw.height() == 3 && raw.size() == 60));
    const Image<std::string, 2> words(4, 2, hmesh::kit::raw);
    CHECK((words.size() == 16 && words.data()[15].empty()));
}

TEST_CASE("check_finite names the first row with a NaN or an infinity, in any order of work") {
    constexpr float infinity = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    Image<float, 3> image = hmesh_test::noise<float, 3>(20, 100, 1);
    CHECK(check_finite(image.view()));
    image.pixel(0, 0)[0] = std::numeric_limits<float>::max();
    image.pixel(1, 0)[0] = std::numeric_limits<float>::denorm_min();
    CHECK(check_finite(image.view()));
    for (const float bad : {nan, infinity, -infinity})
        for (const int y : {0, 31, 32, 77, 99}) {
            Image<float, 3> broken = image;
            broken.pixel(19, 99)[2] = bad;
            broken.pixel(y == 99 ? 19 : 0, y)[y == 99 ? 2 : 0] = bad;
            for (const Status& status : {check_finite(broken.view()), check_finite(broken.view(), hmesh_test::ReverseFor()),
                                         check_finite(broken.view(), hmesh_test::ShuffledFor())}) {
                CHECK(status.code == Errc::not_finite);
                CHECK(status.value == y);
            }
        }
}

TEST_CASE("check_finite refuses doubles that no float holds") {
    Image<double, 1> image(3, 2);
    CHECK(check_finite(image.view()));
    *image.pixel(1, 1) = -3.4e38;
    CHECK(check_finite(image.view()));
    *image.pixel(1, 1) = -3.5e38;
    CHECK(check_finite(image.view()).code == Errc::not_finite);
    CHECK(check_finite(image.view()).value == 1);
}

TEST_CASE("check_finite reads no padding, and looks at bottom-up images too") {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    Image<float, 2> image = hmesh_test::noise<float, 2>(6, 4, 1);
    for (const bool bottom_up : {false, true})
        CHECK(check_finite(hmesh_test::PaddedCopy<float, 2>(image, 3, bottom_up, nan).view()));
    image.pixel(5, 1)[1] = nan;
    for (const bool bottom_up : {false, true})
        CHECK(check_finite(hmesh_test::PaddedCopy<float, 2>(image, 3, bottom_up, 0.0F).view()).value == 1);
}

TEST_CASE("check_finite accepts integers without reading them") {
    CHECK(check_finite(ImageView<std::uint8_t, 3>{nullptr, 65536, 4096, 0}));
    CHECK(check_finite(ImageView<std::uint16_t, 3>{nullptr, 65536, 4096, 0}));
}

TEST_CASE_TEMPLATE("PixelTraits of integers: rounds to nearest, clamps, and gives back every value", T, std::uint8_t,
                   std::uint16_t) {
    using Traits = PixelTraits<T>;
    constexpr int peak = std::numeric_limits<T>::max();
    static_assert(Traits::is_integer);
    CHECK(Traits::peak == peak);
    CHECK(Traits::lowest == 0);
    CHECK(Traits::highest == peak);
    int wrong = 0;
    for (int value = 0; value <= peak; ++value) {
        const T sample = static_cast<T>(value);
        wrong += Traits::to_real(sample) != value;
        wrong += Traits::from_real(value) != sample;
        wrong += Traits::from_real(value + 0.4999) != sample;
        wrong += Traits::from_real(value - 0.4999) != sample;
        wrong += value < peak && Traits::from_real(value + 0.5) != value + 1;
    }
    CHECK(wrong == 0);
    constexpr double infinity = std::numeric_limits<double>::infinity();
    CHECK(Traits::from_real(-0.6) == 0);
    CHECK(Traits::from_real(-1e300) == 0);
    CHECK(Traits::from_real(-infinity) == 0);
    CHECK(Traits::from_real(peak + 0.6) == peak);
    CHECK(Traits::from_real(1e300) == peak);
    CHECK(Traits::from_real(infinity) == peak);
    CHECK(Traits::from_real(std::numeric_limits<double>::quiet_NaN()) == 0);
}

TEST_CASE("PixelTraits of float: peak 1, values outside [0, 1] kept, everything finite stays finite") {
    using Traits = PixelTraits<float>;
    static_assert(!Traits::is_integer);
    CHECK(Traits::peak == 1);
    for (const float value : {0.0F, 1.0F, -3.5F, 12345.678F, std::numeric_limits<float>::max(),
                              -std::numeric_limits<float>::max(), std::numeric_limits<float>::denorm_min()})
        CHECK(Traits::from_real(Traits::to_real(value)) == value);
    CHECK(Traits::from_real(0.1) == 0.1F);
    CHECK(Traits::from_real(1e300) == std::numeric_limits<float>::max());
    CHECK(Traits::from_real(-1e300) == -std::numeric_limits<float>::max());
    CHECK(std::isfinite(Traits::from_real(std::numeric_limits<double>::infinity())));
}

TEST_CASE("the test scene is the same picture in every sample type, and has flat, steep and varied parts") {
    const Image<std::uint8_t, 3> bytes = hmesh_test::scene<std::uint8_t, 3>(60, 40, 5);
    const Image<std::uint16_t, 3> words = hmesh_test::scene<std::uint16_t, 3>(60, 40, 5);
    const Image<float, 3> floats = hmesh_test::scene<float, 3>(60, 40, 5);
    int different = 0, steep = 0, flat = 0;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        different += words.data()[i] != 257 * bytes.data()[i];
        different += floats.data()[i] != static_cast<float>(bytes.data()[i] / 255.0);
        if (i < 3) continue;
        const int step = std::abs(bytes.data()[i] - bytes.data()[i - 3]);
        steep += step > 30;
        flat += step <= 3;
    }
    CHECK(different == 0);
    CHECK(steep > 100);
    CHECK(flat > 3000);
    CHECK(samples_of(hmesh_test::scene<std::uint8_t, 3>(60, 40, 6)) != samples_of(bytes));
}

TEST_CASE("alpha at a threshold is not above it, whichever way it was rounded as a float, and one step of 16 bits more is") {
    using hmesh::kit::is_alpha_above;
    for (int threshold = 0; threshold <= 254; ++threshold) {
        const auto share = static_cast<double>(static_cast<float>(threshold) / 255);
        CHECK(!is_alpha_above(share, threshold, 1));
        CHECK(!is_alpha_above(257 * threshold, threshold, 65535));
        CHECK(is_alpha_above(257 * threshold + 1, threshold, 65535));
    }
}

TEST_CASE("pixels are read of samples of any size") {
    Image<Record, 2> image(3, 2);
    for (std::size_t i = 0; i < image.size(); ++i) image.data()[i].height = static_cast<double>(i);
    std::vector<double> read(6);
    hmesh::kit::read_pixels(image.view(), 0, 1, 3, read.data());
    CHECK(read == std::vector<double>{6, 7, 8, 9, 10, 11});
}
