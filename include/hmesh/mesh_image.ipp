// hmesh - the definition of mesh_image(). Included by mesh_image.hpp only; empty where a program compiles it in another file.
#ifndef HMESH_MESH_IMAGE_IPP
#define HMESH_MESH_IMAGE_IPP
#if !defined(HMESH_COMPILED) || defined(HMESH_IMPLEMENTATION)

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <type_traits>
#include <utility>

#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/progress.hpp"
#include "hmesh/core/psnr.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/fit/image_source.hpp"
#include "hmesh/fit/moment_table.hpp"
#include "hmesh/fit/rendered_error.hpp"
#include "hmesh/image/channel_weights.hpp"
#include "hmesh/image/premultiply.hpp"
#include "hmesh/image/weights.hpp"
#include "hmesh/mesh/periodic.hpp"
#include "hmesh/mesh/unrolled.hpp"
#include "hmesh/methods/annealed/annealed.hpp"
#include "hmesh/methods/final_colors.hpp"
#include "hmesh/methods/psnr_search.hpp"
#include "hmesh/methods/psnr_search_going_on.hpp"
#include "hmesh/tiles/indexed_mesh.hpp"
#include "hmesh/tiles/recut.hpp"
#include "hmesh/tiles/tiled_mesh.hpp"
#include "hmesh/tiles/tiling.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

/// What is known of a recipe, whatever the image's samples.
struct RecipeTraits {
    FunctionRef<double(std::size_t n)> tile_size;
    FunctionRef<double(std::size_t n, const kit::Beginning& from)> work;
    Colors colors;
    bool can_go_on;           // whether it knows beginnings other than the first
    kit::PsnrSearch* search;  // for a PSNR, of such recipes or of others: a pointer, so that a program has the one it needs
    kit::Trials trials;       // where it does
};

/// A recipe for images of C channels behind function references, so that what follows is compiled once for all recipes.
template <int C>
struct RecipeRef : RecipeTraits {
    FunctionRef<Status(kit::TiledMesh<C>& mesh, std::size_t n, const kit::Beginning& from)> run;
};

/// What is meshed.
template <int C>
struct Subject {
    const kit::ImageSource<C>* image;   ///< whose colours the mesh gets, and whose error is told
    const kit::ImageSource<C>* fitted;  ///< whose error the geometry is chosen by: the image, with its channels scaled or as it is
    double samples;  ///< number of pixels, or the sum of their weights, times the number of channels, or the sum of theirs
};

/// Gives the tiled mesh of the image itself the geometry of one that was fitted to scaled channels.
template <int C>
void take_geometry(kit::TiledMesh<C>& of_image, kit::TiledMesh<C>& fitted) {
    kit::IndexedMesh<C>& mesh = of_image.indexed();
    mesh = fitted.indexed();
    for (kit::Color<C>& color : mesh.colors) fitted.source().scale()->to_stored(color);
}

/// Whether the moment tables of tiles of this size, in px, fit memory.
template <int C>
[[nodiscard]] HMESH_COLD Status check_tables(const kit::ImageSource<C>& source, double tile) {
    // Patches stand out of their tiles by parts of a triangle: hence twice as large.
    const int widest = static_cast<int>(std::min<double>(source.width(), 2 * tile));
    const int highest = static_cast<int>(std::min<double>(source.height(), 2 * tile));
    if (kit::MomentTable<C>::fits_memory(widest, highest)) return {};
    return {Errc::image_too_large, "the image or its tiles need more memory than can be addressed, for rows of", widest};
}

/// The progress of one run of a method, whose energies are those of the source that it fits.
template <int C>
void tell_in_image_units(kit::ProgressReporter& progress, const Subject<C>& subject) {
    if (const kit::ChannelScale<C>* const scale = subject.fitted->scale()) progress.set_energy_unit(1 / (scale->unit * scale->unit));
}

/// The mesh that a method works on, between two phases, as ProgressInfo::mesh_so_far gives it.
template <int C>
[[nodiscard]] HMESH_COLD Mesh mesh_so_far(const Subject<C>& subject, kit::TiledMesh<C>& fitted, const Options& options) {
    const kit::ImageSource<C>& source = *subject.image;
    kit::IndexedMesh<C> mesh = fitted.copy();
    if (subject.fitted->scale() != nullptr) kit::take_sampled_colors(mesh, source);
    for (kit::Color<C>& color : mesh.colors) kit::detail::clamp_channels<C>(color, source.low(), source.high());
    kit::finish_cut(mesh, source.has_straight_seams());
    Mesh result = to_mesh(mesh, source.peak());
    result.premultiplied = options.premultiplied;
    return result;
}

