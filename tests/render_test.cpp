#include "hmesh/render.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <utility>
#include <vector>

#include "hmesh/core/random.hpp"
#include "test_executors.hpp"
#include "test_images.hpp"
#include "test_sanitized.hpp"

namespace {

using hmesh::Errc;
using hmesh::Image;
using hmesh::ImageView;
using hmesh::Mesh;
using hmesh::MeshView;
using hmesh::RenderOptions;
using hmesh::Status;
using hmesh::kit::Point;
using hmesh::kit::Random;
using hmesh_test::ReverseFor;
using hmesh_test::samples_of;

Point position(const MeshView& mesh, std::uint32_t v) {
    return {static_cast<double>(mesh.positions[2 * std::size_t{v}]), static_cast<double>(mesh.positions[2 * std::size_t{v} + 1])};
}

double area(const MeshView& mesh, const std::array<std::uint32_t, 3>& face) {
    return hmesh::kit::orient2d(position(mesh, face[0]), position(mesh, face[1]), position(mesh, face[2]));
}

// A triangulation of [0, width] x [0, height] on the 1/256 px grid: shifted grid points, then `splits` faces split in
// three. Coordinates are often halves and wholes, so that centres on edges and vertices occur.
template <int C>
Mesh random_mesh(int width, int height, int columns, int rows, int splits, Random& random) {
    Mesh mesh;
    mesh.channels = C, mesh.width = width, mesh.height = height, mesh.peak = 255;
    const auto around = [&](double x, double step) {
        const double shifted = x + (random.uniform() - 0.5) * 0.6 * step;
        return random.below(2) == 0 ? std::round(2 * shifted) / 2 : hmesh::kit::snap(shifted);
    };
    const auto add = [&](double x, double y) {
        mesh.positions.push_back(static_cast<float>(x));
        mesh.positions.push_back(static_cast<float>(y));
        return static_cast<std::uint32_t>(mesh.vertex_count() - 1);
    };
    const double step_x = static_cast<double>(width) / columns, step_y = static_cast<double>(height) / rows;
    do {
        mesh.positions.clear();
        mesh.faces.clear();
        for (int j = 0; j <= rows; ++j)
            for (int i = 0; i <= columns; ++i) {
                const double x = i == 0 ? 0 : i == columns ? width : around(i * step_x, step_x);
                const double y = j == 0 ? 0 : j == rows ? height : around(j * step_y, step_y);
                add(x, y);
            }
        for (int j = 0; j < rows; ++j)
            for (int i = 0; i < columns; ++i) {
                const auto a = static_cast<std::uint32_t>(j * (columns + 1) + i), b = a + 1;
                const auto c = a + static_cast<std::uint32_t>(columns) + 1, d = c + 1;
                const bool falling = random.below(2) == 0;
                mesh.faces.push_back(falling ? std::array{a, b, d} : std::array{a, b, c});
                mesh.faces.push_back(falling ? std::array{a, d, c} : std::array{b, d, c});
            }
    } while (!std::all_of(mesh.faces.begin(), mesh.faces.end(), [&](const auto& face) { return area(mesh.view(), face) > 0; }));
    for (int n = 0; n < splits; ++n) {
        const std::size_t f = random.below(mesh.face_count());
        const auto [a, b, c] = mesh.faces[f];
        const double u = random.uniform(), v = random.uniform() * (1 - u);
        const Point p = position(mesh.view(), a), q = position(mesh.view(), b), r = position(mesh.view(), c);
        const Point at = hmesh::kit::snap({p.x + u * (q.x - p.x) + v * (r.x - p.x), p.y + u * (q.y - p.y) + v * (r.y - p.y)});
        if (hmesh::kit::orient2d(p, q, at) <= 0 || hmesh::kit::orient2d(q, r, at) <= 0 || hmesh::kit::orient2d(r, p, at) <= 0)
            continue;
        const std::uint32_t d = add(at.x, at.y);
        mesh.faces[f] = {a, b, d};
        mesh.faces.push_back({b, c, d});
        mesh.faces.push_back({c, a, d});
    }
    for (std::size_t k = 0; k < C * mesh.vertex_count(); ++k) mesh.colors.push_back(static_cast<float>(256 * random.uniform()));
    for (auto& face : mesh.faces) std::rotate(face.begin(), face.begin() + static_cast<int>(random.below(3)), face.end());
    return mesh;
}

template <int C>
Image<float, C> drawn(const MeshView& mesh, const RenderOptions& options = {}) {
    hmesh::RenderResult<C> result = hmesh::render<C>(mesh, options);
    REQUIRE(result.status);
    return std::move(result.image);
}

// Which pixels each face draws when it is alone: face f draws pixel (i, j) if result[f][width * j + i].
std::vector<std::vector<bool>> drawn_alone(const MeshView& mesh, const RenderOptions& options = {}) {
    std::vector<std::vector<bool>> result;
    const std::vector<float> ones(mesh.vertex_count, 1.0F);
    for (std::size_t f = 0; f < mesh.face_count; ++f) {
        MeshView alone = mesh;
        alone.faces = mesh.faces + f;
        alone.face_count = 1;
        alone.colors = ones.data();
        alone.channels = 1;
        const Image<float, 1> image = drawn<1>(alone, options);
        result.emplace_back();
        for (const float sample : samples_of(image)) result.back().push_back(sample != 0.0F);
    }
    return result;
}

// The top-left rule in whole numbers: coordinates in units of which a pixel of the picture has `unit`, an even number.
struct WholePoint {
    std::int64_t x, y;
};
bool holds(const std::array<WholePoint, 3>& face, WholePoint p) {
    for (std::size_t k = 0; k < 3; ++k) {
        const WholePoint a = face[k], b = face[(k + 1) % 3];
        const std::int64_t side = (b.x - a.x) * (p.y - a.y) - (p.x - a.x) * (b.y - a.y);
        const bool is_left = b.y < a.y, is_top = b.y == a.y && b.x > a.x;  // clockwise on the screen
        if (side < 0 || (side == 0 && !is_left && !is_top)) return false;
    }
    return true;
}
// The same for a mesh on the 1/256 px grid drawn `times` / `parts` its size.
void check_against_whole_numbers(const MeshView& mesh, int times, int parts) {
    const RenderOptions options{mesh.width * times / parts, mesh.height * times / parts};
    const std::vector<std::vector<bool>> pixels = drawn_alone(mesh, options);
    const std::int64_t unit = 256 * parts;
    std::size_t different = 0;
    for (std::size_t f = 0; f < mesh.face_count; ++f) {
        std::array<WholePoint, 3> face{};
        for (std::size_t k = 0; k < 3; ++k) {
            const Point p = position(mesh, mesh.faces[f][k]);
            face[k] = {std::llround(p.x * 256) * times, std::llround(p.y * 256) * times};
        }
        std::size_t at = 0;
        for (int j = 0; j < *options.height; ++j)
            for (int i = 0; i < *options.width; ++i)
                different += pixels[f][at++] != holds(face, {unit * i + unit / 2, unit * j + unit / 2});
    }
    CHECK(different == 0);
}

void check_each_pixel_once(const MeshView& mesh, const RenderOptions& options = {}) {
    const std::vector<std::vector<bool>> pixels = drawn_alone(mesh, options);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < pixels[0].size(); ++i) {
        std::size_t times = 0;
        for (const std::vector<bool>& face : pixels) times += face[i];
        wrong += times != 1;
    }
    CHECK(wrong == 0);
}

