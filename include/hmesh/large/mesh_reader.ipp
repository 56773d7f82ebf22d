// hmesh - the definition of mesh_image() of readers. Included by mesh_reader.hpp only; empty where a program compiles it in another
// file.
#ifndef HMESH_LARGE_MESH_READER_IPP
#define HMESH_LARGE_MESH_READER_IPP
#if !defined(HMESH_COMPILED) || defined(HMESH_IMPLEMENTATION)

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "hmesh/core/compiler.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/progress.hpp"
#include "hmesh/fit/image_source.hpp"
#include "hmesh/fit/read_source.hpp"
#include "hmesh/image/channel_weights.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/image/weights.hpp"
#include "hmesh/methods/annealed/points_by_rows.hpp"
#include "hmesh/methods/psnr_search_going_on.hpp"
#include "hmesh/tiles/tiled_mesh.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

/// Whether so many vertices as are asked for have handles of 32 bits, which a mesh of an image in memory always has.
[[nodiscard]] HMESH_COLD inline Status check_handles(const Target& target, double pixels) noexcept {
    const double wanted = target.kind == Target::Kind::percent    ? pixels * target.value / 100
                          : target.kind == Target::Kind::vertices ? target.value
                                                                  : 0;
    if (wanted <= static_cast<double>(kit::max_pixels) || target.good_enough) return {};
    return {Errc::target_out_of_range, "a mesh has not so many vertices", wanted, kit::max_pixels};
}

/// Looks at all samples once: whether they are finite, and between which values those of channels that count lie.
template <class T, int C>
[[nodiscard]] HMESH_COLD Status look_at_samples(const kit::ReadImage<T, C>& image, const std::vector<double>& channel_weights,
                                                const ParallelFor& parallel_for, kit::SampleRange& range) {
    constexpr std::size_t band = 32;
    const auto rows = static_cast<std::size_t>(image.height());
    std::vector<kit::SampleRange> ranges((rows + band - 1) / band);
    std::vector<Status> statuses(ranges.size());
    kit::for_each_chunk(parallel_for, rows, band, [&](std::size_t begin, std::size_t end) {
        const kit::Rect rect{0, static_cast<int>(begin), image.width(), static_cast<int>(end - begin)};
        ranges[begin / band] = kit::sample_range(image.fetch(rect, statuses[begin / band]).view(), channel_weights);
    });
    if (image.has_failed()) return image.status();
    range = ranges.front();
    for (std::size_t k = 0; k < ranges.size(); ++k) {
        if (!statuses[k]) return statuses[k];
        range = {std::min(range.low, ranges[k].low), std::max(range.high, ranges[k].high)};
    }
    return {};
}

/// mesh_image() of a reader that check() accepts, with options that passed all checks that need no pixels.
template <class T, int C>
[[nodiscard]] HMESH_COLD Result mesh_read(const kit::ReadImage<T, C>& image, const Options& options, const RecipeRef<C>& recipe,
                                          const ParallelFor& parallel_for) {
    Result result;
    const int width = image.width(), height = image.height();
    kit::SampleRange range{PixelTraits<T>::lowest, PixelTraits<T>::highest};
    result.status = kit::check_weights(options.weights, width, height, parallel_for);
    if (result.status && options.samples == Samples::points) result.status = check_points(width, height);
    if constexpr (!PixelTraits<T>::is_integer)
        if (result.status) result.status = look_at_samples(image, options.channel_weights, parallel_for, range);
    if (!result.status) return result;

    const double unit = kit::weight_unit(options.weights, parallel_for);
    const double pixels = kit::weight_sum(options.weights, unit, width, height, parallel_for);
    const auto source =
        kit::read_source(image, options.weights, unit, &kit::points_by_rows<C>)
            .with_periodic(options.periodic, options.straight_border)
            .with_samples(options.samples);
    kit::ChannelScale<C> scale;
    std::optional<kit::ImageSource<C>> fitted;
    double channels = C;
    if (kit::differ(options.channel_weights)) {
        scale = kit::channel_scale<C>(range, options.channel_weights);
        fitted.emplace(source.with_scale(scale));
        channels = scale.sum();
    }
    // A rectangle that cannot be read ends the work as a cancellation does.
    Options watched = options;
    const auto progress = [&](const ProgressInfo& info) {
        return !image.has_failed() && (!options.progress || options.progress(info));
    };
    watched.progress = progress;
    result = mesh_target<C>({&source, fitted ? &*fitted : &source, pixels * channels}, recipe, watched, parallel_for);
    if (!image.has_failed()) return result;
    result = {};
    result.status = image.status();
    return result;
}

}  // namespace hmesh::detail

namespace hmesh {

template <class T, int C>
Result mesh_image(const ImageReader<T, C>& reader, const Options& options, const Annealed& recipe,
                  const ParallelFor& parallel_for) {
    Result result;
    const auto check_recipe = [&](int width, int height) -> Status {
        const Status status = detail::check_periodic_image(options.periodic, width, height, nullptr);
        return status ? recipe.check(width, height) : status;
    };
    const double pixels = static_cast<double>(reader.width) * reader.height;
    result.status = check(reader);
    if (result.status)
        result.status =
            detail::check_call(options, reader.width, reader.height, static_cast<std::int64_t>(pixels), C, check_recipe);
    if (result.status) result.status = detail::check_handles(options.target, pixels);
    if (!result.status) return result;
    const auto tile_size = [&](std::size_t n) { return recipe.tile_size(reader.width, reader.height, n); };
    const auto run = [&](kit::TiledMesh<C>& mesh, std::size_t n, const kit::Beginning& from) {
        return recipe.from(from).run(mesh, n);
    };
    const auto work = [&](std::size_t n, const kit::Beginning& from) {
        return recipe.from(from).work(reader.width, reader.height, n);
    };
    const kit::ReadImage<T, C> image(reader, options.premultiplied);
    const detail::RecipeTraits traits{
        tile_size, work, options.colors.value_or(Annealed::colors), true, &kit::fewest_vertices_going_on, recipe.trials()};
    return detail::mesh_read<T, C>(image, options, {traits, run}, parallel_for);
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_COMPILED
#endif  // HMESH_LARGE_MESH_READER_IPP
