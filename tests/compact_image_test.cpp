#include "hmesh/rate/compact_image.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <vector>

#include "compact_meshes.hpp"
#include "hmesh/core/random.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/image/premultiply.hpp"
#include "hmesh/io/compact.hpp"
#include "hmesh/io/compact/photographs.hpp"
#include "hmesh/mesh_image.hpp"
#include "hmesh/methods/annealed/options.hpp"
#include "hmesh/render.hpp"
#include "mesh_flaws.hpp"
#include "test_executors.hpp"
#include "test_images.hpp"
#include "test_sanitized.hpp"

using hmesh::CompactImage;
using hmesh::CompactImageOptions;
using hmesh::Errc;

namespace {

hmesh::Annealed quick() {
    hmesh::Annealed recipe;
    recipe.effort = hmesh::Effort::draft;
    return recipe;
}
CompactImageOptions bytes(std::size_t count, bool bare = false) {
    CompactImageOptions options;
    options.bytes = count;
    options.bare = bare;
    return options;
}
hmesh::CompactMesh read(const CompactImage& image, const CompactImageOptions& options) {
    return options.bare ? hmesh::read_bare_compact(image.bytes.data(), image.bytes.size(), {}, options.table)
                        : hmesh::read_compact(image.bytes.data(), image.bytes.size(), {}, options.table);
}

// That the file holds the mesh, and is as near to the image as is said.
template <class T, int C>
void prove(const hmesh::ImageView<T, C>& view, const CompactImageOptions& options, const CompactImage& out) {
    REQUIRE(out.status);
    CHECK(out.bytes.size() <= options.bytes);
    const hmesh::CompactMesh back = read(out, options);
    REQUIRE(back.status);
    CHECK(back.mesh.positions == out.mesh.positions);
    CHECK(back.mesh.colors == out.mesh.colors);
    CHECK(back.mesh.premultiplied == options.premultiplied);
    if (!options.bare) CHECK((back.mesh.width == view.width && back.mesh.height == view.height));
    // Drawn from the bytes, and rounded to the image's samples.
    hmesh::RenderOptions size;
    size.width = view.width;
    size.height = view.height;
    const auto drawn = hmesh::render<C>(back.mesh.view(), size);
    REQUIRE(drawn.status);
    constexpr double peak = hmesh::PixelTraits<T>::peak;
    double energy = 0;
    for (int y = 0; y < view.height; ++y)
        for (int x = 0; x < view.width; ++x)
            for (int k = 0; k < C; ++k) {
                const double value = std::min(std::max(static_cast<double>(drawn.image.pixel(x, y)[k]) / 255, 0.0), 1.0) * peak;
                const double sample = hmesh::PixelTraits<T>::to_real(view.pixel(x, y)[k]);
                const double off = ((std::is_integral_v<T> ? std::round(value) : value) - sample) / peak;
                energy += off * off;
            }
    if (std::isinf(out.psnr)) CHECK(energy == 0);
    else
        CHECK(-10 * std::log10(energy / (static_cast<double>(view.width) * view.height * C)) ==
              doctest::Approx(out.psnr).epsilon(1e-5));
}

}  // namespace

TEST_CASE("compact files hold meshes of images that are one pixel wide, whose flips undo others") {
    hmesh::Image<std::uint8_t, 1> image(65536, 1);
    for (int x = 0; x < image.width(); ++x) image.pixel(x, 0)[0] = 9;
    hmesh::Options options;
    options.target = hmesh::Target::vertices(328);
    const hmesh::Result result = hmesh::mesh_image(image.view(), options, hmesh::Annealed{hmesh::Effort::fast});
    std::vector<std::uint8_t> file;
    REQUIRE(hmesh::write_compact(result.mesh.view(), hmesh::kit::append_to(file)));
    const hmesh::CompactMesh back = hmesh::read_compact(file.data(), file.size());
    REQUIRE(back.status);
    CHECK(hmesh_test::difference(result.mesh, back.mesh) == "");
}