// Gives vertices the colours (3 + 2 x - y / 2, 10 - x + 3 y) of their positions.
void paint_affine(Mesh& mesh) {
    for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
        const Point p = position(mesh.view(), v);
        mesh.colors[2 * v] = static_cast<float>(3 + 2 * p.x - 0.5 * p.y);
        mesh.colors[2 * v + 1] = static_cast<float>(10 - p.x + 3 * p.y);
    }
}
double farthest_from_affine(const Mesh& mesh, const RenderOptions& options) {
    const Image<float, 2> image = drawn<2>(mesh.view(), options);
    double worst = 0;
    for (int j = 0; j < image.height(); ++j)
        for (int i = 0; i < image.width(); ++i) {
            const double x = (i + 0.5) * mesh.width / image.width(), y = (j + 0.5) * mesh.height / image.height();
            worst = std::max(worst, std::abs(static_cast<double>(image.pixel(i, j)[0]) - (3 + 2 * x - 0.5 * y)));
            worst = std::max(worst, std::abs(static_cast<double>(image.pixel(i, j)[1]) - (10 - x + 3 * y)));
        }
    return worst;
}

Status render_status(const MeshView& mesh, const RenderOptions& options = {}) {
    const hmesh::RenderResult<1> result = hmesh::render<1>(mesh, options);
    CHECK((result.image.size() == 0) == !result.status);
    return result.status;
}

}  // namespace

