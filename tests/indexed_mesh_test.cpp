#include "hmesh/tiles/indexed_mesh.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "even_mesh.hpp"
#include "hmesh/core/random.hpp"
#include "test_images.hpp"
#include "test_indexed_meshes.hpp"
#include "test_meshes.hpp"

namespace kit = hmesh::kit;
using hmesh::Triangle;
using hmesh::kit::Color;
using hmesh::kit::IndexedMesh;
using hmesh::kit::Point;
using hmesh::kit::Random;
using hmesh_test::make_indexed;
using hmesh_test::Shape;

namespace {

IndexedMesh<1> whole(int width, int height, const std::vector<Point>& positions, const std::vector<Triangle>& triangles) {
    IndexedMesh<1> mesh;
    mesh.width = width;
    mesh.height = height;
    for (const Point p : positions) mesh.add(p, Color<1>::zero());
    mesh.faces = triangles;
    return mesh;
}

// Four faces around vertex 4 in the middle of 8 x 6 px.
IndexedMesh<1> fan() {
    return whole(8, 6, {{0, 0}, {8, 0}, {8, 6}, {0, 6}, {4, 3}}, {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}});
}

// What check() finds, and where.
std::pair<std::string, std::int64_t> fault(const IndexedMesh<1>& mesh) {
    const hmesh::Status status = check(mesh);
    CHECK_EQ(static_cast<bool>(status), std::string(status.what).empty());
    return {status.what, status.value};
}
using Fault = std::pair<std::string, std::int64_t>;

// How many faces cover a point that lies on no edge.
int cover(const IndexedMesh<1>& mesh, Point p) {
    int count = 0;
    for (const Triangle& t : mesh.faces) {
        int left = 0, right = 0;
        for (std::size_t k = 0; k < 3; ++k)
            ++(kit::orient2d(mesh.positions[t[k]], mesh.positions[t[(k + 1) % 3]], p) > 0 ? left : right);
        count += left == 3 || right == 3 ? 1 : 0;
    }
    return count;
}

}  // namespace

TEST_CASE("meshes of every shape are accepted, and all of their edges and corners may be on the border") {
    const auto image = hmesh_test::scene<std::uint8_t, 1>(40, 31, 1);
    for (const Shape shape : hmesh_test::all_shapes) {
        const IndexedMesh<1> mesh = make_indexed(image, shape, 90, 3);
        CHECK(mesh.vertex_count() > 50);
        hmesh_test::prove(mesh);
    }
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 17}, {23, 1}, {2, 2}})
        hmesh_test::prove(make_indexed(hmesh_test::noise<float, 1>(width, height, 1), Shape::grid, 6, 1));
    const auto wheel = hmesh_test::wheel(64, 36);
    hmesh_test::prove(whole(64, 64, wheel.positions, wheel.triangles));
    hmesh_test::prove(fan());

    const kit::ImageSource<1> source(image.view());
    hmesh_test::prove(hmesh_test::even_mesh(source, 60));
}

TEST_CASE("arrays of vertices that differ in length are found") {
    IndexedMesh<1> mesh = fan();
    mesh.colors.pop_back();
    CHECK(fault(mesh) == Fault{"the arrays of vertices differ in length", 5});
    mesh = fan();
    mesh.dirty.push_back(0);
    CHECK(fault(mesh) == Fault{"the arrays of vertices differ in length", 5});
}

TEST_CASE("an isolated vertex, a corner that is no vertex and a corner that comes twice are found") {
    IndexedMesh<1> mesh = fan();
    mesh.add({2, 2}, Color<1>::zero());
    CHECK(fault(mesh) == Fault{"a vertex belongs to no triangle", 5});
    mesh = fan();
    mesh.faces[2][1] = 5;
    CHECK(fault(mesh) == Fault{"a triangle names a vertex that does not exist", 2});
    mesh = fan();
    mesh.faces[3][1] = mesh.faces[3][2];
    CHECK(fault(mesh) == Fault{"a triangle names a vertex twice", 3});
}

