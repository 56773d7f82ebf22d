#include "hmesh/io/heights/quantized_mesh.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "hmesh/core/random.hpp"
#include "test_exports.hpp"
#include "test_heights.hpp"

namespace {

using hmesh::Samples;
using hmesh_test::Bytes;
using hmesh_test::Point3;
using hmesh_test::Terrain;
using hmesh_test::terrain;

// A tile as the specification has it decoded.
struct Tile {
    Point3 center{}, sphere{}, occlusion{};
    double low = 0, high = 0, radius = 0;
    std::vector<std::array<int, 3>> vertices;  // u, v and height
    std::vector<hmesh::Triangle> faces;
    std::array<std::vector<std::uint32_t>, 4> sides;  // west, south, east, north
    std::vector<Point3> normals;
    bool is_wide = false;
};

Point3 doubles_in(const Bytes& bytes, std::size_t& at) {
    Point3 out{};
    for (double& value : out) value = hmesh_test::number_in<double>(bytes, at);
    return out;
}

Tile read_tile(const Bytes& bytes) {
    Tile out;
    std::size_t at = 0;
    out.center = doubles_in(bytes, at);
    out.low = static_cast<double>(hmesh_test::number_in<float>(bytes, at));
    out.high = static_cast<double>(hmesh_test::number_in<float>(bytes, at));
    out.sphere = doubles_in(bytes, at);
    out.radius = hmesh_test::number_in<double>(bytes, at);
    out.occlusion = doubles_in(bytes, at);
    CHECK(at == 88);
    out.vertices.resize(hmesh_test::number_in<std::uint32_t>(bytes, at));
    for (std::size_t k = 0; k < 3; ++k) {
        int value = 0;
        for (auto& vertex : out.vertices) {
            const int code = hmesh_test::number_in<std::uint16_t>(bytes, at);
            value += (code >> 1) ^ -(code & 1);
            if (value < 0 || value > 32767) FAIL("a coordinate of more than 15 bits");
            vertex[k] = value;
        }
    }
    out.is_wide = out.vertices.size() > 65536;
    if (out.is_wide) at = (at + 3) / 4 * 4;
    const auto index = [&]() -> std::uint32_t {
        return out.is_wide ? hmesh_test::number_in<std::uint32_t>(bytes, at) : hmesh_test::number_in<std::uint16_t>(bytes, at);
    };
    out.faces.resize(hmesh_test::number_in<std::uint32_t>(bytes, at));
    std::uint32_t highest = 0;
    for (hmesh::Triangle& face : out.faces)
        for (std::uint32_t& v : face) {
            const std::uint32_t code = index();
            if (code > highest) FAIL("an index of a vertex that is not the next");
            v = highest - code;
            if (code == 0) ++highest;
            if (v >= out.vertices.size()) FAIL("an index of no vertex");
        }
    for (std::vector<std::uint32_t>& side : out.sides) {
        side.resize(hmesh_test::number_in<std::uint32_t>(bytes, at));
        for (std::uint32_t& v : side) v = index();
    }
    while (at < bytes.size()) {
        CHECK(hmesh_test::number_in<std::uint8_t>(bytes, at) == 1);
        REQUIRE(hmesh_test::number_in<std::uint32_t>(bytes, at) == 2 * out.vertices.size());
        for (std::size_t v = 0; v < out.vertices.size(); ++v) {
            const double x = hmesh_test::number_in<std::uint8_t>(bytes, at) / 127.5 - 1,
                         y = hmesh_test::number_in<std::uint8_t>(bytes, at) / 127.5 - 1;
            Point3 normal = {x, y, 1 - std::abs(x) - std::abs(y)};
            if (normal[2] < 0) normal = {(1 - std::abs(y)) * (x < 0 ? -1 : 1), (1 - std::abs(x)) * (y < 0 ? -1 : 1), normal[2]};
            out.normals.push_back(normal);
        }
    }
    REQUIRE(at == bytes.size());
    return out;
}

hmesh::QuantizedMeshOptions alps() {
    hmesh::QuantizedMeshOptions tile;
    tile.west = 7, tile.south = 46, tile.east = 7.25, tile.north = 46.2;
    return tile;
}

Bytes bytes_of(const hmesh::Mesh& mesh, const hmesh::HeightSamples& samples, const hmesh::QuantizedMeshOptions& tile) {
    return hmesh_test::exported(mesh.view(), [&](const hmesh::MeshView& view, hmesh::Sink sink) {
        return hmesh::write_quantized_mesh(view, samples, sink, tile);
    });
}

// Of radians, by the book: not the way of the library.
Point3 ecef(double longitude, double latitude, double height) {
    const double a = 6378137, b = 6356752.314245179, c = std::cos(latitude), s = std::sin(latitude);
    const double root = std::sqrt(a * a * c * c + b * b * s * s);
    return {(a * a / root + height) * c * std::cos(longitude), (a * a / root + height) * c * std::sin(longitude),
            (b * b / root + height) * s};
}

constexpr double degree = 3.14159265358979323846 / 180;

Point3 decoded(const Tile& tile, const hmesh::QuantizedMeshOptions& sides, const std::array<int, 3>& at) {
    const double u = at[0] / 32767.0, v = at[1] / 32767.0, h = at[2] / 32767.0;
    return ecef((sides.west + u * (sides.east - sides.west)) * degree, (sides.south + v * (sides.north - sides.south)) * degree,
                tile.low + h * (tile.high - tile.low));
}

double hills(double x, double y) { return 1400 + 700 * std::sin(x / 7) * std::cos(y / 5) + 3 * x; }

// Whether the straight line from an eye to a point enters the ellipsoid.
bool is_hidden(const Point3& eye, const Point3& point) {
    const auto scaled = [](const Point3& p) -> Point3 { return {p[0] / 6378137, p[1] / 6378137, p[2] / 6356752.314245179}; };
    const Point3 from = scaled(eye), to = scaled(point), along = hmesh_test::minus(to, from);
    const double nearest = -hmesh_test::inner(from, along) / hmesh_test::inner(along, along);
    if (nearest <= 0 || nearest >= 1) return false;
    const Point3 at = {from[0] + nearest * along[0], from[1] + nearest * along[1], from[2] + nearest * along[2]};
    return hmesh_test::inner(at, at) < 1;
}

}  // namespace

