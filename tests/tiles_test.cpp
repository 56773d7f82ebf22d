// mesh_image in tiles and with weights: what the result must be, told by pixels.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "hmesh/mesh_image.hpp"
#include "test_executors.hpp"
#include "test_images.hpp"
#include "test_meshing.hpp"
#include "test_results.hpp"

using hmesh::Annealed;
using hmesh::Errc;
using hmesh::Image;
using hmesh::Options;
using hmesh::ProgressInfo;
using hmesh::Result;
using hmesh::Target;

namespace {

// A light recipe in tiles of so many px.
Annealed in_tiles(int tile = 64) {
    Annealed recipe;
    recipe.tile = tile;
    recipe.steps.emplace();
    recipe.steps->points = 1.5;
    recipe.steps->annealing.sweeps = 2;
    return recipe;
}
Options options_of(std::int64_t n) { return {Target::vertices(n)}; }

// The sum of w (image - drawn)^2, w in units of the largest weight, and of w.
template <class T, int C>
struct Weighted {
    double energy = 0, weight = 0;
    Weighted(const Image<T, C>& image, const Image<float, 1>& weights, const hmesh::Mesh& mesh) {
        const Image<float, C> drawn = hmesh_test::drawn<C>(mesh);
        float most = 0;
        for (const float w : hmesh_test::samples_of(weights)) most = std::max(most, w);
        for (std::size_t p = 0; p < weights.size(); ++p) {
            const double w = most > 0 ? static_cast<double>(weights.data()[p]) / static_cast<double>(most) : 0;
            weight += w;
            for (std::size_t c = p * C; c < (p + 1) * C; ++c) {
                const double difference = static_cast<double>(drawn.data()[c]) - static_cast<double>(image.data()[c]);
                energy += w * difference * difference;
            }
        }
    }
};

Image<float, 1> disc(int width, int height, float inside, float outside) {
    Image<float, 1> weights(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double dx = x - 0.4 * width, dy = y - 0.5 * height;
            *weights.pixel(x, y) = dx * dx + dy * dy < 0.06 * width * height ? inside : outside;
        }
    return weights;
}

}  // namespace

TEST_CASE("tiles give valid meshes of exactly n vertices with a true report, for many shapes, channels and samples") {
    hmesh_test::prove_result(
        hmesh_test::scene<std::uint8_t, 3>(150, 130, 1),
        hmesh::mesh_image(hmesh_test::scene<std::uint8_t, 3>(150, 130, 1).view(), options_of(1300), in_tiles()), 1300);
    hmesh_test::prove_result(
        hmesh_test::scene<std::uint16_t, 1>(97, 200, 2),
        hmesh::mesh_image(hmesh_test::scene<std::uint16_t, 1>(97, 200, 2).view(), options_of(1500), in_tiles()), 1500);
    hmesh_test::prove_result(hmesh_test::scene<float, 4>(200, 65, 3),
                             hmesh::mesh_image(hmesh_test::scene<float, 4>(200, 65, 3).view(), options_of(1100), in_tiles()),
                             1100);
    hmesh_test::prove_result(
        hmesh_test::noise<std::uint8_t, 1>(900, 3, 4),
        hmesh::mesh_image(hmesh_test::noise<std::uint8_t, 1>(900, 3, 4).view(), options_of(1200), in_tiles()), 1200);
    const Image<std::uint8_t, 2> constant(130, 140);
    const auto flat = hmesh::mesh_image(constant.view(), options_of(1500), in_tiles());
    hmesh_test::prove_result(constant, flat, 1500);
    CHECK(flat.report.psnr == std::numeric_limits<double>::infinity());
}

TEST_CASE("tiles give another mesh than one piece, within 1 dB of it after 2 sweeps of a sharp scene") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(256, 192, 5);
    const Result tiles = hmesh::mesh_image(image.view(), options_of(3200), in_tiles());
    const Result whole = hmesh::mesh_image(image.view(), options_of(3200), in_tiles(0));
    CHECK_FALSE(hmesh_test::same_bytes(tiles.mesh, whole.mesh));
    CHECK(tiles.report.psnr > whole.report.psnr - 1);
}

TEST_CASE("a tile of another size than 0 or 64 to 65536 px is refused") {
    const Image<std::uint8_t, 1> image(8, 8);
    for (const int tile : {-1, 1, 63, 65537}) {
        const Result result = hmesh::mesh_image(image.view(), {}, in_tiles(tile));
        CHECK(result.status.code == Errc::invalid_argument);
        CHECK(result.status.value == tile);
        CHECK(result.status.limit == (tile < 64 ? 64 : 65536));
        CHECK(result.mesh.faces.empty());
    }
}

