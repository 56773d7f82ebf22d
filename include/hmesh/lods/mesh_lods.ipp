// hmesh - the definition of mesh_lods(). Included by mesh_lods.hpp only; empty where a program compiles it in another file.
#ifndef HMESH_LODS_MESH_LODS_IPP
#define HMESH_LODS_MESH_LODS_IPP
#if !defined(HMESH_COMPILED) || defined(HMESH_IMPLEMENTATION)

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "hmesh/core/array.hpp"
#include "hmesh/core/compiler.hpp"
#include "hmesh/core/progress.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/fit/image_source.hpp"
#include "hmesh/tiles/indexed_mesh.hpp"
#include "hmesh/tiles/tiled_mesh.hpp"
#include "hmesh/tiles/tiling.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

/// The numbers of vertices of the levels after one of n vertices: `more` of them, or less where 4 vertices are no longer left.
[[nodiscard]] inline kit::Array<std::size_t> halves(std::size_t n, int more) {
    kit::Array<std::size_t> counts;
    for (n /= 2; n >= 4 && more > 0; n /= 2, --more) counts.push_back(n);
    return counts;
}

/// The work of each coarser level after one of n vertices, in the unit of kit::AnnealedWork.
[[nodiscard]] HMESH_COLD inline kit::Array<double> coarser_works(const Annealed& recipe, double pixels, std::size_t n, int more) {
    kit::Array<double> works;
    for (const std::size_t count : halves(n, more)) {
        const Annealed level = recipe.coarser(count);
        works.push_back(kit::coarser_work(*level.steps, pixels, static_cast<double>(n), static_cast<double>(count)).sum());
        n = count;
    }
    return works;
}

[[nodiscard]] inline double sum(const kit::Array<double>& values) {
    double out = 0;
    for (const double value : values) out += value;
    return out;
}

/// Adds coarser levels to lods.levels, which has the first one, from the share `from` of the whole call on. Sets lods.status where
/// they are not all made.
template <int C>
HMESH_COLD void add_coarser(const Subject<C>& subject, double from, const Options& options, int more,
                            const Annealed& recipe, const ParallelFor& parallel_for, Lods& lods) {
    const kit::ImageSource<C>& source = *subject.fitted;
    const std::size_t n = lods.levels.front().report.vertices;
    const kit::Array<std::size_t> counts = halves(n, more);
    if (counts.empty()) {
        // A search ended at less than 8 vertices, with which nobody reckoned.
        const Report& report = lods.levels.front().report;
        if (from < 1 && options.progress && !options.progress({"colors", 1, report.vertices, report.energy, 1}))
            lods.status = kit::cancelled_by_callback();
        return;
    }
    const kit::Array<double> works = coarser_works(recipe, source.pixels(), n, more);
    double left = sum(works);
    const auto tile_of = [&](std::size_t count) {
        return recipe.coarser(count).tile_size(source.width(), source.height(), count);
    };
    if (const Status status = check_tables(source, tile_of(counts.back())); !status) {
        lods.status = status;
        return;
    }
    kit::ProgressReporter none({}, subject.samples, source.peak());
    kit::TiledMesh<C> tiled(source, options.limits, none, parallel_for);
    tiled.indexed() = kit::to_indexed_mesh<C>(lods.levels.front().mesh);
    if (const kit::ChannelScale<C>* const scale = source.scale())
        for (kit::Color<C>& color : tiled.indexed().colors) scale->to_scaled(color);
    tiled.measure(kit::Tiling(source.width(), source.height(), tile_of(n)));
    for (std::size_t k = 0; k < counts.size(); ++k) {
        const double to = k + 1 < counts.size() ? from + (1 - from) * works[k] / left : 1;
        left -= works[k];
        kit::ProgressReporter progress(options.progress, subject.samples, subject.image->peak(), {from, to});
        tell_in_image_units(progress, subject);
        from = to;
        const auto so_far = [&] { return mesh_so_far(subject, tiled, options); };
        tiled.offer(so_far);
        tiled.report_to(progress);
        const Status status = recipe.coarser(counts[k]).coarsen(tiled, counts[k]);
        Result result = finish(subject, tiled, status, tile_of(counts[k]), options.colors.value_or(Annealed::colors), options);
        tiled.report_to(none);
        if (!result.status) {
            lods.status = result.status;
            return;
        }
        lods.levels.push_back(std::move(result));
    }
}

}  // namespace hmesh::detail

namespace hmesh {

template <class T, int C>
Lods mesh_lods(const ImageView<T, C>& view, const Options& options, const LodOptions& lods, const Annealed& recipe,
               const ParallelFor& parallel_for) {
    Lods out;
    out.status = check(lods);
    if (out.status) out.status = check(view);
    const double pixels = static_cast<double>(view.width) * view.height;
    if (out.status) out.status = check(options, static_cast<std::int64_t>(pixels), C);
    if (out.status) out.status = recipe.check(view.width, view.height);
    if (!out.status) return out;

    // A search is taken for two and a half runs at 2 %, as nobody knows.
    const Target& target = options.target;
    const bool is_search = target.kind == Target::Kind::psnr;
    const double count = target.kind == Target::Kind::vertices ? target.value : pixels * (is_search ? 2 : target.value) / 100;
    const auto n = static_cast<std::size_t>(std::max(4.0, std::min(count, pixels)));
    const double first = recipe.work(view.width, view.height, n) * (is_search ? 2.5 : 1);
    const double from = first / (first + detail::sum(detail::coarser_works(recipe, pixels, n, lods.levels - 1)));
    Options of_first = options;
    const auto progress = [&](ProgressInfo info) {
        info.total *= from;
        return options.progress(info);
    };
    if (options.progress) of_first.progress = progress;
    out.levels.push_back(mesh_image(view, of_first, recipe, parallel_for));
    const Result& finest = out.levels.front();
    out.status = finest.status;
    if (!finest.has_mesh()) out.levels.clear();
    if (!out.status && (out.levels.empty() || out.status.code != Errc::target_out_of_range)) return out;

    const auto body = [&](const detail::Subject<C>& subject, const ImageView<T, C>&) {
        detail::add_coarser(subject, from, options, lods.levels - 1, recipe, parallel_for, out);
    };
    const auto accept = [](int, int) { return Status(); };
    if (const Status status = detail::with_subject<T, C>(view, options, accept, parallel_for, body); !status) out.status = status;
    return out;
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_COMPILED
#endif  // HMESH_LODS_MESH_LODS_IPP
