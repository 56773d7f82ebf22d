// mesh_or_texture: the bytes of meshes in video memory beside those of textures that show as much, as a Markdown table.
//
//     mesh_or_texture [--vertices 256,1024,4096] [--step 16] [--preset -thorough] [IMAGE...]
//
// Images have 3 or 4 channels of 8 bits; without any, two are drawn here: panels of a user interface, 512 x 512 px, and a smooth
// sky, 1024 x 512 px. Textures need astcenc on the path (Debian: astcenc).
//
// A mesh has colours of 8 bits and positions of 16, 8 bytes a vertex, and indices of 16 bits: those of pack_for_gpu(), as list
// and as strips. It is fitted on the grid of 1/STEP px and drawn from what its buffers hold. A texture is ASTC of each of the 14
// sizes of blocks, or RGBA8, at full size or with a half, a quarter, an eighth or a sixteenth of the sides (means of squares of
// pixels), magnified bilinearly; one level, without a mip chain, which would add a third. "texture" is the one of fewest bytes
// whose PSNR is at least the mesh's, "full size" that of those which are not reduced, and "times" how many times its bytes are
// those of the mesh, as list and as strips.
//
// PSNR: 10 log10(255^2 / MSE), the mean over pixels and channels of the two pictures rounded to 8 bits. Images with alpha are
// multiplied by it first, all four channels count, and faces that show nothing are dropped from their meshes.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <hmesh/gpu.hpp>
#include <hmesh/hmesh.hpp>

#include "common.hpp"

namespace {

template <int C>
using Pixels = hmesh::Image<std::uint8_t, C>;

struct Settings {
    std::vector<std::string> vertices{"256", "1024", "4096"};
    double step = 16;                  // of positions, a px
    std::string preset = "-thorough";  // of astcenc
    std::filesystem::path folder;      // for its files
};

// --- meshes ---
// The mesh that the vertex buffer holds, with faces as they are: what a GPU draws.
hmesh::Mesh as_packed(const hmesh::Mesh& mesh, const hmesh::GpuBuffers& list) {
    hmesh::Mesh packed;
    packed.channels = mesh.channels, packed.width = mesh.width, packed.height = mesh.height;
    packed.peak = mesh.peak, packed.premultiplied = mesh.premultiplied;
    for (std::size_t v = 0; v < list.vertex_count(); ++v) {
        const std::uint8_t* const at = &list.vertices[v * list.layout.stride];
        for (std::size_t axis = 0; axis < 2; ++axis) {
            const double share = (at[2 * axis] + 256.0 * at[2 * axis + 1]) / 65535;
            packed.positions.push_back(static_cast<float>(static_cast<double>(list.layout.offset[axis]) +
                                                          static_cast<double>(list.layout.scale[axis]) * share));
        }
        for (int k = 0; k < mesh.channels; ++k)
            packed.colors.push_back(at[list.layout.color.offset + static_cast<std::size_t>(k)]);
    }
    const auto index = [&](std::size_t i) { return list.indices[2 * i] + 256U * list.indices[2 * i + 1]; };
    for (const hmesh::GpuChunk& chunk : list.chunks)
        for (std::size_t i = chunk.first_index; i + 2 < chunk.first_index + chunk.index_count; i += 3)
            packed.faces.push_back(
                {chunk.first_vertex + index(i), chunk.first_vertex + index(i + 1), chunk.first_vertex + index(i + 2)});
    return packed;
}

// --- textures ---
struct Texture {
    std::string name;
    std::size_t bytes = 0;
    double psnr = 0;
    bool is_full_size = true;
};

// Each pixel the mean of factor x factor.
template <int C>
Pixels<C> reduced(const Pixels<C>& picture, int factor) {
    Pixels<C> small(picture.width() / factor, picture.height() / factor);
    for (int y = 0; y < small.height(); ++y)
        for (int x = 0; x < small.width(); ++x)
            for (int k = 0; k < C; ++k) {
                int sum = 0;
                for (int i = 0; i < factor * factor; ++i)
                    sum += picture.pixel(factor * x + i % factor, factor * y + i / factor)[k];
                small.pixel(x, y)[k] = static_cast<std::uint8_t>((2 * sum + factor * factor) / (2 * factor * factor));
            }
    return small;
}

// The picture as a GPU's bilinear filter shows it, clamped at its borders.
template <int C>
Pixels<C> magnified(const Pixels<C>& small, int width, int height) {
    Pixels<C> picture(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double u = std::clamp((x + 0.5) * small.width() / width - 0.5, 0.0, small.width() - 1.0);
            const double v = std::clamp((y + 0.5) * small.height() / height - 0.5, 0.0, small.height() - 1.0);
            const int left = static_cast<int>(u), top = static_cast<int>(v);
            const int right = std::min(left + 1, small.width() - 1), bottom = std::min(top + 1, small.height() - 1);
            for (int k = 0; k < C; ++k) {
                const double above =
                    small.pixel(left, top)[k] + (u - left) * (small.pixel(right, top)[k] - small.pixel(left, top)[k]);
                const double below =
                    small.pixel(left, bottom)[k] + (u - left) * (small.pixel(right, bottom)[k] - small.pixel(left, bottom)[k]);
                picture.pixel(x, y)[k] = static_cast<std::uint8_t>(std::lround(above + (v - top) * (below - above)));
            }
        }
    return picture;
}

// What is left of the picture by astcenc with these blocks; nothing where that fails.
template <int C>
std::optional<Pixels<C>> through_astc(const Pixels<C>& picture, const std::string& blocks, const Settings& settings) {
    const std::string from = (settings.folder / "in.png").string(), to = (settings.folder / "out.png").string();
    std::ofstream file(from, std::ios::binary);
    const auto sink = [&](const void* bytes, std::size_t size) {
        return static_cast<bool>(file.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(size)));
    };
    const tool::Picture samples{picture.width(), picture.height(), C, {picture.data(), picture.data() + picture.size()}};
    if (!tool::write_png(samples, sink)) return {};
    file.close();
    std::filesystem::remove(to);
    const std::string command =
        "astcenc -tl '" + from + "' '" + to + "' " + blocks + " " + settings.preset + " -j 1 -silent > /dev/null 2>&1";
    if (std::system(command.c_str()) != 0) return {};
    tool::ImageFile read;
    if (!tool::read_image(to, read).empty() || read.bits != 8 || read.channels < C) return {};
    Pixels<C> decoded(picture.width(), picture.height());
    for (int y = 0; y < decoded.height(); ++y)
        for (int x = 0; x < decoded.width(); ++x)
            std::copy_n(&read.samples8[static_cast<std::size_t>((y * read.width + x) * read.channels)], C, decoded.pixel(x, y));
    return decoded;
}

