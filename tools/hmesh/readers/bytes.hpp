// tools - Bytes: the bytes of an image file, read as numbers. Nothing is read outside of them: what lies there is 0.
#ifndef HMESH_TOOLS_READERS_BYTES_HPP
#define HMESH_TOOLS_READERS_BYTES_HPP

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace tool {

struct Bytes {
    const unsigned char* data = nullptr;
    std::size_t size = 0;

    [[nodiscard]] std::uint32_t u8(std::size_t at) const noexcept { return at < size ? data[at] : 0; }
    [[nodiscard]] std::uint32_t le16(std::size_t at) const noexcept { return u8(at) | u8(at + 1) << 8U; }
    [[nodiscard]] std::uint32_t be16(std::size_t at) const noexcept { return u8(at) << 8U | u8(at + 1); }
    [[nodiscard]] std::uint32_t le32(std::size_t at) const noexcept { return le16(at) | le16(at + 2) << 16U; }
    [[nodiscard]] std::uint32_t be32(std::size_t at) const noexcept { return be16(at) << 16U | be16(at + 2); }
    // Whether `count` bytes lie from `at` on.
    [[nodiscard]] bool has(std::size_t at, std::size_t count) const noexcept { return at <= size && count <= size - at; }
    // Whether the text of N - 1 characters stands there.
    template <std::size_t N>
    [[nodiscard]] bool says(std::size_t at, const char (&text)[N]) const noexcept {
        return has(at, N - 1) && std::memcmp(data + at, text, N - 1) == 0;
    }
    // Those from `at` on, `count` at most.
    [[nodiscard]] Bytes part(std::size_t at, std::size_t count = SIZE_MAX) const noexcept {
        if (at > size) return {};
        return {data + at, count < size - at ? count : size - at};
    }
};

}  // namespace tool

#endif  // HMESH_TOOLS_READERS_BYTES_HPP
