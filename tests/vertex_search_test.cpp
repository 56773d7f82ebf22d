#include "hmesh/methods/baselines/vertex_search.hpp"

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
#include "hmesh/mesh/delaunay.hpp"
#include "test_images.hpp"
#include "test_meshes.hpp"

namespace kit = hmesh::kit;
using hmesh::Image;
using hmesh::kit::Color;
using hmesh::kit::Face;
using hmesh::kit::Halfedge;
using hmesh::kit::ImageMesh;
using hmesh::kit::Mobility;
using hmesh::kit::Point;
using hmesh::kit::Random;
using hmesh::kit::Ring;
using hmesh::kit::sampled_color;
using hmesh::kit::search_vertices;
using hmesh::kit::Spokes;
using hmesh::kit::Vertex;
using hmesh::kit::VertexState;
using hmesh_test::Subject;
using hmesh_test::Triangulation;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Triangulation delaunay(int width, int height, const std::vector<Point>& points) {
    const kit::Delaunay mesh = kit::triangulate(width, height, points);
    Triangulation out;
    out.positions = mesh.positions();
    for (const Face f : mesh.topology().faces()) {
        const auto v = mesh.topology().vertices(f);
        out.triangles.push_back({static_cast<std::uint32_t>(v[0].index()), static_cast<std::uint32_t>(v[1].index()),
                                 static_cast<std::uint32_t>(v[2].index())});
    }
    return out;
}

// The centres of some pixels, those of the outermost ones on the border.
Triangulation on_pixels(int width, int height, int count, std::uint64_t seed) {
    Random random(seed);
    std::vector<Point> points;
    const auto place = [&](int size) {
        const auto i = static_cast<int>(random.below(static_cast<std::size_t>(size)));
        return size == 1 ? 0.5 : i == 0 ? 0.0 : i == size - 1 ? size : i + 0.5;
    };
    for (int k = 0; k < count; ++k) {
        const double x = place(width);
        points.push_back({x, place(height)});
    }
    return delaunay(width, height, points);
}

// A vertex of at least 71 neighbours, which are on the left side of a 170 x 161 px image and in its sight.
Triangulation fan() {
    std::vector<Point> points{{80.5, 80.5}};
    for (int k = 0; k < 71; ++k) points.push_back({0, 10.5 + 2 * k});
    return delaunay(170, 161, points);
}

bool is_center(double x) { return x - std::floor(x) == 0.5; }

template <int C>
double ring_energy(const ImageMesh<C>& mesh, Vertex v) {
    double energy = 0;
    for (const Halfedge h : mesh.topology().outgoing(v))
        if (!mesh.topology().is_boundary(h)) energy += mesh.energy(mesh.topology().face(h));
    return energy;
}

// By how much the best single move of a vertex by `step` px lowers the energy; not of vertices of more neighbours than fit
// a ring.
template <int C>
double largest_gain(ImageMesh<C>& mesh, int step) {
    double largest = 0;
    for (const Vertex v : mesh.topology().vertices()) {
        const VertexState<C> state = mesh.vertex(v);
        if (state.mobility == Mobility::corner || mesh.topology().valence(v) > kit::ring_capacity) continue;
        const double before = ring_energy(mesh, v);
        for (int dy = -step; dy <= step; dy += step)
            for (int dx = -step; dx <= step; dx += step) {
                const Point p{state.position.x + dx, state.position.y + dy};
                if (p.x < 0 || p.y < 0 || p.x > mesh.width() || p.y > mesh.height()) continue;
                if (mesh.mobility_at(p) != state.mobility || (dx == 0 && dy == 0)) continue;
                const auto mark = mesh.begin();
                mesh.place(v, p, sampled_color(mesh.table(), p));
                bool fits = true;
                for (const Halfedge h : mesh.topology().outgoing(v)) {
                    if (mesh.topology().is_boundary(h)) continue;
                    const auto u = mesh.topology().vertices(mesh.topology().face(h));
                    const double area = kit::orient2d(mesh.position(u[0]), mesh.position(u[1]), mesh.position(u[2]));
                    fits = fits && area >= mesh.limits().min_double_area;
                }
                if (fits) largest = std::max(largest, before - ring_energy(mesh, v));
                mesh.rollback(mark);
            }
    }
    return largest;
}

