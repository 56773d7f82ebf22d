// A file of a program that compiles mesh_image() in compiled_meshing.cpp: with HMESH_COMPILED it sees declarations only.
//
// usage: consumer VERSION        exit status 1: hmesh is of another version, or does not work
#include <hmesh/hmesh.hpp>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>

namespace {

hmesh::Image<std::uint8_t, 1> draw_slope() {
    hmesh::Image<std::uint8_t, 1> image(24, 16);
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 24; ++x) *image.pixel(x, y) = static_cast<std::uint8_t>(x < 9 ? 40 + y : 200 - 3 * x);
    return image;
}

}  // namespace

int main(int argc, char** argv) {
    const hmesh::Image<std::uint8_t, 1> image = draw_slope();
    hmesh::Options options;
    options.target = hmesh::Target::vertices(20);
    const hmesh::Result result = hmesh::mesh_image(image.view(), options);
    const hmesh::Result draft = hmesh::mesh_image(image.view(), options, hmesh::Annealed{hmesh::Effort::draft});
    if (!result.status || !draft.status || draft.mesh.vertex_count() != 20) return 1;

    std::size_t bytes = 0;
    const auto sink = [&](const void*, std::size_t size) { return bytes += size, true; };
    if (!hmesh::write_ply(result.mesh.view(), sink) || !hmesh::render<1>(result.mesh.view()).status) return 1;
    options.target = hmesh::Target::vertices(3);
    std::printf("%zu vertices, PSNR %.6f dB, a PLY file of %zu bytes; 3 vertices: %s\n", result.report.vertices,
                result.report.psnr, bytes, hmesh::message(hmesh::mesh_image(image.view(), options).status).c_str());
    return argc == 2 && std::strcmp(argv[1], HMESH_VERSION_STRING) == 0 ? 0 : 1;
}