TEST_CASE("a flipped face is found, whether its corners or its neighbors' places were exchanged") {
    IndexedMesh<1> mesh = fan();
    std::swap(mesh.faces[1][0], mesh.faces[1][1]);
    CHECK(fault(mesh).first == "an edge is used twice in one direction, first by triangle");
    mesh = fan();
    for (Triangle& t : mesh.faces) std::swap(t[0], t[1]);
    CHECK(fault(mesh) == Fault{"a face is flipped or has no area", 0});
    mesh = fan();
    mesh.positions[4] = {9, 3};  // beyond the side of face 1
    CHECK(fault(mesh) == Fault{"a face is flipped or has no area", 1});
    mesh.positions[4] = {8, 3};  // on it
    CHECK(fault(mesh) == Fault{"a face is flipped or has no area", 1});
}

TEST_CASE("a vertex off the grid is found") {
    IndexedMesh<1> mesh = fan();
    mesh.positions[4] = {4, 3 + 1.0 / 512};
    CHECK(fault(mesh) == Fault{"a vertex is off the grid", 4});
    mesh.positions[4] = {4, 3 + 1.0 / 256};
    CHECK(check(mesh));
    mesh.positions[4] = {4, -1};
    CHECK_FALSE(check(mesh));
}

TEST_CASE("a T-junction is found, though all faces are right and their areas add up") {
    // Vertex 4 is on the diagonal, a side of face 2 but no corner of it.
    const IndexedMesh<1> corners = whole(8, 8, {{0, 0}, {8, 0}, {8, 8}, {0, 8}, {4, 4}}, {{0, 1, 4}, {1, 2, 4}, {0, 2, 3}});
    CHECK(fault(corners) == Fault{"two fans of triangles meet in one vertex", 0});
    // A face around the middle of a grid is cut in two, its neighbour is not.
    const auto grid = hmesh_test::jittered_grid(24, 24, 3, 3, 1, 0);
    const std::vector<std::uint32_t> middle = {5, 6, 9, 10};
    int cuts = 0;
    for (std::size_t t = 0; t < grid.triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            IndexedMesh<1> mesh = whole(24, 24, grid.positions, grid.triangles);
            const Triangle face = mesh.faces[t];
            const std::uint32_t a = face[k], b = face[(k + 1) % 3], c = face[(k + 2) % 3];
            if (std::count(middle.begin(), middle.end(), a) == 0 || std::count(middle.begin(), middle.end(), b) == 0) continue;
            mesh.add(midpoint(mesh.positions[a], mesh.positions[b]), Color<1>::zero());
            mesh.faces[t] = {a, 16, c};
            mesh.faces.push_back({16, b, c});
            CHECK(fault(mesh).first == "an edge inside the image has one face only");
            ++cuts;
        }
    CHECK(cuts == 10);  // five edges, each from both sides
}

TEST_CASE("a hole is found, also where an overlap makes up for its area") {
    const auto grid = hmesh_test::jittered_grid(20, 20, 4, 4, 1, 0);
    // Face 10 has no corner on the border.
    IndexedMesh<1> mesh = whole(20, 20, grid.positions, grid.triangles);
    REQUIRE(check(mesh));
    const Triangle gone = mesh.faces[10];
    mesh.faces[10] = mesh.faces.back();
    mesh.faces.pop_back();
    CHECK(fault(mesh) == Fault{"the faces do not tile the image", 0});
    // A second layer of the same area elsewhere, with corners of its own.
    Triangle again{};
    for (std::size_t k = 0; k < 3; ++k) {
        again[k] = static_cast<std::uint32_t>(mesh.vertex_count());
        const Point p = mesh.positions[gone[k]];
        mesh.add({p.x + 5, p.y + 5}, Color<1>::zero());
    }
    mesh.faces.push_back(again);
    CHECK(fault(mesh).first == "an edge inside the image has one face only");
    // A hole as wide as the image: two components.
    mesh = whole(4, 4, {{0, 0}, {4, 0}, {4, 2}, {0, 2}, {0, 3}, {4, 3}, {4, 4}, {0, 4}},
                 {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}});
    CHECK(fault(mesh) == Fault{"the faces do not tile the image", 0});
}

