/// \file
/// Options of mesh_image(): what all methods share. What belongs to one method stands in its recipe (methods/).
#ifndef HMESH_OPTIONS_HPP
#define HMESH_OPTIONS_HPP

#include <algorithm>
#include <cstdint>
#include <optional>

#include "hmesh/core/compiler.hpp"
#include "hmesh/core/finite.hpp"
#include "hmesh/core/progress.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/mesh/limits.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// How vertices get their final colours.
enum class Colors : std::uint8_t {
    optimal,  ///< least squares for the final geometry
    sampled,  ///< those of the image under the vertices
};

/// How many vertices the mesh gets. Corners of the image count.
struct Target {
    /// What `value` counts.
    enum class Kind : std::uint8_t { vertices, percent, psnr };
    Kind kind = Kind::percent;  ///< set by the functions below
    double value = 1;           ///< vertices, percent of the pixels, or dB

    /// Exactly n vertices, 4 <= n <= max(4, pixels).
    [[nodiscard]] static Target vertices(std::int64_t n) noexcept { return {Kind::vertices, static_cast<double>(n)}; }
    /// This percentage of the pixels, rounded, in (0, 100]; at least 4 vertices.
    [[nodiscard]] static Target percent(double of_pixels) noexcept { return {Kind::percent, of_pixels}; }
    /// The fewest vertices found that reach this PSNR, in dB > 0: about six runs at counts that close in on it.
    [[nodiscard]] static Target psnr(double decibel) noexcept { return {Kind::psnr, decibel}; }
};

/// What mesh_image() can be told, whatever the method. Each has a default that is good for photographs.
struct Options {
    Target target{};      ///< how many vertices; by default one for 100 pixels
    Progress progress{};  ///< told of the work, and may cancel it; refers to a callable that outlives the call
    MeshLimits limits{};  ///< bounds that keep faces and colours sane
    /// Per-pixel weights >= 0, of the image's size; an empty view: all pixels count the same. Only ratios matter. Rounded to
    /// steps of 2^-24 to 2^-8 of the largest, finer for smaller images (kit::WeightScale); less than half a step counts as 0.
    ImageView<float, 1> weights{};
    /// Final colours; none: as the method is defined, optimal for Annealed and Hierarchical, sampled for the baselines.
    std::optional<Colors> colors{};
    /// Round colours to the pixel type's values, so that a file with such colours holds the very mesh that was measured.
    /// Ignored for float. Costs about 0.003 dB at 30 dB, 0.1 dB at 45 dB.
    bool round_colors = true;
    /// For 2 or 4 channels: the image's straight colours are multiplied by alpha / peak, and what is meshed and reported is that;
    /// the mesh says premultiplied. Colours under transparent pixels then do not count, and edges of sprites carry no fringes.
    /// Takes a copy of the image.
    bool premultiplied = false;
};

/// Whether the options mean something for an image of so many pixels and channels; the sentence names the first that does not.
[[nodiscard]] HMESH_COLD inline Status check(const Options& options, std::int64_t pixels, int channels) noexcept {
    const Target& target = options.target;
    const std::int64_t most = std::max<std::int64_t>(4, pixels);
    switch (target.kind) {
        case Target::Kind::vertices:
            if (kit::is_finite(target.value) && target.value > static_cast<double>(most))
                return {Errc::target_out_of_range, "a mesh has at most one vertex a pixel", target.value, most};
            if (!kit::is_within(target.value, 4, static_cast<double>(most)))
                return {Errc::target_out_of_range, "a mesh has at least 4 vertices", target.value, 4};
            break;
        case Target::Kind::percent:
            if (!kit::is_within(target.value, 0, 100) || target.value == 0)
                return {Errc::target_out_of_range, "the target must be above 0 and at most 100 percent of the pixels",
                        target.value, 100};
            break;
        case Target::Kind::psnr:
            if (!kit::is_finite(target.value) || target.value <= 0)
                return {Errc::target_out_of_range, "the PSNR asked for must be positive and finite, in dB", target.value};
            break;
        default: return {Errc::invalid_argument, "the target is of no known kind", static_cast<int>(target.kind), 2};
    }
    if (const Status status = check(options.limits); !status) return status;
    if (options.colors && *options.colors != Colors::optimal && *options.colors != Colors::sampled)
        return {Errc::invalid_argument, "the colors are none of those known", static_cast<int>(*options.colors), 1};
    if (options.premultiplied && !kit::has_alpha(channels))
        return {Errc::invalid_argument, "an image is premultiplied by alpha, which those of 2 or 4 channels have", channels, 4};
    return {};
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_OPTIONS_HPP
