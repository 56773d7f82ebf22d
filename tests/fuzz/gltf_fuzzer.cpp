// Fuzzes write_glb(). The head and the chunks have to have the lengths they say, the JSON has to be JSON, and the buffer the
// vertices and faces that it announces.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>

#include "fuzz_exports.hpp"
#include "fuzz_input.hpp"
#include "fuzz_text.hpp"
#include "hmesh/io/gltf.hpp"

namespace {

using hmesh_test::demand;
using hmesh_test::FuzzText;

// Reads a value of JSON whose strings hold no escapes.
void read_json(FuzzText& text) {
    if (text.accept("\"")) {
        demand(text.until("\"").find('\\') == std::string::npos, "no escapes");
    } else if (text.accept("{}")) {
        return;
    } else if (text.accept("{")) {
        do {
            text.expect("\"");
            static_cast<void>(text.until("\":"));
            read_json(text);
        } while (text.accept(","));
        text.expect("}");
    } else if (text.accept("[")) {
        do read_json(text);
        while (text.accept(","));
        text.expect("]");
    } else if (!text.accept("true") && !text.accept("false")) {
        demand(text.next() == '-' || (text.next() >= '0' && text.next() <= '9'), "a JSON number begins with a digit");
        static_cast<void>(text.number());
    }
}

std::array<double, 2> read_bounds(const std::string& json, const char* name) {
    FuzzText text(json);
    static_cast<void>(text.until(name));
    const double x = text.number();
    text.expect(",");
    return {x, text.number()};
}

void check_file(const std::string& file, const hmesh::MeshView& mesh, const hmesh::GltfOptions& options) {
    FuzzText text(file);
    text.expect("glTF");
    demand(text.word() == 2, "the version is 2");
    demand(text.word() == file.size(), "the head has the file's length");
    const std::size_t json_bytes = text.word();
    text.expect("JSON");
    demand(json_bytes % 4 == 0 && json_bytes <= text.left(), "the JSON is padded");
    const std::string json = file.substr(text.at(), json_bytes);
    FuzzText json_text(json);
    read_json(json_text);
    while (json_text.accept(" ")) continue;
    json_text.expect_end();
    text.skip(json_bytes);
    if (mesh.vertex_count == 0) return text.expect_end();  // a scene of nothing
    const std::size_t buffer_bytes = text.word();
    demand(text.word() == 0x4e4942, "a chunk is BIN");
    demand(buffer_bytes == text.left() && buffer_bytes % 4 == 0, "the buffer is what is left, padded");

    const std::size_t vertices = mesh.vertex_count, corners = 3 * mesh.face_count;
    const bool is_quantized = options.quantized_positions, is_wide = vertices > 65535;
    const auto color_bytes = static_cast<std::size_t>(options.color_bits) / 2;  // of four
    const std::size_t used = vertices * ((is_quantized ? 8 : 12) + color_bytes) + corners * (is_wide ? 4 : 2);
    demand(buffer_bytes >= used && buffer_bytes < used + 4, "the buffer holds vertices and indices");
    FuzzText announced(json);
    static_cast<void>(announced.until("\"buffers\":[{\"byteLength\":"));
    demand(announced.whole() == static_cast<std::int64_t>(used), "the JSON has the buffer's length");

    constexpr double infinity = std::numeric_limits<double>::infinity();
    std::array<double, 2> low = {infinity, infinity}, high = {-infinity, -infinity};
    for (std::size_t v = 0; v < vertices; ++v) {
        for (std::size_t k = 0; k < 2; ++k) {
            const double value = is_quantized ? text.word(2) : static_cast<double>(text.real());
            low[k] = std::min(low[k], value);
            high[k] = std::max(high[k], value);
        }
        demand(text.word() == 0, "z is 0");
    }
    // As JSON readers get them that keep floats, which hold what the buffer does.
    const std::array<double, 2> least = read_bounds(json, "\"min\":["), most = read_bounds(json, "\"max\":[");
    for (std::size_t k = 0; k < 2; ++k) {
        demand(static_cast<float>(least[k]) == static_cast<float>(low[k]), "the smallest coordinate is the accessor's");
        demand(static_cast<float>(most[k]) == static_cast<float>(high[k]), "the largest coordinate is the accessor's");
    }
    text.skip(color_bytes * vertices);  // any number is a colour
    for (std::size_t i = 0; i < corners; ++i) demand(text.word(is_wide ? 4 : 2) < vertices, "an index names a vertex");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    hmesh_test::FuzzInput input(bytes, size);
    hmesh::GltfOptions options;
    options.quantized_positions = input.flag();
    options.colors_are_linear = input.flag();
    if (input.one_in(4)) options.color_bits = 8;
    const bool is_wild = input.one_in(4);
    if (is_wild) options.longer_side = input.wild_real();
    hmesh_test::FuzzMesh mesh = hmesh_test::FuzzMeshDraw(input).mesh();
    mesh.is_good = mesh.is_good && !is_wild;
    hmesh_test::fuzz_exporter(
        input, mesh, [&](const hmesh::MeshView& view, hmesh::Sink sink) { return hmesh::write_glb(view, sink, options); },
        [&](const std::string& file, const hmesh::MeshView& view) { check_file(file, view, options); });
    return 0;
}
