#include "hmesh/methods/annealed/annealed.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "test_images.hpp"
#include "test_methods.hpp"
#include "test_sanitized.hpp"
#include "test_tiled_meshes.hpp"

using hmesh::Annealed;
using hmesh::Effort;
using hmesh::Errc;
using hmesh::Status;
using hmesh::kit::annealed_steps;
using hmesh::kit::AnnealedSteps;
using hmesh_test::names_of;
using hmesh_test::Work;

namespace {

// The recipe of an effort, or of steps of one's own.
Annealed recipe_of(Effort effort, int sweeps, int tile = 0) {
    Annealed recipe{effort, 1, tile, annealed_steps(effort)};
    recipe.steps->annealing.sweeps = std::min(recipe.steps->annealing.sweeps, sweeps);
    return recipe;
}
Annealed recipe_of(const AnnealedSteps& steps, int tile = 0) { return {Effort::normal, 1, tile, steps}; }

}  // namespace

TEST_CASE("every effort's recipe gives every number of vertices from 4 to one a pixel on images of 1 to 6 by 1 to 6 pixels") {
    for (const Effort effort : {Effort::draft, Effort::fast, Effort::normal, Effort::fine, Effort::best})
        for (int height = 1; height <= 6; ++height)
            for (int width = 1; width <= 6; ++width) {
                hmesh::MeshLimits limits;  // the strictest, where vertices get stuck
                if (effort != Effort::best) limits.min_double_area = limits.border_gap = 0.25;
                const auto seed = static_cast<std::uint64_t>(width + 9 * height);
                Work<std::uint8_t, 2> work(hmesh_test::noise<std::uint8_t, 2>(width, height, seed), limits);
                const auto most = static_cast<std::size_t>(std::max(4, width * height));
                const std::size_t step = hmesh_test::stride_if_sanitized(5);
                for (std::size_t n = 4; n <= most; n = n == most ? most + 1 : std::min(n + step, most)) {
                    CAPTURE(width);
                    CAPTURE(height);
                    CAPTURE(n);
                    CHECK(recipe_of(effort, 3).run(work.tiled, n));
                    CHECK(work.count() == n);
                    hmesh_test::prove(work);
                }
            }
}

TEST_CASE("any number of points, of rounds and any batch size give the exact number") {
    Work<std::uint8_t, 1> work(hmesh_test::scene<std::uint8_t, 1>(40, 32, 3));
    for (const double points : {1.0, 1.001, 3.0, 100.0})
        for (const int rounds : {0, 1, 3})
            for (const double batch : {0.02, 0.3, 1.0}) {
                AnnealedSteps steps;
                steps.points = points;
                steps.settle_rounds = rounds;
                steps.collapse_batch = batch;
                steps.annealing.sweeps = 0;
                steps.polish_rounds = 0;
                CHECK(recipe_of(steps).run(work.tiled, 60));
                CHECK(work.count() == 60);
                CHECK(check(work.indexed()));
            }
}

TEST_CASE("where slivers that may not get smaller leave too many vertices, it starts anew with no more points than wanted") {
    std::size_t restarts = 0;
    for (const double least : {0.25, 3.0, 4.0})  // of more than 0.25, which users may not ask for, faces get stuck
        for (const int width : {3, 4, 5, 8})
            for (const int height : {4, 6, 7, 9})
                for (const double points : {1.5, 3.0, 20.0}) {
                    hmesh::MeshLimits limits;
                    limits.min_double_area = least;
                    Work<std::uint8_t, 1> work(hmesh_test::noise<std::uint8_t, 1>(width, height, 1), limits);
                    AnnealedSteps steps = annealed_steps(Effort::draft);
                    steps.points = points;
                    const std::size_t most = least > 0.25 ? 5 : 8;
                    for (std::size_t n = 4; n <= most; ++n) {
                        CHECK(recipe_of(steps).run(work.tiled, n));
                        CHECK(work.count() == n);
                        hmesh_test::prove(work);
                    }
                    const std::string names = names_of(work.progress);
                    std::size_t runs = 0;
                    for (std::size_t at = names.find("points"); at != std::string::npos; at = names.find("points", at + 1))
                        ++runs;
                    if (least <= 0.25) CHECK(runs == most - 3);
                    restarts += runs - (most - 3);
                }
    CHECK(restarts > 10);
}

