#include "hmesh/io/heights/detail/relief.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "hmesh/image/image_view.hpp"
#include "test_heights.hpp"

namespace {

using hmesh::Samples;
using hmesh::detail::Relief;
using hmesh_test::Point3;
using hmesh_test::Terrain;
using hmesh_test::terrain;

// All normals, east, north and up.
std::vector<Point3> normals(const hmesh::Mesh& mesh, const hmesh::HeightSamples& samples,
                            const hmesh::HeightOptions& options = {}) {
    REQUIRE(hmesh::detail::check_relief(mesh.view(), samples, options));
    Relief relief(mesh.view(), samples, options, false);
    relief.find_normals();
    std::vector<Point3> out;
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) out.push_back(relief.normal(v));
    return out;
}

Point3 of_slope(double to_right, double down, const hmesh::HeightOptions& options) {
    return {-options.z.scale * to_right / options.x_step, options.z.scale * down / options.y_step, 1};
}

// Degrees, the largest over the vertices at least `margin` samples from the sides.
double largest_angle(const hmesh::Mesh& mesh, const std::vector<Point3>& found, const hmesh_test::Height& to_right,
                     const hmesh_test::Height& down, const hmesh::HeightOptions& options, double margin) {
    double worst = 0;
    for (std::size_t v = 0; v < found.size(); ++v) {
        const auto x = static_cast<double>(mesh.positions[2 * v]), y = static_cast<double>(mesh.positions[2 * v + 1]);
        if (std::min({x, y, mesh.width - 1 - x, mesh.height - 1 - y}) < margin) continue;
        CHECK(hmesh_test::size_of_vector(found[v]) == doctest::Approx(1).epsilon(1e-12));
        worst = std::max(worst, hmesh_test::angle_between(found[v], of_slope(to_right(x, y), down(x, y), options)));
    }
    return worst;
}

// Vertices anywhere, off the samples.
hmesh::Mesh scattered(hmesh::Mesh mesh) {
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
        const double most_x = mesh.width - (mesh.samples == Samples::points ? 1.0 : 0.0),
                     most_y = mesh.height - (mesh.samples == Samples::points ? 1.0 : 0.0);
        const double x = static_cast<double>(mesh.positions[2 * v]) + 0.37 * std::sin(7.0 * static_cast<double>(v)),
                     y = static_cast<double>(mesh.positions[2 * v + 1]) + 0.41 * std::sin(3.0 * static_cast<double>(v));
        mesh.positions[2 * v] = static_cast<float>(std::max(0.0, std::min(most_x, x)));
        mesh.positions[2 * v + 1] = static_cast<float>(std::max(0.0, std::min(most_y, y)));
    }
    return mesh;
}

hmesh::HeightOptions units() {
    hmesh::HeightOptions options;
    options.x_step = 30, options.y_step = 20;
    options.z.scale = 4;
    return options;
}

}  // namespace

TEST_CASE("the normal of a plane is exact everywhere, at the borders too") {
    const auto plane = [](double x, double y) { return 3 + 2 * x - 5 * y; };
    for (const Samples kind : {Samples::squares, Samples::points}) {
        const Terrain land = terrain(7, 5, kind, plane);
        const hmesh::Mesh mesh = scattered(land.mesh);
        for (const Point3& normal : normals(mesh, land.samples.view(), units()))
            CHECK(hmesh_test::angle_between(normal, of_slope(2, -5, units())) < 1e-6);
        for (const Point3& normal : normals(land.mesh, {}, units()))
            CHECK(hmesh_test::angle_between(normal, of_slope(2, -5, units())) < 1e-5);
    }
}

TEST_CASE("the normal of a quadratic surface is exact a sample from the borders, on samples and between them") {
    const auto bowl = [](double x, double y) { return x * x / 4 - x * y / 8 + y * y / 2 - 3 * x; };
    const auto to_right = [](double x, double y) { return x / 2 - y / 8 - 3; };
    const auto down = [](double x, double y) { return y - x / 8; };
    for (const Samples kind : {Samples::squares, Samples::points}) {
        const Terrain land = terrain(9, 8, kind, bowl);
        const hmesh::Mesh mesh = scattered(land.mesh);
        CHECK(largest_angle(mesh, normals(mesh, land.samples.view(), units()), to_right, down, units(), 1.6) < 1e-5);
        CHECK(largest_angle(mesh, normals(mesh, land.samples.view(), units()), to_right, down, units(), 0) < 12);  // one-sided
    }
}

