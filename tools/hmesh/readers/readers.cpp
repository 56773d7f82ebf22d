#include "readers/readers.hpp"

#include <climits>

#include "hmesh/image/image_view.hpp"
#include "readers/exif.hpp"
#include "terminal/words.hpp"

namespace tool {
namespace {

bool is_pnm_like(Bytes file, char a, char b) noexcept {
    const std::uint32_t kind = file.u8(1), after = file.u8(2);
    return file.size > 2 && file.u8(0) == 'P' &&
           (kind == static_cast<unsigned char>(a) || kind == static_cast<unsigned char>(b)) &&
           (after == ' ' || after == '#' || (after >= '\t' && after <= '\r'));
}

bool is_tga_like(Bytes file) noexcept {
    const std::uint32_t has_map = file.u8(1), type = file.u8(2) & ~8U, bits = file.u8(16);
    const bool is_type = file.u8(2) < 12 && (has_map == 1 ? type == 1 : has_map == 0 && (type == 2 || type == 3));
    return file.size >= 18 && is_type && (bits == 8 || bits == 15 || bits == 16 || bits == 24 || bits == 32);
}

// The place of the frame header of a JPEG file; 0 where these bytes do not hold it.
std::size_t find_jpeg_frame(Bytes file) noexcept {
    for (std::size_t at = 2; file.has(at, 9) && file.u8(at) == 0xff;) {
        const std::uint32_t marker = file.u8(at + 1);
        if (marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc) return at;
        at += marker == 0xff ? 1 : 2 + file.be16(at + 2);
    }
    return 0;
}

}  // namespace

FileKind kind_of(Bytes file) noexcept {
    if (file.says(0, "\x89PNG\r\n\x1a\n")) return FileKind::png;
    if (file.says(0, "\xff\xd8\xff")) return FileKind::jpeg;
    if (file.says(0, "RIFF") && file.says(8, "WEBP")) return FileKind::webp;
    if (file.says(0, "II*\0") || file.says(0, "MM\0*") || file.says(0, "II+\0") || file.says(0, "MM\0+")) return FileKind::tiff;
    if (is_pnm_like(file, '5', '6')) return FileKind::pnm;
    if (is_pnm_like(file, 'f', 'F')) return FileKind::pfm;
    if (file.says(0, "#?RADIANCE") || file.says(0, "#?RGBE")) return FileKind::hdr;
    if (file.says(0, "GIF87a") || file.says(0, "GIF89a")) return FileKind::gif;
    if (file.says(0, "8BPS")) return FileKind::psd;
    if (file.says(0, "BM")) return FileKind::bmp;
    return is_tga_like(file) ? FileKind::tga : FileKind::unknown;
}

const char* name_of(FileKind kind) noexcept {
    switch (kind) {
        case FileKind::unknown: break;
        case FileKind::png: return "PNG";
        case FileKind::jpeg: return "JPEG";
        case FileKind::webp: return "WebP";
        case FileKind::tiff: return "TIFF";
        case FileKind::pnm: return "PNM";
        case FileKind::pfm: return "PFM";
        case FileKind::hdr: return "Radiance HDR";
        case FileKind::bmp: return "BMP";
        case FileKind::tga: return "TGA";
        case FileKind::gif: return "GIF";
        case FileKind::psd: return "PSD";
    }
    return "unknown";
}

std::string not_known(Bytes file) {
    for (const char* const kind : {"P1", "P2", "P3", "P4", "P7"})
        if (is_pnm_like(file, kind[1], kind[1]))
            return std::string("it is a PNM file of the kind ") + kind + ", of which hmesh reads P5, P6, Pf and PF";
    return "it is in no format that hmesh reads, which --help lists";
}

std::string check_size(std::int64_t width, std::int64_t height) {
    using hmesh::Errc;
    if (width > INT_MAX) return in_words({Errc::image_too_large, "the image is too wide", width, hmesh::kit::max_side});
    if (height > INT_MAX) return in_words({Errc::image_too_large, "the image is too high", height, hmesh::kit::max_side});
    const std::uint8_t no_pixel = 0;
    const hmesh::Status status =
        hmesh::check(hmesh::ImageView<std::uint8_t, 1>{&no_pixel, static_cast<int>(width), static_cast<int>(height), 0});
    return status ? std::string() : in_words(status);
}

std::string check_beginning(Bytes file) {
    std::int64_t width = -1, height = -1;
    switch (kind_of(file)) {
        case FileKind::png:
            if (file.says(12, "CgBI")) return "it is a PNG file for iOS alone";
            if (!file.has(16, 8)) return "its PNG header is cut off";
            if (!file.says(12, "IHDR")) return "its first PNG chunk is not IHDR";
            width = file.be32(16);
            height = file.be32(20);
            break;
        case FileKind::jpeg:
            if (const std::size_t frame = find_jpeg_frame(file); frame != 0) {
                width = file.be16(frame + 7);
                height = file.be16(frame + 5);
            }
            break;
        case FileKind::tiff:
            return check_tiff_directory(file.part(file.says(2, "+\0") || file.says(2, "\0+") ? file.size
                                                  : file.u8(0) == 'I'                        ? file.le32(4)
                                                                                             : file.be32(4)),
                                        file.u8(0) == 'I');
        case FileKind::bmp:
            if (!file.has(14, 12)) return "its BMP header is cut off";
            width = file.le32(14) == 12 ? file.le16(18) : file.le32(18);
            height = file.le32(14) == 12 ? file.le16(20) : file.le32(22);
            if (height > INT_MAX) height = (std::int64_t{1} << 32) - height;  // from top to bottom
            break;
        case FileKind::tga:
            width = file.le16(12);
            height = file.le16(14);
            break;
        case FileKind::gif:
            if (!file.has(6, 4)) return "its GIF header is cut off";
            width = file.le16(6);
            height = file.le16(8);
            break;
        case FileKind::psd:
            if (!file.has(14, 8)) return "its PSD header is cut off";
            width = file.be32(18);
            height = file.be32(14);
            break;
        case FileKind::pnm:
        case FileKind::pfm: find_pnm_size(file, width, height); break;
        case FileKind::hdr: find_hdr_size(file, width, height); break;
        case FileKind::webp:  // 16384 px at most
        case FileKind::unknown: break;
    }
    return width < 0 || height < 0 ? "" : check_size(width, height);
}

std::string check_tiff_directory(Bytes directory, bool is_little) {
    std::int64_t width = -1, height = -1;
    const auto u16 = [&](std::size_t at) { return is_little ? directory.le16(at) : directory.be16(at); };
    const auto u32 = [&](std::size_t at) { return is_little ? directory.le32(at) : directory.be32(at); };
    for (std::size_t k = 0; k < u16(0) && directory.has(2 + 12 * k, 12); ++k) {
        const std::size_t entry = 2 + 12 * k;
        const std::int64_t value = u16(entry + 2) == 3 ? u16(entry + 8) : u32(entry + 8);
        if (u16(entry) == 256) width = value;
        if (u16(entry) == 257) height = value;
    }
    return width < 0 || height < 0 ? "" : check_size(width, height);
}

std::string check_ratio(std::size_t needed, std::size_t size, std::size_t ratio) {
    if (needed / ratio <= size) return {};
    return "its " + std::to_string(size) + " bytes cannot hold the " + std::to_string(needed) + " bytes of its pixels";
}

std::string too_short(std::size_t has, std::size_t needs) {
    return "the file ends before its last pixel (" + std::to_string(has) + " of " + std::to_string(needs) + " bytes)";
}

std::string start_image(ImageFile& image, std::int64_t width, std::int64_t height, int channels, int bits) {
    if (std::string why = check_size(width, height); !why.empty()) return why;
    image.width = static_cast<int>(width);
    image.height = static_cast<int>(height);
    image.channels = channels;
    image.bits = bits;
    const auto count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * static_cast<std::size_t>(channels);
    image.samples8.assign(bits == 8 ? count : 0, 0);
    image.samples16.assign(bits == 16 ? count : 0, 0);
    image.samples32.assign(bits == 32 ? count : 0, 0);
    return {};
}

void drop_opaque_alpha(ImageFile& image) {
    if (image.channels != 4 || image.bits == 32) return;
    const auto drop = [&](auto& samples, auto opaque) {
        for (std::size_t k = 3; k < samples.size(); k += 4)
            if (samples[k] != opaque) return;
        std::size_t to = 0;
        for (std::size_t k = 0; k < samples.size(); ++k)
            if (k % 4 != 3) samples[to++] = samples[k];
        samples.resize(to);
        image.channels = 3;
    };
    if (image.bits == 8) drop(image.samples8, std::uint8_t{255});
    else drop(image.samples16, std::uint16_t{65535});
}

void turn_upright(unsigned orientation, ImageFile& image) {
    if (image.bits == 8) turn_upright(orientation, image.channels, image.width, image.height, image.samples8);
    else if (image.bits == 16) turn_upright(orientation, image.channels, image.width, image.height, image.samples16);
    else turn_upright(orientation, image.channels, image.width, image.height, image.samples32);
}

std::string read_bytes_as_image(Bytes file, ImageFile& image) {
    if (std::string why = check_beginning(file); !why.empty()) return why;
    switch (kind_of(file)) {
        case FileKind::unknown: break;
        case FileKind::png: return read_png(file, image);
        case FileKind::jpeg: return read_jpeg(file, image);
        case FileKind::webp: return read_webp(file, image);
        case FileKind::tiff: return read_tiff(file, image);
        case FileKind::pnm: return read_pnm(file, image);
        case FileKind::pfm: return read_pfm(file, image);
        case FileKind::hdr: return read_hdr(file, image);
        case FileKind::bmp: return read_bmp(file, image);
        case FileKind::tga: return read_tga(file, image);
        case FileKind::gif: return read_gif(file, image);
        case FileKind::psd: return read_psd(file, image);
    }
    return is_mesh(file) ? "it is a mesh, and no image" : not_known(file);
}

}  // namespace tool
