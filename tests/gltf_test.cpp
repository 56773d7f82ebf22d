#include "hmesh/io/gltf.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "test_exports.hpp"

namespace {

using hmesh_test::Bytes;
using hmesh_test::number_at;
using hmesh_test::two_faces;

// An exporter with these options, as test_exports.hpp takes it.
auto with(const hmesh::GltfOptions& options) {
    return [options](const hmesh::MeshView& mesh, hmesh::Sink sink) { return hmesh::write_glb(mesh, sink, options); };
}

hmesh::GltfOptions quantized() {
    hmesh::GltfOptions options;
    options.quantized_positions = true;
    return options;
}

// The numbers after the n-th occurrence of "key": in the JSON, as many as stand between its brackets, or one.
std::vector<double> numbers(const std::string& json, const std::string& key, int n = 0) {
    std::size_t at = json.find("\"" + key + "\":");
    for (; n > 0 && at != std::string::npos; --n) at = json.find("\"" + key + "\":", at + 1);
    REQUIRE(at != std::string::npos);
    const char* from = json.c_str() + at + key.size() + 3;
    std::vector<double> found;
    do {
        char* end = nullptr;
        found.push_back(std::strtod(from + (found.empty() && *from == '[' ? 1 : 0), &end));
        from = end + 1;
    } while (from[-1] == ',' && *from != '"');
    return found;
}

// What a .glb of one mesh holds, read by the glTF specification alone.
struct GlbFile {
    std::string json;
    std::vector<std::array<double, 3>> positions;  // of the node's space: units
    std::vector<std::array<double, 3>> stored;     // of the buffer
    std::vector<std::array<int, 4>> colors;
    std::vector<hmesh::Triangle> faces;
    std::size_t index_size = 0;
};

GlbFile read_glb(const Bytes& bytes) {
    GlbFile file;
    REQUIRE(std::memcmp(bytes.data(), "glTF", 4) == 0);
    REQUIRE(number_at<std::uint32_t>(bytes, 4) == 2);
    REQUIRE(number_at<std::uint32_t>(bytes, 8) == bytes.size());
    const std::size_t json_size = number_at<std::uint32_t>(bytes, 12);
    REQUIRE(json_size % 4 == 0);
    REQUIRE(number_at<std::uint32_t>(bytes, 16) == 0x4e4f534aU);
    file.json.assign(bytes.begin() + 20, bytes.begin() + 20 + static_cast<std::ptrdiff_t>(json_size));
    const std::size_t end = file.json.find_last_not_of(' ') + 1;
    REQUIRE(json_size - end < 4);
    REQUIRE(file.json[end - 1] == '}');
    const std::size_t binary_size = number_at<std::uint32_t>(bytes, 20 + json_size), at = 28 + json_size;
    REQUIRE(binary_size % 4 == 0);
    REQUIRE(number_at<std::uint32_t>(bytes, 24 + json_size) == 0x004e4942U);
    REQUIRE(at + binary_size == bytes.size());

    const auto size = [&](const char* key, int n) { return static_cast<std::size_t>(numbers(file.json, key, n)[0]); };
    const std::size_t buffer_size = size("byteLength", 3);
    REQUIRE(buffer_size <= binary_size);
    REQUIRE(binary_size - buffer_size < 4);
    for (std::size_t i = buffer_size; i < binary_size; ++i) REQUIRE(bytes[at + i] == 0);
    const std::size_t vertices = size("count", 0), corners = size("count", 2);
    REQUIRE(size("count", 1) == vertices);
    const std::size_t stride = size("byteStride", 0);
    const std::size_t colors_at = at + size("byteOffset", 0), indices_at = at + size("byteOffset", 1);
    REQUIRE(size("byteLength", 0) == stride * vertices);
    REQUIRE(size("byteLength", 1) == 8 * vertices);
    REQUIRE(size("byteStride", 1) == 8);
    REQUIRE(colors_at == at + size("byteLength", 0));
    REQUIRE(indices_at == colors_at + size("byteLength", 1));
    REQUIRE(size("byteLength", 0) + size("byteLength", 1) + size("byteLength", 2) == buffer_size);
    const bool floats = size("componentType", 0) == 5126;
    REQUIRE((floats || size("componentType", 0) == 5123));
    const std::vector<double> scale = numbers(file.json, "scale"), translation = numbers(file.json, "translation");
    REQUIRE(scale.size() == 3);
    REQUIRE(translation.size() == 3);
    for (std::size_t v = 0; v < vertices; ++v) {
        file.stored.push_back({}), file.positions.push_back({}), file.colors.push_back({});
        for (std::size_t k = 0; k < 3; ++k) {
            file.stored[v][k] = floats ? static_cast<double>(number_at<float>(bytes, at + stride * v + 4 * k))
                                       : number_at<std::uint16_t>(bytes, at + stride * v + 2 * k);
            file.positions[v][k] = file.stored[v][k] * scale[k] + translation[k];
        }
        for (std::size_t k = 0; k < 4; ++k) file.colors[v][k] = number_at<std::uint16_t>(bytes, colors_at + 8 * v + 2 * k);
    }
    const bool wide = size("componentType", 2) == 5125;
    REQUIRE((wide || size("componentType", 2) == 5123));
    file.index_size = wide ? 4 : 2;
    REQUIRE(size("byteLength", 2) == file.index_size * corners);
    for (std::size_t i = 0; i < corners; ++i) {
        if (i % 3 == 0) file.faces.push_back({});
        const std::size_t from = indices_at + file.index_size * i;
        file.faces.back()[i % 3] = wide ? number_at<std::uint32_t>(bytes, from) : number_at<std::uint16_t>(bytes, from);
    }
    return file;
}

GlbFile read_back(const hmesh::Mesh& mesh, const hmesh::GltfOptions& options = {}) {
    return read_glb(hmesh_test::exported(mesh.view(), with(options)));
}

bool has(const GlbFile& file, const char* words) { return file.json.find(words) != std::string::npos; }

int to_linear_light(double share) {
    const double light = share <= 0.04045 ? share / 12.92 : std::pow((share + 0.055) / 1.055, 2.4);
    return static_cast<int>(std::lround(light * 65535));
}

}  // namespace