template <int C>
std::vector<VertexState<C>> states(const ImageMesh<C>& mesh) {
    std::vector<VertexState<C>> all;
    for (std::size_t i = 0; i < mesh.topology().vertex_slots(); ++i) all.push_back(mesh.vertex(Vertex(i)));
    return all;
}

// Vertices are where a search may bring them, with the colours there.
template <class T, int C>
void check_places(const Subject<T, C>& subject, const std::vector<VertexState<C>>& old) {
    const ImageMesh<C>& mesh = subject.mesh;
    hmesh_test::prove(subject);
    for (const Vertex v : mesh.topology().vertices()) {
        const VertexState<C>&before = old[v.index()], &after = mesh.vertex(v);
        REQUIRE(after.mobility == before.mobility);
        const bool held_x = before.mobility == Mobility::corner || before.mobility == Mobility::along_y;
        const bool held_y = before.mobility == Mobility::corner || before.mobility == Mobility::along_x;
        REQUIRE((held_x ? after.position.x == before.position.x : is_center(after.position.x)));
        REQUIRE((held_y ? after.position.y == before.position.y : is_center(after.position.y)));
        const Color<C> color = sampled_color(mesh.table(), after.position);
        for (int c = 0; c < kit::lanes_for(C + 1); ++c) REQUIRE(after.color[c] == color[c]);
    }
}

template <class T, int C>
void check_search(const Image<T, C>& image, int count, std::uint64_t seed) {
    for (const int first_step : {1, 3, 4, 64}) {
        Subject<T, C> subject(image, on_pixels(image.width(), image.height(), count, seed));
        ImageMesh<C>& mesh = subject.mesh;
        kit::sample_colors(mesh);
        CHECK(largest_gain(mesh, 1) > 1e-3 * mesh.mean_energy());
        const auto old = states(mesh);
        // Round by round the energy falls.
        double before = mesh.energy();
        std::size_t moves = search_vertices(mesh, {first_step, 1});
        CHECK(moves > 0);
        CHECK(moves <= mesh.vertex_count());
        CHECK(mesh.energy() < before);
        check_places(subject, old);
        std::size_t moved = 0;
        for (const Vertex v : mesh.topology().vertices()) moved += mesh.position(v) == old[v.index()].position ? 0U : 1U;
        CHECK(moved == moves);
        before = mesh.energy();
        moves = search_vertices(mesh, {first_step, 1000});
        CHECK(mesh.energy() <= before);
        check_places(subject, old);
        // No vertex is left that would gain by any of the steps.
        const double slack = 1e-9 * mesh.energy() + 1e-12 * hmesh_test::squares(image);
        for (int step = first_step; step >= 1; step /= 2) CHECK(largest_gain(mesh, step) <= slack);
        const auto still = hmesh_test::snapshot(mesh);
        CHECK(search_vertices(mesh, {first_step, 1000}) == 0);
        CHECK(hmesh_test::snapshot(mesh) == still);
    }
}

template <class T, int C>
void check_centerd(const Image<T, C>& image, std::uint64_t seed) {
    Subject<T, C> subject(image, hmesh_test::jittered_grid(image.width(), image.height(), 5, 4, seed));
    ImageMesh<C>& mesh = subject.mesh;
    const double range = hmesh::PixelTraits<T>::peak;
    hmesh_test::wear(mesh, 60, range, seed);
    const double slack = hmesh_test::rounding(subject);
    Random random(seed);
    Ring<C> ring;
    Spokes<C> spokes;
    int open = 0;
    for (int k = 0; k < 200; ++k) {
        const Vertex v = hmesh_test::any_vertex(mesh, random);
        VertexState<C> center = mesh.vertex(v);
        center.position = hmesh_test::any_place(mesh, v, 3, random);
        center.color = hmesh_test::any_color(mesh, v, range, random);
        mesh.gather(v, ring, spokes);
        open += ring.open ? 1 : 0;
        const double energy = kit::detail::centered_energy(mesh.table(), ring, center, infinity);
        const auto mark = mesh.begin();
        mesh.place(v, center.position, center.color);
        double expected = 0;
        for (const Halfedge h : mesh.topology().outgoing(v))
            if (!mesh.topology().is_boundary(h)) expected += hmesh_test::brute_energy(subject, mesh.topology().face(h));
        CHECK(std::abs(energy - expected) <= slack);
        mesh.rollback(mark);
        // Bounds above the energy change nothing, others are reached.
        CHECK(kit::detail::centered_energy(mesh.table(), ring, center, 1.01 * energy + slack) == energy);
        for (const double part : {0.0, 0.3, 0.99})
            CHECK(kit::detail::centered_energy(mesh.table(), ring, center, part * energy) >= part * energy);
    }
    CHECK(open > 20);
}

}  // namespace

