#include "hmesh/fit/image_mesh.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "hmesh/core/random.hpp"
#include "mesh_flaws.hpp"
#include "test_executors.hpp"
#include "test_images.hpp"
#include "test_meshes.hpp"

using hmesh::Errc;
using hmesh::Triangle;
using hmesh::kit::Color;
using hmesh::kit::Edge;
using hmesh::kit::Face;
using hmesh::kit::Halfedge;
using hmesh::kit::HalfedgeMesh;
using hmesh::kit::ImageMesh;
using hmesh::kit::Mobility;
using hmesh::kit::Point;
using hmesh::kit::Random;
using hmesh::kit::Vertex;
using hmesh_test::Snapshot;
using hmesh_test::Subject;

namespace {

// Greedy and random edits by turns, each followed by proof of everything the mesh promises.
template <class T, int C>
void torture(hmesh::Image<T, C> image, int columns, int rows, int edits, double range, std::uint64_t seed) {
    const int width = image.width(), height = image.height();
    Subject<T, C> subject(std::move(image), hmesh_test::jittered_grid(width, height, columns, rows, seed));
    ImageMesh<C>& mesh = subject.mesh;
    hmesh_test::prove(subject);
    Random random(seed);
    for (int k = 0; k < edits; ++k) {
        switch (random.below(4)) {
            case 0: hmesh::kit::improve_vertex(mesh, hmesh_test::any_vertex(mesh, random), 0); break;
            case 1: hmesh::kit::improve_edge(mesh, hmesh_test::any_edge(mesh, random), 0); break;
            default: hmesh_test::random_edit(mesh, range, random); break;
        }
        hmesh_test::prove(subject);
    }
}

// Edits in transactions up to three deep, each ended at random; a rollback must give back the snapshot of its beginning.
template <int C>
void transact(ImageMesh<C>& mesh, Random& random, int depth, int& rollbacks) {
    const Snapshot before = hmesh_test::snapshot(mesh);
    const auto mark = mesh.begin();
    const int edits = 1 + static_cast<int>(random.below(12));
    for (int k = 0; k < edits; ++k) {
        if (depth < 3 && random.below(6) == 0) transact(mesh, random, depth + 1, rollbacks);
        switch (random.below(4)) {
            case 0: hmesh::kit::improve_vertex(mesh, hmesh_test::any_vertex(mesh, random), 0); break;
            case 1: hmesh::kit::improve_edge(mesh, hmesh_test::any_edge(mesh, random), 0); break;
            default: hmesh_test::random_edit(mesh, 255.0, random); break;
        }
    }
    if (random.below(3) == 0) {
        mesh.commit(mark);
        return;
    }
    const Snapshot dirty = hmesh_test::snapshot(mesh);
    rollbacks += dirty == before ? 0 : 1;
    mesh.rollback(mark);
    REQUIRE(hmesh_test::snapshot(mesh) == before);
}

const std::vector<Point> square = {{0, 0}, {8, 0}, {8, 6}, {0, 6}};

}  // namespace

TEST_CASE("a mesh stays true to its pixels through thousands of edits, for every sample type and number of channels") {
    torture(hmesh_test::scene<std::uint8_t, 3>(26, 22, 1), 4, 4, 700, 255, 1);
    torture(hmesh_test::scene<std::uint8_t, 1>(25, 21, 2), 4, 3, 700, 255, 2);
    torture(hmesh_test::noise<std::uint16_t, 2>(20, 24, 3), 3, 4, 500, 65535, 3);
    torture(hmesh_test::scene<float, 4>(22, 20, 4), 4, 3, 500, 1, 4);
    torture(hmesh_test::checkerboard<std::uint8_t, 7>(21, 17, 3), 3, 3, 300, 255, 5);
    torture(hmesh_test::noise<float, 1>(17, 23, 6), 2, 2, 500, 1, 6);
}

TEST_CASE("a mesh stays true over constant and affine pictures, and over floats that are very large or very small") {
    torture(hmesh_test::constant_image<std::uint8_t, 3>(18, 15, 1), 3, 3, 300, 255, 11);
    torture(hmesh_test::constant_image<std::uint8_t, 1>(18, 15, 0), 3, 3, 300, 0, 12);
    torture(hmesh_test::affine_image<float, 2>(18, 15), 3, 3, 300, 1, 13);
    torture(hmesh_test::scaled(hmesh_test::scene<float, 3>(18, 15, 14), 1e6), 3, 3, 300, 1e6, 14);
    torture(hmesh_test::scaled(hmesh_test::scene<float, 1>(18, 15, 15), 1e-6), 3, 3, 300, 1e-6, 15);
}

