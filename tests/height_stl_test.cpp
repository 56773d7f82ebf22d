#include "hmesh/io/heights/height_stl.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "hmesh/core/random.hpp"
#include "test_exports.hpp"
#include "test_heights.hpp"

namespace {

using hmesh_test::Bytes;
using hmesh_test::Point3;
using hmesh_test::Terrain;
using hmesh_test::terrain;

struct Facet {
    Point3 normal;
    std::array<Point3, 3> corners;
};

std::vector<Facet> read_stl(const Bytes& bytes) {
    REQUIRE(bytes.size() >= 84);
    CHECK(hmesh_test::as_text(bytes).rfind("solid", 0) != 0);
    std::size_t at = 80;
    std::vector<Facet> out(hmesh_test::number_in<std::uint32_t>(bytes, at));
    for (Facet& facet : out) {
        facet.normal = hmesh_test::floats_in<3>(bytes, at);
        for (Point3& corner : facet.corners) corner = hmesh_test::floats_in<3>(bytes, at);
        CHECK(hmesh_test::number_in<std::uint16_t>(bytes, at) == 0);
    }
    REQUIRE(at == bytes.size());
    return out;
}

std::vector<Facet> surface(const hmesh::Mesh& mesh, const hmesh::HeightOptions& options = {}) {
    return read_stl(hmesh_test::exported(mesh.view(), [&](const hmesh::MeshView& view, hmesh::Sink sink) {
        return hmesh::write_height_stl(view, sink, options);
    }));
}
std::vector<Facet> solid(const hmesh::Mesh& mesh, double base, const hmesh::HeightOptions& options = {}) {
    return read_stl(hmesh_test::exported(mesh.view(), [&](const hmesh::MeshView& view, hmesh::Sink sink) {
        return hmesh::write_solid_stl(view, base, sink, options);
    }));
}

Point3 doubled_area(const Facet& facet) {
    return hmesh_test::cross_product(hmesh_test::minus(facet.corners[1], facet.corners[0]),
                                     hmesh_test::minus(facet.corners[2], facet.corners[0]));
}

// Positive where facets are counter-clockwise seen from outside.
double volume(const std::vector<Facet>& facets) {
    double sum = 0;
    for (const Facet& f : facets)
        sum += hmesh_test::inner(f.corners[0], hmesh_test::cross_product(f.corners[1], f.corners[2])) / 6;
    return sum;
}

// As one who knows nothing but coordinates: each edge has one facet on either side, and the facets around each vertex are one
// fan.
void check_watertight(const std::vector<Facet>& facets) {
    std::map<std::pair<Point3, Point3>, int> edges;
    std::map<Point3, std::map<Point3, Point3>> fans;  // of each vertex: from one neighbour to the next
    int flaws = 0;
    for (const Facet& facet : facets)
        for (std::size_t k = 0; k < 3; ++k) {
            const Point3 &a = facet.corners[k], &b = facet.corners[(k + 1) % 3], &c = facet.corners[(k + 2) % 3];
            flaws += a == b ? 1 : 0;
            ++edges[{a, b}];
            fans[a][b] = c;
        }
    for (const auto& [edge, count] : edges) {
        const auto back = edges.find({edge.second, edge.first});
        flaws += count == 1 && back != edges.end() && back->second == 1 ? 0 : 1;
    }
    CHECK(flaws == 0);
    if (flaws > 0) return;
    for (const auto& [vertex, next] : fans) {
        std::size_t length = 1;
        for (Point3 at = next.begin()->second; at != next.begin()->first && length <= next.size(); at = next.at(at)) ++length;
        flaws += length == next.size() ? 0 : 1;
    }
    CHECK(flaws == 0);
}

double hills(double x, double y) { return 40 + 7 * std::sin(x / 3) * std::cos(y / 5) + 0.5 * x; }

}  // namespace

TEST_CASE("a surface has the faces of the mesh, facing up, each with its normal") {
    const Terrain land = terrain(9, 6, hmesh::Samples::points, hills);
    hmesh::HeightOptions options;
    options.x_step = 30, options.y_step = 20, options.z.scale = 2;
    const std::vector<Facet> facets = surface(land.mesh, options);
    REQUIRE(facets.size() == land.mesh.face_count());
    double area = 0;
    for (const Facet& facet : facets) {
        const Point3 normal = doubled_area(facet);
        CHECK(hmesh_test::angle_between(facet.normal, normal) < 1e-4);
        CHECK(hmesh_test::size_of_vector(facet.normal) == doctest::Approx(1).epsilon(1e-6));
        CHECK(normal[2] > 0);
        area += normal[2] / 2;
    }
    CHECK(area == doctest::Approx(9 * 30 * 6 * 20));
    const Point3 first = facets[0].corners[0];
    CHECK(first == Point3{0, 0, static_cast<double>(2 * land.mesh.colors[0])});
    options.up = hmesh::UpAxis::y;
    for (const Facet& facet : surface(land.mesh, options)) CHECK(facet.normal[1] > 0);
}

