// hmesh - Options of mesh_image(): how many vertices, by which method, with what colours; and which of them make sense.
#ifndef HMESH_OPTIONS_HPP
#define HMESH_OPTIONS_HPP

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "hmesh/core/finite.hpp"
#include "hmesh/core/progress.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/fit/ring.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/methods/baselines/adams.hpp"
#include "hmesh/methods/baselines/adaptive_thinning.hpp"
#include "hmesh/methods/annealed/options.hpp"
#include "hmesh/methods/hierarchical/hierarchical.hpp"
#include "hmesh/methods/baselines/xie.hpp"

namespace hmesh {

// The recipes in methods/. All but the first are there to be compared with: they know no effort, seed or tile, and mesh the
// image in one piece; of their work the executor shares out passes over all pixels or faces alone.
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

// Between which values of the vertices renderers are to interpolate.
enum class FitSpace : std::uint8_t {
    stored,        // the image's stored values: PDF, SVG, HTML, and most that show sRGB as it is
    linear_light,  // the light that sRGB-encoded values stand for: glTF (solve/linear_light.hpp)
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

// All that mesh_image() can be told. Each has a default that is good for photographs; set by name what you want otherwise.
struct Options {
    Target target;
    Method method = Method::annealed;
    Effort effort = Effort::normal;
    std::uint64_t seed = 1;  // of methods that draw random numbers
    Progress progress;
    MeshLimits limits;
    // How much each pixel counts, >= 0, of the image's size; none: all count the same. They are rounded to steps of 2^-24 to
    // 2^-8 of the largest, finer for smaller images (image/weights.hpp); less than half a step counts as 0.
    ImageView<float, 1> weights;
    // px: larger images are meshed in tiles of about this size, 64 to 65536, each of which is a piece of work for a thread.
    // 0: in one piece up to a megapixel and 16384 vertices, in tiles of 256 px beyond. Where a tile would hold less than 256
    // vertices on average, tiles are larger, up to the image, and so is the memory for each.
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
    // linear_light: when all else is done the colours are fitted again, as they are seen through interpolation in linear
    // light, and so is what is reported. They stay stored values (sRGB-encoded, for float shares of 1), in [0, peak] whatever
    // the pixel type: exporters need not know. Wants optimal colours. Costs about 0.2 us a pixel and channel more.
    FitSpace fit_space = FitSpace::stored;
    // For 2 or 4 channels: the image's colours are multiplied by alpha / peak (image/premultiply.hpp), and what is meshed and
    // reported is that. Colours under transparent pixels then do not count, and edges of sprites carry no fringes. The
    // image's are straight; the mesh says premultiplied. Not with linear_light, which renderers apply to straight colours.
    bool premultiplied = false;
};

// The colours that a mesh made with these options has.
[[nodiscard]] inline Colors final_colors(const Options& options) noexcept {
    if (options.colors) return *options.colors;
    return options.method == Method::annealed || options.method == Method::hierarchical ? Colors::optimal : Colors::sampled;
}

namespace detail {

// The integer nearest to a number that may be none, for a Status: 0 for NaN and infinities.
[[nodiscard]] inline std::int64_t nearest_integer(const double& value) noexcept {
    return is_finite(value) ? std::llround(std::max(-9e18, std::min(9e18, value))) : 0;
}

[[nodiscard]] inline Status check_color_options(const Options& options, int channels) noexcept {
    if (options.colors && *options.colors != Colors::optimal && *options.colors != Colors::sampled)
        return {Errc::invalid_argument, "the colours are none of those known", static_cast<std::int64_t>(*options.colors), 1};
    if (options.fit_space != FitSpace::stored && options.fit_space != FitSpace::linear_light)
        return {Errc::invalid_argument, "the fit space is none of those known", static_cast<std::int64_t>(options.fit_space), 0};
    if (options.fit_space == FitSpace::linear_light && final_colors(options) == Colors::sampled)
        return {Errc::invalid_argument, "colours fitted for linear light are optimal, and sampled ones are asked for", 0, 0};
    if (options.fit_space == FitSpace::linear_light && options.premultiplied)
        return {Errc::invalid_argument, "linear light is fitted to straight colours, not to premultiplied ones", 0, 0};
    if (options.premultiplied && !has_alpha(channels))
        return {Errc::invalid_argument, "an image is premultiplied by alpha, which those of 2 or 4 channels have", channels, 4};
    return {};
}

[[nodiscard]] inline Status check_options(const Options& options, std::int64_t pixels) noexcept {
    const Target& target = options.target;
    const std::int64_t most = std::max<std::int64_t>(4, pixels);
    if (target.kind == Target::Kind::vertices) {
        const bool is_too_large = is_finite(target.value) && target.value > static_cast<double>(most);
        if (is_too_large)
            return {Errc::target_out_of_range, "a mesh has at most one vertex a pixel", nearest_integer(target.value), most};
        if (!is_within(target.value, 4, static_cast<double>(most)))
            return {Errc::target_out_of_range, "a mesh has at least 4 vertices", nearest_integer(target.value), 4};
    } else if (target.kind == Target::Kind::rate) {
        if (!is_within(target.value, 0, 100) || target.value == 0)
            return {Errc::target_out_of_range, "the rate must be above 0 and at most 100 percent of the pixels", 0, 100};
    } else if (!is_finite(target.value) || target.value <= 0) {
        return {Errc::target_out_of_range, "the PSNR asked for must be positive and finite, in dB", 0, 1};
    }
    const MeshLimits& limits = options.limits;
    if (!is_within(limits.min_double_area, 1e-4, 0.25))
        return {Errc::invalid_argument, "limits.min_double_area must be in [1e-4, 0.25] px^2", 0, 0};
    if (!is_within(limits.border_gap, 1.0 / 256, 0.25))
        return {Errc::invalid_argument, "limits.border_gap must be in [1/256, 1/4] px", 0, 0};
    if (!is_within(limits.color_overshoot, 0, 100))
        return {Errc::invalid_argument, "limits.color_overshoot must be in [0, 100]", 0, 100};
    if (!is_within(limits.ridge, 1e-9, 1)) return {Errc::invalid_argument, "limits.ridge must be in [1e-9, 1] pixels", 0, 1};
    if (options.tile != 0 && (options.tile < 64 || options.tile > max_side))
        return {Errc::invalid_argument, "the tile must be 0, for the default, or 64 to 65536 px", options.tile,
                options.tile < 64 ? 64 : max_side};
    switch (options.method) {
        case Method::annealed:
            if (options.annealed) return check(*options.annealed);
            if (options.effort <= Effort::best) return {};
            return {Errc::invalid_argument, "the effort is none of those known", static_cast<std::int64_t>(options.effort), 3};
        case Method::hierarchical: return check(options.hierarchical);
        case Method::xie: return check(options.xie);
        case Method::adams: return check(options.adams);
        case Method::adaptive_thinning:
            if (pixels <= adaptive_thinning_pixels) return {};
            return {Errc::image_too_large, "the method adaptive_thinning starts from all pixels, and the image has too many",
                    pixels, adaptive_thinning_pixels};
    }
    return {Errc::invalid_argument, "the method is none of those known", static_cast<std::int64_t>(options.method), 0};
}

}  // namespace detail
}  // namespace hmesh

#endif  // HMESH_OPTIONS_HPP
