#include "hmesh/outline.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "hmesh/render.hpp"
#include "test_images.hpp"
#include "test_outlines.hpp"

using hmesh::Errc;
using hmesh::Outline;
using hmesh::OutlineOptions;
using hmesh_test::AlphaImage;
using hmesh_test::UnitLoops;

namespace {

UnitLoops loops_of(const Outline& outline) {
    UnitLoops loops;
    const auto unit = [&](std::size_t i) {
        return static_cast<std::int64_t>(256 * static_cast<double>(outline.mesh.positions[i]));
    };
    for (const auto& loop : outline.loops) {
        loops.emplace_back();
        for (const std::uint32_t v : loop) loops.back().push_back({unit(2 * std::size_t{v}), unit(2 * std::size_t{v} + 1)});
    }
    return loops;
}

// Proves all that outline() promises.
void prove(const AlphaImage& image, const OutlineOptions& options) {
    const Outline outline = hmesh::outline(image.view(), options);
    REQUIRE_MESSAGE(outline.status, hmesh::message(outline.status).c_str());
    const UnitLoops loops = loops_of(outline);
    const auto margin = static_cast<std::int64_t>(std::lround(256 * options.margin));
    const auto counts = [&](int x, int y) { return image.pixel(x, y)[1] > options.threshold; };
    CHECK(hmesh_test::flaw_of_loops(loops, image.width(), image.height(), margin, counts) == "");
    CHECK(hmesh_test::flaw_of_faces(loops, outline.mesh.faces) == "");
    const std::size_t vertices = outline.mesh.vertex_count();
    std::size_t corners = 0;
    double area = 0;
    for (const auto& loop : loops) {
        corners += loop.size();
        std::int64_t twice = 0;
        for (std::size_t i = 0; i < loop.size(); ++i) twice += hmesh_test::turn_of({0, 0}, loop[i], loop[(i + 1) % loop.size()]);
        area += static_cast<double>(twice) / (2 * 65536);
        if (!options.holes) CHECK(twice > 0);
    }
    CHECK(corners == vertices);
    CHECK(area == doctest::Approx(outline.area).epsilon(1e-12));
    CHECK(outline.area >= outline.covered * (1 - 1e-12));
    CHECK(outline.covered <= static_cast<double>(image.width()) * image.height() * (1 + 1e-12));
    if (options.max_vertices != 0) CHECK(vertices <= static_cast<std::size_t>(options.max_vertices));
    else CHECK(outline.area <= (outline.covered + options.tolerance * outline.length) * (1 + 1e-12));
    CHECK(outline.mesh.width == image.width());
    CHECK(outline.mesh.height == image.height());
    CHECK(check(outline.mesh.view(), 1));
    bool is_any = false;
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x) is_any = is_any || counts(x, y);
    CHECK(is_any == (vertices != 0));
}

}  // namespace

TEST_CASE("every pixel that counts is inside, no two sides meet, and the faces divide the inside, whatever the picture") {
    hmesh::kit::Random random(11);
    for (int round = 0; round < 160; ++round) {
        const int width = 1 + static_cast<int>(random.below(44)), height = 1 + static_cast<int>(random.below(44));
        const AlphaImage image = hmesh_test::some_silhouette(round, width, height, random);
        OutlineOptions options;
        constexpr double margins[] = {0, 0.5, 0.5, 1, 0.3, 0.75, 2.5, 64};
        constexpr double tolerances[] = {0, 0.1, 0.5, 1, 4, 1000};
        options.margin = margins[random.below(8)];
        options.tolerance = tolerances[random.below(6)];
        options.holes = random.below(4) != 0;
        if (random.below(2) == 0) options.max_vertices = 4 + static_cast<int>(random.below(60));
        CAPTURE(round);
        CAPTURE(width);
        CAPTURE(height);
        CAPTURE(options.margin);
        CAPTURE(options.tolerance);
        CAPTURE(options.max_vertices);
        CAPTURE(options.holes);
        prove(image, options);
    }
}

TEST_CASE("a picture that is all there is its rectangle, and one that is all air is nothing") {
    for (const auto& [width, height] : {std::pair<int, int>{1, 1}, {1, 9}, {30, 20}}) {
        const auto full = hmesh_test::silhouette(width, height, [](int, int) { return true; });
        for (const double tolerance : {0.0, 1.0, 1000.0}) {
            OutlineOptions options;
            options.tolerance = tolerance;
            const Outline outline = hmesh::outline(full.view(), options);
            CHECK(outline.mesh.vertex_count() == 4);
            CHECK(outline.mesh.faces.size() == 2);
            CHECK(outline.area == width * height);
            CHECK(outline.covered == width * height);
        }
        const Outline opaque = hmesh::outline(hmesh_test::constant_image<float, 3>(width, height, 0).view());
        CHECK(opaque.area == width * height);

        const Outline air = hmesh::outline(AlphaImage(width, height).view());
        CHECK(air.status);
        CHECK(air.mesh.vertex_count() == 0);
        CHECK(air.mesh.faces.empty());
        CHECK(air.loops.empty());
        CHECK(air.area == 0);
        CHECK(check(air.mesh.view(), 1));
    }
}

