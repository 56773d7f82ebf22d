// tools - the input file as a page shows it: its compressed pixels as they are, without all that makes browsers show others.
//
// The reader takes samples as they are stored, of the first picture; browsers turn what Exif tags say is turned, convert what
// has a colour profile or a gamma, and play animations. So these are left out, and with them what a camera notes beside the
// picture: where it was taken, thumbnails, clips. JPEG: ITU-T T.81, annex B; PNG: W3C's third edition, 5 and 11.
#ifndef HMESH_TOOLS_WRITERS_PLAIN_FILE_HPP
#define HMESH_TOOLS_WRITERS_PLAIN_FILE_HPP

#include <cstddef>
#include <vector>

#include "readers/bytes.hpp"
#include "readers/png_chunks.hpp"

namespace tool {

namespace detail {

// Where the marker is that ends the entropy-coded data from there: zeros are stuffed behind its 255s, and restarts are within.
[[nodiscard]] inline std::size_t end_of_scan(Bytes file, std::size_t at) noexcept {
    const auto is_marker = [&] {
        return file.u8(at) == 0xff && file.u8(at + 1) != 0 && (file.u8(at + 1) < 0xd0 || file.u8(at + 1) > 0xd7);
    };
    while (at + 1 < file.size && !is_marker()) ++at;
    return at;
}

inline void append(Bytes file, std::size_t begin, std::size_t end, std::vector<unsigned char>& to) {
    to.insert(to.end(), file.data + begin, file.data + end);
}

}  // namespace detail

// The picture of a JPEG file of 1 or 3 components, to be turned as ImageFile::orientation says. Of the applications' segments
// those of JFIF and Adobe stay, which say what the components are. Empty where browsers may show other pixels than were read or
// none: CMYK, a height that follows later, and what is not as the standard has it.
[[nodiscard]] inline std::vector<unsigned char> plain_jpeg(Bytes file) {
    if (!file.says(0, "\xff\xd8\xff")) return {};
    std::vector<unsigned char> out;
    detail::append(file, 0, 2, out);
    bool has_frame = false;
    for (std::size_t at = 2; file.has(at, 2);) {
        const unsigned marker = file.u8(at + 1);
        if (file.u8(at) != 0xff) return {};
        if (marker == 0xff) {  // fill
            ++at;
            continue;
        }
        if (marker == 0xd9) {
            detail::append(file, at, at + 2, out);
            return has_frame ? out : std::vector<unsigned char>();
        }
        const std::size_t size = file.be16(at + 2);
        std::size_t end = at + 2 + size;
        if (size < 2 || end > file.size) return {};
        const bool is_frame = marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
        if (is_frame) {
            const bool has_height = size >= 8 && file.be16(at + 5) != 0;
            if (has_frame || !has_height || (file.u8(at + 9) != 1 && file.u8(at + 9) != 3)) return {};
        }
        has_frame = has_frame || is_frame;
        if (marker == 0xda) end = detail::end_of_scan(file, end);
        const bool is_note = (marker >= 0xe1 && marker <= 0xef && marker != 0xee) || marker == 0xfe;
        if (!is_note) detail::append(file, at, end, out);
        at = end;
    }
    return {};
}

// The picture of a PNG file of up to 8 bits a sample. Of the chunks those stay that pixels are made of. Empty where browsers
// would show other pixels than were read or none: Apple's own kind, and what is cut off or damaged; and for 16 bits, which are
// larger than what is seen of them.
[[nodiscard]] inline std::vector<unsigned char> plain_png(Bytes file) {
    if (!file.says(0, "\x89PNG\r\n\x1a\n") || file.size < 33 || file.u8(24) > 8) return {};
    std::vector<unsigned char> out;
    detail::append(file, 0, 8, out);
    for (Chunk chunk; read_chunk(file, chunk); chunk.at += chunk.size + 12) {
        const auto is = [&](const auto& type) { return file.says(chunk.at + 4, type); };
        if (is("IHDR") || is("PLTE") || is("tRNS") || is("IDAT") || is("IEND")) {
            if (!is_undamaged(file, chunk)) return {};
            detail::append(file, chunk.at, chunk.at + 12 + chunk.size, out);
        } else if ((file.u8(chunk.at + 4) & 32U) == 0) {  // critical, and unknown
            return {};
        }
        if (is("IEND")) return out;
    }
    return {};
}

}  // namespace tool

#endif  // HMESH_TOOLS_WRITERS_PLAIN_FILE_HPP
