#include "hmesh/methods/baselines/point_removal.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "hmesh/core/progress.hpp"
#include "hmesh/core/random.hpp"
#include "hmesh/mesh/delaunay.hpp"
#include "test_images.hpp"
#include "test_meshes.hpp"
#include "test_weighted.hpp"

namespace kit = hmesh::kit;
using hmesh::kit::Color;
using hmesh::kit::Delaunay;
using hmesh::kit::Edge;
using hmesh::kit::Face;
using hmesh::kit::Halfedge;
using hmesh::kit::HalfedgeMesh;
using hmesh::kit::ImageMesh;
using hmesh::kit::Mobility;
using hmesh::kit::Point;
using hmesh::kit::PointRemoval;
using hmesh::kit::Random;
using hmesh::kit::Vertex;
using hmesh_test::Subject;
using hmesh_test::Triangulation;
using hmesh_test::Weighted;

namespace {

Triangulation triangulation_of(const Delaunay& mesh) {
    Triangulation result;
    result.positions = mesh.positions();
    for (const Face f : mesh.topology().faces()) {
        const auto v = mesh.topology().vertices(f);
        result.triangles.push_back({static_cast<std::uint32_t>(v[0].index()), static_cast<std::uint32_t>(v[1].index()),
                                    static_cast<std::uint32_t>(v[2].index())});
    }
    return result;
}

// `inner` points anywhere on the 1/256 px grid and `border` on the sides: with luck no four on a circle.
Triangulation generic_points(int width, int height, int inner, int border, std::uint64_t seed) {
    Random random(seed);
    std::vector<Point> points;
    for (int k = 0; k < inner; ++k) {
        const double x = 0.1 + random.uniform() * (width - 0.2), y = 0.1 + random.uniform() * (height - 0.2);
        points.push_back(kit::snap(Point{x, y}));
    }
    for (int k = 0; k < border; ++k) {
        const double t = random.uniform(), w = width, h = height;
        const Point sides[4] = {{t * w, 0}, {t * w, h}, {0, t * h}, {w, t * h}};
        points.push_back(kit::snap(sides[k % 4]));
    }
    return triangulation_of(kit::triangulate(width, height, points));
}

// All corners of the pixels in steps of `step`: every square has its corners on a circle.
Triangulation lattice(int width, int height, int step) {
    std::vector<Point> points;
    for (int y = 0; y <= height; y += step)
        for (int x = 0; x <= width; x += step) points.push_back({static_cast<double>(x), static_cast<double>(y)});
    return triangulation_of(kit::triangulate(width, height, points));
}

// The energy of the Delaunay triangulation of the mesh's vertices but v, with their colours, made from scratch.
template <int C>
double energy_without(const ImageMesh<C>& mesh, Vertex v) {
    std::vector<Vertex> kept;
    std::vector<Point> points;
    for (const Vertex u : mesh.topology().vertices()) {
        if (u == v) continue;
        kept.push_back(u);
        points.push_back(mesh.position(u));
    }
    const Triangulation after = triangulation_of(kit::triangulate(mesh.width(), mesh.height(), points));
    REQUIRE(after.positions.size() == kept.size());
    std::vector<Color<C>> colors;
    for (const Point p : after.positions) {
        const auto at = static_cast<std::size_t>(std::find(points.begin(), points.end(), p) - points.begin());
        colors.push_back(mesh.color(kept.at(at)));
    }
    ImageMesh<C> other(mesh.table(), mesh.color_low(), mesh.color_high());
    REQUIRE(other.assign(after.positions, after.triangles, colors, {}));
    return other.energy();
}

// Random colours, which no picture would suggest.
template <int C>
void recolor(ImageMesh<C>& mesh, double range, std::uint64_t seed) {
    Random random(seed);
    std::vector<Color<C>> colors(mesh.topology().vertex_slots(), Color<C>::zero());
    for (Color<C>& c : colors)
        for (int k = 0; k < C; ++k) c.set(k, range * random.uniform());
    mesh.set_colors(colors);
}

template <int C>
bool is_delaunay(const ImageMesh<C>& mesh) {
    const HalfedgeMesh& topology = mesh.topology();
    for (const Edge e : topology.edges()) {
        if (topology.is_boundary(e)) continue;
        const Halfedge h = HalfedgeMesh::halfedge(e), o = HalfedgeMesh::opposite(h);
        const auto at = [&](Halfedge side) { return mesh.position(topology.to_vertex(side)); };
        if (kit::in_circle(at(o), at(h), at(topology.next(h)), at(topology.next(o))) > 0) return false;
    }
    return true;
}

template <int C>
void require_valid(const ImageMesh<C>& mesh) {
    const hmesh::Status status = mesh.check();
    REQUIRE_MESSAGE(status, std::string(status.what) << " at " << status.value);
    REQUIRE(is_delaunay(mesh));
}

// Every vertex that can go has the cost that a triangulation from scratch tells; corners cannot go.
template <int C>
void check_costs(const ImageMesh<C>& mesh, const PointRemoval<C>& removal, double slack) {
    int corners = 0;
    for (const Vertex v : mesh.topology().vertices()) {
        if (mesh.vertex(v).mobility == Mobility::corner) {
            CHECK(!removal.can_go(v));
            ++corners;
            continue;
        }
        REQUIRE(removal.can_go(v));
        REQUIRE(std::abs(removal.cost(v) - (energy_without(mesh, v) - mesh.energy())) <= slack);
    }
    CHECK(corners == 4);
}

template <class T, int C>
void check_costs_of(hmesh::Image<T, C> image, std::uint64_t seed) {
    const int width = image.width(), height = image.height();
    Subject<T, C> subject(std::move(image), generic_points(width, height, 30, 10, seed));
    const double slack = 2 * hmesh_test::rounding(subject) + 1e-30;
    check_costs(subject.mesh, PointRemoval<C>(subject.mesh), slack);
    recolor(subject.mesh, hmesh::PixelTraits<T>::peak, seed);
    PointRemoval<C> removal(subject.mesh);
    for (const std::size_t count : {35U, 20U, 9U}) {  // costs are kept true on the way
        removal.remove_down_to(count);
        check_costs(subject.mesh, removal, slack + 1e-9 * subject.mesh.energy());
    }
}

// The least cost of all vertices that can go.
template <int C>
double least_cost(const ImageMesh<C>& mesh, const PointRemoval<C>& removal) {
    double least = std::numeric_limits<double>::infinity();
    for (const Vertex v : mesh.topology().vertices())
        if (removal.can_go(v)) least = std::min(least, removal.cost(v));
    return least;
}

// Removes all but the corners one by one: each time the energy rises by the least cost, and the mesh stays Delaunay.
template <int C>
void remove_all(ImageMesh<C>& mesh, double slack) {
    PointRemoval<C> removal(mesh);
    while (mesh.vertex_count() > 4) {
        const std::size_t before = mesh.vertex_count();
        const double energy = mesh.energy(), least = least_cost(mesh, removal);
        REQUIRE(removal.remove_down_to(before - 1) == 1);
        REQUIRE(mesh.vertex_count() == before - 1);
        REQUIRE(std::abs(mesh.energy() - energy - least) <= slack + 1e-9 * std::abs(energy));
        require_valid(mesh);
    }
    for (const Vertex v : mesh.topology().vertices()) CHECK(mesh.vertex(v).mobility == Mobility::corner);
    CHECK(removal.remove_down_to(4) == 0);
}

template <class T, int C>
void remove_all_of(hmesh::Image<T, C> image, const Triangulation& triangulation) {
    Subject<T, C> subject(std::move(image), triangulation);
    remove_all(subject.mesh, hmesh_test::rounding(subject) + 1e-12 * hmesh_test::squares(subject.image));
    hmesh_test::prove(subject);
}

}  // namespace

