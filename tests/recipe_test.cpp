#include "hmesh/methods/recipe.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "hmesh/core/status.hpp"
#include "hmesh/edit/move.hpp"
#include "hmesh/edit/subdivide.hpp"
#include "hmesh/image/premultiply.hpp"
#include "hmesh/mesh_image.hpp"
#include "hmesh/methods/stage.hpp"
#include "hmesh/tiles/indexed_mesh.hpp"
#include "test_images.hpp"
#include "test_results.hpp"

using hmesh::Colors;
using hmesh::Errc;
using hmesh::Image;
using hmesh::ImageView;
using hmesh::Options;
using hmesh::Result;
using hmesh::Status;
using hmesh::Target;
using hmesh::kit::is_recipe;
using hmesh::kit::TiledMesh;

namespace {

Options options_of(std::int64_t n) { return {Target::vertices(n)}; }

// A recipe as users write one: the largest faces are split, then so many sweeps over all vertices.
struct Grid {
    int sweeps = 1;

    static constexpr const char* name = "grid of one's own";
    static constexpr Colors colors = Colors::optimal;

    [[nodiscard]] Status check(int width, int height) const noexcept {
        if (width < 2 || height < 2)
            return {Errc::invalid_argument, "a grid of one's own needs 2 pixels", std::min(width, height), 2};
        return {};
    }
    [[nodiscard]] double tile_size(int width, int height, std::size_t) const noexcept { return std::max(width, height); }
    template <int C>
    [[nodiscard]] Status run(TiledMesh<C>& mesh, std::size_t n) const {
        mesh.indexed() = hmesh::kit::corner_mesh(mesh.source());
        return hmesh::kit::finished_or_cancelled(
            hmesh::kit::run_one_tile_stage<C>(mesh, "own", [&](hmesh::kit::ImageMesh<C>& piece) {
                subdivide(piece, n - piece.vertex_count());
                for (int k = 0; k < sweeps; ++k) sweep(piece);
            }));
    }
};

// One that wants the pixels, and notes what it was called with.
struct Curious {
    std::vector<float>* seen;
    std::vector<std::size_t>* asked;

    static constexpr const char* name = "curious";
    static constexpr Colors colors = Colors::sampled;

    [[nodiscard]] Status check(int, int) const noexcept { return {}; }
    [[nodiscard]] double tile_size(int, int, std::size_t n) const {
        asked->push_back(n);
        return 9;  // for the final colors
    }
    template <class T, int C>
    [[nodiscard]] Status run(TiledMesh<C>& mesh, const ImageView<T, C>& image, std::size_t n) const {
        seen->clear();
        for (int y = 0; y < image.height; ++y)
            for (int k = 0; k < image.width * C; ++k) seen->push_back(static_cast<float>(image.row(y)[k]));
        return Grid().run(mesh, n);
    }
};

// One that gives up, with a mesh or as it was found.
struct Quitter {
    bool has_begun = false;

    static constexpr const char* name = "quitter";
    static constexpr Colors colors = Colors::optimal;

    [[nodiscard]] Status check(int, int) const noexcept { return {}; }
    [[nodiscard]] double tile_size(int, int, std::size_t) const noexcept { return 1e9; }
    template <int C>
    [[nodiscard]] Status run(TiledMesh<C>& mesh, std::size_t n) const {
        if (has_begun) (void)Grid().run(mesh, n);
        return {Errc::invalid_argument, "the quitter gave up", 7, 8};
    }
};

}  // namespace

static_assert(is_recipe<hmesh::Annealed> && is_recipe<Grid> && is_recipe<Curious>);
static_assert(!is_recipe<int> && !is_recipe<Options> && !is_recipe<hmesh::ParallelFor> && !is_recipe<hmesh::kit::AnnealedSteps>);

TEST_CASE("a recipe of one's own meshes images of any kind, with all that is promised of meshes and reports") {
    for (const std::size_t n : {4U, 61U, 300U}) {
        const auto bytes = hmesh_test::scene<std::uint8_t, 3>(40, 30, 3);
        const Result result = hmesh::mesh_image(bytes.view(), options_of(static_cast<std::int64_t>(n)), Grid());
        hmesh_test::prove_result(bytes, result, n);
        REQUIRE(result.report.stages.size() == 2);
        CHECK(std::string(result.report.stages[0].name) == "own");
        CHECK(std::string(result.report.stages[1].name) == "colors");
        const auto floats = hmesh_test::scene<float, 1>(31, 20, 3);
        hmesh_test::prove_result(floats, hmesh::mesh_image(floats.view(), options_of(static_cast<std::int64_t>(n)), Grid()), n);
    }
}

