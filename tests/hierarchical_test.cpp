#include "hmesh/methods/hierarchical/hierarchical.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "hmesh/mesh_image.hpp"
#include "test_images.hpp"
#include "test_meshing.hpp"
#include "test_methods.hpp"
#include "test_results.hpp"

using hmesh::Hierarchical;
using hmesh::Image;
using hmesh::Result;
using hmesh::kit::FootSearch;
using hmesh::kit::StepRule;

namespace {

hmesh::Options options_of(std::size_t n) {
    hmesh::Options options;
    options.target = hmesh::Target::vertices(static_cast<std::int64_t>(n));
    return options;
}

// The mesh proven.
Result mesh_of(const Image<std::uint8_t, 1>& image, std::size_t n, const Hierarchical& recipe = {}) {
    Result result = mesh_image(image.view(), options_of(n), recipe);
    hmesh_test::prove_result(image, result, n);
    return result;
}

Image<std::uint8_t, 1> scene() { return hmesh_test::scene<std::uint8_t, 1>(40, 30, 2); }

// A LevelFilter: how often it was called, on what, and what it does to a sample.
struct Filter {
    float (*change)(float, std::size_t);
    int calls = 0;
    bool sizes_ok = true, begins_as_copy = true;
    std::vector<float> first{};  // what it was given at first

    void operator()(const float* from, float* to, int width, int height, int channels) {
        const auto size = static_cast<std::size_t>(width * height * channels);
        sizes_ok = sizes_ok && width == 40 && height == 30 && channels == 1;
        begins_as_copy = begins_as_copy && std::equal(from, from + size, to);
        if (calls++ == 0) first.assign(from, from + size);
        for (std::size_t k = 0; k < size; ++k) to[k] = change(from[k], k);
    }
};

Result mesh_with(const Image<std::uint8_t, 1>& image, Filter& filter, int levels) {
    Hierarchical recipe;
    recipe.levels = levels;
    recipe.filter = filter;
    return mesh_of(image, 60, recipe);
}

}  // namespace

TEST_CASE("stages come level by level, and those of geometry tell how the solver did") {
    for (const int levels : {1, 2, 3})
        for (const bool start_filtered : {false, true}) {
            Hierarchical recipe;
            recipe.levels = levels;
            recipe.start_filtered = start_filtered;
            const Result result = mesh_of(scene(), 60, recipe);
            std::string names, expected = "levels points removal";
            for (int round = 0; round < 2 * levels; ++round) expected += " geometry flips";
            for (const hmesh::StageReport& stage : result.report.stages) {
                names += std::string(names.empty() ? "" : " ") + stage.name;
                const bool solves = std::string(stage.name) == "geometry";
                CHECK((stage.iterations > 0) == solves);
                CHECK((stage.residual > 0) == solves);
                CHECK(stage.iterations <= recipe.geometry.pcg.max_iterations);
                CHECK(stage.residual <= recipe.geometry.pcg.tolerance);
            }
            CHECK(names == expected + " colors");
        }
}

TEST_CASE("what the stage of levels leaves is reported as it is: the four corners with their error") {
    const auto image = scene();
    const Result result = mesh_of(image, 60);
    const hmesh::StageReport& levels = result.report.stages.front();
    REQUIRE(std::string(levels.name) == "levels");
    CHECK(levels.vertices == 4);
    CHECK(levels.energy > result.report.energy);
    CHECK(levels.psnr < result.report.psnr);
}

TEST_CASE("flips and, safeguarded, geometry steps lower the energy; the mesh is far better than the one at the start") {
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
        Hierarchical recipe;
        recipe.levels = 1;
        recipe.rounds = 4;
        const auto image = hmesh_test::scene<std::uint8_t, 1>(56, 48, seed);
        const Result result = mesh_of(image, 80, recipe);
        const auto& stages = result.report.stages;  // levels points removal (geometry flips)* colors
        for (std::size_t k = 3; k + 1 < stages.size(); ++k) CHECK(stages[k].energy <= stages[k - 1].energy * (1 + 1e-6));
        CHECK(result.report.energy < 0.6 * stages[2].energy);
    }
}

TEST_CASE("without rounds the mesh is that of adams, with optimal colours if asked for") {
    Hierarchical recipe;
    recipe.rounds = 0;
    recipe.start_filtered = false;
    for (const auto colors : {hmesh::Colors::optimal, hmesh::Colors::sampled}) {
        hmesh::Options options = options_of(60);
        options.colors = colors;
        const Result none = mesh_image(scene().view(), options, recipe),
                     start = mesh_image(scene().view(), options, recipe.start);
        CHECK(hmesh_test::same_bytes(none.mesh, start.mesh));
    }
}

