#include "hmesh/solve/linear_light.hpp"

#include <doctest/doctest.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "hmesh/core/random.hpp"
#include "hmesh/render.hpp"
#include "test_executors.hpp"
#include "test_images.hpp"

using hmesh::Errc;
using hmesh::Image;
using hmesh::LinearLightOptions;
using hmesh::LinearLightReport;
using hmesh::Mesh;
using hmesh::PixelTraits;

namespace {

// IEC 61966-2-1 as it is printed there.
double decoded(double share) { return share <= 0.04045 ? share / 12.92 : std::pow((share + 0.055) / 1.055, 2.4); }
double encoded(double light) { return light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055; }

// A grid of cells of about `cell` px whose inner vertices are off their places, in the image's colours there, on no grid.
template <class T, int C>
Mesh jittered(const Image<T, C>& image, int cell, std::uint64_t seed) {
    hmesh::kit::Random random(seed);
    const int columns = image.width() / cell, rows = image.height() / cell;
    Mesh mesh;
    mesh.channels = C, mesh.width = image.width(), mesh.height = image.height(), mesh.peak = PixelTraits<T>::peak;
    for (int j = 0; j <= rows; ++j)
        for (int i = 0; i <= columns; ++i) {
            const auto place = [&](int index, int count, int size) {
                const double at = static_cast<double>(index) * size / count;
                return index == 0 || index == count ? at : std::round((at + 0.4 * cell * (random.uniform() - 0.5)) * 256) / 256;
            };
            const double x = place(i, columns, mesh.width), y = place(j, rows, mesh.height);
            mesh.positions.insert(mesh.positions.end(), {static_cast<float>(x), static_cast<float>(y)});
            const T* pixel =
                image.pixel(std::min(mesh.width - 1, static_cast<int>(x)), std::min(mesh.height - 1, static_cast<int>(y)));
            for (int c = 0; c < C; ++c) mesh.colors.push_back(static_cast<float>(PixelTraits<T>::to_real(pixel[c])));
            if (i == 0 || j == 0) continue;
            const auto d = static_cast<std::uint32_t>(j * (columns + 1) + i), b = d - static_cast<std::uint32_t>(columns) - 1;
            mesh.faces.push_back({b - 1, b, d});
            mesh.faces.push_back({b - 1, d, d - 1});
        }
    return mesh;
}

// Dark, bright, and out of the middle of the range in places.
template <class T, int C>
Image<T, C> contrasty(int width, int height, std::uint64_t seed) {
    const hmesh_test::Scene scene(width, height, seed);
    hmesh::kit::Random random(seed);
    return hmesh_test::draw<T, C>(width, height, [&](int x, int y, int c) {
        return std::clamp(1.6 * scene(x, y, c) - 0.35 + 0.1 * (random.uniform() - 0.5), 0.0, 1.0);
    });
}

// The pixels of a mesh, as weights of its vertices: the slow way, by the definition alone.
struct Pixel {
    std::size_t vertex[3];
    double weight[3];
    int x, y;
};
std::vector<Pixel> pixels_of(const Mesh& mesh) {
    std::vector<Pixel> out;
    for (const auto& face : mesh.faces) {
        double x[3], y[3];
        for (std::size_t k = 0; k < 3; ++k) {
            x[k] = static_cast<double>(mesh.positions[2 * face[k]]);
            y[k] = static_cast<double>(mesh.positions[2 * face[k] + 1]);
        }
        const double area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
        for (int j = 0; j < mesh.height; ++j)
            for (int i = 0; i < mesh.width; ++i) {
                Pixel pixel{{face[0], face[1], face[2]}, {}, i, j};
                bool inside = true;
                for (std::size_t k = 0; k < 3; ++k) {
                    const std::size_t a = (k + 1) % 3, b = (k + 2) % 3;
                    const double side = (x[b] - x[a]) * (j + 0.5 - y[a]) - (y[b] - y[a]) * (i + 0.5 - x[a]);
                    const bool owns = y[b] < y[a] || (y[b] == y[a] && x[b] > x[a]);
                    inside = inside && (side > 0 || (side == 0 && owns));
                    pixel.weight[k] = side / area;
                }
                if (inside) out.push_back(pixel);
            }
    }
    return out;
}

bool is_alpha(std::size_t channels, std::size_t k) { return (channels == 2 || channels == 4) && k + 1 == channels; }

// The error of channel k for these lights, times `weights` if there are some.
template <class T, int C>
double error_of(const Image<T, C>& image, const std::vector<Pixel>& pixels, const std::vector<double>& light, std::size_t k,
                const Image<float, 1>* weights = nullptr) {
    double sum = 0;
    for (const Pixel& p : pixels) {
        double value = 0;
        for (std::size_t i = 0; i < 3; ++i) value += p.weight[i] * light[p.vertex[i]];
        const double shown = (is_alpha(C, k) ? value : encoded(value)) * PixelTraits<T>::peak;
        const double difference = shown - PixelTraits<T>::to_real(image.pixel(p.x, p.y)[k]);
        sum += (weights != nullptr ? static_cast<double>(*weights->pixel(p.x, p.y)) : 1) * difference * difference;
    }
    return sum;
}

std::vector<double> lights_of(const Mesh& mesh, std::size_t k) {
    const auto channels = static_cast<std::size_t>(mesh.channels);
    std::vector<double> out;
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
        const double share = std::clamp(static_cast<double>(mesh.colors[channels * v + k]) / mesh.peak, 0.0, 1.0);
        out.push_back(is_alpha(channels, k) ? share : decoded(share));
    }
    return out;
}

