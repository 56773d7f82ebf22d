#include "hmesh/paper.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <utility>

#include "hmesh/image/weights.hpp"
#include "test_images.hpp"
#include "test_meshing.hpp"
#include "test_methods.hpp"
#include "test_results.hpp"

using hmesh::Adams;
using hmesh::AdaptiveThinning;
using hmesh::Annealed;
using hmesh::Errc;
using hmesh::Hierarchical;
using hmesh::Image;
using hmesh::ImageView;
using hmesh::mesh_image;
using hmesh::Options;
using hmesh::Result;
using hmesh::Target;
using hmesh::Xie;

namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

Options options_of(Target target) { return {target}; }

// Calls body(recipe) for each recipe of the paper as it is by default.
template <class Body>
void for_each_recipe(Body&& body) {
    const auto call = [&](const auto& recipe) {
        CAPTURE(recipe.name);
        body(recipe);
    };
    call(Hierarchical());
    call(Xie());
    call(Adams());
    call(AdaptiveThinning());
}

// Valid meshes with any count from 4 to one vertex a pixel.
template <class T, int C>
void mesh_by_all(const Image<T, C>& image) {
    const std::size_t pixels = image.size() / C, most = std::max<std::size_t>(4, pixels);
    for_each_recipe([&](const auto& recipe) {
        for (const std::size_t n : {std::size_t{4}, std::min<std::size_t>(most, 5), std::max<std::size_t>(4, pixels / 7), most}) {
            CAPTURE(n);
            const Options options = options_of(Target::vertices(static_cast<std::int64_t>(n)));
            hmesh_test::prove_result(image, mesh_image(image.view(), options, recipe), n);
        }
    });
}

// The weighted error of the mesh as it is drawn, and whether the report agrees.
template <class T, int C>
bool is_weighted_report_true(const Image<T, C>& image, const Image<float, 1>& weights, const Result& result) {
    const Image<float, C> drawn = hmesh_test::drawn<C>(result.mesh);
    const hmesh::kit::WeightScale scale(hmesh::kit::weight_unit(weights.view()), image.width(), image.height());
    double energy = 0, squares = 0;
    for (std::size_t k = 0; k < drawn.size(); ++k) {
        const double sample = static_cast<double>(image.data()[k]), weight = scale(weights.data()[k / C]);
        const double difference = static_cast<double>(drawn.data()[k]) - sample;
        energy += weight * difference * difference;
        squares += sample * sample;
    }
    return result.report.energy >= 0 && std::abs(result.report.energy - energy) <= 2.3e-4 * energy + 1e-10 * squares;
}

// The image under a vertex: the mean of the pixels around, each by its share of a unit square around the place.
double bilinear(const Image<std::uint8_t, 1>& image, float at_x, float at_y) {
    const double x = std::clamp(static_cast<double>(at_x), 0.5, image.width() - 0.5);
    const double y = std::clamp(static_cast<double>(at_y), 0.5, image.height() - 0.5);
    double sum = 0;
    for (int j = 0; j < image.height(); ++j)
        for (int i = 0; i < image.width(); ++i)
            sum += *image.pixel(i, j) * std::max(0.0, 1 - std::abs(x - i - 0.5)) * std::max(0.0, 1 - std::abs(y - j - 0.5));
    return sum;
}

}  // namespace

TEST_CASE("the methods of the paper mesh images of 1 to 6 by 1 to 6 pixels, and of one or two rows or columns") {
    for (int height = 1; height <= 6; ++height)
        for (int width = 1; width <= 6; ++width) {
            CAPTURE(width);
            CAPTURE(height);
            const auto seed = static_cast<std::uint64_t>(width + 7 * height);
            mesh_by_all(hmesh_test::noise<std::uint8_t, 1>(width, height, seed));
            mesh_by_all(hmesh_test::constant_image<float, 2>(width, height, 0.3));
        }
    for (const auto& [width, height] : {std::pair{1, 70}, {70, 1}, {2, 45}, {45, 2}})
        for (const auto& image : hmesh_test::hard_pictures<std::uint8_t, 1>(width, height)) mesh_by_all(image);
}

