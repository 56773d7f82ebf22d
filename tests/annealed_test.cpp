#include "hmesh/methods/annealed.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "test_images.hpp"
#include "test_meshes.hpp"

using hmesh::annealed;
using hmesh::AnnealedOptions;
using hmesh::Effort;
using hmesh::Errc;
using hmesh::Monitor;
using hmesh::Point;
using hmesh::Progress;
using hmesh::Status;
using hmesh_test::Subject;

namespace {

Monitor silent() { return Monitor({}, 1, 255); }

AnnealedOptions options_of(Effort effort, int sweeps) {
    AnnealedOptions options = hmesh::annealed_options(effort);
    options.annealing.sweeps = std::min(options.annealing.sweeps, sweeps);
    return options;
}

std::string names_of(const Monitor& monitor) {
    std::string names;
    for (const hmesh::StageReport& stage : monitor.stages())
        names += std::string(names.empty() ? "" : " ") + stage.name;
    return names;
}

}  // namespace

TEST_CASE("the first grid tiles the rectangle, has no more vertices than asked for, and not far fewer") {
    const std::pair<int, int> sizes[] = {{1, 1},   {1, 7},   {9, 1},   {2, 2},   {5, 4},
                                         {60, 40}, {3, 500}, {700, 2}, {333, 77}};
    for (const std::pair<int, int>& size : sizes)
        for (const double count : {4.0, 4.9, 5.0, 6.0, 9.0, 25.5, 100.0, 1234.0, 40000.0}) {
            const int width = size.first, height = size.second;
            CAPTURE(width);
            CAPTURE(height);
            CAPTURE(count);
            const hmesh::detail::Grid grid = hmesh::detail::regular_grid(width, height, count);
            CHECK(static_cast<double>(grid.positions.size()) <= count);
            CHECK(grid.positions.size() >= 4);
            const double possible = std::min(count, (width + 1.0) * (height + 1.0));
            CHECK(static_cast<double>(grid.positions.size()) >= 0.3 * possible);
            double twice_area = 0, least = 1e300;
            for (const hmesh::Triangle& t : grid.triangles) {
                const double twice = hmesh::cross(grid.positions[t[0]], grid.positions[t[1]], grid.positions[t[2]]);
                twice_area += twice;
                least = std::min(least, twice);
            }
            CHECK(twice_area == 2.0 * width * height);
            CHECK(least > 0.9);  // cells of at least a pixel
            for (const Point p : {Point{0, 0}, Point{static_cast<double>(width), static_cast<double>(height)}})
                CHECK(std::count(grid.positions.begin(), grid.positions.end(), p) == 1);
        }
}

TEST_CASE("the first grid's cells are nearly square") {
    const auto grid = hmesh::detail::regular_grid(400, 100, 500);
    std::size_t columns = 0;
    for (const Point p : grid.positions) columns += p.y == 0 ? 1 : 0;
    const double cell_width = 400.0 / static_cast<double>(columns - 1);
    const double cell_height = 100.0 / (static_cast<double>(grid.positions.size() / columns) - 1);
    CHECK(cell_width / cell_height > 0.75);
    CHECK(cell_width / cell_height < 1.33);
}

TEST_CASE(
    "every effort's recipe gives every number of vertices from 4 to one a pixel on images of 1 to 6 by 1 to 6 pixels") {
    for (const Effort effort : {Effort::draft, Effort::fast, Effort::normal, Effort::best})
        for (int height = 1; height <= 6; ++height)
            for (int width = 1; width <= 6; ++width) {
                hmesh::MeshLimits limits;  // the strictest, where vertices get stuck
                if (effort != Effort::best) limits.min_cross = limits.border_gap = 0.25;
                const auto seed = static_cast<std::uint64_t>(width + 9 * height);
                Subject<std::uint8_t, 2> subject(hmesh_test::noise<std::uint8_t, 2>(width, height, seed), limits);
                const auto most = static_cast<std::size_t>(std::max(4, width * height));
                for (std::size_t n = 4; n <= most; ++n) {
                    CAPTURE(width);
                    CAPTURE(height);
                    CAPTURE(n);
                    Monitor monitor = silent();
                    CHECK(annealed(subject.mesh, n, options_of(effort, 3), monitor));
                    CHECK(subject.mesh.vertex_count() == n);
                    hmesh_test::prove(subject);
                }
            }
}

TEST_CASE("any overshoot, share of the first grid and batch size give the exact number") {
    Subject<std::uint8_t, 1> subject(hmesh_test::scene<std::uint8_t, 1>(40, 32, 3));
    for (const double overshoot : {1.0, 1.001, 3.0, 100.0})
        for (const double start : {0.0, 0.3, 1.0})
            for (const double growth : {0.01, 0.3, 10.0})
                for (const double shrinkage : {0.02, 1.0}) {
                    AnnealedOptions options;
                    options.overshoot = overshoot;
                    options.start = start;
                    options.growth = growth;
                    options.shrinkage = shrinkage;
                    options.annealing.sweeps = 0;
                    options.growth_sweeps = 1;
                    options.polish_rounds = 0;
                    Monitor monitor = silent();
                    CHECK(annealed(subject.mesh, 60, options, monitor));
                    CHECK(subject.mesh.vertex_count() == 60);
                    CHECK(subject.mesh.check());
                }
}

