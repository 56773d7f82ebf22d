// Meshes of images that repeat: what mesh_image() makes of Options::periodic.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "hmesh/image/premultiply.hpp"
#include "hmesh/io/eps.hpp"
#include "hmesh/io/gltf.hpp"
#include "hmesh/io/html.hpp"
#include "hmesh/io/pdf.hpp"
#include "hmesh/io/ply.hpp"
#include "hmesh/io/svg.hpp"
#include "hmesh/mesh/halfedge_mesh.hpp"
#include "hmesh/mesh/torus.hpp"
#include "hmesh/mesh/unrolled.hpp"
#include "hmesh/paper.hpp"
#include "hmesh/solve/linear_light.hpp"
#include "hmesh/tiles/indexed_mesh.hpp"
#include "periodic_sheets.hpp"
#include "test_executors.hpp"
#include "test_images.hpp"
#include "test_meshing.hpp"
#include "test_results.hpp"
#include "test_sanitized.hpp"

using hmesh::Annealed;
using hmesh::Effort;
using hmesh::Errc;
using hmesh::Image;
using hmesh::Mesh;
using hmesh::mesh_image;
using hmesh::Options;
using hmesh::Periodic;
using hmesh::Result;
using hmesh::Target;
using hmesh::kit::check_periodic;

namespace {

// Waves that repeat with the image, in all channels differently.
template <class T, int C>
Image<T, C> waves(int width, int height, double phase = 0) {
    return hmesh_test::draw<T, C>(width, height, [=](int x, int y, int c) {
        const double u = 6.283185307179586 * (x + 0.5) / width, v = 6.283185307179586 * (y + 0.5) / height;
        return 0.5 + 0.24 * std::sin((1 + c) * u + phase + v) + 0.24 * std::cos(2 * v - u + c + phase);
    });
}

Options periodic(Periodic along, std::size_t n, bool straight = false) {
    Options options;
    options.target = Target::vertices(static_cast<std::int64_t>(n));
    options.periodic = along;
    options.straight_border = straight;
    return options;
}

// All that a periodic mesh promises.
template <class T, int C>
void check_mesh(const Image<T, C>& image, const Result& result, const Options& options) {
    REQUIRE(std::string(hmesh::message(result.status).c_str()) == "ok");
    const Mesh& mesh = result.mesh;
    REQUIRE(mesh.periodic == options.periodic);
    CHECK(hmesh_test::sheet_flaw(mesh) == "");
    CHECK(std::string(hmesh::message(check_periodic(mesh.view())).c_str()) == "ok");
    // As the sheet: a surface with a border, no two fans of faces in one vertex.
    hmesh::kit::HalfedgeMesh topology;
    CHECK(topology.assign(mesh.vertex_count(), mesh.faces));
    CHECK(hmesh::kit::check(hmesh::kit::to_indexed_mesh<C>(mesh)));
    const double energy = hmesh_test::rendered_error(image, mesh);
    // Each drawn sample is rounded to float: differences of d that are off by r make an error of 2 d r + r^2.
    const double rounding = hmesh_test::energy_rounding(image);
    CHECK(std::abs(result.report.energy - energy) <= 2 * std::sqrt(energy * rounding) + rounding);
    for (std::size_t v = 0; options.straight_border && v < mesh.vertex_count(); ++v) {
        const float x = mesh.positions[2 * v], y = mesh.positions[2 * v + 1];
        REQUIRE((x >= 0 && x <= static_cast<float>(mesh.width) && y >= 0 && y <= static_cast<float>(mesh.height)));
    }
}

constexpr Periodic axes[] = {Periodic::x, Periodic::y, Periodic::xy};

template <class T, int C>
void check_many(std::uint64_t seed, int count) {
    hmesh::kit::Random random(seed);
    const auto below = [&](int n) { return static_cast<int>(random.below(static_cast<std::size_t>(n))); };
    for (int k = 0; k < count; ++k) {
        const int longest = k % 3 == 0 ? 5 : 60;
        const int width = 1 + below(longest), height = 1 + below(k % 4 == 0 ? 4 : longest);
        const Image<T, C> image = below(2) == 0 ? hmesh_test::noise<T, C>(width, height, seed + static_cast<std::uint64_t>(k))
                                                : waves<T, C>(width, height);
        const int most = std::max(4, width * height), n = 4 + below(std::min(most - 3, below(2) == 0 ? 40 : 400));
        Options options = periodic(axes[below(3)], static_cast<std::size_t>(n), below(2) == 0);
        if (below(4) == 0) options.colors = hmesh::Colors::sampled;
        Annealed recipe;
        recipe.effort = static_cast<Effort>(below(3));
        recipe.tile = below(2) == 0 ? 0 : 64;
        CAPTURE(width);
        CAPTURE(height);
        CAPTURE(n);
        CAPTURE(static_cast<int>(options.periodic));
        CAPTURE(options.straight_border);
        CAPTURE(static_cast<int>(recipe.effort));
        const Result result = mesh_image(image.view(), options, recipe);
        check_mesh(image, result, options);
        CHECK(result.report.vertices == static_cast<std::size_t>(n));
    }
}

}  // namespace

