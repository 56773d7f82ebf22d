#include "hmesh/io/ply.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "test_exports.hpp"

namespace {

using hmesh_test::Bytes;
using hmesh_test::number_at;
using hmesh_test::two_faces;

const auto to_sink = [](const hmesh::MeshView& mesh, hmesh::Sink sink) { return hmesh::write_ply(mesh, sink); };

Bytes written(const hmesh::Mesh& mesh, const hmesh::PlyOptions& options = {}) {
    return hmesh_test::exported(
        mesh.view(), [&](const hmesh::MeshView& view, hmesh::Sink sink) { return hmesh::write_ply(view, sink, options); });
}

struct PlyFile {
    std::vector<std::string> color_names;
    std::vector<std::array<float, 3>> positions;
    std::vector<std::vector<int>> colors;
    std::vector<std::array<std::int32_t, 3>> faces;
};

// Reads what this library writes, by the PLY format alone.
PlyFile read_ply(const Bytes& bytes) {
    PlyFile file;
    std::istringstream in(std::string(bytes.begin(), bytes.end()));
    std::string line, word, type, name;
    std::size_t vertices = 0, faces = 0;
    std::getline(in, line);
    REQUIRE(line == "ply");
    std::getline(in, line);
    REQUIRE(line == "format binary_little_endian 1.0");
    while (std::getline(in, line) && line != "end_header") {
        std::istringstream words(line);
        words >> word >> type >> name;
        if (word == "element" && type == "vertex") vertices = std::stoul(name);
        if (word == "element" && type == "face") faces = std::stoul(name);
        if (word == "property" && type == "uchar") file.color_names.push_back(name);
    }
    const auto number = [&](auto zero) {
        Bytes read(sizeof zero);
        in.read(reinterpret_cast<char*>(read.data()), sizeof zero);
        REQUIRE(in.good());
        return number_at<decltype(zero)>(read, 0);
    };
    for (std::size_t v = 0; v < vertices; ++v) {
        file.positions.emplace_back();
        for (float& x : file.positions.back()) x = number(0.0F);
        file.colors.emplace_back();
        for (std::size_t k = 0; k < file.color_names.size(); ++k) file.colors.back().push_back(number(std::uint8_t{0}));
    }
    for (std::size_t f = 0; f < faces; ++f) {
        REQUIRE(number(std::uint8_t{0}) == 3);
        file.faces.push_back({});
        for (std::int32_t& v : file.faces.back()) v = number(std::int32_t{0});
    }
    REQUIRE(in.peek() == std::istringstream::traits_type::eof());
    return file;
}

}  // namespace

TEST_CASE("a mesh of two faces is written as these bytes") {
    hmesh::Mesh mesh = two_faces(3);
    mesh.positions = {0, 0, 3, 0, 3, 2, 0, 1.5F};
    mesh.colors = {0, 128, 255, 1, 2, 3, -5, 300, 99.5F, 99.4F, 0.4F, 254.6F};
    const std::string header =
        "ply\n"
        "format binary_little_endian 1.0\n"
        "comment made by hmesh " HMESH_VERSION_STRING
        "\n"
        "element vertex 4\n"
        "property float x\n"
        "property float y\n"
        "property float z\n"
        "property uchar red\n"
        "property uchar green\n"
        "property uchar blue\n"
        "element face 2\n"
        "property list uchar int vertex_indices\n"
        "end_header\n";
    const Bytes body = {
        0, 0, 0,    0,    0, 0, 0, 0x40, 0, 0, 0, 0, 0,  128, 255,  // (0, 2, 0)
        0, 0, 0x40, 0x40, 0, 0, 0, 0x40, 0, 0, 0, 0, 1,  2,   3,    // (3, 2, 0)
        0, 0, 0x40, 0x40, 0, 0, 0, 0,    0, 0, 0, 0, 0,  255, 100,  // (3, 0, 0)
        0, 0, 0,    0,    0, 0, 0, 0x3f, 0, 0, 0, 0, 99, 0,   255,  // (0, 0.5, 0)
        3, 0, 0,    0,    0, 2, 0, 0,    0, 1, 0, 0, 0,             //
        3, 0, 0,    0,    0, 3, 0, 0,    0, 2, 0, 0, 0,             //
    };
    Bytes expected(header.begin(), header.end());
    expected.insert(expected.end(), body.begin(), body.end());
    CHECK(written(mesh) == expected);
}