TEST_CASE("normals of hills come closer to the true ones with the square of the step, those of faces with the step") {
    const auto worst = [](double size, bool has_samples) {
        const auto hills = [=](double x, double y) { return size * std::sin(x / size) * std::cos(y / size); };
        const auto to_right = [=](double x, double y) { return std::cos(x / size) * std::cos(y / size); };
        const auto down = [=](double x, double y) { return -std::sin(x / size) * std::sin(y / size); };
        const Terrain land = terrain(40, 40, Samples::points, hills);
        const hmesh::Mesh mesh = has_samples ? scattered(land.mesh) : land.mesh;
        const auto found = has_samples ? normals(mesh, land.samples.view()) : normals(mesh, {});
        return largest_angle(mesh, found, to_right, down, {}, 1.6);
    };
    const double coarse = worst(5, true), fine = worst(10, true);
    CHECK(coarse < 1.5);
    CHECK(fine < 0.3 * coarse);
    CHECK(worst(10, false) < 3);
}

TEST_CASE("without samples a vertex has the mean of the normals of its faces, weighted by their area") {
    hmesh::Mesh mesh;  // a tent: two faces of slope 1 to the east, of area 2 and 1, and one that is level
    mesh.channels = 1, mesh.width = 4, mesh.height = 4, mesh.peak = 1;
    mesh.positions = {1, 1, 3, 1, 1, 3, 0, 1, 0, 0};
    mesh.colors = {0, 2, 0, 0, 0};
    mesh.faces = {{0, 1, 2}, {3, 4, 0}};
    const std::vector<Point3> found = normals(mesh, {});
    const Point3 expected = {-4, 0, 4 + 1};  // areas 2 and 1/2, doubled; the slope of the first is 1 to the east
    CHECK(hmesh_test::angle_between(found[0], expected) < 1e-9);
    CHECK(hmesh_test::angle_between(found[1], {-1, 0, 1}) < 1e-9);
    CHECK(hmesh_test::angle_between(found[4], {0, 0, 1}) < 1e-9);
}

