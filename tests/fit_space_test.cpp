// mesh_image() with colours for linear light and with premultiplied alpha.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "hmesh/core/random.hpp"
#include "hmesh/image/premultiply.hpp"
#include "hmesh/mesh_image.hpp"
#include "hmesh/render.hpp"
#include "test_executors.hpp"
#include "test_images.hpp"
#include "test_meshing.hpp"
#include "test_results.hpp"

using hmesh::Errc;
using hmesh::FitSpace;
using hmesh::Image;
using hmesh::mesh_image;
using hmesh::Options;
using hmesh::RenderOptions;
using hmesh::Result;
using hmesh::Target;

namespace {

using Pixels = Image<std::uint8_t, 4>;

Options of(std::int64_t vertices, FitSpace space, bool premultiplied = false) {
    Options options;
    options.target = Target::vertices(vertices);
    options.effort = hmesh::kit::Effort::draft;
    options.fit_space = space;
    options.premultiplied = premultiplied;
    return options;
}

Image<float, 4> drawn(const hmesh::Mesh<4>& mesh, bool linear_light = false) {
    RenderOptions options;
    options.linear_light = linear_light;
    Image<float, 4> out;
    REQUIRE(hmesh::render(mesh.view(), out, options));
    return out;
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

void check_refused(const Options& options) {
    const Result<4> result = mesh_image(sprite(16).view(), options);
    CHECK(result.status.code == Errc::invalid_argument);
    CHECK(std::strlen(result.status.what) > 15);
    CHECK(result.mesh.vertex_count() == 0);
}

}  // namespace

TEST_CASE("what is reported of a fit for linear light is what the mesh drawn in it shows, and more than conversion keeps") {
    const Pixels image = hmesh_test::scene<std::uint8_t, 4>(64, 56, 3);
    const Result<4> stored = mesh_image(image.view(), of(120, FitSpace::stored));
    const Result<4> light = mesh_image(image.view(), of(120, FitSpace::linear_light));
    REQUIRE(light.status);
    CHECK(hmesh_test::flaw_of(light.mesh.view(), 64, 56) == "");
    CHECK(light.mesh.positions == stored.mesh.positions);
    for (const float color : light.mesh.colors) CHECK(std::floor(color) == color);
    const double converted = hmesh::psnr(image.view(), drawn(stored.mesh, true).view());
    const double seen = hmesh::psnr(image.view(), drawn(light.mesh, true).view());
    CHECK(std::abs(light.report.psnr - seen) < 1e-3);
    CHECK(seen > converted + 0.1);
    CHECK(hmesh::psnr(image.view(), drawn(stored.mesh).view()) > converted + 0.1);
    REQUIRE(light.report.stages.size() == stored.report.stages.size() + 1);
    CHECK(std::string(light.report.stages.back().name) == "linear light");
    CHECK(light.report.stages.back().psnr == light.report.psnr);
    CHECK(light.report.stages.back().iterations > 0);

    const Result<4> threads = mesh_image(image.view(), of(120, FitSpace::linear_light), hmesh_test::ThreadFor{3});
    CHECK(hmesh_test::same_bytes(threads, light));
}

TEST_CASE("a fit for linear light that is cancelled reports what is true of the mesh") {
    const Pixels image = hmesh_test::scene<std::uint8_t, 4>(40, 40, 3);
    Options options = of(60, FitSpace::linear_light);
    options.progress.call = [](void*, const hmesh::ProgressInfo& info) { return std::strcmp(info.stage, "linear light") != 0; };
    const Result<4> result = mesh_image(image.view(), options);
    CHECK(result.status.code == Errc::cancelled);
    CHECK(std::abs(result.report.psnr - hmesh::psnr(image.view(), drawn(result.mesh, true).view())) < 1e-3);
}

TEST_CASE("cancelled at once, every method gives a mesh of which the report is true in linear light") {
    const Pixels image = hmesh_test::scene<std::uint8_t, 4>(24, 20, 3);
    for (const hmesh::Method method : {hmesh::Method::annealed, hmesh::Method::hierarchical, hmesh::Method::xie,
                                       hmesh::Method::adams, hmesh::Method::adaptive_thinning}) {
        Options options = of(40, FitSpace::linear_light);
        options.method = method;
        options.colors = hmesh::Colors::optimal;
        options.progress.call = [](void*, const hmesh::ProgressInfo&) { return false; };
        const Result<4> result = mesh_image(image.view(), options);
        CHECK(result.status.code == Errc::cancelled);
        CHECK(hmesh_test::flaw_of(result.mesh.view(), 24, 20) == "");
        CHECK(std::abs(result.report.psnr - hmesh::psnr(image.view(), drawn(result.mesh, true).view())) < 1e-3);
    }
}

TEST_CASE("the PSNR that is searched for is that seen in linear light") {
    const Pixels image = hmesh_test::scene<std::uint8_t, 4>(32, 32, 3);
    Options options = of(4, FitSpace::linear_light);
    options.target = Target::psnr(27);
    const Result<4> result = mesh_image(image.view(), options);
    REQUIRE(result.status);
    CHECK(result.report.psnr >= 27);
    CHECK(hmesh::psnr(image.view(), drawn(result.mesh, true).view()) >= 27 - 1e-3);
}

TEST_CASE("premultiplied meshes are those of the premultiplied image") {
    const Pixels image = sprite(48);
    const Result<4> result = mesh_image(image.view(), of(100, FitSpace::stored, true));
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
    const Result<4> same = mesh_image(product.view(), of(100, FitSpace::stored));
    CHECK(!same.mesh.premultiplied);
    CHECK(hmesh_test::same_bytes(same, result));
    hmesh_test::prove_report(product, result);
}

TEST_CASE("over white and over black a premultiplied sprite has 6 dB less error than one with straight colours") {
    const Pixels image = sprite(64);
    const Result<4> straight = mesh_image(image.view(), of(160, FitSpace::stored));
    const Result<4> premultiplied = mesh_image(image.view(), of(160, FitSpace::stored, true));
    for (const double background : {0.0, 255.0}) {
        const double before = over(background, image, drawn(straight.mesh), false);
        const double after = over(background, image, drawn(premultiplied.mesh), true);
        MESSAGE("over " << background << ": straight " << before << " dB, premultiplied " << after << " dB");
        CHECK(after > before + 6);
    }
}

TEST_CASE("alpha of float images is held to [0, 1] before it multiplies") {
    Image<float, 2> image(3, 1);
    image.samples() = {0.5F, 2.0F, 0.5F, -1.0F, -0.5F, 0.5F};
    CHECK(hmesh::kit::premultiply(image.view()).samples() == std::vector<float>{0.5F, 1, 0, 0, -0.25F, 0.5F});
}

TEST_CASE("fit spaces and premultiplying that make no sense are refused") {
    check_refused(of(20, FitSpace::linear_light, true));
    check_refused(of(20, static_cast<FitSpace>(7)));
    Options sampled = of(20, FitSpace::linear_light);
    sampled.colors = hmesh::Colors::sampled;
    check_refused(sampled);
    Options adams = of(20, FitSpace::linear_light);
    adams.method = hmesh::Method::adams;
    check_refused(adams);
    const hmesh::Status status = hmesh::detail::check_color_options(of(20, FitSpace::stored, true), 3);
    CHECK(status.code == Errc::invalid_argument);
    CHECK(status.value == 3);

    hmesh::Mesh<4> mesh = mesh_image(sprite(16).view(), of(20, FitSpace::stored, true)).mesh;
    Image<float, 4> out;
    RenderOptions options;
    options.linear_light = true;
    CHECK(hmesh::render(mesh.view(), out, options).code == Errc::invalid_argument);
    CHECK(out.samples().empty());
}
