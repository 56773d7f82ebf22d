#include "hmesh/lods/mesh_lods.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "periodic_sheets.hpp"
#include "test_executors.hpp"
#include "test_images.hpp"
#include "test_meshing.hpp"
#include "test_results.hpp"
#include "test_sanitized.hpp"

using hmesh::Annealed;
using hmesh::Effort;
using hmesh::Errc;
using hmesh::Image;
using hmesh::LodOptions;
using hmesh::Lods;
using hmesh::mesh_lods;
using hmesh::Options;
using hmesh::ProgressInfo;
using hmesh::Result;
using hmesh::Target;

namespace {

Options vertices(std::int64_t n) {
    Options options;
    options.target = Target::vertices(n);
    return options;
}
LodOptions count(int levels) {
    LodOptions options;
    options.levels = levels;
    return options;
}

// All levels are there, valid, true of the image, and each has half the vertices of the one before.
template <class T, int C>
void prove_levels(const Image<T, C>& image, const Lods& lods, std::size_t n, std::size_t levels) {
    CHECK_MESSAGE(lods.status, hmesh::message(lods.status).c_str());
    REQUIRE(lods.levels.size() == levels);
    for (const Result& level : lods.levels) {
        CAPTURE(n);
        hmesh_test::prove_result(image, level, n);
        n /= 2;
    }
}

bool same_levels(const Lods& a, const Lods& b) {
    bool same = a.status.code == b.status.code && a.levels.size() == b.levels.size();
    for (std::size_t k = 0; same && k < a.levels.size(); ++k) same = hmesh_test::same_bytes(a.levels[k], b.levels[k]);
    return same;
}

void check_refused(const Lods& lods, Errc code, const char* words) {
    CHECK(lods.levels.empty());
    CHECK(lods.status.code == code);
    CHECK(std::string(lods.status.what).find(words) != std::string::npos);
}

}  // namespace

TEST_CASE("the first level is the mesh of mesh_image(), and each further one has half the vertices of the one before") {
    const Image<std::uint8_t, 3> image = hmesh_test::scene<std::uint8_t, 3>(120, 90, 3);
    for (const Effort effort : {Effort::draft, Effort::fast, Effort::normal}) {
        CAPTURE(static_cast<int>(effort));
        const Lods lods = mesh_lods(image.view(), vertices(301), {}, {effort});
        prove_levels(image, lods, 301, 5);
        const Result first = hmesh::mesh_image(image.view(), vertices(301), Annealed{effort});
        CHECK(hmesh_test::same_bytes(lods.levels[0], first));
        for (std::size_t k = 1; k < lods.levels.size(); ++k) CHECK(lods.levels[k].report.psnr < lods.levels[k - 1].report.psnr);
    }
}

TEST_CASE("levels come for any sample type, channels, weights, premultiplication, sampled colours") {
    const Image<float, 1> floats = hmesh_test::scene<float, 1>(70, 60, 5);
    prove_levels(floats, mesh_lods(floats.view(), vertices(120), count(3), {Effort::fast}), 120, 3);
    const Image<std::uint16_t, 2> shorts = hmesh_test::scene<std::uint16_t, 2>(70, 60, 6);
    prove_levels(shorts, mesh_lods(shorts.view(), vertices(64), count(4), {Effort::draft}), 64, 4);

    const Image<std::uint8_t, 4> rgba = hmesh_test::scene<std::uint8_t, 4>(70, 60, 7);
    Options options = vertices(100);
    options.premultiplied = true;
    for (const Result& level : mesh_lods(rgba.view(), options, count(3)).levels) CHECK(level.mesh.premultiplied);

    const Image<std::uint8_t, 3> image = hmesh_test::scene<std::uint8_t, 3>(70, 60, 8);
    options = vertices(100);
    options.colors = hmesh::Colors::sampled;
    prove_levels(image, mesh_lods(image.view(), options, count(3)), 100, 3);

    // The left half alone counts: hence its error falls.
    Image<float, 1> left(70, 60);
    for (int y = 0; y < 60; ++y)
        for (int x = 0; x < 70; ++x) left.pixel(x, y)[0] = x < 35 ? 1.0F : 0.0F;
    options = vertices(100);
    options.weights = left.view();
    const Lods weighted = mesh_lods(image.view(), options, count(3));
    REQUIRE(weighted.levels.size() == 3);
    const Lods plain = mesh_lods(image.view(), vertices(100), count(3));
    for (std::size_t k = 0; k < 3; ++k) CHECK(weighted.levels[k].report.psnr > plain.levels[k].report.psnr);
}

