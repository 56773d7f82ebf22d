// hmesh - mesh_image(): an image in, a mesh out. The entry point.
//
//     hmesh::ImageView<std::uint8_t, 3> view{pixels, width, height};
//     auto result = hmesh::mesh_image(view);                       // 1 % of the pixels as vertices
//     if (!result.status) ...                                      // result.mesh, result.report
//
// The error that is minimised and reported is that of the final mesh - positions on the 1/256 px grid, colours rounded to
// the pixel type - as a GPU draws it: the squared difference in the image's stored values (sRGB-encoded for usual files),
// summed over pixels and channels.
#ifndef HMESH_MESH_IMAGE_HPP
#define HMESH_MESH_IMAGE_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "hmesh/core/parallel.hpp"
#include "hmesh/core/progress.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/fit/colors.hpp"
#include "hmesh/fit/patchwork.hpp"
#include "hmesh/fit/sampling.hpp"
#include "hmesh/image/image_source.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/image/weights.hpp"
#include "hmesh/image/pyramid.hpp"
#include "hmesh/mesh/mesh_view.hpp"
#include "hmesh/methods/adams.hpp"
#include "hmesh/methods/adaptive_thinning.hpp"
#include "hmesh/methods/annealed.hpp"
#include "hmesh/methods/hierarchical.hpp"
#include "hmesh/methods/psnr_search.hpp"
#include "hmesh/methods/xie.hpp"

namespace hmesh {

// The recipes in methods/. All but the first are there to be compared with: they know no effort, seed or tile, and mesh the
// image in one piece on one thread.
enum class Method : std::uint8_t {
    annealed,
    hierarchical,       // "Image meshing via hierarchical optimization"
    xie,                // Xie et al. 2014
    adams,              // Adams 2011
    adaptive_thinning,  // Demaret and Iske 2004; images up to adaptive_thinning_pixels
};

// How vertices get their final colours.
enum class Colors : std::uint8_t {
    optimal,  // least squares for the final geometry
    sampled,  // those of the image under the vertices
};

// How many vertices the mesh gets. Corners count.
struct Target {
    enum class Kind : std::uint8_t { vertices, rate, psnr };
    Kind kind = Kind::rate;
    double value = 1;