TEST_CASE("cancelled at any call the mesh is valid, the report true, and no further call comes") {
    const auto image = hmesh_test::scene<std::uint8_t, 1>(150, 70, 6);
    for (const int tile : {0, 64})
        for (int k = 1; k < 400; k = k * 5 / 4 + 1) {
            int left = k, after = 0;
            const auto stop = [&](const ProgressInfo& info) {
                CHECK(info.fraction >= 0);
                CHECK(info.fraction <= 1);
                after += left <= 0 ? 1 : 0;
                return --left > 0;
            };
            Options options = options_of(700);
            options.progress = stop;
            const Result result = hmesh::mesh_image(image.view(), options, in_tiles(tile));
            CHECK(after == 0);
            CHECK(result.status.code == (left > 0 ? Errc::ok : Errc::cancelled));
            hmesh_test::prove_report(image, result);
        }
}

TEST_CASE("with weights, energy and PSNR are the weighted ones of the mesh as it is drawn") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(120, 90, 7);
    for (const int tile : {0, 64}) {
        const Image<float, 1> weights = disc(120, 90, 3.0F, 0.3F);
        Options options = options_of(600);
        options.weights = weights.view();
        const Result result = hmesh::mesh_image(image.view(), options, in_tiles(tile));
        CHECK(result.status);
        CHECK(result.report.vertices == 600);
        CHECK(hmesh_test::flaw_of(result.mesh.view(), 120, 90) == "");
        const Weighted drawn(image, weights, result.mesh);
        CHECK(result.report.energy == doctest::Approx(drawn.energy).epsilon(1e-3));
        const double psnr = 10 * std::log10(255.0 * 255 * 3 * drawn.weight / drawn.energy);
        CHECK(result.report.psnr == doctest::Approx(psnr).epsilon(1e-4));
        // What counts more comes out better than without weights.
        options.weights = {};
        const Image<float, 1> inside = disc(120, 90, 1, 0);
        CHECK(Weighted(image, inside, result.mesh).energy <
              0.8 * Weighted(image, inside, hmesh::mesh_image(image.view(), options, in_tiles(tile)).mesh).energy);
    }
}

TEST_CASE("equal weights change no byte of the mesh, whatever their unit") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(70, 60, 8);
    Options options = options_of(150);
    const Result plain = hmesh::mesh_image(image.view(), options, in_tiles());
    for (const float w : {1.0F, 0.001F, 1e30F}) {
        Image<float, 1> weights(70, 60);
        hmesh_test::for_each_sample(weights, [&](float& weight) { weight = w; });
        options.weights = weights.view();
        CHECK(hmesh_test::same_bytes(hmesh::mesh_image(image.view(), options, in_tiles()).mesh, plain.mesh));
    }
}

TEST_CASE("weights of 0 in a region or everywhere give valid meshes with finite colours") {
    const auto image = hmesh_test::scene<std::uint16_t, 2>(140, 75, 9);
    for (const float inside : {0.0F, 1.0F})
        for (const int tile : {0, 64}) {
            const Image<float, 1> weights = disc(140, 75, inside, 0);
            Options options = options_of(700);
            options.weights = weights.view();
            const Result result = hmesh::mesh_image(image.view(), options, in_tiles(tile));
            CHECK(result.status);
            CHECK(result.report.vertices == 700);
            CHECK(hmesh_test::flaw_of(result.mesh.view(), 140, 75) == "");
            for (const float color : result.mesh.colors) CHECK((color >= 0 && color <= 65535));
            if (inside == 0) CHECK(result.report.energy == 0);
        }
}

TEST_CASE("weights of another size, negative, NaN or infinite are refused with what is wrong") {
    const Image<std::uint8_t, 1> image(20, 10);
    const auto refused = [&](const Image<float, 1>& weights, Errc code) {
        Options options;
        options.weights = weights.view();
        const auto result = hmesh::mesh_image(image.view(), options);
        CHECK(result.status.code == code);
        CHECK(!result.has_mesh());
    };
    refused(Image<float, 1>(19, 10), Errc::invalid_argument);
    refused(Image<float, 1>(20, 11), Errc::invalid_argument);
    Image<float, 1> weights(20, 10);
    *weights.pixel(7, 3) = -1;
    refused(weights, Errc::invalid_argument);
    *weights.pixel(7, 3) = std::numeric_limits<float>::quiet_NaN();
    refused(weights, Errc::not_finite);
    *weights.pixel(7, 3) = std::numeric_limits<float>::infinity();
    refused(weights, Errc::not_finite);
}
