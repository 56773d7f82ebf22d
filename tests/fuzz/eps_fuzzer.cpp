// Fuzzes write_eps(). The file has to be lines of 7-bit text, and the shading in it to join as many faces as the mesh.
#include <cstddef>
#include <cstdint>
#include <string>

#include "fuzz_exports.hpp"
#include "fuzz_input.hpp"
#include "fuzz_shadings.hpp"
#include "fuzz_text.hpp"
#include "hmesh/io/eps.hpp"

namespace {

using hmesh_test::demand;
using hmesh_test::FuzzText;

std::string decode_ascii85(const std::string& text) {
    std::string bytes;
    std::uint64_t word = 0;
    std::size_t digits = 0;
    const auto put = [&](std::size_t count) {
        demand(word <= 0xffffffffU, "five digits are four bytes");
        for (std::size_t i = 0; i < count; ++i) bytes += static_cast<char>((word >> (24 - 8 * i)) & 255U);
        word = 0;
        digits = 0;
    };
    for (const char c : text) {
        if (c == '\n' || c == ' ') continue;
        if (c == 'z') {
            demand(digits == 0, "z stands between words");
            put(4);
            continue;
        }
        demand(c >= '!' && c <= 'u', "a digit of base 85");
        word = word * 85 + static_cast<std::uint64_t>(c - '!');
        if (++digits == 5) put(4);
    }
    if (digits == 0) return bytes;
    const std::size_t count = digits - 1;
    demand(count > 0, "a byte takes two digits");
    for (; digits < 5; ++digits) word = word * 85 + 84;
    put(count);
    return bytes;
}

void check_file(const std::string& file, const hmesh::MeshView& mesh, bool is_deflated) {
    std::size_t column = 0;
    for (const char c : file) {
        demand(c == '\n' || (c >= ' ' && c <= '~'), "the file is text");
        column = c == '\n' ? 0 : column + 1;
        demand(column <= 255, "lines are short");
    }
    FuzzText text(file);
    text.expect("%!PS-Adobe-3.0 EPSF-3.0\n");
    if (mesh.face_count == 0) {
        demand(file.find("shfill") == std::string::npos, "nothing is drawn of nothing");
        return;
    }
    const std::size_t vertex_bytes = hmesh_test::read_vertex_bytes(text);
    static_cast<void>(text.until("} exec\n"));
    const std::string data = text.until("~>\n");
    for (std::size_t at = 0; at < data.size(); ++at)
        demand(data[at] != '%' || (at > 0 && data[at - 1] != '\n'), "no line of data looks like a comment");
    const std::string bytes = decode_ascii85(data);
    text.expect("grestore\nshowpage\n%%Trailer\n%%EOF\n");
    text.expect_end();
    if (is_deflated) return;
    const std::size_t faces = hmesh_test::shading_faces(bytes, vertex_bytes);
    demand(faces == mesh.face_count, "the shading joins as many faces as the mesh");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    hmesh_test::FuzzInput input(bytes, size);
    hmesh::PageOptions options;
    hmesh_test::FakeDeflate compressor;
    const hmesh_test::FuzzMesh mesh = hmesh_test::draw_shading(input, options, compressor);
    hmesh_test::fuzz_exporter(
        input, mesh, [&](const hmesh::MeshView& view, hmesh::Sink sink) { return hmesh::write_eps(view, sink, options); },
        [&](const std::string& file, const hmesh::MeshView& view) {
            check_file(file, view, static_cast<bool>(options.deflate));
        });
    return 0;
}
