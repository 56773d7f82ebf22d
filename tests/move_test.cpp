#include "hmesh/edit/move.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "hmesh/core/progress.hpp"
#include "hmesh/core/random.hpp"
#include "test_images.hpp"
#include "test_meshes.hpp"

using hmesh::kit::Color;
using hmesh::kit::Face;
using hmesh::kit::ImageMesh;
using hmesh::kit::Mobility;
using hmesh::kit::Point;
using hmesh::kit::Random;
using hmesh::kit::Tolerance;
using hmesh::kit::Vertex;
using hmesh::kit::VertexState;
using hmesh_test::Subject;

namespace {

// Nothing is too little to try or to pass on.
constexpr Tolerance thorough{0, 0};

template <int C>
void set_all_dirty(ImageMesh<C>& mesh, bool dirty) {
    for (const Vertex v : mesh.topology().vertices()) mesh.set_dirty(v, dirty);
}

template <int C>
std::vector<VertexState<C>> states(const ImageMesh<C>& mesh) {
    std::vector<VertexState<C>> all;
    for (std::size_t i = 0; i < mesh.topology().vertex_slots(); ++i) all.push_back(mesh.vertex(Vertex(i)));
    return all;
}

template <class T, int C>
void check_visits(hmesh::Image<T, C> image, double range, std::uint64_t seed) {
    const int width = image.width(), height = image.height();
    Subject<T, C> subject(std::move(image), hmesh_test::jittered_grid(width, height, 5, 4, seed));
    ImageMesh<C>& mesh = subject.mesh;
    hmesh_test::wear(mesh, 60, range, seed);
    Random random(seed);
    int moved = 0;
    for (int k = 0; k < 300; ++k) {
        const double before = mesh.energy(), slack = hmesh_test::rounding(subject);
        const Vertex v = hmesh_test::any_vertex(mesh, random);
        const auto old = states(mesh);
        const double decrease = hmesh::kit::improve_vertex(mesh, v, 0);
        REQUIRE(decrease >= 0);
        REQUIRE(mesh.energy() <= before + slack);
        REQUIRE(std::abs(before - mesh.energy() - decrease) <= slack);
        hmesh_test::prove(subject);
        for (const Vertex u : mesh.topology().vertices()) {
            const Point from = old[u.index()].position, to = mesh.position(u);
            if (u != v) {
                REQUIRE(from == to);
                continue;
            }
            if (mesh.vertex(u).mobility == Mobility::corner) REQUIRE(from == to);
            if (mesh.vertex(u).mobility == Mobility::along_x) REQUIRE(from.y == to.y);
            if (mesh.vertex(u).mobility == Mobility::along_y) REQUIRE(from.x == to.x);
            moved += from == to ? 0 : 1;
        }
        for (const hmesh::kit::Halfedge h : mesh.topology().outgoing(v)) {
            if (mesh.topology().is_boundary(h)) continue;
            const auto corner = mesh.topology().vertices(mesh.topology().face(h));
            REQUIRE(hmesh::kit::orient2d(mesh.position(corner[0]), mesh.position(corner[1]), mesh.position(corner[2])) >=
                    mesh.limits().min_double_area);
        }
    }
    CHECK(moved > 30);
    // And all in turn.
    for (int k = 0; k < 5; ++k) {
        const double before = mesh.energy(), slack = hmesh_test::rounding(subject);
        set_all_dirty(mesh, true);
        const double decrease = hmesh::kit::sweep(mesh);
        REQUIRE(decrease == before - mesh.energy());
        REQUIRE(decrease >= -slack);
        hmesh_test::prove(subject);
    }
}

// The picture of a mesh, pixel by pixel.
template <int C>
hmesh::Image<float, C> picture_of(const ImageMesh<C>& mesh) {
    hmesh::Image<float, C> image(mesh.width(), mesh.height());
    for (const Face f : mesh.topology().faces()) {
        const auto v = mesh.topology().vertices(f);
        const VertexState<C>&a = mesh.vertex(v[0]), &b = mesh.vertex(v[1]), &c = mesh.vertex(v[2]);
        hmesh_test::for_each_pixel(mesh.width(), mesh.height(), a.position, b.position, c.position, [&](int i, int j) {
            for (int k = 0; k < C; ++k)
                image.pixel(i, j)[k] = static_cast<float>(hmesh_test::interpolate(a, b, c, i + 0.5, j + 0.5, k));
        });
    }
    return image;
}

}  // namespace

TEST_CASE("a visit never raises the energy, returns by how much it fell, and keeps vertices on the grid and on their side") {
    check_visits(hmesh_test::scene<std::uint8_t, 3>(31, 26, 1), 255, 1);
    check_visits(hmesh_test::noise<std::uint16_t, 1>(30, 28, 2), 65535, 2);
    check_visits(hmesh_test::scaled(hmesh_test::scene<float, 4>(26, 30, 3), 100), 100, 3);
    check_visits(hmesh_test::checkerboard<std::uint8_t, 2>(28, 24, 5), 255, 4);
}

