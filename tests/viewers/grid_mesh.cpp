// grid_mesh - a mesh without thin faces, in all formats and as pictures: grid_mesh DIRECTORY [CHANNELS [COLUMNS ROWS]]
//
// A grid of 768 x 512 px whose inner vertices are moved by up to a quarter of a cell, coloured from the scene of tools/pictures,
// with 3 channels or 4, the fourth a wave of alpha. What viewers show of it tells what the exporters are worth, where thin
// faces would tell what the viewers are. Writes mesh.ply, .obj, .glb, .pdf, .eps and .html, quantized.glb, plain.pdf and
// plain.eps (not deflated), gradient.svg, exact.svg and flat.svg; of render()'s picture reference.png, reference4.png, four
// times as large, and paper.png, over white; of 4 channels layouts.json (gpu_layouts.hpp) too. Prints bytes and processor time of
// each file, the best of five.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <utility>
#include <vector>

#include <hmesh/hmesh.hpp>

#include "gpu_layouts.hpp"
#include "scene.hpp"
#include "writers/output_file.hpp"
#include "writers/picture_file.hpp"
#include "writers/pictures.hpp"

namespace {

using Bytes = std::vector<unsigned char>;
using Write = hmesh::FunctionRef<hmesh::Status(hmesh::Sink sink)>;  // an exporter with its mesh and options

hmesh::Mesh make_grid(int channels, int columns, int rows) {
    const hmesh::Image<std::uint8_t, 3> scene = tool::draw_scene(columns + 1, rows + 1);  // a pixel for a vertex
    hmesh::Mesh mesh;
    mesh.channels = channels;
    mesh.width = 768;
    mesh.height = 512;
    mesh.peak = 255;
    hmesh::kit::Random random(1);
    const auto place = [&](int k, int count, int side) {  // on the 1/256 px grid
        const bool is_inner = k > 0 && k < count;
        const double jitter = (random.uniform() - 0.5) * (is_inner ? 0.5 : 0);
        return static_cast<float>(std::round((k + jitter) * side / count * 256) / 256);
    };
    for (int j = 0; j <= rows; ++j)
        for (int i = 0; i <= columns; ++i) {
            const float x = place(i, columns, mesh.width), y = place(j, rows, mesh.height);
            mesh.positions.insert(mesh.positions.end(), {x, y});
            for (int c = 0; c < 3; ++c) mesh.colors.push_back(static_cast<float>(scene.pixel(i, j)[c]));
            if (channels == 4) mesh.colors.push_back(std::round(127.5F + 127.5F * std::sin(x / 40)));
        }
    const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(j * (columns + 1) + i); };
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i) {
            mesh.faces.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
            mesh.faces.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    return mesh;
}

class Directory {
  public:
    explicit Directory(std::string name) : name_(std::move(name)) {}

    // Calls `write` five times.
    void put(const std::string& file, Write write) {
        Bytes bytes;
        const auto sink = hmesh::kit::append_to(bytes);
        double least = 0;  // s of processor time
        for (int k = 0; k < 5; ++k) {
            bytes.clear();
            const std::clock_t start = std::clock();
            if (const hmesh::Status status = write(sink); !status) return fail(file, status.what);
            const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
            least = k == 0 ? seconds : std::min(least, seconds);
        }
        tool::OutputFile out(name_ + "/" + file);
        if (!out.open() || !out(bytes.data(), bytes.size()) || !out.commit()) return fail(file, out.error().c_str());
        const auto size = static_cast<double>(bytes.size());
        const double speed = size / std::max(least, 1e-6) / 1e6;
        std::printf("%-14s %9.0f bytes %7.2f ms %5.0f MB/s\n", file.c_str(), size, 1e3 * least, speed);
    }
    void put_picture(const std::string& file, const tool::Picture& picture) {
        tool::OutputFile out(name_ + "/" + file);
        if (!out.open() || !tool::write_png(picture, out) || !out.commit()) return fail(file, out.error().c_str());
    }
    [[nodiscard]] bool is_good() const noexcept { return is_good_; }

