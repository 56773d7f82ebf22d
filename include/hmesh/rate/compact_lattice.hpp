/// \file
/// CompactLattice: what an image is meshed as whose mesh is to stand on the lattice of a compact file.
#ifndef HMESH_RATE_COMPACT_LATTICE_HPP
#define HMESH_RATE_COMPACT_LATTICE_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "hmesh/core/compiler.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/image/image_view.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::detail {

/// An image whose pixels each stand for `step_x` x `step_y` px of another, the last ones of a row or column perhaps for fewer,
/// with their mean colours.
template <class T, int C>
[[nodiscard]] HMESH_COLD Image<std::uint8_t, C> shrunk(const ImageView<T, C>& view, int columns, int rows, double step_x,
                                                       double step_y, const ParallelFor& parallel_for) {
    Image<std::uint8_t, C> out(columns, rows);
    const auto part = [](int of, double begin, double end) {  // of a pixel, between two places
        return std::min(of + 1.0, end) - std::max<double>(of, begin);
    };
    parallel_for(static_cast<std::size_t>(rows), [&](std::size_t row) {
        const int y = static_cast<int>(row);
        const double top = y * step_y, bottom = std::min<double>(top + step_y, view.height);
        for (int x = 0; x < columns; ++x) {
            const double left = x * step_x, right = std::min<double>(left + step_x, view.width);
            std::array<double, std::size_t{C}> sums{};
            for (int j = static_cast<int>(top); j < view.height && j < bottom; ++j)
                for (int i = static_cast<int>(left); i < view.width && i < right; ++i) {
                    const double weight = part(i, left, right) * part(j, top, bottom);
                    for (std::size_t k = 0; k < C; ++k) sums[k] += weight * PixelTraits<T>::to_real(view.pixel(i, j)[k]);
                }
            const double area = (right - left) * (bottom - top) * PixelTraits<T>::peak;
            for (std::size_t k = 0; k < C; ++k) out.pixel(x, y)[k] = PixelTraits<std::uint8_t>::from_real(sums[k] / area * 255);
        }
    });
    return out;
}

/// The sites of a lattice along an axis of the image, and the pixels of the two images that are meshed for it: first one of a
/// few pixels a site, where sites are far apart, then the image itself, shrunk or not.
struct LatticeAxis {
    int sites;          ///< the last site, on the image's far side; the first is 0
    int pixels;         ///< of the first image
    int size;           ///< px of the second one
    std::int64_t step;  ///< units of the file from one site to the next, but for the last, which may be nearer
    std::int64_t end;   ///< units of the last site

    /// Where site k is, in units of the file.
    [[nodiscard]] std::int64_t at(int k) const noexcept { return std::min(k * step, end); }
    /// Where site k is in the second image, px, on its grid of 1/256 px.
    [[nodiscard]] double place(int k) const noexcept {
        return std::floor(256 * size * static_cast<double>(at(k)) / static_cast<double>(end) + 0.5) / 256;
    }
    /// The site nearest to a place there.
    [[nodiscard]] int nearest(double place) const noexcept {
        const double units = place / size * static_cast<double>(end);
        const int k = std::min(sites - 1, static_cast<int>(units / static_cast<double>(step)));
        return static_cast<double>(at(k + 1)) - units < units - static_cast<double>(at(k)) ? k + 1 : k;
    }
};

/// A lattice over an image.
struct CompactLattice {
    LatticeAxis x, y;
    int per_site;  ///< pixels of the first image from one site to the next, a power of two
    double units;  ///< of the file's px
    /// Whether the second image is the first one too, as where sites are many and nearer than pixels: at other pixels it would
    /// be blurred. Vertices come to sites from a quarter of a pixel then. Worth 0.03 dB.
    bool has_one_image;

    [[nodiscard]] friend bool operator==(const CompactLattice& a, const CompactLattice& b) noexcept {
        return a.x.sites == b.x.sites && a.y.sites == b.y.sites && a.x.step == b.x.step;
    }
};

/// The lattice of about `cell` px a site for an image of width x height px, of which the second image has columns x rows. Where
/// it is `bare` the file's px are its sites, so that these divide the sides evenly; else a site is whole 1/256 px of the image.
[[nodiscard]] inline CompactLattice find_lattice(int width, int height, int columns, int rows, double cell, bool bare) noexcept {
    // Finer ones gain nothing, or are no images.
    const double area = static_cast<double>(width) * height, longer = std::max(width, height);
    const double least = std::max(longer / kit::max_side, std::sqrt(area / static_cast<double>(kit::max_pixels)));
    cell = std::max({cell, 0.6, least});
    CompactLattice out{};
    // Two pixels a site and 65,536 in all are enough, and more than twice those of the second image too many.
    const double sites = area / (cell * cell);
    const double most = std::min(2.05 * static_cast<double>(columns) * rows, static_cast<double>(kit::max_pixels));
    out.per_site = 1;
    while (out.per_site < 16 && (out.per_site < 2 || sites * out.per_site * out.per_site < 65536) &&
           4 * sites * out.per_site * out.per_site <= most && 2 * out.per_site * longer / cell <= kit::max_side)
        out.per_site *= 2;
    out.has_one_image = sites >= 65536 && sites >= static_cast<double>(columns) * rows;
    out.units = bare ? 1 : 256;
    const double narrowest = 256 * out.per_site * least;  // as steps are whole 1/256 px
    const auto step = static_cast<std::int64_t>(std::min(std::max(256 * cell + 0.5, std::ceil(narrowest)), 33554432.0));
    const auto axis = [&](int side, int size) {
        if (bare) {
            const int all = std::max(1, std::min(kit::max_side / out.per_site, static_cast<int>(side / cell + 0.5)));
            return LatticeAxis{all, all * out.per_site, size, 1, all};
        }
        const std::int64_t end = std::int64_t{256} * side;
        return LatticeAxis{static_cast<int>((end + step - 1) / step), static_cast<int>((end * out.per_site + step - 1) / step),
                           size, step, end};
    };
    out.x = axis(width, columns);
    out.y = axis(height, rows);
    return out;
}

}  // namespace hmesh::detail

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_RATE_COMPACT_LATTICE_HPP
