/// \file
/// mesh_image() with the recipe Bounded: a mesh that differs from no sample by more than a bound.
///
///     hmesh::Options options;
///     options.samples = hmesh::Samples::points;                                   // heights at points, not pixels
///     const hmesh::Result result = hmesh::mesh_image(view, options, hmesh::Bounded{2.0});    // nowhere off by more than 2
///
/// Reached by hmesh/terrain.hpp. docs/terrain.md has the method and figures.
#ifndef HMESH_METHODS_BOUNDED_BOUNDED_HPP
#define HMESH_METHODS_BOUNDED_BOUNDED_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "hmesh/core/compiler.hpp"
#include "hmesh/core/finite.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/core/progress.hpp"
#include "hmesh/core/psnr.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/image/channel_weights.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/methods/bounded/height_field.hpp"
#include "hmesh/methods/bounded/options.hpp"
#include "hmesh/methods/bounded/pieces.hpp"
#include "hmesh/methods/bounded/proof.hpp"
#include "hmesh/options.hpp"
#include "hmesh/result.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {
namespace detail {

/// Refuses what a mesh within a bound cannot honour.
[[nodiscard]] HMESH_COLD inline Status check_bounded(const Options& options, int width, int height) noexcept {
    const auto refuse = [](const char* what) -> Status { return {Errc::invalid_argument, what}; };
    const Target usual;
    const Target& target = options.target;
    if (target.kind != usual.kind || target.value != usual.value || target.max_vertices || target.good_enough)
        return refuse("a mesh within a bound has as many vertices as it needs: options.target must be left as it is");
    if (options.weights.data != nullptr) return refuse("a mesh within a bound keeps to all samples alike and knows no weights");
    if (!options.channel_weights.empty())
        return refuse("a mesh within a bound keeps to all channels alike and knows no channel_weights");
    if (options.colors) return refuse("the heights of a mesh within a bound follow from it: options.colors must be left empty");
    if (options.premultiplied) return refuse("a mesh within a bound keeps to samples as they are stored, not premultiplied");
    if (options.periodic != Periodic::none) return refuse("a mesh within a bound is not periodic");
    if (options.psnr_of) return refuse("a mesh within a bound is not searched for by a PSNR: options.psnr_of must be left empty");
    const MeshLimits limits;
    if (options.limits.min_double_area != limits.min_double_area || options.limits.border_gap != limits.border_gap ||
        options.limits.color_overshoot != limits.color_overshoot || options.limits.ridge != limits.ridge ||
        options.limits.position_step != limits.position_step)
        return refuse("a mesh within a bound has limits of its own: options.limits must be left as they are");
    if (options.samples == Samples::points && (width < 2 || height < 2))
        return {Errc::invalid_argument, "an image whose samples are points must have 2 along each side at least",
                std::min(width, height), 2};
    const ImageView<std::uint8_t, 1>& mask = options.mask;
    if (mask.data == nullptr) return {};
    if (const Status status = check(mask); !status) return status;
    if (mask.width != width) return {Errc::invalid_argument, "the mask is not as wide as the image", mask.width, width};
    if (mask.height != height) return {Errc::invalid_argument, "the mask is not as high as the image", mask.height, height};
    return {};
}

/// What face_error() may be at samples of this rounding, so that others who calculate it come to max_error at most, which is not
/// below rounding.slack.
[[nodiscard]] inline double bounded_limit(const kit::Rounding& rounding, double max_error) noexcept {
    const double room = max_error - rounding.slack;
    // Others may round heights, coordinates and their sums in double otherwise: some 2^-52 of the largest height for each.
    const double margin = rounding.largest * (16.0 / 4503599627370496.0);
    return room > 2 * margin ? room - margin : 0;
}

/// The limits of a mesh of this field. Those of the sides follow from the samples along them alone.
[[nodiscard]] HMESH_COLD inline kit::BoundedLimits bounded_limits(const kit::HeightField& field, const Bounded& recipe) noexcept {
    // The margin that a border keeps to its limit leaves nothing for that of rounding where this is less.
    const auto border = [&](double limit) {
        const double error = recipe.max_error * (1 - kit::border_margin) < limit ? recipe.max_error : limit;
        return recipe.free_borders ? error : std::min(error, kit::nearest_finite(recipe.border_error));
    };
    kit::BoundedLimits limits;
    limits.inside = bounded_limit(
        field.rounding, std::max(field.rounding.slack, std::min(recipe.max_error, kit::nearest_finite(recipe.inside_error))));
    limits.seams = border(limits.inside);
    for (int k = 0; k < kit::image_sides; ++k)
        limits.sides[k] = recipe.free_borders ? limits.seams : border(bounded_limit(field.rounding_along[k], recipe.max_error));
    return limits;
}

/// Lets samples along the sides be off by what the border is, where that is more than the inside may be.
HMESH_COLD inline void give_room(kit::HeightField& field, const kit::BoundedLimits& limits) noexcept {
    if (field.samples == Samples::squares) return;  // none is on the border
    for (int k = 0; k < kit::image_sides; ++k) {
        constexpr double rounding = 1e-12;  // here and there
        const double most = limits.sides[k] * (1 - kit::border_margin) * (1 + rounding);
        field.room[k] = std::max(0.0, most - limits.inside);
    }
}

/// A sheet as a mesh with samples of this peak.
[[nodiscard]] HMESH_COLD inline Mesh bounded_mesh(const kit::Sheet& sheet, const kit::HeightField& field, double peak) {
    Mesh mesh;
    mesh.channels = field.channels;
    mesh.width = field.width;
    mesh.height = field.height;
    mesh.peak = peak;
    mesh.samples = field.samples;
    mesh.faces = sheet.faces;
    mesh.positions.reserve(2 * sheet.vertices.size());
    mesh.colors.reserve(static_cast<std::size_t>(field.channels) * sheet.vertices.size());
    for (const kit::Corner& corner : sheet.vertices) {
        mesh.positions.push_back(static_cast<float>(corner.position.x));
        mesh.positions.push_back(static_cast<float>(corner.position.y));
        mesh.colors.insert(mesh.colors.end(), corner.heights, corner.heights + field.channels);
    }
    return mesh;
}

/// mesh_image() with Bounded, for all types of samples: those that the mesh is proved against are read by `read`. Gives the field
/// its room.
[[nodiscard]] HMESH_COLD HMESH_NEVER_INLINE inline Result mesh_bounded(kit::HeightField& field, const Options& options,
                                                                       const Bounded& recipe, double peak,
                                                                       const kit::ReadSamples& read,
                                                                       const ParallelFor& parallel_for) {
    Result result;
    if (recipe.max_error < field.rounding.slack) {
        result.status = {Errc::invalid_argument, "max_error is less than what rounding the samples to floats takes",
                         recipe.max_error, field.rounding.slack};
        return result;
    }
    const kit::BoundedLimits limits = bounded_limits(field, recipe);
    give_room(field, limits);
    std::size_t samples = static_cast<std::size_t>(field.width) * static_cast<std::size_t>(field.height);
    if (!field.data.empty()) samples = static_cast<std::size_t>(std::count(field.data.begin(), field.data.end(), 1));
    const auto channels = static_cast<std::size_t>(field.channels);
    kit::ProgressReporter progress(options.progress, static_cast<double>(std::max<std::size_t>(1, samples) * channels), peak);
    switch (recipe.effort) {
        case Bounded::Effort::draft: progress.plan({9, 1}); break;
        case Bounded::Effort::fast: progress.plan({2, 6, 1}); break;
        case Bounded::Effort::normal: progress.plan({2, 50, 1}); break;
        default: progress.plan({2, 120, 1}); break;
    }
    const kit::PollingExecutor polling(progress, parallel_for);
    double reached = 0;  // the energy of the last sheet
    const auto energy = [&](const kit::Sheet& sheet) {
        return reached = prove(bounded_mesh(sheet, field, peak).view(), field, read, polling).energy;
    };
    const kit::Sheet sheet = kit::BoundedPieces(field, limits, recipe, progress, parallel_for).run(energy);
    if (sheet.faces.empty()) {
        result.status = progress.stopped()
                            ? kit::cancelled_by_callback()
                            : Status(Errc::invalid_argument, "the image has no cell of samples that all have data");
        return result;
    }
    result.mesh = bounded_mesh(sheet, field, peak);
    progress.begin_last("proof", sheet.vertices.size(), reached);
    const kit::Proof proof = prove(result.mesh.view(), field, read, polling);
    if (!proof.is_cover || proof.max_error > recipe.max_error) {
        // Not to be expected; but no mesh is returned as one that holds which does not.
        result = {};
        result.status = {Errc::target_out_of_range, "no mesh within max_error was found", proof.max_error, recipe.max_error};
        return result;
    }
    progress.end(sheet.vertices.size(), proof.energy);
    result.report = {
        sheet.vertices.size(), sheet.faces.size(),
        proof.energy,          kit::psnr_of_energy(proof.energy, static_cast<double>(proof.samples * channels), peak),
        progress.stages(),     proof.max_error};
    if (progress.stopped()) result.status = kit::cancelled_by_callback();
    return result;
}

}  // namespace detail

