#include "hmesh/io/obj.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <sstream>
#include <string>
#include <vector>

#include "test_exports.hpp"

namespace {

using hmesh_test::two_faces;

const auto to_sink = [](const hmesh::MeshView& mesh, hmesh::Sink sink) { return hmesh::write_obj(mesh, sink); };

std::string written(const hmesh::Mesh& mesh) { return hmesh_test::as_text(hmesh_test::exported(mesh.view(), to_sink)); }

const std::string header = "# made by hmesh " HMESH_VERSION_STRING "\n";

}  // namespace

TEST_CASE("a mesh of two faces is written as these lines") {
    hmesh::Mesh mesh = two_faces(3);
    mesh.positions = {0, 0, 3, 0, 2.99609375F, 2, 0, 1.5F};
    mesh.colors = {0, 128, 255, 1, 2, 3, -5, 300, 99.5F, 51, 0.4F, 254.6F};
    CHECK(written(mesh) == header +
                               "v 0 2 0 0 0.501961 1\n"
                               "v 3 2 0 0.003922 0.007843 0.011765\n"
                               "v 2.99609375 0 0 0 1 0.390196\n"
                               "v 0 0.5 0 0.2 0.001569 0.998431\n"
                               "f 1 3 2\n"
                               "f 1 4 3\n");
}

TEST_CASE("grey is written as three equal colours") {
    CHECK(written(two_faces(1)).substr(header.size(), 53) ==
          "v 0 2 0 0 0 0\n"
          "v 3 2 0 0.039216 0.039216 0.039216\nv 3 ");
}

TEST_CASE("alpha is left out") {
    hmesh::Mesh mesh = two_faces(4);
    hmesh::Mesh opaque = two_faces(3);
    CHECK(written(mesh) == written(opaque));
}

TEST_CASE("what is read back is the mesh with y up and faces counter-clockwise") {
    hmesh::Mesh mesh = hmesh_test::square_grid(20, 12);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)  // any numbers on the 1/256 px grid, and a few off it
        mesh.positions[i] += static_cast<float>(i * 37 % 64) / 256 + (i % 7 == 0 ? 0.01F : 0.0F);
    std::istringstream in(written(mesh));
    std::string line, word;
    std::vector<std::array<float, 2>> positions;
    std::size_t faces = 0;
    while (std::getline(in, line)) {
        std::istringstream words(line);
        words >> word;
        if (word == "v") {
            std::array<float, 6> read{};
            for (float& x : read) words >> x;
            REQUIRE(words);
            const std::size_t v = positions.size();
            const double y = 12 - static_cast<double>(mesh.positions[2 * v + 1]);
            CHECK(read[0] == mesh.positions[2 * v]);
            CHECK(read[1] == static_cast<float>(y));
            CHECK(read[2] == 0);
            for (std::size_t k = 0; k < 3; ++k) CHECK(std::abs(read[3 + k] - mesh.colors[3 * v + k]) <= 0.6e-6F);
            positions.push_back({read[0], read[1]});
        } else if (word == "f") {
            std::array<std::size_t, 3> corners{};
            for (std::size_t& corner : corners) words >> corner;
            REQUIRE(words);
            const std::array<float, 2>& a = positions[corners[0] - 1];
            const std::array<float, 2>& b = positions[corners[1] - 1];
            const std::array<float, 2>& c = positions[corners[2] - 1];
            CHECK((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]) > 0);
            CHECK(corners[0] == mesh.faces[faces][0] + 1);
            ++faces;
        }
    }
    CHECK(positions.size() == mesh.vertex_count());
    CHECK(faces == mesh.face_count());
}

TEST_CASE("the locale makes no difference") {
    hmesh::Mesh mesh = two_faces(3);
    mesh.positions[4] = 2.5F;
    hmesh_test::check_locale_makes_no_difference(mesh.view(), to_sink);
}

TEST_CASE("a sink that refuses anywhere gets no more and is reported") {
    hmesh_test::check_refusing_sinks(hmesh_test::square_grid(16, 16).view(), to_sink);
}

TEST_CASE("a mesh that cannot be written gives a Status and no byte") { hmesh_test::check_bad_meshes_are_refused(to_sink); }

TEST_CASE("a mesh of nothing is the line that says who made it") {
    hmesh_test::check_empty_meshes(to_sink, [](const hmesh_test::Bytes& bytes) {
        CHECK(hmesh_test::as_text(bytes) == "# made by hmesh " HMESH_VERSION_STRING "\n");
    });
}
