// heights - a terrain with holes as a model in all formats: heights DIRECTORY
//
// Hills of 61 x 41 samples, 30 m apart, with a lake cut out and cells that touch in a vertex, jittered vertices and normals from
// the samples. Writes height.ply, .obj, .glb, .stl, solid.stl, map.png, which is draped over them, and height.terrain, a tile
// in the Alps.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>

#include <hmesh/core/random.hpp>
#include <hmesh/terrain.hpp>

#include "writers/output_file.hpp"
#include "writers/picture_file.hpp"

namespace {

constexpr int columns = 60, rows = 40;

double height(double x, double y) { return 1500 + 400 * std::sin(x / 7) * std::cos(y / 5) + 8 * x; }

bool is_hole(int x, int y) {
    const bool is_lake = std::hypot(x - 20, 1.5 * (y - 15)) < 8;
    return is_lake || (x > 40 && x < 50 && y > 20 && y < 30 && (x + y) % 2 == 0);
}

hmesh::Mesh make_mesh() {
    hmesh::Mesh mesh;
    mesh.channels = 1;
    mesh.width = columns + 1, mesh.height = rows + 1, mesh.peak = 65535;
    mesh.samples = hmesh::Samples::points;
    hmesh::kit::Random random(1);
    for (int y = 0; y <= rows; ++y)
        for (int x = 0; x <= columns; ++x) {
            const auto place = [&](int k, int last) {  // on the 1/256 px grid
                const double jitter = (random.uniform() - 0.5) * (k > 0 && k < last ? 0.5 : 0);
                return std::round((k + jitter) * 256) / 256;
            };
            const double u = place(x, columns), v = place(y, rows);
            mesh.positions.insert(mesh.positions.end(), {static_cast<float>(u), static_cast<float>(v)});
            mesh.colors.push_back(static_cast<float>(height(u, v)));
        }
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x) {
            if (is_hole(x, y)) continue;
            const auto a = static_cast<std::uint32_t>(y * (columns + 1) + x), c = a + columns + 1;
            mesh.faces.push_back({a, a + 1, c});
            mesh.faces.push_back({a + 1, c + 1, c});
        }
    return mesh;
}

bool put(const std::string& file, hmesh::FunctionRef<hmesh::Status(hmesh::Sink sink)> write) {
    tool::OutputFile out(file);
    const auto sink = [&](const void* bytes, std::size_t size) { return out(bytes, size); };
    hmesh::Status status;
    if (out.open() && (status = write(sink)) && out.commit()) return true;
    std::fprintf(stderr, "heights: cannot write '%s': %s\n", file.c_str(), status ? out.error().c_str() : status.what);
    return false;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: heights DIRECTORY\n");
        return 2;
    }
    const std::string to = std::string(argv[1]) + "/";
    const hmesh::Mesh mesh = make_mesh();
    hmesh::Image<float, 1> samples(mesh.width, mesh.height);
    for (int y = 0; y < mesh.height; ++y)
        for (int x = 0; x < mesh.width; ++x) *samples.pixel(x, y) = static_cast<float>(height(x, y));

    hmesh::HeightOptions options;
    options.x_step = 30, options.y_step = 20, options.x_origin = 100.5, options.y_origin = 0.25;
    options.z = {0, 0.5, -250};
    options.texture = "map.png";
    hmesh::QuantizedMeshOptions tile;
    tile.west = 7, tile.south = 46, tile.east = 7 + 60 / 2700.0, tile.north = 46 + 40 / 5400.0;
    tile.z = options.z;
    tool::Picture map{4, 4, 3, {}};
    for (int i = 0; i < 48; ++i) map.samples.push_back(static_cast<std::uint8_t>(5 * i));
    const bool is_good =
        put(to + "height.ply",
            [&](hmesh::Sink sink) { return hmesh::write_height_ply(mesh.view(), samples.view(), sink, options); }) &&
        put(to + "height.obj",
            [&](hmesh::Sink sink) { return hmesh::write_height_obj(mesh.view(), samples.view(), sink, options); }) &&
        put(to + "height.glb",
            [&](hmesh::Sink sink) { return hmesh::write_height_glb(mesh.view(), samples.view(), sink, options); }) &&
        put(to + "height.stl", [&](hmesh::Sink sink) { return hmesh::write_height_stl(mesh.view(), sink, options); }) &&
        put(to + "solid.stl", [&](hmesh::Sink sink) { return hmesh::write_solid_stl(mesh.view(), 0, sink, options); }) &&
        put(to + "height.terrain",
            [&](hmesh::Sink sink) { return hmesh::write_quantized_mesh(mesh.view(), samples.view(), sink, tile); }) &&
        put(to + "map.png", [&](hmesh::Sink sink) {
            return tool::write_png(map, sink) ? hmesh::Status() : hmesh::Status(hmesh::Errc::write_failed, "no picture");
        });
    return is_good ? 0 : 1;
}