TEST_CASE("a mesh of two faces is written as these bytes") {
    hmesh::Mesh mesh = two_faces(3);
    mesh.positions = {0, 0, 3, 0, 3, 2, 0, 1.5F};
    mesh.colors = {0, 128, 255, 1, 2, 3, -5, 300, 10, 11, 254, 99.5F};
    const std::string json =
        "{\"asset\":{\"version\":\"2.0\",\"generator\":\"hmesh " HMESH_VERSION_STRING
        "\"},"
        "\"extensionsUsed\":[\"KHR_materials_unlit\"],\"scene\":0,\"scenes\":[{\"nodes\":[0]}],"
        "\"nodes\":[{\"mesh\":0,\"translation\":[0,0,0],\"scale\":[0.333333333,0.333333333,0.333333333]}],"
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"COLOR_0\":1},\"indices\":2,\"material\":0}]}],"
        "\"materials\":[{\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"roughnessFactor\":1},"
        "\"extensions\":{\"KHR_materials_unlit\":{}}}],"
        "\"accessors\":["
        "{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\",\"min\":[0,0,0],\"max\":[3,2,0]},"
        "{\"bufferView\":1,\"componentType\":5123,\"normalized\":true,\"count\":4,\"type\":\"VEC4\"},"
        "{\"bufferView\":2,\"componentType\":5123,\"count\":6,\"type\":\"SCALAR\"}],"
        "\"bufferViews\":["
        "{\"buffer\":0,\"byteLength\":48,\"byteStride\":12,\"target\":34962},"
        "{\"buffer\":0,\"byteOffset\":48,\"byteLength\":32,\"byteStride\":8,\"target\":34962},"
        "{\"buffer\":0,\"byteOffset\":80,\"byteLength\":12,\"target\":34963}],"
        "\"buffers\":[{\"byteLength\":92}]}";
    const std::string padding((4 - json.size() % 4) % 4, ' ');
    const std::size_t json_size = json.size() + padding.size(), size = 12 + 8 + json_size + 8 + 92;
    const auto low = [](std::size_t value) { return static_cast<unsigned char>(value % 256); };
    Bytes expected = {'g', 'l', 'T', 'F', 2,   0,  0, 0, low(size), low(size / 256), 0, 0, low(json_size), low(json_size / 256),
                      0,   0,   'J', 'S', 'O', 'N'};
    for (const std::string& text : {json, padding}) expected.insert(expected.end(), text.begin(), text.end());
    const Bytes body = {
        92, 0, 0, 0, 'B', 'I', 'N', 0, 0, 0, 0, 0, 0, 0, 0, 0x40, 0, 0, 0, 0,  // (0, 2, 0)
        0, 0, 0x40, 0x40, 0, 0, 0, 0x40, 0, 0, 0, 0,                           // (3, 2, 0)
        0, 0, 0x40, 0x40, 0, 0, 0, 0, 0, 0, 0, 0,                              // (3, 0, 0)
        0, 0, 0, 0, 0, 0, 0, 0x3f, 0, 0, 0, 0,                                 // (0, 0.5, 0)
        // sRGB 0, 128, 255: 0, 14146, 65535; 1, 2, 3: 20, 40, 60; 0, 255, 10: 0, 65535, 199; 11, 254, 99.5: 219, 64952, 8264
        0, 0, 0x42, 0x37, 0xff, 0xff, 0xff, 0xff,    //
        20, 0, 40, 0, 60, 0, 0xff, 0xff,             //
        0, 0, 0xff, 0xff, 199, 0, 0xff, 0xff,        //
        219, 0, 0xb8, 0xfd, 0x48, 0x20, 0xff, 0xff,  //
        0, 0, 2, 0, 1, 0,                            //
        0, 0, 3, 0, 2, 0,                            //
    };
    expected.insert(expected.end(), body.begin(), body.end());
    CHECK(hmesh_test::exported(mesh.view(), with({})) == expected);
}

