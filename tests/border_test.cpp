#include "hmesh/methods/annealed/border.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "hmesh/lods.hpp"
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
using hmesh::Result;
using hmesh::Samples;
using hmesh::Target;

namespace {

// One of the heights of a terrain that many images are cut from.
double height_at(int x, int y, int) {
    return 0.5 + 0.2 * std::sin(0.21 * x) * std::cos(0.17 * y) + 0.1 * std::sin(0.031 * x * y / 9.0) + 0.1 * std::cos(0.4 * y);
}

template <class T, int C>
Image<T, C> cut(int left, int top, int width, int height) {
    return hmesh_test::draw<T, C>(width, height, [&](int x, int y, int c) { return height_at(left + x, top + y, c) / (c + 1); });
}

Options of_points(const Target& target) {
    Options options{target};
    options.samples = Samples::points;
    return options;
}

// Vertices with this coordinate along an axis, by the other one: place along the side and colours.
std::vector<std::vector<float>> side_of(const Mesh& mesh, std::size_t axis, float at) {
    const auto channels = static_cast<std::size_t>(mesh.channels);
    std::vector<std::vector<float>> side;
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
        if (mesh.positions[2 * v + axis] != at) continue;
        side.push_back({mesh.positions[2 * v + 1 - axis]});
        side.back().insert(side.back().end(), mesh.colors.begin() + static_cast<std::ptrdiff_t>(channels * v),
                           mesh.colors.begin() + static_cast<std::ptrdiff_t>(channels * (v + 1)));
    }
    std::sort(side.begin(), side.end());
    return side;
}

}  // namespace

TEST_CASE("images that share a row share its vertices to the bit, whatever else is in them, by any effort and in tiles") {
    Annealed recipe;
    recipe.border_tolerance = 3;
    for (const Effort effort : {Effort::draft, Effort::fast, Effort::normal}) {
        recipe.effort = effort;
        for (const int tile : {0, 64}) {
            recipe.tile = tile;
            const auto left = cut<std::uint8_t, 3>(0, 0, 91, 140), right = cut<std::uint8_t, 3>(90, 0, 150, 140);
            const auto below = cut<std::uint8_t, 3>(0, 139, 91, 40);
            const Result a = hmesh::mesh_image(left.view(), of_points(Target::vertices(500)), recipe);
            const Result b = hmesh::mesh_image(right.view(), of_points(Target::vertices(731)), recipe);
            const Result c = hmesh::mesh_image(below.view(), of_points(Target::vertices(300)), recipe);
            for (const Result* result : {&a, &b, &c})
                REQUIRE_MESSAGE(result->status, std::string(hmesh::message(result->status).c_str()));
            hmesh_test::prove_result(left, a, 500);
            hmesh_test::prove_result(right, b, 731);
            hmesh_test::prove_result(below, c, 300);
            CHECK(side_of(a.mesh, 0, 90).size() > 6);
            CHECK(side_of(a.mesh, 0, 90) == side_of(b.mesh, 0, 0));
            CHECK(side_of(a.mesh, 1, 139) == side_of(c.mesh, 1, 0));
            // The vertices have the samples' values, and the polyline passes the others.
            const auto side = side_of(a.mesh, 0, 90);
            for (const auto& vertex : side)
                for (std::size_t k = 0; k < 3; ++k) CHECK(vertex[k + 1] == left.pixel(90, static_cast<int>(vertex[0]))[k]);
            for (int y = 0; y < 140; ++y) {
                const auto next = std::find_if(side.begin() + 1, side.end() - 1,
                                               [&](const auto& vertex) { return vertex[0] >= static_cast<float>(y); });
                const auto& from = *(next - 1);
                const double share =
                    (y - static_cast<double>(from[0])) / (static_cast<double>((*next)[0]) - static_cast<double>(from[0]));
                for (std::size_t k = 1; k <= 3; ++k) {
                    const double at =
                        static_cast<double>(from[k]) + share * (static_cast<double>((*next)[k]) - static_cast<double>(from[k]));
                    CHECK(std::abs(at - left.pixel(90, y)[k - 1]) <= 3 + 1e-9);
                }
            }
        }
    }
}

TEST_CASE("floats, weights, sampled colours, searches, starts and levels keep the border, on any executor") {
    const auto image = cut<float, 1>(3, 5, 100, 80), beside = cut<float, 1>(102, 5, 60, 80);
    Annealed recipe{Effort::fast};
    recipe.border_tolerance = 0.01;
    const Result plain = hmesh::mesh_image(image.view(), of_points(Target::vertices(300)), recipe);
    REQUIRE(plain.status);
    const auto right = side_of(plain.mesh, 0, 99);
    CHECK(right.size() > 4);
    CHECK(side_of(hmesh::mesh_image(beside.view(), of_points(Target::vertices(200)), recipe).mesh, 0, 0) == right);
    CHECK(hmesh_test::same_bytes(
        plain, hmesh::mesh_image(image.view(), of_points(Target::vertices(300)), recipe, hmesh_test::ThreadFor{3})));

    const auto has_it = [&](const Result& result) {
        CHECK_MESSAGE(result.status, std::string(hmesh::message(result.status).c_str()));
        CHECK(hmesh_test::flaw_of(result.mesh.view(), 100, 80) == "");
        CHECK(side_of(result.mesh, 0, 99) == right);
    };
    const auto weights = hmesh_test::random_weights(100, 80, 3);
    Options options = of_points(Target::vertices(280));
    options.weights = weights.view();
    has_it(hmesh::mesh_image(image.view(), options, recipe));
    options = of_points(Target::vertices(280));
    options.colors = hmesh::Colors::sampled;
    has_it(hmesh::mesh_image(image.view(), options, recipe));
    Annealed on = recipe;
    on.start = &plain.mesh;
    has_it(hmesh::mesh_image(image.view(), of_points(Target::vertices(350)), on));
    hmesh::LodOptions two;
    two.levels = 2;
    const hmesh::Lods lods = hmesh::mesh_lods(image.view(), of_points(Target::vertices(400)), two, recipe);
    REQUIRE(lods.status);
    for (const Result& level : lods.levels) has_it(level);

    recipe.border_tolerance = 0.05;
    const Result search = hmesh::mesh_image(image.view(), of_points(Target::psnr(42)), recipe);
    CHECK_MESSAGE(search.status, std::string(hmesh::message(search.status).c_str()));
    CHECK(search.report.psnr >= 42);
    CHECK(side_of(search.mesh, 0, 99) ==
          side_of(hmesh::mesh_image(beside.view(), of_points(Target::vertices(200)), recipe).mesh, 0, 0));
}

