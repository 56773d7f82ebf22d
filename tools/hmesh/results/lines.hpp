// tools - the lines that begin and end what the command says of an image, whatever it made of it.
#ifndef HMESH_TOOLS_RESULTS_LINES_HPP
#define HMESH_TOOLS_RESULTS_LINES_HPP

#include <cstddef>
#include <cstdio>
#include <string>

#include "arguments/arguments.hpp"
#include "arguments/files.hpp"
#include "hmesh/mesh/periodic.hpp"
#include "hmesh/result.hpp"
#include "readers/image_file.hpp"

namespace tool {

// The image, and what its reader noted.
inline void print_image(std::FILE* to, const Arguments& arguments, const ImageFile& image) {
    const int channels = image.channels - image.padding;
    std::fprintf(to, "image     %s, %d x %d, %d channel%s of %d bits\n", arguments.input.c_str(), image.width, image.height,
                 channels, channels == 1 ? "" : "s", image.bits);
    if (!image.note.empty()) std::fprintf(to, "note      %s\n", image.note.c_str());
}

// Vertices of the mesh that are copies, of those on the border of a periodic one.
[[nodiscard]] inline std::size_t border_copies(const hmesh::Result& outcome) noexcept {
    const std::size_t all = outcome.mesh.vertex_count(), counted = outcome.report.vertices;
    return outcome.mesh.periodic != hmesh::Periodic::none && all > counted ? all - counted : 0;
}

// How many vertices a mesh has.
inline void print_vertices(std::FILE* to, const hmesh::Result& outcome) {
    std::fprintf(to, "vertices  %zu", outcome.report.vertices);
    if (const std::size_t copies = border_copies(outcome); copies > 0)
        std::fprintf(to, ", and %zu copies of those on the border", copies);
    std::fprintf(to, "\n");
}

// The time, and a line for each file.
inline void print_written(std::FILE* to, const Arguments& arguments, double seconds) {
    std::fprintf(to, "time      %.2f s\n", seconds);
    for (const std::string& name : output_files(arguments)) std::fprintf(to, "written   %s\n", name.c_str());
}

// The same as the end of a line: "0.12 s, written a.ply, a.png".
[[nodiscard]] inline std::string written_words(const Arguments& arguments, double seconds) {
    char time[64];
    std::snprintf(time, sizeof time, "%.2f s", seconds);
    std::string words = time, before = ", written ";
    for (const std::string& name : output_files(arguments)) {
        words += before + name;
        before = ", ";
    }
    return words;
}

}  // namespace tool

#endif  // HMESH_TOOLS_RESULTS_LINES_HPP
