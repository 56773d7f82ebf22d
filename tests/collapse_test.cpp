#include "hmesh/edit/collapse.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "hmesh/core/random.hpp"
#include "test_images.hpp"
#include "test_meshes.hpp"

using hmesh::kit::CollapseCandidate;
using hmesh::kit::Halfedge;
using hmesh::kit::HalfedgeMesh;
using hmesh::kit::ImageMesh;
using hmesh::kit::Mobility;
using hmesh::kit::Point;
using hmesh::kit::Vertex;
using hmesh_test::Subject;

namespace {

constexpr double never = std::numeric_limits<double>::max();

// By how much the energy rises when from_vertex(h) goes into to_vertex(h); infinite when it must not. Does it and undoes it.
template <class T, int C>
double brute_cost(Subject<T, C>& subject, Halfedge h) {
    ImageMesh<C>& mesh = subject.mesh;
    const HalfedgeMesh& topology = mesh.topology();
    const Vertex v = topology.from_vertex(h), u = topology.to_vertex(h);
    if (mesh.vertex(v).mobility == Mobility::corner || !topology.is_collapse_ok(h)) return never;
    const Point from = mesh.position(v), to = mesh.position(u);
    if (mesh.vertex(v).mobility == Mobility::along_x && from.y != to.y) return never;
    if (mesh.vertex(v).mobility == Mobility::along_y && from.x != to.x) return never;
    const double before = hmesh_test::brute_energy(subject);
    const auto mark = mesh.begin();
    mesh.collapse(h);
    bool allowed = topology.valence(u) <= hmesh::kit::max_valence;
    for (const Halfedge s : topology.outgoing(u)) {
        if (topology.is_boundary(s)) continue;
        const auto w = topology.vertices(topology.face(s));
        allowed = allowed && hmesh::kit::orient2d(mesh.position(w[0]), mesh.position(w[1]), mesh.position(w[2])) >=
                                 mesh.limits().min_double_area;
    }
    double rise = never;
    if (allowed) {
        hmesh_test::prove(subject);
        rise = mesh.energy() - before;
    }
    mesh.rollback(mark);
    return rise;
}

struct Seen {
    int interior = 0, border = 0, valence_3 = 0, stuck = 0;
};

template <class T, int C>
void check_costs(Subject<T, C>& subject, Seen& seen) {
    const HalfedgeMesh& topology = subject.mesh.topology();
    hmesh::kit::RingScratch<C> work;
    for (std::size_t i = 0; i < topology.vertex_slots(); ++i) {
        const Vertex v(i);
        if (topology.is_deleted(v)) continue;
        const CollapseCandidate candidate = hmesh::kit::cheapest_collapse(subject.mesh, work, v);
        std::vector<Halfedge> spokes;
        for (const Halfedge h : topology.outgoing(v)) spokes.push_back(h);
        double least = never;
        for (const Halfedge h : spokes) least = std::min(least, brute_cost(subject, h));
        REQUIRE(candidate.halfedge.is_valid() == (least < never));
        if (!candidate.halfedge.is_valid()) {
            REQUIRE(candidate.cost == never);
            ++seen.stuck;
            continue;
        }
        REQUIRE(topology.from_vertex(candidate.halfedge) == v);
        const double slack = 2 * hmesh_test::rounding(subject);
        REQUIRE(std::abs(candidate.cost - least) <= slack);
        REQUIRE(std::abs(candidate.cost - brute_cost(subject, candidate.halfedge)) <= slack);
        ++(topology.is_boundary(v) ? seen.border : seen.interior);
        if (!topology.is_boundary(v) && spokes.size() == 3) ++seen.valence_3;
    }
}

template <class T, int C>
void check_worn(hmesh::Image<T, C> image, double range, std::uint64_t seed, Seen& seen) {
    const int width = image.width(), height = image.height();
    Subject<T, C> subject(std::move(image), hmesh_test::jittered_grid(width, height, 4, 4, seed));
    for (int k = 0; k < 3; ++k) {
        check_costs(subject, seen);
        hmesh_test::wear(subject.mesh, 40, range, seed + static_cast<std::uint64_t>(k));
    }
}

template <class T, int C>
void check_batches(hmesh::Image<T, C> image, int columns, int rows, std::uint64_t seed) {
    const int width = image.width(), height = image.height();
    Subject<T, C> subject(std::move(image), hmesh_test::jittered_grid(width, height, columns, rows, seed));
    ImageMesh<C>& mesh = subject.mesh;
    int rounds = 0;
    for (std::size_t count = 1; mesh.vertex_count() > 4; count = count % 9 + 1, ++rounds) {
        const std::size_t vertices = mesh.vertex_count();
        const std::size_t removed = hmesh::kit::remove_batch(mesh, count, {});
        REQUIRE(removed >= 1);  // else it would never end
        REQUIRE(removed <= count);
        REQUIRE(mesh.vertex_count() == vertices - removed);
        hmesh_test::prove(subject);
        REQUIRE(rounds < 1000);
    }
    std::vector<Point> corners;
    for (const Vertex v : mesh.topology().vertices()) corners.push_back(mesh.position(v));
    const double w = width, h = height;
    for (const Point corner : {Point{0, 0}, Point{w, 0}, Point{0, h}, Point{w, h}})
        CHECK(std::count(corners.begin(), corners.end(), corner) == 1);
    CHECK(hmesh::kit::remove_batch(mesh, 5, {}) == 0);
}

}  // namespace

