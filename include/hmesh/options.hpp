/// \file
/// Options: what mesh_image() can be told, whatever the method. Options of one method are members of its recipe (folder
/// methods/).
#ifndef HMESH_OPTIONS_HPP
#define HMESH_OPTIONS_HPP

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "hmesh/core/compiler.hpp"
#include "hmesh/core/finite.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/progress.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/image/channel_weights.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/mesh/limits.hpp"
#include "hmesh/mesh/periodic.hpp"
#include "hmesh/mesh/samples.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

struct Mesh;

/// How the final colours of the vertices are chosen.
enum class Colors : std::uint8_t {
    optimal,  ///< least squares: the colours with the smallest error for the final geometry, as near as 20 sweeps of descent come
    sampled,  ///< the colour of the image at the position of each vertex
};

/// How many vertices the mesh gets, the four corners of the image included; of a periodic mesh each counts once, however many
/// copies it has on the border. Made by Target::vertices(), percent(), psnr() or at_most().
struct Target {
    /// What `value` counts.
    enum class Kind : std::uint8_t {
        vertices,  ///< a number of vertices
        percent,   ///< vertices in percent of the pixels
        psnr,      ///< dB
    };
    Kind kind = Kind::percent;  ///< what `value` counts
    double value = 1;           ///< number of vertices, percent of the pixels, or dB
    /// Of a PSNR alone: the most vertices that the mesh may have, >= 4. Empty (the default): as many as the image has pixels.
    std::optional<std::int64_t> max_vertices{};
    /// Of a number of vertices or a percentage alone: the PSNR, in dB, > 0, above which a mesh needs no more vertices. Where it
    /// is passed, the mesh is that of the fewest vertices found that reach it, and a number above that of the pixels is no
    /// error. Empty (the default): exactly so many vertices.
    std::optional<double> good_enough{};

    /// What `good_enough` is where no other is named: an error of 0.45 steps of 8 bits (root mean square). The rounding of a
    /// smooth gradient to 8 bits is at 58.9 dB, with that of the vertices' colours at 57.3: a higher bound would spend vertices
    /// on it.
    static constexpr double invisible = 55;

    /// Exactly n vertices, 4 <= n <= max(4, number of pixels).
    [[nodiscard]] static Target vertices(std::int64_t n) noexcept { return {Kind::vertices, static_cast<double>(n), {}, {}}; }
    /// This percentage of the number of pixels, rounded to a whole number of vertices; in (0, 100], at least 4 vertices.
    [[nodiscard]] static Target percent(double of_pixels) noexcept { return {Kind::percent, of_pixels, {}, {}}; }
    /// The fewest vertices found whose mesh reaches this PSNR, in dB, > 0. Annealed takes 1.3 to 2.7 times as long as for that
    /// number of vertices: drafts tell about how many it takes, and one whole run is refined.
    [[nodiscard]] static Target psnr(double decibel) noexcept { return {Kind::psnr, decibel, {}, {}}; }
    /// The same with at most `max_vertices`, >= 4; more than pixels bound nothing. Where these do not reach the PSNR, the mesh
    /// is the best one found of at most so many, and the status target_out_of_range. That of a search which was cancelled may
    /// have up to twice as many.
    [[nodiscard]] static Target psnr(double decibel, std::int64_t max_vertices) noexcept {
        return {Kind::psnr, decibel, max_vertices, {}};
    }
    /// At most n >= 4 vertices, and fewer where these reach a PSNR of `decibel`: 4 of an image of one colour. The status is ok in
    /// either case, if there are places for so many. The one run of vertices(n) where the image needs them; else some two more,
    /// of fewer vertices.
    [[nodiscard]] static Target at_most(std::int64_t n, double decibel = invisible) noexcept {
        return {Kind::vertices, static_cast<double>(n), {}, decibel};
    }
};