TEST_CASE("a cost is the rise of the energy to the Delaunay triangulation without the vertex, made from scratch") {
    check_costs_of(hmesh_test::noise<std::uint8_t, 1>(41, 30, 1), 1);
    check_costs_of(hmesh_test::noise<std::uint8_t, 3>(30, 41, 2), 2);
    check_costs_of(hmesh_test::checkerboard<std::uint16_t, 3>(33, 33, 3), 3);
    check_costs_of(hmesh_test::affine_image<float, 3>(40, 25), 4);
    check_costs_of(hmesh_test::constant_image<std::uint8_t, 3>(24, 24, 0.5), 5);
    check_costs_of(hmesh_test::scene<float, 4>(36, 36, 6), 6);
}

TEST_CASE("a cost over a weighted table is the rise of the weighted energy") {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        Weighted<std::uint8_t, 3> subject(hmesh_test::noise<std::uint8_t, 3>(37, 31, seed),
                                          hmesh_test::random_weights(37, 31, seed), generic_points(37, 31, 30, 10, seed));
        const double slack = 1e-9 * subject.mesh.energy() + 1e-12 * hmesh_test::squares(subject.image);
        PointRemoval<3> removal(subject.mesh);
        for (const std::size_t count : {40U, 25U, 10U}) {
            removal.remove_down_to(count);
            check_costs(subject.mesh, removal, slack);
            require_valid(subject.mesh);
            CHECK(std::abs(subject.mesh.energy() - hmesh_test::weighted_energy(subject)) <= slack);
        }
        removal.remove_down_to(4);
        CHECK(subject.mesh.vertex_count() == 4);
        require_valid(subject.mesh);
    }
}