TEST_CASE("pictures without error, where no vertex is better than another, take any number") {
    Subject<std::uint8_t, 3> constant(hmesh_test::constant_image<std::uint8_t, 3>(32, 27, 0.3));
    Subject<float, 1> affine(hmesh_test::affine_image<float, 1>(32, 27));
    for (const std::size_t n : {4U, 5U, 63U, 432U, 864U})
        for (const Effort effort : {Effort::draft, Effort::fast, Effort::normal}) {
            Monitor monitor = silent();
            CHECK(annealed(constant.mesh, n, options_of(effort, 3), monitor));
            CHECK(annealed(affine.mesh, n, options_of(effort, 3), monitor));
            CHECK(constant.mesh.vertex_count() == n);
            CHECK(affine.mesh.vertex_count() == n);
            hmesh_test::prove(constant);
            hmesh_test::prove(affine);
        }
}

TEST_CASE("stages come in order, those whose options say none are left out, and each tells the mesh it left") {
    Subject<std::uint8_t, 3> subject(hmesh_test::scene<std::uint8_t, 3>(48, 40, 2));
    const double samples = 48.0 * 40 * 3;
    for (const auto& [effort, names] : {std::pair<Effort, const char*>{Effort::draft, "grid insert polish"},
                                        {Effort::fast, "grid insert collapse polish"},
                                        {Effort::normal, "grid insert collapse anneal polish"},
                                        {Effort::best, "grid insert collapse anneal polish"}}) {
        Monitor monitor({}, samples, 255);
        CHECK(annealed(subject.mesh, 50, options_of(effort, 12), monitor));
        CHECK(names_of(monitor) == names);
        for (const hmesh::StageReport& stage : monitor.stages()) {
            CHECK(stage.psnr == doctest::Approx(10 * std::log10(255.0 * 255.0 * samples / stage.energy)));
            if (std::strcmp(stage.name, "collapse") == 0 || std::strcmp(stage.name, "anneal") == 0)
                CHECK(stage.vertices == 50);
            if (std::strcmp(stage.name, "insert") == 0)
                CHECK(stage.vertices == (effort == Effort::draft ? 50 : effort == Effort::best ? 200 : 100));
        }
        CHECK(monitor.stages().back().vertices == subject.mesh.vertex_count());
        CHECK(monitor.stages().back().energy == subject.mesh.energy());
    }
}

TEST_CASE("polishing never raises the energy, and every stage but the collapse leaves a better mesh") {
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
        Subject<std::uint8_t, 3> subject(hmesh_test::scene<std::uint8_t, 3>(64, 56, seed));
        Monitor monitor = silent();
        CHECK(annealed(subject.mesh, 140, options_of(Effort::normal, 12), monitor));
        const auto& stages = monitor.stages();  // grid insert collapse anneal polish
        REQUIRE(stages.size() == 5);
        CHECK(stages[1].energy < stages[0].energy);
        CHECK(stages[2].energy > stages[1].energy);
        CHECK(stages[3].energy < stages[2].energy);
        CHECK(stages[4].energy <= stages[3].energy);
    }
}

TEST_CASE("a mesh can be filled again, and forgets what it was") {
    const auto image = hmesh_test::scene<std::uint8_t, 1>(40, 30, 4);
    Subject<std::uint8_t, 1> used(image), fresh(image);
    Monitor monitor = silent();
    CHECK(annealed(used.mesh, 300, options_of(Effort::fast, 0), monitor));
    for (Subject<std::uint8_t, 1>* subject : {&used, &fresh})
        CHECK(annealed(subject->mesh, 60, options_of(Effort::normal, 4), monitor));
    CHECK(hmesh_test::snapshot(used.mesh) == hmesh_test::snapshot(fresh.mesh));
}

TEST_CASE("told to stop, it leaves a valid mesh and says so") {
    const auto stop_at_second = [](void* user, const hmesh::StageInfo&) { return ++*static_cast<int*>(user) < 2; };
    int calls = 0;
    Subject<std::uint8_t, 1> subject(hmesh_test::scene<std::uint8_t, 1>(40, 30, 4));
    Monitor monitor(Progress{stop_at_second, &calls}, 1200, 255);
    const Status status = annealed(subject.mesh, 60, {}, monitor);
    CHECK(status.code == Errc::cancelled);
    CHECK(calls == 2);
    hmesh_test::prove(subject);
}

