// draw_texture - draws one of the example's textures, 256 x 256 px: draw_texture bricks|planks|marble FILE.ppm, or leaf FILE.tga,
// which has alpha
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

namespace {

constexpr int size = 256;

struct Rgba {
    double red, green, blue, alpha = 1;  // in [0, 1]
};

Rgba mix(const Rgba& a, const Rgba& b, double share) {
    const double t = std::clamp(share, 0.0, 1.0);
    return {a.red + (b.red - a.red) * t, a.green + (b.green - a.green) * t, a.blue + (b.blue - a.blue) * t};
}

// A number in [0, 1] for each point of a grid that repeats after `period` points, so that textures tile.
double lattice(int x, int y, int period) {
    std::uint32_t h = static_cast<std::uint32_t>(x % period) * 73856093U ^ static_cast<std::uint32_t>(y % period) * 19349663U;
    h = (h ^ (h >> 13)) * 1274126177U;
    return static_cast<double>((h ^ (h >> 16)) & 0xffff) / 65535;
}

// Smooth noise in [0, 1], `period` waves to the texture's side.
double noise(double u, double v, int period) {
    const double x = u * period, y = v * period;
    const int i = static_cast<int>(x), j = static_cast<int>(y);
    const auto ease = [](double t) { return t * t * (3 - 2 * t); };
    const double s = ease(x - i), t = ease(y - j);
    const double above = lattice(i, j, period) * (1 - s) + lattice(i + 1, j, period) * s;
    const double below = lattice(i, j + 1, period) * (1 - s) + lattice(i + 1, j + 1, period) * s;
    return above * (1 - t) + below * t;
}

Rgba bricks(double u, double v) {
    const int row = static_cast<int>(8 * v);
    const double along = 4 * u + 0.5 * (row % 2), across = 8 * v - row;
    const double rim = std::min({along - std::floor(along), std::ceil(along) - along, 0.5 * across, 0.5 * (1 - across)});
    const double shade = lattice(static_cast<int>(along) % 4, row, 8);
    const Rgba brick = mix({0.55, 0.22, 0.15}, {0.75, 0.38, 0.25}, 0.6 * shade + 0.4 * noise(u, v, 32));
    return mix({0.72, 0.70, 0.66}, brick, (rim - 0.03) * 60);
}

Rgba planks(double u, double v) {
    const int plank = static_cast<int>(5 * u);
    const double along = v + lattice(plank, 3, 8), across = 5 * u - plank;
    const double grain = 0.5 + 0.5 * std::sin(40 * across + 9 * noise(u, along - std::floor(along), 4));
    const Rgba wood = mix({0.45, 0.29, 0.16}, {0.68, 0.49, 0.30}, 0.5 * grain + 0.5 * lattice(plank, 7, 8));
    return mix({0.14, 0.09, 0.05}, wood, std::min(across, 1 - across) * 40);
}

Rgba marble(double u, double v) {
    double turbulence = 0;
    for (int period = 4, k = 1; period <= 32; period *= 2, k *= 2) turbulence += std::fabs(noise(u, v, period) - 0.5) / k;
    const double vein = std::pow(std::fabs(std::sin(6.283185307179586 * (u + v + turbulence))), 0.3);
    return mix({0.32, 0.33, 0.38}, {0.93, 0.92, 0.90}, vein);
}

Rgba leaf(double u, double v) {
    const double along = (v - 0.05) / 0.9, half = 0.42 * std::pow(std::sin(3.14159265 * std::clamp(along, 0.0, 1.0)), 0.8);
    const double across = std::fabs(u - 0.5), rim = half * (0.94 + 0.06 * std::cos(60 * along));
    const double vein = std::min(across, 0.1 * std::fabs(std::sin(25 * (along + across))));
    Rgba color = mix({0.78, 0.85, 0.45}, mix({0.16, 0.42, 0.12}, {0.42, 0.62, 0.20}, along), vein * 90);
    color.alpha = std::clamp((rim - across) * size, 0.0, 1.0);
    return color;
}

}  // namespace

int main(int argc, char** argv) {
    const std::string name = argc == 3 ? argv[1] : "";
    const bool has_alpha = name == "leaf";
    const auto draw = name == "bricks"   ? bricks
                      : name == "planks" ? planks
                      : name == "marble" ? marble
                      : has_alpha        ? leaf
                                         : nullptr;
    if (draw == nullptr) {
        std::fprintf(stderr, "usage: draw_texture bricks|planks|marble|leaf FILE\n");
        return 2;
    }
    // A PPM file, or a TGA file of 32 bits a pixel, of which 8 are alpha, from the upper left on.
    std::string head = "P6\n" + std::to_string(size) + " " + std::to_string(size) + "\n255\n";
    if (has_alpha) head = {0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, size & 255, size >> 8, size & 255, size >> 8, 32, 0x28};
    std::vector<unsigned char> samples;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            const Rgba color = draw((x + 0.5) / size, (y + 0.5) / size);
            const auto samples_of = has_alpha ? std::vector{color.blue, color.green, color.red, color.alpha}
                                              : std::vector{color.red, color.green, color.blue};
            for (const double value : samples_of)
                samples.push_back(static_cast<unsigned char>(std::lround(255 * std::clamp(value, 0.0, 1.0))));
        }
    std::FILE* file = std::fopen(argv[2], "wb");
    const bool written = file != nullptr && std::fwrite(head.data(), 1, head.size(), file) == head.size() &&
                         std::fwrite(samples.data(), 1, samples.size(), file) == samples.size();
    const bool closed = file != nullptr && std::fclose(file) == 0;
    if (written && closed) return 0;
    std::fprintf(stderr, "draw_texture: cannot write '%s'\n", argv[2]);
    return 1;
}