TEST_CASE("every pixel is drawn by exactly one face, at any output size") {
    Random random(1);
    for (std::size_t n = 0; n < 20; n += hmesh_test::stride_if_sanitized(4)) {
        const Mesh mesh = random_mesh<1>(23, 37, 3, 4, 12, random);
        check_each_pixel_once(mesh.view());
        check_each_pixel_once(mesh.view(), {50, 11});
        check_each_pixel_once(mesh.view(), {1, 90});
        check_each_pixel_once(mesh.view(), {69, 111});
    }
}

TEST_CASE("faces draw the pixels that the top-left rule in whole numbers gives them, at 1, 3 and 1/2 times the size") {
    Random random(2);
    for (std::size_t n = 0; n < 20; n += hmesh_test::stride_if_sanitized(4)) {
        const Mesh mesh = random_mesh<1>(22, 40, 3, 4, 12, random);
        check_against_whole_numbers(mesh.view(), 1, 1);
        check_against_whole_numbers(mesh.view(), 3, 1);
        check_against_whole_numbers(mesh.view(), 1, 2);
    }
}

TEST_CASE("a centre on an edge belongs to the face on the right or below, one on a vertex to one face") {
    Mesh mesh;
    mesh.channels = 1, mesh.width = mesh.height = 3, mesh.peak = 1;
    mesh.positions = {0, 0, 3, 0, 3, 3, 0, 3, 1.5F, 1.5F};
    mesh.colors.assign(5, 0.0F);
    mesh.faces = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};  // above, right, below, left of the middle
    const std::vector<std::vector<bool>> pixels = drawn_alone(mesh.view());
    CHECK(pixels[0] == std::vector<bool>{true, true, false, false, false, false, false, false, false});
    CHECK(pixels[1] == std::vector<bool>{false, false, true, false, true, true, false, false, true});
    CHECK(pixels[2] == std::vector<bool>{false, false, false, false, false, false, true, true, false});
    CHECK(pixels[3] == std::vector<bool>{false, false, false, true, false, false, false, false, false});
}

TEST_CASE("tall slivers over many bands are drawn pixel for pixel") {
    Random random(3);
    for (int n = 0; n < 3; ++n) {
        const Mesh mesh = random_mesh<1>(4, 1500, 12, 1, 12, random);
        check_each_pixel_once(mesh.view());
        check_against_whole_numbers(mesh.view(), 1, 1);
    }
}

TEST_CASE("two faces agree on their edge to the last bit, as the long side of one and a short side of the other") {
    // The edge starts at (2^-33, 10) and ends near (run, 10 + drop). Where run = drop it passes centres at a distance
    // of EdgeWalker's slack, so that its last bit decides.
    for (const double run : {65536.0, 65535.0, 3 * 65535.0, 5 * 65533.0})
        for (const double drop : {65536.0, 65535.0, 3 * 65535.0, 5 * 65533.0}) {
            Mesh mesh;
            mesh.channels = 1, mesh.width = mesh.height = 24, mesh.peak = 1;
            mesh.positions = {
                std::ldexp(1.0F, -33), 10, static_cast<float>(run), static_cast<float>(10 + drop), -5, 30000, 500000, 0};
            mesh.colors.assign(4, 0.0F);
            mesh.faces = {{0, 1, 2}, {0, 3, 1}};
            const std::vector<std::vector<bool>> pixels = drawn_alone(mesh.view());
            std::size_t wrong = 0;
            for (std::size_t i = 24 * 10; i < 24 * 24; ++i) wrong += pixels[0][i] == pixels[1][i];
            CHECK(wrong == 0);
        }
}

