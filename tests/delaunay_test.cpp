#include "hmesh/mesh/delaunay.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "exact_circles.hpp"
#include "hmesh/core/random.hpp"
#include "test_executors.hpp"

using hmesh::kit::Delaunay;
using hmesh::kit::Face;
using hmesh::kit::Halfedge;
using hmesh::kit::HalfedgeMesh;
using hmesh::kit::Point;
using hmesh::kit::Random;
using hmesh::kit::Vertex;
using hmesh_test::GridPoint;
using hmesh_test::on_grid;

namespace {

// --- the empty-circle property by brute force, in integers of 1/256 px ---

// The mesh has the corners and `expected` as its vertices, its faces are a triangulation, and no circle holds a vertex.
void prove(const Delaunay& mesh, std::vector<Point> expected) {
    const HalfedgeMesh& topology = mesh.topology();
    const hmesh::Status connected = topology.check(), status = mesh.check();
    REQUIRE_MESSAGE(connected, connected.what << " at " << connected.value);
    REQUIRE_MESSAGE(status, status.what << " at " << status.value);
    std::vector<GridPoint> vertices;
    std::vector<std::pair<double, double>> have, want;
    for (const Vertex v : topology.vertices()) {
        vertices.push_back(on_grid(mesh.position(v)));
        have.emplace_back(mesh.position(v).x, mesh.position(v).y);
    }
    const double w = mesh.width(), h = mesh.height();
    expected.insert(expected.end(), {{0, 0}, {w, 0}, {w, h}, {0, h}});
    for (const Point p : expected) want.emplace_back(p.x, p.y);
    std::sort(have.begin(), have.end());
    std::sort(want.begin(), want.end());
    want.erase(std::unique(want.begin(), want.end()), want.end());
    REQUIRE(have == want);

    std::int64_t area = 0, folded = 0, occupied = 0;
    for (const Face f : topology.faces()) {
        const auto v = topology.vertices(f);
        const GridPoint a = on_grid(mesh.position(v[0])), b = on_grid(mesh.position(v[1])), c = on_grid(mesh.position(v[2]));
        area += double_area(a, b, c);
        folded += double_area(a, b, c) <= 0;
        for (const GridPoint d : vertices) occupied += hmesh_test::circle_test(a, b, c, d) > 0 ? 1 : 0;
    }
    REQUIRE(area == 2 * 65536 * std::int64_t{mesh.width()} * mesh.height());
    REQUIRE(folded == 0);
    REQUIRE(occupied == 0);
}

// --- points ---

struct Case {
    const char* name;
    int width, height;
    std::vector<Point> points;
};

std::vector<Point> grid(int columns, int rows, Point first, double step) {
    std::vector<Point> points;
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i) points.push_back({first.x + step * i, first.y + step * j});
    return points;
}

std::vector<Point> scattered(int count, Point first, double side, std::uint64_t seed) {
    Random random(seed);
    std::vector<Point> points;
    for (int k = 0; k < count; ++k)
        points.push_back(snap(Point{first.x + side * random.uniform(), first.y + side * random.uniform()}));
    return points;
}

// All whole points at `radius` from the centre, times `scale`.
std::vector<Point> circle(int radius, Point center, double scale) {
    std::vector<Point> points;
    for (int y = -radius; y <= radius; ++y)
        for (int x = -radius; x <= radius; ++x)
            if (x * x + y * y == radius * radius) points.push_back({center.x + scale * x, center.y + scale * y});
    return points;
}

std::vector<Point> line(int count, Point first, Point step) {
    std::vector<Point> points;
    for (int k = 0; k < count; ++k) points.push_back({first.x + step.x * k, first.y + step.y * k});
    return points;
}

