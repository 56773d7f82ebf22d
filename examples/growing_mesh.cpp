// growing_mesh - shows a mesh while it gets better: growing_mesh photo.png [MESH.ply]
//
// A window would draw the meshes; this one prints what each is worth, and writes each over the one before.
#include <chrono>
#include <cstdint>
#include <cstdio>

#include "hmesh/hmesh.hpp"
#define STB_IMAGE_IMPLEMENTATION
#include <stb_image.h>

namespace {

bool write(const hmesh::Mesh& mesh, const char* path) {
    std::FILE* file = std::fopen(path, "wb");
    if (file == nullptr) return false;
    const auto sink = [&](const void* bytes, std::size_t size) { return std::fwrite(bytes, 1, size, file) == size; };
    const bool is_written = static_cast<bool>(hmesh::write_ply(mesh.view(), sink));
    return std::fclose(file) == 0 && is_written;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2 && argc != 3) {
        std::fprintf(stderr, "usage: growing_mesh IMAGE [MESH.ply]\n");
        return 2;
    }
    int width = 0, height = 0;
    unsigned char* pixels = stbi_load(argv[1], &width, &height, nullptr, 3);
    if (pixels == nullptr) {
        std::fprintf(stderr, "%s: %s\n", argv[1], stbi_failure_reason());
        return 1;
    }
    const hmesh::ImageView<std::uint8_t, 3> image{pixels, width, height};

    using Clock = std::chrono::steady_clock;
    const Clock::time_point begin = Clock::now();
    // Called every few milliseconds; between two steps of the work the mesh can be had. Returning false would end the work here.
    const auto show = [&](const hmesh::ProgressInfo& info) {
        if (!info.mesh_so_far) return true;
        const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
        const hmesh::Mesh mesh = info.mesh_so_far();
        const hmesh::RenderResult<3> picture = hmesh::render<3>(mesh.view());
        std::printf("%6.2f s %4.0f %%  %-8s %7zu vertices %6.2f dB\n", seconds, 100 * info.total, info.stage, info.vertices,
                    hmesh::psnr<std::uint8_t, float, 3>(image, picture.image.view()));
        return argc < 3 || write(mesh, argv[2]);
    };
    hmesh::Options options;
    options.progress = show;
    const hmesh::Result result = hmesh::mesh_image(image, options);
    stbi_image_free(pixels);
    if (!result.status) {
        std::fprintf(stderr, "%s: %s\n", argv[1], hmesh::message(result.status).c_str());
        return 1;
    }
    return 0;
}