TEST_CASE("each time the cheapest of all vertices goes, as when all costs are found anew from scratch") {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        Subject<std::uint8_t, 3> subject(hmesh_test::scene<std::uint8_t, 3>(30, 26, seed), generic_points(30, 26, 14, 6, seed));
        ImageMesh<3>& mesh = subject.mesh;
        recolor(mesh, 255, seed);
        PointRemoval<3> removal(mesh);
        while (mesh.vertex_count() > 5) {  // the corners alone have two triangulations
            std::vector<std::pair<double, Vertex>> naive;
            for (const Vertex v : mesh.topology().vertices())
                if (mesh.vertex(v).mobility != Mobility::corner) naive.emplace_back(energy_without(mesh, v), v);
            const auto best =
                *std::min_element(naive.begin(), naive.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
            REQUIRE(removal.remove_down_to(mesh.vertex_count() - 1) == 1);
            REQUIRE(mesh.topology().is_deleted(best.second));
            REQUIRE(std::abs(mesh.energy() - best.first) <= hmesh_test::rounding(subject));
            require_valid(mesh);
        }
        hmesh_test::prove(subject);
    }
}

TEST_CASE("generic points go down to the four corners, of whatever picture") {
    remove_all_of(hmesh_test::constant_image<std::uint8_t, 1>(40, 30, 0.7), generic_points(40, 30, 50, 20, 11));
    remove_all_of(hmesh_test::affine_image<float, 3>(40, 30), generic_points(40, 30, 50, 20, 12));
    remove_all_of(hmesh_test::checkerboard<std::uint8_t, 3>(40, 30, 1), generic_points(40, 30, 50, 20, 13));
    remove_all_of(hmesh_test::noise<std::uint16_t, 3>(40, 30, 14), generic_points(40, 30, 50, 20, 14));
    remove_all_of(hmesh_test::scaled(hmesh_test::noise<float, 3>(40, 30, 15), 1e38), generic_points(40, 30, 50, 20, 15));
}

TEST_CASE("points in line and on circles go down to the four corners: faces without area in between do no harm") {
    remove_all_of(hmesh_test::noise<std::uint8_t, 3>(10, 8, 21), lattice(10, 8, 1));
    remove_all_of(hmesh_test::constant_image<std::uint8_t, 1>(8, 10, 0.3), lattice(8, 10, 1));
    remove_all_of(hmesh_test::affine_image<float, 1>(9, 9), lattice(9, 9, 1));
    remove_all_of(hmesh_test::checkerboard<std::uint8_t, 1>(16, 16, 2), lattice(16, 16, 2));
    remove_all_of(hmesh_test::noise<std::uint8_t, 1>(24, 1, 22), lattice(24, 1, 1));
    remove_all_of(hmesh_test::noise<float, 3>(1, 24, 23), lattice(1, 24, 1));
}

TEST_CASE("what is affine costs nothing, so the border between two affine pictures is what stays") {
    // Steps of 1/64 in a float image: the picture is affine left of x = 16 and constant to the right, and so are colours.
    const auto level = [](double x) { return x < 16 ? x / 64 : 0.25; };
    Subject<float, 1> subject(hmesh_test::draw<float, 1>(32, 16, [&](int x, int, int) { return level(x + 0.5); }),
                              lattice(32, 16, 2));
    std::vector<Color<1>> colors(subject.mesh.topology().vertex_slots(), Color<1>::zero());
    for (const Vertex v : subject.mesh.topology().vertices()) colors[v.index()].set(0, level(subject.mesh.position(v).x));
    subject.mesh.set_colors(colors);
    CHECK(subject.mesh.energy() < 1e-12);
    CHECK(PointRemoval<1>(subject.mesh).remove_down_to(6) == 17 * 9 - 6);
    CHECK(subject.mesh.energy() < 1e-12);
    require_valid(subject.mesh);
    int on_crease = 0;
    for (const Vertex v : subject.mesh.topology().vertices()) on_crease += subject.mesh.position(v).x == 16;
    CHECK(on_crease == 2);
}