std::vector<Point> operator+(std::vector<Point> a, const std::vector<Point>& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

std::vector<Case> cases() {
    const double step = 1.0 / 256;
    return {
        {"none", 1, 1, {}},
        {"random", 50, 30, scattered(45, {0, 0}, 30, 1)},
        {"random, crowded on the 1/256 px grid", 3, 2, scattered(40, {1, 1}, 8 * step, 2)},
        {"whole grid", 6, 5, grid(7, 6, {0, 0}, 1)},
        {"pixel centres", 6, 6, grid(6, 6, {0.5, 0.5}, 1)},
        {"level line", 40, 7, line(30, {5, 3}, {1, 0})},
        {"upright line", 7, 40, line(30, {3, 5}, {0, 1})},
        {"diagonal", 20, 20, line(19, {1, 1}, {1, 1})},
        {"slanted line", 64, 40, line(15, {2, 3}, {3.5, 2.25})},
        {"cross of lines", 20, 20, line(19, {1, 10}, {1, 0}) + line(19, {10, 1}, {0, 1})},
        {"two sides", 30, 9, line(29, {1, 0}, {1, 0}) + line(14, {2, 9}, {2, 0})},
        {"all sides", 9, 9,
         line(8, {1, 0}, {1, 0}) + line(8, {9, 1}, {0, 1}) + line(8, {8, 9}, {-1, 0}) + line(8, {0, 8}, {0, -1})},
        {"sides and inside", 12, 12, line(11, {1, 0}, {1, 0}) + line(5, {0, 2}, {0, 2}) + scattered(25, {0, 0}, 12, 3)},
        {"circle of radius 25", 60, 60, circle(25, {30, 30}, 1)},
        {"circle and its centre", 60, 60, circle(25, {30, 30}, 1) + std::vector<Point>{{30, 30}}},
        {"circle of radius 65, touching the sides", 130, 130, circle(65, {65, 65}, 1)},
        {"circles about one centre", 140, 140, circle(65, {70, 70}, 1) + circle(5, {70, 70}, 1)},
        {"circle as large as the plane", 65536, 65536, circle(65, {32768, 32768}, 504)},
        {"circle near the end of the plane", 65536, 65536, circle(65, {65536 - 65 * step, 65536 - 65 * step}, step)},
        {"grid near the end of the plane", 65536, 65536, grid(6, 6, {65536 - 6 * step, 65536 - 5 * step}, step)},
        {"random all over the plane", 65536, 65536, scattered(40, {0, 0}, 65536, 4)},
        {"coarse grid of the plane", 65536, 65536, grid(7, 6, {8192, 8192}, 8192)},
        {"long and thin", 65536, 1, scattered(10, {65535, 0}, 1, 5) + line(20, {3000, 0.5}, {3000, 0})},
        {"repeated", 10, 10, grid(4, 4, {2, 2}, 2) + grid(4, 4, {2, 2}, 2) + grid(2, 2, {0, 0}, 10)},
    };
}

template <class T>
void shuffle(std::vector<T>& list, Random& random) {
    for (std::size_t i = list.size(); i > 1; --i) std::swap(list[i - 1], list[random.below(i)]);
}

std::vector<Point> inner_positions(const Delaunay& mesh) {
    std::vector<Point> points;
    for (const Vertex v : mesh.topology().vertices())
        if (!Delaunay::is_corner(v)) points.push_back(mesh.position(v));
    return points;
}

}  // namespace

TEST_CASE("points in spatial order make a Delaunay triangulation of the rectangle") {
    for (const Case& test : cases()) {
        CAPTURE(test.name);
        prove(triangulate(test.width, test.height, test.points), test.points);
    }
}

TEST_CASE("points in any order make a Delaunay triangulation, proved after each") {
    Random random(1);
    for (const Case& test : cases()) {
        CAPTURE(test.name);
        Delaunay mesh(test.width, test.height);
        std::vector<Point> order = test.points, inserted;
        shuffle(order, random);
        for (const Point p : order) {
            const Vertex v = mesh.insert(p);
            REQUIRE(mesh.position(v) == p);
            inserted.push_back(p);
            if (inserted.size() % 8 == 0) prove(mesh, inserted);
            else REQUIRE(mesh.check());
        }
        prove(mesh, inserted);
    }
}

