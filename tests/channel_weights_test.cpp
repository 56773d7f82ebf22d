#include "hmesh/image/channel_weights.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "hmesh/methods/hierarchical/hierarchical.hpp"
#include "test_executors.hpp"
#include "test_images.hpp"
#include "test_meshing.hpp"
#include "test_results.hpp"

using hmesh::Annealed;
using hmesh::Effort;
using hmesh::Errc;
using hmesh::Image;
using hmesh::mesh_image;
using hmesh::Options;
using hmesh::Result;
using hmesh::Target;

namespace {

using Weights = std::vector<double>;

Options options_of(std::int64_t vertices, Weights weights) {
    Options options;
    options.target = Target::vertices(vertices);
    options.channel_weights = std::move(weights);
    return options;
}

// The squared error of one channel, drawn pixel by pixel.
template <class T, int C>
double error_of(const Image<T, C>& image, const Result& result, int channel) {
    const Image<float, C> picture = hmesh_test::drawn<C>(result.mesh);
    double sum = 0;
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x) {
            const double difference =
                static_cast<double>(picture.pixel(x, y)[channel]) - static_cast<double>(image.pixel(x, y)[channel]);
            sum += difference * difference;
        }
    return sum;
}

// Energy and PSNR are what the weights make of the channels' errors.
template <class T, int C>
void prove_weighted(const Image<T, C>& image, const Result& result, const Weights& weights) {
    REQUIRE_MESSAGE(result.status, hmesh::message(result.status).c_str());
    CHECK(hmesh_test::flaw_of(result.mesh.view(), image.width(), image.height()) == "");
    const double largest = *std::max_element(weights.begin(), weights.end());
    double energy = 0, channels = 0;
    for (int c = 0; c < C; ++c) {
        const double weight = weights[static_cast<std::size_t>(c)] / largest;
        energy += weight * error_of(image, result, c);
        channels += weight;
    }
    CHECK(result.report.energy == doctest::Approx(energy).epsilon(1e-4));
    const double peak = hmesh::PixelTraits<T>::peak, samples = channels * image.width() * image.height();
    CHECK(result.report.psnr == doctest::Approx(10 * std::log10(peak * peak * samples / energy)).epsilon(1e-5));
    CHECK(result.report.stages.back().energy == result.report.energy);
    // The stage before has told the error of the scaled copy, whose colours are free, in the units of the image.
    const hmesh::StageReport& before = result.report.stages[result.report.stages.size() - 2];
    CHECK(before.psnr == doctest::Approx(result.report.psnr).epsilon(0.05));
}

template <class T>
void prove_type(double tolerance) {
    const auto image = hmesh_test::draw<T, 3>(61, 47, hmesh_test::Scene(61, 47, 3));
    const Weights weights{1, 0.25, 2};
    const Result result = mesh_image(image.view(), options_of(150, weights), Annealed{Effort::draft});
    prove_weighted(image, result, weights);
    CHECK(result.report.vertices == 150);
    CHECK(result.mesh.peak == hmesh::PixelTraits<T>::peak);
    // Each channel has its best colours, weights or not: a common shift of one of them cannot help.
    for (int c = 0; c < 3; ++c) {
        Result shifted = result;
        for (std::size_t k = static_cast<std::size_t>(c); k < shifted.mesh.colors.size(); k += 3)
            shifted.mesh.colors[k] += static_cast<float>(tolerance);
        CHECK(error_of(image, shifted, c) > error_of(image, result, c));
    }
}

Errc refused(const Weights& weights) {
    const auto status = hmesh::kit::check_channel_weights(weights, 3);
    CHECK(!status);
    return status.code;
}

}  // namespace

