// All that the command asks of mesh_image() and render(): it takes half of the time that the command takes to compile. One
// file for each number of channels would be done sooner on four cores, and compile what all of them share three times more.
#include "meshing.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <vector>

#include "hmesh/image/image_reader.hpp"
#include "hmesh/image/premultiply.hpp"
#include "hmesh/io/compact/photographs.hpp"
#include "hmesh/large/mesh_reader.hpp"
#include "hmesh/lods/mesh_lods.hpp"
#include "hmesh/mesh_image.hpp"
#include "hmesh/methods/baselines/adams.hpp"
#include "hmesh/methods/baselines/adaptive_thinning.hpp"
#include "hmesh/methods/baselines/xie.hpp"
#include "hmesh/methods/hierarchical/hierarchical.hpp"
#include "hmesh/rate/compact_image.hpp"
#include "hmesh/render.hpp"
#include "hmesh/solve/linear_light.hpp"
#include "readers/rectangles.hpp"

namespace tool {
namespace {

double meshing_work(int width, int height, const MeshingOptions& options) noexcept {
    const double pixels = static_cast<double>(width) * height;
    const bool is_search = options.target.kind == hmesh::Target::Kind::psnr;
    double n = options.target.value;
    if (options.target.kind != hmesh::Target::Kind::vertices) n = std::max(4.0, pixels * (is_search ? 2 : n) / 100);
    if (options.target.max_vertices) n = std::min(n, static_cast<double>(*options.target.max_vertices));
    if (options.target.good_enough) n = std::min(n, std::max(4.0, pixels));
    const double one = options.method == Method::adaptive_thinning ? 12 * pixels
                       : options.method != Method::annealed
                           ? 0.2 * pixels + 150 * n
                           : hmesh::kit::annealed_work(hmesh::kit::annealed_steps(options.effort), pixels, n, 0).sum();
    // The coarser levels of all that there can be take two fifths of the first.
    const double coarser = 0.4 * one * (1 - std::exp2(1 - options.levels));
    // On a copy of 65,536 px, or more where the bytes are many.
    const double least = std::min(pixels, std::max(65536.0, 32.0 * static_cast<double>(options.bytes)));
    if (options.bytes > 0)
        return 40 * hmesh::kit::annealed_work(hmesh::kit::annealed_steps(options.effort), least,
                                              0.4 * static_cast<double>(options.bytes), 0)
                        .sum();
    return coarser + (is_search ? 2.5 * one : one);
}

double light_work(int width, int height, int channels) noexcept { return 0.18 * channels * width * height; }

// What the library is to be told.
hmesh::Options library_options(const MeshingOptions& wanted) {
    hmesh::Options options;
    options.target = wanted.target;
    options.colors = wanted.colors;
    options.premultiplied = wanted.premultiplied;
    options.periodic = wanted.periodic;
    options.straight_border = wanted.straight_border;
    options.samples = wanted.samples;
    options.weights = wanted.weights;
    options.channel_weights = wanted.channel_weights;
    options.limits.position_step = wanted.position_step;
    options.progress = wanted.progress;
    options.psnr_of = wanted.psnr_of;
    return options;
}

// Calls body(view) with the view of the image. What is called by view is compiled a dozen times: let it be little.
template <int C, class Body>
auto with_view(const ImageFile& image, Body&& body) {
    if (image.bits == 16) return body(hmesh::ImageView<std::uint16_t, C>{image.samples16.data(), image.width, image.height, 0});
    if (image.bits == 32) return body(hmesh::ImageView<float, C>{image.samples32.data(), image.width, image.height, 0});
    return body(hmesh::ImageView<std::uint8_t, C>{image.samples8.data(), image.width, image.height, 0});
}
// Calls body(c) with the number of channels, 1 to 4, as a constant.
template <class Body>
auto with_channels(int channels, Body&& body) {
    switch (channels) {
        case 1: return body(std::integral_constant<int, 1>());
        case 2: return body(std::integral_constant<int, 2>());
        case 3: return body(std::integral_constant<int, 3>());
        default: return body(std::integral_constant<int, 4>());
    }
}
template <class Body>
auto with_view(const ImageFile& image, Body&& body) {
    return with_channels(image.channels, [&](auto channels) { return with_view<channels.value>(image, body); });
}
// The same of several maps together too. join_images() makes no other kinds of them, for each kind takes two seconds to compile.
template <class Body>
auto with_any_view(const ImageFile& image, Body&& body) {
    if (image.channels <= 4) return with_view(image, body);
    const int width = image.width, height = image.height;
    const std::uint16_t* const shorts = image.samples16.data();
    if (image.bits == 32) return body(hmesh::ImageView<float, 16>{image.samples32.data(), width, height, 0});
    if (image.channels == 16) return body(hmesh::ImageView<std::uint16_t, 16>{shorts, width, height, 0});
    return body(hmesh::ImageView<std::uint16_t, 8>{shorts, width, height, 0});
}

// The sum of squares that is such a PSNR of the image, whose peak value is this.
double energy_of_psnr(double psnr, double peak, const ImageFile& image, const MeshingOptions& wanted) {
    const double unit = hmesh::kit::weight_unit(wanted.weights);
    const double channels = with_channels(image.channels, [&](auto count) {
        hmesh::kit::ChannelScale<count.value> scale;
        scale.share = hmesh::kit::channel_shares<count.value>(wanted.channel_weights);
        return scale.sum();
    });
    const double samples = channels * hmesh::kit::weight_sum(wanted.weights, unit, image.width, image.height);
    return std::isfinite(psnr) ? peak * peak * samples * std::pow(10.0, -psnr / 10) : 0;
}

hmesh::Annealed annealed_recipe(const MeshingOptions& wanted) {
    hmesh::Annealed recipe;
    recipe.effort = wanted.effort;
    recipe.seed = wanted.seed;
    recipe.tile = wanted.tile;
    recipe.border_tolerance = wanted.border_tolerance;
    if (wanted.start != nullptr) {
        recipe.start = wanted.start;
        recipe.steps = hmesh::kit::annealed_steps(hmesh::Effort::draft);
    }
    return recipe;
}

template <class T, int C>
[[nodiscard]] hmesh::Result mesh_by_method(const hmesh::ImageView<T, C>& view, const MeshingOptions& wanted,
                                           const hmesh::Options& options, const hmesh::Annealed& annealed,
                                           const hmesh::ParallelFor& parallel_for) {
    if constexpr (C <= 4) {  // others are for images
        switch (wanted.start != nullptr ? Method::annealed : wanted.method) {
            case Method::annealed: break;
            case Method::hierarchical: return hmesh::mesh_image(view, options, hmesh::Hierarchical(), parallel_for);
            case Method::xie: return hmesh::mesh_image(view, options, hmesh::Xie(), parallel_for);
            case Method::adams: return hmesh::mesh_image(view, options, hmesh::Adams(), parallel_for);
            case Method::adaptive_thinning: return hmesh::mesh_image(view, options, hmesh::AdaptiveThinning(), parallel_for);
        }
    }
    return hmesh::mesh_image(view, options, annealed, parallel_for);
}

hmesh::Lods one_level(hmesh::Result result) {
    hmesh::Lods lods;
    lods.status = result.status;
    if (result.has_mesh()) lods.levels.push_back(std::move(result));
    return lods;
}

[[nodiscard]] hmesh::Lods mesh_samples(const ImageFile& image, const MeshingOptions& wanted,
                                       const hmesh::ParallelFor& parallel_for) {
    hmesh::Options options = library_options(wanted);
    // What a sprite counts as is what is left of it.
    const auto psnr_of_sprite = [&](const hmesh::Mesh& mesh, double psnr) {
        hmesh::Result trial;
        trial.mesh = mesh;
        trial.mesh.premultiplied = wanted.premultiplied;
        trial.report.energy = energy_of_psnr(psnr, mesh.peak, image, wanted);
        trial.report.psnr = psnr;
        if (!drop_faces(image, wanted, trial, parallel_for).status) return psnr;
        return wanted.psnr_of ? wanted.psnr_of(trial.mesh, trial.report.psnr) : trial.report.psnr;
    };
    if (wanted.transparent >= 0) options.psnr_of = psnr_of_sprite;
    const hmesh::Annealed annealed = annealed_recipe(wanted);
    if (wanted.levels > 1) {
        hmesh::LodOptions lods;
        lods.levels = wanted.levels;
        return with_any_view(image,
                             [&](const auto& view) { return hmesh::mesh_lods(view, options, lods, annealed, parallel_for); });
    }
    return one_level(
        with_any_view(image, [&](const auto& view) { return mesh_by_method(view, wanted, options, annealed, parallel_for); }));
}

// The largest difference, in stored values, between an image and a mesh drawn in linear light, where pixels and channels
// count.
double largest_light_error(const ImageFile& image, const MeshingOptions& options, const hmesh::Mesh& mesh,
                           const hmesh::ParallelFor& parallel_for) {
    std::vector<float> drawn;
    if (!draw_samples(mesh.view(), true, drawn, parallel_for)) return 0;
    const std::vector<float> wanted = wanted_samples(image, false, parallel_for);
    double largest = 0;
    std::size_t k = 0;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            for (std::size_t c = 0; c < static_cast<std::size_t>(image.channels); ++c, ++k) {
                if (options.weights.data != nullptr && !(*options.weights.pixel(x, y) > 0)) continue;
                if (!options.channel_weights.empty() && !(options.channel_weights[c] > 0)) continue;
                largest = std::max(largest, std::abs(static_cast<double>(drawn[k]) - static_cast<double>(wanted[k])));
            }
    return largest;
}

// Fits the mesh's colours for linear light.
hmesh::LinearLightReport fit_linear_light(const ImageFile& image, const MeshingOptions& wanted, hmesh::Mesh& mesh,
                                          const hmesh::ParallelFor& parallel_for,
                                          hmesh::FunctionRef<bool(double share)> progress = {}) {
    hmesh::LinearLightOptions options;
    options.weights = wanted.weights;
    options.channel_weights = wanted.channel_weights;
    // Colours of floats are not rounded: the steps of whole numbers mean nothing to them.
    options.grid = image.bits == 32 ? 0 : 1;
    return with_view(image,
                     [&](const auto& view) { return hmesh::fit_linear_light(mesh, view, options, parallel_for, progress); });
}

// A stage after all others: colours for linear light, from the share `from` of the whole to the share `to`.
void fit_light(const ImageFile& image, const MeshingOptions& wanted, double from, double to, hmesh::Result& result,
               const hmesh::ParallelFor& parallel_for) {
    hmesh::ProgressInfo info{"linear light", 0, result.report.vertices, result.report.energy, from};
    const auto go_on = [&](double share) {
        info.fraction = share;
        info.total = share < 1 ? from + (to - from) * share : to;
        return !wanted.progress || wanted.progress(info);
    };
    bool is_stopped = !go_on(0);
    const auto progress = [&](double share) {
        is_stopped = is_stopped || !go_on(share);
        return !is_stopped;
    };
    const hmesh::LinearLightReport report = fit_linear_light(image, wanted, result.mesh, parallel_for, progress);
    result.report.energy = info.energy = report.energy;
    result.report.psnr = report.psnr;
    result.report.max_error = largest_light_error(image, wanted, result.mesh, parallel_for);
    result.report.stages.push_back(
        {info.stage, result.report.vertices, report.energy, report.psnr, report.solver_iterations, report.residual});
    is_stopped = !go_on(1) || is_stopped;
    if (result.status && is_stopped) result.status = hmesh::kit::cancelled_by_callback();
}

[[nodiscard]] hmesh::Lods mesh_whole(const ImageFile& image, const MeshingOptions& options,
                                     const hmesh::ParallelFor& parallel_for) {
    if (options.fit_space != FitSpace::linear) return mesh_samples(image, options, parallel_for);
    const double work = meshing_work(image, options), light = light_work(image);
    const double before = work / (work + options.levels * light);
    MeshingOptions first = options;
    const auto progress = [&](hmesh::ProgressInfo info) {
        info.total *= before;
        return options.progress(info);
    };
    if (options.progress) first.progress = progress;
    hmesh::Lods lods = mesh_samples(image, first, parallel_for);
    const auto count = static_cast<double>(lods.levels.size());
    for (std::size_t k = 0; k < lods.levels.size(); ++k) {
        const double from = before + (1 - before) * static_cast<double>(k) / count;
        const double to = k + 1 < lods.levels.size() ? before + (1 - before) * static_cast<double>(k + 1) / count : 1;
        hmesh::Result& level = lods.levels[k];
        fit_light(image, options, from, to, level, parallel_for);
        if (lods.status && !level.status) lods.status = level.status;
    }
    return lods;
}

// PNG files have straight colours.
template <int C>
void divide_by_alpha(hmesh::Image<float, C>& picture, double peak) {
    float* const samples = picture.data();
    for (std::size_t k = 0; k < picture.size(); k += C) {
        const float alpha = samples[k + C - 1];
        for (std::size_t c = 0; c + 1 < C && alpha > 0; ++c) samples[k + c] *= static_cast<float>(peak) / alpha;
    }
}

template <int C>
[[nodiscard]] hmesh::RenderResult<C> render_channels(const hmesh::MeshView& mesh, const DrawOptions& options,
                                                     const hmesh::ParallelFor& parallel_for = {}) {
    hmesh::RenderOptions render_options;
    render_options.width = options.scale * mesh.width;
    render_options.height = options.scale * mesh.height;
    if (options.linear_light) render_options.interpolation = hmesh::RenderOptions::Interpolation::linear;
    return hmesh::render<C>(mesh, render_options, parallel_for);
}

template <int C>
hmesh::Status draw_channels(const hmesh::MeshView& mesh, const DrawOptions& options, Picture& picture) {
    hmesh::RenderResult<C> drawn = render_channels<C>(mesh, options);
    if (!drawn.status) return drawn.status;
    if (mesh.premultiplied) divide_by_alpha(drawn.image, mesh.peak);
    picture = {drawn.image.width(), drawn.image.height(), C, {}};
    picture.samples.reserve(drawn.image.size());
    const double scale = 255 / mesh.peak;
    for (std::size_t k = 0; k < drawn.image.size(); ++k)
        picture.samples.push_back(
            hmesh::PixelTraits<std::uint8_t>::from_real(scale * static_cast<double>(drawn.image.data()[k])));
    return {};
}

template <int C>
hmesh::Status draw_floats(const hmesh::MeshView& mesh, bool linear_light, std::vector<float>& samples,
                          const hmesh::ParallelFor& parallel_for) {
    const hmesh::RenderResult<C> drawn = render_channels<C>(mesh, {1, linear_light}, parallel_for);
    if (drawn.status) samples.assign(drawn.image.data(), drawn.image.data() + drawn.image.size());
    return drawn.status;
}

template <class T, int C>
std::vector<float> to_floats(const hmesh::ImageView<T, C>& view, bool premultiplied, const hmesh::ParallelFor& parallel_for) {
    if constexpr (hmesh::kit::has_alpha(C))
        if (premultiplied) return to_floats(hmesh::kit::premultiply(view, parallel_for).view(), false, parallel_for);
    std::vector<float> samples;
    samples.reserve(static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height) * C);
    for (int y = 0; y < view.height; ++y) {
        const T* const row = view.pixel(0, y);
        for (int k = 0; k < C * view.width; ++k) samples.push_back(static_cast<float>(hmesh::PixelTraits<T>::to_real(row[k])));
    }
    return samples;
}

}  // namespace

