// tools - from types chosen at run time to hmesh's templates: meshes an ImageFile and draws the mesh, whatever the
// bits and channels of the file. All eight instantiations of mesh_image are made here, each with a ThreadPool, which may
// have one thread.
#ifndef HMESH_TOOLS_MESHING_HPP
#define HMESH_TOOLS_MESHING_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "hmesh/mesh_image.hpp"
#include "hmesh/render.hpp"
#include "image_file.hpp"
#include "pictures.hpp"
#include "thread_pool.hpp"
#include "wireframe.hpp"

namespace tool {

// What mesh_image returns, with the number of channels known at run time.
struct Outcome {
    hmesh::Report report;
    hmesh::Status status;
    std::vector<float> positions, colors;
    std::vector<std::array<std::uint32_t, 3>> faces;
    int channels = 0, width = 0, height = 0;
    double peak = 0;
    bool premultiplied = false;

    [[nodiscard]] bool has_mesh() const noexcept { return !faces.empty(); }
    [[nodiscard]] hmesh::MeshView view() const noexcept {
        return {positions.data(), colors.data(), faces.data(), positions.size() / 2, faces.size(), channels, width,
                height,           peak,          premultiplied};
    }
};

namespace detail {

template <class T, int C>
[[nodiscard]] Outcome mesh_samples(const ImageFile& image, const std::vector<T>& samples, const hmesh::Options& options,
                                   const example::ThreadPool& pool) {
    const hmesh::ImageView<T, C> view{samples.data(), image.width, image.height, 0};
    hmesh::Result<C> result = hmesh::mesh_image(view, options, pool);
    return {std::move(result.report),
            result.status,
            std::move(result.mesh.positions),
            std::move(result.mesh.colors),
            std::move(result.mesh.faces),
            C,
            result.mesh.width,
            result.mesh.height,
            result.mesh.peak,
            result.mesh.premultiplied};
}

template <class T>
[[nodiscard]] Outcome mesh_channels(const ImageFile& image, const std::vector<T>& samples, const hmesh::Options& options,
                                    const example::ThreadPool& pool) {
    switch (image.channels) {
        case 1: return mesh_samples<T, 1>(image, samples, options, pool);
        case 2: return mesh_samples<T, 2>(image, samples, options, pool);
        case 3: return mesh_samples<T, 3>(image, samples, options, pool);
        default: return mesh_samples<T, 4>(image, samples, options, pool);
    }
}

// PNG files have straight colours.
template <int C>
void divide_by_alpha(hmesh::Image<float, C>& picture, double peak) {
    for (std::size_t k = 0; k < picture.samples().size(); k += C) {
        const float alpha = picture.samples()[k + C - 1];
        for (std::size_t c = 0; c + 1 < C && alpha > 0; ++c) picture.samples()[k + c] *= static_cast<float>(peak) / alpha;
    }
}

template <int C>
[[nodiscard]] hmesh::Status draw_channels(const hmesh::MeshView& mesh, const hmesh::RenderOptions& options, Picture& picture) {
    hmesh::Image<float, C> drawn;
    if (const hmesh::Status status = hmesh::render(mesh, drawn, options); !status) return status;
    if (mesh.premultiplied) divide_by_alpha(drawn, mesh.peak);
    picture = {drawn.width(), drawn.height(), C, {}};
    picture.samples.reserve(drawn.samples().size());
    const double scale = 255 / mesh.peak;
    for (const float sample : drawn.samples())
        picture.samples.push_back(hmesh::PixelTraits<std::uint8_t>::from_real(scale * static_cast<double>(sample)));
    return {};
}

}  // namespace detail

[[nodiscard]] inline Outcome mesh_file(const ImageFile& image, const hmesh::Options& options, const example::ThreadPool& pool) {
    return image.bits == 16 ? detail::mesh_channels(image, image.samples16, options, pool)
                            : detail::mesh_channels(image, image.samples8, options, pool);
}

struct DrawOptions {
    int scale = 1;              // picture over mesh
    bool linear_light = false;  // see hmesh::RenderOptions
};

// The mesh drawn at 8 bits, with as many channels as it has, straight colours.
[[nodiscard]] inline hmesh::Status draw(const hmesh::MeshView& mesh, const DrawOptions& draw_options, Picture& picture) {
    const hmesh::RenderOptions options{draw_options.scale * mesh.width, draw_options.scale * mesh.height,
                                       draw_options.linear_light};
    switch (mesh.channels) {
        case 1: return detail::draw_channels<1>(mesh, options, picture);
        case 2: return detail::draw_channels<2>(mesh, options, picture);
        case 3: return detail::draw_channels<3>(mesh, options, picture);
        default: return detail::draw_channels<4>(mesh, options, picture);
    }
}

// The mesh drawn in red, green and blue, whatever is transparent over white.
[[nodiscard]] inline hmesh::Status draw_rgb(const hmesh::MeshView& mesh, const DrawOptions& options, Rgb& rgb) {
    Picture drawn;
    const hmesh::Status status = draw(mesh, options, drawn);
    if (status) rgb = to_rgb(drawn);
    return status;
}

[[nodiscard]] inline hmesh::Status draw_with_edges(const hmesh::MeshView& mesh, const DrawOptions& options, Rgb& rgb) {
    if (const hmesh::Status status = draw_rgb(mesh, options, rgb); !status) return status;
    return draw_wireframe(mesh, rgb);
}

}  // namespace tool

#endif  // HMESH_TOOLS_MESHING_HPP
