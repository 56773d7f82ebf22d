// periodic: meshes of textures that tile, beside plain ones of as many vertices, as Markdown tables.
//
//     periodic [--vertices 655,1311] [--efforts normal] [--repeat 3] [--only bricks,rock] [--pictures FOLDER] [IMAGE...]
//
// The textures bricks, rock and wood, 256 px wide and high, are made by code and tile; of each IMAGE a crop of 256 px is
// cross-faded so that it does. Columns: PSNR of all pixels, of those within 2 px of the lines where the texture repeats, of the
// same pixels in a plain mesh of the texture moved by half its size, where they are in the middle, and of the other pixels; the
// largest jump of a channel of the drawn colour from one side of the mesh's border to the other, of 255; vertices in the mesh,
// those of the border counted for each side; faces; processor time, the least of the repeats, which take turns, over that of the
// plain mesh. --pictures writes what 2 x 2 copies show, 4 times as large, around their common corner.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <hmesh/core/random.hpp>
#include <hmesh/hmesh.hpp>
#include <hmesh/mesh/geometry.hpp>
#include <hmesh/mesh/torus.hpp>

#include "common.hpp"
#include "noise.hpp"

namespace {

constexpr int size = 256;
using bench::clamp01;
using bench::Noise;
using hmesh::kit::Point;

bench::Picture draw(const std::function<std::array<double, 3>(double x, double y)>& color) {
    bench::Picture out(size, size);
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            std::array<double, 3> sum{};  // of 16 samples a pixel
            for (int k = 0; k < 16; ++k) {
                const auto c = color(x + (k % 4 + 0.5) / 4, y + (k / 4 + 0.5) / 4);
                for (std::size_t i = 0; i < 3; ++i) sum[i] += clamp01(c[i]) / 16;
            }
            for (std::size_t i = 0; i < 3; ++i) out.pixel(x, y)[i] = static_cast<std::uint8_t>(255 * sum[i] + 0.5);
        }
    return out;
}

bench::Picture bricks() {
    const Noise wobble_x(size, 16, 16, 1), wobble_y(size, 16, 16, 2), grain(size, 48, 48, 3);
    hmesh::kit::Random random(4);
    std::vector<double> tints;
    for (int i = 0; i < 32; ++i) tints.push_back(random.uniform());
    return draw([&](double x, double y) -> std::array<double, 3> {
        const double v = std::fmod(y + 2 * wobble_y(x, y) + size, size), row = std::floor(v / 32);
        const double u = std::fmod(x + 2 * wobble_x(x, y) + (static_cast<int>(row) % 2 == 1 ? 32 : 0) + 11 + size, size);
        const double column = std::floor(u / 64), in_x = u - 64 * column, in_y = v - 32 * row;
        const double depth = std::min({in_x, 64 - in_x, in_y, 32 - in_y});
        const double brick = clamp01((depth - 2) / 1.5), shade = 0.85 + 0.15 * clamp01(depth / 8) + 0.1 * (grain(x, y) - 0.5);
        const double tint = tints[static_cast<std::size_t>(row * 4 + column)];
        const std::array<double, 3> of_brick{(0.5 + 0.2 * tint) * shade, (0.22 + 0.1 * tint) * shade,
                                             (0.16 + 0.06 * tint) * shade};
        std::array<double, 3> out{};
        for (std::size_t i = 0; i < 3; ++i) out[i] = brick * of_brick[i] + (1 - brick) * (0.62 + 0.06 * grain(x, y));
        return out;
    });
}

bench::Picture rock() {
    std::vector<Noise> octaves;
    for (int k = 0; k < 5; ++k) octaves.emplace_back(size, 4 << k, 4 << k, 10 + static_cast<std::uint64_t>(k));
    return draw([&](double x, double y) -> std::array<double, 3> {
        double sum = 0, weight = 0.5;
        for (const Noise& octave : octaves) sum += weight * octave(x, y), weight *= 0.5;
        const double ridge = std::abs(2 * sum - 1);
        return {0.25 + 0.5 * sum, 0.25 + 0.45 * sum + 0.05 * ridge, 0.24 + 0.38 * sum + 0.1 * ridge};
    });
}

bench::Picture wood() {
    const Noise bend(size, 3, 2, 20), fine(size, 64, 4, 21), knots(size, 2, 2, 22);
    return draw([&](double x, double y) -> std::array<double, 3> {
        const double phase = 12 * x / size + 1.5 * bend(x, y) + 0.8 * knots(x, y);
        const double ring = phase - std::floor(phase), dark = ring < 0.85 ? ring / 0.85 : (1 - ring) / 0.15;
        const double level = 0.75 - 0.3 * dark * dark + 0.08 * (fine(x, y) - 0.5);
        return {level, 0.68 * level, 0.42 * level};
    });
}