TEST_CASE("an overlap is found: a face that comes twice, one of another layer, and folds in which all faces turn right") {
    IndexedMesh<1> mesh = fan();
    mesh.faces.push_back(mesh.faces[0]);
    CHECK(fault(mesh).first == "an edge is used twice in one direction, first by triangle");
    mesh = fan();
    for (const Point p : {Point{1, 1}, {3, 1}, {2, 2}}) mesh.add(p, Color<1>::zero());
    mesh.faces.push_back({5, 6, 7});
    CHECK(fault(mesh) == Fault{"the faces do not tile the image", 0});
    // Eight faces twice around vertex 0, which is the middle of an image half as large as their area.
    mesh = whole(8, 8, {{4, 4}, {0, 0}, {8, 0}, {8, 8}, {0, 8}, {0, 0}, {8, 0}, {8, 8}, {0, 8}},
                 {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}, {0, 5, 6}, {0, 6, 7}, {0, 7, 8}, {0, 8, 1}});
    CHECK(fault(mesh) == Fault{"the faces do not tile the image", 0});
    // Two fans that meet in a vertex.
    mesh = whole(8, 6, {{0, 0}, {4, 0}, {0, 3}, {8, 6}, {4, 6}, {8, 3}, {4, 3}}, {{0, 1, 6}, {0, 6, 2}, {3, 4, 6}, {3, 6, 5}});
    CHECK(fault(mesh) == Fault{"two fans of triangles meet in one vertex", 6});
}

TEST_CASE("a mesh of an image of another size is found") {
    IndexedMesh<1> mesh = fan();
    mesh.width = 9;
    CHECK(fault(mesh) == Fault{"the faces do not tile the image", 0});
    mesh = fan();
    std::swap(mesh.width, mesh.height);  // of the same area
    CHECK(fault(mesh).first == "an edge inside the image has one face only");
    mesh = fan();
    mesh.positions[2] = {8, 7};
    CHECK_FALSE(check(mesh));
}

TEST_CASE("no mesh with one triangle too few, too many, turned over or bent to another vertex is accepted") {
    const IndexedMesh<1> good = make_indexed(hmesh_test::scene<std::uint8_t, 1>(24, 20, 2), Shape::worn, 40, 5);
    REQUIRE(check(good));
    Random random(1);
    int accepted = 0;
    for (std::size_t t = 0; t < good.faces.size(); ++t)
        for (int kind = 0; kind < 4; ++kind) {
            IndexedMesh<1> bad = good;
            Triangle& triangle = bad.faces[t];
            if (kind == 0) triangle = bad.faces.back(), bad.faces.pop_back();
            else if (kind == 1) bad.faces.push_back(good.faces[random.below(good.faces.size())]);
            else if (kind == 2) std::swap(triangle[0], triangle[1 + random.below(2)]);
            else {
                const auto other = static_cast<std::uint32_t>(random.below(good.vertex_count()));
                if (std::count(triangle.begin(), triangle.end(), other) != 0) continue;
                triangle[random.below(3)] = other;
            }
            accepted += check(bad) ? 1 : 0;
        }
    CHECK(accepted == 0);
}

