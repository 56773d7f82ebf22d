#include "hmesh/io/compact.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "compact_meshes.hpp"
#include "hmesh/core/random.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/io/compact/photographs.hpp"
#include "hmesh/io/compact/start_table.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/mesh/torus.hpp"
#include "test_exports.hpp"
#include "test_sanitized.hpp"

#ifndef HMESH_TEST_SOURCE
#define HMESH_TEST_SOURCE "tests"  // seen from the repository's root
#endif

using hmesh::CompactColors;
using hmesh::CompactMesh;
using hmesh::CompactOptions;
using hmesh::CompactTable;
using hmesh::Errc;
using hmesh::Mesh;
using hmesh_test::Bytes;
using hmesh_test::MeshKind;
using hmesh_test::random_mesh;

namespace {

Bytes compact(const Mesh& mesh, const CompactOptions& options = {}) {
    return hmesh_test::exported(
        mesh.view(), [&](const hmesh::MeshView& view, hmesh::Sink sink) { return write_compact(view, sink, options); });
}
CompactMesh read(const Bytes& bytes, const CompactTable* table = nullptr) {
    return hmesh::read_compact(bytes.data(), bytes.size(), {}, table);
}
CompactMesh read_bare(const Bytes& bytes, const CompactTable* table = nullptr) {
    return hmesh::read_bare_compact(bytes.data(), bytes.size(), {}, table);
}

// A status without a byte written.
hmesh::Status refusal(const Mesh& mesh, const CompactOptions& options = {}) {
    bool is_called = false;
    const auto sink = [&](const void*, std::size_t) { return is_called = true; };
    const hmesh::Status status = write_compact(mesh.view(), sink, options);
    CHECK(!is_called);
    return status;
}

// What a file that was changed must be for the reader to look at more than its checksum.
void seal(Bytes& bytes) {
    const auto put = [&](std::size_t at, std::size_t value) {
        for (std::size_t k = 0; k < 4; ++k) bytes[at + k] = static_cast<unsigned char>(value >> (8 * k) & 0xffU);
    };
    if (bytes.size() < 14) return;
    put(6, bytes.size());
    std::uint32_t crc = 0xffffffffU;  // bit by bit
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        if (i >= 10 && i < 14) continue;
        crc ^= bytes[i];
        for (int k = 0; k < 8; ++k) crc = (crc & 1U) != 0 ? crc >> 1 ^ 0xedb88320U : crc >> 1;
    }
    put(10, ~crc);
}

// Whether faces turn one way and no two share a side: then they do not overlap, as those of a whole rectangle are its area.
bool is_tiling(const Mesh& mesh) {
    if (!hmesh::check(mesh, 4)) return false;
    std::set<std::pair<std::uint32_t, std::uint32_t>> sides;
    double area = 0;
    for (const hmesh::Triangle& face : mesh.faces) {
        const auto at = [&](std::size_t k, std::size_t axis) { return static_cast<double>(mesh.positions[2 * face[k] + axis]); };
        const double twice = (at(1, 0) - at(0, 0)) * (at(2, 1) - at(0, 1)) - (at(2, 0) - at(0, 0)) * (at(1, 1) - at(0, 1));
        if (twice <= 0) return false;
        area += twice / 2;
        for (std::size_t k = 0; k < 3; ++k)
            if (!sides.insert({face[k], face[(k + 1) % 3]}).second) return false;
    }
    return area <= static_cast<double>(mesh.view().right()) * mesh.view().bottom() || mesh.periodic != hmesh::Periodic::none;
}

std::vector<MeshKind> kinds() {
    std::vector<MeshKind> all(16);
    all[1] = {1, 1, 1, 40, 0, 60, 1, 0};
    all[2] = {1, 1, 256, 4, 0, 4, 4, 0};
    all[3] = {65536, 1, 1, 25, 0, 40, 3, 0};
    all[4] = {65536, 65536, 1, 25, 0, 40, 2, 0};
    all[5] = {100, 70, 1, 120, 0, 400, 3, 0};      // far from Delaunay
    all[6] = {100, 70, 256, 120, 0, 100, 3, 0};    // many on a circle
    all[7] = {8, 8, 256, 400, 0, 200, 3, 0};       // all sites
    all[8] = {100, 70, 1, 60, 1, 0, 3, 0};         // on two sides
    all[9] = {100, 2, 1, 80, 2, 300, 3, 0};        // on three lines
    all[10] = {200, 150, 16, 60, 0, 100, 4, 0.2};  // holes
    all[11] = {200, 150, 1, 60, 0, 100, 4, 0.95};  // pieces that touch in a point, or not
    all[12] = {3, 65536, 4, 30, 0, 80, 1, 0.3};
    all[13] = {16, 16, 1, 0, 0, 0, 3, 0};  // two faces
    all[14] = {16, 16, 1, 0, 0, 9, 3, 1};  // none
    all[15] = {300, 200, 1, 500, 0, 700, 3, 0};
    return all;
}

}  // namespace

TEST_CASE("meshes of all kinds come back as they were, and give the same bytes again") {
    std::uint64_t seed = 0;
    for (const MeshKind& kind : kinds())
        for (std::size_t repeat = 0; repeat < 6; repeat += hmesh_test::stride_if_sanitized(3)) {
            const Mesh mesh = random_mesh(kind, ++seed);
            CAPTURE(seed);
            const Bytes bytes = compact(mesh);
            const CompactMesh back = read(bytes);
            REQUIRE(back.status);
            CHECK(hmesh_test::difference(mesh, back.mesh) == "");
            CHECK(compact(back.mesh) == bytes);
        }
}

// Of any size, lattice, number of points, lines, flips, channels and holes.
MeshKind random_kind(hmesh::kit::Random& random) {
    MeshKind kind;
    const auto side = [&] {
        const std::size_t choice = random.below(8);
        return choice == 0 ? 1 : choice == 1 ? 65536 : 1 + static_cast<int>(random.below(choice < 5 ? 20 : 600));
    };
    kind.width = side();
    kind.height = side();
    kind.step = 1 << random.below(9);
    kind.points = random.below(random.below(4) == 0 ? 400 : 60);
    kind.rows = random.below(3) == 0 ? 1 + random.below(4) : 0;
    kind.flips = random.below(4 * kind.points + 1);
    kind.channels = 1 + static_cast<int>(random.below(4));
    kind.hidden = random.below(3) == 0 ? random.uniform() : 0;
    return kind;
}

