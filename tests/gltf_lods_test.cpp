#include "hmesh/io/gltf_lods.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "test_exports.hpp"

namespace {

using hmesh::GltfOptions;
using hmesh::Mesh;
using hmesh::MeshView;
using hmesh_test::Bytes;
using hmesh_test::square_grid;
using hmesh_test::two_faces;
using Levels = std::vector<MeshView>;

// The chunks of a .glb file without their padding.
struct Chunks {
    std::string json;
    Bytes binary;
};

std::uint32_t word_at(const Bytes& bytes, std::size_t at) { return hmesh_test::number_at<std::uint32_t>(bytes, at); }

Chunks chunks_of(const Bytes& bytes) {
    Chunks chunks;
    REQUIRE(std::memcmp(bytes.data(), "glTF", 4) == 0);
    REQUIRE(word_at(bytes, 8) == bytes.size());
    const std::size_t json = word_at(bytes, 12);
    chunks.json.assign(bytes.begin() + 20, bytes.begin() + 20 + static_cast<std::ptrdiff_t>(json));
    chunks.binary.assign(bytes.begin() + 28 + static_cast<std::ptrdiff_t>(json), bytes.end());
    REQUIRE(word_at(bytes, 20 + json) == chunks.binary.size());
    return chunks;
}

Chunks written(const Levels& levels, const GltfOptions& options = {}) {
    Bytes bytes;
    const auto sink = hmesh::kit::append_to(bytes);
    REQUIRE(hmesh::write_glb_lods(levels, sink, options));
    return chunks_of(bytes);
}
Chunks written_alone(const MeshView& mesh, const GltfOptions& options = {}) {
    Bytes bytes;
    const auto sink = hmesh::kit::append_to(bytes);
    REQUIRE(hmesh::write_glb(mesh, sink, options));
    return chunks_of(bytes);
}

std::size_t count(const std::string& text, const std::string& words) {
    std::size_t found = 0;
    for (std::size_t at = 0; (at = text.find(words, at)) != std::string::npos; at += words.size()) ++found;
    return found;
}

void append(Bytes& to, const Bytes& from) { to.insert(to.end(), from.begin(), from.end()); }

// The grid over a picture of one size, whatever its squares.
Mesh grid(int cells) {
    Mesh mesh = square_grid(cells, cells);
    for (float& x : mesh.positions) x *= 64.0F / static_cast<float>(cells);
    mesh.width = mesh.height = 64;
    return mesh;
}

void check_refused(const Levels& levels, const char* words, const GltfOptions& options = {}) {
    Bytes bytes;
    const auto sink = hmesh::kit::append_to(bytes);
    const hmesh::Status status = hmesh::write_glb_lods(levels, sink, options);
    CHECK(!status);
    CHECK(std::string(status.what).find(words) != std::string::npos);
    CHECK(bytes.empty());
}

}  // namespace

TEST_CASE("levels are nodes of one file, of which the scene shows the finest, with the arrays that files of their own have") {
    const Mesh meshes[] = {grid(8), grid(4), grid(2)};  // 81, 25 and 9 vertices
    for (const bool quantized : {false, true}) {
        GltfOptions options;
        options.quantized_positions = quantized;
        const Chunks file = written({meshes[0].view(), meshes[1].view(), meshes[2].view()}, options);
        Bytes all;
        for (const Mesh& mesh : meshes) append(all, written_alone(mesh.view(), options).binary);
        CHECK(file.binary == all);
        CHECK(count(file.json, "\"scenes\":[{\"nodes\":[0]}]") == 1);
        CHECK(count(file.json, "\"extensions\":{\"MSFT_lod\":{\"ids\":[1,2]}}") == 1);
        CHECK(count(file.json, "\"MSFT_lod\"") == 2);                                  // and among those used
        CHECK(count(file.json, "\"extras\":{\"MSFT_screencoverage\":[0.30864") == 1);  // 25 / 81
        CHECK(count(file.json, "\"extensionsRequired\":[\"KHR_mesh_quantization\"]") == (quantized ? 1 : 0));
        for (const char* mesh : {"\"mesh\":0", "\"mesh\":1", "\"mesh\":2"}) CHECK(count(file.json, mesh) == 1);
        CHECK(count(file.json, "\"attributes\":{\"POSITION\":0,\"COLOR_0\":1},\"indices\":2,\"material\":0") == 1);
        CHECK(count(file.json, "\"attributes\":{\"POSITION\":6,\"COLOR_0\":7},\"indices\":8,\"material\":0") == 1);
        CHECK(count(file.json, "\"count\":25") == 2);
        CHECK(count(file.json, "KHR_materials_unlit\":{}") == 1);
    }
}

