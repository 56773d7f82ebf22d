// Fuzzes write_ply(). A file has to hold what its head says, and positions that are read back as they were.
#include <cstddef>
#include <cstdint>
#include <string>

#include "fuzz_exports.hpp"
#include "fuzz_input.hpp"
#include "fuzz_text.hpp"
#include "hmesh/io/ply.hpp"

namespace {

using hmesh_test::demand;
using hmesh_test::FuzzText;

// The numbers of a PLY file, in bytes or in words.
class Numbers {
  public:
    Numbers(FuzzText& text, bool is_ascii) : text_(&text), is_ascii_(is_ascii) {}
    float real() { return is_ascii_ ? static_cast<float>(word()) : text_->real(); }
    std::uint32_t whole(std::size_t bytes) { return is_ascii_ ? static_cast<std::uint32_t>(word()) : text_->word(bytes); }
    void end_line() {
        if (is_ascii_) text_->expect("\n");
        is_first_ = true;
    }

  private:
    double word() {
        if (!is_first_) text_->expect(" ");
        is_first_ = false;
        return text_->number();
    }
    FuzzText* text_;
    bool is_ascii_, is_first_ = true;
};

void check_file(const std::string& file, const hmesh::MeshView& mesh, const hmesh::PlyOptions& options) {
    FuzzText text(file);
    text.expect(options.ascii ? "ply\nformat ascii 1.0\ncomment " : "ply\nformat binary_little_endian 1.0\ncomment ");
    static_cast<void>(text.until("\n"));
    text.expect("element vertex ");
    demand(text.whole() == static_cast<std::int64_t>(mesh.vertex_count), "the head counts the vertices");
    text.expect("\nproperty float x\nproperty float y\nproperty float z\n");
    int channels = 0;
    while (text.accept(options.float_colors ? "property float " : "property uchar ")) {
        static_cast<void>(text.until("\n"));
        ++channels;
    }
    demand(channels == hmesh_test::channels_written(mesh), "the head names the channels");
    text.expect("element face ");
    demand(text.whole() == static_cast<std::int64_t>(mesh.face_count), "the head counts the faces");
    text.expect("\nproperty list uchar int vertex_indices\nend_header\n");

    Numbers numbers(text, options.ascii);
    for (std::size_t v = 0; v < mesh.vertex_count; ++v) {
        demand(numbers.real() == mesh.positions[2 * v], "x is the mesh's");
        const double y = mesh.height - static_cast<double>(mesh.positions[2 * v + 1]);
        demand(numbers.real() == static_cast<float>(y), "y is the mesh's, upward");
        demand(numbers.real() == 0, "z is 0");
        for (int k = 0; k < channels; ++k) {
            if (!options.float_colors) demand(numbers.whole(1) <= 255, "a colour is a byte");
            else {
                const float color = numbers.real();
                const int from = mesh.channels == 2 ? k / 3 : k;
                const float stored = mesh.colors[static_cast<std::size_t>(mesh.channels) * v + static_cast<std::size_t>(from)];
                if (!mesh.premultiplied || channels < 4)
                    demand(color == static_cast<float>(static_cast<double>(stored) / mesh.peak),
                           "a colour is the mesh's share of the peak");
            }
        }
        numbers.end_line();
    }
    for (std::size_t f = 0; f < mesh.face_count; ++f) {
        const hmesh::Triangle& face = mesh.faces[f];
        demand(numbers.whole(1) == 3, "a face has three corners");
        for (const std::uint32_t v : {face[0], face[2], face[1]}) demand(numbers.whole(4) == v, "a corner is the mesh's");
        numbers.end_line();
    }
    text.expect_end();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    hmesh_test::FuzzInput input(bytes, size);
    hmesh::PlyOptions options;
    options.ascii = input.flag();
    options.float_colors = input.flag();
    const hmesh_test::FuzzMesh mesh = hmesh_test::FuzzMeshDraw(input).mesh();
    hmesh_test::fuzz_exporter(
        input, mesh, [&](const hmesh::MeshView& view, hmesh::Sink sink) { return hmesh::write_ply(view, sink, options); },
        [&](const std::string& file, const hmesh::MeshView& view) { check_file(file, view, options); });
    return 0;
}
