// tools - all that the command asks of mesh_image() and render(), for images of C channels. Only channels_*.cpp include this:
// what they compile takes as long as all the rest. More of them would build faster on many cores, and compile more in common.
#ifndef HMESH_TOOLS_CHANNELS_HPP
#define HMESH_TOOLS_CHANNELS_HPP

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "hmesh/mesh_image.hpp"
#include "hmesh/render.hpp"
#include "meshing.hpp"

namespace tool::detail {

[[nodiscard]] inline hmesh::Method to_library(Method method) noexcept {
    switch (method) {
        case Method::annealed: break;
        case Method::hierarchical: return hmesh::Method::hierarchical;
        case Method::xie: return hmesh::Method::xie;
        case Method::adams: return hmesh::Method::adams;
        case Method::adaptive_thinning: return hmesh::Method::adaptive_thinning;
    }
    return hmesh::Method::annealed;
}

template <class T, int C>
[[nodiscard]] Outcome mesh_samples(const hmesh::ImageView<T, C>& view, const MeshingOptions& wanted,
                                   const hmesh::ParallelFor& parallel_for) {
    hmesh::Options options;
    options.target = wanted.target;
    options.method = to_library(wanted.method);
    options.effort = wanted.effort;
    options.seed = wanted.seed;
    options.tile = wanted.tile;
    options.colors = wanted.colors;
    options.fit_space = wanted.fit_space;
    options.premultiplied = wanted.premultiplied;
    options.weights = wanted.weights;
    options.progress = wanted.progress;
    hmesh::Result<C> result = hmesh::mesh_image(view, options, parallel_for);
    hmesh::Mesh<C>& mesh = result.mesh;
    hmesh::Report& report = result.report;
    return {{std::move(mesh.positions), std::move(mesh.colors), std::move(mesh.faces), C, mesh.width, mesh.height, mesh.peak,
             mesh.premultiplied},
            {report.vertices, report.faces, report.energy, report.psnr, std::move(report.stages)},
            result.status};
}

template <int C>
Outcome mesh_channels(const ImageFile& image, const MeshingOptions& options, const hmesh::ParallelFor& parallel_for) {
    if (image.bits == 16) {
        const hmesh::ImageView<std::uint16_t, C> view{image.samples16.data(), image.width, image.height, 0};
        return mesh_samples(view, options, parallel_for);
    }
    const hmesh::ImageView<std::uint8_t, C> view{image.samples8.data(), image.width, image.height, 0};
    return mesh_samples(view, options, parallel_for);
}

// PNG files have straight colours.
template <int C>
void divide_by_alpha(hmesh::Image<float, C>& picture, double peak) {
    std::vector<float>& samples = picture.samples();
    for (std::size_t k = 0; k < samples.size(); k += C) {
        const float alpha = samples[k + C - 1];
        for (std::size_t c = 0; c + 1 < C && alpha > 0; ++c) samples[k + c] *= static_cast<float>(peak) / alpha;
    }
}

template <int C>
hmesh::Status draw_channels(const hmesh::MeshView& mesh, const DrawOptions& options, Picture& picture) {
    const hmesh::RenderOptions render_options{options.scale * mesh.width, options.scale * mesh.height, options.linear_light};
    hmesh::Image<float, C> drawn;
    if (const hmesh::Status status = hmesh::render(mesh, drawn, render_options); !status) return status;
    if (mesh.premultiplied) divide_by_alpha(drawn, mesh.peak);
    picture = {drawn.width(), drawn.height(), C, {}};
    picture.samples.reserve(drawn.samples().size());
    const double scale = 255 / mesh.peak;
    for (const float sample : drawn.samples())
        picture.samples.push_back(hmesh::PixelTraits<std::uint8_t>::from_real(scale * static_cast<double>(sample)));
    return {};
}

}  // namespace tool::detail

// The definitions for images of C channels.
#define HMESH_TOOLS_CHANNELS(C)                                                                                                \
    template tool::Outcome tool::detail::mesh_channels<C>(const ImageFile&, const MeshingOptions&, const hmesh::ParallelFor&); \
    template hmesh::Status tool::detail::draw_channels<C>(const hmesh::MeshView&, const DrawOptions&, Picture&);

#endif  // HMESH_TOOLS_CHANNELS_HPP