template <class T, int C>
double error_of(const Image<T, C>& image, const Mesh& mesh, const Image<float, 1>* weights = nullptr) {
    const std::vector<Pixel> pixels = pixels_of(mesh);
    double sum = 0;
    for (std::size_t k = 0; k < C; ++k) sum += error_of(image, pixels, lights_of(mesh, k), k, weights);
    return sum;
}

LinearLightOptions to_the_end() {
    LinearLightOptions options;
    options.iterations = 200;
    options.min_gain = 0;
    return options;
}

// No light can be changed by itself, within [0, 1], and lower the error by more than rounding to float explains.
template <class T, int C>
void check_stationary(const Image<T, C>& image, const Mesh& mesh) {
    const std::vector<Pixel> pixels = pixels_of(mesh);
    int inner = 0, at_bounds = 0;
    for (std::size_t k = 0; k < C; ++k) {
        std::vector<double> light = lights_of(mesh, k);
        for (std::size_t v = 0; v < light.size(); ++v) {
            const double here = light[v], h = 1e-5;
            const auto error = [&](double l) {
                light[v] = l;
                const double e = error_of(image, pixels, light, k);
                light[v] = here;
                return e;
            };
            if (here > 2 * h && here < 1 - 2 * h) {
                const double low = error(here - h), middle = error(here), high = error(here + h);
                const double slope = (high - low) / (2 * h), curvature = (high - 2 * middle + low) / (h * h);
                // The minimum is slope / curvature away; as a stored value, less than 1e-3 of the peak.
                CHECK(curvature > 0);
                CHECK(std::abs(slope / curvature) < 1e-3 * here + 1e-5);
                ++inner;
            } else {
                if (here <= 2 * h) CHECK(error(2 * h) >= error(0) * (1 - 1e-6));
                else CHECK(error(1 - 2 * h) >= error(1) * (1 - 1e-6));
                ++at_bounds;
            }
        }
    }
    CHECK(inner > 20);
    CHECK(at_bounds > 0);
}

template <class T, int C>
double rendered_error(const Image<T, C>& image, const Mesh& mesh) {
    hmesh::RenderOptions options;
    options.interpolation = hmesh::RenderOptions::Interpolation::linear;
    const hmesh::RenderResult<C> drawn = hmesh::render<C>(mesh.view(), options);
    REQUIRE(drawn.status);
    double energy = 0;
    for (std::size_t i = 0; i < drawn.image.size(); ++i) {
        const double difference = static_cast<double>(drawn.image.data()[i]) - PixelTraits<T>::to_real(image.data()[i]);
        energy += difference * difference;
    }
    return energy;
}