/// Turns an image, such as a heightmap, into a mesh that differs from no sample by more than recipe.max_error, in each channel,
/// with as few triangles as the effort finds.
///
/// \param view          the image, which check() must accept; 1 to 4 channels
/// \param options       where samples stand (samples), which have data (mask, nan_is_no_data), and progress. All others are to be
///     left as they are; round_colors counts for nothing: vertices that are no samples have heights of type float
/// \param recipe        the bound and the effort
/// \param parallel_for  executor of the tiles
/// \return              the mesh, its error, and a status:
///     - invalid_argument, image_too_large or not_finite where the image, an option or the bound is refused (no mesh);
///     - cancelled by options.progress, with the mesh reached so far, which is within the bound; with none while samples were
///       being inserted.
///
/// The bound is proved on the floats that are returned: at every sample, in double, against each face whose closed triangle holds
/// it. The mesh covers the plane's rectangle, or of images with holes every sample with data in a cell of data and none without,
/// by positively oriented faces; vertices stand on the 1/256 px grid. Same bytes for any executor.
///
/// Time: see Bounded::Effort; linear in the number of samples. Memory: 4 bytes a sample and channel, one for holes, one for the
/// proof, and 0.3 to 0.55 KB a vertex of the draft.
template <class T, int C>
[[nodiscard]] HMESH_NEVER_INLINE Result mesh_image(const ImageView<T, C>& view, const Options& options, const Bounded& recipe,
                                                   const ParallelFor& parallel_for = {}) {
    static_assert(C <= kit::max_bounded_channels, "a mesh within a bound has 1 to 4 channels");
    Result result;
    result.status = check(view);
    if (result.status) result.status = check(options, std::int64_t{view.width} * view.height, C);
    if (result.status) result.status = detail::check_bounded(options, view.width, view.height);
    if (result.status) result.status = check(recipe);
    if (!result.status) return result;
    kit::HeightField field = kit::height_field(view, options.samples, options.mask, options.nan_is_no_data, parallel_for);
    if (field.bad_row >= 0) {
        result.status = {Errc::not_finite, "the image has a sample that is NaN, infinite or beyond all floats, in row",
                         field.bad_row};
        return result;
    }
    const kit::ViewSamples<T, C> read{view};
    return detail::mesh_bounded(field, options, recipe, PixelTraits<T>::peak, read, parallel_for);
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_BOUNDED_BOUNDED_HPP
