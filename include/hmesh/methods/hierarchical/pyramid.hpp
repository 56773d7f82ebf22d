/// \file
/// Pyramid: an image and ever smoother versions of it, for optimisation from coarse to fine.
///
/// "Image meshing via hierarchical optimization", section 4.2: level 0 is the input, and level i is the filter applied to level
/// i - 1. All levels have the size of the input, so that a mesh of one level is a mesh of all. The filter is the bilateral one
/// unless the user brings another, as a LevelFilter.
///
/// Cost: one call of the filter and one image for each level but 0.
#ifndef HMESH_METHODS_HIERARCHICAL_PYRAMID_HPP
#define HMESH_METHODS_HIERARCHICAL_PYRAMID_HPP

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <vector>

#include "hmesh/core/array.hpp"
#include "hmesh/core/assert.hpp"
#include "hmesh/core/finite.hpp"
#include "hmesh/core/function_ref.hpp"
#include "hmesh/core/parallel.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/methods/hierarchical/bilateral.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// A user's filter, for images of any sample type and number of channels. `from` and `to` are images of width * height pixels,
/// packed row after row, of `channels` interleaved samples in stored values (0 to 255 for 8 bits). `to` begins as a copy of
/// `from`. Called once for each level but 0, from one thread, which may start others. A reference: the callable must outlive it.
using LevelFilter = FunctionRef<void(const float* from, float* to, int width, int height, int channels)>;

/// The view filtered by a filter that is set. Samples are rounded by PixelTraits<T>::from_real(). Where the filter gives a value
/// that is not finite, the sample keeps the view's value: one NaN would spoil sums over many pixels, and where a filter has no
/// answer (a mean without weights, 0 / 0) the unfiltered sample adds no error. Memory: two floats a sample.
template <class T, int C>
[[nodiscard]] Image<T, C> apply_filter(const LevelFilter& filter, const ImageView<T, C>& view) {
    HMESH_ASSERT(check(view) && filter);
    Image<T, C> out(view.width, view.height);
    Array<float> from;
    from.reserve(out.size());
    for (int y = 0; y < view.height; ++y) {
        const T* row = view.row(y);
        std::transform(row, row + view.width * C, std::back_inserter(from),
                       [](T sample) { return PixelTraits<float>::from_real(PixelTraits<T>::to_real(sample)); });
    }
    Array<float> to = from;
    filter(from.data(), to.data(), view.width, view.height, C);
    const float* filtered = to.data();
    for (int y = 0; y < view.height; ++y) {
        const T* row = view.row(y);
        T* samples = out.pixel(0, y);
        for (int k = 0; k < view.width * C; ++k, ++filtered)
            samples[k] = is_finite(*filtered) ? PixelTraits<T>::from_real(static_cast<double>(*filtered)) : row[k];
    }
    return out;
}

/// The levels of an image. Owns those from 1 on, and refers to the image as level 0.
template <class T, int C>
class Pyramid {
  public:
    /// Makes `levels` >= 1 levels of the view, which must outlive the pyramid. filter(level) returns an image of the same size;
    /// it is called levels - 1 times, from fine to coarse.
    Pyramid(const ImageView<T, C>& view, int levels, FunctionRef<Image<T, C>(const ImageView<T, C>& level)> filter)
        : input_(view) {
        HMESH_ASSERT(levels >= 1);
        for (int i = 1; i < levels; ++i) {
            filtered_.push_back(filter(level(i - 1)));
            HMESH_ASSERT(filtered_.back().width() == view.width && filtered_.back().height() == view.height);
        }
    }

    /// The number of levels, with the image itself.
    [[nodiscard]] int size() const noexcept { return static_cast<int>(filtered_.size()) + 1; }
    /// Level i, 0 <= i < size(); level 0 is the image itself. Valid as long as the pyramid.
    [[nodiscard]] ImageView<T, C> level(int i) const noexcept {
        HMESH_ASSERT(i >= 0 && i < size());
        return i == 0 ? input_ : filtered_[static_cast<std::size_t>(i) - 1].view();
    }

  private:
    ImageView<T, C> input_;
    std::vector<Image<T, C>> filtered_;  ///< level i is filtered_[i - 1]
};

/// Makes the pyramid of `levels` >= 1 levels of a view, with `filter` if it is set, else with the bilateral filter. check() must
/// accept the view and the bilateral options, and float samples must be finite. The view must outlive the pyramid.
template <class T, int C>
[[nodiscard]] Pyramid<T, C> make_pyramid(const ImageView<T, C>& view, int levels, const BilateralOptions& bilateral = {},
                                         const LevelFilter& filter = {}, const ParallelFor& parallel_for = {}) {
    return Pyramid<T, C>(view, levels, [&](const ImageView<T, C>& level) {
        return filter ? apply_filter(filter, level) : bilateral_filter(level, bilateral, parallel_for);
    });
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_METHODS_HIERARCHICAL_PYRAMID_HPP
