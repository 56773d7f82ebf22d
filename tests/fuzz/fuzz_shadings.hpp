// hmesh tests - what the fuzzers of write_pdf() and write_eps() share: options with compressors that compress nothing or fail,
// and a reader of shadings.
#ifndef HMESH_TESTS_FUZZ_FUZZ_SHADINGS_HPP
#define HMESH_TESTS_FUZZ_FUZZ_SHADINGS_HPP

#include <cstddef>
#include <vector>

#include "fuzz_exports.hpp"
#include "fuzz_input.hpp"
#include "fuzz_text.hpp"
#include "hmesh/io/page_options.hpp"

namespace hmesh_test {

enum class Deflating { none, works, says_no, gives_nothing };

// A compressor that does so.
struct FakeDeflate {
    Deflating how = Deflating::none;
    bool operator()(const unsigned char* bytes, std::size_t size, std::vector<unsigned char>& out) const {
        demand(out.empty(), "a compressor is given an empty vector");
        if (how == Deflating::works) out.assign(bytes, bytes + size);
        return how != Deflating::says_no;
    }
};

[[nodiscard]] inline Deflating draw_deflating(FuzzInput& input) {
    const unsigned which = input.byte() % 8;
    return which < 4    ? Deflating::none
           : which == 7 ? Deflating::gives_nothing
           : which == 6 ? Deflating::says_no
                        : Deflating::works;
}

// Options, which refer to the compressor, and a mesh, which is not good where the compressor fails.
[[nodiscard]] inline FuzzMesh draw_shading(FuzzInput& input, hmesh::PageOptions& options, FakeDeflate& compressor) {
    options.strips = !input.one_in(3);
    compressor.how = draw_deflating(input);
    if (compressor.how != Deflating::none) options.deflate = compressor;
    FuzzMesh mesh = FuzzMeshDraw(input).mesh();
    mesh.is_good = mesh.is_good && compressor.how <= Deflating::works;
    return mesh;
}

// Reads what a shading's dictionary says of its vertices, from its colour space to the last range: the bytes of a vertex.
[[nodiscard]] inline std::size_t read_vertex_bytes(FuzzText& text) {
    static_cast<void>(text.until("/ColorSpace /Device"));
    const std::size_t components = text.accept("Gray") ? 1 : 3;
    static_cast<void>(text.until("/BitsPerCoordinate "));
    const auto coordinate = static_cast<std::size_t>(text.whole());
    text.expect(" /BitsPerComponent ");
    const auto component = static_cast<std::size_t>(text.whole());
    text.expect(" /BitsPerFlag 8\n/Decode [");
    double before = 0;
    for (std::size_t i = 0; i < 4 + 2 * components; ++i) {
        const double end = text.number();
        demand(i % 2 == 0 || end > before, "a range is not empty");
        before = end;
        if (i < 3 + 2 * components) text.expect(" ");
    }
    return 1 + (2 * coordinate + components * component) / 8;
}

// How many faces the bytes of a shading join; all of it must be read, and no flag be another than 0, 1 or 2.
[[nodiscard]] inline std::size_t shading_faces(const std::string& bytes, std::size_t vertex_bytes) {
    demand(bytes.size() % vertex_bytes == 0, "a shading holds whole vertices");
    std::size_t faces = 0;
    for (std::size_t at = 0; at < bytes.size(); ++faces) {
        const int flag = static_cast<unsigned char>(bytes[at]);
        demand(flag <= 2 && (flag == 0 || faces > 0), "a flag says how a face goes on");
        at += (flag == 0 ? 3 : 1) * vertex_bytes;
        demand(at <= bytes.size(), "a face has its corners");
    }
    return faces;
}

}  // namespace hmesh_test

#endif  // HMESH_TESTS_FUZZ_FUZZ_SHADINGS_HPP