TEST_CASE("faces outside the picture are clipped") {
    Random random(4);
    for (int n = 0; n < 10; ++n) {
        Mesh mesh = random_mesh<1>(60, 60, 3, 3, 10, random);
        for (float& x : mesh.positions) x -= 20;
        mesh.channels = 1, mesh.width = mesh.height = 20;
        check_against_whole_numbers(mesh.view(), 1, 1);
        check_each_pixel_once(mesh.view());
    }
}

TEST_CASE("a mesh of an affine picture draws that picture, at any size") {
    Random random(5);
    for (int n = 0; n < 10; ++n) {
        Mesh mesh = random_mesh<2>(40, 36, 4, 4, 30, random);
        paint_affine(mesh);
        CHECK(farthest_from_affine(mesh, {}) < 1e-4);
        CHECK(farthest_from_affine(mesh, {120, 108}) < 1e-4);
        CHECK(farthest_from_affine(mesh, {20, 18}) < 1e-4);
        CHECK(farthest_from_affine(mesh, {33, 71}) < 1e-4);
    }
}

TEST_CASE("colours are neither rounded nor clamped to the peak") {
    Mesh mesh;
    mesh.channels = 1, mesh.width = 2, mesh.height = 1, mesh.peak = 255;
    mesh.positions = {0, 0, 2, 0, 2, 1, 0, 1};
    mesh.faces = {{0, 1, 2}, {0, 2, 3}};
    mesh.colors = {-100.25F, 300.25F, 300.25F, -100.25F};
    CHECK(samples_of(drawn<1>(mesh.view())) == std::vector<float>{-0.125F, 200.125F});
}

TEST_CASE("faces of no area and faces of no pixel change nothing, also the thinnest") {
    Random random(6);
    Mesh mesh = random_mesh<1>(20, 70, 2, 3, 8, random);
    const Image<float, 1> before = drawn<1>(mesh.view());
    const auto first = static_cast<std::uint32_t>(mesh.vertex_count());
    // A vertical, a level and a slanted line, a point, each through pixel centres; then a face between centres.
    mesh.positions.insert(mesh.positions.end(),
                          {3.5F, 0, 3.5F, 30.5F, 3.5F, 70, 0, 5.5F, 10.5F, 5.5F, 20, 5.5F, 0, 0, 8.5F, 8.5F});
    mesh.positions.insert(mesh.positions.end(), {20, 20, 4.25F, 0, 19.25F, 15, 4.25390625F, 0});
    mesh.colors.resize(mesh.vertex_count(), 1000.0F);
    for (std::uint32_t v = 0; v < 9; v += 3) mesh.faces.push_back({first + v, first + v + 1, first + v + 2});
    mesh.faces.push_back({first + 1, first + 1, first + 1});
    mesh.faces.push_back({first, first + 2, first});
    mesh.faces.push_back({first + 9, first + 11, first + 10});
    CHECK(samples_of(drawn<1>(mesh.view())) == samples_of(before));
}

TEST_CASE("colours stay between those of the corners, also where a thin face is given a centre beside it") {
    Mesh mesh;  // its left edge passes the centre of pixel (0, 0) at 2^-35 px: within EdgeWalker's slack
    mesh.channels = 1, mesh.width = 1, mesh.height = 2048, mesh.peak = 1;
    mesh.positions = {0.5F, 0, 0.5F + std::ldexp(1.0F, -22), 0, 0.5F + std::ldexp(1.0F, -23), 2048};
    mesh.colors = {0.25F, 1, 0.25F};
    mesh.faces = {{0, 1, 2}};
    CHECK(drawn<1>(mesh.view()).data()[0] == 0.25F);
}

TEST_CASE("a face of the other orientation draws the same pixels") {
    Random random(7);
    Mesh mesh = random_mesh<1>(20, 20, 2, 2, 5, random);
    const std::vector<std::vector<bool>> pixels = drawn_alone(mesh.view());
    for (auto& face : mesh.faces) std::swap(face[0], face[1]);
    CHECK(drawn_alone(mesh.view()) == pixels);
}

