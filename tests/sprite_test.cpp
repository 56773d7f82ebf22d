#include "hmesh/sprite.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "hmesh/render.hpp"
#include "test_images.hpp"
#include "test_meshing.hpp"
#include "test_results.hpp"
#include "test_weighted.hpp"

using hmesh::Errc;
using hmesh::Image;
using hmesh::Mesh;
using hmesh::Options;
using hmesh::Result;
using hmesh::SpriteReport;
using hmesh::Target;

namespace {

// A soft disc with a hole in one corner, over nothing: colours under transparent pixels are noise.
template <class T, int C>
Image<T, C> disc(int width, int height) {
    hmesh::kit::Random random(7);
    return hmesh_test::draw<T, C>(width, height, [&](int x, int y, int c) {
        const double dx = x + 0.5 - 0.5 * width, dy = y + 0.5 - 0.45 * height;
        const double far = std::sqrt(dx * dx + dy * dy), radius = 0.35 * std::min(width, height);
        const double hole = std::hypot(dx + 0.5 * radius, dy) - 0.25 * radius;
        const double alpha = std::min(std::clamp(0.5 + radius - far, 0.0, 1.0), std::clamp(0.5 + hole, 0.0, 1.0));
        if (c + 1 == C) return alpha;
        return alpha > 0 ? 0.5 + 0.4 * std::sin(0.2 * x + c) * std::cos(0.15 * y) : random.uniform();
    });
}

template <class T, int C>
Result mesh_of(const Image<T, C>& image, Target target = Target::vertices(150)) {
    Options options;
    options.premultiplied = true;
    options.target = target;
    return hmesh::mesh_image(image.view(), options, hmesh::Annealed{hmesh::Effort::fast});
}

// Two squares of two faces, alpha by vertex.
Mesh two_squares(const std::array<float, 6>& alpha) {
    Mesh mesh;
    mesh.channels = 2, mesh.width = 4, mesh.height = 2, mesh.peak = 255, mesh.premultiplied = true;
    mesh.positions = {0, 0, 2, 0, 4, 0, 0, 2, 2, 2, 4, 2};
    for (std::size_t v = 0; v < 6; ++v) mesh.colors.insert(mesh.colors.end(), {static_cast<float>(10 * v), alpha[v]});
    mesh.faces = {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}};
    return mesh;
}

// The PSNR of two premultiplied pictures of stored values laid over a grey, in dB.
template <int C>
double psnr_over(const Image<float, C>& a, const Image<float, C>& b, double peak, double ground) {
    double energy = 0;
    for (std::size_t i = 0; i < a.size(); i += C)
        for (std::size_t k = 0; k + 1 < C; ++k) {
            const auto over = [&](const Image<float, C>& image) {
                return static_cast<double>(image.data()[i + k]) +
                       (1 - static_cast<double>(image.data()[i + C - 1]) / peak) * ground * peak;
            };
            energy += (over(a) - over(b)) * (over(a) - over(b));
        }
    return hmesh::kit::psnr_of_energy(energy, static_cast<double>(a.size() / C * (C - 1)), peak);
}

// Faces as positions and colours of their corners, sorted.
std::vector<std::vector<float>> corners_of(const Mesh& mesh) {
    std::vector<std::vector<float>> out;
    for (const hmesh::Triangle& face : mesh.faces) {
        out.emplace_back();
        for (const std::size_t v : face) {
            out.back().insert(out.back().end(), {mesh.positions[2 * v], mesh.positions[2 * v + 1]});
            for (int c = 0; c < mesh.channels; ++c)
                out.back().push_back(mesh.colors[static_cast<std::size_t>(mesh.channels) * v + static_cast<std::size_t>(c)]);
        }
    }
    std::sort(out.begin(), out.end());
    return out;
}

float most_alpha(const std::vector<float>& corners, int channels) {
    const auto stride = static_cast<std::size_t>(channels + 2);
    return std::max({corners[stride - 1], corners[2 * stride - 1], corners[3 * stride - 1]});
}

}  // namespace

