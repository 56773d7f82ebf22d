#include "hmesh/methods/baselines/adams.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

#include "hmesh/methods/baselines/adaptive_thinning.hpp"
#include "test_images.hpp"
#include "test_methods.hpp"
#include "test_tiled_meshes.hpp"

using hmesh::Adams;
using hmesh::AdaptiveThinning;
using hmesh::kit::Point;
using hmesh_test::prove_mesh;
using hmesh_test::Work;

TEST_CASE(
    "adams and adaptive thinning give every number of vertices on images of 1 to 6 by 1 to 6 pixels, Delaunay and sampled") {
    for (int height = 1; height <= 6; ++height)
        for (int width = 1; width <= 6; ++width) {
            const auto seed = static_cast<std::uint64_t>(width + 9 * height);
            Work<std::uint8_t, 1> work(hmesh_test::noise<std::uint8_t, 1>(width, height, seed));
            for (std::size_t n = 4; n <= static_cast<std::size_t>(std::max(4, width * height)); ++n)
                for (const double density : {0.0, 1.0, 4.5}) {
                    CAPTURE(width);
                    CAPTURE(height);
                    CAPTURE(n);
                    CHECK((density == 0 ? AdaptiveThinning().run(work.tiled, n) : Adams{density, 3}.run(work.tiled, n)));
                    prove_mesh(work, n);
                    CHECK(hmesh_test::is_delaunay(work.indexed()));
                    CHECK(hmesh_test::is_sampled(work.image, work.indexed()));
                }
        }
}

TEST_CASE("adams and adaptive thinning keep a Delaunay mesh with sampled colours on pictures of ties, flat parts and lines") {
    for (auto& picture : hmesh_test::hard_pictures<std::uint8_t, 1>(30, 22)) {
        Work<std::uint8_t, 1> work(std::move(picture));
        for (const std::size_t n : {4U, 5U, 60U, 330U, 660U})
            for (const bool thinning : {false, true}) {
                CAPTURE(n);
                CHECK((thinning ? AdaptiveThinning().run(work.tiled, n) : Adams().run(work.tiled, n)));
                prove_mesh(work, n);
                CHECK(hmesh_test::is_delaunay(work.indexed()));
                CHECK(hmesh_test::is_sampled(work.image, work.indexed()));
            }
    }
}

TEST_CASE("a vertex with more neighbors than a ring holds is left with fewer, and any number of vertices is reached") {
    // A lit row: its points see the few others across the dark, which nothing bends.
    for (const auto& [width, height] : {std::pair{400, 40}, {40, 400}}) {
        const bool wide = width > height;
        Work<std::uint8_t, 1> work(hmesh_test::draw<std::uint8_t, 1>(width, height, [wide](int x, int y, int) {
            return (wide ? y : x) == 3 || (x == (wide ? 200 : 36) && y == (wide ? 36 : 200)) ? 1.0 : 0.0;
        }));
        for (const std::size_t n : {4U, 20U, 400U}) {
            CHECK((Adams{1.5, 0}.run(work.tiled, n)));
            prove_mesh(work, n);
            CHECK(hmesh_test::is_delaunay(work.indexed()));
        }
        CHECK((Adams{1, 0}.run(work.tiled, 700)));
        CHECK(hmesh_test::most_neighbors(work.indexed()) > hmesh::kit::ring_capacity);
    }
}

TEST_CASE("vertices are on the centres of pixels, those of the outermost pixels on the border") {
    Work<std::uint8_t, 1> work(hmesh_test::noise<std::uint8_t, 1>(9, 7, 3));
    CHECK(AdaptiveThinning().run(work.tiled, 63));
    std::vector<std::pair<double, double>> found, expected;
    for (const Point p : work.indexed().positions) found.emplace_back(p.x, p.y);
    for (const double y : {0.0, 1.5, 2.5, 3.5, 4.5, 5.5, 7.0})
        for (const double x : {0.0, 1.5, 2.5, 3.5, 4.5, 5.5, 6.5, 7.5, 9.0}) expected.emplace_back(x, y);
    std::sort(found.begin(), found.end());
    std::sort(expected.begin(), expected.end());
    CHECK(found == expected);
    // One row or column: its vertices lie in the middle, with nothing on the long sides but corners.
    Work<std::uint8_t, 1> column(hmesh_test::noise<std::uint8_t, 1>(1, 20, 3));
    CHECK(AdaptiveThinning().run(column.tiled, 20));
    for (const Point p : column.indexed().positions) CHECK((p.x == 0.5 || ((p.x == 0 || p.x == 1) && (p.y == 0 || p.y == 20))));
}

