// tools - which way up a photograph is: cameras store the pixels as they come and note how to turn them.
//
// The tag Orientation of a JPEG file's Exif segment: CIPA DC-008 (Exif 2.32), 4.5, 4.6.4 and 4.7.
#ifndef HMESH_TOOLS_EXIF_HPP
#define HMESH_TOOLS_EXIF_HPP

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <utility>
#include <vector>

namespace tool {

[[nodiscard]] inline bool is_jpeg(const std::vector<unsigned char>& bytes) noexcept {
    return bytes.size() > 3 && std::memcmp(bytes.data(), "\xff\xd8\xff", 3) == 0;
}

// The orientation of a JPEG file's picture, 1 to 8; 1, which is upright, where the file says none.
[[nodiscard]] inline unsigned orientation(const std::vector<unsigned char>& bytes) noexcept {
    const auto number = [&](std::size_t at, std::size_t size, bool little) {
        unsigned value = 0;
        for (std::size_t k = 0; k < size && at + size <= bytes.size(); ++k)
            value = value << 8U | bytes[little ? at + size - 1 - k : at + k];
        return value;
    };
    for (std::size_t at = 2; at + 18 < bytes.size() && bytes[at] == 0xff && bytes[at + 1] != 0xda;
         at += 2 + std::max(2U, number(at + 2, 2, false))) {
        if (bytes[at + 1] != 0xe1 || std::memcmp(bytes.data() + at + 4, "Exif\0\0", 6) != 0) continue;
        const std::size_t tiff = at + 10;
        const bool little = bytes[tiff] == 'I';
        const std::size_t table = tiff + number(tiff + 4, 4, little);
        for (std::size_t entry = 0; entry < number(table, 2, little); ++entry) {
            if (number(table + 2 + 12 * entry, 2, little) != 274) continue;
            const unsigned found = number(table + 10 + 12 * entry, 2, little);
            return found >= 1 && found <= 8 ? found : 1;
        }
    }
    return 1;
}

// Turns a packed picture that is stored in this orientation upright. From 5 on, width and height change places.
template <class T>
void turn_upright(unsigned orientation, int channels, int& width, int& height, std::vector<T>& samples) {
    const bool transposed = orientation >= 5;
    const bool from_right = orientation == 2 || orientation == 3 || orientation == 7 || orientation == 8;
    const bool from_below = orientation == 3 || orientation == 4 || orientation == 6 || orientation == 7;
    if (!transposed && !from_right && !from_below) return;
    const int last_x = width - 1, last_y = height - 1, row = width;
    if (transposed) std::swap(width, height);
    std::vector<T> upright;
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

#endif  // HMESH_TOOLS_EXIF_HPP