// HMESH_TEST_ROUNDS=N in the environment: N times as many.
TEST_CASE("random meshes come back as they were, or are refused before a byte is written") {
    const char* const rounds = std::getenv("HMESH_TEST_ROUNDS");
    const std::size_t count =
        (rounds == nullptr ? 1 : std::strtoul(rounds, nullptr, 10)) * 400 / hmesh_test::stride_if_sanitized(8);
    hmesh::kit::Random random(rounds == nullptr ? 1 : 2);
    std::size_t refused = 0;
    for (std::size_t round = 0; round < count; ++round) {
        const MeshKind kind = random_kind(random);
        const Mesh mesh = random_mesh(kind, 1000 + round);
        CAPTURE(round);
        CompactOptions options;
        options.colors = std::vector{CompactColors::bits8, CompactColors::bits16, CompactColors::floats}[random.below(3)];
        if (random.below(4) == 0) options.table = &hmesh::compact_photographs;
        Bytes bytes;
        if (const hmesh::Status status = write_compact(mesh.view(), hmesh::kit::append_to(bytes), options); !status) {
            CHECK(status.code == Errc::invalid_argument);
            CHECK(bytes.empty());
            ++refused;
            continue;
        }
        const CompactMesh back = read(bytes, options.table);
        REQUIRE(back.status);
        CHECK(hmesh_test::difference(mesh, back.mesh) == "");
    }
    CHECK(refused <= count / 100);
}

TEST_CASE("a vertex with spokes to all others, and strips along it, come back") {
    Mesh mesh = hmesh_test::two_faces(3);
    mesh.width = mesh.height = 64;
    mesh.positions = {0, 0, 64, 0, 64, 64, 0, 64};
    // The left side sees the lower right corner, and the right side the upper left one.
    mesh.faces = {{0, 1, 2}};
    for (std::uint32_t k = 1; k < 60; ++k) {
        mesh.positions.insert(mesh.positions.end(), {0, static_cast<float>(64 - k)});
        mesh.colors.insert(mesh.colors.end(), {static_cast<float>(k), 7, 9});
        mesh.faces.push_back({2, k == 1 ? 3 : k + 2, k + 3});
    }
    mesh.faces.push_back({2, 62, 0});
    const CompactMesh back = read(compact(mesh));
    REQUIRE(back.status);
    CHECK(hmesh_test::difference(mesh, back.mesh) == "");
}

TEST_CASE("a mesh whose edges are found by flips of which some undo others comes back") {
    const Mesh mesh = random_mesh({100, 70, 1, 200, 0, 3000, 3, 0}, 19);
    const CompactMesh back = read(compact(mesh));
    REQUIRE(back.status);
    CHECK(hmesh_test::difference(mesh, back.mesh) == "");
}

TEST_CASE("a mesh of which Delaunay's triangulation is too many flips away is refused, and not for overlaps") {
    // Two chains of points that bend towards each other. All faces between them are fans of one point of each: in Delaunay's
    // triangulation chains take turns, and one flip exchanges no more than two turns.
    const auto fans = [](int n) {
        Mesh mesh;
        mesh.width = n;
        mesh.height = (2 * n * n + 255) / 256;
        mesh.channels = 1;
        mesh.peak = 255;
        const auto middle = static_cast<float>(mesh.height) / 2;
        for (const int side : {-1, 1})
            for (int k = -n / 2; k < n / 2; ++k) {
                mesh.positions.push_back(static_cast<float>(k + n / 2));
                mesh.positions.push_back(middle + static_cast<float>(side * (n * n / 2 + k * k)) / 256);
                mesh.colors.push_back(100);
            }
        const auto count = static_cast<std::uint32_t>(n);
        for (std::uint32_t k = 0; k + 1 < count; ++k) {
            mesh.faces.push_back({k, k + 1, count});
            mesh.faces.push_back({count - 1, count + k + 1, count + k});
        }
        return mesh;
    };
    const Mesh few = fans(100);
    const CompactMesh back = read(compact(few));
    REQUIRE(back.status);
    CHECK(hmesh_test::difference(few, back.mesh) == "");
    const hmesh::Status status = refusal(fans(400));
    CHECK(status.code == Errc::invalid_argument);
    CHECK(std::string(status.what).find("too unlike Delaunay's") != std::string::npos);
    CHECK(status.limit == 64 * 804);
    CHECK(status.value > status.limit);
}

TEST_CASE("what is said of the image is kept") {
    Mesh mesh = random_mesh({}, 3);
    for (const bool points : {false, true})
        for (const bool premultiplied : {false, true})
            for (const bool linear : {false, true}) {
                mesh = random_mesh({16, 16, 1, 30, 0, 10, 4, 0}, 3);
                mesh.premultiplied = premultiplied;
                if (points) mesh.samples = hmesh::Samples::points, mesh.width = mesh.height = 17;
                CompactOptions options;
                options.linear = linear;
                const CompactMesh back = read(compact(mesh, options));
                REQUIRE(back.status);
                CHECK(hmesh_test::difference(mesh, back.mesh) == "");
                CHECK(back.linear == linear);
            }
}

TEST_CASE("colours come back from 16 bits and from floats to the bit") {
    Mesh mesh = random_mesh({}, 4);
    mesh.peak = 65535;
    hmesh::kit::Random random(5);
    for (float& value : mesh.colors) value = static_cast<float>(random.below(65536));
    CompactOptions options;
    options.colors = CompactColors::bits16;
    CHECK(hmesh_test::difference(mesh, read(compact(mesh, options)).mesh) == "");

    mesh.peak = 0.37;
    constexpr auto most = std::numeric_limits<float>::max();
    for (float& value : mesh.colors) value = static_cast<float>(2 * random.uniform() - 1) * (random.below(9) == 0 ? most : 1.0F);
    mesh.colors[0] = -0.0F;
    options.colors = CompactColors::floats;
    const CompactMesh back = read(compact(mesh, options));
    REQUIRE(back.status);
    CHECK(hmesh_test::difference(mesh, back.mesh) == "");
    CHECK(compact(back.mesh, options) == compact(mesh, options));
}

