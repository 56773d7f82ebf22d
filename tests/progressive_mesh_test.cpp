#include "hmesh/lods/progressive_mesh.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "test_executors.hpp"
#include "test_images.hpp"
#include "test_meshing.hpp"
#include "test_results.hpp"

using hmesh::Annealed;
using hmesh::Effort;
using hmesh::Errc;
using hmesh::Image;
using hmesh::Mesh;
using hmesh::Options;
using hmesh::progressive_mesh;
using hmesh::ProgressiveLevel;
using hmesh::ProgressiveMesh;
using hmesh::ProgressiveOptions;

namespace {

template <class T, int C>
Mesh mesh_of(const Image<T, C>& image, std::int64_t n, const Options& base = {}) {
    Options options = base;
    options.target = hmesh::Target::vertices(n);
    hmesh::Result result = hmesh::mesh_image(image.view(), options, Annealed{Effort::draft});
    REQUIRE(result.status);
    return std::move(result.mesh);
}

ProgressiveOptions count(int levels, double coarser_weight = 0.5) { return {levels, coarser_weight}; }

// Level k as a mesh with arrays of its own.
Mesh level_of(const ProgressiveMesh& nested, std::size_t k) {
    const hmesh::MeshView view = nested.view(k);
    Mesh mesh = nested.mesh;
    mesh.positions.resize(2 * view.vertex_count);
    mesh.colors.resize(static_cast<std::size_t>(view.channels) * view.vertex_count);
    mesh.faces.assign(view.faces, view.faces + view.face_count);
    return mesh;
}

// Every level is a valid mesh of the whole image which uses all vertices of its prefix and no other, and whose error is as drawn.
template <class T, int C>
void prove_levels(const Image<T, C>& image, const ProgressiveMesh& nested, const std::vector<std::size_t>& vertices) {
    CHECK_MESSAGE(nested.status, hmesh::message(nested.status).c_str());
    REQUIRE(nested.levels.size() == vertices.size());
    for (std::size_t k = 0; k < vertices.size(); ++k) {
        CAPTURE(k);
        const ProgressiveLevel& level = nested.levels[k];
        CHECK(level.vertices == vertices[k]);
        CHECK(hmesh_test::flaw_of(nested.view(k), image.width(), image.height()) == "");
        std::set<std::uint32_t> used;
        for (const hmesh::Triangle& face : level.faces) used.insert(face.begin(), face.end());
        CHECK(used.size() == vertices[k]);
        CHECK(*used.rbegin() == vertices[k] - 1);
        const double energy = hmesh_test::rendered_error(image, level_of(nested, k));
        CHECK(std::abs(level.energy - energy) <= 2.3e-4 * energy + hmesh_test::energy_rounding(image));
        if (energy > 0)
            CHECK(level.psnr == doctest::Approx(10 * std::log10(hmesh::PixelTraits<T>::peak * hmesh::PixelTraits<T>::peak *
                                                                static_cast<double>(image.size()) / level.energy)));
    }
}

std::multiset<std::array<float, 2>> points_of(const Mesh& mesh) {
    std::multiset<std::array<float, 2>> points;
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) points.insert({mesh.positions[2 * v], mesh.positions[2 * v + 1]});
    return points;
}

void check_refused(const ProgressiveMesh& nested, Errc code, const char* words) {
    CHECK(nested.levels.empty());
    CHECK(!nested.status);
    CHECK(nested.status.code == code);
    CHECK(std::string(nested.status.what).find(words) != std::string::npos);
}

}  // namespace

TEST_CASE("each level tiles the image with a prefix of one vertex buffer") {
    const Image<std::uint8_t, 3> image = hmesh_test::scene<std::uint8_t, 3>(100, 80, 3);
    const Mesh finest = mesh_of(image, 301);
    const ProgressiveMesh nested = progressive_mesh(image.view(), finest);
    prove_levels(image, nested, {301, 150, 75, 37, 18});
    CHECK(points_of(nested.mesh) == points_of(finest));
    CHECK(nested.mesh.faces == nested.levels[0].faces);
    CHECK(nested.mesh.faces.size() == finest.faces.size());
    for (const float color : nested.mesh.colors) CHECK((color >= 0 && color <= 255 && std::floor(color) == color));
}

TEST_CASE("levels come for other samples, channels and weights, and for images of a pixel, a row or one colour") {
    const Image<float, 1> floats = hmesh_test::scene<float, 1>(60, 50, 4);
    prove_levels(floats, progressive_mesh(floats.view(), mesh_of(floats, 100), {}, count(3)), {100, 50, 25});
    const Image<std::uint8_t, 4> rgba = hmesh_test::scene<std::uint8_t, 4>(60, 50, 5);
    Options options;
    options.premultiplied = true;
    const ProgressiveMesh premultiplied = progressive_mesh(rgba.view(), mesh_of(rgba, 100, options), options, count(3));
    CHECK(premultiplied.levels.size() == 3);
    CHECK(premultiplied.mesh.premultiplied);
    const Image<float, 1> weights = hmesh_test::draw<float, 1>(60, 50, [](int x, int, int) { return x < 30 ? 1.0 : 0.0; });
    const Image<std::uint8_t, 1> grey = hmesh_test::scene<std::uint8_t, 1>(60, 50, 6);
    options = {};
    options.weights = weights.view();
    CHECK(progressive_mesh(grey.view(), mesh_of(grey, 100, options), options, count(3)).levels.size() == 3);

    const Image<std::uint8_t, 1> pixel = hmesh_test::constant_image<std::uint8_t, 1>(1, 1, 0.5);
    prove_levels(pixel, progressive_mesh(pixel.view(), mesh_of(pixel, 4)), {4});
    const Image<std::uint8_t, 3> row = hmesh_test::scene<std::uint8_t, 3>(30, 1, 5);
    prove_levels(row, progressive_mesh(row.view(), mesh_of(row, 16)), {16, 8, 4});
    const Image<std::uint8_t, 3> flat = hmesh_test::constant_image<std::uint8_t, 3>(40, 30, 1.0);
    prove_levels(flat, progressive_mesh(flat.view(), mesh_of(flat, 80), {}, count(32)), {80, 40, 20, 10, 5});
}