TEST_CASE("periodic meshes of any small image cover each place once, and their borders pair in place and colour") {
    const int count = hmesh_test::sanitized ? 6 : 24;
    check_many<std::uint8_t, 3>(1, count);
    check_many<std::uint8_t, 1>(2, count);
    check_many<std::uint16_t, 2>(3, count);
    check_many<float, 4>(4, count);
}

TEST_CASE("an image of one pixel or one row has periodic meshes") {
    for (const auto& [width, height] : {std::pair(1, 1), std::pair(1, 9), std::pair(9, 1), std::pair(2, 2)})
        for (const Periodic along : axes)
            for (const bool straight : {false, true}) {
                const auto image = hmesh_test::noise<std::uint8_t, 3>(width, height, 3);
                for (const std::size_t n : {std::size_t{4}, std::max<std::size_t>(4, static_cast<std::size_t>(width * height))})
                    check_mesh(image, mesh_image(image.view(), periodic(along, n, straight)), periodic(along, n, straight));
            }
}

TEST_CASE("a row that repeats from end to end is meshed as well as one that does not, however many vertices it has") {
    for (const bool is_row : {true, false})
        for (const bool straight : {false, true}) {
            CAPTURE(is_row);
            CAPTURE(straight);
            const auto wave = [](int x, int y, int) { return 0.5 + 0.45 * std::sin(6.283185307179586 * (x + y) / 100); };
            const auto image = hmesh_test::draw<std::uint8_t, 1>(is_row ? 10000 : 1, is_row ? 1 : 10000, wave);
            const Options options = periodic(is_row ? Periodic::x : Periodic::y, 2000, straight);
            Annealed recipe;
            recipe.effort = Effort::draft;
            const Result result = mesh_image(image.view(), options, recipe);
            check_mesh(image, result, options);
            CHECK(result.report.stages.front().vertices > 2000);
            CHECK(result.report.psnr > 54);
        }
}

TEST_CASE("periodic meshes in many tiles are the same for any executor") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(210, 130, 5);
    for (const bool straight : {false, true})
        for (const Effort effort : {Effort::draft, Effort::fast}) {
            const Options options = periodic(Periodic::xy, 450, straight);
            Annealed recipe;
            recipe.effort = effort;
            recipe.tile = 64;
            const Result result = mesh_image(image.view(), options, recipe);
            check_mesh(image, result, options);
            CHECK(result.report.vertices == 450);
            CHECK(hmesh_test::same_bytes(mesh_image(image.view(), options, recipe, hmesh_test::ThreadFor{3}), result));
            CHECK(hmesh_test::same_bytes(mesh_image(image.view(), options, recipe, hmesh_test::ShuffledFor{4}), result));
        }
}