TEST_CASE("1, 3 and 4 channels are written under the names that viewers know") {
    using Names = std::vector<std::string>;
    const PlyFile gray = read_ply(written(two_faces(1)));
    const PlyFile color = read_ply(written(two_faces(3)));
    const PlyFile alpha = read_ply(written(two_faces(4)));
    CHECK(gray.color_names == Names{"intensity"});
    CHECK(color.color_names == Names{"red", "green", "blue"});
    CHECK(alpha.color_names == Names{"red", "green", "blue", "alpha"});
    CHECK(gray.colors[2] == std::vector<int>{20});
    CHECK(color.colors[2] == std::vector<int>{20, 21, 22});
    CHECK(alpha.colors[2] == std::vector<int>{20, 21, 22, 23});
}

TEST_CASE("what is read back is the mesh with y up and faces counter-clockwise") {
    const hmesh::Mesh mesh = hmesh_test::square_grid(20, 20);  // more than one buffer of the writer
    const PlyFile file = read_ply(written(mesh));
    REQUIRE(file.positions.size() == mesh.vertex_count());
    REQUIRE(file.faces.size() == mesh.face_count());
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
        CHECK(file.positions[v] == std::array<float, 3>{mesh.positions[2 * v], 20 - mesh.positions[2 * v + 1], 0});
        for (std::size_t k = 0; k < 3; ++k)
            CHECK(file.colors[v][k] == std::lround(static_cast<double>(mesh.colors[3 * v + k]) * 255));
    }
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
        std::array<std::array<float, 3>, 3> at{};
        for (std::size_t k = 0; k < 3; ++k) at[k] = file.positions[static_cast<std::size_t>(file.faces[f][k])];
        const float twice_area = (at[1][0] - at[0][0]) * (at[2][1] - at[0][1]) - (at[2][0] - at[0][0]) * (at[1][1] - at[0][1]);
        CHECK(twice_area == 1.0F);
        CHECK(file.faces[f][0] == static_cast<std::int32_t>(mesh.faces[f][0]));
    }
}

TEST_CASE("with ascii, the same numbers are written as text") {
    hmesh::Mesh mesh = two_faces(4);
    mesh.positions = {0, 0, 3, 0, 2.99609375F, 2, 0.1F, 1.5F};
    hmesh::PlyOptions options;
    options.ascii = true;
    const std::string header =
        "ply\n"
        "format ascii 1.0\n"
        "comment made by hmesh " HMESH_VERSION_STRING
        "\n"
        "element vertex 4\n"
        "property float x\n"
        "property float y\n"
        "property float z\n";
    const std::string faces =
        "element face 2\n"
        "property list uchar int vertex_indices\n"
        "end_header\n";
    CHECK(hmesh_test::as_text(written(mesh, options)) ==
          header + "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n" + faces +
              "0 2 0 0 1 2 3\n"
              "3 2 0 10 11 12 13\n"
              "2.99609375 0 0 20 21 22 23\n"
              "0.100000001 0.5 0 30 31 32 33\n"
              "3 0 2 1\n"
              "3 0 3 2\n");
    options.float_colors = true;
    hmesh::Mesh gray = two_faces(1);
    gray.colors = {0, 255, -51, 510};
    CHECK(hmesh_test::as_text(written(gray, options)) == header + "property float intensity\n" + faces +
                                                             "0 2 0 0\n"
                                                             "3 2 0 1\n"
                                                             "3 0 0 -0.200000003\n"
                                                             "0 0 0 2\n"
                                                             "3 0 2 1\n"
                                                             "3 0 3 2\n");
}

