#include "writers/formats.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "hmesh/gpu.hpp"
#include "hmesh/io/compact.hpp"
#include "hmesh/io/eps.hpp"
#include "hmesh/io/gltf.hpp"
#include "hmesh/io/gltf_lods.hpp"
#include "hmesh/io/obj.hpp"
#include "hmesh/io/pdf.hpp"
#include "hmesh/io/ply.hpp"
#include "writers/ending.hpp"
#include "writers/meshopt.hpp"
#include "writers/picture_file.hpp"

namespace tool {
namespace {

struct Format {
    const char* ending;  // in lower case
    hmesh::Status (*write)(const hmesh::MeshView& mesh, const FormatOptions& options, hmesh::Sink sink);
};

hmesh::PageOptions page_options() {
    hmesh::PageOptions options;
    options.deflate = deflate;
    return options;
}

hmesh::Status write_ply(const hmesh::MeshView& mesh, const FormatOptions& options, hmesh::Sink sink) {
    hmesh::PlyOptions ply;
    ply.groups = options.groups;
    return hmesh::write_ply(mesh, sink, ply);
}

hmesh::Status write_glb(const hmesh::MeshView& mesh, const FormatOptions& options, hmesh::Sink sink) {
    return write_glb_levels({mesh}, options, sink);
}

constexpr Format formats[] = {
    {".ply", write_ply},
    {".obj", [](const hmesh::MeshView& mesh, const FormatOptions&, hmesh::Sink sink) { return hmesh::write_obj(mesh, sink); }},
    {".glb", write_glb},
    {".pdf", [](const hmesh::MeshView& mesh, const FormatOptions&,
                hmesh::Sink sink) { return hmesh::write_pdf(mesh, sink, page_options()); }},
    {".eps", [](const hmesh::MeshView& mesh, const FormatOptions&,
                hmesh::Sink sink) { return hmesh::write_eps(mesh, sink, page_options()); }},
    {".svg", [](const hmesh::MeshView& mesh, const FormatOptions& options,
                hmesh::Sink sink) { return hmesh::write_svg(mesh, sink, options.svg); }},
    {".html", [](const hmesh::MeshView& mesh, const FormatOptions& options,
                 hmesh::Sink sink) { return hmesh::write_html(mesh, sink, options.html); }},
    {".hmc", [](const hmesh::MeshView& mesh, const FormatOptions& options,
                hmesh::Sink sink) { return hmesh::write_compact(mesh, sink, options.compact); }},
};

}  // namespace

std::string format_ending(const std::string& name) {
    for (const Format& format : formats)
        if (has_ending(name, format.ending)) return format.ending;
    return {};
}

std::string format_endings() {
    std::string endings;
    for (const Format& format : formats) endings += (endings.empty() ? "" : ", ") + std::string(format.ending);
    return endings;
}

std::vector<std::string> format_names() {
    std::vector<std::string> names;
    for (const Format& format : formats) names.emplace_back(format.ending + 1);
    return names;
}

hmesh::Status write_mesh(const hmesh::MeshView& mesh, const std::string& ending, const FormatOptions& options, hmesh::Sink sink) {
    const auto* found =
        std::find_if(std::begin(formats), std::end(formats), [&](const Format& format) { return ending == format.ending; });
    return found->write(mesh, options, sink);
}

hmesh::Status write_mesh(const hmesh::MeshView& mesh, const std::string& ending, const FormatOptions& options,
                         std::vector<unsigned char>& bytes) {
    bytes.clear();
    const auto sink = hmesh::kit::append_to(bytes);
    return write_mesh(mesh, ending, options, hmesh::Sink(sink));
}

hmesh::Status write_glb_levels(const std::vector<hmesh::MeshView>& all, const FormatOptions& options, hmesh::Sink sink) {
    // A level of a sprite may have lost as many vertices as the one before has, or all.
    std::vector<hmesh::MeshView> levels{all.front()};
    for (const hmesh::MeshView& level : all)
        if (level.vertex_count > 0 && level.vertex_count < levels.back().vertex_count) levels.push_back(level);
    hmesh::GltfOptions glb;
    glb.groups = options.groups;
    glb.color_bits = options.glb_color_bits;
    if (levels.front().vertex_count == 0) return hmesh::write_glb(levels.front(), sink, glb);
    if (options.glb == GlbForm::exact) return hmesh::write_glb_lods(levels, sink, glb);
    glb.quantized_positions = true;
    const bool is_compressed = options.glb == GlbForm::meshopt;
    if (is_compressed) glb.compress = compress_gltf;
    std::vector<std::vector<hmesh::Mesh>> ordered(levels.size());
    std::vector<std::vector<hmesh::MeshView>> views(levels.size());
    for (std::size_t k = 0; k < levels.size(); ++k) {
        // So that 16 bits number the vertices of each part.
        if (const hmesh::Status status = hmesh::cut_for_gpu(levels[k], ordered[k]); !status) return status;
        for (hmesh::Mesh& part : ordered[k]) {
            if (const hmesh::Status status = is_compressed ? order_to_compress(part) : order_for_gpu(part); !status)
                return status;
            views[k].push_back(part.view());
        }
    }
    return hmesh::write_glb_parts(views, sink, glb);
}

}  // namespace tool
