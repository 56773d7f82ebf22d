// heightmap - terrain as triangles: one 16-bit channel of heights becomes an OBJ model, its vertices where the ground bends.
//
// usage: heightmap FILE.obj [HEIGHTS.png]        8 or 16 bits; without HEIGHTS: an island of its own
//
// The colour that hmesh fits to each vertex is its height; where vertices lie, and which triangles join them, is chosen so that
// the squared error of the heights is least. A grid of squares with as many vertices is the usual terrain: its error is
// printed beside that of the mesh.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <vector>

#include "hmesh/mesh_image.hpp"
#include "hmesh/render.hpp"

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

struct Error {
    double root_mean_square = 0, largest = 0;  // as shares of the full height
};

Error error_of(const Heights& heights, const hmesh::MeshView& terrain) {
    const auto [drawn, status] = hmesh::render<1>(terrain);
    if (!status) return {1, 1};
    Error error;
    for (std::size_t i = 0; i < drawn.size(); ++i) {
        const double difference = std::fabs(static_cast<double>(drawn.data()[i]) - heights.data()[i]) / 65535;
        error.root_mean_square += difference * difference;
        error.largest = std::max(error.largest, difference);
    }
    error.root_mean_square = std::sqrt(error.root_mean_square / static_cast<double>(drawn.size()));
    return error;
}

// Squares, as many vertices as the mesh has or a few less, each with the height of the pixel under it.
hmesh::Mesh grid_terrain(const Heights& heights, std::size_t vertices) {
    hmesh::Mesh grid;
    grid.channels = 1;
    grid.width = heights.width();
    grid.height = heights.height();
    grid.peak = 65535;
    const double ratio = static_cast<double>(grid.width) / grid.height;
    const int columns = std::max(2, static_cast<int>(std::sqrt(static_cast<double>(vertices) * ratio)));
    const int rows = std::max(2, static_cast<int>(vertices) / columns);
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i) {
            const int x = i * grid.width / (columns - 1), y = j * grid.height / (rows - 1);
            grid.positions.insert(grid.positions.end(), {static_cast<float>(x), static_cast<float>(y)});
            grid.colors.push_back(*heights.pixel(std::min(x, grid.width - 1), std::min(y, grid.height - 1)));
        }
    for (int j = 0; j + 1 < rows; ++j)
        for (int i = 0; i + 1 < columns; ++i) {
            const auto corner = static_cast<std::uint32_t>(j * columns + i), below = corner + static_cast<std::uint32_t>(columns);
            grid.faces.push_back({corner, corner + 1, below});
            grid.faces.push_back({corner + 1, below + 1, below});
        }
    return grid;
}

// x to the right, y up from the ground, z towards the viewer; one unit is one pixel. Seen from above, faces of a mesh are
// clockwise as in the image; those of an OBJ file are to be counter-clockwise, so two corners change places.
bool write_terrain(const hmesh::Mesh& mesh, const char* path) {
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path, "wb"), std::fclose);
    if (!file) return false;
    const double unit = relief * mesh.width / 65535;
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
        std::fprintf(file.get(), "v %.3f %.3f %.3f\n", static_cast<double>(mesh.positions[2 * v]),
                     unit * static_cast<double>(mesh.colors[v]), static_cast<double>(mesh.positions[2 * v + 1]));
    for (const auto& [a, b, c] : mesh.faces) std::fprintf(file.get(), "f %u %u %u\n", a + 1, c + 1, b + 1);
    return std::fflush(file.get()) == 0 && std::ferror(file.get()) == 0;
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

    const hmesh::Result result = hmesh::mesh_image(heights.view(), {}, hmesh::Annealed{hmesh::Effort::fast});
    if (!result.has_mesh()) {
        std::fprintf(stderr, "heightmap: %s\n", hmesh::message(result.status).c_str());
        return 1;
    }

    const hmesh::Mesh grid = grid_terrain(heights, result.report.vertices);
    const Error mesh_error = error_of(heights, result.mesh.view()), grid_error = error_of(heights, grid.view());
    std::printf("%d x %d heights; errors as shares of the full height\n", heights.width(), heights.height());
    std::printf("mesh %7zu vertices, root mean square %.5f, largest %.4f\n", result.report.vertices, mesh_error.root_mean_square,
                mesh_error.largest);
    std::printf("grid %7zu vertices, root mean square %.5f, largest %.4f\n", grid.vertex_count(), grid_error.root_mean_square,
                grid_error.largest);
    if (!write_terrain(result.mesh, argv[1])) {
        std::fprintf(stderr, "heightmap: cannot write '%s'\n", argv[1]);
        return 1;
    }
    return 0;
}
