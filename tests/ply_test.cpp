#include "hmesh/io/ply.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

namespace {

using Bytes = std::vector<unsigned char>;

struct VectorSink {
    Bytes* bytes;
    bool operator()(const void* from, std::size_t size) const {
        const auto* at = static_cast<const unsigned char*>(from);
        bytes->insert(bytes->end(), at, at + size);
        return true;
    }
};

template <int C>
Bytes written(const hmesh::Mesh<C>& mesh) {
    Bytes bytes;
    REQUIRE(hmesh::write_ply(mesh.view(), VectorSink{&bytes}));
    return bytes;
}

// The rectangle [0, 3] x [0, 2] cut from its upper left to its lower right corner.
template <int C>
hmesh::Mesh<C> two_faces() {
    hmesh::Mesh<C> mesh;
    mesh.width = 3, mesh.height = 2, mesh.peak = 255;
    mesh.positions = {0, 0, 3, 0, 3, 2, 0, 2};
    mesh.faces = {{0, 1, 2}, {0, 2, 3}};
    for (int v = 0; v < 4; ++v)
        for (int k = 0; k < C; ++k) mesh.colors.push_back(static_cast<float>(10 * v + k));
    return mesh;
}

// A regular grid of n x n squares of two faces each.
hmesh::Mesh<3> grid(int n) {
    hmesh::Mesh<3> mesh;
    mesh.width = mesh.height = n, mesh.peak = 1;
    for (int y = 0; y <= n; ++y)
        for (int x = 0; x <= n; ++x) {
            mesh.positions.insert(mesh.positions.end(), {static_cast<float>(x), static_cast<float>(y)});
            mesh.colors.insert(mesh.colors.end(), {static_cast<float>(x) / static_cast<float>(n), 0.5F, 1});
        }
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            const auto a = static_cast<std::uint32_t>(y * (n + 1) + x), b = a + 1,
                       c = a + static_cast<std::uint32_t>(n) + 1, d = c + 1;
            mesh.faces.push_back({a, b, d});
            mesh.faces.push_back({a, d, c});
        }
    return mesh;
}

struct PlyFile {
    std::vector<std::string> colour_names;
    std::vector<std::array<float, 3>> positions;
    std::vector<std::vector<int>> colours;
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
        if (word == "property" && type == "uchar") file.colour_names.push_back(name);
    }
    const auto number = [&](auto value) {  // the test runs on little-endian machines
        in.read(reinterpret_cast<char*>(&value), sizeof value);
        REQUIRE(in.good());
        return value;
    };
    for (std::size_t v = 0; v < vertices; ++v) {
        file.positions.push_back({});
        for (float& x : file.positions.back()) x = number(0.0F);
        file.colours.push_back({});
        for (std::size_t k = 0; k < file.colour_names.size(); ++k)
            file.colours.back().push_back(number(std::uint8_t{0}));
    }
    for (std::size_t f = 0; f < faces; ++f) {
        REQUIRE(number(std::uint8_t{0}) == 3);
        file.faces.push_back({});
        for (std::int32_t& v : file.faces.back()) v = number(std::int32_t{0});
    }
    REQUIRE(in.peek() == std::istringstream::traits_type::eof());
    return file;
}

void check_refused(const hmesh::MeshView& mesh, hmesh::Errc code) {
    Bytes bytes;
    const hmesh::Status status = hmesh::write_ply(mesh, VectorSink{&bytes});
    CHECK(status.code == code);
    CHECK(std::strlen(status.what) > 0);
    CHECK(bytes.empty());
}

}  // namespace

TEST_CASE("a mesh of two faces is written as these bytes") {
    hmesh::Mesh<3> mesh = two_faces<3>();
    mesh.positions = {0, 0, 3, 0, 3, 2, 0, 1.5F};
    mesh.colors = {0, 128, 255, 1, 2, 3, -5, 300, 99.5F, 99.4F, 0.4F, 254.6F};
    const std::string header =
        "ply\n"
        "format binary_little_endian 1.0\n"
        "comment made by hmesh " HMESH_VERSION_STRING "\n"
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
        0, 0, 0,    0,    0, 0, 0,    0x40, 0, 0, 0, 0, 0,  128, 255,  // (0, 2, 0)
        0, 0, 0x40, 0x40, 0, 0, 0,    0x40, 0, 0, 0, 0, 1,  2,   3,    // (3, 2, 0)
        0, 0, 0x40, 0x40, 0, 0, 0,    0,    0, 0, 0, 0, 0,  255, 100,  // (3, 0, 0)
        0, 0, 0,    0,    0, 0, 0,    0x3f, 0, 0, 0, 0, 99, 0,   255,  // (0, 0.5, 0)
        3, 0, 0,    0,    0, 2, 0,    0,    0, 1, 0, 0, 0,             //
        3, 0, 0,    0,    0, 3, 0,    0,    0, 2, 0, 0, 0,             //
    };
    Bytes expected(header.begin(), header.end());
    expected.insert(expected.end(), body.begin(), body.end());
    CHECK(written(mesh) == expected);
}

