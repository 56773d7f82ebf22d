// Binary PGM (P5), PPM (P6) and PFM (Pf, PF) files: pixels without compression. Samples of PGM and PPM are scaled so that the
// file's maximum becomes 255 or 65535.
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "readers/pnm_header.hpp"
#include "readers/readers.hpp"

namespace tool {
namespace {

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
std::string take_samples(Bytes file, std::size_t at, std::uint32_t maximum, std::vector<T>& samples) {
    const std::uint32_t full = sizeof(T) == 1 ? 255 : 65535;
    const unsigned char* bytes = file.data + at;
    for (T& sample : samples) {
        std::uint32_t value = *bytes++;
        if constexpr (sizeof(T) == 2) value = value * 256 + *bytes++;
        if (value > maximum)
            return "it has a sample above the maximum of its PNM header (" + std::to_string(value) + ", limit " +
                   std::to_string(maximum) + ")";
        sample = static_cast<T>((value * full + maximum / 2) / maximum);
    }
    return {};
}

std::size_t bytes_of(int width, int height, int channels, std::size_t size) {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * static_cast<std::size_t>(channels) * size;
}

}  // namespace

void find_pnm_size(Bytes file, std::int64_t& width, std::int64_t& height) {
    std::size_t at = 2;
    width = next_number(file, at);
    height = next_number(file, at);
}

std::string read_pnm(Bytes file, ImageFile& image) {
    std::size_t at = 2;
    const int channels = file.u8(1) == '6' ? 3 : 1;
    const int width = next_number(file, at), height = next_number(file, at), maximum = next_number(file, at);
    if (width < 1 || height < 1) return "its PNM header has no valid size";
    if (std::string why = check_size(width, height); !why.empty()) return why;
    if (maximum < 1 || maximum > 65535) return "its PNM header has no maximum from 1 to 65535";
    if (!is_space(file.u8(at++))) return "its PNM header does not end in white space";
    const int bits = maximum > 255 ? 16 : 8;
    const std::size_t needs = bytes_of(width, height, channels, static_cast<std::size_t>(bits) / 8);
    if (!file.has(at, needs)) return too_short(file.size, at + needs);
    if (std::string why = start_image(image, width, height, channels, bits); !why.empty()) return why;
    const auto most = static_cast<std::uint32_t>(maximum);
    return bits == 16 ? take_samples(file, at, most, image.samples16) : take_samples(file, at, most, image.samples8);
}

std::string read_pfm(Bytes file, ImageFile& image) {
    std::size_t at = 2;
    const int channels = file.u8(1) == 'F' ? 3 : 1;
    const int width = next_number(file, at), height = next_number(file, at);
    if (width < 1 || height < 1) return "its PFM header has no valid size";
    if (std::string why = check_size(width, height); !why.empty()) return why;
    const double scale = next_real(file, at);
    if (!std::isfinite(scale) || !(scale < 0 || scale > 0)) return "its PFM header has no scale other than 0";
    if (!is_space(file.u8(at++))) return "its PFM header does not end in white space";
    const std::size_t row = bytes_of(width, 1, channels, 4);
    const std::size_t needs = row * static_cast<std::size_t>(height);
    if (!file.has(at, needs)) return too_short(file.size, at + needs);
    if (std::string why = start_image(image, width, height, channels, 32); !why.empty()) return why;
    float* to = image.samples32.data();
    for (int y = height - 1; y >= 0; --y)  // rows from bottom to top; the sign of the scale is the order of bytes
        for (std::size_t k = 0; k < row; k += 4) {
            const std::size_t from = at + static_cast<std::size_t>(y) * row + k;
            const std::uint32_t word = scale < 0 ? file.le32(from) : file.be32(from);
            std::memcpy(to++, &word, 4);
        }
    return {};
}

}  // namespace tool
