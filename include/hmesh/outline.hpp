/// \file
/// outline(): a mesh of few vertices around the pixels of an image that are not transparent, to draw its texture on.
///
/// Drawn as a rectangle, a texture is blended where it is air, too. An outline leaves most of the air out: every pixel whose
/// alpha is above a threshold is inside of it, its whole unit square and a margin around it. The margin of 0.5 px is what a
/// bilinear filter shows of a pixel beyond its square, at any size; with none, a picture at its own size or of nearest neighbours
/// is whole; 0.5 * 2^k keeps the k-th level of a chain of mipmaps. The outline stays within the image, and no two of its faces
/// overlap, so that what is half transparent is blended once.
///
///     const hmesh::Outline outline = hmesh::outline(view);
///     write_textured_glb(outline.mesh.view(), "icon.png", sink);  // of hmesh/io/textured.hpp
///
/// The texture coordinates of a vertex are its position over the image's size. Islands have outlines of their own, and holes
/// stay where their corners are worth their area. How it is done: outline/contour.hpp, covering.hpp and triangulate.hpp, in this
/// order. Cost: some 5 ns and 5 bytes a pixel, and 10 to 20 us for each corner of the pixels' border: 10 to 20 ms for an icon of
/// 256 px.
#ifndef HMESH_OUTLINE_HPP
#define HMESH_OUTLINE_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "hmesh/core/parallel.hpp"
#include "hmesh/core/status.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/mesh/mesh.hpp"
#include "hmesh/outline/contour.hpp"
#include "hmesh/outline/covering.hpp"
#include "hmesh/outline/grid_geometry.hpp"
#include "hmesh/outline/triangulate.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

/// Options of outline().
struct OutlineOptions {
    double threshold = 0;  ///< alpha in 255ths of the peak, 0 to 254: pixels above it are inside
    double margin = 0.5;   ///< px around each of these pixels, 0 to 64, rounded to 1/256
    /// For fewer vertices: how far the outline may stand out from what has to be inside, px on average along its border, 0 to
    /// 1000. Steps of pixels are some 0.3 px of that.
    double tolerance = 1;
    /// The most vertices, at least 4: kept whatever area that takes. 0: any number.
    int max_vertices = 0;
    bool holes = true;  ///< whether there may be holes; else they are filled
};

/// What outline() returns, or why there is none. Where no pixel is above the threshold, the mesh is empty and the status ok.
struct [[nodiscard]] Outline {
    /// The faces, in the image's plane; one channel, with all colours the peak 1: what a texture is multiplied by.
    Mesh mesh;
    /// The borders: corners of loops[i] are vertices of the mesh, in order, what is inside to their right: outer borders run
    /// clockwise on the screen, holes the other way.
    std::vector<std::vector<std::uint32_t>> loops;
    double covered = 0;  ///< px^2 that have to be inside: pixels above the threshold with their margins
    double length = 0;   ///< px along the border of these, steps of pixels taken as slopes
    double area = 0;     ///< px^2 of the faces
    Status status;       ///< ok, or why there is nothing
};

namespace detail {

/// Whether the options are in range: invalid_argument with value and bound.
[[nodiscard]] inline Status check(const OutlineOptions& options) noexcept {
    if (options.max_vertices != 0 && options.max_vertices < 4)
        return {Errc::invalid_argument, "an outline has at least 4 vertices, or 0 for any number", options.max_vertices, 4};
    return kit::check_ranges(
        {{"the outline's threshold must be from 0 to 254, in 255ths of full alpha", options.threshold, 0, 254},
         {"the outline's margin must be from 0 to 64 px", options.margin, 0, 64},
         {"the outline's tolerance must be from 0 to 1000 px", options.tolerance, 0, 1000}});
}

/// The pixels above the threshold; all of an image without alpha.
template <class T, int C>
[[nodiscard]] kit::Mask mask_above(const ImageView<T, C>& view, double threshold) {
    using Traits = PixelTraits<T>;
    kit::Mask mask{view.width, view.height, {}};
    mask.pixels.assign(static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height), 1);
    if constexpr (kit::has_alpha(C)) {
        std::uint8_t* to = mask.pixels.data();
        for (int y = 0; y < view.height; ++y) {
            const T* pixel = view.row(y);
            for (int x = 0; x < view.width; ++x, pixel += C)
                *to++ = kit::is_alpha_above(Traits::to_real(pixel[C - 1]), threshold, Traits::peak) ? 1 : 0;
        }
    }
    return mask;
}

