// fit_linear_light() of what mesh_image() makes.
#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "hmesh/paper.hpp"
#include "hmesh/render.hpp"
#include "hmesh/solve/linear_light.hpp"
#include "test_executors.hpp"
#include "test_images.hpp"
#include "test_meshing.hpp"
#include "test_results.hpp"

using hmesh::Errc;
using hmesh::fit_linear_light;
using hmesh::Image;
using hmesh::LinearLightReport;
using hmesh::Mesh;
using hmesh::mesh_image;
using hmesh::Options;
using hmesh::Result;
using hmesh::Target;

namespace {

using Pixels = Image<std::uint8_t, 4>;

Result mesh_of(const Pixels& image, std::int64_t vertices, bool premultiplied = false) {
    Options options;
    options.target = Target::vertices(vertices);
    options.premultiplied = premultiplied;
    return mesh_image(image.view(), options, hmesh::Annealed{hmesh::Effort::draft});
}

// As files with 8 bits a colour are fitted.
hmesh::LinearLightOptions whole_numbers() {
    hmesh::LinearLightOptions options;
    options.grid = 1;
    return options;
}

// The PSNR of the mesh as it is drawn, dB.
double psnr_of(const Pixels& image, const Mesh& mesh, bool linear_light) {
    hmesh::RenderOptions options;
    if (linear_light) options.interpolation = hmesh::RenderOptions::Interpolation::linear;
    return hmesh::psnr(image.view(), hmesh_test::drawn<4>(mesh, options).view());
}

}  // namespace

TEST_CASE("what is reported of a fit for linear light is what the mesh drawn in it shows, and more than conversion keeps") {
    const Pixels image = hmesh_test::scene<std::uint8_t, 4>(64, 56, 3);
    const Mesh stored = mesh_of(image, 120).mesh;
    Mesh light = stored;
    const LinearLightReport report = fit_linear_light(light, image.view(), whole_numbers());
    REQUIRE(report.status);
    CHECK(hmesh_test::flaw_of(light.view(), 64, 56) == "");
    CHECK(light.positions == stored.positions);
    CHECK(light.faces == stored.faces);
    for (const float color : light.colors) CHECK(std::floor(color) == color);
    const double converted = psnr_of(image, stored, true), seen = psnr_of(image, light, true);
    CHECK(std::abs(report.psnr - seen) < 1e-3);
    CHECK(std::abs(report.psnr + 10 * std::log10(report.energy / report.converted) - converted) < 1e-3);
    CHECK(seen > converted + 0.1);
    CHECK(psnr_of(image, stored, false) > converted + 0.1);
    CHECK(report.iterations > 0);
    CHECK(report.solver_iterations > 0);

    Mesh threaded = stored;
    const LinearLightReport same = fit_linear_light(threaded, image.view(), whole_numbers(), hmesh_test::ThreadFor{3});
    CHECK(hmesh_test::same_bytes(threaded, light));
    CHECK(same.energy == report.energy);
}

TEST_CASE("a fit for linear light that is stopped at any call reports what is true of the mesh") {
    const Pixels image = hmesh_test::scene<std::uint8_t, 4>(40, 40, 3);
    const Mesh stored = mesh_of(image, 60).mesh;
    bool is_finished = false;
    for (int last = 0; !is_finished; ++last) {
        CAPTURE(last);
        int calls = 0;
        double share = -1;
        bool rises = true;
        const auto go_on = [&](double now) {
            rises = rises && now > share && now < 1;
            share = now;
            return ++calls <= last;
        };
        Mesh light = stored;
        const LinearLightReport report = fit_linear_light(light, image.view(), whole_numbers(), {}, go_on);
        is_finished = calls <= last;
        if (!is_finished) CHECK(calls == last + 1);  // once told to stop, it asks no more
        CHECK(rises);
        CHECK(report.energy <= report.converted);
        CHECK(std::abs(report.psnr - psnr_of(image, light, true)) < 1e-3);
        if (last == 0) CHECK(report.iterations == 0);
        if (is_finished) CHECK(last > 4);
    }
}

TEST_CASE("cancelled at once, every recipe gives a mesh that is fitted for linear light too") {
    const Pixels image = hmesh_test::scene<std::uint8_t, 4>(24, 20, 3);
    const auto check = [&](const auto& recipe) {
        CAPTURE(recipe.name);
        Options options;
        options.target = Target::vertices(40);
        const auto stop = [](const hmesh::ProgressInfo&) { return false; };
        options.progress = stop;
        Result result = mesh_image(image.view(), options, recipe);
        CHECK(result.status.code == Errc::cancelled);
        REQUIRE(result.has_mesh());
        const LinearLightReport report = fit_linear_light(result.mesh, image.view(), whole_numbers());
        CHECK(report.status);
        CHECK(hmesh_test::flaw_of(result.mesh.view(), 24, 20) == "");
        CHECK(std::abs(report.psnr - psnr_of(image, result.mesh, true)) < 1e-3);
    };
    check(hmesh::Annealed());
    check(hmesh::Hierarchical());
    check(hmesh::Xie());
    check(hmesh::Adams());
    check(hmesh::AdaptiveThinning());
}

TEST_CASE("premultiplied meshes are neither fitted for linear light nor drawn in it") {
    const Pixels image = hmesh_test::scene<std::uint8_t, 4>(24, 20, 3);
    const Mesh mesh = mesh_of(image, 20, true).mesh;
    Mesh fitted = mesh;
    CHECK(fit_linear_light(fitted, image.view()).status.code == Errc::invalid_argument);
    CHECK(hmesh_test::same_bytes(fitted, mesh));
    hmesh::RenderOptions options;
    options.interpolation = hmesh::RenderOptions::Interpolation::linear;
    const hmesh::RenderResult<4> picture = hmesh::render<4>(mesh.view(), options);
    CHECK(picture.status.code == Errc::invalid_argument);
    CHECK(picture.image.size() == 0);
}