TEST_CASE("a mesh stays true over images of one pixel, one row and one column") {
    torture(hmesh_test::noise<std::uint8_t, 1>(1, 1, 21), 1, 1, 200, 255, 21);
    torture(hmesh_test::noise<std::uint8_t, 3>(1, 13, 22), 1, 4, 300, 255, 22);
    torture(hmesh_test::noise<float, 2>(13, 1, 23), 4, 1, 300, 1, 23);
    torture(hmesh_test::noise<std::uint16_t, 1>(2, 2, 24), 1, 1, 300, 65535, 24);
}

TEST_CASE("a rollback restores every byte, also from inside other transactions, and a commit keeps every edit") {
    Subject<std::uint8_t, 3> subject(hmesh_test::scene<std::uint8_t, 3>(26, 22, 1), hmesh_test::jittered_grid(26, 22, 4, 4, 1));
    hmesh_test::wear(subject.mesh, 60, 255, 1);
    Random random(1);
    int rollbacks = 0;
    for (int k = 0; k < 250; ++k) {
        transact(subject.mesh, random, 1, rollbacks);
        hmesh_test::prove(subject);
    }
    CHECK(rollbacks > 200);

    const Snapshot before = hmesh_test::snapshot(subject.mesh);
    const auto mark = subject.mesh.begin();
    hmesh_test::wear(subject.mesh, 20, 255, 3);
    const Snapshot after = hmesh_test::snapshot(subject.mesh);
    subject.mesh.commit(mark);
    CHECK(hmesh_test::snapshot(subject.mesh) == after);
    CHECK_FALSE(after == before);
}

TEST_CASE("what follows a rollback is what would have followed without the transaction: free slots are restored too") {
    const auto image = hmesh_test::scene<std::uint8_t, 1>(26, 22, 5);
    const auto grid = hmesh_test::jittered_grid(26, 22, 4, 4, 5);
    Subject<std::uint8_t, 1> tried(image, grid), untried(image, grid);
    for (std::uint64_t k = 0; k < 20; ++k) {
        const auto mark = tried.mesh.begin();
        hmesh_test::wear(tried.mesh, 40, 255, 100 + k);
        tried.mesh.rollback(mark);
        hmesh_test::wear(tried.mesh, 15, 255, 200 + k);
        hmesh_test::wear(untried.mesh, 15, 255, 200 + k);
        REQUIRE(hmesh_test::snapshot(tried.mesh) == hmesh_test::snapshot(untried.mesh));
    }
}

TEST_CASE("a new mesh has the pixels' colours, knows its borders, and is the same whatever the executor's order") {
    const auto image = hmesh_test::scene<std::uint16_t, 4>(90, 80, 1);
    const auto grid = hmesh_test::jittered_grid(90, 80, 30, 30, 1);  // more than one piece of edges and of faces
    Subject<std::uint16_t, 4> serial(image, grid), reversed(image), shuffled(image);
    REQUIRE(reversed.mesh.assign(grid.positions, grid.triangles, hmesh_test::ReverseFor{}));
    REQUIRE(shuffled.mesh.assign(grid.positions, grid.triangles, hmesh_test::ShuffledFor{7}));
    hmesh_test::prove(serial);
    CHECK(hmesh_test::snapshot(serial.mesh) == hmesh_test::snapshot(reversed.mesh));
    CHECK(hmesh_test::snapshot(serial.mesh) == hmesh_test::snapshot(shuffled.mesh));

    for (const Vertex v : serial.mesh.topology().vertices()) {
        const Point p = serial.mesh.position(v);
        CHECK(p == grid.positions[v.index()]);
        const std::uint16_t* pixel = image.pixel(std::min(89, static_cast<int>(p.x)), std::min(79, static_cast<int>(p.y)));
        for (int k = 0; k < 4; ++k) CHECK(serial.mesh.color(v)[k] == pixel[k]);
        const bool on_x = p.x == 0 || p.x == 90, on_y = p.y == 0 || p.y == 80;
        CHECK(serial.mesh.vertex(v).mobility == (on_x && on_y ? Mobility::corner
                                                 : on_x       ? Mobility::along_y
                                                 : on_y       ? Mobility::along_x
                                                              : Mobility::free));
        CHECK(serial.mesh.is_dirty(v));
    }
}

