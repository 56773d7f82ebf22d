#include "hmesh/image/weights.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <string>

#include "hmesh/core/random.hpp"
#include "test_executors.hpp"
#include "test_images.hpp"

using hmesh::Errc;
using hmesh::Image;
using hmesh::ImageView;
using hmesh::Status;
using hmesh::kit::check_weights;
using hmesh::kit::weight_sum;
using hmesh::kit::weight_unit;
using hmesh::kit::WeightScale;

namespace {

constexpr float sample = 1;

bool refused(const Status& status, Errc code, std::int64_t got, std::int64_t want) {
    CHECK(status.code == code);
    CHECK(std::string(status.what).size() > 10);
    CHECK(status.value == got);
    CHECK(status.limit == want);
    return !status;
}

}  // namespace

TEST_CASE("no weights are weights of 1 for every pixel") {
    const ImageView<float, 1> none;
    CHECK(check_weights(none, 7, 5));
    CHECK(check_weights(ImageView<float, 1>{nullptr, 3, 2, 1}, 7, 5));
    CHECK(weight_unit(none) == 1);
    CHECK(weight_sum(none, weight_unit(none), 7, 5) == 35);
    CHECK(weight_sum(none, 1, 65536, 65536) == 4294967296.0);
}

TEST_CASE("check_weights refuses weights of another size than the image's") {
    CHECK(refused(check_weights({&sample, 4, 3, 0}, 5, 3), Errc::invalid_argument, 4, 5));
    CHECK(refused(check_weights({&sample, 4, 3, 0}, 4, 2), Errc::invalid_argument, 3, 2));
    CHECK(refused(check_weights({&sample, 0, 0, 0}, 4, 2), Errc::invalid_argument, 0, 4));
    CHECK(refused(check_weights({&sample, 1, -1, 0}, 1, 1), Errc::invalid_argument, -1, 1));
    CHECK(check_weights({&sample, 1, 1, 0}, 1, 1));
}

TEST_CASE("check_weights refuses strides and sizes that check() refuses") {
    CHECK(refused(check_weights({&sample, 10, 4, 36}, 10, 4), Errc::invalid_argument, 36, 40));
    CHECK(refused(check_weights({&sample, 10, 4, -41}, 10, 4), Errc::invalid_argument, 41, 4));
    CHECK(refused(check_weights({&sample, 0, 0, 0}, 0, 0), Errc::invalid_argument, 0, 1));
    CHECK(refused(check_weights({&sample, 65537, 1, 0}, 65537, 1), Errc::image_too_large, 65537, 65536));
}

TEST_CASE("check_weights refuses NaN, infinities and negative weights, and tells the first row with one") {
    const Image<float, 1> good = hmesh_test::noise<float, 1>(41, 70, 1);
    CHECK(check_weights(good.view(), 41, 70));
    constexpr float infinity = std::numeric_limits<float>::infinity();
    for (const float bad :
         {infinity, -infinity, std::numeric_limits<float>::quiet_NaN(), -1.0F, -std::numeric_limits<float>::denorm_min()})
        for (const int row : {0, 31, 32, 69})
            for (const int column : {0, 40}) {
                Image<float, 1> weights = good;
                weights.pixel(column, row)[0] = bad;
                if (row < 69) weights.pixel(20, 69)[0] = bad;
                const Errc code = std::isfinite(bad) ? Errc::invalid_argument : Errc::not_finite;
                CHECK(refused(check_weights(weights.view(), 41, 70), code, row, 0));
                CHECK(refused(check_weights(weights.view(), 41, 70, hmesh_test::ReverseFor()), code, row, 0));
            }
    Image<float, 1> both = good;
    both.pixel(3, 5)[0] = -1;
    both.pixel(9, 5)[0] = infinity;
    CHECK(refused(check_weights(both.view(), 41, 70), Errc::not_finite, 5, 0));
    Image<float, 1> extreme(2, 2);
    const float extremes[] = {-0.0F, std::numeric_limits<float>::max(), std::numeric_limits<float>::denorm_min(), 0.0F};
    std::copy(std::begin(extremes), std::end(extremes), extreme.data());
    CHECK(check_weights(extreme.view(), 2, 2));
}

