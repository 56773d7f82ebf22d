#include "hmesh/solve/sampled_colors.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "hmesh/core/random.hpp"
#include "hmesh/fit/image_source.hpp"
#include "test_colors.hpp"
#include "test_executors.hpp"
#include "test_images.hpp"
#include "test_meshes.hpp"

using hmesh::Image;
using hmesh::kit::Color;
using hmesh::kit::ImageSource;
using hmesh::kit::Point;
using hmesh::kit::sampled_color;
using hmesh::kit::Vertex;
using hmesh_test::Subject;

namespace {

template <class T, int C>
Color<C> sample_source(const ImageSource<C>& source, Point p) {
    return sampled_color<C>(source.width(), source.height(), p, [&](int x, int y) { return source.pixel(x, y); });
}

// Samples of integers are exact in tables, those of floats are differences of sums.
template <class T>
double table_rounding(int width) {
    return hmesh::PixelTraits<T>::is_integer ? 0 : 1e-15 * width;
}

template <class T, int C>
void check_samples(const Image<T, C>& image) {
    const int width = image.width(), height = image.height();
    const ImageSource<C> source(image.view());
    const hmesh::kit::MomentTable<C> table(image.view(), image.view().bounds());
    const double peak = hmesh::PixelTraits<T>::peak, slack = table_rounding<T>(width);
    const auto check_at = [&](Point p, double rounding) {
        const Color<C> got = sample_source<T, C>(source, p), from_table = sampled_color(table, p);
        for (int c = 0; c < hmesh::kit::lanes_for(C + 1); ++c) {
            const double expected = c < C ? test::naive_sample(image, p, c) : 0;
            REQUIRE(std::abs(got[c] - expected) <= rounding);
            REQUIRE(std::abs(from_table[c] - got[c]) <= slack);
        }
    };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) check_at({x + 0.5, y + 0.5}, 0);
    // Corners, and sides where a pixel's centre is straight in from them.
    for (const double y : {0.0, static_cast<double>(height)}) {
        for (const double x : {0.0, static_cast<double>(width)}) check_at({x, y}, 0);
        for (int x = 0; x < width; ++x) check_at({x + 0.5, y}, 0);
    }
    for (const double x : {0.0, static_cast<double>(width)})
        for (int y = 0; y < height; ++y) check_at({x, y + 0.5}, 0);
    hmesh::kit::Random random(1);
    for (int k = 0; k < 200; ++k) {
        const Point p{width * random.uniform(), height * random.uniform()};
        check_at(p, 1e-14 * peak);
        check_at({p.x, std::floor(p.y) + 0.5}, 1e-14 * peak);
        check_at({std::floor(p.x) + 0.5, p.y}, 1e-14 * peak);
        check_at({p.x, 0}, 1e-14 * peak);
        check_at({width * 1.0, p.y}, 1e-14 * peak);
    }
}

template <class T, int C>
void check_mesh(const Image<T, C>& image, std::uint64_t seed) {
    Subject<T, C> subject(image, hmesh_test::jittered_grid(image.width(), image.height(), 6, 5, seed));
    hmesh_test::wear(subject.mesh, 60, hmesh::PixelTraits<T>::peak, seed);
    const auto before = hmesh_test::snapshot(subject.mesh);
    hmesh::kit::sample_colors(subject.mesh);
    CHECK_FALSE(hmesh_test::snapshot(subject.mesh) == before);
    hmesh_test::prove(subject);
    for (const Vertex v : subject.mesh.topology().vertices())
        for (int c = 0; c < hmesh::kit::lanes_for(C + 1); ++c)
            REQUIRE(std::abs(subject.mesh.color(v)[c] - (c < C ? test::naive_sample(image, subject.mesh.position(v), c) : 0)) <=
                    1e-13 * hmesh::PixelTraits<T>::peak);
    const auto serial = hmesh_test::snapshot(subject.mesh);
    hmesh::kit::sample_colors(subject.mesh, hmesh_test::ThreadFor{3});
    CHECK(hmesh_test::snapshot(subject.mesh) == serial);
}

}  // namespace