TEST_CASE("the energy of a ring around a trial is that of its faces once the vertex is there; past a bound it may stop") {
    check_centerd(hmesh_test::scene<std::uint8_t, 3>(31, 26, 1), 1);
    check_centerd(hmesh_test::noise<std::uint16_t, 1>(30, 28, 2), 2);
    check_centerd(hmesh_test::scene<float, 4>(26, 30, 3), 3);
}

TEST_CASE("a search lowers the energy, keeps vertices on pixels or on their side, and ends where no single step gains") {
    check_search(hmesh_test::scene<std::uint8_t, 3>(41, 36, 1), 40, 1);
    check_search(hmesh_test::noise<std::uint16_t, 1>(30, 38, 2), 40, 2);
    check_search(hmesh_test::scene<float, 2>(36, 30, 3), 25, 3);
    check_search(hmesh_test::checkerboard<std::uint8_t, 1>(28, 34, 5), 30, 4);
}

TEST_CASE("images of one or two rows or columns are searched like any") {
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 40}, {40, 1}, {2, 2}, {2, 30}, {30, 2}, {3, 3}}) {
        Subject<std::uint8_t, 2> subject(hmesh_test::noise<std::uint8_t, 2>(width, height, 1),
                                         on_pixels(width, height, std::max(width, height) / 4, 2));
        kit::sample_colors(subject.mesh);
        const auto old = states(subject.mesh);
        const double before = subject.mesh.energy();
        const std::size_t moves = search_vertices(subject.mesh, {4, 100});
        CHECK((width + height < 30 || moves > 0));
        CHECK(subject.mesh.energy() <= before);
        for (const Vertex v : subject.mesh.topology().vertices())
            if (subject.mesh.vertex(v).mobility == Mobility::corner) CHECK(subject.mesh.position(v) == old[v.index()].position);
        hmesh_test::prove(subject);
    }
}

TEST_CASE("a vertex finds the tip of a tent, and one on the side the foot of a ridge") {
    const auto tent = hmesh_test::draw<std::uint8_t, 1>(
        40, 30, [](int x, int y, int) { return 1 - std::max(std::abs(x - 24) / 24.0, std::abs(y - 11) / 18.0); });
    Subject<std::uint8_t, 1> subject(tent, delaunay(40, 30, {{9.5, 22.5}}));
    kit::sample_colors(subject.mesh);
    CHECK(search_vertices(subject.mesh, {}) > 0);
    CHECK(subject.mesh.position(Vertex(4)) == Point{24.5, 11.5});
    const auto ridge = hmesh_test::draw<std::uint8_t, 1>(40, 30, [](int x, int, int) { return 1 - std::abs(x - 24) / 24.0; });
    Subject<std::uint8_t, 1> sides(ridge, delaunay(40, 30, {{9.5, 0}, {11.5, 30}}));
    kit::sample_colors(sides.mesh);
    CHECK(search_vertices(sides.mesh, {}) > 0);
    for (const std::size_t v : {4U, 5U}) CHECK(sides.mesh.position(Vertex(v)).x == 24.5);
}

TEST_CASE("pictures that any mesh fits move no vertex") {
    const auto check_still = [](const auto& image) {
        Subject subject(image, on_pixels(image.width(), image.height(), 40, 1));
        kit::sample_colors(subject.mesh);
        const auto before = hmesh_test::snapshot(subject.mesh);
        CHECK(search_vertices(subject.mesh, {}) == 0);
        CHECK(hmesh_test::snapshot(subject.mesh) == before);
    };
    check_still(hmesh_test::constant_image<std::uint8_t, 3>(41, 36, 0.3));
    check_still(hmesh_test::constant_image<std::uint16_t, 1>(41, 36, 0.7));
    check_still(hmesh_test::constant_image<float, 1>(41, 36, 0.3));
    check_still(hmesh_test::constant_image<float, 3>(41, 36, 0.7));
}