TEST_CASE("faces whose alpha is nowhere above the threshold go with the vertices that only they use, opaque ones come first") {
    Mesh mesh = two_squares({0, 0, 255, 1, 0, 255});
    SpriteReport report = hmesh::drop_transparent(mesh, 0);
    CHECK(report.status);
    CHECK(report.dropped_faces == 1);  // 0 1 4
    CHECK(report.dropped_vertices == 0);
    CHECK(report.opaque_faces == 0);
    CHECK(report.area == 6);
    CHECK(mesh.faces == std::vector<hmesh::Triangle>{{0, 4, 3}, {1, 2, 5}, {1, 5, 4}});
    report = hmesh::drop_transparent(mesh, 1);
    CHECK(report.dropped_faces == 1);
    CHECK(report.dropped_vertices == 2);
    CHECK(report.area == 4);
    CHECK(mesh.faces == std::vector<hmesh::Triangle>{{0, 1, 3}, {0, 3, 2}});
    CHECK(mesh.positions == std::vector<float>{2, 0, 4, 0, 2, 2, 4, 2});
    CHECK(mesh.colors == std::vector<float>{10, 0, 20, 255, 40, 0, 50, 255});
    CHECK(check(mesh.view(), 2));

    mesh = two_squares({9, 255, 254.5F, 9, 255, 255});
    report = hmesh::drop_transparent(mesh);
    CHECK(report.opaque_faces == 2);
    CHECK(report.dropped_faces == 0);
    CHECK(mesh.faces == std::vector<hmesh::Triangle>{{1, 2, 5}, {1, 5, 4}, {0, 1, 4}, {0, 4, 3}});
}

TEST_CASE("of an image without an opaque pixel nothing is left, through mesh_image() everything") {
    for (const auto& [width, height] : {std::array<int, 2>{1, 1}, {7, 1}, {40, 30}}) {
        const auto air = hmesh_test::draw<std::uint8_t, 4>(width, height, [](int, int, int c) { return c == 3 ? 0.0 : 0.7; });
        Result result = mesh_of(air, Target::at_most(200));
        CHECK(result.report.vertices == 4);
        CHECK(result.has_mesh());
        const SpriteReport report = hmesh::drop_transparent(result, air.view());
        CHECK(report.status);
        CHECK(result.status);
        CHECK(result.mesh.vertex_count() == 0);
        CHECK(result.mesh.faces.empty());
        CHECK(result.report.vertices == 0);
        CHECK(result.report.psnr == std::numeric_limits<double>::infinity());
        CHECK(report.area == 0);
        CHECK(report.dropped_vertices == 4);
        CHECK(check(result.mesh.view(), 4));
        CHECK(hmesh_test::rendered_error(Image<std::uint8_t, 4>(width, height), result.mesh) == 0);
        CHECK(hmesh::drop_transparent(result.mesh).status);  // once more
    }
}

TEST_CASE_TEMPLATE("what is left is drawn as before over any background, and the report is that of it", T, std::uint8_t,
                   std::uint16_t, float) {
    const auto check_channels = [](const auto& image, auto channels) {
        constexpr int C = decltype(channels)::value;
        const Result whole = mesh_of(image);
        const double peak = whole.mesh.peak;
        const auto wanted = hmesh::kit::premultiply(image.view());
        Image<float, C> reference(image.width(), image.height());
        for (std::size_t k = 0; k < reference.size(); ++k) reference.data()[k] = static_cast<float>(wanted.data()[k]);
        for (const double threshold : {0.0, 1.0, 3.0}) {
            CAPTURE(threshold);
            Result result = whole;
            const SpriteReport report = hmesh::drop_transparent(result, image.view(), {}, threshold);
            CHECK(report.status);
            // Least squares of floats are seldom 0 to the last bit.
            if (threshold > 0 || std::is_integral_v<T>) CHECK(report.dropped_faces > (threshold > 0 ? 10 : 2));
            CHECK(result.report.faces + report.dropped_faces == whole.report.faces);
            CHECK(result.report.vertices + report.dropped_vertices == whole.report.vertices);
            const double energy = hmesh_test::rendered_error(wanted, result.mesh);
            CHECK(result.report.energy == doctest::Approx(energy).epsilon(1e-4));
            if (threshold > 0) CHECK(report.area < 0.45 * image.width() * image.height());
            if (threshold > 1) continue;
            const auto before = hmesh_test::drawn<C>(whole.mesh), after = hmesh_test::drawn<C>(result.mesh);
            for (const double ground : {0.0, 0.5, 1.0})
                CHECK(psnr_over<C>(reference, after, peak, ground) > psnr_over<C>(reference, before, peak, ground) - 0.02);
            // The faces are those of the mesh before that are above the threshold, opaque ones first.
            std::vector<std::vector<float>> kept;
            for (const auto& face : corners_of(whole.mesh))
                if (255 * static_cast<double>(most_alpha(face, C)) > threshold * peak) kept.push_back(face);
            CHECK(corners_of(result.mesh) == kept);
            for (std::size_t f = 0; f < result.mesh.faces.size(); ++f) {
                double least = peak;
                for (const std::size_t v : result.mesh.faces[f])
                    least = std::min(least, static_cast<double>(result.mesh.colors[C * v + C - 1]));
                if ((least >= 254.5 / 255 * peak) != (f < report.opaque_faces)) FAIL("face ", f);
            }
            CHECK(report.opaque_faces > 10);
        }
    };
    check_channels(disc<T, 4>(60, 50), std::integral_constant<int, 4>());
    check_channels(disc<T, 2>(60, 50), std::integral_constant<int, 2>());
}