TEST_CASE(
    "a mesh with a vertex moved by chance is accepted if no face turned over and the border stayed, and then covers "
    "every point once") {
    const IndexedMesh<1> good = make_indexed(hmesh_test::scene<std::uint8_t, 1>(16, 12, 2), Shape::delaunay, 25, 7);
    Random random(2);
    int accepted = 0, refused = 0;
    for (int k = 0; k < 300; ++k) {
        IndexedMesh<1> mesh = good;
        const std::size_t v = random.below(mesh.vertex_count());
        const Point from = mesh.positions[v];
        const double reach = 1.0 + static_cast<double>(random.below(8));
        const auto moved = [&](double x) {
            const double step = random.below(2) == 0 ? 0 : kit::snap(reach * random.uniform()) - kit::snap(0.5 * reach);
            return std::max(0.0, x + step);
        };
        const Point to{moved(from.x), moved(from.y)};
        mesh.positions[v] = to;
        const bool is_corner = (from.x == 0 || from.x == 16) && (from.y == 0 || from.y == 12);
        bool valid = is_corner
                         ? to == from
                         : ((from.x != 0 && from.x != 16) || to.x == from.x) && ((from.y != 0 && from.y != 12) || to.y == from.y);
        for (const Triangle& t : mesh.faces)
            if (!(kit::orient2d(mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]) > 0)) valid = false;
        REQUIRE(static_cast<bool>(check(mesh)) == valid);
        ++(valid ? accepted : refused);
        if (!valid) continue;
        // Points off the grid that no line through two of its points meets; also outside of the image.
        int wrong = 0;
        for (int j = -2; j < 28; ++j)
            for (int i = -2; i < 36; ++i) {
                const Point q{0.5 * i + 0.0123456, 0.5 * j + 0.0345678};
                const bool inside = q.x > 0 && q.x < 16 && q.y > 0 && q.y < 12;
                wrong += cover(mesh, q) != (inside ? 1 : 0) ? 1 : 0;
            }
        REQUIRE(wrong == 0);
    }
    CHECK(accepted > 30);
    CHECK(refused > 30);
}

TEST_CASE("the corners of an image are a mesh of two faces, in the colors of its outermost pixels") {
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 5}, {7, 1}, {7, 4}}) {
        const auto image = hmesh_test::noise<std::uint8_t, 3>(width, height, 3);
        const kit::ImageSource<3> source(image.view());
        const IndexedMesh<3> mesh = kit::corner_mesh(source);
        hmesh_test::prove(mesh);
        CHECK(mesh.width == width);
        CHECK(mesh.height == height);
        CHECK(mesh.faces.size() == 2);
        REQUIRE(mesh.vertex_count() == 4);
        for (std::size_t v = 0; v < 4; ++v) {
            const Point p = mesh.positions[v];
            for (int c = 0; c < 3; ++c)
                CHECK(mesh.colors[v][c] == image.pixel(p.x == 0 ? 0 : width - 1, p.y == 0 ? 0 : height - 1)[c]);
        }
    }
}

TEST_CASE("a mesh goes into plain arrays and back, and loses nothing but what floats cannot hold of its colors") {
    const IndexedMesh<3> whole = make_indexed(hmesh_test::scene<std::uint8_t, 3>(64, 40, 2), Shape::worn, 60, 3);
    const hmesh::Mesh plain = kit::to_mesh(whole, 255);
    CHECK(plain.channels == 3);
    CHECK(plain.width == 64);
    CHECK(plain.height == 40);
    CHECK(plain.peak == 255);
    CHECK(!plain.premultiplied);
    CHECK(plain.faces == whole.faces);
    const IndexedMesh<3> back = kit::to_indexed_mesh<3>(plain);
    hmesh_test::prove(back);
    CHECK(back.positions == whole.positions);
    CHECK(back.faces == whole.faces);
    CHECK(back.dirty == std::vector<unsigned char>(whole.vertex_count(), 1));  // all is to be looked at
    bool same = true;
    for (std::size_t v = 0; v < whole.vertex_count(); ++v) {
        for (int c = 0; c < 3; ++c)
            same = same && static_cast<float>(whole.colors[v][c]) == static_cast<float>(back.colors[v][c]);
        for (int c = 3; c < kit::lanes_for(4); ++c) same = same && back.colors[v][c] == 0;
    }
    CHECK(same);
    // As floats they go round and round.
    const hmesh::Mesh again = kit::to_mesh(back, 255);
    CHECK(again.positions == plain.positions);
    CHECK(again.colors == plain.colors);
}

