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

/// An image whose pixels each stand for `step` x `step` px of another, the last ones of a row or column perhaps for fewer, with
/// their mean colours.
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

/// A lattice over an image: it is meshed as an image of `per_site` pixels a site, that the mesh may move by whole sites.
struct CompactLattice {
    int columns, rows;      ///< pixels of the image that is meshed
    int per_site;           ///< such pixels from one site of the lattice to the next, a power of two
    double step_x, step_y;  ///< px of the image for each of these pixels
    int shrink;             ///< the same where both are that whole number, else 0

    [[nodiscard]] friend bool operator==(const CompactLattice& a, const CompactLattice& b) noexcept {
        return a.columns == b.columns && a.rows == b.rows && a.per_site == b.per_site;
    }
};

/// The lattice of about `cell` px a site. Where it is `bare` the file's px are its sites, so that these divide the sides evenly;
/// else they are whole px of the image.
[[nodiscard]] inline CompactLattice find_lattice(int width, int height, double cell, bool bare) noexcept {
    CompactLattice out{};
    // Meshed pixels of an eighth of a site cost time and gain nothing; of a photograph some 256 x 256 tell enough.
    const double enough = std::sqrt(static_cast<double>(width) * height / 65536);
    out.per_site = 1;
    while (out.per_site < 16 && cell / out.per_site >= 2 && cell / out.per_site >= 1.5 * enough) out.per_site *= 2;
    if (bare) {
        const auto sites = [&](int side) { return std::max(1, static_cast<int>(side / std::max(cell, 1.0) + 0.5)); };
        while (out.per_site > 1 && (sites(width) * out.per_site > width || sites(height) * out.per_site > height))
            out.per_site /= 2;
        out.columns = sites(width) * out.per_site;
        out.rows = sites(height) * out.per_site;
        out.step_x = static_cast<double>(width) / out.columns;
        out.step_y = static_cast<double>(height) / out.rows;
        return out;
    }
    out.shrink = std::max(1, static_cast<int>(cell / out.per_site + 0.5));
    out.columns = (width + out.shrink - 1) / out.shrink;
    out.rows = (height + out.shrink - 1) / out.shrink;
    out.step_x = out.step_y = out.shrink;
    return out;
}

}  // namespace hmesh::detail

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_RATE_COMPACT_LATTICE_HPP
