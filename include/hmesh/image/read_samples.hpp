/// \file
/// Samples of one channel as real numbers: what code needs that looks at images of all types, compiled once.
#ifndef HMESH_IMAGE_READ_SAMPLES_HPP
#define HMESH_IMAGE_READ_SAMPLES_HPP

#include "hmesh/core/function_ref.hpp"
#include "hmesh/image/image_view.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// Writes the stored values of one channel at the pixels [begin, end) of a row to values[0], values[1] ...
using ReadSamples = FunctionRef<void(int channel, int row, int begin, int end, double* values)>;

/// The samples of a view, for a ReadSamples: any thread may call it. Some 1 ns a sample.
template <class T, int C>
struct ViewSamples {
    ImageView<T, C> view;  ///< its pixels must outlive this

    /// Writes them.
    void operator()(int channel, int row, int begin, int end, double* values) const {
        const T* sample = view.pixel(begin, row) + channel;
        for (int i = begin; i < end; ++i, sample += C) *values++ = PixelTraits<T>::to_real(*sample);
    }
};

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_IMAGE_READ_SAMPLES_HPP
