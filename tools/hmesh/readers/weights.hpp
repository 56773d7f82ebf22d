// tools - weights from an image file: how much each pixel counts when an image is meshed.
#ifndef HMESH_TOOLS_READERS_WEIGHTS_HPP
#define HMESH_TOOLS_READERS_WEIGHTS_HPP

#include <algorithm>
#include <cstddef>
#include <string>

#include "hmesh/image/image_view.hpp"
#include "readers/image_file.hpp"
#include "terminal/standard_streams.hpp"

namespace tool {

namespace detail {

template <class T>
void take_weights(const hmesh::kit::Array<T>& samples, int channels, hmesh::Image<float, 1>& weights) {
    const int colors = channels < 3 ? 1 : 3;
    const T* pixel = samples.data();
    for (std::size_t i = 0; i < weights.size(); ++i) {
        double sum = 0;
        for (int c = 0; c < colors; ++c) sum += hmesh::PixelTraits<T>::to_real(pixel[c]);
        weights.data()[i] = static_cast<float>(sum / (colors * hmesh::PixelTraits<T>::peak));
        pixel += channels;
    }
}

}  // namespace detail

// The weights that an image file holds, 1 for white, and in [0, 1] unless it holds floats: its grey, or the mean of red, green
// and blue. Alpha means nothing.
[[nodiscard]] inline hmesh::Image<float, 1> to_weights(const ImageFile& file) {
    hmesh::Image<float, 1> weights(file.width, file.height);
    if (file.bits == 32) detail::take_weights(file.samples32, file.channels, weights);
    else if (file.bits == 16) detail::take_weights(file.samples16, file.channels, weights);
    else detail::take_weights(file.samples8, file.channels, weights);
    return weights;
}

// Reads the weights for an image of this size. Returns "" or what is wrong, as a sentence.
[[nodiscard]] inline std::string read_weights(const std::string& path, int width, int height, hmesh::Image<float, 1>& weights) {
    ImageFile file;
    if (const std::string why = read_image(path, file); !why.empty()) return "cannot read " + input_words(path) + ": " + why;
    if (file.width != width || file.height != height)
        return "the weights " + input_words(path) + " are " + std::to_string(file.width) + " x " + std::to_string(file.height) +
               " px, the image is " + std::to_string(width) + " x " + std::to_string(height) + " px";
    if (const std::string what = find_not_finite(file); !what.empty())
        return "the weights " + input_words(path) + " have " + what;
    weights = to_weights(file);
    const float* const first = weights.data();
    if (std::all_of(first, first + weights.size(), [](float weight) { return weight == 0; }))
        return "the weights " + input_words(path) + " are all zero: no pixel would count";
    return {};
}

}  // namespace tool

#endif  // HMESH_TOOLS_READERS_WEIGHTS_HPP