double meshing_work(const ImageFile& image, const MeshingOptions& options) noexcept {
    return meshing_work(image.width, image.height, options);
}

double light_work(const ImageFile& image) noexcept { return light_work(image.width, image.height, image.channels); }

std::vector<float> wanted_samples(const ImageFile& image, bool premultiplied, const hmesh::ParallelFor& parallel_for) {
    return with_view(image, [&](const auto& view) { return to_floats(view, premultiplied, parallel_for); });
}

hmesh::Status draw_samples(const hmesh::MeshView& mesh, bool linear_light, std::vector<float>& samples,
                           const hmesh::ParallelFor& parallel_for) {
    return with_channels(mesh.channels,
                         [&](auto channels) { return draw_floats<channels.value>(mesh, linear_light, samples, parallel_for); });
}

hmesh::Colors final_colors(const MeshingOptions& options) noexcept {
    const bool is_sampled = options.method != Method::annealed && options.method != Method::hierarchical;
    return options.colors.value_or(is_sampled ? hmesh::Colors::sampled : hmesh::Colors::optimal);
}

std::string find_conflict(const MeshingOptions& options) {
    if (options.fit_space == FitSpace::stored) return {};
    if (final_colors(options) == hmesh::Colors::sampled) return "--fit-space linear fits colours, and sampled ones are asked for";
    return options.premultiplied ? "--fit-space linear fits straight colours, not premultiplied ones: leave one of them out" : "";
}