TEST_CASE("weights must be one for each channel, finite, not negative, and not all 0") {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    CHECK(hmesh::kit::check_channel_weights({}, 3));
    CHECK(hmesh::kit::check_channel_weights({0, 0, 1e-30}, 3));
    CHECK(hmesh::kit::check_channel_weights({1e30, 0, 1e-300}, 3));
    CHECK(refused({1, 1}) == Errc::invalid_argument);
    CHECK(refused({1, 1, 1, 1}) == Errc::invalid_argument);
    CHECK(refused({1, -1e-9, 1}) == Errc::invalid_argument);
    CHECK(refused({1, infinity, 1}) == Errc::invalid_argument);
    CHECK(refused({1, 1, std::nan("")}) == Errc::invalid_argument);
    CHECK(refused({0, 0, 0}) == Errc::invalid_argument);
    CHECK(hmesh::kit::check_channel_weights({1, 1, 2e30}, 3).limit == 1e30);
    CHECK(hmesh::kit::check_channel_weights({1, 1, -1}, 3).limit == 0);
    const auto image = hmesh_test::noise<std::uint8_t, 3>(9, 9, 1);
    const Result result = mesh_image(image.view(), options_of(8, {1, 1}));
    CHECK(result.status.code == Errc::invalid_argument);
    CHECK(result.status.value == 2);
    CHECK(result.status.limit == 3);
    CHECK(!result.has_mesh());
}

TEST_CASE("equal weights, whatever they are, are no weights") {
    const auto image = hmesh_test::draw<std::uint8_t, 3>(50, 40, hmesh_test::Scene(50, 40, 1));
    const Result plain = mesh_image(image.view(), options_of(90, {}), Annealed{Effort::draft});
    const Result equal = mesh_image(image.view(), options_of(90, {0.3, 0.3, 0.3}), Annealed{Effort::draft});
    CHECK(hmesh_test::same_bytes(plain, equal));
}

TEST_CASE("values beyond the range of a scale are limited to it") {
    const auto scale = hmesh::kit::channel_scale<2>({-1, 3}, {4, 1});
    constexpr auto most = static_cast<double>(std::numeric_limits<float>::max());
    for (const auto& [value, wanted] : {std::pair{-1.0, -1.0}, {3, 3}, {0.3, 0.3}, {-1.1, -1}, {-most, -1}, {3.1, 3}, {most, 3}})
        CHECK(scale.limited(value) == wanted);
}

TEST_CASE("energy and PSNR are those of the weighted channels, for each type of samples") {
    prove_type<std::uint8_t>(1);
    prove_type<std::uint16_t>(40);
    prove_type<float>(0.003);
}

TEST_CASE("vertices are placed as in an image whose channels are scaled by the roots of the weights") {
    const auto image = hmesh_test::draw<std::uint16_t, 2>(64, 48, hmesh_test::Scene(64, 48, 4));
    Image<std::uint16_t, 2> scaled = hmesh_test::draw<std::uint16_t, 2>(64, 48, hmesh_test::Scene(64, 48, 4));
    for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 64; ++x) scaled.pixel(x, y)[1] = static_cast<std::uint16_t>(std::lround(0.5 * image.pixel(x, y)[1]));
    const Annealed recipe{Effort::fast};
    const Result weighted = mesh_image(image.view(), options_of(120, {12, 3}), recipe);
    const Result by_hand = mesh_image(scaled.view(), options_of(120, {}), recipe);
    CHECK(weighted.mesh.positions == by_hand.mesh.positions);
    CHECK(weighted.mesh.faces == by_hand.mesh.faces);
    CHECK(weighted.report.psnr == doctest::Approx(by_hand.report.psnr + 10 * std::log10(1.25 / 2)).epsilon(1e-3));
    prove_weighted(image, weighted, {12, 3});
}

TEST_CASE("a channel that counts more is more like the image, and one that counts nothing still gets its best colors") {
    const auto image = hmesh_test::draw<std::uint8_t, 3>(80, 60, hmesh_test::Scene(80, 60, 9));
    const auto run = [&](const Weights& weights) {
        return mesh_image(image.view(), options_of(120, weights), Annealed{Effort::fast});
    };
    const Result even = run({}), first = run({1, 0.05, 0.05}), alone = run({1, 0, 0});
    CHECK(error_of(image, first, 0) < 0.8 * error_of(image, even, 0));
    CHECK(error_of(image, first, 2) > error_of(image, even, 2));
    CHECK(error_of(image, alone, 0) < 1.1 * error_of(image, first, 0));
    prove_weighted(image, first, {1, 0.05, 0.05});
    prove_weighted(image, alone, {1, 0, 0});
    const Result constant = run({0, 0, 1});
    const double mean = error_of(image, constant, 0) / (80.0 * 60);
    CHECK(mean < 0.1 * 255 * 255);  // far better than any one colour
}

