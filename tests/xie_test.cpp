#include "hmesh/methods/baselines/xie.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include "test_images.hpp"
#include "test_methods.hpp"
#include "test_tiled_meshes.hpp"

using hmesh::Xie;
using hmesh::kit::Point;
using hmesh_test::prove_mesh;
using hmesh_test::Work;

namespace {

// In the middle of a pixel, or on the border: what pixel_vertex gives and what steps of whole pixels lead to.
bool is_on_pixel(double x, int size) { return x == 0 || x == size || x - static_cast<int>(x) == 0.5; }

}  // namespace

TEST_CASE("xie gives every number of vertices, on pixels and with sampled colours, on pictures of ties, flat parts and lines") {
    for (const auto& [width, height] : {std::pair{26, 18}, {1, 60}, {60, 1}, {2, 40}, {40, 2}, {3, 3}})
        for (auto& picture : hmesh_test::hard_pictures<std::uint8_t, 1>(width, height)) {
            Work<std::uint8_t, 1> work(std::move(picture));
            const std::size_t pixels = work.image.size();
            for (const std::size_t n : {std::size_t{4}, std::size_t{7}, pixels / 8 + 4, pixels}) {
                CAPTURE(work.image.width());
                CAPTURE(n);
                CHECK(Xie().run(work.tiled, n));
                prove_mesh(work, n);
                CHECK(hmesh_test::is_sampled(work.image, work.indexed()));
                bool on_pixels = true;
                for (const Point p : work.indexed().positions)
                    on_pixels = on_pixels && is_on_pixel(p.x, width) && is_on_pixel(p.y, height);
                CHECK(on_pixels);
            }
        }
}

TEST_CASE("every stage of xie after the removal lowers the energy, and it ends with the first round that gains too little") {
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
        Work<std::uint8_t, 3> work(hmesh_test::scene<std::uint8_t, 3>(64, 48, seed));
        Xie recipe;
        recipe.enough = 0.02;
        recipe.rounds = 50;
        CHECK(recipe.run(work.tiled, 90));
        const auto& stages = work.progress.stages();
        REQUIRE(stages.size() >= 4);
        REQUIRE(stages.size() % 2 == 0);
        for (std::size_t k = 2; k < stages.size(); ++k) {
            CHECK(std::string(stages[k].name) == (k % 2 == 0 ? "search" : "flips"));
            CHECK(stages[k].vertices == 90);
            CHECK(stages[k].energy <= stages[k - 1].energy);
            if (k % 2 == 0) continue;
            const double before = stages[k - 2].energy, gain = before - stages[k].energy;
            CHECK((gain > 0.02 * before) == (k + 1 < stages.size()));
        }
        CHECK(work.indexed().energy < 0.9 * stages[1].energy);
    }
}

TEST_CASE("without rounds xie is adams, to the last bit") {
    const auto image = hmesh_test::scene<std::uint8_t, 1>(40, 30, 2);
    Work<std::uint8_t, 1> moved(image), left(image);
    Xie recipe;
    recipe.rounds = 0;
    CHECK(recipe.run(moved.tiled, 50));
    CHECK(recipe.start.run(left.tiled, 50));
    CHECK(hmesh_test::same_bits(moved.indexed(), left.indexed()));
}

TEST_CASE("options of xie at the ends of their ranges give a valid mesh of the exact number") {
    Work<std::uint8_t, 1> work(hmesh_test::scene<std::uint8_t, 1>(24, 20, 3));
    for (const int first_step : {1, 4096})
        for (const int visits : {1, 1000})
            for (const int flip_visits : {1, 1000000})
                for (const double enough : {0.0, 1.0})
                    for (const std::size_t n : {4U, 40U, 480U}) {
                        Xie recipe;
                        recipe.search = {first_step, visits};
                        recipe.flip_visits = flip_visits;
                        recipe.enough = enough;
                        recipe.rounds = 1000;  // each gains something
                        REQUIRE(recipe.check());
                        CHECK(recipe.run(work.tiled, n));
                        prove_mesh(work, n);
                    }
}

TEST_CASE("options of xie that mean nothing are named") {
    using hmesh_test::is_refused;
    for (const double bad : hmesh_test::bad_numbers) {
        CHECK(is_refused<Xie>("xie enough", [&](Xie& o) { o.enough = bad; }));
        CHECK(is_refused<Xie>("adams density", [&](Xie& o) { o.start.density = bad; }));
    }
    for (const int bad : hmesh_test::bad_integers) {
        CHECK(is_refused<Xie>("xie search.first_step", [&](Xie& o) { o.search.first_step = bad; }));
        CHECK(is_refused<Xie>("xie search.visits", [&](Xie& o) { o.search.visits = bad; }));
        CHECK(is_refused<Xie>("xie flip_visits", [&](Xie& o) { o.flip_visits = bad; }));
        CHECK(is_refused<Xie>("xie rounds", [&](Xie& o) { o.rounds = bad; }));
        CHECK(is_refused<Xie>("adams smoothing", [&](Xie& o) { o.start.smoothing = bad; }));
    }
    for (const auto spoil : {+[](Xie& o) { o.search.first_step = 0; }, +[](Xie& o) { o.search.first_step = 4097; }})
        CHECK(is_refused<Xie>("xie search.first_step", spoil));
    CHECK(is_refused<Xie>("xie search.visits", [](Xie& o) { o.search.visits = 0; }));
    CHECK(is_refused<Xie>("xie flip_visits", [](Xie& o) { o.flip_visits = 0; }));
    CHECK(is_refused<Xie>("xie enough", [](Xie& o) { o.enough = 1.0001; }));
}