TEST_CASE("with weights the report counts pixels with theirs") {
    const auto image = disc<std::uint8_t, 4>(48, 40);
    const auto weights = hmesh_test::random_weights(48, 40, 3);
    Options options;
    options.premultiplied = true;
    options.target = Target::vertices(90);
    options.weights = weights.view();
    Result result = hmesh::mesh_image(image.view(), options, hmesh::Annealed{hmesh::Effort::draft});
    CHECK(hmesh::drop_transparent(result, image.view(), options, 40).dropped_faces > 3);
    const auto drawn = hmesh_test::drawn<4>(result.mesh);
    const auto wanted = hmesh::kit::premultiply(image.view());
    const float most = *std::max_element(weights.data(), weights.data() + weights.size());
    double energy = 0;
    for (std::size_t k = 0; k < wanted.size(); ++k) {
        const double difference = static_cast<double>(drawn.data()[k]) - wanted.data()[k];
        energy += static_cast<double>(weights.data()[k / 4] / most) * difference * difference;
    }
    CHECK(result.report.energy == doctest::Approx(energy).epsilon(1e-4));
}

TEST_CASE("with weights of channels the report counts channels with theirs") {
    const auto image = disc<std::uint8_t, 4>(48, 40);
    Options options;
    options.premultiplied = true;
    options.target = Target::vertices(90);
    options.channel_weights = {1, 0.25, 0.25, 4};
    Result result = hmesh::mesh_image(image.view(), options, hmesh::Annealed{hmesh::Effort::draft});
    CHECK(hmesh::drop_transparent(result, image.view(), options, 40).dropped_faces > 3);
    const auto drawn = hmesh_test::drawn<4>(result.mesh);
    const auto wanted = hmesh::kit::premultiply(image.view());
    double energy = 0;
    for (std::size_t k = 0; k < wanted.size(); ++k) {
        const double difference = static_cast<double>(drawn.data()[k]) - wanted.data()[k];
        energy += options.channel_weights[k % 4] / 4 * difference * difference;
    }
    CHECK(result.report.energy == doctest::Approx(energy).epsilon(2e-3));
    CHECK(result.report.psnr ==
          doctest::Approx(10 * std::log10(255 * 255 * 48 * 40 * (5.5 / 4) / result.report.energy)).epsilon(1e-3));
    options.channel_weights = {1, 2};
    CHECK(hmesh::drop_transparent(result, image.view(), options).status.code == Errc::invalid_argument);
}

TEST_CASE(
    "the largest error is that of the faces that are left, and of nothing where there were others, of straight meshes too") {
    for (const bool premultiplied : {true, false}) {
        CAPTURE(premultiplied);
        Mesh mesh = two_squares({0, 0, 200, 0, 0, 200});  // two faces of air, whose colours are 0 to 40
        mesh.premultiplied = premultiplied;
        Mesh left = mesh;
        REQUIRE(hmesh::drop_transparent(left, 2).status);
        const Image<float, 2> wanted = hmesh_test::drawn<2>(left);
        Image<std::uint8_t, 2> image(4, 2);
        for (std::size_t k = 0; k < image.size(); k += 2) {
            const float alpha = std::round(wanted.data()[k + 1]);
            image.data()[k + 1] = static_cast<std::uint8_t>(alpha);
            const float color = premultiplied && alpha > 0 ? 255 * wanted.data()[k] / alpha : wanted.data()[k];
            image.data()[k] = static_cast<std::uint8_t>(std::round(std::min(255.0F, color)));
        }
        Result result;
        result.mesh = mesh;
        result.report.max_error = 1000;
        REQUIRE(hmesh::drop_transparent(result, image.view(), {}, 2).status);
        const auto stored = premultiplied ? hmesh::kit::premultiply(image.view()) : image;
        double largest = 0;
        for (std::size_t k = 0; k < stored.size(); ++k)
            largest = std::max(largest, std::abs(static_cast<double>(wanted.data()[k]) - stored.data()[k]));
        CHECK(largest < 10);
        CHECK(result.report.max_error == doctest::Approx(largest).epsilon(1e-4));
    }
}

