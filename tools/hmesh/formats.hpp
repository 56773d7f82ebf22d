// tools - the mesh formats that the command writes, chosen by the ending of a file's name. A new format is a line in
// the table.
#ifndef HMESH_TOOLS_FORMATS_HPP
#define HMESH_TOOLS_FORMATS_HPP

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "hmesh/io/eps.hpp"
#include "hmesh/io/gltf.hpp"
#include "hmesh/io/html.hpp"
#include "hmesh/io/obj.hpp"
#include "hmesh/io/pdf.hpp"
#include "hmesh/io/ply.hpp"
#include "hmesh/io/svg.hpp"
#include "image_file.hpp"
#include "output_file.hpp"

namespace tool {

// What some formats are told beside the mesh.
struct FormatOptions {
    hmesh::SvgOptions svg;
    hmesh::HtmlOptions html;
};

namespace detail {

// hmesh::Deflate by stb_image_write: no zlib is needed. About 10 MB/s.
[[nodiscard]] inline bool deflate(void*, const unsigned char* bytes, std::size_t size, std::vector<unsigned char>& out) {
    if (size > max_deflated) return false;
    std::vector<unsigned char> copy(bytes, bytes + size);  // stb takes no const
    int length = 0;
    const std::unique_ptr<unsigned char, void (*)(void*)> made(
        stbi_zlib_compress(copy.data(), static_cast<int>(size), &length, stbi_write_png_compression_level), std::free);
    if (made) out.assign(made.get(), made.get() + length);
    return made != nullptr;
}

[[nodiscard]] inline hmesh::Status write_ply_file(const hmesh::MeshView& mesh, const FormatOptions&, OutputFile& file) {
    return hmesh::write_ply(mesh, file);
}
[[nodiscard]] inline hmesh::Status write_obj_file(const hmesh::MeshView& mesh, const FormatOptions&, OutputFile& file) {
    return hmesh::write_obj(mesh, file);
}
[[nodiscard]] inline hmesh::Status write_glb_file(const hmesh::MeshView& mesh, const FormatOptions&, OutputFile& file) {
    return hmesh::write_glb(mesh, file);
}
[[nodiscard]] inline hmesh::Status write_pdf_file(const hmesh::MeshView& mesh, const FormatOptions&, OutputFile& file) {
    hmesh::PdfOptions options;
    options.deflate = deflate;
    return hmesh::write_pdf(mesh, file, options);
}
[[nodiscard]] inline hmesh::Status write_eps_file(const hmesh::MeshView& mesh, const FormatOptions&, OutputFile& file) {
    hmesh::EpsOptions options;
    options.deflate = deflate;
    return hmesh::write_eps(mesh, file, options);
}
[[nodiscard]] inline hmesh::Status write_svg_file(const hmesh::MeshView& mesh, const FormatOptions& options, OutputFile& file) {
    return hmesh::write_svg(mesh, file, options.svg);
}
[[nodiscard]] inline hmesh::Status write_html_file(const hmesh::MeshView& mesh, const FormatOptions& options, OutputFile& file) {
    return hmesh::write_html(mesh, file, options.html);
}

}  // namespace detail

struct Format {
    const char* ending;  // in lower case
    hmesh::Status (*write)(const hmesh::MeshView& mesh, const FormatOptions& options, OutputFile& file);
};

inline constexpr Format formats[] = {
    {".ply", detail::write_ply_file},   {".obj", detail::write_obj_file}, {".glb", detail::write_glb_file},
    {".pdf", detail::write_pdf_file},   {".eps", detail::write_eps_file}, {".svg", detail::write_svg_file},
    {".html", detail::write_html_file},
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

// Writes the mesh as `format`. No format knows grey with alpha: such a mesh is written as red, green, blue, alpha.
[[nodiscard]] inline hmesh::Status write_mesh(hmesh::MeshView mesh, const Format& format, const FormatOptions& options,
                                              OutputFile& file) {
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
    return format.write(mesh, options, file);
}

}  // namespace tool

#endif  // HMESH_TOOLS_FORMATS_HPP
