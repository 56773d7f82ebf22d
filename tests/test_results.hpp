// hmesh tests - what every result of mesh_image must be, told without the library's geometry, moments or energies.
//
// flaw_of() says whether the mesh is one; rendered_error() compares the image with the drawn mesh, pixel by pixel.
#ifndef HMESH_TESTS_TEST_RESULTS_HPP
#define HMESH_TESTS_TEST_RESULTS_HPP

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "hmesh/image/image_view.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/render.hpp"
#include "hmesh/result.hpp"
#include "mesh_flaws.hpp"
#include "same_bytes.hpp"
#include "test_images.hpp"

namespace hmesh_test {

// The mesh as it is drawn.
template <int C>
[[nodiscard]] hmesh::Image<float, C> drawn(const hmesh::Mesh& mesh, const hmesh::RenderOptions& options = {}) {
    hmesh::RenderResult<C> result = hmesh::render<C>(mesh.view(), options);
    REQUIRE(result.status);
    return std::move(result.image);
}

// The sum over pixels and channels of the squared difference between the image and the mesh drawn at its size.
template <class T, int C>
double rendered_error(const hmesh::Image<T, C>& image, const hmesh::Mesh& mesh) {
    const hmesh::Image<float, C> picture = drawn<C>(mesh);
    REQUIRE(picture.size() == image.size());
    double energy = 0;
    for (std::size_t k = 0; k < picture.size(); ++k) {
        const double difference = static_cast<double>(picture.data()[k]) - static_cast<double>(image.data()[k]);
        energy += difference * difference;
    }
    return energy;
}

// The largest magnitude of a sample.
template <class T, int C>
double magnitude_of(const hmesh::Image<T, C>& image) {
    double most = 0;
    for (const T sample : samples_of(image)) most = std::max(most, std::abs(static_cast<double>(sample)));
    return most;
}

// What the roundings of sums of squares, and of colours and drawn samples to float, can make of an energy.
template <class T, int C>
double energy_rounding(const hmesh::Image<T, C>& image) {
    const double sample = 1e-6 * magnitude_of(image) + static_cast<double>(std::numeric_limits<float>::denorm_min());
    return static_cast<double>(image.size()) * sample * sample;
}

// The result is a valid mesh of the image, whatever its status, and the report is true of it to 1e-3 dB.
template <class T, int C>
void prove_report(const hmesh::Image<T, C>& image, const hmesh::Result& result, bool round_colors = true) {
    using Traits = hmesh::PixelTraits<T>;
    const hmesh::Report& report = result.report;
    CHECK(flaw_of(result.mesh.view(), image.width(), image.height()) == "");
    CHECK(result.has_mesh());
    CHECK(result.mesh.channels == C);
    CHECK(result.mesh.peak == Traits::peak);
    CHECK(report.vertices == result.mesh.vertex_count());
    CHECK(report.faces == result.mesh.face_count());
    CHECK(result.mesh.colors.size() == C * result.mesh.vertex_count());
    bool in_range = true, whole = true;
    for (const float color : result.mesh.colors) {
        in_range = in_range && static_cast<double>(color) >= Traits::lowest && static_cast<double>(color) <= Traits::highest;
        whole = whole && std::floor(color) == color;
    }
    CHECK(in_range);
    if (Traits::is_integer && round_colors) CHECK(whole);

    const hmesh::Image<float, C> picture = drawn<C>(result.mesh);
    double largest = 0;
    for (std::size_t k = 0; k < picture.size(); ++k)
        largest = std::max(largest, std::abs(static_cast<double>(picture.data()[k]) - static_cast<double>(image.data()[k])));
    const auto least = static_cast<double>(std::numeric_limits<float>::denorm_min());
    CHECK(std::abs(report.max_error - largest) <= 1e-6 * magnitude_of(image) + least);
    const double energy = rendered_error(image, result.mesh);
    CHECK(report.energy >= 0);
    CHECK(std::abs(report.energy - energy) <= 2.3e-4 * energy + energy_rounding(image));  // 1e-3 dB
    const auto samples = static_cast<double>(image.size());
    if (!(report.energy > 0)) CHECK(report.psnr == std::numeric_limits<double>::infinity());
    else
        CHECK(report.psnr ==
              doctest::Approx(10 * std::log10(Traits::peak * Traits::peak * samples / report.energy)).epsilon(1e-12));
    CHECK(!report.stages.empty());
}

// The same for a result that has all that was asked for.
template <class T, int C>
void prove_result(const hmesh::Image<T, C>& image, const hmesh::Result& result, std::size_t vertices, bool round_colors = true) {
    CHECK_MESSAGE(result.status, hmesh::message(result.status).c_str());
    CHECK(result.report.vertices == vertices);
    prove_report(image, result, round_colors);
}

}  // namespace hmesh_test

#endif  // HMESH_TESTS_TEST_RESULTS_HPP
