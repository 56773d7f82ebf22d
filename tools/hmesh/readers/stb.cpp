// BMP, TGA and GIF files, and PNG and JPEG files where their libraries are missing, by stb_image, the only file that
// compiles it.
//
// stb_image takes what a file lacks as zeros, or as what the memory held: whether each pixel is there is found out here, before.
// Its buffers are zeros.
#include <algorithm>
#include <climits>
#include <cstdlib>
#include <cstring>
#include <memory>

#include "readers/readers.hpp"

namespace {

// Zeros from `used` on: stb_image's buffers grow.
void* grow_with_zeros(void* buffer, std::size_t used, std::size_t size) {
    void* grown = std::realloc(buffer, size);
    if (grown != nullptr && size > used) std::memset(static_cast<unsigned char*>(grown) + used, 0, size - used);
    return grown;
}

}  // namespace

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_BMP
#define STBI_ONLY_TGA
#define STBI_ONLY_GIF
#ifndef HMESH_HAS_PNG
#define STBI_ONLY_PNG
#endif
#ifndef HMESH_HAS_JPEG
#define STBI_ONLY_JPEG
#endif
#define STBI_NO_HDR
#define STBI_NO_LINEAR
#define STBI_NO_STDIO
#define STBI_FAILURE_USERMSG
#define STBI_MAX_DIMENSIONS 65536
#define STBI_MALLOC(size) std::calloc(1, size)
#define STBI_REALLOC_SIZED(buffer, used, size) grow_with_zeros(buffer, used, size)
#define STBI_REALLOC(buffer, size) std::realloc(buffer, size)
#define STBI_FREE(buffer) std::free(buffer)
#define STBI_ASSERT(what) static_cast<void>(0)
#include <stb_image.h>
#ifndef HMESH_STB_VERSION  // CMake looks for it
#define HMESH_STB_VERSION "of an unknown version"
#endif