TEST_CASE("removal in any order leaves a Delaunay triangulation, down to two faces, proved after each") {
    Random random(2);
    for (const Case& test : cases()) {
        CAPTURE(test.name);
        for (int round = 0; round < 2; ++round) {
            Delaunay mesh = triangulate(test.width, test.height, test.points);
            std::vector<Vertex> order;
            for (const Vertex v : mesh.topology().vertices())
                if (!Delaunay::is_corner(v)) order.push_back(v);
            if (round == 0) shuffle(order, random);
            for (const Vertex v : order) {
                mesh.remove(v);
                REQUIRE(mesh.topology().is_deleted(v));
                prove(mesh, inner_positions(mesh));
            }
            CHECK(mesh.topology().vertex_count() == 4);
            CHECK(mesh.topology().face_count() == 2);
        }
    }
}

TEST_CASE("insertions and removals in any mixture leave a Delaunay triangulation of what is there") {
    Random random(3);
    for (const int steps : {1, 2, 256}) {  // to the pixel: half of all points are there already, many are on the border
        Delaunay mesh(9, 7);
        std::vector<std::pair<Point, Vertex>> there;
        for (int k = 0; k < 600; ++k) {
            if (!there.empty() && random.below(20) < (k % 200 < 100 ? 6U : 14U)) {
                const std::size_t i = random.below(there.size());
                mesh.remove(there[i].second);
                there.erase(there.begin() + static_cast<std::ptrdiff_t>(i));
            } else {
                const auto draw = [&](int size) {
                    return static_cast<double>(random.below(static_cast<std::size_t>(size * steps + 1))) / steps;
                };
                const double x = draw(9), y = draw(7);
                const Point p{x, y};
                const Vertex v = mesh.insert(p);
                REQUIRE(mesh.position(v) == p);
                const auto old = std::find_if(there.begin(), there.end(), [&](const auto& pair) { return pair.first == p; });
                if (old != there.end()) CHECK(old->second == v);
                else if (!Delaunay::is_corner(v)) there.emplace_back(p, v);
            }
            REQUIRE(mesh.topology().vertex_count() == 4 + there.size());
            std::vector<Point> points;
            for (const auto& pair : there) points.push_back(pair.first);
            if (k % 16 == 0) prove(mesh, points);
            else REQUIRE(mesh.check());
        }
    }
}

TEST_CASE("larger sets: random points, all pixel centres and all whole pixels, inserted and then removed") {
    Random random(4);
    for (const auto& points : {scattered(2500, {0, 0}, 50, 6), grid(50, 50, {0.5, 0.5}, 1), grid(51, 51, {0, 0}, 1)}) {
        Delaunay mesh = triangulate(50, 50, points);
        REQUIRE(mesh.check());
        std::vector<Vertex> order;
        for (const Vertex v : mesh.topology().vertices())
            if (!Delaunay::is_corner(v)) order.push_back(v);
        shuffle(order, random);
        for (std::size_t k = 0; k < order.size(); ++k) {
            mesh.remove(order[k]);
            if (k % 250 == 0) REQUIRE(mesh.check());
        }
        CHECK(mesh.topology().vertex_count() == 4);
        prove(mesh, {});
    }
}