TEST_CASE("the methods of the paper mesh pictures of ties, of flat parts and of lines") {
    for (const auto& image : hmesh_test::hard_pictures<std::uint8_t, 1>(24, 17)) mesh_by_all(image);
    for (const auto& image : hmesh_test::hard_pictures<float, 1>(14, 13)) mesh_by_all(image);
}

TEST_CASE("the methods of the paper mesh every sample type, numbers of channels, floats of any size and sign") {
    mesh_by_all(hmesh_test::scene<std::uint8_t, 3>(20, 16, 1));
    mesh_by_all(hmesh_test::scene<std::uint8_t, 4>(20, 16, 1));
    mesh_by_all(hmesh_test::scene<std::uint16_t, 1>(20, 16, 1));
    mesh_by_all(hmesh_test::noise<std::uint16_t, 3>(20, 16, 1));
    for (const double factor : {3.4e38, 1e30, 7.0, 1e-30}) {
        CAPTURE(factor);
        Image<float, 1> image = hmesh_test::noise<float, 1>(14, 12, 4);
        hmesh_test::for_each_sample(
            image, [&](float& sample) { sample = static_cast<float>(factor * (2 * static_cast<double>(sample) - 1)); });
        mesh_by_all(image);
    }
}

TEST_CASE("the methods of the paper count pixels by their weights, zeros among them") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(24, 18, 3);
    for (const double factor : {1.0, 0.0}) {
        Image<float, 1> weights = hmesh_test::random_weights(24, 18, 5);
        hmesh_test::for_each_sample(weights, [&](float& weight) { weight *= static_cast<float>(factor); });
        for_each_recipe([&](const auto& recipe) {
            for (const auto colors : {hmesh::Colors::optimal, hmesh::Colors::sampled})
                for (const std::int64_t n : {4, 40, 432}) {
                    Options options = options_of(Target::vertices(n));
                    options.weights = weights.view();
                    options.colors = colors;
                    const Result result = mesh_image(image.view(), options, recipe);
                    CHECK(result.status);
                    CHECK(result.report.vertices == static_cast<std::size_t>(n));
                    CHECK(hmesh_test::flaw_of(result.mesh.view(), 24, 18) == "");
                    CHECK(is_weighted_report_true(image, weights, result));
                }
        });
    }
}

TEST_CASE("padding between rows and rows stored bottom up change no byte of what the methods of the paper make") {
    const auto image = hmesh_test::scene<std::uint16_t, 3>(30, 22, 2);
    const Options options = options_of(Target::vertices(40));
    for_each_recipe([&](const auto& recipe) {
        const Result packed = mesh_image(image.view(), options, recipe);
        for (const bool bottom_up : {false, true}) {
            const hmesh_test::PaddedCopy<std::uint16_t, 3> copy(image, 7, bottom_up, 12345);
            CHECK(hmesh_test::same_bytes(mesh_image(copy.view(), options, recipe), packed));
        }
    });
}

TEST_CASE("colours are those asked for: of the image under the vertices, or no worse") {
    const auto image = hmesh_test::scene<std::uint8_t, 1>(40, 30, 3);
    const auto check = [&](const auto& recipe, bool samples) {
        CAPTURE(recipe.name);
        for (const bool round : {false, true}) {
            Options options = options_of(Target::vertices(70));
            options.round_colors = round;
            options.colors = hmesh::Colors::sampled;
            const Result sampled = mesh_image(image.view(), options, recipe);
            options.colors = hmesh::Colors::optimal;
            const Result optimal = mesh_image(image.view(), options, recipe);
            options.colors.reset();
            CHECK((recipe.colors == hmesh::Colors::sampled) == samples);
            CHECK(hmesh_test::same_bytes(mesh_image(image.view(), options, recipe), samples ? sampled : optimal));
            hmesh_test::prove_result(image, sampled, 70, round);
            hmesh_test::prove_result(image, optimal, 70, round);
            CHECK(sampled.mesh.positions == optimal.mesh.positions);
            CHECK(optimal.report.energy < sampled.report.energy);
            double worst = 0;
            for (std::size_t v = 0; v < 70; ++v) {
                const double color = bilinear(image, sampled.mesh.positions[2 * v], sampled.mesh.positions[2 * v + 1]);
                worst = std::max(worst, std::abs(color - static_cast<double>(sampled.mesh.colors[v])));
            }
            CHECK(worst <= (round ? 0.5 + 1e-4 : 1e-4));
        }
    };
    check(Annealed(), false);
    check(Hierarchical(), false);
    check(Xie(), true);
    check(Adams(), true);
    check(AdaptiveThinning(), true);
}

