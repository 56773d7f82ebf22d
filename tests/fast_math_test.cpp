// Compiled with -ffast-math where the compiler has it: what users hand over is refused there too.
#include <doctest/doctest.h>

#include <cstdint>
#include <cstring>
#include <vector>

#include "hmesh/fit/image_mesh.hpp"
#include "hmesh/fit/moment_table.hpp"
#include "hmesh/io/ply.hpp"
#include "hmesh/mesh_image.hpp"
#include "hmesh/render.hpp"
#include "hmesh/terrain.hpp"
#include "test_images.hpp"

using hmesh::Errc;
using hmesh::Image;
using hmesh::Options;
using hmesh::Target;

namespace {

// Made of bits, which the compiler does not look through.
template <class To, class Bits>
To from_bits(Bits bits) {
    volatile Bits hidden = bits;
    const Bits shown = hidden;
    To value;
    static_assert(sizeof value == sizeof shown);
    std::memcpy(&value, &shown, sizeof value);
    return value;
}
const float bad_floats[] = {from_bits<float>(0x7FC00000U), from_bits<float>(0x7F800000U), from_bits<float>(0xFF800000U)};
const double bad_doubles[] = {from_bits<double>(std::uint64_t{0x7FF8000000000000U}),
                              from_bits<double>(std::uint64_t{0x7FF0000000000000U})};

Options with_vertices(int vertices) {
    Options options;
    options.target = Target::vertices(vertices);
    return options;
}
const hmesh::Annealed quick{hmesh::Effort::draft};

}  // namespace

TEST_CASE("pixels and weights that are no numbers are refused") {
    for (const float bad : bad_floats) {
        Image<float, 1> image = hmesh_test::scene<float, 1>(24, 20, 3);
        *image.pixel(7, 5) = bad;
        CHECK(mesh_image(image.view(), with_vertices(40), quick).status.code == Errc::not_finite);

        Options options = with_vertices(40);
        Image<float, 1> weights(24, 20);
        *weights.pixel(3, 2) = bad;
        options.weights = weights.view();
        CHECK(mesh_image(hmesh_test::scene<float, 1>(24, 20, 3).view(), options, quick).status.code == Errc::not_finite);
    }
}

TEST_CASE("options that are no numbers are refused") {
    const Image<float, 1> image = hmesh_test::scene<float, 1>(24, 20, 3);
    for (const double bad : bad_doubles) {
        for (const auto kind : {Target::Kind::vertices, Target::Kind::percent, Target::Kind::psnr}) {
            Options options;
            options.target = {kind, bad};
            CHECK(mesh_image(image.view(), options, quick).status.code == Errc::target_out_of_range);
        }
        Options options = with_vertices(40);
        options.limits.ridge = bad;
        CHECK(mesh_image(image.view(), options, quick).status.code == Errc::invalid_argument);
        hmesh::Annealed recipe = quick;
        recipe.steps = hmesh::kit::annealed_steps(hmesh::Effort::draft);
        recipe.steps->points = bad;
        CHECK(mesh_image(image.view(), with_vertices(40), recipe).status.code == Errc::invalid_argument);
    }
    for (double hmesh::Bounded::*const error :
         {&hmesh::Bounded::max_error, &hmesh::Bounded::border_error, &hmesh::Bounded::inside_error}) {
        hmesh::Bounded bounded{1};
        bounded.*error = bad_doubles[0];
        CHECK(mesh_image(image.view(), {}, bounded).status.code == Errc::invalid_argument);
    }
    hmesh::Bounded infinite{0.1};
    infinite.inside_error = bad_doubles[1];  // is none
    CHECK(mesh_image(image.view(), {}, infinite).status);
}

TEST_CASE("a mesh at work refuses places and colours that are no numbers") {
    const Image<float, 1> image = hmesh_test::scene<float, 1>(8, 6, 3);
    const hmesh::kit::MomentTable<1> table(image.view(), image.view().bounds());
    hmesh::kit::ImageMesh<1> mesh(table, 0, 1);
    const std::vector<hmesh::kit::Point> square = {{0, 0}, {8, 0}, {8, 6}, {0, 6}};
    const std::vector<hmesh::Triangle> faces = {{0, 1, 2}, {0, 2, 3}};
    const std::vector<hmesh::kit::Color<1>> colors(4, hmesh::kit::Color<1>::zero());
    CHECK(mesh.assign(square, faces, colors, {}));
    for (const double bad : bad_doubles) {
        std::vector<hmesh::kit::Point> places = square;
        places[2].y = bad;
        CHECK(mesh.assign(places, faces).code == Errc::not_finite);
        std::vector<hmesh::kit::Color<1>> painted = colors;
        painted[1].set(0, bad);
        CHECK(mesh.assign(square, faces, painted, {}).code == Errc::not_finite);
    }
}

TEST_CASE("an image is meshed as well as without, and meshes that are no numbers are not written or drawn") {
    const Image<float, 1> image = hmesh_test::scene<float, 1>(48, 40, 3);
    const hmesh::Result result = mesh_image(image.view(), with_vertices(150), quick);
    REQUIRE(result.status);
    const hmesh::RenderResult<1> drawn = hmesh::render<1>(result.mesh.view());
    REQUIRE(drawn.status);
    CHECK(psnr(image.view(), drawn.image.view()) == doctest::Approx(result.report.psnr).epsilon(1e-4));
    CHECK(result.report.psnr > 28);

    const auto sink = [](const void*, std::size_t) { return true; };
    REQUIRE(write_ply(result.mesh.view(), sink));
    for (const float bad : bad_floats) {
        hmesh::Mesh mesh = result.mesh;
        mesh.positions[9] = bad;
        CHECK(write_ply(mesh.view(), sink).code == Errc::not_finite);
        CHECK(hmesh::render<1>(mesh.view()).status.code == Errc::not_finite);
        mesh = result.mesh;
        mesh.colors[4] = bad;
        CHECK(write_ply(mesh.view(), sink).code == Errc::not_finite);
    }
}