TEST_CASE("the weight of coarser levels moves error between them") {
    const Image<std::uint8_t, 3> image = hmesh_test::scene<std::uint8_t, 3>(120, 90, 7);
    const Mesh finest = mesh_of(image, 400);
    const ProgressiveMesh first = progressive_mesh(image.view(), finest, {}, count(4, 0));
    const ProgressiveMesh half = progressive_mesh(image.view(), finest, {}, count(4));
    const ProgressiveMesh alike = progressive_mesh(image.view(), finest, {}, count(4, 1));
    REQUIRE((first.levels.size() == 4 && half.levels.size() == 4 && alike.levels.size() == 4));
    CHECK(first.levels[0].psnr > half.levels[0].psnr);
    CHECK(half.levels[0].psnr > alike.levels[0].psnr);
    CHECK(first.levels[3].psnr < half.levels[3].psnr);
    CHECK(half.levels[3].psnr < alike.levels[3].psnr);
    // Alone, the finest level has the colours that the mesh came with, but for the last rounding.
    const double energy = hmesh_test::rendered_error(image, finest);
    CHECK(first.levels[0].energy <= 1.001 * energy);
}

TEST_CASE("what is no mesh of the image, and options out of range, are refused with a sentence") {
    const Image<std::uint8_t, 3> image = hmesh_test::scene<std::uint8_t, 3>(40, 30, 2);
    const Mesh mesh = mesh_of(image, 60);
    check_refused(progressive_mesh(image.view(), mesh, {}, count(0)), Errc::invalid_argument, "at least 1 level");
    check_refused(progressive_mesh(image.view(), mesh, {}, count(33)), Errc::invalid_argument, "at most 32 levels");
    for (const double bad : {-0.1, 1.1, std::numeric_limits<double>::quiet_NaN()})
        check_refused(progressive_mesh(image.view(), mesh, {}, count(5, bad)), Errc::invalid_argument, "weight of coarser");
    check_refused(progressive_mesh(image.view(), Mesh()), Errc::invalid_argument, "channels");
    check_refused(progressive_mesh(hmesh_test::scene<std::uint8_t, 3>(41, 30, 2).view(), mesh), Errc::invalid_argument, "wide");
    Mesh broken = mesh;
    broken.faces.pop_back();
    check_refused(progressive_mesh(image.view(), broken), Errc::invalid_argument, "");
    broken = mesh;
    broken.colors[5] = std::numeric_limits<float>::quiet_NaN();
    check_refused(progressive_mesh(image.view(), broken), Errc::invalid_argument, "finite");
    broken = mesh;
    broken.premultiplied = true;
    check_refused(progressive_mesh(image.view(), broken), Errc::invalid_argument, "premultiplied");
    check_refused(progressive_mesh(hmesh::ImageView<std::uint8_t, 3>{}, mesh), Errc::invalid_argument, "");
    hmesh::Options repeating;
    repeating.periodic = hmesh::Periodic::x;
    check_refused(progressive_mesh(image.view(), mesh, repeating), Errc::invalid_argument, "do not repeat");
    Mesh repeats = mesh;
    repeats.periodic = hmesh::Periodic::x;
    check_refused(progressive_mesh(image.view(), repeats), Errc::invalid_argument, "do not repeat");
    hmesh::Options weighted;
    weighted.channel_weights = {1, 2, 3};
    check_refused(progressive_mesh(image.view(), mesh, weighted), Errc::invalid_argument, "channel_weights");
}

TEST_CASE("progress rises to 1, a cancellation leaves no levels, and any executor gives the same bytes") {
    const Image<std::uint8_t, 3> image = hmesh_test::scene<std::uint8_t, 3>(100, 80, 3);
    const Mesh finest = mesh_of(image, 300);
    double last = 0;
    bool rises = true;
    const auto watch = [&](const hmesh::ProgressInfo& info) {
        rises = rises && info.total >= last;
        last = info.total;
        return true;
    };
    Options options;
    options.progress = watch;
    const ProgressiveMesh one = progressive_mesh(image.view(), finest, options);
    CHECK(rises);
    CHECK(last == 1);
    for (const double stop : {0.0, 0.3, 0.6, 0.84, 0.86, 0.9, 1.0}) {
        const auto cancel = [stop](const hmesh::ProgressInfo& info) { return info.total < stop; };
        options.progress = cancel;
        check_refused(progressive_mesh(image.view(), finest, options), Errc::cancelled, "cancelled");
    }
    const ProgressiveMesh other = progressive_mesh(image.view(), finest, {}, {}, hmesh_test::ThreadFor{3});
    CHECK(hmesh_test::same_bytes(one.mesh, other.mesh));
    REQUIRE(one.levels.size() == other.levels.size());
    for (std::size_t k = 0; k < one.levels.size(); ++k) CHECK(one.levels[k].faces == other.levels[k].faces);
}