TEST_CASE("samples without data make slopes one-sided, and what is stored there changes nothing") {
    const auto plane = [](double x, double y) { return 2 * x - 5 * y; };
    for (const Samples kind : {Samples::squares, Samples::points}) {
        // Cells of samples 3 and 4 are a hole: of points, all cells that touch them.
        const auto is_hole = [&](int x, int y) {
            return kind == Samples::points ? x >= 2 && x <= 4 && y >= 2 && y <= 4 : x >= 3 && x <= 4 && y >= 3 && y <= 4;
        };
        Terrain land = terrain(8, 8, kind, plane, is_hole);
        hmesh::Image<std::uint8_t, 1> mask(land.samples.width(), land.samples.height());
        for (int y = 0; y < mask.height(); ++y)
            for (int x = 0; x < mask.width(); ++x) *mask.pixel(x, y) = x >= 3 && x <= 4 && y >= 3 && y <= 4 ? 0 : 1;
        for (const float sentinel :
             {-32768.0F, 1e30F, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
            for (int y = 3; y <= 4; ++y)
                for (int x = 3; x <= 4; ++x) *land.samples.pixel(x, y) = sentinel;
            for (const Point3& normal : normals(land.mesh, {land.samples.view(), mask.view()}))
                CHECK(hmesh_test::angle_between(normal, of_slope(2, -5, {})) < 1e-6);
            if (std::isfinite(sentinel)) continue;
            for (const Point3& normal : normals(land.mesh, land.samples.view()))
                CHECK(hmesh_test::angle_between(normal, of_slope(2, -5, {})) < 1e-6);
        }
    }
}

TEST_CASE("a vertex without data around it and a sample without neighbours are level") {
    Terrain land = terrain(4, 4, Samples::points, [](double x, double y) { return x * y; });
    hmesh::Image<std::uint8_t, 1> mask(5, 5);
    for (const Point3& normal : normals(land.mesh, {land.samples.view(), mask.view()})) CHECK(normal == Point3{0, 0, 1});
    *mask.pixel(2, 2) = 1;
    for (const Point3& normal : normals(land.mesh, {land.samples.view(), mask.view()})) CHECK(normal == Point3{0, 0, 1});
    const Terrain one = terrain(1, 1, Samples::squares, [](double x, double y) { return x * y; });
    for (const Point3& normal : normals(one.mesh, one.samples.view())) CHECK(normal == Point3{0, 0, 1});
}

TEST_CASE("tiles that are given a sample more on each side, or the whole map, have equal normals on their common side") {
    const auto noise = [](double x, double y) { return 10 * std::sin(12.9898 * x + 78.233 * y); };
    for (const Samples kind : {Samples::points, Samples::squares}) {
        const int size = 8, apron = kind == Samples::points ? 1 : 2;
        const Terrain whole = terrain(2 * size, size, kind, noise);
        const Terrain left = terrain(size, size, kind, noise),
                      right = terrain(size, size, kind, [&](double x, double y) { return noise(x + size, y); });
        hmesh::ImageView<float, 1> for_left = whole.samples.view();
        for_left.row_stride = static_cast<std::ptrdiff_t>(sizeof(float)) * whole.samples.width();
        for_left.width = left.mesh.width + apron;
        hmesh::ImageView<float, 1> for_right = for_left;
        for_right.data += size - apron;
        for_right.width = right.mesh.width + apron;
        const auto of_whole = normals(whole.mesh, whole.samples.view()), of_left = normals(left.mesh, for_left),
                   of_right = normals(right.mesh, {for_right, {}, apron, 0}),
                   of_map = normals(right.mesh, {whole.samples.view(), {}, size, 0}),
                   alone = normals(right.mesh, right.samples.view());
        const auto at = [&](const hmesh::Mesh& mesh, const std::vector<Point3>& all, float x, float y) {
            for (std::size_t v = 0; v < all.size(); ++v)
                if (mesh.positions[2 * v] == x && mesh.positions[2 * v + 1] == y) return all[v];
            return Point3{};
        };
        int same = 0;
        for (int y = 0; y <= size; ++y) {
            const auto row = static_cast<float>(y);
            const Point3 expected = at(whole.mesh, of_whole, size, row);
            CHECK(at(left.mesh, of_left, size, row) == expected);
            CHECK(at(right.mesh, of_right, 0, row) == expected);
            CHECK(at(right.mesh, of_map, 0, row) == expected);
            same += at(right.mesh, alone, 0, row) == expected ? 1 : 0;
        }
        CHECK(same < size);  // what the apron is for
    }
}

TEST_CASE("a mask has its columns and rows where the samples have theirs") {
    // A wall of NaN and a mask of it, of a map with fewer rows than columns.
    const Terrain land = terrain(7, 4, Samples::points, [](double x, double y) { return 2 * x * x + y; });
    hmesh::Image<float, 1> holed(8, 5);
    hmesh::Image<std::uint8_t, 1> mask(8, 5);
    for (int y = 0; y < 5; ++y)
        for (int x = 0; x < 8; ++x) {
            const bool is_known = x != 5 && !(x == 1 && y == 3);
            *mask.pixel(x, y) = is_known ? 255 : 0;
            *holed.pixel(x, y) = is_known ? *land.samples.pixel(x, y) : std::numeric_limits<float>::quiet_NaN();
        }
    CHECK(normals(land.mesh, {land.samples.view(), mask.view()}) == normals(land.mesh, holed.view()));
    CHECK(normals(land.mesh, holed.view()) != normals(land.mesh, land.samples.view()));
}

TEST_CASE("samples of any type and any channel are read as stored") {
    const Terrain land = terrain(5, 4, Samples::points, [](double x, double y) { return 3 * x + y * y; });
    hmesh::Image<std::uint16_t, 3> colors(6, 5);
    hmesh::Mesh mesh = land.mesh;
    mesh.channels = 3;
    mesh.colors.clear();
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
        for (int k = 0; k < 3; ++k) mesh.colors.push_back(k == 1 ? land.mesh.colors[v] : 7);
    for (int y = 0; y < 5; ++y)
        for (int x = 0; x < 6; ++x) colors.pixel(x, y)[1] = static_cast<std::uint16_t>(*land.samples.pixel(x, y));
    hmesh::HeightOptions options;
    options.z.channel = 1;
    CHECK(normals(mesh, colors.view(), options) == normals(land.mesh, land.samples.view()));
    // Rows bottom up.
    hmesh::Image<std::uint16_t, 3> turned(6, 5);
    for (int y = 0; y < 5; ++y) std::copy(colors.pixel(0, y), colors.pixel(0, y) + 18, turned.pixel(0, 4 - y));
    const hmesh::ImageView<std::uint16_t, 3> upward{turned.pixel(0, 4), 6, 5, -36};
    CHECK(normals(mesh, upward, options) == normals(mesh, colors.view(), options));
    options.z.channel = 2;
    for (const Point3& normal : normals(mesh, colors.view(), options)) CHECK(normal == Point3{0, 0, 1});
}
