// tools - the PSNR between two sets of samples of one image.
#ifndef HMESH_TOOLS_RESULTS_PSNR_BETWEEN_HPP
#define HMESH_TOOLS_RESULTS_PSNR_BETWEEN_HPP

#include <cstddef>
#include <vector>

#include "hmesh/core/psnr.hpp"
#include "hmesh/image/image_view.hpp"

namespace tool {

// How much samples count: empty views and vectors say all alike.
struct SampleWeights {
    hmesh::ImageView<float, 1> of_pixels;  // of the image's size
    std::vector<double> of_channels;       // one for each channel
};

// In dB, of `drawn` against `wanted`: stored values, as many, of pixels of so many channels. `multiplies`: the colours of `drawn`
// are still to be multiplied by alpha, its last channel.
[[nodiscard]] inline double psnr_between(const std::vector<float>& wanted, const std::vector<float>& drawn, std::size_t channels,
                                         double peak, const SampleWeights& weights, bool multiplies = false) {
    double energy = 0, samples = 0;
    const auto width = static_cast<std::size_t>(weights.of_pixels.width);
    for (std::size_t i = 0, pixel = 0; i < wanted.size(); i += channels, ++pixel) {
        const double alpha = multiplies ? static_cast<double>(drawn[i + channels - 1]) / peak : 1;
        double of_pixel = 1;
        if (weights.of_pixels.data != nullptr)
            of_pixel =
                static_cast<double>(*weights.of_pixels.pixel(static_cast<int>(pixel % width), static_cast<int>(pixel / width)));
        for (std::size_t c = 0; c < channels; ++c) {
            const double factor = c + 1 < channels ? alpha : 1;
            const double difference = factor * static_cast<double>(drawn[i + c]) - static_cast<double>(wanted[i + c]);
            const double weight = weights.of_channels.empty() ? of_pixel : of_pixel * weights.of_channels[c];
            energy += weight * difference * difference;
            samples += weight;
        }
    }
    return hmesh::kit::psnr_of_energy(energy, samples, peak);
}

}  // namespace tool

#endif  // HMESH_TOOLS_RESULTS_PSNR_BETWEEN_HPP