TEST_CASE("vertices of more neighbors than fit a ring stay, and those around them move") {
    Subject<std::uint8_t, 3> subject(hmesh_test::scene<std::uint8_t, 3>(170, 161, 1), fan());
    ImageMesh<3>& mesh = subject.mesh;
    kit::sample_colors(mesh);
    const auto old = states(mesh);
    int large = 0;
    for (const Vertex v : mesh.topology().vertices()) large += mesh.topology().valence(v) > kit::ring_capacity ? 1 : 0;
    REQUIRE(large == 1);
    const double before = mesh.energy();
    CHECK(search_vertices(mesh, {4, 1000}) > 0);
    CHECK(mesh.energy() < before);
    hmesh_test::prove(subject);
    CHECK(largest_gain(mesh, 1) <= 1e-9 * before);
    for (const Vertex v : mesh.topology().vertices())
        if (mesh.topology().valence(v) > kit::ring_capacity) CHECK(mesh.position(v) == old[v.index()].position);
}

TEST_CASE("locked vertices stay, and vertices off the pixels stay as far off them") {
    Subject<std::uint8_t, 3> subject(hmesh_test::scene<std::uint8_t, 3>(41, 36, 1), hmesh_test::jittered_grid(41, 36, 6, 5, 1));
    ImageMesh<3>& mesh = subject.mesh;
    kit::sample_colors(mesh);
    for (std::size_t i = 0; i < mesh.vertex_count(); i += 3) mesh.lock(Vertex(i), kit::max_valence);
    const auto old = states(mesh);
    CHECK(search_vertices(mesh, {}) > 5);
    hmesh_test::prove(subject);
    for (const Vertex v : mesh.topology().vertices()) {
        const Point from = old[v.index()].position, to = mesh.position(v);
        if (v.index() % 3 == 0) CHECK(from == to);
        CHECK(to.x - from.x == std::round(to.x - from.x));
        CHECK(to.y - from.y == std::round(to.y - from.y));
        if (from != to && mesh.vertex(v).mobility == Mobility::free) CHECK(std::min({to.x, to.y, 41 - to.x, 36 - to.y}) >= 0.5);
    }
}

TEST_CASE("over an image with weights the energy that falls is the weighted one") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(41, 36, 1);
    const Image<float, 1> weights = hmesh_test::random_weights(41, 36, 2);
    const kit::MomentTable<3> table(image.view(), weights.view(), kit::weight_unit(weights.view()), image.view().bounds());
    ImageMesh<3> mesh(table, 0, 255);
    const Triangulation start = on_pixels(41, 36, 40, 1);
    REQUIRE(mesh.assign(start.positions, start.triangles));
    kit::sample_colors(mesh);
    const double before = mesh.energy();
    CHECK(search_vertices(mesh, {4, 1000}) > 0);
    CHECK(mesh.energy() < before);
    const hmesh::Status status = mesh.check();
    CHECK_MESSAGE(status, status.what);
    CHECK(largest_gain(mesh, 1) <= 1e-9 * before);
}

TEST_CASE("without visits, or told to stop, no vertex moves") {
    Subject<std::uint8_t, 3> subject(hmesh_test::scene<std::uint8_t, 3>(41, 36, 1), on_pixels(41, 36, 40, 1));
    kit::sample_colors(subject.mesh);
    const auto before = hmesh_test::snapshot(subject.mesh);
    CHECK(search_vertices(subject.mesh, {4, 0}) == 0);
    const auto stop = [](const hmesh::ProgressInfo&) { return false; };
    kit::ProgressReporter progress(stop, 1, 255);
    kit::TaskProgress task(progress, 1);
    subject.mesh.set_task(&task);
    (void)progress.poll();
    CHECK(search_vertices(subject.mesh, {}) == 0);
    CHECK(hmesh_test::snapshot(subject.mesh) == before);
    subject.mesh.set_task(nullptr);
    CHECK(search_vertices(subject.mesh, {}) > 0);
}
