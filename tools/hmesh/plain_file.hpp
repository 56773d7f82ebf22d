// tools - the input file as a page shows it: its compressed pixels as they are, without all that makes browsers show others.
//
// The reader takes samples as they are stored, of the first picture; browsers turn what Exif tags say is turned, convert what
// has a colour profile or a gamma, and play animations. So these are left out, and with them what a camera notes beside the
// picture: where it was taken, thumbnails, clips. JPEG: ITU-T T.81, annex B; PNG: W3C's third edition, 5 and 11.
#ifndef HMESH_TOOLS_PLAIN_FILE_HPP
#define HMESH_TOOLS_PLAIN_FILE_HPP

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <vector>

#include "exif.hpp"
#include "image_file.hpp"

namespace tool {

namespace detail {

using Bytes = std::vector<unsigned char>;

[[nodiscard]] inline bool begins_with(const Bytes& bytes, const char* signature) noexcept {
    const std::size_t size = std::strlen(signature);
    return bytes.size() >= size && std::memcmp(bytes.data(), signature, size) == 0;
}

// The number of `size` bytes there, the highest first; they must be there.
[[nodiscard]] inline std::uint32_t big_endian(const Bytes& bytes, std::size_t at, std::size_t size) noexcept {
    std::uint32_t value = 0;
    for (std::size_t k = 0; k < size; ++k) value = value << 8U | bytes[at + k];
    return value;
}

// The CRC-32 of PNG, annex D.
[[nodiscard]] inline std::uint32_t crc(const Bytes& bytes, std::size_t begin, std::size_t end) noexcept {
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t n = 0; n < 256; ++n) {
        table[n] = n;
        for (int bit = 0; bit < 8; ++bit) table[n] = (table[n] & 1U) != 0 ? 0xedb88320U ^ table[n] >> 1U : table[n] >> 1U;
    }
    std::uint32_t sum = 0xffffffffU;
    for (std::size_t i = begin; i < end; ++i) sum = table[(sum ^ bytes[i]) & 255U] ^ sum >> 8U;
    return ~sum;
}

// Where the marker is that ends the entropy-coded data from there: zeros are stuffed behind its 255s, and restarts are within.
[[nodiscard]] inline std::size_t end_of_scan(const Bytes& bytes, std::size_t at) noexcept {
    while (at + 1 < bytes.size() && !(bytes[at] == 0xff && bytes[at + 1] != 0 && (bytes[at + 1] < 0xd0 || bytes[at + 1] > 0xd7)))
        ++at;
    return at;
}

}  // namespace detail

// The picture of a JPEG file of 1 or 3 components, to be turned as ImageFile::orientation says. Of the applications' segments
// those of JFIF and Adobe stay, which say what the components are. Empty where browsers may show other pixels than were read or
// none: CMYK, a height that follows later, and what is not as the standard has it.
[[nodiscard]] inline std::vector<unsigned char> plain_jpeg(const std::vector<unsigned char>& bytes) {
    if (!detail::begins_with(bytes, "\xff\xd8\xff")) return {};
    std::vector<unsigned char> out(bytes.begin(), bytes.begin() + 2);
    const auto keep = [&](std::size_t from, std::size_t to) {
        out.insert(out.end(), bytes.begin() + static_cast<std::ptrdiff_t>(from), bytes.begin() + static_cast<std::ptrdiff_t>(to));
    };
    bool has_frame = false;
    for (std::size_t at = 2; at + 1 < bytes.size();) {
        const unsigned marker = bytes[at + 1];
        if (bytes[at] != 0xff) return {};
        if (marker == 0xff) {  // fill
            ++at;
            continue;
        }
        if (marker == 0xd9) {
            keep(at, at + 2);
            return has_frame ? out : std::vector<unsigned char>();
        }
        if (at + 4 > bytes.size()) return {};
        const std::size_t size = detail::big_endian(bytes, at + 2, 2);
        std::size_t end = at + 2 + size;
        if (size < 2 || end > bytes.size()) return {};
        const bool is_frame = marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
        if (is_frame) {
            const bool has_height = size >= 8 && detail::big_endian(bytes, at + 5, 2) != 0;
            if (has_frame || !has_height || (bytes[at + 9] != 1 && bytes[at + 9] != 3)) return {};
        }
        has_frame = has_frame || is_frame;
        if (marker == 0xda) end = detail::end_of_scan(bytes, end);
        const bool is_note = (marker >= 0xe1 && marker <= 0xef && marker != 0xee) || marker == 0xfe;
        if (!is_note) keep(at, end);
        at = end;
    }
    return {};
}

// The picture of a PNG file of up to 8 bits a sample. Of the chunks those stay that pixels are made of. Empty where browsers
// would show other pixels than stb_image or none: Apple's own kind, and what is cut off or damaged; and for 16 bits, which are
// larger than what is seen of them.
[[nodiscard]] inline std::vector<unsigned char> plain_png(const std::vector<unsigned char>& bytes) {
    if (!detail::begins_with(bytes, "\x89PNG\r\n\x1a\n") || bytes.size() < 33 || bytes[24] > 8) return {};
    std::vector<unsigned char> out(bytes.begin(), bytes.begin() + 8);
    for (std::size_t at = 8; at + 12 <= bytes.size();) {
        const std::size_t size = detail::big_endian(bytes, at, 4);
        if (size > bytes.size() - at - 12) return {};
        const auto is = [&](const char* type) { return std::memcmp(bytes.data() + at + 4, type, 4) == 0; };
        const std::size_t end = at + 12 + size;
        if (is("IHDR") || is("PLTE") || is("tRNS") || is("IDAT") || is("IEND")) {
            if (detail::crc(bytes, at + 4, end - 4) != detail::big_endian(bytes, end - 4, 4)) return {};
            std::copy(bytes.begin() + static_cast<std::ptrdiff_t>(at), bytes.begin() + static_cast<std::ptrdiff_t>(end),
                      std::back_inserter(out));
        } else if ((bytes[at + 4] & 32U) == 0) {  // critical, and unknown
            return {};
        }
        if (is("IEND")) return out;
        at = end;
    }
    return {};
}

}  // namespace tool

#endif  // HMESH_TOOLS_PLAIN_FILE_HPP
