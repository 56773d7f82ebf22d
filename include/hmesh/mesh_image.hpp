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
#include <utility>
#include <vector>

#include "hmesh/core/assert.hpp"
#include "hmesh/core/lanes.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/core/progress.hpp"
#include "hmesh/core/psnr.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/solve/bounded_colors.hpp"
#include "hmesh/fit/rendered_error.hpp"
#include "hmesh/solve/linear_light.hpp"
#include "hmesh/tiles/tiled_mesh.hpp"
#include "hmesh/solve/sampled_colors.hpp"
#include "hmesh/fit/image_source.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/fit/moment_table.hpp"
#include "hmesh/image/premultiply.hpp"
#include "hmesh/methods/hierarchical/pyramid.hpp"
#include "hmesh/image/weights.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/methods/baselines/adams.hpp"
#include "hmesh/methods/baselines/adaptive_thinning.hpp"
#include "hmesh/methods/annealed/annealed.hpp"
#include "hmesh/methods/hierarchical/hierarchical.hpp"
#include "hmesh/options.hpp"
#include "hmesh/methods/psnr_search.hpp"
#include "hmesh/methods/baselines/xie.hpp"

namespace hmesh {

// Of the final mesh. PSNR = 10 log10(peak^2 / MSE), MSE the mean over pixels AND channels of the squared difference between
// the image and the mesh drawn at its size, colours neither rounded nor clamped after interpolation; infinity for MSE 0. Drawn
// between stored values, or in linear light where Options::fit_space says so; the image premultiplied where Options does. With
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

// The mesh as plain arrays.
template <int C>
[[nodiscard]] Mesh<C> extract(const IndexedMesh<C>& whole, double peak) {
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
template <class T, int C>
[[nodiscard]] bool run_hierarchical(TiledMesh<C>& work, const ImageView<T, C>& view, std::size_t n, const Options& options,
                                    double unit) {
    const HierarchicalOptions& recipe = options.hierarchical;
    work.indexed() = regular_grid(work.source(), 4);  // what a cancellation finds
    if (!work.monitor().begin("levels", work.vertex_count(), work.energy())) return false;
    const Pyramid<T, C> pyramid = make_pyramid(view, recipe.levels, recipe.bilateral, recipe.filter, work.parallel_for());
    std::vector<ImageSource<C>> coarse;
    for (int level = 1; level < recipe.levels; ++level) coarse.emplace_back(pyramid.level(level), options.weights, unit);
    {
        // The report tells the error of what there is, measured apart so that no moment table stays meanwhile.
        TiledMesh<C> corners(work.source(), work.limits(), work.monitor(), work.parallel_for());
        corners.indexed() = std::move(work.indexed());
        corners.measure(one_tile(work.source()));
        work.indexed() = std::move(corners.indexed());
    }
    return work.monitor().end(work.vertex_count(), work.energy()) && hierarchical(work, coarse, n, recipe);
}

// A mesh of n vertices by the method asked for.
template <class T, int C>
[[nodiscard]] Status run(TiledMesh<C>& work, const ImageView<T, C>& view, std::size_t n, const Options& options, double unit) {
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

// The stage after all others: colours for linear light. Returns the energy seen through it; `energy` is that before.
template <class T, int C>
[[nodiscard]] double light_colors(Mesh<C>& mesh, const ImageView<T, C>& view, const ImageView<float, 1>& weights, double ridge,
                                  double grid, double energy, ProgressReporter& monitor, const ParallelFor& parallel_for) {
    LinearLightOptions recipe;
    recipe.weights = weights;
    recipe.ridge = ridge;
    recipe.grid = grid;
    monitor.begin("linear light", mesh.vertex_count(), energy);
    const auto go_on = [&](double share) { return monitor.update(share, mesh.vertex_count(), energy); };
    const LinearLightReport report = fit_linear_light(mesh, view, recipe, parallel_for, go_on);
    HMESH_ASSERT(report.status);
    monitor.note_solve(report.solver_iterations, report.residual);
    monitor.end(mesh.vertex_count(), report.energy);
    return report.energy;
}

// One mesh of n vertices, finished. `samples`: pixels, or the sum of their weights, times channels.
template <class T, int C>
[[nodiscard]] Result<C> mesh_with(const ImageView<T, C>& view, double unit, double samples, std::size_t n, const Options& options,
                                  const ParallelFor& parallel_for) {
    using Traits = PixelTraits<T>;
    Result<C> result;
    const bool in_tiles = options.method == Method::annealed;
    const double longest = std::max(view.width, view.height);
    const double tile = in_tiles ? tile_size(view.width, view.height, n, options.tile) : longest;
    // Patches stand out of their tiles by parts of a triangle: hence twice as large.
    const int widest = static_cast<int>(std::min<double>(view.width, 2 * tile));
    const int highest = static_cast<int>(std::min<double>(view.height, 2 * tile));
    if (!MomentTable<C>::fits_memory(widest, highest)) {
        result.status = {Errc::image_too_large, "the image or its tiles need more memory than can be addressed, for rows of",
                         widest, 0};
        return result;
    }
    const ImageSource<C> source(view, options.weights, unit);
    ProgressReporter monitor(options.progress, samples, Traits::peak);
    TiledMesh<C> work(source, options.limits, monitor, parallel_for);
    result.status = run(work, view, n, options, unit);
    monitor.begin("colors", work.vertex_count(), work.energy());
    const double grid = Traits::is_integer && options.round_colors ? 1 : 0;
    const Tiling tiling = in_tiles ? Tiling(source.width(), source.height(), tile) : one_tile(source);
    if (final_colors(options) == Colors::sampled) sample_colors(work, tiling, grid);
    else bounded_colors(work, tiling, Traits::lowest, Traits::highest, grid);
    const IndexedMesh<C>& whole = work.indexed();
    result.mesh = extract(whole, Traits::peak);
    double energy = std::max(0.0, whole.energy);  // rounding may leave less than nothing
    if constexpr (!Traits::is_integer) energy = rendered_error(result.mesh, view, options.weights, unit, parallel_for);
    monitor.end(whole.vertex_count(), energy);
    if (result.status && monitor.stopped()) result.status = cancelled_by_callback();
    if (options.fit_space == FitSpace::linear_light) {
        energy = light_colors(result.mesh, view, options.weights, options.limits.ridge, grid, energy, monitor, parallel_for);
        if (result.status && monitor.stopped()) result.status = cancelled_by_callback();
    }
    result.report = {whole.vertex_count(), whole.triangles.size(), energy, psnr_of_energy(energy, samples, Traits::peak),
                     monitor.stages()};
    return result;
}

}  // namespace detail

// Meshes the image. Tiles run through `parallel_for` (core/parallel.hpp); same image, options and seed give the same bytes,
// whatever it does. Memory: about 0.7 KB a vertex, and for each tile at work its moment table (32 bytes a pixel for 8-bit
// RGB, 92 with weights) and 0.6 KB for each vertex placed there; a small image is one tile, and any image is for methods
// other than annealed. A fit for linear light takes 0.5 KB a vertex, premultiplying a copy of the image. Stack, on each thread
// that works: up to 4 channels 0.2 MB, for 16 channels 0.5 MB.
//
// Status: invalid_argument, image_too_large or not_finite where the image or an option is refused (the mesh is empty);
// target_out_of_range for a number of vertices that the image cannot hold (empty) or a PSNR that no mesh reached (the
// nearest one is returned); cancelled by options.progress (the mesh reached so far is returned).
//
// Never inlined: all calls run the same instructions, so that they round alike.
template <class T, int C>
[[nodiscard]] HMESH_NEVER_INLINE Result<C> mesh_image(const ImageView<T, C>& view, const Options& options = {},
                                                      const ParallelFor& parallel_for = {}) {
    Result<C> result;
    result.status = check(view);
    if (result.status) result.status = detail::check_options(options, std::int64_t{view.width} * view.height);
    if (result.status) result.status = detail::check_color_options(options, C);
    if (result.status) result.status = check_finite(view, parallel_for);
    if (result.status) result.status = check_weights(options.weights, view.width, view.height, parallel_for);
    if (!result.status) return result;
    if constexpr (has_alpha(C)) {
        if (options.premultiplied) {
            const Image<T, C> image = premultiply(view, parallel_for);
            Options rest = options;
            rest.premultiplied = false;
            result = mesh_image(image.view(), rest, parallel_for);
            result.mesh.premultiplied = true;
            return result;
        }
    }

    const double unit = weight_unit(options.weights, parallel_for);
    const double samples = C * weight_sum(options.weights, unit, view.width, view.height, parallel_for);
    const auto pixels = static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
    const std::size_t most = std::max<std::size_t>(4, pixels);
    const auto mesh_of = [&](std::size_t n) { return detail::mesh_with(view, unit, samples, n, options, parallel_for); };
    const auto share = [&](double percent) {
        return std::min(
            most, std::max<std::size_t>(4, static_cast<std::size_t>(std::llround(static_cast<double>(pixels) * percent / 100))));
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