TEST_CASE("colours that integers do not hold are rounded as those of other files, and held to their range") {
    Mesh mesh = hmesh_test::two_faces(1);
    mesh.colors = {-3, 10.4F, 10.6F, 300};
    const CompactMesh back = read(compact(mesh));
    CHECK(std::multiset<float>(back.mesh.colors.begin(), back.mesh.colors.end()) == std::multiset<float>{0, 10, 11, 255});
}

TEST_CASE("a periodic mesh with a jagged cut comes back, and one that does not join itself is refused") {
    // One period of x: the left and the right side are the same zigzag.
    Mesh mesh = hmesh_test::two_faces(3);
    mesh.periodic = hmesh::Periodic::x;
    mesh.positions = {-1, 0, 2, 0, 4, 1, 1, 1, -1, 2, 2, 2};
    mesh.colors = {1, 2, 3, 1, 2, 3, 7, 8, 9, 7, 8, 9, 4, 5, 6, 4, 5, 6};
    mesh.faces = {{0, 1, 3}, {1, 2, 3}, {3, 5, 4}, {3, 2, 5}};
    REQUIRE(hmesh::kit::check_periodic(mesh.view()));
    const CompactMesh back = read(compact(mesh));
    REQUIRE(back.status);
    CHECK(hmesh_test::difference(mesh, back.mesh) == "");
    CompactOptions coarse;
    coarse.color_step = 16;
    CHECK(refusal(mesh, coarse).code == Errc::invalid_argument);  // copies on the cut would differ
    mesh.colors[0] = 50;
    CHECK(refusal(mesh).code == Errc::invalid_argument);
}

TEST_CASE("vertices of one place and colour become one, in which two pieces touch") {
    Mesh mesh = hmesh_test::two_faces(1);
    mesh.positions = {0, 0, 1, 0, 1, 1, 1, 1, 3, 2, 0, 2};
    mesh.colors = {1, 2, 9, 9, 3, 4};
    mesh.faces = {{0, 1, 2}, {3, 4, 5}};
    const CompactMesh back = read(compact(mesh));
    REQUIRE(back.status);
    CHECK(back.mesh.vertex_count() == 5);
    CHECK(back.mesh.face_count() == 2);
    CHECK(is_tiling(back.mesh));
    mesh.colors[3] = 8;
    CHECK(refusal(mesh).code == Errc::invalid_argument);
}

TEST_CASE("what a compact file cannot hold is refused before a byte is written") {
    const Mesh good = hmesh_test::two_faces(3);
    const auto refused = [&](auto&& spoil) {
        Mesh mesh = good;
        spoil(mesh);
        return refusal(mesh).code == Errc::invalid_argument;
    };
    CHECK(compact(good).size() > 14);
    CHECK(refused([](Mesh& m) { m.positions[2] = 2.999F; }));                  // off the grid
    CHECK(refused([](Mesh& m) { m.positions[2] = 4; }));                       // outside of the image
    CHECK(refused([](Mesh& m) { std::swap(m.faces[0][0], m.faces[0][1]); }));  // turned over
    CHECK(refused([](Mesh& m) { m.faces[1] = {0, 1, 3}; }));                   // overlapping
    CHECK(refused([](Mesh& m) { m.faces.push_back(m.faces[0]); }));            // twice
    CHECK(refused([](Mesh& m) { m.faces.pop_back(); }));                       // a vertex without a face
    CHECK(refused([](Mesh& m) { m.positions = {0, 0, 3, 0, 3, 2, 0, 0}; }));   // two at a place
    CHECK(refused([](Mesh& m) { m.faces[0] = {0, 1, 1}; }));                   // without an area
    CHECK(refused([](Mesh& m) {                                                // a vertex on a side of a face
        m.positions.insert(m.positions.end(), {1.5F, 1, 1, 2});
        m.colors.resize(18, 5);
        m.faces = {{0, 1, 2}, {0, 4, 3}, {4, 5, 3}};
    }));
    for (const int width : {0, -1, 65537}) {
        Mesh mesh = good;
        mesh.width = width;
        CHECK(!refusal(mesh));
    }
    Mesh five = good;
    five.channels = 5;
    five.colors.resize(20);
    CHECK(refusal(five).code == Errc::invalid_argument);
    Mesh odd = good;
    odd.colors[3] = std::numeric_limits<float>::quiet_NaN();
    CHECK(refusal(odd).code == Errc::not_finite);
}

TEST_CASE("a sink that refuses bytes is told of") {
    const Mesh mesh = random_mesh({}, 1);
    CHECK(write_compact(mesh.view(), [](const void*, std::size_t) { return false; }).code == Errc::write_failed);
}

TEST_CASE("a Delaunay mesh costs its points and colours, and next to nothing for faces") {
    const auto size = [](std::size_t flips) {
        Mesh mesh = random_mesh({512, 512, 1, 1500, 0, flips, 1, 0}, 11);
        for (float& value : mesh.colors) value = 77;
        return static_cast<double>(compact(mesh).size());
    };
    const double plain = size(0), flipped = size(3000);
    CHECK(plain < 1500 * 25.6 / 8);  // log2(512^2 256^2 / 1500) + log2(e) = 24.9 bits, and what is learnt
    CHECK(flipped > plain + 200);
}