TEST_CASE("borders that cannot be are refused with a sentence") {
    const auto image = cut<std::uint8_t, 1>(0, 0, 60, 50);
    const auto status_of = [&](const Options& options, const Annealed& recipe) {
        return hmesh::mesh_image(image.view(), options, recipe).status;
    };
    Annealed recipe{Effort::draft};
    for (const double tolerance : {-1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        recipe.border_tolerance = tolerance;
        CHECK(status_of(of_points(Target::vertices(100)), recipe).code == Errc::invalid_argument);
    }
    recipe.border_tolerance = 1e300;
    CHECK(status_of(of_points(Target::vertices(100)), recipe).limit == std::numeric_limits<float>::max());
    recipe.border_tolerance = 0;
    const hmesh::Status few = status_of(of_points(Target::vertices(20)), recipe);
    CHECK(few.code == Errc::target_out_of_range);
    CHECK(std::string(hmesh::message(few).c_str()).find("limit 20)") != std::string::npos);
    // A search that comes to fewer ends with the same sentence, whatever bounds it.
    const hmesh::Status searched = status_of(of_points(Target::psnr(35, 20)), recipe);
    CHECK(searched.code == Errc::target_out_of_range);
    CHECK(searched.value == few.value);
    CHECK(std::string(searched.what) == few.what);
    CHECK(!hmesh::mesh_image(image.view(), of_points(Target::vertices(20)), recipe).has_mesh());
    // Four corners that are all that the sides ask for are a mesh, which a search may end with.
    recipe.border_tolerance = 1000;
    const Result corners = hmesh::mesh_image(image.view(), of_points(Target::psnr(90, 4)), recipe);
    CHECK(corners.status.code == Errc::target_out_of_range);
    CHECK(corners.report.vertices == 4);
    CHECK(corners.has_mesh());
    recipe.border_tolerance = 2;
    CHECK(status_of(Options{Target::vertices(300)}, recipe).code == Errc::invalid_argument);
    Options weighted = of_points(Target::vertices(300));
    weighted.channel_weights = {1};
    CHECK(status_of(weighted, recipe));  // one weight makes no difference
    Annealed other = recipe;
    other.border_tolerance = 5;
    const Mesh mesh = hmesh::mesh_image(image.view(), of_points(Target::vertices(300)), other).mesh;
    recipe.start = &mesh;
    CHECK(status_of(of_points(Target::vertices(300)), recipe).code == Errc::invalid_argument);
}

TEST_CASE("every number of vertices from few to one a sample is reached or refused, whatever the image") {
    for (const auto& [columns, rows] : {std::pair{2, 2}, {2, 30}, {30, 2}, {3, 3}, {17, 12}}) {
        const int width = columns, height = rows;
        for (std::uint64_t seed = 1; seed <= 3; ++seed)
            for (int n = 4; n <= width * height; n += 1 + n / 3) {
                const auto image = seed == 1 ? hmesh_test::constant_image<std::uint8_t, 1>(width, height, 0.5)
                                             : hmesh_test::noise<std::uint8_t, 1>(width, height, seed);
                Annealed recipe{seed == 2 ? Effort::draft : Effort::normal};
                recipe.border_tolerance = seed == 3 ? 40 : 0;
                const Result result = hmesh::mesh_image(image.view(), of_points(Target::vertices(n)), recipe);
                CAPTURE(width);
                CAPTURE(height);
                CAPTURE(n);
                CAPTURE(seed);
                CHECK(result.has_mesh() == static_cast<bool>(result.status));
                if (result.has_mesh()) CHECK(hmesh_test::flaw_of(result.mesh.view(), width, height) == "");
                if (result.status) CHECK(result.report.vertices == static_cast<std::size_t>(n));
                else CHECK(result.status.code == Errc::target_out_of_range);
            }
    }
}

TEST_CASE("vertices are as dense as wanted beside a long flat side of two of them") {
    auto image = hmesh_test::noise<std::uint8_t, 1>(449, 129, 1);
    const int right = image.width() - 1, bottom = image.height() - 1;
    for (int x = 0; x <= right; ++x) *image.pixel(x, 0) = *image.pixel(x, bottom) = 0;
    for (int y = 0; y <= bottom; ++y) *image.pixel(0, y) = *image.pixel(right, y) = 0;
    Annealed recipe{Effort::draft};
    recipe.border_tolerance = 0;
    const Result result = hmesh::mesh_image(image.view(), of_points(Target::vertices(28960)), recipe);
    CHECK(result.status);
    CHECK(result.report.vertices == 28960);
    CHECK(side_of(result.mesh, 1, 0.0F).size() == 2);
    CHECK(hmesh_test::flaw_of(result.mesh.view(), image.width(), image.height()) == "");
}
