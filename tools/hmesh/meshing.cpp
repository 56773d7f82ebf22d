#include "meshing.hpp"

namespace tool {

hmesh::Colors final_colors(const MeshingOptions& options) noexcept {
    const bool is_sampled = options.method != Method::annealed && options.method != Method::hierarchical;
    return options.colors.value_or(is_sampled ? hmesh::Colors::sampled : hmesh::Colors::optimal);
}

std::string find_conflict(const MeshingOptions& options) {
    if (options.fit_space != FitSpace::linear) return {};
    if (final_colors(options) == hmesh::Colors::sampled) return "--fit-space linear fits colours, and sampled ones are asked for";
    return options.premultiplied ? "--fit-space linear fits straight colours, not premultiplied ones" : "";
}

hmesh::Result mesh_file(const ImageFile& image, const MeshingOptions& options, const hmesh::ParallelFor& parallel_for) {
    switch (image.channels) {
        case 1: return detail::mesh_channels<1>(image, options, parallel_for);
        case 2: return detail::mesh_channels<2>(image, options, parallel_for);
        case 3: return detail::mesh_channels<3>(image, options, parallel_for);
        default: return detail::mesh_channels<4>(image, options, parallel_for);
    }
}

hmesh::Status draw(const hmesh::MeshView& mesh, const DrawOptions& options, Picture& picture) {
    switch (mesh.channels) {
        case 1: return detail::draw_channels<1>(mesh, options, picture);
        case 2: return detail::draw_channels<2>(mesh, options, picture);
        case 3: return detail::draw_channels<3>(mesh, options, picture);
        default: return detail::draw_channels<4>(mesh, options, picture);
    }
}

}  // namespace tool
