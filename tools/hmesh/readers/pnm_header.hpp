// tools - numbers in the headers of PGM, PPM and PFM files (Netpbm).
#ifndef HMESH_TOOLS_READERS_PNM_HEADER_HPP
#define HMESH_TOOLS_READERS_PNM_HEADER_HPP

#include <cstddef>
#include <cstdint>
#include <string>

#include "readers/bytes.hpp"

namespace tool {

[[nodiscard]] inline bool is_space(std::uint32_t c) noexcept { return c == ' ' || (c >= '\t' && c <= '\r'); }

inline void skip_space(Bytes file, std::size_t& at) noexcept {
    while (at < file.size && (is_space(file.u8(at)) || file.u8(at) == '#')) {
        if (file.u8(at) == '#')
            while (at < file.size && file.u8(at) != '\n' && file.u8(at) != '\r') ++at;
        else ++at;
    }
}

// The next decimal number of a header, after white space and # comments; -1 when there is none below 10^9.
[[nodiscard]] inline int next_number(Bytes file, std::size_t& at) noexcept {
    skip_space(file, at);
    int value = -1;
    for (; at < file.size && file.u8(at) >= '0' && file.u8(at) <= '9'; ++at) {
        if (value >= 100000000) return -1;
        value = (value < 0 ? 0 : value * 10) + static_cast<int>(file.u8(at) - '0');
    }
    return value;
}

// Of a header that is looked for in these bytes, a whole file or its beginning, and goes on behind them.
[[nodiscard]] inline std::string endless_header(Bytes file) {
    return "its header does not end within " + std::to_string(file.size) + " bytes";
}

}  // namespace tool

#endif  // HMESH_TOOLS_READERS_PNM_HEADER_HPP