TEST_CASE("levels over one vertex buffer share its arrays") {
    const Mesh finest = grid(8);
    const std::vector<hmesh::Triangle> corners = {{0, 1, 2}};
    MeshView level = finest.view();
    level.vertex_count = 3;
    level.faces = corners.data();
    level.face_count = 1;
    const Chunks file = written({finest.view(), level});
    Bytes all = written_alone(finest.view()).binary;
    append(all, {0, 0, 2, 0, 1, 0, 0, 0});  // counter-clockwise, and padding
    CHECK(file.binary == all);
    CHECK(count(file.json, "\"attributes\":{\"POSITION\":0,\"COLOR_0\":1},\"indices\":3,\"material\":0") == 1);
}

TEST_CASE("one level is the file that write_glb() writes") {
    const Mesh mesh = grid(4);
    const Chunks file = written({mesh.view()}), alone = written_alone(mesh.view());
    CHECK(file.json == alone.json);
    CHECK(file.binary == alone.binary);
}

TEST_CASE("one level of nothing is the empty scene that write_glb() writes") {
    Mesh none = grid(4);
    none.positions.clear(), none.colors.clear(), none.faces.clear();
    std::string file, alone;
    CHECK(hmesh::write_glb_lods({none.view()}, hmesh::kit::append_to(file)));
    CHECK(hmesh::write_glb(none.view(), hmesh::kit::append_to(alone)));
    CHECK(!file.empty());
    CHECK(file == alone);
}

TEST_CASE("a level in parts is one mesh of several primitives, whose positions lie on one grid") {
    const Mesh whole = grid(8), coarse = grid(2);
    Mesh left = whole, right = whole;  // without unused vertices
    left.faces.clear(), right.faces.clear(), right.positions.clear(), right.colors.clear();
    for (const hmesh::Triangle& face : whole.faces) {
        const bool is_low = face[0] < 45 && face[1] < 45 && face[2] < 45;  // the upper four rows
        if (is_low) left.faces.push_back(face);
        else right.faces.push_back({face[0] - 36, face[1] - 36, face[2] - 36});
    }
    left.positions.resize(2 * 45), left.colors.resize(3 * 45);
    right.positions.assign(whole.positions.begin() + 2 * 36, whole.positions.end());
    right.colors.assign(whole.colors.begin() + 3 * 36, whole.colors.end());
    GltfOptions options;
    options.quantized_positions = true;
    Bytes bytes;
    const auto sink = hmesh::kit::append_to(bytes);
    REQUIRE(hmesh::write_glb_parts({{left.view(), right.view()}, {coarse.view()}}, sink, options));
    const Chunks file = chunks_of(bytes);
    CHECK(count(file.json,
                "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"COLOR_0\":1},\"indices\":2,\"material\":0},"
                "{\"attributes\":{\"POSITION\":3,\"COLOR_0\":4},\"indices\":5,\"material\":0}]},{") == 1);
    CHECK(count(file.json, "\"mesh\":") == 2);
    CHECK(count(file.json, "\"count\":45,\"type\":\"VEC3\",\"min\":[0,32,0],\"max\":[64,64,0]") == 1);
    CHECK(count(file.json, "\"count\":45,\"type\":\"VEC3\",\"min\":[0,0,0],\"max\":[64,32,0]") == 1);
    const std::size_t part = 45 * 16 + 6 * left.faces.size();
    for (std::size_t v = 0; v < 45; ++v) {
        CHECK((word_at(file.binary, 8 * v) >> 16U) == static_cast<std::uint32_t>(64 - left.positions[2 * v + 1]));
        CHECK((word_at(file.binary, part + 8 * v) >> 16U) == static_cast<std::uint32_t>(64 - right.positions[2 * v + 1]));
    }

    bytes.clear();
    REQUIRE(hmesh::write_glb_parts({{left.view(), right.view()}, {coarse.view()}}, sink));
    Bytes all = written_alone(left.view()).binary;
    append(all, written_alone(right.view()).binary);
    append(all, written_alone(coarse.view()).binary);
    CHECK(chunks_of(bytes).binary == all);

    bytes.clear();
    CHECK(!hmesh::write_glb_parts({{left.view(), right.view()}, {}}, sink));
    CHECK(!hmesh::write_glb_parts({{left.view(), square_grid(3, 3).view()}}, sink));
    CHECK(bytes.empty());
}