TEST_CASE("a tile has the mesh's vertices and faces, to 15 bits, in the order in which faces name them") {
    for (const Samples kind : {Samples::points, Samples::squares}) {
        const Terrain land = terrain(20, 14, kind, hills);
        const Tile tile = read_tile(bytes_of(land.mesh, land.samples.view(), alps()));
        REQUIRE(tile.vertices.size() == land.mesh.vertex_count());
        REQUIRE(tile.faces.size() == land.mesh.face_count());
        CHECK(!tile.is_wide);
        std::uint32_t next = 0;
        for (std::size_t f = 0; f < tile.faces.size(); ++f) {
            const auto [a, b, c] = land.mesh.faces[f];
            const hmesh::Triangle expected = {a, c, b};
            for (std::size_t k = 0; k < 3; ++k) {
                CHECK(tile.faces[f][k] <= next);
                if (tile.faces[f][k] == next) ++next;
                const std::array<int, 3>& at = tile.vertices[tile.faces[f][k]];
                const std::size_t v = expected[k];
                const double step = (tile.high - tile.low) / 32767;
                CHECK(std::abs(at[0] / 32767.0 * 20 - static_cast<double>(land.mesh.positions[2 * v])) <= 10.0001 / 32767);
                CHECK(std::abs((1 - at[1] / 32767.0) * 14 - static_cast<double>(land.mesh.positions[2 * v + 1])) <=
                      7.0001 / 32767);
                CHECK(std::abs(tile.low + at[2] * step - static_cast<double>(land.mesh.colors[v])) <= 0.5001 * step);
            }
            const std::array<int, 3>&p = tile.vertices[tile.faces[f][0]], &q = tile.vertices[tile.faces[f][1]],
                                  &r = tile.vertices[tile.faces[f][2]];
            CHECK((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]) > 0);  // counter-clockwise from above
        }
    }
}

TEST_CASE("a tile lists the vertices of its sides, from west to east and from south to north, and no others") {
    hmesh::Mesh mesh =
        terrain(20, 14, Samples::points, hills, [](int x, int y) { return x > 4 && x < 9 && y > 3 && y < 7; }).mesh;
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v)  // so near a side that they would round to it
        for (std::size_t k = 0; k < 2; ++k) {
            float& at = mesh.positions[2 * v + k];
            const float most = k == 0 ? 20 : 14;
            if (at == 1) at = 1.0F / 16384;
            if (at == most - 1) at = most - 1.0F / 16384;
        }
    const Tile tile = read_tile(bytes_of(mesh, {}, alps()));
    const std::array<std::size_t, 4> counts = {15, 21, 15, 21};
    for (std::size_t side = 0; side < 4; ++side) {
        const std::size_t fixed = side % 2, along = 1 - fixed;
        const int at = side < 2 ? 0 : 32767;
        REQUIRE(tile.sides[side].size() == counts[side]);
        std::set<std::uint32_t> listed(tile.sides[side].begin(), tile.sides[side].end());
        int before = -1;
        for (const std::uint32_t v : tile.sides[side]) {
            CHECK(tile.vertices[v][along] > before);
            before = tile.vertices[v][along];
        }
        for (std::uint32_t v = 0; v < tile.vertices.size(); ++v) CHECK((tile.vertices[v][fixed] == at) == (listed.count(v) == 1));
        // Those so near to the side are as near as they may be, a step from it.
        const int next = side < 2 ? 1 : 32766;
        CHECK(std::count_if(tile.vertices.begin(), tile.vertices.end(), [&](const auto& v) { return v[fixed] == next; }) ==
              static_cast<std::ptrdiff_t>(counts[side]));
    }
}