TEST_CASE("in tiles every effort gives the exact number, and a better mesh than the effort before") {
    const auto image = hmesh_test::scene<std::uint8_t, 1>(150, 130, 7);
    double before = 1e300;
    for (const Effort effort : {Effort::draft, Effort::fast, Effort::normal}) {
        Work<std::uint8_t, 1> work(image);
        CHECK(recipe_of(effort, 12, 64).run(work.tiled, 1400));
        CHECK(work.count() == 1400);
        hmesh_test::prove(work);
        CHECK(work.indexed().energy < before);
        before = work.indexed().energy;
    }
    for (const auto& [width, height, n] :
         {std::tuple{300, 1, 300U}, {1, 300, 300U}, {65, 200, 1100U}, {64, 64, 4096U}, {130, 64, 8320U}}) {
        Work<std::uint8_t, 3> work(hmesh_test::noise<std::uint8_t, 3>(width, height, 1));
        CAPTURE(work.image.width());
        CHECK(recipe_of(Effort::fast, 0, 64).run(work.tiled, n));
        CHECK(work.count() == n);
        hmesh_test::prove(work);
    }
    Work<std::uint8_t, 3> constant(hmesh_test::constant_image<std::uint8_t, 3>(150, 130, 0.3));
    for (const std::size_t n : {800U, 3000U}) {
        CHECK(recipe_of(Effort::normal, 1, 64).run(constant.tiled, n));
        CHECK(constant.count() == n);
        hmesh_test::prove(constant);
    }
}

TEST_CASE("in tiles any number of points gives the exact number, however few of them move before the collapse") {
    const auto image = hmesh_test::scene<std::uint8_t, 1>(150, 130, 7);
    for (const int rounds : {0, 2})
        for (const double points : {1.0, 4.0}) {
            AnnealedSteps steps = annealed_steps(Effort::draft);
            steps.settle_rounds = rounds;
            steps.points = points;
            Work<std::uint8_t, 1> work(image);
            CHECK(recipe_of(steps, 64).run(work.tiled, 1400));
            CHECK(work.count() == 1400);
            hmesh_test::prove(work);
        }
}

TEST_CASE("a flat part within a sharp line gives no vertex too many neighbors, straight or round, in one piece and in tiles") {
    const auto on_line = [](int kind, int x, int y) {
        const double r = std::hypot(x - 200.5, y - 150.5);
        return kind == 0 ? r < 100 : kind == 1 ? y < 150 : kind == 2 ? std::abs(x - 200) < 90 && std::abs(y - 150) < 90 : y == 0;
    };
    for (int kind = 0; kind < 4; ++kind)
        for (const int tile : {0, 128}) {
            const auto image =
                hmesh_test::draw<std::uint8_t, 1>(400, 300, [&](int x, int y, int) { return on_line(kind, x, y) ? 0.9 : 0.1; });
            for (const std::size_t n : {60U, 300U, 700U}) {
                if (hmesh_test::sanitized && n != 300) continue;
                CAPTURE(kind);
                CAPTURE(n);
                Work<std::uint8_t, 1> work(image);
                CHECK(recipe_of(Effort::fast, 1, tile).run(work.tiled, n));
                CHECK(work.count() == n);
                hmesh_test::prove(work);
            }
        }
}

TEST_CASE("an image of one row or column keeps its first points, however many, and a vertex for 5 px follows waves of 125 px") {
    const int length = hmesh_test::sanitized ? 10000 : 20000;
    for (const bool is_row : {true, false})
        for (const Effort effort : {Effort::draft, Effort::normal}) {
            CAPTURE(is_row);
            CAPTURE(effort);
            const auto wave = [](int x, int y, int) { return 0.5 + 0.45 * std::sin(0.05 * (x + y)); };
            Work<std::uint8_t, 1> work(hmesh_test::draw<std::uint8_t, 1>(is_row ? length : 1, is_row ? 1 : length, wave));
            const auto n = static_cast<std::size_t>(length / 5);
            CHECK(recipe_of(effort, 2).run(work.tiled, n));
            CHECK(work.count() == n);
            CHECK(work.progress.stages().front().vertices > n);
            CHECK(work.tiled.energy() / length < 0.2);  // rounding to 8 bits alone is 1 / 12
            hmesh_test::prove(work);
        }
}

