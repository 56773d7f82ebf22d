// Python module - mesh_image() and compact_image() by sample type and number of channels, each number compiled in a file of its
// own that setup.py writes, so that compilers work side by side.
#ifndef HMESH_PYTHON_MESHING_HPP
#define HMESH_PYTHON_MESHING_HPP

#include <cstddef>
#include <cstdint>

#include "hmesh/core/parallel.hpp"
#include "hmesh/image/image_view.hpp"
#include "hmesh/methods/annealed/options.hpp"
#include "hmesh/methods/bounded/options.hpp"
#include "hmesh/options.hpp"
#include "hmesh/rate/compact_image.hpp"
#include "hmesh/render.hpp"
#include "hmesh/result.hpp"

namespace python {

// The sample types of numpy arrays that are images.
enum class Sample : std::uint8_t { uint8, uint16, float32 };

// An array of samples: those of a pixel beside each other, pixels of a row likewise.
struct Pixels {
    const void* data;
    int width, height;
    std::ptrdiff_t row_stride;  // bytes
    Sample sample;
};

// The view of an array as an image of C channels of type T.
template <class T, int C>
[[nodiscard]] hmesh::ImageView<T, C> view_of(const Pixels& pixels) noexcept {
    return {static_cast<const T*>(pixels.data), pixels.width, pixels.height, pixels.row_stride};
}

// Calls body() with the view of an array as an image of C channels.
template <int C, class Body>
[[nodiscard]] auto with_view(const Pixels& pixels, Body&& body) {
    if (pixels.sample == Sample::uint8) return body(view_of<std::uint8_t, C>(pixels));
    if (pixels.sample == Sample::uint16) return body(view_of<std::uint16_t, C>(pixels));
    return body(view_of<float, C>(pixels));
}

// mesh_image() by Annealed.
template <int C>
[[nodiscard]] hmesh::Result mesh_channels(const Pixels& pixels, const hmesh::Options& options, const hmesh::Annealed& recipe,
                                          const hmesh::ParallelFor& parallel_for);

// compact_image(), of up to 4 channels.
template <int C>
[[nodiscard]] hmesh::CompactImage compact_channels(const Pixels& pixels, const hmesh::CompactImageOptions& options,
                                                   const hmesh::Annealed& recipe, const hmesh::ParallelFor& parallel_for);

// mesh_image() by Bounded, of one channel.
[[nodiscard]] hmesh::Result mesh_heights(const Pixels& pixels, const hmesh::Options& options, const hmesh::Bounded& recipe,
                                         const hmesh::ParallelFor& parallel_for);

}  // namespace python

#endif  // HMESH_PYTHON_MESHING_HPP