  private:
    void fail(const std::string& file, const char* why) {
        std::fprintf(stderr, "grid_mesh: cannot write '%s/%s': %s\n", name_.c_str(), file.c_str(), why);
        is_good_ = false;
    }
    std::string name_;
    bool is_good_ = true;
};

template <int C>
tool::Picture drawn(const hmesh::MeshView& mesh, int scale) {
    hmesh::RenderOptions options;
    options.width = scale * mesh.width;
    options.height = scale * mesh.height;
    const hmesh::RenderResult<C> out = hmesh::render<C>(mesh, options);
    if (!out.status) return {};
    const hmesh::Image<std::uint8_t, C> pixels = hmesh::to_pixels<std::uint8_t>(out.image);
    return {pixels.width(), pixels.height(), C, {pixels.data(), pixels.data() + pixels.size()}};
}

template <int C>
bool write_all(const hmesh::MeshView& mesh, const std::string& name) {
    Directory to(name);
    to.put("mesh.ply", [&](hmesh::Sink sink) { return hmesh::write_ply(mesh, sink); });
    to.put("mesh.obj", [&](hmesh::Sink sink) { return hmesh::write_obj(mesh, sink); });
    to.put("mesh.glb", [&](hmesh::Sink sink) { return hmesh::write_glb(mesh, sink); });
    hmesh::GltfOptions quantized;
    quantized.quantized_positions = true;
    to.put("quantized.glb", [&](hmesh::Sink sink) { return hmesh::write_glb(mesh, sink, quantized); });
    to.put("plain.pdf", [&](hmesh::Sink sink) { return hmesh::write_pdf(mesh, sink); });
    hmesh::PageOptions pdf;
    pdf.deflate = tool::deflate;
    to.put("mesh.pdf", [&](hmesh::Sink sink) { return hmesh::write_pdf(mesh, sink, pdf); });
    to.put("plain.eps", [&](hmesh::Sink sink) { return hmesh::write_eps(mesh, sink); });
    hmesh::PageOptions eps;
    eps.deflate = tool::deflate;
    to.put("mesh.eps", [&](hmesh::Sink sink) { return hmesh::write_eps(mesh, sink, eps); });
    const auto put_svg = [&](const char* file, hmesh::SvgOptions::Kind kind) {
        hmesh::SvgOptions svg;
        svg.kind = kind;
        to.put(file, [&](hmesh::Sink sink) { return hmesh::write_svg(mesh, sink, svg); });
    };
    put_svg("gradient.svg", hmesh::SvgOptions::Kind::gradient);
    put_svg("exact.svg", hmesh::SvgOptions::Kind::exact);
    put_svg("flat.svg", hmesh::SvgOptions::Kind::flat);
    to.put("mesh.html", [&](hmesh::Sink sink) { return hmesh::write_html(mesh, sink); });
    to.put_picture("reference.png", drawn<C>(mesh, 1));
    to.put_picture("reference4.png", drawn<C>(mesh, 4));
    to.put_picture("paper.png", tool::to_picture(tool::to_rgb(drawn<C>(mesh, 1))));
    return to.is_good();
}

}  // namespace

int main(int argc, char** argv) {
    const int channels = argc >= 3 ? std::atoi(argv[2]) : 3;
    const int columns = argc == 5 ? std::atoi(argv[3]) : 72, rows = argc == 5 ? std::atoi(argv[4]) : 48;
    if (argc < 2 || argc == 4 || argc > 5 || (channels != 3 && channels != 4) || columns < 1 || rows < 1 || columns > 2048 ||
        rows > 2048) {
        std::fprintf(stderr, "usage: grid_mesh DIRECTORY [CHANNELS [COLUMNS ROWS]]   (3 72 48; 3 or 4, each 1 to 2048)\n");
        return 2;
    }
    const hmesh::Mesh mesh = make_grid(channels, columns, rows);
    if (channels == 3) return write_all<3>(mesh.view(), argv[1]) ? 0 : 1;
    Directory to(argv[1]);
    to.put("layouts.json", [&](hmesh::Sink sink) { return GpuLayouts(sink).write(mesh); });
    return write_all<4>(mesh.view(), argv[1]) && to.is_good() ? 0 : 1;
}