TEST_CASE("what is read back is the mesh with y up, counter-clockwise, in linear light") {
    hmesh::Mesh mesh = hmesh_test::square_grid(20, 12);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)  // any numbers on the 1/256 px grid
        mesh.positions[i] += static_cast<float>(i * 37 % 64) / 256;
    for (std::size_t i = 0; i < mesh.colors.size(); ++i) mesh.colors[i] = static_cast<float>(i % 131) / 100 - 0.1F;
    for (const bool is_quantized : {false, true}) {
        hmesh::GltfOptions options;
        options.longer_side = 0;
        options.quantized_positions = is_quantized;
        const GlbFile file = read_back(mesh, options);
        REQUIRE(file.positions.size() == mesh.vertex_count());
        REQUIRE(file.faces.size() == mesh.face_count());
        std::array<double, 3> least{1e9, 1e9, 1e9}, most{-1e9, -1e9, -1e9};
        for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
            const auto x = static_cast<double>(mesh.positions[2 * v]), y = static_cast<double>(mesh.positions[2 * v + 1]);
            CHECK(file.positions[v] == std::array<double, 3>{x, 12 - y, 0});
            for (std::size_t k = 0; k < 3; ++k) {
                const double share = std::max(0.0, std::min(1.0, static_cast<double>(mesh.colors[3 * v + k])));
                CHECK(file.colors[v][k] == to_linear_light(share));
                least[k] = std::min(least[k], file.stored[v][k]);
                most[k] = std::max(most[k], file.stored[v][k]);
            }
            CHECK(file.colors[v][3] == 65535);
        }
        CHECK(numbers(file.json, "min") == std::vector<double>(least.begin(), least.end()));
        CHECK(numbers(file.json, "max") == std::vector<double>(most.begin(), most.end()));
        for (std::size_t f = 0; f < mesh.face_count(); ++f) {
            const std::array<double, 3>& a = file.positions[file.faces[f][0]];
            const std::array<double, 3>& b = file.positions[file.faces[f][1]];
            const std::array<double, 3>& c = file.positions[file.faces[f][2]];
            CHECK((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]) > 0);
            CHECK(file.faces[f][0] == mesh.faces[f][0]);
        }
        CHECK(has(file, "\"extensionsRequired\":[\"KHR_mesh_quantization\"]") == is_quantized);
        CHECK(has(file, "\"KHR_materials_unlit\",\"KHR_mesh_quantization\"]") == is_quantized);
    }
}