TEST_CASE("a face without an area has the normal 0, and more faces than a file numbers are refused") {
    hmesh::Mesh mesh = terrain(2, 2, hmesh::Samples::points, hills).mesh;
    mesh.faces.push_back({0, 1, 1});
    mesh.faces.push_back({0, 1, 2});  // in line
    mesh.positions[4] = 2, mesh.positions[5] = 0, mesh.colors[0] = mesh.colors[1] = mesh.colors[2] = 5;
    const std::vector<Facet> facets = surface(mesh);
    int flat = 0;
    for (const Facet& facet : facets) {
        if (hmesh_test::size_of_vector(doubled_area(facet)) == 0) {
            CHECK(facet.normal == Point3{0, 0, 0});
            ++flat;
        } else CHECK(hmesh_test::size_of_vector(facet.normal) == doctest::Approx(1));
    }
    CHECK(flat >= 2);
    hmesh::MeshView many = mesh.view();
    std::vector<unsigned char> none;
    constexpr std::uint64_t too_many = std::uint64_t{1} << 32U;  // of which none is read
    if (sizeof(std::size_t) > 4) {
        many.face_count = static_cast<std::size_t>(too_many);
        CHECK(hmesh::write_height_stl(many, hmesh::kit::append_to(none)).limit == 4294967295.0);
    }
    many.face_count = std::size_t{1} << 29U;
    CHECK(hmesh::write_solid_stl(many, 0, hmesh::kit::append_to(none)).limit == 536870911.0);
    many = mesh.view(), many.vertex_count = std::size_t{1} << 31U;
    CHECK(hmesh::write_height_stl(many, hmesh::kit::append_to(none)).limit == 2147483647.0);
    CHECK(none.empty());
}

TEST_CASE("a solid is watertight, stands on its base and has the volume between") {
    for (const hmesh::Samples kind : {hmesh::Samples::points, hmesh::Samples::squares}) {
        const Terrain land = terrain(9, 6, kind, hills);
        const std::vector<Facet> facets = solid(land.mesh, 10);
        CHECK(facets.size() == 2 * land.mesh.face_count() + 2 * 2 * (9 + 6));
        check_watertight(facets);
        double below = 0, expected = 0;
        for (const Facet& facet : surface(land.mesh))
            expected += doubled_area(facet)[2] / 2 * ((facet.corners[0][2] + facet.corners[1][2] + facet.corners[2][2]) / 3 - 10);
        for (const Facet& facet : facets) {
            const bool is_base = facet.corners[0][2] == 10 && facet.corners[1][2] == 10 && facet.corners[2][2] == 10;
            if (is_base) below += doubled_area(facet)[2] / 2;
            for (const Point3& corner : facet.corners) CHECK(corner[2] >= 10);
        }
        CHECK(below == doctest::Approx(-54));
        CHECK(volume(facets) == doctest::Approx(expected).epsilon(1e-5));
        hmesh::HeightOptions options;
        options.up = hmesh::UpAxis::y;
        check_watertight(solid(land.mesh, 10, options));
        CHECK(volume(solid(land.mesh, 10, options)) == doctest::Approx(expected).epsilon(1e-5));
    }
}

TEST_CASE("a solid with holes has walls around them") {
    const Terrain land =
        terrain(9, 6, hmesh::Samples::points, hills, [](int x, int y) { return x >= 3 && x <= 5 && y >= 2 && y <= 3; });
    const std::vector<Facet> facets = solid(land.mesh, -5);
    CHECK(facets.size() == 2 * land.mesh.face_count() + 2 * (2 * (9 + 6) + 2 * (3 + 2)));
    check_watertight(facets);
    for (const Facet& facet : facets) {  // nothing is inside of the hole
        const double x = (facet.corners[0][0] + facet.corners[1][0] + facet.corners[2][0]) / 3,
                     y = -(facet.corners[0][1] + facet.corners[1][1] + facet.corners[2][1]) / 3;
        CHECK((x <= 3 || x >= 6 || y <= 2 || y >= 4));
    }
}