TEST_CASE("plain arrays of other channels, or that are not of one number of vertices, give an empty mesh") {
    const IndexedMesh<1> whole = fan();
    const hmesh::Mesh good = kit::to_mesh(whole, 255);
    CHECK(kit::to_indexed_mesh<1>(good).vertex_count() == 5);
    CHECK(kit::to_indexed_mesh<2>(good).vertex_count() == 0);
    hmesh::Mesh bad = good;
    bad.colors.pop_back();
    CHECK(kit::to_indexed_mesh<1>(bad).vertex_count() == 0);
    bad = good;
    bad.channels = 2;
    CHECK(kit::to_indexed_mesh<1>(bad).vertex_count() == 0);
    // Whether it is a mesh of its image is for check() to say.
    bad = good;
    bad.faces[1] = {0, 9, 4};
    CHECK(!check(kit::to_indexed_mesh<1>(bad)));
    bad = good;
    bad.positions[8] = 8;  // vertex 4: a face without area
    CHECK(!check(kit::to_indexed_mesh<1>(bad)));
}

TEST_CASE("a periodic mesh in plain arrays may have any numbers for positions and size: check() refuses it") {
    IndexedMesh<1> square = whole(8, 6, {{0, 0}, {8, 0}, {8, 6}, {0, 6}}, {{0, 1, 2}, {0, 2, 3}});
    square.periodic = hmesh::Periodic::xy;
    const hmesh::Mesh good = kit::to_mesh(square, 255);
    CHECK(check(kit::to_indexed_mesh<1>(good)));
    CHECK(kit::to_indexed_mesh<1>(good).copy_count == 3);
    const auto refuses = [](const hmesh::Mesh& mesh) {
        const IndexedMesh<1> bad = kit::to_indexed_mesh<1>(mesh);
        return bad.roots.size() == 4 && bad.roots[2] == 2 && fault(bad).first == "a vertex is far outside the image";
    };
    for (const float far :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 1e30F, -1e30F, 3e9F}) {
        hmesh::Mesh bad = good;
        bad.positions[5] = far;
        CHECK(refuses(bad));
    }
    for (const int size : {0, -1, std::numeric_limits<int>::min()}) {
        hmesh::Mesh bad = good;
        bad.width = size;
        CHECK(refuses(bad));
    }
}

TEST_CASE("a periodic mesh is refused whose vertices are off the grid, or tied to others than those in their place") {
    IndexedMesh<1> good = fan();
    good.periodic = hmesh::Periodic::xy;
    good.roots = {0, 0, 0, 0, 4};
    good.count_copies();
    REQUIRE(check(good));
    IndexedMesh<1> other = good;
    for (const std::uint32_t root : {1U, 3U}) {  // any of them may be the root
        other.roots = {root, root, root, root, 4};
        CHECK(check(other));
    }
    for (const Point off : {Point{4.001, 3}, {4, 3.001}}) {
        IndexedMesh<1> bad = good;
        bad.positions[4] = off;
        CHECK(fault(bad) == Fault("a vertex is off the grid", 4));
    }
    const auto place_of = [&](const hmesh::kit::Array<std::uint32_t>& roots) {
        IndexedMesh<1> bad = good;
        bad.roots = roots;
        const Fault found = fault(bad);
        return found.first.find("tied") != std::string::npos ? found.second : -1;
    };
    CHECK(place_of({0, 0, 5, 0, 4}) == 2);  // there is no such vertex
    CHECK(place_of({0, 0, 0, 0xffffffffU, 4}) == 3);
    CHECK(place_of({0, 0, 4, 0, 4}) == 2);  // it is in another place
    CHECK(place_of({0, 0, 0, 0, 0}) == 4);
    CHECK(place_of({0, 0, 1, 0, 4}) == 2);  // it is a copy itself
    CHECK(place_of({0, 0, 2, 0, 4}) == 2);  // and on its own, though others are in its place
    IndexedMesh<1> bad = good;
    bad.roots.pop_back();
    CHECK(fault(bad) == Fault("the arrays of vertices differ in length", 5));
}