TEST_CASE("the bare profile has a head of five bytes and comes back") {
    for (int channels = 1; channels <= 4; ++channels) {
        const Mesh mesh = random_mesh({96, 64, 256, 40, 0, 60, channels, 0}, 8);
        CompactOptions options;
        const std::size_t whole = compact(mesh, options).size();
        options.bare = true;
        const Bytes bytes = compact(mesh, options);
        CHECK(bytes.size() < whole - 10);
        CHECK(bytes[1] == 96);
        CHECK(bytes[2] == 64);
        const CompactMesh back = read_bare(bytes);
        REQUIRE(back.status);
        CHECK(hmesh_test::difference(mesh, back.mesh) == "");
        CHECK(!read(bytes).status);
    }
    CompactOptions bare;
    bare.bare = true;
    CHECK(refusal(random_mesh({96, 64, 128, 40, 0, 60, 3, 0}, 8), bare).code == Errc::invalid_argument);    // half px
    CHECK(refusal(random_mesh({96, 64, 256, 40, 0, 60, 3, 0.5}, 8), bare).code == Errc::invalid_argument);  // holes
    Mesh points = random_mesh({95, 63, 256, 40, 0, 60, 3, 0}, 8);
    points.width = 96, points.height = 64, points.samples = hmesh::Samples::points;
    CHECK(std::string(refusal(points, bare).what).find("square samples") != std::string::npos);
}

TEST_CASE("coarse colours come back within their steps, and the finer the nearer") {
    for (int channels = 1; channels <= 4; ++channels) {
        const Mesh mesh = random_mesh({96, 64, 256, 90, 0, 60, channels, 0}, 8);
        double before = 1e9;
        for (const std::uint32_t step : {1000U, 200U, 40U, 8U, 1U}) {
            CompactOptions options;
            options.color_step = step;
            const CompactMesh back = read(compact(mesh, options));
            REQUIRE(back.status);
            // The same positions and faces: colours are compared at the places that both have in the file's order.
            const Mesh exact = read(compact(mesh)).mesh;
            CHECK(back.mesh.positions == exact.positions);
            REQUIRE(back.mesh.faces == exact.faces);
            double worst = 0;
            for (std::size_t k = 0; k < exact.colors.size(); ++k)
                worst =
                    std::max(worst, std::abs(static_cast<double>(exact.colors[k]) - static_cast<double>(back.mesh.colors[k])));
            CHECK(worst <= before);
            // Steps are at most four times that of the mean area; errors of neighbours count too, and there are three planes.
            CHECK(worst <= 1 + 12.0 * step / 16);
            before = worst;
        }
    }
}

TEST_CASE("vertices are moved to a lattice, and faces stay as they lie") {
    std::uint64_t seed = 70;
    for (const std::uint32_t lattice : {16U, 100U, 256U}) {
        const Mesh mesh = random_mesh({96, 65, 1, 60, 0, 60, 3, 0}, ++seed);
        CompactOptions options;
        options.lattice = lattice;
        const CompactMesh back = read(compact(mesh, options));
        REQUIRE(back.status);
        CHECK(is_tiling(back.mesh));
        CHECK(back.mesh.face_count() == mesh.face_count());
        for (std::size_t k = 0; k < back.mesh.positions.size(); ++k) {
            const double side = k % 2 == 0 ? 96 : 65, at = static_cast<double>(back.mesh.positions[k]);
            CHECK((at == side || std::fmod(256 * at, lattice) == 0));
        }
        options.lattice = 256 * 90;
        CHECK(refusal(mesh, options).code == Errc::invalid_argument);
    }
    CompactOptions options;
    options.color_step = 4096;
    CHECK(refusal(random_mesh({}, 1), options).code == Errc::invalid_argument);
    options.color_step = 1, options.colors = CompactColors::bits16;
    CHECK(refusal(random_mesh({}, 1), options).code == Errc::invalid_argument);
    options.color_step = 0, options.colors = static_cast<CompactColors>(3);
    CHECK(refusal(random_mesh({}, 1), options).value == 3);
}

TEST_CASE("the bare profile is refused a lattice that its reader refuses") {
    Mesh mesh = hmesh_test::two_faces(3);
    mesh.positions = {0, 0, 3, 0, 3, 2, 0, 2};
    CompactOptions options;
    options.bare = true;
    options.lattice = 65536U * 256;
    const Bytes bytes = compact(mesh, options);
    CHECK(hmesh::read_bare_compact(bytes.data(), bytes.size()).status);
    options.lattice += 256;
    CHECK(refusal(mesh, options).code == Errc::invalid_argument);
}

TEST_CASE("a peak above the largest float gives colours that are") {
    Mesh mesh = hmesh_test::two_faces(1);
    mesh.peak = 1e39;
    for (float& value : mesh.colors) value = std::numeric_limits<float>::max();
    const CompactMesh back = read(compact(mesh));
    REQUIRE(back.status);
    for (const float value : back.mesh.colors) CHECK(value == doctest::Approx(3.4e38).epsilon(0.01));
}

TEST_CASE("the size of a bare mesh may be told by others") {
    const Mesh mesh = random_mesh({300, 200, 512, 40, 0, 60, 3, 0}, 8);
    CompactOptions options;
    options.bare = options.size_is_told = true;
    const Bytes bytes = compact(mesh, options);
    const CompactMesh back = hmesh::read_bare_compact(bytes.data(), bytes.size(), 300, 200);
    REQUIRE(back.status);
    CHECK(hmesh_test::difference(mesh, back.mesh) == "");
    CHECK(!read_bare(bytes).status);
    CHECK(hmesh::read_bare_compact(bytes.data(), bytes.size(), 0, 200).status.code == Errc::invalid_argument);
    CHECK(hmesh::read_bare_compact(bytes.data(), bytes.size(), 300, 65537).status.code == Errc::invalid_argument);
    options.bare = false;
    CHECK(refusal(mesh, options).code == Errc::invalid_argument);
}