// With weights of channels the error of a scaled copy is told, whose samples are rounded.
TEST_CASE("the error that a level begins with is that of the one before, weights of channels and all") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(90, 70, 4);
    for (const std::vector<double>& weights : {std::vector<double>{}, {4, 0.5, 1}}) {
        Options options = vertices(240);
        options.channel_weights = weights;
        std::map<std::size_t, double> begun;  // by the number of vertices
        const auto watch = [&](const ProgressInfo& info) {
            if (info.fraction <= 0 && std::strcmp(info.stage, "collapse") == 0) begun[info.vertices] = info.energy;
            return true;
        };
        options.progress = watch;
        const Lods lods = mesh_lods(image.view(), options, count(3), {Effort::fast});
        REQUIRE(lods.levels.size() == 3);
        for (const Result* const level : {&lods.levels[0], &lods.levels[1]})
            CHECK(begun[level->report.vertices] == doctest::Approx(level->report.energy).epsilon(weights.empty() ? 1e-3 : 0.05));
    }
}

TEST_CASE("sampled colours are those of each level") {
    const auto noise = hmesh_test::noise<std::uint8_t, 3>(60, 50, 3);
    Options options = vertices(120);
    const Lods optimal = mesh_lods(noise.view(), options, count(3), {Effort::draft});
    options.colors = hmesh::Colors::sampled;
    const Lods sampled = mesh_lods(noise.view(), options, count(3), {Effort::draft});
    REQUIRE((optimal.levels.size() == 3 && sampled.levels.size() == 3));
    for (std::size_t k = 0; k < 3; ++k) CHECK(sampled.levels[k].report.psnr < optimal.levels[k].report.psnr - 0.4);
}

TEST_CASE("levels are as good as meshes of their own, on average over pictures and seeds" *
          doctest::skip(hmesh_test::sanitized)) {
    for (const Effort effort : {Effort::fast, Effort::normal}) {
        CAPTURE(static_cast<int>(effort));
        double gain = 0;
        for (std::uint64_t seed = 1; seed <= 4; ++seed) {
            const Image<std::uint8_t, 3> image = hmesh_test::scene<std::uint8_t, 3>(160, 140, seed);
            const Lods lods = mesh_lods(image.view(), vertices(600), count(4), {effort, seed});
            REQUIRE(lods.levels.size() == 4);
            for (std::size_t k = 1; k < 4; ++k) {
                const auto n = static_cast<std::int64_t>(lods.levels[k].report.vertices);
                gain +=
                    lods.levels[k].report.psnr - hmesh::mesh_image(image.view(), vertices(n), Annealed{effort, seed}).report.psnr;
            }
        }
        // A seed more or less is worth 0.1; few vertices get more sweeps than fast has for a mesh of their own.
        CHECK(gain / 12 > (effort == Effort::fast ? 0.2 : -0.12));
    }
}

TEST_CASE("levels of an image that repeats repeat too") {
    const auto image = hmesh_test::draw<std::uint8_t, 3>(96, 80, hmesh_test::Scene(96, 80, 5));
    for (const hmesh::Periodic periodic : {hmesh::Periodic::x, hmesh::Periodic::xy})
        for (const bool straight : {false, true}) {
            CAPTURE(straight);
            Options options = vertices(240);
            options.periodic = periodic;
            options.straight_border = straight;
            const Lods lods = mesh_lods(image.view(), options, count(3), Annealed{Effort::fast});
            CHECK_MESSAGE(lods.status, hmesh::message(lods.status).c_str());
            REQUIRE(lods.levels.size() == 3);
            std::size_t n = 240;
            for (const Result& level : lods.levels) {
                CHECK(level.report.vertices == n);
                CHECK(level.mesh.periodic == periodic);
                CHECK(hmesh_test::sheet_flaw(level.mesh) == "");
                n /= 2;
            }
        }
}