template <class T, int C>
void check_fit(std::uint64_t seed, double grid) {
    CAPTURE(C);
    const Image<T, C> image = contrasty<T, C>(32, 28, seed);
    const Mesh before = jittered(image, 4, seed);
    Mesh mesh = before;
    LinearLightOptions options;
    options.grid = grid;
    const LinearLightReport report = fit_linear_light(mesh, image.view(), options);
    REQUIRE(report.status);
    CHECK(report.converted == doctest::Approx(error_of(image, before)).epsilon(1e-6));
    CHECK(report.energy == doctest::Approx(error_of(image, mesh)).epsilon(1e-6));
    CHECK(report.energy == doctest::Approx(rendered_error(image, mesh)).epsilon(1e-6));
    const double peak = PixelTraits<T>::peak;
    CHECK(report.psnr == doctest::Approx(10 * std::log10(peak * peak * 32 * 28 * C / report.energy)).epsilon(1e-12));
    CHECK(report.energy < 0.9 * report.converted);
    CHECK(report.iterations >= 1);
    CHECK(report.iterations <= 6);
    CHECK(report.residual < 1e-5);
    for (const float color : mesh.colors) {
        const auto value = static_cast<double>(color);
        const bool may_be = value >= 0 && value <= mesh.peak && (grid == 0 || std::floor(value / grid) * grid == value);
        CHECK(may_be);
    }
    CHECK(mesh.positions == before.positions);
}

}  // namespace

TEST_CASE("the error reported is that of the pixels by the definition and as drawn, and colours are in range and on the grid") {
    check_fit<std::uint8_t, 1>(1, 1);
    check_fit<std::uint8_t, 3>(2, 1);
    check_fit<std::uint8_t, 4>(3, 0);
    check_fit<float, 2>(4, 0);
    check_fit<std::uint16_t, 1>(5, 1);
}

TEST_CASE("at the result the finite differences of the true error vanish, or point out of the range") {
    const auto grey = contrasty<std::uint8_t, 1>(26, 24, 7);
    Mesh mesh = jittered(grey, 4, 7);
    REQUIRE(fit_linear_light(mesh, grey.view(), to_the_end()).status);
    check_stationary(grey, mesh);
    const auto sprite = contrasty<float, 2>(26, 24, 8);
    Mesh other = jittered(sprite, 4, 8);
    REQUIRE(fit_linear_light(other, sprite.view(), to_the_end()).status);
    check_stationary(sprite, other);
}

TEST_CASE("the first step is that of a dense Gauss-Newton solve, where a ridge counts as so many pixels of a vertex's colour") {
    // Well inside the range and near the optimum, so that nothing is cut off or halved.
    const auto image =
        hmesh_test::draw<float, 1>(24, 20, [](int x, int y, int) { return 0.4 + 0.01 * x + 0.2 * std::sin(0.3 * y); });
    const Mesh before = jittered(image, 4, 9);
    const std::vector<double> light = lights_of(before, 0);
    const auto slope_at = [](double value) { return (encoded(value + 1e-6) - encoded(value - 1e-6)) / 2e-6; };
    const auto n = static_cast<Eigen::Index>(light.size());
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd rhs = Eigen::VectorXd::Zero(n);
    for (const Pixel& p : pixels_of(before)) {
        double value = 0;
        Eigen::VectorXd row = Eigen::VectorXd::Zero(n);
        for (std::size_t i = 0; i < 3; ++i) value += p.weight[i] * light[p.vertex[i]];
        const double slope = slope_at(value);
        for (std::size_t i = 0; i < 3; ++i) row(static_cast<Eigen::Index>(p.vertex[i])) += slope * p.weight[i];
        matrix += row * row.transpose();
        rhs -= row * (encoded(value) - static_cast<double>(*image.pixel(p.x, p.y)));
    }
    for (const double ridge : {0.0, 3.0}) {
        CAPTURE(ridge);
        Mesh mesh = before;
        LinearLightOptions options;
        options.iterations = 1;
        options.ridge = ridge;
        REQUIRE(fit_linear_light(mesh, image.view(), options).iterations == 1);
        Eigen::MatrixXd held = matrix;
        for (std::size_t v = 0; v < light.size(); ++v)
            held(static_cast<Eigen::Index>(v), static_cast<Eigen::Index>(v)) += ridge * slope_at(light[v]) * slope_at(light[v]);
        const Eigen::VectorXd step = held.ldlt().solve(rhs);
        for (std::size_t v = 0; v < light.size(); ++v)
            CHECK(lights_of(mesh, 0)[v] == doctest::Approx(light[v] + step(static_cast<Eigen::Index>(v))).epsilon(1e-5));
    }
}