TEST_CASE("the sphere holds all vertices, is hardly larger than it must be, and the heights are within the header's") {
    for (const double size : {0.01, 1.0, 20.0, 180.0}) {
        hmesh::QuantizedMeshOptions sides = alps();
        sides.east = sides.west + size, sides.south = std::max(-90.0, sides.north - size);
        const Terrain land = terrain(20, 14, Samples::points, hills);
        const Tile tile = read_tile(bytes_of(land.mesh, {}, sides));
        CHECK(tile.center == tile.sphere);
        double farthest = 0, widest = 0;
        for (const auto& a : tile.vertices) {
            farthest = std::max(farthest, hmesh_test::size_of_vector(hmesh_test::minus(decoded(tile, sides, a), tile.sphere)));
            for (const auto& b : tile.vertices)
                widest = std::max(
                    widest, hmesh_test::size_of_vector(hmesh_test::minus(decoded(tile, sides, a), decoded(tile, sides, b))));
        }
        CHECK(tile.radius >= farthest);
        CHECK(tile.radius <= farthest + 0.002);
        CHECK(tile.radius < (size > 100 ? 0.8 : 0.55) * widest);  // no sphere is below 0.5
        const auto [low, high] = std::minmax_element(land.mesh.colors.begin(), land.mesh.colors.end());
        CHECK(tile.low == static_cast<double>(*low));
        CHECK(tile.high == static_cast<double>(*high));
    }
}

TEST_CASE("the sphere is around the middle of the vertices' box, which lies as the ground does in the middle of the tile") {
    for (const double south : {-70.0, -20.0, 30.0, 89.3}) {  // the last one where a degree of longitude is hardly a kilometre
        hmesh::QuantizedMeshOptions sides;
        sides.west = 160, sides.east = 175, sides.south = south, sides.north = south < 89 ? south + 10 : 89.9;
        sides.z.scale = 4;
        const Tile tile = read_tile(bytes_of(terrain(20, 14, Samples::points, hills).mesh, {}, sides));
        const double lon = 167.5 * degree, lat = (sides.south + sides.north) / 2 * degree;
        const std::array<Point3, 3> axes = {{{-std::sin(lon), std::cos(lon), 0},
                                             {-std::sin(lat) * std::cos(lon), -std::sin(lat) * std::sin(lon), std::cos(lat)},
                                             {std::cos(lat) * std::cos(lon), std::cos(lat) * std::sin(lon), std::sin(lat)}}};
        double farthest = 0;
        for (const Point3& axis : axes) {
            double low = 1e9, high = -1e9;
            for (const auto& at : tile.vertices) {
                const double along = hmesh_test::inner(decoded(tile, sides, at), axis);
                low = std::min(low, along), high = std::max(high, along);
            }
            CHECK(std::abs(hmesh_test::inner(tile.center, axis) - (low + high) / 2) < 1e-3);  // m
        }
        for (const auto& at : tile.vertices)
            farthest = std::max(farthest, hmesh_test::size_of_vector(hmesh_test::minus(decoded(tile, sides, at), tile.center)));
        CHECK(tile.radius >= farthest);
        CHECK(tile.radius <= farthest + 0.002);
    }
}

TEST_CASE("the heights that stand for both ends are floats, the next one below and the next one above what is asked for") {
    const Terrain land = terrain(4, 3, Samples::points, [](double, double) { return 0.0; });
    // Of each pair the nearest floats are one above and one below, in some order.
    for (const double shift : {0.1, 0.2, 0.3, 0.7})
        for (const double sign : {-1.0, 1.0}) {
            hmesh::QuantizedMeshOptions sides = alps();
            sides.low = sign * (1000 + shift) - 2000, sides.high = sign * (1000 + shift) + 2000;
            const Tile tile = read_tile(bytes_of(land.mesh, {}, sides));
            const auto low = static_cast<float>(tile.low), high = static_cast<float>(tile.high);
            CHECK(tile.low <= sides.low);
            CHECK(static_cast<double>(std::nextafter(low, 1e9F)) > sides.low);
            CHECK(tile.high >= sides.high);
            CHECK(static_cast<double>(std::nextafter(high, -1e9F)) < sides.high);
        }
    // Floats stay what they are.
    hmesh::QuantizedMeshOptions sides = alps();
    sides.low = -0.25, sides.high = 8.5;
    const Tile tile = read_tile(bytes_of(land.mesh, {}, sides));
    CHECK(tile.low == -0.25);
    CHECK(tile.high == 8.5);
}

