// tools - the chunks of a PNG file (W3C, third edition, 5.3).
#ifndef HMESH_TOOLS_READERS_PNG_CHUNKS_HPP
#define HMESH_TOOLS_READERS_PNG_CHUNKS_HPP

#include <array>
#include <cstddef>
#include <cstdint>

#include "readers/bytes.hpp"

namespace tool {

// A chunk: its name stands at `at` + 4, its data at `at` + 8, their check sum behind these.
struct Chunk {
    std::size_t at = 8, size = 0;
};

// Whether there is a whole chunk; to the next: at += size + 12.
[[nodiscard]] inline bool read_chunk(Bytes file, Chunk& chunk) noexcept {
    chunk.size = file.be32(chunk.at);
    return file.has(chunk.at, 12) && chunk.size <= file.size - chunk.at - 12;
}

// CRC-32 of ISO 3309, as PNG has it.
[[nodiscard]] inline std::uint32_t crc(Bytes bytes) noexcept {
    static const auto table = [] {
        std::array<std::uint32_t, 256> values{};
        for (std::uint32_t n = 0; n < 256; ++n) {
            values[n] = n;
            for (int k = 0; k < 8; ++k) values[n] = (values[n] & 1U) != 0 ? 0xedb88320U ^ (values[n] >> 1U) : values[n] >> 1U;
        }
        return values;
    }();
    std::uint32_t value = 0xffffffffU;
    for (std::size_t k = 0; k < bytes.size; ++k) value = table[(value ^ bytes.data[k]) & 0xffU] ^ (value >> 8U);
    return ~value;
}

// Whether the check sum of a whole chunk is right.
[[nodiscard]] inline bool is_undamaged(Bytes file, const Chunk& chunk) noexcept {
    return crc(file.part(chunk.at + 4, chunk.size + 4)) == file.be32(chunk.at + chunk.size + 8);
}

}  // namespace tool

#endif  // HMESH_TOOLS_READERS_PNG_CHUNKS_HPP
