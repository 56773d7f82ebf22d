#include "formats.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "hmesh/io/eps.hpp"
#include "hmesh/io/gltf.hpp"
#include "hmesh/io/obj.hpp"
#include "hmesh/io/pdf.hpp"
#include "hmesh/io/ply.hpp"

namespace tool {
namespace {

struct Format {
    const char* ending;  // in lower case
    hmesh::Status (*write)(const hmesh::MeshView& mesh, const FormatOptions& options, ByteSink sink);
};

hmesh::Status write_pdf(const hmesh::MeshView& mesh, const FormatOptions&, ByteSink sink) {
    hmesh::PdfOptions options;
    options.deflate = deflate;
    return hmesh::write_pdf(mesh, sink, options);
}
hmesh::Status write_eps(const hmesh::MeshView& mesh, const FormatOptions&, ByteSink sink) {
    hmesh::EpsOptions options;
    options.deflate = deflate;
    return hmesh::write_eps(mesh, sink, options);
}

constexpr Format formats[] = {
    {".ply", [](const hmesh::MeshView& mesh, const FormatOptions&, ByteSink sink) { return hmesh::write_ply(mesh, sink); }},
    {".obj", [](const hmesh::MeshView& mesh, const FormatOptions&, ByteSink sink) { return hmesh::write_obj(mesh, sink); }},
    {".glb", [](const hmesh::MeshView& mesh, const FormatOptions&, ByteSink sink) { return hmesh::write_glb(mesh, sink); }},
    {".pdf", write_pdf},
    {".eps", write_eps},
    {".svg", [](const hmesh::MeshView& mesh, const FormatOptions& options,
                ByteSink sink) { return hmesh::write_svg(mesh, sink, options.svg); }},
    {".html", [](const hmesh::MeshView& mesh, const FormatOptions& options,
                 ByteSink sink) { return hmesh::write_html(mesh, sink, options.html); }},
};

const Format* find_format(const std::string& name) {
    const auto* found = std::find_if(std::begin(formats), std::end(formats),
                                     [&](const Format& format) { return has_ending(name, format.ending); });
    return found != std::end(formats) ? found : nullptr;
}

}  // namespace

bool has_ending(const std::string& name, const std::string& ending) {
    if (name.size() <= ending.size()) return false;
    for (std::size_t i = 0; i < ending.size(); ++i) {
        const char c = name[name.size() - ending.size() + i];
        if ((c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c) != ending[i]) return false;
    }
    return true;
}

bool is_format(const std::string& name) { return find_format(name) != nullptr; }

std::string format_endings() {
    std::string endings;
    for (const Format& format : formats) endings += (endings.empty() ? "" : ", ") + std::string(format.ending);
    return endings;
}

hmesh::Status write_mesh(hmesh::MeshView mesh, const std::string& name, const FormatOptions& options, ByteSink sink) {
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
    return find_format(name)->write(mesh, options, sink);
}

}  // namespace tool