TEST_CASE("limits are kept, and their values checked") {
    const Bytes bytes = compact(random_mesh({}, 2));
    const std::size_t vertices = read(bytes).mesh.vertex_count();
    const auto status = [&](std::int64_t most, std::int64_t pixels) {
        hmesh::CompactLimits limits;
        limits.max_vertices = most;
        limits.max_pixels = pixels;
        return hmesh::read_compact(bytes.data(), bytes.size(), limits).status;
    };
    const auto n = static_cast<std::int64_t>(vertices);
    CHECK(status(n, 256));
    CHECK(!status(n - 1, 256));
    CHECK(status(n - 1, 256).value == doctest::Approx(static_cast<double>(n)));
    CHECK(status(n, 255).code == Errc::image_too_large);
    CHECK(status(3, 256).code == Errc::invalid_argument);
    CHECK(status(3, 256).value == 3);
    CHECK(status(4, 256).value == doctest::Approx(static_cast<double>(n)));
    CHECK(status(std::int64_t{1} << 24, 256));
    CHECK(status((std::int64_t{1} << 24) + 1, 256).code == Errc::invalid_argument);
    CHECK(status(n, 0).code == Errc::invalid_argument);
    CHECK(status(n, 1).code == Errc::image_too_large);
    CHECK(status(n, std::int64_t{1} << 32));
    CHECK(status(n, (std::int64_t{1} << 32) + 1).code == Errc::invalid_argument);
}

TEST_CASE("a file cut anywhere, or with any bit turned, is refused") {
    const MeshKind kinds[] = {{}, {200, 150, 16, 20, 0, 30, 4, 0.3}, {1, 1, 1, 3, 0, 4, 1, 0}, {90, 60, 256, 25, 0, 30, 3, 0}};
    for (const MeshKind& kind : kinds) {
        CompactOptions options;
        if (kind.step == 256) options.color_step = 90, options.table = &hmesh::compact_photographs;
        const Bytes whole = compact(random_mesh(kind, 6), options);
        const auto status = [&](const Bytes& bytes) { return read(bytes, options.table).status; };
        REQUIRE(status(whole));
        for (std::size_t size = 0; size < whole.size(); ++size) {
            Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
            CHECK(!status(cut));
            CHECK(read(cut, options.table).mesh.faces.empty());
        }
        for (std::size_t bit = 0; bit < 8 * whole.size(); bit += hmesh_test::stride_if_sanitized(7)) {
            Bytes turned = whole;
            turned[bit / 8] = static_cast<unsigned char>(turned[bit / 8] ^ 1U << (bit % 8));
            CHECK(!status(turned));
        }
        Bytes longer = whole;
        longer.push_back(0);
        CHECK(!status(longer));
        seal(longer);
        CHECK(!status(longer));
        CHECK(!hmesh::read_compact(nullptr, 0).status);
        CHECK(!hmesh::read_bare_compact(nullptr, 0).status);
    }
}

TEST_CASE("damage that checksums do not see gives a valid mesh or none") {
    std::size_t passed = 0;
    const auto look = [&](const CompactMesh& got) {
        if (!got.status) {
            CHECK(got.mesh.faces.empty());
            CHECK(got.mesh.positions.empty());
            return;
        }
        ++passed;
        CHECK(is_tiling(got.mesh));
    };
    for (const MeshKind& kind : {MeshKind{64, 64, 256, 12, 0, 30, 3, 0}, MeshKind{64, 64, 256, 12, 0, 30, 4, 0.3}}) {
        const bool is_bare = kind.hidden == 0;
        CompactOptions options;
        options.bare = is_bare;
        const Bytes whole = compact(random_mesh(kind, 9), options);
        for (std::size_t size = 0; size < whole.size(); ++size) {
            Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
            if (!is_bare) seal(cut);
            look(is_bare ? read_bare(cut) : read(cut));
        }
        for (std::size_t bit = 0; bit < 8 * whole.size(); bit += hmesh_test::stride_if_sanitized(5)) {
            Bytes turned = whole;
            turned[bit / 8] = static_cast<unsigned char>(turned[bit / 8] ^ 1U << (bit % 8));
            if (!is_bare) seal(turned);
            look(is_bare ? read_bare(turned) : read(turned));
        }
    }
    hmesh::kit::Random random(1);
    for (int k = 0; k < 300; ++k) {
        Bytes noise{0x12, 40, 30, 1, static_cast<unsigned char>(k % 100)};
        const std::size_t size = random.below(60);
        while (noise.size() < 5 + size) noise.push_back(static_cast<unsigned char>(random.below(256)));
        look(read_bare(noise));
    }
    CHECK(passed > 0);
}

TEST_CASE("a start table is for those who have it, and changes nothing but the bytes") {
    for (const bool is_bare : {false, true})
        for (const int channels : {1, 3, 4}) {
            CAPTURE(is_bare);
            CAPTURE(channels);
            CompactOptions options;
            options.bare = is_bare;
            options.color_step = 100;
            const Mesh mesh = random_mesh({80, 60, 256, 40, 0, 60, channels, 0}, 17);
            const Bytes without = compact(mesh, options);
            options.table = &hmesh::compact_photographs;
            const Bytes with = compact(mesh, options);
            CHECK(with != without);
            CHECK(with[is_bare ? 0 : 5] == without[is_bare ? 0 : 5] + (is_bare ? 64 : 2));
            const auto read_with = [&](const Bytes& bytes, const CompactTable* table) {
                return is_bare ? read_bare(bytes, table) : read(bytes, table);
            };
            const CompactMesh got = read_with(with, options.table), plain = read_with(without, options.table);
            REQUIRE(got.status);
            REQUIRE(plain.status);
            CHECK(got.mesh.positions == plain.mesh.positions);
            CHECK(got.mesh.faces == plain.mesh.faces);
            // Which coarse colours are chosen depends on what their bits cost.
            options.color_step = 0;
            const Mesh exact = read_with(compact(mesh, options), options.table).mesh;
            options.table = nullptr;
            CHECK(exact.colors == read_with(compact(mesh, options), nullptr).mesh.colors);
            const CompactMesh refused = read_with(with, nullptr);
            CHECK(refused.status.code == Errc::invalid_argument);
            CHECK(std::string(hmesh::message(refused.status).c_str()) ==
                  "the compact mesh begins with a start table that its reader was not given, number (2)");
            const CompactMesh older = read_with(with, &hmesh::compact_photographs_1);
            CHECK(std::string(hmesh::message(older.status).c_str()) ==
                  "the compact mesh begins with a start table that its reader was not given, number (2, limit 1)");
            // Files of the table before are read with this one.
            options.table = &hmesh::compact_photographs_1;
            const Bytes of_before = compact(mesh, options);
            CHECK(of_before[is_bare ? 0 : 5] == without[is_bare ? 0 : 5] + (is_bare ? 32 : 1));
            CHECK(of_before.size() != with.size());
            const CompactMesh before = read_with(of_before, &hmesh::compact_photographs);
            REQUIRE(before.status);
            CHECK(before.mesh.colors == exact.colors);
        }
}