TEST_CASE("the bounds of positions off the grid are those of the floats in the file, to the last bit") {
    hmesh::Mesh mesh = two_faces(3);
    mesh.positions = {1e-9F, 1e-3F, 1234.567F, 0.1F, 3.3333F, 1.9F, 1.0F / 3, -7e9F};
    mesh.height = 1;
    const GlbFile file = read_back(mesh);
    const std::vector<double> least = numbers(file.json, "min"), most = numbers(file.json, "max");
    CHECK(static_cast<float>(least[0]) == 1e-9F);
    CHECK(static_cast<float>(most[0]) == 1234.567F);
    CHECK(static_cast<float>(least[1]) == static_cast<float>(1 - static_cast<double>(1.9F)));
    CHECK(static_cast<float>(most[1]) == 7e9F);
}

TEST_CASE("quantised positions are rounded to a step of 1/256 px or a 65535th of the larger extent") {
    for (const int side : {1, 255, 256, 512, 4096}) {
        CAPTURE(side);
        const double half_step = side <= 255 ? 0 : side / 65535.0 / 2;
        const auto full = static_cast<float>(side);
        hmesh::Mesh mesh = two_faces(3);
        mesh.width = side, mesh.height = side;
        mesh.positions = {0, 0, full, 0, full, full, full / 3, full - 1.0F / 256};
        mesh.positions[6] = std::floor(mesh.positions[6] * 256) / 256;
        hmesh::GltfOptions options = quantized();
        options.longer_side = 0;
        const GlbFile file = read_back(mesh, options);
        for (std::size_t v = 0; v < 4; ++v) {
            // The scale is written with nine digits, 5e-9 of it off at most.
            const double slack = half_step > 0 ? side * 5e-9 : 0;
            CHECK(std::abs(file.positions[v][0] - static_cast<double>(mesh.positions[2 * v])) <= half_step + slack);
            CHECK(std::abs(file.positions[v][1] - (side - static_cast<double>(mesh.positions[2 * v + 1]))) <= half_step + slack);
        }
        CHECK(file.stored[1][0] == (side <= 255 ? side * 256 : 65535));
    }
    for (const bool is_wide : {false, true}) {
        hmesh::Mesh mesh = two_faces(3);
        const float x = is_wide ? 4096 : 1, y = is_wide ? 1 : 4096;
        mesh.width = static_cast<int>(x), mesh.height = static_cast<int>(y);
        mesh.positions = {0, 0, x, 0, x, y, 1.0F / 256, y};
        const GlbFile file = read_back(mesh, quantized());
        CHECK(file.stored[1] == std::array<double, 3>{is_wide ? 65535.0 : 16, is_wide ? 16.0 : 65535, 0});
    }
    // Positions may lie outside the image, and the grid is theirs.
    for (const float shift : {-100.0F, 40000.0F, 0.25F}) {
        hmesh::Mesh mesh = two_faces(3);
        for (float& x : mesh.positions) x += shift;
        hmesh::GltfOptions options = quantized();
        options.longer_side = 6;
        const GlbFile file = read_back(mesh, options);
        const auto far = static_cast<double>(2 * shift);
        CHECK(file.positions[2] == std::array<double, 3>{6 + far, -far, 0});
        CHECK(numbers(file.json, "min") == std::vector<double>{0, 0, 0});
        CHECK(numbers(file.json, "max") == std::vector<double>{3, 2, 0});  // all lie on whole px
    }
}