TEST_CASE("images as long as any fit into bytes of any number") {
    for (const bool bare : {false, true}) {
        if (bare && hmesh_test::sanitized) continue;
        hmesh::Image<std::uint8_t, 1> image(65536, hmesh_test::sanitized ? 3 : 16);
        for (int y = 0; y < image.height(); ++y)
            for (int x = 0; x < image.width(); ++x) image.pixel(x, y)[0] = static_cast<std::uint8_t>(x / 300 + 2 * y);
        const CompactImage out = compact_image(image.view(), bytes(4000, bare), quick());
        CHECK(out.status);
        CHECK(out.bytes.size() <= 4000);
    }
    const auto small = hmesh_test::scene<std::uint8_t, 3>(20, 10, 1);
    CHECK(compact_image(small.view(), bytes(std::numeric_limits<std::size_t>::max()), quick()).status);
}

TEST_CASE("a start table that no file can name is refused") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(20, 10, 1);
    hmesh::CompactTable table = hmesh::compact_photographs;
    table.number = 7;
    CompactImageOptions options = bytes(300);
    options.table = &table;
    const CompactImage out = compact_image(image.view(), options, quick());
    CHECK(out.status.code == Errc::invalid_argument);
    CHECK(out.bytes.empty());
}

TEST_CASE("an image fits into the bytes that it is given, and uses them, the better the more there are") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(90, 60, 1);
    for (const bool bare : {false, true}) {
        double before = 0;
        for (const std::size_t budget : {80U, 160U, 320U}) {
            CAPTURE(budget);
            const CompactImage out = compact_image(image.view(), bytes(budget, bare), quick());
            prove(image.view(), bytes(budget, bare), out);
            CHECK(static_cast<double>(out.bytes.size()) >= 0.98 * static_cast<double>(budget));
            CHECK(out.psnr > before);
            before = out.psnr;
        }
    }
}

TEST_CASE("a drawing gets a lattice that is fine enough for its edges" * doctest::skip(hmesh_test::sanitized)) {
    // The second has more vertices than are a matter of luck, and is told by its flat colours. Of 24 such drawings each the first
    // come to 47 dB, the second too, or to 37 on the lattice of a photograph; with a draft half of them come to 40.
    hmesh::Annealed recipe;
    recipe.effort = hmesh::Effort::fast;
    for (const int width : {200, 400}) {
        CAPTURE(width);
        const std::size_t budget = width == 200 ? 800 : 1600;
        const int height = width * 4 / 5;
        hmesh::Image<std::uint8_t, 3> image(width, height);
        hmesh::kit::Random random(5);
        for (int k = 0; k < width / 16; ++k) {
            const auto below = [&](std::size_t n) { return static_cast<int>(random.below(n)); };
            const int x0 = below(static_cast<std::size_t>(width) - 50), y0 = below(static_cast<std::size_t>(height) - 40);
            const int columns = 10 + below(40), rows = 10 + below(30);
            const int color[3] = {below(256), below(256), below(256)};
            for (int y = y0; y < y0 + rows; ++y)
                for (int x = x0; x < x0 + columns; ++x)
                    for (int c = 0; c < 3; ++c) image.pixel(x, y)[c] = static_cast<std::uint8_t>(color[c]);
        }
        const CompactImage out = compact_image(image.view(), bytes(budget), recipe);
        prove(image.view(), bytes(budget), out);
        CHECK(out.psnr > 40);
    }
}

// Gradients have far finer colours than photographs, and more bytes go into these.
TEST_CASE("smooth images have fine colours, and use their bytes" * doctest::skip(hmesh_test::sanitized)) {
    const auto make_smooth = [](auto& image, int channels) {
        for (int y = 0; y < image.height(); ++y)
            for (int x = 0; x < image.width(); ++x)
                for (int c = 0; c < channels; ++c)
                    image.pixel(x, y)[c] =
                        static_cast<std::uint8_t>(128 + 60 * std::sin(0.01 * x + c) + 60 * std::cos(0.013 * y));
    };
    hmesh::Image<std::uint8_t, 3> rgb(160, 120);
    hmesh::Image<std::uint8_t, 4> rgba(160, 120);
    make_smooth(rgb, 3);
    make_smooth(rgba, 4);
    for (const std::size_t budget : {1600U, 4000U}) {
        const CompactImage out = compact_image(rgb.view(), bytes(budget), quick());
        CHECK(out.psnr > 52);
        CHECK((static_cast<double>(out.bytes.size()) >= 0.98 * static_cast<double>(budget) || out.psnr >= 55));
    }
    const CompactImage out = compact_image(rgba.view(), bytes(12000), quick());
    CHECK((out.bytes.size() >= 11760 || out.psnr >= 55));
}