TEST_CASE("a picture that repeats is fitted as well beside the seam as elsewhere, and better than by a plain mesh") {
    const auto image = waves<std::uint8_t, 3>(96, 80);
    const auto error_beside = [&](const Mesh& mesh) {
        const Image<float, 3> drawn = hmesh_test::drawn<3>(mesh);
        double beside = 0, elsewhere = 0;
        for (int y = 0; y < 80; ++y)
            for (int x = 0; x < 96; ++x)
                for (int c = 0; c < 3; ++c) {
                    const double d = static_cast<double>(drawn.pixel(x, y)[c]) - image.pixel(x, y)[c];
                    (x < 2 || y < 2 || x >= 94 || y >= 78 ? beside : elsewhere) += d * d;
                }
        const double near = 4.0 * (96 + 80) - 16;
        return std::pair(beside / near, elsewhere / (96 * 80 - near));
    };
    const double plain = error_beside(mesh_image(image.view(), Options{Target::vertices(120)}).mesh).first;
    for (const bool straight : {false, true}) {
        const auto [beside, elsewhere] = error_beside(mesh_image(image.view(), periodic(Periodic::xy, 120, straight)).mesh);
        CAPTURE(straight);
        CHECK(beside < (straight ? 1.6 : 1.25) * elsewhere);
        CHECK(beside < 0.8 * plain);
    }
}

TEST_CASE("copies of a periodic mesh leave no pixel free at any size") {
    const auto image = hmesh_test::constant_image<std::uint8_t, 1>(37, 23, 0.5);
    const auto busy = hmesh_test::noise<std::uint8_t, 1>(37, 23, 8);
    Mesh mesh = mesh_image(busy.view(), periodic(Periodic::xy, 90)).mesh;
    std::fill(mesh.colors.begin(), mesh.colors.end(), 100.0F);
    for (const int scale : {1, 3, 7, 16}) {
        hmesh::RenderOptions options;
        options.width = scale * 37 + scale / 2;
        options.height = scale * 23;
        const Image<float, 1> drawn = hmesh_test::drawn<1>(mesh, options);
        const std::vector<float> samples = hmesh_test::samples_of(drawn);
        CHECK(*std::min_element(samples.begin(), samples.end()) == doctest::Approx(100));
    }
    CHECK(mesh_image(image.view(), periodic(Periodic::xy, 4)).report.energy == 0);
}

TEST_CASE("weights and premultiplied colours of periodic images count as they do elsewhere") {
    const auto image = hmesh_test::scene<std::uint8_t, 4>(50, 40, 6);
    const auto weights = hmesh_test::random_weights(50, 40, 2);
    for (const bool straight : {false, true}) {
        Options options = periodic(Periodic::xy, 150, straight);
        options.weights = weights.view();
        const Result weighted = mesh_image(image.view(), options);
        REQUIRE(weighted.status);
        CHECK(check_periodic(weighted.mesh.view()));
        float most = 0;
        for (const float weight : hmesh_test::samples_of(weights)) most = std::max(most, weight);
        const Image<float, 4> drawn = hmesh_test::drawn<4>(weighted.mesh);
        double energy = 0;
        for (int y = 0; y < 40; ++y)
            for (int x = 0; x < 50; ++x)
                for (int c = 0; c < 4; ++c) {
                    const double d = static_cast<double>(drawn.pixel(x, y)[c]) - image.pixel(x, y)[c];
                    energy += d * d * static_cast<double>(*weights.pixel(x, y)) / static_cast<double>(most);
                }
        CHECK(weighted.report.energy == doctest::Approx(energy).epsilon(1e-3));
        options.weights = {};
        options.premultiplied = true;
        const Result result = mesh_image(image.view(), options);
        REQUIRE(result.status);
        CHECK(result.mesh.premultiplied);
        check_mesh(hmesh::kit::premultiply(image.view()), result, options);
    }
}