// A crop from the middle that repeats: its last 32 px fade into those before its first.
bench::Picture cross_faded(const bench::Picture& image) {
    constexpr int fade = 32;
    const int left = std::max(fade, (image.width() - size) / 2), top = std::max(fade, (image.height() - size) / 2);
    const auto weight = [](int at) { return std::max(0.0, (at - (size - fade) + 0.5) / fade); };
    bench::Picture out(size, size);
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x)
            for (int c = 0; c < 3; ++c) {
                const double a = weight(x), b = weight(y);
                const auto at = [&](int dx, int dy) {
                    const int i = std::clamp(left + x - dx, 0, image.width() - 1),
                              j = std::clamp(top + y - dy, 0, image.height() - 1);
                    return static_cast<double>(image.pixel(i, j)[c]);
                };
                const double value =
                    (1 - b) * ((1 - a) * at(0, 0) + a * at(size, 0)) + b * ((1 - a) * at(0, size) + a * at(size, size));
                out.pixel(x, y)[c] = static_cast<std::uint8_t>(value + 0.5);
            }
    return out;
}

double psnr_of(double squares, double count) { return 10 * std::log10(255.0 * 255.0 * 3 * count / squares); }

struct Fidelity {
    double all = 0, near = 0, others = 0;  // dB
};

// The image that begins in the middle of another one.
bench::Picture rolled(const bench::Picture& image) {
    bench::Picture out(size, size);
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) std::copy_n(image.pixel((x + size / 2) % size, (y + size / 2) % size), 3, out.pixel(x, y));
    return out;
}

// `line`: where the texture begins again, px.
Fidelity fidelity(const bench::Picture& image, const hmesh::Mesh& mesh, int line = 0) {
    const auto drawn = hmesh::render<3>(mesh.view());
    double squares[2] = {}, counts[2] = {};
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            const auto beside = [&](int at) { return (at - line + 2 + size) % size < 4; };
            const bool is_near = beside(x) || beside(y);
            ++counts[is_near];
            for (int c = 0; c < 3; ++c) {
                const double d = static_cast<double>(drawn.image.pixel(x, y)[c]) - image.pixel(x, y)[c];
                squares[is_near] += d * d;
            }
        }
    return {psnr_of(squares[0] + squares[1], counts[0] + counts[1]), psnr_of(squares[1], counts[1]),
            psnr_of(squares[0], counts[0])};
}

// The colour at p, given by the face that holds q, of the mesh and its copies.
std::array<double, 3> color_beside(const hmesh::Mesh& mesh, Point p, Point q) {
    double best = -1e300;
    std::array<double, 3> out{};
    for (const hmesh::Triangle& face : mesh.faces)
        for (int j = -1; j <= 1; ++j)
            for (int i = -1; i <= 1; ++i) {
                Point at[3];
                for (std::size_t k = 0; k < 3; ++k)
                    at[k] = {static_cast<double>(mesh.positions[2 * std::size_t{face[k]}]) + i * size,
                             static_cast<double>(mesh.positions[2 * std::size_t{face[k]} + 1]) + j * size};
                const auto inside = hmesh::kit::barycentric(at[0], at[1], at[2], q);
                const double least = std::min({inside.a, inside.b, inside.c});
                if (least <= best) continue;
                best = least;
                const auto w = hmesh::kit::barycentric(at[0], at[1], at[2], p);
                for (std::size_t c = 0; c < 3; ++c)
                    out[c] = w.a * static_cast<double>(mesh.colors[3 * std::size_t{face[0]} + c]) +
                             w.b * static_cast<double>(mesh.colors[3 * std::size_t{face[1]} + c]) +
                             w.c * static_cast<double>(mesh.colors[3 * std::size_t{face[2]} + c]);
            }
    return out;
}

// The largest jump of a channel over the mesh's border, at 3 places of each edge.
double largest_jump(const hmesh::Mesh& mesh) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
    for (const hmesh::Triangle& f : mesh.faces)
        for (std::size_t k = 0; k < 3; ++k) ++sides[{f[k], f[(k + 1) % 3]}];
    double jump = 0;
    for (const auto& [side, count] : sides) {
        const auto [a, b] = side;
        if (sides.count({b, a}) != 0) continue;
        const auto at = [&](std::uint32_t v) {
            return Point{static_cast<double>(mesh.positions[2 * std::size_t{v}]),
                         static_cast<double>(mesh.positions[2 * std::size_t{v} + 1])};
        };
        const Point p = at(a), q = at(b);
        const double dx = q.x - p.x, dy = q.y - p.y, length = std::hypot(dx, dy);
        for (const double t : {0.2, 0.5, 0.8}) {
            const Point on{p.x + t * dx, p.y + t * dy};
            const Point beyond{on.x + 1e-6 * dy / length, on.y - 1e-6 * dx / length};
            const auto outer = color_beside(mesh, on, beyond);
            for (std::size_t c = 0; c < 3; ++c) {
                const double inner = (1 - t) * static_cast<double>(mesh.colors[3 * std::size_t{a} + c]) +
                                     t * static_cast<double>(mesh.colors[3 * std::size_t{b} + c]);
                jump = std::max(jump, std::abs(inner - outer[c]));
            }
        }
    }
    return jump;
}