/// What a method made of subject.fitted, with its status, as a result: the mesh with final colours, found in tiles of this size in
/// px, and its report. Where channels are not scaled, `fitted` has these colours then.
template <int C>
[[nodiscard]] HMESH_COLD Result finish(const Subject<C>& subject, kit::TiledMesh<C>& fitted, Status status, double tile,
                                       Colors colors, const Options& options) {
    Result result;
    result.status = status;
    const kit::ImageSource<C>& source = *subject.image;
    const kit::ChannelScale<C>* const scale = subject.fitted->scale();
    kit::ProgressReporter& progress = fitted.progress();
    const ParallelFor& parallel_for = fitted.parallel_for();
    progress.begin_colors(fitted.vertex_count(), fitted.energy());
    std::optional<kit::TiledMesh<C>> of_image;
    if (scale != nullptr) {
        progress.set_energy_unit(1);
        take_geometry(of_image.emplace(source, options.limits, progress, parallel_for), fitted);
    }
    kit::TiledMesh<C>& tiled = of_image ? *of_image : fitted;
    const double grid = source.is_integer() && options.round_colors ? 1 : 0;
    const double largest = colors == Colors::sampled ? sample_colors(tiled, tile, grid)
                                                     : bounded_colors(tiled, tile, {source.low(), source.high(), grid});
    kit::IndexedMesh<C>& mesh = tiled.indexed();
    kit::finish_cut(mesh, source.has_straight_seams(), parallel_for);
    result.mesh = to_mesh(mesh, source.peak(), parallel_for);
    result.mesh.premultiplied = options.premultiplied;
    const bool is_exact = source.has_exact_sums(tile) && scale == nullptr;
    const auto errors_of = [&](const Mesh& drawn) {
        return kit::rendered_errors(drawn, source, parallel_for, scale == nullptr ? kit::ChannelScale<C>() : *scale);
    };
    const kit::RenderedError errors =
        is_exact ? kit::RenderedError{std::max(0.0, mesh.energy), largest}  // rounding may leave less energy than nothing
        : source.periodic() == Periodic::none ? errors_of(result.mesh)
                                              : errors_of(kit::unrolled(result.mesh.view()));
    const double energy = errors.energy;
    const auto made = [&] { return result.mesh; };
    progress.end(mesh.distinct_count(), energy, made);
    if (progress.stopped()) result.status = kit::cancelled_by_callback();
    result.report = {mesh.distinct_count(), mesh.faces.size(), energy, kit::psnr_of_energy(energy, subject.samples, source.peak()),
                     progress.stages(), errors.largest};
    return result;
}

/// One finished mesh of n vertices. `notes`: what runs hand on, at first empty.
template <int C>
[[nodiscard]] HMESH_COLD Result mesh_once(const Subject<C>& subject, std::size_t n, const kit::Beginning& from,
                                          const kit::ProgressSpan& span, kit::ImageNotes<C>& notes, const RecipeRef<C>& recipe,
                                          const Options& options, const ParallelFor& parallel_for) {
    Result result;
    const double tile = recipe.tile_size(n);
    result.status = check_tables(*subject.image, tile);
    if (!result.status) return result;
    kit::ProgressReporter progress(options.progress, subject.samples, subject.image->peak(), span);
    tell_in_image_units(progress, subject);
    kit::TiledMesh<C> fitted(*subject.fitted, options.limits, progress, parallel_for);
    fitted.notes() = std::move(notes);
    fitted.indexed() = kit::tied_corner_mesh(*subject.fitted);  // what a cancellation finds
    const auto so_far = [&] { return mesh_so_far(subject, fitted, options); };
    fitted.offer(so_far);
    const Status status = recipe.run(fitted, n, from);
    if (!status && status.code != Errc::cancelled && progress.stages().empty()) {  // refused before anything was done
        result.status = status;
        return result;
    }
    result = finish(subject, fitted, status, tile, recipe.colors, options);
    notes = std::move(fitted.notes());
    return result;
}

/// After a search: the mesh's own PSNR, and the last word to the callback.
[[nodiscard]] HMESH_COLD inline Result searched(Result result, const Options& options, double samples, double peak) {
    const Report& report = result.report;
    if (!result.has_mesh()) return result;
    result.report.psnr = kit::psnr_of_energy(report.energy, samples, peak);
    if (!options.progress || !(result.status || result.status.code == Errc::target_out_of_range)) return result;
    if (!options.progress({report.stages.back().name, 1, report.vertices, report.energy, 1}))
        result.status = kit::cancelled_by_callback();
    return result;
}

