#include "hmesh/large/mesh_reader.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "test_executors.hpp"
#include "test_images.hpp"
#include "test_meshing.hpp"
#include "test_results.hpp"
#include "test_sanitized.hpp"

using hmesh::Annealed;
using hmesh::Effort;
using hmesh::Errc;
using hmesh::Image;
using hmesh::ImageReader;
using hmesh::mesh_image;
using hmesh::Options;
using hmesh::Result;
using hmesh::Samples;
using hmesh::Target;
using hmesh::kit::Rect;
using hmesh_test::same_bytes;

namespace {

Options options_of(int vertices) {
    Options options;
    options.target = Target::vertices(vertices);
    return options;
}

// Meshes an image and a reader of it, which must come to the same.
template <class T, int C>
void check_same(const Image<T, C>& image, const Options& options, const Annealed& recipe,
                const hmesh::ParallelFor& parallel_for = {}) {
    const hmesh::ViewReader<T, C> view(image.view());
    const Result expected = mesh_image(image.view(), options, recipe),
                 result = mesh_image(view.reader(), options, recipe, parallel_for);
    CHECK_MESSAGE(expected.status, hmesh::message(expected.status).c_str());
    CHECK(same_bytes(result, expected));
}

// Several tiles, which all phases cut anew.
Annealed in_tiles(Effort effort) {
    Annealed recipe{effort};
    recipe.tile = 64;
    return recipe;
}

template <class T, int C>
void check_type(std::uint64_t seed) {
    const auto image = hmesh_test::scene<T, C>(160, 120, seed);
    const Image<float, 1> weights = hmesh_test::random_weights(160, 120, seed);
    for (const Samples samples : {Samples::squares, Samples::points})
        for (const bool is_weighted : {false, true}) {
            Options options = options_of(400);
            options.samples = samples;
            if (is_weighted) options.weights = weights.view();
            check_same(image, options, in_tiles(is_weighted ? Effort::draft : Effort::fast), hmesh_test::ThreadFor{2});
        }
}

// The pixels of an image, with a count of calls; the one of number `fails` says that it could not.
template <class T, int C>
struct CountedReader {
    hmesh::ViewReader<T, C> view;
    int fails = -1;
    int calls = 0;
    Rect failed{};
    bool operator()(const Rect& rect, T* to, std::ptrdiff_t stride) {
        if (calls++ != fails) return view(rect, to, stride);
        failed = rect;
        return false;
    }
};

std::string words_of(const Rect& rect) { return message(hmesh::kit::unread(rect)).c_str(); }

}  // namespace

TEST_CASE("a reader gives the bytes of its view, for any sample type, number of channels, samples, weights, tiles and threads") {
    check_type<std::uint8_t, 3>(1);
    check_type<float, 1>(2);
    if (hmesh_test::sanitized) return;
    check_type<std::uint8_t, 1>(3);
    check_type<std::uint8_t, 4>(4);
    check_type<std::uint16_t, 2>(5);
    check_type<float, 3>(6);
}

TEST_CASE("so it does whatever the options ask for") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(120, 90, 7);
    const auto floats = hmesh_test::scene<float, 3>(120, 90, 8);
    const auto alpha = hmesh_test::scene<std::uint8_t, 4>(90, 120, 9);
    Options options = options_of(300);
    check_same(image, options, {Effort::normal});
    options.colors = hmesh::Colors::sampled;
    check_same(floats, options, in_tiles(Effort::draft));
    options.colors.reset();
    options.channel_weights = {0.3, 0, 1};
    check_same(image, options, in_tiles(Effort::draft));
    check_same(floats, options, in_tiles(Effort::draft));
    auto last_is_lowest = floats;
    last_is_lowest.pixel(60, 89)[0] = -2;
    check_same(last_is_lowest, options, in_tiles(Effort::draft));
    options.channel_weights.clear();
    options.periodic = hmesh::Periodic::xy;
    check_same(floats, options, in_tiles(Effort::draft));
    options.straight_border = true;
    check_same(image, options, in_tiles(Effort::draft));
    options = options_of(300);
    options.premultiplied = true;
    check_same(alpha, options, in_tiles(Effort::draft));
    options.premultiplied = false;
    options.samples = Samples::points;
    Annealed recipe = in_tiles(Effort::draft);
    recipe.border_tolerance = 20;
    check_same(image, options, recipe);
    options = options_of(200);
    const Result start = mesh_image(image.view(), options_of(350), {Effort::draft});
    recipe = in_tiles(Effort::draft);
    recipe.start = &start.mesh;
    check_same(image, options, recipe);
    options.target = Target::psnr(24);
    check_same(image, options, {Effort::draft});
    options.target = Target::at_most(500, 20);
    check_same(image, options, {Effort::draft});
}