TEST_CASE("new colours for all vertices give their energy, whatever the executor's order, and leave deleted slots alone") {
    const auto image = hmesh_test::scene<std::uint8_t, 3>(90, 80, 1);
    const auto grid = hmesh_test::jittered_grid(90, 80, 30, 30, 1);
    Subject<std::uint8_t, 3> serial(image, grid), reversed(image, grid);
    for (Subject<std::uint8_t, 3>* subject : {&serial, &reversed}) hmesh_test::wear(subject->mesh, 600, 255, 2);
    CHECK(serial.mesh.topology().vertex_count() < serial.mesh.topology().vertex_slots());
    Random random(3);
    std::vector<Color<3>> colors(serial.mesh.topology().vertex_slots(), Color<3>::zero());
    for (Color<3>& color : colors)
        for (int k = 0; k < 3; ++k) color.set(k, 255 * random.uniform());
    serial.mesh.set_colors(colors);
    reversed.mesh.set_colors(colors, hmesh_test::ReverseFor{});
    hmesh_test::prove(serial);
    for (const Vertex v : serial.mesh.topology().vertices())
        for (int k = 0; k < 3; ++k) REQUIRE(serial.mesh.color(v)[k] == colors[v.index()][k]);
    CHECK(hmesh_test::snapshot(serial.mesh) == hmesh_test::snapshot(reversed.mesh));
    hmesh_test::wear(serial.mesh, 200, 255, 4);
    hmesh_test::prove(serial);
}

TEST_CASE("triangulations that are none are refused") {
    Subject<std::uint8_t, 1> subject(hmesh_test::noise<std::uint8_t, 1>(8, 6, 1));
    ImageMesh<1>& mesh = subject.mesh;
    REQUIRE(mesh.assign(square, {{0, 1, 2}, {0, 2, 3}}));
    REQUIRE(mesh.check());
    CHECK(mesh.assign(square, {{0, 1, 2}, {0, 2, 4}}).code == Errc::invalid_argument);  // no vertex 4
    CHECK(mesh.assign(square, {{0, 1, 2}, {0, 1, 3}}).code == Errc::invalid_argument);  // 0 -> 1 twice
    CHECK(mesh.assign(square, {{0, 1, 2}, {0, 2, 2}}).code == Errc::invalid_argument);  // a corner twice
    CHECK(mesh.assign(square, {{0, 1, 2}}).code == hmesh::Errc::invalid_argument);      // vertex 3 alone
    CHECK(mesh.assign({{0, 0}, {4, 0}, {0, 3}, {8, 6}, {4, 6}, {8, 3}, {4, 3}}, {{0, 1, 6}, {0, 6, 2}, {3, 4, 6}, {3, 6, 5}})
              .code == Errc::invalid_argument);  // two fans in 6
    REQUIRE(mesh.assign(square, {{0, 1, 3}, {1, 2, 3}}));
    hmesh_test::prove(subject);
}