TEST_CASE("a visit leaves the vertex with the colour that fits its ring best") {
    Subject<std::uint8_t, 3> subject(hmesh_test::scene<std::uint8_t, 3>(31, 26, 1), hmesh_test::jittered_grid(31, 26, 5, 4, 1));
    ImageMesh<3>& mesh = subject.mesh;
    for (const Vertex v : mesh.topology().vertices()) {
        hmesh::kit::improve_vertex(mesh, v, 0);
        const Color<3> best = mesh.color(v);
        const double least = mesh.energy();
        for (int k = 0; k < 3; ++k)
            for (const double h : {-0.5, 0.5}) {
                Color<3> other = best;
                other.set(k, best[k] + h);
                if (other[k] < mesh.color_low() || other[k] > mesh.color_high()) continue;  // a bound may hold it
                mesh.place(v, mesh.position(v), other);
                CHECK(mesh.energy() > least);
            }
        mesh.place(v, mesh.position(v), best);
    }
}

TEST_CASE("a visit that expects too little of a step only sets the colour") {
    Subject<std::uint8_t, 3> subject(hmesh_test::scene<std::uint8_t, 3>(31, 26, 1), hmesh_test::jittered_grid(31, 26, 5, 4, 1));
    const auto old = states(subject.mesh);
    double decrease = 0;
    for (const Vertex v : subject.mesh.topology().vertices())
        decrease += hmesh::kit::improve_vertex(subject.mesh, v, std::numeric_limits<double>::infinity());
    CHECK(decrease > 0);
    for (const Vertex v : subject.mesh.topology().vertices()) CHECK(subject.mesh.position(v) == old[v.index()].position);
}

TEST_CASE("a visit with a step is never worse than one that only sets the colour") {
    Subject<std::uint8_t, 3> subject(hmesh_test::noise<std::uint8_t, 3>(31, 26, 1), hmesh_test::jittered_grid(31, 26, 6, 5, 1));
    ImageMesh<3>& mesh = subject.mesh;
    int better = 0;
    for (int k = 0; k < 4; ++k)
        for (const Vertex v : mesh.topology().vertices()) {
            const auto mark = mesh.begin();
            const double recolored = hmesh::kit::improve_vertex(mesh, v, std::numeric_limits<double>::infinity());
            mesh.rollback(mark);
            const double moved = hmesh::kit::improve_vertex(mesh, v, 0);
            REQUIRE(moved >= recolored);
            better += moved > recolored ? 1 : 0;
        }
    CHECK(better > 20);
}

TEST_CASE("a vertex with a face smaller than the limits allow is left alone") {
    hmesh::MeshLimits limits;
    limits.min_double_area = 1000;
    Subject<std::uint8_t, 1> subject(hmesh_test::noise<std::uint8_t, 1>(31, 26, 1), hmesh_test::jittered_grid(31, 26, 5, 4, 1),
                                     limits);
    const auto before = hmesh_test::snapshot(subject.mesh);
    for (const Vertex v : subject.mesh.topology().vertices()) CHECK(hmesh::kit::improve_vertex(subject.mesh, v, 0) == 0);
    CHECK(hmesh_test::snapshot(subject.mesh) == before);
}

TEST_CASE("a sweep visits the vertices that are dirty and no other, and a gain makes the neighbors dirty") {
    Subject<std::uint8_t, 1> subject(hmesh_test::scene<std::uint8_t, 1>(41, 36, 1), hmesh_test::jittered_grid(41, 36, 6, 5, 1));
    ImageMesh<1>& mesh = subject.mesh;
    set_all_dirty(mesh, false);
    const auto before = hmesh_test::snapshot(mesh);
    CHECK(hmesh::kit::sweep(mesh, thorough) == 0);
    CHECK(hmesh_test::snapshot(mesh) == before);

    const Vertex dirty(mesh.vertex_count() / 2);
    mesh.set_dirty(dirty, true);
    const auto old = states(mesh);
    CHECK(hmesh::kit::sweep(mesh, {1e9, 0}) > 0);  // nothing gains so much that it spreads
    for (const Vertex v : mesh.topology().vertices()) {
        CHECK_FALSE(mesh.is_dirty(v));
        if (v != dirty) CHECK((mesh.position(v) == old[v.index()].position && mesh.color(v)[0] == old[v.index()].color[0]));
    }

    // With a tolerance sweeps come to rest: nothing is dirty, and another sweep does nothing.
    set_all_dirty(mesh, true);
    int sweeps = 0;
    for (bool any = true; any && sweeps < 500; ++sweeps) {
        hmesh::kit::sweep(mesh, {1e-3, 1e-3});
        any = false;
        for (const Vertex v : mesh.topology().vertices()) any = any || mesh.is_dirty(v);
    }
    CHECK(sweeps > 2);
    CHECK(sweeps < 500);
    CHECK(hmesh::kit::sweep(mesh, thorough) == 0);
}