TEST_CASE("tiles that nobody asked for hold 200 vertices, 400 with few sweeps and 640 with none, on 128 to 256 px") {
    const auto tile_size = [](Effort effort, int width, int height, std::size_t n) {
        return Annealed{effort}.tile_size(width, height, n);
    };
    for (const int side : {300, 1024, 2000}) {
        const double pixels = static_cast<double>(side) * side;
        const auto share = [&](double percent) { return static_cast<std::size_t>(pixels * percent / 100); };
        for (const Effort effort : {Effort::normal, Effort::fine, Effort::best})
            CHECK(tile_size(effort, side, side, share(1)) == doctest::Approx(std::sqrt(20000)).epsilon(1e-3));
        CHECK(tile_size(Effort::fast, side, side, share(1)) == doctest::Approx(200).epsilon(1e-3));
        CHECK(tile_size(Effort::normal, side, side, share(10)) == 128);
        CHECK(tile_size(Effort::draft, side, side, share(1)) == doctest::Approx(253).epsilon(1e-2));
        CHECK(tile_size(Effort::draft, side, side, share(10)) == 128);
        CHECK(tile_size(Effort::fast, side, side, share(0.5)) == 256);
    }
    CHECK(tile_size(Effort::normal, 3000, 3000, 500000) == 256);
}

TEST_CASE("tiles are as large as asked for, but hold 180 vertices on average, or 256 with few sweeps") {
    const auto tile_size = [](Effort effort, int width, int height, std::size_t n, int tile) {
        return Annealed{effort, 1, tile, {}}.tile_size(width, height, n);
    };
    CHECK(tile_size(Effort::normal, 4000, 3000, 1000000, 100) == 100);
    for (const std::size_t n : {4U, 100U, 1000U, 10000U, 100000U})
        for (const auto& [width, height] : {std::pair{4000, 3000}, {20000, 300}, {64, 60000}, {300, 300}}) {
            const double per_pixel = static_cast<double>(n) / (static_cast<double>(width) * height);
            for (const Effort effort : {Effort::draft, Effort::fast, Effort::normal, Effort::best}) {
                const double tile = tile_size(effort, width, height, n, 64), fewest = effort < Effort::normal ? 256 : 180;
                const double area = std::min<double>(tile, width) * std::min<double>(tile, height);
                CHECK(tile >= 64);
                CHECK((area * per_pixel > fewest - 0.1 || tile >= std::max(width, height)));
                if (tile > 64) CHECK(area * per_pixel < fewest * 1.5625);
            }
        }
}

TEST_CASE("pictures without error, where no vertex is better than another, take any number") {
    Work<std::uint8_t, 3> constant(hmesh_test::constant_image<std::uint8_t, 3>(32, 27, 0.3));
    Work<float, 1> affine(hmesh_test::affine_image<float, 1>(32, 27));
    for (const std::size_t n : {4U, 5U, 63U, 432U, 864U})
        for (const Effort effort : {Effort::draft, Effort::fast, Effort::normal}) {
            CHECK(recipe_of(effort, 3).run(constant.tiled, n));
            CHECK(recipe_of(effort, 3).run(affine.tiled, n));
            CHECK(constant.count() == n);
            CHECK(affine.count() == n);
            hmesh_test::prove(constant);
            hmesh_test::prove(affine);
        }
}