    // Exactly n vertices, 4 <= n <= max(4, pixels).
    [[nodiscard]] static Target vertices(std::int64_t n) noexcept { return {Kind::vertices, static_cast<double>(n)}; }
    // This percentage of the pixels, rounded, in (0, 100]; at least 4 vertices.
    [[nodiscard]] static Target rate(double percent) noexcept { return {Kind::rate, percent}; }
    // The fewest vertices found that reach this PSNR, in dB > 0: about six runs at counts that close in on it.
    [[nodiscard]] static Target psnr(double decibel) noexcept { return {Kind::psnr, decibel}; }
};

struct Options {
    Target target;
    Method method = Method::annealed;
    Effort effort = Effort::normal;
    std::uint64_t seed = 1;  // of methods that draw random numbers
    Progress progress;
    MeshLimits limits;
    ImageView<float, 1> weights;  // how much each pixel counts, >= 0, of the image's size; none: all count the same
    // px: larger images are meshed in tiles of about this size, 64 to 65536, each of which is a piece of work for a thread.
    // 0: in one piece up to a megapixel and 16384 vertices, in tiles of 256 px beyond.
    int tile = 0;
    // In place of what `effort` means: start from annealed_options(effort) and change what you like. Its seed is ignored.
    std::optional<AnnealedOptions> annealed;
    AdamsOptions adams;
    XieOptions xie;
    HierarchicalOptions hierarchical;
    // None: as the method is defined, sampled for adams, adaptive_thinning and xie, else optimal.
    std::optional<Colors> colors;
    // Round colours to the pixel type's values, so that a file with such colours holds the very mesh that was measured.
    // Ignored for float. Costs about 0.003 dB at 30 dB, 0.1 dB at 45 dB.
    bool round_colors = true;
};

// The colours that a mesh made with these options has.
[[nodiscard]] inline Colors final_colors(const Options& options) noexcept {
    if (options.colors) return *options.colors;
    return options.method == Method::annealed || options.method == Method::hierarchical ? Colors::optimal : Colors::sampled;
}

// Of the final mesh. PSNR = 10 log10(peak^2 / MSE), MSE the mean over pixels AND channels of the squared difference between
// the image and the mesh drawn at its size, colours neither rounded nor clamped after interpolation; infinity for MSE 0. With
// weights, each pixel counts in `energy` and in the mean as often as its weight over the largest says (image/weights.hpp).
struct Report {
    std::size_t vertices = 0, faces = 0;
    double energy = 0;  // the sum of squared differences over pixels and channels
    double psnr = 0;    // dB
    std::vector<StageReport> stages;
};

// `mesh` is valid, and `report` true of it, whatever the status; where nothing could be meshed it is empty.
template <int C>
struct [[nodiscard]] Result {
    Mesh<C> mesh;
    Report report;
    Status status;
};

namespace detail {

// The integer nearest to a number that may be none: 0 for NaN, the ends for infinities.
[[nodiscard]] inline std::int64_t nearest_integer(double value) noexcept {
    if (!(value == value)) return 0;
    return static_cast<std::int64_t>(std::max(-9e18, std::min(9e18, value)));
}

[[nodiscard]] inline Status check_options(const Options& options, std::int64_t pixels) noexcept {
    const Target& target = options.target;
    const std::int64_t most = std::max<std::int64_t>(4, pixels);
    if (target.kind == Target::Kind::vertices) {
        if (!(target.value >= 4))
            return {Errc::target_out_of_range, "a mesh has at least 4 vertices", nearest_integer(target.value), 4};
        if (target.value > static_cast<double>(most))
            return {Errc::target_out_of_range, "a mesh has at most one vertex a pixel", nearest_integer(target.value), most};
    } else if (target.kind == Target::Kind::rate) {
        if (!(target.value > 0 && target.value <= 100))
            return {Errc::target_out_of_range, "the rate must be above 0 and at most 100 percent of the pixels", 0, 100};
    } else if (!(target.value > 0 && std::isfinite(target.value))) {
        return {Errc::target_out_of_range, "the PSNR asked for must be positive and finite, in dB", 0, 1};
    }
    const MeshLimits& limits = options.limits;
    if (!(limits.min_cross >= 1e-4 && limits.min_cross <= 0.25))
        return {Errc::invalid_argument, "limits.min_cross must be in [1e-4, 0.25] px^2", 0, 0};
    if (!(limits.border_gap >= 1.0 / 256 && limits.border_gap <= 0.25))
        return {Errc::invalid_argument, "limits.border_gap must be in [1/256, 1/4] px", 0, 0};
    if (!(limits.color_overshoot >= 0 && limits.color_overshoot <= 100))
        return {Errc::invalid_argument, "limits.color_overshoot must be in [0, 100]", 0, 100};
    if (!(limits.ridge >= 1e-9 && limits.ridge <= 1))
        return {Errc::invalid_argument, "limits.ridge must be in [1e-9, 1] pixels", 0, 1};
    if (options.tile != 0 && (options.tile < 64 || options.tile > max_side))
        return {Errc::invalid_argument, "the tile must be 0, for the default, or 64 to 65536 px", options.tile,
                options.tile < 64 ? 64 : max_side};
    switch (options.method) {
        case Method::annealed: return options.annealed ? check(*options.annealed) : Status{};
        case Method::hierarchical: return check(options.hierarchical);
        case Method::xie: return check(options.xie);
        case Method::adams: return check(options.adams);
        case Method::adaptive_thinning:
            if (pixels <= adaptive_thinning_pixels) return {};
            return {Errc::image_too_large, "the method adaptive_thinning starts from all pixels, and the image has too many", pixels,
                    adaptive_thinning_pixels};
    }
    return {Errc::invalid_argument, "the method is none of those known", static_cast<std::int64_t>(options.method), 0};
}

// The mesh as plain arrays.
template <int C>
[[nodiscard]] Mesh<C> extract(const WholeMesh<C>& whole, double peak) {
    Mesh<C> out;
    out.width = whole.width;
    out.height = whole.height;
    out.peak = peak;
    out.positions.reserve(2 * whole.vertex_count());
    out.colors.reserve(C * whole.vertex_count());
    for (std::size_t i = 0; i < whole.vertex_count(); ++i) {
        out.positions.push_back(static_cast<float>(whole.positions[i].x));
        out.positions.push_back(static_cast<float>(whole.positions[i].y));
        for (int c = 0; c < C; ++c) out.colors.push_back(static_cast<float>(whole.colors[i][c]));
    }
    out.faces = whole.triangles;
    return out;
}

// The levels of the image as the method hierarchical wants them, from 1 on.
template <class T, int C, class ParallelFor>
[[nodiscard]] bool run_hierarchical(Patchwork<C, ParallelFor>& work, const ImageView<T, C>& view, std::size_t n, const Options& options,
                                    double unit) {
    const HierarchicalOptions& recipe = options.hierarchical;
    work.whole() = regular_grid(work.source(), 4);  // what a cancellation finds
    if (!work.monitor().begin("levels", work.vertex_count(), work.energy())) return false;
    const Pyramid<T, C> pyramid = make_pyramid(view, recipe.levels, recipe.bilateral, recipe.filter, work.parallel_for());
    std::vector<ImageSource<C>> coarse;
    for (int level = 1; level < recipe.levels; ++level) coarse.emplace_back(pyramid.level(level), options.weights, unit);
    {
        // The report tells the error of what there is, measured apart so that no moment table stays meanwhile.
        Patchwork<C, ParallelFor> corners(work.source(), work.limits(), work.monitor(), work.parallel_for());
        corners.whole() = std::move(work.whole());
        corners.measure(one_tile(work.source()));
        work.whole() = std::move(corners.whole());
    }
    return work.monitor().end(work.vertex_count(), work.energy()) && hierarchical(work, coarse, n, recipe);
}

// A mesh of n vertices by the method asked for.
template <class T, int C, class ParallelFor>
[[nodiscard]] Status run(Patchwork<C, ParallelFor>& work, const ImageView<T, C>& view, std::size_t n, const Options& options, double unit) {
    const auto done = [](bool finished) { return finished ? Status{} : cancelled_by_callback(); };
    switch (options.method) {
        case Method::annealed: break;
        case Method::hierarchical: return done(run_hierarchical(work, view, n, options, unit));
        case Method::xie: return done(xie(work, n, options.xie));
        case Method::adams: return done(adams(work, n, options.adams));
        case Method::adaptive_thinning: return done(adaptive_thinning(work, n));
    }
    AnnealedOptions recipe = options.annealed.value_or(annealed_options(options.effort));
    recipe.seed = options.seed;
    return annealed(work, n, recipe, options.tile);
}

// One mesh of n vertices, finished. `samples`: pixels, or the sum of their weights, times channels.
template <class T, int C, class ParallelFor>
[[nodiscard]] Result<C> mesh_with(const ImageView<T, C>& view, double unit, double samples, std::size_t n, const Options& options,
                                  const ParallelFor& parallel_for) {
    using Traits = PixelTraits<T>;
    const ImageSource<C> source(view, options.weights, unit);
    Monitor monitor(options.progress, samples, Traits::peak);
    Patchwork<C, ParallelFor> work(source, options.limits, monitor, parallel_for);
    Result<C> result;
    result.status = run(work, view, n, options, unit);
    monitor.begin("colors", work.vertex_count(), work.energy());
    const double grid = Traits::is_integer && options.round_colors ? 1 : 0;
    const bool in_tiles = options.method == Method::annealed;
    const Tiling tiling =
        in_tiles ? Tiling(source.width(), source.height(), tile_size(source.width(), source.height(), n, options.tile)) : one_tile(source);
    if (final_colors(options) == Colors::sampled) sample_colors(work, tiling, grid);
    else bounded_colors(work, tiling, Traits::lowest, Traits::highest, grid);
    monitor.end(work.vertex_count(), work.energy());
    if (result.status && monitor.stopped()) result.status = cancelled_by_callback();
    const WholeMesh<C>& whole = work.whole();
    result.mesh = extract(whole, Traits::peak);
    const double energy = std::max(0.0, whole.energy);  // rounding may leave less than nothing
    result.report = {whole.vertex_count(), whole.triangles.size(), energy, psnr_of_energy(energy, samples, Traits::peak),
                     monitor.stages()};
    return result;
}

}  // namespace detail

// Meshes the image. Tiles run through `parallel_for` (core/parallel.hpp); same image, options and seed give the same bytes,
// whatever it does. Memory: about 0.3 KB a vertex, and for each tile at work its moment table (32 bytes a pixel for 8-bit
// RGB, 92 with weights) and 0.6 KB for each vertex placed there; a small image is one tile, and any image is for methods
// other than annealed.
//
// Status: invalid_argument, image_too_large or not_finite where the image or an option is refused (the mesh is empty);
// target_out_of_range for a number of vertices that the image cannot hold (empty) or a PSNR that no mesh reached (the
// nearest one is returned); cancelled by options.progress (the mesh reached so far is returned).
template <class T, int C, class ParallelFor = SerialFor>
[[nodiscard]] Result<C> mesh_image(const ImageView<T, C>& view, const Options& options = {}, const ParallelFor& parallel_for = {}) {
    Result<C> result;
    result.status = check(view);
    if (result.status) result.status = detail::check_options(options, std::int64_t{view.width} * view.height);
    if (result.status) result.status = check_finite(view, parallel_for);
    if (result.status) result.status = check_weights(options.weights, view.width, view.height, parallel_for);
    if (!result.status) return result;

    const double unit = weight_unit(options.weights, parallel_for);
    const double samples = C * weight_sum(options.weights, unit, view.width, view.height, parallel_for);
    const auto pixels = static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
    const std::size_t most = std::max<std::size_t>(4, pixels);
    const auto mesh_of = [&](std::size_t n) { return detail::mesh_with(view, unit, samples, n, options, parallel_for); };
    const auto share = [&](double percent) {
        return std::min(most, std::max<std::size_t>(4, static_cast<std::size_t>(std::llround(static_cast<double>(pixels) * percent / 100))));
    };
    switch (options.target.kind) {
        case Target::Kind::vertices: return mesh_of(static_cast<std::size_t>(options.target.value));
        case Target::Kind::rate: return mesh_of(share(options.target.value));
        case Target::Kind::psnr: return fewest_vertices(options.target.value, share(1), most, mesh_of);
    }
    result.status = {Errc::invalid_argument, "the target is of no known kind", static_cast<std::int64_t>(options.target.kind), 0};
    return result;
}

}  // namespace hmesh

#endif  // HMESH_MESH_IMAGE_HPP