TEST_CASE("the report of a sprite that repeats is that of its copies together, and counts copies of a vertex once") {
    const auto image = disc<std::uint8_t, 4>(48, 40);
    for (const bool straight : {false, true}) {
        CAPTURE(straight);
        Options options;
        options.premultiplied = true;
        options.periodic = hmesh::Periodic::xy;
        options.straight_border = straight;
        options.target = Target::vertices(90);
        Result result = hmesh::mesh_image(image.view(), options, hmesh::Annealed{hmesh::Effort::draft});
        const SpriteReport report = hmesh::drop_transparent(result, image.view(), options, 40);
        CAPTURE(std::string(hmesh::message(report.status).c_str()));
        REQUIRE(report.status);
        CHECK(report.dropped_faces > 3);
        CHECK(result.report.faces == result.mesh.face_count());
        std::set<std::pair<float, float>> places;
        for (std::size_t v = 0; v < result.mesh.vertex_count(); ++v) {
            const auto inside = [](float x, float period) { return x - std::floor(x / period) * period; };
            places.emplace(inside(result.mesh.positions[2 * v], 48), inside(result.mesh.positions[2 * v + 1], 40));
        }
        CHECK(result.report.vertices == places.size());
        const auto drawn = hmesh_test::drawn<4>(result.mesh);
        const auto wanted = hmesh::kit::premultiply(image.view());
        double energy = 0, largest = 0;
        for (std::size_t k = 0; k < wanted.size(); ++k) {
            const double difference = static_cast<double>(drawn.data()[k]) - wanted.data()[k];
            energy += difference * difference;
            largest = std::max(largest, std::abs(difference));
        }
        CHECK(result.report.energy == doctest::Approx(energy).epsilon(1e-4));
        CHECK(result.report.max_error == doctest::Approx(largest).epsilon(1e-4));
    }
}

TEST_CASE("meshes without alpha, thresholds out of range and results of another image are refused and stay as they are") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const Mesh good = two_squares({0, 0, 255, 1, 0, 255});
    const auto check_refused = [](Mesh mesh, double threshold, Errc code) {
        const Mesh before = mesh;
        const SpriteReport report = hmesh::drop_transparent(mesh, threshold);
        CHECK(report.status.code == code);
        CHECK(hmesh_test::same_bytes(mesh, before));
    };
    for (const double bad : {-1.0, 254.5, 255.0, 1e300, nan}) check_refused(good, bad, Errc::invalid_argument);
    check_refused({}, 0, Errc::invalid_argument);
    Mesh gray = good;
    gray.channels = 1, gray.colors.resize(6);
    check_refused(gray, 0, Errc::invalid_argument);
    Mesh broken = good;
    broken.colors[3] = std::numeric_limits<float>::quiet_NaN();
    check_refused(broken, 0, Errc::not_finite);
    broken = good;
    broken.colors.pop_back();
    check_refused(broken, 0, Errc::invalid_argument);

    const auto image = disc<std::uint8_t, 2>(4, 2);
    Result result;
    const auto refused = [&](const hmesh::ImageView<std::uint8_t, 2>& view) {
        const Result before = result;
        CHECK(hmesh::drop_transparent(result, view).status.code == Errc::invalid_argument);
        CHECK(hmesh_test::same_bytes(result, before));
    };
    refused(image.view());  // no mesh
    result.mesh = good;
    CHECK(hmesh::drop_transparent(result, image.view()).status);
    refused(disc<std::uint8_t, 2>(5, 2).view());
    refused({});
    for (int k = 0; k < 4; ++k) {  // each alone is reason enough
        CAPTURE(k);
        const hmesh::Image<float, 1> weights = hmesh_test::random_weights(k == 0 ? 5 : 4, 2, 1);
        Options options;
        options.weights = weights.view();
        result.mesh = good;
        if (k == 1) result.mesh.height = 3;
        if (k == 2) result.mesh.channels = 4, result.mesh.colors.resize(24);
        const Result before = result;
        const SpriteReport report = hmesh::drop_transparent(result, image.view(), options, k == 3 ? 255 : 2);
        CHECK(report.status.code == Errc::invalid_argument);
        CHECK(hmesh_test::same_bytes(result, before));
    }
    result.mesh = good;
    result.mesh.positions[0] = -1;
    refused(image.view());
}
