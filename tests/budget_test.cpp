#include "hmesh/methods/annealed/budget.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "even_mesh.hpp"
#include "hmesh/core/random.hpp"
#include "test_executors.hpp"
#include "test_images.hpp"
#include "test_sanitized.hpp"
#include "test_tiled_meshes.hpp"

namespace kit = hmesh::kit;
using hmesh::kit::apportion;
using hmesh::kit::reach_vertex_count;
using hmesh::kit::Tiling;
using hmesh::kit::detail::Removals;
using hmesh_test::Work;

namespace {

using Counts = std::vector<std::size_t>;

std::size_t sum_of(const Counts& counts) {
    std::size_t sum = 0;
    for (const std::size_t k : counts) sum += k;
    return sum;
}

// What apportion() promises: the right sum, no cap exceeded, and nobody below its cap gets less for its weight than another,
// rounding left aside.
void check_shares(std::size_t count, const std::vector<double>& weights, const Counts& caps) {
    const Counts got = apportion(count, weights, caps);
    REQUIRE(got.size() == weights.size());
    CHECK(sum_of(got) == std::min(count, sum_of(caps)));
    for (std::size_t i = 0; i < got.size(); ++i) {
        REQUIRE(got[i] <= caps[i]);
        if (got[i] == caps[i]) continue;
        for (std::size_t j = 0; j < got.size(); ++j) {
            const double own = static_cast<double>(got[i]) + 1, other = static_cast<double>(got[j]) - 1;
            CHECK(other * weights[i] <= own * weights[j] * (1 + 1e-9) + (weights[i] == 0 ? 1e300 : 0));
        }
    }
}

// A mesh of about `count` vertices, its energy known.
template <class T, int C>
void start(Work<T, C>& work, std::size_t count) {
    work.tiled.indexed() = hmesh_test::even_mesh(work.source, count);
    const Tiling one(work.image.width(), work.image.height(), 1e9);
    REQUIRE(work.tiled.for_each(one, [](kit::Patch<C>& patch, std::size_t) { kit::sweep(patch.mesh()); }));
    hmesh_test::prove(work);
}

// From about `from` vertices to exactly `to`, in tiles; returns by what factor the energy changed.
template <class T, int C>
double change(const hmesh::Image<T, C>& image, std::size_t from, std::size_t to, double tile,
              const hmesh::MeshLimits& limits = {}) {
    CAPTURE(from);
    CAPTURE(to);
    CAPTURE(tile);
    Work<T, C> work(image, limits);
    start(work, from);
    const double before = work.indexed().energy;
    CHECK(reach_vertex_count(work.tiled, to, tile, {}));
    CHECK(work.count() == to);
    hmesh_test::prove(work);
    double least = 1e300;
    for (const hmesh::Triangle& t : work.indexed().faces)
        least = std::min(
            least, kit::orient2d(work.indexed().positions[t[0]], work.indexed().positions[t[1]], work.indexed().positions[t[2]]));
    CHECK(least >= limits.min_double_area);
    return work.indexed().energy / before;
}

constexpr double one_tile = 1e9;

}  // namespace

TEST_CASE("shares add up, are in proportion to the weights to within one, and exceed no cap") {
    constexpr std::size_t none = 1000000;
    CHECK(apportion(10, {1, 1}, {none, none}) == Counts{5, 5});
    CHECK(apportion(10, {3, 1, 1}, {none, none, none}) == Counts{6, 2, 2});
    CHECK(apportion(10, {3, 1, 1}, {4, none, none}) == Counts{4, 3, 3});
    CHECK(apportion(10, {0, 0}, {none, none}) == Counts{5, 5});
    CHECK(apportion(0, {1, 2}, {none, none}) == Counts{0, 0});
    CHECK(apportion(7, {2}, {none}) == Counts{7});
    CHECK(apportion(7, {2}, {3}) == Counts{3});
    CHECK(apportion(7, {}, {}).empty());
    kit::Random random(1);
    for (int round = 0; round < 2000; ++round) {
        const std::size_t size = 1 + random.below(12), count = random.below(round % 2 == 0 ? 30 : 3000);
        std::vector<double> weights;
        Counts caps;
        for (std::size_t k = 0; k < size; ++k) {
            weights.push_back(random.below(6) == 0 ? 0 : std::pow(10, 8 * random.uniform() - 4));
            caps.push_back(random.below(3) == 0 ? random.below(1 + count / 2) : none);
        }
        check_shares(count, weights, caps);
    }
}