TEST_CASE("options that mean nothing are named, and the efforts' own all mean something") {
    for (const Effort effort : {Effort::draft, Effort::fast, Effort::normal, Effort::best})
        CHECK(check(hmesh::annealed_options(effort)));
    const auto refused = [](auto&& spoil) {
        AnnealedOptions options;
        spoil(options);
        const Status status = check(options);
        return status.code == Errc::invalid_argument && std::strlen(status.what) > 15;
    };
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
    for (const double bad : {-1.0, 1e300, infinity, -infinity, nan}) {
        CHECK(refused([bad](AnnealedOptions& o) { o.overshoot = bad; }));
        CHECK(refused([bad](AnnealedOptions& o) { o.start = bad; }));
        CHECK(refused([bad](AnnealedOptions& o) { o.growth = bad; }));
        CHECK(refused([bad](AnnealedOptions& o) { o.shrinkage = bad; }));
        CHECK(refused([bad](AnnealedOptions& o) { o.growth_flips.spread = bad; }));
        CHECK(refused([bad](AnnealedOptions& o) { o.growth_visits.least = bad; }));
        CHECK(refused([bad](AnnealedOptions& o) { o.polish.spread = bad; }));
        CHECK(refused([bad](AnnealedOptions& o) { o.annealing.temperature = bad; }));
        CHECK(refused([bad](AnnealedOptions& o) { o.annealing.cooling = bad; }));
        CHECK(refused([bad](AnnealedOptions& o) { o.annealing.exchange = bad; }));
        CHECK(refused([bad](AnnealedOptions& o) { o.annealing.jump = bad; }));
        CHECK(refused([bad](AnnealedOptions& o) { o.annealing.jump_reach = bad; }));
        CHECK(refused([bad](AnnealedOptions& o) { o.annealing.start_price = bad; }));
        CHECK(refused([bad](AnnealedOptions& o) { o.annealing.band = bad; }));
    }
    for (const int bad : {-1, std::numeric_limits<int>::max()}) {
        CHECK(refused([bad](AnnealedOptions& o) { o.growth_sweeps = bad; }));
        CHECK(refused([bad](AnnealedOptions& o) { o.polish_rounds = bad; }));
        CHECK(refused([bad](AnnealedOptions& o) { o.relaxation.rounds = bad; }));
        CHECK(refused([bad](AnnealedOptions& o) { o.annealing.sweeps = bad; }));
    }
}

TEST_CASE("screens that are NaN, negative or infinite are refused or give a valid mesh of the exact number") {
    Subject<std::uint8_t, 1> subject(hmesh_test::scene<std::uint8_t, 1>(32, 28, 3));
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
    using Screen = double hmesh::AnnealingOptions::*;
    for (const Screen screen : {&hmesh::AnnealingOptions::flip_screen, &hmesh::AnnealingOptions::insertion_screen,
                                &hmesh::AnnealingOptions::removal_screen})
        for (const double bad : {nan, -infinity, -1.0, 0.0, 1e300, infinity}) {
            CAPTURE(bad);
            AnnealedOptions options;
            options.annealing.sweeps = 3;
            options.annealing.*screen = bad;
            if (!check(options)) continue;
            Monitor monitor = silent();
            CHECK(annealed(subject.mesh, 50, options, monitor));
            CHECK(subject.mesh.vertex_count() == 50);
            hmesh_test::prove(subject);
        }
}

TEST_CASE("options at the ends of their ranges give a valid mesh of the exact number") {
    Subject<std::uint8_t, 1> subject(hmesh_test::scene<std::uint8_t, 1>(24, 20, 3));
    for (const bool high : {false, true})
        for (const std::size_t n : {4U, 30U, 480U}) {
            AnnealedOptions options;
            const auto pick = [high](double a, double b) { return high ? b : a; };
            options.overshoot = pick(1, 100);
            options.start = pick(0, 1);
            options.growth = pick(1e-2, 10);
            options.shrinkage = pick(1e-2, 1);
            options.growth_sweeps = high ? 4 : 0;
            options.polish_rounds = high ? 4 : 0;
            options.growth_flips = options.growth_visits = options.polish = {pick(0, 1e6), pick(0, 1e6)};
            options.relaxation.rounds = high ? 4 : 0;
            options.annealing.sweeps = 3;
            options.annealing.temperature = pick(0, 1e3);
            options.annealing.cooling = pick(0, 100);
            options.annealing.exchange = pick(0, 1);
            options.annealing.jump = pick(0, 1);
            options.annealing.jump_reach = pick(0, 1);
            options.annealing.start_price = pick(1e-6, 1e6);
            options.annealing.band = pick(0, 1);
            REQUIRE(check(options));
            Monitor monitor = silent();
            CHECK(annealed(subject.mesh, n, options, monitor));
            CHECK(subject.mesh.vertex_count() == n);
            hmesh_test::prove(subject);
        }
}