TEST_CASE("pixels in no face are 0 and a later face covers an earlier") {
    Mesh mesh;
    mesh.channels = 1, mesh.width = 4, mesh.height = 2, mesh.peak = 1;
    mesh.positions = {0, 0, 2, 0, 0, 2, 2, 2, 1, 0, 1, 2};
    mesh.colors = {1, 1, 1, 1, 1, 1};
    mesh.faces = {{0, 1, 3}, {0, 3, 2}};
    CHECK(samples_of(drawn<1>(mesh.view())) == std::vector<float>{1, 1, 0, 0, 1, 1, 0, 0});
    mesh.positions.insert(mesh.positions.end(), {0, 0, 1, 0, 1, 2, 0, 2});
    mesh.colors.insert(mesh.colors.end(), {5, 5, 5, 5});
    mesh.faces.push_back({6, 7, 8});
    mesh.faces.push_back({6, 8, 9});
    CHECK(samples_of(drawn<1>(mesh.view())) == std::vector<float>{5, 1, 0, 0, 5, 1, 0, 0});
}

TEST_CASE("a mesh of nothing is drawn as nothing, at any size") {
    Mesh mesh;
    mesh.channels = 4, mesh.width = 3, mesh.height = 40, mesh.peak = 255;
    CHECK(samples_of(drawn<4>(mesh.view())) == std::vector<float>(4 * 3 * 40, 0.0F));
    CHECK(samples_of(drawn<4>(mesh.view(), {70, 1})) == std::vector<float>(4 * 70, 0.0F));
    mesh.channels = 3;
    CHECK(render_status(mesh.view()).code == Errc::invalid_argument);  // render_status() draws one channel
}

TEST_CASE("an executor that runs backwards gives identical bytes") {
    Random random(8);
    Mesh mesh = random_mesh<3>(150, 210, 70, 60, 500, random);  // more than one chunk of vertices and of faces
    for (std::uint32_t v = 20; v-- > 0;)                        // over many bands and over each other
        mesh.faces.push_back({100 * v, 50 * v + 7, 3000 + 33 * v});
    const Image<float, 3> forward = drawn<3>(mesh.view(), {300, 333});
    const hmesh::RenderResult<3> reversed = hmesh::render<3>(mesh.view(), {300, 333}, ReverseFor{});
    REQUIRE(reversed.status);
    const Image<float, 3>& backward = reversed.image;
    CHECK(samples_of(forward) == samples_of(backward));
    const Image<std::uint8_t, 3> pixels = hmesh::to_pixels<std::uint8_t>(forward);
    CHECK(samples_of(pixels) == samples_of(hmesh::to_pixels<std::uint8_t>(forward, ReverseFor{})));
    const double serial = hmesh::psnr(pixels.view(), forward.view());
    CHECK(serial == hmesh::psnr(pixels.view(), forward.view(), ReverseFor{}));
    CHECK(serial > 50);
    CHECK(serial < 70);  // of rounding: 20 log10(255 sqrt 12) = 58.9 dB
}

