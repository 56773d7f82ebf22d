// From pixels to a drawn picture and a file, through the calls that a user makes.
#include "hmesh/hmesh.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <string>
#include <vector>

#include "test_images.hpp"
#include "test_meshing.hpp"
#include "test_results.hpp"
#include "test_sanitized.hpp"

using hmesh::Annealed;
using hmesh::Effort;
using hmesh::Image;
using hmesh::mesh_image;
using hmesh::Options;
using hmesh::Target;

namespace {

template <class T, int C>
hmesh::Result mesh_of(const Image<T, C>& image, std::int64_t vertices, Effort effort) {
    Annealed recipe{effort};
    if (effort == Effort::best) {  // its 300 sweeps take long under sanitizers
        recipe.steps = hmesh::kit::annealed_steps(effort);
        recipe.steps->annealing.sweeps = 100;
    }
    return mesh_image(image.view(), Options{Target::vertices(vertices)}, recipe);
}

// Image in, mesh, picture out: psnr() of the picture is what the report says.
template <class T, int C>
void run(const Image<T, C>& image, std::int64_t vertices, Effort effort) {
    const auto result = mesh_of(image, vertices, effort);
    hmesh_test::prove_result(image, result, static_cast<std::size_t>(vertices));
    const Image<float, C> drawn = hmesh_test::drawn<C>(result.mesh);
    CHECK(std::abs(hmesh::psnr(image.view(), drawn.view()) - result.report.psnr) < 1e-3);
    const Image<T, C> pixels = hmesh::to_pixels<T>(drawn);  // rounding adds about 1/12 to an error of many
    CHECK(std::abs(hmesh::psnr(image.view(), pixels.view()) - result.report.psnr) < 0.3);
}

}  // namespace

TEST_CASE("the PSNR reported is that of the mesh as it is drawn, for every effort and sample type") {
    for (const Effort effort : {Effort::draft, Effort::fast, Effort::normal}) {
        run(hmesh_test::scene<std::uint8_t, 3>(96, 80, 1), 150, effort);
        run(hmesh_test::scene<std::uint8_t, 1>(96, 80, 2), 150, effort);
        run(hmesh_test::scene<std::uint16_t, 4>(64, 60, 3), 120, effort);
        run(hmesh_test::scene<float, 2>(64, 60, 4), 120, effort);
    }
    run(hmesh_test::scene<std::uint8_t, 3>(48, 40, 1), 50, Effort::best);
}

TEST_CASE("more effort and more vertices give a better mesh" * doctest::skip(hmesh_test::sanitized)) {
    double draft = 0, gain_of[4] = {0, 0, 0, 0};
    constexpr std::uint64_t images = 10;  // single gains scatter by 0.6 dB
    for (std::uint64_t seed = 1; seed <= images; ++seed) {
        const auto image = hmesh_test::scene<std::uint8_t, 3>(64, 64, seed);
        double before = 0;
        for (const Effort effort : {Effort::draft, Effort::fast, Effort::normal, Effort::fine, Effort::best}) {
            const double psnr = mesh_of(image, 100, effort).report.psnr;
            (effort == Effort::draft ? draft : gain_of[static_cast<int>(effort) - 1]) += (psnr - before) / images;
            before = psnr;
        }
        double fewer = 0;
        for (const std::int64_t vertices : {20, 60, 180, 540}) {
            const double psnr = mesh_of(image, vertices, Effort::fast).report.psnr;
            CHECK(psnr > fewer + 2);
            fewer = psnr;
        }
    }
    CHECK(draft > 29.3);
    CHECK(gain_of[0] > 2.9);  // fast over draft
    CHECK(gain_of[1] > 0.4);  // normal over fast
    CHECK(draft + gain_of[0] + gain_of[1] > 32.8);
    CHECK(gain_of[2] > 0.5);  // fine over normal
    CHECK(gain_of[3] > 0.2);  // best over fine
}

TEST_CASE("drawn at three times the size, the middles of its pixels are those of the size it was made for") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(96, 80, 1);
    const auto result = mesh_of(image, 300, Effort::normal);
    const Image<float, 3> once = hmesh_test::drawn<3>(result.mesh), thrice = hmesh_test::drawn<3>(result.mesh, {288, 240});
    float most = 0;
    for (int y = 0; y < 80; ++y)
        for (int x = 0; x < 96; ++x)
            for (int c = 0; c < 3; ++c)
                most = std::max(most, std::abs(once.pixel(x, y)[c] - thrice.pixel(3 * x + 1, 3 * y + 1)[c]));
    CHECK(most < 0.01F);
}

TEST_CASE("a mesh goes into a PLY file as it is") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(40, 36, 1);
    const auto result = mesh_of(image, 60, Effort::normal);
    std::string file;
    REQUIRE(hmesh::write_ply(result.mesh.view(), hmesh::kit::append_to(file)));
    const std::string end = "end_header\n";
    const std::size_t body = file.find(end) + end.size();
    REQUIRE(body > end.size());
    CHECK(file.find("element vertex 60\n") != std::string::npos);
    CHECK(file.find("element face " + std::to_string(result.report.faces) + "\n") != std::string::npos);
    CHECK(file.size() == body + 60 * 15 + result.report.faces * 13);
    for (std::size_t v = 0; v < 60; ++v)
        for (std::size_t c = 0; c < 3; ++c)
            CHECK(static_cast<float>(static_cast<unsigned char>(file[body + 15 * v + 12 + c])) == result.mesh.colors[3 * v + c]);
}

TEST_CASE("a mirrored, turned or inverted picture is meshed about as well") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(64, 64, 4);
    Image<std::uint8_t, 3> mirrored(64, 64), turned(64, 64), inverted(64, 64);
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x)
            for (int c = 0; c < 3; ++c) {
                const std::uint8_t sample = image.pixel(x, y)[c];
                mirrored.pixel(63 - x, y)[c] = sample;
                turned.pixel(y, x)[c] = sample;
                inverted.pixel(x, y)[c] = static_cast<std::uint8_t>(255 - sample);
            }
    const double psnr = mesh_of(image, 160, Effort::normal).report.psnr;
    for (const auto* other : {&mirrored, &turned, &inverted})
        CHECK(std::abs(mesh_of(*other, 160, Effort::normal).report.psnr - psnr) < 1);
}

TEST_CASE("a sharp edge is met by the mesh: two colours cost few vertices") {
    // A bright triangle with corners on whole pixels, its sides between pixels of any slope.
    const auto image = hmesh_test::draw<std::uint8_t, 1>(64, 64, [](int x, int y, int) {
        const double u = x + 0.5, v = y + 0.5;
        return v > 10 && v < 10 + 1.5 * (u - 12) && v < 52 - 0.3 * (u - 12) ? 1.0 : 0.0;
    });
    const double few = mesh_of(image, 24, Effort::normal).report.psnr;
    CHECK(few > 30);
    CHECK(mesh_of(image, 60, Effort::normal).report.psnr > 40);
}