TEST_CASE("the error never rises against conversion, however coarse the grid") {
    for (const double grid : {0.0, 1.0, 16.0, 51.0})
        for (std::uint64_t seed = 1; seed <= 4; ++seed) {
            const auto image =
                seed % 2 == 0 ? hmesh_test::noise<std::uint8_t, 1>(20, 20, seed) : contrasty<std::uint8_t, 1>(20, 20, seed);
            Mesh mesh = jittered(image, seed < 3 ? 2 : 5, seed);
            LinearLightOptions options;
            options.grid = grid;
            const LinearLightReport report = fit_linear_light(mesh, image.view(), options);
            CHECK(report.energy <= report.converted);
            CHECK(report.energy == doctest::Approx(rendered_error(image, mesh)).epsilon(1e-6));
        }
}

TEST_CASE("a step that goes so far that the error rises is halved until it falls") {
    const auto image = hmesh_test::draw<std::uint8_t, 1>(8, 8, [](int, int, int) { return 0.42; });
    Mesh mesh = jittered(image, 8, 1);
    std::fill(mesh.colors.begin(), mesh.colors.end(), 204.0F);  // from which a step leads to black
    LinearLightOptions options;
    options.iterations = 1;
    LinearLightReport report = fit_linear_light(mesh, image.view(), options);
    CHECK(report.iterations == 1);
    CHECK(report.energy < 0.5 * report.converted);
    options.iterations = 6;
    report = fit_linear_light(mesh, image.view(), options);
    CHECK(report.energy < 1e-3 * report.converted);
}

TEST_CASE("colours that are the best on the grid stay, where a step rounded to it would lose") {
    for (std::uint64_t seed = 1; seed <= 25; ++seed) {
        CAPTURE(seed);
        const auto image = contrasty<std::uint8_t, 1>(8, 8, seed);
        Mesh best = jittered(image, 8, seed);
        double least = std::numeric_limits<double>::max();
        LinearLightOptions options;
        options.grid = 127.5;
        options.iterations = 0;
        for (int k = 0; k < 81; ++k) {
            Mesh mesh = best;
            mesh.colors = {static_cast<float>(k % 3) * 127.5F, static_cast<float>(k / 3 % 3) * 127.5F,
                           static_cast<float>(k / 9 % 3) * 127.5F, static_cast<float>(k / 27 % 3) * 127.5F};
            const double energy = fit_linear_light(mesh, image.view(), options).energy;
            if (energy >= least) continue;
            least = energy;
            best = mesh;
        }
        Mesh fitted = best;
        options.iterations = 6;
        const LinearLightReport report = fit_linear_light(fitted, image.view(), options);
        CHECK(report.iterations > 0);
        CHECK(report.energy == least);
        CHECK(fitted.colors == best.colors);
    }
}