// Of a file that is read by rectangles, whose samples are in none of the image's vectors.
[[nodiscard]] hmesh::Lods mesh_rectangles(const ImageFile& image, const MeshingOptions& options,
                                          const hmesh::ParallelFor& parallel_for) {
    const auto mesh = [&](auto sample, auto channels) {
        using T = decltype(sample);
        const auto read = [&](const hmesh::kit::Rect& rect, T* samples, std::ptrdiff_t row_stride) {
            return image.rectangles->read(rect, samples, row_stride);
        };
        const hmesh::ImageReader<T, channels.value> reader{image.width, image.height, read, true};
        return one_level(hmesh::mesh_image(reader, library_options(options), annealed_recipe(options), parallel_for));
    };
    return with_channels(image.channels, [&](auto channels) {
        if (image.bits == 16) return mesh(std::uint16_t(), channels);
        if (image.bits == 32) return mesh(float(), channels);
        return mesh(std::uint8_t(), channels);
    });
}

hmesh::Lods mesh_levels(const ImageFile& image, const MeshingOptions& options, const hmesh::ParallelFor& parallel_for) {
    if (image.rectangles) return mesh_rectangles(image, options, parallel_for);
    return mesh_whole(image, options, parallel_for);
}

hmesh::Result first_level(hmesh::Lods& lods) {
    hmesh::Result first;
    if (!lods.levels.empty()) {
        first = std::move(lods.levels.front());
        lods.levels.erase(lods.levels.begin());
    }
    first.status = lods.status;
    return first;
}