TEST_CASE("triangulations of rows join to that of the whole and of what stays where they meet, wherever it is cut") {
    Random random(9);
    for (const Case& test : cases())
        for (int round = 0; round < 3; ++round) {
            CAPTURE(test.name);
            std::vector<double> cuts{0.0, static_cast<double>(test.height)};
            for (int k = 0; k < 4; ++k) {
                const double cut = (1 + static_cast<double>(random.below(static_cast<std::size_t>(256 * test.height - 1)))) / 256;
                const auto is_there = [&](Point p) { return p.y == cut; };  // points may not be where it is cut
                if (std::none_of(test.points.begin(), test.points.end(), is_there)) cuts.push_back(cut);
            }
            std::sort(cuts.begin(), cuts.end());
            cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
            std::vector<std::unique_ptr<Delaunay>> parts;
            std::vector<Point> points = test.points;
            for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
                parts.push_back(std::make_unique<Delaunay>(test.width, test.height));
                parts[k]->keep_rows(cuts[k], cuts[k + 1]);
                for (const Point p : test.points)
                    if (p.y >= cuts[k] && p.y <= cuts[k + 1]) parts[k]->insert(p);
                if (k > 0) points.insert(points.end(), {{0, cuts[k]}, {static_cast<double>(test.width), cuts[k]}});
            }
            Delaunay& whole = *parts.front();
            std::vector<std::unique_ptr<Delaunay>> second, others;
            for (std::size_t k = 1; k < parts.size(); ++k) (k == 1 ? second : others).push_back(std::move(parts[k]));
            whole.join({}, {});
            whole.join(second, {});
            whole.join(others, hmesh_test::ReverseFor());
            prove(whole, points);
            for (const double part : {0.25, 0.5, 0.75}) {  // in slots that are free, and in others
                points.push_back(snap(Point{part * test.width, (1 - part) * test.height}));
                whole.insert(points.back());
            }
            prove(whole, points);
        }
}

TEST_CASE("a corner of the rectangle may see 300 points in line, and a vertex that sees 200 of them may go") {
    const std::vector<Point> points = line(301, {300, 0}, {0, 1});
    Delaunay mesh = triangulate(65536, 65536, points);
    CHECK(mesh.topology().valence(Vertex(0)) >= 300);
    prove(mesh, points);
    const Vertex v = mesh.insert({0.25, 150});
    CHECK(mesh.topology().valence(v) >= 200);
    prove(mesh, points + std::vector<Point>{{0.25, 150}});
    mesh.remove(v);
    CHECK(mesh.topology().valence(Vertex(0)) >= 300);
    prove(mesh, points);
    const Vertex side = mesh.insert({0, 150});
    CHECK(mesh.topology().valence(side) >= 200);
    mesh.remove(side);
    prove(mesh, points);
    for (int k = 1; k < 300; ++k) mesh.remove(mesh.insert({300, static_cast<double>(k)}));
    prove(mesh, {{300, 0}, {300, 300}});
}

TEST_CASE("locate finds the face, the edge or the vertex under a point") {
    Random random(5);
    Delaunay mesh = triangulate(12, 9, grid(7, 9, {1, 0}, 1) + scattered(20, {0, 0}, 9, 7));
    const HalfedgeMesh& topology = mesh.topology();
    int faces = 0, edges = 0, vertices = 0;
    for (int k = 0; k < 3000; ++k) {
        const int steps = k % 2 == 0 ? 2 : 256;
        const auto draw = [&](int size) {
            return static_cast<double>(random.below(static_cast<std::size_t>(size * steps + 1))) / steps;
        };
        const double x = draw(12), y = draw(9);
        const Point p{x, y};
        const Halfedge h = mesh.locate(p);
        REQUIRE(!topology.is_boundary(h));
        Vertex v[3] = {topology.from_vertex(h), topology.to_vertex(h), topology.to_vertex(topology.next(h))};
        double beside[3];
        for (int i = 0; i < 3; ++i) beside[i] = orient2d(mesh.position(v[i]), mesh.position(v[(i + 1) % 3]), p);
        REQUIRE((beside[0] >= 0 && beside[1] >= 0 && beside[2] >= 0));
        const int zeros = (beside[0] == 0) + (beside[1] == 0) + (beside[2] == 0);
        if (zeros == 2) REQUIRE(mesh.position(v[0]) == p);
        if (zeros == 1) REQUIRE(beside[0] == 0);
        ++(zeros == 0 ? faces : zeros == 1 ? edges : vertices);
        if (k % 100 == 0) mesh.insert(p);  // begin elsewhere
    }
    CHECK(faces > 300);
    CHECK(edges > 300);
    CHECK(vertices > 100);
}