TEST_CASE("weights count each pixel as often as they say") {
    const auto image = contrasty<std::uint8_t, 1>(24, 24, 3);
    auto weights = hmesh_test::random_weights(24, 24, 5);
    // Multiples of the library's step.
    hmesh_test::for_each_sample(weights, [](float& weight) { weight = std::floor(weight) / 64; });
    *weights.pixel(0, 0) = 1;
    Mesh mesh = jittered(image, 4, 3), plain = mesh;
    LinearLightOptions options;
    options.weights = weights.view();
    const LinearLightReport report = fit_linear_light(mesh, image.view(), options);
    CHECK(report.energy == doctest::Approx(error_of(image, mesh, &weights)).epsilon(1e-6));
    double count = 0;
    for (const float weight : hmesh_test::samples_of(weights)) count += static_cast<double>(weight);
    CHECK(report.psnr == doctest::Approx(10 * std::log10(255 * 255 * count / report.energy)).epsilon(1e-12));
    REQUIRE(fit_linear_light(plain, image.view()).status);
    CHECK(error_of(image, mesh, &weights) < 0.98 * error_of(image, plain, &weights));
    CHECK(error_of(image, plain) < 0.98 * error_of(image, mesh));
}

TEST_CASE("faces wider than the pixels that are read at once have the error of them all, with weights too") {
    const auto image = contrasty<std::uint8_t, 2>(280, 70, 6);
    auto weights = hmesh_test::random_weights(280, 70, 5);
    // Multiples of the library's step.
    hmesh_test::for_each_sample(weights, [](float& weight) { weight = std::floor(weight) / 64; });
    *weights.pixel(0, 0) = 1;
    for (const bool is_weighted : {false, true}) {
        CAPTURE(is_weighted);
        const Mesh before = jittered(image, 70, 6);
        Mesh mesh = before;
        LinearLightOptions options;
        if (is_weighted) options.weights = weights.view();
        const LinearLightReport report = fit_linear_light(mesh, image.view(), options);
        const Image<float, 1>* const used = is_weighted ? &weights : nullptr;
        CHECK(report.converted == doctest::Approx(error_of(image, before, used)).epsilon(1e-6));
        CHECK(report.energy == doctest::Approx(error_of(image, mesh, used)).epsilon(1e-6));
    }
}

TEST_CASE("channels count in the report as much as they are said to, and get the colours that they get without") {
    const auto image = contrasty<std::uint8_t, 3>(24, 24, 3);
    const Mesh before = jittered(image, 4, 3);
    LinearLightReport reports[3], weighted;
    Mesh mesh;
    const auto fit = [&](const std::vector<double>& channel_weights) {
        LinearLightOptions options;
        options.channel_weights = channel_weights;
        mesh = before;
        const LinearLightReport report = fit_linear_light(mesh, image.view(), options);
        REQUIRE(report.status);
        return report;
    };
    for (std::size_t k = 0; k < 3; ++k) reports[k] = fit({k == 0 ? 2.0 : 0, k == 1 ? 2.0 : 0, k == 2 ? 2.0 : 0});
    const LinearLightReport plain = fit({});
    const std::vector<float> colors = mesh.colors;
    CHECK(reports[0].energy + reports[1].energy + reports[2].energy == doctest::Approx(plain.energy).epsilon(1e-12));
    weighted = fit({2, 0.5, 1});
    CHECK(mesh.colors == colors);
    const auto mean = [&](double LinearLightReport::*energy) {
        return reports[0].*energy + reports[1].*energy / 4 + reports[2].*energy / 2;
    };
    CHECK(weighted.energy == doctest::Approx(mean(&LinearLightReport::energy)).epsilon(1e-12));
    CHECK(weighted.converted == doctest::Approx(mean(&LinearLightReport::converted)).epsilon(1e-12));
    CHECK(weighted.psnr == doctest::Approx(10 * std::log10(255 * 255 * 24 * 24 * 1.75 / weighted.energy)).epsilon(1e-12));
    CHECK(std::abs(weighted.psnr - plain.psnr) > 0.01);
}

TEST_CASE("constant images stay exact, to the bit") {
    for (const double level : {0.0, 0.01, 0.3, 1.0}) {
        const auto image = hmesh_test::constant_image<std::uint8_t, 3>(12, 9, level);
        const Mesh before = jittered(image, 3, 1);
        Mesh mesh = before;
        const LinearLightReport report = fit_linear_light(mesh, image.view());
        CHECK(report.energy == 0);
        CHECK(report.iterations == 0);
        CHECK(mesh.colors == before.colors);
        CHECK(rendered_error(image, mesh) < 1e-8);
    }
}