/// The mesh that options.target asks for.
template <int C>
[[nodiscard]] HMESH_COLD Result mesh_target(const Subject<C>& subject, const RecipeRef<C>& recipe, const Options& options,
                                            const ParallelFor& parallel_for) {
    const double pixels = subject.image->pixels();
    const auto all = static_cast<std::int64_t>(std::max(4.0, std::min(pixels, static_cast<double>(kit::max_pixels))));
    const auto most = static_cast<std::size_t>(std::min(all, options.target.max_vertices.value_or(all)));
    const auto share = [&](double percent) {
        return std::min(most, std::max<std::size_t>(4, static_cast<std::size_t>(std::llround(pixels * percent / 100))));
    };
    const Target& target = options.target;
    const std::size_t wanted = target.kind == Target::Kind::percent
                                   ? share(target.value)
                                   : static_cast<std::size_t>(std::min(target.value, static_cast<double>(all)));
    kit::ImageNotes<C> notes;
    if (target.kind != Target::Kind::psnr && (!target.good_enough || wanted == 4))
        return mesh_once(subject, wanted, {}, {}, notes, recipe, options, parallel_for);
    kit::SearchProgress progress;
    const Mesh any;  // stands for the mesh of another run
    const auto run = [&](std::size_t n, const kit::Beginning& from, const kit::ProgressSpan& span) {
        Result result = mesh_once(subject, n, from, span, notes, recipe, options, parallel_for);
        if (options.psnr_of && result.has_mesh()) result.report.psnr = options.psnr_of(result.mesh, result.report.psnr);
        return result;
    };
    const auto mesh_from = [&](std::size_t n, const kit::Beginning& from) {
        if (!recipe.can_go_on) return run(n, {}, progress.next());
        const auto work_of = [&](kit::Work work) {
            return recipe.work(n, {kit::goes_on(work) ? &any : nullptr, work});
        };
        return run(n, from, progress.next(from.work, work_of));
    };
    const double peak = subject.image->peak();
    const auto search = [&](double psnr, double first, std::size_t limit) {
        return recipe.search(psnr, recipe.trials, std::min(limit, share(recipe.can_go_on ? first : 1)), limit,
                             static_cast<std::size_t>(all), mesh_from);
    };
    if (target.kind != Target::Kind::psnr) {
        // Most images need what they are given: their one run comes first, and is that of a target without good_enough.
        const double bound = *target.good_enough;
        Result whole = run(wanted, {}, progress.next(4, 1));
        if (!whole.status || whole.report.psnr <= bound) return searched(std::move(whole), options, subject.samples, peak);
        Result fewer = search(bound, 100.0 / 8 * static_cast<double>(wanted) / pixels, wanted - 1);
        if (!fewer.status && fewer.report.psnr < bound) {
            if (fewer.status.code != Errc::target_out_of_range) whole.status = fewer.status;
            fewer = std::move(whole);
        }
        return searched(std::move(fewer), options, subject.samples, peak);
    }
    // Half way, on a logarithmic scale, from what photographs need for 32 dB to what they need for the target.
    const double first = 0.25 * std::exp2(std::max(-2.0, std::min(2.0, (target.value - 32) / 4)));
    return searched(search(target.value, first, most), options, subject.samples, peak);
}

/// A recipe for images of one kind behind function references.
template <class T, int C>
struct ImageRecipeRef : RecipeTraits {
    FunctionRef<Status(int width, int height)> check;
    FunctionRef<Status(kit::TiledMesh<C>& mesh, const ImageView<T, C>& image, std::size_t n, const kit::Beginning& from)> run;
    bool takes_view;          // whether run() looks at the image
    const char* no_periodic;  // why the recipe refuses periodic images; null: it does not
};

/// Whether the image may be periodic, by its size and the recipe.
[[nodiscard]] HMESH_COLD inline Status check_periodic_image(Periodic periodic, int width, int height, const char* no_periodic) {
    if (periodic == Periodic::none) return {};
    if (no_periodic != nullptr) return {Errc::invalid_argument, no_periodic};
    if (kit::wraps_x(periodic) && width > kit::max_period)
        return {Errc::image_too_large, "the image is too wide to repeat from left to right", width, kit::max_period};
    if (kit::wraps_y(periodic) && height > kit::max_period)
        return {Errc::image_too_large, "the image is too high to repeat from top to bottom", height, kit::max_period};
    return {};
}

