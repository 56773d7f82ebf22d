#include "hmesh/methods/annealed/seams.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "hmesh/core/random.hpp"
#include "test_executors.hpp"
#include "test_images.hpp"

using hmesh::Image;
using hmesh::PixelTraits;
using hmesh::kit::Color;
using hmesh::kit::ImageSource;
using hmesh::kit::Seam;
using hmesh::kit::seam_colors;
using hmesh::kit::seam_lines;
using hmesh::kit::seam_nodes;
using hmesh::kit::SeamLine;
using hmesh::kit::detail::SeamCurve;

namespace {

constexpr auto go_on = [] { return true; };

// Channel c of the pixel row j of a seam: the mean of both sides, pixels outside being the nearest inside.
template <class T, int C>
double row_of(const Image<T, C>& image, const Seam& seam, int j, int c) {
    const auto at = [&](int x, int y) {
        return PixelTraits<T>::to_real(image.pixel(std::clamp(x, 0, image.width() - 1), std::clamp(y, 0, image.height() - 1))[c]);
    };
    return seam.vertical ? 0.5 * (at(seam.x - 1, seam.y + j) + at(seam.x, seam.y + j))
                         : 0.5 * (at(seam.x + j, seam.y - 1) + at(seam.x + j, seam.y));
}
template <class T, int C>
double value_of(const Image<T, C>& image, const Seam& seam, int j, int c) {
    return 0.5 * (row_of(image, seam, j - 1, c) + row_of(image, seam, j, c));
}

template <class T, int C>
double brute_error(const Image<T, C>& image, const Seam& seam, int a, int b) {
    double sum = 0;
    for (int c = 0; c < C; ++c) {
        const double from = value_of(image, seam, a, c), to = value_of(image, seam, b, c);
        for (int j = a; j < b; ++j) {
            const double t = (j + 0.5 - a) / (b - a);
            sum += std::pow((1 - t) * from + t * to - row_of(image, seam, j, c), 2);
        }
    }
    return sum;
}

// Seams of every kind in an image of at least 3 x 3 px: along its middle, beside its border, in its corner, of 1 px.
std::vector<Seam> seams_of(int width, int height) {
    return {{width / 2, 0, height, true},      {0, height / 2, width, false},    {1, 1, height - 1, true},
            {1, height - 1, width - 2, false}, {width - 1, height - 1, 1, true}, {2, 1, 1, false}};
}

template <class T, int C>
void check_errors(const Image<T, C>& image) {
    const ImageSource<C> source(image.view());
    for (const Seam& seam : seams_of(image.width(), image.height())) {
        const SeamCurve<C> curve(source, seam);
        REQUIRE(curve.length() == seam.length);
        double scale = 0;
        for (int j = 0; j <= seam.length; ++j)
            for (int c = 0; c < C; ++c) {
                REQUIRE(curve.value(j)[c] == doctest::Approx(value_of(image, seam, j, c)).epsilon(1e-12));
                scale += std::pow(row_of(image, seam, j, c), 2);
            }
        for (int a = 0; a < seam.length; ++a)
            for (int b = a + 1; b <= seam.length; ++b)
                REQUIRE(std::abs(curve.error(a, b) - brute_error(image, seam, a, b)) <= 1e-11 * scale);
    }
}

// Error and price of a choice of nodes; infinite where the next is out of reach.
template <int C>
double cost_of(const SeamCurve<C>& curve, const std::vector<int>& nodes, int reach, double price) {
    double sum = price * static_cast<double>(nodes.size());
    int last = 0;
    for (std::size_t k = 0; k <= nodes.size(); ++k) {
        const int next = k < nodes.size() ? nodes[k] : curve.length();
        if (next - last > reach) return std::numeric_limits<double>::infinity();
        sum += curve.error(last, next);
        last = next;
    }
    return sum;
}

template <class T, int C>
void check_optimum(const Image<T, C>& image, const Seam& seam) {
    const ImageSource<C> source(image.view());
    const SeamCurve<C> curve(source, seam);
    const double whole = curve.error(0, seam.length);
    for (const int step : {1, 2, 3, 5})
        for (const int reach : {step, step + 1, 3 * step, 1000})
            for (const double price : {0.0, 1e-4 * whole, 0.01 * whole, 0.1 * whole, 10 * whole}) {
                CAPTURE(step);
                CAPTURE(reach);
                CAPTURE(price);
                std::vector<int> places;
                for (int place = step; place < seam.length; place += step) places.push_back(place);
                REQUIRE(places.size() < 14);
                double best = std::numeric_limits<double>::infinity();
                for (unsigned subset = 0; subset < 1U << places.size(); ++subset) {
                    std::vector<int> nodes;
                    for (std::size_t k = 0; k < places.size(); ++k)
                        if ((subset >> k & 1U) != 0) nodes.push_back(places[k]);
                    best = std::min(best, cost_of(curve, nodes, reach, price));
                }
                const std::vector<int> nodes = seam_nodes(curve, step, reach, price);
                for (const int node : nodes) REQUIRE(std::count(places.begin(), places.end(), node) == 1);
                REQUIRE(std::is_sorted(nodes.begin(), nodes.end()));
                REQUIRE(cost_of(curve, nodes, reach, price) <= best + 1e-9 * (whole + best));
            }
}

template <class T, int C>
void check_colors(const Image<T, C>& image, const Seam& seam, const std::vector<int>& nodes) {
    const ImageSource<C> source(image.view());
    const SeamCurve<C> curve(source, seam);
    const std::vector<Color<C>> colors = seam_colors(curve, nodes);
    REQUIRE(colors.size() == nodes.size());
    if (nodes.empty()) return;
    std::vector<int> knots = nodes;
    knots.insert(knots.begin(), 0);
    knots.push_back(seam.length);
    Eigen::MatrixXd hats = Eigen::MatrixXd::Zero(seam.length, static_cast<Eigen::Index>(knots.size()));
    for (std::size_t k = 0; k + 1 < knots.size(); ++k)
        for (int j = knots[k]; j < knots[k + 1]; ++j) {
            const double t = (j + 0.5 - knots[k]) / (knots[k + 1] - knots[k]);
            hats(j, static_cast<Eigen::Index>(k)) = 1 - t;
            hats(j, static_cast<Eigen::Index>(k) + 1) = t;
        }
    const auto n = static_cast<Eigen::Index>(nodes.size());
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> solver(hats.middleCols(1, n));
    for (int c = 0; c < C; ++c) {
        Eigen::VectorXd rows(seam.length);
        for (int j = 0; j < seam.length; ++j) rows(j) = row_of(image, seam, j, c);
        rows -= hats.col(0) * value_of(image, seam, 0, c) + hats.col(n + 1) * value_of(image, seam, seam.length, c);
        const Eigen::VectorXd solution = solver.solve(rows);
        for (Eigen::Index k = 0; k < n; ++k)
            REQUIRE(std::abs(colors[static_cast<std::size_t>(k)][c] - solution(k)) <= 1e-9 * PixelTraits<T>::peak);
    }
    for (const Color<C>& color : colors)
        for (int k = C; k < hmesh::kit::lanes_for(C + 1); ++k) REQUIRE(color[k] == 0);
}

template <int C>
double count_of(const std::vector<SeamLine<C>>& lines) {
    double sum = 0;
    for (const SeamLine<C>& line : lines) sum += static_cast<double>(line.offsets.size());
    return sum;
}

// The seams of a 200 x 160 px image in tiles of 50 x 40 px.
std::vector<Seam> many_seams() {
    std::vector<Seam> seams;
    for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i) {
            if (i > 0) seams.push_back({50 * i, 40 * j, 40, true});
            if (j > 0) seams.push_back({50 * i, 40 * j, 50, false});
        }
    return seams;
}

}  // namespace