TEST_CASE("where holes touch in a vertex each side gets a vertex of its own, a 64th of a sample away at most") {
    const auto chessboard = [](int x, int y) { return (x + y) % 2 == 1; };
    const Terrain land = terrain(8, 7, hmesh::Samples::points, hills, chessboard);
    const std::vector<Facet> facets = solid(land.mesh, 0);
    CHECK(facets.size() == 2 * land.mesh.face_count() + 2 * 4 * 28);
    check_watertight(facets);
    for (const Facet& facet : facets)
        for (const Point3& corner : facet.corners)
            CHECK(std::hypot(corner[0] - std::round(corner[0]), corner[1] - std::round(corner[1])) <= 1.0 / 64 + 1e-6);
    for (const Facet& facet : solid(land.mesh, 0))
        if (facet.corners[0][2] > 1 && facet.corners[1][2] > 1 && facet.corners[2][2] > 1) CHECK(facet.normal[2] > 0);
    // A hole in a corner of the map, cells that hang by a vertex, a fan of more than half a circle.
    check_watertight(solid(terrain(3, 3, hmesh::Samples::points, hills, [](int x, int y) { return x == y && x != 1; }).mesh, 0));
    check_watertight(solid(
        terrain(4, 4, hmesh::Samples::points, hills, [](int x, int y) { return (x == 1 && y == 1) || (x == 2 && y == 2); }).mesh,
        0));
}

TEST_CASE("where thin faces touch in a vertex, it is moved by no more than leaves them as they were turned") {
    // Two faces above one another that meet in the middle, which is `height` away from the side across; of a 64th of a sample as
    // of others they would turn over.
    for (const float height : {0.5F, 0.03125F, 0.0078125F, 0.0009765625F})
        for (const bool is_upright : {false, true}) {
            CAPTURE(height);
            hmesh::Mesh mesh;
            mesh.channels = 1, mesh.peak = 1, mesh.width = 4, mesh.height = 4;
            mesh.positions = {2, 2, 1, 2 - height, 3, 2 - height, 3, 2 + height, 1, 2 + height};
            if (is_upright)
                for (std::size_t v = 0; v < 5; ++v) std::swap(mesh.positions[2 * v], mesh.positions[2 * v + 1]);
            mesh.colors.assign(5, 7.0F);
            mesh.faces = {{0, 1, 2}, {0, 3, 4}};
            if (is_upright)
                for (hmesh::Triangle& face : mesh.faces) std::swap(face[1], face[2]);
            const std::vector<Facet> facets = solid(mesh, 0);
            check_watertight(facets);
            int above = 0;
            for (const Facet& facet : facets) {
                const double up = doubled_area(facet)[2];
                const bool is_above =
                               std::all_of(facet.corners.begin(), facet.corners.end(), [](const auto&p) { return p[2] == 7; }),
                           is_below =
                               std::all_of(facet.corners.begin(), facet.corners.end(), [](const auto&p) { return p[2] == 0; });
                // Twice the area was 2 * height. At most a quarter of the way is gone, and a 64th at most.
                const double least = static_cast<double>(height) * 2 - 2 * std::min(static_cast<double>(height) / 4, 1.0 / 64);
                if (is_above) CHECK(up >= least * 0.999);
                if (is_below) CHECK(up <= -least * 0.999);
                above += is_above ? 1 : 0;
                // Straight into the face, whose sides are alike.
                for (const Point3& corner : facet.corners)
                    if (std::hypot(corner[0] - 2, corner[1] + 2) < 0.02)
                        CHECK(std::abs(is_upright ? corner[1] + 2 : corner[0] - 2) < 1e-6);
            }
            CHECK(above == 2);
            CHECK(volume(facets) > 7 * 1.4 * static_cast<double>(height));
            CHECK(volume(facets) < 7 * 2 * static_cast<double>(height));  // they are apart
        }
}

TEST_CASE("solids of random holes are watertight") {
    hmesh::kit::Random random(7);
    for (int i = 0; i < 40; ++i) {
        std::array<bool, 100> holes{};
        const double share = 0.1 + 0.02 * i;
        for (bool& hole : holes) hole = random.uniform() < share;
        const Terrain land = terrain(10, 10, hmesh::Samples::points, hills,
                                     [&](int x, int y) { return holes[static_cast<std::size_t>(10 * y + x)]; });
        if (land.mesh.face_count() == 0) continue;
        CAPTURE(i);
        const std::vector<Facet> facets = solid(land.mesh, 1);
        check_watertight(facets);
        CHECK(volume(facets) > 0);
    }
}

