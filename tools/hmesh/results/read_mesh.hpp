// tools - a mesh that is read from a compact file, in the place of one that is made of an image.
#ifndef HMESH_TOOLS_RESULTS_READ_MESH_HPP
#define HMESH_TOOLS_RESULTS_READ_MESH_HPP

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "arguments/arguments.hpp"
#include "hmesh/mesh/torus.hpp"
#include "readers/image_file.hpp"
#include "results/lines.hpp"
#include "results/made.hpp"
#include "results/mesh_file.hpp"
#include "terminal/words.hpp"

namespace tool {

// Of a periodic mesh a vertex and its copies on the border count once, as in reports of meshes that are made.
[[nodiscard]] inline std::size_t count_vertices(const hmesh::MeshView& mesh) {
    if (mesh.periodic == hmesh::Periodic::none) return mesh.vertex_count;
    const hmesh::kit::Array<std::uint32_t> firsts =
        hmesh::kit::tied_vertices(hmesh::kit::positions_of(mesh), {mesh.width, mesh.height, mesh.periodic});
    std::size_t count = 0;
    for (std::uint32_t v = 0; v < firsts.size(); ++v) count += firsts[v] == v ? 1 : 0;
    return count;
}

// Makes `made` the mesh of the file, `image` one of its size without pixels, and the arguments say what its colours are. Returns
// "" or what is wrong, as the end of a sentence that begins with the file's name.
[[nodiscard]] inline std::string read_mesh(const std::vector<unsigned char>& bytes, Arguments& arguments, ImageFile& image,
                                           Made& made) {
    hmesh::CompactMesh read = read_mesh_file(bytes);
    if (!read.status) return in_words(read.status);
    image.width = read.mesh.width;
    image.height = read.mesh.height;
    image.channels = read.mesh.channels;
    image.bits = read.colors == hmesh::CompactColors::bits8 ? 8 : read.colors == hmesh::CompactColors::bits16 ? 16 : 32;
    arguments.meshing.fit_space = read.linear ? FitSpace::linear : FitSpace::stored;
    arguments.meshing.premultiplied = read.mesh.premultiplied;
    hmesh::Result& outcome = made.levels.emplace_back().outcome;
    outcome.report.vertices = count_vertices(read.mesh.view());
    outcome.report.faces = read.mesh.face_count();
    outcome.mesh = std::move(read.mesh);
    return {};
}

// What is said of it: a summary, or a line of several.
inline void print_read(std::FILE* to, const Arguments& arguments, const ImageFile& image, const Made& made, bool is_line) {
    const hmesh::Report& report = made.finest().outcome.report;
    if (is_line) {
        std::fprintf(to, "%s: %zu vertices, %s\n", arguments.input.c_str(), report.vertices,
                     written_words(arguments, made.seconds).c_str());
        return;
    }
    print_image(to, arguments, image);
    print_vertices(to, made.finest().outcome);
    std::fprintf(to, "faces     %zu\n", report.faces);
    print_written(to, arguments, made.seconds);
}

}  // namespace tool

#endif  // HMESH_TOOLS_RESULTS_READ_MESH_HPP