TEST_CASE("the error of a stretch of a seam is that of its pixel rows, down and to the right, at borders, of 1 px") {
    check_errors(hmesh_test::noise<std::uint8_t, 3>(23, 19, 1));
    check_errors(hmesh_test::scene<std::uint16_t, 1>(31, 27, 2));
    check_errors(hmesh_test::noise<float, 4>(14, 17, 3));
    check_errors(hmesh_test::noise<std::uint8_t, 1>(3, 3, 4));
}

TEST_CASE("the nodes of a seam are the best of all choices at any price, on multiples of the step and within reach") {
    const auto bytes = hmesh_test::noise<std::uint8_t, 3>(20, 20, 1);
    const auto words = hmesh_test::scene<std::uint16_t, 1>(20, 20, 2);
    for (const int length : {1, 2, 3, 7, 12}) {
        check_optimum(bytes, {7, 3, length, true});
        check_optimum(bytes, {3, 9, length, false});
        check_optimum(words, {10, 2, length, true});
        check_optimum(words, {2, 10, length, false});
    }
    check_optimum(hmesh_test::scene<float, 2>(13, 13, 3), {6, 0, 13, true});
    check_optimum(hmesh_test::noise<std::uint8_t, 1>(13, 2, 4), {0, 1, 13, false});
}