TEST_CASE("a vertex with too many neighbors for a ring stays until some of these are gone") {
    const int spokes = kit::ring_capacity + 16;
    std::vector<Point> points;
    Random random(31);
    for (int k = 0; k < spokes; ++k) {  // hardly off a circle, or there would be many triangulations without the hub
        const double angle = 6.283185307179586 * k / spokes, radius = 25 + 0.05 * random.uniform();
        points.push_back(kit::snap(Point{30 + radius * std::cos(angle), 30 + radius * std::sin(angle)}));
    }
    points.push_back({30, 30});
    Subject<std::uint8_t, 3> subject(hmesh_test::noise<std::uint8_t, 3>(60, 60, 31),
                                     triangulation_of(kit::triangulate(60, 60, points)));
    ImageMesh<3>& mesh = subject.mesh;
    Vertex hub;
    for (const Vertex v : mesh.topology().vertices())
        if (mesh.position(v) == Point{30, 30}) hub = v;
    REQUIRE(mesh.topology().valence(hub) == spokes);
    PointRemoval<3> removal(mesh);
    CHECK(!removal.can_go(hub));
    while (mesh.topology().valence(hub) > kit::ring_capacity) {
        REQUIRE(removal.remove_down_to(mesh.vertex_count() - 1) == 1);
        REQUIRE(!mesh.topology().is_deleted(hub));
        require_valid(mesh);
    }
    CHECK(removal.can_go(hub));
    CHECK(std::abs(removal.cost(hub) - (energy_without(mesh, hub) - mesh.energy())) <= 2 * hmesh_test::rounding(subject));
    removal.remove_down_to(4);
    CHECK(mesh.vertex_count() == 4);
    hmesh_test::prove(subject);
}

TEST_CASE("locked vertices stay, and no more go than are asked for") {
    Subject<std::uint8_t, 1> subject(hmesh_test::noise<std::uint8_t, 1>(40, 40, 41), generic_points(40, 40, 60, 12, 41));
    ImageMesh<1>& mesh = subject.mesh;
    const std::size_t count = mesh.vertex_count();
    for (std::size_t k = 10; k < 20; ++k) mesh.lock(Vertex(k), kit::max_valence);
    PointRemoval<1> removal(mesh);
    CHECK(removal.remove_down_to(count) == 0);
    CHECK(removal.remove_down_to(count + 100) == 0);
    CHECK(removal.remove_down_to(count - 25) == 25);
    CHECK(mesh.vertex_count() == count - 25);
    CHECK(removal.remove_down_to(4) == count - 25 - 14);
    for (std::size_t k = 10; k < 20; ++k) CHECK(!mesh.topology().is_deleted(Vertex(k)));
    require_valid(mesh);
}

TEST_CASE("removal says how far it is, and a callback ends it, and the rating before it, with a mesh that is valid") {
    for (const int last : {5, 20}) {
        CAPTURE(last);
        Subject<std::uint8_t, 1> subject(hmesh_test::noise<std::uint8_t, 1>(60, 60, 51), lattice(60, 60, 1));
        int calls = 0;
        double fraction = 0;
        const auto callback = [&](const hmesh::ProgressInfo& info) {
            fraction = info.fraction;
            return ++calls < last;
        };
        kit::ProgressReporter progress(callback, 3600, 255);
        progress.set_range(0, 1);
        std::size_t removed = 0;
        {
            kit::TaskProgress task(progress, 1);
            subject.mesh.set_task(&task);
            removed = PointRemoval<1>(subject.mesh).remove_down_to(100);
            subject.mesh.set_task(nullptr);
        }
        CHECK(calls == last);
        if (last == 5) CHECK(removed == 0);  // fewer than 256 vertices are rated between two calls
        else CHECK(removed > 500);
        CHECK(removed < 61 * 61 - 100);
        CHECK(fraction == doctest::Approx(static_cast<double>(removed) / (61 * 61 - 100)).epsilon(1e-2));
        CHECK(subject.mesh.vertex_count() == 61 * 61 - removed);
        require_valid(subject.mesh);
    }
}
