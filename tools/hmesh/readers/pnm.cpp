// Binary PGM (P5), PPM (P6) and PFM (Pf, PF) files: pixels without compression. Samples of PGM and PPM are scaled so that the
// file's maximum becomes 255 or 65535.
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "readers/plain_layout.hpp"
#include "readers/readers.hpp"

namespace tool {
namespace {

bool is_space(std::uint32_t c) noexcept { return c == ' ' || (c >= '\t' && c <= '\r'); }

void skip_space(Bytes file, std::size_t& at) noexcept {
    while (at < file.size && (is_space(file.u8(at)) || file.u8(at) == '#')) {
        if (file.u8(at) == '#')
            while (at < file.size && file.u8(at) != '\n' && file.u8(at) != '\r') ++at;
        else ++at;
    }
}

// The next decimal number of a header, after white space and # comments; -1 when there is none below 10^9.
int next_number(Bytes file, std::size_t& at) noexcept {
    skip_space(file, at);
    int value = -1;
    for (; at < file.size && file.u8(at) >= '0' && file.u8(at) <= '9'; ++at) {
        if (value >= 100000000) return -1;
        value = (value < 0 ? 0 : value * 10) + static_cast<int>(file.u8(at) - '0');
    }
    return value;
}

// Of a header that is looked for in these bytes, a whole file or its beginning, and goes on behind them.
std::string endless_header(Bytes file) { return "its header does not end within " + std::to_string(file.size) + " bytes"; }

// The scale of a PFM header: NaN when there is none.
double next_real(Bytes file, std::size_t& at) {
    skip_space(file, at);
    std::string text;
    for (; at < file.size && !is_space(file.u8(at)) && text.size() < 40; ++at) text += static_cast<char>(file.u8(at));
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    return text.empty() || *end != '\0' ? NAN : value;
}

// T is uint8_t where the maximum is at most 255, else uint16_t.
template <class T>
std::string take_whole(const unsigned char* bytes, std::size_t count, std::uint32_t maximum, T* samples) {
    const std::uint32_t full = sizeof(T) == 1 ? 255 : 65535;
    if (maximum == full) {  // as nearly all files have it; out of core they are read some 25 times
        if constexpr (sizeof(T) == 1) std::memcpy(samples, bytes, count);
        else
            for (std::size_t k = 0; k < count; ++k) samples[k] = static_cast<T>(bytes[2 * k] << 8 | bytes[2 * k + 1]);
        return {};
    }
    for (std::size_t k = 0; k < count; ++k) {
        std::uint32_t value = *bytes++;
        if constexpr (sizeof(T) == 2) value = value * 256 + *bytes++;
        if (value > maximum)
            return "it has a sample above the maximum of its PNM header (" + std::to_string(value) + ", limit " +
                   std::to_string(maximum) + ")";
        samples[k] = static_cast<T>((value * full + maximum / 2) / maximum);
    }
    return {};
}

// Reads a file whose layout is known. Samples lie row by row.
std::string read_rows(Bytes file, const PlainLayout& layout, ImageFile& image) {
    const auto rows = static_cast<std::size_t>(layout.height);
    const std::size_t needs = layout.row_bytes() * rows;
    if (!file.has(layout.first, needs)) return too_short(file.size, layout.first + needs);
    if (std::string why = start_image(image, layout.width, layout.height, layout.channels, layout.bits()); !why.empty())
        return why;
    void* const samples = layout.sample_bytes == 1   ? static_cast<void*>(image.samples8.data())
                          : layout.sample_bytes == 2 ? static_cast<void*>(image.samples16.data())
                                                     : static_cast<void*>(image.samples32.data());
    for (std::size_t y = 0; y < rows; ++y) {
        const unsigned char* const from =
            file.data + layout.first + (layout.is_bottom_up ? rows - 1 - y : y) * layout.row_bytes();
        std::string why = take_samples(layout, from, layout.row_bytes() / layout.sample_bytes,
                                       static_cast<unsigned char*>(samples) + y * layout.row_bytes());
        if (!why.empty()) return why;
    }
    return {};
}

}  // namespace

void find_pnm_size(Bytes file, std::int64_t& width, std::int64_t& height) {
    std::size_t at = 2;
    width = next_number(file, at);
    height = next_number(file, at);
}

std::string read_pnm_layout(Bytes file, PlainLayout& layout) {
    layout = {};
    std::size_t at = 2;
    layout.channels = file.u8(1) == '6' ? 3 : 1;
    layout.width = next_number(file, at);
    layout.height = next_number(file, at);
    const int maximum = next_number(file, at);
    if (at >= file.size) return endless_header(file);
    if (layout.width < 1 || layout.height < 1) return "its PNM header has no valid size";
    if (maximum < 1 || maximum > 65535) return "its PNM header has no maximum from 1 to 65535";
    if (!is_space(file.u8(at++))) return "its PNM header does not end in white space";
    layout.maximum = static_cast<std::uint32_t>(maximum);
    layout.sample_bytes = maximum > 255 ? 2 : 1;
    layout.first = at;
    return {};
}

std::string read_pfm_layout(Bytes file, PlainLayout& layout) {
    layout = {};
    std::size_t at = 2;
    layout.channels = file.u8(1) == 'F' ? 3 : 1;
    layout.width = next_number(file, at);
    layout.height = next_number(file, at);
    const double scale = next_real(file, at);
    if (at >= file.size) return endless_header(file);
    if (layout.width < 1 || layout.height < 1) return "its PFM header has no valid size";
    if (!std::isfinite(scale) || !(scale < 0 || scale > 0)) return "its PFM header has no scale other than 0";
    if (!is_space(file.u8(at++))) return "its PFM header does not end in white space";
    layout.sample_bytes = 4;
    layout.is_little = scale < 0;
    layout.is_bottom_up = true;
    layout.first = at;
    return {};
}

std::string take_samples(const PlainLayout& layout, const unsigned char* bytes, std::size_t count, void* samples) {
    if (layout.sample_bytes == 1) return take_whole(bytes, count, layout.maximum, static_cast<std::uint8_t*>(samples));
    if (layout.sample_bytes == 2) return take_whole(bytes, count, layout.maximum, static_cast<std::uint16_t*>(samples));
    const Bytes words{bytes, 4 * count};
    for (std::size_t k = 0; k < count; ++k) {
        const std::uint32_t word = layout.is_little ? words.le32(4 * k) : words.be32(4 * k);
        std::memcpy(static_cast<unsigned char*>(samples) + 4 * k, &word, 4);
    }
    return {};
}

std::string read_pnm(Bytes file, ImageFile& image) {
    PlainLayout layout;
    if (std::string why = read_pnm_layout(file, layout); !why.empty()) return why;
    return read_rows(file, layout, image);
}

std::string read_pfm(Bytes file, ImageFile& image) {
    PlainLayout layout;
    if (std::string why = read_pfm_layout(file, layout); !why.empty()) return why;
    return read_rows(file, layout, image);
}

}  // namespace tool