TEST_CASE("with float_colors, shares of the peak are written as they are, below 0 and above 1 too") {
    hmesh::Mesh mesh = two_faces(3);
    mesh.peak = 2;
    mesh.colors = {0, 1, 2, -1, 3, 0.1F, 0, 0, 0, 0, 0, 0};
    hmesh::PlyOptions options;
    options.float_colors = true;
    const Bytes bytes = written(mesh, options);
    const std::string text = hmesh_test::as_text(bytes);
    CHECK(text.find("property float red\nproperty float green\nproperty float blue\nelement face") != std::string::npos);
    const std::size_t body = text.find("end_header\n") + 11;
    REQUIRE(bytes.size() == body + 4 * 24 + 2 * 13);
    const auto number = [&](std::size_t vertex, std::size_t k) { return number_at<float>(bytes, body + 24 * vertex + 4 * k); };
    CHECK(number(0, 1) == 2);
    CHECK(number(0, 3) == 0);
    CHECK(number(0, 4) == 0.5F);
    CHECK(number(0, 5) == 1);
    CHECK(number(1, 3) == -0.5F);
    CHECK(number(1, 4) == 1.5F);
    CHECK(number(1, 5) == 0.05F);
}

TEST_CASE("float_colors of a premultiplied mesh are straight, and may be above the peak or below 0") {
    hmesh::Mesh mesh = two_faces(4);
    mesh.peak = 1;
    mesh.premultiplied = true;
    constexpr float largest = std::numeric_limits<float>::max();
    mesh.colors = {5, 1, -1, 1, 1, 0.25F, 0, 0.5F, largest, 0, -largest, 1e-3F, 0, 0, 0, 0};
    hmesh::PlyOptions options;
    options.float_colors = true;
    const Bytes bytes = written(mesh, options);
    const std::size_t body = hmesh_test::as_text(bytes).find("end_header\n") + 11;
    REQUIRE(bytes.size() == body + 4 * 28 + 2 * 13);
    const auto number = [&](std::size_t vertex, std::size_t k) {
        return number_at<float>(bytes, body + 28 * vertex + 12 + 4 * k);
    };
    CHECK(number(0, 0) == 5);
    CHECK(number(0, 2) == -1);
    CHECK(number(1, 0) == 2);
    CHECK(number(1, 1) == 0.5F);
    CHECK(number(2, 0) == 0.5F * largest);
    CHECK(number(2, 2) == -0.5F * largest);
}

TEST_CASE("the locale makes no difference") {
    hmesh::Mesh mesh = two_faces(3);
    mesh.positions[4] = 2.5F;
    for (const bool ascii : {false, true})
        hmesh_test::check_locale_makes_no_difference(mesh.view(), [=](const hmesh::MeshView& view, hmesh::Sink sink) {
            return hmesh::write_ply(view, sink, {ascii, true});
        });
}

TEST_CASE("a sink that refuses anywhere gets no more and is reported") {
    const hmesh::Mesh mesh = hmesh_test::square_grid(16, 16);
    hmesh_test::check_refusing_sinks(mesh.view(), to_sink);
    hmesh_test::check_refusing_sinks(mesh.view(), [](const hmesh::MeshView& view, hmesh::Sink sink) {
        return hmesh::write_ply(view, sink, {true, true});
    });
}

TEST_CASE("a mesh that cannot be written gives a Status and no byte") {
    hmesh_test::check_bad_meshes_are_refused(to_sink);
    hmesh_test::check_bad_meshes_are_refused([](const hmesh::MeshView& view, hmesh::Sink sink) {
        return hmesh::write_ply(view, sink, {true, true});
    });
    hmesh::Mesh mesh = two_faces(3);
    hmesh::MeshView huge = mesh.view();
    huge.vertex_count = std::size_t{1} << 31U;
    hmesh_test::check_refused(huge, hmesh::Errc::invalid_argument, to_sink);
    // A share that no float holds.
    mesh.peak = 1e-40;
    CHECK(to_sink(mesh.view(), [](const void*, std::size_t) { return true; }));
    hmesh_test::check_refused(mesh.view(), hmesh::Errc::not_finite, [](const hmesh::MeshView& view, hmesh::Sink sink) {
        return hmesh::write_ply(view, sink, {false, true});
    });
}

TEST_CASE("a mesh of nothing is a header that counts nothing") {
    hmesh_test::check_empty_meshes(to_sink, [](const Bytes& bytes) {
        const std::string text = hmesh_test::as_text(bytes);
        CHECK(text.find("element vertex 0\n") != std::string::npos);
        CHECK(text.find("element face 0\n") != std::string::npos);
        CHECK(text.substr(text.size() - 11) == "end_header\n");
    });
}
