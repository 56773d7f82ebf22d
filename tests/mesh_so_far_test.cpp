// Meshes that grow while one looks: ProgressInfo::mesh_so_far.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "hmesh/core/progress.hpp"
#include "hmesh/lods.hpp"
#include "hmesh/paper.hpp"
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
using hmesh::ProgressInfo;
using hmesh::Result;
using hmesh::Target;

namespace {

// Takes each mesh that is offered, and says stop after `most` of them.
struct Listener {
    struct Taken {
        std::string stage;
        std::size_t vertices;
        Mesh mesh;
    };
    std::vector<Taken> taken;
    std::size_t most = 1000;

    bool operator()(const ProgressInfo& info) {
        if (!info.mesh_so_far) return true;
        taken.push_back({info.stage, info.vertices, info.mesh_so_far()});
        CHECK(hmesh_test::same_bytes(info.mesh_so_far(), taken.back().mesh));
        return taken.size() < most;
    }
    [[nodiscard]] std::string stages() const {
        std::string names;
        for (const Taken& one : taken) names += one.stage + " ";
        return names;
    }
};

// The same result whether one listens or not, and valid meshes of the image on the way to it.
template <class T, int C, class Recipe>
Listener check_meshes(const Image<T, C>& image, Options options, const Recipe& recipe, const hmesh::ParallelFor& executor = {}) {
    const Result alone = hmesh::mesh_image(image.view(), options, recipe, executor);
    REQUIRE(alone.status);
    Listener listener;
    options.progress = listener;
    const Result result = hmesh::mesh_image(image.view(), options, recipe, executor);
    CHECK(hmesh_test::same_bytes(result, alone));
    REQUIRE(!listener.taken.empty());
    for (const Listener::Taken& one : listener.taken) {
        CAPTURE(one.stage);
        const Mesh& mesh = one.mesh;
        if (options.periodic == hmesh::Periodic::none) {
            CHECK(hmesh_test::flaw_of(mesh.view(), image.width(), image.height()) == "");
            CHECK(mesh.vertex_count() == one.vertices);
        } else CHECK(hmesh::kit::check_periodic(mesh.view()));
        CHECK(mesh.colors.size() == C * mesh.vertex_count());
        CHECK(mesh.premultiplied == options.premultiplied);
        using Traits = hmesh::PixelTraits<T>;
        const auto [low, high] = std::minmax_element(mesh.colors.begin(), mesh.colors.end());
        CHECK(static_cast<double>(*low) >= Traits::lowest);
        CHECK(static_cast<double>(*high) <= Traits::highest);
    }
    CHECK(hmesh_test::same_bytes(listener.taken.back().mesh, result.mesh));
    return listener;
}

}  // namespace

TEST_CASE("a mesh may be seen after each stage and each sweep, gets better, and ends the same as unseen") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(160, 140, 6);
    const hmesh_test::ThreadFor threads{3};
    for (const int tile : {0, 64}) {
        const Listener seen = check_meshes(image, Options{Target::vertices(1200)}, Annealed{Effort::normal, 1, tile}, threads);
        CHECK(seen.stages() == "points settle collapse anneal anneal anneal anneal anneal anneal anneal polish colors ");
        const auto error = [&](std::size_t k) { return hmesh_test::rendered_error(image, seen.taken[k].mesh); };
        CHECK(seen.taken[0].vertices == 3600);
        CHECK(error(1) < error(0));
        CHECK(seen.taken[2].vertices == 1200);
        const std::size_t last = seen.taken.size() - 1;
        CHECK(error(last) < error(2));
        // Colours are nearly the final ones.
        CHECK(error(last - 1) < 1.01 * error(last));
    }
}

TEST_CASE("any kind of image and any method lets its mesh be seen") {
    const auto gray = hmesh_test::scene<float, 1>(90, 70, 2);
    Options options{Target::vertices(300)};
    const Annealed fast{Effort::fast, 1, 64};
    check_meshes(gray, options, fast);
    check_meshes(gray, options, hmesh::Adams{});
    // The meshes of coarser levels are not of the image.
    const Listener levels = check_meshes(hmesh_test::scene<std::uint8_t, 3>(120, 100, 2), options, hmesh::Hierarchical{});
    CHECK(levels.stages() == "geometry flips geometry flips colors ");
    for (const bool is_straight : {false, true}) {
        Options periodic = options;
        periodic.periodic = hmesh::Periodic::xy;
        periodic.straight_border = is_straight;
        check_meshes(gray, periodic, fast);
    }
    Options points = options;
    points.samples = hmesh::Samples::points;
    check_meshes(gray, points, fast);
    Options sprite = options;
    sprite.premultiplied = true;
    check_meshes(hmesh_test::scene<std::uint8_t, 4>(90, 70, 2), sprite, fast);
    // Channels that count nothing have colours too.
    const auto image = hmesh_test::scene<std::uint8_t, 3>(90, 70, 2);
    Options weighted = options;
    weighted.channel_weights = {1, 0.5, 0};
    const Listener seen = check_meshes(image, weighted, fast);
    for (const Listener::Taken& one : seen.taken) {
        bool is_flat = true;
        for (std::size_t v = 0; v < one.vertices; ++v) is_flat = is_flat && one.mesh.colors[3 * v + 2] == one.mesh.colors[2];
        CHECK_FALSE(is_flat);
    }
}

TEST_CASE("who has seen enough cancels, and gets the mesh that was seen with its final colours") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(160, 140, 6);
    // After points, settle and collapse, in the midst of anneal, and after its last sweep.
    for (const int tile : {0, 64})
        for (const std::size_t most : {1U, 2U, 3U, 6U, 9U}) {
            Listener listener;
            listener.most = most;
            Options options{Target::vertices(1200)};
            options.progress = listener;
            const Result result = hmesh::mesh_image(image.view(), options, Annealed{Effort::normal, 1, tile});
            CHECK(result.status.code == Errc::cancelled);
            REQUIRE(listener.taken.size() == most);
            CHECK(result.mesh.positions == listener.taken.back().mesh.positions);
            CHECK(result.mesh.faces == listener.taken.back().mesh.faces);
            hmesh_test::prove_report(image, result);
        }
}

TEST_CASE("a mesh that was seen can be gone on from") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(120, 100, 6);
    Listener listener;
    listener.most = 2;
    Options options{Target::vertices(700)};
    options.progress = listener;
    CHECK_FALSE(hmesh::mesh_image(image.view(), options, Annealed{Effort::draft}).status);
    Annealed recipe{Effort::normal};
    recipe.start = &listener.taken.back().mesh;
    const Result result = hmesh::mesh_image(image.view(), {Target::vertices(700)}, recipe);
    hmesh_test::prove_result(image, result, 700);
    CHECK(result.report.energy < hmesh::mesh_image(image.view(), {Target::vertices(700)}, Annealed{Effort::fast}).report.energy);
}

TEST_CASE("levels of detail and searches for a PSNR let their meshes be seen") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(120, 100, 6);
    Listener listener;
    Options options{Target::vertices(400)};
    options.progress = listener;
    const hmesh::Lods lods = hmesh::mesh_lods(image.view(), options, {3}, Annealed{Effort::fast});
    REQUIRE(lods.status);
    std::size_t whole = 0;
    for (const Listener::Taken& one : listener.taken) {
        CHECK(hmesh_test::flaw_of(one.mesh.view(), 120, 100) == "");
        if (one.stage == "colors") CHECK(hmesh_test::same_bytes(one.mesh, lods.levels[whole++].mesh));
    }
    CHECK(whole == 3);
    check_meshes(image, Options{Target::psnr(24)}, Annealed{Effort::fast});
}
