// heightmap - terrain as triangles: one 16-bit channel of heights becomes an OBJ model, with as few triangles as are nowhere off
// by more than a hundredth of the heights' range.
//
// usage: heightmap FILE.obj [HEIGHTS.png]        8 or 16 bits; without HEIGHTS: an island of its own
//
// Heights are points, from which to the next is one unit. The command hmesh-terrain does the same with files of elevation, in
// metres, with holes and in tiles.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>

#include "hmesh/terrain.hpp"

#define STBI_ONLY_PNG  // of PGM, stb_image before 2.28 swaps the bytes of 16-bit samples
#define STB_IMAGE_IMPLEMENTATION
#include <stb_image.h>

namespace {

using Heights = hmesh::Image<std::uint16_t, 1>;

constexpr double relief = 0.15;  // full height (65535) as a share of the terrain's width

// A mountain ridge that sinks into a flat sea; ravines by folded waves of ever shorter length.
Heights draw_island(int width, int height) {
    Heights heights(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double u = (x + 0.5) / width - 0.5, v = (y + 0.5) / height - 0.5;
            double ground = 0.75 - 2.4 * std::hypot(u, v) + 0.25 * std::exp(-60 * (u + v) * (u + v));
            double a = 9 * u + 2, b = 9 * v + 1;
            for (double size = 0.12; size > 0.004; size *= 0.5) {
                ground += size * (1 - 2 * std::fabs(std::sin(a + 1.3 * std::sin(b))));
                const double turned = 1.6 * a + 1.2 * b;
                b = 1.6 * b - 1.2 * a + 1;
                a = turned;
            }
            *heights.pixel(x, y) = static_cast<std::uint16_t>(65535 * std::clamp(ground, 0.0, 1.0));
        }
    return heights;
}

// False where the file cannot be read, as stbi_failure_reason() says. 8 bits are stretched to 16, colours become grey.
bool read_heights(const char* path, Heights& heights) {
    int width = 0, height = 0;
    const std::unique_ptr<stbi_us, void (*)(void*)> samples(stbi_load_16(path, &width, &height, nullptr, 1), stbi_image_free);
    if (!samples) return false;
    heights = Heights(width, height);
    std::copy_n(samples.get(), heights.size(), heights.data());
    return true;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2 && argc != 3) {
        std::fprintf(stderr, "usage: heightmap FILE.obj [HEIGHTS.png]\n");
        return 2;
    }
    Heights heights = draw_island(512, 512);
    if (argc == 3 && !read_heights(argv[2], heights)) {
        std::fprintf(stderr, "heightmap: cannot read '%s': %s\n", argv[2], stbi_failure_reason());
        return 1;
    }

    const auto [low, high] = std::minmax_element(heights.data(), heights.data() + heights.size());
    hmesh::Options options;
    options.samples = hmesh::Samples::points;
    const hmesh::Result terrain = hmesh::mesh_image(heights.view(), options, hmesh::Bounded{0.01 * (*high - *low)});
    if (!terrain.has_mesh()) {
        std::fprintf(stderr, "heightmap: %s\n", hmesh::message(terrain.status).c_str());
        return 1;
    }
    std::printf("%d x %d heights from %d to %d: %zu triangles of %d, nowhere off by more than %.1f\n", heights.width(),
                heights.height(), *low, *high, terrain.report.faces, 2 * (heights.width() - 1) * (heights.height() - 1),
                terrain.report.max_error);

    hmesh::HeightOptions model;
    model.z.scale = relief * heights.width() / 65535;
    model.up = hmesh::UpAxis::y;  // as most programs that read OBJ have it
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(argv[1], "wb"), std::fclose);
    const auto sink = [&](const void* bytes, std::size_t size) { return std::fwrite(bytes, 1, size, file.get()) == size; };
    // The normals are those of all heights, not of the triangles.
    if (!file || !hmesh::write_height_obj(terrain.mesh.view(), heights.view(), sink, model) || std::fflush(file.get()) != 0) {
        std::fprintf(stderr, "heightmap: cannot write '%s'\n", argv[1]);
        return 1;
    }
    return 0;
}