/// Whether an image of this size may be one of points.
[[nodiscard]] HMESH_COLD inline Status check_points(int width, int height) noexcept {
    if (width < 2) return {Errc::invalid_argument, "an image whose samples are points must be at least 2 samples wide", width, 2};
    if (height < 2)
        return {Errc::invalid_argument, "an image whose samples are points must be at least 2 samples high", height, 2};
    return {};
}

/// Whether options, and the recipe by `check_recipe`, can mesh an image of this size; `pixels`: how many vertices it holds.
[[nodiscard]] HMESH_COLD inline Status check_call(const Options& options, int width, int height, std::int64_t pixels, int channels,
                                                  FunctionRef<Status(int width, int height)> check_recipe) {
    if (const Status status = check(options, pixels, channels); !status) return status;
    if (options.mask.data != nullptr || options.nan_is_no_data)
        return {Errc::invalid_argument, "this method meshes all samples: of those of the library Bounded alone knows mask and "
                                        "nan_is_no_data"};
    return check_recipe(width, height);
}

/// Calls body() with what is to be meshed and the image as methods see it, once view and options have passed all checks: those of
/// the recipe are `check_recipe`.
template <class T, int C>
[[nodiscard]] HMESH_COLD Status with_subject(const ImageView<T, C>& view, const Options& options,
                                             FunctionRef<Status(int width, int height)> check_recipe,
                                             const ParallelFor& parallel_for,
                                             FunctionRef<void(const Subject<C>& subject, const ImageView<T, C>& image)> body) {
    Status status = check(view);
    if (status)
        status = check_call(options, view.width, view.height, std::int64_t{view.width} * view.height, C, check_recipe);
    if (status) status = kit::check_finite(view, parallel_for);
    if (status) status = kit::check_weights(options.weights, view.width, view.height, parallel_for);
    if (status && options.samples == Samples::points) status = check_points(view.width, view.height);
    if (!status) return status;

    ImageView<T, C> image = view;
    [[maybe_unused]] Image<T, C> premultiplied;
    if constexpr (kit::has_alpha(C)) {
        if (options.premultiplied) {
            premultiplied = kit::premultiply(view, parallel_for);
            image = premultiplied.view();
        }
    }
    const double unit = kit::weight_unit(options.weights, parallel_for);
    const double pixels = kit::weight_sum(options.weights, unit, view.width, view.height, parallel_for);
    const auto source =
        kit::ImageSource<C>(image, options.weights, unit)
            .with_periodic(options.periodic, options.straight_border)
            .with_samples(options.samples);
    kit::ChannelScale<C> scale;
    std::optional<kit::ImageSource<C>> fitted;
    double channels = C;
    if (kit::differ(options.channel_weights)) {
        scale = kit::channel_scale<C>(kit::sample_range(image, options.channel_weights), options.channel_weights);
        fitted.emplace(source.with_scale(scale));
        channels = scale.sum();
    }
    body({&source, fitted ? &*fitted : &source, pixels * channels}, image);
    return {};
}

/// mesh_image() with any recipe.
template <class T, int C>
[[nodiscard]] HMESH_NEVER_INLINE HMESH_COLD Result mesh_view(const ImageView<T, C>& view, const Options& options,
                                                             const ImageRecipeRef<T, C>& recipe,
                                                             const ParallelFor& parallel_for) {
    Result result;
    const auto check_recipe = [&](int width, int height) -> Status {
        if (const Status status = check_periodic_image(options.periodic, width, height, recipe.no_periodic); !status) return status;
        if (const Status status = recipe.check(width, height); !status) return status;
        if (!recipe.takes_view || !kit::differ(options.channel_weights)) return {};
        return {Errc::invalid_argument, "this method reads the pixels by itself and knows no channel_weights"};
    };
    const auto body = [&](const Subject<C>& subject, const ImageView<T, C>& image) {
        const auto run = [&](kit::TiledMesh<C>& mesh, std::size_t n, const kit::Beginning& from) {
            return recipe.run(mesh, image, n, from);
        };
        const RecipeTraits& traits = recipe;
        result = mesh_target(subject, RecipeRef<C>{traits, run}, options, parallel_for);
    };
    if (const Status status = with_subject<T, C>(view, options, check_recipe, parallel_for, body); !status) result.status = status;
    return result;
}