/// The convex hull of polygons as one of them.
[[nodiscard]] inline kit::Loop hull_of(const std::vector<kit::Loop>& loops) {
    kit::Loop points;
    for (const kit::Loop& loop : loops) points.insert(points.end(), loop.begin(), loop.end());
    return kit::convex_hull(std::move(points));
}

/// The fewest corners found around contours whose area is at most `largest`, px^2, and that are at most `most`, whatever their
/// area is: there may be more where no more can go.
[[nodiscard]] inline kit::Covering simplified(kit::Covering covering, std::size_t most, double largest) {
    // Sides that are turned between removals win back area: so some steps may pass the bound, if not by far, and further ones
    // come back. Large steps come first, as if there were no others.
    const double too_large = largest + 3 * (largest - covering.area());
    kit::Covering best = covering;
    for (const double share : {0.8, 0.93, 1.0}) {
        covering = best;
        for (int misses = 0; misses < 8;) {
            const auto next =
                std::min(covering.corners() - 1, static_cast<std::size_t>(share * static_cast<double>(covering.corners())));
            const bool is_over = covering.corners() > most;
            if (!covering.remove_to(is_over ? std::max(most, next) : next)) break;
            if (is_over || covering.area() <= largest) best = covering, misses = 0;
            else if (covering.area() > too_large || share == 1) break;
            else ++misses;
        }
    }
    return best;
}

/// Few corners around contours, of which there is at least one.
[[nodiscard]] inline std::vector<kit::Loop> cover(const kit::Contours& contours, int width, int height,
                                                  const OutlineOptions& options) {
    // So many islands and holes are noise: one polygon around them is drawn sooner than all of theirs.
    constexpr std::size_t most_loops = 4096;
    const std::size_t most =
        options.max_vertices != 0 ? static_cast<std::size_t>(options.max_vertices) : std::numeric_limits<std::size_t>::max();
    const double largest = contours.area + options.tolerance * contours.length;
    if (contours.loops.size() <= most_loops) {
        const kit::Covering covering = simplified({contours.loops, width, height}, most, largest);
        if (covering.corners() <= most) return covering.loops();
    }
    const kit::Covering hull = simplified({{hull_of(contours.loops)}, width, height}, most, largest);
    if (hull.corners() <= most) return hull.loops();
    return {kit::box_of(contours.loops).corners()};
}

/// outline() of a mask, with options in range.
[[nodiscard]] inline Outline outline_of(const kit::Mask& mask, const OutlineOptions& options) {
    Outline out;
    out.mesh.channels = 1;
    out.mesh.width = mask.width, out.mesh.height = mask.height;
    out.mesh.peak = 1;
    const int margin = static_cast<int>(std::lround(options.margin * kit::units_per_px));
    const kit::Contours contours = kit::contours_of(mask, margin, options.holes);
    out.covered = contours.area;
    out.length = contours.length;
    if (contours.loops.empty()) return out;
    const std::vector<kit::Loop> loops = cover(contours, mask.width, mask.height, options);
    for (const kit::Loop& loop : loops) {
        out.loops.emplace_back();
        out.area += static_cast<double>(kit::double_area(loop)) / (2.0 * kit::units_per_px * kit::units_per_px);
        for (const kit::GridPoint p : loop) {
            out.loops.back().push_back(static_cast<std::uint32_t>(out.mesh.vertex_count()));
            out.mesh.positions.push_back(static_cast<float>(p.x) / kit::units_per_px);
            out.mesh.positions.push_back(static_cast<float>(p.y) / kit::units_per_px);
        }
    }
    out.mesh.colors.assign(out.mesh.vertex_count(), 1.0F);
    out.mesh.faces = kit::triangulate(loops);
    return out;
}

}  // namespace detail

/// The outline of the pixels of an image whose alpha is above a threshold; of an image without alpha, its rectangle.
///
/// \param view     the image, which check() must accept
/// \param options  how near to the pixels and of how many vertices it is
/// \return         mesh, borders and areas; or the status invalid_argument, image_too_large or not_finite
///
/// More than 4,096 islands and holes, and more than max_vertices leaves to them, become one outline, convex or a rectangle. The
/// same image and options give the same outline.
template <class T, int C>
[[nodiscard]] Outline outline(const ImageView<T, C>& view, const OutlineOptions& options = {}) {
    Outline out;
    out.status = check(view);
    if (out.status) out.status = detail::check(options);
    if (out.status) out.status = kit::check_finite(view);
    return out.status ? detail::outline_of(detail::mask_above(view, options.threshold), options) : out;
}

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_OUTLINE_HPP