TEST_CASE("a mesh or size that cannot be drawn gives a Status and no picture") {
    Random random(9);
    const Mesh good = random_mesh<1>(8, 8, 2, 2, 0, random);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    CHECK(render_status(good.view()));
    for (const int none : {0, -3}) {
        CHECK(render_status(good.view(), {none, 5}).code == Errc::invalid_argument);
        CHECK(render_status(good.view(), {5, none}).code == Errc::invalid_argument);
        CHECK(render_status(good.view(), {5, none}).value == none);
        CHECK(render_status(good.view(), {5, none}).limit == 1);
    }
    CHECK(render_status(good.view(), {65537, 1}).code == Errc::image_too_large);
    CHECK(render_status(good.view(), {1, 65537}).code == Errc::image_too_large);
    CHECK(render_status(good.view(), {65536, 65536}).code == Errc::image_too_large);
    if constexpr (sizeof(std::size_t) == 4) {  // elsewhere it is drawn, into 4 GiB
        const Mesh wide = random_mesh<4>(8, 8, 2, 2, 0, random);
        CHECK(hmesh::render<4>(wide.view(), {65536, 4096}).status.code == Errc::image_too_large);
    }
    CHECK(render_status({}).code == Errc::invalid_argument);
    Mesh mesh = good;
    mesh.width = 0;
    CHECK(render_status(mesh.view(), {5, 5}).code == Errc::invalid_argument);
    mesh = good;
    mesh.height = -1;
    CHECK(render_status(mesh.view(), {5, 5}).code == Errc::invalid_argument);
    mesh = good;
    mesh.positions[3] = nan;
    CHECK(render_status(mesh.view()).code == Errc::not_finite);
    mesh = good;
    mesh.colors[3] = nan;
    CHECK(render_status(mesh.view()).code == Errc::not_finite);
    mesh = good;
    mesh.faces[2][1] = 9;
    CHECK(render_status(mesh.view()).code == Errc::invalid_argument);
    for (const float far : {1e7F, -1e7F, std::numeric_limits<float>::max()}) {
        mesh = good;
        mesh.positions[2] = far;
        CHECK(render_status(mesh.view()).code == Errc::invalid_argument);
    }
    const hmesh::RenderResult<3> wrong_channels = hmesh::render<3>(good.view());
    CHECK(wrong_channels.status.code == Errc::invalid_argument);
    CHECK(wrong_channels.status.value == 1);
    CHECK(wrong_channels.status.limit == 3);
    CHECK(wrong_channels.image.size() == 0);
    CHECK(render_status(good.view(), {{}, {}, static_cast<RenderOptions::Interpolation>(2)}).code == Errc::invalid_argument);
}

TEST_CASE("a side that is not given is the mesh's own") {
    Random random(10);
    const Mesh mesh = random_mesh<1>(8, 6, 2, 2, 0, random);
    const Image<float, 1> own = drawn<1>(mesh.view()), wide = drawn<1>(mesh.view(), {20, {}}),
                          high = drawn<1>(mesh.view(), {{}, 20});
    CHECK((own.width() == 8 && own.height() == 6));
    CHECK((wide.width() == 20 && wide.height() == 6));
    CHECK((high.width() == 8 && high.height() == 20));
}

TEST_CASE("in linear light colours are held to the range and interpolated as light, alpha as it is stored") {
    Mesh mesh;  // from dark on the left to light on the right, both out of the range in the first channel
    mesh.channels = 4, mesh.width = 16, mesh.height = 3, mesh.peak = 200;
    mesh.positions = {0, 0, 16, 0, 16, 3, 0, 3};
    mesh.faces = {{0, 1, 2}, {0, 2, 3}};
    for (const bool is_light : {false, true, true, false}) {
        const std::array<float, 4> dark = {-50, 20, 0, -10}, light = {300, 150, 200, 240};
        mesh.colors.insert(mesh.colors.end(), (is_light ? light : dark).begin(), (is_light ? light : dark).end());
    }
    RenderOptions options{32, 6};
    options.interpolation = RenderOptions::Interpolation::linear;
    const Image<float, 4> image = drawn<4>(mesh.view(), options);
    const auto decoded = [](double share) { return share <= 0.04045 ? share / 12.92 : std::pow((share + 0.055) / 1.055, 2.4); };
    const auto encoded = [](double l) { return l <= 0.0031308 ? 12.92 * l : 1.055 * std::pow(l, 1 / 2.4) - 0.055; };
    const double low[4] = {0, 0.1, 0, 0}, high[4] = {1, 0.75, 1, 1};
    for (int j = 0; j < 6; ++j)
        for (int i = 0; i < 32; ++i)
            for (int k = 0; k < 4; ++k) {
                const double right = (i + 0.5) / 32;
                const double expected = k == 3 ? low[k] + right * (high[k] - low[k])
                                               : encoded(decoded(low[k]) + right * (decoded(high[k]) - decoded(low[k])));
                CHECK(static_cast<double>(image.pixel(i, j)[k]) == doctest::Approx(200 * expected).epsilon(1e-5));
            }
    mesh.premultiplied = true;
    const hmesh::RenderResult<4> refused = hmesh::render<4>(mesh.view(), options);
    CHECK(refused.status.code == Errc::invalid_argument);
    CHECK(refused.image.size() == 0);
    CHECK(hmesh::render<4>(mesh.view()).status);
}

