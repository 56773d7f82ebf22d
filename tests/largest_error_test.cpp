#include "hmesh/fit/largest_error.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hmesh/core/random.hpp"
#include "hmesh/fit/image_mesh.hpp"
#include "hmesh/fit/image_source.hpp"
#include "hmesh/fit/rendered_error.hpp"
#include "hmesh/mesh/delaunay.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "test_executors.hpp"
#include "test_images.hpp"
#include "test_sanitized.hpp"

using hmesh::Image;
using hmesh::Samples;
using hmesh::kit::Color;
using hmesh::kit::Delaunay;
using hmesh::kit::ImageMesh;
using hmesh::kit::ImageSource;

namespace {

// A random mesh of whole colours on an image, whose largest error is compared with that of the mesh's arrays, pixel by pixel.
template <class T, int C>
void prove(const Image<T, C>& image, Samples samples, const Image<float, 1>& weights, std::uint64_t seed) {
    CAPTURE(seed);
    const int width = image.width(), height = image.height();
    const hmesh::ImageView<float, 1> counted = weights.size() > 0 ? weights.view() : hmesh::ImageView<float, 1>();
    const auto source = ImageSource<C>(image.view(), counted, 1).with_samples(samples);
    const auto table = source.table({0, 0, width, height});
    hmesh::kit::Random random(seed);
    Delaunay delaunay(width, height, samples);
    const double low = hmesh::kit::inset(samples);
    const auto place = [&](int size) {
        return std::min(size - low, low + static_cast<double>(random.below(256 * static_cast<std::size_t>(size))) / 256);
    };
    for (std::size_t k = 0; k < 5 * seed; ++k) delaunay.insert({place(width), place(height)});
    std::vector<Color<C>> colors;
    for (const hmesh::kit::Vertex v : delaunay.topology().vertices()) {
        const auto p = delaunay.position(v);
        colors.push_back(source.pixel(static_cast<int>(p.x), static_cast<int>(p.y)));
    }
    ImageMesh<C> mesh(table, source.low(), source.high());
    REQUIRE(mesh.assign(delaunay.positions(), delaunay.topology().triangles(), colors));
    const hmesh::Mesh arrays = to_mesh(mesh, 255);
    CHECK(arrays.samples == samples);
    CHECK(arrays.positions.front() == 0);
    const hmesh::kit::RenderedError errors = hmesh::kit::rendered_errors(arrays, image.view(), counted, 1);
    CHECK(largest_error(mesh) == doctest::Approx(errors.largest).epsilon(1e-9));
    CHECK(errors.largest > 0);
    CHECK(std::abs(mesh.energy() - errors.energy) <= 1e-6 * errors.energy);
}

}  // namespace

TEST_CASE("the largest error is that of a look at all pixels, with weights and for points too") {
    const Image<float, 1> none;
    for (std::uint64_t seed = 1; seed <= 20; ++seed)
        for (const Samples samples : {Samples::squares, Samples::points}) {
            prove(hmesh_test::noise<std::uint8_t, 3>(40, 31, seed), samples, none, seed);
            prove(hmesh_test::scene<std::uint16_t, 1>(33, 40, seed), samples, none, seed);
            prove(hmesh_test::scene<std::uint8_t, 4>(20, 21, seed), samples, none, seed);
            prove(hmesh_test::noise<std::uint8_t, 1>(30, 31, seed), samples, hmesh_test::random_weights(30, 31, seed), seed);
        }
}

TEST_CASE("a pixel of weight 0 does not count, one of a small weight does") {
    Image<std::uint8_t, 1> image(8, 8);
    *image.pixel(3, 4) = 200, *image.pixel(6, 2) = 90;
    Image<float, 1> weights(8, 8);
    std::fill_n(weights.data(), 64, 1.0F);
    const auto error = [&](float weight) {
        *weights.pixel(3, 4) = weight;
        const ImageSource<1> source(image.view(), weights.view(), 1);
        const auto table = source.table({0, 0, 8, 8});
        ImageMesh<1> mesh(table, 0, 255);
        REQUIRE(mesh.assign({{0, 0}, {8, 0}, {8, 8}, {0, 8}}, {{0, 1, 2}, {0, 2, 3}}));
        return largest_error(mesh);
    };
    CHECK(error(0) == doctest::Approx(90));
    CHECK(error(0.01F) == doctest::Approx(200));
}