TEST_CASE("triangulate numbers the corners first, then the points in spatial order, each once") {
    const std::vector<Point> points = grid(9, 8, {0, 0}, 1) + scattered(60, {0, 0}, 8, 8) + grid(9, 8, {0, 0}, 1);
    const Delaunay mesh = triangulate(8, 8, points);
    CHECK(mesh.topology().vertex_count() == mesh.positions().size());
    CHECK((mesh.position(Vertex(0)) == Point{0, 0} && mesh.position(Vertex(1)) == Point{8, 0}));
    CHECK((mesh.position(Vertex(2)) == Point{8, 8} && mesh.position(Vertex(3)) == Point{0, 8}));
    for (std::size_t k = 5; k < mesh.positions().size(); ++k)
        CHECK(hmesh::kit::morton_code(mesh.positions()[k - 1]) <= hmesh::kit::morton_code(mesh.positions()[k]));
    prove(mesh, points);
}

TEST_CASE("slots of removed vertices are used again") {
    Delaunay mesh = triangulate(20, 20, grid(19, 19, {1, 1}, 1));
    const std::size_t slots = mesh.topology().vertex_slots(), edges = mesh.topology().edge_slots();
    Random random(6);
    for (int k = 0; k < 2000; ++k) {
        const Point p{1.0 + static_cast<double>(random.below(19)), 1.0 + static_cast<double>(random.below(19))};
        const Vertex v = mesh.insert(p);
        mesh.remove(v);
        CHECK(mesh.insert(p) == v);
    }
    CHECK(mesh.topology().vertex_slots() == slots);
    CHECK(mesh.topology().edge_slots() == edges);
    REQUIRE(mesh.check());
}

TEST_CASE("check() refuses vertices that are not where they were, and says what is wrong with them") {
    // 8 x 8 with a point inside and, on the side y = 0, four. Vertices are numbered in the order of insertion.
    const auto sentence = [](const auto& tamper) {
        Delaunay mesh(8, 8);
        for (const Point p : {Point{4, 4}, Point{6, 0}, Point{4, 0}, Point{2, 0}, Point{1, 0}}) mesh.insert(p);
        tamper(const_cast<hmesh::kit::Array<Point>&>(mesh.positions()));
        return std::string(mesh.check().what);
    };
    using Points = hmesh::kit::Array<Point>;
    CHECK(sentence([](Points&) {}).empty());
    CHECK(sentence([](Points& points) { points.push_back({1, 1}); }) == "there are not as many positions as vertices");
    CHECK(sentence([](Points& points) { points[2] = {8, 7}; }) == "a corner of the rectangle is not where it was");
    const std::string off_side = "a boundary edge does not run along a side of the rectangle, from vertex";
    CHECK(sentence([](Points& points) { points[6] = {4, 1}; }) == off_side);
    CHECK(sentence([](Points& points) { points[6] = {7, 0}; }) == off_side);  // backwards
    CHECK(sentence([](Points& points) { points[6] = points[5]; }) == off_side);
    // Around twice: (0, 0), down, right, up, left, and once more over the four points.
    CHECK(sentence([](Points& points) {
              points[5] = {0, 0}, points[6] = {0, 8}, points[7] = {8, 8}, points[8] = {8, 0};
          }) == "the boundary does not run around the rectangle once");
    CHECK(sentence([](Points& points) { points[4] = {4, -1}; }) == "a face is not positively oriented");
    CHECK(sentence([](Points& points) { points[4] = {4, 0}; }) == "a face is not positively oriented");  // no area
    CHECK(sentence([](Points& points) { points[4] = {4, 7}; }) == "an edge is not locally Delaunay");
}