TEST_CASE("the chain ends where 4 vertices are left") {
    const Image<std::uint8_t, 3> image = hmesh_test::scene<std::uint8_t, 3>(40, 30, 2);
    prove_levels(image, mesh_lods(image.view(), vertices(40), count(32)), 40, 4);  // 40, 20, 10, 5
    prove_levels(image, mesh_lods(image.view(), vertices(7), count(5)), 7, 1);
    prove_levels(image, mesh_lods(image.view(), vertices(8), count(1)), 8, 1);
    const Image<std::uint8_t, 1> pixel = hmesh_test::constant_image<std::uint8_t, 1>(1, 1, 0.5);
    prove_levels(pixel, mesh_lods(pixel.view()), 4, 1);
    const Image<std::uint8_t, 1> row = hmesh_test::scene<std::uint8_t, 1>(30, 1, 5);
    prove_levels(row, mesh_lods(row.view(), vertices(30)), 30, 3);
    for (const double level : {0.0, 0.5, 1.0}) {
        const Image<std::uint8_t, 3> flat = hmesh_test::constant_image<std::uint8_t, 3>(50, 40, level);
        prove_levels(flat, mesh_lods(flat.view(), vertices(200)), 200, 5);
    }
    const Image<std::uint8_t, 3> noise = hmesh_test::noise<std::uint8_t, 3>(40, 30, 1);
    prove_levels(noise, mesh_lods(noise.view(), vertices(1200)), 1200, 5);
}

TEST_CASE("what mesh_image() refuses and absurd numbers of levels are refused with a sentence") {
    const Image<std::uint8_t, 3> image = hmesh_test::scene<std::uint8_t, 3>(40, 30, 2);
    for (const int levels : {0, -1, std::numeric_limits<int>::min()})
        check_refused(mesh_lods(image.view(), vertices(40), count(levels)), Errc::invalid_argument, "at least 1 level");
    for (const int levels : {33, std::numeric_limits<int>::max()})
        check_refused(mesh_lods(image.view(), vertices(40), count(levels)), Errc::invalid_argument, "at most 32 levels");
    check_refused(mesh_lods(image.view(), vertices(3)), Errc::target_out_of_range, "4 vertices");
    check_refused(mesh_lods(image.view(), vertices(1201)), Errc::target_out_of_range, "one vertex a pixel");
    Options options;
    options.target = Target::percent(std::numeric_limits<double>::quiet_NaN());
    check_refused(mesh_lods(image.view(), options), Errc::target_out_of_range, "percent");
    check_refused(mesh_lods(hmesh::ImageView<std::uint8_t, 3>{}, {}), Errc::invalid_argument, "");
    Annealed recipe;
    recipe.tile = 1;
    check_refused(mesh_lods(image.view(), {}, {}, recipe), Errc::invalid_argument, "tile");
    recipe = {};
    const hmesh::Mesh of_another = mesh_lods(hmesh_test::scene<std::uint8_t, 3>(41, 30, 2).view(), {}).levels.at(0).mesh;
    recipe.start = &of_another;
    check_refused(mesh_lods(image.view(), {}, {}, recipe), Errc::invalid_argument, "wide");
    recipe = {};
    recipe.border_tolerance = 0;
    for (const Target& target : {Target::vertices(20), Target::psnr(35)}) {
        options.target = target;
        options.samples = hmesh::Samples::points;
        check_refused(mesh_lods(image.view(), options, {}, recipe), Errc::target_out_of_range, "sides");
    }
    Image<float, 1> bad = hmesh_test::scene<float, 1>(40, 30, 2);
    bad.pixel(3, 4)[0] = std::numeric_limits<float>::quiet_NaN();
    check_refused(mesh_lods(bad.view(), {}), Errc::not_finite, "");
}

TEST_CASE("a search for a PSNR is the first level's, and its failure the whole's") {
    const Image<std::uint8_t, 3> image = hmesh_test::scene<std::uint8_t, 3>(80, 60, 4);
    Options options;
    options.target = Target::psnr(27);
    const Lods lods = mesh_lods(image.view(), options, count(3), {Effort::fast});
    REQUIRE(lods.levels.size() == 3);
    CHECK(lods.status);
    CHECK(lods.levels[0].report.psnr >= 27);
    CHECK(lods.levels[1].report.psnr < 27);
    options.target = Target::psnr(90, 60);
    const Lods nearest = mesh_lods(image.view(), options, count(3), {Effort::fast});
    CHECK(nearest.status.code == Errc::target_out_of_range);
    REQUIRE(nearest.levels.size() == 3);
    CHECK(nearest.levels[2].report.vertices == 15);
}