TEST_CASE("pixels are seen whose difference is less than what rounding takes of sums of 16 bits") {
    constexpr int width = 1500, height = 1300;
    for (std::uint64_t seed = 1; seed <= 12; seed += hmesh_test::stride_if_sanitized(4)) {
        CAPTURE(seed);
        hmesh::kit::Random random(seed);
        const auto level = static_cast<std::uint16_t>(65535 - random.below(2000));
        Image<std::uint16_t, 3> image(width, height);
        std::fill_n(image.data(), image.size(), level);
        // One by 2 in the lower face, one by 3 in the upper one.
        *image.pixel(static_cast<int>(random.below(100)), height - 2) = static_cast<std::uint16_t>(level - 2);
        *image.pixel(width - 100 + static_cast<int>(random.below(99)), 1) = static_cast<std::uint16_t>(level - 3);
        const ImageSource<3> source(image.view());
        const auto table = source.table({0, 0, width, height});
        ImageMesh<3> mesh(table, 0, 65535);
        REQUIRE(mesh.assign({{0, 0}, {width, 0}, {width, height}, {0, height}}, {{0, 1, 2}, {0, 2, 3}}));
        CHECK(largest_error(mesh) == doctest::Approx(3).epsilon(1e-9));
    }
}

TEST_CASE("the largest error is the same to the bit on any executor, in whatever piece of faces it lies") {
    constexpr int columns = 60, rows = 40, width = 2 * columns, height = 2 * rows;
    std::vector<std::size_t> pieces;
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        CAPTURE(seed);
        hmesh::kit::Random random(seed);
        Image<std::uint8_t, 1> image = hmesh_test::noise<std::uint8_t, 1>(width, height, seed);
        for (std::size_t k = 0; k < image.size(); ++k) image.data()[k] /= 8;
        // The cell with the faces of most energy, and the pixel with the largest difference in another one.
        const int place = static_cast<int>(random.below(columns * rows)), other = (place + 1) % (columns * rows);
        for (const int dy : {0, 1})
            for (const int dx : {0, 1}) *image.pixel(2 * (other % columns) + dx, 2 * (other / columns) + dy) = 200;
        *image.pixel(2 * (place % columns), 2 * (place / columns)) = 255;
        const ImageSource<1> source(image.view());
        const auto table = source.table({0, 0, width, height});
        std::vector<hmesh::kit::Point> points;
        std::vector<hmesh::Triangle> triangles;
        for (int y = 0; y <= rows; ++y)
            for (int x = 0; x <= columns; ++x) points.push_back({2.0 * x, 2.0 * y});
        for (std::uint32_t y = 0; y < rows; ++y)
            for (std::uint32_t x = 0; x < columns; ++x) {
                const std::uint32_t a = y * (columns + 1) + x, b = a + columns + 1;
                triangles.push_back({a, a + 1, b + 1});
                triangles.push_back({a, b + 1, b});
            }
        ImageMesh<1> mesh(table, 0, 255);
        REQUIRE(mesh.assign(points, triangles, std::vector<Color<1>>(points.size(), Color<1>::zero())));
        const double expected = largest_error(mesh);
        CHECK(expected == 255);
        CHECK(largest_error(mesh, hmesh_test::ReverseFor{}) == expected);
        CHECK(largest_error(mesh, hmesh_test::ShuffledFor{seed}) == expected);
        CHECK(largest_error(mesh, hmesh_test::ThreadFor{3}) == expected);
        const auto counted = [&](std::size_t n, hmesh::Piece piece) {
            pieces.push_back(n);
            for (std::size_t k = 0; k < n; ++k) piece(k);
        };
        CHECK(largest_error(mesh, counted) == expected);
        CHECK(pieces.back() == (2 * columns * rows + 1023) / 1024);
    }
}