TEST_CASE("a user's filter is called once a level, on the image first, and on a copy of its input") {
    const auto image = scene();
    for (const int levels : {1, 2, 4}) {
        Filter half{[](float x, std::size_t) { return 0.5F * x; }};
        (void)mesh_with(image, half, levels);
        CHECK(half.calls == levels - 1);
        CHECK(half.sizes_ok);
        CHECK(half.begins_as_copy);
        if (levels > 1) CHECK(std::equal(half.first.begin(), half.first.end(), image.data(), image.data() + image.size()));
    }
}

TEST_CASE("levels that are the image again are as if more rounds were done on it") {
    const auto image = scene();
    Filter identity{[](float x, std::size_t) { return x; }};
    Hierarchical twice, once;
    twice.levels = 2;
    twice.filter = identity;
    once.levels = 1;
    const Result filtered = mesh_of(image, 60, twice);
    twice.start_filtered = false;
    CHECK(hmesh_test::same_bytes(mesh_of(image, 60, twice).mesh, filtered.mesh));
    once.rounds = 4;
    // But for the colours that are solved for anew where a level begins.
    const Result longer = mesh_of(image, 60, once);
    CHECK(filtered.report.stages.size() == longer.report.stages.size());
    CHECK(std::abs(filtered.report.psnr - longer.report.psnr) < 0.1);
}

TEST_CASE("where a user's filter has no answer, NaN or infinite, the level keeps its samples") {
    const auto image = scene();
    Filter identity{[](float x, std::size_t) { return x; }};
    Filter nan{[](float, std::size_t) { return std::numeric_limits<float>::quiet_NaN(); }};
    Filter mixed{
        [](float x, std::size_t k) { return k % 3 == 0 ? x : (k % 3 == 1 ? 1 : -1) * std::numeric_limits<float>::infinity(); }};
    const Result kept = mesh_with(image, identity, 3);
    CHECK(hmesh_test::same_bytes(mesh_with(image, nan, 3), kept));
    CHECK(hmesh_test::same_bytes(mesh_with(image, mixed, 3), kept));
}

TEST_CASE("a user's filter may return anything") {
    const auto image = scene();
    Filter wild{[](float x, std::size_t k) { return k % 2 == 0 ? 1e38F : -x * 1e30F; }};
    Filter inverted{[](float x, std::size_t) { return 255 - x; }};
    Filter empty{[](float, std::size_t) { return 0.0F; }};
    (void)mesh_with(image, wild, 2);
    (void)mesh_with(image, empty, 2);
    CHECK(mesh_with(image, inverted, 2).report.psnr > mesh_of(image, 60).report.psnr - 3);  // bends where the image does
}

TEST_CASE("every search for foot points, both rules and options at the ends of their ranges give valid meshes") {
    const auto image = hmesh_test::scene<std::uint8_t, 1>(14, 12, 3);
    for (const FootSearch search : {FootSearch::plane, FootSearch::own_face, FootSearch::one_ring})
        for (const StepRule rule : {StepRule::safeguarded, StepRule::literal})
            for (const bool high : {false, true})
                for (const std::size_t n : {4U, 30U, 168U}) {
                    CAPTURE(n);
                    Hierarchical recipe;
                    recipe.geometry.search = search;
                    recipe.geometry.rule = rule;
                    (void)mesh_of(image, n, recipe);
                    recipe.levels = high ? 3 : 1;
                    recipe.rounds = high ? 3 : 1;
                    recipe.flip_visits = high ? 1000000 : 1;
                    recipe.start = {high ? 1000.0 : 1.0, high ? 100 : 0};
                    recipe.geometry.color_scale = high ? 1e3 : 1e-3;
                    recipe.geometry.ridge = high ? 1e3 : 1e-9;
                    recipe.geometry.halvings = high ? 20 : 0;
                    recipe.geometry.pcg = {high ? 500 : 1, high ? 1 : 1e-15};
                    recipe.bilateral = {high && n == 4 ? 99 : 1, high ? 1e300 : 1e-300, high ? 1e300 : 1e-300};
                    REQUIRE(recipe.check());
                    (void)mesh_of(image, n, recipe);
                }
}