TEST_CASE("quantised positions on a grid of a power of two are exact as long as 65535 steps reach across the mesh") {
    for (const int steps : {1, 4, 64, 128, 256}) {
        CAPTURE(steps);
        const int side = 65535 / steps;
        hmesh::Mesh mesh = two_faces(3);
        mesh.width = side, mesh.height = side;
        const float full = static_cast<float>(side), step = 1.0F / static_cast<float>(steps);
        mesh.positions = {0, 0, full, 0, full, full, 3 * step, full - step};
        hmesh::GltfOptions options = quantized();
        options.longer_side = 0;
        GlbFile file = read_back(mesh, options);
        CHECK(file.stored[1] == std::array<double, 3>{static_cast<double>(side * steps), static_cast<double>(side * steps), 0});
        for (std::size_t v = 0; v < 4; ++v) {
            CHECK(file.positions[v][0] == static_cast<double>(mesh.positions[2 * v]));
            CHECK(file.positions[v][1] == side - static_cast<double>(mesh.positions[2 * v + 1]));
        }
        mesh.width = mesh.height = side + 1;  // one px more is a step too many
        for (float& at : mesh.positions) at = at == full ? full + 1 : at;
        file = read_back(mesh, options);
        CHECK(file.stored[1][0] == 65535);
        CHECK(file.positions[1][0] == doctest::Approx(side + 1).epsilon(1e-8));
    }
}

TEST_CASE("positions off all grids are rounded to a step of 1/256 px") {
    hmesh::Mesh mesh = two_faces(3);
    mesh.positions = {0, 0, 3, 0, 3, 2, 0.00001F, 0.7F};
    hmesh::GltfOptions options = quantized();
    options.longer_side = 0;
    const GlbFile file = read_back(mesh, options);
    CHECK(file.stored[1] == std::array<double, 3>{768, 512, 0});
    CHECK(file.positions[3][0] == 0);
    CHECK(std::abs(file.positions[3][1] - 1.3) <= 1.0 / 512);
}

TEST_CASE("colours of 8 bits are rounded linear light") {
    hmesh::GltfOptions options;
    options.color_bits = 8;
    const Bytes bytes = hmesh_test::exported(two_faces(4).view(), with(options));
    const std::string json(bytes.begin() + 20, bytes.end());
    CHECK(json.find("{\"bufferView\":1,\"componentType\":5121,\"normalized\":true,\"count\":4,\"type\":\"VEC4\"}") !=
          std::string::npos);
    const std::size_t colors_at = 28 + number_at<std::uint32_t>(bytes, 12) + 48;
    for (std::size_t v = 0; v < 4; ++v)
        for (std::size_t k = 0; k < 4; ++k) {
            const double share = static_cast<double>(10 * v + k) / 255;
            const auto wanted = k == 3 ? std::lround(share * 255) : std::lround(to_linear_light(share) / 257.0);
            CHECK(number_at<std::uint8_t>(bytes, colors_at + 4 * v + k) == wanted);
        }
    for (const int bits : {0, 7, 9, 32, -8}) {
        options.color_bits = bits;
        hmesh_test::check_refused(two_faces(3).view(), hmesh::Errc::invalid_argument, with(options));
    }
}

