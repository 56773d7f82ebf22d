// gpu_buffers: what pack_for_gpu() makes of images, and its order of faces beside that of meshoptimizer, as Markdown tables.
//
//     gpu_buffers [--vertices 2600,20000] [--effort draft] [--grid 256] [--repeat 5] [--mosaic N] IMAGE...
//
// Bytes a vertex are those of both buffers. ACMR and ATVR are of a FIFO of 16 vertices; ATVR of 32-wide batches is what
// meshoptimizer analyses as (32, 32, 32). us a face is processor time, the least of the repeats: of all of pack_for_gpu(), and
// of the orders alone. Lines named meshoptimizer are there if it was found when this was built (Debian: libmeshoptimizer-dev).
// --grid is that of `hmesh --grid`; --mosaic lays each image out N x N times, for more vertices than it could hold.
//
// The last table has bytes a vertex on disk: of both buffers, and of what `hmesh --glb` writes, with colours of 16 and 8 bits,
// and what zlib makes of either at its level 9, if it was found. Of compressed files it says what is vertices and what
// indices; the rest is JSON.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <hmesh/gpu.hpp>
#include <hmesh/hmesh.hpp>

#include "common.hpp"
#include "writers/formats.hpp"

#ifdef HMESH_HAS_MESHOPT
#include <meshoptimizer.h>
#endif
#ifdef HMESH_HAS_ZLIB
#include <zlib.h>
#endif

