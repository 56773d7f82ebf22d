// tools - reads binary PGM (P5) and PPM (P6) files of 8 and 16 bits from memory.
//
// stb_image reads them too, but in 2.27 (Debian 12) takes the bytes of 16-bit samples in the wrong order, and fills
// what a truncated file lacks with whatever the memory held. Samples are scaled so that the file's maximum becomes 255
// or 65535.
#ifndef HMESH_TOOLS_PNM_HPP
#define HMESH_TOOLS_PNM_HPP

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tool {

struct PnmHeader {
    int width = 0, height = 0, channels = 0, maximum = 0;
    std::size_t pixels_at = 0;  // where the samples begin
};

[[nodiscard]] inline bool is_pnm(const std::vector<unsigned char>& file) {
    return file.size() > 2 && file[0] == 'P' && (file[1] == '5' || file[1] == '6');
}

namespace detail {

[[nodiscard]] inline bool is_space(unsigned char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

// The next decimal number of a header, after white space and # comments; -1 when there is none below 10^9.
[[nodiscard]] inline int next_number(const std::vector<unsigned char>& file, std::size_t& at) {
    while (at < file.size() && (is_space(file[at]) || file[at] == '#')) {
        if (file[at] == '#')
            while (at < file.size() && file[at] != '\n' && file[at] != '\r') ++at;
        else ++at;
    }
    int value = -1;
    for (; at < file.size() && file[at] >= '0' && file[at] <= '9'; ++at) {
        if (value >= 100000000) return -1;
        value = (value < 0 ? 0 : value * 10) + (file[at] - '0');
    }
    return value;
}

}  // namespace detail

// Reads the header. Returns "" or what is wrong, as the end of a sentence.
[[nodiscard]] inline std::string read_pnm_header(const std::vector<unsigned char>& file, PnmHeader& header) {
    std::size_t at = 2;
    header.channels = file[1] == '6' ? 3 : 1;
    header.width = detail::next_number(file, at);
    header.height = detail::next_number(file, at);
    header.maximum = detail::next_number(file, at);
    if (header.width < 1 || header.height < 1) return "its PNM header has no valid size";
    if (header.maximum < 1 || header.maximum > 65535) return "its PNM header has no maximum from 1 to 65535";
    if (at >= file.size() || !detail::is_space(file[at])) return "its PNM header does not end in white space";
    header.pixels_at = at + 1;
    return {};
}

// Reads the samples after a valid header: T is uint8_t where maximum <= 255, else uint16_t. The same return value.
template <class T>
[[nodiscard]] std::string read_pnm_samples(const std::vector<unsigned char>& file, const PnmHeader& header,
                                           std::vector<T>& samples) {
    const std::size_t count = static_cast<std::size_t>(header.width) * static_cast<std::size_t>(header.height) *
                              static_cast<std::size_t>(header.channels);
    if ((file.size() - header.pixels_at) / sizeof(T) < count) return "the file ends before its last pixel";
    const auto maximum = static_cast<std::uint32_t>(header.maximum);
    const std::uint32_t full = sizeof(T) == 1 ? 255 : 65535;
    samples.resize(count);
    const unsigned char* bytes = file.data() + header.pixels_at;
    for (T& sample : samples) {
        std::uint32_t value = *bytes++;
        if constexpr (sizeof(T) == 2) value = value * 256 + *bytes++;
        if (value > maximum) return "it has a sample above the maximum of its PNM header";
        sample = static_cast<T>((value * full + maximum / 2) / maximum);
    }
    return {};
}

}  // namespace tool

#endif  // HMESH_TOOLS_PNM_HPP
