#include "hmesh/mesh/torus.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "periodic_sheets.hpp"

using hmesh::Mesh;
using hmesh::Periodic;
using hmesh::Triangle;
using hmesh::kit::check_periodic;
using hmesh::kit::Point;
using hmesh::kit::Torus;
using hmesh::kit::Turns;

namespace {

// A torus of 8 x 6 px: 3 x 3 vertices, those of the last row and column being copies of the first, and jagged by an edge that was
// moved from the right side to the left one.
Mesh sheet() {
    Mesh mesh;
    mesh.channels = 1;
    mesh.width = 8, mesh.height = 6;
    mesh.peak = 255;
    mesh.periodic = Periodic::xy;
    for (const int y : {0, 2, 6})
        for (const int x : {0, 3, 8}) {
            mesh.positions.insert(mesh.positions.end(), {static_cast<float>(x), static_cast<float>(y)});
            mesh.colors.push_back(static_cast<float>(10 * (x % 8) + y % 6));
        }
    for (const std::uint32_t v : {0U, 1U, 3U, 4U}) {
        mesh.faces.push_back({v, v + 1, v + 4});
        mesh.faces.push_back({v, v + 4, v + 3});
    }
    return mesh;
}

std::string why(const Mesh& mesh) { return hmesh::message(check_periodic(mesh.view())).c_str(); }

}  // namespace

TEST_CASE("turns lead from one place of a vertex to another, along the axes that repeat") {
    const Torus both{8, 6, Periodic::xy}, one{8, 6, Periodic::x};
    CHECK((hmesh::kit::turns_between({1, 2}, {17, -4}, both) == Turns{2, -1}));
    CHECK((hmesh::kit::turned({1, 2}, {2, -1}, both) == Point{17, -4}));
    CHECK((hmesh::kit::turns_into({-0.5, 6}, 0, 0, both) == Turns{1, -1}));
    CHECK((hmesh::kit::turns_into({-0.5, 6}, 0, 0, one) == Turns{1, 0}));
    CHECK((hmesh::kit::turns_into({3, 1}, 4, 2, both) == Turns{1, 1}));
}

TEST_CASE("vertices in one place of the torus are tied to the first of them") {
    const std::vector<Point> positions{{0, 0}, {8, 0}, {3, 1}, {3, 7}, {-5, -5}, {8, 6}};
    CHECK((hmesh::kit::tied_vertices(positions, {8, 6, Periodic::xy}) == std::vector<std::uint32_t>{0, 0, 2, 2, 2, 0}));
    CHECK((hmesh::kit::tied_vertices(positions, {8, 6, Periodic::x}) == std::vector<std::uint32_t>{0, 0, 2, 3, 4, 5}));
}

TEST_CASE("vertices far away, or at no place, are tied to none") {
    const double nan = std::numeric_limits<double>::quiet_NaN(), huge = std::numeric_limits<double>::max();
    const std::vector<Point> positions{{0, 0}, {800, 0}, {0, -600}, {nan, 0}, {0, huge}, {-huge, nan}, {8, 6}};
    CHECK((hmesh::kit::tied_vertices(positions, {8, 6, Periodic::xy}) == std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 0}));
}

TEST_CASE("a sheet of a torus is accepted, straight or jagged, and the same sheet of a cylinder") {
    Mesh mesh = sheet();
    CHECK(why(mesh) == "ok");
    CHECK(hmesh_test::sheet_flaw(mesh) == "");
    for (const Periodic along : {Periodic::x, Periodic::y}) {
        mesh.periodic = along;
        for (std::size_t v = 0; v < 9; ++v) {  // only one pair of sides has one colour
            const auto x = static_cast<int>(mesh.positions[2 * v]), y = static_cast<int>(mesh.positions[2 * v + 1]);
            mesh.colors[v] = static_cast<float>(along == Periodic::x ? 10 * (x % 8) + y : 10 * x + y % 6);
        }
        CHECK(why(mesh) == "ok");
    }
    // The face at the right border whose edge is on it comes from the left instead.
    mesh = sheet();
    mesh.positions.insert(mesh.positions.end(), {-5, 0, 0, 2, 0, 0});
    mesh.positions[2 * 10 + 0] = 0;
    mesh.colors.insert(mesh.colors.end(), {mesh.colors[1], mesh.colors[3], mesh.colors[0]});
    mesh.faces[2] = {9, 11, 10};
    CHECK(why(mesh) == "ok");
    CHECK(hmesh_test::sheet_flaw(mesh) == "");
}

TEST_CASE("what is no sheet of a torus is refused with what is wrong with it") {
    Mesh mesh = sheet();
    mesh.periodic = Periodic::none;
    CHECK(why(mesh) == "the mesh is not periodic");
    mesh = sheet();
    mesh.colors[2] = 11;
    CHECK(why(mesh) == "the copies of a vertex on the cut differ in colour, at vertex (2)");
    mesh = sheet();
    mesh.positions[2 * 5 + 1] = 2.5F;  // of the right side alone
    CHECK(why(mesh).find("an edge on the cut has no partner on its other side") == 0);
    mesh = sheet();
    mesh.faces.pop_back();
    CHECK(why(mesh) == "the faces do not tile the image (7)");
    mesh = sheet();
    std::swap(mesh.faces[3][1], mesh.faces[3][2]);
    CHECK(why(mesh) == "a face is flipped or has no area (3)");
    mesh = sheet();
    mesh.faces[0] = mesh.faces[2];
    CHECK(why(mesh) != "ok");
    mesh = sheet();
    mesh.positions[0] = 1e6F;
    CHECK(why(mesh) == "the mesh has a position far outside its image, at vertex (0)");
    // A cylinder's free border is no border of a torus.
    mesh = sheet();
    mesh.height = 7;
    CHECK(why(mesh) != "ok");
}