TEST_CASE("a range of heights that is not given is that of all vertices, and may be far below a metre") {
    for (std::size_t lowest = 0; lowest < 4; ++lowest)
        for (std::size_t highest = 0; highest < 4; ++highest) {
            if (lowest == highest) continue;
            hmesh::Mesh mesh = terrain(1, 1, Samples::points, [](double, double) { return 7.0; }).mesh;
            mesh.colors[lowest] = 6.875F, mesh.colors[highest] = 7.25F;
            const Tile tile = read_tile(bytes_of(mesh, {}, alps()));
            CHECK(tile.low == 6.875);
            CHECK(tile.high == 7.25);
            std::multiset<int> heights;
            for (const auto& at : tile.vertices) heights.insert(at[2]);
            CHECK(heights == std::multiset<int>{0, 10922, 10922, 32767});  // a third of the way
        }
}

TEST_CASE("what is hidden with the occlusion point is all hidden: eyes anywhere, brute force") {
    hmesh::kit::Random random(3);
    for (const double size : {0.1, 5.0, 60.0, 150.0}) {
        hmesh::QuantizedMeshOptions sides;
        sides.west = -20, sides.east = -20 + size, sides.south = -35, sides.north = std::min(90.0, -35 + size);
        sides.z.scale = 3;
        const Terrain land = terrain(12, 12, Samples::points, hills);
        const Tile tile = read_tile(bytes_of(land.mesh, {}, sides));
        std::vector<Point3> points;
        for (const auto& at : tile.vertices) points.push_back(decoded(tile, sides, at));
        const Point3 occlusion = {tile.occlusion[0] * 6378137, tile.occlusion[1] * 6378137,
                                  tile.occlusion[2] * 6356752.314245179};
        int hidden = 0, wrong = 0, tight = 0, all_hidden = 0;
        for (int i = 0; i < 4000; ++i) {
            const Point3 eye =
                ecef(random.uniform() * 6.3, std::asin(2 * random.uniform() - 1), std::exp(3 + 15 * random.uniform()));
            const bool says = is_hidden(eye, occlusion);
            int visible = 0;
            for (const Point3& point : points) visible += is_hidden(eye, point) ? 0 : 1;
            hidden += says ? 1 : 0;
            wrong += says && visible > 0 ? 1 : 0;
            all_hidden += visible == 0 ? 1 : 0;
            tight += says && visible == 0 ? 1 : 0;
        }
        CAPTURE(size);
        CHECK(wrong == 0);
        CHECK(hidden > 100);
        if (size < 10) CHECK(tight > 0.9 * all_hidden);
    }
}

TEST_CASE("a tile of half the globe has an occlusion point too") {
    hmesh::QuantizedMeshOptions sides;
    sides.west = -180, sides.east = 0, sides.south = -90, sides.north = 90;
    const Terrain land = terrain(12, 12, Samples::points, hills);
    const Tile tile = read_tile(bytes_of(land.mesh, land.samples.view(), sides));
    for (const double coordinate : tile.occlusion) CHECK(std::isfinite(coordinate));
    CHECK(hmesh_test::size_of_vector(tile.occlusion) > 1000);
    for (const Point3& normal : tile.normals) CHECK(std::isfinite(hmesh_test::size_of_vector(normal)));
}

TEST_CASE("a level tile of nearly half the globe hides behind a point near to it, on the equator where there is no other") {
    hmesh::QuantizedMeshOptions sides;
    sides.west = -88, sides.east = 88, sides.south = -80, sides.north = 60;  // from any other latitude a corner is too far away
    const Tile tile = read_tile(bytes_of(terrain(12, 12, Samples::points, [](double, double) { return 0.0; }).mesh, {}, sides));
    const double reach = hmesh_test::size_of_vector(tile.occlusion);  // radii
    CHECK(tile.occlusion[0] == doctest::Approx(reach));
    // The corners in the south are the farthest, by an angle of acos(cos 80 cos 88) on the sphere that the globe becomes.
    const double south = std::atan(std::tan(80 * degree) * 6356752.314245179 / 6378137);
    CHECK(reach == doctest::Approx(1 / (std::cos(south) * std::cos(88 * degree))).epsilon(1e-6));
}