TEST_CASE("the smallest images, and of one colour") {
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 40}, {33, 1}, {2, 2}}) {
        check_same(hmesh_test::noise<std::uint8_t, 3>(width, height, 1), options_of(4), {Effort::normal});
        check_same(hmesh_test::constant_image<float, 1>(width, height, 0.5), options_of(4), {Effort::normal});
    }
    check_same(hmesh_test::constant_image<std::uint8_t, 1>(300, 20, 0.5), options_of(50), in_tiles(Effort::draft));
}

// Beyond 4194304 px there is no table of the whole image, and patches have tables of their own.
TEST_CASE("of large images no rectangle is large, and no pixel is read often") {
    constexpr int width = 2600, height = 1620, channels = hmesh_test::sanitized ? 1 : 3;
    const auto image = hmesh_test::draw<float, channels>(width, height, [](int x, int y, int c) {
        return 0.5 + 0.1 * c + 0.2 * std::sin(0.002 * x * (y % 400)) + 0.001 * (x % 300);
    });
    const hmesh::ViewReader<float, channels> view(image.view());
    // Each pixel once more at the left and above of a rectangle, once less beyond it.
    std::vector<int> steps((width + 1) * (height + 1), 0);
    std::int64_t largest = 0;
    // What a reader fetches that keeps the last 16 bands of 64 rows it was asked for, as the command's does.
    std::vector<int> bands;
    int fetched = 0;
    const auto read = [&](const Rect& rect, float* to, std::ptrdiff_t stride) {
        for (int band = rect.y / 64; band <= (rect.y + rect.height - 1) / 64; ++band) {
            const auto at = std::find(bands.begin(), bands.end(), band);
            if (at != bands.end()) bands.erase(at);
            else if (++fetched; bands.size() == 16) bands.erase(bands.begin());
            bands.push_back(band);
        }
        const auto step = [&](int x, int y) -> int& { return steps[static_cast<std::size_t>(y * (width + 1) + x)]; };
        ++step(rect.x, rect.y), --step(rect.x + rect.width, rect.y);
        --step(rect.x, rect.y + rect.height), ++step(rect.x + rect.width, rect.y + rect.height);
        largest = std::max(largest, std::int64_t{rect.width} * rect.height);
        return view(rect, to, stride);
    };
    const ImageReader<float, channels> reader{width, height, read};
    constexpr int n = hmesh_test::sanitized ? 12000 : 18000;
    const Options options = options_of(n);
    const Result result = mesh_image(reader, options, {Effort::draft});
    REQUIRE(result.status);
    CHECK(result.report.vertices == n);
    if (!hmesh_test::sanitized) CHECK(same_bytes(result, mesh_image(image.view(), options, {Effort::draft})));
    CHECK(largest <= 600 * 600);
    double sum = 0;
    int most = 0;
    std::vector<int> above(width + 1, 0);
    for (int y = 0; y < height; ++y)
        for (int x = 0, row = 0; x < width; ++x) {
            row += steps[static_cast<std::size_t>(y * (width + 1) + x)];
            above[static_cast<std::size_t>(x)] += row;
            most = std::max(most, above[static_cast<std::size_t>(x)]);
            sum += above[static_cast<std::size_t>(x)];
        }
    CHECK(sum / (double{width} * height) < 32);
    CHECK(fetched < 20 * ((height + 63) / 64));  // one pass after the other, each down the image
    CHECK(most < 80);                            // where patches stand out of their tiles, as they do where points are far apart
}