TEST_CASE("a compressor is given the vertices and the indices, and its bytes are what the file holds") {
    struct Call {
        Bytes bytes;
        std::size_t count, stride;
        bool is_indices;
    };
    std::vector<Call> calls;
    const auto compress = [&](const hmesh::GltfArray& array, Bytes& out) {
        calls.push_back({{array.bytes, array.bytes + array.count * array.stride}, array.count, array.stride, array.is_indices});
        out.assign(5 + calls.size(), static_cast<unsigned char>(calls.size()));
        return true;
    };
    hmesh::Mesh mesh = two_faces(3);
    mesh.faces.pop_back();
    hmesh::GltfOptions options = quantized();
    const Bytes plain = hmesh_test::exported(mesh.view(), with(options));
    options.compress = compress;
    const Bytes bytes = hmesh_test::exported(mesh.view(), with(options));
    REQUIRE(calls.size() == 2);
    const std::size_t plain_at = 28 + number_at<std::uint32_t>(plain, 12);
    const auto part = [&](std::size_t at, std::size_t size) {
        const auto first = plain.begin() + static_cast<std::ptrdiff_t>(plain_at + at);
        return Bytes(first, first + static_cast<std::ptrdiff_t>(size));
    };
    CHECK(calls[0].count == 4);
    CHECK(calls[0].stride == 16);
    CHECK(!calls[0].is_indices);
    for (std::size_t v = 0; v < 4; ++v) {  // position and colour, where the plain file has all positions first
        const auto vertex = calls[0].bytes.begin() + static_cast<std::ptrdiff_t>(16 * v);
        CHECK(Bytes(vertex, vertex + 8) == part(8 * v, 8));
        CHECK(Bytes(vertex + 8, vertex + 16) == part(32 + 8 * v, 8));
    }
    CHECK(calls[1].count == 3);
    CHECK(calls[1].stride == 2);
    CHECK(calls[1].is_indices);
    CHECK(calls[1].bytes == part(64, 6));
    const std::size_t json_size = number_at<std::uint32_t>(bytes, 12);
    const std::string json(bytes.begin() + 20, bytes.begin() + 20 + static_cast<std::ptrdiff_t>(json_size));
    const char* const views =
        "\"bufferViews\":[{\"buffer\":1,\"byteLength\":64,\"byteStride\":16,\"target\":34962,\"extensions\":{"
        "\"EXT_meshopt_compression\":{\"buffer\":0,\"byteOffset\":0,\"byteLength\":6,\"byteStride\":16,\"count\":4,"
        "\"mode\":\"ATTRIBUTES\"}}},{\"buffer\":1,\"byteOffset\":64,\"byteLength\":6,\"target\":34963,"
        "\"extensions\":{\"EXT_meshopt_compression\":{\"buffer\":0,\"byteOffset\":8,\"byteLength\":7,\"byteStride\":2,"
        "\"count\":3,\"mode\":\"TRIANGLES\"}}}],\"buffers\":[{\"byteLength\":16},{\"byteLength\":70,\"extensions\":{"
        "\"EXT_meshopt_compression\":{\"fallback\":true}}}]}";
    CHECK(json.find("{\"bufferView\":0,\"byteOffset\":8,\"componentType\":5123,\"normalized\":true") != std::string::npos);
    CHECK(json.find("{\"bufferView\":1,\"componentType\":5123,\"count\":3") != std::string::npos);
    CHECK(json.find(views) != std::string::npos);
    CHECK(json.find("\"extensionsRequired\":[\"KHR_mesh_quantization\",\"EXT_meshopt_compression\"]") != std::string::npos);
    const Bytes body = {16, 0, 0, 0, 'B', 'I', 'N', 0, 1, 1, 1, 1, 1, 1, 0, 0, 2, 2, 2, 2, 2, 2, 2, 0};
    CHECK(Bytes(bytes.begin() + 20 + static_cast<std::ptrdiff_t>(json_size), bytes.end()) == body);
    CHECK(number_at<std::uint32_t>(bytes, 8) == bytes.size());

    const auto fail = [](const hmesh::GltfArray& array, Bytes& out) {
        if (!array.is_indices) out.push_back(1);
        return true;  // of no bytes
    };
    options.compress = fail;
    hmesh_test::check_refused(mesh.view(), hmesh::Errc::write_failed, with(options));
    const auto give_up = [](const hmesh::GltfArray&, Bytes& out) {
        out.push_back(1);
        return false;
    };
    options.compress = give_up;
    hmesh_test::check_refused(mesh.view(), hmesh::Errc::write_failed, with(options));
}

