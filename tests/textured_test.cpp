#include "hmesh/io/textured.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <string>
#include <vector>

#include "test_exports.hpp"

namespace {

using hmesh_test::Bytes;
using hmesh_test::number_at;

const auto to_obj = [](const hmesh::MeshView& mesh, hmesh::Sink sink) {
    return hmesh::write_textured_obj(mesh, "a b.mtl", sink);
};
const auto to_ply = [](const hmesh::MeshView& mesh, hmesh::Sink sink) { return hmesh::write_textured_ply(mesh, "b.png", sink); };
const auto to_glb = [](const hmesh::MeshView& mesh, hmesh::Sink sink) { return hmesh::write_textured_glb(mesh, "b.png", sink); };

// The first number after "key": and an open bracket, if there is one.
double number_of(const std::string& json, const std::string& key, int n = 0) {
    std::size_t at = json.find("\"" + key + "\":");
    for (; n > 0 && at != std::string::npos; --n) at = json.find("\"" + key + "\":", at + 1);
    REQUIRE(at != std::string::npos);
    const char* from = json.c_str() + at + key.size() + 3;
    return std::strtod(from + (*from == '[' ? 1 : 0), nullptr);
}

}  // namespace

TEST_CASE("an OBJ has positions and coordinates y up, by one index, and names its material") {
    const std::string text = hmesh_test::as_text(hmesh_test::exported(hmesh_test::two_faces(1).view(), to_obj));
    CHECK(text == "# made by hmesh " HMESH_VERSION_STRING
                  "\nmtllib a b.mtl\nusemtl image\nv 0 2 0\nv 3 2 0\nv 3 0 0\nv 0 0 0\nvt 0 1\nvt 1 1\nvt 1 0\nvt 0 0\n"
                  "f 1/1 3/3 2/2\nf 1/1 4/4 3/3\n");
    const auto bare = [](const hmesh::MeshView& mesh, hmesh::Sink sink) {
        return hmesh::write_textured_obj(mesh, nullptr, sink);
    };
    CHECK(hmesh_test::as_text(hmesh_test::exported(hmesh_test::two_faces(1).view(), bare)).find("mtl") == std::string::npos);
    std::string material;
    CHECK(hmesh::write_material("icon.png", hmesh::kit::append_to(material)));
    CHECK(material == "# made by hmesh " HMESH_VERSION_STRING
                      "\nnewmtl image\nKd 1 1 1\nillum 0\nmap_Kd -clamp on icon.png\nmap_d -clamp on -imfchan m icon.png\n");
}

TEST_CASE("a PLY has s and t beside positions, and the texture's name as a comment") {
    const hmesh::Mesh mesh = hmesh_test::square_grid(5, 3);
    const Bytes bytes = hmesh_test::exported(mesh.view(), to_ply);
    const std::string text = hmesh_test::as_text(bytes);
    CHECK(text.find("\ncomment TextureFile b.png\n") != std::string::npos);
    CHECK(text.find("property float x\nproperty float y\nproperty float z\nproperty float s\nproperty float t\n") !=
          std::string::npos);
    const std::size_t at = text.find("end_header\n") + 11;
    REQUIRE(bytes.size() == at + 20 * mesh.vertex_count() + 13 * mesh.face_count());
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
        const auto number = [&](std::size_t k) { return number_at<float>(bytes, at + 20 * v + 4 * k); };
        CHECK(number(0) == mesh.positions[2 * v]);
        CHECK(number(1) == 3 - mesh.positions[2 * v + 1]);
        CHECK(number(2) == 0);
        CHECK(number(3) == mesh.positions[2 * v] / 5);
        CHECK(number(4) == doctest::Approx(static_cast<double>(number(1)) / 3));
    }
    const std::size_t faces_at = at + 20 * mesh.vertex_count();
    CHECK(bytes[faces_at] == 3);
    CHECK(number_at<std::uint32_t>(bytes, faces_at + 1) == mesh.faces[0][0]);
    CHECK(number_at<std::uint32_t>(bytes, faces_at + 5) == mesh.faces[0][2]);
}