TEST_CASE("its options are those that it was given, and its final colors those that it names unless others are asked for") {
    const auto image = hmesh_test::scene<std::uint8_t, 1>(40, 30, 3);
    const Result none = hmesh::mesh_image(image.view(), options_of(60), Grid{0});
    const Result many = hmesh::mesh_image(image.view(), options_of(60), Grid{10});
    CHECK(many.report.energy < 0.9 * none.report.energy);
    Options options = options_of(60);
    options.colors = Colors::optimal;
    CHECK(hmesh_test::same_bytes(hmesh::mesh_image(image.view(), options, Grid{10}), many));
    options.colors = Colors::sampled;
    CHECK(hmesh::mesh_image(image.view(), options, Grid{10}).report.energy > many.report.energy);
}

TEST_CASE("it finds the fewest vertices for a PSNR, and is asked for the tiles of each number") {
    const auto image = hmesh_test::scene<std::uint8_t, 1>(40, 30, 3);
    std::vector<float> seen;
    std::vector<std::size_t> asked;
    const Result result = hmesh::mesh_image(image.view(), Options{Target::psnr(25)}, Curious{&seen, &asked});
    hmesh_test::prove_result(image, result, result.report.vertices);
    CHECK(result.report.psnr >= 25);
    CHECK(asked.size() > 2);
    CHECK(std::count(asked.begin(), asked.end(), result.report.vertices) == 1);
}

TEST_CASE("a recipe that wants the pixels is given the image, multiplied by alpha where that is asked for") {
    const auto image = hmesh_test::scene<std::uint8_t, 4>(20, 16, 3);
    std::vector<float> seen;
    std::vector<std::size_t> asked;
    Options options = options_of(50);
    const Result straight = hmesh::mesh_image(image.view(), options, Curious{&seen, &asked});
    CHECK(seen == std::vector<float>(image.data(), image.data() + image.size()));
    CHECK(!straight.mesh.premultiplied);
    options.premultiplied = true;
    const Result premultiplied = hmesh::mesh_image(image.view(), options, Curious{&seen, &asked});
    const auto product = hmesh::kit::premultiply(image.view());
    CHECK(seen == std::vector<float>(product.data(), product.data() + product.size()));
    CHECK(premultiplied.mesh.premultiplied);
    CHECK(asked == std::vector<std::size_t>{50, 50});
}

TEST_CASE("what it refuses is refused before it runs, with its own sentence") {
    const Image<std::uint8_t, 1> row(20, 1);
    const Result result = hmesh::mesh_image(row.view(), options_of(4), Grid());
    CHECK(result.status.code == Errc::invalid_argument);
    CHECK(std::string(hmesh::message(result.status).c_str()) == "a grid of one's own needs 2 pixels (1, limit 2)");
    CHECK(!result.has_mesh());
    CHECK(result.report.stages.empty());
    // Options that all methods share come first.
    CHECK(hmesh::mesh_image(row.view(), options_of(21), Grid()).status.code == Errc::target_out_of_range);
}

TEST_CASE(
    "where it fails, its status comes with the mesh that there is and a report that is true of it, or none without a stage") {
    const auto image = hmesh_test::scene<std::uint8_t, 1>(40, 30, 3);
    for (const bool has_begun : {false, true}) {
        const Result result = hmesh::mesh_image(image.view(), options_of(60), Quitter{has_begun});
        CHECK(result.status.code == Errc::invalid_argument);
        CHECK(result.status.value == 7);
        CHECK(result.has_mesh() == has_begun);
        CHECK(result.report.vertices == (has_begun ? 60 : 0));
        CHECK(result.report.stages.empty() != has_begun);
        if (has_begun) hmesh_test::prove_report(image, result);
    }
}

TEST_CASE("it is cancelled as others are") {
    const auto image = hmesh_test::scene<std::uint8_t, 1>(40, 30, 3);
    for (int last = 0; last < 5; ++last) {
        int calls = 0;
        const auto stop = [&](const hmesh::ProgressInfo&) { return ++calls <= last; };
        Options options = options_of(60);
        options.progress = stop;
        const Result result = hmesh::mesh_image(image.view(), options, Grid());
        CHECK(calls == last + 1);
        CHECK(result.status.code == Errc::cancelled);
        hmesh_test::prove_report(image, result);
    }
}