TEST_CASE("the longer side has the length asked for, and positions in the buffer stay pixels") {
    hmesh::Mesh mesh = hmesh_test::square_grid(4, 8);
    for (const double length : {0.0, 1.0, 2.5, 1e-3, 1e4}) {
        hmesh::GltfOptions options;
        options.longer_side = length;
        const GlbFile file = read_back(mesh, options);
        CHECK(file.stored[4] == std::array<double, 3>{4, 8, 0});
        CHECK(file.positions[4][1] == doctest::Approx(length > 0 ? length : 8).epsilon(1e-8));
        CHECK(file.positions[4][0] == doctest::Approx(length > 0 ? length / 2 : 4).epsilon(1e-8));
    }
    CHECK(read_back(mesh).positions[4] == std::array<double, 3>{0.5, 1, 0});
    for (const double bad : {-1.0, 1e39, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
        hmesh::GltfOptions options;
        options.longer_side = bad;
        hmesh_test::check_refused(mesh.view(), hmesh::Errc::invalid_argument, with(options));
    }
}

TEST_CASE("grey is three equal colours, alpha is not decoded and blends") {
    const GlbFile gray = read_back(two_faces(1)), alpha = read_back(two_faces(4));
    const int ten = to_linear_light(10.0 / 255);
    CHECK(gray.colors[1] == std::array<int, 4>{ten, ten, ten, 65535});
    CHECK(alpha.colors[1] == std::array<int, 4>{ten, to_linear_light(11.0 / 255), to_linear_light(12.0 / 255), 13 * 257});
    CHECK_FALSE(has(gray, "alphaMode"));
    CHECK(has(alpha, "\"alphaMode\":\"BLEND\""));
    CHECK_FALSE(has(alpha, "doubleSided"));  // false is the default
}

TEST_CASE("colours that are linear already are written as they are") {
    hmesh::GltfOptions options;
    options.colors_are_linear = true;
    CHECK(read_back(two_faces(4), options).colors[3] == std::array<int, 4>{30 * 257, 31 * 257, 32 * 257, 33 * 257});
}

TEST_CASE("indices have 16 bits up to 65535 vertices and 32 beyond: 65535 is never an index of 16 bits") {
    const hmesh::Mesh most = hmesh_test::square_grid(254, 256), more = hmesh_test::square_grid(255, 255);
    REQUIRE(most.vertex_count() == 65535);
    REQUIRE(more.vertex_count() == 65536);
    for (const hmesh::Mesh* mesh : {&most, &more}) {
        const GlbFile file = read_back(*mesh);
        CHECK(file.index_size == (mesh == &most ? 2 : 4));
        CHECK(file.positions.size() == mesh->vertex_count());
        CHECK(file.faces.size() == mesh->face_count());
        std::size_t wrong = 0;
        for (std::size_t f = 0; f < mesh->face_count(); ++f) {
            const hmesh::Triangle& face = mesh->faces[f];
            wrong += file.faces[f] != hmesh::Triangle{face[0], face[2], face[1]};
        }
        CHECK(wrong == 0);
    }
}

TEST_CASE("a buffer that is no multiple of four is padded with zeros and keeps its length") {
    hmesh::Mesh mesh = two_faces(3);
    mesh.faces.pop_back();
    const GlbFile file = read_back(mesh);  // checks the padding
    CHECK(numbers(file.json, "byteLength", 3)[0] == 86);
}

TEST_CASE("the JSON is padded with spaces, whatever its length") {
    std::array<int, 4> lengths{};
    for (int width = 1; width <= 1000000; width *= 10) {
        hmesh::Mesh mesh = two_faces(3);
        mesh.positions[2] = mesh.positions[4] = static_cast<float>(width);
        const GlbFile file = read_back(mesh);  // checks the padding
        ++lengths[(file.json.find_last_not_of(' ') + 1) % 4];
    }
    for (const int count : lengths) CHECK(count > 0);
}

TEST_CASE("the locale makes no difference") {
    hmesh::Mesh mesh = two_faces(3);
    mesh.positions[4] = 3.5F;
    hmesh_test::check_locale_makes_no_difference(mesh.view(), with({}));
}

TEST_CASE("a sink that refuses anywhere gets no more and is reported") {
    const hmesh::Mesh mesh = hmesh_test::square_grid(16, 16);
    hmesh_test::check_refusing_sinks(mesh.view(), with({}));
    hmesh_test::check_refusing_sinks(mesh.view(), with(quantized()));
}

TEST_CASE("a mesh that cannot be written gives a Status and no byte") {
    hmesh_test::check_bad_meshes_are_refused(with({}));
    hmesh_test::check_bad_meshes_are_refused(with(quantized()));
}

TEST_CASE("a mesh of 4 GiB or more is refused before it is read") {
    const hmesh::Mesh mesh = two_faces(3);
    for (const std::size_t count : {std::size_t{358000000}, std::size_t{1} << 31U, std::numeric_limits<std::size_t>::max()}) {
        hmesh::MeshView huge = mesh.view();
        huge.vertex_count = count;  // 20 bytes each
        hmesh_test::check_refused(huge, hmesh::Errc::invalid_argument, with({}));
        huge = mesh.view();
        huge.face_count = 2 * count;  // 6 bytes each
        hmesh_test::check_refused(huge, hmesh::Errc::invalid_argument, with({}));
    }
    hmesh::MeshView huge = mesh.view();
    huge.vertex_count = 214748364;  // 2^32 - 16 bytes of vertices alone, and no room for the rest
    const hmesh::Status status = hmesh::write_glb(huge, [](const void*, std::size_t) { return true; });
    CHECK(status.limit == 4294967295);
    CHECK(status.value > status.limit);
}

TEST_CASE("a mesh of nothing is a scene of nothing: accessors have one element at least") {
    hmesh_test::check_empty_meshes(with({}), [](const Bytes& bytes) {
        CHECK(number_at<std::uint32_t>(bytes, 8) == bytes.size());
        CHECK(number_at<std::uint32_t>(bytes, 12) == bytes.size() - 20);
        CHECK(bytes.size() % 4 == 0);
        const std::string json(bytes.begin() + 20, bytes.end());
        CHECK(json.find("\"scene\":0,\"scenes\":[{}]}") != std::string::npos);
        for (const char* word : {"accessors", "meshes", "buffers", "nodes"}) CHECK(json.find(word) == std::string::npos);
    });

    hmesh::Mesh nothing = hmesh_test::two_faces(3);
    nothing.positions.clear(), nothing.colors.clear(), nothing.faces.clear();
    const auto is_written = [&](const hmesh::GltfOptions& options) {
        std::size_t bytes = 0;
        const auto count = [&](const void*, std::size_t size) { return bytes += size, true; };
        const bool is_ok = static_cast<bool>(hmesh::write_glb(nothing.view(), count, options));
        CHECK(is_ok == (bytes > 0));
        return is_ok;
    };
    hmesh::GltfOptions options;
    for (const bool is_quantized : {false, true}) {
        options.quantized_positions = is_quantized;
        CHECK(is_written(options));
    }
    options.longer_side = -1;
    CHECK_FALSE(is_written(options));
    options.longer_side = 1;
    options.color_bits = 9;
    CHECK_FALSE(is_written(options));
}