// All textures of the picture, those of fewest bytes first; none where astcenc fails.
template <int C>
std::vector<Texture> textures_of(const Pixels<C>& picture, const Settings& settings) {
    constexpr std::array<std::pair<int, int>, 14> blocks{{{4, 4},
                                                          {5, 4},
                                                          {5, 5},
                                                          {6, 5},
                                                          {6, 6},
                                                          {8, 5},
                                                          {8, 6},
                                                          {8, 8},
                                                          {10, 5},
                                                          {10, 6},
                                                          {10, 8},
                                                          {10, 10},
                                                          {12, 10},
                                                          {12, 12}}};
    std::vector<Texture> textures;
    for (const int factor : {1, 2, 4, 8, 16}) {
        if (picture.width() % factor != 0 || picture.height() % factor != 0) continue;
        const Pixels<C> small = reduced(picture, factor);
        const auto add = [&](const std::string& name, std::size_t bytes, const Pixels<C>& shown) {
            const Pixels<C> large = magnified(shown, picture.width(), picture.height());
            textures.push_back({name + (factor == 1 ? "" : " 1/" + std::to_string(factor)), bytes,
                                hmesh::psnr(picture.view(), large.view()), factor == 1});
        };
        add("RGBA8", small.size() / C * 4, small);
        for (const auto& [width, height] : blocks) {
            const std::string name = std::to_string(width) + "x" + std::to_string(height);
            const auto across = static_cast<std::size_t>((small.width() + width - 1) / width);
            const auto down = static_cast<std::size_t>((small.height() + height - 1) / height);
            const auto decoded = through_astc(small, name, settings);
            if (!decoded) {
                std::fprintf(stderr, "mesh_or_texture: astcenc made no texture with blocks of %s; is it on the path?\n",
                             name.c_str());
                return {};
            }
            add("ASTC " + name, 16 * across * down, *decoded);
        }
    }
    std::stable_sort(textures.begin(), textures.end(), [](const Texture& a, const Texture& b) { return a.bytes < b.bytes; });
    return textures;
}