TEST_CASE("a .glb has coordinates with v down, and the texture's name as a URI") {
    const hmesh::Mesh mesh = hmesh_test::square_grid(4, 3);
    const auto named = [](const hmesh::MeshView& view, hmesh::Sink sink) {
        return hmesh::write_textured_glb(view, "../aA9zZ0-.~ \"@[`{/:\"_\xc3\xa9.png", sink);
    };
    const Bytes bytes = hmesh_test::exported(mesh.view(), named);
    CHECK(std::memcmp(bytes.data(), "glTF", 4) == 0);
    CHECK(number_at<std::uint32_t>(bytes, 8) == bytes.size());
    const std::size_t json_size = number_at<std::uint32_t>(bytes, 12), at = 28 + json_size;
    const std::string json(bytes.begin() + 20, bytes.begin() + 20 + static_cast<std::ptrdiff_t>(json_size));
    CHECK(json.find("\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0},\"metallicFactor\":0,"
                    "\"roughnessFactor\":1},\"alphaMode\":\"BLEND\",\"extensions\":{\"KHR_materials_unlit\":{}}}],"
                    "\"samplers\":[{\"magFilter\":9729,\"minFilter\":9729,\"wrapS\":33071,\"wrapT\":33071}],"
                    "\"textures\":[{\"sampler\":0,\"source\":0}],\"images\":[{\"uri\":"
                    "\"../aA9zZ0-.~%20%22%40%5B%60%7B/%3A%22_%C3%A9.png\"}]") != std::string::npos);
    CHECK(number_of(json, "scale") == 0.25);
    CHECK(json.find("\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":1},\"indices\":2,"
                    "\"material\":0}]}]") != std::string::npos);
    const std::size_t vertices = mesh.vertex_count();
    CHECK(number_of(json, "count", 0) == static_cast<double>(vertices));
    CHECK(number_of(json, "count", 1) == static_cast<double>(vertices));
    CHECK(number_of(json, "count", 2) == 3.0 * static_cast<double>(mesh.face_count()));
    CHECK(number_of(json, "byteOffset", 0) == 12.0 * static_cast<double>(vertices));
    CHECK(number_of(json, "byteOffset", 1) == 20.0 * static_cast<double>(vertices));
    CHECK(number_of(json, "max") == 4);
    CHECK(number_of(json, "min") == 0);
    const double all = 20.0 * static_cast<double>(vertices) + 6.0 * static_cast<double>(mesh.face_count());
    CHECK(number_of(json, "byteLength", 3) == all);
    REQUIRE(bytes.size() >= at + static_cast<std::size_t>(all));
    for (std::size_t v = 0; v < vertices; ++v) {
        CHECK(number_at<float>(bytes, at + 12 * v) == mesh.positions[2 * v]);
        CHECK(number_at<float>(bytes, at + 12 * v + 4) == 3 - mesh.positions[2 * v + 1]);
        CHECK(number_at<float>(bytes, at + 12 * vertices + 8 * v) == mesh.positions[2 * v] / 4);
        CHECK(number_at<float>(bytes, at + 12 * vertices + 8 * v + 4) == mesh.positions[2 * v + 1] / 3);
    }
    CHECK(number_at<std::uint16_t>(bytes, at + 20 * vertices + 2) == mesh.faces[0][2]);
}

TEST_CASE("a mesh of nothing is written as nothing") {
    const auto has_size = [](const Bytes& bytes) { CHECK(!bytes.empty()); };
    hmesh_test::check_empty_meshes(to_obj, has_size);
    hmesh_test::check_empty_meshes(to_ply, has_size);
    hmesh_test::check_empty_meshes(to_glb, [](const Bytes& bytes) {
        CHECK(number_at<std::uint32_t>(bytes, 8) == bytes.size());
        CHECK(hmesh_test::as_text(bytes).find("\"scenes\":[{}]}") != std::string::npos);
    });
}

TEST_CASE("meshes and names that files cannot hold give a Status and no byte, and a sink that refuses is reported") {
    const hmesh::Mesh grid = hmesh_test::square_grid(25, 25);
    for (const hmesh_test::Write write : {hmesh_test::Write(to_obj), hmesh_test::Write(to_ply), hmesh_test::Write(to_glb)}) {
        hmesh_test::check_bad_meshes_are_refused(write);
        hmesh_test::check_refusing_sinks(grid.view(), write);
        hmesh_test::check_locale_makes_no_difference(grid.view(), write);
    }
    const hmesh::Mesh mesh = hmesh_test::two_faces(1);
    Bytes bytes;
    const auto sink = hmesh::kit::append_to(bytes);
    for (const char* bad : {"", "a\nb", "\x01"}) {
        CHECK(hmesh::write_textured_ply(mesh.view(), bad, sink).code == hmesh::Errc::invalid_argument);
        CHECK(hmesh::write_textured_glb(mesh.view(), bad, sink).code == hmesh::Errc::invalid_argument);
        CHECK(hmesh::write_textured_obj(mesh.view(), bad, sink).code == hmesh::Errc::invalid_argument);
        CHECK(hmesh::write_material(bad, sink).code == hmesh::Errc::invalid_argument);
    }
    CHECK(hmesh::write_textured_ply(mesh.view(), nullptr, sink).code == hmesh::Errc::invalid_argument);
    CHECK(hmesh::write_textured_glb(mesh.view(), "a.png", sink, -1).code == hmesh::Errc::invalid_argument);
    CHECK(bytes.empty());
}