TEST_CASE("solids of random faces are watertight, and no corner leaves the faces around its vertex") {
    hmesh::kit::Random random(11);
    for (int i = 0; i < 20; ++i) {
        hmesh::Mesh mesh = terrain(8, 8, hmesh::Samples::points, hills).mesh;
        std::vector<hmesh::Triangle> left;
        for (const hmesh::Triangle& face : mesh.faces)
            if (random.uniform() > 0.05 + 0.02 * i) left.push_back(face);
        mesh.faces = left;
        CAPTURE(i);
        const std::vector<Facet> facets = solid(mesh, 1);
        check_watertight(facets);
        for (const Facet& facet : facets)
            for (const Point3& corner : facet.corners) {
                if (corner[2] == 1) continue;
                const double column = std::round(corner[0]), row = std::round(-corner[1]);
                const std::array<double, 2> moved = {corner[0] - column, -corner[1] - row};
                if (std::hypot(moved[0], moved[1]) < 1e-9) continue;
                bool is_inside = false;
                for (const hmesh::Triangle& face : mesh.faces)
                    for (std::size_t k = 0; k < 3; ++k) {
                        const auto at = [&](std::size_t n, std::size_t axis) {
                            return static_cast<double>(mesh.positions[2 * std::size_t{face[(k + n) % 3]} + axis]);
                        };
                        if (at(0, 0) != column || at(0, 1) != row) continue;
                        const auto side = [&](std::size_t n, double sign) {
                            return sign * ((at(n, 0) - column) * moved[1] - (at(n, 1) - row) * moved[0]);
                        };
                        is_inside = is_inside || (side(1, 1) >= -1e-9 && side(2, -1) >= -1e-9);
                    }
                if (!is_inside) FAIL("outside: ", corner[0], " ", corner[1]);
            }
    }
}

TEST_CASE("what no solid can be made of gives a Status and no byte, and a sink that refuses is reported") {
    const Terrain land = terrain(9, 6, hmesh::Samples::points, hills);
    const auto to_surface = [](const hmesh::MeshView& mesh, hmesh::Sink sink) { return hmesh::write_height_stl(mesh, sink); };
    const auto to_solid = [](const hmesh::MeshView& mesh, hmesh::Sink sink) { return hmesh::write_solid_stl(mesh, -50, sink); };
    for (const hmesh_test::Write write : {hmesh_test::Write(to_surface), hmesh_test::Write(to_solid)}) {
        hmesh_test::check_refusing_sinks(terrain(12, 12, hmesh::Samples::points, hills).mesh.view(), write);
        hmesh::Mesh mesh = land.mesh;
        mesh.faces[1][2] = 1000;
        hmesh_test::check_refused(mesh.view(), hmesh::Errc::invalid_argument, write);
        mesh = land.mesh, mesh.colors[5] = std::numeric_limits<float>::infinity();
        hmesh_test::check_refused(mesh.view(), hmesh::Errc::not_finite, write);
        mesh.positions.clear(), mesh.colors.clear(), mesh.faces.clear();
        CHECK(hmesh_test::exported(mesh.view(), write).size() == 84);
    }
    hmesh::Mesh mesh = land.mesh;
    mesh.faces.push_back(mesh.faces[3]);
    hmesh_test::check_refused(mesh.view(), hmesh::Errc::invalid_argument, to_solid);
    mesh = land.mesh;
    std::swap(mesh.faces[3][0], mesh.faces[3][1]);
    hmesh_test::check_refused(mesh.view(), hmesh::Errc::invalid_argument, to_solid);
    mesh = land.mesh;
    mesh.faces[3][0] = mesh.faces[3][1];
    hmesh_test::check_refused(mesh.view(), hmesh::Errc::invalid_argument, to_solid);
    const double lowest = static_cast<double>(*std::min_element(land.mesh.colors.begin(), land.mesh.colors.end()));
    for (const double base :
         {lowest, 100.0, -1e300, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        const auto on_base = [&](const hmesh::MeshView& view, hmesh::Sink sink) {
            return hmesh::write_solid_stl(view, base, sink);
        };
        hmesh_test::check_refused(land.mesh.view(), hmesh::Errc::invalid_argument, on_base);
    }
    CHECK(!solid(land.mesh, lowest - 0.001).empty());
}

TEST_CASE("a solid whose borders touch where floats are too far apart to part them is refused, nearer by and without holes not") {
    const auto chessboard = [](int x, int y) { return (x + y) % 2 == 1; };
    const hmesh::Mesh mesh = terrain(8, 7, hmesh::Samples::points, hills, chessboard).mesh;
    hmesh::HeightOptions far;  // as UTM has it: floats are 1/32 and 1/2 apart
    far.x_origin = 500000, far.y_origin = 5000000;
    for (const hmesh::UpAxis up : {hmesh::UpAxis::z, hmesh::UpAxis::y}) {
        far.up = up;
        const auto write = [&](const hmesh::MeshView& view, hmesh::Sink sink) {
            return hmesh::write_solid_stl(view, 0, sink, far);
        };
        hmesh_test::check_refused(mesh.view(), hmesh::Errc::invalid_argument, write);
    }
    check_watertight(solid(terrain(8, 7, hmesh::Samples::points, hills).mesh, 0, far));
    far.x_step = far.y_step = 100;
    check_watertight(solid(mesh, 0, far));
    far.x_step = far.y_step = 1, far.x_origin = far.y_origin = 1000;
    check_watertight(solid(mesh, 0, far));
}