TEST_CASE("what a float channel that counts nothing holds moves no vertex") {
    const auto picture = [](double largest) {
        return hmesh_test::draw<float, 4>(96, 80, [=](int x, int y, int c) {
            return c == 3 ? largest * ((7 * x + 3 * y) % 100) / 100 : 0.5 + 0.4 * std::sin(0.1 * x + c) * std::cos(0.13 * y);
        });
    };
    Options options;
    options.target = Target::vertices(200);
    options.channel_weights = {1, 1, 1, 0};
    const Result small = mesh_image(picture(1e-3).view(), options), large = mesh_image(picture(1e6).view(), options);
    CHECK(small.mesh.positions == large.mesh.positions);
    CHECK(small.mesh.faces == large.mesh.faces);
#if defined(__FMA__)  // products may be contracted, of what counts nothing too
    CHECK(small.report.energy == doctest::Approx(large.report.energy).epsilon(1e-12));
#else
    CHECK(small.report.energy == large.report.energy);
#endif
}

TEST_CASE("weights of channels go with those of pixels, a PSNR as the target, a start, and any number of threads") {
    const auto image = hmesh_test::draw<std::uint8_t, 3>(300, 280, hmesh_test::Scene(300, 280, 2));
    const auto pixels = hmesh_test::random_weights(300, 280, 5);
    Options options = options_of(600, {1, 0.5, 0.125});
    options.weights = pixels.view();
    const Result one = mesh_image(image.view(), options, Annealed{Effort::draft});
    const Result three = mesh_image(image.view(), options, Annealed{Effort::draft}, hmesh_test::ShuffledFor{3});
    REQUIRE(one.status);
    CHECK(hmesh_test::same_bytes(one, three));

    options.weights = {};
    options.target = Target::psnr(40);
    const Result reached = mesh_image(image.view(), options, Annealed{Effort::draft});
    CHECK(reached.report.psnr >= 40);
    CHECK(reached.report.psnr < 42);
    prove_weighted(image, reached, {1, 0.5, 0.125});

    options.target = Target::vertices(static_cast<std::int64_t>(reached.report.vertices));
    Annealed go_on{Effort::draft};
    go_on.start = &reached.mesh;
    const Result again = mesh_image(image.view(), options, go_on);
    CHECK(again.report.psnr >= reached.report.psnr - 0.1);
    prove_weighted(image, again, {1, 0.5, 0.125});
}

TEST_CASE("one pixel, constant images and constant channels have meshes") {
    for (const int size : {1, 2, 5}) {
        const auto image = hmesh_test::constant_image<float, 3>(size, size, 0.25);
        const Result result = mesh_image(image.view(), options_of(4, {1, 2, 0}));
        REQUIRE(result.status);
        CHECK(result.report.energy < 1e-9);
    }
    const auto noise = hmesh_test::noise<float, 1>(20, 20, 3);
    const auto image = hmesh_test::draw<float, 2>(
        20, 20, [&](int x, int y, int c) { return c == 0 ? 1e6 * static_cast<double>(noise.pixel(x, y)[0]) : -3.0; });
    const Result result = mesh_image(image.view(), options_of(60, {1, 100}));
    REQUIRE(result.status);
    CHECK(error_of(image, result, 1) < 1);
}

TEST_CASE("a method that reads the pixels by itself refuses weights that differ") {
    const auto image = hmesh_test::noise<std::uint8_t, 3>(16, 16, 1);
    CHECK(mesh_image(image.view(), options_of(20, {1, 2, 1}), hmesh::Hierarchical{}).status.code == Errc::invalid_argument);
    CHECK(mesh_image(image.view(), options_of(20, {2, 2, 2}), hmesh::Hierarchical{}).status);
}
