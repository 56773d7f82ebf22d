// examples - the mesh formats that the command writes, chosen by the ending of a file's name. A new format is a line in
// the table.
#ifndef HMESH_EXAMPLES_FORMATS_HPP
#define HMESH_EXAMPLES_FORMATS_HPP

#include <cstddef>
#include <string>
#include <vector>

#include "hmesh/io/ply.hpp"
#include "output_file.hpp"

namespace example {

namespace detail {

// PLY has no grey with alpha: such a mesh is written as red, green, blue, alpha.
[[nodiscard]] inline hmesh::Status write_any_ply(hmesh::MeshView mesh, OutputFile& file) {
    std::vector<float> colors;
    if (mesh.channels == 2) {
        colors.reserve(4 * mesh.vertex_count);
        for (std::size_t v = 0; v < mesh.vertex_count; ++v) {
            colors.insert(colors.end(), 3, mesh.colors[2 * v]);
            colors.push_back(mesh.colors[2 * v + 1]);
        }
        mesh.colors = colors.data();
        mesh.channels = 4;
    }
    return hmesh::write_ply(mesh, file);
}

}  // namespace detail

struct Format {
    const char* ending;  // in lower case
    hmesh::Status (*write)(hmesh::MeshView mesh, OutputFile& file);
};

inline constexpr Format formats[] = {
    {".ply", detail::write_any_ply},
};

// Whether the name ends so, in lower or upper case, and has more before it.
[[nodiscard]] inline bool has_ending(const std::string& name, const std::string& ending) {
    if (name.size() <= ending.size()) return false;
    for (std::size_t i = 0; i < ending.size(); ++i) {
        const char c = name[name.size() - ending.size() + i];
        if ((c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c) != ending[i]) return false;
    }
    return true;
}

// The format of a file of this name, or nullptr.
[[nodiscard]] inline const Format* find_format(const std::string& name) {
    for (const Format& format : formats)
        if (has_ending(name, format.ending)) return &format;
    return nullptr;
}

[[nodiscard]] inline std::string format_endings() {
    std::string endings;
    for (const Format& format : formats) endings += (endings.empty() ? "" : ", ") + std::string(format.ending);
    return endings;
}

}  // namespace example

#endif  // HMESH_EXAMPLES_FORMATS_HPP