hmesh::Result fit_bytes(const ImageFile& image, const MeshingOptions& options, const hmesh::ParallelFor& parallel_for,
                        std::vector<unsigned char>& file) {
    hmesh::CompactImageOptions wanted;
    wanted.bytes = options.bytes;
    if (options.start_table) wanted.table = &hmesh::compact_photographs;
    wanted.premultiplied = options.premultiplied;
    wanted.progress = options.progress;
    const hmesh::Annealed recipe = annealed_recipe(options);
    hmesh::CompactImage made = with_channels(image.channels, [&](auto channels) {
        const hmesh::ImageView<std::uint8_t, channels.value> view{image.samples8.data(), image.width, image.height, 0};
        return hmesh::compact_image(view, wanted, recipe, parallel_for);
    });
    hmesh::Result result;
    result.status = made.status;
    result.mesh = std::move(made.mesh);
    file = std::move(made.bytes);
    result.report.vertices = result.mesh.vertex_count();
    result.report.faces = result.mesh.faces.size();
    std::vector<float> drawn;
    if (!result.status || !draw_samples(result.mesh.view(), false, drawn)) return result;
    const std::vector<float> samples = wanted_samples(image, wanted.premultiplied, parallel_for);
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const double off = std::abs(static_cast<double>(drawn[k]) - static_cast<double>(samples[k]));
        result.report.energy += off * off;
        result.report.max_error = std::max(result.report.max_error, off);
    }
    result.report.psnr = hmesh::kit::psnr_of_energy(result.report.energy, static_cast<double>(samples.size()), result.mesh.peak);
    return result;
}