TEST_CASE("in all without caps a share is off by one at most") {
    kit::Random random(2);
    for (int round = 0; round < 300; ++round) {
        const std::size_t size = 1 + random.below(200), count = random.below(100000);
        std::vector<double> weights;
        double total = 0;
        for (std::size_t k = 0; k < size; ++k) total += weights.emplace_back(random.uniform());
        const Counts got = apportion(count, weights, Counts(size, count));
        CHECK(sum_of(got) == count);
        for (std::size_t k = 0; k < size; ++k)
            CHECK(std::abs(static_cast<double>(got[k]) - static_cast<double>(count) * weights[k] / total) <= 1 + 1e-6);
    }
}

TEST_CASE("what capped shares leave goes to those without weight, if there are no others") {
    CHECK(apportion(10, {1, 0}, {3, 100}) == Counts{3, 7});
    CHECK(apportion(10, {1, 0, 0}, {4, 100, 100}) == Counts{4, 3, 3});
    CHECK(apportion(10, {1, 0, 0}, {4, 1, 100}) == Counts{4, 1, 5});
    CHECK(apportion(10, {1, 0, 0}, {4, 1, 2}) == Counts{4, 1, 2});
}

TEST_CASE("a mesh comes to exactly n vertices, from above and from below, in one and in several tiles") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(120, 100, 3);
    for (const double tile : {one_tile, 60.0, 40.0}) {
        for (const std::size_t to : {640U, 900U, 1500U}) CHECK(change(image, 600, to, tile) < 1);
        for (const std::size_t to : {561U, 400U, 250U}) change(image, 600, to, tile);
        CHECK(change(image, 600, 594, tile) < 1.05);
    }
    const auto noise = hmesh_test::noise<float, 1>(90, 70, 1);
    for (const double tile : {one_tile, 40.0}) {
        change(noise, 500, 300, tile);
        CHECK(change(noise, 500, 1200, tile) < 1);
    }
}

TEST_CASE("a mesh of a picture without error takes any number, up to one vertex a pixel, too") {
    const auto constant = hmesh_test::constant_image<std::uint8_t, 1>(100, 80, 0.4);
    const auto affine = hmesh_test::affine_image<float, 2>(60, 50);
    hmesh::MeshLimits strict;
    strict.min_double_area = strict.border_gap = 0.25;
    for (const double tile : {one_tile, 50.0}) {
        for (const std::size_t to : {200U, 301U, 1000U}) change(constant, 300, to, tile);
        change(constant, 300, 8000, tile);
        change(constant, 300, 8000, tile, strict);
        for (const std::size_t to : {150U, 600U}) change(affine, 300, to, tile);
    }
}

TEST_CASE("a mesh that has n vertices already is left alone, to the last bit") {
    Work<std::uint8_t, 3> work(hmesh_test::scene<std::uint8_t, 3>(60, 50, 3));
    start(work, 200);
    const auto before = work.indexed();
    CHECK(reach_vertex_count(work.tiled, before.vertex_count(), 25, {}));
    CHECK(hmesh_test::same_bits(work.indexed(), before));
}

TEST_CASE("in tiles the cheapest vertices of all go, and new ones come where the error is") {
    // Detail in the right half only: removals happen on the left, insertions on the right.
    kit::Random random(3);
    const auto image =
        hmesh_test::draw<std::uint8_t, 1>(120, 100, [&](int x, int, int) { return x < 60 ? 0.5 : random.uniform(); });
    const auto left_of = [](const kit::IndexedMesh<1>& whole) {
        return std::count_if(whole.positions.begin(), whole.positions.end(), [](kit::Point p) { return p.x < 50; });
    };
    for (const double tile : {one_tile, 40.0}) {
        Work<std::uint8_t, 1> work(image);
        start(work, 600);
        work.tiled.for_each(Tiling(120, 100, one_tile), [](kit::Patch<1>& patch, std::size_t) {
            for (int k = 0; k < 5; ++k) kit::sweep(patch.mesh()), kit::flip_edges(patch.mesh());
        });
        const std::size_t count = work.count();
        const auto left = left_of(work.indexed());
        CHECK(reach_vertex_count(work.tiled, count - 60, tile, {}));
        CHECK(left - left_of(work.indexed()) > 35);  // of 60; 25 if the half did not matter, and compilers differ by some
        const auto now = left_of(work.indexed());
        CHECK(reach_vertex_count(work.tiled, count + 60, tile, {}));
        CHECK(left_of(work.indexed()) - now < 12);
    }
}