TEST_CASE("a pixel alone is a square with its margin, as far as the image goes") {
    const auto image = hmesh_test::silhouette(5, 4, [](int x, int y) { return x == 4 && y == 1; });
    OutlineOptions options;
    options.tolerance = 0;
    for (const double margin : {0.0, 0.25, 0.5, 1.0, 64.0}) {
        options.margin = margin;
        const Outline outline = hmesh::outline(image.view(), options);
        const double left = std::max(0.0, 4 - margin), top = std::max(0.0, 1 - margin), bottom = std::min(4.0, 2 + margin);
        CHECK(outline.area == (5 - left) * (bottom - top));
        CHECK(outline.mesh.positions == std::vector<float>{static_cast<float>(left), static_cast<float>(top), 5,
                                                           static_cast<float>(top), 5, static_cast<float>(bottom),
                                                           static_cast<float>(left), static_cast<float>(bottom)});
    }
}

TEST_CASE("the threshold is one of 255ths of full alpha, whatever the samples are") {
    const auto check_type = [](auto sample) {
        using T = decltype(sample);
        const auto image = hmesh_test::draw<T, 4>(40, 10, [](int x, int, int c) { return c == 3 ? x / 51.0 : 0.0; });  // 5 a px
        for (const double threshold : {0.0, 4.0, 5.0, 99.0, 100.0, 254.0}) {
            OutlineOptions options;
            options.threshold = threshold, options.margin = 0;
            const double columns = std::max(0.0, 39 - std::floor(threshold / 5));
            CHECK(hmesh::outline(image.view(), options).covered == 10 * columns);
        }
    };
    check_type(std::uint8_t{});
    check_type(std::uint16_t{});
    check_type(0.0F);
}

TEST_CASE("a disc has few vertices and little more area than it needs, fewer the more area it may take") {
    const auto disc = hmesh_test::silhouette(200, 200, [](int x, int y) { return std::hypot(x - 99.5, y - 99.5) < 90; });
    std::size_t before = 1000;
    for (const auto& [tolerance, most] : {std::pair<double, std::size_t>{0.54, 40}, {0.9, 19}, {1.35, 14}, {4.5, 8}}) {
        OutlineOptions options;
        options.tolerance = tolerance;
        const std::size_t vertices = hmesh::outline(disc.view(), options).mesh.vertex_count();
        CHECK(vertices <= most);
        CHECK(vertices < before);
        before = vertices;
    }
    // The least polygons around a circle are regular, n tan(pi / n) / pi times its area; 1 % more are steps of pixels.
    for (const int n : {4, 8, 12, 16, 24, 40}) {
        OutlineOptions options;
        options.max_vertices = n, options.tolerance = 0;
        const Outline outline = hmesh::outline(disc.view(), options);
        const double pi = std::acos(-1.0), least = n * std::tan(pi / n) / pi;
        CAPTURE(n);
        CHECK(outline.mesh.vertex_count() <= static_cast<std::size_t>(n));
        CHECK(outline.area / outline.covered < 1.012 * least);
    }
}

TEST_CASE("noise of more islands than anyone wants is one outline") {
    hmesh::kit::Random random(5);
    const auto noise = hmesh_test::silhouette(300, 300, [&](int, int) { return random.uniform() < 0.1; });
    OutlineOptions options;
    options.margin = 0;
    const Outline outline = hmesh::outline(noise.view(), options);
    CHECK(outline.loops.size() == 1);
    CHECK(outline.area > 0.9 * 300 * 300);
    CHECK(outline.mesh.vertex_count() < 60);
}

TEST_CASE("the same picture gives the same outline") {
    hmesh::kit::Random random(3);
    const AlphaImage image = hmesh_test::some_silhouette(7, 90, 70, random);
    const Outline one = hmesh::outline(image.view()), other = hmesh::outline(image.view());
    CHECK(one.mesh.positions == other.mesh.positions);
    CHECK(one.mesh.faces == other.mesh.faces);
    CHECK(one.loops == other.loops);
}

TEST_CASE("an outline is drawn as a mesh of ones") {
    const auto disc = hmesh_test::silhouette(30, 30, [](int x, int y) { return std::hypot(x - 15, y - 12) < 9; });
    const Outline outline = hmesh::outline(disc.view());
    const hmesh::RenderResult<1> drawn = hmesh::render<1>(outline.mesh.view());
    REQUIRE(drawn.status);
    for (int y = 0; y < 30; ++y)
        for (int x = 0; x < 30; ++x)
            if (disc.pixel(x, y)[1] > 0) CHECK(*drawn.image.pixel(x, y) == 1);
}

TEST_CASE("bad images and options out of range are refused with value and bound") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const AlphaImage good(3, 3);
    const auto refused = [&](double threshold, double margin, double tolerance, int most) {
        OutlineOptions options;
        options.threshold = threshold, options.margin = margin, options.tolerance = tolerance, options.max_vertices = most;
        const Outline outline = hmesh::outline(good.view(), options);
        CHECK(outline.status.code == Errc::invalid_argument);
        CHECK(outline.mesh.width == 0);
        CHECK(outline.loops.empty());
    };
    for (const double bad : {-1.0, 255.0, nan}) refused(bad, 0, 0, 0);
    for (const double bad : {-0.1, 65.0, nan}) refused(0, bad, 0, 0);
    for (const double bad : {-0.1, 1001.0, nan}) refused(0, 0, bad, 0);
    for (const int bad : {-1, 1, 3}) refused(0, 0, 0, bad);
    CHECK(hmesh::outline(hmesh::ImageView<std::uint8_t, 4>{}).status.code == Errc::invalid_argument);
    hmesh::Image<float, 4> image(2, 2);
    image.pixel(1, 1)[3] = static_cast<float>(nan);
    CHECK(hmesh::outline(image.view()).status.code == Errc::not_finite);
}