TEST_CASE("noise uses its bytes too, where they can tell more than its mean") {
    const auto image = hmesh_test::noise<std::uint8_t, 3>(120, 90, 2);
    double before = 0;
    for (const std::size_t budget : {300U, 500U, 1200U}) {
        if (hmesh_test::sanitized && budget == 500) continue;
        const CompactImage out = compact_image(image.view(), bytes(budget), quick());
        prove(image.view(), bytes(budget), out);
        CHECK(static_cast<double>(out.bytes.size()) >= 0.96 * static_cast<double>(budget));
        CHECK(out.psnr > before);
        before = out.psnr;
    }
}

TEST_CASE("too few bytes are refused, with those that are needed") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(40, 30, 1);
    for (const bool bare : {false, true}) {
        const CompactImage out = compact_image(image.view(), bytes(5, bare), quick());
        CHECK(out.status.code == Errc::target_out_of_range);
        CHECK(out.status.limit == 5);
        CHECK(out.bytes.empty());
        CHECK(out.mesh.faces.empty());
        const auto least = static_cast<std::size_t>(out.status.value);
        CHECK(least < 40);
        const CompactImage fits = compact_image(image.view(), bytes(least, bare), quick());
        prove(image.view(), bytes(least, bare), fits);
        CHECK(!compact_image(image.view(), bytes(least - 1, bare), quick()).status);
    }
    CHECK(compact_image(hmesh::ImageView<std::uint8_t, 3>{}).status.code == Errc::invalid_argument);
}

TEST_CASE("images of all sizes and kinds of samples fit") {
    hmesh::kit::Random random(1);
    for (int round = 0; round < 6; ++round) {
        const int width = 1 + static_cast<int>(random.below(round < 4 ? 4 : 40)), height = 1 + static_cast<int>(random.below(30));
        CAPTURE(width);
        CAPTURE(height);
        CompactImageOptions options = bytes(60 + random.below(300), round % 2 == 0);
        if (round % 3 > 0) options.table = &hmesh::compact_photographs;
        const auto grey = hmesh_test::scene<std::uint8_t, 1>(width, height, 2);
        prove(grey.view(), options, compact_image(grey.view(), options, quick()));
        const auto deep = hmesh_test::scene<std::uint16_t, 3>(width, height, 3);
        prove(deep.view(), options, compact_image(deep.view(), options, quick()));
        const auto real = hmesh_test::scene<float, 3>(width, height, 4);
        prove(real.view(), options, compact_image(real.view(), options, quick()));
        const auto sprite = hmesh_test::scene<std::uint8_t, 4>(width, height, 5);
        CompactImageOptions times_alpha = options;
        times_alpha.premultiplied = true;
        const auto product = hmesh::kit::premultiply(sprite.view());
        prove(product.view(), times_alpha, compact_image(sprite.view(), times_alpha, quick()));
    }
}

TEST_CASE("a mesh to start from is refused by a sentence that speaks of it") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(40, 40, 1);
    const hmesh::Mesh mesh = hmesh::mesh_image(image.view(), {}, quick()).mesh;
    hmesh::Annealed recipe = quick();
    recipe.start = &mesh;
    const CompactImage out = compact_image(image.view(), bytes(300), recipe);
    CHECK((out.status.code == Errc::invalid_argument && !out.status.has_value && out.bytes.empty()));
}

TEST_CASE("an image without alpha cannot be premultiplied") {
    CompactImageOptions options = bytes(300);
    options.premultiplied = true;
    const auto grey = hmesh_test::scene<std::uint8_t, 1>(20, 20, 1);
    const auto color = hmesh_test::scene<float, 3>(20, 20, 1);
    for (const CompactImage& out : {compact_image(grey.view(), options, quick()), compact_image(color.view(), options, quick())})
        CHECK((out.status.code == Errc::invalid_argument && out.bytes.empty()));
}