/// What mesh_image() can be told, whatever the method. The defaults are good for photographs.
struct Options {
    Target target{};      ///< number of vertices; by default 1 % of the number of pixels
    Progress progress{};  ///< is told how far the work is and may cancel it; its callable must outlive the call
    MeshLimits limits{};  ///< smallest area of a face and range of colours while fitting
    /// Per-pixel weights >= 0, of the image's size. An empty view (the default): all pixels count the same. Only ratios matter.
    /// Weights are rounded to steps of 2^-24 to 2^-8 of the largest one, finer for smaller images (kit::WeightScale); less than
    /// half a step counts as 0.
    ImageView<float, 1> weights{};
    /// How much each channel counts: one weight in [0, 1e30] for each, not all 0, as for luma against chroma or for a set of maps
    /// in one image. Empty (the default): all count the same. Only ratios matter. Where they differ, vertices are placed by a
    /// scaled copy of the image with 16 bits a sample; a channel of weight 0 has no part in that, and gets the colours that fit
    /// it best nevertheless. Hierarchical knows no such weights.
    std::vector<double> channel_weights{};
    /// How the final colours are chosen. Empty (the default): as the method defines it, `optimal` for Annealed and
    /// Hierarchical, `sampled` for the baselines.
    std::optional<Colors> colors{};
    /// Whether final colours are rounded to values of the pixel type, so that a file that stores such values holds the very
    /// mesh whose error is reported. Ignored for float images. Costs about 0.003 dB at 30 dB, 0.1 dB at 45 dB.
    bool round_colors = true;
    /// Whether the colours of an image of 2 or 4 channels are multiplied by alpha / peak before meshing. Error and PSNR are
    /// then those of the premultiplied image, and Mesh::premultiplied is set. Colours under transparent pixels do not count,
    /// and the edges of sprites carry no fringes. Takes a copy of the image.
    bool premultiplied = false;
    /// Along which axes the image repeats, as a texture that tiles does, at most 32768 px long there. The mesh is that of a
    /// torus or cylinder, cut open: copies of it shifted by the image's size join it without a gap, an overlap or a jump of
    /// colour (Mesh::periodic, mesh/torus.hpp). A vertex of the cut counts once in the target, though the mesh holds a copy of
    /// it for each side. Error and PSNR are those of the picture that copies cover. Of the recipes of the library Annealed alone
    /// can do it.
    Periodic periodic = Periodic::none;
    /// Of a periodic image: whether the cut runs along the sides of the image. Else it is jagged, as the faces are: they stand
    /// out of the image's rectangle and leave as much of it free on the other side, for a copy of them. Costs up to 0.3 dB.
    bool straight_border = false;
    /// Where the samples stand in the plane: squares, as pictures have them, or points, as heightmaps do: then the image has two
    /// at least along each axis, and does not repeat.
    Samples samples = Samples::squares;
    /// Which samples have data: a view of the image's size, 0 for those that have none, such as voids of an elevation model. The
    /// mesh leaves them out: it covers every sample with data in a cell of data, and none without data. A cell is the square of
    /// four neighbouring samples of an image of points, all with data, and the square of one sample of an image of squares. An
    /// empty view (the default): all have data. Of the recipes of the library Bounded alone can do it.
    ImageView<std::uint8_t, 1> mask{};
    /// Of a float image: whether a sample that is NaN or infinite in a channel has no data. By default such images are refused.
    /// Bounded alone, too.
    bool nan_is_no_data = false;
    /// What a search for a PSNR goes by, and Target::good_enough: psnr_of(mesh, psnr) returns the PSNR, in dB, that a mesh counts
    /// as, `psnr` being its own (Report::psnr). For meshes that are to reach the target as they are stored or drawn, with fewer
    /// bits or between other values. Empty (the default): their own. Called for each run of a search, on the thread that called
    /// mesh_image(); it must return a number and rise with the number of vertices, on the whole, and its callable must outlive
    /// the call.
    FunctionRef<double(const Mesh& mesh, double psnr)> psnr_of{};
};

/// Whether the options are valid for an image of `pixels` pixels and `channels` channels: target_out_of_range or
/// invalid_argument, with a sentence about the first option that is not. mesh_image() calls it.
[[nodiscard]] HMESH_COLD inline Status check(const Options& options, std::int64_t pixels, int channels) noexcept {
    const Target& target = options.target;
    const std::int64_t most = std::max<std::int64_t>(4, pixels);
    switch (target.kind) {
        case Target::Kind::vertices:
            if (target.value > static_cast<double>(most) && !target.good_enough)
                return {Errc::target_out_of_range, "a mesh has at most one vertex a pixel", target.value, most};
            if (!kit::is_within(target.value, 4, std::max(target.value, 4.0)))
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
    if (target.good_enough && target.kind == Target::Kind::psnr)
        return {Errc::invalid_argument, "good_enough bounds a number of vertices, and the target is a PSNR, in dB", target.value};
    if (target.good_enough && (!kit::is_finite(*target.good_enough) || *target.good_enough <= 0))
        return {Errc::target_out_of_range, "the PSNR that is good enough must be positive and finite, in dB",
                *target.good_enough};
    if (target.max_vertices && target.kind != Target::Kind::psnr)
        return {Errc::invalid_argument, "max_vertices bounds the search for a PSNR, and the target is none",
                *target.max_vertices};
    if (target.max_vertices && *target.max_vertices < 4)
        return {Errc::target_out_of_range, "a mesh has at least 4 vertices, and so has the most that it may have",
                *target.max_vertices, 4};
    if (const Status status = kit::check_channel_weights(options.channel_weights, channels); !status) return status;
    if (const Status status = check(options.limits); !status) return status;
    if (options.colors && *options.colors != Colors::optimal && *options.colors != Colors::sampled)
        return {Errc::invalid_argument, "the colors are none of those known", static_cast<int>(*options.colors), 1};
    if (options.premultiplied)
        if (const Status status = kit::check_premultiplied(channels); !status) return status;
    if (options.periodic > Periodic::xy)
        return {Errc::invalid_argument, "the axes of periodic are none of those known", static_cast<int>(options.periodic), 3};
    if (options.straight_border && options.periodic == Periodic::none)
        return {Errc::invalid_argument, "straight_border is for periodic meshes, and periodic is none"};
    if (options.samples > Samples::points)
        return {Errc::invalid_argument, "the samples are none of those known", static_cast<int>(options.samples), 1};
    if (options.samples == Samples::points && options.periodic != Periodic::none)
        return {Errc::invalid_argument, "a periodic image is of samples that are squares, and the samples are points",
                static_cast<int>(options.periodic), 0};
    return {};
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_OPTIONS_HPP
