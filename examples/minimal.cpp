// minimal - an image file becomes a mesh file: minimal photo.png mesh.ply
#include <cstdint>
#include <cstdio>

// README begin
#include <hmesh/hmesh.hpp>
// README end
#define STB_IMAGE_IMPLEMENTATION
#include <stb_image.h>

int main(int argc, char** argv) {
    if (argc != 3) {
        std::fprintf(stderr, "usage: minimal IMAGE MESH.ply\n");
        return 2;
    }
    int width = 0, height = 0;
    unsigned char* pixels = stbi_load(argv[1], &width, &height, nullptr, 3);
    if (pixels == nullptr) {
        std::fprintf(stderr, "%s: %s\n", argv[1], stbi_failure_reason());
        return 1;
    }
    // README begin

    const hmesh::ImageView<std::uint8_t, 3> image{pixels, width, height};
    const hmesh::Result result = hmesh::mesh_image(image);  // one vertex for 100 pixels
    // README end
    stbi_image_free(pixels);
    // README begin
    if (!result.has_mesh()) {
        std::fprintf(stderr, "%s: %s\n", argv[1], hmesh::message(result.status).c_str());
        return 1;
    }
    std::printf("%zu vertices, %zu faces, PSNR %.2f dB\n", result.report.vertices, result.report.faces, result.report.psnr);

    std::FILE* file = std::fopen(argv[2], "wb");
    const auto sink = [&](const void* bytes, std::size_t size) { return std::fwrite(bytes, 1, size, file) == size; };
    if (file == nullptr || !hmesh::write_ply(result.mesh.view(), sink) || std::fclose(file) != 0) {
        std::fprintf(stderr, "cannot write %s\n", argv[2]);
        return 1;
    }
    // README end
    return 0;
}