// --- the table ---
template <int C>
bool print_picture(const std::string& name, const Pixels<C>& picture, const Settings& settings) {
    Pixels<C> wanted = picture;
    if constexpr (C == 4) wanted = hmesh::kit::premultiply(picture.view());
    const std::vector<Texture> textures = textures_of(wanted, settings);
    if (textures.empty()) return false;
    for (const std::string& count : settings.vertices) {
        hmesh::Options options;
        options.target = hmesh::Target::vertices(std::atoll(count.c_str()));
        options.limits.position_step = 1 / settings.step;
        options.premultiplied = C == 4;
        hmesh::Result result = hmesh::mesh_image(picture.view(), options);
        if (!result.has_mesh()) {
            std::fprintf(stderr, "mesh_or_texture: %s: %s\n", name.c_str(), hmesh::message(result.status).c_str());
            return false;
        }
        if constexpr (C == 4) (void)hmesh::drop_transparent(result, picture.view(), options);
        hmesh::GpuOptions packing;
        const hmesh::GpuBuffers list = hmesh::pack_for_gpu(result.mesh.view(), packing);
        packing.topology = hmesh::GpuTopology::triangle_strip;
        const hmesh::GpuBuffers strips = hmesh::pack_for_gpu(result.mesh.view(), packing);
        if (!list.status || !strips.status) return false;
        const Pixels<C> drawn = hmesh::to_pixels<std::uint8_t>(hmesh::render<C>(as_packed(result.mesh, list).view()).image);
        const double psnr = hmesh::psnr(wanted.view(), drawn.view());
        const auto found = [&](bool at_full_size) {
            return std::find_if(textures.begin(), textures.end(),
                                [&](const Texture& t) { return t.psnr >= psnr && (t.is_full_size || !at_full_size); });
        };
        const auto best = found(false), full = found(true);  // RGBA8 at full size is always there
        const std::size_t bytes = list.vertices.size() + list.indices.size(),
                          fewer = strips.vertices.size() + strips.indices.size();
        std::printf("| %s | %zu | %.2f dB | %zu, %zu | %s, %zu, %.2f dB | %.2f, %.2f | %s, %zu |\n", name.c_str(),
                    result.mesh.vertex_count(), psnr, bytes, fewer, best->name.c_str(), best->bytes, best->psnr,
                    static_cast<double>(best->bytes) / static_cast<double>(bytes),
                    static_cast<double>(best->bytes) / static_cast<double>(fewer), full->name.c_str(), full->bytes);
        std::fflush(stdout);
    }
    return true;
}

// --- pictures ---
using Colour = std::array<double, 3>;

Colour mix(const Colour& a, const Colour& b, double share) {
    Colour colour{};
    for (std::size_t k = 0; k < 3; ++k) colour[k] = a[k] + share * (b[k] - a[k]);
    return colour;
}

// px from (x, y) to the outside of a rectangle with round corners, negative inside.
double outside(double x, double y, double left, double top, double width, double height, double radius) {
    const double dx = std::abs(x - left - width / 2) - width / 2 + radius,
                 dy = std::abs(y - top - height / 2) - height / 2 + radius;
    return std::hypot(std::max(dx, 0.0), std::max(dy, 0.0)) + std::min(std::max(dx, dy), 0.0) - radius;
}

// A window's panels, buttons, bars and a dial, each a vertical gradient with a border of 2 px and smooth edges; no letters.
Colour panels_at(double x, double y) {
    Colour colour = mix({38, 44, 58}, {18, 20, 30}, y / 512);
    const auto lay = [&](double left, double top, double width, double height, double radius, const Colour& above,
                         const Colour& below, const Colour& border) {
        const double distance = outside(x, y, left, top, width, height, radius);
        colour = mix(colour, border, std::clamp(0.5 - distance, 0.0, 1.0));
        colour = mix(colour, mix(above, below, std::clamp((y - top) / height, 0.0, 1.0)), std::clamp(-1.5 - distance, 0.0, 1.0));
    };
    const Colour dark{52, 60, 78}, darker{36, 42, 56}, line{96, 110, 140};
    lay(16, 16, 480, 56, 10, {70, 120, 190}, {40, 76, 140}, {120, 160, 220});
    lay(16, 88, 150, 408, 12, dark, darker, line);
    lay(182, 88, 314, 240, 12, dark, darker, line);
    lay(182, 344, 314, 152, 12, dark, darker, line);
    for (int i = 0; i < 7; ++i)
        lay(30, 106 + 54 * i, 122, 40, 8, i == 2 ? Colour{240, 170, 60} : Colour{84, 96, 122},
            i == 2 ? Colour{200, 120, 30} : Colour{64, 74, 96}, i == 2 ? Colour{255, 210, 130} : line);
    for (int i = 0; i < 4; ++i) {
        lay(204, 366 + 30 * i, 270, 16, 8, {24, 28, 38}, {30, 34, 46}, {70, 80, 100});
        lay(206, 368 + 30 * i, 80 + 52 * i, 12, 6, {120, 210, 140}, {50, 150, 90}, {60, 160, 100});
    }
    lay(214, 118, 180, 180, 90, {30, 36, 50}, {60, 70, 92}, {140, 150, 175});
    lay(254, 158, 100, 100, 50, {220, 90, 80}, {150, 40, 50}, {250, 160, 140});
    for (int i = 0; i < 3; ++i) lay(414, 122 + 66 * i, 60, 44, 6, {90, 160, 200}, {50, 100, 150}, {150, 200, 230});
    return colour;
}

