// PSD files (Adobe Photoshop File Formats Specification): the picture that is saved for programs that know no layers, grey, RGB
// or CMYK of 8 or 16 bits, raw or in runs. stb_image reads RGB alone, and casts what it makes of pixels that are half transparent
// to bytes that do not hold it.
#include <algorithm>
#include <cstring>

#include "readers/readers.hpp"

namespace tool {
namespace {

struct Psd {
    std::size_t width = 0, height = 0, channels = 0, bytes = 0, colors = 0;  // bytes: of a sample
    std::size_t at = 0;                                                      // of the pixels, behind their compression
    bool has_runs = false;
    bool is_over_white = false;  // the colours, where channel `colors` is their alpha and no selection that was saved

    [[nodiscard]] std::size_t row() const { return width * bytes; }
    [[nodiscard]] std::size_t used() const { return std::min(channels, colors + (colors < 4 ? 1 : 0)); }  // with alpha
};

// PackBits: a row of `size` bytes, which must be made of all of `packed`.
bool unpack(Bytes packed, unsigned char* row, std::size_t size) {
    std::size_t at = 0, done = 0;
    while (at < packed.size) {
        const std::uint32_t code = packed.u8(at++);
        if (code == 128) continue;
        const std::size_t count = code < 128 ? code + 1 : 257 - code;
        if (count > size - done || !packed.has(at, code < 128 ? count : 1)) return false;
        if (code < 128) std::memcpy(row + done, packed.data + at, count);
        else std::memset(row + done, packed.data[at], count);
        at += code < 128 ? count : 1;
        done += count;
    }
    return done == size;
}

// Whether the first extra channel is the picture's transparency, as a negative number of layers says: of this section, or with
// 16 bits of a block behind it.
bool has_transparency(Bytes layers) {
    if (layers.be32(0) != 0) return layers.be16(4) > 0x7fff;
    for (std::size_t at = 8 + std::size_t{layers.be32(4)}; layers.has(at, 12);
         at += 12 + (std::size_t{layers.be32(at + 8)} + 3) / 4 * 4)
        if (layers.says(at + 4, "Mt16") || (layers.says(at + 4, "Lr16") && layers.be16(at + 12) > 0x7fff)) return true;
    return false;
}

std::string read_header(Bytes file, Psd& psd) {
    psd.channels = file.be16(12);
    psd.height = file.be32(14);
    psd.width = file.be32(18);
    const std::uint32_t bits = file.be16(22), mode = file.be16(24);
    if (file.be16(4) != 1) return "it is a PSB file, of PSD's second version";
    if (std::string why = check_size(static_cast<std::int64_t>(psd.width), static_cast<std::int64_t>(psd.height)); !why.empty())
        return why;
    if (mode != 1 && mode != 3 && mode != 4)
        return "its PSD colour mode is " + std::to_string(mode) + ", and hmesh reads 1, 3 and 4: grey, RGB and CMYK";
    if (bits != 8 && bits != 16) return "it has " + std::to_string(bits) + " bits a sample, not 8 or 16";
    psd.bytes = bits / 8;
    psd.colors = mode;
    if (psd.channels < psd.colors || psd.channels > 56)
        return "it has " + std::to_string(psd.channels) + " channels, not " + std::to_string(psd.colors) + " to 56";
    psd.at = 26;
    for (int section = 0; section < 3; ++section) {  // mode, resources, layers
        const std::size_t size = file.be32(psd.at);
        if (!file.has(psd.at, 4) || !file.has(psd.at + 4, size))
            return "its section at byte " + std::to_string(psd.at) + " is cut off";
        psd.is_over_white = section == 2 && has_transparency(file.part(psd.at + 4, size));
        psd.at += 4 + size;
    }
    if (!file.has(psd.at, 2)) return "the file ends before its pixels";
    const std::uint32_t compression = file.be16(psd.at);
    psd.at += 2;
    psd.has_runs = compression == 1;
    return compression <= 1 ? "" : "its PSD compression is " + std::to_string(compression) + ", and hmesh reads 0 and 1";
}

// The planes, one after the other, of which what is not shown is looked at as well.
std::string read_planes(Bytes file, const Psd& psd, std::vector<unsigned char>& planes) {
    const std::size_t rows = psd.height * psd.channels, used_rows = psd.height * psd.used();
    std::size_t at = psd.at + (psd.has_runs ? 2 * rows : 0);
    if (!psd.has_runs && !file.has(at, psd.row() * rows)) return too_short(file.size, at + psd.row() * rows);
    if (psd.has_runs && !file.has(psd.at, 2 * rows)) return too_short(file.size, at);
    // A run of 128 bytes takes two.
    if (std::string why = check_ratio(psd.row() * rows, file.size, 64); !why.empty()) return why;
    planes.assign(psd.row() * used_rows, 0);
    std::vector<unsigned char> unseen(psd.row());
    for (std::size_t row = 0; row < rows; ++row) {
        unsigned char* const to = row < used_rows ? planes.data() + row * psd.row() : unseen.data();
        const std::size_t size = psd.has_runs ? file.be16(psd.at + 2 * row) : psd.row();
        if (!file.has(at, size)) return too_short(file.size, at + size);
        if (!psd.has_runs) std::memcpy(to, file.data + at, size);
        else if (!unpack(file.part(at, size), to, psd.row())) return "its row " + std::to_string(row) + " is damaged";
        at += size;
    }
    return {};
}

// What is half transparent is stored over white.
template <class T>
void take_white_away(T (&pixel)[4], std::size_t colors) {
    constexpr double peak = static_cast<T>(-1);
    const double alpha = pixel[colors] / peak;
    for (std::size_t c = 0; c < std::min<std::size_t>(colors, 3) && alpha > 0; ++c) {
        const double color = peak - (peak - static_cast<double>(pixel[c])) / alpha;
        pixel[c] = static_cast<T>(std::max(0.0, color) + 0.5);
    }
}

template <class T>
void take_planes(const Psd& psd, const std::vector<unsigned char>& planes, hmesh::kit::Array<T>& to) {
    const std::size_t pixels = psd.width * psd.height, used = psd.used();
    const Bytes bytes{planes.data(), planes.size()};
    T pixel[4] = {};
    for (std::size_t i = 0; i < pixels; ++i) {
        for (std::size_t c = 0; c < used; ++c) {
            const std::size_t at = (c * pixels + i) * sizeof(T);
            pixel[c] = static_cast<T>(sizeof(T) == 1 ? bytes.u8(at) : bytes.be16(at));
        }
        if (psd.colors == 4) {
            cmyk_to_rgb(pixel, 1, true, to.data() + 3 * i);
            continue;
        }
        if (used > psd.colors && psd.is_over_white) take_white_away(pixel, psd.colors);
        std::copy_n(pixel, used, to.data() + used * i);
    }
}

}  // namespace

std::string read_psd(Bytes file, ImageFile& image) {
    Psd psd;
    if (std::string why = read_header(file, psd); !why.empty()) return why;
    std::vector<unsigned char> planes;
    if (std::string why = read_planes(file, psd, planes); !why.empty()) return why;
    const int channels = psd.colors == 4 ? 3 : static_cast<int>(psd.used()), bits = static_cast<int>(8 * psd.bytes);
    if (std::string why =
            start_image(image, static_cast<std::int64_t>(psd.width), static_cast<std::int64_t>(psd.height), channels, bits);
        !why.empty())
        return why;
    if (bits == 8) take_planes(psd, planes, image.samples8);
    else take_planes(psd, planes, image.samples16);
    return {};
}

}  // namespace tool
