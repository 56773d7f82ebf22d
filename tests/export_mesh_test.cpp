#include "hmesh/io/detail/export_mesh.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "hmesh/io/eps.hpp"
#include "hmesh/io/gltf.hpp"
#include "hmesh/io/html.hpp"
#include "hmesh/io/obj.hpp"
#include "hmesh/io/pdf.hpp"
#include "hmesh/io/ply.hpp"
#include "hmesh/io/svg.hpp"
#include "test_exports.hpp"

using hmesh::Mesh;
using hmesh::detail::ExportMesh;
using hmesh::detail::Premultiplied;
using hmesh_test::exported;

namespace {

// Opaque, half and fully transparent corners, one of them with colour above alpha.
Mesh premultiplied_mesh() {
    Mesh mesh = hmesh_test::two_faces(4);
    mesh.colors = {10, 20, 30, 255, 0, 0, 0, 0, 50, 30, 0, 51, 40, 250, 0, 102};
    mesh.premultiplied = true;
    return mesh;
}
// The same, divided by hand. Vertex 1 shares a face with 0 and 2 only: (10 + 50, 20 + 30, 30) / (306 / 255).
Mesh straight_mesh() {
    Mesh mesh = premultiplied_mesh();
    mesh.colors = {10, 20, 30, 255, 50, 50 / 1.2F, 25, 0, 250, 150, 0, 51, 100, 255, 0, 102};
    mesh.premultiplied = false;
    return mesh;
}

std::vector<float> colors_of(const ExportMesh& mesh) {
    const hmesh::MeshView& view = mesh.view();
    return {view.colors, view.colors + static_cast<std::size_t>(view.channels) * view.vertex_count};
}

void check_same(hmesh_test::Write write) {
    const Mesh straight = straight_mesh(), premultiplied = premultiplied_mesh();
    CHECK(exported(premultiplied.view(), write) == exported(straight.view(), write));
    Mesh bare = premultiplied;
    bare.premultiplied = false;
    CHECK(exported(premultiplied.view(), write) != exported(bare.view(), write));
}

}  // namespace

TEST_CASE("a mesh without a width or a height or with more than 4 channels is not exported") {
    using hmesh::detail::check_for_export;
    const Mesh mesh = hmesh_test::two_faces(3);
    CHECK(check_for_export(mesh.view()));
    for (const int size : {0, -7}) {
        Mesh bad = mesh;
        bad.width = size;
        CHECK(check_for_export(bad.view()).value == size);
        bad = mesh;
        bad.height = size;
        CHECK(check_for_export(bad.view()).value == size);
    }
    CHECK(check_for_export(hmesh_test::two_faces(2).view()));
    CHECK(check_for_export(hmesh_test::two_faces(5).view()).value == 5);
}

TEST_CASE("more vertices or faces than a format numbers are refused, and nothing is read of them") {
    using hmesh::detail::check_counts;
    hmesh::MeshView mesh;  // of no arrays
    mesh.vertex_count = 7;
    mesh.face_count = 9;
    CHECK(check_counts(mesh, 7, 9, "too many"));
    for (const auto& [most_vertices, most_faces] : {std::array<std::uint64_t, 2>{6, 9}, {7, 8}}) {
        const hmesh::Status status = check_counts(mesh, most_vertices, most_faces, "too many");
        CHECK(status.code == hmesh::Errc::invalid_argument);
        CHECK(status.what == std::string("too many"));
        CHECK(status.value == status.limit + 1);
    }
    mesh.vertex_count = std::numeric_limits<std::size_t>::max();
    CHECK(check_counts(mesh, 7, 9, "too many").value > 7);
    CHECK(check_counts(mesh, std::numeric_limits<std::uint64_t>::max(), 9, "too many"));
}

TEST_CASE("y is up, and faces are turned so that they stay seen from the front") {
    const Mesh mesh = hmesh_test::two_faces(3);
    CHECK(hmesh::detail::y_up(mesh.view(), 0) == 2);
    CHECK(hmesh::detail::y_up(mesh.view(), 2) == 0);
    CHECK(hmesh::detail::turned({4, 5, 6}) == hmesh::Triangle{4, 6, 5});
}

TEST_CASE("shares of the peak are held to [0, 1]") {
    CHECK(hmesh::detail::share_of_peak(51, 255) == 0.2);
    CHECK(hmesh::detail::share_of_peak(-1, 255) == 0);
    CHECK(hmesh::detail::share_of_peak(256, 255) == 1);
    CHECK(hmesh::detail::share_of_peak(std::numeric_limits<float>::max(), 1e-300) == 1);
}