TEST_CASE("a first level that has no coarser ones ends the progress once, and may be cancelled there") {
    const auto flat = hmesh_test::constant_image<std::uint8_t, 1>(60, 50, 0.5);
    for (const Target& target : {Target::psnr(40), Target::vertices(7)})
        for (const bool goes_on : {true, false}) {
            int ends = 0;
            const auto watch = [&](const ProgressInfo& info) {
                ends += info.total >= 1 ? 1 : 0;
                return goes_on || info.total < 1;
            };
            Options options;
            options.target = target;
            options.progress = watch;
            const Lods lods = mesh_lods(flat.view(), options, {}, {Effort::draft});
            CHECK(ends == 1);
            CHECK(lods.status.code == (goes_on ? Errc::ok : Errc::cancelled));
            REQUIRE(lods.levels.size() == 1);
            CHECK(lods.levels[0].report.vertices < 8);
        }
}

TEST_CASE("progress rises over the whole chain, to 1, and a cancellation leaves the levels that were finished") {
    const Image<std::uint8_t, 3> image = hmesh_test::scene<std::uint8_t, 3>(120, 90, 3);
    for (const bool is_search : {false, true}) {
        Options options = vertices(300);
        if (is_search) options.target = Target::psnr(27);
        double last = 0;
        bool rises = true;
        std::vector<double> ends;  // of the levels
        const auto watch = [&](const ProgressInfo& info) {
            rises = rises && info.total >= last && info.fraction >= 0 && info.fraction <= 1;
            last = info.total;
            if (info.fraction >= 1 && std::strcmp(info.stage, "colors") == 0) ends.push_back(info.total);
            return true;
        };
        options.progress = watch;
        const Lods lods = mesh_lods(image.view(), options, count(4), {Effort::fast});
        CHECK(lods.levels.size() == 4);
        CHECK(rises);
        CHECK(last == 1);
        REQUIRE(ends.size() >= 4);
        CHECK(ends[ends.size() - 4] < 0.95);
        CHECK(ends[ends.size() - 2] < 1);
        // A level that takes half the work of the one before it has half its share.
        const double* const end = ends.data() + ends.size() - 4;
        CHECK(end[2] - end[1] < 0.75 * (end[1] - end[0]));
        CHECK(end[3] - end[2] < 0.75 * (end[2] - end[1]));
        CHECK(end[2] > end[1]);
    }
    const Lods whole = mesh_lods(image.view(), vertices(300), count(4), {Effort::fast});
    for (const double stop : {0.0, 0.2, 0.5, 0.7, 0.8, 0.9, 0.97, 1.0}) {
        CAPTURE(stop);
        Options options = vertices(300);
        const auto cancel = [stop](const ProgressInfo& info) { return info.total < stop; };
        options.progress = cancel;
        const Lods lods = mesh_lods(image.view(), options, count(4), {Effort::fast});
        CHECK(lods.status.code == Errc::cancelled);
        REQUIRE(!lods.levels.empty());
        CHECK(lods.levels.size() < 4);
        for (std::size_t k = 0; k < lods.levels.size(); ++k) {
            if (lods.levels[k].status) CHECK(hmesh_test::same_bytes(lods.levels[k], whole.levels[k]));
            else CHECK(k == 0);
            CHECK(hmesh_test::flaw_of(lods.levels[k].mesh.view(), 120, 90) == "");
        }
    }
}

TEST_CASE("any executor gives the same bytes") {
    const Image<std::uint8_t, 3> image = hmesh_test::scene<std::uint8_t, 3>(300, 200, 3);
    Annealed recipe;
    recipe.effort = Effort::fast;
    recipe.tile = 64;
    const Lods one = mesh_lods(image.view(), vertices(3000), count(3), recipe);
    prove_levels(image, one, 3000, 3);
    CHECK(same_levels(one, mesh_lods(image.view(), vertices(3000), count(3), recipe, hmesh_test::ReverseFor())));
    CHECK(same_levels(one, mesh_lods(image.view(), vertices(3000), count(3), recipe, hmesh_test::ThreadFor{3})));
}