TEST_CASE("a sweep that is told to stop does, and what it did not visit stays dirty") {
    Subject<std::uint8_t, 1> subject(hmesh_test::scene<std::uint8_t, 1>(60, 50, 3), hmesh_test::jittered_grid(60, 50, 20, 20, 3));
    ImageMesh<1>& mesh = subject.mesh;
    set_all_dirty(mesh, true);
    const auto stop = [](const hmesh::ProgressInfo&) { return false; };
    hmesh::kit::ProgressReporter progress(stop, 3000, 255);
    hmesh::kit::TaskProgress task(progress, 1);
    mesh.set_task(&task);
    hmesh::kit::sweep(mesh, {1e300, 0});  // no gain makes neighbours dirty
    mesh.set_task(nullptr);
    std::size_t dirty = 0;
    for (const Vertex v : mesh.topology().vertices()) dirty += mesh.is_dirty(v) ? 1 : 0;
    CHECK(dirty == mesh.vertex_count() - 255);  // the callback is asked at the 256th visit
}

TEST_CASE("an affine picture is reproduced to rounding") {
    hmesh::Image<std::uint16_t, 3> image(40, 30);
    for (int y = 0; y < 30; ++y)
        for (int x = 0; x < 40; ++x)
            for (int k = 0; k < 3; ++k)
                image.pixel(x, y)[k] = static_cast<std::uint16_t>(9000 + (300 + 11 * k) * x - (77 * k + 1) * y);
    Subject<std::uint16_t, 3> subject(std::move(image), hmesh_test::jittered_grid(40, 30, 6, 5, 1));
    CHECK(subject.mesh.energy() > 1e6);
    for (int k = 0; k < 60; ++k) {
        set_all_dirty(subject.mesh, true);
        hmesh::kit::sweep(subject.mesh, thorough);
    }
    CHECK(std::abs(subject.mesh.energy()) < 1e-12 * hmesh_test::squares(subject.image));
    CHECK(hmesh_test::brute_energy(subject) < 1e-12 * hmesh_test::squares(subject.image));
    hmesh_test::prove(subject);
}

TEST_CASE("a mesh is found again from its picture when its vertices have been pushed away") {
    const int width = 72, height = 60;
    auto grid = hmesh_test::jittered_grid(width, height, 6, 5, 3);
    Subject<float, 2> truth(hmesh_test::constant_image<float, 2>(width, height, 0), grid);
    Random random(3);
    for (const Vertex v : truth.mesh.topology().vertices()) {
        Color<2> color = Color<2>::zero();
        for (int k = 0; k < 2; ++k) color.set(k, 255 * random.uniform());
        truth.mesh.place(v, truth.mesh.position(v), color);
    }
    Subject<float, 2> subject(picture_of(truth.mesh), grid);
    ImageMesh<2>& mesh = subject.mesh;
    for (const Vertex v : mesh.topology().vertices()) mesh.place(v, hmesh_test::any_place(mesh, v, 1.5, random), mesh.color(v));
    // The best that colours alone can do, then the vertices.
    for (int k = 0; k < 30; ++k)
        for (const Vertex v : mesh.topology().vertices())
            hmesh::kit::improve_vertex(mesh, v, std::numeric_limits<double>::infinity());
    const double start = mesh.energy();
    for (int k = 0; k < 200; ++k) {
        set_all_dirty(mesh, true);
        hmesh::kit::sweep(mesh, thorough);
    }
    hmesh_test::prove(subject);
    CHECK(start > 1e4);
    CHECK(mesh.energy() < 1e-3 * start);
    double worst = 0;
    for (const Vertex v : mesh.topology().vertices()) {
        const Point p = mesh.position(v), q = truth.mesh.position(v);
        worst = std::max(worst, std::max(std::abs(p.x - q.x), std::abs(p.y - q.y)));
    }
    CHECK(worst < 0.1);
}

TEST_CASE("what a vertex does depends on the picture, not on the unit of its samples") {
    // Powers of two, so that nothing rounds differently.
    const auto grid = hmesh_test::jittered_grid(41, 36, 5, 5, 1);
    const auto image = hmesh_test::scene<float, 1>(41, 36, 1);
    for (const double factor : {1.0 / 256, 1.0 / 1048576}) {
        Subject<float, 1> large(hmesh_test::scaled(image, 256), grid), small(hmesh_test::scaled(image, 256 * factor), grid);
        for (int k = 0; k < 10; ++k) {
            hmesh::kit::sweep(large.mesh);
            hmesh::kit::sweep(small.mesh);
        }
        CHECK(small.mesh.energy() == doctest::Approx(factor * factor * large.mesh.energy()).epsilon(1e-6).scale(0));
    }
}