TEST_CASE("every integer of 8 and 16 bits comes back from its share") {
    for (int i = 0; i <= 255; ++i) CHECK(hmesh::detail::to_u8(hmesh::detail::share_of_peak(static_cast<float>(i), 255)) == i);
    int wrong = 0;
    for (int i = 0; i <= 65535; ++i)
        wrong += hmesh::detail::to_u16(hmesh::detail::share_of_peak(static_cast<float>(i), 65535)) != i;
    CHECK(wrong == 0);
}

TEST_CASE("grey is red, green and blue; without alpha a vertex is opaque") {
    using Shares = std::array<double, 4>;
    Mesh gray = hmesh_test::two_faces(1);
    Mesh color = hmesh_test::two_faces(3);
    Mesh alpha = hmesh_test::two_faces(4);
    gray.peak = color.peak = alpha.peak = 40;
    CHECK(hmesh::detail::rgba_shares(gray.view(), 1) == Shares{0.25, 0.25, 0.25, 1});
    CHECK(hmesh::detail::rgba_shares(color.view(), 2) == Shares{0.5, 21.0 / 40, 22.0 / 40, 1});
    CHECK(hmesh::detail::rgba_shares(alpha.view(), 2) == Shares{0.5, 21.0 / 40, 22.0 / 40, 23.0 / 40});
}

TEST_CASE("straight colours are divided by alpha, and transparent corners take the mean of their neighbours") {
    const Mesh mesh = premultiplied_mesh(), expected = straight_mesh();
    const ExportMesh straight(mesh.view(), Premultiplied::divided);
    CHECK(!straight.view().premultiplied);
    for (std::size_t i = 0; i < expected.colors.size(); ++i)
        CHECK(straight.view().colors[i] == doctest::Approx(expected.colors[i]));
}

TEST_CASE("a transparent corner and its copy on the other border take one colour, the mean of the neighbours of both") {
    Mesh mesh = hmesh_test::two_faces(4);  // 0 and 1, and 3 and 2, are one vertex each
    mesh.positions.insert(mesh.positions.end(), {1.5F, 1});
    mesh.faces = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
    mesh.colors = {0, 0, 0, 0, 0, 0, 0, 0, 40, 80, 0, 255, 40, 80, 0, 255, 0, 0, 10, 51};
    mesh.premultiplied = true;
    mesh.periodic = hmesh::Periodic::x;
    std::vector<float> expected = {0, 0, 0, 0, 0, 0, 0, 0, 40, 80, 0, 255, 40, 80, 0, 255, 0, 0, 50, 51};
    // 0 shares faces with 3 and twice with 4, 1 with 2 and twice with 4.
    const ExportMesh tied(mesh.view(), Premultiplied::divided);
    for (std::size_t k = 0; k < 3; ++k)
        expected[k] = expected[4 + k] = (2 * mesh.colors[12 + k] + 4 * mesh.colors[16 + k]) / (2 * 255 + 4 * 51) * 255;
    const std::vector<float> colors = colors_of(tied);
    REQUIRE(colors.size() == expected.size());
    for (std::size_t i = 0; i < colors.size(); ++i) CHECK(colors[i] == doctest::Approx(expected[i]));

    mesh.colors[8] = mesh.colors[9] = mesh.colors[11] = 0;  // what one copy sees alone the other has too
    const ExportMesh one(mesh.view(), Premultiplied::divided);
    for (std::size_t k = 0; k < 4; ++k) CHECK(one.view().colors[k] == one.view().colors[4 + k]);
}

TEST_CASE("where all is transparent colours are 0") {
    Mesh clear = premultiplied_mesh();
    for (std::size_t v = 0; v < 4; ++v) clear.colors[4 * v + 3] = v == 0 ? -1.0F : 0.0F;
    const ExportMesh none(clear.view(), Premultiplied::divided);
    for (std::size_t v = 0; v < 4; ++v)
        for (std::size_t k = 0; k < 3; ++k) CHECK(none.view().colors[4 * v + k] == 0);
}

TEST_CASE("grey with alpha becomes red, green, blue and alpha, premultiplied or divided") {
    Mesh gray = hmesh_test::two_faces(2);
    gray.colors = {10, 51, 0, 0, 20, 51, 0, 0};
    gray.premultiplied = true;
    const ExportMesh kept(gray.view(), Premultiplied::kept);
    CHECK(kept.view().channels == 4);
    CHECK(kept.view().premultiplied);
    CHECK(colors_of(kept) == std::vector<float>{10, 10, 10, 51, 0, 0, 0, 0, 20, 20, 20, 51, 0, 0, 0, 0});
    const ExportMesh divided(gray.view(), Premultiplied::divided);
    CHECK(divided.view().channels == 4);
    CHECK(!divided.view().premultiplied);
    CHECK(colors_of(divided) == std::vector<float>{50, 50, 50, 51, 75, 75, 75, 0, 100, 100, 100, 51, 75, 75, 75, 0});
    gray.premultiplied = false;
    const ExportMesh straight(gray.view(), Premultiplied::divided);
    CHECK(colors_of(straight) == colors_of(kept));
}