TEST_CASE("the way to n is the same whatever the executor's order") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(120, 100, 3);
    for (const std::size_t to : {450U, 800U}) {
        Work<std::uint8_t, 3> serial(image);
        const hmesh_test::ReverseFor backwards;
        const hmesh_test::ShuffledFor anyhow{7};
        Work<std::uint8_t, 3> reversed(image, {}, {}, backwards), shuffled(image, {}, {}, anyhow);
        start(serial, 600), start(reversed, 600), start(shuffled, 600);
        CHECK(reach_vertex_count(serial.tiled, to, 40, {}));
        CHECK(reach_vertex_count(reversed.tiled, to, 40, {}));
        CHECK(reach_vertex_count(shuffled.tiled, to, 40, {}));
        CHECK(hmesh_test::same_bits(serial.indexed(), reversed.indexed()));
        CHECK(hmesh_test::same_bits(serial.indexed(), shuffled.indexed()));
    }
}

TEST_CASE("a round on the way to n takes and gives as many vertices as it is told to, or fewer") {
    for (const double tile : {one_tile, 40.0}) {
        Work<std::uint8_t, 1> work(hmesh_test::scene<std::uint8_t, 1>(120, 100, 3));
        start(work, 800);
        const Tiling tiling(120, 100, tile);
        std::size_t before = work.count();
        const std::size_t removed = kit::detail::remove_cheapest(work.tiled, tiling, 150, {});
        CHECK(removed <= 150);
        CHECK(removed > 100);
        CHECK(work.count() == before - removed);
        before = work.count();
        CHECK(kit::detail::insert_best(work.tiled, tiling, 300));
        CHECK(work.count() <= before + 300);
        CHECK(work.count() > before + 200);
    }
}

TEST_CASE("where some patches of a large image speak for all, about as many vertices go, and hardly dearer ones") {
    const auto image = hmesh_test::scene<std::uint8_t, 1>(16384, 260, 3);
    const Tiling tiling(16384, 260, 256);
    double most_energy = 0;
    for (const bool is_exact : {true, false}) {
        if (is_exact && hmesh_test::sanitized) continue;
        Work<std::uint8_t, 1> work(image);
        REQUIRE(work.tiled.sample_step(tiling) == 4);
        start(work, 4000);
        const std::size_t before = work.count();
        if (is_exact) CHECK(kit::detail::remove_cheapest(work.tiled, tiling, 400, {}) > 390);
        else (void)kit::detail::remove_cheapest(work.tiled, tiling, 400, {}, Removals::about);
        const auto removed = static_cast<double>(before - work.count());
        CHECK(removed == doctest::Approx(400).epsilon(0.15));
        if (is_exact) most_energy = 1.02 * work.indexed().energy;
        if (!hmesh_test::sanitized) CHECK(work.indexed().energy < most_energy);
        hmesh_test::prove(work);
        if (is_exact) continue;
        const std::size_t left = work.count();
        // More than can go at once: all that can.
        (void)kit::detail::remove_cheapest(work.tiled, tiling, left, {}, Removals::about);
        CHECK(static_cast<double>(left - work.count()) > 0.2 * static_cast<double>(left));
        hmesh_test::prove(work);
    }
    // A small one has patches that stay: exactly as many.
    Work<std::uint8_t, 1> small(hmesh_test::scene<std::uint8_t, 1>(120, 100, 3));
    start(small, 800);
    const std::size_t before = small.count();
    REQUIRE(small.tiled.sample_step(Tiling(120, 100, 5)) == 1);
    (void)kit::detail::remove_cheapest(small.tiled, Tiling(120, 100, 40), 50, {}, Removals::about);
    CHECK(small.count() == before - 50);
}