TEST_CASE("normals are those of the surface on the globe, to the bytes that hold them") {
    // A slope of 0.2 to the east and -0.1 to the north, in metres: the samples' steps are those of the latitude, and longer up
    // high. On each side of the equator and in each quarter around the axis bytes say otherwise which way is up.
    struct Land {
        double west, south, offset;
    };
    const double e2 = 0.00669437999014;
    for (const Land& at : {Land{100, -40.2, 0}, Land{100, -40.2, 1e6}, Land{20, 35, 0}, Land{130, 35, 0}, Land{-130, 35, 0},
                           Land{-40, 5, 0}, Land{-40, 70, 1e6}, Land{-100, -60, 0}, Land{-30, -75, 0}, Land{60, -20, 0}})
        for (const Samples kind : {Samples::points, Samples::squares}) {
            CAPTURE(at.west);
            CAPTURE(at.south);
            hmesh::QuantizedMeshOptions sides;
            sides.west = at.west, sides.south = at.south, sides.east = at.west + 0.2, sides.north = at.south + 0.2;
            sides.z.offset = at.offset;
            const double c = std::cos((at.south + 0.1) * degree), s = std::sin((at.south + 0.1) * degree);
            const double across = 6378137 / std::sqrt(1 - e2 * s * s), along = across * (1 - e2) / (1 - e2 * s * s);
            const double east = (across + at.offset) * c * 0.2 / 10 * degree, north = (along + at.offset) * 0.2 / 8 * degree;
            const Terrain land = terrain(10, 8, kind, [&](double x, double y) { return 0.2 * x * east + 0.1 * y * north; });
            const Tile by_samples = read_tile(bytes_of(land.mesh, land.samples.view(), sides)),
                       by_faces = read_tile(bytes_of(land.mesh, {}, sides));
            REQUIRE(by_samples.normals.size() == by_samples.vertices.size());
            REQUIRE(by_faces.normals.size() == by_samples.vertices.size());
            double farthest = 0, farthest_by_faces = 0;
            for (std::size_t v = 0; v < by_samples.vertices.size(); ++v) {
                const double lon = (at.west + 0.2 * by_samples.vertices[v][0] / 32767) * degree,
                             lat = (at.south + 0.2 * by_samples.vertices[v][1] / 32767) * degree;
                const Point3 e = {-std::sin(lon), std::cos(lon), 0},
                             n = {-std::sin(lat) * std::cos(lon), -std::sin(lat) * std::sin(lon), std::cos(lat)},
                             up = {std::cos(lat) * std::cos(lon), std::cos(lat) * std::sin(lon), std::sin(lat)};
                Point3 expected{};
                for (std::size_t k = 0; k < 3; ++k) expected[k] = -0.2 * e[k] + 0.1 * n[k] + up[k];
                farthest = std::max(farthest, hmesh_test::angle_between(by_samples.normals[v], expected));
                farthest_by_faces = std::max(farthest_by_faces, hmesh_test::angle_between(by_faces.normals[v], expected));
            }
            CHECK(farthest < 0.8);  // degrees: 0.7 is what two bytes cost
            CHECK(farthest_by_faces < 0.9);
        }
    hmesh::QuantizedMeshOptions sides;
    // All samples of the row at a pole are one: there is no slope to the east, and one to the north as elsewhere.
    sides.west = 30, sides.east = 60, sides.south = -90, sides.north = -89.9;
    const double step = 6378137 / std::sqrt(1 - e2) * 0.1 / 8 * degree;  // m, to the north
    const Terrain cone = terrain(8, 8, Samples::points, [&](double x, double y) { return 30 * x - 0.3 * y * step; });
    const Tile tip = read_tile(bytes_of(cone.mesh, cone.samples.view(), sides));
    REQUIRE(tip.sides[1].size() == 9);
    for (const std::uint32_t v : tip.sides[1]) {
        const double lon = (30 + 30 * tip.vertices[v][0] / 32767.0) * degree;
        CHECK(hmesh_test::angle_between(tip.normals[v], {-0.3 * std::cos(lon), -0.3 * std::sin(lon), -1}) < 0.8);
    }
    // At a pole the side is one place: faces with two corners there have no area, and say nothing.
    sides.south = -90, sides.north = -60;
    for (int west = -180; west < 180; west += 30) {
        sides.west = west, sides.east = west + 30;
        const Tile pole = read_tile(bytes_of(terrain(3, 3, Samples::points, [](double, double) { return 5.0; }).mesh, {}, sides));
        for (std::size_t v = 0; v < pole.vertices.size(); ++v)  // the western one is a corner of such a face alone
            if (pole.vertices[v][0] == 0 && pole.vertices[v][1] == 0)
                CHECK(hmesh_test::angle_between(pole.normals[v], {0, 0, -1}) < 0.9);
    }
    hmesh::QuantizedMeshOptions none = sides;
    none.has_normals = false;
    CHECK(read_tile(bytes_of(terrain(4, 3, Samples::points, hills).mesh, {}, none)).normals.empty());
}

