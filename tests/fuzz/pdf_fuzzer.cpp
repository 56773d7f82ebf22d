// Fuzzes write_pdf(). The table has to say where objects begin, streams have to be as long as they say, and the shading has
// to join as many faces as the mesh.
#include <cstddef>
#include <cstdint>
#include <string>

#include "fuzz_exports.hpp"
#include "fuzz_input.hpp"
#include "fuzz_shadings.hpp"
#include "fuzz_text.hpp"
#include "hmesh/io/pdf.hpp"

namespace {

using hmesh_test::demand;
using hmesh_test::FuzzText;

// The bytes of a shading, and what its dictionary says of them.
void check_shading(const std::string& entries, const std::string& stream, const hmesh::MeshView& mesh) {
    FuzzText text(entries);
    const std::size_t vertex_bytes = hmesh_test::read_vertex_bytes(text);
    text.expect("]");
    if (text.accept("\n/Filter /FlateDecode")) return;
    const std::size_t faces = hmesh_test::shading_faces(stream, vertex_bytes);
    demand(faces == mesh.face_count, "the shading joins as many faces as the mesh");
}

void check_file(const std::string& file, const hmesh::MeshView& mesh) {
    FuzzText head(file);
    head.expect("%PDF-1.4\n");
    const std::size_t last = file.rfind("startxref\n");
    demand(last != std::string::npos, "the file says where its table is");
    FuzzText end(file, last);
    end.expect("startxref\n");
    const std::int64_t table_at = end.whole();
    end.expect("\n%%EOF\n");
    end.expect_end();

    demand(table_at > 0 && table_at < static_cast<std::int64_t>(last), "the table is in the file");
    FuzzText table(file, static_cast<std::size_t>(table_at));
    table.expect("xref\n0 ");
    const std::int64_t count = table.whole();
    table.expect("\n0000000000 65535 f \n");
    int shadings = 0;
    for (std::int64_t number = 1; number < count; ++number) {
        const std::size_t entry = table.at();
        FuzzText object(file, static_cast<std::size_t>(table.whole()));
        demand(table.at() == entry + 10, "an offset has ten digits");
        table.expect(" 00000 n \n");
        demand(object.whole() == number, "an object is where the table says");
        object.expect(" 0 obj\n<< ");
        const std::size_t dictionary = object.at();
        if (file.find("\n/Length ", dictionary) > file.find(" >>\nendobj\n", dictionary)) continue;  // no stream
        const std::string entries = object.until("\n/Length ");
        const auto length = static_cast<std::size_t>(object.whole());
        object.expect(" >>\nstream\n");
        const std::size_t stream = object.at();
        object.skip(length);
        object.expect("\nendstream\nendobj\n");
        if (entries.find("/ShadingType 4") == std::string::npos) continue;
        ++shadings;
        check_shading(entries, file.substr(stream, length), mesh);
    }
    table.expect("trailer\n<< /Size ");
    demand(table.whole() == count, "the trailer counts the objects");
    demand(shadings == (mesh.face_count == 0     ? 0
                        : mesh.channels % 2 == 0 ? 2
                                                 : 1),
           "the page has a shading, and one of its alpha");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    hmesh_test::FuzzInput input(bytes, size);
    hmesh::PageOptions options;
    hmesh_test::FakeDeflate compressor;
    const hmesh_test::FuzzMesh mesh = hmesh_test::draw_shading(input, options, compressor);
    hmesh_test::fuzz_exporter(
        input, mesh, [&](const hmesh::MeshView& view, hmesh::Sink sink) { return hmesh::write_pdf(view, sink, options); },
        check_file);
    return 0;
}