TEST_CASE("stages come in order, those whose options say none are left out, and each tells the mesh it left") {
    const double samples = 48.0 * 40 * 3;
    for (const auto& [effort, names] : {std::pair<Effort, const char*>{Effort::draft, "points settle collapse polish"},
                                        {Effort::fast, "points settle collapse anneal polish"},
                                        {Effort::normal, "points settle collapse anneal polish"},
                                        {Effort::best, "points settle collapse anneal polish"}}) {
        Work<std::uint8_t, 3> work(hmesh_test::scene<std::uint8_t, 3>(48, 40, 2));
        CHECK(recipe_of(effort, 12).run(work.tiled, 50));
        CHECK(names_of(work.progress) == names);
        for (const hmesh::StageReport& stage : work.progress.stages()) {
            CHECK(stage.psnr == doctest::Approx(10 * std::log10(255.0 * 255.0 * samples / stage.energy)));
            if (std::strcmp(stage.name, "collapse") == 0) CHECK(stage.vertices == 50);
            if (std::strcmp(stage.name, "settle") == 0) {
                CHECK(static_cast<double>(stage.vertices) <= std::ceil(50 * annealed_steps(effort).points));
                CHECK(static_cast<double>(stage.vertices) >= 50 * annealed_steps(effort).points - 4);
            }
        }
        CHECK(work.progress.stages().back().vertices == work.count());
        CHECK(work.progress.stages().back().energy == work.indexed().energy);
    }
}

TEST_CASE("every round of polish lowers the energy, and settling and annealing leave a better mesh") {
    for (std::uint64_t seed = 1; seed <= (hmesh_test::sanitized ? 1U : 3U); ++seed) {
        double before = 1e300;
        for (const int rounds : {0, 1, 3}) {
            Work<std::uint8_t, 3> work(hmesh_test::scene<std::uint8_t, 3>(64, 56, seed));
            AnnealedSteps steps = annealed_steps(Effort::normal);
            steps.polish_rounds = rounds;
            CHECK(recipe_of(steps).run(work.tiled, 140));
            const auto& stages = work.progress.stages();  // points settle collapse anneal polish
            REQUIRE(stages.size() == 5);
            CHECK(stages[1].energy < stages[0].energy);
            CHECK(stages[3].energy < stages[2].energy);
            CHECK(stages[4].energy < stages[2].energy);  // both of 140 vertices
            CHECK(stages[4].energy < before);
            before = stages[4].energy;
        }
    }
}

TEST_CASE("a mesh can be filled again, and forgets what it was") {
    const auto image = hmesh_test::scene<std::uint8_t, 1>(40, 30, 4);
    Work<std::uint8_t, 1> used(image), fresh(image);
    CHECK(recipe_of(Effort::fast, 0).run(used.tiled, 300));
    for (Work<std::uint8_t, 1>* work : {&used, &fresh}) CHECK(recipe_of(Effort::normal, 4).run(work->tiled, 60));
    CHECK(hmesh_test::same_bits(used.indexed(), fresh.indexed()));
}

TEST_CASE("told to stop, it leaves a valid mesh and says so") {
    int calls = 0;
    const auto stop_at_second = [&](const hmesh::ProgressInfo&) { return ++calls < 2; };
    Work<std::uint8_t, 1> work(hmesh_test::scene<std::uint8_t, 1>(40, 30, 4), {}, stop_at_second);
    const Status status = Annealed().run(work.tiled, 60);
    CHECK(status.code == Errc::cancelled);
    CHECK(calls == 2);
    hmesh_test::prove(work, false);
}