TEST_CASE("more points before the removal give a better mesh, all pixels the best") {
    double before = 1e300;
    for (const double density : {1.0, 2.0, 4.5, 0.0}) {
        double energy = 0;
        for (const std::uint64_t seed : {1U, 2U, 3U}) {
            Work<std::uint8_t, 1> work(hmesh_test::scene<std::uint8_t, 1>(48, 40, seed));
            CHECK((density == 0 ? AdaptiveThinning().run(work.tiled, 60) : Adams{density, 3}.run(work.tiled, 60)));
            energy += work.indexed().energy;
        }
        CHECK(energy < before);
        before = energy;
    }
}

TEST_CASE("as many points as pixels are adaptive thinning, to the last bit") {
    const auto image = hmesh_test::scene<std::uint8_t, 1>(24, 20, 2);
    Work<std::uint8_t, 1> dense(image), all(image);
    CHECK((Adams{1000, 3}.run(dense.tiled, 40)));
    CHECK(AdaptiveThinning().run(all.tiled, 40));
    CHECK(hmesh_test::same_bits(dense.indexed(), all.indexed()));
}

TEST_CASE("float pictures of any size and sign have their vertices too") {
    for (const double factor : {3.4e38, 1.0, 1e-30}) {
        auto image = hmesh_test::noise<float, 1>(14, 11, 4);
        hmesh_test::for_each_sample(
            image, [&](float& sample) { sample = static_cast<float>(factor * (2 * static_cast<double>(sample) - 1)); });
        Work<float, 1> work(std::move(image));
        for (const std::size_t n : {4U, 30U, 154U}) {
            CHECK(Adams().run(work.tiled, n));
            prove_mesh(work, n);
            CHECK(AdaptiveThinning().run(work.tiled, n));
            prove_mesh(work, n);
        }
    }
}

TEST_CASE("stages come in order and tell the mesh they left: some points more than asked for, then those asked for") {
    Work<std::uint8_t, 1> work(hmesh_test::scene<std::uint8_t, 1>(48, 40, 2));
    CHECK((Adams{4, 3}.run(work.tiled, 50)));
    CHECK(hmesh_test::names_of(work.progress) == "points removal");
    const auto& stages = work.progress.stages();
    CHECK(stages[0].vertices >= 200);
    CHECK(stages[0].vertices <= 200 + 2 + 4);  // 1 % more, and corners that are no points
    CHECK(stages[0].energy < stages[1].energy);
    CHECK(stages[1].vertices == 50);
    CHECK(stages[1].energy == work.indexed().energy);
    for (const hmesh::StageReport& stage : stages) CHECK(stage.iterations == 0);
}

TEST_CASE("a mesh can be filled again, and forgets what it was") {
    const auto image = hmesh_test::scene<std::uint8_t, 1>(40, 30, 4);
    Work<std::uint8_t, 1> used(image), fresh(image);
    CHECK((Adams{2, 0}.run(used.tiled, 300)));
    for (Work<std::uint8_t, 1>* work : {&used, &fresh}) CHECK(Adams().run(work->tiled, 60));
    CHECK(hmesh_test::same_bits(used.indexed(), fresh.indexed()));
}

TEST_CASE("options of adams that mean nothing are named") {
    using hmesh_test::is_refused;
    const auto density = [](double bad) { return is_refused<Adams>("adams density", [bad](Adams& o) { o.density = bad; }); };
    for (const double bad : hmesh_test::bad_numbers) CHECK(density(bad));
    for (const double bad : {0.0, 0.999, 1000.5}) CHECK(density(bad));
    for (const int bad : hmesh_test::bad_integers)
        CHECK(is_refused<Adams>("adams smoothing", [bad](Adams& o) { o.smoothing = bad; }));
    CHECK(is_refused<Adams>("adams smoothing", [](Adams& o) { o.smoothing = 101; }));
    CHECK(Adams{1, 0}.check());
    CHECK(Adams{1000, 100}.check());
}