TEST_CASE("the methods of the paper reach a PSNR, and say so where they cannot") {
    const auto image = hmesh_test::scene<std::uint8_t, 1>(40, 30, 3);
    for_each_recipe([&](const auto& recipe) {
        const Result result = mesh_image(image.view(), options_of(Target::psnr(28)), recipe);
        hmesh_test::prove_result(image, result, result.report.vertices);
        CHECK(result.report.psnr >= 28);
        CHECK(result.report.vertices < 1200);
        const Result most = mesh_image(image.view(), options_of(Target::psnr(200)), recipe);
        CHECK(most.status.code == Errc::target_out_of_range);
        hmesh_test::prove_report(image, most);
        const Result few = mesh_image(image.view(), options_of(Target::psnr(28, 20)), recipe);
        CHECK(few.status.code == Errc::target_out_of_range);
        CHECK(few.report.vertices == 20);
    });
}

TEST_CASE("options of a recipe are checked before a pixel is read") {
    const std::uint8_t pixel[3] = {};
    const ImageView<std::uint8_t, 3> view{pixel, 16384, 16384};
    const auto what = [&](const auto& recipe) {
        const Result result = mesh_image(view, options_of(Target::vertices(20)), recipe);
        CHECK(result.status.code == Errc::invalid_argument);
        CHECK(!result.has_mesh());
        CHECK(result.report.stages.empty());
        return std::string(result.status.what);
    };
    Adams adams;
    adams.density = not_a_number;
    CHECK(what(adams).find("adams density ") == 0);
    Xie xie;
    xie.rounds = -1;
    CHECK(what(xie).find("xie rounds ") == 0);
    Hierarchical hierarchical;
    hierarchical.levels = 0;
    CHECK(what(hierarchical).find("hierarchical levels ") == 0);
}

TEST_CASE("colors that are none of those known are refused whatever the recipe") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(24, 20, 3);
    Options options = options_of(Target::vertices(20));
    options.colors = hmesh::Colors{2};
    for_each_recipe([&](const auto& recipe) {
        const Result result = mesh_image(image.view(), options, recipe);
        CHECK(result.status.code == Errc::invalid_argument);
        CHECK(!result.has_mesh());
    });
}

TEST_CASE("adaptive thinning of more than 2^22 pixels is refused before a pixel is read") {
    const std::uint8_t pixel[3] = {};
    for (const auto& [width, height] : {std::pair{2049, 2048}, {65536, 65}, {1 << 14, 1 << 14}}) {
        const ImageView<std::uint8_t, 3> view{pixel, width, height};
        const auto status = mesh_image(view, options_of(Target::vertices(4)), AdaptiveThinning()).status;
        CHECK(status.code == Errc::image_too_large);
        CHECK(status.value == static_cast<double>(width) * height);
        CHECK(status.limit == 1 << 22);
        Hierarchical other;
        other.levels = 0;  // or it would go on
        CHECK(mesh_image(view, options_of(Target::vertices(4)), other).status.code == Errc::invalid_argument);
    }
    CHECK(AdaptiveThinning().check(2048, 2048));
}

TEST_CASE("cancelled at once, every recipe gives the four corners, and a report that is true of them") {
    const auto image = hmesh_test::scene<std::uint8_t, 4>(24, 20, 3);
    const auto check = [&](const auto& recipe) {
        CAPTURE(recipe.name);
        Options options = options_of(Target::vertices(40));
        options.colors = hmesh::Colors::optimal;
        const auto stop = [](const hmesh::ProgressInfo&) { return false; };
        options.progress = stop;
        const Result result = mesh_image(image.view(), options, recipe);
        CHECK(result.status.code == Errc::cancelled);
        CHECK(result.report.vertices == 4);
        hmesh_test::prove_report(image, result);
    };
    check(Annealed());
    for_each_recipe(check);
}
