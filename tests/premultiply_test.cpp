#include "hmesh/image/premultiply.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/core/random.hpp"
#include "hmesh/render.hpp"
#include "test_images.hpp"
#include "test_meshing.hpp"
#include "test_results.hpp"

using hmesh::Errc;
using hmesh::Image;
using hmesh::mesh_image;
using hmesh::Options;
using hmesh::Result;
using hmesh::Target;

namespace {

using Pixels = Image<std::uint8_t, 4>;

Result mesh_of(const Pixels& image, std::int64_t vertices, bool premultiplied) {
    Options options;
    options.target = Target::vertices(vertices);
    options.premultiplied = premultiplied;
    return mesh_image(image.view(), options, hmesh::Annealed{hmesh::Effort::draft});
}

// A shaded disc with a soft edge over garbage in transparent pixels.
Pixels sprite(int size) {
    hmesh::kit::Random random(5);
    Pixels image(size, size);
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            const double distance = std::hypot(x + 0.5 - 0.5 * size, y + 0.5 - 0.5 * size);
            const double alpha = std::clamp(0.5 + (0.35 * size - distance) / 1.5, 0.0, 1.0);
            const double shade[3] = {200 - 0.8 * x, 120 + 0.5 * y, 60};
            for (int k = 0; k < 3; ++k)
                image.pixel(x, y)[k] = static_cast<std::uint8_t>(alpha > 0 ? shade[k] : 255 * random.uniform());
            image.pixel(x, y)[3] = static_cast<std::uint8_t>(255 * alpha + 0.5);
        }
    return image;
}

// PSNR over a background of what is drawn against what is right, dB.
double over(double background, const Pixels& truth, const Image<float, 4>& picture, bool premultiplied) {
    double energy = 0;
    for (int y = 0; y < truth.height(); ++y)
        for (int x = 0; x < truth.width(); ++x) {
            const float* p = picture.pixel(x, y);
            const std::uint8_t* t = truth.pixel(x, y);
            const double alpha = std::clamp(static_cast<double>(p[3]) / 255, 0.0, 1.0), true_alpha = t[3] / 255.0;
            for (int k = 0; k < 3; ++k) {
                const double shown = static_cast<double>(p[k]) * (premultiplied ? 1 : alpha) + background * (1 - alpha);
                const double right = t[k] * true_alpha + background * (1 - true_alpha);
                energy += (shown - right) * (shown - right);
            }
        }
    return 10 * std::log10(255.0 * 255 * 3 * truth.width() * truth.height() / energy);
}

}  // namespace

TEST_CASE("premultiplied meshes are those of the premultiplied image") {
    const Pixels image = sprite(48);
    const Result result = mesh_of(image, 100, true);
    REQUIRE(result.status);
    CHECK(result.mesh.premultiplied);
    CHECK(result.mesh.view().premultiplied);
    const Pixels product = hmesh::kit::premultiply(image.view());
    for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 48; ++x)
            for (int k = 0; k < 4; ++k) {
                const std::uint8_t* p = image.pixel(x, y);
                CHECK(product.pixel(x, y)[k] == (k < 3 ? (2 * p[k] * p[3] + 255) / 510 : p[3]));
            }
    Result same = mesh_of(product, 100, false);
    CHECK(!same.mesh.premultiplied);
    same.mesh.premultiplied = true;
    CHECK(hmesh_test::same_bytes(same, result));
    hmesh_test::prove_report(product, result);
}

TEST_CASE("over white and over black a premultiplied sprite has 6 dB less error than one with straight colours") {
    const Pixels image = sprite(64);
    const Result straight = mesh_of(image, 160, false);
    const Result premultiplied = mesh_of(image, 160, true);
    for (const double background : {0.0, 255.0}) {
        const double before = over(background, image, hmesh_test::drawn<4>(straight.mesh), false);
        const double after = over(background, image, hmesh_test::drawn<4>(premultiplied.mesh), true);
        MESSAGE("over " << background << ": straight " << before << " dB, premultiplied " << after << " dB");
        CHECK(after > before + 6);
    }
}

TEST_CASE("alpha of float images is held to [0, 1] before it multiplies") {
    const float samples[] = {0.5F, 2.0F, 0.5F, -1.0F, -0.5F, 0.5F};
    const Image<float, 2> product = hmesh::kit::premultiply(hmesh::ImageView<float, 2>{samples, 3, 1});
    CHECK(hmesh_test::samples_of(product) == std::vector<float>{0.5F, 1, 0, 0, -0.25F, 0.5F});
}

TEST_CASE("premultiplying what has no alpha is refused") {
    Options options;
    options.premultiplied = true;
    for (const int channels : {1, 3, 5, 16}) {
        const hmesh::Status status = check(options, 256, channels);
        CHECK(status.code == Errc::invalid_argument);
        CHECK(status.value == channels);
    }
    for (const int channels : {2, 4}) CHECK(check(options, 256, channels));
    const auto rgb = hmesh_test::scene<std::uint8_t, 3>(16, 16, 1);
    CHECK(mesh_image(rgb.view(), options).status.value == 3);
}