TEST_CASE("vertices outside the rectangle, off the grid or not finite are refused, and the mesh is then empty") {
    Subject<std::uint8_t, 2> subject(hmesh_test::noise<std::uint8_t, 2>(8, 6, 1));
    ImageMesh<2>& mesh = subject.mesh;
    const std::vector<Triangle> fan = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
    constexpr double infinity = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
    const auto refused = [&](std::size_t vertex, Point place, Errc code, const char* word) {
        std::vector<Point> positions = square;
        positions.push_back({4, 3});
        REQUIRE(mesh.assign(positions, fan));
        REQUIRE(mesh.vertex_count() == 5);
        positions[vertex] = place;
        const hmesh::Status status = mesh.assign(positions, fan);
        CHECK(status.code == code);
        CHECK_MESSAGE(std::string(status.what).find(word) != std::string::npos, status.what);
        CHECK(status.value == static_cast<double>(vertex));
        CHECK(mesh.vertex_count() == 0);
        CHECK(mesh.topology().face_count() == 0);
        CHECK(mesh.energy() == 0);
    };
    for (const double far : {-1.0 / 256, -1.0, -1e9, -1e300}) {
        refused(4, {far, 3}, Errc::invalid_argument, "outside");
        refused(0, {0, far}, Errc::invalid_argument, "outside");
    }
    for (const double far : {8 + 1.0 / 256, 9.0, 1e9, 1e300}) refused(2, {far, 6}, Errc::invalid_argument, "outside");
    for (const double far : {6 + 1.0 / 256, 1e9, 1e300}) refused(3, {0, far}, Errc::invalid_argument, "outside");
    for (const double step : {1.0 / 512, 1e-12, 1.0 / 3}) {
        refused(4, {4 + step, 3}, Errc::invalid_argument, "grid");
        refused(4, {4, 3 - step}, Errc::invalid_argument, "grid");
    }
    for (const double bad : {nan, infinity, -infinity}) {
        refused(4, {bad, 3}, Errc::not_finite, "position");
        refused(1, {8, bad}, Errc::not_finite, "position");
    }
    REQUIRE(mesh.assign(square, {{0, 1, 3}, {1, 2, 3}}));
    CHECK(mesh.assign(square, {{0, 1, 2}}).code == Errc::invalid_argument);
    CHECK(mesh.vertex_count() == 0);
    REQUIRE(mesh.assign(square, {{0, 1, 3}, {1, 2, 3}}));  // it is of use again
    hmesh_test::prove(subject);
}

TEST_CASE("colours that are not as many as the vertices, or not finite, are refused; what is in their padding does not count") {
    Subject<std::uint8_t, 2> subject(hmesh_test::noise<std::uint8_t, 2>(8, 6, 1));
    ImageMesh<2>& mesh = subject.mesh;
    const std::vector<Triangle> faces = {{0, 1, 2}, {0, 2, 3}};
    std::vector<Color<2>> colors(4, Color<2>::all(7));
    REQUIRE(mesh.assign(square, faces, colors, {}));
    hmesh_test::prove(subject);
    CHECK(mesh.color(Vertex(3))[1] == 7);
    for (const std::size_t number : {1U, 3U, 5U, 100U}) {
        const hmesh::Status status = mesh.assign(square, faces, std::vector<Color<2>>(number, Color<2>::zero()), {});
        CHECK(status.code == Errc::invalid_argument);
        CHECK(status.value == static_cast<double>(number));
        CHECK(status.limit == 4);
        CHECK(mesh.vertex_count() == 0);
    }
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity()})
        for (std::size_t v = 0; v < 4; ++v)
            for (int k = 0; k < 2; ++k) {
                std::vector<Color<2>> broken = colors;
                broken[v].set(k, bad);
                const hmesh::Status status = mesh.assign(square, faces, broken, {});
                CHECK(status.code == Errc::not_finite);
                CHECK(status.value == static_cast<double>(v));
            }
}

TEST_CASE("a mesh becomes plain arrays and comes back: places, colours as floats, faces and the energy") {
    Subject<std::uint16_t, 3> subject(hmesh_test::scene<std::uint16_t, 3>(26, 22, 1), hmesh_test::jittered_grid(26, 22, 5, 4, 1));
    ImageMesh<3>& mesh = subject.mesh;
    hmesh_test::wear(mesh, 300, 65535, 1);
    REQUIRE(hmesh::kit::remove_batch(mesh, 5, {}) > 0);
    REQUIRE(mesh.topology().vertex_slots() > mesh.vertex_count());
    const hmesh::Mesh plain = to_mesh(mesh, 65535);
    CHECK(plain.channels == 3);
    CHECK(plain.width == 26);
    CHECK(plain.height == 22);
    CHECK(plain.peak == 65535);
    CHECK_FALSE(plain.premultiplied);
    CHECK(hmesh_test::flaw_of(plain.view(), 26, 22) == "");
    REQUIRE(plain.vertex_count() == mesh.vertex_count());
    REQUIRE(plain.face_count() == mesh.topology().face_count());
    std::size_t row = 0;
    std::vector<std::uint32_t> number(mesh.topology().vertex_slots());
    for (const Vertex v : mesh.topology().vertices()) {
        CHECK(static_cast<double>(plain.positions[2 * row]) == mesh.position(v).x);
        CHECK(static_cast<double>(plain.positions[2 * row + 1]) == mesh.position(v).y);
        for (int k = 0; k < 3; ++k)
            CHECK(plain.colors[3 * row + static_cast<std::size_t>(k)] == static_cast<float>(mesh.color(v)[k]));
        number[v.index()] = static_cast<std::uint32_t>(row++);
    }
    row = 0;
    for (const Face f : mesh.topology().faces()) {
        const auto v = mesh.topology().vertices(f);
        CHECK(plain.faces[row++] == Triangle{number[v[0].index()], number[v[1].index()], number[v[2].index()]});
    }

    Subject<std::uint16_t, 3> again(subject.image);
    REQUIRE(again.mesh.assign(plain, hmesh_test::ReverseFor{}));
    hmesh_test::prove(again);
    CHECK(again.mesh.energy() == doctest::Approx(mesh.energy()).epsilon(1e-5));
    const hmesh::Mesh copy = to_mesh(again.mesh, 65535);
    CHECK(copy.positions == plain.positions);
    CHECK(copy.colors == plain.colors);
    CHECK(copy.faces.size() == plain.faces.size());
    hmesh_test::wear(again.mesh, 50, 65535, 2);  // and work goes on
    hmesh_test::prove(again);
}