TEST_CASE("a start table of any text is read to its end") {
    const Mesh mesh = random_mesh({80, 60, 256, 40, 0, 60, 3, 0}, 18);
    hmesh::kit::Random random(4);
    std::vector<std::string> texts{"", "#", "##", "Q", "?", "#\\", "#~", "~~~~~~~~~~~~~~~~~~~~~~#~", "\n#O"};
    for (int k = 0; k < 100; ++k) {
        std::string text;
        for (std::size_t size = random.below(300); size > 0; --size) text += static_cast<char>(1 + random.below(255));
        texts.push_back(text);
    }
    for (const std::string& text : texts) {
        CAPTURE(text);
        for (const CompactTable* const kind : {&hmesh::compact_photographs, &hmesh::compact_photographs_1}) {
            const CompactTable table{6, kind->code, text.c_str(), text.c_str()};
            CompactOptions options;
            options.table = &table;
            const CompactMesh got = read(compact(mesh, options), &table);
            REQUIRE(got.status);
            CHECK(got.mesh.face_count() == mesh.face_count());
        }
    }
    for (const int number : {-1, 0, 7}) {
        const CompactTable table{number, hmesh::compact_photographs.code};
        CompactOptions options;
        options.table = &table;
        CHECK(refusal(mesh, options).code == Errc::invalid_argument);
    }
    for (int symbol = 0; symbol < 90; ++symbol)
        CHECK(hmesh::detail::TableText::symbol(hmesh::detail::TableText::character(symbol)) == symbol);
}

// Any bit where HMESH_TEST_ROUNDS is in the environment, else every 17th.
TEST_CASE("of files of every profile, cut anywhere or with any bit turned, what passes is a valid mesh") {
    for (const char* const name :
         {"rgb", "gray", "holes", "wide", "bare", "coarse", "coarse_bare", "table", "table_bare", "table_2", "table_2_bare"}) {
        CAPTURE(name);
        std::ifstream file(std::string(HMESH_TEST_SOURCE) + "/golden/compact/" + name + ".hmc", std::ios::binary);
        const Bytes whole{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
        REQUIRE(!whole.empty());
        const bool is_bare = std::string(name).find("bare") != std::string::npos;
        const auto look = [&](Bytes bytes) {
            const CompactTable* const table = &hmesh::compact_photographs;
            if (!is_bare) {
                CHECK(!read(bytes, table).status);
                seal(bytes);
            }
            const CompactMesh got = is_bare ? read_bare(bytes, table) : read(bytes, table);
            CHECK((got.status ? is_tiling(got.mesh) : got.mesh.faces.empty() && got.mesh.positions.empty()));
        };
        for (std::size_t size = 0; size < whole.size(); size += hmesh_test::stride_if_sanitized(5))
            look({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)});
        const std::size_t step = std::getenv("HMESH_TEST_ROUNDS") != nullptr ? 1 : hmesh_test::sanitized ? 41 : 17;
        for (std::size_t bit = 0; bit < 8 * whole.size(); bit += step) {
            // Bits of the size and the checksum are put right again by seal(), and then the file is whole.
            Bytes turned = whole;
            turned[bit / 8] = static_cast<unsigned char>(turned[bit / 8] ^ 1U << (bit % 8));
            look(std::move(turned));
        }
    }
}

TEST_CASE("heads that this version does not write are refused") {
    const Bytes whole = compact(random_mesh({}, 6));
    const auto status = [&](std::size_t at, unsigned char value) {
        Bytes changed = whole;
        changed[at] = value;
        seal(changed);
        return read(changed).status;
    };
    CHECK(status(14, whole[14]));
    CHECK(!status(4, 2));                                             // another version
    CHECK(!status(5, 1));                                             // a start table that it did not begin with
    CHECK(!status(5, 7));                                             // one that there cannot be
    CHECK(!status(14, static_cast<unsigned char>(whole[14] | 12U)));  // a kind of colours
    for (unsigned bit = 3; bit < 8; ++bit) CHECK(!status(15, static_cast<unsigned char>(whole[15] | 1U << bit)));
    CHECK(!status(16, 0));  // a width
    CHECK(!status(18, 0));  // a step
}

namespace {

// As heads have numbers.
Bytes varint(std::uint32_t value) {
    Bytes bytes;
    for (; value > 127; value >>= 7) bytes.push_back(static_cast<unsigned char>((value & 0x7fU) | 0x80U));
    bytes.push_back(static_cast<unsigned char>(value));
    return bytes;
}

bool says(const hmesh::Status& status, const char* words) { return std::string(status.what).find(words) != std::string::npos; }

}  // namespace