TEST_CASE("options that mean nothing are named, and the efforts' own all mean something") {
    for (const Effort effort : {Effort::draft, Effort::fast, Effort::normal, Effort::fine, Effort::best})
        CHECK(check(annealed_steps(effort)));
    const auto refused = [](auto&& spoil) {
        AnnealedSteps steps;
        spoil(steps);
        const Status status = check(steps);
        return status.code == Errc::invalid_argument && std::strlen(status.what) > 15 && status.value != status.limit;
    };
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
    for (const double bad : {-1.0, 1e300, infinity, -infinity, nan}) {
        CHECK(refused([bad](AnnealedSteps& o) { o.points = bad; }));
        CHECK(refused([bad](AnnealedSteps& o) { o.collapse_batch = bad; }));
        CHECK(refused([bad](AnnealedSteps& o) { o.settle_flip_gain = bad; }));
        CHECK(refused([bad](AnnealedSteps& o) { o.settle.min_gain = bad; }));
        CHECK(refused([bad](AnnealedSteps& o) { o.polish.propagate_above = bad; }));
        CHECK(refused([bad](AnnealedSteps& o) { o.relaxation.min_gain = bad; }));
        CHECK(refused([bad](AnnealedSteps& o) { o.annealing.temperature = bad; }));
        CHECK(refused([bad](AnnealedSteps& o) { o.annealing.cooling = bad; }));
        CHECK(refused([bad](AnnealedSteps& o) { o.annealing.try_probability = bad; }));
        CHECK(refused([bad](AnnealedSteps& o) { o.annealing.jump = bad; }));
        CHECK(refused([bad](AnnealedSteps& o) { o.annealing.jump_reach = bad; }));
        CHECK(refused([bad](AnnealedSteps& o) { o.annealing.start_price = bad; }));
        CHECK(refused([bad](AnnealedSteps& o) { o.annealing.count_tolerance = bad; }));
    }
    for (const int bad : {-1, std::numeric_limits<int>::max()}) {
        CHECK(refused([bad](AnnealedSteps& o) { o.settle_rounds = bad; }));
        CHECK(refused([bad](AnnealedSteps& o) { o.polish_rounds = bad; }));
        CHECK(refused([bad](AnnealedSteps& o) { o.relaxation.rounds = bad; }));
        CHECK(refused([bad](AnnealedSteps& o) { o.annealing.sweeps = bad; }));
        CHECK(refused([bad](AnnealedSteps& o) { o.annealing.nudges = bad; }));
    }
}

TEST_CASE("screens that are NaN, negative or infinite are refused or give a valid mesh of the exact number") {
    Work<std::uint8_t, 1> work(hmesh_test::scene<std::uint8_t, 1>(32, 28, 3));
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
    using Screen = double hmesh::kit::AnnealingOptions::*;
    for (const Screen screen : {&hmesh::kit::AnnealingOptions::flip_screen, &hmesh::kit::AnnealingOptions::insertion_screen,
                                &hmesh::kit::AnnealingOptions::removal_screen})
        for (const double bad : {nan, -infinity, -1.0, 0.0, 1e300, infinity}) {
            CAPTURE(bad);
            AnnealedSteps steps;
            steps.annealing.sweeps = 3;
            steps.annealing.*screen = bad;
            if (!check(steps)) continue;
            CHECK(recipe_of(steps).run(work.tiled, 50));
            CHECK(work.count() == 50);
            hmesh_test::prove(work);
        }
}

TEST_CASE("options at the ends of their ranges give a valid mesh of the exact number") {
    Work<std::uint8_t, 1> work(hmesh_test::scene<std::uint8_t, 1>(24, 20, 3));
    for (const bool high : {false, true})
        for (const std::size_t n : {4U, 30U, 480U}) {
            AnnealedSteps steps;
            const auto pick = [high](double a, double b) { return high ? b : a; };
            steps.points = pick(1, 100);
            steps.collapse_batch = pick(1e-2, 1);
            steps.settle_rounds = high ? 4 : 0;
            steps.polish_rounds = high ? 4 : 0;
            steps.settle_flip_gain = pick(0, 1e6);
            steps.settle = steps.polish = {pick(0, 1e6), pick(0, 1e6)};
            steps.relaxation.rounds = high ? 4 : 0;
            steps.annealing.sweeps = 3;
            steps.annealing.temperature = pick(0, 1e3);
            steps.annealing.cooling = pick(0, 100);
            steps.annealing.try_probability = pick(0, 1);
            steps.annealing.jump = pick(0, 1);
            steps.annealing.jump_reach = pick(0, 1);
            steps.annealing.nudges = high ? 1000 : 0;
            steps.annealing.start_price = pick(1e-6, 1e6);
            steps.annealing.count_tolerance = pick(0, 1);
            REQUIRE(check(steps));
            CHECK(recipe_of(steps).run(work.tiled, n));
            CHECK(work.count() == n);
            hmesh_test::prove(work);
        }
}