TEST_CASE("plain arrays that are no mesh of the image are refused") {
    Subject<std::uint8_t, 3> subject(hmesh_test::noise<std::uint8_t, 3>(8, 6, 1));
    ImageMesh<3>& mesh = subject.mesh;
    REQUIRE(mesh.assign(square, {{0, 1, 2}, {0, 2, 3}}));
    const hmesh::Mesh good = to_mesh(mesh, 255);
    const auto refused = [&](const hmesh::Mesh& bad) {
        REQUIRE(mesh.assign(good));
        REQUIRE(mesh.check());
        const hmesh::Status status = mesh.assign(bad);
        CHECK(mesh.vertex_count() == (status ? 4 : 0));
        return status;
    };
    CHECK(refused(good));
    CHECK(refused(hmesh::Mesh()).code == Errc::invalid_argument);
    hmesh::Mesh bad = good;
    bad.channels = 4;
    CHECK(refused(bad).value == 4);
    CHECK(refused(bad).limit == 3);
    bad = good, bad.width = 9;
    CHECK(refused(bad).value == 9);
    CHECK(refused(bad).limit == 8);
    bad = good, bad.height = 5;
    CHECK(refused(bad).value == 5);
    CHECK(refused(bad).limit == 6);
    bad = good, bad.positions.pop_back();
    CHECK(refused(bad).code == Errc::invalid_argument);
    bad = good, bad.colors.push_back(0);
    CHECK(refused(bad).code == Errc::invalid_argument);
    bad = good, bad.positions[2] = 8.25F;
    CHECK(refused(bad).value == 1);
    bad = good, bad.colors[7] = std::numeric_limits<float>::quiet_NaN();
    CHECK(refused(bad).code == Errc::not_finite);
    CHECK(refused(bad).value == 2);
    bad = good, bad.faces[1][2] = 4;
    CHECK(refused(bad).code == Errc::invalid_argument);
    bad = good, bad.positions.clear(), bad.colors.clear(), bad.faces.clear();
    CHECK(mesh.assign(bad));  // as HalfedgeMesh has it: a mesh of nothing
    CHECK(mesh.vertex_count() == 0);
}

TEST_CASE("check() notices a mesh that does not tile the rectangle, turns a face over, or leaves the grid or its padding") {
    Subject<std::uint8_t, 1> subject(hmesh_test::noise<std::uint8_t, 1>(8, 6, 1));
    ImageMesh<1>& mesh = subject.mesh;
    REQUIRE(mesh.assign(square, {{0, 2, 1}, {0, 3, 2}}));
    CHECK_FALSE(mesh.check());  // all faces turned over
    REQUIRE(mesh.assign({{0, 0}, {8, 0}, {8, 6}}, {{0, 1, 2}}));
    CHECK_FALSE(mesh.check());  // half the rectangle
    REQUIRE(mesh.assign({{0, 0}, {8, 0}, {8, 6}, {0, 6}, {4, 3}}, {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}}));
    CHECK_FALSE(mesh.check());  // a notch, so that vertex 4 is on the mesh's border but inside the image
    const std::vector<Triangle> fan = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
    REQUIRE(mesh.assign({{0, 0}, {8, 0}, {8, 6}, {0, 6}, {4, 3}}, fan));
    REQUIRE(mesh.check());
    mesh.place(Vertex(4), {4 + 1.0 / 512, 3}, mesh.color(Vertex(4)));
    CHECK_FALSE(mesh.check());
    mesh.place(Vertex(4), {4, 3}, mesh.color(Vertex(4)));
    REQUIRE(mesh.check());
    Color<1> padded = Color<1>::zero();
    padded.set(1, 1);
    mesh.place(Vertex(4), {4, 3}, padded);
    CHECK_FALSE(mesh.check());
}