TEST_CASE("whichever read fails, there is no mesh, the status names the rectangle, and nothing is read or told after it") {
    const auto check_failures = [](const auto& image, Options options, int step) {
        using Reader = CountedReader<std::decay_t<decltype(*image.data())>, 3>;
        const hmesh::ViewReader<std::decay_t<decltype(*image.data())>, 3> view(image.view());
        Reader whole{view};
        REQUIRE(mesh_image(ImageReader<std::decay_t<decltype(*image.data())>, 3>{image.width(), image.height(), whole}, options,
                           in_tiles(Effort::draft))
                    .status);
        CHECK(whole.calls > 10);
        for (int k = 0; k < whole.calls; k += step) {
            Reader fails{view, k};
            bool is_told = false;
            const auto progress = [&](const hmesh::ProgressInfo&) {
                is_told = is_told || fails.calls > k;
                return true;
            };
            options.progress = progress;
            const ImageReader<std::decay_t<decltype(*image.data())>, 3> reader{image.width(), image.height(), fails};
            const Result result = mesh_image(reader, options, in_tiles(Effort::draft));
            REQUIRE(result.status.code == Errc::read_failed);
            CHECK(message(result.status).c_str() == words_of(fails.failed));
            CHECK(fails.calls == k + 1);
            CHECK(!is_told);
            CHECK(!result.has_mesh());
            CHECK(result.report.vertices == 0);
        }
    };
    const int step = hmesh_test::sanitized ? 5 : 1;
    Options options = options_of(150);
    check_failures(hmesh_test::scene<std::uint8_t, 3>(100, 80, 3), options, step);
    check_failures(hmesh_test::scene<float, 3>(100, 80, 3), options, step);
    options.periodic = hmesh::Periodic::x;
    check_failures(hmesh_test::scene<float, 3>(100, 80, 3), options, 7 * step);
    options = options_of(150);
    options.channel_weights = {1, 2, 3};
    options.colors = hmesh::Colors::sampled;
    check_failures(hmesh_test::scene<float, 3>(100, 80, 3), options, 3 * step);
    options.target = Target::psnr(28);
    check_failures(hmesh_test::scene<std::uint8_t, 3>(100, 80, 3), options, 29 * step);
}

TEST_CASE("a failure among threads ends the work with its status") {
    const auto image = hmesh_test::scene<std::uint8_t, 1>(300, 200, 4);
    const hmesh::ViewReader<std::uint8_t, 1> view(image.view());
    for (const bool is_concurrent : {false, true})
        for (const int last : {0, 3, 9, 20}) {
            std::atomic<int> calls{0};
            const auto read = [&](const Rect& rect, std::uint8_t* to, std::ptrdiff_t stride) {
                return calls++ < last && view(rect, to, stride);
            };
            const ImageReader<std::uint8_t, 1> reader{300, 200, read, is_concurrent};
            const Result result = mesh_image(reader, options_of(900), in_tiles(Effort::normal), hmesh_test::ThreadFor{3});
            CHECK(result.status.code == Errc::read_failed);
            CHECK(!result.has_mesh());
        }
}

TEST_CASE("a cancellation gives the mesh reached, the same as of the view") {
    const auto image = hmesh_test::scene<float, 1>(150, 110, 5);
    const hmesh::ViewReader<float, 1> view(image.view());
    for (const std::string last : {"points", "settle", "collapse", "anneal", "polish", "colors"}) {
        const auto run = [&](const auto& from) {
            const auto progress = [&](const hmesh::ProgressInfo& info) { return info.stage != last || info.fraction < 0.4; };
            Options options = options_of(400);
            options.progress = progress;
            return mesh_image(from, options, in_tiles(Effort::normal));
        };
        const Result result = run(view.reader());
        CHECK(result.status.code == Errc::cancelled);
        CHECK(result.has_mesh());
        CHECK(same_bytes(result, run(image.view())));
    }
}

