#include "writers/pictures.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace tool {

Picture to_picture(const ImageFile& image) {
    Picture picture{image.width, image.height, image.channels, image.samples8};
    for (const std::uint16_t sample : image.samples16) picture.samples.push_back(static_cast<std::uint8_t>((sample + 128) / 257));
    for (const float sample : image.samples32)
        picture.samples.push_back(hmesh::PixelTraits<std::uint8_t>::from_real(255 * static_cast<double>(sample)));
    return picture;
}

Picture to_picture(const Rgb& rgb) { return {rgb.width(), rgb.height(), 3, {rgb.data(), rgb.data() + rgb.size()}}; }

Rgb to_rgb(const Picture& picture) {
    Rgb rgb(picture.width, picture.height);
    const int channels = picture.channels;
    const bool is_translucent = hmesh::kit::has_alpha(channels);
    const std::uint8_t* from = picture.samples.data();
    std::uint8_t* to = rgb.data();
    for (std::size_t i = 0; i < rgb.size() / 3; ++i, from += channels, to += 3)
        for (int c = 0; c < 3; ++c) {
            const int alpha = is_translucent ? from[channels - 1] : 255;
            const int value = from[channels < 3 ? 0 : c];
            to[c] = static_cast<std::uint8_t>((value * alpha + 255 * (255 - alpha) + 127) / 255);
        }
    return rgb;
}

Rgb residual(const Rgb& original, const Rgb& drawn, double gain) {
    Rgb out(original.width(), original.height());
    for (std::size_t k = 0; k < out.size(); ++k) {
        const int difference = int{drawn.data()[k]} - int{original.data()[k]};
        out.data()[k] = hmesh::PixelTraits<std::uint8_t>::from_real(128 + gain * difference);
    }
    return out;
}

Rgb side_by_side(const std::vector<Rgb>& pictures, int gap) {
    int width = -gap, height = 0;
    for (const Rgb& picture : pictures) {
        width += gap + picture.width();
        height = std::max(height, picture.height());
    }
    Rgb out(std::max(0, width), height);
    std::fill(out.data(), out.data() + out.size(), std::uint8_t{255});
    int x = 0;
    for (const Rgb& picture : pictures) {
        for (int y = 0; y < picture.height(); ++y) std::copy_n(picture.view().row(y), 3 * picture.width(), out.pixel(x, y));
        x += picture.width() + gap;
    }
    return out;
}

}  // namespace tool