TEST_CASE("what the bare profile does not say is refused, and what it says wrongly") {
    CompactOptions options;
    options.bare = true;
    const Mesh good = hmesh_test::two_faces(3);
    const auto refused = [&](auto&& spoil) {
        Mesh mesh = good;
        spoil(mesh);
        return refusal(mesh, options).code == Errc::invalid_argument;
    };
    CHECK(refused([](Mesh& m) { m.peak = 254; }));
    CHECK(refused([](Mesh& m) { m.periodic = hmesh::Periodic::x, m.colors.assign(12, 5); }));
    CHECK(refused([](Mesh& m) { m.faces.pop_back(), m.positions.resize(6), m.colors.resize(9); }));
    CHECK(refused([](Mesh& m) {
        m.samples = hmesh::Samples::points;
        m.positions = {0, 0, 2, 0, 2, 1, 0, 1};
    }));
    options.colors = CompactColors::bits16;
    CHECK(refused([](Mesh& /*m*/) {}));
    options.colors = CompactColors::bits8;
    for (const bool is : {false, true}) {
        Mesh mesh = good;
        mesh.channels = 2;
        mesh.colors.resize(8);
        options.linear = is;
        mesh.premultiplied = !is;
        const CompactMesh back = read_bare(compact(mesh, options));
        REQUIRE(back.status);
        CHECK(back.linear == is);
        CHECK(back.mesh.premultiplied == !is);
    }
    options.linear = false;
    const Bytes whole = compact(good, options);
    REQUIRE(whole[1] == 3);  // first come the kind, the sides, the lattice and the step of colours, of a byte each
    const auto status = [&](std::size_t at, const Bytes& in_place_of_one) {
        Bytes changed = whole;
        changed.insert(changed.erase(changed.begin() + static_cast<std::ptrdiff_t>(at)), in_place_of_one.begin(),
                       in_place_of_one.end());
        return read_bare(changed).status;
    };
    CHECK(status(1, {3}));
    for (const unsigned kind : {0U, 15U}) {
        const hmesh::Status other = status(0, {static_cast<unsigned char>((kind << 4 | (whole[0] & 15U)) & 0xffU)});
        CHECK(says(other, "no bare compact mesh of a version known"));
        CHECK(other.value == kind);
    }
    for (const std::size_t side : {1U, 2U})
        for (const std::uint32_t none : {0U, 65537U}) {
            CHECK(says(status(side, varint(none)), "sides of 1 to 65536 px"));
            CHECK(status(side, varint(none)).value == none);
        }
    for (const std::uint32_t side : {1U, 65536U}) CHECK(!says(status(1, varint(side)), "sides of"));
    for (const std::uint32_t none : {0U, 65537U}) CHECK(says(status(3, varint(none)), "a lattice of 1 to 65536 px"));
    CHECK(!says(status(3, varint(65536)), "a lattice of"));
    CHECK(says(status(4, varint(4096)), "too large a step of colours"));
    CHECK(!says(status(4, varint(4095)), "too large a step of colours"));
    for (std::size_t size = 3; size < 5; ++size)
        CHECK(
            says(read_bare(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size))).status, "ends in its head"));
}

TEST_CASE("frames that this version does not write are refused") {
    Mesh mesh = hmesh_test::two_faces(3);  // one period of x, whose sides are a zigzag: from -1 to 4 px, and from 0 to 2
    mesh.periodic = hmesh::Periodic::x;
    mesh.positions = {-1, 0, 2, 0, 4, 1, 1, 1, -1, 2, 2, 2};
    mesh.colors.assign(18, 7);
    mesh.faces = {{0, 1, 3}, {1, 2, 3}, {3, 5, 4}, {3, 2, 5}};
    const Bytes whole = compact(mesh);
    const auto frame = [](std::int64_t left, std::int64_t top, std::uint32_t width, std::uint32_t height) {
        Bytes bytes;
        for (const std::int64_t at : {left, top}) {
            const Bytes number = varint(static_cast<std::uint32_t>(at < 0 ? -2 * at - 1 : 2 * at));
            bytes.insert(bytes.end(), number.begin(), number.end());
        }
        for (const std::uint32_t side : {width, height}) {
            const Bytes number = varint(side);
            bytes.insert(bytes.end(), number.begin(), number.end());
        }
        return bytes;
    };
    const Bytes written = frame(-256, 0, 1280, 512);
    const auto place = std::search(whole.begin(), whole.end(), written.begin(), written.end());
    REQUIRE(place != whole.end());
    const auto status = [&](const Bytes& other, unsigned char periodic) {
        Bytes changed(whole.begin(), place);
        changed[15] = static_cast<unsigned char>((changed[15] & 0xfcU) | periodic);
        changed.insert(changed.end(), other.begin(), other.end());
        changed.insert(changed.end(), place + static_cast<std::ptrdiff_t>(written.size()), whole.end());
        seal(changed);
        return read(changed).status;
    };
    constexpr std::uint32_t most = 1U << 25;
    constexpr std::int64_t furthest = most;
    const char* const words = "frame has no size, is too large, or is not that of a periodic mesh";
    CHECK(status(written, 1));
    CHECK(says(status(written, 0), words));
    CHECK(says(status(frame(0, 0, 768, 512), 1), words));  // the image's, which is not told
    for (const Bytes& other : {frame(0, 0, 0, 512), frame(0, 0, 1280, 0), frame(0, 0, most + 1, 512), frame(0, 0, 1280, most + 1),
                               frame(-furthest - 1, 0, 1280, 512), frame(furthest + 1, 0, 1280, 512),
                               frame(0, -furthest - 1, 1280, 512), frame(0, furthest + 1, 1280, 512)})
        CHECK(says(status(other, 1), words));
    for (const Bytes& other : {frame(0, 0, 1, 512), frame(0, 0, 1280, 1), frame(0, 0, most, 512), frame(0, 0, 1280, most),
                               frame(-furthest, 0, 1280, 512), frame(furthest, 0, 1280, 512), frame(0, -furthest, 1280, 512),
                               frame(0, furthest, 1280, 512)})
        CHECK(!says(status(other, 1), words));
}