TEST_CASE("indices have 32 bits above 65,536 vertices, at a multiple of 4, and 16 bits below 65,536") {
    for (const int rows : {254, 255, 256}) {
        const Terrain land = terrain(255, rows, Samples::points, hills);
        const Tile tile = read_tile(bytes_of(land.mesh, {}, alps()));
        CAPTURE(rows);
        // Of 65,536 vertices the first could not be named at last: one more makes it 32 bits.
        CHECK(tile.vertices.size() == land.mesh.vertex_count() + (rows == 255 ? 1 : 0));
        CHECK(tile.is_wide == (rows >= 255));
        CHECK(tile.faces.size() == land.mesh.face_count());
        for (std::size_t side = 0; side < 4; ++side)
            CHECK(tile.sides[side].size() == static_cast<std::size_t>(side % 2 == 0 ? rows + 1 : 256));
        bool is_same = true;
        for (std::size_t f = 0; f < tile.faces.size(); ++f) {
            const auto [a, b, c] = land.mesh.faces[f];
            const hmesh::Triangle expected = {a, c, b};
            for (std::size_t k = 0; k < 3; ++k) {
                const double u = tile.vertices[tile.faces[f][k]][0] / 32767.0 * 255;
                is_same = is_same && std::abs(u - static_cast<double>(land.mesh.positions[2 * std::size_t{expected[k]}])) < 0.01;
            }
        }
        CHECK(is_same);
    }
}

TEST_CASE("vertices that no face names are left out") {
    hmesh::Mesh mesh = terrain(4, 3, Samples::points, hills).mesh;
    mesh.faces.resize(2);
    const Tile tile = read_tile(bytes_of(mesh, {}, alps()));
    CHECK(tile.vertices.size() == 4);
    CHECK(tile.normals.size() == 4);
    CHECK(tile.sides[0].size() == 2);
    CHECK(tile.sides[2].empty());
}

TEST_CASE("neighbouring tiles with one range of heights share the vertices and the normals of their side") {
    const Terrain whole = terrain(32, 16, Samples::points, hills);
    const Terrain left = terrain(16, 16, Samples::points, hills),
                  right = terrain(16, 16, Samples::points, [](double x, double y) { return hills(x + 16, y); });
    hmesh::QuantizedMeshOptions west = alps(), east = alps();
    west.low = east.low = 500, west.high = east.high = 2500.1;
    west.east = east.west = 7.1, east.east = 7.2;
    const Tile a = read_tile(bytes_of(left.mesh, whole.samples.view(), west)),
               b = read_tile(bytes_of(right.mesh, {whole.samples.view(), {}, 16, 0}, east));
    REQUIRE(a.sides[2].size() == 17);
    REQUIRE(b.sides[0].size() == 17);
    CHECK(a.low == b.low);
    CHECK(a.high >= 2500.1);
    CHECK(a.high == b.high);
    for (std::size_t i = 0; i < 17; ++i) {
        const std::uint32_t v = a.sides[2][i], w = b.sides[0][i];
        CHECK(a.vertices[v][1] == b.vertices[w][1]);
        CHECK(a.vertices[v][2] == b.vertices[w][2]);
        CHECK(a.normals[v] == b.normals[w]);
    }
}

TEST_CASE("the rounded mesh is what a reader of the tile has, half a step from the one that was at most") {
    for (const Samples kind : {Samples::points, Samples::squares}) {
        Terrain land = terrain(20, 14, kind, hills);
        for (std::size_t i = 0; i < land.mesh.positions.size(); ++i) {
            float& at = land.mesh.positions[i];
            const float most = i % 2 == 0 ? 20 : 14;
            if (at > 0 && at < most) at += 0.3F * static_cast<float>(std::sin(static_cast<double>(i)));
        }
        hmesh::QuantizedMeshOptions sides = alps();
        sides.z = {0, 0.25, 100};
        const hmesh::TileRounding rounding = hmesh::rounded_to_tile(land.mesh.view(), sides);
        REQUIRE(rounding.status);
        const Tile tile = read_tile(bytes_of(land.mesh, {}, sides));
        REQUIRE(rounding.mesh.vertex_count() == land.mesh.vertex_count());
        CHECK(rounding.mesh.faces == land.mesh.faces);
        CHECK(rounding.mesh.samples == kind);
        for (std::size_t f = 0; f < tile.faces.size(); ++f) {
            const auto [a, b, c] = land.mesh.faces[f];
            const hmesh::Triangle expected = {a, c, b};
            for (std::size_t k = 0; k < 3; ++k) {
                const std::array<int, 3>& at = tile.vertices[tile.faces[f][k]];
                const std::size_t v = expected[k];
                CHECK(static_cast<double>(rounding.mesh.positions[2 * v]) == doctest::Approx(at[0] / 32767.0 * 20).epsilon(1e-6));
                CHECK(static_cast<double>(rounding.mesh.positions[2 * v + 1]) ==
                      doctest::Approx((1 - at[1] / 32767.0) * 14).epsilon(1e-6));
                const double metres = tile.low + (tile.high - tile.low) * at[2] / 32767;
                CHECK(static_cast<double>(rounding.mesh.colors[v]) == doctest::Approx((metres - 100) / 0.25).epsilon(1e-6));
            }
        }
        const double step = (tile.high - tile.low) / 32767 / 0.25;
        for (std::size_t v = 0; v < land.mesh.vertex_count(); ++v) {
            for (std::size_t k = 0; k < 2; ++k)
                CHECK(std::abs(static_cast<double>(rounding.mesh.positions[2 * v + k] - land.mesh.positions[2 * v + k])) <=
                      0.51 * (k == 0 ? 20 : 14) / 32767);
            CHECK(std::abs(static_cast<double>(rounding.mesh.colors[v] - land.mesh.colors[v])) <= 0.51 * step);
        }
        CHECK(rounding.mesh.positions != land.mesh.positions);
    }
}