namespace {

using Indices = std::vector<std::uint32_t>;

// The least processor time of the repeats, in us a face.
double microseconds(int repeats, std::size_t faces, const std::function<void()>& work) {
    double least = 1e300;
    for (int i = 0; i < repeats; ++i) {
        const double begin = bench::processor_seconds();
        work();
        least = std::min(least, bench::processor_seconds() - begin);
    }
    return least * 1e6 / static_cast<double>(faces);
}

// One line: an order of a mesh, as the indices of a list or strip of all of it.
void print_order(const char* name, const hmesh::Mesh& mesh, const Indices& indices, double time) {
    const auto use = hmesh::kit::vertex_cache_use(indices.data(), indices.size(), mesh.face_count(), mesh.vertex_count());
    std::printf("| %zu | %s | %.4f | %.4f | ", mesh.vertex_count(), name, use.acmr, use.atvr);
#ifdef HMESH_HAS_MESHOPT
    Indices list = indices;
    if (std::count(indices.begin(), indices.end(), hmesh::kit::no_index) > 0) {
        list.resize(meshopt_unstripifyBound(indices.size()));
        list.resize(meshopt_unstripify(list.data(), indices.data(), indices.size(), hmesh::kit::no_index));
    }
    std::printf("%.3f | ",
                static_cast<double>(meshopt_analyzeVertexCache(list.data(), list.size(), mesh.vertex_count(), 32, 32, 32).atvr));
#else
    std::printf("| ");
#endif
    std::printf("%.2f | %.3f |\n", 2 * static_cast<double>(indices.size()) / static_cast<double>(mesh.vertex_count()), time);
}

Indices list_of(const std::vector<hmesh::Triangle>& faces, const Indices& order) {
    Indices indices;
    for (const std::uint32_t f : order) indices.insert(indices.end(), faces[f].begin(), faces[f].end());
    return indices;
}

void compare_orders(const hmesh::Mesh& mesh, int repeats) {
    const std::size_t faces = mesh.face_count(), vertices = mesh.vertex_count();
    Indices as_made, order, strips;
    for (const auto& face : mesh.faces) as_made.insert(as_made.end(), face.begin(), face.end());
    print_order("as meshed", mesh, as_made, 0);
    double time = microseconds(repeats, faces, [&] { order = hmesh::kit::vertex_cache_order(mesh.faces, vertices); });
    print_order("list", mesh, list_of(mesh.faces, order), time);
#ifdef HMESH_HAS_MESHOPT
    Indices other(as_made.size());
    time = microseconds(repeats, faces,
                        [&] { meshopt_optimizeVertexCache(other.data(), as_made.data(), as_made.size(), vertices); });
    print_order("list, meshoptimizer", mesh, other, time);
#endif
    time = microseconds(repeats, faces, [&] { strips = hmesh::kit::vertex_cache_strips(mesh.faces, vertices); });
    print_order("strips", mesh, strips, time);
#ifdef HMESH_HAS_MESHOPT
    strips.resize(meshopt_stripifyBound(as_made.size()));
    std::size_t used = 0;
    time = microseconds(repeats, faces, [&] {
        meshopt_optimizeVertexCacheStrip(other.data(), as_made.data(), as_made.size(), vertices);
        used = meshopt_stripify(strips.data(), other.data(), other.size(), vertices, hmesh::kit::no_index);
    });
    strips.resize(used);
    print_order("strips, meshoptimizer", mesh, strips, time);
#endif
}

void print_buffers(const hmesh::Mesh& mesh, int repeats) {
    for (const auto topology : {hmesh::GpuTopology::triangle_list, hmesh::GpuTopology::triangle_strip}) {
        hmesh::GpuOptions options;
        options.topology = topology;
        hmesh::GpuBuffers buffers;
        const double time =
            microseconds(repeats, mesh.face_count(), [&] { buffers = hmesh::pack_for_gpu(mesh.view(), options); });
        const auto bytes = static_cast<double>(buffers.vertices.size() + buffers.indices.size());
        std::printf("| %zu | %s | %zu | %.3f | %.3f | %.3f |\n", mesh.vertex_count(),
                    topology == hmesh::GpuTopology::triangle_list ? "list" : "strips", buffers.chunks.size(),
                    static_cast<double>(buffers.vertex_count()) / static_cast<double>(mesh.vertex_count()),
                    bytes / static_cast<double>(mesh.vertex_count()), time);
    }
}

using Bytes = std::vector<std::uint8_t>;

void print_size(const hmesh::Mesh& mesh, const char* what, int bits, const Bytes& bytes) {
    const auto vertices = static_cast<double>(mesh.vertex_count());
    std::printf("| %zu | %s | %d | %.2f | ", mesh.vertex_count(), what, bits, static_cast<double>(bytes.size()) / vertices);
#ifdef HMESH_HAS_ZLIB
    uLongf size = compressBound(static_cast<uLong>(bytes.size()));
    Bytes packed(size);
    if (compress2(packed.data(), &size, bytes.data(), static_cast<uLong>(bytes.size()), 9) == Z_OK)
        std::printf("%.2f", static_cast<double>(size) / vertices);
#endif
    std::printf(" | ");
    // What is compressed stands behind EXT_meshopt_compression, primitive by primitive.
    const std::string text(bytes.begin(), bytes.end());
    double parts[2] = {};
    std::size_t at = 0, found = 0;
    const std::string before = "\"EXT_meshopt_compression\":{\"buffer\":0,", length = "\"byteLength\":";
    for (; (at = text.find(before, at)) != std::string::npos; ++found) {
        at = text.find(length, at) + length.size();
        parts[found % 2] += std::atof(text.c_str() + at) / vertices;
    }
    if (found > 0) std::printf("%.2f, %.2f", parts[0], parts[1]);
    std::printf(" |\n");
}

void print_sizes(const hmesh::Mesh& mesh) {
    for (const auto topology : {hmesh::GpuTopology::triangle_list, hmesh::GpuTopology::triangle_strip}) {
        hmesh::GpuOptions options;
        options.topology = topology;
        const hmesh::GpuBuffers buffers = hmesh::pack_for_gpu(mesh.view(), options);
        Bytes bytes = buffers.vertices;
        bytes.insert(bytes.end(), buffers.indices.begin(), buffers.indices.end());
        print_size(mesh, topology == hmesh::GpuTopology::triangle_list ? "buffers, list" : "buffers, strips", 8, bytes);
    }
    const std::pair<const char*, tool::GlbForm> forms[] = {{"--glb exact", tool::GlbForm::exact},
                                                           {"--glb packed", tool::GlbForm::packed},
#ifdef HMESH_HAS_MESHOPT
                                                           {"--glb meshopt", tool::GlbForm::meshopt}
#endif
    };
    for (const auto& [name, form] : forms)
        for (const int bits : {16, 8}) {
            tool::FormatOptions options;
            options.glb = form;
            options.glb_color_bits = bits;
            Bytes bytes;
            if (!tool::write_glb_levels({mesh.view()}, options, hmesh::kit::append_to(bytes))) return;
            print_size(mesh, name, bits, bytes);
        }
}

// The picture n x n times.
bench::Picture mosaic_of(const bench::Picture& tile, int n) {
    bench::Picture mosaic(n * tile.width(), n * tile.height());
    for (int y = 0; y < mosaic.height(); ++y)
        for (int x = 0; x < n; ++x)
            std::copy_n(tile.pixel(0, y % tile.height()), 3 * tile.width(), mosaic.pixel(x * tile.width(), y));
    return mosaic;
}

}  // namespace