TEST_CASE("the cheapest collapse costs what the energy rises by, and no neighbor that a vertex may go into costs less") {
    Seen seen;
    check_worn(hmesh_test::scene<std::uint8_t, 3>(26, 23, 1), 255, 1, seen);
    check_worn(hmesh_test::noise<std::uint16_t, 1>(25, 24, 2), 65535, 2, seen);
    check_worn(hmesh_test::scene<float, 4>(22, 26, 3), 1, 3, seen);
    check_worn(hmesh_test::checkerboard<std::uint8_t, 7>(20, 20, 3), 255, 4, seen);
    CHECK(seen.interior > 60);
    CHECK(seen.border > 60);
    CHECK(seen.valence_3 > 10);
    CHECK(seen.stuck > 40);  // the corners at least
}

TEST_CASE("the cheapest collapse is known for the smallest meshes and images") {
    Seen seen;
    Subject<std::uint8_t, 1> one(hmesh_test::noise<std::uint8_t, 1>(1, 1, 1), hmesh_test::jittered_grid(1, 1, 2, 2, 1));
    check_costs(one, seen);
    Subject<std::uint8_t, 3> column(hmesh_test::noise<std::uint8_t, 3>(1, 12, 1), hmesh_test::jittered_grid(1, 12, 1, 5, 1));
    check_costs(column, seen);
    Subject<float, 1> row(hmesh_test::noise<float, 1>(12, 1, 1), hmesh_test::jittered_grid(12, 1, 5, 2, 1));
    check_costs(row, seen);
    Subject<std::uint8_t, 1> fan(hmesh_test::noise<std::uint8_t, 1>(9, 9, 1));
    REQUIRE(fan.mesh.assign({{0, 0}, {9, 0}, {9, 9}, {0, 9}, {4, 5}}, {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}));
    check_costs(fan, seen);
    CHECK(seen.interior >= 4);
    CHECK(seen.border >= 10);
}

TEST_CASE("a mesh loses its cheapest vertices, as many as asked for where they are apart, down to its four corners") {
    check_batches(hmesh_test::scene<std::uint8_t, 3>(41, 36, 1), 7, 6, 1);
    check_batches(hmesh_test::noise<std::uint16_t, 1>(30, 33, 2), 5, 5, 2);
    check_batches(hmesh_test::scene<float, 2>(33, 28, 3), 5, 4, 3);
    check_batches(hmesh_test::constant_image<std::uint8_t, 1>(30, 30, 0.5), 5, 5, 4);
    check_batches(hmesh_test::noise<std::uint8_t, 1>(1, 1, 5), 2, 2, 5);
    check_batches(hmesh_test::noise<std::uint8_t, 3>(1, 15, 6), 1, 8, 6);
    check_batches(hmesh_test::noise<float, 1>(15, 1, 7), 8, 1, 7);
    check_batches(hmesh_test::scaled(hmesh_test::scene<float, 1>(20, 20, 8), 1e6), 4, 4, 8);
    check_batches(hmesh_test::scaled(hmesh_test::scene<float, 1>(20, 20, 9), 1e-6), 4, 4, 9);
}

