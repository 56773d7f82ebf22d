#include "hmesh/fit/rendered_error.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "hmesh/lods/progressive_mesh.hpp"
#include "hmesh/mesh_image.hpp"
#include "hmesh/paper.hpp"
#include "hmesh/render.hpp"
#include "test_executors.hpp"
#include "test_images.hpp"
#include "test_meshes.hpp"
#include "test_meshing.hpp"

using hmesh::Image;
using hmesh::ImageView;
using hmesh::Mesh;
using hmesh::kit::rendered_errors;

namespace {

template <class T, int C>
Mesh mesh_of(const Image<T, C>& image, int vertices) {
    hmesh::Options options;
    options.target = hmesh::Target::vertices(vertices);
    const hmesh::Result result = mesh_image(image.view(), options, hmesh::Annealed{hmesh::Effort::draft});
    REQUIRE(result.status);
    return result.mesh;
}

// By the brute force of test_meshes.hpp: each pixel against each face.
template <class T, int C>
double brute_energy(const Image<T, C>& image, const Mesh& mesh) {
    double energy = 0;
    for (const hmesh::Triangle& t : mesh.faces) {
        hmesh::kit::VertexState<C> corners[3]{};
        for (std::size_t k = 0; k < 3; ++k) {
            corners[k].position = {static_cast<double>(mesh.positions[2 * t[k]]),
                                   static_cast<double>(mesh.positions[2 * t[k] + 1])};
            for (int c = 0; c < C; ++c)
                corners[k].color.set(c, static_cast<double>(mesh.colors[C * t[k] + static_cast<std::size_t>(c)]));
        }
        energy += hmesh_test::brute_energy(image, corners[0], corners[1], corners[2]);
    }
    return energy;
}

}  // namespace

TEST_CASE("the energy is that of brute force, in any order of the work") {
    const auto bytes = hmesh_test::scene<std::uint8_t, 3>(40, 32, 3);
    const auto floats = hmesh_test::scene<float, 2>(31, 44, 5);
    const Mesh of_bytes = mesh_of(bytes, 90);
    const Mesh of_floats = mesh_of(floats, 90);
    CHECK(rendered_errors(of_bytes, bytes.view()).energy == doctest::Approx(brute_energy(bytes, of_bytes)).epsilon(1e-12));
    CHECK(rendered_errors(of_floats, floats.view()).energy == doctest::Approx(brute_energy(floats, of_floats)).epsilon(1e-12));
    CHECK(rendered_errors(of_floats, floats.view(), {}, 1, hmesh_test::ShuffledFor{3}).energy ==
          rendered_errors(of_floats, floats.view()).energy);
}

TEST_CASE("weights count each pixel as often as they say") {
    const auto image = hmesh_test::scene<float, 1>(24, 20, 3);
    const Mesh mesh = mesh_of(image, 40);
    const hmesh::RenderResult<1> drawn = hmesh::render<1>(mesh.view());
    REQUIRE(drawn.status);
    Image<float, 1> weights(24, 20);
    double expected = 0;
    for (int y = 0; y < 20; ++y)
        for (int x = 0; x < 24; ++x) {
            *weights.pixel(x, y) = static_cast<float>((x + 2 * y) % 3);
            const double difference = static_cast<double>(*drawn.image.pixel(x, y)) - static_cast<double>(*image.pixel(x, y));
            expected += (x + 2 * y) % 3 / 2.0 * difference * difference;
        }
    CHECK(rendered_errors(mesh, image.view(), weights.view(), 0.5).energy == doctest::Approx(expected).epsilon(1e-5));
}

TEST_CASE("what is reported of a float image is what is drawn, a sun beside deep shades in it or not") {
    for (const float sun : {1.0F, 4e3F, 65504.0F, 1e6F}) {
        Image<float, 1> image = hmesh_test::scene<float, 1>(96, 80, 3);
        for (int y = 30; y < 36; ++y)
            for (int x = 20; x < 26; ++x) *image.pixel(x, y) = sun;
        hmesh::Options options;
        options.target = hmesh::Target::vertices(300);
        const auto check_recipe = [&](const auto& recipe) {
            const hmesh::Result result = mesh_image(image.view(), options, recipe);
            REQUIRE(result.status);
            const hmesh::RenderResult<1> drawn = hmesh::render<1>(result.mesh.view());
            REQUIRE(drawn.status);
            CHECK(result.report.psnr ==
                  doctest::Approx(psnr(image.view(), drawn.image.view())).epsilon(3e-4));  // drawn in floats
            CHECK(result.report.stages.back().psnr == result.report.psnr);
        };
        check_recipe(hmesh::Annealed{hmesh::Effort::fast});
        check_recipe(hmesh::Hierarchical());
    }
}

TEST_CASE("what is reported of an image with weights, or of one wide table, is what is drawn, and so of levels of one buffer") {
    const auto image = hmesh_test::draw<std::uint8_t, 1>(65536, 8, [](int x, int y, int) {
        return 0.4 + 0.24 * std::sin(0.05 * x) * std::cos(0.07 * y) + (x / 40 % 2 == 0 ? 0.2 : 0);
    });
    const auto weight = [](int x, int y, int) { return (97 * x + 31 * y) % 257 / 256.0; };
    const auto about = [](double energy) { return doctest::Approx(energy).epsilon(1e-13); };
    const auto weights = hmesh_test::draw<float, 1>(65536, 8, weight);
    hmesh::Options options;
    options.weights = weights.view();
    options.target = hmesh::Target::vertices(6000);
    const hmesh::Result wide = mesh_image(image.view(), options, hmesh::Xie());
    REQUIRE(wide.status);
    CHECK(wide.report.energy == about(rendered_errors(wide.mesh, image.view(), options.weights).energy));
    const hmesh::ProgressiveMesh nested = progressive_mesh(image.view(), wide.mesh, options);
    REQUIRE(nested.status);
    for (const hmesh::ProgressiveLevel& level : nested.levels) {
        Mesh drawn = nested.mesh;
        drawn.faces = level.faces;
        CHECK(level.energy == about(rendered_errors(drawn, image.view(), options.weights).energy));
    }

    const auto small = hmesh_test::scene<std::uint16_t, 1>(1024, 64, 3);
    const auto small_weights = hmesh_test::draw<float, 1>(1024, 64, weight);
    options.weights = small_weights.view();
    options.target = hmesh::Target::vertices(600);
    const hmesh::Result result = mesh_image(small.view(), options, hmesh::Annealed{hmesh::Effort::draft});
    REQUIRE(result.status);
    const hmesh::kit::RenderedError errors = rendered_errors(result.mesh, small.view(), options.weights);
    CHECK(result.report.energy == about(errors.energy));
    CHECK(result.report.max_error == about(errors.largest));
}