int main(int argc, char** argv) {
    std::vector<std::string> sizes{"2600", "20000"}, images;
    int repeats = 5, columns = 1, grid = 256;
    hmesh::Annealed recipe{hmesh::Effort::draft};
    bool is_good = true;
    for (int i = 1; i < argc; ++i) {
        const std::string argument = argv[i];
        if (argument.compare(0, 2, "--") != 0) images.push_back(argument);
        else if (++i == argc) is_good = false;
        else if (argument == "--vertices") sizes = bench::split(argv[i]);
        else if (argument == "--repeat") repeats = std::max(1, std::atoi(argv[i]));
        else if (argument == "--effort") is_good &= bench::effort_of(argv[i], recipe.effort);
        else if (argument == "--grid") grid = std::clamp(std::atoi(argv[i]), 1, 256);
        else if (argument == "--mosaic") columns = std::clamp(std::atoi(argv[i]), 1, 64);
        else is_good = false;
    }
    if (!is_good || images.empty()) {
        std::fprintf(stderr,
                     "usage: gpu_buffers [--vertices 2600,20000] [--effort draft] [--grid 256] [--repeat 5] [--mosaic N] "
                     "IMAGE...\n");
        return 2;
    }
    std::vector<hmesh::Mesh> meshes;
    for (const std::string& path : images) {
        const auto picture = bench::read("gpu_buffers", path);
        if (!picture) return 1;
        const bench::Picture mosaic = mosaic_of(*picture, columns);
        for (const std::string& size : sizes) {
            hmesh::Options options;
            options.target = hmesh::Target::vertices(std::atoll(size.c_str()));
            options.limits.position_step = 1.0 / grid;
            auto result = hmesh::mesh_image(mosaic.view(), options, recipe);
            if (!result.has_mesh()) {
                std::fprintf(stderr, "gpu_buffers: %s: %s\n", path.c_str(), hmesh::message(result.status).c_str());
                return 1;
            }
            meshes.push_back(std::move(result.mesh));
        }
    }
    std::puts("| vertices | indices | chunks | vertices stored | B/vertex | us/face |\n|---|---|---|---|---|---|");
    for (const auto& mesh : meshes) print_buffers(mesh, repeats);
    std::puts("\n| vertices | order | ACMR | ATVR | ATVR 32 | B of indices/vertex | us/face |\n|---|---|---|---|---|---|---|");
    for (const auto& mesh : meshes) compare_orders(mesh, repeats);
    std::puts("\n| vertices | on disk | bits of a colour | B/vertex | zlib | vertices, indices |\n|---|---|---|---|---|---|");
    for (const auto& mesh : meshes) print_sizes(mesh);
    return 0;
}