TEST_CASE("an image that changes while it is read breaks nothing") {
    const auto image = hmesh_test::noise<float, 1>(160, 120, 6);
    const hmesh::ViewReader<float, 1> view(image.view());
    int calls = 0;
    const auto read = [&](const Rect& rect, float* to, std::ptrdiff_t stride) {
        const float shift = static_cast<float>(++calls % 5);
        (void)view(rect, to, stride);
        for (int y = 0; y < rect.height; ++y)
            for (int x = 0; x < rect.width; ++x)
                to[y * (stride / 4) + x] = calls % 2 == 0 ? 100 * shift : shift - to[y * (stride / 4) + x];
        return true;
    };
    for (const int vertices : {4, 500, 19200}) {
        const Result result = mesh_image(ImageReader<float, 1>{160, 120, read}, options_of(vertices), in_tiles(Effort::draft));
        CHECK((!result.has_mesh() || hmesh_test::flaw_of(result.mesh.view(), 160, 120) == ""));
    }
    // Beyond the range that weights of channels were scaled to.
    const auto colors = hmesh_test::noise<float, 3>(60, 40, 7);
    const hmesh::ViewReader<float, 3> of_colors(colors.view());
    for (const float gain : {1e30F, -1e30F}) {
        calls = 0;
        const auto grows = [&](const Rect& rect, float* to, std::ptrdiff_t stride) {
            (void)of_colors(rect, to, stride);
            if (++calls > 5) to[1] *= gain;
            return true;
        };
        Options options = options_of(100);
        options.channel_weights = {1, 2, 3};
        const Result result = mesh_image(ImageReader<float, 3>{60, 40, grows}, options, in_tiles(Effort::draft));
        CHECK((!result.has_mesh() || hmesh_test::flaw_of(result.mesh.view(), 60, 40) == ""));
    }
    // Finite at first, and then no longer.
    calls = 0;
    const auto turns_nan = [&](const Rect& rect, float* to, std::ptrdiff_t stride) {
        (void)view(rect, to, stride);
        if (++calls > 12) to[0] = std::numeric_limits<float>::quiet_NaN();
        return true;
    };
    const Result result = mesh_image(ImageReader<float, 1>{160, 120, turns_nan}, options_of(100), in_tiles(Effort::draft));
    CHECK(result.status.code == Errc::not_finite);
    CHECK(!result.has_mesh());
}

TEST_CASE("what is refused of a view is refused of a reader, before anything is read") {
    const auto never = [](const Rect&, auto*, std::ptrdiff_t) {
        FAIL("read");
        return false;
    };
    const auto code_of = [&](int width, int height, const Options& options, const Annealed& recipe = {}) {
        return mesh_image(ImageReader<std::uint8_t, 1>{width, height, never}, options, recipe).status.code;
    };
    CHECK(code_of(0, 5, {}) == Errc::invalid_argument);
    CHECK(code_of(5, 65537, {}) == Errc::image_too_large);
    CHECK(code_of(5, 5, options_of(3)) == Errc::target_out_of_range);
    CHECK(code_of(5, 5, options_of(26)) == Errc::target_out_of_range);
    Options options;
    options.target = Target::percent(10);  // of 2^32
    CHECK(code_of(65536, 65536, options) == Errc::target_out_of_range);
    options = {};
    options.periodic = hmesh::Periodic::x;
    CHECK(code_of(65536, 10, options) == Errc::image_too_large);
    options = {};
    options.premultiplied = true;
    CHECK(code_of(10, 10, options) == Errc::invalid_argument);
    options = {};
    options.samples = Samples::points;
    CHECK(code_of(1, 10, options) == Errc::invalid_argument);
    CHECK(mesh_image(ImageReader<float, 1>{1, 10, never}, options).status.code == Errc::invalid_argument);
    const Image<float, 1> weights(10, 9);
    options = {};
    options.weights = weights.view();
    CHECK(code_of(10, 10, options) == Errc::invalid_argument);
    CHECK(mesh_image(ImageReader<float, 1>{10, 10, never}, options).status.code == Errc::invalid_argument);
    Annealed recipe;
    recipe.tile = 3;
    CHECK(code_of(10, 10, {}, recipe) == Errc::invalid_argument);
    CHECK(mesh_image(ImageReader<float, 3>{10, 10}).status.code == Errc::invalid_argument);

    auto wild = hmesh_test::noise<float, 1>(20, 90, 7);
    for (const int row : {88, 41, 40}) {
        *wild.pixel(7, row) = std::numeric_limits<float>::quiet_NaN();
        const hmesh::ViewReader<float, 1> view(wild.view());
        const Result result = mesh_image(view.reader(), {}, {}, hmesh_test::ReverseFor{});
        CHECK(result.status.code == Errc::not_finite);
        CHECK(result.status.value == row);
        CHECK(!result.has_mesh());
    }
}