TEST_CASE("1, 3 and 4 channels are written under the names that viewers know") {
    using Names = std::vector<std::string>;
    const PlyFile grey = read_ply(written(two_faces<1>()));
    const PlyFile colour = read_ply(written(two_faces<3>()));
    const PlyFile alpha = read_ply(written(two_faces<4>()));
    CHECK(grey.colour_names == Names{"intensity"});
    CHECK(colour.colour_names == Names{"red", "green", "blue"});
    CHECK(alpha.colour_names == Names{"red", "green", "blue", "alpha"});
    CHECK(grey.colours[2] == std::vector<int>{20});
    CHECK(colour.colours[2] == std::vector<int>{20, 21, 22});
    CHECK(alpha.colours[2] == std::vector<int>{20, 21, 22, 23});
}

TEST_CASE("what is read back is the mesh with y up and faces counter-clockwise") {
    const hmesh::Mesh<3> mesh = grid(20);  // more than one buffer of the writer
    const PlyFile file = read_ply(written(mesh));
    REQUIRE(file.positions.size() == mesh.vertex_count());
    REQUIRE(file.faces.size() == mesh.face_count());
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
        CHECK(file.positions[v] == std::array<float, 3>{mesh.positions[2 * v], 20 - mesh.positions[2 * v + 1], 0});
        for (std::size_t k = 0; k < 3; ++k)
            CHECK(file.colours[v][k] == std::lround(static_cast<double>(mesh.colors[3 * v + k]) * 255));
    }
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
        std::array<std::array<float, 3>, 3> at{};
        for (std::size_t k = 0; k < 3; ++k) at[k] = file.positions[static_cast<std::size_t>(file.faces[f][k])];
        const float twice_area =
            (at[1][0] - at[0][0]) * (at[2][1] - at[0][1]) - (at[2][0] - at[0][0]) * (at[1][1] - at[0][1]);
        CHECK(twice_area == 1.0F);
        CHECK(file.faces[f][0] == static_cast<std::int32_t>(mesh.faces[f][0]));
    }
}

TEST_CASE("a sink that refuses after k bytes gets no more and is reported, for all k") {
    const hmesh::Mesh<3> mesh = grid(16);
    const std::size_t size = written(mesh).size();
    REQUIRE(size > 8192);
    for (std::size_t k = 0; k <= size; ++k) {
        std::size_t taken = 0;
        int refusals = 0;
        const hmesh::Status status = hmesh::write_ply(mesh.view(), [&](const void*, std::size_t bytes) {
            const bool fits = taken + bytes <= k;
            if (fits) taken += bytes;
            else ++refusals;
            return fits;
        });
        const bool all = k == size;
        if (static_cast<bool>(status) != all || refusals != (all ? 0 : 1) || taken > k) FAIL("k = ", k);
        if (!all && (status.code != hmesh::Errc::write_failed || status.got != static_cast<std::int64_t>(taken)))
            FAIL("k = ", k);
    }
}

TEST_CASE("a mesh that cannot be written gives a Status and no byte") {
    const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
    const hmesh::Mesh<3> good = two_faces<3>();
    check_refused(hmesh::MeshView{}, hmesh::Errc::invalid_argument);
    for (const float bad : {nan, infinity, -infinity}) {
        hmesh::Mesh<3> mesh = good;
        mesh.positions[7] = bad;
        check_refused(mesh.view(), hmesh::Errc::not_finite);
        mesh = good;
        mesh.colors[11] = bad;
        check_refused(mesh.view(), hmesh::Errc::not_finite);
    }
    hmesh::Mesh<3> mesh = good;
    mesh.faces[1][2] = 4;
    check_refused(mesh.view(), hmesh::Errc::invalid_argument);
    mesh = good;
    mesh.faces.clear();
    check_refused(mesh.view(), hmesh::Errc::invalid_argument);
    for (const double peak : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
        mesh = good;
        mesh.peak = peak;
        check_refused(mesh.view(), hmesh::Errc::invalid_argument);
    }
    mesh = good;
    mesh.height = 0;
    check_refused(mesh.view(), hmesh::Errc::invalid_argument);
    check_refused(two_faces<2>().view(), hmesh::Errc::invalid_argument);
    check_refused(two_faces<5>().view(), hmesh::Errc::invalid_argument);
    hmesh::MeshView huge = good.view();
    huge.vertex_count = std::size_t{1} << 31U;
    check_refused(huge, hmesh::Errc::invalid_argument);
}
