// tools - which way up a photograph is: cameras store the pixels as they come and note how to turn them.
//
// The tag Orientation of Exif data, which JPEG, PNG and WebP files hold: CIPA DC-008 (Exif 2.32), 4.5, 4.6.4 and 4.7.
#ifndef HMESH_TOOLS_READERS_EXIF_HPP
#define HMESH_TOOLS_READERS_EXIF_HPP

#include <algorithm>
#include <cstddef>
#include <utility>

#include "readers/bytes.hpp"

namespace tool {

// The orientation that Exif data say, which begin as a TIFF file does: 1 to 8, and 1, which is upright, where they say none.
[[nodiscard]] inline unsigned tiff_orientation(Bytes exif) noexcept {
    const bool little = exif.u8(0) == 'I';
    const auto u16 = [&](std::size_t at) { return little ? exif.le16(at) : exif.be16(at); };
    const std::size_t table = little ? exif.le32(4) : exif.be32(4);
    for (std::size_t k = 0; k < u16(table) && exif.has(table + 2 + 12 * k, 12); ++k) {
        if (u16(table + 2 + 12 * k) != 274) continue;
        const bool is_long = u16(table + 4 + 12 * k) == 4;
        const unsigned found = u16(table + 10 + 12 * k + (is_long && !little ? 2 : 0));
        return found >= 1 && found <= 8 ? found : 1;
    }
    return 1;
}

// That of a JPEG file's picture.
[[nodiscard]] inline unsigned jpeg_orientation(Bytes file) noexcept {
    for (std::size_t at = 2; file.has(at, 18) && file.u8(at) == 0xff && file.u8(at + 1) != 0xda;
         at += file.u8(at + 1) == 0xff ? 1 : 2 + std::max(2U, file.be16(at + 2)))  // 255s may fill
        if (file.u8(at + 1) == 0xe1 && file.says(at + 4, "Exif\0\0"))
            return tiff_orientation(file.part(at + 10, std::max(8U, file.be16(at + 2)) - 8));
    return 1;
}

// Turns a packed picture that is stored in this orientation upright. From 5 on, width and height change places. `samples`: a
// std::vector or kit::Array.
template <class Samples>
void turn_upright(unsigned orientation, int channels, int& width, int& height, Samples& samples) {
    const bool transposed = orientation >= 5;
    const bool from_right = orientation == 2 || orientation == 3 || orientation == 7 || orientation == 8;
    const bool from_below = orientation == 3 || orientation == 4 || orientation == 6 || orientation == 7;
    if (!transposed && !from_right && !from_below) return;
    const int last_x = width - 1, last_y = height - 1, row = width;
    if (transposed) std::swap(width, height);
    Samples upright;
    upright.reserve(samples.size());
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const int along = transposed ? y : x, across = transposed ? x : y;  // of the rows as they are stored
            const auto column = static_cast<std::ptrdiff_t>(from_right ? last_x - along : along);
            const auto line = static_cast<std::ptrdiff_t>(from_below ? last_y - across : across);
            const auto pixel = samples.begin() + (line * row + column) * channels;
            upright.insert(upright.end(), pixel, pixel + channels);
        }
    samples.swap(upright);
}

}  // namespace tool

#endif  // HMESH_TOOLS_READERS_EXIF_HPP
