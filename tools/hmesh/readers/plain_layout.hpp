// tools - where the samples lie in PGM, PPM and PFM files (Netpbm), and what they mean.
#ifndef HMESH_TOOLS_READERS_PLAIN_LAYOUT_HPP
#define HMESH_TOOLS_READERS_PLAIN_LAYOUT_HPP

#include <cstddef>
#include <cstdint>
#include <string>

#include "readers/bytes.hpp"

namespace tool {

struct PlainLayout {
    int width = 0, height = 0, channels = 0;
    std::size_t sample_bytes = 1;  // 1 and 2: whole numbers, 4: floats
    std::uint32_t maximum = 255;   // of whole numbers
    bool is_little = false;        // the order of bytes
    bool is_bottom_up = false;     // the order of rows
    std::size_t first = 0;         // byte of the file that is the first of a sample

    [[nodiscard]] int bits() const noexcept { return 8 * static_cast<int>(sample_bytes); }
    [[nodiscard]] std::size_t row_bytes() const noexcept {
        return static_cast<std::size_t>(width) * static_cast<std::size_t>(channels) * sample_bytes;
    }
};

// The header of a PGM or PPM file, and of a PFM file, in the first bytes of the file. Returns "" or what is wrong; the size may
// be one that nobody meshes.
[[nodiscard]] std::string read_pnm_layout(Bytes file, PlainLayout& layout);
[[nodiscard]] std::string read_pfm_layout(Bytes file, PlainLayout& layout);

// Makes samples of as many bytes as those of the file have of `count` of them. Returns "" or what is wrong.
[[nodiscard]] std::string take_samples(const PlainLayout& layout, const unsigned char* bytes, std::size_t count, void* samples);

}  // namespace tool

#endif  // HMESH_TOOLS_READERS_PLAIN_LAYOUT_HPP
