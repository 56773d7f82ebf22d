#include "hmesh/mesh/mesh.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>

using hmesh::Errc;
using hmesh::Mesh;
using hmesh::MeshView;
using hmesh::Status;

namespace {

Mesh square() {
    Mesh mesh;
    mesh.positions = {0, 0, 8, 0, 8, 6, 0, 6};
    mesh.colors = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
    mesh.faces = {{0, 1, 2}, {0, 2, 3}};
    mesh.channels = 3;
    mesh.width = 8;
    mesh.height = 6;
    mesh.peak = 255;
    return mesh;
}

}  // namespace

TEST_CASE("a MeshView points into its Mesh and counts what is there") {
    const Mesh mesh = square();
    const MeshView view = mesh.view();
    CHECK(view.positions == mesh.positions.data());
    CHECK(view.colors == mesh.colors.data());
    CHECK(view.faces == mesh.faces.data());
    CHECK(mesh.vertex_count() == 4);
    CHECK(mesh.face_count() == 2);
    CHECK(view.vertex_count == 4);
    CHECK(view.face_count == 2);
    CHECK(view.channels == 3);
    CHECK(view.width == 8);
    CHECK(view.height == 6);
    CHECK(view.peak == 255);
    CHECK(check(view, 3));
    CHECK(check(view, 4));
}

TEST_CASE("check refuses a mesh without vertices, faces or data") {
    CHECK(check(MeshView(), 4).code == Errc::invalid_argument);
    CHECK(check(Mesh().view(), 4).code == Errc::invalid_argument);
    const Mesh mesh = square();
    MeshView views[5];
    for (MeshView& view : views) view = mesh.view();
    views[0].vertex_count = 0;
    views[1].face_count = 0;
    views[2].positions = nullptr;
    views[3].colors = nullptr;
    views[4].faces = nullptr;
    const char* words[] = {"no vertices", "no faces", "null pointer", "null pointer", "null pointer"};
    for (std::size_t i = 0; i < 5; ++i) {
        const Status status = check(views[i], 4);
        CHECK(status.code == Errc::invalid_argument);
        CHECK(std::string(status.what).find(words[i]) != std::string::npos);
        CHECK(status.value == 0);
        CHECK(status.limit == (i < 2 ? 1 : 0));
    }
}

TEST_CASE("check takes a mesh of nothing, if it says of how many channels it has none") {
    Mesh mesh = square();
    mesh.positions.clear(), mesh.colors.clear(), mesh.faces.clear();
    CHECK(check(mesh.view(), 3));
    CHECK(check(mesh.view(), 2).code == Errc::invalid_argument);
    mesh.peak = 0;
    CHECK(check(mesh.view(), 3).code == Errc::invalid_argument);
}

TEST_CASE("check refuses a number of channels that the use cannot hold") {
    const Mesh mesh = square();
    CHECK(check(mesh.view(), 2).code == Errc::invalid_argument);
    CHECK(check(mesh.view(), 2).value == 3);
    CHECK(check(mesh.view(), 2).limit == 2);
    for (const int channels : {0, -1}) {
        MeshView view = mesh.view();
        view.channels = channels;
        CHECK(check(view, 4).code == Errc::invalid_argument);
    }
}

TEST_CASE("check refuses a peak that is not positive and finite") {
    for (const double peak : {0.0, -1.0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
        Mesh mesh = square();
        mesh.peak = peak;
        CHECK(check(mesh.view(), 3).code == Errc::invalid_argument);
    }
}

TEST_CASE("check names the vertex with a position or colour that is not finite") {
    constexpr float infinity = std::numeric_limits<float>::infinity();
    for (const float bad : {infinity, -infinity, std::numeric_limits<float>::quiet_NaN()}) {
        for (std::size_t i = 0; i < 8; ++i) {
            Mesh mesh = square();
            mesh.positions[i] = bad;
            CHECK(check(mesh.view(), 3).code == Errc::not_finite);
            CHECK(check(mesh.view(), 3).value == static_cast<std::int64_t>(i / 2));
        }
        for (std::size_t i = 0; i < 12; ++i) {
            Mesh mesh = square();
            mesh.colors[i] = bad;
            CHECK(check(mesh.view(), 3).code == Errc::not_finite);
            CHECK(check(mesh.view(), 3).value == static_cast<std::int64_t>(i / 3));
        }
    }
}

TEST_CASE("check names the face with an index out of range") {
    for (const std::uint32_t bad : {4U, 5U, 0xffffffffU})
        for (std::size_t i = 0; i < 6; ++i) {
            Mesh mesh = square();
            mesh.faces[i / 3][i % 3] = bad;
            CHECK(check(mesh.view(), 3).code == Errc::invalid_argument);
            CHECK(check(mesh.view(), 3).value == static_cast<std::int64_t>(i / 3));
            CHECK(check(mesh.view(), 3).limit == 3);
        }
}

TEST_CASE("check reads no array of a mesh that is shorter than the others say") {
    CHECK(check(square(), 3));
    for (const bool of_colors : {true, false}) {
        Mesh mesh = square();
        (of_colors ? mesh.colors : mesh.positions).pop_back();
        CHECK(check(mesh, 3).code == Errc::invalid_argument);
    }
    Mesh mesh = square();
    mesh.channels = -1;
    CHECK(check(mesh, 3).code == Errc::invalid_argument);
}
