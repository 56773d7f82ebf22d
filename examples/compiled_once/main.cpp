// compiled_once - hmesh in a program of many files: this is one of those that use it. It compiles in a second, because all files
// of the program are compiled with HMESH_COMPILED and so see of mesh_image() its declaration only. meshing.cpp is the one file
// that compiles it. ../CMakeLists.txt says what both have in common.
//
// The same two files without HMESH_COMPILED are header-only again, and do the same.
#include <hmesh/hmesh.hpp>

#include <cstddef>
#include <cstdint>
#include <cstdio>

namespace {

// A disc on a slope of colours.
hmesh::Image<std::uint8_t, 3> draw_disc(int width, int height) {
    hmesh::Image<std::uint8_t, 3> picture(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            std::uint8_t* pixel = picture.pixel(x, y);
            const int dx = x - width / 2, dy = y - height / 2;
            pixel[0] = static_cast<std::uint8_t>(255 * x / width);
            pixel[1] = static_cast<std::uint8_t>(255 * y / height);
            pixel[2] = dx * dx + dy * dy < 6400 ? 230 : 40;
        }
    return picture;
}

}  // namespace

int main() {
    const hmesh::Image<std::uint8_t, 3> picture = draw_disc(256, 256);
    hmesh::Options options;
    options.target = hmesh::Target::vertices(300);
    const hmesh::Result result = hmesh::mesh_image(picture.view(), options);
    if (!result.has_mesh()) {
        std::fprintf(stderr, "compiled_once: %s\n", hmesh::message(result.status).c_str());
        return 1;
    }
    std::size_t bytes = 0;
    const auto sink = [&](const void*, std::size_t size) {
        bytes += size;
        return true;
    };
    const hmesh::Status written = hmesh::write_glb(result.mesh.view(), sink);
    std::printf("%zu vertices, %zu faces, PSNR %.2f dB, %zu bytes as GLB\n", result.report.vertices, result.report.faces,
                result.report.psnr, bytes);
    return written ? 0 : 1;
}