TEST_CASE("a search for a PSNR of a periodic mesh reaches it") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(90, 70, 2);
    for (const bool straight : {false, true}) {
        Options options = periodic(Periodic::x, 4, straight);
        options.target = Target::psnr(27);
        const Result result = mesh_image(image.view(), options);
        check_mesh(image, result, options);
        CHECK(result.report.psnr >= 27);
        CHECK(result.report.psnr < 27.6);
    }
}

TEST_CASE("a periodic mesh can go on from another one, and from no other kind") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(80, 64, 3);
    Options options = periodic(Periodic::xy, 200);
    const Result first = mesh_image(image.view(), options);
    Annealed recipe;
    recipe.start = &first.mesh;
    for (const std::int64_t n : {160, 50}) {
        options.target = Target::vertices(n);
        const Result second = mesh_image(image.view(), options, recipe);
        check_mesh(image, second, options);
        CHECK(second.report.vertices == static_cast<std::size_t>(n));
    }
    const auto refused = [&](const Options& asked) {
        const Result result = mesh_image(image.view(), asked, recipe);
        CHECK(result.status.code == Errc::invalid_argument);
        CHECK(!result.has_mesh());
        return std::string(result.status.what);
    };
    CHECK(refused(periodic(Periodic::x, 160)) == "the mesh to start from is not periodic along the axes asked for");
    CHECK(refused(periodic(Periodic::none, 160)) == "the mesh to start from is not periodic along the axes asked for");
    CHECK(refused(periodic(Periodic::xy, 160, true)) == "the mesh to start from has no straight border, at vertex");
    Mesh torn = first.mesh;
    torn.faces.pop_back();
    recipe.start = &torn;
    CHECK(refused(options) == "the faces do not tile the image");
}

TEST_CASE("a periodic mesh is valid wherever it is cancelled") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(100, 80, 4);
    for (const bool straight : {false, true})
        for (int calls = 1; calls < 400; calls = calls * 3 / 2 + 1) {
            Options options = periodic(Periodic::xy, 200, straight);
            int left = calls;
            const auto stop = [&](const hmesh::ProgressInfo&) { return --left > 0; };
            options.progress = stop;
            Annealed recipe;
            recipe.tile = 64;
            const Result result = mesh_image(image.view(), options, recipe);
            CAPTURE(calls);
            if (!result.status) CHECK(result.status.code == Errc::cancelled);
            CHECK(hmesh_test::sheet_flaw(result.mesh, 10) == "");
            CHECK(check_periodic(result.mesh.view()));
            if (result.status) break;
        }
}

TEST_CASE("weights of channels go with periodic meshes") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(60, 50, 9);
    const std::vector<double> shares{1, 0.25, 0.5};
    for (const bool straight : {false, true}) {
        Options options = periodic(Periodic::xy, 150, straight);
        options.channel_weights = shares;
        const Result result = mesh_image(image.view(), options);
        REQUIRE(result.status);
        CHECK(check_periodic(result.mesh.view()));
        CHECK(hmesh_test::sheet_flaw(result.mesh) == "");
        const Image<float, 3> drawn = hmesh_test::drawn<3>(result.mesh);
        double energy = 0;
        for (int y = 0; y < 50; ++y)
            for (int x = 0; x < 60; ++x)
                for (int c = 0; c < 3; ++c) {
                    const double d = static_cast<double>(drawn.pixel(x, y)[c]) - image.pixel(x, y)[c];
                    energy += d * d * shares[static_cast<std::size_t>(c)];
                }
        CHECK(result.report.energy == doctest::Approx(energy).epsilon(1e-4));
    }
}