TEST_CASE("a reach shorter than the step is the step: all places are nodes") {
    const auto image = hmesh_test::noise<std::uint8_t, 1>(20, 20, 1);
    const ImageSource<1> source(image.view());
    CHECK(seam_nodes(SeamCurve<1>(source, {5, 0, 20, true}), 3, 1, 1e9) == std::vector<int>{3, 6, 9, 12, 15, 18});
    CHECK(seam_nodes(SeamCurve<1>(source, {5, 0, 20, true}), 30, 1, 0).empty());
    CHECK(seam_nodes(SeamCurve<1>(source, {5, 0, 20, true}), 20, 20, 0).empty());
}

TEST_CASE("nodes go where the picture has its kinks") {
    const auto image = hmesh_test::draw<float, 1>(64, 40, [](int, int y, int) {
        const double v = y + 0.5;
        return v < 10 ? 0.1 : v < 25 ? 0.1 + 0.05 * (v - 10) : 0.85;
    });
    const ImageSource<1> source(image.view());
    CHECK(seam_nodes(SeamCurve<1>(source, {30, 0, 40, true}), 1, 1000, 1e-3) == std::vector<int>{10, 25});
    CHECK(seam_nodes(SeamCurve<1>(source, {0, 17, 64, false}), 1, 1000, 1e-3).empty());
}

TEST_CASE("the colours of a seam's nodes are the least-squares ones, its ends keeping theirs") {
    hmesh::kit::Random random(1);
    const auto bytes = hmesh_test::noise<std::uint8_t, 3>(40, 40, 1);
    const auto floats = hmesh_test::scene<float, 5>(40, 40, 2);
    for (int k = 0; k < 60; ++k) {
        const int length = 1 + static_cast<int>(random.below(35));
        const Seam seam{1 + static_cast<int>(random.below(5)), 1 + static_cast<int>(random.below(5)), length,
                        random.below(2) == 0};
        std::vector<int> nodes;
        for (int node = 1; node < length; ++node)
            if (k % 4 == 0 || random.below(4) == 0) nodes.push_back(node);
        check_colors(bytes, seam, nodes);
        check_colors(floats, seam, nodes);
    }
}