TEST_CASE("vertices without pixels keep their colour") {
    const auto image = contrasty<std::uint8_t, 1>(8, 8, 1);
    Mesh mesh;
    mesh.channels = 1, mesh.width = mesh.height = 8, mesh.peak = 255;
    mesh.positions = {0, 0, 8, 0, 8, 8, 0, 8, 0.125F, 0.125F, 0.25F, 0.125F};
    mesh.colors = {100, 100, 100, 100, 37, 38};
    // No face of vertices 0 and 4 holds the centre of a pixel.
    mesh.faces = {{0, 1, 5}, {1, 2, 5}, {5, 2, 3}, {0, 5, 4}, {4, 5, 3}, {0, 4, 3}};
    REQUIRE(fit_linear_light(mesh, image.view()).status);
    CHECK(mesh.colors[0] == 100);
    CHECK(mesh.colors[4] == 37);
    CHECK(mesh.colors[2] != 100);
    CHECK(mesh.colors[5] != 38);
}

TEST_CASE("the same bytes with any executor") {
    const auto image = contrasty<std::uint8_t, 3>(96, 80, 11);
    const Mesh before = jittered(image, 3, 11);
    REQUIRE(before.faces.size() > 1024);  // several pieces of work
    const auto fitted = [&](const hmesh::ParallelFor& parallel_for) {
        Mesh mesh = before;
        const LinearLightReport report = fit_linear_light(mesh, image.view(), LinearLightOptions(), parallel_for);
        mesh.colors.push_back(static_cast<float>(report.energy / 1e6));
        return mesh.colors;
    };
    const std::vector<float> serial = fitted({});
    CHECK(fitted(hmesh_test::ReverseFor()) == serial);
    CHECK(fitted(hmesh_test::ShuffledFor{3}) == serial);
    CHECK(fitted(hmesh_test::ThreadFor{3}) == serial);
}

TEST_CASE("when told to stop, what is reported is true of the mesh") {
    const auto image = contrasty<std::uint8_t, 1>(24, 24, 3);
    for (int after = 0; after < 3; ++after) {
        Mesh mesh = jittered(image, 4, 3);
        int asked = 0;
        double last = -1;
        const auto go_on = [&](double share) {
            CHECK(share > last);
            CHECK(share <= 1);
            last = share;
            return asked++ < after;
        };
        const LinearLightReport report = fit_linear_light(mesh, image.view(), {}, {}, go_on);
        CHECK(report.iterations == after);
        CHECK(report.energy == doctest::Approx(rendered_error(image, mesh)).epsilon(1e-6));
    }
}

TEST_CASE("float images and colours may leave the range: colours are held to it first") {
    const hmesh_test::Scene scene(24, 24, 5);
    Image<float, 1> image(24, 24);
    for (int y = 0; y < 24; ++y)
        for (int x = 0; x < 24; ++x) *image.pixel(x, y) = static_cast<float>(2.4 * scene(x, y, 0) - 0.7);
    const Mesh before = jittered(image, 4, 2);
    Mesh mesh = before;
    const LinearLightReport report = fit_linear_light(mesh, image.view());
    CHECK(report.converted == doctest::Approx(rendered_error(image, before)).epsilon(1e-5));
    CHECK(report.energy == doctest::Approx(rendered_error(image, mesh)).epsilon(1e-5));
    CHECK(report.energy < report.converted);
    for (const float color : mesh.colors) CHECK(std::clamp(color, 0.0F, 1.0F) == color);
}

TEST_CASE("the peak is the mesh's, whatever the samples are: floats up to 256 are fitted as those up to 1") {
    const auto image = contrasty<float, 3>(24, 20, 3);
    Image<float, 3> scaled(24, 20);
    for (int y = 0; y < 20; ++y)
        for (int x = 0; x < 24; ++x)
            for (int k = 0; k < 3; ++k) scaled.pixel(x, y)[k] = 256 * image.pixel(x, y)[k];
    Mesh mesh = jittered(image, 4, 2), other = jittered(scaled, 4, 2);
    other.peak = 256;
    const LinearLightReport report = fit_linear_light(mesh, image.view()), of_scaled = fit_linear_light(other, scaled.view());
    CHECK(report.energy < 0.9 * report.converted);
    CHECK(of_scaled.energy == 65536 * report.energy);
    CHECK(of_scaled.psnr == doctest::Approx(report.psnr));
}

