#include "readers/image_set.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "terminal/standard_streams.hpp"

namespace tool {
namespace {

std::string size_words(const ImageFile& image) {
    return std::to_string(image.width) + " x " + std::to_string(image.height) + " px";
}

// The samples of one image among those of all, `stride` channels a pixel.
template <class T>
void put(const ImageFile& from, hmesh::kit::Array<T>& to, std::size_t first, std::size_t stride) {
    const auto channels = static_cast<std::size_t>(from.channels);
    const std::size_t pixels = static_cast<std::size_t>(from.width) * static_cast<std::size_t>(from.height);
    const bool is_float = sizeof(T) == sizeof(float);
    const double factor = from.bits == 32                    ? 1
                          : is_float                         ? (from.bits == 16 ? 1 / 65535.0 : 1 / 255.0)
                          : sizeof(T) == 2 && from.bits == 8 ? 257
                                                             : 1;
    for (std::size_t pixel = 0; pixel < pixels; ++pixel)
        for (std::size_t c = 0; c < channels; ++c)
            to[pixel * stride + first + c] = static_cast<T>(factor * sample_of(from, pixel * channels + c));
}

}  // namespace

double sample_of(const ImageFile& image, std::size_t index) noexcept {
    if (image.bits == 32) return static_cast<double>(image.samples32[index]);
    return image.bits == 16 ? image.samples16[index] : image.samples8[index];
}

std::string join_images(const std::vector<ImageFile>& images, const std::vector<std::string>& names, ImageFile& joined) {
    joined = {};
    for (std::size_t i = 0; i < images.size(); ++i) {
        const ImageFile &first = images[0], &image = images[i];
        if (image.width != first.width || image.height != first.height)
            return input_words(names[0]) + " has " + size_words(first) + " and " + input_words(names[i]) + " has " +
                   size_words(image) + ": images of one mesh must have one size";
        if (const std::string what = find_not_finite(image); !what.empty()) return input_words(names[i]) + " has " + what;
        joined.channels += image.channels;
        joined.bits = std::max(joined.bits, image.bits);
    }
    if (joined.channels > most_channels)
        return "the images have " + std::to_string(joined.channels) + " channels together, and a mesh has at most " +
               std::to_string(most_channels);
    joined.width = images[0].width, joined.height = images[0].height;
    if (joined.channels > 4) {
        joined.padding = (joined.channels <= 8 && joined.bits != 32 ? 8 : 16) - joined.channels;
        joined.channels += joined.padding;
        joined.bits = std::max(joined.bits, 16);
    }
    const auto stride = static_cast<std::size_t>(joined.channels);
    const std::size_t samples = static_cast<std::size_t>(joined.width) * static_cast<std::size_t>(joined.height) * stride;
    if (joined.bits == 32) joined.samples32.assign(samples, 0);
    else if (joined.bits == 16) joined.samples16.assign(samples, 0);
    else joined.samples8.assign(samples, 0);
    std::size_t first = 0;
    for (const ImageFile& image : images) {
        if (joined.bits == 32) put(image, joined.samples32, first, stride);
        else if (joined.bits == 16) put(image, joined.samples16, first, stride);
        else put(image, joined.samples8, first, stride);
        first += static_cast<std::size_t>(image.channels);
    }
    return {};
}

}  // namespace tool
