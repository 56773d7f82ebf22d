// Fuzzes write_obj(). Lines have to be those of the mesh: positions that are read back as they were, colours in [0, 1].
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

#include "fuzz_exports.hpp"
#include "fuzz_input.hpp"
#include "fuzz_text.hpp"
#include "hmesh/io/obj.hpp"

namespace {

using hmesh_test::demand;

void check_file(const std::string& file, const hmesh::MeshView& mesh) {
    hmesh_test::FuzzText text(file);
    text.expect("# ");
    static_cast<void>(text.until("\n"));
    for (std::size_t v = 0; v < mesh.vertex_count; ++v) {
        text.expect("v ");
        demand(static_cast<float>(text.number()) == mesh.positions[2 * v], "x is the mesh's");
        text.expect(" ");
        const double y = mesh.height - static_cast<double>(mesh.positions[2 * v + 1]);
        demand(std::abs(text.number() - y) <= 1e-8 * std::abs(y), "y is the mesh's, upward, to nine digits");
        text.expect(" 0");
        for (int k = 0; k < 3; ++k) {
            text.expect(" ");
            const double share = text.number();
            demand(share >= 0 && share <= 1, "a colour is in [0, 1]");
        }
        text.expect("\n");
    }
    for (std::size_t f = 0; f < mesh.face_count; ++f) {
        text.expect("f");
        for (const std::size_t k : {0U, 2U, 1U}) {
            text.expect(" ");
            demand(text.whole() == std::int64_t{mesh.faces[f][k]} + 1, "a corner is the mesh's, counted from 1");
        }
        text.expect("\n");
    }
    text.expect_end();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    hmesh_test::FuzzInput input(bytes, size);
    const hmesh_test::FuzzMesh mesh = hmesh_test::FuzzMeshDraw(input).mesh();
    hmesh_test::fuzz_exporter(
        input, mesh, [](const hmesh::MeshView& view, hmesh::Sink sink) { return hmesh::write_obj(view, sink); }, check_file);
    return 0;
}