TEST_CASE("check() notices vertices that were changed behind the mesh's back") {
    const std::vector<Triangle> fan = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
    const auto sentence = [&](hmesh::Image<std::uint8_t, 1> image, const auto& tamper) {
        Subject<std::uint8_t, 1> subject(std::move(image));
        REQUIRE(subject.mesh.assign({{0, 0}, {8, 0}, {8, 6}, {0, 6}, {4, 3}}, fan));
        tamper(const_cast<hmesh::kit::VertexState<1>&>(subject.mesh.vertex(Vertex(4))));
        return std::string(subject.mesh.check().what);
    };
    const auto noise = hmesh_test::noise<std::uint8_t, 1>(8, 6, 1), black = hmesh_test::constant_image<std::uint8_t, 1>(8, 6, 0);
    CHECK(sentence(noise, [](hmesh::kit::VertexState<1>&) {}).empty());
    CHECK(sentence(noise, [](hmesh::kit::VertexState<1>& v) { v.mobility = Mobility::along_x; }) ==
          "a vertex's mobility is wrong");
    CHECK(sentence(noise, [](hmesh::kit::VertexState<1>& v) { v.color.set(0, v.color[0] + 1); }) == "a face's energy is stale");
    // In black all energies are 0, whatever the moments.
    CHECK(sentence(black, [](hmesh::kit::VertexState<1>& v) { v.position = {5, 3}; }) == "an edge's moments are stale");
}

TEST_CASE("a vertex's place is clamped to the grid, and off the border unless it lives there") {
    Subject<std::uint8_t, 1> subject(hmesh_test::noise<std::uint8_t, 1>(8, 6, 1));
    const ImageMesh<1>& mesh = subject.mesh;
    const double gap = mesh.limits().border_gap;
    CHECK(mesh.clamp({3.1, 2.9}, Mobility::free) == Point{794.0 / 256, 742.0 / 256});
    CHECK(mesh.clamp({-3, 99}, Mobility::free) == Point{gap, 6 - gap});
    CHECK(mesh.clamp({99, -3}, Mobility::free) == Point{8 - gap, gap});
    CHECK(mesh.clamp({-1, 6}, Mobility::along_x) == Point{gap, 6});
    CHECK(mesh.clamp({8, 7}, Mobility::along_y) == Point{8, 6 - gap});
    CHECK(mesh.clamp({8, 0}, Mobility::corner) == Point{8, 0});
}

TEST_CASE("colours keep within their range and its overshoot, also when that overflows") {
    Subject<std::uint8_t, 1> bytes(hmesh_test::noise<std::uint8_t, 1>(8, 6, 1));
    const double slack = 255 * bytes.mesh.limits().color_overshoot;
    CHECK(bytes.mesh.color_low() == doctest::Approx(-slack));
    CHECK(bytes.mesh.color_high() == doctest::Approx(255 + slack));
    Subject<float, 1> floats(hmesh_test::noise<float, 1>(8, 6, 1));
    CHECK(std::isfinite(floats.mesh.color_low()));
    CHECK(std::isfinite(floats.mesh.color_high()));
    CHECK(floats.mesh.color_high() >= hmesh::PixelTraits<float>::highest);
}

TEST_CASE("room reserved changes nothing") {
    const auto image = hmesh_test::scene<std::uint8_t, 1>(26, 22, 5);
    const auto grid = hmesh_test::jittered_grid(26, 22, 4, 4, 5);
    Subject<std::uint8_t, 1> plain(image, grid), roomy(image, grid);
    roomy.mesh.reserve(1000);
    for (Subject<std::uint8_t, 1>* subject : {&plain, &roomy}) hmesh_test::wear(subject->mesh, 100, 255, 2);
    CHECK(hmesh_test::snapshot(plain.mesh) == hmesh_test::snapshot(roomy.mesh));
}