TEST_CASE("check_weights looks at no padding") {
    const Image<float, 1> good = hmesh_test::noise<float, 1>(9, 6, 1);
    for (const bool bottom_up : {false, true}) {
        const hmesh_test::PaddedCopy<float, 1> copy(good, 3, bottom_up, std::numeric_limits<float>::quiet_NaN());
        CHECK(check_weights(copy.view(), 9, 6));
        CHECK(weight_unit(copy.view()) == weight_unit(good.view()));
        CHECK(weight_sum(copy.view(), 0.5, 9, 6) == weight_sum(good.view(), 0.5, 9, 6));
    }
}

TEST_CASE("weight_unit makes the largest weight 1, whatever its size, and is 1 where all are 0") {
    CHECK(weight_unit(Image<float, 1>(4, 3).view()) == 1);
    for (const float largest : {1.0F, 255.0F, 0.3F, std::numeric_limits<float>::max(), std::numeric_limits<float>::denorm_min()})
        for (const int at : {0, 17, 59}) {
            Image<float, 1> weights(6, 10);
            weights.data()[5] = 0.5F * largest;
            weights.data()[static_cast<std::size_t>(at)] = largest;
            const double unit = weight_unit(weights.view());
            CHECK(std::isfinite(unit));
            CHECK(std::abs(unit * static_cast<double>(largest) - 1) < 1e-15);
            CHECK(weight_unit(weights.view(), hmesh_test::ReverseFor()) == unit);
        }
}

TEST_CASE("WeightScale rounds scaled weights to a step that is fine for small images and never coarser than 1/256") {
    const auto digits = [](int width, int height) {
        const WeightScale scale(1, width, height);
        CHECK(scale(0.0F) == 0);
        CHECK(scale(1.0F) == 1);
        hmesh::kit::Random random(1);
        for (int k = 0; k < 1000; ++k) {
            const auto weight = static_cast<float>(random.uniform());
            const double rounded = scale(weight), steps = rounded / scale.step();
            CHECK(std::floor(steps) == steps);
            CHECK(std::abs(rounded - static_cast<double>(weight)) <= 0.5 * scale.step());
        }
        return -std::log2(scale.step());
    };
    CHECK(digits(1, 1) == 24);
    CHECK(digits(61, 52) == 24);
    CHECK(digits(512, 512) == 20);
    CHECK(digits(4000, 3000) == 12);
    CHECK(digits(65536, 4096) == 8);
    CHECK(digits(4096, 65536) == 8);
    CHECK(digits(65536, 1) == 8);
}

TEST_CASE("scaled weights do not depend on the unit of the weights, and 0 stays 0") {
    hmesh::kit::Random random(2);
    for (int k = 0; k < 1000; ++k) {
        const auto weight = static_cast<double>(random.below(256));
        const WeightScale scale(1.0 / 255, 600, 400);
        CHECK(scale(static_cast<float>(weight)) == WeightScale(1.0 / 1020, 600, 400)(static_cast<float>(4 * weight)));
        CHECK((scale(static_cast<float>(weight)) == 0) == (weight == 0));
    }
    CHECK(WeightScale(1.0 / 255, 600, 400)(255.0F) == 1);
}

TEST_CASE("weight_sum adds the scaled weights, to the same bits in any order of the work") {
    const Image<float, 1> weights = hmesh_test::noise<float, 1>(57, 131, 3);
    long double expected = 0;
    for (const float weight : hmesh_test::samples_of(weights)) expected += static_cast<long double>(weight) * 0.37L;
    const double sum = weight_sum(weights.view(), 0.37, 57, 131);
    const auto step = static_cast<long double>(WeightScale(0.37, 57, 131).step());
    CHECK(std::abs(static_cast<long double>(sum) - expected) <= 57 * 131 * 0.5L * step);
    CHECK(weight_sum(weights.view(), 0.37, 57, 131, hmesh_test::ReverseFor()) == sum);
    for (std::uint64_t seed = 1; seed <= 5; ++seed)
        CHECK(weight_sum(weights.view(), 0.37, 57, 131, hmesh_test::ShuffledFor{seed}) == sum);
    CHECK(weight_sum(Image<float, 1>(4, 3).view(), 1, 4, 3) == 0);
    CHECK(weight_sum(hmesh_test::constant_image<float, 1>(4, 3, 0.5).view(), 2, 4, 3) == 12);
}