TEST_CASE("levels with alpha are divided by it each, and drawn over what is behind") {
    Mesh fine = two_faces(4), coarse = two_faces(4);
    fine.premultiplied = coarse.premultiplied = true;
    fine.positions.insert(fine.positions.end(), {1, 1});
    fine.colors.insert(fine.colors.end(), {1, 2, 3, 4});
    fine.faces = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
    const Chunks file = written({fine.view(), coarse.view()});
    Bytes all = written_alone(fine.view()).binary;
    append(all, written_alone(coarse.view()).binary);
    CHECK(file.binary == all);
    CHECK(count(file.json, "\"alphaMode\":\"BLEND\"") == 1);
}

TEST_CASE("a level that shares positions and not colours has its own") {
    const Mesh fine = grid(4);
    std::vector<float> colors = fine.colors;
    for (float& color : colors) color = 1 - color;
    MeshView coarse = fine.view();
    coarse.vertex_count = 24, coarse.face_count = 1;  // of the first three corners
    coarse.colors = colors.data();
    Bytes all = written_alone(fine.view()).binary;
    append(all, written_alone(coarse).binary);
    CHECK(written({fine.view(), coarse}).binary == all);
}

TEST_CASE("a compressor is given vertices and indices of all levels") {
    const Mesh fine = grid(4), coarse = grid(2);
    std::size_t arrays = 0, elements = 0;
    const auto compress = [&](const hmesh::GltfArray& array, std::vector<unsigned char>& out) {
        ++arrays;
        elements += array.count;
        out = {1, 2, 3, 4};
        return true;
    };
    GltfOptions options;
    options.compress = compress;
    const Chunks file = written({fine.view(), coarse.view()}, options);
    CHECK(arrays == 4);
    CHECK(elements == 25 + 3 * 32 + 9 + 3 * 8);
    CHECK(file.binary.size() == 16);
    const auto fail = [](const hmesh::GltfArray& array, std::vector<unsigned char>& out) {
        out = {1};
        return array.count != 3 * 8;  // at the last
    };
    options.compress = fail;
    Bytes bytes;
    CHECK(hmesh::write_glb_lods({fine.view(), coarse.view()}, hmesh::kit::append_to(bytes), options).code ==
          hmesh::Errc::write_failed);
    CHECK(bytes.empty());
}

TEST_CASE("levels that are none are refused with a sentence, before a byte is written") {
    const Mesh fine = grid(4), coarse = grid(2);
    check_refused({}, "no levels");
    check_refused({coarse.view(), fine.view()}, "not fewer vertices");
    check_refused({fine.view(), fine.view()}, "not fewer vertices");
    Mesh other = coarse;
    other.width = 65;
    check_refused({fine.view(), other.view()}, "another size");
    check_refused({fine.view(), two_faces(4).view()}, "another size");
    other = coarse;
    other.height = 63;
    check_refused({fine.view(), other.view()}, "another size");
    MeshView view = coarse.view();
    view.samples = hmesh::Samples::points;
    check_refused({fine.view(), view}, "another size");
    view = coarse.view();
    view.premultiplied = true;
    check_refused({fine.view(), view}, "other channels");
    other = coarse;
    other.channels = 1;
    check_refused({fine.view(), other.view()}, "other channels");
    other = coarse;
    other.faces[0][1] = 9;
    check_refused({fine.view(), other.view()}, "names no vertex");
    Mesh none = coarse;
    none.positions.clear(), none.colors.clear(), none.faces.clear();
    check_refused({fine.view(), none.view()}, "without vertices");
    check_refused({none.view(), none.view()}, "without vertices");
    hmesh::GltfOptions options;
    options.longer_side = -1;
    check_refused({fine.view(), coarse.view()}, "longer side", options);
    const hmesh::Status status =
        hmesh::write_glb_lods({fine.view(), coarse.view()}, [](const void*, std::size_t) { return false; });
    CHECK(status.code == hmesh::Errc::write_failed);
}