struct Variant {
    const char* name;
    hmesh::Periodic periodic;
    bool straight;
};
constexpr Variant variants[] = {
    {"plain", hmesh::Periodic::none, false}, {"jagged", hmesh::Periodic::xy, false}, {"straight", hmesh::Periodic::xy, true}};

// 2 x 2 copies around their common corner, 64 px of each, enlarged.
void write_corner(const hmesh::Mesh& mesh, const std::string& path) {
    constexpr int scale = 4, part = 64;
    hmesh::RenderOptions options;
    options.width = options.height = size * scale;
    const auto drawn = hmesh::render<3>(mesh.view(), options);
    constexpr int side = 2 * part * scale, all = size * scale;
    tool::Picture out{side, side, 3, {}};
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x)
            for (int c = 0; c < 3; ++c) {
                const int i = (x + all - part * scale) % all, j = (y + all - part * scale) % all;
                const double value = static_cast<double>(drawn.image.pixel(i, j)[c]);
                out.samples.push_back(static_cast<std::uint8_t>(std::max(0.0, std::min(255.0, value + 0.5))));
            }
    std::FILE* const file = std::fopen(path.c_str(), "wb");
    if (file == nullptr) return;
    const auto sink = [&](const void* bytes, std::size_t count) { return std::fwrite(bytes, 1, count, file) == count; };
    (void)tool::write_png(out, sink);
    std::fclose(file);
}

}  // namespace

int main(int argc, char** argv) {
    std::vector<std::string> counts{"655", "1311"}, efforts{"normal"}, only, paths;
    std::string folder;
    int repeats = 3;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        const bool has_value = i + 1 < argc;
        if (word == "--vertices" && has_value) counts = bench::split(argv[++i]);
        else if (word == "--efforts" && has_value) efforts = bench::split(argv[++i]);
        else if (word == "--repeat" && has_value) repeats = std::max(1, std::atoi(argv[++i]));
        else if (word == "--only" && has_value) only = bench::split(argv[++i]);
        else if (word == "--pictures" && has_value) folder = argv[++i];
        else paths.push_back(word);
    }
    std::vector<std::pair<std::string, bench::Picture>> textures;
    textures.emplace_back("bricks", bricks());
    textures.emplace_back("rock", rock());
    textures.emplace_back("wood", wood());
    for (const std::string& path : paths) {
        const auto image = bench::read("periodic", path);
        if (!image) return 1;
        const std::size_t slash = path.find_last_of('/');
        const std::string file = slash == std::string::npos ? path : path.substr(slash + 1);
        textures.emplace_back(file.substr(0, file.find_last_of('.')), cross_faded(*image));
    }
    std::printf(
        "| texture | vertices | effort | border | PSNR | within 2 px | these in the middle | others | jump | in the mesh | faces "
        "| time |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (const auto& [name, image] : textures)
        for (const std::string& count : counts)
            for (const std::string& effort : efforts) {
                if (!only.empty() && std::count(only.begin(), only.end(), name) == 0) continue;
                hmesh::Annealed recipe;
                if (!bench::effort_of(effort, recipe.effort)) return 1;
                std::array<hmesh::Mesh, 3> meshes;
                std::array<double, 3> seconds{1e9, 1e9, 1e9};
                for (int k = 0; k < repeats; ++k)
                    for (std::size_t v = 0; v < 3; ++v) {
                        hmesh::Options options;
                        options.target = hmesh::Target::vertices(std::atoll(count.c_str()));
                        options.periodic = variants[v].periodic;
                        options.straight_border = variants[v].straight;
                        const double begin = bench::processor_seconds();
                        hmesh::Result result = hmesh::mesh_image(image.view(), options, recipe);
                        seconds[v] = std::min(seconds[v], bench::processor_seconds() - begin);
                        if (!result.status) return 1;
                        meshes[v] = std::move(result.mesh);
                    }
                hmesh::Options options;
                options.target = hmesh::Target::vertices(std::atoll(count.c_str()));
                const bench::Picture moved = rolled(image);
                const hmesh::Result middle = hmesh::mesh_image(moved.view(), options, recipe);
                const double in_the_middle = fidelity(moved, middle.mesh, size / 2).near;
                for (std::size_t v = 0; v < 3; ++v) {
                    const Fidelity f = fidelity(image, meshes[v]);
                    std::printf("| %s | %s | %s | %s | %.2f | %.2f | %.2f | %.2f | %.1f | %zu | %zu | %.2f |\n", name.c_str(),
                                count.c_str(), effort.c_str(), variants[v].name, f.all, f.near, in_the_middle, f.others,
                                largest_jump(meshes[v]), meshes[v].vertex_count(), meshes[v].face_count(),
                                seconds[v] / seconds[0]);
                    std::fflush(stdout);
                    if (!folder.empty())
                        write_corner(meshes[v],
                                     folder + "/" + name + "-" + count + "-" + effort + "-" + variants[v].name + ".png");
                }
            }
}