hmesh::Result mesh_file(const ImageFile& image, const MeshingOptions& options, const hmesh::ParallelFor& parallel_for) {
    hmesh::Lods lods = mesh_levels(image, options, parallel_for);
    return first_level(lods);
}

hmesh::SpriteReport drop_faces(const ImageFile& image, const MeshingOptions& options, hmesh::Result& outcome,
                               const hmesh::ParallelFor& parallel_for) {
    if (!hmesh::kit::has_alpha(image.channels)) {
        hmesh::SpriteReport report;  // all of it is opaque
        report.opaque_faces = outcome.mesh.faces.size();
        report.area = static_cast<double>(image.width) * image.height;
        return report;
    }
    const hmesh::Options wanted = library_options(options);
    const auto drop = [&](const auto& view) {
        return hmesh::drop_transparent(outcome, view, wanted, options.transparent, parallel_for);
    };
    return image.channels == 2 ? with_view<2>(image, drop) : with_view<4>(image, drop);
}

hmesh::Outline outline_file(const ImageFile& image, const hmesh::OutlineOptions& options) {
    return with_view(image, [&](const auto& view) { return hmesh::outline(view, options); });
}

LightMesh light_mesh(const ImageFile& image, const MeshingOptions& options, const hmesh::Mesh& mesh,
                     const hmesh::ParallelFor& parallel_for) {
    LightMesh out;
    out.mesh = mesh;
    const hmesh::LinearLightReport report = fit_linear_light(image, options, out.mesh, parallel_for);
    out.psnr = report.psnr;
    out.stored_psnr = report.psnr - 10 * std::log10(report.converted / report.energy);
    if (!(report.energy > 0)) out.stored_psnr = out.psnr;  // converted is 0 too, or as good as that
    return out;
}

hmesh::Status draw(const hmesh::MeshView& mesh, const DrawOptions& options, Picture& picture) {
    return with_channels(mesh.channels, [&](auto channels) { return draw_channels<channels.value>(mesh, options, picture); });
}

}  // namespace tool