TEST_CASE("a sample is the pixel at its center, bilinear in between, and the nearest beyond the outermost centres") {
    check_samples(hmesh_test::noise<std::uint8_t, 1>(9, 7, 1));
    check_samples(hmesh_test::noise<std::uint8_t, 3>(12, 8, 2));
    check_samples(hmesh_test::noise<std::uint16_t, 2>(7, 9, 3));
    check_samples(hmesh_test::noise<float, 4>(8, 6, 4));
    check_samples(hmesh_test::noise<std::uint8_t, 3>(1, 1, 5));
    check_samples(hmesh_test::noise<std::uint8_t, 2>(1, 9, 6));
    check_samples(hmesh_test::noise<float, 1>(9, 1, 7));
    check_samples(hmesh_test::noise<std::uint16_t, 16>(2, 2, 8));
}

TEST_CASE("a sample asks for pixels of the image alone, and at a centre for no other than its own") {
    hmesh::kit::Random random(9);
    for (const auto& [columns, rows] : {std::pair(1, 1), std::pair(1, 6), std::pair(6, 1), std::pair(5, 4)}) {
        const int width = columns, height = rows;
        for (int k = 0; k < 100; ++k) {
            const bool is_center = k % 2 == 0;
            // Of the others half on the lines through the corners and the middle.
            const auto place = [&](int size) {
                const double at = size * random.uniform();
                return is_center ? std::floor(at) + 0.5 : k % 4 == 1 ? at : static_cast<double>(random.below(3)) * size / 2;
            };
            const double x = place(width), y = place(height);
            (void)sampled_color<1>(width, height, {x, y}, [&](int i, int j) {
                REQUIRE((i >= 0 && i < width && j >= 0 && j < height));
                if (is_center) CHECK((i == static_cast<int>(x) && j == static_cast<int>(y)));
                return Color<1>::zero();
            });
        }
    }
}

TEST_CASE("samples of a linear picture are its values, as far in as the outermost centres") {
    Image<float, 1> image(16, 11);
    for (int y = 0; y < 11; ++y)
        for (int x = 0; x < 16; ++x) *image.pixel(x, y) = static_cast<float>(3 * x - 2 * y + 40);
    const ImageSource<1> source(image.view());
    hmesh::kit::Random random(2);
    for (int k = 0; k < 300; ++k) {
        const Point p{0.5 + 15 * random.uniform(), 0.5 + 10 * random.uniform()};
        CHECK(sample_source<float, 1>(source, p)[0] == doctest::Approx(3 * (p.x - 0.5) - 2 * (p.y - 0.5) + 40).epsilon(1e-12));
    }
}

TEST_CASE("samples of the largest floats are finite and between those around them") {
    hmesh::kit::Random random(3);
    Image<float, 1> image(6, 5);
    const float most = std::numeric_limits<float>::max();
    hmesh_test::for_each_sample(image, [&](float& sample) { sample = random.below(2) == 0 ? most : -most; });
    const ImageSource<1> source(image.view());
    for (int k = 0; k < 300; ++k) {
        const double value = sample_source<float, 1>(source, {6 * random.uniform(), 5 * random.uniform()})[0];
        REQUIRE(std::abs(value) <= static_cast<double>(most));
    }
}

TEST_CASE("a mesh with sampled colours has the energy of its pixels, and knows it") {
    check_mesh(hmesh_test::scene<std::uint8_t, 3>(31, 26, 1), 1);
    check_mesh(hmesh_test::noise<std::uint16_t, 1>(30, 28, 2), 2);
    check_mesh(hmesh_test::scene<float, 4>(26, 30, 3), 3);
    check_mesh(hmesh_test::checkerboard<std::uint8_t, 2>(28, 24, 5), 4);
}

TEST_CASE("sampled over an image with weights, colours are those of the samples, whatever their weights") {
    const auto image = hmesh_test::noise<std::uint8_t, 3>(31, 26, 1);
    const Image<float, 1> weights = hmesh_test::random_weights(31, 26, 2);
    const hmesh::kit::MomentTable<3> table(image.view(), weights.view(), hmesh::kit::weight_unit(weights.view()),
                                           image.view().bounds());
    hmesh::kit::ImageMesh<3> mesh(table, 0, 255);
    const auto grid = hmesh_test::jittered_grid(31, 26, 6, 5, 1);
    REQUIRE(mesh.assign(grid.positions, grid.triangles));
    hmesh::kit::sample_colors(mesh);
    const hmesh::Status status = mesh.check();
    CHECK_MESSAGE(status, status.what);
    for (const Vertex v : mesh.topology().vertices())
        for (int c = 0; c < 3; ++c)
            CHECK(mesh.color(v)[c] == doctest::Approx(test::naive_sample(image, mesh.position(v), c)).epsilon(1e-12));
}
