#include "hmesh/io/straight_colors.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <string>
#include <vector>

#include "hmesh/io/eps.hpp"
#include "hmesh/io/gltf.hpp"
#include "hmesh/io/html.hpp"
#include "hmesh/io/obj.hpp"
#include "hmesh/io/pdf.hpp"
#include "hmesh/io/ply.hpp"
#include "test_exports.hpp"

using hmesh::Mesh;
using hmesh::detail::StraightMesh;
using hmesh_test::exported;

namespace {

// Opaque, half and fully transparent corners, one of them with colour above alpha.
Mesh<4> premultiplied_mesh() {
    Mesh<4> mesh = hmesh_test::two_faces<4>();
    mesh.colors = {10, 20, 30, 255, 0, 0, 0, 0, 50, 30, 0, 51, 40, 250, 0, 102};
    mesh.premultiplied = true;
    return mesh;
}
// The same, divided by hand. Vertex 1 shares a face with 0 and 2 only: (10 + 50, 20 + 30, 30) / (306 / 255).
Mesh<4> straight_mesh() {
    Mesh<4> mesh = premultiplied_mesh();
    mesh.colors = {10, 20, 30, 255, 50, 50 / 1.2F, 25, 0, 250, 150, 0, 51, 100, 255, 0, 102};
    mesh.premultiplied = false;
    return mesh;
}

void check_same(hmesh_test::Write write) {
    const Mesh<4> straight = straight_mesh(), premultiplied = premultiplied_mesh();
    CHECK(exported(premultiplied.view(), write) == exported(straight.view(), write));
    Mesh<4> bare = premultiplied;
    bare.premultiplied = false;
    CHECK(exported(premultiplied.view(), write) != exported(bare.view(), write));
}

}  // namespace

TEST_CASE("straight colours are divided by alpha, and transparent corners take the mean of their neighbours") {
    const Mesh<4> mesh = premultiplied_mesh(), expected = straight_mesh();
    const StraightMesh straight(mesh.view());
    CHECK(!straight.view().premultiplied);
    for (std::size_t i = 0; i < expected.colors.size(); ++i)
        CHECK(straight.view().colors[i] == doctest::Approx(expected.colors[i]));
}

TEST_CASE("where all is transparent colours are 0, and grey with alpha is divided too") {
    Mesh<4> clear = premultiplied_mesh();
    for (std::size_t v = 0; v < 4; ++v) clear.colors[4 * v + 3] = v == 0 ? -1.0F : 0.0F;
    const StraightMesh none(clear.view());
    for (std::size_t v = 0; v < 4; ++v)
        for (std::size_t k = 0; k < 3; ++k) CHECK(none.view().colors[4 * v + k] == 0);
    Mesh<2> grey = hmesh_test::two_faces<2>();
    grey.colors = {10, 51, 0, 0, 20, 51, 0, 0};
    grey.premultiplied = true;
    const StraightMesh straight(grey.view());
    CHECK(straight.view().colors[0] == 50);
    CHECK(straight.view().colors[2] == 75);
    CHECK(straight.view().colors[4] == 100);
}

TEST_CASE("meshes with straight colours or without alpha are left as they are") {
    const Mesh<4> mesh = straight_mesh();
    CHECK(StraightMesh(mesh.view()).view().colors == mesh.colors.data());
    Mesh<3> colour = hmesh_test::two_faces<3>();
    colour.premultiplied = true;
    CHECK(StraightMesh(colour.view()).view().colors == colour.colors.data());
}

TEST_CASE("formats that know straight colours only are given these") {
    check_same([](const hmesh::MeshView& mesh, hmesh::Sink sink) { return hmesh::write_ply(mesh, sink); });
    check_same([](const hmesh::MeshView& mesh, hmesh::Sink sink) { return hmesh::write_obj(mesh, sink); });
    check_same([](const hmesh::MeshView& mesh, hmesh::Sink sink) { return hmesh::write_glb(mesh, sink); });
    check_same([](const hmesh::MeshView& mesh, hmesh::Sink sink) { return hmesh::write_pdf(mesh, sink); });
}

TEST_CASE("EPS lays premultiplied colours over white, HTML is told of them") {
    Mesh<4> premultiplied = premultiplied_mesh();
    premultiplied.colors[13] = 102;  // no colour above alpha: that one would be cut off on its way over straight colours
    Mesh<4> straight = straight_mesh();
    const auto eps = [](const hmesh::MeshView& mesh, hmesh::Sink sink) { return hmesh::write_eps(mesh, sink); };
    CHECK(exported(premultiplied.view(), eps) == exported(straight.view(), eps));
    const auto html = [](const hmesh::MeshView& mesh, hmesh::Sink sink) { return hmesh::write_html(mesh, sink); };
    const auto says = [&](const hmesh::MeshView& mesh, const char* text) {
        return hmesh_test::as_text(exported(mesh, html)).find(text) != std::string::npos;
    };
    CHECK(says(premultiplied.view(), "premultiplied: true"));
    CHECK(says(straight.view(), "premultiplied: false"));
    Mesh<3> colour = hmesh_test::two_faces<3>();
    colour.premultiplied = true;
    CHECK(says(colour.view(), "premultiplied: false"));
}