TEST_CASE("the rounded mesh has other heights and positions, and all else that the mesh has") {
    hmesh::Mesh mesh = terrain(5, 4, Samples::points, hills).mesh;
    const std::vector<float> heights = mesh.colors;
    mesh.channels = 3, mesh.peak = 100;
    mesh.periodic = hmesh::Periodic::x;
    mesh.colors.clear();
    for (const float height : heights) mesh.colors.insert(mesh.colors.end(), {1, height, 3});
    hmesh::QuantizedMeshOptions sides = alps();
    sides.z.channel = 1;
    const hmesh::TileRounding rounding = hmesh::rounded_to_tile(mesh.view(), sides);
    REQUIRE(rounding.status);
    CHECK(rounding.mesh.width == mesh.width);
    CHECK(rounding.mesh.height == mesh.height);
    CHECK(rounding.mesh.channels == 3);
    CHECK(rounding.mesh.peak == 100);
    CHECK(rounding.mesh.premultiplied == mesh.premultiplied);
    CHECK(rounding.mesh.periodic == mesh.periodic);
    CHECK(rounding.mesh.samples == mesh.samples);
    CHECK(rounding.mesh.faces == mesh.faces);
    REQUIRE(rounding.mesh.colors.size() == mesh.colors.size());
    for (std::size_t v = 0; v < heights.size(); ++v) {
        CHECK(rounding.mesh.colors[3 * v] == 1);
        CHECK(std::abs(rounding.mesh.colors[3 * v + 1] - heights[v]) < 0.05F);
        CHECK(rounding.mesh.colors[3 * v + 2] == 3);
    }
}

TEST_CASE("level land, one cell and a scale of 0 are tiles too") {
    for (const auto& [columns, value] : std::map<int, double>{{1, 5.0}, {3, -20.5}}) {
        const double height = value;
        const Terrain land = terrain(columns, columns, Samples::points, [=](double, double) { return height; });
        const Tile tile = read_tile(bytes_of(land.mesh, land.samples.view(), alps()));
        CHECK(tile.low == height);
        CHECK(tile.high == height);
        for (const auto& at : tile.vertices) CHECK(at[2] == 0);
        hmesh::QuantizedMeshOptions sides = alps();
        sides.z = {0, 0, 7};
        CHECK(read_tile(bytes_of(land.mesh, land.samples.view(), sides)).low == 7);
        CHECK(hmesh::rounded_to_tile(land.mesh.view(), sides).mesh.colors == land.mesh.colors);
    }
}

TEST_CASE("no vertex may be beyond any side of the image, and a Status tells where it is and how far it may go") {
    const Terrain land = terrain(30, 20, Samples::points, hills);
    const std::size_t last = land.mesh.vertex_count() - 1;
    for (const std::size_t v : {std::size_t{0}, std::size_t{1}, last})
        for (const std::size_t k : {std::size_t{0}, std::size_t{1}})
            for (const bool is_low : {false, true}) {
                const float most = k == 0 ? 30 : 20, place = is_low ? -0.25F : most + 0.25F;
                hmesh::Mesh mesh = land.mesh;
                mesh.positions[2 * v + k] = place;
                const hmesh::TileRounding rounding = hmesh::rounded_to_tile(mesh.view(), alps());
                CHECK(rounding.status.code == hmesh::Errc::invalid_argument);
                CHECK(rounding.status.value == static_cast<double>(place));
                CHECK(rounding.status.limit == (is_low ? 0 : static_cast<double>(most)));
                CHECK(rounding.mesh.vertex_count() == 0);
                CHECK(rounding.mesh.faces.empty());
            }
}