TEST_CASE("numbers in a head that this version does not write are refused") {
    const Bytes whole = compact(random_mesh({}, 6));  // of 16 x 16 px; each number is a byte
    REQUIRE(whole[16] == 16);
    const auto status = [&](std::size_t at, const Bytes& in_place_of_one, unsigned first_flags = 0) {
        Bytes changed = whole;
        changed[14] = static_cast<unsigned char>(changed[14] | first_flags);
        const auto place = changed.erase(changed.begin() + static_cast<std::ptrdiff_t>(at));
        changed.insert(place, in_place_of_one.begin(), in_place_of_one.end());
        seal(changed);
        return read(changed).status;
    };
    CHECK(status(16, varint(16)));
    CHECK(!status(16, {16 | 0x80, 0}));                  // longer than it need be
    CHECK(!status(19, {0x80, 0x80, 0x80, 0x80, 0x10}));  // 2^32, whose lower bits are those of 0
    CHECK(!status(19, {0x80, 0x80, 0x80, 0x80, 0x80, 0}));
    for (const std::size_t side : {16U, 17U}) {
        CHECK(status(side, varint(65537)).value == 65537);
        CHECK(status(side, varint(65537)).limit == 65536);
        CHECK(status(side, {1}, 32).limit == 2);  // of points
    }
    CHECK(status(18, varint((1U << 25) + 1)).value == (1 << 25) + 1);
    CHECK(!says(status(18, varint(1U << 25)), "lattice must have"));
    CHECK(status(19, varint(4096)).value == 4096);
    CHECK(!says(status(19, varint(4095)), "a step that they cannot have"));
    CHECK(says(status(19, {1}, 4), "a step that they cannot have"));  // of 16 bits
    CHECK(says(status(14, {12}), "what this version does not know"));
    for (std::size_t size = 14; size < 20; ++size) {
        Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
        seal(cut);
        CHECK(!read(cut).status);
    }
    const auto peak = [&](double value) {
        std::uint64_t bits = 0;
        std::memcpy(&bits, &value, 8);
        Bytes bytes{whole[19]};
        for (unsigned k = 0; k < 8; ++k) bytes.push_back(static_cast<unsigned char>(bits >> (8 * k) & 0xffU));
        return status(19, bytes, 128);
    };
    CHECK(peak(254));
    for (const double none :
         {0.0, -1.0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN(), 255.0})
        CHECK(peak(none).code == Errc::invalid_argument);
}

namespace {

// What a mesh holds as whole numbers: positions in 1/256 px, then colours; then faces.
std::string numbers_of(const Mesh& mesh) {
    std::ostringstream text;
    text << mesh.width << ' ' << mesh.height << ' ' << mesh.channels << '\n' << mesh.vertex_count() << '\n';
    const auto channels = static_cast<std::size_t>(mesh.channels);
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
        text << static_cast<std::int64_t>(256 * static_cast<double>(mesh.positions[2 * v])) << ' '
             << static_cast<std::int64_t>(256 * static_cast<double>(mesh.positions[2 * v + 1]));
        for (std::size_t c = 0; c < channels; ++c) text << ' ' << static_cast<std::int64_t>(mesh.colors[channels * v + c]);
        text << '\n';
    }
    text << mesh.face_count() << '\n';
    for (const hmesh::Triangle& face : mesh.faces) text << face[0] << ' ' << face[1] << ' ' << face[2] << '\n';
    return text.str();
}
template <class Content>
Content content_of(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

}  // namespace

// Colours were chosen otherwise then; what is read of them stays for ever.
TEST_CASE("files of former writers are read as ever") {
    for (const std::string name : {"first_coarse", "first_coarse_bare", "first_table", "first_table_bare"}) {
        const std::string path = std::string(HMESH_TEST_SOURCE) + "/golden/compact/" + name;
        CAPTURE(path);
        const auto held = content_of<Bytes>(path + ".hmc");
        const CompactTable* const table = name.find("table") == std::string::npos ? nullptr : &hmesh::compact_photographs;
        const CompactMesh got = name.find("bare") != std::string::npos ? read_bare(held, table) : read(held, table);
        REQUIRE(got.status);
        CHECK(numbers_of(got.mesh) == content_of<std::string>(path + ".txt"));
    }
}

TEST_CASE("compact files and what is read of them are those of yesterday") {
    const bool renews = std::getenv("HMESH_RENEW_GOLDEN") != nullptr;
    const std::pair<const char*, MeshKind> files[] = {{"rgb", {96, 64, 1, 40, 0, 60, 3, 0}},
                                                      {"gray", {16, 16, 64, 20, 0, 0, 1, 0}},
                                                      {"holes", {96, 64, 16, 40, 0, 90, 4, 0.25}},
                                                      {"wide", {65536, 2, 1, 30, 2, 90, 2, 0}},
                                                      {"bare", {40, 30, 256, 40, 0, 60, 3, 0}},
                                                      {"coarse", {96, 64, 256, 60, 0, 60, 3, 0}},
                                                      {"coarse_bare", {400, 300, 512, 60, 0, 60, 4, 0}},
                                                      {"table", {96, 64, 256, 60, 0, 60, 3, 0}},
                                                      {"table_bare", {400, 300, 512, 60, 0, 60, 4, 0}},
                                                      {"table_2", {96, 64, 256, 60, 0, 60, 3, 0}},
                                                      {"table_2_bare", {400, 300, 512, 60, 0, 60, 4, 0}},
                                                      {"table_2_gray", {96, 64, 16, 60, 0, 60, 2, 0.25}}};
    std::uint64_t seed = 40;
    for (const auto& [name, kind] : files) {
        const std::string path = std::string(HMESH_TEST_SOURCE) + "/golden/compact/" + name;
        CAPTURE(path);
        CompactOptions options;
        options.bare = std::string(name).find("bare") != std::string::npos;
        if (std::string(name).find("coarse") == 0) options.color_step = 90;
        if (std::string(name).find("table") == 0) {
            const bool is_second = std::string(name).find("table_2") == 0;
            options.color_step = is_second && kind.channels == 2 ? 0 : 120;
            options.table = is_second ? &hmesh::compact_photographs : &hmesh::compact_photographs_1;
        }
        const Bytes written = compact(random_mesh(kind, ++seed), options);
        if (renews)
            std::ofstream(path + ".hmc", std::ios::binary)
                .write(reinterpret_cast<const char*>(written.data()), static_cast<std::streamsize>(written.size()));
        const auto held = content_of<Bytes>(path + ".hmc");
        CHECK(written == held);
        const CompactMesh got = options.bare ? read_bare(held, options.table) : read(held, options.table);
        REQUIRE(got.status);
        const std::string text = numbers_of(got.mesh);
        if (renews) std::ofstream(path + ".txt") << text;
        CHECK(text == content_of<std::string>(path + ".txt"));
    }
}