TEST_CASE("one vertex removed is the cheapest of all, and its neighbors become due") {
    Subject<std::uint8_t, 3> subject(hmesh_test::scene<std::uint8_t, 3>(41, 36, 1), hmesh_test::jittered_grid(41, 36, 6, 5, 1));
    ImageMesh<3>& mesh = subject.mesh;
    for (int k = 0; k < 3; ++k) hmesh::kit::sweep(mesh);
    for (int k = 0; k < 20; ++k) {
        for (const Vertex v : mesh.topology().vertices()) mesh.set_dirty(v, false);
        Vertex cheapest;
        double least = never;
        hmesh::kit::RingScratch<3> work;
        for (const Vertex v : mesh.topology().vertices()) {
            const CollapseCandidate candidate = hmesh::kit::cheapest_collapse(mesh, work, v);
            if (candidate.cost < least) least = candidate.cost, cheapest = v;
        }
        REQUIRE(cheapest.is_valid());
        std::vector<Vertex> ring;
        for (const Halfedge h : mesh.topology().outgoing(cheapest)) ring.push_back(mesh.topology().to_vertex(h));
        const double before = mesh.energy();
        REQUIRE(hmesh::kit::remove_batch(mesh, 1, {}) == 1);
        CHECK(mesh.topology().is_deleted(cheapest));
        CHECK(mesh.energy() <= before + least + hmesh_test::rounding(subject));  // relaxing only makes it better
        for (const Vertex u : ring) CHECK(mesh.is_dirty(u));
        hmesh_test::prove(subject);
    }
}

TEST_CASE("removals are chosen cheapest first, from those on offer alone, none beside another") {
    Subject<std::uint8_t, 1> subject(hmesh_test::scene<std::uint8_t, 1>(90, 80, 1), hmesh_test::jittered_grid(90, 80, 20, 20, 1));
    const ImageMesh<1>& mesh = subject.mesh;
    std::vector<Vertex> offered;
    for (const Vertex v : hmesh::kit::spatial_vertices(mesh))
        if (v.index() % 3 != 0) offered.push_back(v);
    const auto all = hmesh::kit::cheapest_removals(mesh, offered, mesh.vertex_count());
    // By brute force: the cheapest that is left, then no neighbour of it.
    hmesh::kit::RingScratch<1> work;
    std::vector<double> costs(mesh.topology().vertex_slots(), never);
    for (const Vertex v : offered) costs[v.index()] = hmesh::kit::cheapest_collapse(mesh, work, v).cost;
    for (const auto& removal : all) {
        const auto least = std::min_element(costs.begin(), costs.end());
        REQUIRE(removal.cost == *least);
        REQUIRE(costs[removal.vertex.index()] == *least);
        REQUIRE(offered[removal.place] == removal.vertex);
        costs[removal.vertex.index()] = never;
        for (const Halfedge h : mesh.topology().outgoing(removal.vertex)) costs[mesh.topology().to_vertex(h).index()] = never;
    }
    CHECK(*std::min_element(costs.begin(), costs.end()) == never);
    const auto some = hmesh::kit::cheapest_removals(mesh, offered, 10);
    REQUIRE(some.size() == 10);
    for (std::size_t k = 0; k < some.size(); ++k) CHECK(some[k].vertex == all[k].vertex);
    // Of those chosen the first are removed.
    CHECK(hmesh::kit::remove_batch(subject.mesh, all, 7, {}) == 7);
    for (std::size_t k = 0; k < all.size(); ++k) CHECK(mesh.topology().is_deleted(all[k].vertex) == (k < 7));
    hmesh_test::prove(subject);
}