TEST_CASE("psnr is 10 log10(peak^2 / MSE) with the mean over pixels and channels") {
    const std::vector<std::uint8_t> reference = {10, 20, 30, 40, 50, 60}, other = {10, 20, 33, 40, 54, 60};
    const ImageView<std::uint8_t, 3> a{reference.data(), 2, 1, 0}, b{other.data(), 2, 1, 0};
    CHECK(hmesh::psnr(a, b) == doctest::Approx(10 * std::log10(255.0 * 255.0 * 6 / 25)).epsilon(1e-14));
    const std::vector<float> drawn_samples = {10, 20, 30.5F, 40, 50, 60};
    CHECK(hmesh::psnr(a, ImageView<float, 3>{drawn_samples.data(), 2, 1, 0}) ==
          doctest::Approx(10 * std::log10(255.0 * 255.0 * 6 / 0.25)).epsilon(1e-14));
    const std::vector<std::uint16_t> deep = {0, 65535}, deep_other = {1, 65535};
    CHECK(
        hmesh::psnr(ImageView<std::uint16_t, 1>{deep.data(), 1, 2, 0}, ImageView<std::uint16_t, 1>{deep_other.data(), 1, 2, 0}) ==
        doctest::Approx(20 * std::log10(65535.0) + 10 * std::log10(2.0)).epsilon(1e-14));
    const std::vector<float> zero = {0}, half = {0.5F};
    CHECK(hmesh::psnr(ImageView<float, 1>{zero.data(), 1, 1, 0}, ImageView<float, 1>{half.data(), 1, 1, 0}) ==
          doctest::Approx(10 * std::log10(4.0)).epsilon(1e-14));
}

TEST_CASE("psnr reads rows by their stride") {
    const std::vector<std::uint8_t> padded = {1, 2, 99, 3, 4, 99}, packed = {3, 4, 1, 2};
    const ImageView<std::uint8_t, 1> upside_down{padded.data() + 3, 2, 2, -3};
    CHECK(std::isinf(hmesh::psnr(upside_down, ImageView<std::uint8_t, 1>{packed.data(), 2, 2, 0})));
}

TEST_CASE("psnr is infinite for equal images and NaN for images that cannot be compared") {
    const std::vector<std::uint8_t> samples(12, 9);
    const ImageView<std::uint8_t, 1> a{samples.data(), 4, 3, 0}, lower{samples.data(), 4, 2, 0},
        narrower{samples.data(), 3, 3, 0}, nothing{};
    CHECK(hmesh::psnr(a, a) == std::numeric_limits<double>::infinity());
    CHECK(std::isnan(hmesh::psnr(a, lower)));
    CHECK(std::isnan(hmesh::psnr(a, narrower)));
    CHECK(std::isnan(hmesh::psnr(nothing, nothing)));
    const std::vector<float> nan(12, std::numeric_limits<float>::quiet_NaN());
    CHECK(std::isnan(hmesh::psnr(a, ImageView<float, 1>{nan.data(), 4, 3, 0})));
}

TEST_CASE("to_pixels rounds to nearest and holds to the type's range") {
    Image<float, 2> image(2, 2);
    const float samples[] = {-3, 0.4F, 0.5F, 254.4F, 254.6F, 255, 256, 1e9F};
    std::copy(std::begin(samples), std::end(samples), image.data());
    const Image<std::uint8_t, 2> bytes = hmesh::to_pixels<std::uint8_t>(image);
    CHECK(bytes.width() == 2);
    CHECK(bytes.height() == 2);
    CHECK(samples_of(bytes) == std::vector<std::uint8_t>{0, 0, 1, 254, 255, 255, 255, 255});
    CHECK(samples_of(hmesh::to_pixels<std::uint16_t>(image)) == std::vector<std::uint16_t>{0, 0, 1, 254, 255, 255, 256, 65535});
    CHECK(samples_of(hmesh::to_pixels<float>(image)) == samples_of(image));
}
