// minimal - an image file becomes a mesh file: minimal photo.png mesh.ply
#include <cstdio>

// README begin
#include <hmesh/hmesh.hpp>
// README end
#define STB_IMAGE_IMPLEMENTATION
#include <stb_image.h>

int main(int argc, char** argv) {
    if (argc != 3) return std::fprintf(stderr, "usage: minimal IMAGE MESH.ply\n"), 2;
    // README begin
    int width = 0, height = 0;
    unsigned char* pixels = stbi_load(argv[1], &width, &height, nullptr, 3);
    if (pixels == nullptr) return std::fprintf(stderr, "%s: %s\n", argv[1], stbi_failure_reason()), 1;
    const hmesh::ImageView<std::uint8_t, 3> image{pixels, width, height};

    const auto [mesh, report, status] = hmesh::mesh_image(image);  // one vertex for 100 pixels
    if (!status) return std::fprintf(stderr, "%s: %s\n", argv[1], status.what), 1;

    std::FILE* file = std::fopen(argv[2], "wb");
    const auto sink = [&](const void* bytes, std::size_t size) { return std::fwrite(bytes, 1, size, file) == size; };
    const bool written = file != nullptr && hmesh::write_ply(mesh.view(), sink) && std::fclose(file) == 0;
    std::printf("%zu vertices, %zu faces, PSNR %.2f dB\n", report.vertices, report.faces, report.psnr);
    // README end
    if (!written) std::fprintf(stderr, "cannot write %s\n", argv[2]);
    stbi_image_free(pixels);
    return written ? 0 : 1;
}