TEST_CASE(
    "of a large image a few vertices go from some patches, just as many as are to go; where those have none others give them") {
    const auto image = hmesh_test::scene<std::uint8_t, 1>(16384, 260, 3);
    {
        Work<std::uint8_t, 1> work(image);
        const Tiling tiling(16384, 260, 256);
        start(work, 4000);
        const std::vector<kit::Point> before = work.indexed().positions;
        const std::size_t few = before.size() / 256;
        REQUIRE(kit::detail::do_some_suffice(work.tiled, tiling, few));
        CHECK_FALSE(kit::detail::do_some_suffice(work.tiled, tiling, few + 1));
        CHECK(kit::detail::remove_cheapest(work.tiled, tiling, few, {}, Removals::from_some) == few);
        CHECK(work.count() == before.size() - few);
        hmesh_test::prove(work);
        // One tile in four is worked on: of the one in the middle of the others each vertex stays.
        const std::vector<kit::Point>& after = work.indexed().positions;
        for (const kit::Point p : before)
            if (static_cast<int>(p.x) / 256 % 4 == 2) REQUIRE(std::count(after.begin(), after.end(), p) == 1);
    }
    // All between 300 and 470 px, in the second tile.
    Work<std::uint8_t, 1> work(image);
    hmesh::Image<float, 1> density(16384, 260);
    for (int y = 0; y < 260; ++y)
        for (int x = 300; x < 470; ++x) *density.pixel(x, y) = 1;
    kit::Delaunay delaunay(16384, 260);
    REQUIRE(kit::insert_pixels(delaunay, kit::first_points(kit::point_ranks(density), 600), [] { return true; }));
    work.tiled.indexed() = kit::delaunay_mesh(work.source, delaunay);
    work.tiled.measure(Tiling(16384, 260, 256));
    const std::size_t before = work.count();
    REQUIRE(kit::detail::do_some_suffice(work.tiled, Tiling(16384, 260, 256), 2));
    CHECK(kit::detail::remove_cheapest(work.tiled, Tiling(16384, 260, 256), 2, {}, Removals::from_some) == 0);
    CHECK(reach_vertex_count(work.tiled, before - 2, 256, {}));
    CHECK(work.count() == before - 2);
    hmesh_test::prove(work);
}

TEST_CASE("where no tile can take a vertex, an edge between two tiles is split") {
    // A square in a narrow frame, in tiles much smaller than its two faces: only their common edge is far from the least area.
    hmesh::MeshLimits limits;
    limits.min_double_area = 60;
    Work<std::uint8_t, 1> work(hmesh_test::constant_image<std::uint8_t, 1>(16, 16, 0.5), limits);
    kit::IndexedMesh<1> mesh;
    mesh.width = mesh.height = 16;
    const std::vector<kit::Point> corners = {{0, 0}, {16, 0}, {16, 16}, {0, 16}, {2, 2}, {14, 2}, {14, 14}, {2, 14}};
    for (const kit::Point p : corners) mesh.add(p, work.source.pixel(8, 8));
    mesh.faces = {{0, 1, 5}, {0, 5, 4}, {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}, {4, 5, 6}, {4, 6, 7}};
    work.tiled.indexed() = mesh;
    CHECK(reach_vertex_count(work.tiled, 9, 4, {}));
    REQUIRE(work.count() == 9);
    const std::vector<kit::Point>& after = work.indexed().positions;
    CHECK(std::count(after.begin(), after.end(), kit::Point{8, 8}) == 1);
    CHECK_FALSE(reach_vertex_count(work.tiled, 12, 4, {}));  // all that is left is too small
    hmesh_test::prove(work);
}

TEST_CASE("told to stop on the way to n it says no and leaves a mesh") {
    for (const std::size_t to : {300U, 1500U})
        for (const double tile : {one_tile, 40.0})
            for (const int calls : {0, 1, 5, 9}) {
                bool is_armed = false;
                int left = calls;
                const auto callback = [&](const hmesh::ProgressInfo&) { return !is_armed || left-- > 0; };
                Work<std::uint8_t, 1> work(hmesh_test::scene<std::uint8_t, 1>(120, 100, 3), {}, callback);
                start(work, 600);
                is_armed = true;
                const bool met = reach_vertex_count(work.tiled, to, tile, {});
                CHECK(met == (work.count() == to));
                if (calls < 2) CHECK_FALSE(met);
                hmesh_test::prove(work, met);
            }
}