TEST_CASE("an image of one colour takes no more bytes than that") {
    const std::vector<std::uint8_t> pixels(std::size_t{3} * 64 * 64, 77);
    const hmesh::ImageView<std::uint8_t, 3> view{pixels.data(), 64, 64};
    const CompactImage out = compact_image(view, bytes(1000), quick());
    prove(view, bytes(1000), out);
    CHECK(out.bytes.size() < 50);
    CHECK(out.psnr > 55);
}

TEST_CASE("the same bytes for any executor") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(80, 50, 1);
    const CompactImage alone = compact_image(image.view(), bytes(150), quick());
    CHECK(compact_image(image.view(), bytes(150), quick(), hmesh_test::ReverseFor()).bytes == alone.bytes);
    CHECK(compact_image(image.view(), bytes(150), quick(), hmesh_test::ThreadFor{3}).bytes == alone.bytes);
}

TEST_CASE("the same bytes from rows with anything between them, also bottom up") {
    constexpr int width = 80, height = 50, row = 3 * width, stride = row + 7;
    const auto image = hmesh_test::scene<std::uint8_t, 3>(width, height, 1);
    std::vector<std::uint8_t> stored(std::size_t{stride} * height, 77);
    for (int y = 0; y < height; ++y) std::copy_n(image.pixel(0, y), row, stored.data() + stride * (height - 1 - y));
    const hmesh::ImageView<std::uint8_t, 3> view{stored.data() + stride * (height - 1), width, height, -stride};
    const CompactImage out = compact_image(view, bytes(150), quick());
    prove(view, bytes(150), out);
    CHECK(out.bytes == compact_image(image.view(), bytes(150), quick()).bytes);
}

TEST_CASE("progress never falls and ends at 1; what is cancelled gives no bytes") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(50, 40, 1);
    CompactImageOptions options = bytes(100);
    double last = 0;
    int calls = 0, most = -1;
    bool has_fallen = false, has_mesh = false;
    const auto progress = [&](const hmesh::ProgressInfo& info) {
        has_fallen = has_fallen || info.total < last;
        last = info.total;
        has_mesh = has_mesh || info.mesh_so_far;  // which would be one of another size
        return ++calls != most;
    };
    options.progress = progress;
    CHECK(compact_image(image.view(), options, quick()).status);
    CHECK(!has_fallen);
    CHECK(!has_mesh);
    CHECK(last == 1);
    const int all = calls;
    for (const int call : {1, 2 + all / 4, 3 + all / 2, all - 1, all}) {
        most = call;
        calls = 0;
        last = 0;
        const CompactImage out = compact_image(image.view(), options, quick());
        CHECK(out.status.code == Errc::cancelled);
        CHECK(out.bytes.empty());
    }
}

TEST_CASE("NaN is refused") {
    std::vector<float> pixels(64, 0.5F);
    pixels[9] = std::numeric_limits<float>::quiet_NaN();
    const hmesh::ImageView<float, 1> view{pixels.data(), 8, 8};
    CHECK(compact_image(view, bytes(100), quick()).status.code == Errc::not_finite);
}

TEST_CASE("shrunk pixels are the means of what they cover, also at the image's end") {
    const std::vector<std::uint8_t> pixels = {0, 30, 60, 90, 120, 150};
    const hmesh::ImageView<std::uint8_t, 1> view{pixels.data(), 3, 2};
    const auto one = hmesh::detail::shrunk(view, 1, 1, 3.0, 2.0, {});
    CHECK(one.data()[0] == 75);
    const auto two = hmesh::detail::shrunk(view, 2, 1, 1.5, 2.0, {});
    CHECK(two.data()[0] == 55);  // (0 + 30 / 2 + 90 + 120 / 2) / 3
    CHECK(two.data()[1] == 95);
    const auto end = hmesh::detail::shrunk(view, 2, 1, 2.0, 2.0, {});
    CHECK(end.data()[0] == 60);
    CHECK(end.data()[1] == 105);
    const auto same = hmesh::detail::shrunk(view, 3, 2, 1.0, 1.0, {});
    CHECK(std::vector<std::uint8_t>(same.data(), same.data() + 6) == pixels);
}
