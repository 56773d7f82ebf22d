// The same input gives the same bytes: in two runs, whatever the executor's order and number of threads.
#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include "hmesh/paper.hpp"
#include "test_executors.hpp"
#include "test_images.hpp"
#include "test_meshing.hpp"
#include "test_results.hpp"
#include "test_sanitized.hpp"

using hmesh::Annealed;
using hmesh::Effort;
using hmesh::Image;
using hmesh::mesh_image;
using hmesh::Options;
using hmesh::Result;
using hmesh::Target;

namespace {

template <class T, int C, class Recipe>
void check_repeatable(const Image<T, C>& image, const Options& options, const Recipe& recipe) {
    const Result first = mesh_image(image.view(), options, recipe);
    REQUIRE(first.mesh.vertex_count() >= 4);
    // Other memory under the pixels, and other contents in memory to come.
    const Image<T, C> copy = image;
    {
        const std::vector<double> dirt(100000, 12345.678);
        CHECK(dirt.back() > 0);
    }
    CHECK(hmesh_test::same_bytes(mesh_image(copy.view(), options, recipe), first));
    if (hmesh_test::sanitized) {
        CHECK(hmesh_test::same_bytes(mesh_image(image.view(), options, recipe, hmesh_test::ThreadFor{7}), first));
        return;
    }
    const hmesh_test::ReverseFor backwards;
    const hmesh_test::ShuffledFor anyhow{1}, otherwise{2};
    const hmesh_test::ThreadFor two{2}, seven{7};
    for (const hmesh::ParallelFor& executor : std::initializer_list<hmesh::ParallelFor>{backwards, anyhow, otherwise, two, seven})
        CHECK(hmesh_test::same_bytes(mesh_image(image.view(), options, recipe, executor), first));
}
template <class T, int C>
void check_repeatable(const Image<T, C>& image, Target target, Effort effort, int sweeps = 8) {
    Annealed recipe;
    recipe.steps = hmesh::kit::annealed_steps(effort);
    recipe.steps->annealing.sweeps = std::min(recipe.steps->annealing.sweeps, sweeps);
    check_repeatable(image, Options{target}, recipe);
}

}  // namespace

TEST_CASE("all efforts give the same bytes in two runs, in any order of the pieces and on any number of threads") {
    // Large enough for several pieces of rows, faces, edges and vertices.
    for (const Effort effort : {Effort::draft, Effort::fast, Effort::normal})
        check_repeatable(hmesh_test::scene<std::uint8_t, 3>(80, 70, 1), Target::vertices(420), effort);
    check_repeatable(hmesh_test::scene<std::uint8_t, 3>(48, 40, 1), Target::vertices(40), Effort::best, 50);
}

TEST_CASE("tiles give the same bytes in two runs, in any order and on any number of threads, with weights too") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(160, 140, 6);
    Image<float, 1> weights(160, 140);
    for (int y = 0; y < 140; ++y)
        for (int x = 0; x < 160; ++x) *weights.pixel(x, y) = x < 100 ? 1.0F : 0.1F * static_cast<float>(y % 3);
    Options options;
    options.target = Target::vertices(1400);
    Annealed recipe;
    recipe.tile = 64;
    recipe.steps.emplace();
    recipe.steps->points = 1.5;
    recipe.steps->annealing.sweeps = 2;
    check_repeatable(image, options, recipe);
    options.weights = weights.view();
    check_repeatable(image, options, recipe);
}

TEST_CASE("the methods of the paper give the same bytes in any order and on any number of threads too") {
    const auto weights = hmesh_test::random_weights(80, 70, 1);
    const auto check = [&](const auto& recipe, const auto& recipe_with_weights) {
        Options options{Target::vertices(300)};
        check_repeatable(hmesh_test::scene<std::uint8_t, 3>(80, 70, 1), options, recipe);
        options.weights = weights.view();
        check_repeatable(hmesh_test::scene<float, 1>(80, 70, 2), options, recipe_with_weights);
    };
    hmesh::Hierarchical own_face, one_ring;
    own_face.geometry.search = hmesh::kit::FootSearch::own_face;
    one_ring.geometry.search = hmesh::kit::FootSearch::one_ring;
    check(own_face, one_ring);
    check(hmesh::Xie(), hmesh::Xie());
    check(hmesh::Adams(), hmesh::Adams());
    check(hmesh::AdaptiveThinning(), hmesh::AdaptiveThinning());
}

TEST_CASE("float images, whose sums are rounded, give the same bytes too") {
    check_repeatable(hmesh_test::noise<float, 2>(70, 50, 2), Target::vertices(300), Effort::fast);
    check_repeatable(hmesh_test::scene<float, 1>(70, 50, 2), Target::vertices(150), Effort::normal);
}

TEST_CASE("ties are broken the same way everywhere: pictures without error, checkers, one vertex a pixel") {
    for (const Effort effort : {Effort::draft, Effort::fast, Effort::normal}) {
        check_repeatable(hmesh_test::constant_image<std::uint8_t, 3>(30, 25, 0.5), Target::vertices(150), effort);
        check_repeatable(hmesh_test::checkerboard<std::uint8_t, 1>(32, 32, 4), Target::vertices(100), effort);
        check_repeatable(hmesh_test::noise<std::uint16_t, 1>(16, 12, 1), Target::vertices(192), effort);
    }
}

TEST_CASE("a search for a PSNR gives the same bytes, reached or not") {
    check_repeatable(hmesh_test::scene<std::uint8_t, 3>(48, 40, 3), Target::psnr(29), Effort::fast);
    check_repeatable(hmesh_test::noise<std::uint8_t, 1>(14, 12, 3), Target::psnr(90), Effort::draft);
}

TEST_CASE("every index of a stage is handed out once") {
    bool once = true;
    const auto counting = [&](std::size_t n, hmesh::Piece piece) {
        std::set<std::size_t> seen;
        for (std::size_t i = n; i-- > 0;) {
            once = once && seen.insert(i).second;
            piece(i);
        }
    };
    const auto image = hmesh_test::scene<std::uint8_t, 3>(48, 40, 3);
    Options options;
    options.target = Target::vertices(100);
    CHECK(hmesh_test::same_bytes(mesh_image(image.view(), options, counting), mesh_image(image.view(), options)));
    CHECK(once);
}

TEST_CASE("another seed gives another mesh of like PSNR") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(96, 96, 5);
    Options options;
    options.target = Target::vertices(400);
    double least = 1e9, most = 0;
    std::vector<Result> results;
    for (const std::uint64_t seed : {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{2}, std::uint64_t{3}, ~std::uint64_t{0}}) {
        results.push_back(mesh_image(image.view(), options, Annealed{Effort::normal, seed}));
        hmesh_test::prove_result(image, results.back(), 400);
        for (std::size_t k = 0; k + 1 < results.size(); ++k)
            CHECK_FALSE(hmesh_test::same_bytes(results[k].mesh, results.back().mesh));
        least = std::min(least, results.back().report.psnr);
        most = std::max(most, results.back().report.psnr);
    }
    CHECK(most - least < 0.4);  // 0.1 dB for thousands of vertices; it shrinks with their square root
}

TEST_CASE("draft draws no random number: the seed changes nothing") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(48, 48, 5);
    const Options options{Target::vertices(100)};
    const Result first = mesh_image(image.view(), options, Annealed{Effort::draft});
    CHECK(hmesh_test::same_bytes(mesh_image(image.view(), options, Annealed{Effort::draft, 99}), first));
}