namespace tool {
namespace {

constexpr std::size_t max_file = INT_MAX;  // stb_image counts in int

struct Decoded {
    int width = 0, height = 0, channels = 0;
};

template <class T>
std::string take(const Decoded& size, T* pixels, ImageFile& image, hmesh::kit::Array<T>& samples) {
    const std::unique_ptr<T, void (*)(void*)> owner(pixels, stbi_image_free);
    if (pixels == nullptr) return std::string("stb_image refuses it: ") + stbi_failure_reason();
    if (std::string why = start_image(image, size.width, size.height, size.channels, 8 * int{sizeof(T)}); !why.empty())
        return why;
    std::memcpy(samples.data(), pixels, samples.size() * sizeof(T));
    return {};
}

std::string too_few(std::size_t has, std::size_t needs) {
    return "the file ends before its last pixel (" + std::to_string(has) + " of " + std::to_string(needs) + " pixels)";
}

// --- BMP: the headers and masks of Microsoft's documentation of bitmap storage ---

struct Bmp {
    std::size_t pixels_at = 0, header = 0, bits = 0, row = 0, used = 0;  // bytes of a row, and those of them that hold pixels
    std::size_t colors = 0;                                              // of the palette that pixels are numbers of
    std::int64_t width = 0, height = 0;
};

bool is_run_of_bits(std::uint32_t mask) {
    if (mask == 0) return false;
    const std::uint32_t low = mask & (~mask + 1);
    const std::uint32_t run = mask / low;
    return (run & (run + 1)) == 0 && run <= 255;
}

std::string check_masks(Bytes file, const Bmp& bmp) {
    if (file.le32(30) != 3) return {};
    const std::uint32_t alpha = bmp.header >= 56 ? file.le32(66) : 0;
    for (const std::size_t at : {54U, 58U, 62U})
        if (!is_run_of_bits(file.le32(at))) return "its BMP header has a mask that is no run of 1 to 8 bits";
    return alpha == 0 || is_run_of_bits(alpha) ? "" : "its BMP header has a mask of alpha that is no run of 1 to 8 bits";
}

// Whether each pixel has a colour of the palette.
std::string check_palette(Bytes file, const Bmp& bmp) {
    if (bmp.header == 12) return "it is a BMP file of OS/2 with a palette";
    if (bmp.colors < 1) return "its palette has no colours";
    if (bmp.colors >= std::size_t{1} << bmp.bits) return {};
    const std::uint32_t mask = (1U << bmp.bits) - 1U;
    const std::size_t per_byte = 8 / bmp.bits;
    for (std::size_t y = 0; y < static_cast<std::size_t>(bmp.height); ++y)
        for (std::size_t x = 0; x < static_cast<std::size_t>(bmp.width); ++x) {
            const std::uint32_t byte = file.u8(bmp.pixels_at + y * bmp.row + x / per_byte);
            const std::uint32_t color = byte >> (8 - bmp.bits * (x % per_byte + 1)) & mask;
            if (color >= bmp.colors)
                return "it has a pixel of colour " + std::to_string(color) + ", and its palette has " +
                       std::to_string(bmp.colors);
        }
    return {};
}

std::string check_bmp(Bytes file, Bmp& bmp) {
    bmp.pixels_at = file.le32(10);
    bmp.header = file.le32(14);
    const bool is_old = bmp.header == 12;
    if (!is_old && bmp.header != 40 && bmp.header != 56 && bmp.header != 108 && bmp.header != 124)
        return "its BMP header has " + std::to_string(bmp.header) + " bytes, not 12, 40, 56, 108 or 124";
    bmp.width = is_old ? file.le16(18) : file.le32(18);
    bmp.height = is_old ? file.le16(20) : file.le32(22);
    if (bmp.height > INT_MAX) bmp.height = (std::int64_t{1} << 32) - bmp.height;  // from top to bottom
    if (std::string why = check_size(bmp.width, bmp.height); !why.empty()) return why;
    bmp.bits = is_old ? file.le16(24) : file.le16(28);
    const std::uint32_t compression = is_old ? 0 : file.le32(30);
    const bool has_masks = compression == 3 && (bmp.bits == 16 || bmp.bits == 32);
    if (compression != 0 && !has_masks) return "its BMP compression is " + std::to_string(compression) + ", and hmesh reads none";
    if (bmp.bits != 1 && bmp.bits != 4 && bmp.bits != 8 && bmp.bits != 16 && bmp.bits != 24 && bmp.bits != 32)
        return "it has " + std::to_string(bmp.bits) + " bits a pixel, not 1, 4, 8, 16, 24 or 32";
    bmp.row = (static_cast<std::size_t>(bmp.width) * bmp.bits + 31) / 32 * 4;
    bmp.used = (static_cast<std::size_t>(bmp.width) * bmp.bits + 7) / 8;
    if (bmp.pixels_at < 14 + bmp.header) return "its pixels begin within its header";
    const std::size_t end = bmp.pixels_at + bmp.row * static_cast<std::size_t>(bmp.height - 1) + bmp.used;
    if (end > file.size) return too_short(file.size, end);
    if (bmp.bits <= 8) bmp.colors = std::min((bmp.pixels_at - 14 - bmp.header) / 4, std::size_t{1} << bmp.bits);
    return bmp.bits <= 8 ? check_palette(file, bmp) : check_masks(file, bmp);
}

// How many bytes from the first on are headers, masks and palette. Pixels may begin later, as behind a palette for screens of
// few colours, or where a program likes them to.
std::size_t end_of_header(Bytes file, const Bmp& bmp) {
    const std::size_t masks_behind = bmp.header == 40 && file.le32(30) == 3 ? 12 : 0;
    return std::min(bmp.pixels_at, 14 + bmp.header + masks_behind + 4 * bmp.colors);
}

// The same file as stb_image takes it: with a header of 108 bytes in place of 56, of which no more is read, as of 56 it takes the
// masks from behind; and with nothing before its pixels that is no header, which it takes for damage or for colours.
std::vector<unsigned char> as_stb_takes_it(Bytes file, const Bmp& bmp) {
    std::vector<unsigned char> out(file.data, file.data + end_of_header(file, bmp));
    if (bmp.header == 56) {
        out.insert(out.begin() + 70, 52, 0);
        out[14] = 108;
    }
    const std::size_t pixels_at = out.size();
    for (unsigned k = 0; k < 4; ++k) out[10 + k] = static_cast<unsigned char>(pixels_at >> (8 * k));
    out.insert(out.end(), file.data + bmp.pixels_at, file.data + file.size);
    return out;
}

// --- TGA: Truevision's specification, version 2.0 ---

struct Tga {
    std::size_t at = 0, pixel_bytes = 0, pixels = 0, colors = 0;
    bool has_map = false, has_runs = false;
};

// Whether what is at `at` is a colour of the map.
std::string check_color(Bytes file, const Tga& tga, std::size_t at) {
    const std::size_t color = tga.pixel_bytes == 1 ? file.u8(at) : file.le16(at);
    if (!tga.has_map || color < tga.colors) return {};
    return "it has a pixel of colour " + std::to_string(color) + ", and its colour map has " + std::to_string(tga.colors);
}

std::string check_pixels(Bytes file, Tga& tga) {
    for (std::size_t done = 0; done < tga.pixels;) {
        std::size_t count = tga.pixels, stored = tga.pixels;
        if (tga.has_runs) {
            const std::uint32_t packet = file.u8(tga.at);
            if (tga.at >= file.size) return too_few(done, tga.pixels);
            ++tga.at;
            count = (packet & 127U) + 1;
            stored = packet > 127 ? 1 : count;
        }
        if (count > tga.pixels - done) return "it has a run beyond its last pixel";
        if (!file.has(tga.at, stored * tga.pixel_bytes)) return too_short(file.size, tga.at + stored * tga.pixel_bytes);
        for (std::size_t k = 0; tga.has_map && k < stored; ++k)
            if (std::string why = check_color(file, tga, tga.at + k * tga.pixel_bytes); !why.empty()) return why;
        tga.at += stored * tga.pixel_bytes;
        done += count;
    }
    return {};
}

std::string check_tga(Bytes file) {
    Tga tga;
    const std::uint32_t bits = file.u8(16), map_bits = file.u8(7);
    tga.has_map = file.u8(1) == 1;
    tga.has_runs = file.u8(2) >= 8;
    tga.colors = file.le16(5);
    tga.pixels = std::size_t{file.le16(12)} * file.le16(14);
    tga.pixel_bytes = (bits + 7) / 8;
    if (std::string why = check_size(file.le16(12), file.le16(14)); !why.empty()) return why;
    if (tga.has_map && (bits > 16 || file.le16(3) != 0 || (map_bits != 15 && map_bits != 16 && map_bits != 24 && map_bits != 32)))
        return "its colour map has entries of " + std::to_string(map_bits) + " bits from " + std::to_string(file.le16(3)) +
               " on, and hmesh reads 15, 16, 24 or 32 bits from 0 on";
    tga.at = 18 + std::size_t{file.u8(0)} + (tga.has_map ? tga.colors * ((map_bits + 7) / 8) : 0);
    return check_pixels(file, tga);
}

// --- GIF: CompuServe's GIF89a, with LZW as its appendix F has it ---

// The bytes of a chain of blocks, and `at` behind it. False where the file ends before.
bool read_blocks(Bytes file, std::size_t& at, std::vector<unsigned char>* bytes) {
    while (at < file.size) {
        const std::size_t size = file.u8(at++);
        if (size == 0) return true;
        if (!file.has(at, size)) return false;
        if (bytes != nullptr) bytes->insert(bytes->end(), file.data + at, file.data + at + size);
        at += size;
    }
    return false;
}

// How many pixels LZW codes make until all are there; each code is followed by its length alone, as no pixel is needed but those
// that are no colour.
std::string check_lzw(const std::vector<unsigned char>& bytes, unsigned root_bits, std::size_t pixels, std::size_t colors) {
    if (root_bits < 1 || root_bits > 8) return "its LZW codes begin with " + std::to_string(root_bits) + " bits, not 1 to 8";
    const std::size_t clear = std::size_t{1} << root_bits;
    std::vector<std::size_t> length(4096, 0);
    for (std::size_t k = 0; k < clear; ++k) length[k] = 1;
    std::size_t next = clear + 2, last = SIZE_MAX, done = 0, word = 0;
    unsigned code_bits = root_bits + 1, word_bits = 0;
    for (const unsigned char byte : bytes) {
        word |= std::size_t{byte} << word_bits;
        word_bits += 8;
        while (word_bits >= code_bits) {
            const std::size_t code = word & ((std::size_t{1} << code_bits) - 1);
            word >>= code_bits;
            word_bits -= code_bits;
            if (code == clear) {
                next = clear + 2;
                code_bits = root_bits + 1;
                last = SIZE_MAX;
                continue;
            }
            if (code == clear + 1) return too_few(done, pixels);
            if (code > next || (code == next && (last == SIZE_MAX || next >= 4096)))
                return "it has an LZW code that means nothing";
            if (code < clear && code >= colors)
                return "it has a pixel of colour " + std::to_string(code) + ", and its palette has " + std::to_string(colors);
            if (last != SIZE_MAX && next < 4096) length[next++] = length[last] + 1;
            done += length[code];
            if (done >= pixels) return {};
            last = code;
            if (next == std::size_t{1} << code_bits && code_bits < 12) ++code_bits;
        }
    }
    return too_few(done, pixels);
}

// A frame whose descriptor is at `at`, which is then behind it.
std::string check_frame(Bytes file, std::size_t& at, std::size_t global_colors, bool is_first) {
    const std::size_t width = file.le16(at + 5), height = file.le16(at + 7);
    const std::uint32_t flags = file.u8(at + 9);
    const std::size_t local_colors = (flags & 128U) != 0 ? std::size_t{2} << (flags & 7U) : 0;
    const std::size_t colors = local_colors != 0 ? local_colors : global_colors;
    const std::size_t x = file.le16(at + 1), y = file.le16(at + 3);
    at += 10 + 3 * local_colors;
    if (!file.has(at, 1)) return "the file ends within a frame";
    if (colors == 0) return "it has a frame without a palette";
    if (width == 0 || height == 0 || x + width > file.le16(6) || y + height > file.le16(8))
        return "it has a frame beyond its picture";
    const unsigned root_bits = file.u8(at++);
    std::vector<unsigned char> codes;
    if (!read_blocks(file, at, is_first ? &codes : nullptr)) return "the file ends within a frame";
    return is_first ? check_lzw(codes, root_bits, width * height, colors) : "";
}

std::string check_gif(Bytes file, std::size_t& frames) {
    if (std::string why = check_size(file.le16(6), file.le16(8)); !why.empty()) return why;
    const std::uint32_t flags = file.u8(10);
    const std::size_t colors = (flags & 128U) != 0 ? std::size_t{2} << (flags & 7U) : 0;
    for (std::size_t at = 13 + 3 * colors; at < file.size;) {
        switch (file.u8(at)) {
            case 0x3b: return frames != 0 ? "" : "it has no frame";
            case 0x21:
                at += 2;
                if (!read_blocks(file, at, nullptr)) return "the file ends within an extension";
                break;
            case 0x2c:
                if (std::string why = check_frame(file, at, colors, frames++ == 0); !why.empty()) return why;
                break;
            default: return "it has no block of GIF's at byte " + std::to_string(at);
        }
    }
    return "the file ends before its trailer";
}

// The same file with its first colour as the background, of which stb_image makes nothing: with any other it fills what the first
// frame leaves of the picture, red and blue changed for one another. That is transparent, as browsers show it.
std::vector<unsigned char> without_background(Bytes file) {
    std::vector<unsigned char> out(file.data, file.data + file.size);
    out[11] = 0;
    return out;
}

// Of a file whose header knows no alpha, the fourth bytes are alpha all the same, as most programs that leave this out mean it,
// unless all are 0: no picture is meant to be invisible.
void drop_unsaid_alpha(ImageFile& image) {
    if (image.channels != 4) return;
    hmesh::kit::Array<std::uint8_t>& samples = image.samples8;
    for (std::size_t k = 3; k < samples.size(); k += 4)
        if (samples[k] != 0) return;
    for (std::size_t k = 3; k < samples.size(); k += 4) samples[k] = 255;
    drop_opaque_alpha(image);
}

}  // namespace

std::string decode_stb(Bytes file, ImageFile& image) {
    if (file.size > max_file) return "the file is larger than 2 GiB";
    const auto size = static_cast<int>(file.size);
    Decoded header, found;
    if (stbi_info_from_memory(file.data, size, &header.width, &header.height, &header.channels) == 0)
        return std::string("stb_image refuses it: ") + stbi_failure_reason();
    if (header.height < 0 && header.height > INT_MIN) header.height = -header.height;  // of a BMP file from top to bottom
    if (std::string why = check_size(header.width, header.height); !why.empty()) return why;
    // Asked for all the channels that there are: with a transparent colour a PNG file has one more than its header says.
    const auto decode = [&](auto load) { return load(file.data, size, &found.width, &found.height, &found.channels, 0); };
    if (stbi_is_16_bit_from_memory(file.data, size) != 0)
        return take(found, decode(stbi_load_16_from_memory), image, image.samples16);
    return take(found, decode(stbi_load_from_memory), image, image.samples8);
}

std::string read_bmp(Bytes file, ImageFile& image) {
    Bmp bmp;
    std::string why = check_bmp(file, bmp);
    if (why.empty() && (bmp.header == 56 || end_of_header(file, bmp) < bmp.pixels_at)) {
        const std::vector<unsigned char> same = as_stb_takes_it(file, bmp);
        why = decode_stb({same.data(), same.size()}, image);
    } else if (why.empty()) {
        why = decode_stb(file, image);
    }
    if (why.empty()) drop_opaque_alpha(image);
    return why;
}

std::string read_tga(Bytes file, ImageFile& image) {
    std::string why = check_tga(file);
    if (why.empty()) why = decode_stb(file, image);
    if (why.empty() && (file.u8(17) & 15U) == 0) drop_unsaid_alpha(image);
    if (why.empty() && (file.u8(17) & 16U) != 0) turn_upright(2, image);  // rows from right to left
    return why;
}

std::string read_gif(Bytes file, ImageFile& image) {
    std::size_t frames = 0;
    std::string why = check_gif(file, frames);
    if (why.empty()) {
        const std::vector<unsigned char> same = without_background(file);
        why = decode_stb({same.data(), same.size()}, image);
    }
    if (why.empty()) drop_opaque_alpha(image);
    if (why.empty() && frames > 1)
        image.note = "the file is animated: the first of its " + std::to_string(frames) + " frames is taken";
    return why;
}

std::string stb_decoder() { return std::string("stb_image ") + HMESH_STB_VERSION; }

}  // namespace tool