TEST_CASE("a batch removes as many as asked for as long as enough vertices share no neighbor") {
    Subject<std::uint8_t, 1> subject(hmesh_test::scene<std::uint8_t, 1>(90, 80, 1), hmesh_test::jittered_grid(90, 80, 20, 20, 1));
    const std::size_t vertices = subject.mesh.vertex_count();
    CHECK(hmesh::kit::remove_batch(subject.mesh, 0, {}) == 0);
    CHECK(hmesh::kit::remove_batch(subject.mesh, 40, {}) == 40);
    CHECK(subject.mesh.vertex_count() == vertices - 40);
    const std::size_t removed = hmesh::kit::remove_batch(subject.mesh, 100000, {});
    CHECK(removed > 20);
    CHECK(removed < vertices / 2);
    hmesh_test::prove(subject);
}

TEST_CASE("no collapse gives a vertex more neighbors than it may have, inside the image") {
    Subject<std::uint8_t, 1> wheel(hmesh_test::noise<std::uint8_t, 1>(64, 64, 1), hmesh_test::wheel(64, hmesh::kit::max_valence));
    Seen seen;
    check_costs(wheel, seen);
    for (int k = 0; k < 30; ++k) {
        hmesh::kit::remove_batch(wheel.mesh, 3, {});
        for (const Vertex v : wheel.mesh.topology().vertices())
            REQUIRE(wheel.mesh.topology().valence(v) <= hmesh::kit::max_valence);
    }
    hmesh_test::prove(wheel);
}

TEST_CASE("no collapse gives a vertex more neighbors than it may have, on the border") {
    // A hub (vertex 0) on the upper side with a fan below it, and right of it vertex 1 with 4 neighbours, which would
    // best go into the hub: the picture is flat there, and not in the corner.
    hmesh::Image<std::uint8_t, 1> image(64, 64);
    for (int y = 0; y < 64; ++y)
        for (int x = 60; x < 64; ++x) *image.pixel(x, y) = 200;
    for (const int valence : {hmesh::kit::max_valence - 1, hmesh::kit::max_valence}) {
        // hub, beside it, beyond that, left of the hub, and the corners from the upper right on
        hmesh_test::Triangulation half{{{32, 0}, {48, 0}, {56, 4}, {16, 0}, {64, 0}, {64, 64}, {0, 64}, {0, 0}}, {}};
        const auto rim_size = static_cast<std::uint32_t>(valence - 2);
        for (std::uint32_t k = 0; k < rim_size; ++k) {
            const double angle = (20 + 145.0 * k / (rim_size - 1)) * 3.141592653589793 / 180;
            half.positions.push_back(hmesh::kit::snap(Point{32 + 14 * std::cos(angle), 14 * std::sin(angle)}));
        }
        const std::uint32_t first = 8, last = first + rim_size - 1, middle = first + rim_size / 2;
        half.triangles = {{0, 1, first},  {1, 2, first}, {1, 4, 2},    {2, 4, 5}, {2, 5, first},
                          {middle, 5, 6}, {0, last, 3},  {3, last, 6}, {3, 6, 7}};
        for (std::uint32_t k = first; k < last; ++k) {
            half.triangles.push_back({0, k, k + 1});
            half.triangles.push_back({k + 1, k, k < middle ? 5U : 6U});
        }
        Subject<std::uint8_t, 1> subject(image, half);
        hmesh_test::prove(subject);
        const HalfedgeMesh& topology = subject.mesh.topology();
        REQUIRE(topology.valence(Vertex(0)) == valence);
        REQUIRE(topology.valence(Vertex(1)) == 4);
        hmesh::kit::RingScratch<1> work;
        const CollapseCandidate candidate = hmesh::kit::cheapest_collapse(subject.mesh, work, Vertex(1));
        REQUIRE(candidate.halfedge.is_valid());
        CHECK((topology.to_vertex(candidate.halfedge) == Vertex(0)) == (valence < hmesh::kit::max_valence));
        subject.mesh.collapse(candidate.halfedge);
        CHECK(topology.valence(Vertex(0)) <= hmesh::kit::max_valence);
        hmesh_test::prove(subject);
    }
}