TEST_CASE("heights may be those of the range and no others, and a Status tells the height and the end that it is beyond") {
    const hmesh::Mesh mesh = terrain(1, 1, Samples::points, [](double x, double y) { return 10 * x + 20 * y; }).mesh;  // 0 to 30
    hmesh::QuantizedMeshOptions sides = alps();
    sides.low = 0, sides.high = 30;
    CHECK(hmesh::rounded_to_tile(mesh.view(), sides).status);
    sides.low = 1;
    const hmesh::Status low = hmesh::rounded_to_tile(mesh.view(), sides).status;
    CHECK(low.code == hmesh::Errc::invalid_argument);
    CHECK(low.value == 0);
    CHECK(low.limit == 1);
    sides.low = -1, sides.high = 29;
    const hmesh::Status high = hmesh::rounded_to_tile(mesh.view(), sides).status;
    CHECK(high.code == hmesh::Errc::invalid_argument);
    CHECK(high.value == 30);
    CHECK(high.limit == 29);
}

TEST_CASE("sides are degrees of the globe to its ends, at most half of it from west to east") {
    const hmesh::Mesh mesh = terrain(1, 1, Samples::points, [](double, double) { return 0.0; }).mesh;
    struct Sides {
        double west, south, east, north;
        bool is_good;
    };
    for (const Sides& of : {Sides{-180, -90, 0, 90, true}, Sides{-180.001, -90, -1, 90, false}, Sides{180, -90, 360, 90, true},
                            Sides{180.001, -90, 300, 90, false}, Sides{-180, -90, 0.001, 90, false},
                            Sides{-180, -90.001, 0, 90, false}, Sides{-180, -90, 0, 90.001, false},
                            Sides{-180, 90, 0, 90.001, false}, Sides{5, 7, 5, 8, false}, Sides{5, 7, 6, 7, false}}) {
        hmesh::QuantizedMeshOptions tile;
        tile.west = of.west, tile.south = of.south, tile.east = of.east, tile.north = of.north;
        CAPTURE(of.west);
        CAPTURE(of.east);
        CHECK(static_cast<bool>(hmesh::rounded_to_tile(mesh.view(), tile).status) == of.is_good);
    }
    hmesh::MeshView many = mesh.view();
    many.face_count = std::size_t{1} << 31U;  // of which none is read
    CHECK(hmesh::rounded_to_tile(many, alps()).status.value == 2147483648.0);
    many = mesh.view(), many.vertex_count = std::size_t{1} << 31U;
    CHECK(hmesh::rounded_to_tile(many, alps()).status.value == 2147483648.0);
}

TEST_CASE("what no tile holds gives a Status and no byte, and a sink that refuses is reported") {
    const Terrain land = terrain(30, 30, Samples::points, hills);
    const auto write_alps = [](const hmesh::MeshView& mesh, hmesh::Sink sink) {
        return hmesh::write_quantized_mesh(mesh, {}, sink, alps());
    };
    hmesh_test::check_refusing_sinks(land.mesh.view(), write_alps);
    hmesh::Mesh mesh = land.mesh;
    mesh.faces[1][2] = 1000;
    hmesh_test::check_refused(mesh.view(), hmesh::Errc::invalid_argument, write_alps);
    mesh = land.mesh, mesh.colors[5] = std::numeric_limits<float>::quiet_NaN();
    hmesh_test::check_refused(mesh.view(), hmesh::Errc::not_finite, write_alps);
    mesh = land.mesh, mesh.colors[5] = -7e6F;
    hmesh_test::check_refused(mesh.view(), hmesh::Errc::invalid_argument, write_alps);
    mesh = land.mesh, mesh.positions.clear(), mesh.colors.clear(), mesh.faces.clear();
    hmesh_test::check_refused(mesh.view(), hmesh::Errc::invalid_argument, write_alps);
    const auto refuses = [&](const hmesh::QuantizedMeshOptions& tile) {
        const auto write = [&](const hmesh::MeshView& view, hmesh::Sink sink) {
            return hmesh::write_quantized_mesh(view, {}, sink, tile);
        };
        hmesh_test::check_refused(land.mesh.view(), hmesh::Errc::invalid_argument, write);
        CHECK(!hmesh::rounded_to_tile(land.mesh.view(), tile).status);
    };
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double bad : {nan, 200.0, 7.25}) {
        hmesh::QuantizedMeshOptions tile = alps();
        tile.west = bad;
        refuses(tile);
    }
    for (const double bad : {nan, 200.0, 7.0, 6.0}) {
        hmesh::QuantizedMeshOptions tile = alps();
        tile.east = bad;
        refuses(tile);
    }
    for (const double bad : {nan, 91.0, 46.0}) {
        hmesh::QuantizedMeshOptions tile = alps();
        tile.north = bad;
        refuses(tile);
    }
    for (const double bad : {nan, -91.0, 46.2}) {
        hmesh::QuantizedMeshOptions tile = alps();
        tile.south = bad;
        refuses(tile);
    }
    hmesh::QuantizedMeshOptions tile = alps();
    tile.low = 1000, tile.high = 3000;  // the hills go lower
    refuses(tile);
    tile.low = 0, tile.high = -1;
    refuses(tile);
    tile = alps(), tile.z.channel = 1;
    refuses(tile);
    refuses({});
}
