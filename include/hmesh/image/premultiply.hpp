/// \file
/// premultiply(): an image with its colours multiplied by alpha.
///
/// Between an opaque pixel and a transparent one, interpolated straight colours mix in whatever the transparent pixel hides:
/// fringes. Colours multiplied by alpha mix as light does: a mean of such pixels is what the mean of the pixels would look like
/// over any background (Porter and Duff, "Compositing digital images", 1984). O(pixels).
#ifndef HMESH_IMAGE_PREMULTIPLY_HPP
#define HMESH_IMAGE_PREMULTIPLY_HPP

#include <algorithm>
#include <cstddef>

#include "hmesh/core/parallel.hpp"
#include "hmesh/image/image_view.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// The image with all channels but alpha, the last one, multiplied by alpha / peak and rounded to the pixel type. Alpha is
/// clamped to [0, peak], which float images may leave. check() must accept the view.
template <class T, int C>
[[nodiscard]] Image<T, C> premultiply(const ImageView<T, C>& view, const ParallelFor& parallel_for = {}) {
    static_assert(has_alpha(C), "images of 2 or 4 channels have alpha");
    using Traits = PixelTraits<T>;
    Image<T, C> out(view.width, view.height, raw);
    for_each_chunk(parallel_for, static_cast<std::size_t>(view.height), 32, [&](std::size_t begin, std::size_t end) {
        for (std::size_t y = begin; y < end; ++y) {
            const T* from = view.row(static_cast<int>(y));
            T* to = out.pixel(0, static_cast<int>(y));
            for (int x = 0; x < view.width; ++x, from += C, to += C) {
                const double alpha = std::max(0.0, std::min(Traits::peak, Traits::to_real(from[C - 1])));
                for (int k = 0; k < C - 1; ++k) to[k] = Traits::from_real(Traits::to_real(from[k]) * alpha / Traits::peak);
                to[C - 1] = Traits::from_real(alpha);
            }
        }
    });
    return out;
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IMAGE_PREMULTIPLY_HPP