TEST_CASE("all seams together get about the number of nodes asked for, at one price") {
    const std::vector<Seam> seams = many_seams();
    for (const std::uint64_t seed : {1U, 2U}) {
        const auto image = hmesh_test::scene<std::uint8_t, 3>(200, 160, seed);
        const ImageSource<3> source(image.view());
        for (const double count : {50.0, 100.0, 200.0, 400.0}) {
            CAPTURE(count);
            const auto lines = seam_lines(source, seams, count, 1, 1000, go_on);
            REQUIRE(lines.size() == seams.size());
            CHECK(count_of(lines) >= 0.85 * count);
            CHECK(count_of(lines) <= 1.15 * count);
            // One price: no seam gains more by a node more than another loses by a node less. The first is at most the
            // price, the second at least.
            double gain = 0, loss = std::numeric_limits<double>::infinity();
            for (std::size_t k = 0; k < seams.size(); ++k) {
                const SeamCurve<3> curve(source, seams[k]);
                const std::vector<int>& nodes = lines[k].offsets;
                const double now = cost_of(curve, nodes, 1000, 0);
                for (int node = 1; node < seams[k].length; ++node) {
                    std::vector<int> other = nodes;
                    const auto at = std::lower_bound(other.begin(), other.end(), node);
                    if (at != other.end() && *at == node) {
                        other.erase(at);
                        loss = std::min(loss, cost_of(curve, other, 1000, 0) - now);
                    } else {
                        other.insert(at, node);
                        gain = std::max(gain, now - cost_of(curve, other, 1000, 0));
                    }
                }
                const std::vector<Color<3>> colors = seam_colors(curve, nodes);
                REQUIRE(colors.size() == lines[k].colors.size());
                for (std::size_t m = 0; m < colors.size(); ++m)
                    for (int c = 0; c < 3; ++c) REQUIRE(colors[m][c] == lines[k].colors[m][c]);
            }
            CHECK(gain <= loss * (1 + 1e-9));
        }
    }
}

TEST_CASE("nodes are on the step and within reach on pictures without error too, and none is no problem") {
    const std::vector<Seam> seams = many_seams();
    const auto image = hmesh_test::constant_image<std::uint8_t, 1>(200, 160, 0.3);
    const ImageSource<1> source(image.view());
    for (const double count : {0.0, 1.0, 30.0, 1e6}) {
        const auto lines = seam_lines(source, seams, count, 3, 15, go_on);
        for (std::size_t k = 0; k < seams.size(); ++k) {
            int last = 0;
            for (const int node : lines[k].offsets) {
                REQUIRE(node % 3 == 0);
                REQUIRE(node - last <= 15);
                last = node;
            }
            REQUIRE(last < seams[k].length);
            REQUIRE(seams[k].length - last <= 15);
            for (const Color<1>& color : lines[k].colors) REQUIRE(color[0] == doctest::Approx(*image.pixel(0, 0)));
        }
    }
    CHECK(seam_lines(source, {}, 10, 1, 5, go_on).empty());
}

TEST_CASE("nodes are the same whatever the executor's order; seams that come after a stop get none") {
    const std::vector<Seam> seams = many_seams();
    const auto image = hmesh_test::scene<std::uint8_t, 3>(200, 160, 3);
    const ImageSource<3> source(image.view());
    const auto serial = seam_lines(source, seams, 150, 1, 100, go_on);
    const auto reversed = seam_lines(source, seams, 150, 1, 100, go_on, hmesh_test::ReverseFor{});
    const auto shuffled = seam_lines(source, seams, 150, 1, 100, go_on, hmesh_test::ShuffledFor{5});
    for (const auto* other : {&reversed, &shuffled})
        for (std::size_t k = 0; k < seams.size(); ++k) {
            REQUIRE(other->at(k).offsets == serial[k].offsets);
            for (std::size_t m = 0; m < serial[k].colors.size(); ++m)
                for (int c = 0; c < 3; ++c) REQUIRE(other->at(k).colors[m][c] == serial[k].colors[m][c]);
        }
    const auto stopped = seam_lines(source, seams, 150, 1, 100, [] { return false; });
    CHECK(stopped.size() == seams.size());
    CHECK(count_of(stopped) == 0);
    for (const auto& line : stopped) CHECK(line.colors.empty());
}
