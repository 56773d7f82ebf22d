#include "job/sha256.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <vector>

namespace job {
namespace {

// The first 32 bits of the fractional parts of the cube roots of the first 64 primes.
constexpr std::array<std::uint32_t, 64> constants = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5, 0xd807aa98, 0x12835b01,
    0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174, 0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc,
    0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da, 0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147,
    0x06ca6351, 0x14292967, 0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070, 0x19a4c116, 0x1e376c08,
    0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3, 0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208,
    0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

constexpr std::uint32_t turned(std::uint32_t word, unsigned bits) { return word >> bits | word << (32 - bits); }

}  // namespace

void Sha256::add_block(const unsigned char* block) {
    std::array<std::uint32_t, 64> w{};
    for (std::size_t i = 0; i < 16; ++i)
        for (std::size_t k = 0; k < 4; ++k) w[i] = w[i] << 8U | block[4 * i + k];
    for (std::size_t i = 16; i < 64; ++i) {
        const std::uint32_t a = w[i - 15], b = w[i - 2];
        w[i] = w[i - 16] + w[i - 7] + (turned(a, 7) ^ turned(a, 18) ^ a >> 3U) + (turned(b, 17) ^ turned(b, 19) ^ b >> 10U);
    }
    std::array<std::uint32_t, 8> s = state_;
    for (std::size_t i = 0; i < 64; ++i) {
        const std::uint32_t first = s[7] + (turned(s[4], 6) ^ turned(s[4], 11) ^ turned(s[4], 25)) +
                                    ((s[4] & s[5]) ^ (~s[4] & s[6])) + constants[i] + w[i];
        const std::uint32_t second =
            (turned(s[0], 2) ^ turned(s[0], 13) ^ turned(s[0], 22)) + ((s[0] & s[1]) ^ (s[0] & s[2]) ^ (s[1] & s[2]));
        s = {first + second, s[0], s[1], s[2], s[3] + first, s[4], s[5], s[6]};
    }
    for (std::size_t k = 0; k < 8; ++k) state_[k] += s[k];
}

void Sha256::add(const void* bytes, std::size_t size) {
    const auto* from = static_cast<const unsigned char*>(bytes);
    while (size > 0) {
        const std::size_t filled = size_ % block_.size(), part = std::min(size, block_.size() - filled);
        std::memcpy(block_.data() + filled, from, part);
        if (filled + part == block_.size()) add_block(block_.data());
        from += part;
        size -= part;
        size_ += part;
    }
}

std::string Sha256::hex() {
    const std::uint64_t bits = 8 * size_;
    constexpr std::array<unsigned char, 64> padding = {0x80};
    const std::size_t filled = size_ % 64;
    add(padding.data(), filled < 56 ? 56 - filled : 120 - filled);
    std::array<unsigned char, 8> length{};
    for (unsigned k = 0; k < 8; ++k) length[k] = static_cast<unsigned char>(bits >> (56 - 8 * k) & 0xffU);
    add(length.data(), length.size());
    std::string text;
    for (const std::uint32_t word : state_)
        for (unsigned k = 0; k < 8; ++k) text += "0123456789abcdef"[word >> (28 - 4 * k) & 0xfU];
    return text;
}

std::string sha256_of_file(const std::string& path, std::string& hex) {
    errno = 0;
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), std::fclose);
    if (!file) return std::strerror(errno);
    Sha256 sum;
    std::vector<unsigned char> bytes(std::size_t{1} << 18U);
    for (std::size_t got = 1; got > 0;) {
        got = std::fread(bytes.data(), 1, bytes.size(), file.get());
        sum.add(bytes.data(), got);
    }
    if (std::ferror(file.get()) != 0) return std::strerror(errno);
    hex = sum.hex();
    return {};
}

}  // namespace job