TEST_CASE("every format writes grey with alpha as the red, green, blue and alpha that it is") {
    Mesh gray = hmesh_test::two_faces(2);
    gray.colors = {10, 255, 70, 0, 60, 128, 200, 201};
    Mesh rgba = hmesh_test::two_faces(4);
    rgba.colors = {10, 10, 10, 255, 70, 70, 70, 0, 60, 60, 60, 128, 200, 200, 200, 201};
    for (const bool premultiplied : {false, true}) {
        gray.premultiplied = rgba.premultiplied = premultiplied;
        const auto check_same = [&](hmesh_test::Write write) {
            CHECK(exported(gray.view(), write) == exported(rgba.view(), write));
        };
        check_same([](const hmesh::MeshView& mesh, hmesh::Sink sink) { return hmesh::write_ply(mesh, sink); });
        check_same([](const hmesh::MeshView& mesh, hmesh::Sink sink) { return hmesh::write_ply(mesh, sink, {true, true}); });
        check_same([](const hmesh::MeshView& mesh, hmesh::Sink sink) { return hmesh::write_obj(mesh, sink); });
        check_same([](const hmesh::MeshView& mesh, hmesh::Sink sink) { return hmesh::write_glb(mesh, sink); });
        check_same([](const hmesh::MeshView& mesh, hmesh::Sink sink) { return hmesh::write_pdf(mesh, sink); });
        check_same([](const hmesh::MeshView& mesh, hmesh::Sink sink) { return hmesh::write_eps(mesh, sink); });
        check_same([](const hmesh::MeshView& mesh, hmesh::Sink sink) { return hmesh::write_html(mesh, sink); });
        for (const hmesh::SvgOptions::Kind kind :
             {hmesh::SvgOptions::Kind::gradient, hmesh::SvgOptions::Kind::exact, hmesh::SvgOptions::Kind::flat})
            check_same([=](const hmesh::MeshView& mesh, hmesh::Sink sink) { return hmesh::write_svg(mesh, sink, {kind, true}); });
    }
}

TEST_CASE("meshes with straight colours or without alpha are left as they are") {
    const Mesh mesh = straight_mesh();
    CHECK(ExportMesh(mesh.view(), Premultiplied::divided).view().colors == mesh.colors.data());
    Mesh color = hmesh_test::two_faces(3);
    color.premultiplied = true;
    CHECK(ExportMesh(color.view(), Premultiplied::divided).view().colors == color.colors.data());
    const Mesh premultiplied = premultiplied_mesh();
    CHECK(ExportMesh(premultiplied.view(), Premultiplied::kept).view().colors == premultiplied.colors.data());
}

TEST_CASE("formats that know straight colours only are given these") {
    check_same([](const hmesh::MeshView& mesh, hmesh::Sink sink) { return hmesh::write_ply(mesh, sink); });
    check_same([](const hmesh::MeshView& mesh, hmesh::Sink sink) { return hmesh::write_obj(mesh, sink); });
    check_same([](const hmesh::MeshView& mesh, hmesh::Sink sink) { return hmesh::write_glb(mesh, sink); });
    check_same([](const hmesh::MeshView& mesh, hmesh::Sink sink) { return hmesh::write_pdf(mesh, sink); });
}

TEST_CASE("EPS lays premultiplied colours over white, HTML is told of them") {
    Mesh premultiplied = premultiplied_mesh();
    premultiplied.colors[13] = 102;  // no colour above alpha: that one would be cut off on its way over straight colours
    Mesh straight = straight_mesh();
    const auto eps = [](const hmesh::MeshView& mesh, hmesh::Sink sink) { return hmesh::write_eps(mesh, sink); };
    CHECK(exported(premultiplied.view(), eps) == exported(straight.view(), eps));
    const auto html = [](const hmesh::MeshView& mesh, hmesh::Sink sink) { return hmesh::write_html(mesh, sink); };
    const auto says = [&](const hmesh::MeshView& mesh, const char* text) {
        return hmesh_test::as_text(exported(mesh, html)).find(text) != std::string::npos;
    };
    CHECK(says(premultiplied.view(), "\"premultiplied\":true"));
    CHECK(says(straight.view(), "\"premultiplied\":false"));
    Mesh color = hmesh_test::two_faces(3);
    color.premultiplied = true;
    CHECK(says(color.view(), "\"premultiplied\":false"));
}