TEST_CASE("coordinates under the pixels cannot move a vertex: V K = P holds already") {
    Hierarchical recipe;
    recipe.levels = 1;
    recipe.geometry.search = FootSearch::plane;
    recipe.geometry.pcg.tolerance = 1e-13;
    for (const StepRule rule : {StepRule::safeguarded, StepRule::literal}) {
        recipe.geometry.rule = rule;
        const Result result = mesh_of(scene(), 60, recipe);
        recipe.rounds = 0;
        const Result start = mesh_of(scene(), 60, recipe);
        recipe.rounds = 2;
        CHECK(result.mesh.positions.size() == start.mesh.positions.size());
        std::vector<std::pair<float, float>> moved, left;
        for (std::size_t v = 0; v < 60; ++v) {
            moved.emplace_back(result.mesh.positions[2 * v], result.mesh.positions[2 * v + 1]);
            left.emplace_back(start.mesh.positions[2 * v], start.mesh.positions[2 * v + 1]);
        }
        std::sort(moved.begin(), moved.end());
        std::sort(left.begin(), left.end());
        CHECK(moved == left);
    }
}

TEST_CASE("options of hierarchical that mean nothing are named") {
    using hmesh_test::is_refused;
    for (const double bad : hmesh_test::bad_numbers) {
        CHECK(is_refused<Hierarchical>("adams density", [&](Hierarchical& o) { o.start.density = bad; }));
        CHECK(is_refused<Hierarchical>("hierarchical geometry.color_scale",
                                       [&](Hierarchical& o) { o.geometry.color_scale = bad; }));
        CHECK(is_refused<Hierarchical>("hierarchical geometry.ridge", [&](Hierarchical& o) { o.geometry.ridge = bad; }));
        CHECK(is_refused<Hierarchical>("hierarchical geometry.pcg.tolerance",
                                       [&](Hierarchical& o) { o.geometry.pcg.tolerance = bad; }));
        if (bad == 1e300) continue;
        CHECK(is_refused<Hierarchical>("bilateral sigma_color", [&](Hierarchical& o) { o.bilateral.sigma_color = bad; }));
        CHECK(is_refused<Hierarchical>("bilateral sigma_space", [&](Hierarchical& o) { o.bilateral.sigma_space = bad; }));
    }
    const auto iterations = [](int bad) {
        return is_refused<Hierarchical>("hierarchical geometry.pcg.max_iterations",
                                        [bad](Hierarchical& o) { o.geometry.pcg.max_iterations = bad; });
    };
    for (const int bad : hmesh_test::bad_integers) {
        CHECK(is_refused<Hierarchical>("adams smoothing", [&](Hierarchical& o) { o.start.smoothing = bad; }));
        CHECK(is_refused<Hierarchical>("bilateral diameter", [&](Hierarchical& o) { o.bilateral.diameter = bad; }));
        CHECK(is_refused<Hierarchical>("hierarchical levels", [&](Hierarchical& o) { o.levels = bad; }));
        CHECK(is_refused<Hierarchical>("hierarchical rounds", [&](Hierarchical& o) { o.rounds = bad; }));
        CHECK(is_refused<Hierarchical>("hierarchical flip_visits", [&](Hierarchical& o) { o.flip_visits = bad; }));
        CHECK(is_refused<Hierarchical>("hierarchical geometry.halvings", [&](Hierarchical& o) { o.geometry.halvings = bad; }));
        CHECK(iterations(bad));
    }
    CHECK(is_refused<Hierarchical>("hierarchical levels", [](Hierarchical& o) { o.levels = 0; }));
    CHECK(is_refused<Hierarchical>("hierarchical levels", [](Hierarchical& o) { o.levels = 21; }));
    CHECK(is_refused<Hierarchical>("hierarchical flip_visits", [](Hierarchical& o) { o.flip_visits = 0; }));
    CHECK(is_refused<Hierarchical>("hierarchical geometry.ridge", [](Hierarchical& o) { o.geometry.ridge = 0; }));
    CHECK(is_refused<Hierarchical>("hierarchical geometry.halvings", [](Hierarchical& o) { o.geometry.halvings = 21; }));
    CHECK(iterations(0));
    for (const int bad : {3, 255}) {
        const auto search = static_cast<hmesh::kit::FootSearch>(bad);
        const auto rule = static_cast<hmesh::kit::StepRule>(bad);
        CHECK(is_refused<Hierarchical>("hierarchical geometry.search", [&](Hierarchical& o) { o.geometry.search = search; }));
        CHECK(is_refused<Hierarchical>("hierarchical geometry.rule", [&](Hierarchical& o) { o.geometry.rule = rule; }));
    }
    CHECK(is_refused<Hierarchical>("hierarchical geometry.rule",
                                   [](Hierarchical& o) { o.geometry.rule = hmesh::kit::StepRule{2}; }));
}