// Clouds of light: waves that are bent by waves, none shorter than some 60 px, over a gradient.
Colour sky_at(double x, double y) {
    const double u = x / 160, v = y / 160;
    const double bend = std::sin(1.3 * u + 0.7 * std::sin(1.1 * v)) + 0.6 * std::sin(1.9 * v - 0.8 * u + 1);
    const double cloud = 0.5 + 0.28 * std::sin(1.7 * u + 1.4 * bend) + 0.22 * std::sin(2.1 * v - bend + 0.5 * u);
    const double glow = std::exp(-(std::pow((x - 700) / 260, 2) + std::pow((y - 230) / 150, 2)));
    const Colour night = mix({12, 16, 44}, {52, 30, 78}, y / 512);
    return mix(mix(night, {176, 92, 140}, 0.7 * cloud * cloud), {255, 226, 170}, 0.75 * glow);
}

Pixels<3> drawn(int width, int height, Colour (*at)(double, double)) {
    Pixels<3> picture(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const Colour colour = at(x + 0.5, y + 0.5);
            for (std::size_t k = 0; k < 3; ++k) picture.pixel(x, y)[k] = static_cast<std::uint8_t>(std::lround(colour[k]));
        }
    return picture;
}

bool print_file(const std::string& path, const Settings& settings) {
    tool::ImageFile file;
    const std::string why = tool::read_image(path, file);
    if (!why.empty() || file.channels < 3 || file.bits != 8) {
        std::fprintf(stderr, "mesh_or_texture: %s: %s\n", path.c_str(),
                     why.empty() ? "not 3 or 4 channels of 8 bits" : why.c_str());
        return false;
    }
    const auto print = [&](auto picture) {
        std::copy(file.samples8.begin(), file.samples8.end(), picture.data());
        return print_picture(bench::file_name(path), picture, settings);
    };
    return file.channels == 4 ? print(Pixels<4>(file.width, file.height)) : print(Pixels<3>(file.width, file.height));
}

}  // namespace

int main(int argc, char** argv) {
    Settings settings;
    std::vector<std::string> images;
    bool is_good = true;
    for (int i = 1; i < argc; ++i) {
        const std::string argument = argv[i];
        if (argument.compare(0, 2, "--") != 0) images.push_back(argument);
        else if (++i == argc) is_good = false;
        else if (argument == "--vertices") settings.vertices = bench::split(argv[i]);
        else if (argument == "--step") settings.step = std::atof(argv[i]);
        else if (argument == "--preset") settings.preset = argv[i];
        else is_good = false;
    }
    if (!is_good) {
        std::fprintf(stderr, "usage: mesh_or_texture [--vertices 256,1024,4096] [--step 16] [--preset -thorough] [IMAGE...]\n");
        return 2;
    }
    settings.folder = std::filesystem::temp_directory_path() / ("mesh_or_texture_" + std::to_string(std::random_device{}()));
    std::filesystem::create_directories(settings.folder);
    std::puts("| picture | vertices | PSNR | mesh: list, strips, bytes | texture, bytes, PSNR | times | full size, bytes |");
    std::puts("|---|---|---|---|---|---|---|");
    if (images.empty())
        is_good = print_picture<3>("panels", drawn(512, 512, panels_at), settings) &&
                  print_picture<3>("sky", drawn(1024, 512, sky_at), settings);
    for (const std::string& image : images) is_good = is_good && print_file(image, settings);
    std::filesystem::remove_all(settings.folder);
    return is_good ? 0 : 1;
}