TEST_CASE("colours for linear light are one for the copies of a vertex, and no worse") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(70, 60, 4);
    const Image<float, 1> weights = hmesh_test::random_weights(70, 60, 4);
    for (const bool straight : {false, true}) {
        Mesh mesh = mesh_image(image.view(), periodic(Periodic::xy, 140, straight)).mesh;
        hmesh::LinearLightOptions options;
        if (straight) options.weights = weights.view();
        const hmesh::LinearLightReport report = hmesh::fit_linear_light(mesh, image.view(), options);
        REQUIRE(report.status);
        CHECK(report.energy < 0.999 * report.converted);
        CHECK(check_periodic(mesh.view()));
        if (straight) continue;
        hmesh::RenderOptions in_light;
        in_light.interpolation = hmesh::RenderOptions::Interpolation::linear;
        const Image<float, 3> drawn = hmesh_test::drawn<3>(mesh, in_light);
        double energy = 0;
        for (int y = 0; y < 60; ++y)
            for (int x = 0; x < 70; ++x)
                for (int c = 0; c < 3; ++c) {
                    const double d = static_cast<double>(drawn.pixel(x, y)[c]) - image.pixel(x, y)[c];
                    energy += d * d;
                }
        CHECK(report.energy == doctest::Approx(energy).epsilon(1e-5));
    }
}

TEST_CASE("pictures of periodic meshes have the copies that cover the image, models the mesh as it is") {
    const auto image = hmesh_test::noise<std::uint8_t, 3>(40, 30, 4);
    const Mesh mesh = mesh_image(image.view(), periodic(Periodic::xy, 120)).mesh;
    const Mesh whole = hmesh::kit::unrolled(mesh.view());
    REQUIRE(whole.face_count() > mesh.face_count());
    using Bytes = std::vector<unsigned char>;
    const auto bytes_of = [](auto&& write) {
        Bytes bytes;
        const auto sink = hmesh::kit::append_to(bytes);
        CHECK(write(hmesh::Sink(sink)));
        return bytes;
    };
    const auto same = [&](auto&& write) {
        return bytes_of([&](hmesh::Sink sink) { return write(mesh.view(), sink); }) ==
               bytes_of([&](hmesh::Sink sink) { return write(whole.view(), sink); });
    };
    CHECK(same([](const hmesh::MeshView& view, hmesh::Sink sink) { return hmesh::write_svg(view, sink); }));
    CHECK(same([](const hmesh::MeshView& view, hmesh::Sink sink) { return hmesh::write_pdf(view, sink); }));
    CHECK(same([](const hmesh::MeshView& view, hmesh::Sink sink) { return hmesh::write_eps(view, sink); }));
    CHECK(same([](const hmesh::MeshView& view, hmesh::Sink sink) { return hmesh::write_html(view, sink); }));
    CHECK_FALSE(same([](const hmesh::MeshView& view, hmesh::Sink sink) { return hmesh::write_ply(view, sink); }));
    CHECK_FALSE(same([](const hmesh::MeshView& view, hmesh::Sink sink) { return hmesh::write_glb(view, sink); }));
}

TEST_CASE("what cannot be periodic is refused with a sentence") {
    const auto image = hmesh_test::noise<std::uint8_t, 1>(8, 8, 1);
    const auto why = [&](const auto& recipe, const Options& options) {
        const Result result = mesh_image(image.view(), options, recipe);
        CHECK(result.status.code == Errc::invalid_argument);
        CHECK(!result.has_mesh());
        return std::string(result.status.what);
    };
    CHECK(why(hmesh::Adams(), periodic(Periodic::x, 8)) == "the recipe adams makes no periodic meshes");
    CHECK(why(hmesh::Hierarchical(), periodic(Periodic::y, 8)) == "the recipe hierarchical makes no periodic meshes");
    CHECK(why(Annealed(), periodic(Periodic::none, 8, true)) == "straight_border is for periodic meshes, and periodic is none");
    CHECK(why(Annealed(), periodic(static_cast<Periodic>(4), 8)) == "the axes of periodic are none of those known");
    const Image<std::uint8_t, 1> wide(hmesh::kit::max_period + 1, 1);
    CHECK(mesh_image(wide.view(), periodic(Periodic::x, 8)).status.code == Errc::image_too_large);
    CHECK(mesh_image(wide.view(), periodic(Periodic::y, 800)).status);
}
