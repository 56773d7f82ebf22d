// relief - shows what a bound makes of heights: relief DIRECTORY
//
// Writes DIRECTORY/EFFORT.jpg for some efforts of the recipe Bounded: the shaded relief of its mesh beside the mesh's edges, of
// mountains of the program's own around a lake without data; and prints a Markdown table of them.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>

#include <hmesh/render.hpp>
#include <hmesh/terrain.hpp>

#include "writers/output_file.hpp"
#include "writers/picture_file.hpp"
#include "writers/pictures.hpp"
#include "writers/wireframe.hpp"

namespace {

using tool::Rgb;

constexpr int width = 241, height = 181;  // samples
constexpr int scale = 2;                  // pixels of the pictures from sample to sample
constexpr double range = 1000, bound = 0.02 * range;

// In [0, 1], of one point of a grid.
double noise_at(int x, int y, std::uint32_t layer) {
    std::uint32_t h =
        static_cast<std::uint32_t>(x) * 0x9e3779b1U ^ static_cast<std::uint32_t>(y) * 0x85ebca77U ^ layer * 0xc2b2ae3dU;
    h = (h ^ (h >> 15U)) * 0x2c1b3c6dU;
    h = (h ^ (h >> 12U)) * 0x297a2d39U;
    return (h ^ (h >> 15U)) * (1.0 / 4294967295.0);
}
// Between the points of a grid, without a bend.
double noise(double x, double y, std::uint32_t layer) {
    const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
    const auto ease = [](double t) { return t * t * t * (t * (t * 6 - 15) + 10); };
    const double s = ease(x - i), t = ease(y - j);
    const auto row = [&](int at) { return (1 - s) * noise_at(i, at, layer) + s * noise_at(i + 1, at, layer); };
    return (1 - t) * row(j) + t * row(j + 1);
}
// Ridges, each layer narrower, lower and turned, and rough where it is high; in (0, range].
double height_at(int x, int y) {
    double sum = 0, rough = 1, share = 0.5;
    double u = x / 80.0 + 0.6 * noise(x / 60.0, y / 60.0, 20), v = y / 80.0 + 0.6 * noise(x / 60.0, y / 60.0, 21);
    for (std::uint32_t layer = 0; layer < 6; ++layer, share *= 0.45) {
        const double ridge = 1 - std::abs(2 * noise(u, v, layer) - 1);
        sum += share * rough * ridge * ridge;
        rough = std::min(1.0, 1.6 * ridge * ridge);
        const double turned = 1.6 * u - 1.2 * v;  // twice as fine
        v = 1.2 * u + 1.6 * v;
        u = turned;
    }
    return range * std::min(1.0, 0.02 + 1.2 * sum);
}

// Lit from the north-west; higher is lighter. 0 is no height, and white.
Rgb shaded(const hmesh::Image<float, 1>& heights) {
    Rgb picture(heights.width(), heights.height());
    for (int y = 0; y < picture.height(); ++y)
        for (int x = 0; x < picture.width(); ++x) {
            const double own = static_cast<double>(*heights.pixel(x, y));
            const auto at = [&](int i, int j) {
                const double value = static_cast<double>(
                    *heights.pixel(std::clamp(i, 0, picture.width() - 1), std::clamp(j, 0, picture.height() - 1)));
                return value > 0 ? value : own;
            };
            constexpr double steep = 0.035 * scale;  // of a unit of height a pixel
            const double dx = steep * (at(x + 1, y) - at(x - 1, y)) / 2, dy = steep * (at(x, y + 1) - at(x, y - 1)) / 2;
            const double light = (0.5 * dx + 0.5 * dy + 0.70710678) / std::sqrt(1 + dx * dx + dy * dy);
            const double tone = 0.25 + 0.75 * std::max(0.0, light), rise = own / range;
            const double land[3] = {130 + 125 * rise, 150 + 95 * rise, 100 + 140 * rise};
            for (int c = 0; c < 3; ++c)
                picture.pixel(x, y)[c] =
                    own > 0 ? static_cast<std::uint8_t>(std::clamp(tone * land[c], 0.0, 255.0)) : std::uint8_t{255};
        }
    return picture;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: relief DIRECTORY\n");
        return 2;
    }
    hmesh::Image<float, 1> heights(width, height);
    hmesh::Image<std::uint8_t, 1> mask(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            *heights.pixel(x, y) = static_cast<float>(height_at(x, y));
            const double far = std::hypot((x - 168) / 34.0, (y - 118) / 22.0) + 0.5 * noise(x / 16.0, y / 16.0, 9);
            *mask.pixel(x, y) = far > 1 ? 1 : 0;
        }
    struct Named {
        const char* name;
        hmesh::Bounded::Effort effort;
    };
    for (const Named& wanted : {Named{"draft", hmesh::Bounded::Effort::draft}, Named{"best", hmesh::Bounded::Effort::best}}) {
        hmesh::Options options;
        options.samples = hmesh::Samples::points;
        options.mask = mask.view();
        const hmesh::Result result = hmesh::mesh_image(heights.view(), options, hmesh::Bounded{bound, wanted.effort});
        hmesh::RenderOptions size;
        size.width = scale * (width - 1) + 1;
        size.height = scale * (height - 1) + 1;
        const hmesh::RenderResult<1> drawn = hmesh::render<1>(result.mesh.view(), size);
        if (!result.status || !drawn.status) return 1;
        const Rgb relief = shaded(drawn.image);
        Rgb edges(relief.width(), relief.height());
        std::fill(edges.data(), edges.data() + edges.size(), std::uint8_t{255});
        tool::WireframeOptions lines;
        lines.color = {40, 60, 90};
        lines.opacity = 1;
        if (!tool::draw_wireframe(result.mesh.view(), edges, lines)) return 1;
        const std::string name = wanted.name + std::string(".jpg");
        tool::OutputFile file(argv[1] + ("/" + name));
        if (!file.open() || !tool::write_jpeg(tool::to_picture(tool::side_by_side({relief, edges})), 85, file) ||
            !file.commit()) {
            std::fprintf(stderr, "relief: cannot write '%s/%s': %s\n", argv[1], name.c_str(), file.error().c_str());
            return 1;
        }
        std::printf("| `%s`: %zu triangles, off by at most %.1f of %.0f | ![%s](terrain/%s) |\n", wanted.name,
                    result.report.faces, result.report.max_error, range, wanted.name, name.c_str());
    }
}