/// Whether a recipe's run() takes the image's view too: run(mesh, view, n).
template <class Recipe, class T, int C, class = void>
inline constexpr bool wants_view = false;
template <class Recipe, class T, int C>
inline constexpr bool
    wants_view<Recipe, T, C,
               std::void_t<decltype(std::declval<const Recipe&>().run(
                   std::declval<kit::TiledMesh<C>&>(), std::declval<const ImageView<T, C>&>(), std::size_t{}))>> = true;

/// Whether a recipe can go on from a mesh, by a member from(beginning).
template <class Recipe, class = void>
inline constexpr bool can_go_on = false;
template <class Recipe>
inline constexpr bool
    can_go_on<Recipe, std::void_t<decltype(std::declval<const Recipe&>().from(std::declval<const kit::Beginning&>()))>> = true;

/// Whether such a recipe knows how long a run takes, by a member work(width, height, n).
template <class Recipe, class = void>
inline constexpr bool knows_work = false;
template <class Recipe>
inline constexpr bool knows_work<
    Recipe, std::void_t<decltype(std::declval<const Recipe&>().from(std::declval<const kit::Beginning&>()).work(0, 0, 0))>> = true;

/// Whether a recipe makes periodic meshes, by a member can_be_periodic.
template <class Recipe, class = void>
inline constexpr bool can_be_periodic = false;
template <class Recipe>
inline constexpr bool can_be_periodic<Recipe, std::void_t<decltype(Recipe::can_be_periodic)>> = Recipe::can_be_periodic;

/// The number of characters before the zero.
[[nodiscard]] constexpr std::size_t length_of(const char* text) noexcept {
    std::size_t length = 0;
    while (text[length] != 0) ++length;
    return length;
}
/// The sentence of a recipe that makes no periodic meshes.
template <class Recipe>
[[nodiscard]] constexpr auto no_periodic_sentence() noexcept {
    constexpr const char* parts[] = {"the recipe ", Recipe::name, " makes no periodic meshes"};
    std::array<char, length_of(parts[0]) + length_of(parts[1]) + length_of(parts[2]) + 1> text{};
    std::size_t size = 0;
    for (const char* part : parts)
        for (; *part != 0; ++part) text[size++] = *part;
    return text;
}
template <class Recipe>
inline constexpr auto no_periodic = no_periodic_sentence<Recipe>();

}  // namespace hmesh::detail

namespace hmesh {

template <class T, int C, class Recipe, class>
Result mesh_image(const ImageView<T, C>& view, const Options& options, const Recipe& recipe, const ParallelFor& parallel_for) {
    const auto check = [&](int width, int height) -> Status { return recipe.check(width, height); };
    const auto tile_size = [&](std::size_t n) { return static_cast<double>(recipe.tile_size(view.width, view.height, n)); };
    const auto run = [&](kit::TiledMesh<C>& mesh, [[maybe_unused]] const ImageView<T, C>& image, std::size_t n,
                         [[maybe_unused]] const kit::Beginning& from) -> Status {
        if constexpr (detail::can_go_on<Recipe>) return recipe.from(from).run(mesh, n);
        else if constexpr (detail::wants_view<Recipe, T, C>) return recipe.run(mesh, image, n);
        else return recipe.run(mesh, n);
    };
    const auto work = [&](std::size_t n, [[maybe_unused]] const kit::Beginning& from) {
        if constexpr (detail::knows_work<Recipe>) return static_cast<double>(recipe.from(from).work(view.width, view.height, n));
        else return static_cast<double>(n);
    };
    kit::Trials trials;
    kit::PsnrSearch* search = nullptr;
    if constexpr (detail::can_go_on<Recipe>) {
        trials = recipe.trials();
        search = &kit::fewest_vertices_going_on;
    } else {
        search = &kit::fewest_vertices_anew;
    }
    const Colors colors = options.colors.value_or(Recipe::colors);
    const char* no_periodic = nullptr;
    if constexpr (!detail::can_be_periodic<Recipe>) no_periodic = detail::no_periodic<Recipe>.data();
    const detail::RecipeTraits traits{tile_size, work, colors, detail::can_go_on<Recipe>, search, trials};
    return detail::mesh_view(view, options,
                             detail::ImageRecipeRef<T, C>{traits, check, run, detail::wants_view<Recipe, T, C>, no_periodic},
                             parallel_for);
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_COMPILED
#endif  // HMESH_MESH_IMAGE_IPP