TEST_CASE("a mesh that is not one of the image is refused and left as it was") {
    const auto image = contrasty<std::uint8_t, 4>(12, 12, 3);
    const Mesh good = jittered(image, 3, 3);
    const auto check_refused = [&](const Mesh& bad) {
        Mesh mesh = bad;
        const LinearLightReport report = fit_linear_light(mesh, image.view());
        CHECK(report.status.code == Errc::invalid_argument);
        CHECK(std::strlen(report.status.what) > 15);
        CHECK(mesh.colors == bad.colors);
    };
    Mesh mesh = good;
    REQUIRE(fit_linear_light(mesh, image.view()).status);
    check_refused(Mesh());
    mesh = good, mesh.colors.pop_back();
    check_refused(mesh);
    mesh = good, mesh.positions.pop_back();
    check_refused(mesh);
    mesh = good, mesh.channels = 3;
    check_refused(mesh);
    mesh = good, mesh.width = 11;
    check_refused(mesh);
    mesh = good, mesh.height = 13;
    check_refused(mesh);
    mesh = good, mesh.premultiplied = true;
    check_refused(mesh);
    mesh = good, mesh.positions[7] = 12.5F;
    check_refused(mesh);
    mesh = good, std::swap(mesh.faces[3][0], mesh.faces[3][1]);
    check_refused(mesh);
}

TEST_CASE("images, weights and options that cannot be are refused, and the mesh is left as it was") {
    const auto image = contrasty<float, 3>(12, 12, 3);
    const Mesh good = jittered(image, 3, 3);
    const auto refusal = [&](const hmesh::ImageView<float, 3>& view, const LinearLightOptions& options) {
        Mesh mesh = good;
        const LinearLightReport report = fit_linear_light(mesh, view, options);
        CHECK((report.status ? 0 : std::strlen(report.status.what)) > 15);
        CHECK(mesh.colors == good.colors);
        CHECK(report.energy == 0);
        return report.status.code;
    };
    hmesh::ImageView<float, 3> view = image.view();
    view.data = nullptr;
    CHECK(refusal(view, {}) == Errc::invalid_argument);
    view = image.view(), view.row_stride = 4;
    CHECK(refusal(view, {}) == Errc::invalid_argument);
    Image<float, 3> bad = image;
    bad.pixel(3, 3)[1] = std::numeric_limits<float>::quiet_NaN();
    CHECK(refusal(bad.view(), {}) == Errc::not_finite);

    LinearLightOptions options;
    const Image<float, 1> small(4, 4);
    options.weights = small.view();
    CHECK(refusal(image.view(), options) == Errc::invalid_argument);
    Image<float, 1> weights(12, 12);
    weights.pixel(0, 11)[0] = -1;
    options.weights = weights.view();
    CHECK(refusal(image.view(), options) == Errc::invalid_argument);
    weights.pixel(0, 11)[0] = std::numeric_limits<float>::infinity();
    CHECK(refusal(image.view(), options) == Errc::not_finite);

    options = {}, options.channel_weights = {1, 1};
    CHECK(refusal(image.view(), options) == Errc::invalid_argument);
    options.channel_weights = {0, 0, 0};
    CHECK(refusal(image.view(), options) == Errc::invalid_argument);
    options = {}, options.iterations = -1;
    CHECK(refusal(image.view(), options) == Errc::invalid_argument);
    for (double LinearLightOptions::*const option :
         {&LinearLightOptions::min_gain, &LinearLightOptions::ridge, &LinearLightOptions::grid})
        for (const double value : {-1.0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
            options = {}, options.*option = value;
            CHECK(refusal(image.view(), options) == Errc::invalid_argument);
        }
}
